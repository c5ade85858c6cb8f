//! Interfaces as triangulated Wavefront OBJ, through the crate `obj-exporter`.
//!
//! That crate prints six decimals. Small geometry is therefore multiplied by a power of ten, which the names
//! of the objects state.

use std::io::Write;
use std::path::Path;

use obj_exporter::{Geometry, ObjSet, Object, Primitive, Shape, Vertex, export};
use vofkit_geometry::Vector;

use super::triangulation::triangles;
use super::{ExportError, check_materials, write_file};
use crate::facet::Facet;
use crate::space::spatial;

/// Largest error of a written coordinate: half of the last printed decimal.
const PRINTED_ERROR: f64 = 0.5e-6;

/// Largest part of the smallest cell that printing may cost. More, and facets of fine meshes get visible
/// steps.
const LOSS: f64 = 1e-4;

/// Largest power of ten to scale by; a larger one could exceed the largest number.
const LARGEST_POWER: i32 = 300;

/// Writes the interfaces as OBJ, one object per material in the order of `names`; returns the factor on all
/// coordinates.
///
/// Facets become triangles (2D: lines) without shared vertices and without normals; triangles are
/// counter-clockwise seen from outside the material. The factor is 1 unless six decimals would lose more than
/// 1e-4 of `cell_size`, the length of the smallest cell; otherwise it is the smallest sufficient power of ten
/// and the objects are named like `disc_scale_1e3`. Blanks and `#` in names become `_`. A material without
/// interface is an object without faces.
///
/// # Errors
/// A facet whose material has no name, and whatever the file system reports.
pub fn write_obj<const D: usize>(
    path: impl AsRef<Path>,
    names: &[String],
    facets: &[Facet<D>],
    cell_size: f64,
) -> Result<f64, ExportError> {
    let path = path.as_ref();
    check_materials(path, names, facets)?;
    let power = power_of_ten(cell_size);
    let scale = 10_f64.powi(power);
    let mut objects: Vec<Object> = names.iter().map(|name| empty_object(object_name(name, power))).collect();
    for facet in facets {
        let object = &mut objects[facet.material];
        let normal = spatial(&facet.normal);
        for points in &facet.loops {
            let points: Vec<_> = points.iter().map(|point| spatial(point) * scale).collect();
            add_loop::<D>(object, &points, &normal);
        }
    }
    let set = ObjSet { material_library: None, objects };
    write_file(path, |writer| {
        export(&set, writer)?;
        writer.flush()
    })?;
    Ok(scale)
}

/// The smallest power of ten, not negative, with which a cell of this size loses no more than [`LOSS`].
fn power_of_ten(cell_size: f64) -> i32 {
    let needed = (PRINTED_ERROR / (LOSS * cell_size)).log10();
    // Rounding of the logarithm must not ask for one power more.
    if needed.is_finite() { ((needed - 1e-9).ceil() as i32).clamp(0, LARGEST_POWER) } else { 0 }
}

fn object_name(name: &str, power: i32) -> String {
    let kept = |c: char| if c.is_whitespace() || c.is_control() || c == '#' { '_' } else { c };
    let name: String = name.chars().map(kept).collect();
    if power == 0 { name } else { format!("{name}_scale_1e{power}") }
}

fn empty_object(name: String) -> Object {
    Object {
        name,
        vertices: Vec::new(),
        tex_vertices: Vec::new(),
        normals: Vec::new(),
        geometry: vec![Geometry { material_name: None, shapes: Vec::new() }],
    }
}

fn add_loop<const D: usize>(object: &mut Object, points: &[Vector<3>], normal: &Vector<3>) {
    let first = object.vertices.len();
    let vertex = |at: usize| (first + at, None, None);
    let mut add = |primitive| {
        object.geometry[0].shapes.push(Shape { primitive, groups: Vec::new(), smoothing_groups: Vec::new() });
    };
    if D == 2 {
        (1..points.len()).for_each(|at| add(Primitive::Line(vertex(at - 1), vertex(at))));
    } else {
        for [a, b, c] in triangles(points, normal) {
            add(Primitive::Triangle(vertex(a), vertex(b), vertex(c)));
        }
    }
    object.vertices.extend(points.iter().map(|p| Vertex { x: p.x, y: p.y, z: p.z }));
}

#[cfg(test)]
mod tests {
    use super::{object_name, power_of_ten};

    #[test]
    fn the_power_of_ten_is_the_smallest_that_serves() {
        let cases = [(1.0, 0), (5e-3, 0), (4.9e-3, 1), (5e-4, 1), (4.9e-4, 2), (1e-9, 7), (1e9, 0)];
        for (cell_size, power) in cases {
            assert_eq!(power_of_ten(cell_size), power, "{cell_size}");
        }
        for odd in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(power_of_ten(odd), 0, "{odd}");
        }
        assert_eq!(power_of_ten(f64::MIN_POSITIVE), 300);
    }

    #[test]
    fn names_stay_on_one_line() {
        assert_eq!(object_name("salt\nwater #1", 0), "salt_water__1");
        assert_eq!(object_name("disc", 3), "disc_scale_1e3");
    }
}
