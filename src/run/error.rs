//! Why a run failed.

use std::fmt;
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, SourceCode};

use crate::advection::StepError;
use crate::export::ExportError;
use crate::import::ImportError;
use crate::interface::ReconstructionError;
use crate::scene::SceneError;
use crate::volume_associated::TransportError;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be run.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The output folder cannot be used.
    #[error("the output folder {} {problem}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What would be right.
        help: String,
    },
    /// A checkpoint that is of no use.
    #[error("the checkpoint {} {problem}", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What would be right.
        help: &'static str,
    },
    /// The run was stopped from outside, and can go on.
    #[error("stopped after step {step} of {steps}; go on with: vofkit run --resume {}", folder.display())]
    Stopped {
        /// The steps that are done.
        step: usize,
        /// All steps.
        steps: usize,
        /// The output folder with the checkpoint.
        folder: PathBuf,
    },
    /// A file of a run that cannot be read back.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// A file was not written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A step that cannot be done.
    #[error("step {step} of {steps}, from time {time}, failed: {error}")]
    Step {
        /// The step, counted from 1.
        step: usize,
        /// All steps.
        steps: usize,
        /// The time at which it starts.
        time: f64,
        /// Its Courant number at the largest amplitude.
        courant: f64,
        /// What went wrong.
        error: StepError,
    },
    /// A step of the fields that cannot be done.
    #[error("step {step} of {steps}, from time {time}, failed for the fields: {error}")]
    Field {
        /// The step, counted from 1.
        step: usize,
        /// All steps.
        steps: usize,
        /// The time at which it starts.
        time: f64,
        /// What went wrong.
        error: TransportError,
    },
    /// An interface that was not found, for output.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
}

impl Diagnostic for RunError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::Scene(error) => error.help(),
            Self::Folder { help, .. } => Some(Box::new(help)),
            Self::Checkpoint { help, .. } => Some(Box::new(help)),
            Self::Import(error) => Some(Box::new(error.help())),
            Self::Step { courant, error: StepError::Overdrawn { .. }, .. } => Some(Box::new(format!(
                "lower advection.courant, now {courant:.4}, or set advection.substeps = \"auto\""
            ))),
            _ => None,
        }
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        if let Self::Scene(error) = self { error.source_code() } else { None }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        if let Self::Scene(error) = self { error.labels() } else { None }
    }
}
