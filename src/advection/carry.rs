//! Quantities that travel with their material: what its flux carries from cell to cell (Eq. 48-52 of the paper).
//!
//! A cell gets *pieces* of a material: what it keeps, and what comes from other cells or through open ends. Its new value is the mean
//! of the values of the pieces, weighted by their volumes or masses. What leaves one cell enters another, so that totals are
//! conserved; and a mean with positive weights is between its values. Where rounding, or regions that fold over, would take
//! it further, it is limited to their range. That, and what corrected fractions take along, is in the [`Ledger`].
//!
//! **Slopes.** In cells that hold nothing but the material and lie among such, a value may change linearly over the cell. In sweeps the
//! slope along each axis is the smaller of the two differences, or none where these have different signs (MinMod, Eq. 69). For regions
//! that lie anywhere it is the least squares gradient, scaled until all nodes of the cell are within the range of the neighbours. The
//! mean of a piece then is that at its centroid. Quantities conserved with the mass have no slope where the density has one: the mean
//! over a mass would need second moments.

use nalgebra::SMatrix;
use vofkit_geometry::clip::{Region, Tile};
use vofkit_geometry::{Cell, Vector};

use super::ledger::{Ledger, QuantityLedger};
use crate::mesh::Mesh;
use crate::parallel;
use crate::quantity::{Distribution, MaterialQuantity};
use crate::tolerance::NORMAL_EQUATIONS;
use crate::volume_associated::Weighting;

/// A piece of a material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<const D: usize> {
    /// The cell that it comes from; none for what flows in.
    pub(super) donor: Option<usize>,
    /// Negative where a region folds over.
    pub(super) volume: f64,
    /// The integral of position from the middle of the donor: in sweeps in cells along each axis, else in space.
    pub(super) moment: Vector<D>,
}

/// How a value changes over a cell.
#[derive(Clone, Copy, Debug)]
struct Slope<const D: usize> {
    along: Vector<D>,
    /// The largest change from the middle.
    span: f64,
}

impl<const D: usize> Slope<D> {
    fn none() -> Self {
        Self { along: Vector::zeros(), span: 0.0 }
    }
}

/// What slopes are taken along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    /// Mesh lines.
    Lines,
    /// Directions in space.
    Space,
}

/// Carries quantities; keeps its memory.
#[derive(Clone, Debug)]
pub(super) struct Carry<const D: usize> {
    /// The values at the start of the step.
    start: Vec<Vec<Vec<f64>>>,
    /// The volume of each material in each cell, by what was carried since the start of the step.
    held: Vec<Vec<f64>>,
    /// The place of the first component of each quantity among all.
    first: Vec<usize>,
    /// By component, then by cell; none for those that are constant over cells.
    slopes: Vec<Vec<Slope<D>>>,
    /// The middles of the cells, from their first nodes.
    middles: Vec<Vector<D>>,
    /// By target: the values of all quantities; what limiting moved, by quantity; what left, by quantity; volumes by material.
    results: Vec<f64>,
}

/// A mean of values in the making.
#[derive(Clone, Copy, Debug)]
struct Blend {
    amount: f64,
    weight: f64,
    /// The least and the largest value that was added.
    range: [f64; 2],
    /// The same of what is owed: of values with negative weights.
    owed: [f64; 2],
}

impl Blend {
    fn nothing() -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        Self { amount: 0.0, weight: 0.0, range: none, owed: none }
    }

    fn add(&mut self, weight: f64, value: f64) {
        self.amount += weight * value;
        self.weight += weight;
        let [low, high] = if weight > 0.0 { &mut self.range } else { &mut self.owed };
        *low = low.min(value);
        *high = high.max(value);
    }

    /// The mean, and what limiting it moves. A cell that only owes keeps its value, which what comes in later in the step may need.
    fn mean(&self) -> (f64, f64) {
        let owes = self.range[0] > self.range[1];
        let [low, high] = if owes { self.owed } else { self.range };
        if low > high {
            return (0.0, self.amount.abs());
        }
        let has_mean = if owes { self.weight < 0.0 } else { self.weight > 0.0 };
        let mean = if has_mean { self.amount / self.weight } else { 0.5 * (low + high) };
        let value = mean.clamp(low, high);
        // The quotient alone moves nothing.
        (value, if value == mean && has_mean { 0.0 } else { (value * self.weight - self.amount).abs() })
    }
}

/// Quantities before a pass.
struct Before<'a, const D: usize> {
    quantities: &'a [MaterialQuantity],
    slopes: &'a [Vec<Slope<D>>],
    first: &'a [usize],
}

impl<const D: usize> Before<'_, D> {
    fn slope(&self, quantity: usize, component: usize, cell: usize) -> Slope<D> {
        let slopes = &self.slopes[self.first[quantity] + component];
        slopes.get(cell).copied().unwrap_or_else(Slope::none)
    }

    /// The mean over a piece, conserved with the volume.
    fn value(&self, quantity: usize, component: usize, piece: &Piece<D>) -> f64 {
        let of = &self.quantities[quantity];
        let Some(donor) = piece.donor else {
            // Checked: there are inflow values where material flows in.
            return of.inflow.as_ref().map_or(0.0, |inflow| inflow[component]);
        };
        let slope = self.slope(quantity, component, donor);
        let change = if slope.span > 0.0 { slope.along.dot(&piece.moment) / piece.volume } else { 0.0 };
        of.values[component][donor] + change.clamp(-slope.span, slope.span)
    }

    /// The weight of a piece.
    fn weight(&self, quantity: usize, piece: &Piece<D>) -> f64 {
        match self.quantities[quantity].weighting {
            Weighting::Volume => piece.volume,
            Weighting::Mass(density) => piece.volume * self.value(density, 0, piece),
        }
    }
}

/// What a pass gives to cells. What cells hold before it is given by material and cell.
pub(super) trait Pieces<const D: usize>: Sync {
    /// The pieces of a material that the cell at a place gets.
    fn arriving(&self, held: &[Vec<f64>], place: usize, material: usize, visit: &mut dyn FnMut(Piece<D>));

    /// The pieces of a material that cross open ends there; their volumes are negative where they come in.
    fn leaving(&self, held: &[Vec<f64>], place: usize, material: usize, visit: &mut dyn FnMut(Piece<D>));
}

/// What a step moves.
pub(super) struct Cargo<'a> {
    pub(super) fractions: &'a mut [Vec<f64>],
    pub(super) quantities: &'a mut [MaterialQuantity],
}

/// The places of all quantities, those that others are conserved with first.
fn in_order(quantities: &[MaterialQuantity]) -> impl Iterator<Item = usize> {
    let is_first = |k: &usize| quantities[*k].weighting == Weighting::Volume;
    let first = (0..quantities.len()).filter(is_first);
    first.chain((0..quantities.len()).filter(move |k| !is_first(k)))
}

/// Whether there are quantities of each of so many materials.
pub(super) fn carried(quantities: &[MaterialQuantity], materials: usize) -> Vec<bool> {
    (0..materials).map(|k| quantities.iter().any(|quantity| quantity.material == k)).collect()
}

impl<const D: usize> Carry<D> {
    pub(super) fn new() -> Self {
        Self {
            start: Vec::new(),
            held: Vec::new(),
            first: Vec::new(),
            slopes: Vec::new(),
            middles: Vec::new(),
            results: Vec::new(),
        }
    }

    /// Starts a step in some cells.
    pub(super) fn begin(
        &mut self,
        quantities: &[MaterialQuantity],
        fractions: &[Vec<f64>],
        volumes: &[f64],
        cells: impl Iterator<Item = usize>,
    ) {
        if quantities.is_empty() {
            return;
        }
        self.start.resize_with(quantities.len(), Vec::new);
        for (start, quantity) in self.start.iter_mut().zip(quantities) {
            start.clone_from(&quantity.values);
        }
        self.first.clear();
        let mut components = 0;
        for quantity in quantities {
            self.first.push(components);
            components += quantity.values.len();
        }
        self.slopes.resize_with(components, Vec::new);
        self.held.resize_with(fractions.len(), Vec::new);
        for held in &mut self.held {
            held.resize(volumes.len(), 0.0);
        }
        for cell in cells {
            for (held, f) in self.held.iter_mut().zip(fractions) {
                held[cell] = f[cell] * volumes[cell];
            }
        }
    }

    /// Makes room for a number of targets that is not that of the sources.
    pub(super) fn resize(&mut self, cells: usize) {
        self.held.iter_mut().for_each(|held| held.resize(cells, 0.0));
    }

    /// Puts the values back to those at the start of the step.
    pub(super) fn restore(&mut self, quantities: &mut [MaterialQuantity]) {
        for (quantity, start) in quantities.iter_mut().zip(&mut self.start) {
            std::mem::swap(&mut quantity.values, start);
        }
    }

    /// Whether two cells have the same constant values of all quantities of a material.
    pub(super) fn alike(&self, quantities: &[MaterialQuantity], material: usize, [a, b]: [usize; 2]) -> bool {
        let flat =
            |slopes: &Vec<Slope<D>>| [a, b].iter().all(|&i| slopes.get(i).is_none_or(|s| s.span == 0.0));
        quantities.iter().zip(&self.first).filter(|(quantity, _)| quantity.material == material).all(
            |(quantity, &first)| {
                quantity.values.iter().all(|values| values[a] == values[b])
                    && self.slopes[first..first + quantity.values.len()].iter().all(flat)
            },
        )
    }

    /// The middle of a cell from its first node; none where no quantity has slopes.
    pub(super) fn middle(&self, cell: usize) -> Option<&Vector<D>> {
        self.middles.get(cell)
    }

    /// Finds the slopes in some cells, from the values and the fractions as they are.
    pub(super) fn find_slopes<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        quantities: &[MaterialQuantity],
        cells: &[u32],
        along: Along,
    ) {
        let Self { first, slopes, middles, .. } = self;
        let is_linear = |quantity: &MaterialQuantity| quantity.distribution == Distribution::Linear;
        if along == Along::Space && middles.is_empty() && quantities.iter().any(is_linear) {
            *middles = parallel::map(mesh.grid().len(), |cell| {
                let moments = C::Tile::region(&mesh.local_cell(cell)).moments();
                moments.first / moments.volume
            });
        }
        for k in in_order(quantities) {
            let quantity = &quantities[k];
            for (component, values) in quantity.values.iter().enumerate() {
                let mut found = std::mem::take(&mut slopes[first[k] + component]);
                if is_linear(quantity) {
                    found.resize(mesh.grid().len(), Slope::none());
                    let of_density = match quantity.weighting {
                        Weighting::Volume => None,
                        Weighting::Mass(density) => Some(&slopes[first[density]]),
                    };
                    let new = parallel::map(cells.len(), |i| {
                        let cell = cells[i] as usize;
                        if of_density
                            .and_then(|slopes| slopes.get(cell))
                            .is_some_and(|slope| slope.span > 0.0)
                        {
                            return Slope::none();
                        }
                        let around = Around { mesh, f: &fractions[quantity.material], values, middles };
                        match along {
                            Along::Lines => around.along_lines(cell),
                            Along::Space => around.in_space(cell),
                        }
                    });
                    for (&cell, slope) in cells.iter().zip(new) {
                        found[cell as usize] = slope;
                    }
                } else {
                    found.clear();
                }
                slopes[first[k] + component] = found;
            }
        }
    }

    /// Does one pass: the quantities in `cells` of `to` become those of the pieces that they get of `from`, or of what `to` itself was.
    pub(super) fn pass(
        &mut self,
        cells: &[u32],
        pieces: &(impl Pieces<D> + ?Sized),
        from: Option<&[MaterialQuantity]>,
        to: &mut [MaterialQuantity],
        ledger: &mut Ledger,
    ) {
        let Self { held, first, slopes, results, .. } = self;
        let before = Before { quantities: from.unwrap_or(&*to), slopes, first };
        let (values, count) = (slopes.len(), first.len());
        let width = values + 2 * count + held.len();
        let carried = carried(before.quantities, held.len());
        results.clear();
        results.resize(cells.len() * width, 0.0);
        parallel::for_each_chunk(results, width, |place, result| {
            let (means, rest) = result.split_at_mut(values);
            let (limited, rest) = rest.split_at_mut(count);
            let (left, volumes) = rest.split_at_mut(count);
            for (material, volume) in volumes.iter_mut().enumerate().filter(|(k, _)| carried[*k]) {
                pieces.arriving(held, place, material, &mut |piece| *volume += piece.volume);
            }
            for k in in_order(before.quantities) {
                let quantity = &before.quantities[k];
                for component in 0..quantity.values.len() {
                    let mut blend = Blend::nothing();
                    pieces.arriving(held, place, quantity.material, &mut |piece| {
                        blend.add(before.weight(k, &piece), before.value(k, component, &piece));
                    });
                    let (mean, moved) = blend.mean();
                    means[before.first[k] + component] = mean;
                    limited[k] += moved;
                    if let Weighting::Mass(density) = quantity.weighting {
                        // What limiting the density took along.
                        let mass = means[before.first[density]] * volumes[quantity.material];
                        limited[k] += (mean * (mass - blend.weight)).abs();
                    }
                    pieces.leaving(held, place, quantity.material, &mut |piece| {
                        left[k] += before.weight(k, &piece) * before.value(k, component, &piece);
                    });
                }
            }
        });
        ledger.quantities.resize_with(count, QuantityLedger::default);
        for (&cell, result) in cells.iter().zip(results.chunks_exact(width)) {
            let cell = cell as usize;
            for (k, quantity) in to.iter_mut().enumerate() {
                for (component, values) in quantity.values.iter_mut().enumerate() {
                    values[cell] = result[first[k] + component];
                }
                ledger.quantities[k].limited += result[values + k];
                ledger.quantities[k].outflow += result[values + count + k];
            }
            for (held, volume) in held.iter_mut().zip(&result[values + 2 * count..]) {
                held[cell] = *volume;
            }
        }
    }

    /// Ends a step: what corrections of the fractions took along or brought is entered, and cells without material get 0.
    pub(super) fn finish(
        &self,
        cells: &[u32],
        volume: impl Fn(usize) -> f64,
        fractions: &[Vec<f64>],
        quantities: &mut [MaterialQuantity],
        ledger: &mut Ledger,
    ) {
        ledger.quantities.resize_with(quantities.len(), QuantityLedger::default);
        for k in 0..quantities.len() {
            let material = quantities[k].material;
            for (place, &cell) in cells.iter().enumerate() {
                let cell = cell as usize;
                let weight = match quantities[k].weighting {
                    Weighting::Volume => 1.0,
                    Weighting::Mass(density) => quantities[density].values[0][cell],
                };
                let f = fractions[material][cell];
                let change = weight * (f * volume(place) - self.held[material][cell]);
                for values in &quantities[k].values {
                    ledger.quantities[k].limited += (change * values[cell]).abs();
                }
            }
        }
        // Only now: densities weigh what others lose in cells that empty.
        for MaterialQuantity { material, values, .. } in quantities {
            for values in values {
                for (value, f) in values.iter_mut().zip(&fractions[*material]) {
                    if *f == 0.0 {
                        *value = 0.0;
                    }
                }
            }
        }
    }
}

/// The values of a component around a cell.
struct Around<'a, C, const D: usize> {
    mesh: &'a Mesh<C, D>,
    f: &'a [f64],
    values: &'a [f64],
    middles: &'a [Vector<D>],
}

impl<C: Cell<D>, const D: usize> Around<'_, C, D> {
    /// The neighbours across all faces where they and the cell hold nothing else.
    fn neighbours(&self, cell: usize) -> Option<[Option<usize>; 6]> {
        if self.f[cell] < 1.0 {
            return None;
        }
        let mut neighbours = [None; 6];
        for (face, next) in neighbours[..2 * D].iter_mut().enumerate() {
            *next = self.mesh.grid().neighbour(cell, face / 2, face % 2);
            if next.is_some_and(|next| self.f[next] < 1.0) {
                return None;
            }
        }
        Some(neighbours)
    }

    /// The change over the cell along each axis.
    fn along_lines(&self, cell: usize) -> Slope<D> {
        let Some(neighbours) = self.neighbours(cell) else { return Slope::none() };
        let here = self.values[cell];
        let along = Vector::from_fn(|axis, _| {
            let (Some(below), Some(above)) = (neighbours[2 * axis], neighbours[2 * axis + 1]) else {
                return 0.0;
            };
            let (backward, forward) = (here - self.values[below], self.values[above] - here);
            if backward * forward > 0.0 { backward.abs().min(forward.abs()).copysign(forward) } else { 0.0 }
        });
        Slope { along, span: 0.5 * along.amax() }
    }

    /// The gradient.
    fn in_space(&self, cell: usize) -> Slope<D> {
        let Some(neighbours) = self.neighbours(cell) else { return Slope::none() };
        let here = self.values[cell];
        let (mut low, mut high) = (here, here);
        let mut matrix = SMatrix::<f64, D, D>::zeros();
        let mut right = Vector::<D>::zeros();
        for (face, next) in neighbours.iter().enumerate() {
            let Some(next) = *next else { continue };
            let difference = self.values[next] - here;
            low = low.min(self.values[next]);
            high = high.max(self.values[next]);
            let mut way =
                self.mesh.anchor(next) + self.middles[next] - self.mesh.anchor(cell) - self.middles[cell];
            way -= self.across_ends(cell, face, next);
            let weight = way.norm_squared().recip();
            matrix += way * way.transpose() * weight;
            right += way * (weight * difference);
        }
        if low == high {
            return Slope::none();
        }
        // Where the mesh is one cell wide nothing is known of the slope across it: it becomes zero.
        let trace = matrix.trace();
        matrix += SMatrix::identity() * (NORMAL_EQUATIONS * trace);
        let Some(inverse) = matrix.try_inverse() else { return Slope::none() };
        let gradient = inverse * right;
        let (mut span, mut scale) = (0.0_f64, 1.0_f64);
        for node in self.mesh.local_cell(cell).nodes() {
            let change = gradient.dot(&(node - self.middles[cell]));
            span = span.max(change.abs());
            let room = if change > 0.0 { high - here } else { here - low };
            if change.abs() > room {
                scale = scale.min(room / change.abs());
            }
        }
        Slope { along: gradient * scale, span: span * scale }
    }

    /// From one image of the mesh to the next, where the face of a cell is at a joined end.
    fn across_ends(&self, cell: usize, face: usize, next: usize) -> Vector<D> {
        let (grid, axis) = (self.mesh.grid(), face / 2);
        let [here, there] = [cell, next].map(|cell| grid.offset(cell)[axis]);
        let wraps = if face % 2 == 1 { there <= here } else { there >= here };
        if !wraps {
            return Vector::zeros();
        }
        let (mut far, near) = ([0; D], [0; D]);
        far[axis] = grid.cells()[axis];
        let period = self.mesh.nodes()[grid.node_index(far)] - self.mesh.nodes()[grid.node_index(near)];
        if face % 2 == 1 { -period } else { period }
    }
}
