//! Interfaces of few words for tests.
#![allow(dead_code)]

use std::ops::ControlFlow;

use asperity::elastic::coupling::neighbours;
use asperity::elastic::{CellLoading, CellSlip, Coupling, Curves, Event, Interface, InterfaceParameters};
use asperity::monitor::Monitor;
use asperity::population::Population;
use asperity::shape::{Edges, Shape};

pub fn setting(connection: f64, slip: CellSlip, drive_tolerance: f64) -> InterfaceParameters {
    InterfaceParameters {
        connection,
        loading: CellLoading::Uniform,
        slip,
        viscosity: None,
        drive_tolerance,
        area: None,
    }
}

pub fn interface(
    population: &dyn Population,
    scales: Option<Vec<f64>>,
    coupling: Box<dyn Coupling>,
    setting: InterfaceParameters,
) -> Interface {
    let curves = Curves::new(population, coupling.shape().size()).unwrap();
    let curves = match scales {
        Some(scales) => curves.scaled(scales).unwrap(),
        None => curves,
    };
    Interface::new(Box::new(curves), coupling, setting).unwrap()
}

/// An open chain.
pub fn chain(
    population: &dyn Population,
    cells: usize,
    stiffness: f64,
    connection: f64,
    slip: CellSlip,
    drive_tolerance: f64,
) -> Interface {
    let coupling = neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap();
    interface(population, None, coupling, setting(connection, slip, drive_tolerance))
}

/// The events up to a drive.
pub fn events(interface: &mut Interface, drive: f64) -> Vec<Event> {
    let mut events = Vec::new();
    interface.run(drive, &mut |event, _| events.push(*event)).unwrap();
    events
}

/// A monitor that says stop when it is asked for the nth time.
pub struct Impatient(pub usize);

impl Monitor for Impatient {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Scales 1 + std z, with z from sums of twelve numbers of a congruential sequence (D. E. Knuth's MMIX).
pub fn scales(number: usize, std: f64) -> Vec<f64> {
    let mut word = 1_u64;
    let mut uniform = || {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (word >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..number).map(|_| 1.0 + std * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect()
}
