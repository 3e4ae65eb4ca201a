//! Energies of a slider: each term on its own, and their sum.

use crate::common::curve;
use crate::common::pulled::{UNDAMPED, near, pull};
use asperity::block::{EnergyBalance, Slip};

#[test]
fn every_event_and_every_approach_balances() {
    let damped = Slip::Inertial { mass: 2.0, damping: 0.3 };
    for (slip, tolerance) in
        [(Slip::Reset, 1e-12), (Slip::Overdamped, 1e-12), (UNDAMPED, 1e-10), (damped, 1e-10)]
    {
        let run = pull(&mut curve::gaussian(0.1), 1.0, slip, &[12.0, 6.0, 14.0]);
        assert!(run.events.len() > 2);
        let mut sum = EnergyBalance::default();
        for event in &run.events {
            near(event.energy.imbalance(), 0.0, tolerance);
            near(event.approach.imbalance(), 0.0, tolerance);
            assert!(event.energy.breaks > 0.0 && event.energy.slip > 0.0);
            sum += event.energy;
            sum += event.approach;
        }
        near(run.energy.imbalance(), 0.0, tolerance);
        assert!(run.energy.work > sum.work);
    }
}

#[test]
fn the_first_overdamped_slip_loses_what_the_table_says() {
    let first = pull(&mut curve::gaussian(0.1), 1.0, Slip::Overdamped, &[2.0]).events[0];
    // Digits printed.
    near(first.energy.slip, 0.07085, 5e-6);
}

#[test]
fn a_reset_loses_the_spring_energy_and_all_that_contacts_store() {
    let first = pull(&mut curve::gaussian(0.1), 1.0, Slip::Reset, &[2.0]).events[0];
    near(first.energy.slip, 0.5 * first.before.force.powi(2), 1e-13);
    near(first.energy.breaks, -first.energy.elastic, 1e-13);
}

#[test]
fn what_damping_takes_is_between_nothing_and_all_of_a_slip() {
    let lost = |damping: f64| {
        let slip = Slip::Inertial { mass: 1.0, damping };
        pull(&mut curve::gaussian(0.1), 1.0, slip, &[2.0]).events[0].energy
    };
    let viscous = [0.0, 0.1, 1.0].map(|damping| lost(damping).viscous);
    assert!(viscous[0] == 0.0 && viscous.is_sorted_by(|a, b| a < b), "{viscous:?}");
    // Without overshoot all of the overdamped loss is viscous.
    let strong = lost(20.0);
    near(strong.viscous, 0.07085, 5e-6);
    near(strong.slip, 0.0, 1e-9);
}
