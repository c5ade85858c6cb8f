//! Pictures of scenes and results, as PNG, and animations of results.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use vofkit_geometry::{Hexahedron, Quad};

use super::terminal::{self, Failure};
use crate::export::Snapshot;
use crate::export::picture::{self, Look, Paint, Pixels, Slice, View, write_animation};
use crate::run::Draw;
use crate::run::moment::{self, Moment};
use crate::run::output::title;
use crate::run::results::Results;
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
    /// Draw all states of a run's results in one file that moves (APNG, which browsers play): 10 a second, or PER_SECOND.
    #[arg(long, value_name = "PER_SECOND", num_args = 0..=1, require_equals = true, default_missing_value = "10",
        value_parser = clap::value_parser!(u16).range(1..=1000), conflicts_with = "time")]
    pub animate: Option<u16>,
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
        if work.animate.is_some() {
            return Err(Failure::other(
                format!("--animate does not fit {}, which is no folder with results", work.source.display()),
                "run the scene with many times in its [output], and name its output folder",
            ));
        }
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
    let results = Results::open(&work.source)?;
    if let Some(per_second) = work.animate {
        return work.film(&results, per_second);
    }
    let stored = results.state(work.time)?;
    match stored.dimension() {
        2 => work.write(&results.name(), &stored.moment::<Quad, 2>()?),
        _ => work.write(&results.name(), &stored.moment::<Hexahedron, 3>()?),
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
        let out = self.out(name);
        self.pixels(&out, name, moment)?.write(&out)?;
        terminal::print(&format!("{}: {}\n", out.display(), title(name, moment.time)))
    }

    /// Draws all states of results in one file.
    fn film(&self, results: &Results, per_second: u16) -> Result<(), Failure> {
        let (name, times) = (results.name(), results.times());
        let out = self.out(&name);
        let frames = u32::try_from(times.len()).unwrap_or(u32::MAX);
        write_animation(&out, frames, per_second, |frame| {
            let stored = results.state(Some(times[frame as usize]))?;
            match stored.dimension() {
                2 => self.pixels(&out, &name, &stored.moment::<Quad, 2>()?),
                _ => self.pixels(&out, &name, &stored.moment::<Hexahedron, 3>()?),
            }
        })?;
        let [first, last] = [times[0], times[times.len() - 1]];
        terminal::print(&format!("{}: {name}, {frames} states, t = {first} to {last}\n", out.display()))
    }

    fn out(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.png")))
    }

    fn pixels<C: Paint<D>, const D: usize>(
        &self,
        out: &Path,
        name: &str,
        moment: &Moment<C, D>,
    ) -> Result<Pixels, Failure> {
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
        let title = title(name, *time);
        let snapshot = Snapshot { mesh, names, fractions, facets, title: &title };
        Ok(picture::draw(out, &snapshot, &look)?)
    }
}
