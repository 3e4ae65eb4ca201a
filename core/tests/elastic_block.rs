//! One cell, and cells rigidly coupled, do what a block does.

mod common;

use asperity::block::{self, StickSlip};
use asperity::elastic::{Curves, Event, Interface, Loading, Setting, Slip};
use asperity::population::Population;
use common::chain::Chain;
use common::curve::gaussian;
use common::pulled::{near, pull};

const TOLERANCE: f64 = 1e-13;

fn interface(
    population: &dyn Population,
    cells: usize,
    stiffness: f64,
    connection: f64,
    slip: Slip,
) -> Interface {
    let curves = Curves::new(population, cells, &mut ()).unwrap();
    let setting = Setting {
        connection,
        loading: Loading::Uniform,
        slip,
        viscosity: None,
        drive_tolerance: TOLERANCE,
        area: 1.0,
    };
    Interface::new(Box::new(curves), Box::new(Chain { cells, stiffness }), setting).unwrap()
}

fn events(interface: &mut Interface, drive: f64) -> Vec<Event> {
    let mut events = Vec::new();
    interface.run(drive, &mut (), &mut |event, _| events.push(*event)).unwrap();
    events
}

/// Slips of a block and of a cell; what is lost to the accuracy by which the loss of balance is known: near it
/// K(X_T − X_c) = ½F''(X − X_1)², F'' some 1/σ².
fn same(events: &[Event], slips: &StickSlip, cells: f64) {
    assert_eq!(events.len(), slips.events.len());
    let near_fold = 1e-6;
    for (event, slip) in events.iter().zip(&slips.events) {
        near(event.drive, slip.before.drive, 1e-9);
        near(event.position_before, slip.before.position, near_fold);
        near(event.force_before / cells, slip.before.force, near_fold);
        near(event.position_after, slip.after.position, 1e-9);
        near(event.force_after / cells, slip.after.force, 1e-9);
        near(event.broken_fraction, slip.broken_fraction, near_fold);
        near(event.dissipated_breaks / cells, slip.energy.breaks, near_fold);
        near(event.dissipated_slip / cells, slip.energy.slip, near_fold);
    }
}

#[test]
fn one_cell_is_a_block() {
    for std in [0.05, 0.1] {
        for (slip, of_block) in
            [(Slip::Overdamped, block::Slip::Overdamped), (Slip::Reset, block::Slip::Reset)]
        {
            let slips = pull(&mut gaussian(std), 1.0, of_block, &[12.0]);
            let mut cell = interface(&gaussian(std), 1, 0.0, 1.0, slip);
            same(&events(&mut cell, 12.0), &slips, 1.0);
            println!("{std} {slip:?} {:e}", cell.energy().imbalance());
        }
    }
}
