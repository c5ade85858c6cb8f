//! Cells and planes of every category of the exact tables (`geometry/tests/truncation.csv` and `rotated.csv`), drawn at random and
//! compared with the [`oracle`](super::oracle).

use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Vector};

use super::Family;
use super::case::{Given, Input, Random, Row, Verdict};
use super::cells::{at_share, box_volume, collapsed, cube, is_valid, parallelepiped, ruled, swept};
use super::oracle::{self, Exact};

/// Errors of volumes, relative to the cell.
const VOLUME: f64 = 2e-15;
/// Errors of volumes where terms cancel, relative to the box around the cell.
const SIGNED: f64 = 1e-14;
/// Errors of section areas, relative to the larger one of themselves and a face of a cube of the same volume.
const AREA: f64 = 1e-14;
/// The same where the plane nearly touches an edge or a saddle, and the area changes like a logarithm.
const TOUCHING: f64 = 1e-12;
/// The volume of a collapsed cell, relative to the box around it, below which it may be nothing but rounding.
const COLLAPSED: f64 = 1e-9;
/// How thin slivers and needles are, relative to their length.
const THIN: [f64; 2] = [1e-3, 1e-6];

pub(super) const FAMILIES: &[Family] = &[
    valid("exact/cube", |random| cut(random, cube())),
    valid("exact/box", |random| {
        let lengths = Vector::<3>::from_fn(|_, _| 10.0_f64.powf(random.within(-1.0, 1.0)));
        let shift = random.vector(10.0);
        cut(random, cube().map(|x| x.component_mul(&lengths) + shift))
    }),
    valid("exact/parallelepiped", |random| {
        let nodes = parallelepiped(random);
        cut(random, nodes)
    }),
    valid("exact/ruled", |random| {
        let nodes = ruled(random, 0.15);
        cut(random, nodes)
    }),
    valid("exact/ruled_strong", |random| {
        let nodes = sound(random, |random| ruled(random, 0.35));
        cut(random, nodes)
    }),
    valid("exact/twisted", |random| {
        let nodes = sound(random, |random| {
            let mut nodes = ruled(random, 0.02);
            let (sin, cos) = random.within(-1.2, 1.2).sin_cos();
            for x in &mut nodes[4..] {
                let (u, v) = (x[0] - 0.5, x[1] - 0.5);
                (x[0], x[1]) = (0.5 + cos * u - sin * v, 0.5 + sin * u + cos * v);
            }
            nodes
        });
        cut(random, nodes)
    }),
    valid("exact/collapsed", |random| {
        loop {
            let nodes = sound(random, |random| {
                let nodes = ruled(random, 0.1);
                collapsed(random, nodes)
            });
            let cell = Hexahedron::new(nodes);
            if cell.volume() > COLLAPSED * box_volume(&cell) {
                return cut(random, nodes);
            }
        }
    }),
    valid("exact/sliver", |random| {
        let (thin, axis) = (random.one_of(&THIN), random.below(3));
        let nodes = ruled(random, 0.15).map(|x| scaled(x, thin, |k| k == axis));
        cut(random, nodes)
    }),
    valid("exact/needle", |random| {
        let (thin, axis) = (random.one_of(&THIN), random.below(3));
        let nodes = ruled(random, 0.15).map(|x| scaled(x, thin, |k| k != axis));
        cut(random, nodes)
    }),
    valid("exact/rotated_thin", |random| {
        let (thin, axis, is_sliver) =
            (random.one_of(&[1e-1, 1e-3, 1e-6]), random.below(3), random.below(2) == 0);
        let (about, angle) = (nalgebra::Unit::new_normalize(random.unit()), random.within(0.0, 3.0));
        let rotation = nalgebra::Rotation3::from_axis_angle(&about, angle);
        let shift = random.vector(1.0) * random.below(2) as f64;
        let thin = |x: Vector<3>| rotation * scaled(x, thin, |k| (k == axis) == is_sliver) + shift;
        let nodes = sound(random, |random| ruled(random, 0.15).map(thin));
        cut(random, nodes)
    }),
    valid("exact/tiny", |random| {
        let nodes = ruled(random, 0.15).map(|x| x * 1e-9);
        cut(random, nodes)
    }),
    valid("exact/huge", |random| {
        let nodes = ruled(random, 0.15).map(|x| x * 1e9);
        cut(random, nodes)
    }),
    valid("exact/offset", |random| {
        let shift = random.vector(1e6);
        let nodes = ruled(random, 0.15).map(|x| x + shift);
        cut(random, nodes)
    }),
    valid("exact/almost_empty", |random| {
        let fraction = 10.0_f64.powf(random.within(-15.0, -3.0));
        filled(random, fraction)
    }),
    valid("exact/almost_full", |random| {
        let fraction = 1.0 - 10.0_f64.powf(random.within(-15.0, -3.0));
        filled(random, fraction)
    }),
    valid("exact/beside", |random| {
        let nodes = ruled(random, 0.15);
        let share = random.one_of(&[-1.0, 1.0]) * random.within(0.6, 1.5) + 0.5;
        let normal = random.unit();
        at(nodes, normal, share)
    }),
    valid("exact/through_vertex", |random| {
        let (nodes, normal, node) = (ruled(random, 0.15), random.unit(), random.below(8));
        through(nodes, normal, nodes[node])
    }),
    valid("exact/parallel_to_edge", |random| {
        let nodes = ruled(random, 0.15);
        let normal = across(random, nodes[1] - nodes[0]);
        let share = random.within(0.0, 1.0);
        at(nodes, normal, share)
    }),
    touching("exact/along_edge", |random| {
        let nodes = ruled(random, 0.15);
        let normal = across(random, nodes[1] - nodes[0]);
        through(nodes, normal, nodes[0])
    }),
    touching("exact/near_saddle", |random| {
        let nodes = ruled(random, 0.25);
        let face = Hexahedron::FACE_NODES[random.below(6)];
        let normal = random.unit();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| normal.dot(&nodes[face[k]]));
        let distance = random.one_of(&[0.0, 1e-16, 1e-14, 1e-10, 1e-6]) * random.one_of(&[-1.0, 1.0]);
        let constant = (a * c - b * d) / (a + c - b - d) + distance;
        Input::Cell(Box::new(Row { nodes, normal, given: Given::Constant(constant) }))
    }),
    valid("exact/axis_normal", |random| {
        let mut normal = Vector::<3>::zeros();
        normal[random.below(3)] = random.one_of(&[-1.0, 1.0]);
        let share = random.within(0.0, 1.0);
        at(cube(), normal, share)
    }),
    family(
        "exact/plane_of_face",
        "planes of faces leave nothing or all of a box, to 2e-15 of it",
        |random| {
            let mut normal = Vector::<3>::zeros();
            normal[random.below(3)] = random.one_of(&[-1.0, 1.0]);
            let share = random.below(2) as f64;
            at(cube(), normal, share)
        },
        |input| judged(input, |row, exact| volumes(row, exact, VOLUME * exact.cell_volume)),
    ),
    signed("exact/swept", |random| {
        let nodes = swept(random);
        cut(random, nodes)
    }),
    signed("exact/bow_tie", |random| {
        let mut nodes = ruled(random, 0.15);
        let [a, b] = random.one_of(&[[4, 5], [5, 6], [6, 7], [4, 6]]);
        nodes.swap(a, b);
        cut(random, nodes)
    }),
];

/// How many times longer a case takes than one of the kernel alone.
const WEIGHT: usize = 4;

const fn valid(name: &'static str, draw: fn(&mut Random) -> Input) -> Family {
    let holds = "volumes are exact to 2e-15 of the cell, section areas to 1e-14 of the larger one of themselves and V^(2/3), beyond what the rounding of the plane's place does to them";
    family(name, holds, draw, |input| judged(input, |row, exact| all(row, exact, AREA)))
}

const fn touching(name: &'static str, draw: fn(&mut Random) -> Input) -> Family {
    let holds = "volumes are exact to 2e-15 of the cell, section areas to 1e-12 of the larger one of themselves and V^(2/3), beyond what the rounding of the plane's place does to them";
    family(name, holds, draw, |input| judged(input, |row, exact| all(row, exact, TOUCHING)))
}

const fn signed(name: &'static str, draw: fn(&mut Random) -> Input) -> Family {
    let holds = "signed volumes are exact to 1e-14 of the box around the cell";
    family(name, holds, draw, |input| {
        judged(input, |row, exact| volumes(row, exact, SIGNED * box_volume(&Hexahedron::new(row.nodes))))
    })
}

const fn family(
    name: &'static str,
    holds: &'static str,
    draw: fn(&mut Random) -> Input,
    judge: fn(&Input) -> Verdict,
) -> Family {
    Family { name, holds, weight: WEIGHT, draw, judge }
}

fn judged(input: &Input, judge: impl Fn(&Row, &Exact) -> Verdict) -> Verdict {
    match input {
        Input::Cell(row) => judge(row, &oracle::truncate(&row.nodes, &row.normal, row.constant())),
        _ => Verdict::good(""),
    }
}

fn all(row: &Row, exact: &Exact, allowed: f64) -> Verdict {
    let found = Hexahedron::new(row.nodes).truncate(&plane(row)).section_area;
    let size = exact.section_area.max(exact.cell_volume.powf(2.0 / 3.0));
    let told = format!("a section of {found:e} for {:e}", exact.section_area);
    let area = Verdict::of((found - exact.section_area).abs(), allowed * size + exact.area_rounding, told);
    volumes(row, exact, VOLUME * exact.cell_volume).or(area)
}

fn volumes(row: &Row, exact: &Exact, allowed: f64) -> Verdict {
    let cell = Hexahedron::new(row.nodes);
    let of = |what: &str, found: f64, wanted: f64| {
        Verdict::of((found - wanted).abs(), allowed, format!("{what} {found:e} for {wanted:e}"))
    };
    let truncated = of("a truncated volume", cell.truncate(&plane(row)).volume, exact.truncated_volume);
    of("a cell volume", cell.volume(), exact.cell_volume).or(truncated)
}

fn plane(row: &Row) -> HalfSpace<3> {
    HalfSpace { normal: row.normal, constant: row.constant() }
}

/// The first of some draws that the check lets pass.
fn sound(random: &mut Random, draw: impl Fn(&mut Random) -> [Vector<3>; 8]) -> [Vector<3>; 8] {
    loop {
        let nodes = draw(random);
        if is_valid(&Hexahedron::new(nodes)) {
            return nodes;
        }
    }
}

fn scaled(x: Vector<3>, factor: f64, is_scaled: impl Fn(usize) -> bool) -> Vector<3> {
    Vector::<3>::from_fn(|k, _| if is_scaled(k) { factor * x[k] } else { x[k] })
}

/// A plane somewhere in a cell.
fn cut(random: &mut Random, nodes: [Vector<3>; 8]) -> Input {
    let (normal, share) = (random.unit(), random.within(0.0, 1.0));
    at(nodes, normal, share)
}

/// A plane at a share of the cell's height.
fn at(nodes: [Vector<3>; 8], normal: Vector<3>, share: f64) -> Input {
    let constant = at_share(nodes.map(|x| normal.dot(&x)), share);
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Constant(constant) }))
}

/// The plane through a point.
fn through(nodes: [Vector<3>; 8], normal: Vector<3>, point: Vector<3>) -> Input {
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Constant(normal.dot(&point)) }))
}

/// A direction across an edge.
fn across(random: &mut Random, edge: Vector<3>) -> Vector<3> {
    loop {
        let normal = edge.cross(&random.unit());
        if normal.norm() > 0.1 * edge.norm() {
            return normal.normalize();
        }
    }
}

/// A plane that leaves about a fraction of a cell.
fn filled(random: &mut Random, fraction: f64) -> Input {
    let (nodes, normal) = (ruled(random, 0.15), random.unit());
    let found = Hexahedron::new(nodes).plane_constant(&normal, fraction, PositionMethod::Auto);
    let constant = found.map_or(f64::NAN, |found| found.constant);
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Constant(constant) }))
}
