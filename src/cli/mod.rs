//! The command line: `vofkit run`, `vofkit reconstruct`, `vofkit check`, `vofkit new`, `vofkit picture`, `vofkit kernel`,
//! `vofkit study`, `vofkit stress`.
//!
//! - this file: the arguments and what they start;
//! - [`check`]: what a scene will do, without doing it; [`template`]: scenes to start from;
//! - `picture`: results and scenes as PNG; [`kernel`]: tables of cells and planes through the kernel; `study`: combinations of settings;
//!   [`stress`]: extreme cases;
//! - `interrupt`: Ctrl-C; [`progress`]: how far a run is; [`terminal`]: text and errors on the terminal.
//!
//! Exit codes: 0 done, 1 failed, 2 wrong arguments.

pub mod check;
mod interrupt;
pub mod kernel;
#[cfg(feature = "plot")]
pub mod picture;
pub mod progress;
pub mod stress;
#[cfg(feature = "plot")]
pub mod study;
pub mod template;
pub mod terminal;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use vofkit_geometry::{Hexahedron, Quad};

use crate::report::{still, table};
use crate::run::threads::Pool;
use crate::run::{self, Checkpoint, Checkpoints, Progress, RunError, RunOptions, Silent};
use crate::scene::{Draft, Scene, StillScene};
use interrupt::Interrupt;
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
        #[arg(required_unless_present = "resume")]
        scene: Option<PathBuf>,
        /// Go on with the run that left a checkpoint in this output folder; it has the scene, too.
        #[arg(long, value_name = "DIR", conflicts_with_all = ["scene", "out", "force", "set"])]
        resume: Option<PathBuf>,
        /// Write a checkpoint into the output folder after every so many steps; Ctrl-C writes one in any case.
        #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u32).range(1..))]
        checkpoint: Option<u32>,
        /// To where and how.
        #[command(flatten)]
        work: Work,
    },
    /// Reconstruct the interface of a scene as it stands and write what it asks for; it needs no velocity and no advection.
    Reconstruct {
        /// The scene file.
        scene: PathBuf,
        /// To where and how.
        #[command(flatten)]
        work: Work,
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
    /// Draw a scene, or the results of a run, as PNG. No display is needed.
    #[cfg(feature = "plot")]
    Picture {
        /// Of what, to where and how.
        #[command(flatten)]
        work: picture::Work,
    },
    /// Run a scene for every combination of lists of settings and report error against time.
    #[cfg(feature = "plot")]
    Study {
        /// Which, to where and how.
        #[command(flatten)]
        work: study::Work,
    },
    /// Try stiff and extreme cases and report what falls short; the exit code is then not 0.
    Stress {
        /// Which, and how many.
        #[command(flatten)]
        work: stress::Work,
    },
    /// Ask the geometry kernel about a table of cells and planes.
    Kernel {
        /// What.
        #[command(subcommand)]
        question: kernel::Question,
    },
}

/// To where the results of a scene go, and how.
#[derive(Debug, Args)]
pub struct Work {
    /// The output folder; `out/NAME` with the name of the scene unless it is given.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace the results in an existing output folder.
    #[arg(long)]
    pub force: bool,
    /// Share the work among N threads, one per processor unless it is given; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
    /// Set a value of the scene, such as `'mesh.cells=[32,32]'` or `material.0.name=water`; an empty value removes the key.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl Work {
    /// Does the work of the scene with this name, and prints the account of it.
    fn go<T: Send>(
        self,
        name: &str,
        work: impl FnOnce(&RunOptions, &mut dyn Progress) -> Result<T, RunError> + Send,
        text: impl FnOnce(&T, &Path) -> String,
    ) -> Result<(), Failure> {
        let folder = self.out.unwrap_or_else(|| PathBuf::from("out").join(name));
        let pool = Pool::new(self.threads)?;
        let options = RunOptions { folder, force: self.force, threads: pool.threads() };
        let mut progress: Box<dyn Progress> = if self.quiet { Box::new(Silent) } else { progress::chosen() };
        let summary = pool.install(|| work(&options, &mut *progress))?;
        if self.quiet { Ok(()) } else { terminal::print(&text(&summary, &options.folder)) }
    }
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
        Command::Run { scene, resume, checkpoint, mut work } => {
            let from = resume.map(|folder| Checkpoint::read(&folder)).transpose()?;
            let scene = match (&from, scene) {
                (Some(checkpoint), _) => {
                    work.out = Some(checkpoint.folder().to_owned());
                    checkpoint.scene()?
                }
                (None, scene) => Scene::load(scene.unwrap_or_default(), &work.set)?,
            };
            let interrupt = Interrupt::listen()?;
            let every = checkpoint.unwrap_or(0) as usize;
            let checkpoints = Checkpoints { every, stop: Some(interrupt.stop.clone()) };
            let run = |options: &RunOptions, progress: &mut dyn Progress| {
                let progress = &mut interrupt.watch(progress);
                match &scene {
                    Scene::Plane(scene) => {
                        run::run_with_checkpoints::<Quad, 2>(scene, options, &checkpoints, from, progress)
                    }
                    Scene::Space(scene) => run::run_with_checkpoints::<Hexahedron, 3>(
                        scene,
                        options,
                        &checkpoints,
                        from,
                        progress,
                    ),
                }
            };
            work.go(scene.name(), run, table::summary)
        }
        Command::Reconstruct { scene, work } => {
            let scene = Draft::load(&scene, &work.set)?.still()?;
            let reconstruct = |options: &RunOptions, progress: &mut dyn Progress| match &scene {
                StillScene::Plane(scene) => run::still::reconstruct::<Quad, 2>(scene, options, progress),
                StillScene::Space(scene) => {
                    run::still::reconstruct::<Hexahedron, 3>(scene, options, progress)
                }
            };
            work.go(scene.name(), reconstruct, still::text)
        }
        Command::Check { scene, set } => match check::draft(Draft::load(scene, &set)?) {
            Ok(text) => terminal::print(&text),
            Err(error) => {
                let lines = error.details().iter().map(|line| format!("{line}\n"));
                terminal::print(&lines.collect::<String>())?;
                Err(error.into())
            }
        },
        Command::New { kind } => terminal::print(&template::text(kind)),
        #[cfg(feature = "plot")]
        Command::Picture { work } => picture::draw(work),
        #[cfg(feature = "plot")]
        Command::Study { work } => study::run(work),
        Command::Stress { work } => stress::run(work),
        Command::Kernel { question } => kernel::ask(question),
    }
}
