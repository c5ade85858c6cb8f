//! What can be wrong with a surface, whether it is closed, and which way round its shells are.

use std::fmt;

use vofkit_geometry::Vector;

use super::Body;
use crate::tolerance::{RANGE, SHELL_FLAT};

/// Defects that an error names; the others are in its list.
const NAMED: usize = 5;

/// What is wrong with a surface. Triangles (2D: segments) are counted from 1, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BodyDefect {
    /// A coordinate that is not a finite number.
    NotFinite {
        /// The triangle.
        triangle: usize,
    },
    /// An edge that no other triangle shares: there is a hole.
    Open {
        /// The triangle.
        triangle: usize,
    },
    /// An edge along which two triangles run the same way, so that one of them is turned over.
    TurnedOver {
        /// The triangles.
        triangles: Vec<usize>,
    },
    /// An edge at which an odd number of triangles meet.
    Branching {
        /// The triangles.
        triangles: Vec<usize>,
    },
    /// Two triangles that run through each other.
    Crossing {
        /// The triangles.
        triangles: [usize; 2],
    },
    /// A triangle next to which the surface overlaps, or is turned over.
    Overlapping {
        /// The triangle.
        triangle: usize,
        /// How often the surface winds around the space on one side of it.
        winding: i32,
    },
}

impl BodyDefect {
    /// What is wrong, with triangles by their numbers, and segments by the lines on which they start.
    fn told(&self, lines: &[usize]) -> String {
        let names = |triangles: &[usize]| {
            let line = |triangle: &usize| lines.get(triangle - 1).unwrap_or(triangle).to_string();
            let list = triangles.iter().map(line).collect::<Vec<_>>().join(", ");
            match (lines, triangles) {
                ([], [_]) => format!("triangle {list}"),
                ([], _) => format!("triangles {list}"),
                (_, [_]) => format!("the segment from line {list}"),
                _ => format!("the segments from lines {list}"),
            }
        };
        match self {
            Self::NotFinite { triangle } => {
                format!("{} has a coordinate that is not finite", names(&[*triangle]))
            }
            Self::Open { triangle } => {
                format!("{} has an edge that no other one shares", names(&[*triangle]))
            }
            Self::TurnedOver { triangles } => {
                format!("{} run the same way along their common edge", names(triangles))
            }
            Self::Branching { triangles } => {
                format!("{} meet at one edge, an odd number of them", names(triangles))
            }
            Self::Crossing { triangles } => format!("{} run through each other", names(triangles)),
            Self::Overlapping { triangle, winding } => format!(
                "{} lies where the surface overlaps or is turned over: it winds {winding} times around one side",
                names(&[*triangle])
            ),
        }
    }
}

impl fmt::Display for BodyDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(&[]))
    }
}

/// Why there is no body in a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodyError {
    /// There are no triangles.
    #[error("the surface has no triangles")]
    Empty,
    /// The surface encloses no volume.
    #[error("the surface of {triangles} triangles encloses nothing: it is flat, and {extent:e} long")]
    Flat {
        /// How many triangles there are.
        triangles: usize,
        /// The longest side of the box around it.
        extent: f64,
    },
    /// The surface is so large or so small that its volume is none in double precision.
    #[error("the surface is {extent:e} long: its volume is outside the range of double precision")]
    Range {
        /// The longest side of the box around it.
        extent: f64,
    },
    /// Everything that is wrong with it.
    #[error("the surface does not bound a body: {}", .0.told(&[]))]
    Defects(Defects),
}

impl BodyError {
    /// What is wrong, with the lines on which the segments of an outline start.
    pub(crate) fn told(&self, lines: &[usize]) -> String {
        match self {
            Self::Defects(defects) if !lines.is_empty() => {
                format!("the outline does not bound a body: {}", defects.told(lines))
            }
            other => other.to_string(),
        }
    }
}

/// A list of defects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Defects(pub Vec<BodyDefect>);

impl Defects {
    fn told(&self, lines: &[usize]) -> String {
        let named: Vec<String> = self.0.iter().take(NAMED).map(|defect| defect.told(lines)).collect();
        let more = match self.0.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more defects"),
        };
        format!("{}{more}", named.join("; "))
    }
}

/// What was odd about a surface and put right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BodyNotice {
    /// A shell whose normals pointed inward was turned.
    Turned {
        /// Its first triangle, counted from 1.
        triangle: usize,
        /// How many triangles it has.
        triangles: usize,
    },
    /// A shell inside another one whose normals pointed outward was turned, so that it bounds a cavity.
    Cavity {
        /// Its first triangle, counted from 1.
        triangle: usize,
        /// How many triangles it has.
        triangles: usize,
    },
}

impl fmt::Display for BodyNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Turned { triangle, triangles } => write!(
                f,
                "the shell of {triangles} triangles from number {triangle} on pointed inward and was turned outward"
            ),
            Self::Cavity { triangle, triangles } => write!(
                f,
                "the shell of {triangles} triangles from number {triangle} on lies inside another one and was taken for a cavity"
            ),
        }
    }
}

pub(super) fn refused(defects: Vec<BodyDefect>) -> Result<(), BodyError> {
    if defects.is_empty() { Ok(()) } else { Err(BodyError::Defects(Defects(defects))) }
}

/// Whether there is a surface and all its coordinates are finite.
pub(super) fn finite<const D: usize>(surface: &[[Vector<D>; D]]) -> Result<(), BodyError> {
    if surface.is_empty() {
        return Err(BodyError::Empty);
    }
    let odd = |(i, piece): (usize, &[Vector<D>; D])| {
        let finite = piece.iter().flatten().all(|x| x.is_finite());
        (!finite).then_some(BodyDefect::NotFinite { triangle: i + 1 })
    };
    refused(surface.iter().enumerate().filter_map(odd).collect())
}

/// Whether volumes of the size of a body are in the range of double precision.
pub(super) fn in_range<const D: usize>(body: &Body<D>) -> Result<(), BodyError> {
    let extent = body.extent();
    if extent == 0.0 || RANGE.contains(&extent.powi(D as i32)) {
        Ok(())
    } else {
        Err(BodyError::Range { extent })
    }
}

/// An edge of a piece (2D: an end), which way the piece runs along it, and the piece.
type Edge = ([u32; 2], bool, usize);

/// The number of the shell that each piece belongs to: the least number of its pieces.
///
/// # Errors
/// Edges that are not shared by as many pieces on one side as on the other.
pub(super) fn shells<const D: usize>(pieces: &[[u32; D]]) -> Result<Vec<usize>, BodyError> {
    let mut edges: Vec<Edge> = Vec::with_capacity(D * pieces.len());
    for (number, piece) in pieces.iter().enumerate() {
        for i in 0..D {
            let (a, b) = (piece[i], piece[(i + 1) % D]);
            if D == 2 {
                edges.push(([a, a], i == 0, number));
            } else if a != b {
                edges.push(([a.min(b), a.max(b)], a < b, number));
            }
        }
    }
    edges.sort_unstable();
    let mut shells: Vec<usize> = (0..pieces.len()).collect();
    let mut defects = Vec::new();
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        let forward = shared.iter().filter(|edge| edge.1).count();
        let triangles = || shared.iter().map(|edge| edge.2 + 1).collect();
        match shared.len() {
            1 => defects.push(BodyDefect::Open { triangle: shared[0].2 + 1 }),
            all if all == 2 * forward => {
                shared.windows(2).for_each(|two| join(&mut shells, two[0].2, two[1].2))
            }
            all if all % 2 == 0 => defects.push(BodyDefect::TurnedOver { triangles: triangles() }),
            _ => defects.push(BodyDefect::Branching { triangles: triangles() }),
        }
    }
    refused(defects)?;
    Ok((0..pieces.len()).map(|piece| root(&mut shells, piece)).collect())
}

/// The least piece of a shell, as far as it is joined; the way there is shortened.
fn root(shells: &mut [usize], mut piece: usize) -> usize {
    while shells[piece] != piece {
        shells[piece] = shells[shells[piece]];
        piece = shells[piece];
    }
    piece
}

fn join(shells: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(shells, a), root(shells, b));
    shells[a.max(b)] = a.min(b);
}

/// Turns shells so that those inside an even number of others point outward and the rest inward. What is nearer than `touch` touches.
///
/// # Errors
/// A body of no volume.
pub(super) fn orient<const D: usize>(
    body: &mut Body<D>,
    shells: &[usize],
    touch: f64,
) -> Result<(), BodyError> {
    let mut members: Vec<(usize, usize)> = shells.iter().copied().zip(0..).collect();
    members.sort_unstable();
    let negligible = SHELL_FLAT * body.extent().powi(D as i32);
    let mut turned = Vec::new();
    let mut is_flat = true;
    for shell in members.chunk_by(|a, b| a.0 == b.0) {
        let (first, triangles) = (shell[0].0, shell.len());
        let volume = body.volume_of(shell.iter().map(|(_, piece)| *piece));
        is_flat &= volume.abs() <= negligible;
        let is_cavity = depth(body, shells, shell, touch) % 2 == 1;
        if (volume < 0.0) != is_cavity {
            let triangle = first + 1;
            turned.push(first);
            body.notices.push(match is_cavity {
                true => BodyNotice::Cavity { triangle, triangles },
                false => BodyNotice::Turned { triangle, triangles },
            });
        }
    }
    if is_flat {
        return Err(BodyError::Flat { triangles: shells.len(), extent: body.extent() });
    }
    for (piece, shell) in body.pieces.iter_mut().zip(shells) {
        if turned.binary_search(shell).is_ok() {
            piece.swap(0, 1);
        }
    }
    Ok(())
}

/// How many other shells enclose a shell, by the first of its pieces that touches none of them. A shell that is touched everywhere
/// lies beside those that touch it.
fn depth<const D: usize>(body: &Body<D>, shells: &[usize], shell: &[(usize, usize)], touch: f64) -> usize {
    let mut enclosing = 0;
    for &(own, piece) in shell {
        let mut around: Vec<(usize, [i32; 2])> = Vec::new();
        body.across(piece, touch, |number, sides| {
            let other = shells[number];
            match around.iter_mut().find(|(known, _)| *known == other) {
                Some((_, windings)) => (0..2).for_each(|i| windings[i] += sides[i]),
                None => around.push((other, sides)),
            }
        });
        around.retain(|(other, _)| *other != own);
        enclosing = around.iter().filter(|(_, windings)| !windings.contains(&0)).count();
        if around.iter().all(|(_, [before, behind])| before == behind) {
            break;
        }
    }
    enclosing
}
