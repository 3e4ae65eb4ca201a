//! `[renormalisation]`: what it measures is what it should, and what it compares it with.

use std::ops::ControlFlow;
use std::path::Path;

use asperity::Error;
use asperity::law::{Gaussian, Law};
use asperity::monitor::Monitor;
use asperity::scenario::Scenario;
use asperity_runner::output::{self, Outcome};
use asperity_runner::summary::Renormalisation;
use asperity_runner::{input, task};

fn scenario(share: f64) -> Scenario {
    let text = format!(
        "contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
renormalisation = {{ runs = 4, points = 40 }}
[interface]
cells = [60, 60]
contacts = 'one'
connection = {}
coupling.neighbours.stiffness = {share}
edges = 'periodic'
",
        1.0 - 4.0 * share
    );
    input::parse(&text, "test", Path::new(""), &[]).expect("the scenario makes sense").scenario
}

fn run(share: f64) -> Outcome {
    task::run(&scenario(share), &mut ()).unwrap()
}

fn found(outcome: &Outcome) -> Renormalisation {
    outcome.summary.renormalisation.expect("what was measured")
}

/// 4 standard errors of 4 · 3600 free contacts; Kolmogorov's distance at a false-alarm rate of 1e-6.
#[test]
fn uncoupled_contacts_break_at_their_thresholds() {
    let outcome = run(0.0);
    let found = found(&outcome);
    let law = found.mean_field.expect("a law where nothing is coupled");
    assert!(
        (found.mean.value - 1.0).abs() < 4.0 * 0.1 / 120.0
            && (found.std.value - 0.1).abs() < 4.0 * 0.071 / 120.0
    );
    assert!((law.mean - 1.0).abs() < 1e-12 && (law.std - 0.1).abs() < 1e-12);
    assert!(
        found.thresholds.distance < 2.69 / 120.0 && (law.distance - found.thresholds.distance).abs() < 1e-12
    );
    let column = |name: &str| outcome.record.values(name).unwrap();
    let (drive, free) = (column("drive"), column("free_density"));
    let gaussian = Gaussian::new(1.0, 0.1).unwrap();
    // Means over intervals of a fifth of σ.
    assert!(drive.iter().zip(free).all(|(x, p)| (p - gaussian.density(*x)).abs() < 0.01));
    let off = free.iter().zip(column("measured_density")).zip(column("measured_error"));
    let far = off.filter(|((p, q), error)| (*p - *q).abs() > 4.0 * **error).count();
    // Errors of four runs scatter, too: of Student's law with 3 degrees of freedom 2.8 % lie beyond.
    assert!(drive.len() == 40 && far < 6, "{far}");
}

#[test]
fn coupled_contacts_break_before_their_thresholds_and_more_alike() {
    let found = found(&run(0.05));
    let law = found.mean_field.expect("a coupling below the critical one");
    assert!((found.coupling - 0.2).abs() < 1e-15 && (found.critical_coupling - 0.2494).abs() < 5e-5);
    assert!(law.mean < found.mean.value && found.mean.value < found.thresholds.mean);
    assert!(law.std < found.std.value && found.std.value < found.thresholds.std);
    assert!(law.distance < found.thresholds.distance);
}

#[test]
fn from_the_critical_coupling_on_there_is_no_mean_field() {
    let outcome = run(0.07);
    assert!(found(&outcome).mean_field.is_none() && outcome.record.get("mean_field_density").is_none());
}

#[test]
fn the_table_has_its_columns() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().join("out");
    let outcome = run(0.02);
    output::write(&at, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(at.join("thresholds.csv")).unwrap();
    let header = "drive,free_density,measured_density,measured_error,mean_field_density";
    assert_eq!((table.lines().next(), table.lines().count()), (Some(header), 41));
    assert_eq!(output::read(&at).unwrap().summary, outcome.summary);
}

#[test]
fn it_can_be_stopped() {
    struct Stop;
    impl Monitor for Stop {
        fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
            if fraction > 0.4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    assert_eq!(task::run(&scenario(0.05), &mut Stop).unwrap_err(), Error::Stopped);
}
