//! Bodies bounded by triangles, in two dimensions by segments.
//!
//! This file holds a body and how it is made and moved; [`check`] what can be wrong with its surface, and which way round it is;
//! `crossing` whether it crosses or overlaps itself; `inside` which points it holds; `tree` finds the parts of the surface next
//! to a place.

pub mod check;
mod crossing;
mod inside;
mod tree;

use std::collections::HashMap;

use vofkit_geometry::Vector;
use vofkit_geometry::clip::bounds;

use super::Rotation;
use crate::tolerance::SHELL_TOUCH;
pub use check::{BodyDefect, BodyError, BodyNotice};
use tree::Tree;

/// A closed surface of triangles (2D: segments) and what it encloses.
///
/// Triangles are counter-clockwise seen from outside; segments run counter-clockwise around the body. The surface winds once around
/// what it encloses.
#[derive(Clone, Debug)]
pub struct Body<const D: usize> {
    corners: Vec<Vector<D>>,
    pieces: Vec<[u32; D]>,
    tree: Tree,
    notices: Vec<BodyNotice>,
}

impl<const D: usize> PartialEq for Body<D> {
    fn eq(&self, other: &Self) -> bool {
        self.corners == other.corners && self.pieces == other.pieces
    }
}

impl<const D: usize> Body<D> {
    /// The body in a surface, given as the corners of its pieces. Corners with equal coordinates are one.
    ///
    /// A shell that is turned inside out is turned back, and so is one inside another if it does not bound a cavity; see
    /// [`Body::notices`].
    ///
    /// # Errors
    /// A surface that does not bound a body, with every defect.
    pub fn new(surface: &[[Vector<D>; D]]) -> Result<Self, BodyError> {
        check::finite(surface)?;
        let mut corners = Vec::new();
        let mut numbers = HashMap::new();
        let mut number = |x: &Vector<D>| {
            // Both zeros are one.
            let key: [u64; D] = std::array::from_fn(|k| (x[k] + 0.0).to_bits());
            *numbers.entry(key).or_insert_with(|| {
                corners.push(*x);
                corners.len() as u32 - 1
            })
        };
        let pieces: Vec<[u32; D]> =
            surface.iter().map(|piece| std::array::from_fn(|i| number(&piece[i]))).collect();
        let shells = check::shells(&pieces)?;
        let mut body = Self::assembled(corners, pieces, Vec::new());
        check::in_range(&body)?;
        let touch = SHELL_TOUCH * body.extent();
        crossing::apart(&body, touch)?;
        check::orient(&mut body, &shells, touch)?;
        crossing::simple(&body, touch)?;
        Ok(body)
    }

    fn assembled(corners: Vec<Vector<D>>, pieces: Vec<[u32; D]>, notices: Vec<BodyNotice>) -> Self {
        let tree = Tree::new(pieces.iter().map(|piece| bounds(piece.iter().map(|&i| &corners[i as usize]))));
        Self { corners, pieces, tree, notices }
    }

    /// Where the corners go under `x -> shift + scale R x`; the scale must be positive.
    #[must_use]
    pub fn placed(&self, scale: f64, rotation: &Rotation<D>, shift: &Vector<D>) -> Self {
        let corners = self.corners.iter().map(|x| rotation.apply(&(x * scale)) + shift).collect();
        Self::assembled(corners, self.pieces.clone(), self.notices.clone())
    }

    /// What was odd about the surface and put right.
    pub fn notices(&self) -> &[BodyNotice] {
        &self.notices
    }

    /// How many triangles (2D: segments) the surface has.
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// The corners of a piece of the surface.
    pub fn piece(&self, number: usize) -> [Vector<D>; D] {
        self.pieces[number].map(|i| self.corners[i as usize])
    }

    /// The numbers of the pieces whose boxes meet the box between two corners.
    pub fn near<'a>(&'a self, [lower, upper]: [Vector<D>; 2]) -> impl Iterator<Item = usize> + 'a {
        self.tree.near([lower, upper])
    }

    /// Whether no piece of the surface comes near the box between two corners.
    pub fn is_clear(&self, corners: [Vector<D>; 2]) -> bool {
        self.near(corners).next().is_none()
    }

    /// The volume (2D: area), by the divergence theorem.
    pub fn volume(&self) -> f64 {
        self.volume_of(0..self.pieces.len())
    }

    fn volume_of(&self, pieces: impl IntoIterator<Item = usize>) -> f64 {
        // Relative to a corner, so that no digits go to the distance from the origin.
        let origin = self.corners[0];
        let factorial = if D == 2 { 2.0 } else { 6.0 };
        let heights = pieces.into_iter().map(|number| {
            let piece = self.piece(number);
            normal(&piece).dot(&(piece[0] - origin))
        });
        heights.sum::<f64>() / factorial
    }

    /// The longest side of the box around the body.
    fn extent(&self) -> f64 {
        let [lower, upper] = self.bounding_box();
        (upper - lower).amax()
    }

    /// The corners of the box around the body.
    pub fn bounding_box(&self) -> [Vector<D>; 2] {
        bounds(&self.corners)
    }
}

/// The outward normal of a piece, as long as its segment or twice the area of its triangle.
pub(crate) fn normal<const D: usize>(piece: &[Vector<D>; D]) -> Vector<D> {
    let a = piece[1] - piece[0];
    if D == 2 {
        return Vector::from_fn(|i, _| if i == 0 { a[1] } else { -a[0] });
    }
    let b = piece[2 % D] - piece[0];
    Vector::from_fn(|i, _| {
        let [j, k] = [(i + 1) % D, (i + 2) % D];
        a[j] * b[k] - a[k] * b[j]
    })
}
