//! Scenes that are stiff or extreme, and what every run of them owes: conservation and bounds, or an error that says what is wrong.

use vofkit_geometry::{Cell, Hexahedron, Quad};

use super::Family;
use super::case::{Input, Random, Verdict};
use super::scenery::{Scenery, disc, material};
use crate::advection::{Ledger, Scheme, StepError, SweepAxes};
use crate::mesh::Mesh;
use crate::metrics::material_volume;
use crate::run::prepare::{self, Mover};
use crate::scene::{Resolved, Scene};
use crate::stopwatch::Stopwatch;

/// Drift of a material's volume, relative to the mesh, beyond what the ledger says was corrected.
const DRIFT: f64 = 1e-12;
/// How far a fraction may be out of bounds before correction, by schemes that need none.
const BOUNDS: f64 = 1e-12;
/// Halvings of a step that asks a cell for more than it holds.
const HALVINGS: usize = 10;

pub(super) const FAMILIES: &[Family] = &[
    sound(
        "motion/tiny_steps",
        "100,000 steps of a Courant number of 1e-6 conserve volume and stay within bounds",
        1 << 20,
        |random| {
            let materials = disc("a", [random.within(0.4, 0.6), random.within(0.4, 0.6)], 0.25);
            Scenery { cells: [6, 6], materials, courant: 1e-6, steps: 100_000, ..Scenery::new(random) }
                .input()
        },
    ),
    sound(
        "motion/courant_one",
        "steps of a Courant number of 1 - 1e-12 and of exactly 1 conserve volume and stay within bounds",
        250,
        |random| {
            let velocity = random.one_of(&["[1.0, 0.0]", "[-1.0, 0.0]", "[0.0, 1.0]", "[0.5, -0.5]"]);
            let field = format!("{{ uniform = {{ velocity = {velocity} }} }}");
            let courant = random.one_of(&[1.0, 1.0 - 1e-12]);
            Scenery { field, courant, periodic: true, ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "motion/whirl",
        "a whirl within one cell, whose velocity changes sign across faces, conserves volume and stays within bounds",
        250,
        |random| {
            let centre = [random.within(0.3, 0.7), random.within(0.3, 0.7)];
            let field = format!(
                "{{ rotation = {{ centre = {centre:?}, rate = {:?} }} }}",
                random.one_of(&[1.0, -3.0])
            );
            Scenery { field, courant: random.within(0.2, 1.0), ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "motion/fold",
        "shear so strong that sweeps fold conserves volume and stays within bounds, in steps as short as that takes",
        250,
        |random| {
            let field = "\"rudman_shear\"".to_owned();
            let materials = disc("a", [1.5, random.within(0.8, 2.0)], 0.7);
            let side = [std::f64::consts::PI; 2];
            Scenery {
                field,
                materials,
                side,
                cells: [4, 4],
                courant: random.within(0.5, 1.0),
                ..Scenery::new(random)
            }
            .input()
        },
    ),
    sound(
        "motion/there_and_back",
        "10,000 steps there and back conserve volume and stay within bounds",
        1 << 14,
        |random| {
            let field = "{ reversed_vortex = { period = 2.0 } }".to_owned();
            Scenery { field, courant: 0.0, steps: 10_000, cells: [10, 10], ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "motion/aspect",
        "cells 1e4 times longer than wide conserve volume and stay within bounds",
        250,
        |random| {
            let field = "{ uniform = { velocity = [1.0, 1e-4] } }".to_owned();
            let materials =
                material("a", "{ rectangle = { centre = [0.5, 0.5e-4], lengths = [0.4, 0.37e-4] } }");
            Scenery { field, materials, side: [1.0, 1e-4], periodic: true, ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "motion/spin",
        "a remap to the mesh turned by 90 degrees conserves volume and stays within bounds",
        250,
        |random| {
            let materials = disc("a", [0.5, 0.52], random.within(0.05, 0.45));
            Input::Scene(format!(
                "[mesh]\ncells = [9, 9]\ndistortion = {{ random = {{ amplitude = 0.2, seed = {} }} }}\n\
                 motion = {{ rotate = {{ centre = [0.5, 0.5], angle = {:?} }} }}\n\n{materials}\
                 [advection]\nmode = \"remesh\"\nscheme = \"remap\"\nsteps = 1\n\n[output]\ninterface = []\n",
                random.below(1000),
                std::f64::consts::FRAC_PI_2
            ))
        },
    ),
    Family {
        name: "motion/still",
        holds: "without velocity no bit of a fraction changes",
        weight: 250,
        draw: |random| {
            let field = "{ uniform = { velocity = [0.0, 0.0] } }".to_owned();
            Scenery { field, courant: 0.0, steps: 5, ..Scenery::new(random) }.input()
        },
        judge: |input| {
            on_scene(input, |run| {
                if run.changed { Verdict::broken("bits changed") } else { Verdict::good("the same bits") }
            })
        },
    },
    sound(
        "materials/film",
        "films of 1e-9 of a cell conserve volume and stay within bounds",
        250,
        |random| {
            let (place, thickness) = (random.within(0.3, 0.7), 1e-9 / 8.0);
            let shape =
                format!("{{ rectangle = {{ centre = [{place:?}, 0.5], lengths = [{thickness:?}, 0.4] }} }}");
            Scenery { materials: material("film", &shape), ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "materials/twenty",
        "20 materials in one cell conserve their volumes and stay within bounds",
        500,
        |random| {
            let at = |k: usize| [0.42 + 0.01 * (k % 5) as f64, 0.42 + 0.012 * (k / 5) as f64];
            let materials = (0..20).map(|k| disc(&format!("m{k}"), at(k), 0.004)).collect();
            Scenery { materials, cells: [5, 5], steps: 8, ..Scenery::new(random) }.input()
        },
    ),
    sound(
        "materials/ends",
        "material that touches every end, fills the domain or is not there conserves volume and stays within bounds",
        250,
        |random| {
            let shape = random.one_of(&[
            "{ rectangle = { centre = [0.5, 0.5], lengths = [1.0, 1.0] } }",
            "{ rectangle = { centre = [0.5, 0.5], lengths = [3.0, 0.31] } }",
            "{ disc = { centre = [0.5, 0.5], radius = 0.5 } }",
            "{ disc = { centre = [9.0, 9.0], radius = 0.5 } }",
            "{ difference = [{ rectangle = { centre = [0.5, 0.5], lengths = [1.0, 1.0] } }, { disc = { centre = [0.5, 0.5], radius = 0.4 } }] }",
        ]);
            Scenery { materials: material("a", shape), ..Scenery::new(random) }.input()
        },
    ),
];

/// A family of scenes that conserve volume and stay within bounds.
const fn sound(
    name: &'static str,
    holds: &'static str,
    weight: usize,
    draw: fn(&mut Random) -> Input,
) -> Family {
    Family { name, holds, weight, draw, judge: |input| on_scene(input, Course::sound) }
}

/// What a run of a scene did.
struct Course {
    /// Volumes of the materials before and after, with what the boundary took.
    volumes: Vec<[f64; 2]>,
    ledger: Ledger,
    total: f64,
    /// Whether the scheme needs no corrections.
    exact: bool,
    changed: bool,
}

impl Course {
    fn sound(&self) -> Verdict {
        let of = |(k, [before, after]): (usize, &[f64; 2])| {
            let account = &self.ledger.materials[k];
            let corrected = account.clipped + account.rescaled;
            let error = (after - before + account.outflow).abs();
            let told = format!("material {k} went from {before:e} to {after:e}, {corrected:e} corrected");
            // Where corrections are of the scheme, they say what they did.
            let allowed = DRIFT * self.total + if self.exact { 0.0 } else { corrected };
            let drift = Verdict::of(error, allowed, told);
            let outside = (-account.smallest).max(account.largest - 1.0).max(0.0);
            let told =
                format!("fractions of material {k} from {:e} to {:e}", account.smallest, account.largest);
            // Without any sweep there are no extremes.
            if self.exact && self.ledger.sweeps > 0 && outside.is_finite() {
                drift.or(Verdict::of(outside, BOUNDS, told))
            } else {
                drift
            }
        };
        self.volumes.iter().enumerate().map(of).fold(Verdict::good("exact"), Verdict::or)
    }
}

fn on_scene(input: &Input, judge: fn(&Course) -> Verdict) -> Verdict {
    let Input::Scene(text) = input else { return Verdict::good("") };
    let course = match Scene::parse("reproducer.toml", "stress", text, &[]) {
        Ok(Scene::Plane(scene)) => run::<Quad, 2>(&scene),
        Ok(Scene::Space(scene)) => run::<Hexahedron, 3>(&scene),
        Err(error) => Err(error.to_string()),
    };
    match course {
        Ok(course) => judge(&course),
        Err(error) => Verdict::broken(format!("it cannot be run: {error}")),
    }
}

fn run<C: Cell<D>, const D: usize>(scene: &Resolved<D>) -> Result<Course, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let mesh: Mesh<C, D> = prepare::mesh(scene).map_err(|error| text(&error))?;
    let mut fractions = prepare::fractions(scene, &mesh).map_err(|error| text(&error))?;
    let start = fractions.clone();
    let mut setup = prepare::setup(scene, &mesh).map_err(|error| text(&error))?;
    let plan = setup.plan;
    let mut ledger = Ledger::new(fractions.len());
    for step in 0..plan.steps {
        let times = [plan.time(step), plan.time(step + 1)];
        advance(&mut setup.mover, &mut fractions, step, times, plan.end, HALVINGS, &mut ledger)
            .map_err(|error| format!("step {}: {error}", step + 1))?;
    }
    let volumes = start.iter().zip(&fractions).map(|(a, b)| [a, b].map(|f| material_volume(&mesh, f)));
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
    let advection = &scene.advection;
    Ok(Course {
        volumes: volumes.collect(),
        ledger,
        total: mesh.total_volume(),
        exact: matches!(advection.scheme, Scheme::Sweeps | Scheme::Unsplit | Scheme::Remap)
            && advection.sweep_axes == SweepAxes::Logical,
        changed: !start.iter().flatten().zip(fractions.iter().flatten()).all(same),
    })
}

/// A step, in halves where a cell would give more than it holds.
fn advance<C: Cell<D>, const D: usize>(
    mover: &mut Mover<'_, C, D>,
    fractions: &mut [Vec<f64>],
    number: usize,
    [start, end]: [f64; 2],
    run_end: f64,
    halvings: usize,
    ledger: &mut Ledger,
) -> Result<(), StepError> {
    match mover.step(fractions, &mut [], number, [start, end, run_end], &mut Stopwatch::default()) {
        Ok(done) => {
            ledger.add(&done);
            Ok(())
        }
        Err(error) if halvings > 0 && error.is_too_large() => {
            let middle = 0.5 * (start + end);
            advance(mover, fractions, 2 * number, [start, middle], run_end, halvings - 1, ledger)?;
            advance(mover, fractions, 2 * number + 1, [middle, end], run_end, halvings - 1, ledger)
        }
        Err(error) => Err(error),
    }
}
