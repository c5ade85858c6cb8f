//! Scenes to try, as text.

use super::case::{Input, Random};

/// What makes up a scene.
pub(super) struct Scenery {
    /// Cells along each axis.
    pub(super) cells: [usize; 2],
    /// The upper corner; the lower one is the origin.
    pub(super) side: [f64; 2],
    /// The distortion as TOML.
    pub(super) distortion: String,
    /// The `[[material]]` sections.
    pub(super) materials: String,
    /// The velocity field as TOML.
    pub(super) field: String,
    /// The Courant number; with zero the steps go to the time 2.
    pub(super) courant: f64,
    /// Steps.
    pub(super) steps: usize,
    /// Whether both axes are joined at their ends.
    pub(super) periodic: bool,
    /// Keys of `[advection]`.
    pub(super) scheme: &'static str,
    /// The normal method.
    pub(super) normal: &'static str,
}

impl Scenery {
    /// A disc in a vortex on a small mesh, with methods drawn at random.
    pub(super) fn new(random: &mut Random) -> Self {
        let random_mesh = format!("{{ random = {{ amplitude = 0.2, seed = {} }} }}", random.below(1000));
        let distortion = match random.below(3) {
            0 => "\"none\"".to_owned(),
            1 => random_mesh,
            _ => "{ wave = { amplitude = 0.3 } }".to_owned(),
        };
        let schemes = [
            "scheme = \"sweeps\"",
            "scheme = \"sweeps\"\nsweep_order = \"symmetric\"",
            "scheme = \"sweeps\"\nsweep_axes = \"cartesian\"",
            "scheme = \"unsplit\"",
            "scheme = \"isotropic\"",
        ];
        Self {
            cells: [8, 8],
            side: [1.0, 1.0],
            distortion,
            materials: disc(
                "a",
                [random.within(0.35, 0.65), random.within(0.35, 0.65)],
                random.within(0.1, 0.3),
            ),
            field: "{ reversed_vortex = { period = 8.0 } }".to_owned(),
            courant: random.within(0.1, 1.0),
            steps: 12,
            periodic: false,
            scheme: random.one_of(&schemes),
            normal: random.one_of(&["youngs", "lvira", "swartz", "least_squares"]),
        }
    }

    pub(super) fn input(&self) -> Input {
        let Self { cells, side, distortion, materials, field, courant, steps, scheme, normal, .. } = self;
        let boundary = match self.periodic {
            true => "[boundary]\nx = [\"periodic\", \"periodic\"]\ny = [\"periodic\", \"periodic\"]\n\n",
            false => "",
        };
        let stepping = match *courant > 0.0 {
            true => format!("courant = {courant:?}\nsteps = {steps}"),
            false => format!("end_time = 2.0\nsteps = {steps}"),
        };
        Input::Scene(format!(
            "[mesh]\ncells = {cells:?}\nlower = [0.0, 0.0]\nupper = {side:?}\ndistortion = {distortion}\n\n\
             {materials}[velocity]\nfield = {field}\n\n{boundary}[reconstruction]\nnormal = \"{normal}\"\n\n\
             [advection]\n{scheme}\nsubsteps = \"auto\"\n{stepping}\n\n[output]\ninterface = []\n"
        ))
    }
}

/// The section of a material that there may be nothing of.
pub(super) fn material(name: &str, shape: &str) -> String {
    format!("[[material]]\nname = \"{name}\"\nshape = {shape}\nallow_empty = true\n\n")
}

/// The section of a disc.
pub(super) fn disc(name: &str, centre: [f64; 2], radius: f64) -> String {
    material(name, &format!("{{ disc = {{ centre = {centre:?}, radius = {radius:?} }} }}"))
}
