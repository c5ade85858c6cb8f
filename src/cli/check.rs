//! What a scene will do, without doing it.

use vofkit_geometry::{Cell, Hexahedron, Quad};

use crate::advection::{Boundary, End};
use crate::mesh::{Mesh, axis_name};
use crate::metrics::material_volume;
use crate::report::table;
use crate::run::{Plan, Schedule, output, prepare};
use crate::scene::{Draft, MaterialSetup, Resolved, Scene, SceneError, Still, StillScene};

/// Validates a scene and describes what a run does with it, or a reconstruction if nothing moves.
///
/// # Errors
/// See [`report`] and [`still_report`].
pub fn draft(draft: Draft) -> Result<String, SceneError> {
    if draft.moves() {
        return match draft.scene()? {
            Scene::Plane(scene) => report::<Quad, 2>(&scene),
            Scene::Space(scene) => report::<Hexahedron, 3>(&scene),
        };
    }
    match draft.still()? {
        StillScene::Plane(scene) => still_report::<Quad, 2>(&scene),
        StillScene::Space(scene) => still_report::<Hexahedron, 3>(&scene),
    }
}

/// Validates a scene and describes it: the scene as TOML with every default filled in, then, in comments, what a run
/// computes, writes and skips.
///
/// # Errors
/// Everything that would keep the scene from being run. The mesh is made, but nothing is written.
pub fn report<C: Cell<D>, const D: usize>(scene: &Resolved<D>) -> Result<String, SceneError> {
    let mesh: Mesh<C, D> = prepare::mesh(scene)?;
    let fractions = prepare::fractions(scene, &mesh)?;
    let setup = prepare::setup(scene, &mesh)?;
    let plan = setup.plan;
    let schedule = Schedule::new(&scene.output, &plan);
    let times: Vec<f64> = schedule.steps().iter().map(|&step| plan.time(step)).collect();
    let mut rows = vec![
        ("cells", mesh.grid().len().to_string()),
        ("memory", format!("about {}", crate::run::megabytes(prepare::memory(scene)))),
        ("time steps", format!("{} of {:.6e}, to the time {:.6}", plan.steps, plan.dt(), plan.end)),
        ("Courant number", courant(&plan)),
        ("boundary", boundary(&setup.boundary, scene.boundary.periodic)),
    ];
    rows.extend(contents(scene, &mesh, &fractions));
    rows.push(("files", output::names(scene, &schedule).join(" ")));
    rows.push(("not written", not_written(scene)));
    for note in crate::run::notes(scene, &setup, &schedule) {
        rows.push(("note", note));
    }
    Ok(with_comments(&scene.to_toml(&setup.boundary, &times), &rows))
}

/// Validates a scene of which nothing moves and describes it, like [`report`].
///
/// # Errors
/// Everything that would keep it from being reconstructed.
pub fn still_report<C: Cell<D>, const D: usize>(scene: &Still<D>) -> Result<String, SceneError> {
    let mesh: Mesh<C, D> = prepare::still_mesh(scene)?;
    let fractions = prepare::fractions(scene, &mesh)?;
    let mut rows = vec![
        ("for", "vofkit reconstruct: nothing moves".to_owned()),
        ("cells", mesh.grid().len().to_string()),
        ("memory", format!("about {}", crate::run::megabytes(prepare::still_memory(scene)))),
    ];
    rows.extend(contents(scene, &mesh, &fractions));
    rows.push(("files", output::still_names(scene).join(" ")));
    rows.push(("not written", not_written(scene)));
    rows.extend(crate::run::of_start(scene, &mesh).into_iter().map(|note| ("note", note)));
    Ok(with_comments(&scene.to_toml(), &rows))
}

/// Mixed cells and materials.
fn contents<C: Cell<D>, const D: usize>(
    scene: &Still<D>,
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
) -> Vec<(&'static str, String)> {
    let (mixed, cells) = (crate::run::mixed_cells(fractions), mesh.grid().len());
    let mixed = format!("{mixed} at the start; the other {} need no plane", cells - mixed);
    let material = |(material, fractions): (&MaterialSetup<D>, &Vec<f64>)| {
        let volume = material_volume(mesh, fractions);
        ("material", format!("\"{}\", volume {volume:.12e}", material.name))
    };
    std::iter::once(("mixed cells", mixed))
        .chain(scene.materials.iter().zip(fractions).map(material))
        .collect()
}

fn not_written<const D: usize>(scene: &Still<D>) -> String {
    let skipped = crate::run::not_asked_for(&scene.output);
    if skipped.is_empty() { "-".to_owned() } else { skipped.join(", ") }
}

fn with_comments(toml: &str, rows: &[(&str, String)]) -> String {
    let comments: String = table::lines(rows).lines().map(|line| format!("# {line}\n")).collect();
    format!("{toml}\n{comments}")
}

fn courant(plan: &Plan) -> String {
    let mut text = format!("{:.4}", plan.courant);
    if plan.substeps > 1 {
        text.push_str(&format!(", so that each step is split into {}", plan.substeps));
    }
    if plan.overdraft {
        text.push_str(", above the limit; the run goes on all the same");
    }
    text
}

fn boundary<const D: usize>(boundary: &Boundary<D>, periodic: [bool; D]) -> String {
    let word = |end: End| if end == End::Wall { "wall" } else { "outflow" };
    let of_axis = |axis: usize| {
        let name = axis_name(axis);
        if periodic[axis] {
            return format!("{name} periodic");
        }
        let [lower, upper] = boundary.ends[axis].map(word);
        format!("{name} {lower}/{upper}")
    };
    (0..D).map(of_axis).collect::<Vec<_>>().join(", ")
}
