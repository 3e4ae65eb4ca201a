//! Stick-slip of a block that is pulled through a soft spring.
//!
//! `cargo run --release -p asperity --example block`; the same in Python is `python/examples/block.py`.

use std::sync::Arc;

use asperity::block::{Block, Drive, Loading, Slip};
use asperity::contacts::{Contacts, Initial};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;

fn main() -> asperity::Result<()> {
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.05)?), Arc::new(Point::new(0.0)?));
    let equation = MasterEquation::new(contacts, &Initial::default())?;

    // Slips are possible behind springs softer than the steepest fall of the force.
    println!("critical stiffness {:.4}", equation.pull(20.0)?.critical_stiffness());

    // In a slip all contacts break, and the spring relaxes: the rule of the paper.
    let block = Block::new(Loading::Spring(1.0), Slip::Reset, None)?;
    let run = block.pull(&mut equation.population()?, &Drive::to(8.0))?;
    for slip in &run.events {
        println!(
            "slip at X_T = {:.5}: from X = {:.5} by {:.5}, force drop {:.5}",
            slip.before.drive,
            slip.before.position,
            slip.slip(),
            slip.drop()
        );
    }
    Ok(())
}
