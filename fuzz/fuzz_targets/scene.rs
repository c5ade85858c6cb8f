//! Any bytes as a scene file: an error with a place in it, or a scene; small ones are checked as `vofkit check` does, mesh and all.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit::cli::check;
use vofkit::scene::{Draft, StillScene};

/// Meshes with more cells than this are not made.
const CELLS: usize = 400;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(draft) = Draft::parse("fuzz.toml", "fuzz", text, &[]) else { return };
    let cells = match draft.clone().still() {
        Ok(StillScene::Plane(scene)) => {
            scene.mesh.cells.iter().fold(1, |all: usize, &n| all.saturating_mul(n))
        }
        Ok(StillScene::Space(scene)) => {
            scene.mesh.cells.iter().fold(1, |all: usize, &n| all.saturating_mul(n))
        }
        Err(error) => return assert!(!error.message().is_empty()),
    };
    if cells <= CELLS {
        match check::draft(draft) {
            Ok(text) => assert!(text.contains("[mesh]")),
            Err(error) => assert!(!error.message().is_empty()),
        }
    }
});
