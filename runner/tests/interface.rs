//! Drives of interfaces computed: what comes out is what the models say, and what does not fit is refused.

use std::ops::ControlFlow;
use std::path::Path;

use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::ensemble::lattice::{Avalanche, Until};
use asperity::monitor::Monitor;
use asperity::scenario::Model;
use asperity::task::summary::Catalogue;
use asperity_runner::output::Outcome;
use asperity_runner::{input, output};

fn read(text: &str) -> input::Input {
    input::parse(text, "test", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn run(text: &str) -> Outcome {
    asperity_runner::run(&read(text).scenario, &mut ()).unwrap()
}

fn catalogue(outcome: &Outcome) -> &Catalogue {
    outcome.summary.numbers.catalogue().expect("an interface has a catalogue")
}

fn column<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    outcome.record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

const LATTICE: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [9, 7], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2, catalogue_from = 1.5 }
drive = { distance = 3.0, points = 4, maps = [0.5, 3.0] }
";

/// The catalogue is that of the lattice itself, from where it is asked for; looks on the way change nothing.
#[test]
fn contacts_one_by_one_make_the_avalanches_of_the_lattice() {
    let input = read(LATTICE);
    let Model { contacts, initial, .. } = input.scenario.build().unwrap();
    let mut lattice =
        input.scenario.interface.as_ref().unwrap().lattice(contacts, initial, None, None, &mut ()).unwrap();
    let mut all: Vec<Avalanche> = Vec::new();
    lattice.run(Until::Drive(3.0), &mut |avalanche| all.push(*avalanche)).unwrap();
    let late: Vec<_> = all.iter().filter(|avalanche| avalanche.drive >= 1.5).collect();
    let outcome = asperity_runner::run(&input.scenario, &mut ()).unwrap();
    assert!(late.len() > 50 && late.len() < all.len());
    assert_eq!(column(&outcome, "event_drive"), late.iter().map(|a| a.drive).collect::<Vec<_>>());
    assert_eq!(column(&outcome, "event_size"), late.iter().map(|a| a.size as f64).collect::<Vec<_>>());
    assert_eq!(column(&outcome, "event_cells"), late.iter().map(|a| a.area as f64).collect::<Vec<_>>());
    assert_eq!(
        (column(&outcome, "map_drive"), column(&outcome, "cell_force").len()),
        (&[0.5, 3.0][..], 2 * 63)
    );
    assert_eq!(column(&outcome, "cell_force")[63..], lattice.forces());
    assert_eq!(
        (column(&outcome, "drive"), column(&outcome, "force")[3]),
        (&[0.0, 1.0, 2.0, 3.0][..], lattice.force())
    );
    let reported = catalogue(&outcome);
    assert_eq!((reported.cells, reported.events, reported.magnitude.as_str()), (63, late.len(), "size"));
    let largest = reported.largest.unwrap();
    assert_eq!(largest.magnitude, late.iter().map(|a| a.size).max().unwrap() as f64);
    assert_eq!(column(&outcome, "event_size")[largest.event - 1], largest.magnitude);
    let waiting = (late[late.len() - 1].drive - late[0].drive) / (late.len() - 1) as f64;
    assert!((reported.mean_waiting.unwrap() / waiting - 1.0).abs() < 1e-12);
    assert_eq!(outcome.summary.seed, Some(1));
}

/// One cell is a block: first slip and X_2 of the reference values (σ = 0.1, K = 1, overdamped). The drive is found to
/// 1e-10, the position near the loss of balance as its root.
#[test]
fn one_cell_is_a_block() {
    let outcome = run("
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
interface = { cells = [1], coupling.neighbours = { stiffness = 1.0 }, connection = 1.0, slip = 'overdamped', drive_tolerance = 1e-10 }
drive = { distance = 2.0, points = 21 }
");
    let first = |name: &str| column(&outcome, name)[0];
    assert!((first("event_drive") - 1.666198355430).abs() < 1e-8);
    assert!((first("event_position_before") - 0.8925878043021).abs() < 1e-4);
    assert!((first("event_position_after") - 1.332802416243).abs() < 1e-8);
    assert_eq!(catalogue(&outcome).magnitude, "moment");
    // A chain is looked at wherever the trace is.
    assert_eq!(column(&outcome, "cell_force"), column(&outcome, "force"));
    for name in ["event_time", "event_duration", "event_front_speed_left"] {
        assert!(outcome.record.get(name).is_none(), "{name} without viscosity");
    }
}

/// Every point of a drive is in balance, also where the contacts of the cells are stretched from the start.
#[test]
fn a_drive_begins_in_balance_with_stretched_contacts() {
    let outcome = run("
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
initial.rectangular = { min = 0.2, max = 0.4 }
interface = { cells = [3], coupling.neighbours = { stiffness = 1.0 }, connection = 0.5, slip = 'overdamped', catalogue_from = 0.1 }
drive = { distance = 1.2, points = 7, maps = [0.0, 1.2] }
");
    let [drive, position, force] = ["drive", "position", "force"].map(|name| column(&outcome, name));
    for ((drive, position), force) in drive.iter().zip(position).zip(force) {
        // Three springs of 0.5; equilibria are solved to 1e-10.
        assert!((1.5 * (drive - position) - force).abs() < 1e-8, "{drive} {position} {force}");
    }
    assert!((drive[0] - 0.6).abs() < 1e-9 && (drive[6] - 1.8).abs() < 1e-9, "{drive:?}");
    assert_eq!(column(&outcome, "map_drive"), drive);
}

/// Waiting times are increases of the drive from one event to the next, of which those in a hold are 0.
#[test]
fn events_in_a_hold_wait_for_no_drive() {
    let outcome = run("
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.temperature = { energy = 0.02, attempt_rate = 1.0 }
initial.rectangular = { min = 0.0, max = 0.8 }
interface = { cells = [8, 8], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
protocol = [
  { velocity = 0.1, distance = 1.0, points = 3 },
  { hold = 1e5, points = 3 },
  { velocity = 0.1, distance = 1.0, points = 3 },
]
");
    let drives = column(&outcome, "event_drive");
    let held = drives.windows(2).filter(|pair| pair[1] == pair[0]).count();
    assert!(held > 5, "{held} of {} intervals", drives.len() - 1);
    let mean = (drives[drives.len() - 1] - drives[0]) / (drives.len() - 1) as f64;
    // Rounding of some hundred terms.
    assert!((catalogue(&outcome).mean_waiting.unwrap() / mean - 1.0).abs() < 1e-12);
}

/// One cell of few contacts is a block over their ensemble, in which every break that moves it is a slip.
#[test]
fn a_cell_of_few_contacts_is_a_block_over_them() {
    let input = read("
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
interface = { cells = [1], coupling.neighbours = { stiffness = 1.0 }, connection = 0.5, slip = 'overdamped', drive_tolerance = 1e-12 }
ensemble = { size = 20, seed = 4, disorder = 'quenched' }
drive = { distance = 8.0, points = 2 }
");
    let Model { contacts, initial, .. } = input.scenario.build().unwrap();
    let ensemble = input.scenario.ensemble.as_ref().unwrap().build(contacts, initial).unwrap();
    let block = Block::new(Loading::Spring(0.5), Slip::Overdamped, None).unwrap();
    let drive = Drive { turning_points: vec![8.0], points: 2 };
    let slips = block.pull(&mut ensemble.population().unwrap(), &drive).unwrap();
    let outcome = asperity_runner::run(&input.scenario, &mut ()).unwrap();
    let drives = column(&outcome, "event_drive");
    assert!(drives.len() > 20 && drives.len() == slips.events.len());
    for (drive, slip) in drives.iter().zip(&slips.events) {
        // Both add the same positions in another order: rounding of drives of order 10.
        assert!((drive - slip.before.drive).abs() < 1e-10);
    }
    assert_eq!(outcome.summary.seed, Some(4));
}

/// Scales drawn differ, those of a list are taken; events of a chain state which cells slipped.
#[test]
fn cells_differ_as_they_are_asked_to() {
    let chain = |more: &str| {
        run(&format!(
            "contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
[interface]
cells = [4]
coupling.neighbours = {{ stiffness = 1.0 }}
connection = 1.0
{more}
[drive]
distance = 3.0
points = 4
"
        ))
    };
    let [even, listed, drawn] =
        ["", "disorder.scale = [1.0, 1.0, 0.5, 1.0]", "disorder = { std = 0.1, seed = 5 }"].map(chain);
    assert_eq!((column(&even, "event_cells")[0], even.summary.seed), (4.0, None));
    assert_eq!((column(&listed, "event_epicentre")[0], listed.summary.seed), (2.0, None));
    assert_eq!(column(&listed, "slipped_cell")[0], 2.0);
    assert_eq!(drawn.summary.seed, Some(5));
    assert!(column(&drawn, "event_drive")[0] < column(&even, "event_drive")[0]);
}

#[test]
fn nothing_happens_on_a_short_way_and_is_written_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(&LATTICE.replace("3.0", "0.1").replace("0.5, 0.1", "0.05").replace("0.5 }", "0.1 }"));
    assert_eq!(catalogue(&outcome).events, 0);
    let results = folder.path().join("results");
    output::write(&results, &outcome, &[]).unwrap();
    let events = std::fs::read_to_string(results.join("events.csv")).unwrap();
    assert!(events.starts_with("event,drive,force_before,") && events.lines().count() == 1, "{events}");
    assert_eq!(output::read(&results).unwrap(), outcome);
}

#[test]
fn maps_that_do_not_fit_in_memory_are_refused_before_any_work() {
    /// Enough for the cells, which take 0.7 GB.
    struct Gigabyte;
    impl Monitor for Gigabyte {
        fn progress(&mut self, _: f64) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
        fn memory(&self) -> u64 {
            1_000_000_000
        }
    }

    let maps: Vec<_> = (1..=40).map(|i| format!("{i}.0")).collect();
    let text = LATTICE
        .replace("[9, 7]", "[2000, 2000]")
        .replace("[0.5, 3.0]", &format!("[{}]", maps.join(", ")))
        .replace("distance = 3.0", "distance = 40.0");
    let error = asperity_runner::run(&read(&text).scenario, &mut Gigabyte).unwrap_err();
    let Error::TooLarge { key, needed, allowed, .. } = error else { panic!("{error}") };
    // Eight bytes for each of the four million cells of 40 maps.
    assert_eq!((key.as_str(), allowed), ("drive.maps", 1_000_000_000));
    assert!(needed >= 1_280_000_000, "{needed}");
}

const AGED: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }
contacts.ageing.logarithmic = { growth = 0.02, time = 1.0 }
master_equation.tolerance = 1e-4
";

/// One cell whose contacts are time-dependent is the block in time, up to the accuracy of a step of both.
#[test]
fn one_cell_in_time_is_a_block_in_time() {
    let cell = run(&format!(
        "{AGED}
interface = {{ cells = [1], coupling.neighbours = {{ stiffness = 1.0 }}, connection = 0.2, slip = 'overdamped', viscosity = 0.1 }}
drive = {{ distance = 12.0, velocity = 1e-2, points = 25 }}
"
    ));
    let block = run(&format!(
        "{AGED}
block = {{ stiffness = 0.2, slip.damped = {{ damping = 0.1 }} }}
drive = {{ distance = 12.0, velocity = 1e-2, points = 25 }}
"
    ));
    assert!(column(&block, "event_drive").len() > 1);
    for name in ["drive", "position_before", "position_after", "drop", "slip", "dissipated_breaks"] {
        let [cell, block] = [&cell, &block].map(|outcome| column(outcome, &format!("event_{name}")));
        assert_eq!(cell.len(), block.len(), "{name}");
        for (cell, block) in cell.iter().zip(block) {
            // Each solution has the tolerance 1e-4.
            assert!((cell - block).abs() < 2e-4, "{name}: {cell} {block}");
        }
    }
    let (drives, times) = (column(&cell, "drive"), column(&cell, "time"));
    assert!(
        // Drives of some hundred steps are added, and so are times.
        drives.iter().zip(times).all(|(drive, time)| (time - 100.0 * drive).abs() < 1e-9 * time.max(1.0))
    );
    assert_eq!(column(&cell, "map_drive"), drives);
    assert_eq!(column(&cell, "cell_velocity"), column(&cell, "velocity"));
    assert_eq!(column(&cell, "slipped_event").len(), column(&cell, "event_drive").len());
}

/// A cell has all lengths times its scale and the temperature of all: that of contacts with such thresholds.
#[test]
fn a_scaled_cell_is_as_warm_as_the_others() {
    let friction = |mean: f64, scale: f64| {
        run(&format!(
            "
contacts.thresholds.gaussian = {{ mean = {mean}, std = {} }}
contacts.temperature = {{ energy = 0.05, attempt_rate = 1.0, barrier = 'elastic' }}
interface = {{ cells = [1], coupling.neighbours = {{ stiffness = 1.0 }}, connection = 1.0, slip = 'overdamped', viscosity = 0.1, disorder.scale = [{scale}] }}
drive = {{ distance = 2.0, velocity = 1e-2, points = 11 }}
master_equation.tolerance = 1e-4
",
            0.1 * mean
        ))
    };
    let (scaled, plain, other) = (friction(1.0, 1.25), friction(1.25, 1.0), friction(1.0, 1.0));
    let (scaled, plain, other) = (column(&scaled, "force"), column(&plain, "force"), column(&other, "force"));
    for (scaled, plain) in scaled.iter().zip(plain) {
        // The tolerance of both solutions.
        assert!((scaled - plain).abs() < 1e-4, "{scaled} {plain}");
    }
    assert!((plain[10] - 1.25 * other[10]).abs() > 1e-2);
}

/// The scale factors of cells multiply lengths; the force of a free contact is the same in all cells.
#[test]
fn free_contacts_of_scaled_cells_have_the_same_friction() {
    // The slider moves by 1000 mean thresholds in the time in which a broken contact is free: one in a thousand is not.
    let outcome = run("
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.delay = { time = 1.0 }
contacts.free_friction = { force = 0.3 }
interface = { cells = [3], coupling.neighbours = { stiffness = 0.001 }, connection = 5.0, slip = 'overdamped', viscosity = 0.01, disorder.scale = [0.5, 1.0, 2.0] }
drive = { distance = 3000.0, velocity = 1000.0, points = 3 }
");
    let forces = &column(&outcome, "cell_force")[6..];
    // Contacts that are attached carry less than a thousandth of two mean thresholds.
    assert!(forces.iter().all(|force| (force - 0.3).abs() < 3e-3), "{forces:?}");
}

/// Cells of few time-dependent contacts differ by chance, each seed by its own.
#[test]
fn cells_of_few_contacts_in_time_are_drawn() {
    let events = |seed: u64| {
        let outcome = run(&format!(
            "{AGED}
interface = {{ cells = [3], coupling.neighbours = {{ stiffness = 0.5 }}, connection = 0.2, slip = 'overdamped', viscosity = 0.1 }}
ensemble = {{ size = 200, seed = {seed} }}
drive = {{ distance = 5.0, velocity = 1e-2, points = 6 }}
"
        ));
        assert_eq!(outcome.summary.seed, Some(seed));
        column(&outcome, "event_drive").to_vec()
    };
    let [one, again, other] = [1, 1, 2].map(events);
    assert!(!one.is_empty() && one == again && one != other, "{one:?} {other:?}");
}
