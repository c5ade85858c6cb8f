//! Whether a run fits into memory, before any of it is taken: an allocation that fails later would end the process.

use std::hint::black_box;

use crate::scene::{Part, SceneError, Still};

/// Halvings in the search for how much memory there is; a percent is as much as anyone wants to know.
const HALVINGS: usize = 7;

/// Whether there are about `needed` bytes.
///
/// # Errors
/// An error at mesh.cells with the memory that is needed and that there is.
pub(super) fn check<const D: usize>(scene: &Still<D>, needed: u64) -> Result<(), SceneError> {
    let unused = unused().unwrap_or(u64::MAX);
    let there = if reserves(needed) { unused } else { unused.min(reservable(needed)) };
    if there >= needed {
        return Ok(());
    }
    let cells = scene.mesh.cells.map(|count| count.to_string()).join(" x ");
    Err(scene.error(
        Part::Mesh,
        format!(
            "a run with {cells} cells takes about {} of memory, and there is {}",
            megabytes(needed),
            megabytes(there)
        ),
        "ask for fewer cells in mesh.cells, or use a machine with more memory",
    ))
}

/// Bytes as people read them.
pub(crate) fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

/// Memory that the system can give without taking it from others; none where it does not tell.
fn unused() -> Option<u64> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    kibibytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// Forgets the most memory that the process had, where the system can.
pub(crate) fn forget_peak() {
    // Where it cannot, the peak is one of all that the process did.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The most memory that the process had since; none where the system does not tell.
pub(crate) fn peak() -> Option<u64> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The bytes of a line that ends in kB.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// Whether the process may have so many bytes more; limits of the process and of the address space show up here.
fn reserves(bytes: u64) -> bool {
    let Ok(bytes) = usize::try_from(bytes) else { return false };
    let mut probe = Vec::<u8>::new();
    let there = probe.try_reserve_exact(bytes).is_ok();
    // What nobody looks at need not be reserved.
    black_box(&probe);
    there
}

/// About how many bytes, fewer than `limit`, the process may have.
fn reservable(limit: u64) -> u64 {
    let (mut there, mut missing) = (0, limit);
    for _ in 0..HALVINGS {
        let middle = there + (missing - there) / 2;
        if reserves(middle) { there = middle } else { missing = middle }
    }
    there
}
