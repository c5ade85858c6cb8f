//! The values of the fields of a run, and what they are at the start.

use serde::{Deserialize, Serialize};
use vofkit_geometry::Cell;

use crate::mesh::Mesh;
use crate::profile::Profile;
use crate::scene::{FieldSetup, Location};
use crate::volume_associated::points;

/// The values of all fields.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct State {
    /// Means over the cells, by quantity; those of fields at nodes belong to their last step.
    pub(super) means: Vec<Vec<f64>>,
    /// Values at nodes, by field and component; none for other fields.
    pub(super) nodes: Vec<Vec<Vec<f64>>>,
    /// Values at integration points, by field, component and number of the point, of fields that are moved there; none for others, whose
    /// means say all.
    pub(super) points: Vec<Vec<Vec<Vec<f64>>>>,
}

impl State {
    /// Whether it has as many values as another one, everywhere.
    pub(super) fn fits(&self, other: &Self) -> bool {
        fn all<T>(a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> bool {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        let lists = |a: &Vec<Vec<f64>>, b: &Vec<Vec<f64>>| all(a, b, |a, b| a.len() == b.len());
        lists(&self.means, &other.means)
            && all(&self.nodes, &other.nodes, lists)
            && all(&self.points, &other.points, |a, b| all(a, b, lists))
    }
}

/// The values of profiles where those of a field are: means over cells, or values at nodes. Fields at integration points start from the
/// means of their values there.
pub(super) fn sampled<C: Cell<D>, const D: usize>(
    setup: &FieldSetup<D>,
    profiles: &[Profile<D>],
    mesh: &Mesh<C, D>,
) -> Vec<Vec<f64>> {
    let of_component = |profile: &Profile<D>| match setup.location {
        Location::Cell => profile.cell_means(mesh),
        Location::Node(_) => mesh.nodes().iter().map(|x| profile.value(x)).collect(),
        Location::Points => points::cell_means(mesh, &sampled_at_points(profile, mesh)),
    };
    profiles.iter().map(of_component).collect()
}

/// The values of a profile at the integration points, by their number.
pub(super) fn sampled_at_points<C: Cell<D>, const D: usize>(
    profile: &Profile<D>,
    mesh: &Mesh<C, D>,
) -> Vec<Vec<f64>> {
    let at_point = |number: usize| {
        let local = points::local(number);
        (0..mesh.grid().len()).map(|cell| profile.value(&mesh.cell(cell).map(&local))).collect()
    };
    (0..points::count(D)).map(at_point).collect()
}
