//! A distribution of thresholds of one's own, by its density alone.
//!
//! `cargo run --release -p asperity --example law`; the same in Python is `python/examples/law.py`.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::law::{Law, Point, Tabulated};
use asperity::master::MasterEquation;

/// The density, up to a factor: a parabola between stretches of 0.5 and 1.5.
fn density(x: f64) -> f64 {
    (x - 0.5) * (1.5 - x)
}

fn main() -> asperity::Result<()> {
    // Values on a grid suffice. The density is linear between them and normalised.
    let grid = (0..=400).map(|i| 0.5 + f64::from(i) / 400.0);
    let rows: Vec<(f64, f64)> = grid.map(|x| (x, density(x))).collect();
    let thresholds = Arc::new(Tabulated::from_density(&rows)?);
    println!("mean {:.6}, standard deviation {:.6}", thresholds.mean(), thresholds.std());

    let contacts = Contacts::new(thresholds, Arc::new(Point::new(0.0)?));
    let equation = MasterEquation::new(contacts, &Initial::default())?;
    let pull = equation.pull(10.0)?;
    if let Some(peak) = pull.static_friction() {
        println!("static friction {:.6} at X = {:.6}", peak.value, peak.position);
    }
    // In closed form ⟨x²⟩/2⟨x⟩ = 21/40 for the parabola.
    println!("kinetic friction {:.5}, closed form {:.5}", equation.steady_state().kinetic_friction(), 0.525);
    Ok(())
}
