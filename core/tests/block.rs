//! The slider block over friction curves in closed form, against the reference values of its first slips.

mod common;

use asperity::block::{Block, Drive, End, Loading, Regime, Slip, StickSlip, critical_stiffness};
use asperity::exact::{ClosedForm, Gaussian, Rectangular};
use asperity::population::Population;
use common::curve::{self, ClosedCurve};

fn pull(population: &mut dyn Population, stiffness: f64, slip: Slip, turning_points: &[f64]) -> StickSlip {
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let drive = Drive { turning_points: turning_points.to_vec(), points: 101 };
    block.pull(population, &drive, &mut ()).unwrap()
}

const UNDAMPED: Slip = Slip::Inertial { mass: 1.0, damping: 0.0 };

/// σ, K, X_1, F_1, period of resets, X_2 overdamped and inertial.
const FIRST_SLIPS: [[f64; 7]; 3] = [
    [0.05, 1.0, 0.9193897819656, 0.8713694334127, 1.790759215378, 1.395379607689, 1.772833616443],
    [0.1, 1.0, 0.8925878043021, 0.7736105511280, 1.666198355430, 1.332802416243, 1.599378752724],
    [0.2, 0.5, 0.8855675280253, 0.6696859786180, 2.224939485261, 1.389965210192, 1.624726721071],
];

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
}

#[test]
fn first_slips_are_those_of_the_table() {
    for [std, stiffness, x1, f1, period, overdamped, inertial] in FIRST_SLIPS {
        // Digits printed.
        let digits = 1e-12;
        let reset = pull(&mut curve::gaussian(std), stiffness, Slip::Reset, &[10.0]);
        near(reset.events[0].before.position, x1, digits);
        near(reset.events[0].before.force, f1, digits);
        for pair in reset.events.windows(2) {
            near(pair[1].before.drive - pair[0].before.drive, period, digits);
            near(pair[1].drop(), f1, digits);
        }
        let slow = pull(&mut curve::gaussian(std), stiffness, Slip::Overdamped, &[4.0]);
        near(slow.events[0].after.position, overdamped, digits);
        let swung = pull(&mut curve::gaussian(std), stiffness, UNDAMPED, &[4.0]);
        near(swung.events[0].position_turn, inertial, 1e-11);
        println!("{std} {:e}", swung.events[0].position_turn - inertial);
        println!("{} | {} | {}", reset.regime, slow.regime, swung.regime);
    }
}

#[test]
fn overdamped_slips_are_finitely_many() {
    for (std, stiffness, slips) in [(0.05, 1.0, 15), (0.05, 0.5, 28), (0.1, 1.0, 3)] {
        let slow = pull(&mut curve::gaussian(std), stiffness, Slip::Overdamped, &[60.0]);
        println!("{}", slow.regime);
        let Regime::Transient { slips: found, .. } = slow.regime else { panic!("{}", slow.regime) };
        assert_eq!(found, slips);
    }
}
