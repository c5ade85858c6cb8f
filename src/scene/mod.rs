//! Scene files: what to run, in TOML, read into typed sections and resolved to the types of the toolkit.
//!
//! - `read`: the text of the file; `overrides`: values set on the command line;
//! - `mesh`, `motion`, `material`, `shape`, `quantity`, `field`, `velocity`, `boundary`, `advection`, `output`: one section each, as it is
//!   written and what it means;
//! - `error`: what is wrong, with the place in the file, `quote`: how much of it is shown; `wording`: names, and what the reader of TOML says;
//! - this file: the whole scene.
//!
//! `vofkit new disc` prints a scene with every key explained.

mod advection;
mod boundary;
mod context;
mod error;
mod field;
mod material;
mod mesh;
mod motion;
mod output;
mod overrides;
mod quantity;
mod quote;
mod read;
mod shape;
mod velocity;
mod wording;

use std::ops::{Deref, Range};
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::Spanned;

pub use advection::{AdvectionSetup, Mode, Stepping, Substeps};
pub use boundary::BoundarySetup;
pub use error::{SceneError, Source};
pub use field::{FieldSetup, Kind, Location, Method};
pub use material::{FileParts, MaterialSetup};
pub use mesh::MeshSetup;
pub use output::OutputSetup;
pub use quantity::QuantitySetup;
pub use velocity::{ReversalSetup, VelocitySetup};

pub(crate) use read::read_text;

use context::{Context, default};
use material::MaterialSection;
use wording::{check_name, unreadable};

use crate::advection::Boundary;
use crate::import::StructuredGrid;
use crate::interface::Reconstruction;
use crate::shape::Shape;

/// Where to learn what scene files can say.
const TEMPLATE_HELP: &str = "`vofkit new disc` prints a scene with every key explained";

/// A scene in two or three dimensions.
#[derive(Clone, Debug)]
pub enum Scene {
    /// On quadrilaterals.
    Plane(Box<Resolved<2>>),
    /// On hexahedra.
    Space(Box<Resolved<3>>),
}

/// A scene of which nothing moves, in two or three dimensions.
#[derive(Clone, Debug)]
pub enum StillScene {
    /// On quadrilaterals.
    Plane(Box<Still<2>>),
    /// On hexahedra.
    Space(Box<Still<3>>),
}

/// What a scene says of one instant, in the words of the toolkit, every default filled in.
#[derive(Clone, Debug)]
pub struct Still<const D: usize> {
    /// The name; that of the output folder too.
    pub name: String,
    /// The mesh.
    pub mesh: MeshSetup<D>,
    /// The materials, the first one on top.
    pub materials: Vec<MaterialSetup<D>>,
    /// Fractions and centroids, where they come from the file of the mesh.
    pub parts: Option<FileParts<D>>,
    /// The boundary.
    pub boundary: BoundarySetup<D>,
    /// The interface reconstruction.
    pub reconstruction: Reconstruction,
    /// What is written.
    pub output: OutputSetup,
    file: SceneFile,
    source: Source,
}

/// A whole scene: that of its start, which it dereferences to, and what moves it.
#[derive(Clone, Debug)]
pub struct Resolved<const D: usize> {
    /// The start.
    pub still: Still<D>,
    /// The quantities that belong to the mesh.
    pub fields: Vec<FieldSetup<D>>,
    /// The velocity at full amplitude.
    pub field: VelocitySetup,
    /// How it changes in time.
    pub reversal: ReversalSetup,
    /// The advection.
    pub advection: AdvectionSetup,
}

impl<const D: usize> Deref for Resolved<D> {
    type Target = Still<D>;

    fn deref(&self) -> &Still<D> {
        &self.still
    }
}

/// A scene file that was read, and not yet taken apart.
#[derive(Clone, Debug)]
pub struct Draft {
    file: SceneFile,
    source: Source,
    dimension: usize,
    grid: Option<StructuredGrid>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a scene")]
struct SceneFile {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<Spanned<String>>,
    mesh: Spanned<mesh::MeshSection>,
    #[serde(skip_serializing_if = "Option::is_none")]
    material: Option<Spanned<Vec<MaterialSection>>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    field: Vec<field::FieldSection>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<velocity::VelocitySection>,
    #[serde(default)]
    boundary: boundary::BoundarySection,
    #[serde(default)]
    reconstruction: advection::ReconstructionSection,
    #[serde(default = "no_advection")]
    advection: Spanned<advection::AdvectionSection>,
    #[serde(default)]
    output: output::OutputSection,
}

fn no_advection() -> Spanned<advection::AdvectionSection> {
    default(advection::AdvectionSection::default())
}

/// A part of a scene that a later stage can find fault with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The box of the mesh.
    Mesh,
    /// The distortion of the mesh.
    Distortion,
    /// Its motion.
    Motion,
    /// The shape of a material.
    Shape(usize),
    /// The velocity field.
    Field,
    /// The start of a quantity that belongs to the mesh.
    Initial(usize),
    /// The ends of an axis.
    Boundary(usize),
    /// The scheme.
    Scheme,
    /// The Courant number, or what fixes it.
    Courant,
    /// The number of steps, or the end.
    Steps,
}

impl Draft {
    /// Reads a scene file and sets the values of `key=value` in it.
    ///
    /// # Errors
    /// A file that cannot be read or is no scene.
    pub fn load(path: impl AsRef<Path>, settings: &[String]) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let fallback = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("scene");
        Self::parse(&path.display().to_string(), fallback, &read_text(path, "scene")?, settings)
    }

    /// Reads the text of a scene; `file` is the name that errors show, `fallback` that of a scene without a name.
    ///
    /// # Errors
    /// As [`Draft::load`].
    pub fn parse(file: &str, fallback: &str, text: &str, settings: &[String]) -> Result<Self, SceneError> {
        let mut source = Source::new(file, text);
        if !settings.is_empty() {
            let changed = overrides::apply(&source, settings)?;
            source = source.changed(changed);
        }
        let mut read: SceneFile =
            toml::from_str(source.text()).map_err(|error| unreadable(&source, &error))?;
        let name = read.name.get_or_insert_with(|| default(fallback.to_owned()));
        let context = Context { source: &source };
        check_name("the scene", name, context)?;
        let (dimension, grid) = read.mesh.get_ref().shape(read.mesh.span(), context)?;
        Ok(Self { file: read, source, dimension, grid })
    }

    /// Whether the scene says anything of what moves.
    pub fn moves(&self) -> bool {
        self.file.moves()
    }

    /// The start of the scene; what moves it is not looked at.
    ///
    /// # Errors
    /// Everything that can be found wrong without making the mesh.
    pub fn still(self) -> Result<StillScene, SceneError> {
        Ok(match self.dimension {
            2 => StillScene::Plane(Box::new(Still::new(self)?)),
            _ => StillScene::Space(Box::new(Still::new(self)?)),
        })
    }

    /// The whole scene.
    ///
    /// # Errors
    /// As [`Draft::still`], and a scene without a velocity.
    pub fn scene(self) -> Result<Scene, SceneError> {
        Ok(match self.dimension {
            2 => Scene::Plane(Box::new(Resolved::new(Still::new(self)?)?)),
            _ => Scene::Space(Box::new(Resolved::new(Still::new(self)?)?)),
        })
    }
}

impl Scene {
    /// Reads a scene file and sets the values of `key=value` in it.
    ///
    /// # Errors
    /// Everything that can be found wrong without making the mesh.
    pub fn load(path: impl AsRef<Path>, settings: &[String]) -> Result<Self, SceneError> {
        Draft::load(path, settings)?.scene()
    }

    /// Reads the text of a scene; `file` is the name that errors show, `fallback` that of a scene without a name.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(file: &str, fallback: &str, text: &str, settings: &[String]) -> Result<Self, SceneError> {
        Draft::parse(file, fallback, text, settings)?.scene()
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        match self {
            Self::Plane(scene) => &scene.name,
            Self::Space(scene) => &scene.name,
        }
    }
}

fn nothing_moves(context: Context<'_>) -> SceneError {
    context.error(
        0..0,
        "missing key `velocity`: nothing moves",
        "add a [velocity] section with a field, or write the interface as it is by `vofkit reconstruct`",
    )
}

impl SceneFile {
    fn moves(&self) -> bool {
        let Self { velocity, mesh, advection, .. } = self;
        velocity.is_some() || mesh.get_ref().motion.is_some() || !advection.span().is_empty()
    }

    /// In each mode something else moves, and only that.
    fn check_mode(&self, mode: Mode, context: Context<'_>) -> Result<(), SceneError> {
        let place = self.advection.get_ref().mode_place();
        match (mode, &self.velocity, &self.mesh.get_ref().motion) {
            (Mode::Flow, None, _) => Err(nothing_moves(context)),
            (Mode::Flow, Some(_), Some(motion)) => Err(context.error(
                motion.span(),
                "the mesh moves, but advection.mode is \"flow\", in which it stands still",
                "set advection.mode = \"remesh\" and leave out [velocity], or leave out mesh.motion",
            )),
            (Mode::Remesh, _, None) => Err(context.error(
                place,
                "advection.mode is \"remesh\", and there is no mesh.motion",
                "say how the mesh moves, such as motion = { wave = { amplitude = 0.5 } } in [mesh]",
            )),
            (Mode::Remesh, Some(velocity), Some(_)) => Err(context.error(
                velocity.field.span(),
                "in the mode \"remesh\" the material rests, and there is a velocity",
                "leave out [velocity], or set advection.mode = \"flow\" and leave out mesh.motion",
            )),
            (Mode::Flow, Some(_), None) | (Mode::Remesh, None, Some(_)) => Ok(()),
        }
    }

    fn materials(&self) -> &[MaterialSection] {
        self.material.as_ref().map_or(&[], |sections| sections.get_ref())
    }
}

impl StillScene {
    /// The name of the scene.
    pub fn name(&self) -> &str {
        match self {
            Self::Plane(scene) => &scene.name,
            Self::Space(scene) => &scene.name,
        }
    }
}

impl<const D: usize> Resolved<D> {
    fn new(mut still: Still<D>) -> Result<Self, SceneError> {
        let Still { file, source, mesh, reconstruction, .. } = &mut still;
        let context = Context { source };
        if !file.moves() {
            return Err(nothing_moves(context));
        }
        file.reconstruction.check_moves(*reconstruction, context)?;
        let fields = field::resolve_all(&mut file.field, mesh, context)?;
        file.advection.get_mut().place = file.advection.span();
        let advection = file.advection.get_mut().resolve(context)?;
        file.check_mode(advection.mode, context)?;
        let (field, reversal) = match &file.velocity {
            Some(velocity) => velocity.resolve::<D>(context)?,
            None => (VelocitySetup::none(), ReversalSetup::None),
        };
        let field = field.acting(advection.stepping.end_time());
        Ok(Self { still, fields, field, reversal, advection })
    }

    /// The scene as TOML with every default filled in; `boundary` is what the ends turned out to be, `times` when output
    /// is written.
    pub fn to_toml(&self, boundary: &Boundary<D>, times: &[f64]) -> String {
        let mut file = self.file.clone();
        file.boundary.fill(self.boundary.periodic, boundary);
        file.output.times.get_or_insert_with(|| default(times.to_vec()));
        file.to_toml(true)
    }
}

impl<const D: usize> Still<D> {
    fn new(Draft { mut file, source, grid, .. }: Draft) -> Result<Self, SceneError> {
        let context = Context { source: &source };
        let mesh = match &grid {
            Some(grid) => file.mesh.get_ref().resolve_file(grid, context)?,
            None => file.mesh.get_mut().resolve(context)?,
        };
        if let (Some(grid), true) = (&grid, file.materials().is_empty()) {
            let all: Vec<_> = grid.materials().map(MaterialSection::from_file).collect();
            file.material = (!all.is_empty()).then(|| default(all));
        }
        if file.materials().is_empty() && file.field.is_empty() {
            let place = file.material.as_ref().map(Spanned::span).unwrap_or_default();
            return Err(context.error(
                place,
                if grid.is_some() {
                    "neither the scene nor the file of the mesh has a material, and there is no field"
                } else {
                    "the scene has no material and no field"
                },
                "add a [[material]] section with a name and a shape, or a [[field]] section",
            ));
        }
        let mut materials = material::resolve::<D>(file.materials(), grid.is_some(), context)?;
        let names: Vec<String> = materials.iter().map(|material| material.name.clone()).collect();
        let boundary: BoundarySetup<D> = file.boundary.resolve(&names, context)?;
        if let Some(axis) = (0..D).find(|&axis| grid.is_some() && boundary.periodic[axis]) {
            return Err(context.error(
                file.boundary.place(axis),
                "the ends of a mesh from a file cannot be joined",
                "use \"wall\" or \"outflow\" there",
            ));
        }
        for (k, (material, section)) in materials.iter_mut().zip(file.materials()).enumerate() {
            let flows_in = boundary.inflow == Some(k);
            material.quantities = quantity::resolve_all(&section.quantity, flows_in, &mesh, context)?;
        }
        let regions_overlap = file.advection.get_ref().regions_overlap();
        let moves_in_space = D == 3 && file.moves();
        let reconstruction = file.reconstruction.resolve(moves_in_space, regions_overlap, context)?;
        let (sections, place) = (file.materials(), file.mesh.get_ref().place());
        let parts = grid.map(|grid| material::parts(sections, &grid, reconstruction, place, context));
        let parts = parts.transpose()?.flatten();
        let output = file.output.resolve(D == 2 || !names.is_empty(), context)?;
        let name = file.name.as_ref().map(|name| name.get_ref().clone()).unwrap_or_default();
        Ok(Self { name, mesh, materials, parts, boundary, reconstruction, output, file, source })
    }

    /// The scene as TOML with every default filled in, but for the advection.
    pub fn to_toml(&self) -> String {
        self.file.to_toml(false)
    }

    /// The normal method as scene files write it.
    pub fn normal_word(&self) -> &str {
        self.file.reconstruction.normal_word()
    }

    /// The shapes of the materials; none where the file of the mesh has their fractions.
    pub fn shapes(&self) -> Option<Vec<Shape<D>>> {
        self.materials.iter().map(|material| material.shape.clone()).collect()
    }

    /// The names of the materials.
    pub fn material_names(&self) -> Vec<String> {
        self.materials.iter().map(|material| material.name.clone()).collect()
    }

    /// The name of the file, and the text of the scene with all values that were set.
    pub(crate) fn text(&self) -> (&str, &str) {
        (self.source.file(), self.source.text())
    }

    /// An error in a part of the scene.
    pub(crate) fn error(
        &self,
        part: Part,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.error(self.place(part), message, help)
    }

    fn place(&self, part: Part) -> Range<usize> {
        let file = &self.file;
        let advection = file.advection.get_ref();
        let given = |place: Range<usize>, otherwise: Range<usize>| {
            if place.is_empty() { otherwise } else { place }
        };
        // The velocity, or what there is in its place.
        let moves = || {
            let velocity = file.velocity.as_ref().map(|velocity| velocity.field.span());
            let motion = || file.mesh.get_ref().motion.as_ref().map(Spanned::span);
            velocity.or_else(motion).unwrap_or_default()
        };
        match part {
            Part::Mesh => file.mesh.get_ref().place(),
            Part::Distortion => given(file.mesh.get_ref().distortion.span(), file.mesh.get_ref().place()),
            Part::Shape(material) => given(file.materials()[material].place(), file.mesh.get_ref().place()),
            Part::Motion | Part::Field => moves(),
            Part::Initial(field) => file.field[field].initial_place(),
            Part::Boundary(axis) => given(file.boundary.place(axis), moves()),
            Part::Scheme => advection.scheme_place(),
            Part::Courant => advection.courant_place(),
            Part::Steps => advection.steps_place(),
        }
    }
}

impl SceneFile {
    /// The sections as TOML, with or without the one of the advection.
    fn to_toml(&self, with_advection: bool) -> String {
        let Ok(mut document) = toml_edit::ser::to_document(self) else { return String::new() };
        if !with_advection {
            document.remove("advection");
        }
        for (_, item) in document.iter_mut() {
            // Sections become tables of their own; what is inside them stays on one line.
            let value = std::mem::take(item);
            *item = match value.into_table() {
                Ok(table) => toml_edit::Item::Table(table),
                Err(value) => match value.into_array_of_tables() {
                    Ok(list) => toml_edit::Item::ArrayOfTables(list),
                    Err(value) => value,
                },
            };
        }
        document.to_string()
    }
}
