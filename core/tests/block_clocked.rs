//! A slider block over contacts that know time.

mod common;

use std::time::Instant;

use asperity::block::{Block, Loading, Slide, Slip};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::history::{History, Piece};
use asperity::master::Transport;
use common::{contacts, gaussian, initial, point};

fn steady(velocity: f64, distance: f64) -> History {
    History::new(vec![Piece { velocity, duration: distance / velocity }]).unwrap()
}

fn slide(contacts: &Contacts, stiffness: f64, slip: Slip, drive: &History, tolerance: f64) -> Slide {
    let transport = Transport::new(contacts.clone(), &initial(&point(0.0)), 0.1 * tolerance).unwrap();
    let times: Vec<f64> = (0..=400).map(|i| f64::from(i) / 400.0 * drive.duration()).collect();
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    block.follow(&transport, drive, &times, tolerance, &mut ()).unwrap()
}

#[test]
fn look() {
    let athermal = contacts(&gaussian(1.0, 0.1), &point(0.0));
    for (name, slip, velocity) in [
        ("damped", Slip::Damped { damping: 1e-3 }, 1e-2),
        ("damped", Slip::Damped { damping: 1e-3 }, 1e-4),
        ("inertial", Slip::Inertial { mass: 1.0, damping: 0.0 }, 1e-3),
        ("inertial", Slip::Inertial { mass: 1.0, damping: 0.0 }, 1e-5),
    ] {
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let now = Instant::now();
            let run = slide(&athermal, 1.0, slip, &steady(velocity, 2.0), tolerance);
            let time = now.elapsed();
            println!("{name} v {velocity:e} tol {tolerance:e} {time:?} trace {} slips {} {}", run.trace.len(), run.slips.len(), run.regime);
            if let Some(s) = run.slips.first() {
                println!("  X1 {} F1 {} X2 {} after {} F {} diss {}", s.before.position, s.before.force, s.position_turn, s.after.position, s.after.force, s.dissipated);
            }
            println!("  {:?} breaks {}", run.ledger, run.ledger.breaks());
        }
    }
    let log = Contacts {
        rules: Rules { ageing: Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 }), ..Rules::default() },
        ..contacts(&gaussian(1.0, 0.2), &point(0.0))
    };
    for k in [0.05, 0.2] {
        let now = Instant::now();
        let run = slide(&log, k, Slip::Damped { damping: 0.1 }, &steady(1e-3, 40.0), 1e-3);
        println!("log K {k} {:?} slips {} {}", now.elapsed(), run.slips.len(), run.regime);
        for s in &run.slips { println!("   {} {} {} {}", s.before.drive, s.drop(), s.slip(), s.broken_fraction); }
    }
}
