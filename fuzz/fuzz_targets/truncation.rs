//! Truncation of any eight nodes by any plane: everything is finite, the parts sum to the whole, and on valid cells the
//! volume grows with the plane constant and stays between nothing and the whole.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit_fuzz::Input;
use vofkit_geometry::{Cell, Defect, HalfSpace, Hexahedron};

fuzz_target!(|input: Input| {
    let cell = Hexahedron::new(input.nodes);
    let valid = !cell.defects().iter().any(Defect::is_error);
    let constant = if input.number.is_finite() { input.number } else { 0.0 };
    let half_space = HalfSpace { normal: input.normal, constant };
    let below = cell.truncate(&half_space);
    let above = cell.truncate(&half_space.complement());
    assert!(
        cell.volume().is_finite() && below.volume.is_finite() && above.volume.is_finite(),
        "{below:?} {above:?}"
    );
    for points in cell.section(&half_space) {
        assert!(points.len() > 2 && points.iter().all(|x| x.iter().all(|c| c.is_finite())), "{points:?}");
    }
    let scale = input.extent().powi(3);
    // Normals whose squares underflow, or whose products with the nodes do, carry no direction.
    if input.normal.amax() * input.extent() < 1e-100 || scale < 1e-250 {
        return;
    }
    assert!(below.section_area.is_finite() && above.section_area.is_finite(), "{below:?} {above:?}");
    let error = (below.volume + above.volume - cell.volume()).abs();
    assert!(error <= 1e-13 * scale, "{error:e} of {scale:e}: {below:?} {above:?}");
    if valid {
        let further =
            HalfSpace { constant: constant + 0.01 * input.extent() * input.normal.norm(), ..half_space };
        let more = cell.truncate(&further).volume;
        assert!(more >= below.volume - 1e-13 * scale, "{more:e} after {below:?}");
        assert!(below.volume >= -1e-13 * scale && below.volume <= cell.volume() + 1e-13 * scale, "{below:?}");
    }
});
