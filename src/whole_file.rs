//! Files that are read as a whole.

use std::fs;
use std::io;
use std::path::Path;

/// The bytes of a file. A folder, a device or a pipe, which may never end, is refused.
pub(crate) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    check(path)?;
    fs::read(path)
}

/// The text of a file; see [`bytes`].
#[cfg(feature = "import")]
pub(crate) fn text(path: &Path) -> io::Result<String> {
    check(path)?;
    fs::read_to_string(path)
}

fn check(path: &Path) -> io::Result<()> {
    if fs::metadata(path)?.is_file() {
        return Ok(());
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a folder, a device or a pipe, not a file"))
}
