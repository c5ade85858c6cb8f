//! From where three dimensions are seen, and what is shown of the mesh.

use std::str::FromStr;

use vofkit_geometry::Vector;

use crate::mesh::axis_name;

/// A direction from which one looks, along parallel lines; z points upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Degrees about z, counter-clockwise seen from above; 0 is in front, at lower y, 90 on the side of larger x.
    pub azimuth: f64,
    /// Degrees above the plane of x and y.
    pub elevation: f64,
}

/// Views that have names.
const NAMED: [(&str, View); 7] = [
    ("front", View { azimuth: 0.0, elevation: 0.0 }),
    ("right", View { azimuth: 90.0, elevation: 0.0 }),
    ("back", View { azimuth: 180.0, elevation: 0.0 }),
    ("left", View { azimuth: 270.0, elevation: 0.0 }),
    ("top", View { azimuth: 0.0, elevation: 90.0 }),
    ("bottom", View { azimuth: 0.0, elevation: -90.0 }),
    ("iso", View::ISO),
];

impl View {
    /// From the right in front and above.
    pub const ISO: Self = Self { azimuth: 35.0, elevation: 25.0 };

    /// Unit vectors to the right, upwards, and towards the one who looks.
    pub(super) fn axes(&self) -> [Vector<3>; 3] {
        let (sin, cos) = self.azimuth.to_radians().sin_cos();
        let (rise, run) = self.elevation.to_radians().sin_cos();
        let right = Vector::<3>::new(cos, sin, 0.0);
        let towards = Vector::<3>::new(run * sin, -run * cos, rise);
        [right, towards.cross(&right), towards]
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, view)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(*view);
        }
        let angle =
            |word: &str, most: f64| word.trim().parse().ok().filter(|angle: &f64| angle.abs() <= most);
        let angles = text.split_once(',').map(|(a, e)| (angle(a, 360.0), angle(e, 90.0)));
        let Some((Some(azimuth), Some(elevation))) = angles else {
            let names = NAMED.map(|(name, _)| name).join(", ");
            return Err(format!(
                "give one of {names}, or AZIMUTH,ELEVATION in degrees from -360 to 360 and from -90 to 90, such as 35,25"
            ));
        };
        Ok(Self { azimuth, elevation })
    }
}

/// A layer of nodes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slice {
    /// The axis of the mesh across which it lies.
    pub axis: usize,
    /// Its place along that axis, from 0.
    pub layer: usize,
}

impl FromStr for Slice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=').and_then(|(axis, layer)| {
            let axis = (0..3).find(|&k| axis_name(k) == axis.trim())?;
            Some(Self { axis, layer: layer.trim().parse().ok()? })
        });
        parts.ok_or_else(|| "give AXIS=LAYER, a layer of nodes counted from 0, such as z=16".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::{NAMED, Slice, View};

    #[test]
    fn the_axes_of_a_view_are_a_right_handed_frame() {
        for (name, view) in NAMED {
            let [right, up, towards] = view.axes();
            assert!((right.cross(&up) - towards).norm() <= 1e-15, "{name}");
            assert!((right.norm() - 1.0).abs() <= 1e-15 && (up.norm() - 1.0).abs() <= 1e-15, "{name}");
            assert!(up.z >= -1e-15, "{name}");
            assert_eq!(name.parse(), Ok(view));
        }
        let [right, up, towards] = "right".parse::<View>().unwrap().axes();
        assert!((right.y - 1.0).abs() + (up.z - 1.0).abs() + (towards.x - 1.0).abs() <= 1e-15);
    }

    #[test]
    fn views_and_slices_are_read_or_explained() {
        assert_eq!("-30, 12.5".parse(), Ok(View { azimuth: -30.0, elevation: 12.5 }));
        for wrong in ["", "ISO", "30", "30,91", "361,0", "nan,0", "1,2,3", "0,inf"] {
            assert!(wrong.parse::<View>().unwrap_err().contains("AZIMUTH,ELEVATION"), "{wrong}");
        }
        assert_eq!("y=3".parse(), Ok(Slice { axis: 1, layer: 3 }));
        for wrong in ["", "y", "y=", "w=1", "x=-1", "x=1.5", "x=1=2"] {
            assert!(wrong.parse::<Slice>().unwrap_err().contains("AXIS=LAYER"), "{wrong}");
        }
    }
}
