//! The plane for any fraction of any eight nodes: a typed error, or a plane that gives the fraction back where the
//! cell is valid.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit_fuzz::Input;
use vofkit_geometry::{Cell, Defect, HalfSpace, Hexahedron, PositionError, PositionMethod};

fuzz_target!(|input: Input| {
    let cell = Hexahedron::new(input.nodes);
    let valid = !cell.defects().iter().any(Defect::is_error);
    let volume = cell.volume();
    let Input { normal, number: fraction, .. } = input;
    // The volume of a nearly flat cell is the rounding of larger terms, and need not be monotone.
    let measurable = normal.amax() > 1e-50 && volume > 1e-4 * input.extent().powi(3) && volume > 1e-150;
    for method in [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent] {
        match cell.plane_constant(&normal, fraction, method) {
            Ok(position) => {
                assert!((0.0..=1.0).contains(&fraction) && volume > 0.0);
                assert!(position.constant.is_finite() && position.evaluations <= 101, "{position:?}");
                if valid && measurable {
                    let found = cell.truncate(&HalfSpace { normal, constant: position.constant });
                    // The constant is rounded; a unit of it changes the volume by the section's area.
                    let area = (found.section_area * normal.norm()).max(input.extent().powi(2));
                    let allowed = 1e-12 * volume + 1e-14 * (input.distance() + input.extent()) * area;
                    let error = (found.volume - fraction * volume).abs();
                    assert!(error <= allowed, "{method:?}: {error:e} of {volume:e}, {position:?}, {found:?}");
                }
            }
            Err(PositionError::Fraction(bad)) => assert!(!(0.0..=1.0).contains(&bad)),
            Err(PositionError::Normal) => assert!(normal.iter().all(|&c| c == 0.0)),
            Err(PositionError::Volume(bad)) => assert!(!(bad > 0.0 && bad.is_finite())),
            Err(PositionError::NoConvergence { residual, .. }) => {
                let has_direction = normal.amax() > 1e-50 && volume > 1e-150;
                assert!(!valid || !has_direction, "{method:?}: {residual:e} of {volume:e}");
            }
        }
    }
});
