//! L1 errors after one period of a sine, at each number of cells along an axis, and the fitted order, of every scheme for quantities of the mesh.
//! `cargo run --release --example field_orders [COURANT]`; the Courant number is 0.8 if none is given, and at most 1.

mod measure;

use measure::{Failure, Method, cases, fitted, methods};

/// The Courant number if none is given: where the limits of the scheme `tvd` show.
const COURANT: f64 = 0.8;

fn main() -> Result<(), Failure> {
    let courant = std::env::args().nth(1).map_or(Ok(COURANT), |text| text.parse())?;
    if !(courant > 0.0 && courant <= 1.0) {
        return Err(format!("the Courant number is {courant}; give one above 0 and up to 1").into());
    }
    let methods = methods();
    let schemes: Vec<Method> = methods.iter().map(|(_, method, _)| *method).collect();
    for case in cases() {
        let sizes = &case.sizes;
        let by_size: Result<Vec<Vec<f64>>, Failure> =
            sizes.iter().map(|&n| case.errors(n, courant, &schemes)).collect();
        let by_size = by_size?;
        println!("{}, Courant number {courant}", case.name);
        for (k, (name, _, _)) in methods.iter().enumerate() {
            let errors: Vec<f64> = by_size.iter().map(|errors| errors[k]).collect();
            let listed: Vec<String> = errors.iter().map(|error| format!("{error:.3e}")).collect();
            println!("  {name:<22} {}  order {:.2}", listed.join(" "), fitted(sizes, &errors));
        }
    }
    Ok(())
}
