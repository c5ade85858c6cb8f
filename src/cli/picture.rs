//! Pictures of scenes and results, as PNG.

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::Args;
use vofkit_geometry::{Hexahedron, Quad};

use super::terminal::{self, Failure};
use crate::export::Snapshot;
use crate::export::picture::{Look, Paint, Slice, View, write_png};
use crate::run::moment::{self, Moment};
use crate::run::output::title;
use crate::run::results::Stored;
use crate::run::{Draw, RunError};
use crate::scene::{Draft, Resolved, Scene, Still, StillScene};

/// Least and largest width and height of a picture, in pixels.
const SIZES: std::ops::RangeInclusive<u32> = 100..=4096;

/// Of what, to where and how.
#[derive(Debug, Args)]
pub struct Work {
    /// A scene, or the output folder of a run.
    pub source: PathBuf,
    /// The time: scenes are run up to it, 0 unless it is given; of results the nearest state is drawn, the last unless it is given.
    #[arg(long, value_name = "T", value_parser = time, allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// The file to write; NAME.png with the name of the scene unless it is given.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Pixels; about 800 for the longer side unless they are given.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// From where three dimensions are seen: front, right, back, left, top, bottom, iso, or AZIMUTH,ELEVATION in degrees.
    #[arg(long, allow_hyphen_values = true)]
    pub view: Option<View>,
    /// Draw the lines of the mesh in a layer of its nodes, such as z=16 (three dimensions).
    #[arg(long, value_name = "AXIS=LAYER")]
    pub slice: Option<Slice>,
    /// Give each connected piece of a material a colour of its own.
    #[arg(long)]
    pub fragments: bool,
    /// Draw the normals.
    #[arg(long)]
    pub normals: bool,
    /// Leave out the lines of the mesh.
    #[arg(long)]
    pub no_mesh: bool,
    /// Set a value of the scene, as in `run`.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

fn time(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "give a number, such as 1.5".to_owned())
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |word: &str| word.parse().ok().filter(|side| SIZES.contains(side));
    match text.split_once('x').map(|(width, height)| (side(width), side(height))) {
        Some((Some(width), Some(height))) => Ok([width, height]),
        _ => Err(format!(
            "give width and height from {} to {} pixels, such as 800x600",
            SIZES.start(),
            SIZES.end()
        )),
    }
}

/// Draws a picture and says where it is.
///
/// # Errors
/// A source that cannot be read or run, a time that it does not have, and a file that cannot be written.
pub fn draw(work: Work) -> Result<(), Failure> {
    if let Some(out) = work.out.as_ref().filter(|out| out.extension() != Some(OsStr::new("png"))) {
        return Err(Failure::other(
            format!("{} is not the name of a picture", out.display()),
            "give a name that ends with .png, the format in which pictures are written",
        ));
    }
    if !work.source.is_dir() {
        let draft = Draft::load(&work.source, &work.set)?;
        return if draft.moves() {
            match draft.scene()? {
                Scene::Plane(scene) => work.run::<Quad, 2>(&scene),
                Scene::Space(scene) => work.run::<Hexahedron, 3>(&scene),
            }
        } else {
            match draft.still()? {
                StillScene::Plane(scene) => work.still::<Quad, 2>(&scene),
                StillScene::Space(scene) => work.still::<Hexahedron, 3>(&scene),
            }
        };
    }
    if !work.set.is_empty() {
        return Err(Failure::other(
            format!("--set does not fit {}, which holds results", work.source.display()),
            "name the scene, or leave out --set",
        ));
    }
    let stored = Stored::open(&work.source, work.time)?;
    match stored.dimension() {
        2 => work.write(&stored.name, &stored.moment::<Quad, 2>()?),
        _ => work.write(&stored.name, &stored.moment::<Hexahedron, 3>()?),
    }
}

impl Work {
    fn run<C: Draw<D> + Paint<D>, const D: usize>(&self, scene: &Resolved<D>) -> Result<(), Failure> {
        let moment = moment::of_run::<C, D>(scene, self.time.unwrap_or(0.0))?;
        self.write(&scene.name, &moment)
    }

    fn still<C: Draw<D> + Paint<D>, const D: usize>(&self, scene: &Still<D>) -> Result<(), Failure> {
        if let Some(time) = self.time.filter(|&time| time != 0.0) {
            return Err(Failure::other(
                format!("there is no time {time}: nothing moves in the scene"),
                "leave out --time, or add a [velocity] section to the scene",
            ));
        }
        self.write(&scene.name, &moment::of_still::<C, D>(scene)?)
    }

    fn write<C: Paint<D>, const D: usize>(&self, name: &str, moment: &Moment<C, D>) -> Result<(), Failure> {
        let Moment { time, mesh, names, fractions, facets } = moment;
        if names.is_empty() {
            return Err(Failure::other(
                format!("there are no materials in {}, and so no picture", self.source.display()),
                "set picture = true in [output] for pictures of fields",
            ));
        }
        let look = Look {
            size: self.size,
            view: self.view,
            slice: self.slice,
            fragments: self.fragments,
            mesh: !self.no_mesh,
            normals: self.normals,
        };
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.png")));
        let title = title(name, *time);
        let snapshot = Snapshot { mesh, names, fractions, facets, title: &title };
        write_png(&out, &snapshot, &look).map_err(RunError::from)?;
        terminal::print(&format!("{}: {title}\n", out.display()))
    }
}
