//! A fit as it is run and written: the fitted scenario, what is reported of readings, and a search that does not end.

use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use asperity::contacts::{Contacts, Initial};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;
use asperity::scenario::Scenario;
use asperity_runner::output::{self, Outcome};
use asperity_runner::{input, run};

/// The shipped fit to a curve as it is, and the one to a record in steady sliding: each is run once for all tests.
static OF_CURVE: LazyLock<Outcome> = LazyLock::new(|| fitted(&[]));
static OF_RECORD: LazyLock<Outcome> = LazyLock::new(|| shipped("fit-steady.toml", &[]));

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
    let outcome = &*OF_CURVE;
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), outcome, &[]).unwrap();
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
    let outcome = &*OF_CURVE;
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
    let fixed: Vec<(&str, f64)> =
        found.fixed.iter().map(|number| (number.key.as_str(), number.value)).collect();
    assert_eq!(fixed, [("contacts.reforming.gaussian.mean", 0.1), ("contacts.reforming.gaussian.std", 0.03)]);
    // N and k are hardly known apart: only the noise distinguishes the one from the other.
    assert_eq!(found.correlations.len(), 1);
    assert!(found.correlations[0].coefficient < -0.99);
}

#[test]
fn white_noise_of_the_same_readings_is_reported_to_be_none() {
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
fn other_distributions_of_thresholds_are_compared() {
    let outcome = fitted(&["fit.laws=['gaussian', 'exponential', 'rectangular']"]);
    let laws = outcome.summary.numbers.fit().unwrap().laws.clone().unwrap();
    // The scenario's own distribution made the curve; the same one from another start is the same fit.
    assert_eq!(laws.difference.min(laws.others[0].difference.unwrap()), 0.0);
    assert!(laws.difference < 1e-3 && laws.others[0].difference.unwrap() < 1e-3, "{laws:?}");
    assert_eq!(laws.others[1].numbers[0].key, "contacts.thresholds.exponential.mean");
    // 10 counts as decisive (Burnham and Anderson, 2002).
    assert!(laws.others[1].difference.unwrap() > 10.0, "{laws:?}");
    assert_eq!(laws.others[2].law, "rectangular");
}

#[test]
fn another_distribution_frees_what_the_fit_frees() {
    let free = "fit.free=['contacts.thresholds.gaussian.mean', 'contacts.stiffness']";
    let set = "contacts.thresholds.gaussian={ mean = 0.9, std = 0.12 }";
    let outcome = fitted(&[free, set, "contacts.count=2000.0", "fit.laws=['gamma', 'rectangular']"]);
    let laws = outcome.summary.numbers.fit().unwrap().laws.clone().unwrap();
    let keys: Vec<&str> = laws.others[0].numbers.iter().map(|number| number.key.as_str()).collect();
    assert_eq!(keys[..2], ["contacts.thresholds.gamma.mean", "contacts.stiffness"]);
    assert!(!keys.contains(&"contacts.thresholds.gamma.std"), "{keys:?}");
    // A rectangular distribution has no mean among its numbers.
    assert!(laws.others[1].refused.as_ref().unwrap().contains("thresholds.min, thresholds.max"), "{laws:?}");
}

#[test]
fn the_file_of_the_curve_is_stated_with_its_hash() {
    let outcome = &*OF_CURVE;
    let sources = &outcome.summary.numbers.fit().unwrap().sources;
    assert_eq!(sources.len(), 1);
    assert_eq!(sources[0].name, "measured-pull.csv");
    // By `sha256sum scenarios/measured-pull.csv`.
    assert_eq!(sources[0].sha256, "20a6908872c2ee4a37c906c6c8c29570f0e91ee9e85101b67df4e3658ad4b5d9");
}

/// The shipped fit with another text in the place of the name of its file, and the rows of a curve as `moved.csv`.
fn instead_of_the_file(text: &str, rows: &str, overrides: &[&str]) -> Outcome {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let shipped = fs::read_to_string(scenarios.join("fit.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit.toml");
    fs::write(folder.path().join("moved.csv"), format!("position,force\n{rows}")).unwrap();
    fs::write(&path, shipped.replace("file = \"measured-pull.csv\"", text)).unwrap();
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    run(&input::read(&path, &overrides).expect("the scenario is valid").scenario, &mut ()).unwrap()
}

#[test]
fn zeros_of_force_and_position_are_those_of_the_machine() {
    let first = &*OF_CURVE;
    let of = |name: &str| first.record.values(name).unwrap();
    let readings = of("reading_position").iter().zip(of("measured_force"));
    // Each position is read 0.5 too large, and each force 30 and twice the position.
    let rows: String =
        readings.map(|(x, force)| format!("{},{}\n", x + 0.5, force + 31.0 + 2.0 * x)).collect();
    let machine = ["fit.offset=30.0", "fit.trend=2.0", "fit.origin=0.5"];
    let moved = instead_of_the_file("file = \"moved.csv\"", &rows, &machine);
    let (found, expected) = (moved.summary.numbers.fit().unwrap(), first.summary.numbers.fit().unwrap());
    for (number, expected) in found.numbers.iter().zip(&expected.numbers) {
        // Two searches end within a thousandth of an error of the same place.
        assert!((number.value - expected.value).abs() < 3e-3 * expected.error, "{number:?} {expected:?}");
    }
    let fixed: Vec<f64> =
        found.fixed.iter().filter(|number| number.key.starts_with("fit.")).map(|n| n.value).collect();
    assert_eq!(fixed, [30.0, 2.0, 0.5]);
}

#[test]
fn errors_a_drift_and_priors_are_taken_from_the_scenario() {
    let prior = "fit.prior={ 'contacts.stiffness' = { value = 1.0, error = 0.01 } }";
    let outcome = fitted(&["fit.reading=2.0", "fit.drift={ longest = 0.3 }", prior]);
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged);
    let keys: Vec<&str> = found.numbers[4..].iter().map(|number| number.key.as_str()).collect();
    assert_eq!((keys.as_slice(), found.reading), (&["fit.drift.amplitude", "fit.drift.length"][..], 2.0));
    // The curve alone knows the stiffness to 16 %: hardly anything is added to a prior of 1 %.
    let stiffness = &found.numbers[3];
    assert!(
        (stiffness.value - 1.0).abs() < 0.01 && (0.0095..0.0101).contains(&stiffness.error),
        "{stiffness:?}"
    );
}

/// What the summary and the table tell of errors of the positions.
#[test]
fn errors_of_positions_are_taken_from_the_scenario() {
    let numbers = "'contacts.thresholds.gaussian.mean', 'contacts.thresholds.gaussian.std', 'contacts.count'";
    let free = format!("fit.free=[{numbers}]");
    let white = ["fit.noise='white'", free.as_str()];
    let of = |error: Option<&str>| fitted(&[white.as_slice(), error.as_slice()].concat());
    let [exact, read] = [None, Some("fit.position_error=0.01")].map(of);
    let spread = |outcome: &Outcome| {
        let std = outcome.record.values("reading_std").unwrap();
        std.iter().fold(0.0, |most: f64, one| most.max(*one))
            / std.iter().fold(f64::MAX, |least, one| least.min(*one))
    };
    // All readings have one error, or those on the slopes a larger one.
    assert_eq!(spread(&exact), 1.0);
    assert!(spread(&read) > 1.1, "{}", spread(&read));
    assert!(read.summary.numbers.fit().unwrap().converged);
}

#[test]
fn a_measurement_without_forces_has_about_the_errors_of_the_one_that_was_made() {
    let made = &*OF_CURVE;
    let positions = made.record.values("reading_position").unwrap();
    let truth = [
        "contacts.thresholds.gaussian={ mean = 1.0, std = 0.12 }",
        "contacts.count=2000.0",
        "contacts.stiffness=1.0",
        "fit.reading=2.0",
    ];
    let planned = instead_of_the_file(&format!("position = {positions:?}"), "", &truth);
    let (planned, made) = (planned.summary.numbers.fit().unwrap(), made.summary.numbers.fit().unwrap());
    assert!(planned.misfit.is_none() && planned.sources.is_empty());
    for (planned, made) in planned.numbers.iter().zip(&made.numbers).take(2) {
        // Errors go with the square root of the number of contacts, which the curve determines to 16 %.
        assert!((0.7..1.4).contains(&(planned.error / made.error)), "{planned:?} {made:?}");
    }
}

#[test]
fn thresholds_of_free_form_are_reported_and_written() {
    let outcome = fitted(&["fit.thresholds='free_form'"]);
    let form = outcome.summary.numbers.fit().unwrap().free_form.unwrap();
    assert!(form.converged);
    // The thresholds that made the curve; one curve in 16 000 is farther off.
    assert!((form.mean.value.0 - 1.0).abs() < 4.0 * form.mean.error.0, "{form:?}");
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    let table = fs::read_to_string(folder.path().join("fit/thresholds.csv")).unwrap();
    let heading = "free_form_threshold,free_form_density,free_form_density_low,free_form_density_high,free_form_cumulative,free_form_cumulative_error";
    assert_eq!(table.lines().next(), Some(heading));
    let readings = fs::read_to_string(folder.path().join("fit/fit.csv")).unwrap();
    let heading = "reading_position,measured_force,expected_force,reading_std,whitened_residual";
    assert_eq!(readings.lines().next(), Some(heading));
}

/// Two curves of the same contacts, read with different zeros of the force, against the drive of a machine.
const CURVES: &str = r#"
[contacts]
count = 1.0e3
thresholds.gaussian = { mean = 0.95, std = 0.33 }

[fit]
noise = "white"
compliance = "free"
free = [
    "contacts.thresholds.gaussian.mean",
    "contacts.thresholds.gaussian.std",
    "contacts.count",
    "fit.curve.1.offset",
]
[[fit.curve]]
file = "first.csv"
[[fit.curve]]
file = "second.csv"
"#;

#[test]
fn several_curves_are_fitted_together_and_each_has_its_fitted_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let thresholds = Arc::new(Gaussian::new(1.0, 0.3).unwrap());
    let reformed = Arc::new(Point::new(0.0).unwrap());
    let contacts = Contacts { count: 1200.0, ..Contacts::new(thresholds, reformed) };
    let pull = MasterEquation::new(contacts, &Initial::default()).unwrap().pull(5.0).unwrap();
    // Below the critical stiffness of these contacts the slider does not slip.
    let compliance = 1.5e-4;
    for (name, count, offset) in [("first.csv", 80, 0.0), ("second.csv", 60, 25.0)] {
        let rows = (1..=count).map(|i| {
            let x = 5.0 * f64::from(i) / f64::from(count);
            let force = pull.force(x);
            format!("{:?},{:?}\n", x + compliance * force, force + offset)
        });
        fs::write(path(name), format!("drive,force\n{}", rows.collect::<String>())).unwrap();
    }
    fs::write(path("curves.toml"), CURVES).unwrap();
    let input = input::read(&path("curves.toml"), &[]).expect("the scenario is valid");
    let outcome = run(&input.scenario, &mut ()).unwrap();
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged);
    let truth = [
        ("contacts.thresholds.gaussian.mean", 1.0),
        ("contacts.thresholds.gaussian.std", 0.3),
        ("contacts.count", 1200.0),
        ("fit.curve.1.offset", 25.0),
        ("fit.compliance", compliance),
    ];
    for (number, (key, value)) in found.numbers.iter().zip(truth) {
        assert_eq!(number.key, key);
        // The curves have no noise; errors of the solution and of its derivatives remain.
        assert!((number.value / value - 1.0).abs() < 1e-6, "{number:?}");
    }
    output::write(&path("fit"), &outcome, &[]).unwrap();
    for (name, points) in [("fitted-0.toml", 80), ("fitted-1.toml", 60)] {
        let read = input::read(&path("fit").join(name), &[]).expect("it runs as it is");
        let compared = run(&read.scenario, &mut ()).unwrap();
        let compared = *compared.summary.numbers.compare().unwrap();
        assert_eq!(compared.points, points);
        // Of forces of a thousand; the fit is exact to 1e-6 of it.
        assert!(compared.residual_rms.unwrap() < 1e-3, "{compared:?}");
    }
}

/// Cycles of stick-slip of a block over single contacts, whose slips form all contacts anew: what made the record is known, also
/// where the slider rested after each slip.
#[test]
fn loadings_of_cycles_are_fitted_together_with_the_position_at_which_each_begins() {
    let outcome = shipped("fit-cycles.toml", &[]);
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged && !found.misfit.unwrap().is_unlikely());
    let truth = [
        ("contacts.thresholds.gaussian.mean", 1.0),
        ("contacts.thresholds.gaussian.std", 0.12),
        ("contacts.count", 2000.0),
        ("contacts.stiffness", 1.0),
        ("fit.curve.0.origin", 0.0),
        ("fit.curve.1.origin", 1.244_098),
        ("fit.curve.2.origin", 2.483_994),
        ("fit.curve.3.origin", 3.728_547),
        ("fit.reading", 2.0),
    ];
    assert_eq!(found.numbers.len(), truth.len());
    for (number, (key, value)) in found.numbers.iter().zip(truth) {
        assert_eq!(number.key, key);
        // One in a hundred such sets of nine numbers has one that is farther off.
        assert!((number.value - value).abs() < 3.5 * number.error, "{number:?}");
    }
    let fixed: Vec<&str> = found.fixed.iter().map(|number| number.key.as_str()).collect();
    let held = ["contacts.reforming", "initial"]
        .map(|of| ["mean", "std"].map(|name| format!("{of}.gaussian.{name}")));
    assert_eq!(fixed, [held.concat(), vec!["fit.compliance".to_owned()]].concat());
    // One cycle alone knows less: of four, errors of common numbers are half as large.
    let alone = shipped(
        "fit-cycles.toml",
        &[
            "fit.curve=[{ file = 'measured-cycles.csv', range = [0.0, 1.27] }]",
            "fit.free=['contacts.thresholds.gaussian.mean', 'contacts.thresholds.gaussian.std', 'contacts.count', 'fit.curve.0.origin']",
            "contacts.stiffness=1.0",
        ],
    );
    let alone = alone.summary.numbers.fit().unwrap();
    // Between a half and what the noise of other contacts, which has another estimated size, changes of it.
    let ratio = found.numbers[0].error / alone.numbers[0].error;
    assert!((0.3..0.8).contains(&ratio), "{ratio}");
}

#[test]
fn the_numbers_that_made_the_shipped_record_are_found_and_its_fitted_scenario_has_them() {
    let outcome = &*OF_RECORD;
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged && !found.misfit.unwrap().is_unlikely());
    assert_eq!(found.readings, 4500);
    // By `sha256sum scenarios/measured-noise.csv`.
    let hash = "3d3740aa7b6bf868f363a1fb6c689e7087f9469688676ee52b1b949963aa0072";
    assert!(found.sources.iter().map(|source| source.sha256.as_str()).eq([hash]));
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
    output::write(&folder.path().join("fit"), outcome, &[]).unwrap();
    let read = input::read(&folder.path().join("fit/fitted.toml"), &[]).expect("it runs as it is");
    let computed = run(&read.scenario, &mut ()).unwrap();
    let noise = computed.summary.numbers.noise().unwrap();
    assert_eq!(noise.size.to_bits(), found.numbers[2].value.to_bits());
    // The mean of the record is the only datum of the kinetic friction.
    let friction = found.friction.unwrap().kinetic_friction;
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
    let outcome = &*OF_RECORD;
    let scenario = toml::from_str::<Scenario>(&outcome.scenario).unwrap();
    let forces = scenario.fit.unwrap().steady.unwrap().force.unwrap();
    let rows: String =
        forces.iter().enumerate().map(|(i, force)| format!("{},{force}\n", 60.0 + 0.05 * i as f64)).collect();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("record.csv"), format!("position,force\n{rows}")).unwrap();
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/fit-steady.toml"));
    let text = text.unwrap().replace("measured-noise.csv", "record.csv").replace("spacing = 0.05", "");
    let path = folder.path().join("fit.toml");
    fs::write(&path, text).unwrap();
    let again = run(&input::read(&path, &[]).expect("the scenario is valid").scenario, &mut ()).unwrap();
    let values = |outcome: &Outcome| -> Vec<f64> {
        outcome.summary.numbers.fit().unwrap().numbers.iter().map(|number| number.value).collect()
    };
    for (a, b) in values(outcome).iter().zip(values(&again)) {
        // The spacing of positions is that of the first and the last, but for rounding.
        assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn draws_from_the_posterior_are_reported_and_written() {
    let posterior = "fit.posterior={ draws = 12, chains = 2, seed = 3 }";
    // Readings up to the second breaks; without the noise of contacts, whose covariance takes most of the time.
    let free = "fit.free=['contacts.thresholds.gaussian.mean', 'contacts.thresholds.gaussian.std', 'contacts.count']";
    let short = "fit.range=[0.0, 2.0]";
    let outcome = fitted(&[posterior, "fit.noise='white'", free, "contacts.stiffness=1.0", short]);
    let found = outcome.summary.numbers.fit().unwrap();
    let reported = found.posterior.as_ref().unwrap();
    assert_eq!((reported.chains, reported.draws, outcome.summary.seed), (2, 12, Some(3)));
    let keys = |numbers: Vec<&String>| numbers.into_iter().cloned().collect::<Vec<String>>();
    assert_eq!(
        keys(reported.numbers.iter().map(|number| &number.key).collect()),
        keys(found.numbers.iter().map(|number| &number.key).collect())
    );
    // 24 draws are not worth 400.
    assert!(
        outcome.summary.warnings.iter().any(|text| text.starts_with("fit.posterior: more draws are needed"))
    );
    let values = outcome.record.values("posterior_value").unwrap();
    let mean = values[..24].iter().sum::<f64>() / 24.0;
    assert!((mean / reported.numbers[0].mean - 1.0).abs() < 1e-14);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit");
    output::write(&path, &outcome, &[]).unwrap();
    assert_eq!(output::read(&path).unwrap(), outcome);
    let file = netcdf_reader::NcFile::open(path.join("posterior.nc")).unwrap();
    for (number, drawn) in reported.numbers.iter().zip(values.chunks_exact(24)) {
        let stored = file.read_variable::<f64>(&format!("posterior/{}", number.key)).unwrap();
        assert_eq!(
            (stored.shape(), stored.iter().copied().collect::<Vec<f64>>().as_slice()),
            (&[2, 12][..], drawn)
        );
    }
    for (name, shape) in [("posterior/chain", vec![2]), ("sample_stats/draw", vec![12])] {
        assert_eq!(file.read_variable::<i64>(name).unwrap().shape(), shape, "{name}");
    }
    let refused = input::parse(
        "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n[fit]\nfile = 'measured-pull.csv'\nfree = ['contacts.count']\nposterior.draws = 3",
        "test",
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios"),
        &[],
    );
    assert!(format!("{:?}", refused.unwrap_err()).contains("fit.posterior.draws"));
}

#[test]
fn a_record_of_steady_sliding_has_a_posterior_near_its_estimates() {
    let free = "fit.free=['contacts.count', 'contacts.stiffness']";
    let truth = "contacts.thresholds.gaussian={ mean = 1.0, std = 0.12 }";
    // An error of readings that is free is hardly determined: its posterior is far from normal.
    let sampling = "fit.posterior={ draws = 100, chains = 2, seed = 3 }";
    let outcome = shipped("fit-steady.toml", &[free, truth, "fit.reading=1.0", sampling]);
    let found = outcome.summary.numbers.fit().unwrap();
    let reported = found.posterior.as_ref().unwrap();
    assert_eq!((reported.chains, reported.draws), (2, 100));
    for (drawn, number) in reported.numbers.iter().zip(&found.numbers) {
        assert_eq!(drawn.key, number.key);
        let shift = (drawn.mean - number.value) / number.error;
        let ratio = drawn.std / number.error;
        // Four standard errors of the mean and of the standard deviation of so many draws, and what a logarithm bends over an
        // error of some per cent.
        let effective = drawn.effective_size.0;
        assert!(shift.abs() < 4.0 / effective.sqrt() + 0.1, "{drawn:?} {number:?}");
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * effective).sqrt() + 0.1, "{drawn:?} {number:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    assert!(folder.path().join("fit/posterior.nc").exists());
    // The part of the summary that is about the fit, on its own.
    let text = fs::read_to_string(folder.path().join("fit/fit.json")).unwrap();
    let alone: asperity::task::summary::FitSummary = serde_json::from_str(&text).unwrap();
    assert_eq!(&alone, found);
}

#[test]
fn forces_at_several_velocities_give_the_contacts_that_made_them() {
    let outcome = shipped("fit-velocity-curve.toml", &[]);
    let found = outcome.summary.numbers.fit().unwrap();
    assert!(found.converged && found.readings == 11 && found.friction.is_none());
    // By `sha256sum scenarios/measured-velocities.csv`.
    let hash = "a27e691c230b";
    assert_eq!(
        (found.sources[0].name.as_str(), &found.sources[0].sha256[..12]),
        ("measured-velocities.csv", hash)
    );
    assert!(!found.misfit.unwrap().is_unlikely());
    let truth = [
        ("contacts.count", 2000.0),
        ("contacts.ageing.logarithmic.growth", 0.06),
        ("contacts.ageing.logarithmic.time", 0.5),
    ];
    for (number, (key, value)) in found.numbers.iter().zip(truth) {
        assert_eq!(number.key, key);
        assert!((number.value - value).abs() < 3.0 * number.error, "{number:?}");
    }
    // The fitted scenario runs, and its residuals are those of the fit.
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    for (file, heading) in [
        (
            "fit_readings.csv",
            "reading_velocity,reading_friction,reading_expected_friction,reading_friction_std,reading_friction_residual",
        ),
        ("fit_velocity_curve.csv", "fit_velocity,fit_friction,fit_friction_error"),
    ] {
        let table = fs::read_to_string(folder.path().join("fit").join(file)).unwrap();
        assert_eq!(table.lines().next(), Some(heading));
    }
    let read = input::read(&folder.path().join("fit/fitted.toml"), &[]).expect("it runs as it is");
    let computed = run(&read.scenario, &mut ()).unwrap();
    let values = |outcome: &Outcome, name: &str| outcome.record.values(name).unwrap().to_vec();
    let [forces, expected] =
        ["reading_friction", "reading_expected_friction"].map(|name| values(&outcome, name));
    let squares: f64 = forces.iter().zip(&expected).map(|(force, fit)| (force - fit).powi(2)).sum();
    let rms = (squares / 11.0).sqrt();
    // Forces are computed at the measured velocities; the search and this curve differ by rounding of the velocities.
    let compared = computed.summary.numbers.compare().unwrap().residual_rms.unwrap();
    assert!((compared / rms - 1.0).abs() < 1e-9, "{compared} {rms}");
    // The smooth curve ends at the lowest and the highest velocity, with the forces of the fit there.
    let [velocity, friction] = ["fit_velocity", "fit_friction"].map(|name| values(&outcome, name));
    assert_eq!((velocity[0], velocity.len()), (1e-3, 33));
    assert!((velocity[32] / 100.0 - 1.0).abs() < 1e-12);
    assert!(
        (friction[0] / expected[0] - 1.0).abs() < 1e-12 && (friction[32] / expected[10] - 1.0).abs() < 1e-9
    );
}

#[test]
fn an_offset_and_a_background_of_a_velocity_curve_are_told_apart_from_the_contacts() {
    let text = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n\
                contacts.delay.time = 0.5\ncontacts.background_force = 0.2\n\
                fit.free = ['contacts.delay.time', 'contacts.background_force']\nfit.offset = -0.1\n\
                fit.velocity_curve = { velocity = [10.0, 0.1, 1.0, 1.0], force = [0.301, 0.6855769230769231, 0.5617142857142857, 0.5597142857142857] }";
    let read = input::parse(text, "test", Path::new("."), &[]).unwrap();
    let outcome = run(&read.scenario, &mut ()).unwrap();
    let found = outcome.summary.numbers.fit().unwrap();
    // F_k = ⟨x²⟩/[2(⟨x⟩ + vτ)] = 0.505/(1 + vτ) with τ = 0.4, a background of 0.3 and the offset −0.1. The two readings at v = 1 are
    // 0.001 above and below it, so that the least squares have these numbers.
    let [delay, background] = [&found.numbers[0], &found.numbers[1]];
    assert_eq!(background.key, "contacts.background_force");
    assert!((found.reading - 1e-3).abs() < 1e-8, "{}", found.reading);
    // The search ends within a thousandth of an error of some 1e-2.
    assert!((delay.value - 0.4).abs() < 1e-3 * delay.error && delay.error < 2e-2, "{delay:?}");
    assert!((background.value - 0.3).abs() < 1e-3 * background.error, "{background:?}");
    // The offset is fixed, and subtracted from the forces that the fitted scenario compares.
    assert!(found.fixed.iter().any(|number| number.key == "fit.offset" && number.value == -0.1));
    let folder = tempfile::tempdir().unwrap();
    output::write(&folder.path().join("fit"), &outcome, &[]).unwrap();
    let fitted = fs::read_to_string(folder.path().join("fit/fitted.toml")).unwrap();
    let fitted = toml::from_str::<Scenario>(&fitted).unwrap();
    assert_eq!(fitted.compare.unwrap().force.unwrap()[0], 0.401);
    assert_eq!(fitted.contacts.background_force, Some(background.value));
}
