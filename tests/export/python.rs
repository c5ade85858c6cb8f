//! What VTK, by way of Python, reads from written files.

use std::path::Path;
use std::process::Command;

/// Keys and values printed about one file.
pub(crate) type Found = Vec<(String, String)>;

/// What the Python script prints about each file; none where Python or pyvista is missing.
pub(crate) fn read_by_vtk(files: &[&Path]) -> Option<Vec<Found>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/read_vtk.py");
    let output = match Command::new("python3").arg(script).args(files).output() {
        Ok(output) if output.status.code() != Some(3) => output,
        Ok(output) => {
            eprintln!("SKIPPED: written files not read by VTK: {}", String::from_utf8_lossy(&output.stderr));
            return None;
        }
        Err(error) => {
            eprintln!("SKIPPED: written files not read by VTK: python3: {error}");
            return None;
        }
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!String::from_utf8_lossy(&output.stderr).contains("ERR"), "{output:?}");
    let mut found: Vec<Found> = Vec::new();
    for line in std::str::from_utf8(&output.stdout).unwrap().lines() {
        let (key, value) = line.split_once('\t').unwrap();
        if key == "file" {
            found.push(Vec::new());
        }
        found.last_mut().unwrap().push((key.to_owned(), value.to_owned()));
    }
    assert_eq!(found.len(), files.len());
    Some(found)
}

/// The values printed under a key.
pub(crate) fn get<'a>(found: &'a Found, key: &str) -> Vec<&'a str> {
    let item = found.iter().find(|item| item.0 == key).unwrap_or_else(|| panic!("no {key:?} in {found:?}"));
    item.1.split_whitespace().collect()
}

pub(crate) fn floats(found: &Found, key: &str) -> Vec<f64> {
    get(found, key).into_iter().map(|value| value.parse().unwrap()).collect()
}
