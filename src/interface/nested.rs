//! Several materials in one cell, cut one after the other from what the earlier ones left (nested dissection, Dyadechko & Shashkov
//! 2008), so that the parts tile the cell: none overlaps another, and their volumes add up to that of the cell.
//!
//! **Order.** Next comes the material, or void, whose plane fits the cells around best, the one listed first among equals; or, with
//! [`Materials::Listed`](super::Materials), the first of the list that has a normal, and void is what is left. How normals
//! are found where materials are gone already is told in `order`. What has no normal waits for the others; what still has none then
//! stays mixed, in equal parts everywhere in the rest. Where centroids say how the materials lie, `centroids` finds order and normals.
//!
//! **Positions** are found on what is left: [regions](vofkit_geometry::clip) with straight edges in the cell's own frame. In 2D they
//! are the cell to the bit, in 3D ruled faces become four triangles about their middles: no volume changes by it.

use std::cell::RefCell;

use vofkit_geometry::clip::{Full, Region, Side, Tile};
use vofkit_geometry::root::{self, Root};
use vofkit_geometry::tolerance::{POSITION_EVALUATIONS, POSITION_FAILURE, POSITION_RESIDUAL};
use vofkit_geometry::{Cell, HalfSpace, PositionError, Vector};

use super::order::{Next, Queue, Waiting};
use super::sharing::void;
use super::{Counts, Parts, Placed, Reconstruction, ReconstructionError};
use crate::mesh::Mesh;
use crate::normal::frame::Frame;
use crate::normal::{Direction, NoNormal};
use crate::tolerance::FRACTION_ROUNDING;

/// What planes make of a cell.
pub(crate) type RegionOf<C, const D: usize> = <<C as Cell<D>>::Tile as Tile<D>>::Region;

/// A cell that several materials share.
#[derive(Clone, Copy, Debug)]
pub struct Shared<'a, C, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<C, D>,
    /// What the materials have of the cells.
    pub parts: Parts<'a, D>,
    /// By material, what was placed: directions that its own fractions gave are used where these alone say how the material lies. May
    /// be empty.
    pub planes: &'a [Option<Placed<D>>],
    /// The cell's index.
    pub index: usize,
    /// [`Mesh::local_cell`].
    pub cell: &'a C,
}

/// One cut: what is left of the cell in the half-space is the material's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut<const D: usize> {
    /// The material; none for void.
    pub material: Option<usize>,
    /// Its half-space, in the coordinates of [`Mesh::local_cell`].
    pub half_space: HalfSpace<D>,
}

/// What a material, or void, takes of what those before it leave of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Share<const D: usize> {
    /// What lies in a half-space, in the coordinates of [`Mesh::local_cell`].
    Below(HalfSpace<D>),
    /// This part everywhere: the fractions around the cell give no direction.
    Even(f64),
    /// All that is left.
    Rest,
}

/// What is cut next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen<const D: usize> {
    /// Its place among those that wait.
    pub(super) place: usize,
    /// Its direction in the frame of the cell.
    pub(super) direction: Direction<D>,
}

/// Dissects cells; keeps its memory from one to the next.
#[derive(Clone, Debug)]
pub struct Dissector<C: Cell<D>, const D: usize> {
    pub(super) queue: Queue<C, D>,
    /// What is left, with the piece that it is of.
    pub(super) rest: Vec<(usize, RegionOf<C, D>)>,
    /// The same after the next cut.
    next: Vec<(usize, RegionOf<C, D>)>,
    cuts: Vec<Cut<D>>,
}

impl<C: Cell<D>, const D: usize> Default for Dissector<C, D> {
    fn default() -> Self {
        Self { queue: Queue::new(), rest: Vec::new(), next: Vec::new(), cuts: Vec::new() }
    }
}

impl<C: Cell<D>, const D: usize> Dissector<C, D> {
    /// Cuts `pieces`, cells in the coordinates of [`Mesh::local_cell`] that tile the cell, into the parts of its materials. The
    /// volumes of a material add up to its fraction of the cell, and those in a piece, void included, to the piece.
    /// Each is given to `part` as piece, material and volume relative to the cell's; some come in several parts.
    ///
    /// # Errors
    /// Fractions that add up to more than 1, or a plane constant that was not found.
    pub fn dissect(
        &mut self,
        shared: Shared<'_, C, D>,
        pieces: impl IntoIterator<Item = C>,
        method: Reconstruction,
        mut part: impl FnMut(usize, usize, f64),
    ) -> Result<Counts, ReconstructionError> {
        let Shared { mesh, parts: Parts { fractions, .. }, index, cell, .. } = shared;
        let frame = Frame::new(cell);
        self.rest.clear();
        let regions = pieces.into_iter().map(|piece| region(&piece, |x| frame.point(x)));
        self.rest.extend(regions.enumerate());
        self.cuts.clear();
        let void = void(mesh, fractions, index)?;
        self.queue.fill(mesh.grid(), fractions, void, index, method.materials);
        let whole: f64 = self.rest.iter().map(|(_, region)| region.volume()).sum();
        if method.normal.reads_centroids() {
            self.know_centroids(&shared, &frame);
        }
        let mut counts = Counts::default();
        let mut give = |piece, material: Option<usize>, volume| {
            if let Some(material) = material {
                part(piece, material, volume / whole);
            }
        };
        while !self.queue.is_settled()
            && let Some(chosen) = self.choose(&shared, &frame, method)
        {
            let Chosen { place, direction: Direction { normal, determined, trials } } = chosen;
            let Waiting { material, fraction, .. } = self.queue.waiting[place];
            let Root { position, residual, evaluations } = self.position(&normal, self.queue.share(place));
            if !(residual.abs() <= POSITION_FAILURE * whole) {
                let source = PositionError::NoConvergence { residual: residual / whole, evaluations };
                let cell = mesh.grid().offset(index).to_vec();
                return Err(ReconstructionError::Cell { cell, fraction, source });
            }
            let half_space = HalfSpace { normal, constant: position };
            self.cut(&half_space, |piece, volume| give(piece, material, volume));
            let half_space = frame.half_space_in_space(&half_space);
            self.cuts.push(Cut { material, half_space });
            counts.count(&Placed::Plane { half_space, determined, trials, evaluations, closed_form: false });
            self.queue.remove(place);
        }
        self.leave(give);
        let settled = self.queue.is_settled();
        for waiting in self.queue.waiting.iter().filter(|waiting| !settled && waiting.material.is_some()) {
            counts.count(&Placed::<D>::NoNormal(waiting.refused.unwrap_or(NoNormal::Balanced)));
        }
        Ok(counts)
    }

    /// What is cut next; none where nothing that waits has a normal.
    fn choose(
        &mut self,
        shared: &Shared<'_, C, D>,
        frame: &Frame<D>,
        method: Reconstruction,
    ) -> Option<Chosen<D>> {
        if method.normal.reads_centroids() {
            return self.choose_by_centroid();
        }
        let &Shared { mesh, parts, planes, index, cell } = shared;
        loop {
            let Next { place, sought, is_alone } = self.queue.next()?;
            let Waiting { material, ref mut refused, .. } = self.queue.waiting[place];
            // The stencil has the fractions; only the place is taken from the material.
            let around = parts.material(mesh, material.unwrap_or(0));
            let own = material.filter(|_| is_alone).and_then(|k| planes.get(k)?.as_ref()?.direction());
            let found = match own {
                Some(direction) => Ok(direction),
                None => method.normal.normal_among(around, index, cell, sought, method.position),
            };
            match found {
                Ok(found) => {
                    let direction = Direction { normal: frame.normal(&found.normal), ..found };
                    return Some(Chosen { place, direction });
                }
                Err(reason) => *refused = Some(reason),
            }
        }
    }

    /// Cuts another region, in the coordinates of [`Mesh::local_cell`], with the cuts of the last cell: `part` is given
    /// materials and volumes, which add up to the region with void.
    pub fn divide(&mut self, region: RegionOf<C, D>, mut part: impl FnMut(usize, f64)) {
        self.rest.clear();
        self.rest.push((0, region));
        let mut give = |_, material: Option<usize>, volume| {
            if let Some(material) = material {
                part(material, volume);
            }
        };
        for place in 0..self.cuts.len() {
            let Cut { material, half_space } = self.cuts[place];
            self.cut(&half_space, |piece, volume| give(piece, material, volume));
        }
        self.leave(give);
    }

    /// Gives what the cuts left to those that wait.
    fn leave(&self, mut give: impl FnMut(usize, Option<usize>, f64)) {
        for (place, waiting) in self.queue.waiting.iter().enumerate() {
            for (piece, region) in &self.rest {
                give(*piece, waiting.material, region.volume() * self.queue.share(place));
            }
        }
    }

    /// The cuts of the last cell, in order.
    pub fn cuts(&self) -> &[Cut<D>] {
        &self.cuts
    }

    /// What the materials and void of the last cell take, one after the other, of what is left; the last one takes all of it. Void is
    /// none.
    pub(crate) fn shares(&self) -> impl Iterator<Item = (Option<usize>, Share<D>)> {
        let cuts = self.cuts.iter().map(|cut| (cut.material, Share::Below(cut.half_space)));
        let mut left = 1.0;
        let waiting = self.queue.waiting.iter().enumerate().map(move |(place, waiting)| {
            let share = Share::Even(self.queue.share(place) / left);
            left -= self.queue.share(place);
            (waiting.material, if left <= FRACTION_ROUNDING { Share::Rest } else { share })
        });
        cuts.chain(waiting).chain([(None, Share::Rest)])
    }

    /// The material that got all that the cuts left of the last cell, if one did.
    pub fn last(&self) -> Option<usize> {
        if self.queue.is_settled() { self.queue.waiting[0].material } else { None }
    }

    /// The plane constant that leaves `share` of the rest below, with the residual as a volume.
    pub(super) fn position(&self, normal: &Vector<D>, share: f64) -> Root {
        let rest: f64 = self.rest.iter().map(|(_, region)| region.volume()).sum();
        // The smaller part keeps its relative accuracy.
        let (sign, goal) = if share <= 0.5 { (1.0, share * rest) } else { (-1.0, (1.0 - share) * rest) };
        let normal = normal * sign;
        let heights = self.rest.iter().flat_map(|(_, region)| region.corners()).map(|x| normal.dot(x));
        let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)]);
        let spare = RefCell::new(RegionOf::<C, D>::empty());
        let below = |constant: f64| {
            let half_space = HalfSpace { normal, constant };
            let volume = |(_, region): &(usize, RegionOf<C, D>)| {
                volume_below(region, &half_space, &mut spare.borrow_mut())
            };
            self.rest.iter().map(volume).sum::<f64>() - goal
        };
        let tolerance = POSITION_RESIDUAL * goal;
        let mut root = root::brent(below, [low, high], [-goal, rest - goal], tolerance, POSITION_EVALUATIONS);
        root.position *= sign;
        root
    }

    /// Takes what lies in the half-space from the rest, and gives its volumes to `part` by piece.
    fn cut(&mut self, half_space: &HalfSpace<D>, mut part: impl FnMut(usize, f64)) {
        let Self { rest, next, .. } = self;
        next.clear();
        for (piece, region) in rest.drain(..) {
            split(region, half_space, &mut |volume| part(piece, volume), &mut |above| {
                next.push((piece, above))
            });
        }
        std::mem::swap(rest, next);
    }
}

/// Gives the volume in a half-space and what is left of a region; where there is no room for that, of its simplices, which
/// always have it.
fn split<R: Region<D>, const D: usize>(
    region: R,
    half_space: &HalfSpace<D>,
    below: &mut dyn FnMut(f64),
    above: &mut dyn FnMut(R),
) {
    let (mut part, mut rest) = (R::empty(), R::empty());
    match region.split(half_space, &mut part, &mut rest) {
        Ok(Side::Below) => below(region.volume()),
        Ok(Side::Above) => above(region),
        Ok(Side::Across) => {
            below(part.volume());
            above(rest);
        }
        Err(Full) => region.simplices(&mut |simplex| split(simplex.clone(), half_space, below, above)),
    }
}

/// The volume of a region in a half-space.
fn volume_below<R: Region<D>, const D: usize>(region: &R, half_space: &HalfSpace<D>, part: &mut R) -> f64 {
    match region.cut(half_space, part) {
        Ok(Side::Below) => region.volume(),
        Ok(Side::Above) => 0.0,
        Ok(Side::Across) => part.volume(),
        Err(Full) => {
            let mut sum = 0.0;
            region.simplices(&mut |simplex| sum += volume_below(simplex, half_space, part));
            sum
        }
    }
}

/// A cell as a region, its points taken elsewhere.
pub(crate) fn region<C: Cell<D>, const D: usize>(
    cell: &C,
    to: impl Fn(&Vector<D>) -> Vector<D>,
) -> RegionOf<C, D> {
    let mut nodes = [Vector::zeros(); 8];
    let mut middles = [Vector::zeros(); 6];
    let count = cell.nodes().len();
    for (place, x) in nodes.iter_mut().zip(cell.nodes()) {
        *place = to(x);
    }
    for (middle, face) in middles.iter_mut().zip(C::FACE_NODES) {
        *middle = face.iter().map(|&node| nodes[node]).sum::<Vector<D>>() / face.len() as f64;
    }
    RegionOf::<C, D>::fans(&nodes[..count], &middles[..C::FACES])
}
