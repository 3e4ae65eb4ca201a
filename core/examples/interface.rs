//! An interface of sixteen cells, from event to event, with the state of every cell in between.
//!
//! `cargo run --release -p asperity --example interface`; the same in Python is `python/examples/interface.py`.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{Curves, Interface, InterfaceParameters};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;
use asperity::shape::{Edges, Shape};

fn main() -> asperity::Result<()> {
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
    let population = MasterEquation::new(contacts, &Initial::default())?.population()?;

    // Cells share a curve F(X) up to a scale of their lengths: the fifth is weak, the others rise along the chain.
    let scales: Vec<f64> = (0..16).map(|j| if j == 4 { 0.8 } else { 1.0 + 0.01 * f64::from(j) }).collect();
    let cells = Curves::new(&population, scales.len())?.scaled(scales)?;
    let springs = neighbours(Shape::Chain(16), Edges::Open, 0.3)?;
    let mut chain = Interface::new(Box::new(cells), springs, InterfaceParameters::new(0.5, 1e-6))?;

    // `next` goes on to the next slide, and gives its events, each with the cells that slipped.
    while chain.drive() < 4.0 {
        for (event, slipped) in chain.next(4.0)? {
            println!(
                "X_T = {:.4}: {} cells from cell {}, force drop {:.4}",
                event.drive,
                slipped.len(),
                event.epicentre,
                event.drop()
            );
        }
    }
    println!(
        "at X_T = {:.1} cell 0 is at {:.4}, cell 15 at {:.4}",
        chain.drive(),
        chain.positions()[0],
        chain.positions()[15]
    );
    Ok(())
}
