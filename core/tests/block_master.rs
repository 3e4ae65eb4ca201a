//! The block over the master equation: what the closed forms cannot tell, and both together.

mod common;

use asperity::block::{Slip, StickSlip, critical_stiffness};
use common::pulled::{UNDAMPED, near, pull};
use common::{gaussian, master, point};

/// Relaxed contacts with Gaussian thresholds, forces to `TOLERANCE`.
fn over(std: f64, stiffness: f64, slip: Slip, turning_points: &[f64]) -> StickSlip {
    let relaxed = point(0.0);
    let mut population = master(&gaussian(1.0, std), &relaxed, &relaxed).population(TOLERANCE).unwrap();
    pull(&mut population, stiffness, slip, turning_points)
}

const TOLERANCE: f64 = 1e-11;

/// σ, K, X_1, F_1, X_2 overdamped and inertial.
const FIRST_SLIPS: [[f64; 6]; 2] = [
    [0.05, 1.0, 0.9193897819656, 0.8713694334127, 1.395379607689, 1.772833616443],
    [0.1, 1.0, 0.8925878043021, 0.7736105511280, 1.332802416243, 1.599378752724],
];

#[test]
fn first_slips_are_those_of_the_table() {
    for [std, stiffness, x1, f1, overdamped, inertial] in FIRST_SLIPS {
        let [reset, slow, swung] =
            [Slip::Reset, Slip::Overdamped, UNDAMPED].map(|slip| over(std, stiffness, slip, &[4.0]));
        for first in [&reset, &slow, &swung].map(|run| run.events[0]) {
            // Where F'' is some 1/σ², an error of F' moves X_1 by less than itself.
            near(first.before.position, x1, 1e-9);
            near(first.before.force, f1, 1e-10);
        }
        near(slow.events[0].after.position, overdamped, 1e-9);
        near(swung.events[0].position_turn, inertial, 1e-9);
        println!("{:e}", swung.events[0].position_turn - inertial);
        for run in [reset, slow, swung] {
            for event in run.events {
                println!("{:e} {:e}", event.energy.imbalance(), event.approach.imbalance());
                near(event.energy.imbalance(), 0.0, 1e-9);
                near(event.approach.imbalance(), 0.0, 1e-9);
            }
        }
    }
}

#[test]
fn arrest_persists_below_a_second_stiffness() {
    for std in [0.05, 0.1, 0.2] {
        let relaxed = point(0.0);
        let population = master(&gaussian(1.0, std), &relaxed, &relaxed).population(1e-8).unwrap();
        let critical = critical_stiffness(&population, 5.0, &mut ()).unwrap();
        for part in [0.2, 0.3, 0.4, 0.5, 0.55] {
            let start = std::time::Instant::now();
            let mut population = population.clone();
            let run = pull(&mut population, part * critical, Slip::Arrest, &[40.0]);
            let drops: Vec<_> = run.events.iter().map(|e| (1e4 * e.drop()).round() / 1e4).collect();
            println!("{std} {part} {:?} {} {:?}", start.elapsed(), run.regime, drops);
        }
    }
}
