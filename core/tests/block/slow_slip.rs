//! A block over contacts that are free for a random time after breaks, and slide with a friction force meanwhile.

use crate::common::{contacts, exponential, gaussian, initial, point};
use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Contacts, FreeFriction, Rules};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::Transport;
use asperity::rate_dependent::RateDependentContacts;

const FRICTION: f64 = 0.3;
const TIME: f64 = 50.0;
const STIFFNESS: f64 = 0.1;

fn sliding(friction: FreeFriction) -> Contacts {
    let delay = exponential(TIME).into();
    let rules = Rules { delay, free_friction: friction, ..Rules::default() };
    Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) }
}

fn block(slip: Slip) -> Block {
    Block::new(Loading::Spring(STIFFNESS), slip, None).unwrap()
}

fn drive(velocity: f64, duration: f64) -> History {
    History::new(vec![Piece { velocity, duration }]).unwrap()
}

/// After the fast slip the damping hardly matters: K(X_T − X) = F. Contacts re-form unstretched at the rate 1/τ, which lowers F
/// by f each, and the others are stretched, so that V = (fφ/τ + Kv)/(K + k(1 − φ)), φ the free fraction.
#[test]
fn slow_slip_follows_from_re_forming() {
    let velocity = 1e-3;
    let contacts = sliding(FreeFriction { force: FRICTION, viscosity: 0.0 });
    let transport = Transport::new(contacts, &initial(&point(0.0))).unwrap();
    let times: Vec<f64> = (1..=1600).map(|k| 10.0 * f64::from(k)).collect();
    let slide = block(Slip::Damped { damping: 0.05 })
        .follow_with(&transport, &drive(velocity, 16_000.0), &times, 1e-5, &mut ())
        .unwrap();
    let slip = slide.slips.first().unwrap();
    assert!(slip.fastest > 1e3 * velocity, "{}", slip.fastest);
    let peak = slide.trace.iter().position(|m| m.velocity == slip.fastest).unwrap_or(0);
    let mut seen = 0;
    for moment in slide.trace[peak..].iter().filter(|m| m.time < slip.after.time + 50.0) {
        let slow = (FRICTION * moment.free / TIME + STIFFNESS * velocity) / (STIFFNESS + 1.0 - moment.free);
        if moment.velocity < 2.0 * slow && (0.3..0.8).contains(&moment.free) {
            // The drag γV is a part γ/(Kτ) = 1 % of the balance, and what still breaks is less.
            assert!((moment.velocity / slow - 1.0).abs() < 0.05, "{moment:?}, not {slow}");
            seen += 1;
        }
    }
    assert!(seen > 5, "{seen} states of slow slip");
    let balance = slide.energy;
    assert!(balance.background > 0.1 * balance.work, "{balance:?}");
    assert!(balance.imbalance().abs() < 1e-3 * balance.work, "{balance:?}");
}

/// The balance closes with mass, damping, and a friction that rises with the velocity, for cohorts and for single contacts.
#[test]
fn the_energy_balance_closes() {
    let contacts = sliding(FreeFriction { force: FRICTION, viscosity: 0.2 });
    let start = initial(&point(0.0));
    let cohorts = Transport::new(contacts.clone(), &start).unwrap();
    let ensemble = Ensemble::new(contacts, start, 300, 5, Disorder::Annealed).unwrap().in_time().unwrap();
    let both: [&dyn RateDependentContacts; 2] = [&cohorts, &ensemble];
    for contacts in both {
        for slip in [Slip::Damped { damping: 0.05 }, Slip::Inertial { mass: 1.0, damping: 0.1 }] {
            let slide =
                block(slip).follow_with(contacts, &drive(0.1, 150.0), &[150.0], 1e-4, &mut ()).unwrap();
            let balance = slide.energy;
            // Steps are of second order, with an error of 1e-4 of the position each.
            let apart = balance.imbalance().abs() / balance.work;
            assert!(balance.background > 0.0 && apart < 5e-3, "{slip:?}: {apart:e} {balance:?}");
        }
    }
}
