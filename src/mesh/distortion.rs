//! Ways to move the nodes of a mesh off their places.

use std::f64::consts::PI;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use vofkit_geometry::Vector;

use super::{Grid, MeshError};

/// How the nodes of a mesh of equal boxes are moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Distortion {
    /// Not at all.
    #[default]
    None,
    /// Each component by a uniform random number in `[-amplitude, amplitude]` times the spacing; nodes on the boundary
    /// slide along it.
    Random {
        /// Largest move relative to the spacing along the axis, at least 0 and below 1.
        amplitude: f64,
        /// Seed of the generator (ChaCha8); the same seed gives the same mesh everywhere.
        seed: u64,
    },
    /// `x_k += a L_k prod_j sin(2 pi x_j / L_j) / (2 pi)` with the lengths `L` of the box.
    Wave {
        /// The amplitude `a`, below 1 in magnitude.
        amplitude: f64,
    },
    /// A rotation about the box's z axis (2D: its centre) by `angle` times `prod_j sin(pi x_j / L_j)`, which vanishes
    /// on the boundary.
    Twist {
        /// The angle in the middle, in radians.
        angle: f64,
    },
}

impl Distortion {
    /// Whether nodes stay where they are.
    pub fn is_none(&self) -> bool {
        *self == Self::None
    }

    pub(super) fn apply<const D: usize>(
        &self,
        grid: &Grid<D>,
        lower: &Vector<D>,
        upper: &Vector<D>,
        nodes: &mut [Vector<D>],
    ) -> Result<(), MeshError> {
        let length = upper - lower;
        match *self {
            Self::None => {}
            Self::Random { amplitude, seed } => {
                if !(0.0..1.0).contains(&amplitude) {
                    return Err(MeshError::Distortion(format!(
                        "the random amplitude {amplitude} is not at least 0 and below 1"
                    )));
                }
                random(grid, &length, amplitude, seed, nodes);
            }
            Self::Wave { amplitude } => {
                if !(amplitude.abs() < 1.0) {
                    return Err(MeshError::Distortion(format!(
                        "the wave amplitude {amplitude} is not between -1 and 1"
                    )));
                }
                for x in inner(grid, nodes) {
                    let bump: f64 =
                        (0..D).map(|k| (2.0 * PI * (x[k] - lower[k]) / length[k]).sin()).product();
                    *x += length * (amplitude * bump / (2.0 * PI));
                }
            }
            Self::Twist { angle } => {
                if !angle.is_finite() {
                    return Err(MeshError::Distortion(format!("the twist angle {angle} is not finite")));
                }
                let centre = (lower + upper) * 0.5;
                for x in inner(grid, nodes) {
                    let bump: f64 = (0..D).map(|k| (PI * (x[k] - lower[k]) / length[k]).sin()).product();
                    let (sin, cos) = (angle * bump).sin_cos();
                    let [a, b] = [x[0] - centre[0], x[1] - centre[1]];
                    x[0] = centre[0] + cos * a - sin * b;
                    x[1] = centre[1] + sin * a + cos * b;
                }
            }
        }
        Ok(())
    }
}

/// The nodes that do not lie on the boundary, so that rounding cannot move those that do.
fn inner<'a, const D: usize>(
    grid: &'a Grid<D>,
    nodes: &'a mut [Vector<D>],
) -> impl Iterator<Item = &'a mut Vector<D>> {
    let cells = grid.cells();
    nodes.iter_mut().enumerate().filter_map(move |(node, x)| {
        let at = grid.node_offset(node);
        (0..D).all(|k| at[k] > 0 && at[k] < cells[k]).then_some(x)
    })
}

fn random<const D: usize>(
    grid: &Grid<D>,
    length: &Vector<D>,
    amplitude: f64,
    seed: u64,
    nodes: &mut [Vector<D>],
) {
    let cells = grid.cells();
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (generator.next_u64() >> 11) as f64 * (2.0_f64.powi(-52)) - 1.0;
    let moves: Vec<Vector<D>> = (0..nodes.len()).map(|_| Vector::from_fn(|_, _| uniform())).collect();
    for (node, x) in nodes.iter_mut().enumerate() {
        let at = grid.node_offset(node);
        // Periodic images of a node move together.
        let image = std::array::from_fn(|k| if grid.periodic()[k] { at[k] % cells[k] } else { at[k] });
        let drawn = moves[grid.node_index(image)];
        for k in 0..D {
            if at[k] > 0 && at[k] < cells[k] {
                x[k] += amplitude * drawn[k] * length[k] / cells[k] as f64;
            }
        }
    }
}
