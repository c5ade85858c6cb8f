//! Ctrl-C, and a polite request to end.

use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::terminal::Failure;

/// The exit code of a process that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// A flag that the first Ctrl-C sets; the second one ends the process at once.
///
/// # Errors
/// The system does not let one listen.
pub(super) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = flag.clone();
    ctrlc::set_handler(move || {
        if set.swap(true, Ordering::Relaxed) {
            exit(INTERRUPTED);
        }
        eprintln!("stopping after this step; once more ends at once");
    })
    .map_err(|error| {
        Failure::other(format!("cannot listen to Ctrl-C: {error}"), "run vofkit from a terminal")
    })?;
    Ok(flag)
}
