//! `[output]`: what is written, and when.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::context::{Context, Numbers};
use super::error::SceneError;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with times, interface, fields, picture, history")]
pub(super) struct OutputSection {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) times: Option<Numbers>,
    interface: Vec<Spanned<String>>,
    fields: Spanned<bool>,
    picture: Spanned<bool>,
    history: bool,
}

impl Default for OutputSection {
    fn default() -> Self {
        let no = || super::context::default(false);
        Self { times: None, interface: Vec::new(), fields: no(), picture: no(), history: true }
    }
}

/// What the run writes besides its summary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputSetup {
    /// When interfaces and fields are written; none for the start and the end.
    pub times: Option<Vec<f64>>,
    /// Interfaces as Wavefront OBJ.
    pub obj: bool,
    /// Interfaces as VTK polygons.
    pub vtk: bool,
    /// The mesh with fractions and velocity as VTK structured grid.
    pub fields: bool,
    /// Pictures of the start and the end.
    pub picture: bool,
    /// A table with one line per step.
    pub history: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Obj,
    Vtk,
}

impl OutputSection {
    /// `has_pictures` tells whether there is anything to draw.
    pub(super) fn resolve(
        &self,
        has_pictures: bool,
        context: Context<'_>,
    ) -> Result<OutputSetup, SceneError> {
        let mut setup = OutputSetup {
            fields: *self.fields.get_ref(),
            picture: *self.picture.get_ref(),
            history: self.history,
            ..OutputSetup::default()
        };
        if let Some(times) = &self.times {
            if let Some(odd) = times.get_ref().iter().find(|t| !(t.is_finite() && **t >= 0.0)) {
                return Err(context.error(
                    times.span(),
                    format!("output.times holds {odd}"),
                    "give times of at least 0",
                ));
            }
            setup.times = Some(times.get_ref().clone());
        }
        let built = |feature: &str, there: bool, place| {
            if there {
                return Ok(());
            }
            Err(context.error(
                place,
                format!("this build of vofkit has no `{feature}` output"),
                format!("leave it out, or build with `--features {feature}`"),
            ))
        };
        for format in &self.interface {
            let known = [("obj", Format::Obj), ("vtk", Format::Vtk)];
            match context.word("the interface format", format, &known)? {
                Format::Obj => {
                    built("obj", cfg!(feature = "obj"), format.span())?;
                    setup.obj = true;
                }
                Format::Vtk => {
                    built("vtk", cfg!(feature = "vtk"), format.span())?;
                    setup.vtk = true;
                }
            }
        }
        if setup.fields {
            built("vtk", cfg!(feature = "vtk"), self.fields.span())?;
        }
        if setup.picture {
            built("plot", cfg!(feature = "plot"), self.picture.span())?;
            if !has_pictures {
                return Err(context.error(
                    self.picture.span(),
                    "in three dimensions there are pictures of materials only, and the scene has none",
                    "set picture = false, and look at fields = true with a viewer",
                ));
            }
        }
        Ok(setup)
    }
}
