//! Pictures as SVG.

use super::*;
use vofkit::export::picture::write_picture;
use vofkit::geometry::Quad;

#[test]
fn a_picture_has_cells_lines_interfaces_and_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disc.svg");
    let mesh = mesh::<Quad, 2>([4, 3]);
    let mut facets = segments();
    facets[0].loops[0][0][0] = f64::NAN;
    facets[1].loops[0][0][0] = f64::INFINITY;
    write_picture(&path, &mesh, &names(), &fractions(12), &facets, "<title> & \u{1}").unwrap();
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
        let error = write_picture(&path, &mesh, &names(), fractions, facets, "").unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    };
    refused(&fractions(12)[..1], &[], "2 materials have names, 1 have fractions");
    refused(&fractions(11), &[], "`disc` has 11 values, the mesh has 12 cells");
    refused(&fractions(12), &[facet(0, 2, vec![])], "cell 0 is of material 2, but 2 names");
    assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
}
