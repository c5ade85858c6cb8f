//! Writes `scenes/velocity/bend.vts`: a channel that turns by a right angle, the flow in it as nodal velocity `U`, and a drop at its inlet as
//! cell data `alpha.drop`. `cargo run --release --example bend [FILE]` writes it anew, into another file if one is named.
//!
//! The flow is that between two cylinders under a pressure gradient along the channel, nearly a parabola:
//! `u = 1.5 U (1 - s^2)` with the mean speed `U = 1` and `s` from -1 at the inner to 1 at the outer wall.

use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

use vofkit::export::vtk::{CellArray, write_structured_grid_with_nodes};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Quad, Vector};
use vofkit::mesh::{Grid, Mesh};
use vofkit::shape::Shape;

/// Cells along and across the channel.
const CELLS: [usize; 2] = [32, 16];
/// The radii of the inner and the outer wall.
const RADII: [f64; 2] = [0.5, 1.5];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os().nth(1).map_or(PathBuf::from("scenes/velocity/bend.vts"), PathBuf::from);
    let grid = Grid::new(CELLS, [false; 2]);
    let polar = |node: usize| {
        let [i, j] = grid.node_offset(node);
        let [along, across] = [i as f64 / CELLS[0] as f64, j as f64 / CELLS[1] as f64];
        // From the x axis against the clock; inwards is to the left.
        (RADII[1] + (RADII[0] - RADII[1]) * across, FRAC_PI_2 * along)
    };
    let place = |node: usize| {
        let (radius, angle) = polar(node);
        Vector::<2>::new(radius * angle.cos(), radius * angle.sin())
    };
    let velocity = |node: usize| {
        let (radius, angle) = polar(node);
        let s = (2.0 * radius - RADII[0] - RADII[1]) / (RADII[1] - RADII[0]);
        Vector::<2>::new(-angle.sin(), angle.cos()) * (1.5 * (1.0 - s * s))
    };
    let nodes = 0..grid.node_count();
    let mesh = Mesh::<Quad, 2>::from_nodes(grid.clone(), nodes.clone().map(place).collect())?;
    let velocities: Vec<Vector<2>> = nodes.map(velocity).collect();
    let drop = Shape::Sphere { centre: [1.05, 0.4].into(), radius: 0.25 };
    let fractions = volume_fractions(&mesh, &[drop]);
    let at_cells = [CellArray::scalar("alpha.drop", &fractions[0])];
    write_structured_grid_with_nodes(&path, &mesh, &at_cells, &[CellArray::vector("U", &velocities)])?;
    println!("{}", path.display());
    Ok(())
}
