//! `[reconstruction]` and `[advection]`: methods and time steps.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::PositionMethod;

use super::context::{Context, default};
use super::error::SceneError;
use crate::advection::{Scheme, SweepAxes, SweepOrder};
use crate::interface::{Materials, Reconstruction};
use crate::normal::NormalMethod;

/// Larger remainders than this are no wisps.
const LARGEST_WISP: f64 = 0.1;

/// The Courant number of scenes that give none.
const DEFAULT_COURANT: f64 = 0.5;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with normal, position, materials")]
pub(super) struct ReconstructionSection {
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<Spanned<String>>,
    position: Spanned<String>,
    materials: Spanned<String>,
}

impl Default for ReconstructionSection {
    fn default() -> Self {
        let word = |text: &str| default(text.to_owned());
        Self { normal: None, position: word("auto"), materials: word("nested") }
    }
}

impl ReconstructionSection {
    /// The normal method, once it is [resolved](Self::resolve).
    pub(super) fn normal_word(&self) -> &str {
        self.normal.as_ref().map_or("", |normal| normal.get_ref())
    }

    /// Swartz' normals are the default where they are worth their time: in the plane, and in space where nothing moves. What moves in space ends in
    /// thin sheets, of which so many cells take every round that Youngs' on a finer mesh come to the same error sooner. And where the
    /// regions that leave a cell may overlap, what corrections leave behind grows under Swartz' normals on distorted hexahedra.
    pub(super) fn resolve(
        &mut self,
        moves_in_space: bool,
        regions_overlap: bool,
        context: Context<'_>,
    ) -> Result<Reconstruction, SceneError> {
        let usual = if moves_in_space || regions_overlap { "youngs" } else { "swartz" };
        let normal = self.normal.get_or_insert_with(|| default(usual.to_owned()));
        let normals = [
            ("youngs", NormalMethod::Youngs),
            ("youngs_logical", NormalMethod::YoungsLogical),
            ("least_squares", NormalMethod::LeastSquares),
            ("lvira", NormalMethod::Lvira),
            ("elvira", NormalMethod::Elvira),
            ("swartz", NormalMethod::Swartz),
            ("slic", NormalMethod::Slic),
            ("myc", NormalMethod::Myc),
            ("mof", NormalMethod::Mof),
        ];
        let positions = [
            ("auto", PositionMethod::Auto),
            ("newton", PositionMethod::Newton),
            ("brent", PositionMethod::Brent),
        ];
        let materials = [
            ("nested", Materials::Nested),
            ("listed", Materials::Listed),
            ("independent", Materials::Independent),
        ];
        Ok(Reconstruction {
            normal: context.word("the normal method", normal, &normals)?,
            position: context.word("the position method", &self.position, &positions)?,
            materials: context.word(
                "the reconstruction of several materials",
                &self.materials,
                &materials,
            )?,
        })
    }

    /// Refuses methods that know a material only where it starts.
    pub(super) fn check_moves(&self, method: Reconstruction, context: Context<'_>) -> Result<(), SceneError> {
        if !method.normal.reads_centroids() {
            return Ok(());
        }
        let place = self.normal.as_ref().map(Spanned::span).unwrap_or_default();
        Err(context.error(
            place,
            format!(
                "the normal method \"{}\" needs the centroids of the materials, and fractions that were moved have none",
                self.normal_word()
            ),
            "use \"swartz\", \"lvira\" or \"youngs\", or write the interface as it is by `vofkit reconstruct`",
        ))
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "a table with mode, scheme, sweep_axes, sweep_order, substeps, wisps, courant, end_time, steps"
)]
pub(super) struct AdvectionSection {
    mode: Spanned<String>,
    scheme: Spanned<String>,
    sweep_axes: Spanned<String>,
    sweep_order: Spanned<String>,
    substeps: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wisps: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    courant: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end_time: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Spanned<i64>>,
    /// Where the section is.
    #[serde(skip)]
    pub(super) place: Range<usize>,
}

impl Default for AdvectionSection {
    fn default() -> Self {
        let word = |text: &str| default(text.to_owned());
        Self {
            mode: word("flow"),
            scheme: word("sweeps"),
            sweep_axes: word("logical"),
            sweep_order: word("alternating"),
            substeps: word("error"),
            wisps: None,
            courant: None,
            end_time: None,
            steps: None,
            place: 0..0,
        }
    }
}

/// What happens above the Courant number that the scheme can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Substeps {
    /// The run is refused.
    Error,
    /// Each step is split.
    Auto,
    /// The run goes on, and the ledger shows what it cost.
    Off,
}

/// The two numbers that fix the time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// The fewest equal steps that keep the Courant number and end at `end_time`.
    CourantToTime {
        /// The largest Courant number.
        courant: f64,
        /// The end.
        end_time: f64,
    },
    /// A number of steps with this Courant number.
    CourantForSteps {
        /// The Courant number.
        courant: f64,
        /// Steps.
        steps: u64,
    },
    /// A number of equal steps that end at `end_time`.
    StepsToTime {
        /// Steps.
        steps: u64,
        /// The end.
        end_time: f64,
    },
}

impl Stepping {
    /// The end, where it is given.
    pub fn end_time(&self) -> Option<f64> {
        match *self {
            Self::CourantToTime { end_time, .. } | Self::StepsToTime { end_time, .. } => Some(end_time),
            Self::CourantForSteps { .. } => None,
        }
    }
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The materials; the mesh stands still.
    Flow,
    /// The mesh; the materials rest.
    Remesh,
}

/// How the materials are moved.
#[derive(Clone, Debug, PartialEq)]
pub struct AdvectionSetup {
    /// What moves.
    pub mode: Mode,
    /// How the volumes are moved.
    pub scheme: Scheme,
    /// The directions of the sweeps.
    pub sweep_axes: SweepAxes,
    /// Their order.
    pub sweep_order: SweepOrder,
    /// What happens above the limit of the scheme.
    pub substeps: Substeps,
    /// The fraction below which wisps are removed; none keeps them.
    pub wisps: Option<f64>,
    /// The time steps.
    pub stepping: Stepping,
}

impl AdvectionSection {
    pub(super) fn resolve(&mut self, context: Context<'_>) -> Result<AdvectionSetup, SceneError> {
        let modes = [("flow", Mode::Flow), ("remesh", Mode::Remesh)];
        let mode = context.word("the mode", &self.mode, &modes)?;
        if mode == Mode::Remesh {
            // The motion is given from its start to its end, which need have no time.
            self.end_time.get_or_insert(default(1.0));
        }
        let schemes =
            [Scheme::Sweeps, Scheme::Isotropic, Scheme::WeymouthYue, Scheme::Unsplit, Scheme::Remap]
                .map(|s| (s.name(), s));
        let orders = [("alternating", SweepOrder::Alternating), ("symmetric", SweepOrder::Symmetric)];
        let axes = [("logical", SweepAxes::Logical), ("cartesian", SweepAxes::Cartesian)];
        let substeps = [("error", Substeps::Error), ("auto", Substeps::Auto), ("off", Substeps::Off)];
        Ok(AdvectionSetup {
            mode,
            scheme: context.word("the scheme", &self.scheme, &schemes)?,
            sweep_axes: context.word("sweep_axes", &self.sweep_axes, &axes)?,
            sweep_order: context.word("sweep_order", &self.sweep_order, &orders)?,
            substeps: context.word("substeps", &self.substeps, &substeps)?,
            wisps: self.wisps(context)?,
            stepping: self.stepping(context)?,
        })
    }

    fn wisps(&self, context: Context<'_>) -> Result<Option<f64>, SceneError> {
        let Some(wisps) = &self.wisps else { return Ok(None) };
        let below = *wisps.get_ref();
        if below > 0.0 && below <= LARGEST_WISP {
            return Ok(Some(below));
        }
        Err(context.error(
            wisps.span(),
            format!("advection.wisps is {below}"),
            format!("give the fraction below which detached remainders are removed, at most {LARGEST_WISP}"),
        ))
    }

    fn stepping(&mut self, context: Context<'_>) -> Result<Stepping, SceneError> {
        let steps = match &self.steps {
            None => None,
            Some(steps) => {
                Some(u64::try_from(*steps.get_ref()).ok().filter(|&n| n > 0).ok_or_else(|| {
                    context.error(
                        steps.span(),
                        format!("advection.steps is {}", steps.get_ref()),
                        "give a whole number of at least 1",
                    )
                })?)
            }
        };
        let number = |what, value: &Option<Spanned<f64>>| {
            value.as_ref().map(|value| context.positive(what, value)).transpose()
        };
        let end_time = number("advection.end_time", &self.end_time)?;
        let courant = number("advection.courant", &self.courant)?;
        match (courant, end_time, steps) {
            (None, Some(end_time), Some(steps)) => Ok(Stepping::StepsToTime { steps, end_time }),
            (Some(_), Some(_), Some(_)) => Err(context.error(
                self.steps_place(),
                "courant, end_time and steps are all given; two of them already fix the time step",
                "leave out one of advection.courant, advection.end_time and advection.steps",
            )),
            (_, None, None) => Err(context.error(
                self.steps_place(),
                "there is neither advection.end_time nor advection.steps",
                "say when the run ends: two of courant, end_time and steps fix the time step, and courant is \
                 0.5 unless it is given",
            )),
            (courant, end_time, steps) => {
                let courant =
                    courant.unwrap_or_else(|| *self.courant.insert(default(DEFAULT_COURANT)).get_ref());
                Ok(match (end_time, steps) {
                    (Some(end_time), _) => Stepping::CourantToTime { courant, end_time },
                    (None, steps) => Stepping::CourantForSteps { courant, steps: steps.unwrap_or(1) },
                })
            }
        }
    }

    /// Whether the regions that leave a cell across its faces may overlap, on distorted meshes at least.
    pub(super) fn regions_overlap(&self) -> bool {
        self.scheme.get_ref() == Scheme::Isotropic.name() || self.sweep_axes.get_ref() == "cartesian"
    }

    /// The place of what fixes the size of a step: the Courant number if it is given.
    pub(super) fn courant_place(&self) -> Range<usize> {
        self.courant.as_ref().map_or_else(|| self.steps_place(), Spanned::span)
    }

    /// The place of the mode.
    pub(super) fn mode_place(&self) -> Range<usize> {
        self.mode.span()
    }

    /// The place of the scheme.
    pub(super) fn scheme_place(&self) -> Range<usize> {
        self.scheme.span()
    }

    /// The place of the number of steps, or of the end.
    pub(super) fn steps_place(&self) -> Range<usize> {
        let steps = self.steps.as_ref().map(Spanned::span);
        steps.or_else(|| self.end_time.as_ref().map(Spanned::span)).unwrap_or(self.place.clone())
    }
}
