//! The thresholds of contacts from a measured curve of force, with errors.
//!
//! `cargo run --release -p asperity --example fit`; the same in Python is `python/examples/fit.py`.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{Fit, Measurement};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;

fn contacts(mean: f64, std: f64) -> asperity::Result<Contacts> {
    let relaxed = Arc::new(Point::new(0.0)?);
    Ok(Contacts { count: 2000.0, ..Contacts::new(Arc::new(Gaussian::new(mean, std)?), relaxed) })
}

fn main() -> asperity::Result<()> {
    // In place of a measurement: two thousand contacts of thresholds 1 ± 0.12, one by one.
    let positions: Vec<f64> = (1..=100).map(|i| 0.04 * f64::from(i)).collect();
    let measured = Ensemble::new(contacts(1.0, 0.12)?, Initial::default(), 2000, 7, Disorder::Annealed)?;
    let forces = measured.pull(&positions)?.force;

    // From a first guess. The noise of the contacts is part of the errors.
    let guess = MasterEquation::new(contacts(0.9, 0.2)?, &Initial::default())?;
    let free = ["thresholds.mean", "thresholds.std"];
    let found = Fit::new(guess, Measurement::new(positions, forces)).free(free).run()?;
    for name in free {
        if let Some(number) = found.estimate(name) {
            println!("{name} = {:.4} ± {:.4}", number.value, number.error);
        }
    }
    Ok(())
}
