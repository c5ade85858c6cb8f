//! Pictures as SVG and PNG.

use super::*;
use resvg::tiny_skia::Pixmap;
use vofkit::export::ExportError;
use vofkit::export::Snapshot;
use vofkit::export::picture::{Look, Paint, draw, write_animation, write_png, write_svg};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Hexahedron, Quad};
use vofkit::interface::{Reconstruction, reconstruct};
use vofkit::shape::Shape;

#[test]
fn a_picture_has_cells_lines_interfaces_and_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disc.svg");
    let mesh = mesh::<Quad, 2>([4, 3]);
    let mut facets = segments();
    facets[0].loops[0][0][0] = f64::NAN;
    facets[1].loops[0][0][0] = f64::INFINITY;
    let title = "<title> & \u{1}";
    let (names, fractions) = (names(), fractions(12));
    let snapshot = Snapshot { mesh: &mesh, names: &names, fractions: &fractions, facets: &facets, title };
    write_svg(&path, &snapshot).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("&lt;title&gt; &amp;  \n</text>"), "{text}");
    assert!(text.contains("salt \"&amp;\" &lt;water&gt; #1"), "{text}");
    // Eleven levels of one material, ten of the other, the mesh, two interfaces.
    assert_eq!(text.matches("<path").count(), 11 + 10 + 1 + 2, "{text}");
    // Of the facets with points that are not finite only the whole segment is left.
    assert!(text.contains("d=\"M40000 24200l-18800 0\""), "{text}");
    assert!(!text.contains("NaN") && !text.contains("inf") && text.ends_with("</svg>"), "{text}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disc.svg");
    let mesh = mesh::<Quad, 2>([4, 3]);
    let refused = |fractions: &[Vec<f64>], facets: &[Facet<2>], what: &str| {
        let snapshot = Snapshot { mesh: &mesh, names: &names(), fractions, facets, title: "" };
        let error = write_svg(&path, &snapshot).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    };
    refused(&fractions(12)[..1], &[], "2 materials have names, 1 have fractions");
    refused(&fractions(11), &[], "`disc` has 11 values, the mesh has 12 cells");
    refused(&fractions(12), &[facet(0, 2, vec![])], "cell 0 is of material 2, but 2 names");
    assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
}

#[test]
fn frames_of_an_animation_are_of_one_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.png");
    let mesh = mesh::<Quad, 2>([4, 3]);
    let (names, fractions) = (names(), fractions(12));
    let snapshot = Snapshot { mesh: &mesh, names: &names, fractions: &fractions, facets: &[], title: "" };
    let film = |frames: u32, widths: [u32; 3]| {
        write_animation::<ExportError>(&path, frames, 10, |frame| {
            let look = Look { size: Some([widths[frame as usize], 200]), ..Look::default() };
            draw(&path, &snapshot, &look)
        })
    };
    let refused = |frames, widths, what: &str| {
        let error = film(frames, widths).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
        assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
    };
    refused(0, [300; 3], "0 frames");
    refused(3, [300, 300, 301], "frame 2 has 301 x 200 pixels, those before 300 x 200");
    // One that cannot be drawn at all.
    refused(2, [300, 0, 300], "");
    film(3, [300; 3]).unwrap();
    assert_eq!(files_in(folder.path()), std::slice::from_ref(&path));
}

/// A picture, read back.
struct Seen(Pixmap);

impl Seen {
    fn of<C: Paint<D>, const D: usize>(mesh: &Mesh<C, D>, shapes: &[Shape<D>], look: &Look) -> Self {
        let fractions = volume_fractions(mesh, shapes);
        let facets = reconstruct(mesh, &fractions, Reconstruction::default()).unwrap().facets;
        let names: Vec<String> = (0..shapes.len()).map(|k| format!("number {k}")).collect();
        let snapshot =
            Snapshot { mesh, names: &names, fractions: &fractions, facets: &facets, title: "some title" };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("seen.png");
        write_png(&path, &snapshot, look).unwrap();
        assert_eq!(files_in(folder.path()), std::slice::from_ref(&path));
        Self(Pixmap::decode_png(&std::fs::read(&path).unwrap()).unwrap())
    }

    fn size(&self) -> [u32; 2] {
        [self.0.width(), self.0.height()]
    }

    fn at(&self, x: u32, y: u32) -> [u8; 3] {
        let pixel = self.0.pixel(x, y).unwrap();
        assert_eq!(pixel.alpha(), 255);
        [pixel.red(), pixel.green(), pixel.blue()]
    }

    /// The places between title and legend with colours of a kind.
    fn places(&self, is_kind: impl Fn([u8; 3]) -> bool) -> Vec<[u32; 2]> {
        let [width, height] = self.size();
        let all = (60..height - 60).flat_map(|y| (0..width).map(move |x| [x, y]));
        all.filter(|&[x, y]| is_kind(self.at(x, y))).collect()
    }
}

/// The least and the largest coordinates.
fn extent(places: &[[u32; 2]]) -> [[u32; 2]; 2] {
    [0, 1].map(|axis| {
        let along = || places.iter().map(|place| place[axis]);
        [along().min().unwrap(), along().max().unwrap()]
    })
}

fn is_blue([r, _, b]: [u8; 3]) -> bool {
    b > r.saturating_add(50)
}

fn is_orange([r, _, b]: [u8; 3]) -> bool {
    r > b.saturating_add(50)
}

fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

fn unit<C: Cell<D>, const D: usize>(n: usize) -> Mesh<C, D> {
    Mesh::unit([n; D], &Distortion::None).unwrap()
}

#[test]
fn a_disc_is_where_it_should_be() {
    let look = Look { size: Some([600, 500]), mesh: false, ..Look::default() };
    let seen = Seen::of(&unit::<Quad, 2>(32), &[ball([0.5; 2], 0.3)], &look);
    assert_eq!(seen.size(), [600, 500]);
    let [[left, right], [top, bottom]] = extent(&seen.places(is_blue));
    assert!((left + right).abs_diff(599) <= 2 && (right - left).abs_diff(bottom - top) <= 2);
    let middle = [(left + right) / 2, (top + bottom) / 2];
    // Sixty parts of a hundred of blue on white.
    let inside = seen.at(middle[0], middle[1]);
    assert!(
        inside.iter().zip([102, 170, 209]).all(|(&found, there)| found.abs_diff(there) <= 2),
        "{inside:?}"
    );
    // The interface is a dark ring at the rim and nowhere else.
    let radius = 0.5 * f64::from(right - left);
    let dark = seen.places(|[r, g, b]| r < 60 && g < 110 && b < 160);
    assert!(dark.len() >= 400, "{}", dark.len());
    for [x, y] in dark {
        let [x, y] = [f64::from(x) - f64::from(middle[0]), f64::from(y) - f64::from(middle[1])];
        assert!((x.hypot(y) / radius - 1.0).abs() <= 0.05, "{x} {y} {radius}");
    }
}

#[test]
fn materials_fragments_and_normals_have_their_colours() {
    let mesh = unit::<Quad, 2>(20);
    let discs = [ball([0.25, 0.5], 0.15), ball([0.75, 0.5], 0.15)];
    let look = Look { mesh: false, ..Look::default() };
    let seen = Seen::of(&mesh, &discs, &look);
    assert_eq!(seen.size()[0], 800);
    let [blue, orange] = [seen.places(is_blue), seen.places(is_orange)].map(|places| extent(&places)[0]);
    assert!(blue[1] < 400 && orange[0] >= 400, "{blue:?} {orange:?}");

    let both = Shape::Union(discs.to_vec());
    let seen = Seen::of(&mesh, std::slice::from_ref(&both), &look);
    assert!(seen.places(is_orange).is_empty());
    let seen = Seen::of(&mesh, std::slice::from_ref(&both), &Look { fragments: true, ..look });
    assert!(!seen.places(is_blue).is_empty() && !seen.places(is_orange).is_empty());

    let plain = extent(&Seen::of(&mesh, &discs, &look).places(is_blue))[0];
    let arrows = extent(&Seen::of(&mesh, &discs, &Look { normals: true, ..look }).places(is_blue))[0];
    // They point out of the material, over most of a cell of 37 pixels.
    assert!((20..40).contains(&(plain[0] - arrows[0])), "{plain:?} {arrows:?}");

    let lines = Seen::of(&mesh, &discs, &Look::default()).places(|[r, g, b]| r == g && g == b && r < 250);
    assert!(lines.len() >= 42 * 300, "{}", lines.len());
}

#[test]
fn more_fragments_than_colours_share_the_last_one() {
    let mesh = unit::<Quad, 2>(40);
    let centre = |k: usize| [0.1 + 0.2 * (k % 5) as f64, 0.3 + 0.4 * (k / 5) as f64];
    let drops = (0..10).map(|k| ball(centre(k), 0.05 + 0.002 * k as f64)).collect();
    let look = Look { fragments: true, mesh: false, ..Look::default() };
    let seen = Seen::of(&mesh, &[Shape::Union(drops)], &look);
    let mut grey = seen.places(|[r, g, b]| r == g && g == b && (120..200).contains(&r));
    // The legend has several lines below the mesh.
    grey.retain(|place| place[1] < 800);
    // The three smallest are the first ones in the lower row.
    let [across, down] = extent(&grey);
    assert!(across[1] < 450 && down[0] > 500, "{across:?} {down:?}");
}

#[test]
fn a_sphere_is_round_and_shaded_from_every_side() {
    let mesh = unit::<Hexahedron, 3>(12);
    for view in ["front", "back", "left", "right", "top", "bottom", "iso", "-70,-20"] {
        let look = Look {
            size: Some([400, 400]),
            view: Some(view.parse().unwrap()),
            mesh: false,
            ..Look::default()
        };
        let seen = Seen::of(&mesh, &[ball([0.5; 3], 0.35)], &look);
        assert_eq!(seen.size(), [400, 400]);
        let blue = seen.places(is_blue);
        let [[left, right], [top, bottom]] = extent(&blue);
        assert!((left + right).abs_diff(399) <= 4, "{view}: {left} {right}");
        assert!((right - left).abs_diff(bottom - top) <= 5, "{view}: {left} {right} {top} {bottom}");
        let disc = 0.25 * std::f64::consts::PI * f64::from(right - left).powi(2);
        assert!((blue.len() as f64 / disc - 1.0).abs() <= 0.06, "{view}: {} {disc}", blue.len());
        let shades: std::collections::BTreeSet<_> = blue.iter().map(|&[x, y]| seen.at(x, y)).collect();
        assert!(shades.len() >= 20, "{view}: {}", shades.len());
    }
}

#[test]
fn the_nearer_of_two_balls_hides_the_other() {
    let mesh = unit::<Hexahedron, 3>(12);
    let balls = [ball([0.5, 0.25, 0.5], 0.2), ball([0.5, 0.75, 0.5], 0.2)];
    let seen = |view: &str| {
        let view = Some(view.parse().unwrap());
        Seen::of(&mesh, &balls, &Look { view, mesh: false, ..Look::default() })
    };
    let count = |seen: &Seen| [seen.places(is_blue).len(), seen.places(is_orange).len()];
    let [blue, orange] = count(&seen("front"));
    assert!(blue > 20 * orange, "{blue} {orange}");
    let [blue, orange] = count(&seen("back"));
    assert!(orange > 20 * blue, "{blue} {orange}");
    let right = seen("right");
    let [blue, orange] = [right.places(is_blue), right.places(is_orange)].map(|places| extent(&places)[0]);
    assert!(blue[1] < orange[0], "{blue:?} {orange:?}");
}

#[test]
fn edges_slices_and_normals_of_space_are_drawn() {
    let mesh = unit::<Hexahedron, 3>(6);
    let grey = |look: Look| {
        let seen = Seen::of(&mesh, &[ball([0.5; 3], 0.3)], &look);
        seen.places(|[r, g, b]| r == g && g == b && r < 200).len()
    };
    let bare = grey(Look { mesh: false, ..Look::default() });
    let edges = grey(Look::default());
    let slice = grey(Look { slice: Some("z=3".parse().unwrap()), mesh: false, ..Look::default() });
    let normals = grey(Look { normals: true, mesh: false, ..Look::default() });
    assert_eq!(bare, 0);
    assert!(edges >= 4000 && slice >= 1000 && normals >= 200, "{edges} {slice} {normals}");
}

#[test]
fn looks_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seen.png");
    fn refused<C: Paint<D>, const D: usize>(
        path: &Path,
        facets: &[Facet<D>],
        names: usize,
        look: &Look,
    ) -> String {
        let mesh = unit::<C, D>(2);
        let names: Vec<String> = (0..names).map(|k| format!("a rather long name, number {k}")).collect();
        let fractions = vec![vec![0.5; mesh.grid().len()]; names.len()];
        let snapshot = Snapshot { mesh: &mesh, names: &names, fractions: &fractions, facets, title: "" };
        write_png(path, &snapshot, look).unwrap_err().to_string()
    }
    let view = Look { view: Some("top".parse().unwrap()), ..Look::default() };
    assert!(refused::<Quad, 2>(&path, &[], 1, &view).contains("leave out the view"));
    let slice = Look { slice: Some("z=3".parse().unwrap()), ..Look::default() };
    assert!(refused::<Quad, 2>(&path, &[], 1, &slice).contains("leave it out"));
    assert!(
        refused::<Hexahedron, 3>(&path, &[], 1, &slice)
            .contains("layer 3 of nodes across z: they go from 0 to 2")
    );
    let small = Look { size: Some([200, 200]), ..Look::default() };
    assert!(refused::<Quad, 2>(&path, &[], 20, &small).contains("200 x 200 pixels leave no room"));
    let far = facet(4, 0, vec![]);
    assert!(refused::<Quad, 2>(&path, &[far], 1, &small).contains("cell 4, but the mesh has 4 cells"));
    assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
}
