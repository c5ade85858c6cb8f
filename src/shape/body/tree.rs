//! Which boxes meet a box: by the tree of parry, without the feature `surface` by looking at all.

use vofkit_geometry::Vector;

#[cfg(feature = "surface")]
use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector as Corner,
    partitioning::{Bvh, BvhBuildStrategy, BvhNode},
};

/// Boxes around the pieces of a surface.
#[derive(Clone)]
pub(super) struct Tree {
    #[cfg(feature = "surface")]
    boxes: Bvh,
    #[cfg(not(feature = "surface"))]
    boxes: Vec<[[f64; 3]; 2]>,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tree")
    }
}

/// A point in space; in two dimensions in the plane z = 0.
fn in_space<const D: usize>(x: &Vector<D>) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { x[k] } else { 0.0 })
}

#[cfg(feature = "surface")]
fn around<const D: usize>(corners: &[Vector<D>; 2]) -> Aabb {
    let [lower, upper] = corners.each_ref().map(|x| Corner::from(in_space(x)));
    Aabb::new(lower, upper)
}

impl Tree {
    #[cfg(feature = "surface")]
    pub(super) fn new<const D: usize>(boxes: impl Iterator<Item = [Vector<D>; 2]>) -> Self {
        let leaves: Vec<Aabb> = boxes.map(|corners| around(&corners)).collect();
        Self { boxes: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves) }
    }

    /// The numbers of the boxes that meet the box between two corners.
    #[cfg(feature = "surface")]
    pub(super) fn near<const D: usize>(&self, corners: [Vector<D>; 2]) -> impl Iterator<Item = usize> + '_ {
        let query = BvhNode::leaf(around(&corners), 0);
        self.boxes.leaves(move |node: &BvhNode| node.intersects(&query)).map(|number| number as usize)
    }

    #[cfg(not(feature = "surface"))]
    pub(super) fn new<const D: usize>(boxes: impl Iterator<Item = [Vector<D>; 2]>) -> Self {
        Self { boxes: boxes.map(|corners| corners.each_ref().map(in_space)).collect() }
    }

    /// The numbers of the boxes that meet the box between two corners.
    #[cfg(not(feature = "surface"))]
    pub(super) fn near<const D: usize>(&self, corners: [Vector<D>; 2]) -> impl Iterator<Item = usize> + '_ {
        let [lower, upper] = corners.each_ref().map(in_space);
        let meets = move |[a, b]: &[[f64; 3]; 2]| (0..3).all(|k| a[k] <= upper[k] && b[k] >= lower[k]);
        self.boxes.iter().enumerate().filter(move |(_, other)| meets(other)).map(|(number, _)| number)
    }
}
