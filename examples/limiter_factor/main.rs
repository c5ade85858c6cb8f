//! Fig. 13: the largest factor on MinMod that keeps the total variation, at seven Courant numbers, beside the bound `2 (1/Cr - 1)` and the paper's
//! fit (Eq. 71). `cargo run --release --example limiter_factor [FOLDER]` prints them and writes `limiter_factor.csv` and `limiter_factor.svg`
//! into the folder, `out` if none is given.

mod search;

use std::fs;
use std::path::PathBuf;

use search::{COURANT_NUMBERS, bound, largest_factor};
use vofkit::export::plot::{Curve, write_curves};
use vofkit::volume_associated::courant_alpha;

/// Courant numbers between which the bound and the fit are drawn straight.
const DRAWN: usize = 61;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or(PathBuf::from("out"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let mut table = "courant,largest_factor,bound,eq_71\n".to_owned();
    let mut found = Vec::new();
    for courant in COURANT_NUMBERS {
        let factor = largest_factor(courant)?;
        found.push((courant, factor));
        table += &format!("{courant},{factor:.4},{:.4},{:.4}\n", bound(courant), courant_alpha(courant));
    }
    print!("{table}");
    fs::write(folder.join("limiter_factor.csv"), table)?;

    let mut courant: Vec<f64> = (0..DRAWN).map(|i| 0.4 + 0.6 * i as f64 / (DRAWN - 1) as f64).collect();
    courant.extend(COURANT_NUMBERS);
    courant.sort_by(f64::total_cmp);
    let factor =
        |at: &f64| found.iter().find(|(courant, _)| courant == at).map_or(f64::NAN, |&(_, factor)| factor);
    let [found, bound, fit]: [Vec<f64>; 3] = [
        courant.iter().map(factor).collect(),
        courant.iter().map(|&courant| bound(courant)).collect(),
        courant.iter().map(|&courant| courant_alpha(courant)).collect(),
    ];
    let curves = [
        Curve { name: "2 (1/Cr - 1)", values: &bound },
        Curve { name: "found", values: &found },
        Curve { name: "Eq. 71", values: &fit },
    ];
    let title = "largest factor on MinMod that keeps the total variation";
    write_curves(folder.join("limiter_factor.svg"), ("Courant number", &courant), &curves, title)?;
    Ok(())
}
