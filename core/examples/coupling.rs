//! An elastic coupling of one's own: every cell is connected to every other one.
//!
//! `cargo run --release -p asperity --example coupling`. Python has the couplings of the core only; of three cells on
//! a ring each is the neighbour of both others, so `python/examples/coupling.py` computes the same with those.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::elastic::{Coupling, Curves, Interface, InterfaceParameters};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;
use asperity::monitor::Monitor;
use asperity::shape::{Edges, Shape};

/// Springs of equal stiffness K between all pairs of n cells: A = nK − K 1·1ᵀ.
#[derive(Debug)]
struct EachToEach {
    cells: usize,
    stiffness: f64,
}

impl Coupling for EachToEach {
    fn shape(&self) -> Shape {
        Shape::Chain(self.cells)
    }

    fn edges(&self) -> Edges {
        Edges::Periodic
    }

    /// −A X: each cell is drawn to the mean of all.
    fn forces(
        &mut self,
        displacements: &[f64],
        forces: &mut [f64],
        _monitor: &mut dyn Monitor,
    ) -> asperity::Result<()> {
        let sum: f64 = displacements.iter().sum();
        for (force, x) in forces.iter_mut().zip(displacements) {
            *force = self.stiffness * (sum - self.cells as f64 * x);
        }
        Ok(())
    }

    /// (d + A)⁻¹ r exactly, by the formula of Sherman and Morrison.
    fn precondition(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        _monitor: &mut dyn Monitor,
    ) -> asperity::Result<bool> {
        let own = diagonal + self.cells as f64 * self.stiffness;
        let common = self.stiffness * right.iter().sum::<f64>() / diagonal;
        right.iter_mut().for_each(|r| *r = (*r + common) / own);
        Ok(true)
    }

    fn self_stiffness(&self, _cell: usize) -> f64 {
        (self.cells - 1) as f64 * self.stiffness
    }
}

fn main() -> asperity::Result<()> {
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
    let population = MasterEquation::new(contacts, &Initial::default())?.population()?;
    let cells = Curves::new(&population, 3)?.scaled(vec![0.9, 1.0, 1.1])?;
    let coupling = EachToEach { cells: 3, stiffness: 0.1 };
    let parameters = InterfaceParameters::new(0.5, 1e-6);
    let mut interface = Interface::new(Box::new(cells), Box::new(coupling), parameters)?;
    interface.run(4.0, &mut |event, slipped| {
        println!("X_T = {:.4}: {} of 3 cells, force drop {:.4}", event.drive, slipped.len(), event.drop());
    })?;
    println!("force {:.4} at X_T = {:.1}", interface.force(), interface.drive());
    Ok(())
}
