//! The text of a scene or study file, or why there is none.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::error::SceneError;

/// These files are written by hand; anything larger is something else.
const LARGEST: u64 = 1 << 20;

/// Reads the file of a `what`, a scene or a study. Nothing above the size limit is read.
pub(crate) fn read_text(path: &Path, what: &str) -> Result<String, SceneError> {
    let shown = path.display();
    let unreadable = |error: io::Error| {
        let help = match error.kind() {
            io::ErrorKind::NotFound if what == "scene" => {
                "name an existing file; `vofkit new disc > disc.toml` makes one"
            }
            io::ErrorKind::NotFound => "name an existing file",
            io::ErrorKind::PermissionDenied => "change its permissions, or name another file",
            _ => "name a readable file",
        };
        SceneError::of_file(format!("cannot read the {what} file {shown}: {error}"), help)
    };
    let too_large = |size: String| {
        SceneError::of_file(
            format!("the {what} file {shown} is too large: {size} the limit of {LARGEST} bytes (1 MiB)"),
            "name another one; they are short texts in TOML",
        )
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(SceneError::of_file(
            format!("cannot read the {what} file {shown}: it is a folder"),
            "name a file inside it, such as one that ends in .toml",
        ));
    }
    if metadata.len() > LARGEST {
        return Err(too_large(format!("its {} bytes are above", metadata.len())));
    }
    let mut bytes = Vec::new();
    // Pipes and devices have no size beforehand.
    File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST {
        return Err(too_large("it goes on beyond".to_owned()));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
        SceneError::of_file(
            format!("the {what} file {shown} is not UTF-8: the byte at offset {at}, in line {line}, does not belong there"),
            "save it as UTF-8 text",
        )
    })
}
