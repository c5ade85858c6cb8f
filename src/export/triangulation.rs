//! Polygons in a plane as triangles, by ear clipping.

use vofkit_geometry::Vector;

/// The triangles of a simple polygon that runs counter-clockwise about `normal`, as indices into `points`.
///
/// A convex polygon becomes a fan about its first point. No points are added, so that neighbouring facets
/// still meet in the same edges. There are always `points.len() - 2` triangles; where the polygon intersects
/// itself or has no extent, some of them overlap or have no area.
pub(super) fn triangles(points: &[Vector<3>], normal: &Vector<3>) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len().saturating_sub(2));
    while left.len() > 3 {
        let n = left.len();
        let corner = |at: usize| [left[(at + n - 1) % n], left[at % n], left[(at + 1) % n]];
        let at = (1..=n).find(|&at| is_ear(points, normal, &left, corner(at))).unwrap_or(1) % n;
        triangles.push(corner(at));
        left.remove(at);
    }
    if let [a, b, c] = left[..] {
        triangles.push([a, b, c]);
    }
    triangles
}

/// Whether a corner of the polygon is convex and no other point lies in its triangle or on the cut.
fn is_ear(points: &[Vector<3>], normal: &Vector<3>, left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let turn = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [points[a], points[b], points[c]];
        (b - a).cross(&(c - b)).dot(normal)
    };
    turn(a, b, c) > 0.0
        && !left.iter().any(|&p| {
            ![a, b, c].contains(&p) && turn(a, b, p) > 0.0 && turn(b, c, p) > 0.0 && turn(c, a, p) >= 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::triangles;
    use vofkit_geometry::Vector;

    fn areas(points: &[[f64; 2]]) -> Vec<f64> {
        let points: Vec<_> = points.iter().map(|p| Vector::<3>::new(0.5, p[0], p[1])).collect();
        let area = |[a, b, c]: [usize; 3]| {
            0.5 * (points[b] - points[a]).cross(&(points[c] - points[a])).dot(&Vector::<3>::x())
        };
        triangles(&points, &Vector::<3>::x()).into_iter().map(area).collect()
    }

    #[test]
    fn a_convex_polygon_becomes_a_fan() {
        let points = [[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.0, 2.0], [0.0, 2.0]];
        let flat: Vec<_> = points.iter().map(|p| Vector::<3>::new(p[0], p[1], 0.0)).collect();
        assert_eq!(triangles(&flat, &Vector::<3>::z()), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn triangles_of_a_comb_are_positive_and_add_up() {
        let comb = [
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 4.0],
            [5.0, 1.0],
            [4.0, 4.0],
            [3.0, 1.0],
            [2.0, 4.0],
            [1.0, 1.0],
            [0.0, 4.0],
        ];
        let found = areas(&comb);
        assert_eq!(found.len(), comb.len() - 2);
        assert!(found.iter().all(|&area| area > 0.0), "{found:?}");
        assert!((found.iter().sum::<f64>() - 15.0).abs() <= 1e-14);
    }

    #[test]
    fn anything_gives_two_triangles_less_than_points() {
        for count in 0..9 {
            for value in [0.0, f64::NAN, f64::INFINITY] {
                assert_eq!(areas(&vec![[value, 1.0]; count]).len(), count.saturating_sub(2));
            }
        }
    }
}
