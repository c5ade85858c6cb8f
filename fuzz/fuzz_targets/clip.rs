//! A region of any fourteen corners cut by one plane and then by another: nothing panics, everything is finite, the parts
//! sum to the whole, and where a region has no room for a cut its simplices have.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit_fuzz::Input;
use vofkit_geometry::clip::{Full, Polyhedron, Region, Side};
use vofkit_geometry::{HalfSpace, Vector};

/// Both parts of a region.
fn parts(whole: &Polyhedron, half_space: &HalfSpace<3>) -> Result<[Polyhedron; 2], Full> {
    let (mut below, mut above) = (Polyhedron::empty(), Polyhedron::empty());
    Ok(match whole.split(half_space, &mut below, &mut above)? {
        Side::Below => [whole.clone(), Polyhedron::empty()],
        Side::Above => [Polyhedron::empty(), whole.clone()],
        Side::Across => [below, above],
    })
}

fuzz_target!(|inputs: (Input, Input)| {
    let (first, second) = inputs;
    let middles: [Vector<3>; 6] = std::array::from_fn(|i| second.nodes[i]);
    let whole = Polyhedron::fans(&first.nodes, &middles);
    let size = whole.corners().map(|x| x.amax()).fold(0.0, f64::max);
    let add_up = |whole: &Polyhedron, parts: &[Polyhedron; 2]| {
        let [below, above] = parts.each_ref().map(Region::volume);
        let error = (below + above - whole.volume()).abs();
        assert!(error <= 1e-11 * size.powi(3), "{error:e} of {whole:?}: {below:e} {above:e}");
    };
    let half_spaces = [&first, &second].map(|input| {
        let constant = if input.number.is_finite() { input.number } else { 0.0 };
        HalfSpace { normal: input.normal, constant }
    });
    let cut_twice = |whole: &Polyhedron| -> Result<(), Full> {
        let both = parts(whole, &half_spaces[0])?;
        add_up(whole, &both);
        for part in &both {
            add_up(part, &parts(part, &half_spaces[1])?);
        }
        Ok(())
    };
    if cut_twice(&whole).is_err() {
        whole.simplices(&mut |simplex| cut_twice(simplex).expect("a simplex has room"));
    }
});
