//! Orders of convergence of the schemes for quantities of the mesh, and the largest factor on MinMod that lets the total variation not grow.

#[path = "../examples/field_orders/measure.rs"]
mod measure;
#[path = "../examples/limiter_factor/search.rs"]
mod search;

use measure::{Method, cases, fitted, methods};
use search::{COURANT_NUMBERS, bound, grows, largest_factor};

/// At a Courant number where all schemes but `tvd` are stable.
#[test]
fn orders_on_a_bar_and_in_two_dimensions() {
    for case in cases() {
        let wanted: Vec<(&str, Method, f64)> =
            methods().into_iter().filter_map(|(name, method, least)| Some((name, method, least?))).collect();
        let schemes: Vec<Method> = wanted.iter().map(|(_, method, _)| *method).collect();
        let by_size: Vec<Vec<f64>> =
            case.sizes.iter().map(|&n| case.errors(n, 0.8, &schemes).expect("a valid case")).collect();
        for (k, (name, _, least)) in wanted.iter().enumerate() {
            let errors: Vec<f64> = by_size.iter().map(|errors| errors[k]).collect();
            let order = fitted(&case.sizes, &errors);
            assert!(order >= *least, "{} {name}: order {order}, errors {errors:?}", case.name);
        }
    }
}

/// The total variation of noise never grows under `tvd` with `alpha` MinMod just where `alpha <= 2 (1/Cr - 1)`.
#[test]
fn the_largest_factor_on_min_mod() {
    for courant in COURANT_NUMBERS {
        let (found, bound) = (largest_factor(courant).expect("a valid bar"), bound(courant));
        assert!((found - bound).abs() <= 1e-3, "Cr {courant}: {found}, not {bound}");
        assert!(!grows(courant, bound * (1.0 - 1e-12)).expect("a valid bar"), "Cr {courant}");
    }
}
