//! How far the facets of a sphere (2D: circle) are from it, cell by cell.

use vofkit_geometry::{Cell, Vector};

use crate::facet::Facet;
use crate::mesh::Mesh;
use crate::parallel;
use crate::space::spatial;

/// The mean over the facets of the Hausdorff distance between a facet and the part of the sphere in its cell: the largest distance of a
/// point of one of them from the other. None without facets.
///
/// In 3D the rim of either part is represented by its corners, on the edges of the cell.
pub fn hausdorff_mean<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    facets: &[Facet<D>],
    centre: &Vector<D>,
    radius: f64,
) -> Option<f64> {
    let sphere = Sphere { centre: *centre, radius };
    let sum = parallel::sum(facets.len(), |i| distance(&mesh.cell(facets[i].cell), &facets[i], &sphere));
    (!facets.is_empty()).then(|| sum / facets.len() as f64)
}

/// Times that a point is put into the cell and onto the sphere: both are nearly across each other.
const PROJECTIONS: usize = 4;

/// Steps towards local coordinates, each of which leaves the share of the cell's twists of an error.
const INVERSE_STEPS: usize = 12;

struct Sphere<const D: usize> {
    centre: Vector<D>,
    radius: f64,
}

impl<const D: usize> Sphere<D> {
    /// The point of the sphere next to `x`.
    fn onto(&self, x: &Vector<D>) -> Vector<D> {
        self.centre + (x - self.centre) * (self.radius / (x - self.centre).norm())
    }

    /// The point of the sphere's part in a cell that is next to `x`, by turns put into the cell and onto the sphere.
    fn part<C: Cell<D>>(&self, cell: &C, inverse: &Inverse<D>, x: &Vector<D>) -> Vector<D> {
        (0..PROJECTIONS).fold(self.onto(x), |y, _| {
            self.onto(&cell.map(&inverse.local(cell, &y).map(|t| t.clamp(0.0, 1.0))))
        })
    }

    /// The places between `a` and `b` where the sphere crosses.
    fn crossings(&self, a: &Vector<D>, b: &Vector<D>) -> impl Iterator<Item = Vector<D>> {
        let (start, along) = (a - self.centre, b - a);
        let (square, half) = (along.norm_squared(), start.dot(&along));
        let root = half * half - square * (start.norm_squared() - self.radius * self.radius);
        let (a, root) = (*a, root.sqrt());
        let places = [-root, root].map(|root| (root - half) / square);
        // Not a number where there is no crossing.
        places.into_iter().filter(|t| (0.0..=1.0).contains(t)).map(move |t| a + along * t)
    }
}

fn distance<C: Cell<D>, const D: usize>(cell: &C, facet: &Facet<D>, sphere: &Sphere<D>) -> f64 {
    let nodes = cell.nodes();
    let pairs = (0..nodes.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    let edges = pairs.filter(|&[i, j]| (0..D).filter(|&k| C::OFFSETS[i][k] != C::OFFSETS[j][k]).count() == 1);
    let rim: Vec<Vector<D>> = edges.flat_map(|[i, j]| sphere.crossings(&nodes[i], &nodes[j])).collect();
    let mut largest = rim.iter().map(|y| from_facet(facet, y)).fold(0.0, f64::max);
    // The top of the sphere over the plane, and the middle of the facet under it.
    let depth = facet.plane_constant - facet.normal.dot(&sphere.centre);
    if aside(facet, &(sphere.centre + facet.normal * depth)) == 0.0 {
        largest = largest.max((sphere.radius - depth).abs());
    }
    let inverse = Inverse::new(cell);
    let from_sphere = |x: &Vector<D>| {
        let nearest = sphere.onto(x);
        let local = inverse.local(cell, &nearest);
        if local.iter().all(|t| (0.0..=1.0).contains(t)) {
            (x - nearest).norm()
        } else if D == 2 {
            rim.iter().map(|y| (x - y).norm()).fold(f64::INFINITY, f64::min)
        } else {
            (x - sphere.part(cell, &inverse, x)).norm()
        }
    };
    let largest = facet.loops.iter().flatten().map(from_sphere).fold(largest, f64::max);
    // A part of the sphere that no edge meets has no rim.
    if largest.is_finite() { largest } else { 0.0 }
}

/// Finds local coordinates in a cell.
struct Inverse<const D: usize> {
    /// The rows of `J^-1`, with the mean edges as columns of `J`.
    rows: [Vector<D>; D],
}

impl<const D: usize> Inverse<D> {
    fn new<C: Cell<D>>(cell: &C) -> Self {
        let unit = |axis: usize| Vector::from_fn(|k, _| f64::from(u8::from(k == axis)));
        Self { rows: std::array::from_fn(|axis| cell.physical_gradient(&unit(axis))) }
    }

    /// The local coordinates of a point.
    fn local<C: Cell<D>>(&self, cell: &C, x: &Vector<D>) -> Vector<D> {
        let mut local = Vector::repeat(0.5);
        for _ in 0..INVERSE_STEPS {
            let off = x - cell.map(&local);
            local += Vector::from_fn(|axis, _| self.rows[axis].dot(&off));
        }
        local
    }
}

/// The distance of a point from a facet.
fn from_facet<const D: usize>(facet: &Facet<D>, y: &Vector<D>) -> f64 {
    let height = facet.normal.dot(y) - facet.plane_constant;
    height.hypot(aside(facet, &(y - facet.normal * height)))
}

/// The distance of a point of the facet's plane from the facet; zero inside.
fn aside<const D: usize>(facet: &Facet<D>, foot: &Vector<D>) -> f64 {
    let of_loop = |points: &Vec<Vector<D>>| {
        let sides = (0..points.len()).map(|i| [points[i], points[(i + 1) % points.len()]]);
        if D == 3 && sides.clone().all(|[a, b]| is_left(&facet.normal, &(b - a), &(foot - a))) {
            return 0.0;
        }
        let from_side = sides.map(|[a, b]| {
            let along = b - a;
            let t = along.dot(&(foot - a)) / along.norm_squared();
            let nearest = t.clamp(0.0, 1.0);
            // A facet in 2D is the side itself.
            if D == 2 { (t - nearest).abs() * along.norm() } else { (a + along * nearest - foot).norm() }
        });
        from_side.fold(f64::INFINITY, f64::min)
    };
    facet.loops.iter().map(of_loop).fold(f64::INFINITY, f64::min)
}

/// Whether `b` turns counter-clockwise from `a`, seen against the normal.
fn is_left<const D: usize>(normal: &Vector<D>, a: &Vector<D>, b: &Vector<D>) -> bool {
    spatial(a).cross(&spatial(b)).dot(&spatial(normal)) >= 0.0
}
