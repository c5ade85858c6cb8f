//! What the geometry kernel owes any cell and plane.

use std::num::NonZeroUsize;

use gauss_quad::legendre::GaussLegendre;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionError, PositionMethod, Vector, hyperbola};

use super::Family;
use super::case::{CaseFile, Given, Input, Random, Row, Verdict};
use super::cells::{anything, box_volume, collapsed, common, cube, cut, filled, is_valid, ruled};

/// Rounding of volumes, relative to the cell or, where terms cancel, to the box around it.
const VOLUME: f64 = 1e-13;
/// Corners where the Jacobian determinant is below this, relative to the largest, are inverted beyond doubt.
const INVERTED: f64 = -1e-6;
/// Evaluations of a plane constant, with the last one of the residual: at most, and by Newton's method on valid cells.
const EVALUATIONS: usize = 101;
const NEWTON_EVALUATIONS: usize = 20;
/// Points of the quadrature that moments of hyperbolas are compared with.
const QUADRATURE: NonZeroUsize = NonZeroUsize::new(96).expect("not zero");
const METHODS: [PositionMethod; 3] = [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent];

pub(super) const FAMILIES: &[Family] = &[
    Family {
        name: "geometry/parts",
        holds: "the parts below and above any plane add up to the cell, to 1e-13 of the cell (of the box around it, if inverted)",
        weight: 1,
        draw: |random| {
            let nodes = if random.below(3) == 0 { anything(random) } else { common(random) };
            let (normal, share) = (random.unit(), random.within(-0.1, 1.1));
            cut(nodes, normal, share)
        },
        judge: |input| on_cell(input, parts),
    },
    Family {
        name: "geometry/through",
        holds: "planes through vertices, along edges, in faces and through saddles leave parts that add up, change by the section's area, and are finite",
        weight: 1,
        draw: |random| if random.below(3) == 0 { saddle(random) } else { through(random) },
        judge: |input| on_cell(input, |row| parts(row).or(smooth(row))),
    },
    Family {
        name: "geometry/hyperbola",
        holds: "the moments of a hyperbola with w from -1 + 1e-15 to 1e15 are those of a quadrature, to 1e-12 of themselves",
        weight: 4,
        draw: |random| {
            let magnitude = 10.0_f64.powf(random.within(-15.0, 15.0));
            let w = if random.below(2) == 0 { magnitude } else { magnitude.min(1.0 / magnitude) - 1.0 };
            Input::Number(w, |w| vec![CaseFile::table(with_hyperbola(w).text())])
        },
        judge: |input| if let Input::Number(w, _) = input { moments(*w) } else { Verdict::good("") },
    },
    Family {
        name: "geometry/scaled",
        holds: "volumes of cells from 1e-75 to 1e75 long scale to 1e-14",
        weight: 1,
        draw: |random| scaled(random, -249, 249),
        judge: |input| on_cell(input, |row| stretched_alike(row, 1e-14)),
    },
    Family {
        name: "geometry/range",
        holds: "cells whose volume over- or underflows are refused by the check, and their positions with a typed error; nothing is NaN",
        weight: 1,
        draw: |random| {
            let [low, high] = if random.below(2) == 0 { [366, 966] } else { [-966, -366] };
            scaled(random, low, high)
        },
        judge: |input| on_cell(input, out_of_range),
    },
    Family {
        name: "geometry/aspect",
        holds: "cells up to 1e8 times longer than wide have the truncated volumes of compact ones, to 1e-13",
        weight: 1,
        draw: |random| {
            let factors = [0, 1, 2].map(|_| 2.0_f64.powi(random.below(55) as i32 - 27));
            plain(random).map_nodes(|row| row.stretched(factors))
        },
        judge: |input| on_cell(input, |row| stretched_alike(row, 1e-13)),
    },
    Family {
        name: "geometry/offset",
        holds: "cells up to 1e12 from the origin have the volumes and the plane constants (relative to their first node) of those at it",
        weight: 1,
        draw: |random| {
            let shift = random.vector(1e12).map(f64::round);
            plain(random).map_nodes(|row| Row { nodes: row.nodes.map(|x| x + shift), ..row.clone() })
        },
        judge: |input| on_cell(input, offset),
    },
    Family {
        name: "geometry/collapsed",
        holds: "cells with edges and faces collapsed have parts that add up and, where the check lets them pass, positions",
        weight: 1,
        draw: |random| {
            let nodes = ruled(random, 0.1);
            let nodes = collapsed(random, nodes);
            let normal = random.unit();
            filled(nodes, normal, random.within(0.0, 1.0))
        },
        judge: |input| on_cell(input, |row| parts(row).or(position(row))),
    },
    Family {
        name: "geometry/inverted",
        holds: "cells with an inverted corner are refused by the check; the kernel neither hangs nor panics on them, and is finite",
        weight: 1,
        draw: |random| {
            let mut nodes = ruled(random, 0.1);
            let node = random.below(8);
            nodes[node] = Vector::repeat(1.0) - nodes[node] + random.vector(0.9);
            let normal = random.unit();
            filled(nodes, normal, random.within(0.0, 1.0))
        },
        judge: |input| on_cell(input, inverted),
    },
    Family {
        name: "geometry/positions",
        holds: "every method finds a plane for fractions from 5e-324 to 1 - 1e-15, Newton's in at most 20 evaluations and Brent's in 101, to 1e-12 of the cell",
        weight: 1,
        draw: |random| {
            let (nodes, normal) = (common(random), random.unit());
            let any = random.within(0.0, 1.0);
            filled(
                nodes,
                normal,
                random.one_of(&[any, 1e-300, 1e-15, 1e-8, 1.0 - 1e-15, f64::MIN_POSITIVE, 5e-324, 1.0]),
            )
        },
        judge: |input| on_cell(input, position),
    },
];

fn on_cell(input: &Input, judge: impl Fn(&Row) -> Verdict) -> Verdict {
    if let Input::Cell(row) = input { judge(row) } else { Verdict::good("") }
}

impl Input {
    fn map_nodes(self, change: impl Fn(&Row) -> Row) -> Self {
        if let Self::Cell(row) = &self { Self::Cell(Box::new(change(row))) } else { self }
    }
}

/// A cell with short binary coordinates, a normal of small whole numbers, and a plane: shifts and scales leave all of it exact.
fn plain(random: &mut Random) -> Input {
    let nodes = ruled(random, 0.2).map(|x| x.map(|c| (c * 256.0).round() / 256.0));
    let normal = Vector::<3>::from_fn(|_, _| random.below(9) as f64 - 4.0);
    let normal = if normal.amax() == 0.0 { Vector::<3>::new(1.0, 2.0, -1.0) } else { normal };
    cut(nodes, normal, random.within(0.0, 1.0))
}

fn scaled(random: &mut Random, low: i32, high: i32) -> Input {
    let factor = 2.0_f64.powi(low + random.below((high - low + 1) as usize) as i32);
    plain(random).map_nodes(|row| Row {
        nodes: row.nodes.map(|x| x * factor),
        given: match row.given {
            Given::Local(constant) => Given::Local(constant * factor),
            given => given,
        },
        ..row.clone()
    })
}

fn through(random: &mut Random) -> Input {
    let nodes = common(random);
    let face = Hexahedron::FACE_NODES[random.below(6)];
    let [a, b, c] = [face[0], face[1], face[2]].map(|node| nodes[node]);
    let normal = match random.below(3) {
        0 => random.unit(),
        1 => (b - a).cross(&random.unit()),
        _ => (b - a).cross(&(c - a)),
    };
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Local(normal.dot(&(a - nodes[0]))) }))
}

fn saddle(random: &mut Random) -> Input {
    let mut nodes = cube();
    let twist = random.within(0.01, 0.4);
    for (node, sign) in [(4, 1.0), (5, -1.0), (6, 1.0), (7, -1.0)] {
        nodes[node][2] += sign * twist * random.within(0.2, 1.0);
    }
    let [a, b, c, d] = [4, 5, 6, 7].map(|node| nodes[node][2]);
    let constant = (a * c - b * d) / (a + c - b - d) + random.one_of(&[0.0, 1e-16, -1e-16, 1e-12, -1e-12]);
    Input::Cell(Box::new(Row { nodes, normal: Vector::<3>::z(), given: Given::Local(constant) }))
}

/// The volume that errors are relative to: of the cell, or of the box around it.
fn scale(cell: &Hexahedron) -> f64 {
    if is_valid(cell) { cell.volume() } else { box_volume(cell) }
}

fn parts(row: &Row) -> Verdict {
    let (cell, half_space) = (row.cell(), row.half_space());
    let [below, above] = [half_space, half_space.complement()].map(|side| cell.truncate(&side).volume);
    let error = (below + above - cell.volume()).abs();
    Verdict::of(error, VOLUME * scale(&cell), format!("parts {below:e} and {above:e} of {:e}", cell.volume()))
}

/// The volume changes by the section's area times the step.
fn smooth(row: &Row) -> Verdict {
    let (cell, half_space) = (row.cell(), row.half_space());
    let length = half_space.normal.norm();
    let step = 1e-7;
    let at = |shift: f64| {
        cell.truncate(&HalfSpace { constant: half_space.constant + shift * length, ..half_space })
    };
    let [before, here, after] = [-step, 0.0, step].map(at);
    // A face in the plane makes the area jump: the change is then between those beside it.
    let areas = [before, here, after].map(|part| part.section_area * length);
    let change = after.volume - before.volume;
    let [least, most] =
        [areas.iter().fold(f64::INFINITY, |a, &b| a.min(b)), areas.iter().fold(0.0_f64, |a, &b| a.max(b))];
    let error = (2.0 * step * least - change).max(change - 2.0 * step * most).max(0.0);
    let allowed = VOLUME * scale(&cell) + 40.0 * step * step;
    Verdict::of(error, allowed, format!("a change of {change:e} with areas {areas:?}"))
}

/// A cell with a face that the plane meets in this hyperbola: of the heights `s` at its corners one is below,
/// and `1 + w = (s2 s4 - s1 s3) / ((s2 - s1)(s4 - s1))`.
fn with_hyperbola(w: f64) -> Row {
    let mut nodes = cube();
    let [side, far] = if w > 0.0 {
        [1.0, 4.0 * (1.0 + w) - 1.0]
    } else {
        let share = (0.5 * (1.0 + w)).sqrt();
        [share / (1.0 - share), (share / (1.0 - share)).powi(2)]
    };
    for (node, height) in [(4, -1.0), (5, side), (6, far), (7, side)] {
        nodes[node][2] = 2.0 + height;
    }
    Row { nodes, normal: Vector::<3>::z(), given: Given::Constant(2.0) }
}

/// `M00` and `M10` against a quadrature of `g = (1 - t)/(1 + w t)` in `s = ln(1 + w t)`, where it is smooth.
fn moments(w: f64) -> Verdict {
    let moments = hyperbola::moments(1.0 + w, 1.0, w);
    let rule = GaussLegendre::new(QUADRATURE);
    let end = w.ln_1p();
    // t = (e^s - 1) / w, dt = e^s / w ds, 1 + w t = e^s.
    let t = |s: f64| s.exp_m1() / w;
    let m00 = rule.integrate(0.0, end, |s| (1.0 - t(s)) / w);
    let m10 = rule.integrate(0.0, end, |s| t(s) * (1.0 - t(s)) / w);
    let error = ((moments.m00 - m00) / m00).abs().max(((moments.m10 - m10) / m10).abs());
    Verdict::of(error, 1e-12, format!("M00 {:e} for {m00:e}, M10 {:e} for {m10:e}", moments.m00, moments.m10))
}

/// The truncated share of a cell is that of the cell shrunk to unit size.
fn stretched_alike(row: &Row, allowed: f64) -> Verdict {
    let cell = row.cell();
    let extent = |axis: usize| {
        let largest = cell.nodes().iter().map(|x| x[axis].abs()).fold(0.0, f64::max);
        // A power of two, so that nothing is rounded.
        if largest > 0.0 { 2.0_f64.powi(largest.log2().round() as i32) } else { 1.0 }
    };
    let compact = row.stretched([0, 1, 2].map(|axis| 1.0 / extent(axis)));
    let share = |row: &Row| row.cell().truncate(&row.half_space()).volume / row.cell().volume();
    let [own, other] = [share(row), share(&compact)];
    Verdict::of((own - other).abs(), allowed, format!("a share of {own} for {other}"))
}

fn out_of_range(row: &Row) -> Verdict {
    let cell = row.cell();
    let truncated = cell.truncate(&row.half_space());
    if truncated.volume.is_nan() || cell.volume().is_nan() {
        return Verdict::broken(format!("volumes {:e} and {:e}", truncated.volume, cell.volume()));
    }
    if is_valid(&cell) {
        return Verdict::broken(format!("the check lets a volume of {:e} pass", cell.volume()));
    }
    match cell.plane_constant(&row.normal, 0.3, PositionMethod::Auto) {
        Ok(found) if !found.constant.is_finite() => Verdict::broken(format!("{found:?}")),
        Ok(found) => Verdict::broken(format!("a plane for a cell out of range: {found:?}")),
        Err(error) => Verdict::good(error.to_string()),
    }
}

fn offset(row: &Row) -> Verdict {
    let far = Hexahedron::new(row.nodes);
    let near = row.cell();
    let volume = Verdict::of(
        (far.volume() - near.volume()).abs(),
        VOLUME * near.volume(),
        format!("volume {:e}", far.volume()),
    );
    let [a, b] = [&far, &near].map(|cell| cell.plane_constant(&row.normal, 0.37, PositionMethod::Auto));
    match (a, b) {
        (Ok(a), Ok(b)) => {
            let (a, b) = (a.local_constant, b.local_constant);
            volume.or(Verdict::of((a - b).abs(), 1e-12 * row.normal.norm(), format!("constants {a} and {b}")))
        }
        (a, b) => Verdict::broken(format!("{a:?} and {b:?}")),
    }
}

fn position(row: &Row) -> Verdict {
    let (cell, fraction) = (row.cell(), row.fraction());
    if !is_valid(&cell) {
        return Verdict::good("the check refuses it");
    }
    let of = |method: PositionMethod| match cell.plane_constant(&row.normal, fraction, method) {
        Ok(found) => {
            let plane = HalfSpace { normal: row.normal, constant: found.local_constant };
            let error = (cell.truncate(&plane).volume - fraction * cell.volume()).abs();
            let told = format!("{method:?}: {error:e} of {:e}, {found:?}", cell.volume());
            let most = if method == PositionMethod::Brent { EVALUATIONS } else { NEWTON_EVALUATIONS };
            let evaluations = Verdict::of(found.evaluations as f64, most as f64, told.clone());
            Verdict::of(error, 1e-12 * cell.volume(), told).or(evaluations)
        }
        Err(error) => Verdict::broken(format!("{method:?}: {error}")),
    };
    METHODS.map(of).into_iter().fold(Verdict::good("exact"), Verdict::or)
}

fn inverted(row: &Row) -> Verdict {
    let cell = row.cell();
    let corners = Hexahedron::OFFSETS
        .iter()
        .map(|offset| cell.jacobian_determinant(&Vector::<3>::from_fn(|axis, _| offset[axis] as f64)));
    let (low, high) =
        corners.fold((f64::INFINITY, 0.0_f64), |(low, high), det| (low.min(det), high.max(det.abs())));
    if low < INVERTED * high && is_valid(&cell) {
        return Verdict::broken(format!("a corner has the determinant {low:e}, and the check lets it pass"));
    }
    for method in METHODS {
        match cell.plane_constant(&row.normal, row.fraction(), method) {
            Ok(found) if !found.constant.is_finite() || found.evaluations > EVALUATIONS => {
                return Verdict::broken(format!("{method:?}: {found:?}"));
            }
            Err(PositionError::NoConvergence { evaluations, .. }) if evaluations > EVALUATIONS => {
                return Verdict::broken(format!("{method:?}: {evaluations} evaluations"));
            }
            _ => {}
        }
    }
    let truncated = cell.truncate(&row.half_space());
    if truncated.volume.is_finite() {
        Verdict::good("finite")
    } else {
        Verdict::broken(format!("{truncated:?}"))
    }
}
