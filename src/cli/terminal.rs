//! Text to standard output, and errors to standard error.

use std::fmt;
use std::io::{self, IsTerminal, Write};

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};

use crate::export::ExportError;
use crate::run::RunError;
use crate::run::threads::ThreadsError;
use crate::scene::SceneError;

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// A run.
    Run(RunError),
    /// Something else.
    Other {
        /// What went wrong.
        message: String,
        /// What would be right.
        help: String,
    },
}

impl Failure {
    /// A failure with a message of its own.
    pub fn other(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Other { message: message.into(), help: help.into() }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Run(error.into())
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::Run(error.into())
    }
}

impl From<ThreadsError> for Failure {
    fn from(error: ThreadsError) -> Self {
        Self::other(error.to_string(), error.help)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run(error) => error.fmt(f),
            Self::Other { message, .. } => f.write_str(message),
        }
    }
}

impl std::error::Error for Failure {}

impl Diagnostic for Failure {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::Run(error) => error.help(),
            Self::Other { help, .. } => Some(Box::new(help)),
        }
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        if let Self::Run(error) = self { error.source_code() } else { None }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        if let Self::Run(error) = self { error.labels() } else { None }
    }
}

/// Prints text. A reader that has had enough is no failure.
///
/// # Errors
/// A standard output that cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::other(
            format!("cannot write to standard output: {error}"),
            "redirect it to where there is space",
        )),
        _ => Ok(()),
    }
}

/// Prints an error: with colours and frames on a terminal, else in plain characters.
pub fn report(failure: &Failure) {
    let colours = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let theme = if colours { GraphicalTheme::unicode() } else { GraphicalTheme::none() };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_links(false)
        .with_wrap_lines(false)
        .without_syntax_highlighting();
    let mut text = String::new();
    if handler.render_report(&mut text, failure).is_err() {
        text = format!("error: {failure}\n");
    }
    // There is nowhere left to report to.
    let _ = io::stderr().lock().write_all(text.as_bytes());
}
