//! A fit as it is run and written: the fitted scenario, what is told of readings, and a search that does not end.

use std::path::Path;

use asperity::contacts::Initial;
use asperity::master::MasterEquation;
use asperity::scenario::Scenario;
use asperity_runner::output::{self, Outcome};
use asperity_runner::{input, run};

/// Runs the shipped fit to a curve with overrides.
fn fitted(overrides: &[&str]) -> Outcome {
    shipped("fit.toml", overrides)
}

fn shipped(name: &str, overrides: &[&str]) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
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

#[test]
fn the_numbers_that_made_the_shipped_record_are_found_and_its_fitted_scenario_has_them() {
    let outcome = shipped("fit-steady.toml", &[]);
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged && !found.misfit.unwrap().is_unlikely());
    assert_eq!(found.readings, 4500);
    let truth = [
        ("contacts.thresholds.gaussian.mean", 1.0),
        ("contacts.thresholds.gaussian.std", 0.12),
        ("contacts.count", 2000.0),
        ("contacts.stiffness", 1.0),
        ("fit.reading", 1.0),
    ];
    for (number, (key, value)) in found.numbers.iter().zip(truth) {
        assert_eq!(number.key, key);
        assert!((number.value - value).abs() < 3.0 * number.error, "{number:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    let read = input::read(&folder.path().join("fit/fitted.toml"), &[]).expect("it runs as it is");
    let computed = run(&read.scenario, &mut ()).unwrap();
    let noise = computed.summary.numbers.noise().unwrap();
    assert_eq!(noise.size.to_bits(), found.numbers[2].value.to_bits());
    // The mean of the record is the only datum of the kinetic friction.
    let friction = found.friction.kinetic_friction;
    assert!((noise.kinetic_friction / friction.value.0 - 1.0).abs() < 1e-9);
    // Far from the ends of the range of wave numbers, where neither leakage nor aliasing counts, the expected periodogram is the
    // spectrum and the error of a reading. A tenth: the rest of both at the third peak.
    let (q, expected) = (
        outcome.record.values("fit_wave_number").unwrap(),
        outcome.record.values("fit_expected_periodogram").unwrap(),
    );
    let equation = MasterEquation::new(read.scenario.build().unwrap().contacts, &Initial::default()).unwrap();
    let steady = equation.steady_state();
    let floor = found.reading.powi(2) * 0.05;
    for k in (100..700).step_by(50) {
        let exact = steady.spectrum(&[q[k]], noise.size).unwrap()[0] + floor;
        assert!((expected[k] / exact - 1.0).abs() < 0.1, "{k}: {} {exact}", expected[k]);
    }
}

#[test]
fn a_record_may_have_positions_and_be_part_of_the_scenario() {
    let outcome = shipped("fit-steady.toml", &[]);
    let scenario = toml::from_str::<Scenario>(&outcome.scenario).unwrap();
    let forces = scenario.fit.unwrap().steady.unwrap().force.unwrap();
    let rows: String =
        forces.iter().enumerate().map(|(i, force)| format!("{},{force}\n", 60.0 + 0.05 * i as f64)).collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("record.csv"), format!("position,force\n{rows}")).unwrap();
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/fit-steady.toml"));
    let text = text.unwrap().replace("measured-noise.csv", "record.csv").replace("spacing = 0.05", "");
    let path = folder.path().join("fit.toml");
    std::fs::write(&path, text).unwrap();
    let again = run(&input::read(&path, &[]).expect("the scenario is valid").scenario, &mut ()).unwrap();
    let values = |outcome: &Outcome| -> Vec<f64> {
        outcome.summary.numbers.fit().unwrap().numbers.iter().map(|number| number.value).collect()
    };
    for (a, b) in values(&outcome).iter().zip(values(&again)) {
        // The spacing of positions is that of the first and the last, but for rounding.
        assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    }
}
