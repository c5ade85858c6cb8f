//! What the kernel costs: preparing a cell, cutting it, and finding the plane for a part of it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use vofkit_geometry::submesh::{self, Triangulation};
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, TruncationMethod, Vector, Wanted};

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Random, corner};

/// Inputs of a benchmark, all used in one pass, so that no branch predictor learns one of them: microseconds for a pass are nanoseconds
/// for a call.
const SAMPLES: usize = 1000;

/// A cell, a unit normal, a fraction in [0.001, 0.999], and the half-space that holds about this part.
struct Sample<const D: usize, C> {
    cell: C,
    normal: Vector<D>,
    fraction: f64,
    half_space: HalfSpace<D>,
}

fn samples<const D: usize, C: Cell<D>>(cell: impl Fn(&mut Random) -> C) -> Vec<Sample<D, C>> {
    let mut random = Random(1);
    let sample = || {
        let (cell, normal) = (cell(&mut random), random.unit());
        let fraction = random.within(0.001, 0.999);
        let position = cell.plane_constant(&normal, fraction, PositionMethod::Auto);
        let constant = position.expect("a valid cell").constant;
        Sample { cell, normal, fraction, half_space: HalfSpace { normal, constant } }
    };
    std::iter::repeat_with(sample).take(SAMPLES).collect()
}

fn each<const D: usize, C: Cell<D>, T>(
    criterion: &mut Criterion,
    name: &str,
    samples: &[Sample<D, C>],
    call: impl Fn(&Sample<D, C>) -> T,
) {
    criterion.bench_function(name, |bench| {
        bench.iter(|| {
            for sample in samples {
                black_box(&call(black_box(sample)));
            }
        });
    });
}

fn cuts<const D: usize, C: Cell<D>>(
    criterion: &mut Criterion,
    name: &str,
    make: impl Fn(&mut Random) -> C,
    methods: &[PositionMethod],
) {
    let samples = samples(make);
    each(criterion, &format!("{name}/truncate"), &samples, |s| s.cell.truncate(&s.half_space));
    for &method in methods {
        let name = format!("{name}/plane_constant {method:?}");
        each(criterion, &name, &samples, |s| s.cell.plane_constant(&s.normal, s.fraction, method));
    }
}

/// All samples in one call.
fn batch(criterion: &mut Criterion, samples: &[Sample<3, Hexahedron>]) {
    let wanted: Vec<_> = samples
        .iter()
        .map(|&Sample { cell, normal, fraction, .. }| Wanted { cell, normal, fraction })
        .collect();
    criterion.bench_function("ruled/plane_constants", |bench| {
        bench.iter(|| {
            let mut sum = 0.0;
            Hexahedron::plane_constants(black_box(&wanted), PositionMethod::Auto, |_, found| {
                sum += found.map_or(0.0, |found| found.constant);
            });
            sum
        });
    });
}

/// A matrix near the identity, for parallelograms and parallelepipeds.
fn near_identity<const D: usize>(random: &mut Random) -> nalgebra::SMatrix<f64, D, D> {
    nalgebra::SMatrix::identity() + nalgebra::SMatrix::from_fn(|_, _| random.within(-0.15, 0.15))
}

fn kernel(criterion: &mut Criterion) {
    use PositionMethod::{Auto, Brent, Newton};
    use TruncationMethod::{Kothe, Submesh2, Submesh4};
    let ruled = |random: &mut Random| random.cell::<3, Hexahedron>(0.15);
    let built = samples(ruled);
    each(criterion, "ruled/new", &built, |s| Hexahedron::new(std::array::from_fn(|i| s.cell.nodes()[i])));
    each(criterion, "ruled/defects", &built, |s| s.cell.defects());
    each(criterion, "ruled/section", &built, |s| s.cell.section(&s.half_space));
    each(criterion, "ruled/moment", &built, |s| s.cell.first_moment(&s.half_space));
    each(criterion, "ruled/section_centroid", &built, |s| s.cell.section_centroid(&s.half_space));
    for (name, method) in [("kothe", Kothe), ("submesh2", Submesh2), ("submesh4", Submesh4)] {
        let name = format!("ruled/truncate {name}");
        each(criterion, &name, &built, |s| method.truncate(&s.cell, &s.half_space));
    }
    each(criterion, "ruled/plane_constant submesh4", &built, |s| {
        submesh::plane_constant(&s.cell, &s.normal, s.fraction, Triangulation::FourPerFace)
    });
    cuts(criterion, "box", |_| Hexahedron::from_corners(corner), &[Auto]);
    let parallelepiped = |random: &mut Random| {
        let shape = near_identity::<3>(random);
        Hexahedron::from_corners(|offset| shape * corner(offset))
    };
    cuts(criterion, "parallelepiped", parallelepiped, &[Auto]);
    cuts(criterion, "ruled", ruled, &[Newton, Brent]);
    batch(criterion, &samples(ruled));
    // A rotated sliver, which compensated arithmetic is for.
    let rotation = nalgebra::Rotation3::from_euler_angles(0.3, 0.7, 1.1);
    let sliver = |random: &mut Random| {
        let cell = ruled(random);
        Hexahedron::new(std::array::from_fn(|i| {
            rotation * cell.nodes()[i].component_mul(&Vector::<3>::new(1.0, 1.0, 1e-6))
        }))
    };
    let built = samples(sliver);
    each(criterion, "rotated sliver/new", &built, |s| {
        Hexahedron::new(std::array::from_fn(|i| s.cell.nodes()[i]))
    });
    cuts(criterion, "rotated sliver", sliver, &[Newton]);
    let quad = |random: &mut Random| random.cell::<2, Quad>(0.15);
    let built = samples(quad);
    each(criterion, "quad/new", &built, |s| Quad::new(std::array::from_fn(|i| s.cell.nodes()[i])));
    cuts(criterion, "quad", quad, &[Auto, Newton, Brent]);
}

criterion_group!(benches, kernel);
criterion_main!(benches);
