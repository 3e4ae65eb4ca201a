//! A fit as it is run and written: the fitted scenario, what is told of readings, and a search that does not end.

use std::path::Path;

use asperity::master::MasterEquation;
use asperity_runner::output::{self, Outcome};
use asperity_runner::{input, run};

/// Runs a shipped scenario with overrides.
fn fitted(overrides: &[&str]) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/fit.toml");
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let input = input::read(&path, &overrides).expect("the scenario is valid");
    run(&input.scenario, &mut ()).unwrap()
}

#[test]
fn the_fitted_scenario_has_the_curve_of_the_fit_to_the_last_bit() {
    let outcome = fitted(&[]);
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    let read = input::read(&folder.path().join("fit/fitted.toml"), &[]).expect("it runs as it is");
    let model = read.scenario.build().unwrap();
    let distance = read.scenario.pull.as_ref().unwrap().distance;
    let pull = MasterEquation::new(model.contacts, &model.initial).unwrap().pull(distance).unwrap();
    let (positions, expected) =
        (outcome.record.values("reading_position"), outcome.record.values("expected_force"));
    for (&x, &force) in positions.unwrap().iter().zip(expected.unwrap()) {
        assert_eq!(pull.force(x).to_bits(), force.to_bits(), "X = {x}");
    }
    let compared = run(&read.scenario, &mut ()).unwrap();
    assert_eq!(compared.summary.numbers.compare().unwrap().points, positions.unwrap().len());
}

#[test]
fn the_numbers_that_made_the_shipped_curve_are_found() {
    let outcome = fitted(&[]);
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged && !found.misfit.unwrap().is_unlikely());
    let truth = [
        ("contacts.thresholds.gaussian.mean", 1.0),
        ("contacts.thresholds.gaussian.std", 0.12),
        ("contacts.count", 2000.0),
        ("contacts.stiffness", 1.0),
        ("fit.reading", 2.0),
    ];
    assert_eq!(found.numbers.len(), truth.len());
    for (number, (key, value)) in found.numbers.iter().zip(truth) {
        assert_eq!(number.key, key);
        assert!((number.value - value).abs() < 3.0 * number.error, "{number:?}");
    }
    // N and k are hardly known apart: the noise alone tells the one from the other.
    assert_eq!(found.correlations.len(), 1);
    assert!(found.correlations[0].coefficient < -0.99);
}

#[test]
fn white_noise_of_the_same_readings_is_told_to_be_none() {
    let keys = "fit.free=['contacts.thresholds.gaussian.mean', 'contacts.thresholds.gaussian.std', 'contacts.count']";
    let white = fitted(&["fit.noise='white'", keys, "contacts.stiffness=1.0"]);
    let found = white.summary.numbers.fit().unwrap();
    assert!(found.misfit.unwrap().is_unlikely());
}

#[test]
fn readings_are_cut_and_averaged() {
    let outcome = fitted(&["fit.range=[0.0, 3.0]", "fit.average=2"]);
    // 75 readings up to 3.0; the last group has one.
    assert_eq!(outcome.record.values("reading_position").unwrap().len(), 38);
    assert_eq!(outcome.summary.numbers.fit().unwrap().readings, 38);
}
