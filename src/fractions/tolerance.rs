//! Every threshold of the quadrature, each dimensionless and with its reason.

/// Error of the integral over one smooth piece, relative to the volume of the brick that is integrated. Bricks are no larger than
/// the curved shapes in them, so that totals are right to 1e-9 with three digits to spare; smaller would meet rounding.
pub(super) const QUADRATURE: f64 = 1e-12;

/// The same for the integrals over one section inside the integral over sections: the outer rule must not take their errors for
/// a feature of its integrand.
pub(super) const SECTION: f64 = 1e-13;

/// Share of the product of the longest edges that counts as volume of a brick when errors are compared with it, so that
/// flat and collapsed bricks do not ask for an error of zero.
pub(super) const FLAT: f64 = 1e-6;

/// Rounding of a crossing of a curved surface, in units of `epsilon |y|^2 / slope`: the floor of the tolerances.
/// Without it a ball a million times larger than the cell would be bisected in search of noise.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Bisected pieces after which one integral takes what it has. A square root or a jump that no break point announces takes 30.
pub(super) const PIECES: usize = 300;

/// Bisections of a cell after which a brick is integrated whatever it holds: it is 2^-90 of the cell.
pub(super) const BISECTIONS: usize = 90;

/// Bisections spent on a pair of surfaces that may be tangent or meet across the direction of integration, and on points where
/// three meet. The adaptive rule finds most of their kinks, but not those between its outermost nodes and the
/// ends; bricks are 2^-24 of the cell by then.
pub(super) const PAIR_BISECTIONS: usize = 24;

/// Bricks of one cell after which no more are bisected: a bound on the time that a cell can take.
pub(super) const BRICKS: usize = 50_000;

/// Largest distance from the middle of a brick to its corners in the frame in which a curved surface is the unit
/// sphere. Larger bricks lose digits of the crossings, and a surface that takes a small part of them hides between nodes.
pub(super) const REACH: f64 = 1.0;

/// A slope along one direction, relative to the steepest, that is counted as none.
pub(super) const LEVEL: f64 = 1e-13;

/// A polynomial's value, relative to its largest coefficient, that is counted as a (double) root: one break point too
/// many costs little, one missing makes the rule bisect.
pub(super) const DOUBLE_ROOT: f64 = 1e-9;

/// Break points nearer than this are one.
pub(super) const BREAKS_APART: f64 = 1e-14;

/// A fraction this near to one is one: the rounding of the sum over the bricks of a cell.
pub(super) const FULL: f64 = 16.0 * f64::EPSILON;

/// A corner of a body's surface this near to the plane of a triangle, relative to the cell, lies in it: triangles share corners, and
/// rounding must not cut slivers off them.
pub(super) const COPLANAR: f64 = 1e-12;

/// Triangles of a body in one brick above which the brick is bisected: cutting by all of them takes the square of their number.
pub(super) const TRIANGLES: usize = 24;

/// Bisections of a cell because of many triangles. After them, where dozens meet at a corner, the time is spent.
pub(super) const CROWD_BISECTIONS: usize = 15;

/// Triangles of a body in one brick above which the time is not spent, but the brick is bisected on.
pub(super) const MOST_TRIANGLES: usize = 256;

/// Bisections of a cell that a body cuts after which its middle decides: what is left is 2^-30 of the cell, where hundreds of
/// triangles meet at a corner.
pub(super) const BODY_BISECTIONS: usize = 30;

/// Bisections for the sake of curved surfaces and of ruled faces in a cell that a body cuts too. Their errors fall by four with each
/// bisection along every axis, and are those of cells of a thousandth the volume then.
pub(super) const MEETING_BISECTIONS: usize = 9;

/// Distance from the middle of a brick to its corners, in the frame in which a curved surface is the unit sphere, below which its
/// tangent plane stands for the surface where a body cuts the brick too: the volume between them is its square, one part in 10^4
/// of a brick, and changes its sign from brick to brick.
pub(super) const MEETING_REACH: f64 = 1e-2;

/// How far a brick may be from a parallelepiped, relative to its edges, where a body cuts it: its faces are taken for four
/// triangles each, which enclose what the ruled face does, so that the error of a part of it is some hundredths of this.
pub(super) const WARP: f64 = 5e-2;
