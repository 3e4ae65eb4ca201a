//! Interfaces over time-dependent contacts whose load point follows a protocol: steady starts, velocity steps and holds.

use std::sync::Arc;

use crate::common::point;
use asperity::Error;
use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Contacts, Initial, Rules};
use asperity::elastic::{CellLoading, CellSlip};
use asperity::history::{History, Piece};
use asperity::law::Gaussian;
use asperity::master::{MasterEquation, Transport};
use asperity::record::Record;
use asperity::scenario::{
    self, Drive, Edges, Elasticity, Interface, PerCell, Protocol, Scales, Scenario, Step, TaskStart,
};

const TOLERANCE: f64 = 1e-4;
const VISCOSITY: f64 = 1.0;

/// Contacts that age, with thresholds so broad that deviations from steady sliding decay within some mean thresholds.
fn ageing() -> Contacts {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 }), ..Rules::default() };
    Contacts { rules, ..Contacts::new(Arc::new(Gaussian::new(1.0, 0.25).unwrap()), point(0.0)) }
}

/// The same contacts under a chain with these scales and springs to the drive.
fn chain(scales: &[f64], connection: f64) -> Scenario {
    let own = Interface {
        cells: vec![scales.len()],
        contacts: PerCell::Many,
        connection,
        coupling: Elasticity::Neighbours { stiffness: 1.0 },
        edges: Edges::Open,
        loading: CellLoading::Uniform,
        slip: Some(CellSlip::Overdamped),
        viscosity: Some(VISCOSITY),
        disorder: Some(Scales { scale: Some(scales.to_vec()), ..Scales::default() }),
        areas: None,
        drive_tolerance: 1e-6,
        catalogue_from: 0.0,
        mass: None,
        slip_rates: None,
        main_shocks: None,
    };
    let contacts = scenario::Contacts {
        thresholds: Some(scenario::Law::Gaussian { mean: 1.0, std: 0.25 }),
        ageing: Some(scenario::Ageing::Logarithmic { growth: 0.04, time: 1.0 }),
        ..scenario::Contacts::default()
    };
    let mut scenario = Scenario { interface: Some(own), ..Scenario::new(contacts) };
    scenario.master_equation.tolerance = Some(TOLERANCE);
    scenario
}

fn moving(velocity: f64, distance: f64, points: usize) -> Step {
    Step { points, ..Step::moving(velocity, distance / velocity) }
}

fn steady(step: Step) -> Step {
    Step { start: Some(TaskStart::Steady), ..step }
}

fn hold(duration: f64, points: usize) -> Step {
    Step { hold: Some(duration), points, ..Step::default() }
}

/// The record of a chain along a protocol.
fn follow(chain: &Scenario, steps: Vec<Step>) -> Record {
    let scenario = Scenario { protocol: Some(Protocol(steps)), ..chain.clone() };
    let model = scenario.build().unwrap();
    // The error that is estimated of the force of a cell may exceed the tolerance of a step, which it is not.
    let unchecked =
        scenario::Model { master_equation: scenario::MasterEquation { tolerance: None }, ..model };
    scenario.protocol.unwrap().run_interface(&unchecked, &mut ()).unwrap().record
}

fn values<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

fn farthest(found: &[f64], expected: impl IntoIterator<Item = f64>) -> f64 {
    found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max)
}

/// F_k by the renewal equation, which shares only the description of contacts with transport.
fn kinetic(velocity: f64) -> f64 {
    MasterEquation::at(ageing(), &Initial::default(), velocity).unwrap().steady_state().kinetic_friction()
}

#[test]
fn cells_that_differ_slide_steadily_until_the_first_step() {
    let (scales, velocity, connection) = ([0.8, 1.0, 1.3, 1.1], 0.01, 2.0);
    let record = follow(&chain(&scales, connection), vec![steady(moving(velocity, 1.5, 16))]);
    // A cell of the scale s is one of scale 1 at the velocity v/s, with forces times s.
    let expected: Vec<f64> = scales.iter().map(|scale| scale * kinetic(velocity / scale)).collect();
    let (drives, forces) = (values(&record, "drive"), values(&record, "cell_force"));
    let begin = (expected.iter().sum::<f64>() + 4.0 * VISCOSITY * velocity) / (4.0 * connection);
    assert!((drives[0] - begin).abs() < TOLERANCE && (drives[15] - begin - 1.5).abs() < TOLERANCE);
    assert!(values(&record, "event_drive").is_empty());
    // The tolerance of the contacts, and that of the positions of cells, which change forces by a stiffness of 1.
    let off = farthest(forces, (0..16).flat_map(|_| expected.clone()));
    assert!(off < 4.0 * TOLERANCE, "{off:e}");
    let fastest = values(&record, "cell_velocity").iter().fold(0.0, |high: f64, v| high.max(*v));
    assert!((fastest / velocity - 1.0).abs() < 0.02, "{fastest}");
}

#[test]
fn a_step_from_a_steady_start_is_that_after_a_long_run_in() {
    // Deviations from steady sliding decay over 1.4 mean thresholds at most: 20 mean thresholds leave e^{−14} = 8e-7.
    const RUN_IN: f64 = 20.0;
    let (chain, velocity) = (chain(&[0.9, 1.0, 1.2], 2.0), 0.01);
    let step = || vec![moving(velocity, 0.5, 6), moving(10.0 * velocity, 2.0, 41)];
    let mut begun = step();
    begun[0].start = Some(TaskStart::Steady);
    let slid = follow(&chain, [vec![moving(velocity, RUN_IN, 2)], step()].concat());
    let found = follow(&chain, begun);
    // The first two points of the other run are its start and the end of the run-in.
    for name in ["force", "cell_force"] {
        let cells = if name == "force" { 1 } else { 3 };
        let expected = values(&slid, name)[cells..].iter().copied();
        let off = farthest(values(&found, name), expected);
        // Both within the tolerance, for three cells together.
        assert!(off < 6.0 * TOLERANCE, "{name}: {off:e}");
    }
    // The friction after the step has moved by far more than that.
    let forces = values(&found, "force");
    assert!((forces[0] - forces[45]).abs() > 0.1, "{forces:?}");
}

#[test]
fn a_uniform_chain_is_one_cell_and_that_a_block() {
    let (velocity, connection) = (0.01, 0.5);
    let steps = || {
        vec![
            steady(moving(velocity, 0.2, 3)),
            hold(300.0, 11),
            moving(velocity, 2.5, 51),
            hold(30.0, 6),
            moving(3.0 * velocity, 1.0, 21),
        ]
    };
    let [one, five] = [1, 5].map(|cells| follow(&chain(&vec![1.0; cells], connection), steps()));
    for (name, cells) in [("force", 5.0), ("position", 1.0), ("drive", 1.0), ("velocity", 1.0)] {
        let off = farthest(values(&five, name), values(&one, name).iter().map(|value| cells * value));
        // Cells that are alike move alike: but for the rounding of the solution of five equations instead of one, the steps
        // are the same. Rounding may change an iteration more or less, by a hundredth of the tolerance each.
        assert!(off < cells * TOLERANCE, "{name}: {off:e}");
    }
    let protocol = Protocol(steps());
    let transport = Transport::steady_with(&ageing(), velocity, TOLERANCE, &mut ()).unwrap();
    let block = Block::new(Loading::Spring(connection), Slip::Damped { damping: VISCOSITY }, None).unwrap();
    let times = protocol.times();
    let run = block.follow_with(&transport, &protocol.build().unwrap(), &times, TOLERANCE, &mut ()).unwrap();
    let at = |time: &f64| run.trace.iter().find(|moment| moment.time == *time).unwrap();
    let off = farthest(values(&one, "force"), times.iter().map(|time| at(time).force));
    // Two solvers of the same equation, each within some tolerances; slips amplify what they differ by.
    assert!(off < 20.0 * TOLERANCE, "{off:e}");
    let off = farthest(values(&one, "drive"), times.iter().map(|time| at(time).drive));
    assert!(off < TOLERANCE, "{off:e}");
}

#[test]
fn the_whole_interface_heals_in_a_hold() {
    // A stiff machine: the slider moves with the load point, but for F/K = 0.005, and a rigid slider has no solver of motion.
    let (velocity, connection, cells) = (0.1, 200.0, 3);
    let (rest, pull) = ([10.0, 100.0, 1000.0], 1.5);
    let peak = |forces: &[f64]| forces.iter().copied().fold(0.0, f64::max);
    let mut healed = Vec::new();
    for hold_time in rest {
        let steps = vec![steady(moving(velocity, 0.1, 2)), hold(hold_time, 3), moving(velocity, pull, 301)];
        let record = follow(&chain(&vec![1.0; cells], connection), steps);
        let pieces = [(velocity, 0.1 / velocity), (0.0, hold_time), (velocity, pull / velocity)];
        let piece = |(velocity, duration)| Piece { velocity, duration };
        let history = History::new(pieces.map(piece).to_vec()).unwrap();
        let times: Vec<f64> = (0..=300)
            .map(|k| (history.knots()[2].0 + f64::from(k) * pull / velocity / 300.0).min(history.duration()))
            .collect();
        let mut rigid = Transport::steady_with(&ageing(), velocity, 1e-6, &mut ()).unwrap();
        let expected = peak(&rigid.follow(&history, &times).unwrap().force);
        let found = peak(values(&record, "force")) / cells as f64;
        // The load point is at 301 places 0.005 apart, and near its peak the force is a parabola; a slider that creeps by 0.005
        // during the hold has another half of a percent of young contacts.
        assert!((found - expected).abs() < 1e-3, "{hold_time}: {found} {expected}");
        healed.push(found);
    }
    // Thresholds grow by 4 % of their mean per factor of e in age, and the peak with them.
    let per_decade = healed[2] - healed[1];
    assert!(per_decade > 0.03 && healed[1] > healed[0], "{healed:?}");
}

#[test]
fn a_hold_of_a_soft_chain_creeps_to_rest_and_loses_nothing() {
    let (velocity, connection) = (0.01, 0.3);
    let (scenario, tolerance) = (chain(&[0.9, 1.1], connection), TOLERANCE);
    let steps = vec![steady(moving(velocity, 0.5, 2)), hold(2000.0, 21)];
    let record = follow(&scenario, steps);
    let (position, last) = (values(&record, "position"), values(&record, "cell_velocity").len() - 1);
    // It follows the springs by the drag, ηv/(K + F') in all, and then rests: velocities decay within η/(K + F') < 3.
    assert!(position[22 - 1] - position[1] < VISCOSITY * velocity / connection + tolerance);
    assert!(values(&record, "cell_velocity")[last] < 1e-9);
    assert_eq!(values(&record, "drive")[1], values(&record, "drive")[21]);
    assert!(values(&record, "map_time").windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn slip_rates_are_the_motion_of_the_cells() {
    let steps = || vec![steady(moving(1e-3, 0.1, 2)), hold(1e4, 2), moving(1e-3, 6.0, 2)];
    let recorded = |most: usize| {
        // Thresholds so narrow, and springs so soft, that the cells slip.
        let mut scenario = chain(&[0.9, 1.0, 1.1], 0.05);
        scenario.contacts.thresholds = Some(scenario::Law::Gaussian { mean: 1.0, std: 0.1 });
        scenario.interface.as_mut().unwrap().slip_rates = Some(most);
        follow(&scenario, steps())
    };
    let record = recorded(100_000);
    let (time, rates) = (values(&record, "slip_rate_time"), values(&record, "slip_rate"));
    let (count, positions) = (time.len(), values(&record, "cell_position"));
    assert_eq!((rates.len(), record.get("slip_rate").unwrap().dimensions.len()), (3 * count, 2));
    assert_eq!(values(&record, "slip_rate_step")[count - 1], (count - 1) as f64);
    assert!(!values(&record, "event_drive").is_empty());
    for cell in 0..3 {
        let rate = |i: usize| rates[3 * i + cell];
        let moved: f64 = (1..count).map(|i| 0.5 * (rate(i) + rate(i - 1)) * (time[i] - time[i - 1])).sum();
        let expected = positions[positions.len() - 3 + cell] - positions[cell];
        // Velocities are positions to the third order of a step, whose error is the tolerance, as is that of the trapezoidal
        // rule, twelve times that of TR-BDF2.
        assert!((moved / expected - 1.0).abs() < 0.01, "{cell}: {moved} {expected}");
    }
    // Of fewer steps every second, fourth, … is there, with the same values.
    let few = recorded(64);
    let every = values(&few, "slip_rate_step")[1] as usize;
    assert!(every >= 2 && values(&few, "slip_rate_time").len() <= 64);
    let expected: Vec<f64> = rates.chunks(3).step_by(every).flatten().copied().collect();
    assert_eq!(values(&few, "slip_rate"), expected);
}

#[test]
fn what_interfaces_do_not_follow_is_refused() {
    let error = |scenario: Scenario| match scenario.build() {
        Err(Error::Invalid { key, expected, .. }) => (key, expected),
        other => panic!("{other:?}"),
    };
    let steps = Some(Protocol(vec![moving(0.1, 1.0, 2)]));
    let timed = || Scenario { protocol: steps.clone(), ..chain(&[1.0, 1.0], 1.0) };
    timed().build().unwrap();
    let with_rates = |steps: usize, mut scenario: Scenario| {
        scenario.interface.as_mut().unwrap().slip_rates = Some(steps);
        scenario
    };
    assert_eq!(error(with_rates(1, timed())).0, "interface.slip_rates");
    assert_eq!(error(with_rates(10_000_000_000_000, timed())).0, "interface.slip_rates");
    let mut athermal = timed();
    athermal.contacts.ageing = None;
    let drive = Some(Drive::default());
    let driven = Scenario { protocol: None, drive, ..athermal.clone() };
    assert_eq!(error(with_rates(100, driven)).0, "interface.slip_rates");
    assert_eq!(error(athermal).0, "protocol");
    let ensemble = Some(scenario::Ensemble { size: Some(100), ..scenario::Ensemble::default() });
    let drawn = Some(Protocol(vec![steady(moving(0.1, 1.0, 2))]));
    assert_eq!(error(Scenario { ensemble: ensemble.clone(), protocol: drawn, ..timed() }).0, "ensemble");
    Scenario { ensemble: ensemble.clone(), ..timed() }.build().unwrap();
    let drive = Drive { velocity: Some(0.1), start: TaskStart::Steady, ..Drive::default() };
    let steady = Scenario { protocol: None, drive: Some(drive), ..timed() };
    assert_eq!(steady.build().unwrap().steady, Some(0.1));
    assert_eq!(error(Scenario { ensemble, ..steady }).0, "ensemble");
}
