//! What interfaces and their advection cost on one thread: all planes of a sphere on a distorted mesh, and one step of each scheme, by mixed
//! cell. `cargo bench --bench step`; `RAYON_NUM_THREADS` is set to 1 unless it is given.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use vofkit::advection::Scheme;
use vofkit::interface::{is_mixed, planes};
use vofkit::normal::Material;
use vofkit::prelude::*;

const METHODS: [NormalMethod; 5] = [
    NormalMethod::Youngs,
    NormalMethod::LeastSquares,
    NormalMethod::Myc,
    NormalMethod::Swartz,
    NormalMethod::Lvira,
];

const SCHEMES: [Scheme; 2] = [Scheme::Sweeps, Scheme::Unsplit];

fn mixed(fractions: &[f64]) -> Vec<usize> {
    (0..fractions.len()).filter(|&i| is_mixed(fractions[i])).collect()
}

fn group<'a>(criterion: &'a mut Criterion, name: &str, mixed: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .throughput(Throughput::Elements(mixed as u64))
        .sample_size(10)
        .measurement_time(Duration::from_secs(2));
    group
}

fn reconstruction<C: Cell<D>, const D: usize>(criterion: &mut Criterion, name: &str, cells: [usize; D]) {
    let mesh =
        Mesh::<C, D>::unit(cells, &Distortion::Random { amplitude: 0.2, seed: 1 }).expect("a valid mesh");
    let sphere = Shape::Sphere { centre: Vector::repeat(0.5), radius: 0.32 };
    let fractions = volume_fractions(&mesh, &[sphere]).swap_remove(0);
    let cells = mixed(&fractions);
    let material = Material { mesh: &mesh, fractions: &fractions, centroids: None };
    let mut group = group(criterion, name, cells.len());
    for normal in METHODS {
        let method = Reconstruction { normal, ..Reconstruction::default() };
        group.bench_function(format!("{normal:?}"), |bencher| {
            bencher.iter(|| black_box(planes(material, &cells, method)).expect("planes"));
        });
    }
}

fn step<C: Cell<D>, const D: usize>(
    criterion: &mut Criterion,
    name: &str,
    cells: [usize; D],
    field: Field,
    centre: Vector<D>,
) {
    for amplitude in [0.0, 0.2] {
        let mesh =
            Mesh::<C, D>::unit(cells, &Distortion::Random { amplitude, seed: 1 }).expect("a valid mesh");
        let fractions = volume_fractions(&mesh, &[Shape::Sphere { centre, radius: 0.15 }]);
        let mut group = group(criterion, &format!("{name}, random {amplitude}"), mixed(&fractions[0]).len());
        for scheme in SCHEMES {
            let velocity = Velocity { field, reversal: Reversal::None };
            let reconstruction = Reconstruction { normal: NormalMethod::Youngs, ..Reconstruction::default() };
            let settings = Settings { scheme, reconstruction, ..Settings::default() };
            group.bench_function(format!("{scheme:?}"), |bencher| {
                let mut transport = Transport::new(&mesh, velocity, settings).expect("a transport");
                let dt = 0.5 / transport.courant_rate();
                bencher.iter_batched_ref(
                    || fractions.clone(),
                    |fractions| transport.step(fractions, 0, 0.0, dt).expect("a step"),
                    criterion::BatchSize::LargeInput,
                );
            });
        }
    }
}

fn all(criterion: &mut Criterion) {
    reconstruction::<Quad, 2>(criterion, "planes in 2D", [128; 2]);
    reconstruction::<Hexahedron, 3>(criterion, "planes in 3D", [48; 3]);
    step::<Quad, 2>(criterion, "step in 2D", [128; 2], Field::ReversedVortex, Vector::<2>::new(0.5, 0.75));
    step::<Hexahedron, 3>(criterion, "step in 3D", [48; 3], Field::Deformation3d, Vector::<3>::repeat(0.35));
}

criterion_group!(benches, all);
criterion_main!(benches);
