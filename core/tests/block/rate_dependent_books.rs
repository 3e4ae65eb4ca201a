//! The books of a slider block over time-dependent contacts: every term counted on its own, and nothing left over.

use crate::common::pulled::near;
use crate::common::{contacts, gamma, gaussian, initial, point};
use asperity::block::{Block, Loading, Slide, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, FreeFriction, Rules, Stiffness, Temperature};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Transport};
use asperity::rate_dependent::RateDependentContacts;

/// Of a step of the slider, as a length …
const TOLERANCE: f64 = 1e-4;
/// … and how far its top goes.
const WAY: f64 = 5.0;

const DAMPED: Slip = Slip::Damped { damping: 0.1 };
const INERTIAL: Slip = Slip::Inertial { mass: 1.0, damping: 0.1 };

fn slide(stiffness: f64, slip: Slip, contacts: &dyn RateDependentContacts, velocity: f64) -> Slide {
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let drive = History::new(vec![Piece { velocity, duration: WAY / velocity }]).unwrap();
    block.follow_with(contacts, &drive, &[], TOLERANCE, &mut ()).unwrap()
}

fn of(rules: Rules) -> Contacts {
    Contacts { rules, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) }
}

fn aged(ageing: Ageing) -> Rules {
    Rules { ageing: Some(ageing), ..Rules::default() }
}

fn strengthening() -> Ageing {
    Ageing::Logarithmic { growth: 0.05, time: 1.0 }
}

fn diffusing() -> Ageing {
    Ageing::Smoluchowski { mature: gaussian(1.3, 0.2), diffusion: 0.04 }
}

fn warm() -> Rules {
    let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1.0) };
    Rules { temperature: Some(temperature), ..Rules::default() }
}

/// Contacts that slide for a while before they form again.
fn free() -> Rules {
    let times: SharedLaw = gamma(4.0, 2.0);
    let free_friction = FreeFriction { force: 0.1, viscosity: 0.05 };
    Rules { delay: times.into(), free_friction, ..Rules::default() }
}

fn per_threshold(contacts: Contacts) -> Contacts {
    Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts }
}

/// Transport from relaxed contacts.
fn transport(contacts: &Contacts, tolerance: f64) -> Transport {
    Transport::new_with(contacts.clone(), &initial(&point(0.0)), tolerance, &mut ()).unwrap()
}

#[test]
fn the_work_is_found_again() {
    let ageing = |ageing, rules| Rules { ageing: Some(ageing), ..rules };
    let cases = [
        (
            "logarithmic, spread",
            Contacts { reforming: gaussian(0.2, 0.05), ..of(aged(strengthening())) },
            DAMPED,
        ),
        ("delay", of(Rules { delay: 2.0.into(), ..warm() }), INERTIAL),
        ("free", of(free()), INERTIAL),
        ("identical", Contacts { thresholds: point(1.0), ..of(warm()) }, INERTIAL),
        ("per threshold", per_threshold(of(ageing(strengthening(), warm()))), INERTIAL),
    ];
    for (name, contacts, slip) in cases {
        let run = slide(0.4, slip, &transport(&contacts, 1e-4), 1e-2);
        assert!(run.energy.breaks > 0.5 && !run.slips.is_empty(), "{name}: {run:?}");
        // Each step is right to the tolerance, times forces below 1; there are no more than its way has of it.
        assert!(run.energy.imbalance().abs() < TOLERANCE * WAY, "{name}: {:e}", run.energy.imbalance());
    }
    let diffusing = per_threshold(of(ageing(diffusing(), warm())));
    let run = slide(0.4, DAMPED, &transport(&diffusing, 1e-3), 1e-1);
    assert!(run.energy.strengthening < -0.01, "{run:?}");
    assert!(run.energy.imbalance().abs() < TOLERANCE * WAY, "{:e}", run.energy.imbalance());
}

#[test]
fn steady_sliding_loses_what_the_renewal_equation_says() {
    let velocity = 0.1;
    for (contacts, accuracy) in [
        (of(aged(strengthening())), 1e-6),
        (per_threshold(of(aged(strengthening()))), 1e-4),
        // Panels of the energy are as wide as the tolerance allows.
        (of(warm()), 2e-5),
        // Of diffusion, with its cells of the width √tolerance.
        (of(aged(diffusing())), 2e-3),
    ] {
        let equation = MasterEquation::at(contacts.clone(), &initial(&point(0.0)), velocity).unwrap();
        let (steady, life) = (equation.steady_state(), equation.life());
        let mut sliding = Transport::steady_with(&contacts, velocity, 1e-4, &mut ()).unwrap();
        sliding.step(3.0, 3.0 / velocity, &mut ()).unwrap();
        let energies = sliding.energies();
        let lost = 3.0 * steady.breaking_rate() * life.breaking_energy().curve().value(0.0);
        near(energies.lost, lost, accuracy);
        // What comes by work and by stiffening goes with the breaks.
        near(3.0 * steady.kinetic_friction() + energies.strengthening, lost, accuracy);
    }
}

#[test]
fn slips_share_the_books_of_the_whole() {
    let run = slide(0.4, INERTIAL, &transport(&of(aged(strengthening())), 1e-4), 1e-2);
    let slip = &run.slips[0];
    assert!(slip.energy.breaks > 0.0 && slip.energy.dissipated() > 0.0);
    near(slip.energy.imbalance(), 0.0, TOLERANCE);
}
