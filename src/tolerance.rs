//! Every threshold of the numerics, each dimensionless and with its reason. Those of the cells are in
//! [`vofkit_geometry::tolerance`], those of the integrals over shapes with these in `fractions`.

/// Fluxes are multiples of the largest edge integral over two to this power: below its rounding, and sums of a cell's
/// fluxes still fit into the 53 bits of a double.
pub const FLUX_BITS: i32 = 49;

/// A fraction this close to 0 or 1 is set to it, and the change is in the ledger. It is the rounding of a step: without it
/// cells that emptied would keep a remainder of a few units in the last place and be carried along as mixed for ever.
pub const FRACTION_ROUNDING: f64 = 1e-14;

/// The fractions of several materials in a cell may add up to one and this much: the rounding of whoever made them. More is an
/// error, since parts that tile the cell cannot have these volumes.
pub const OVERFULL: f64 = 1e-9;

/// A gradient below this, relative to the largest fraction of the stencil, is rounding: no normal.
pub const GRADIENT_FLAT: f64 = 16.0 * f64::EPSILON;

/// Share of its trace that is added to the diagonal of a matrix before it is inverted: far below what decides, and enough to
/// keep a direction of which nothing is known at zero.
pub const NORMAL_EQUATIONS: f64 = 1e-14;

/// The promised fall of a misfit, relative to the misfit, below which a descent has arrived: what is left moves the plane by far
/// less than the misfit says that it is wrong.
pub const DESCENT_GAIN: f64 = 1e-3;

/// A promised fall of a misfit (of fractions, squared) below this is rounding: where a plane fits, the descent goes on to here,
/// which keeps it to 1e-12 of a cell.
pub const MISFIT_ROUNDING: f64 = 1e-28;

/// A misfit (of fractions, squared and weighted) below this is none: the plane fits the patch as exactly as the fractions are known.
pub const MISFIT_NONE: f64 = 1e-20;

/// The part of a misfit that derivatives may leave behind where a plane can fit the patch to rounding: it is the square of the turn
/// to that plane, which is some tenths at most, and what sections change by on the way.
pub const MISFIT_CURVED: f64 = 0.25;

/// How many times smaller the squared misfit of a material has to be with something set aside than without. Interfaces that end at
/// another one are fitted exactly that way, curved ones hardly better; touching bodies are carried best from about 16 on.
pub(crate) const ASIDE_MISFIT: f64 = 16.0;

/// Misfits of the planes of several materials in a cell that differ by less than this (in fractions, squared) are the same, so that
/// not rounding says which one is cut first.
pub const MISFIT_EQUAL: f64 = 1e-12;

/// Points after which a descent stops. From a gradient's normal it takes about four; twenty are enough from any start.
pub const DESCENT_POINTS: usize = 20;

/// The damping, relative to the trace of the curvature, that the first step gets that does not descend.
pub const DESCENT_DAMPING: f64 = 1e-2;

/// The largest turn of one step, as the tangent of its angle: linear models say nothing about larger ones.
pub const DESCENT_TURN: f64 = 0.5;

/// The least curvature of a misfit, in squared fractions per squared turn, for which it determines the normal: below, rounding
/// turns it by more than 1e-10.
pub const PLANE_DETERMINED: f64 = 1e-12;

/// A mean square misfit of the fractions of a patch above which other starts are tried. A circle with a radius of three
/// cells stays below; corners, films and two interfaces are above.
pub const MISFIT_POOR: f64 = 2.5e-3;

/// What is added to the spread `f (1 - f)` of a fraction before a misfit is divided by its root: pure cells would otherwise decide
/// alone.
pub const SPREAD_LEAST: f64 = 1e-3;

/// Starts whose directions have a cosine above this lead to the same minimum.
pub const STARTS_APART: f64 = 0.99;

/// A part of a cell below this lies in one corner or at one edge, so that planes that leave it turn about a point of their own: the misfit
/// then has minima that say nothing about the patch.
pub const CELL_PART: f64 = 1e-3;

/// The turn over which derivatives of a centroid are differences: the rounding of a centroid over it is as large as its square.
pub const CENTROID_TURN: f64 = 1e-6;

/// A distance of centroids, relative to the size of the smaller part, above which a descent is repeated from other starts. Along a circle
/// with a radius of three cells planes come nearer; what stays above are corners, films, and minima that are none of the interface's.
pub const CENTROID_NEAR: f64 = 5e-2;

/// Descents in a row towards a centroid: small parts that lie along an edge have long narrow valleys, and one in ten thousand takes more points
/// than one descent has.
pub const CENTROID_DESCENTS: usize = 4;

/// The least cosine between the normals of neighbours that belong to the same piece of interface: 60 degrees. Around a corner of 90
/// degrees normals of different sides are apart by more, along a circle with a radius of two cells by less.
pub const CONNECTED_NORMALS: f64 = 0.5;

/// The largest height of a neighbour's middle over the plane of a cell, relative to its distance along the plane, if both belong to the
/// same piece of interface. The other side of a film lies higher.
pub const CONNECTED_SLOPE: f64 = 1.0;

/// Rounds after which the planes of neighbours are taken as they are. Errors are squared in each, so that a common plane is found in
/// four or five; along a curve two or three bring all that there is to gain, and at the rims of sheets, where planes do not come
/// to rest, more of them change errors either way.
pub const RELAXED_ROUNDS: usize = 6;

/// The square of the last turn of a plane and its neighbours, relative to the mean square of the heights of their middles over it, below
/// which it stays: further rounds would change less than a tenth of what remains.
pub const RELAXED_GAIN: f64 = 1e-2;

/// The square of a turn, or of a height in cells, that counts as none.
pub const TURN_ROUNDING: f64 = 1e-24;

/// A swept region whose own volume differs from the flux volume by more than this factor does not resemble the face's motion (its
/// velocity changes sign): the face is then moved as a whole.
pub const SWEPT_VOLUME_RATIO: f64 = 2.0;

/// Rounds in which the depth of a region that is traced back along no single axis is adjusted. Each gains the Courant number
/// times the change of the velocity over a cell; what is left in folded faces is settled by moving the face as a whole.
pub const TRACE_ITERATIONS: usize = 8;

/// What crosses an end of a moving mesh below this, relative to the cell at the end, is the rounding of nodes that slide along it.
pub const END_SLIDING: f64 = 1e-13;

/// Two outflows of a cell may ask for this much more than it holds, relative to its volume: rounding.
pub const OUTFLOW_EXCESS: f64 = 1e-12;

/// A reversed flow whose remaining duration is below this, relative to the time it ran, is back at its start: the rounding of the
/// sum of the steps.
pub const REVERSAL_ROUNDING: f64 = 1e-12;

/// The moves of a node and of its image at a joined end may differ by this, relative to the size of the mesh: rounding. Without
/// a limit joined ends could come apart.
pub const PERIODIC_MOTION: f64 = 1e-12;

/// Fractions from a file may add up to this much more than 1 in a cell: those of other programs are often rounded to seven
/// digits. They are then divided by their sum.
pub const FRACTION_SUM: f64 = 1e-6;

/// Centroids from a file may lie this far outside of the box around their cell, relative to the largest coordinate of its corners: the
/// rounding of both to single precision, twice 2^-24 each. Without it the sliver at a face would be refused.
pub const CENTROID_OUTSIDE: f64 = 2.5e-7;

/// Nodes of a plane mesh from a file may differ by this much in z, relative to the size of the mesh: coordinates in single precision
/// that were turned into the plane.
pub const PLANAR: f64 = 1e-6;

/// A cell belongs to a fragment of a material where its fraction is above this: wisps below it join nothing.
pub const FRAGMENT_FRACTION: f64 = 1e-6;

/// A fragment counts where it holds more than this part of the material.
pub const FRAGMENT_VOLUME: f64 = 1e-4;

/// Cell volumes, volumes of bodies, edge integrals of potentials, and the lengths and times of scenes outside this range are refused: their
/// products, quotients and roundings would over- or underflow.
pub const RANGE: std::ops::RangeInclusive<f64> = 1e-250..=1e250;

/// A face whose area, relative to its extent to the power of the dimension less one, is below this has collapsed: fluxes through it
/// are rounding, and no point of it could be moved to account for them.
pub const FACE_COLLAPSED: f64 = 1e-10;

/// The fluxes of a cell that the caller gives may fail to cancel by this, relative to its volume: rounding. What they fill or drain
/// beyond that would go missing, since the cell stays as large as it is.
pub const FLUX_BALANCE: f64 = 1e-13;

/// What a cell keeps of a material below this, relative to what it held, is the rounding of what left.
pub const KEPT_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Unsplit contents may be out of bounds by this much, relative to the cell: rounding. More means that a pre-image folds over.
pub const FRACTION_EXCESS: f64 = 1e-12;

/// The volume of a pre-image may differ from what the fluxes make it by this, relative to the larger of the cell and the box around
/// it: the rounding of any cell. More means that its corners lie so far away that what is cut from it would be rounding.
pub const PREIMAGE_ROUNDING: f64 = 1e-12;

/// Cells around one that is not settled, at most, that a step looks at. Nodes that come from further away have left every
/// Courant number behind; on a mesh with collapsed cells the bound for how far they come would be infinite.
pub const LARGEST_RADIUS: f64 = 64.0;

/// A shell whose volume, relative to the cube over the longest side of its body, is below this is flat: rounding would decide which way
/// round it is.
pub const SHELL_FLAT: f64 = 1e-14;

/// Parts of a surface that are nearer than this, relative to the longest side of the box around it, touch: well above the rounding of
/// coordinates in single precision. Without it bodies that lie on each other would be told to overlap.
pub const SHELL_TOUCH: f64 = 1e-6;

/// The sum of the fluxes of a cell, over its volume and the largest Courant number of the mesh, below which a velocity from nodes is free of
/// divergence: the rounding of fields that are so, such as rotations. More would show up as a drift of volumes.
pub const DIVERGENCE_ROUNDING: f64 = 1e-12;

/// An end of a mesh through which velocities from nodes come by less than this, relative to the largest velocity, is a wall: the rounding
/// of single precision. Without it walls of other programs would leak.
pub const WALL_ROUNDING: f64 = 1e-6;

/// The nodes of a mesh and of the file with its velocity may differ by this, relative to the size of the mesh: single precision.
/// More would be another mesh.
pub const SAME_NODE: f64 = 1e-6;

/// The residual of one round of conjugate gradients, relative to that at its start, below which they end: rounding of the rest.
pub const PROJECTION_REDUCTION: f64 = 1e-10;

/// The sum of the fluxes of a cell, relative to the largest flux, below which a projection is done: rounding of the sum itself.
pub const PROJECTION_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The same where further rounds gain nothing: the rounding of pressures that are much larger than their differences. More is an error,
/// since volumes would drift.
pub const PROJECTION_RESIDUAL: f64 = 1e-13;

/// Rounds of conjugate gradients of a projection. Each gains ten digits as long as these are there; two or three are enough.
pub const PROJECTION_ROUNDS: usize = 6;

/// Iterations of a round of conjugate gradients. They take some times the cells along the longest axis, times the aspect ratio of the cells;
/// with more than these the round ends where it is, and the next one goes on.
pub const PROJECTION_ITERATIONS: usize = 20_000;
