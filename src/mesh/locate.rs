//! Which cells of a mesh may meet a box: for regions that lie anywhere, on meshes however distorted.
//!
//! On an undistorted mesh that is a range of indices. On any other it is a tree of boxes: the cells in blocks of two along each
//! axis, these blocks in blocks again, and so on, each with the box around its nodes. Periodic meshes are met in all their images.

use vofkit_geometry::clip::bounds;
use vofkit_geometry::{Cell, Vector};

use super::{Grid, Mesh};
use crate::parallel;

/// Finds the cells that may meet a box.
#[derive(Clone, Debug)]
pub struct Locator<const D: usize> {
    /// From coarse to fine; none for undistorted meshes.
    levels: Vec<Level<D>>,
    /// The box around all nodes.
    bounds: [Vector<D>; 2],
    /// Whether all ends that are not joined are plane and lie on that box.
    is_box: bool,
    /// From one image of a periodic mesh to the next along each axis; zero along others.
    periods: [Vector<D>; D],
}

/// Blocks of cells, the first axis fastest.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    grid: Grid<D>,
    boxes: Vec<[Vector<D>; 2]>,
}

/// A cell that may meet the box, in one of the images of a periodic mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate<const D: usize> {
    /// The cell.
    pub cell: usize,
    /// What is to be added to its nodes.
    pub shift: Vector<D>,
}

fn meet<const D: usize>(a: &[Vector<D>; 2], b: &[Vector<D>; 2]) -> bool {
    (0..D).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k])
}

impl<const D: usize> Locator<D> {
    /// Prepares the search in a mesh.
    pub fn new<C: Cell<D>>(mesh: &Mesh<C, D>) -> Self {
        let grid = mesh.grid();
        let periods = std::array::from_fn(|axis| {
            let mut far = [0; D];
            far[axis] = grid.cells()[axis];
            if grid.periodic()[axis] {
                mesh.nodes()[grid.node_index(far)] - mesh.nodes()[0]
            } else {
                Vector::zeros()
            }
        });
        let mut levels: Vec<Level<D>> = Vec::new();
        if !mesh.is_undistorted() {
            let mut below = grid.cells();
            while levels.is_empty() || below.iter().any(|&n| n > 1) {
                let blocks = Grid::new(below.map(|n| n.div_ceil(2)), [false; D]);
                let boxes = parallel::map(blocks.len(), |block| match levels.last() {
                    None => bounds_of_children(&blocks, &below, block, |child| cell_bounds(mesh, child)),
                    Some(finer) => bounds_of_children(&blocks, &below, block, |child| {
                        finer.boxes[finer.grid.index(child)]
                    }),
                });
                below = blocks.cells();
                levels.push(Level { grid: blocks, boxes });
            }
            levels.reverse();
        }
        let bounds = bounds(mesh.nodes());
        let on_end = |(node, x): (usize, &Vector<D>)| {
            let at = grid.node_offset(node);
            (0..D).filter(|&axis| !grid.periodic()[axis]).all(|axis| {
                (at[axis] != 0 || x[axis] == bounds[0][axis])
                    && (at[axis] != grid.cells()[axis] || x[axis] == bounds[1][axis])
            })
        };
        let is_box = mesh.nodes().iter().enumerate().all(on_end);
        Self { levels, bounds, is_box, periods }
    }

    /// Whether a region, given by the box around it and the cells found for that, may reach beyond an end of the mesh that is
    /// not joined to the other.
    pub fn reaches_out<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        [low, high]: &[Vector<D>; 2],
        found: &[Candidate<D>],
    ) -> bool {
        let grid = mesh.grid();
        let mut ends = (0..D).filter(|&axis| !grid.periodic()[axis]);
        if self.is_box {
            let [lower, upper] = &self.bounds;
            return ends.any(|axis| low[axis] < lower[axis] || high[axis] > upper[axis]);
        }
        ends.any(|axis| {
            let at_end = |candidate: &Candidate<D>| {
                (0..2).any(|side| grid.neighbour(candidate.cell, axis, side).is_none())
            };
            found.is_empty() || found.iter().any(at_end)
        })
    }

    /// Adds to `found` every cell whose own box meets the box from `low` to `high`.
    pub fn find<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        [low, high]: [Vector<D>; 2],
        found: &mut Vec<Candidate<D>>,
    ) {
        // How many periods the images lie away that the box meets.
        let images = |axis: usize| {
            let period = self.periods[axis][axis];
            if period == 0.0 {
                return (0, 1);
            }
            let first = ((low[axis] - self.bounds[1][axis]) / period).ceil() as isize;
            let last = ((high[axis] - self.bounds[0][axis]) / period).floor() as isize;
            (first, (last - first + 1).max(0) as usize)
        };
        let images: [(isize, usize); D] = std::array::from_fn(images);
        for mut image in 0..images.iter().map(|(_, count)| count).product::<usize>() {
            let mut shift = Vector::zeros();
            for (&(first, count), period) in images.iter().zip(&self.periods) {
                shift += period * (first + (image % count) as isize) as f64;
                image /= count;
            }
            let wanted = [low - shift, high - shift];
            let mut found = |cell: usize| found.push(Candidate { cell, shift });
            if self.levels.is_empty() {
                self.in_boxes(mesh, &wanted, &mut found);
            } else {
                self.in_block(mesh, &wanted, 0, 0, &mut found);
            }
        }
    }

    /// The cells of an undistorted mesh that meet a box.
    fn in_boxes<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        [low, high]: &[Vector<D>; 2],
        found: &mut impl FnMut(usize),
    ) {
        let grid = mesh.grid();
        let mut range = [(0, 0); D];
        for (axis, range) in range.iter_mut().enumerate() {
            let n = grid.cells()[axis];
            let (start, end) = (self.bounds[0][axis], self.bounds[1][axis]);
            if !(low[axis] <= end && high[axis] >= start) {
                return;
            }
            let place = |x: f64| ((x - start) / (end - start) * n as f64).clamp(0.0, (n - 1) as f64) as usize;
            let node = |i: usize| {
                let mut offset = [0; D];
                offset[axis] = i;
                mesh.nodes()[grid.node_index(offset)][axis]
            };
            // The quotient is rounded: the nodes decide.
            let (mut first, mut last) = (place(low[axis]), place(high[axis]));
            while first > 0 && node(first) > low[axis] {
                first -= 1;
            }
            while last + 1 < n && node(last + 1) < high[axis] {
                last += 1;
            }
            *range = (first, last - first + 1);
        }
        for mut place in 0..range.iter().map(|(_, count)| count).product::<usize>() {
            let offset = range.map(|(first, count)| {
                let at = first + place % count;
                place /= count;
                at
            });
            found(grid.index(offset));
        }
    }

    /// The cells in a block of a level that meet a box.
    fn in_block<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        wanted: &[Vector<D>; 2],
        level: usize,
        block: usize,
        found: &mut impl FnMut(usize),
    ) {
        let Level { grid, boxes } = &self.levels[level];
        if !meet(wanted, &boxes[block]) {
            return;
        }
        let finer = self.levels.get(level + 1).map(|level| &level.grid);
        let below = finer.unwrap_or(mesh.grid());
        for child in children(grid, &below.cells(), block) {
            if finer.is_some() {
                self.in_block(mesh, wanted, level + 1, below.index(child), found);
            } else if meet(wanted, &cell_bounds(mesh, child)) {
                found(below.index(child));
            }
        }
    }
}

/// The offsets of what a block is made of, two along each axis, less at an end.
fn children<const D: usize>(
    blocks: &Grid<D>,
    below: &[usize; D],
    block: usize,
) -> impl Iterator<Item = [usize; D]> {
    let (at, below) = (blocks.offset(block), *below);
    (0..1_usize << D)
        .map(move |place| std::array::from_fn(|k| 2 * at[k] + (place >> k & 1)))
        .filter(move |child: &[usize; D]| child.iter().zip(&below).all(|(i, n)| i < n))
}

fn bounds_of_children<const D: usize>(
    blocks: &Grid<D>,
    below: &[usize; D],
    block: usize,
    of_child: impl Fn([usize; D]) -> [Vector<D>; 2],
) -> [Vector<D>; 2] {
    children(blocks, below, block)
        .map(of_child)
        .reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])])
        .expect("a block has at least one part")
}

fn cell_bounds<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, offset: [usize; D]) -> [Vector<D>; 2] {
    let grid = mesh.grid();
    let first = grid.node_index(offset);
    let [mut low, mut high] = [mesh.nodes()[first]; 2];
    for corner in &C::OFFSETS[1..] {
        let x = &mesh.nodes()[first + grid.node_index(*corner)];
        for k in 0..D {
            low[k] = if x[k] < low[k] { x[k] } else { low[k] };
            high[k] = if x[k] > high[k] { x[k] } else { high[k] };
        }
    }
    [low, high]
}
