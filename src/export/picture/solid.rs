//! Three-dimensional drawings: shaded interfaces, the edges of the mesh, and a layer of its nodes.

use svg::node::element::Group;
use vofkit_geometry::{Hexahedron, Vector};

use super::camera::{Slice, View};
use super::depth::{Canvas, Place};
use super::sheet::Sheet;
use super::{Look, Paint, Pixels, finite_loops, raster};
use crate::export::Snapshot;
use crate::export::palette::{Colour, GREY};
use crate::export::triangulation::triangles;
use crate::facet::Facet;
use crate::mesh::{Mesh, axis_name};

/// Where the light comes from: right, up, towards the one who looks.
const LIGHT: [f64; 3] = [-0.35, 0.5, 0.79];

/// Brightness of a surface without light, and what the light adds, outside of the material and on the inner side of its interface.
const OUTSIDE: [f64; 2] = [0.5, 0.55];
const INSIDE: [f64; 2] = [0.3, 0.35];

/// Units of the width of the edges of the mesh, of lines of a layer, and of normals.
const EDGE: f64 = 1.6;
const LAYER: f64 = 0.8;
const NORMAL: f64 = 1.2;

/// Lines of a layer are paler than the edges.
const PALE: Colour = [150, 150, 150];

/// Lines on a surface win against it by this part of the size of the mesh.
const LIFT: f64 = 2e-3;

/// Normals, relative to the length of a cell.
const ARROW: f64 = 0.8;

impl Paint<3> for Hexahedron {
    fn pixels(snapshot: &Snapshot<'_, Self, 3>, colours: &[Colour], look: &Look) -> Result<Pixels, String> {
        let Snapshot { mesh, names, facets, title, .. } = *snapshot;
        let eye = Eye::new(mesh, names, look)?;
        let mut canvas = Canvas::new(eye.sheet.size());
        if let Some(slice) = look.slice {
            eye.layer(&mut canvas, mesh, slice)?;
        }
        if look.mesh {
            eye.edges(&mut canvas, mesh);
        }
        let cell = (mesh.total_volume() / mesh.grid().len() as f64).cbrt();
        for facet in facets.iter().filter(|facet| facet.normal.iter().all(|x| x.is_finite())) {
            let colour = colours[facet.material % colours.len()];
            eye.surface(&mut canvas, facet, colour);
            if look.normals {
                eye.normal(&mut canvas, facet, cell * ARROW);
            }
        }
        let mut picture = raster::white(&eye.sheet)?;
        canvas.show(&mut picture);
        raster::draw(&eye.sheet.document(title, Group::new(), names, colours, 1.0), picture, &eye.sheet)
    }
}

/// Where the mesh is seen on the sheet.
struct Eye {
    /// The middle of the mesh.
    middle: Vector<3>,
    axes: [Vector<3>; 3],
    /// The least coordinate to the right and the largest upwards.
    corner: [f64; 2],
    sheet: Sheet,
    /// The size of the mesh.
    size: f64,
    /// Where the light comes from.
    light: Vector<3>,
}

impl Eye {
    fn new(mesh: &Mesh<Hexahedron, 3>, names: &[String], look: &Look) -> Result<Self, String> {
        let [lower, upper] = mesh.bounds();
        let middle = lower + (upper - lower) * 0.5;
        let axes = look.view.unwrap_or(View::ISO).axes();
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for node in mesh.nodes() {
            for (axis, [low, high]) in axes.iter().zip(&mut range) {
                let at = axis.dot(&(node - middle));
                [*low, *high] = [low.min(at), high.max(at)];
            }
        }
        let sheet = Sheet::around(range.map(|[low, high]| high - low), names, look.size)?;
        let light = axes.iter().zip(LIGHT).map(|(axis, part)| axis * part).sum::<Vector<3>>().normalize();
        Ok(Self {
            middle,
            axes,
            corner: [range[0][0], range[1][1]],
            sheet,
            size: (upper - lower).norm(),
            light,
        })
    }

    /// The place of a point on the sheet, in pixels.
    fn place(&self, point: &Vector<3>) -> Place {
        let [x, y, near] = self.axes.map(|axis| axis.dot(&(point - self.middle)));
        let sheet = &self.sheet;
        let [x, y] =
            [sheet.left + (x - self.corner[0]) * sheet.scale, sheet.top + (self.corner[1] - y) * sheet.scale];
        [x * sheet.pixels, y * sheet.pixels, near / self.size]
    }

    /// The same, so that it wins against a surface that it lies on.
    fn lifted(&self, point: &Vector<3>) -> Place {
        let [x, y, near] = self.place(point);
        [x, y, near + LIFT]
    }

    fn surface(&self, canvas: &mut Canvas, facet: &Facet<3>, colour: Colour) {
        let is_outside = facet.normal.dot(&self.axes[2]) >= 0.0;
        let normal = if is_outside { facet.normal } else { -facet.normal };
        let [dark, lit] = if is_outside { OUTSIDE } else { INSIDE };
        let brightness = dark + lit * normal.dot(&self.light).max(0.0);
        let colour = colour.map(|part| (f64::from(part) * brightness).round() as u8);
        for points in finite_loops(facet) {
            let places: Vec<Place> = points.iter().map(|point| self.place(point)).collect();
            for corners in triangles(points, &facet.normal) {
                canvas.triangle(corners.map(|corner| places[corner]), colour);
            }
        }
    }

    fn normal(&self, canvas: &mut Canvas, facet: &Facet<3>, length: f64) {
        for points in finite_loops(facet) {
            let foot = points.iter().sum::<Vector<3>>() / points.len() as f64;
            let ends = [foot, foot + facet.normal * length].map(|point| self.lifted(&point));
            canvas.line(ends, NORMAL * self.sheet.pixels, [40; 3]);
        }
    }

    /// The twelve edges of the whole mesh.
    fn edges(&self, canvas: &mut Canvas, mesh: &Mesh<Hexahedron, 3>) {
        let cells = mesh.grid().cells();
        for axis in 0..3 {
            for ends in 0..4 {
                let mut at = [0; 3];
                for (bit, across) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
                    at[across] = if ends >> bit & 1 == 1 { cells[across] } else { 0 };
                }
                self.mesh_line(canvas, mesh, at, axis, (EDGE, GREY));
            }
        }
    }

    fn layer(&self, canvas: &mut Canvas, mesh: &Mesh<Hexahedron, 3>, slice: Slice) -> Result<(), String> {
        let cells = mesh.grid().cells();
        let Slice { axis, layer } = slice;
        if layer > cells[axis] {
            let (name, last) = (axis_name(axis), cells[axis]);
            return Err(format!(
                "there is no layer {layer} of nodes across {name}: they go from 0 to {last}"
            ));
        }
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        for [along, step] in [across, [across[1], across[0]]] {
            for line in 0..=cells[step] {
                let mut at = [0; 3];
                at[axis] = layer;
                at[step] = line;
                self.mesh_line(canvas, mesh, at, along, (LAYER, PALE));
            }
        }
        Ok(())
    }

    /// A line along an axis of the mesh from one end to the other.
    fn mesh_line(
        &self,
        canvas: &mut Canvas,
        mesh: &Mesh<Hexahedron, 3>,
        mut at: [usize; 3],
        axis: usize,
        (width, colour): (f64, Colour),
    ) {
        let mut place = |index: usize| {
            at[axis] = index;
            self.place(&mesh.nodes()[mesh.grid().node_index(at)])
        };
        let mut start = place(0);
        for index in 1..=mesh.grid().cells()[axis] {
            let end = place(index);
            canvas.line([start, end], width * self.sheet.pixels, colour);
            start = end;
        }
    }
}
