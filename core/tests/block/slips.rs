//! Slips of a block over friction curves in closed form, against the reference values.

use crate::common::curve;
use crate::common::pulled::{UNDAMPED, near, pull};
use asperity::block::{Missing, Regime, Slip, critical_stiffness};
use asperity::exact::{ClosedForm, Gaussian};

/// σ, K, X_1, F_1, period of resets, X_2 overdamped and inertial.
const FIRST_SLIPS: [[f64; 7]; 3] = [
    [0.05, 1.0, 0.9193897819656, 0.8713694334127, 1.790759215378, 1.395379607689, 1.772833616443],
    [0.1, 1.0, 0.8925878043021, 0.7736105511280, 1.666198355430, 1.332802416243, 1.599378752724],
    [0.2, 0.5, 0.8855675280253, 0.6696859786180, 2.224939485261, 1.389965210192, 1.624726721071],
];

/// Half a unit of the last digit printed, and rounding.
const DIGITS: f64 = 6e-13;

#[test]
fn first_slips_are_those_of_the_table() {
    for [std, stiffness, x1, f1, period, overdamped, inertial] in FIRST_SLIPS {
        let [reset, slow, swung] = [Slip::Reset, Slip::Overdamped, UNDAMPED]
            .map(|slip| pull(&mut curve::gaussian(std), stiffness, slip, &[4.0]).events[0]);
        for first in [reset, slow, swung] {
            near(first.before.position, x1, DIGITS);
            near(first.before.force, f1, DIGITS);
            near(first.before.drive, period, DIGITS);
        }
        near(slow.after.position, overdamped, DIGITS);
        near(swung.position_turn, inertial, DIGITS);
        // The curve of the untruncated law begins with a force that is not quite 0.
        let renewed = Gaussian::new(1.0, std).force(0.0);
        near(reset.after.position, period - renewed / stiffness, DIGITS);
    }
}

#[test]
fn resets_repeat_for_ever() {
    let [std, stiffness, _, drop, period, ..] = FIRST_SLIPS[1];
    let reset = pull(&mut curve::gaussian(std), stiffness, Slip::Reset, &[100.0]);
    let Regime::Persistent { slips: 60, period: found, drop: fallen, slip, scatter } = reset.regime else {
        panic!("{}", reset.regime)
    };
    // What 60 slips add up of the rounding of a drive near 100.
    near(found, period, 1e-12);
    near(fallen, drop, 1e-12);
    near(slip, drop / stiffness, 1e-12);
    near(scatter, 0.0, 1e-12);
}

#[test]
fn overdamped_slips_are_finitely_many() {
    for (std, stiffness, expected) in [(0.05, 1.0, 15), (0.05, 0.5, 28), (0.1, 1.0, 3)] {
        let slow = pull(&mut curve::gaussian(std), stiffness, Slip::Overdamped, &[60.0]);
        assert!(
            matches!(slow.regime, Regime::Transient { slips, .. } if slips == expected),
            "{}",
            slow.regime
        );
        assert!(slow.events.windows(2).all(|pair| pair[1].drop() < pair[0].drop()));
    }
}

#[test]
fn a_stiff_block_slides_smoothly_and_a_soft_one_slips() {
    for std in [0.05, 0.1, 0.2] {
        let critical = Gaussian::new(1.0, std).critical_stiffness();
        let slips = |stiffness: f64| pull(&mut curve::gaussian(std), stiffness, Slip::Overdamped, &[5.0]);
        let soft = slips(critical - 1e-9);
        assert_eq!(soft.events.len(), 1, "{}", soft.regime);
        let stiff = slips(critical + 1e-9);
        assert!(matches!(stiff.regime, Regime::Smooth { .. }), "{}", stiff.regime);
    }
}

#[test]
fn the_critical_stiffness_is_where_mean_field_avalanches_diverge() {
    for std in [0.05_f64, 0.1] {
        let found = critical_stiffness(&curve::gaussian(std), 5.0, &mut ()).unwrap();
        near(found, Gaussian::new(1.0, std).critical_stiffness(), 1e-12);
        // κ_c = 1/max(xP_c), at x = (x̄ + √(x̄² + 4σ²))/2.
        let x = 0.5 * (1.0 + (1.0 + 4.0 * std * std).sqrt());
        let density = (-0.5 * ((x - 1.0) / std).powi(2)).exp() / (std * (2.0 * std::f64::consts::PI).sqrt());
        near(found, x * density - 1.0, 1e-9);
    }
}

#[test]
fn an_undamped_arrest_does_not_depend_on_the_mass() {
    let [std, stiffness, .., inertial] = FIRST_SLIPS[1];
    let mut durations = Vec::new();
    for mass in [1e-2, 1e-1, 1.0, 1e1, 1e2] {
        let slip = Slip::Inertial { mass, damping: 0.0 };
        let swung = pull(&mut curve::gaussian(std), stiffness, slip, &[2.0]);
        // The turn follows from the energy balance, whatever the mass: two digits beyond the rounding of a long integration in time.
        near(swung.events[0].position_turn, inertial, 1e-10);
        durations.push(swung.course.unwrap().time.last().unwrap() / mass.sqrt());
    }
    // Times go as √M.
    durations.iter().for_each(|duration| near(*duration, durations[0], 1e-9));
}

#[test]
fn damping_brings_the_arrest_from_equal_areas_to_the_overdamped_balance() {
    let [std, stiffness, .., overdamped, inertial] = FIRST_SLIPS[1];
    let turn = |damping: f64| {
        let slip = Slip::Inertial { mass: 1.0, damping };
        pull(&mut curve::gaussian(std), stiffness, slip, &[2.0]).events[0].position_turn
    };
    let turns = [1e-6, 0.1, 0.5, 1.0].map(turn);
    assert!(turns.is_sorted_by(|a, b| a > b), "{turns:?}");
    // The damping of 1e-6 takes as much of the energy of a slip of length 1.
    assert!(turns[0] < inertial && inertial - turns[0] < 1e-5, "{turns:?}");
    // Faster than oscillations: no overshoot is left.
    for damping in [10.0, 1e3] {
        near(turn(damping), overdamped, 1e-8);
    }
}

#[test]
fn a_swing_dies_on_the_unloading_line() {
    for [std, stiffness, ..] in FIRST_SLIPS {
        let swung = pull(&mut curve::gaussian(std), stiffness, UNDAMPED, &[3.0]);
        let (first, form) = (swung.events[0], Gaussian::new(1.0, std));
        let turn = first.position_turn;
        let rest = (stiffness * first.before.drive - form.force(turn) + turn) / (stiffness + 1.0);
        // Roots and closed forms are accurate to 1e-12, and divided by slopes of order 1.
        near(first.after.position, rest, 1e-11);
        near(first.after.force, stiffness * (first.before.drive - rest), 1e-11);
    }
}

#[test]
fn a_drive_that_is_too_short_decides_nothing() {
    let regime = |end: f64| pull(&mut curve::gaussian(0.1), 1.0, Slip::Overdamped, &[end]).regime;
    for (end, slips, missing) in
        [(1.0, 0, Missing::Distance), (2.0, 1, Missing::Slips), (6.0, 3, Missing::Silence)]
    {
        assert_eq!(regime(end), Regime::Undecided { slips, missing }, "{end}");
    }
}
