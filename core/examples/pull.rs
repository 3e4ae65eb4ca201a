//! The force of a slider from the first loading to steady sliding: the contacts of Fig. 2 of Braun and Peyrard (2008).
//!
//! `cargo run --release -p asperity --example pull`; the same in Python is `python/examples/pull.py`.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;

fn main() -> asperity::Result<()> {
    // Thresholds of mean 1 and standard deviation 0.05; contacts that break re-form without stretch.
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.05)?), Arc::new(Point::new(0.0)?));
    let initial = Initial::new(Arc::new(Gaussian::new(0.1, 0.025)?));

    // Infinitely many contacts, by the master equation.
    let equation = MasterEquation::new(contacts.clone(), &initial)?;
    let pull = equation.pull(20.0)?;
    for position in [0.5, 1.0, 2.0, 5.0, 20.0] {
        println!("F({position}) = {:.6}", pull.force(position));
    }
    if let Some(peak) = pull.static_friction() {
        println!("static friction {:.6} at X = {:.6}", peak.value, peak.position);
    }
    println!("kinetic friction {:.6}", equation.steady_state().kinetic_friction());
    println!("critical stiffness {:.4}", pull.critical_stiffness());

    // A thousand contacts, one by one, with the standard error of their force.
    let sample = Ensemble::new(contacts, initial, 1000, 1, Disorder::Annealed)?.pull(&[5.0])?;
    println!("a thousand contacts: F(5) = {:.6} ± {:.6}", sample.force[0], sample.error[0]);
    Ok(())
}
