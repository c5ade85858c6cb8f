//! The command line: `vofkit run`, `vofkit check`, `vofkit new`, `vofkit kernel`.
//!
//! - this file: the arguments and what they start;
//! - [`check`]: what a scene will do, without doing it; [`template`]: scenes to start from;
//! - [`kernel`]: tables of cells and planes through the kernel;
//! - [`progress`]: how far a run is; [`terminal`]: text and errors on the terminal; [`threads`]: how many work.
//!
//! Exit codes: 0 done, 1 failed, 2 wrong arguments.

pub mod check;
pub mod kernel;
pub mod progress;
pub mod template;
pub mod terminal;
pub mod threads;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use vofkit_geometry::{Hexahedron, Quad};

use crate::report::{Summary, table};
use crate::run::{self, Progress, RunError, RunOptions, Silent};
use crate::scene::Scene;
use template::Kind;
use terminal::Failure;

/// Volume-of-fluid reconstruction and advection on distorted quadrilateral and hexahedral meshes.
#[derive(Debug, Parser)]
#[command(name = "vofkit", version, about, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene and write what it asks for.
    Run {
        /// The scene file.
        scene: PathBuf,
        /// The output folder; `out/NAME` with the name of the scene unless it is given.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Replace the results in an existing output folder.
        #[arg(long)]
        force: bool,
        /// Share the work among N threads, one per processor unless it is given; the results do not depend on it.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        /// Print nothing but errors.
        #[arg(long)]
        quiet: bool,
        /// Set a value of the scene, such as `'mesh.cells=[32,32]'` or `material.0.name=water`; an empty value removes the key.
        #[arg(long, value_name = "KEY=VALUE")]
        set: Vec<String>,
    },
    /// Validate a scene and print it with every default filled in, and what it will compute and skip.
    Check {
        /// The scene file.
        scene: PathBuf,
        /// Set a value of the scene, as in `run`.
        #[arg(long, value_name = "KEY=VALUE")]
        set: Vec<String>,
    },
    /// Print a scene to start from, with every key explained.
    New {
        /// Which one.
        kind: Kind,
    },
    /// Ask the geometry kernel about a table of cells and planes.
    Kernel {
        /// What.
        #[command(subcommand)]
        question: kernel::Question,
    },
}

/// Reads the arguments of the process and does what they say.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Fails only where there is nobody to read it.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match execute(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal::report(&failure);
            ExitCode::FAILURE
        }
    }
}

/// Does what the arguments say.
///
/// # Errors
/// A scene that cannot be run, a run or a table that failed, or a standard output that cannot be written.
pub fn execute(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run { scene, out, force, threads, quiet, set } => {
            let scene = Scene::load(scene, &set)?;
            let folder = out.unwrap_or_else(|| PathBuf::from("out").join(scene.name()));
            let pool = threads::Pool::new(threads)?;
            let options = RunOptions { folder, force, threads: pool.threads() };
            let mut progress: Box<dyn Progress> = if quiet { Box::new(Silent) } else { progress::chosen() };
            let summary = pool.install(|| run_scene(&scene, &options, &mut *progress))?;
            if quiet { Ok(()) } else { terminal::print(&table::summary(&summary, &options.folder)) }
        }
        Command::Check { scene, set } => {
            let scene = Scene::load(scene, &set)?;
            let checked = match &scene {
                Scene::Plane(scene) => check::report::<Quad, 2>(scene),
                Scene::Space(scene) => check::report::<Hexahedron, 3>(scene),
            };
            match checked {
                Ok(text) => terminal::print(&text),
                Err(error) => {
                    let lines = error.details().iter().map(|line| format!("{line}\n"));
                    terminal::print(&lines.collect::<String>())?;
                    Err(error.into())
                }
            }
        }
        Command::New { kind } => terminal::print(&template::text(kind)),
        Command::Kernel { question } => kernel::ask(question),
    }
}

fn run_scene(scene: &Scene, options: &RunOptions, progress: &mut dyn Progress) -> Result<Summary, RunError> {
    match scene {
        Scene::Plane(scene) => run::run::<Quad, 2>(scene, options, progress),
        Scene::Space(scene) => run::run::<Hexahedron, 3>(scene, options, progress),
    }
}
