//! Drives computed: regimes, slips and files of a slider behind its block.

use std::path::Path;

use asperity::task::summary::{Friction, Sliding, SlidingKind};
use asperity_runner::output::Outcome;
use asperity_runner::{input, output};

fn run(contacts: &str, rest: &str) -> Outcome {
    let text = format!("contacts.thresholds.gaussian = {contacts}\n{rest}");
    let input = input::parse(&text, "test", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    asperity_runner::run(&input.scenario, &mut ()).unwrap()
}

fn sliding(outcome: &Outcome) -> &Sliding {
    outcome.summary.numbers.sliding().expect("a drive says how it slid")
}

fn friction(outcome: &Outcome) -> &Friction {
    outcome.summary.numbers.friction().expect("a drive says what friction is")
}

/// Digits given in the literature of the values: half a unit of the last one.
fn near(found: f64, expected: f64, digits: f64) {
    assert!((found - expected).abs() <= digits, "{found} for {expected}");
}

const BROAD: &str = "{ mean = 1.0, std = 0.1 }";
const NARROW: &str = "{ mean = 1.0, std = 0.05 }";

#[test]
fn resets_go_on_for_ever() {
    let outcome = run(BROAD, "block = { stiffness = 1.0 }\ndrive = { distance = 12.0 }");
    let sliding = sliding(&outcome);
    assert_eq!(sliding.regime, SlidingKind::Persistent);
    // X_1 + F_1/K and F_1 of the reference values, located to 1e-9.
    near(sliding.period.unwrap(), 1.666198355430, 1e-8);
    near(sliding.mean_drop.unwrap(), 0.7736105511280, 1e-8);
    let first = sliding.first_instability.unwrap();
    near(first.position, 0.8925878043021, 1e-9);
    near(first.drive, first.position + first.force, 1e-12);
    near(friction(&outcome).kinetic_friction, 0.505, 1e-9);
}

#[test]
fn overdamped_slips_are_counted_and_end() {
    let rest = "block = { stiffness = 1.0, slip = 'overdamped' }\ndrive = { distance = 40.0 }";
    let outcome = run(NARROW, rest);
    assert_eq!((sliding(&outcome).regime, sliding(&outcome).slips), (SlidingKind::Transient, 15));
    assert!(sliding(&outcome).period.is_none());
}

#[test]
fn a_trace_has_a_point_before_and_after_every_slip_and_the_spring_carries_the_force() {
    let outcome = run(BROAD, "block = { stiffness = 0.5 }\ndrive = { distance = 9.0, points = 11 }");
    let column = |name: &str| outcome.record.values(name).unwrap();
    let (drive, force, spring) = (column("drive"), column("force"), column("spring_force"));
    for (k, &at) in column("event_drive").iter().enumerate() {
        let rows: Vec<usize> = (0..drive.len()).filter(|&row| drive[row] == at).collect();
        assert!(rows.len() >= 2, "slip {k}");
        let (before, after) = (rows[0], rows[rows.len() - 1]);
        near(force[before] - force[after], column("event_drop")[k], 1e-12);
    }
    // In balance, to the accuracy of the force.
    force.iter().zip(spring).for_each(|(f, s)| near(*f, *s, 1e-9));
    near(*drive.last().unwrap(), 9.0, 1e-12);
}

/// A displacement counts from the equilibrium with stretched contacts: X_T = F/K at X = 0.
#[test]
fn a_displacement_counts_from_the_equilibrium_with_stretched_contacts() {
    let stretched = "initial.rectangular = { min = 0.2, max = 0.4 }\nensemble = { size = 1000 }";
    let block = "block = { stiffness = 0.5, slip = 'overdamped' }\ndrive = { distance = 0.4, points = 5 }";
    let outcome = run(BROAD, &format!("{stretched}\n{block}"));
    // Hardly anything breaks: F = 0.3 + X = 0.5 (X_T - X).
    let force = |drive: f64| 0.3 + (0.5 * drive - 0.3) / 1.5;
    let [drives, forces] = ["drive", "force"].map(|name| outcome.record.values(name).unwrap());
    let [first, last] = [drives[0], *drives.last().unwrap()];
    near(first, 0.6, 1e-9);
    near(last, 1.0, 1e-9);
    // One in a million contacts holds less than 0.53, the largest stretch.
    drives.iter().zip(forces).for_each(|(drive, found)| near(*found, force(*drive), 1e-6));
    // The simulated contacts have a mean stretch of their own, 0.0018 from 0.3 in the mean.
    let drives = outcome.record.values("ensemble_drive").unwrap();
    near(drives[0], 0.6, 0.02);
    near(drives.last().unwrap() - drives[0], 0.4, 1e-12);
}

#[test]
fn the_ensemble_slips_as_the_master_equation_does() {
    let rest = "block = { stiffness = 1.0, slip = 'overdamped' }\ndrive = { distance = 8.0 }\n\
                ensemble = { size = 100000, seed = 5 }";
    let outcome = run(BROAD, rest);
    let master = sliding(&outcome);
    let ensemble = master.ensemble.as_deref().unwrap();
    // A fourth dip of F is nearly steep enough, and for some draws of contacts is.
    assert!(master.slips == 3 && (3..=4).contains(&ensemble.slips), "{}", ensemble.slips);
    // The force at the first slip scatters as N^(−1/3), here 0.02 x̄⟨k⟩, and by a factor of order 1.
    near(ensemble.first_instability.unwrap().force, master.first_instability.unwrap().force, 0.02);
    // Single breaks are by far the most frequent events, and every contact broke many times.
    let (size, events) =
        (outcome.record.values("size").unwrap(), outcome.record.values("size_events").unwrap());
    assert_eq!(size[..2], [1.0, 2.0]);
    assert!(events[0] > 0.5 * events.iter().sum::<f64>());
}

#[test]
fn an_imposed_force_runs_away_at_static_friction() {
    let outcome = run(BROAD, "drive = { force_to = 1.0 }");
    let runaway = sliding(&outcome).runaway.unwrap();
    // The default tolerance of 1e-10, and a digit for the slope at the maximum.
    near(runaway.force, 0.7964360150770, 1e-9);
    // The place of a maximum is known to the root of the accuracy of its value.
    near(runaway.position, 0.8441642907576, 1e-6);
    assert_eq!(sliding(&outcome).regime, SlidingKind::Runaway);
}

#[test]
fn a_rigid_slider_goes_forth_and_back_on_a_closed_loop() {
    let rest = "drive = { turning_points = [4.0, -4.0, 4.0, -4.0], points = 2801 }";
    let outcome = run("{ mean = 1.0, std = 0.2 }", rest);
    let (drive, force) = (outcome.record.values("drive").unwrap(), outcome.record.values("force").unwrap());
    let top = drive.iter().rposition(|&x| x == 4.0).unwrap();
    let bottom = drive[..top].iter().rposition(|&x| x == -4.0).unwrap();
    let (forth, back) = (bottom..top, top..drive.len());
    let mirrored = drive[forth.clone()].iter().zip(&force[forth]).map(|(x, f)| (-x, -f));
    // The start is forgotten over 8 = 6 X*: e^{−6} of 0.2 is left, of which the difference is less.
    for ((x, f), (y, g)) in mirrored.zip(drive[back.clone()].iter().zip(&force[back])) {
        near(x, *y, 1e-9);
        near(f, *g, 1e-3);
    }
}

#[test]
fn inertial_slips_leave_their_time_course() {
    let rest = "block = { stiffness = 1.0, slip.inertial = { mass = 2.0 } }\ndrive = { distance = 2.0 }";
    let outcome = run(BROAD, rest);
    let column = |name: &str| outcome.record.values(name).unwrap();
    // Equal areas.
    near(column("event_position_turn")[0], 1.599378752724, 1e-7);
    assert!(column("event_position_after")[0] < column("event_position_turn")[0]);
    let (time, velocity) = (column("slip_time"), column("slip_velocity"));
    assert!(time.is_sorted() && time.len() == velocity.len());
    near(*velocity.last().unwrap(), 0.0, 1e-6);
}

#[test]
fn a_drive_that_never_slips_is_an_outcome() {
    let outcome = run(BROAD, "block = { stiffness = 4.0, slip = 'arrest' }\ndrive = {}");
    assert_eq!((sliding(&outcome).regime, sliding(&outcome).slips), (SlidingKind::Smooth, 0));
    assert!(sliding(&outcome).first_instability.is_none());
}

#[test]
fn what_is_written_is_read_back() {
    let rest = "block = { stiffness = 1.0 }\ndrive = { distance = 4.0 }\nensemble = { size = 1000 }";
    let outcome = run(BROAD, rest);
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("drive");
    output::write(&place, &outcome, &[]).unwrap();
    assert_eq!(output::read(&place).unwrap(), outcome);
    let events = std::fs::read_to_string(place.join("events.csv")).unwrap();
    let header = "event,drive,position_before,position_after,position_turn,force_before,force_after,drop,slip,\
                  broken_fraction,dissipated_breaks,dissipated_slip";
    assert_eq!(events.lines().next(), Some(header));
    assert_eq!(events.lines().count(), 1 + outcome.summary.numbers.sliding().unwrap().slips);
    let trace = std::fs::read_to_string(place.join("trace.csv")).unwrap();
    assert!(trace.starts_with("drive,position,force,spring_force\n"), "{}", &trace[..80]);
}

#[test]
fn a_map_of_stick_slip_has_the_fractions_of_the_simulations() {
    let rest = "block = { stiffness = 1.0, slip = 'arrest', slip_fraction = 0.3 }
        stability = { stiffnesses = [0.5, 1.0, 20.0], resolution = 0.2, simulations = 4 }
        ensemble = { size = 100 }";
    let outcome = run(BROAD, rest);
    let column = |name: &str| outcome.record.values(name).unwrap();
    let found = outcome.summary.numbers.stick_slip()[0].ensemble.as_ref().unwrap();
    assert_eq!((found.simulations, outcome.summary.sample), (4, Some(100.0)));
    // The second stiffness is that of the block.
    assert_eq!(column("ensemble_persistent")[1], found.persistent as f64 / 4.0);
    assert_eq!(column("ensemble_transient")[1], found.transient as f64 / 4.0);
    // Persistent far below the end at 1.04, none far above K_c = 3.009.
    assert_eq!((column("ensemble_persistent")[0], column("ensemble_none")[2]), (1.0, 1.0));
    assert!(column("ensemble_drop")[2].is_nan());
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("map");
    output::write(&place, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(place.join("stability.csv")).unwrap();
    let header = "stiffness,stick_slip,ensemble_none,ensemble_transient,ensemble_persistent,ensemble_drop,\
                  ensemble_drop_std";
    assert_eq!(table.lines().next(), Some(header));
}
