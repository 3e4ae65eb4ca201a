//! Friction against velocity, of contacts that temperature breaks before their thresholds.
//!
//! `cargo run --release -p asperity --example rates`; the same in Python is `python/examples/rates.py`.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Temperature};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;

fn main() -> asperity::Result<()> {
    // The barrier is the elastic energy that a contact lacks to its threshold; T = 0.05 k⟨x_s⟩², attempt rate 1.
    let mut contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
    contacts.rules.temperature = Some(Temperature::new(0.05, 1.0));

    for velocity in [1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
        let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity)?;
        println!("F_k({velocity:.0e}) = {:.6}", equation.steady_state().kinetic_friction());
    }

    // Fast sliding leaves temperature no time.
    contacts.rules.temperature = None;
    let athermal = MasterEquation::new(contacts, &Initial::default())?;
    println!("without temperature {:.6}", athermal.steady_state().kinetic_friction());
    Ok(())
}
