//! A scenario computed: its numbers are those of the theory, both models agree, and it can be stopped.

use std::ops::ControlFlow;
use std::path::Path;

use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::task::summary::{Extended, Friction, StaticFriction};
use asperity::{Error, scenario::Scenario};
use asperity_runner::input;
use asperity_runner::output::Outcome;

const FIGURE_2: &str = "
title = 'Fig. 2'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.05 }
initial.gaussian = { mean = 0.1, std = 0.025 }
pull = { distance = 20.0, points = 2001, snapshots = [0.0, 1.09, 20.0] }
";

fn scenario(text: &str) -> Scenario {
    input::parse(text, "test", Path::new(""), &[]).expect("the scenario is valid").scenario
}

fn run(text: &str) -> Outcome {
    asperity_runner::run(&scenario(text), &mut ()).unwrap()
}

fn friction(outcome: &Outcome) -> &Friction {
    outcome.summary.numbers.friction().expect("a pull says what friction is")
}

/// Largest difference of two columns in units of `scale`.
fn farthest(a: &[f64], b: &[f64], scale: &[f64]) -> f64 {
    assert_eq!((a.len(), b.len()), (scale.len(), scale.len()));
    let differences = a.iter().zip(b).zip(scale).map(|((a, b), s)| (a - b).abs() / s);
    differences.fold(0.0, f64::max)
}

/// ∫ of row `row` of a density along the stretches, by the trapezoidal rule.
fn mass(record: &Record, row: usize) -> f64 {
    let stretch = record.values("stretch").unwrap();
    let density = record.row("stretch_density", row).unwrap();
    let pairs = stretch.windows(2).zip(density.windows(2));
    pairs.map(|(x, q)| 0.5 * (x[1] - x[0]) * (q[0] + q[1])).sum()
}

fn near(value: f64, reference: f64, tolerance: f64) {
    assert!((value - reference).abs() < tolerance, "{value} is not {reference}");
}

#[test]
fn the_numbers_of_figure_2_are_those_of_the_theory() {
    let outcome = run(FIGURE_2);
    let StaticFriction::Reached { force, position } = friction(&outcome).static_friction else {
        panic!("static friction was not reached")
    };
    // The default tolerance is 1e-10 of F; positions of a flat maximum have the root of it, a critical stiffness that of a slope.
    near(force, 0.868_081_709_809, 1e-9);
    near(position, 0.791_756_131_650, 1e-7);
    near(friction(&outcome).kinetic_friction, 0.50125, 1e-12);
    near(friction(&outcome).relaxation_length.0, 20.270_485_418_3, 1e-8);
    near(friction(&outcome).relaxation_length_paper.0, 20.0, 1e-9);
    near(friction(&outcome).critical_stiffness.0, 6.143_821_037, 1e-6);
    let force = outcome.record.values("force").unwrap();
    for (index, reference) in [(109, 0.190_395_432_031), (500, 0.297_307_166), (2000, 0.432_329_275)] {
        near(force[index], reference, 1e-9);
    }
}

#[test]
fn positions_count_both_ends_and_contacts_are_all_there() {
    let outcome = run(FIGURE_2);
    let position = outcome.record.values("position").unwrap();
    assert_eq!((position.len(), position[0], position[2000]), (2001, 0.0, 20.0));
    for row in 0..3 {
        // The trapezoidal rule on the points of the density.
        near(mass(&outcome.record, row), 1.0, 1e-3);
    }
    assert_eq!(outcome.record.get("force_std"), None);
    assert_eq!(outcome.summary.sample, None);
}

#[test]
fn the_resolved_scenario_computes_the_same() {
    let outcome = run(FIGURE_2);
    assert_eq!(run(&outcome.scenario), outcome);
}

#[test]
fn both_models_agree() {
    let outcome = run(&format!("{FIGURE_2}\nensemble = {{ size = 20000, seed = 3 }}\n"));
    let column = |name| outcome.record.values(name).unwrap();
    // fails by chance less than once in a million: 6 standard deviations, about 100 independent positions
    assert!(farthest(column("ensemble_force"), column("force"), column("force_std")) < 6.0);
    let errors = column("ensemble_error").iter().zip(column("force_std"));
    assert!(errors.clone().all(|(a, b)| (a / b - 1.0).abs() < 0.1));
    assert_eq!((outcome.summary.sample, outcome.summary.seed), (Some(20_000.0), Some(3)));
    let bins = outcome.record.length("bin").unwrap();
    assert_eq!(column("ensemble_stretch_density").len(), 3 * bins);
    assert_eq!(outcome.record.get("steady_ensemble_density"), None, "20 thresholds are too short to settle");
}

#[test]
fn a_long_pull_shows_the_ensemble_in_steady_sliding() {
    let outcome = run("
        contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }
        pull = { distance = 200.0, points = 11 }
        ensemble = { size = 20000, seed = 1 }
    ");
    let column = |name| outcome.record.values(name).unwrap();
    assert!(farthest(column("averaged_position"), &[190.0, 200.0], &[1e-5; 2]) < 1.0);
    let (bin, density) = (column("bin"), column("steady_ensemble_density"));
    // Q_s(0) = 1/x̄; each bin holds some 20000 w contacts at each of about 10 independent times
    let flat: Vec<f64> = bin.iter().zip(density).filter(|(x, _)| **x < 0.3).map(|(_, q)| *q).collect();
    assert!(flat.len() > 5 && flat.iter().all(|q| (q - 1.0).abs() < 0.05), "{flat:?}");
    near(density.iter().sum::<f64>() * (bin[1] - bin[0]), 1.0, 1e-9);
}

#[test]
fn identical_contacts_break_together() {
    let outcome = run("
        contacts.thresholds.point = { at = 1.0 }
        pull = { distance = 2.5, points = 6, snapshots = [0.0, 0.5, 2.5] }
    ");
    let column = |name| outcome.record.values(name).unwrap();
    assert!(farthest(column("breaking_atom_position"), &[1.0, 2.0], &[1e-12; 2]) < 1.0);
    assert!(farthest(column("breaking_atom_weight"), &[1.0, 1.0], &[1e-12; 2]) < 1.0);
    assert_eq!(column("stretch_atom_position"), [0.0, 0.5, 2.5]);
    assert!(farthest(column("stretch_atom_stretch"), &[0.0, 0.5, 0.5], &[1e-12; 3]) < 1.0);
    assert!(farthest(column("force"), &[0.0, 0.5, 0.0, 0.5, 0.0, 0.5], &[1e-12; 6]) < 1.0);
    assert_eq!(friction(&outcome).critical_stiffness, Extended(f64::INFINITY));
    assert_eq!(friction(&outcome).relaxation_length, Extended(f64::INFINITY));
}

#[test]
fn a_force_that_still_rises_has_no_static_friction() {
    let outcome = run("
        contacts.thresholds.exponential = { mean = 1.0 }
        contacts.normal_load = 4.0
        pull = { distance = 5.0, points = 3 }
    ");
    assert_eq!(friction(&outcome).static_friction, StaticFriction::NotReached);
    let coefficients = outcome.summary.numbers.friction().unwrap().friction_coefficients.unwrap();
    assert_eq!((coefficients.at_rest, coefficients.normal_load), (None, 4.0));
    // The default tolerance is 1e-10.
    near(coefficients.kinetic, 0.25, 1e-9);
}

#[test]
fn a_compared_curve_is_kept_and_measured() {
    let outcome = run("
        contacts.thresholds.exponential = { mean = 1.0 }
        contacts.count = 100.0
        pull = { distance = 1.0, points = 3 }
        compare = { position = [0.0, 0.5, 3.0], force = [3.0, 39.346934028736655, 7.0] }
    ");
    let compare = outcome.summary.numbers.compare().unwrap();
    assert_eq!(compare.points, 2);
    // The measured forces are those of the closed form to 1e-10, and lengths are rounded.
    near(compare.residual_rms.unwrap(), 3.0 / 2f64.sqrt(), 1e-6);
    assert_eq!(outcome.record.values("compared_position").unwrap(), [0.0, 0.5, 3.0]);
    assert_eq!(outcome.summary.sample, Some(100.0), "the band is that of the contacts themselves");
}

#[test]
fn results_beyond_the_memory_are_refused_before_any_work() {
    let mut scenario = scenario(FIGURE_2);
    scenario.pull.as_mut().unwrap().points = 400_000_000;
    let error = asperity_runner::run(&scenario, &mut Patience { left: 0, last: 0.0 }).unwrap_err();
    assert!(matches!(error, Error::TooLarge { needed: 19_200_000_000.., .. }), "{error}");
    assert!(error.to_string().starts_with("pull.points: "), "{error}");
}

/// Counts what it hears, and stops the work when it has heard enough.
struct Patience {
    left: usize,
    last: f64,
}

impl Monitor for Patience {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        assert!((self.last..=1.0 + 1e-12).contains(&fraction), "{fraction} after {}", self.last);
        self.last = fraction;
        if self.left == 0 {
            return ControlFlow::Break(());
        }
        self.left -= 1;
        ControlFlow::Continue(())
    }
}

#[test]
fn progress_never_falls_and_reaches_the_end() {
    let mut patience = Patience { left: usize::MAX, last: 0.0 };
    let scenario = scenario(&format!("{FIGURE_2}\nensemble = {{ size = 1000 }}\n"));
    asperity_runner::run(&scenario, &mut patience).unwrap();
    // Each part of a part of the work ends a billionth short.
    near(patience.last, 1.0, 1e-8);
    let heard = usize::MAX - patience.left;
    for left in [0, 1, heard / 2, heard - 1] {
        let stopped = asperity_runner::run(&scenario, &mut Patience { left, last: 0.0 });
        assert_eq!(stopped.unwrap_err(), Error::Stopped);
    }
}

/// The scatter of one contact is not known.
#[test]
fn one_contact_has_no_standard_error() {
    let text =
        "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\npull = {}\nensemble = { size = 1 }\n";
    let scenario = input::parse(text, "test", Path::new(""), &[]).unwrap().scenario;
    let record = asperity_runner::run(&scenario, &mut ()).unwrap().record;
    assert!(record.get("ensemble_force").is_some() && record.get("ensemble_error").is_none());
}

/// The covariance that a pull stores: symmetric, its diagonal the variance of the finite-size band, N times smaller
/// for N contacts; a reference value for one contact (1e-10 of the default aim).
#[test]
fn a_pull_stores_the_covariance_of_the_force() {
    let outcome = run("contacts = { count = 1000.0, thresholds.gaussian = { mean = 1.0, std = 0.1 } }\n\
        pull = { distance = 3.0, points = 31, covariance = [0.9, 1.0, 2.18] }");
    let values = outcome.record.values("covariance").unwrap();
    assert_eq!(values.len(), 9);
    near(values[1] / 1000.0, 0.052_402_383_426_301_9, 1e-9);
    near(values[5] / 1000.0, 0.011_373_566_364_583_7, 1e-9);
    assert!(values[1] == values[3] && values[2] == values[6] && values[5] == values[7]);
    let std = outcome.record.values("force_std").unwrap()[9];
    near(values[0] / (std * std), 1.0, 1e-10);
    assert_eq!(outcome.record.values("covariance_other").unwrap(), [0.9, 1.0, 2.18]);
}

/// One position, at the start of the pull, where contacts that all start at 0 have a certain force; and none.
#[test]
fn a_covariance_of_one_position_or_none_is_stored_or_absent() {
    let contacts = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n";
    let record = |positions: &str| {
        run(&format!("{contacts}pull = {{ distance = 3.0, points = 31, covariance = [{positions}] }}")).record
    };
    // Rounding of terms of order 1.
    near(record("0.0").values("covariance").unwrap()[0], 0.0, 1e-14);
    let both = record("0.0, 1.0");
    let values = both.values("covariance").unwrap();
    assert!(values[..3].iter().all(|value| value.abs() < 1e-14) && values[3] > 0.0, "{values:?}");
    assert!(record("").values("covariance").is_none());
}

/// Positions beyond the pull or out of order, and contacts without such a covariance, are refused at their key.
#[test]
fn covariances_that_do_not_exist_are_refused() {
    let refused = |text: &str| match input::parse(text, "test", Path::new(""), &[]) {
        Ok(read) => asperity_runner::run(&read.scenario, &mut ()).map(drop).unwrap_err().to_string(),
        Err(error) => error.to_string(),
    };
    let contacts = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n";
    let beyond = refused(&format!("{contacts}pull = {{ distance = 3.0, covariance = [1.0, 4.0] }}"));
    assert!(beyond.contains("pull.covariance.1") && beyond.contains("distance 3"), "{beyond}");
    let repeated = refused(&format!("{contacts}pull = {{ distance = 3.0, covariance = [1.0, 1.0] }}"));
    assert!(repeated.contains("pull.covariance.1") && repeated.contains("above 1"), "{repeated}");
    let order = refused(&format!("{contacts}pull = {{ distance = 3.0, covariance = [1.0, 0.5] }}"));
    assert!(order.contains("pull.covariance.1") && order.contains("above 1"), "{order}");
    let delay = "contacts.delay.time = 0.5\n";
    let free =
        refused(&format!("{contacts}{delay}pull = {{ distance = 3.0, covariance = [1.0], velocity = 1.0 }}"));
    assert!(free.contains("contacts.delay"), "{free}");
}

/// Derivatives of friction by every parameter: those of F_k = N(1 + σ²)/2 in closed form, and F_s is proportional to
/// the number of contacts. None unless they are asked for.
#[test]
fn a_pull_gives_the_derivatives_of_friction() {
    let contacts = "contacts = { count = 1000.0, thresholds.gaussian = { mean = 1.0, std = 0.1 } }\n";
    let outcome = run(&format!("{contacts}pull = {{ distance = 3.0, points = 31, derivatives = true }}"));
    let numbers = &outcome.summary.numbers;
    let names: Vec<&str> = numbers.derivatives().iter().map(|by| by.parameter.as_str()).collect();
    assert_eq!(names, ["thresholds.mean", "thresholds.std", "count", "stiffness"]);
    for (by, expected) in numbers.derivatives().iter().zip([495.0, 100.0, 0.505, 505.0]) {
        near(by.kinetic_friction / expected, 1.0, 1e-9);
    }
    let StaticFriction::Reached { force, .. } = numbers.friction().unwrap().static_friction else { panic!() };
    near(numbers.derivatives()[2].static_friction.unwrap() * 1000.0 / force, 1.0, 1e-12);
    let without = run(&format!("{contacts}pull = {{ distance = 3.0, points = 31 }}"));
    assert!(without.summary.numbers.derivatives().is_empty());
}

/// The noise of steady sliding: S(0) and the standard deviation in closed form, the stiffness of one contact from the
/// tail, and the periodogram of an ensemble about the exact spectrum: its mean deviation in standard errors.
#[test]
fn a_spectrum_agrees_with_the_periodogram_of_the_ensemble() {
    let outcome = run("contacts = { count = 1000.0, thresholds.gaussian = { mean = 1.0, std = 0.1 } }\n\
        spectrum = { highest = 20.0, points = 2001 }\nensemble = { size = 500, seed = 2 }");
    let noise = outcome.summary.numbers.noise().unwrap();
    let scale = 1000.0_f64.powi(2) / 500.0;
    near(noise.at_zero / scale, 0.002_500_25, 1e-12);
    near(noise.tail, 2.0, 1e-9);
    near(noise.force_std.powi(2) / scale, 1.03 / 3.0 - 0.505_f64.powi(2), 1e-10);
    let [q, spectrum] = ["wave_number", "spectrum"].map(|name| outcome.record.values(name).unwrap());
    let [at, found, error] = ["ensemble_wave_number", "ensemble_spectrum", "ensemble_spectrum_error"]
        .map(|name| outcome.record.values(name).unwrap());
    let exact = |x: f64| {
        let place = x / q[1];
        let (i, part) = (place as usize, place.fract());
        spectrum[i] * (1.0 - part) + spectrum.get(i + 1).unwrap_or(&spectrum[i]) * part
    };
    // Between the peaks, where the spectrum hardly varies over a wave number of a segment.
    let smooth = |x: &f64| (1.0..5.0).contains(x) || (7.5..11.0).contains(x);
    let z = at.iter().zip(found).zip(error).filter(|((x, _), _)| smooth(x));
    let z: Vec<f64> = z.map(|((&x, found), error)| (found - exact(x)) / (error * exact(x) / found)).collect();
    let mean = z.iter().sum::<f64>() / z.len() as f64;
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
    // 97 numbers, of which two neighbours are correlated by the window: the mean has a standard error of about 0.13.
    assert!(z.len() > 90 && mean.abs() < 0.4 && (0.8..1.25).contains(&rms), "{mean} {rms} {}", z.len());
}
