//! Every threshold of the kernel, each dimensionless and with its reason.

/// The twists of a cell, summed over components relative to its mean edges, that count as none: they change no volume
/// by more than rounding does. Without it a mesh of exact boxes whose coordinates were rounded would miss the closed forms.
pub const TWIST_NEGLIGIBLE: f64 = 4.0 * f64::EPSILON;

/// The largest twists, summed over components relative to the mean edges, for which the affine frame is used. Each of
/// the twelve components stays below 4 in valid cells; bow-ties and folded swept regions have mean edges that nearly
/// vanish, and dividing by them would lose digits.
pub const TWIST_AFFINE: f64 = 48.0;

/// Condition of a cell's frame, the sum of the elements of `|J^-1| |J|`, above which it is computed with compensated
/// arithmetic. Plain arithmetic loses this factor: without it, 5e-11 of the volume of a sliver of 1e-6 that is
/// rotated, 1e-7 of a needle's. Boxes along the axes are at 3, strongly distorted cells below 10; slivers and needles pass
/// it when rotated, from an aspect of about 1/15.
pub const FRAME_CONDITION: f64 = 32.0;

/// Residual of a plane constant relative to the smaller of the two parts: the rounding of a truncated volume.
/// Smaller, and the iteration would chase noise.
pub const POSITION_RESIDUAL: f64 = 4.0 * f64::EPSILON;

/// Residual of a plane constant, relative to the volume of the unit cube in the cell's frame, that is always small enough: 2e-320, near
/// the least number that there is. Parts below it have few digits, and products on the way to them none: without it the search would
/// bisect until it gives up.
pub const POSITION_LEAST: f64 = f64::from_bits(1 << 12);

/// Residual, relative to the cell's volume, above which a plane constant is an error. Rounding stays far
/// below; only a volume that is not monotone in the constant (an inverted cell) comes here.
pub const POSITION_FAILURE: f64 = 1e-12;

/// Residual of a plane constant, relative to the volume of the unit cube in the cell's frame, that is never an error: volumes are sums
/// of terms of that order, and the rounding of the plane constant alone moves the plane by as much. It counts where the frame is a
/// length scale, on cells that are much thinner than they are warped: without it they have no plane constant once their volume is
/// below about 1e-5 of their extent cubed.
pub const POSITION_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Evaluations after which the search for a plane constant gives up. Bisection alone needs 60; Brent's method took
/// up to 47 on the worst valid cells.
pub const POSITION_EVALUATIONS: usize = 100;

/// Largest distance of a sampled section edge from the true curve, relative to the longer diagonal of its face.
/// Smaller gives more points than a viewer can show.
pub const SECTION_CHORD: f64 = 2e-3;

/// A Jacobian determinant below this, relative to its largest Bernstein coefficient, is negative. Collapsed
/// edges have determinant zero there up to rounding, and are legal.
pub const JACOBIAN_NEGATIVE: f64 = -1e-12;

/// Sub-boxes after which the search for a negative Jacobian determinant stops. The bounds converge with the
/// square of the box size, so only a cell whose determinant touches zero along a curve or a surface stays open that
/// long; it has been sampled at more than this number of points without a negative value, and passes.
pub const JACOBIAN_BOXES: usize = 20_000;

/// An edge shorter than this, relative to the cell's longest, is noticed as collapsed.
pub const EDGE_COLLAPSED: f64 = 1e-14;

/// An orientation `l - r` of three points of the plane whose magnitude is below this times `|l| + |r|` may be rounding:
/// the points count as collinear (Shewchuk 1997: 3 units of rounding, and two more for the scaling). Without it a
/// quadrilateral with three nodes on a line would be non-convex by chance.
pub const ORIENTATION: f64 = 3.0 * f64::EPSILON;

/// Most chords that one curved edge of a section is sampled with. [`SECTION_CHORD`] asks for no more than 23 unless the
/// face is folded; without a limit, coordinates near overflow could ask for any number.
pub const SECTION_CHORDS: usize = 32;

/// A component of a normal in the cell's frame, relative to the largest, that is counted as none: what it adds is far
/// below rounding, and the inverse of a smaller one overflows. A whole normal below it, as a region is cut along, is none.
pub const DIRECTION_NEGLIGIBLE: f64 = 1e-290;

/// Kothe's formula divides by `lambda`, the product of the heights of two edges of a face over the plane. Below
/// this, relative to the square of the height of the cell, it counts as zero, and the face falls back. Terms of the
/// order of `1 / lambda` cancel, and on twisted faces of `1 / lambda^2`: a larger limit would give up faces to a
/// worse fall-back, with a smaller one a face that is parallel to the plane up to rounding would give volumes of
/// any size.
pub const KOTHE_PARALLEL: f64 = 1e-6;

/// Terms after which Kothe's series is cut off. They give full accuracy up to `|w| = 0.99`; at `w = -1` less than
/// 2e-6 of the sum is left. Without a limit it would go on for ever there.
pub const KOTHE_TERMS: usize = 2000;

/// A simplex of a cell, relative to the cell's extent to the power of the dimension, that counts as nothing when the cell is
/// cut out of a region. Its planes are rounding, and where all of them are, any part of the region could lie between them.
pub const PIECE_NEGLIGIBLE: f64 = 1e-15;

/// How far a corner of a face lies from the plane of the others, relative to the size of the face, where the face counts as plane
/// when its cell is cut out of a region: the rounding of coordinates of a few cell sizes.
pub const FACE_PLANE: f64 = 1e-14;

/// A difference of heights along an edge, relative to the largest component of the normal in the cell's frame, below which it
/// is counted as that: the edge lies in the plane to far beyond rounding, and the inverse of a smaller one overflows.
pub const HEIGHT_NEGLIGIBLE: f64 = 1e-290;
