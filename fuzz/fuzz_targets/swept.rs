//! The region between any two faces: its volume is finite, the same with and without what cuts need, and the opposite the other way
//! round; the parts that a plane leaves of it add up.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit_fuzz::Input;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};

fn check<C: Cell<D>, const D: usize>(
    back: &[Vector<D>],
    face: &[Vector<D>],
    half_space: &HalfSpace<D>,
    scale: f64,
) {
    let region = C::swept(back, face);
    let volume = region.volume();
    assert!(volume.is_finite(), "{region:?}");
    let alone = C::swept_volume(back, face);
    assert!((alone - volume).abs() <= 1e-13 * scale, "{alone:e} {volume:e}");
    let there = C::swept(face, back).volume();
    assert!((there + volume).abs() <= 1e-13 * scale, "{there:e} {volume:e}");
    let [below, above] = [*half_space, half_space.complement()].map(|side| region.truncate(&side).volume);
    assert!(below.is_finite() && above.is_finite(), "{below:e} {above:e}");
    // Without a direction there are no parts.
    if half_space.normal.amax() * scale.powf(1.0 / D as f64) > 1e-100 && scale > 1e-250 {
        assert!((below + above - volume).abs() <= 1e-13 * scale, "{below:e} and {above:e} of {volume:e}");
    }
}

fuzz_target!(|input: Input| {
    let number = if input.number.is_finite() { input.number } else { 0.0 };
    let half_space = HalfSpace { normal: input.normal, constant: number };
    let extent = input.extent() + input.distance();
    check::<Hexahedron, 3>(&input.nodes[..4], &input.nodes[4..], &half_space, extent.powi(3));
    let planar = input.nodes.map(|x| x.xy());
    let half_plane = HalfSpace { normal: input.normal.xy(), constant: number };
    check::<Quad, 2>(&planar[..2], &planar[2..4], &half_plane, extent.powi(2));
});
