//! Pictures of meshes, volume fractions and interfaces, as SVG in two dimensions and as PNG in two and three. No display is needed.
//!
//! - this file: what a picture shows, and the files;
//! - `flat`: two dimensions, as SVG, with `path`, which writes lines and polygons in few characters;
//! - `solid`: three dimensions, with `camera`, where they are seen from, and `depth`, what hides what;
//! - `pieces`: fragments in colours of their own;
//! - `sheet`: size, title and legend; `raster`: from SVG to pixels, with the font that comes with the program;
//! - `pixels`: from there to PNG files, also of many pictures as an animation.

mod camera;
mod depth;
mod flat;
mod path;
mod pieces;
mod pixels;
mod raster;
mod sheet;
mod solid;

use std::path::Path;

use vofkit_geometry::{Cell, Vector};

pub use self::camera::{Slice, View};
use self::pieces::ByPiece;
pub use self::pixels::{Pixels, write_animation};
use super::palette::{AREAS, Colour};
use super::{ExportError, Snapshot, check_length, check_materials, write_file};
use crate::facet::Facet;

/// How a picture shows what there is.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Width and height in pixels; about 800 where it is left open.
    pub size: Option<[u32; 2]>,
    /// From where three dimensions are seen; from [`View::ISO`] where it is left open.
    pub view: Option<View>,
    /// A layer of nodes in three dimensions whose mesh lines are drawn.
    pub slice: Option<Slice>,
    /// Whether each connected piece of a material has a colour of its own, and not each material; small pieces share one if there
    /// are many.
    pub fragments: bool,
    /// Whether mesh lines are drawn; in three dimensions the edges of the whole mesh.
    pub mesh: bool,
    /// Whether normals are drawn on the interface.
    pub normals: bool,
}

impl Default for Look {
    fn default() -> Self {
        let (size, view, slice) = (None, None, None);
        Self { size, view, slice, fragments: false, mesh: true, normals: false }
    }
}

/// Cells whose meshes can be drawn.
pub trait Paint<const D: usize>: Cell<D> {
    /// A picture, with a colour for each material.
    ///
    /// # Errors
    /// What the look and the mesh do not let be drawn.
    fn pixels(snapshot: &Snapshot<'_, Self, D>, colours: &[Colour], look: &Look) -> Result<Pixels, String>;
}

/// Writes a picture of a two-dimensional mesh as SVG, about 800 units wide or high.
///
/// Cells are tinted by each material with its volume fraction as opacity; facets are drawn as lines in a
/// darker shade, unless they have points that are not finite. Mesh lines are left out where they would lie closer than 2.5 units.
///
/// # Errors
/// Fractions that do not fit names or mesh, a facet whose material has no name, and whatever the file system
/// reports.
pub fn write_svg<C: Cell<2>>(
    path: impl AsRef<Path>,
    snapshot: &Snapshot<'_, C, 2>,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    check(path, snapshot)?;
    let (document, _) = flat::document(snapshot, &AREAS, &Look::default())
        .map_err(|reason| ExportError::data(path, reason))?;
    write_file(path, |writer| svg::write(writer, &document))
}

/// Writes a picture as PNG: in two dimensions what [`write_svg`] shows, in three the shaded interfaces.
///
/// # Errors
/// As [`write_svg`], and a look that does not fit the mesh.
pub fn write_png<C: Paint<D>, const D: usize>(
    path: impl AsRef<Path>,
    snapshot: &Snapshot<'_, C, D>,
    look: &Look,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    draw(path, snapshot, look)?.write(path)
}

/// Draws the picture that [`write_png`] writes; errors name the file that it is for.
///
/// # Errors
/// As [`write_png`], but for the file system.
pub fn draw<C: Paint<D>, const D: usize>(
    path: impl AsRef<Path>,
    snapshot: &Snapshot<'_, C, D>,
    look: &Look,
) -> Result<Pixels, ExportError> {
    let path = path.as_ref();
    check(path, snapshot)?;
    let drawn = if look.fragments {
        let pieces = ByPiece::new(snapshot);
        C::pixels(&pieces.snapshot(snapshot), &pieces.colours, look)
    } else {
        C::pixels(snapshot, &AREAS, look)
    };
    drawn.map_err(|reason| ExportError::data(path, reason))
}

fn check<C: Cell<D>, const D: usize>(path: &Path, snapshot: &Snapshot<'_, C, D>) -> Result<(), ExportError> {
    let Snapshot { mesh, names, fractions, facets, .. } = *snapshot;
    check_materials(path, names, facets)?;
    if names.len() != fractions.len() {
        let reason = format!("{} materials have names, {} have fractions", names.len(), fractions.len());
        return Err(ExportError::data(path, reason));
    }
    for (name, fractions) in names.iter().zip(fractions) {
        check_length(path, name, fractions.len(), mesh.grid().len())?;
    }
    let cells = mesh.grid().len();
    match facets.iter().find(|facet| facet.cell >= cells) {
        None => Ok(()),
        Some(Facet { cell, .. }) => {
            let reason = format!("there is an interface in cell {cell}, but the mesh has {cells} cells");
            Err(ExportError::data(path, reason))
        }
    }
}

/// The parts of a facet that have points, all of them finite.
fn finite_loops<const D: usize>(facet: &Facet<D>) -> impl Iterator<Item = &Vec<Vector<D>>> {
    let finite =
        |points: &&Vec<Vector<D>>| !points.is_empty() && points.iter().flatten().all(|x| x.is_finite());
    facet.loops.iter().filter(finite)
}
