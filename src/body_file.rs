//! Bodies from files: triangulated surfaces as STL or Wavefront OBJ (feature `surface`), polygons as text.
//!
//! Coordinates of OBJ files and of polygons are read as `f64`; STL files hold `f32`. Triangles are counted from 1, in the order of the
//! file; polygons of OBJ files are split into triangles first.

use std::io;
use std::path::{Path, PathBuf};

use vofkit_geometry::Vector;

use crate::shape::{Body, BodyError};
use crate::whole_file;

/// Why a file gives no body.
#[derive(Debug, thiserror::Error)]
pub enum BodyFileError {
    /// The file system refused.
    #[error("cannot read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        error: io::Error,
    },
    /// A name that does not end in what this dimension reads.
    #[error("{} is no file of a body {}", path.display(), if *dimension == 2 { "in the plane" } else { "in space" })]
    Kind {
        /// The file.
        path: PathBuf,
        /// 2 or 3.
        dimension: usize,
    },
    /// What stands in the file is not what its name says.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        problem: String,
    },
    /// A surface that bounds no body.
    #[error("{}: {}", path.display(), error.told(lines))]
    Surface {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: BodyError,
        /// The lines on which the segments of an outline start, counted from 1; of triangles none.
        lines: Vec<usize>,
    },
}

impl BodyFileError {
    /// What would be right.
    pub fn help(&self) -> &'static str {
        match self {
            Self::Read { error, .. } if error.kind() == io::ErrorKind::NotFound => {
                "name an existing file; its path is relative to the folder of the scene file"
            }
            Self::Read { .. } => "name a readable file",
            Self::Kind { dimension: 2, .. } => {
                "in two dimensions name a text file, .txt or .csv, of lines \"x, y\""
            }
            Self::Kind { .. } if cfg!(feature = "surface") => "in three dimensions name an .stl or .obj file",
            Self::Kind { .. } => "build vofkit with the feature `surface` to read .stl and .obj files",
            Self::Content { .. } => "write the file again, or name another one",
            Self::Surface { error: BodyError::Range { .. }, .. } => {
                "give the coordinates in other units; `scale` in the scene brings them back"
            }
            Self::Surface { .. } => {
                "repair the surface: every edge belongs to two triangles that run along it in opposite ways, and its parts do not overlap"
            }
        }
    }
}

/// Reads a body: `.stl` or `.obj` in three dimensions; in two, `.txt` or `.csv` with a point, `x, y`, on each line and a blank line
/// between loops.
///
/// # Errors
/// See [`BodyFileError`].
pub fn read<const D: usize>(path: &Path) -> Result<Body<D>, BodyFileError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let reader: Reader = match (D, extension.as_str()) {
        (2, "txt" | "csv") => polygons,
        #[cfg(feature = "surface")]
        (3, "stl") => triangles::stl,
        #[cfg(feature = "surface")]
        (3, "obj") => triangles::obj,
        _ => return Err(BodyFileError::Kind { path: path.to_owned(), dimension: D }),
    };
    let bytes =
        whole_file::bytes(path).map_err(|error| BodyFileError::Read { path: path.to_owned(), error })?;
    let Pieces { coordinates, lines } =
        reader(&bytes).map_err(|problem| BodyFileError::Content { path: path.to_owned(), problem })?;
    let piece = |all: &[f64]| std::array::from_fn(|i| Vector::from_fn(|k, _| all[D * i + k]));
    let surface: Vec<[Vector<D>; D]> = coordinates.chunks_exact(D * D).map(piece).collect();
    Body::new(&surface).map_err(|error| BodyFileError::Surface { path: path.to_owned(), error, lines })
}

/// The pieces of a surface.
#[derive(Default)]
struct Pieces {
    /// The coordinates of the corners of all of them.
    coordinates: Vec<f64>,
    /// The lines on which segments start.
    lines: Vec<usize>,
}

/// From the bytes of a file to the pieces in it, or what is wrong with them.
type Reader = fn(&[u8]) -> Result<Pieces, String>;

fn polygons(bytes: &[u8]) -> Result<Pieces, String> {
    let text = std::str::from_utf8(bytes).map_err(|error| format!("it is not text: {error}"))?;
    let mut pieces = Pieces::default();
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut lines: Vec<usize> = Vec::new();
    // A blank line behind the last one ends the last loop.
    for (number, line) in text.lines().chain([""]).enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if !line.is_empty() {
            let numbers = line.split([',', ' ', '\t', ';']).filter(|word| !word.is_empty());
            let numbers: Result<Vec<f64>, _> = numbers.map(str::parse).collect();
            match numbers.as_deref() {
                Ok(&[x, y]) if x.is_finite() && y.is_finite() => {
                    points.push([x, y]);
                    lines.push(number + 1);
                }
                _ => return Err(format!("line {} is \"{line}\", not two finite numbers: x, y", number + 1)),
            }
            continue;
        }
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        match points.len() {
            0 => {}
            1 | 2 => {
                return Err(format!(
                    "the loop that ends before line {} has {} points, not three or more",
                    number + 1,
                    points.len()
                ));
            }
            _ => {
                let next = points.iter().cycle().skip(1);
                pieces
                    .coordinates
                    .extend(points.iter().zip(next).flat_map(|([a, b], [c, d])| [*a, *b, *c, *d]));
                pieces.lines.extend(&lines[..points.len()]);
            }
        }
        points.clear();
        lines.clear();
    }
    Ok(pieces)
}

#[cfg(feature = "surface")]
mod triangles {
    use std::io::Cursor;

    use super::Pieces;

    /// Bytes before the triangles of a binary STL file, and of each of them.
    const HEADER: usize = 84;
    const TRIANGLE: usize = 50;

    pub(super) fn stl(bytes: &[u8]) -> Result<Pieces, String> {
        let count =
            bytes.get(HEADER - 4..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
        let is_binary = count
            .is_some_and(|count| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(count));
        let mut coordinates = Vec::new();
        let mut solid = |mut bytes: Vec<u8>| {
            if is_binary {
                // Some begin like text files.
                bytes[..HEADER - 4].fill(0);
            }
            let mesh = stl_io::read_stl(&mut Cursor::new(bytes))
                .map_err(|error| format!("it is no STL file: {error}"))?;
            for face in &mesh.faces {
                let corners = face.vertices.iter().flat_map(|&i| mesh.vertices[i].0);
                coordinates.extend(corners.map(f64::from));
            }
            Ok::<(), String>(())
        };
        match std::str::from_utf8(bytes) {
            Ok(text) if !is_binary && text.trim_start().starts_with("solid") => {
                for part in text.trim().split_inclusive("endsolid") {
                    // Behind `endsolid` stands the name of the solid, and then the next one.
                    if let Some((_, body)) = part.split_once("facet") {
                        solid(format!("solid \nfacet{body}").into_bytes())?;
                    }
                }
            }
            _ => solid(bytes.to_vec())?,
        }
        Ok(Pieces { coordinates, ..Pieces::default() })
    }

    pub(super) fn obj(bytes: &[u8]) -> Result<Pieces, String> {
        let options = tobj::LoadOptions {
            triangulate: true,
            ignore_points: true,
            ignore_lines: true,
            ..tobj::LoadOptions::default()
        };
        // Materials say nothing about the surface.
        let none = |_: &std::path::Path| Ok((Vec::new(), Default::default()));
        let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, none)
            .map_err(|error| format!("it is no OBJ file: {error}"))?;
        let mut coordinates = Vec::new();
        for mesh in models.iter().map(|model| &model.mesh) {
            for &corner in &mesh.indices {
                let start = 3 * corner as usize;
                let corner =
                    mesh.positions.get(start..start + 3).ok_or("a face names a corner that is not there")?;
                coordinates.extend(corner);
            }
        }
        Ok(Pieces { coordinates, ..Pieces::default() })
    }
}
