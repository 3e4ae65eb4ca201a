//! The block over the master equation: with its accuracy, and where the closed forms cannot follow.

use crate::common::pulled::{UNDAMPED, near, pull};
use crate::common::{gaussian, master, point, rectangular};
use asperity::block::{Regime, Slip, StickSlip, critical_stiffness};
use asperity::exact::{ClosedForm as _, Rectangular};
use asperity::master::MasterPopulation;
use asperity::population::Population as _;

/// Relaxed contacts with Gaussian thresholds.
fn relaxed(std: f64, tolerance: f64) -> MasterPopulation {
    let relaxed = point(0.0);
    master(&gaussian(1.0, std), &relaxed, &relaxed).population_with(tolerance, &mut ()).unwrap()
}

/// σ, K, X_1, F_1, X_2 overdamped and inertial.
const FIRST_SLIPS: [[f64; 6]; 2] = [
    [0.05, 1.0, 0.9193897819656, 0.8713694334127, 1.395379607689, 1.772833616443],
    [0.1, 1.0, 0.8925878043021, 0.7736105511280, 1.332802416243, 1.599378752724],
];

#[test]
fn first_slips_are_those_of_the_table() {
    // Ten times the tolerance of the forces: the slope there is of order 1, F'' some 1/σ².
    let accuracy = 1e-10;
    for [std, stiffness, x1, f1, overdamped, inertial] in FIRST_SLIPS {
        let first = |slip| pull(&mut relaxed(std, 1e-11), stiffness, slip, &[2.0]).events[0];
        let [reset, slow, swung] = [Slip::Reset, Slip::Overdamped, UNDAMPED].map(first);
        for event in [reset, slow, swung] {
            near(event.before.position, x1, accuracy);
            near(event.before.force, f1, accuracy);
        }
        near(reset.after.position, reset.before.drive, accuracy);
        near(slow.after.position, overdamped, accuracy);
        near(swung.position_turn, inertial, accuracy);
    }
    // Digits printed.
    near(pull(&mut relaxed(0.1, 1e-11), 1.0, Slip::Overdamped, &[2.0]).events[0].energy.slip, 0.07085, 5e-6);
}

#[test]
fn contacts_without_stretch_carry_no_force_at_the_start() {
    // Exactly: of rounding in polynomials nothing is reported.
    for std in [0.05, 0.1, 0.3] {
        assert_eq!(relaxed(std, 1e-11).ahead(0.0).force, 0.0);
        let relaxed = point(0.0);
        let pull = master(&gaussian(1.0, std), &relaxed, &relaxed).pull(2.0).unwrap();
        assert_eq!([pull.force(0.0), pull.slope(0.0).round()], [0.0, 1.0]);
    }
}

#[test]
fn resets_over_rectangular_thresholds_have_the_period_of_the_closed_form() {
    let relaxed = point(0.0);
    for (min, max, stiffness) in [(0.7, 1.3, 0.5), (0.7, 1.3, 1.1), (0.7, 1.3, 0.1), (0.9, 1.1, 2.0)] {
        let thresholds = rectangular(min, max);
        let mut population = master(&thresholds, &relaxed, &relaxed).population_with(1e-11, &mut ()).unwrap();
        let run = pull(&mut population, stiffness, Slip::Reset, &[40.0 / stiffness.min(1.0)]);
        let Regime::Persistent { period, .. } = run.regime else { panic!("{}", run.regime) };
        let expected = Rectangular { min, max }.stick_slip_period(stiffness).unwrap();
        // The error of the force over the stiffness.
        near(period, expected, 1e-10 / stiffness.min(1.0));
    }
    let form = Rectangular { min: 0.7, max: 1.3 };
    // Below min/(max − min) it slips, above it slides.
    assert!(form.stick_slip_period(0.99 * form.critical_stiffness()).is_some());
    assert_eq!(form.stick_slip_period(1.01 * form.critical_stiffness()), None);
    assert_eq!(form.stick_slip_period(0.0), None);
    assert_eq!(Rectangular { min: 0.4, max: 1.6 }.stick_slip_period(0.1), None);
}

#[test]
fn overdamped_slips_are_finitely_many() {
    for (std, stiffness, expected) in [(0.05, 1.0, 15), (0.05, 0.5, 28), (0.1, 1.0, 3)] {
        let run = pull(&mut relaxed(std, 1e-10), stiffness, Slip::Overdamped, &[60.0]);
        assert!(matches!(run.regime, Regime::Transient { slips, .. } if slips == expected), "{}", run.regime);
    }
}

#[test]
fn arrested_stick_slip_persists_below_a_second_critical_stiffness() {
    // Drops of 40 slips, within a bracket of K_p/K_c.
    for (std, below, above) in [(0.05, 0.2, 0.3), (0.1, 0.3, 0.4), (0.2, 0.5, 0.55)] {
        let population = relaxed(std, 1e-10);
        let critical = critical_stiffness(&population, 5.0, &mut ()).unwrap();
        let arrested = |part: f64| pull(&mut population.clone(), part * critical, Slip::Arrest, &[100.0]);
        let (soft, stiff) = (arrested(below), arrested(above));
        let last = &soft.events[39..];
        assert!(
            last.iter().all(|event| (event.drop() / last[0].drop() - 1.0).abs() < 1e-6 && event.drop() > 0.1)
        );
        assert!(matches!(soft.regime, Regime::Persistent { .. }), "{}", soft.regime);
        assert!(matches!(stiff.regime, Regime::Transient { slips, .. } if slips < 40), "{}", stiff.regime);
    }
}

#[test]
fn energies_balance_forth_and_back() {
    let damped = Slip::Inertial { mass: 1.0, damping: 0.3 };
    // Far from any oscillation: the speed follows the force within 1e-5 of the time of the slip.
    let light = Slip::Inertial { mass: 1e-4, damping: 5.0 };
    let broad = rectangular(0.0, 0.2);
    let population = master(&gaussian(1.0, 0.05), &broad, &broad).population_with(1e-10, &mut ()).unwrap();
    for (slip, accuracy) in [
        (Slip::Reset, 1e-9),
        (Slip::Overdamped, 1e-9),
        (Slip::Arrest, 1e-9),
        (UNDAMPED, 1e-7),
        (damped, 1e-7),
        (light, 1e-7),
    ] {
        let run = pull(&mut population.clone(), 0.5, slip, &[3.0, -4.0, 4.0]);
        let signs: Vec<f64> = run.events.iter().map(|event| event.slip().signum()).collect();
        assert!(signs.contains(&1.0) && signs.contains(&-1.0), "{slip:?}");
        for event in &run.events {
            near(event.energy.imbalance(), 0.0, accuracy);
            near(event.approach.imbalance(), 0.0, accuracy);
        }
        near(run.energy.imbalance(), 0.0, accuracy);
    }
}

#[test]
fn a_hysteresis_loop_closes_and_loses_its_area() {
    // Stiffer than K_c, so that there is no slip; loops of this size settle as the contacts lose step.
    let run: StickSlip =
        pull(&mut relaxed(0.1, 1e-10), 4.0, Slip::Overdamped, &[20.0, 10.0, 20.0, 10.0, 20.0, 10.0]);
    assert!(run.events.is_empty());
    let turns: Vec<_> = run.trace.iter().filter(|p| p.drive == 10.0).map(|p| p.force).collect();
    let last = turns[turns.len() - 2..].to_vec();
    assert!(last.iter().all(|force| *force < -0.4), "{turns:?}");
    near(last[0], last[1], 1e-2);
    near(run.energy.imbalance(), 0.0, 1e-9);
    near(run.energy.slip, 0.0, 0.0);
}

/// Contacts of one threshold that turn back break after 1.8, twice their mean life of 0.9, all together.
#[test]
fn a_straight_way_back_may_be_as_long_as_lives() {
    let re_formed = point(0.1);
    let mut population = master(&point(1.0), &re_formed, &re_formed).population_with(1e-10, &mut ()).unwrap();
    let run = pull(&mut population, 0.3, Slip::Overdamped, &[9.0, -5.0, 8.0]);
    for event in &run.events {
        // All break at 1 and re-form at 0.1; sliding on, F rises by 1 and the spring falls by K per length.
        near(event.before.force.abs(), 1.0, 1e-12);
        near(event.slip().abs(), 0.9 / 1.3, 1e-12);
        near(event.energy.imbalance(), 0.0, 1e-12);
    }
}

/// A slider that turns back meets every break, wherever the solution had ended before it was continued.
/// Where all contacts slip from one side of X = 0 to relaxed ones at X = X_T = 0, nothing there has a size by which to
/// recognise rounding.
#[test]
fn a_slip_may_end_at_the_origin() {
    let run = pull(&mut relaxed(0.01, 1e-9), 0.3, Slip::Arrest, &[9.0, -5.0, 8.0]);
    let ends = run.events.iter().map(|event| event.after.position.abs()).filter(|x| *x < 1e-9);
    assert_eq!((run.events.len(), ends.count()), (7, 2));
    near(run.energy.imbalance(), 0.0, 1e-8);
}

#[test]
fn no_break_is_passed_over() {
    let unstretched = point(0.0);
    let mut population =
        master(&point(1.0), &unstretched, &unstretched).population_with(1e-10, &mut ()).unwrap();
    let run = pull(&mut population, 2.0, Slip::Overdamped, &[9.0, -5.0, 8.0]);
    let (forth, rest) = run.events.split_at(8);
    let (back, again) = rest.split_at(12);
    assert_eq!(again.len(), 11);
    for leg in [forth, back, again] {
        // One threshold after the other.
        for pair in leg.windows(2) {
            near((pair[1].before.position - pair[0].before.position).abs(), 1.0, 1e-12);
        }
    }
    for event in &run.events {
        near(event.energy.imbalance(), 0.0, 1e-12);
        near(event.approach.imbalance(), 0.0, 1e-12);
    }
}
