//! Measured kinetic friction against velocity and static friction against hold time, beside the computed curves.

use std::path::Path;

use asperity::contacts::Initial;
use asperity::master::MasterEquation;
use asperity_runner::input;
use asperity_runner::output::Outcome;

const GROWING: &str = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }\n\
                       contacts.ageing.logarithmic = { growth = 0.02, time = 1.0 }\n";

fn run(text: &str) -> Outcome {
    let parsed = input::parse(text, "test", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    asperity_runner::run(&parsed.scenario, &mut ()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The root mean square of 0.01, −0.01 and 0.02.
const RMS: f64 = 0.014_142_135_623_730_95;

/// These forces, off by 0.01, −0.01 and 0.02.
fn off([first, middle, last]: [f64; 3]) -> String {
    format!("[{}, {}, {}]", first + 0.01, middle - 0.01, last + 0.02)
}

/// Measured less computed forces: what `off` added.
fn residuals_are_those_of_off(outcome: &Outcome, tolerance: f64) -> bool {
    let residuals = outcome.record.values("compared_residual").unwrap();
    residuals.len() == 3
        && residuals.iter().zip([0.01, -0.01, 0.02]).all(|(r, off)| (r - off).abs() <= tolerance)
}

#[test]
fn kinetic_friction_is_compared_at_the_measured_velocities() {
    let velocities = [2.0, 0.03, 0.4];
    let contacts = input::parse(&format!("{GROWING}pull.velocity = 1.0\n"), "test", Path::new(""), &[]);
    let contacts = contacts.unwrap().scenario.build().unwrap().contacts;
    let friction = |velocity| {
        let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
        equation.steady_state().kinetic_friction()
    };
    let curve = "velocity_curve = { from = 0.1, to = 1.0, points = 3 }\n";
    let alone = run(&format!("{GROWING}{curve}"));
    let forces = off(velocities.map(friction));
    let outcome =
        run(&format!("{GROWING}{curve}compare = {{ velocity = {velocities:?}, force = {forces} }}\n"));
    let compare = *outcome.summary.numbers.compare().unwrap();
    // Two solutions of the renewal equation, each to 1e-10.
    assert!(compare.points == 3 && (compare.residual_rms.unwrap() - RMS).abs() < 1e-9, "{compare:?}");
    assert_eq!(outcome.record.values("compared_velocity").unwrap(), velocities);
    assert!(residuals_are_those_of_off(&outcome, 1e-9), "{:?}", outcome.record.values("compared_residual"));
    assert_eq!(outcome.record.values("kinetic_friction"), alone.record.values("kinetic_friction"));
    // The background force is part of both.
    let raised = run(&format!(
        "{GROWING}contacts.background_force = 0.5\n{curve}compare = {{ velocity = {velocities:?}, force = {forces} }}\n"
    ));
    let raised = raised.summary.numbers.compare().unwrap().residual_rms.unwrap();
    let expected = ((0.49_f64.powi(2) + 0.51_f64.powi(2) + 0.48_f64.powi(2)) / 3.0).sqrt();
    assert!((raised - expected).abs() < 1e-9, "{raised} {expected}");
}

#[test]
fn static_friction_is_compared_at_the_measured_hold_times() {
    let curve = |from: f64, to: f64, points: usize| {
        format!("hold_curve = {{ from = {from:e}, to = {to:e}, points = {points}, velocity = 0.1 }}\n")
    };
    // The same times as those of another curve, in another order and between those of this one.
    let other = run(&format!("{GROWING}{}", curve(3.0, 300.0, 3)));
    let [short, middle, long] = other.record.values("static_friction").unwrap() else {
        panic!("three holds")
    };
    let alone = run(&format!("{GROWING}{}", curve(1.0, 1e3, 4)));
    let holds = [300.0, 3.0, 30.0];
    let compare = format!("compare = {{ hold = {holds:?}, force = {} }}\n", off([*long, *short, *middle]));
    let outcome = run(&format!("{GROWING}{}{compare}", curve(1.0, 1e3, 4)));
    let found = *outcome.summary.numbers.compare().unwrap();
    let error = |outcome: &Outcome| outcome.summary.accuracy.unwrap();
    // Each of the peaks has the error that is estimated.
    let off = (found.residual_rms.unwrap() - RMS).abs();
    assert!(found.points == 3 && off <= error(&outcome) + error(&other), "{found:?}");
    assert_eq!(outcome.record.values("compared_hold").unwrap(), holds);
    assert!(residuals_are_those_of_off(&outcome, error(&outcome) + error(&other)));
    let peaks = |outcome: &Outcome| outcome.record.values("static_friction").unwrap().to_vec();
    let pairs = peaks(&outcome).into_iter().zip(peaks(&alone));
    let apart = pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    assert!(peaks(&outcome).len() == 4 && apart <= error(&outcome) + error(&alone), "{apart:e}");
}

fn refused(text: &str) -> String {
    input::parse(text, "test", Path::new(""), &[]).unwrap_err().to_string()
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let velocities = "velocity_curve = { from = 0.1, to = 1.0, points = 2 }\n";
    let holds = "hold_curve = { from = 1.0, to = 10.0, points = 2, velocity = 0.1 }\n";
    for (task, compare, words) in [
        (
            velocities,
            "position = [1.0], force = [1.0]",
            "compare.position: expected velocity with [velocity_curve]",
        ),
        (holds, "velocity = [1.0], force = [1.0]", "compare.velocity: expected hold with [hold_curve]"),
        (
            "pull.velocity = 1.0\n",
            "hold = [1.0], force = [1.0]",
            "compare.hold: expected position with [pull]",
        ),
        (holds, "hold = [1.0, 2.0], force = [1.0]", "compare.force: expected 2 forces, one for each hold"),
        (holds, "hold = [1.0, 0.0], force = [1.0, 1.0]", "compare.hold.1: expected a number above 0, got 0"),
        (
            velocities,
            "velocity = [-1.0], force = [1.0]",
            "compare.velocity.0: expected a number above 0, got -1",
        ),
        (
            holds,
            "hold = [1.0], force = [1.0], stiffness = 1.0",
            "compare.stiffness: expected none but with [[protocol]]",
        ),
        (holds, "hold = [1.0], force = [1.0], law = 'slip'", "compare.law: expected none without"),
        (holds, "force = [1.0]", "compare.hold: expected at least one point"),
        (
            "spectrum.velocity = 1.0\n",
            "position = [1.0], force = [1.0]",
            "compare: expected a compared curve only",
        ),
    ] {
        let error = refused(&format!("{GROWING}{task}compare = {{ {compare} }}\n"));
        assert!(error.starts_with(words), "{error}");
    }
    let temperatures = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }\n\
                        contacts.temperature = { energy = 0.05, attempt_rate = 1.0 }\n\
                        velocity_curve = { from = 0.1, to = 1.0, points = 2, temperatures = [0.05, 0.1] }\n\
                        compare = { velocity = [1.0], force = [1.0] }\n";
    let error = refused(temperatures);
    assert!(
        error.starts_with("compare: expected no compared curve beside velocity_curve.temperatures"),
        "{error}"
    );
}
