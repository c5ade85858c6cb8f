//! What a scene will do, without doing it.

use vofkit_geometry::Cell;

use crate::advection::{Boundary, End};
use crate::mesh::{Mesh, axis_name};
use crate::metrics::material_volume;
use crate::report::table;
use crate::run::{Plan, Schedule, output, prepare};
use crate::scene::{Resolved, SceneError};

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
    let (mixed, cells) = (crate::run::mixed_cells(&fractions), mesh.grid().len());
    rows.push(("mixed cells", format!("{mixed} at the start; the other {} need no plane", cells - mixed)));
    for (material, fractions) in scene.materials.iter().zip(&fractions) {
        rows.push((
            "material",
            format!("\"{}\", volume {:.12e}", material.name, material_volume(&mesh, fractions)),
        ));
    }
    rows.push(("files", output::names(scene, &schedule).join(" ")));
    let skipped = crate::run::not_asked_for(&scene.output);
    rows.push(("not written", if skipped.is_empty() { "-".to_owned() } else { skipped.join(", ") }));
    for note in crate::run::notes(scene, &mesh, &plan, &schedule) {
        rows.push(("note", note));
    }
    let comments: String = table::lines(&rows).lines().map(|line| format!("# {line}\n")).collect();
    Ok(format!("{}\n{comments}", scene.to_toml(&setup.boundary, &times)))
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
