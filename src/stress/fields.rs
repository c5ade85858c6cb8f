//! Fractions that are none, and meshes that scenes cannot name.

use vofkit_geometry::{Cell, Hexahedron, PositionError, PositionMethod, Quad, Vector};

use super::Family;
use super::case::{CaseFile, Input, Verdict};
use super::cells::{common, filled};
use crate::advection::{Settings, Transport};
use crate::interface::{Reconstruction, reconstruct};
use crate::mesh::{Distortion, Grid, Mesh, MeshError};
use crate::metrics::material_volume;
use crate::shape::Shape;
use crate::velocity::{Field, Reversal, Velocity};

/// Change of a volume that is rounding, relative to the mesh.
const VOLUME: f64 = 1e-12;
/// A disc that is carried.
const DISC: [f64; 2] = [0.5, 0.52];
const RADIUS: f64 = 0.3;

pub(super) const FAMILIES: &[Family] = &[
    Family {
        name: "fractions/odd",
        holds: "fractions below 0, above 1 and not a number are refused with a typed error; all others, denormal ones too, have a finite plane",
        weight: 1,
        draw: |random| {
            let (nodes, normal) = (common(random), random.unit());
            let odd = [
                -1e-300,
                -1.0,
                1.0 + f64::EPSILON,
                f64::NAN,
                f64::INFINITY,
                1e-310,
                5e-324,
                -0.0,
                1.0 - f64::EPSILON,
            ];
            filled(nodes, normal, random.one_of(&odd))
        },
        judge: odd,
    },
    Family {
        name: "fractions/field",
        holds: "one bad fraction in a field is refused by reconstruction and by a step, and the field stays as it was",
        weight: 50,
        draw: |random| {
            let bad = [-1e-15, -1.0, 1.0 + 1e-15, 2.0, f64::NAN, f64::NEG_INFINITY];
            Input::Number(random.one_of(&bad), bad_field_files)
        },
        judge: |input| if let Input::Number(bad, _) = input { bad_field(*bad) } else { Verdict::good("") },
    },
    Family {
        name: "motion/graded",
        holds: "a mesh whose neighbours differ in volume by up to 1e6 conserves volume and stays within bounds",
        weight: 250,
        draw: |random| Input::Number(10.0_f64.powf(random.within(0.0, 6.0)), graded_files),
        judge: |input| if let Input::Number(ratio, _) = input { graded(*ratio) } else { Verdict::good("") },
    },
];

fn odd(input: &Input) -> Verdict {
    let Input::Cell(row) = input else { return Verdict::good("") };
    let (cell, fraction) = (Hexahedron::new(row.nodes), row.fraction());
    if cell.defects().iter().any(vofkit_geometry::Defect::is_error) {
        return Verdict::good("the check refuses the cell");
    }
    let methods = [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent];
    for found in methods.map(|method| cell.plane_constant(&row.normal, fraction, method)) {
        let fits = match &found {
            Ok(found) => (0.0..=1.0).contains(&fraction) && found.constant.is_finite(),
            Err(PositionError::Fraction(_)) => !(0.0..=1.0).contains(&fraction),
            Err(_) => false,
        };
        if !fits {
            return Verdict::broken(format!("{fraction:e}: {found:?}"));
        }
    }
    Verdict::good("as it should be")
}

fn vortex() -> Velocity {
    Velocity { field: Field::ReversedVortex, reversal: Reversal::None }
}

/// A small mesh with one bad fraction.
fn with_bad_fraction(bad: f64) -> Result<(Mesh<Quad, 2>, Vec<Vec<f64>>), MeshError> {
    let mesh = Mesh::unit([6; 2], &Distortion::Random { amplitude: 0.2, seed: 3 })?;
    let mut fractions = vec![vec![0.5; mesh.grid().len()]];
    fractions[0][17] = bad;
    Ok((mesh, fractions))
}

fn bad_field_files(bad: f64) -> Vec<CaseFile> {
    let grid = with_bad_fraction(bad).map(|(mesh, fractions)| grid_text(&mesh, Some(&fractions[0])));
    let scene = on_grid("fractions_field.vts", "name = \"a\"");
    vec![CaseFile::scene(scene), CaseFile::grid(grid.unwrap_or_default())]
}

fn bad_field(bad: f64) -> Verdict {
    let Ok((mesh, mut fractions)) = with_bad_fraction(bad) else { return Verdict::broken("no mesh") };
    let before: Vec<u64> = fractions[0].iter().map(|f| f.to_bits()).collect();
    if let Ok(interface) = reconstruct(&mesh, &fractions, Reconstruction::default()) {
        return Verdict::broken(format!("{} facets of a field with {bad}", interface.facets.len()));
    }
    let Ok(mut transport) = Transport::new(&mesh, vortex(), Settings::default()) else {
        return Verdict::broken("no transport");
    };
    let stepped = transport.step(&mut fractions, 0, 0.0, 1e-3);
    let same = fractions[0].iter().map(|f| f.to_bits()).eq(before);
    if stepped.is_err() && same {
        Verdict::good("refused")
    } else {
        Verdict::broken(format!("a step with {bad}: {stepped:?}"))
    }
}

/// The unit square with columns whose widths alternate by a ratio.
fn graded_mesh(ratio: f64) -> Result<Mesh<Quad, 2>, MeshError> {
    let grid = Grid::new([8, 8], [false; 2]);
    let width = |column: usize| if column.is_multiple_of(2) { ratio } else { 1.0 };
    let total: f64 = (0..8).map(width).sum();
    let place = |count: usize| (0..count).map(width).sum::<f64>() / total;
    let nodes = (0..grid.node_count()).map(|node| {
        let [i, j] = grid.node_offset(node);
        Vector::<2>::new(place(i), j as f64 / 8.0)
    });
    let nodes = nodes.collect();
    Mesh::from_nodes(grid, nodes)
}

fn graded_files(ratio: f64) -> Vec<CaseFile> {
    let grid = graded_mesh(ratio).map(|mesh| grid_text(&mesh, None));
    let [x, y] = DISC;
    let disc =
        format!("name = \"a\"\nshape = {{ disc = {{ centre = [{x:?}, {y:?}], radius = {RADIUS:?} }} }}");
    vec![CaseFile::scene(on_grid("motion_graded.vts", &disc)), CaseFile::grid(grid.unwrap_or_default())]
}

/// A scene on a grid, in the vortex of these cases.
fn on_grid(file: &str, material: &str) -> String {
    format!(
        "[mesh]\nfile = \"{file}\"\n\n[[material]]\n{material}\n\n[velocity]\nfield = {{ reversed_vortex = {{ period = 1e9 }} }}\n\n\
         [advection]\ncourant = 0.5\nsteps = 20\n\n[output]\ninterface = []\n"
    )
}

/// A mesh as a structured grid in plain text, with fractions of a material `a` if there are any.
fn grid_text(mesh: &Mesh<Quad, 2>, fractions: Option<&[f64]>) -> String {
    let [columns, rows] = mesh.grid().cells();
    let extent = format!("0 {columns} 0 {rows} 0 0");
    let points: String = mesh.nodes().iter().map(|x| format!("{:?} {:?} 0\n", x[0], x[1])).collect();
    let cells = fractions.map_or_else(String::new, |fractions| {
        let numbers: String = fractions.iter().map(|f| format!("{f:?}\n")).collect();
        let array = "<DataArray type=\"Float64\" Name=\"alpha.a\" format=\"ascii\">";
        format!("<CellData>{array}\n{numbers}</DataArray></CellData>\n")
    });
    let array = "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">";
    format!(
        "<VTKFile type=\"StructuredGrid\" version=\"1.0\">\n<StructuredGrid WholeExtent=\"{extent}\">\n<Piece Extent=\"{extent}\">\n\
         <Points>{array}\n{points}</DataArray></Points>\n{cells}</Piece>\n</StructuredGrid>\n</VTKFile>\n"
    )
}

fn graded(ratio: f64) -> Verdict {
    let mesh = match graded_mesh(ratio) {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let mut fractions =
        crate::fractions::volume_fractions(&mesh, &[Shape::Sphere { centre: DISC.into(), radius: RADIUS }]);
    let before = material_volume(&mesh, &fractions[0]);
    let mut transport = match Transport::new(&mesh, vortex(), Settings::default()) {
        Ok(transport) => transport,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let dt = 0.5 / transport.courant_rate();
    let mut outside: f64 = 0.0;
    for step in 0..20 {
        match transport.step(&mut fractions, step, step as f64 * dt, (step + 1) as f64 * dt) {
            Ok(ledger) => {
                let account = ledger.materials[0];
                outside = outside.max(-account.smallest).max(account.largest - 1.0);
            }
            Err(error) => return Verdict::broken(error.to_string()),
        }
    }
    let drift = (material_volume(&mesh, &fractions[0]) - before).abs();
    Verdict::of(drift, VOLUME, format!("drift {drift:e}")).or(Verdict::of(
        outside,
        VOLUME,
        format!("{outside:e} out of bounds"),
    ))
}
