//! `[renormalisation]`: what it measures is what it should, and what it compares it with.

use std::ops::ControlFlow;
use std::path::Path;

use asperity::Error;
use asperity::law::{Gaussian, Law};
use asperity::monitor::Monitor;
use asperity::scenario::Scenario;
use asperity::task::summary::{FirstBreakStatistics, InterfaceSize};
use asperity_runner::input;
use asperity_runner::output::{self, Outcome};

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
    input::parse(&text, "test", Path::new(""), &[]).expect("the scenario is valid").scenario
}

fn run(share: f64) -> Outcome {
    asperity_runner::run(&scenario(share), &mut ()).unwrap()
}

fn found(outcome: &Outcome) -> FirstBreakStatistics {
    *outcome.summary.numbers.renormalisation().expect("what was measured")
}

/// Cells of many contacts, whose scales scatter.
fn cells(connection: f64, springs: f64, scatter: f64) -> Outcome {
    let text = format!(
        "contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.05 }}
renormalisation = {{ runs = 4, points = 40 }}
[interface]
cells = [300]
connection = {connection}
coupling.neighbours.stiffness = {springs}
disorder.std = {scatter}
drive_tolerance = 1e-4
"
    );
    let scenario = input::parse(&text, "test", Path::new(""), &[]).expect("the scenario is valid").scenario;
    asperity_runner::run(&scenario, &mut ()).unwrap()
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
    assert_eq!(found.size, InterfaceSize::Contacts(3600));
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
fn cells_that_are_alike_have_the_law_of_mean_field() {
    let found = found(&cells(9.0, 0.3, 0.0));
    let law = found.mean_field.expect("a coupling below the critical one");
    assert_eq!((found.size, found.coupling), (InterfaceSize::Cells(300), 0.1));
    // The force is known to 1e-10, and what it makes of positions is 1/(1 − κ/κ_c) = 5 times as much.
    assert!(law.distance < 1e-8, "{law:?}");
    // What is not waited for: 1e-6 of the contacts, 5 σ off.
    assert!((law.mean - found.mean.value).abs() < 1e-6 && (law.std - found.std.value).abs() < 1e-4);
    assert!(found.mean.error < 1e-12 && found.std.error < 1e-12);
}

/// Stiff springs make one slider of cells that scatter; soft ones do not, least where a cell alone is unstable.
#[test]
fn cells_that_differ_have_the_law_of_mean_field_where_they_are_stiff() {
    let (stiff, soft) = (found(&cells(4.5, 1e5, 0.1)), found(&cells(4.5, 0.01, 0.1)));
    let law = stiff.mean_field.expect("a coupling below the critical one");
    // 4 standard errors of mean and deviation of 1200 scales; of the narrower law the latter changes twice as much.
    let errors = [4.0 * 0.1 / 1200.0_f64.sqrt(), 4.0 * 2.0 * 0.1 / 2400.0_f64.sqrt()];
    assert!((stiff.mean.value - law.mean).abs() < errors[0] && (stiff.std.value - law.std).abs() < errors[1]);
    assert!(soft.std.value > law.std + errors[1] && soft.mean_field.unwrap().distance > 4.0 * law.distance);
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
    assert_eq!(asperity_runner::run(&scenario(0.05), &mut Stop).unwrap_err(), Error::Stopped);
}
