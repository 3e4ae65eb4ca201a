//! Starts in steady sliding: nothing changes until the first step, and after it all is as after a long run-in.

use std::sync::Arc;

use crate::common::{gaussian, point, rectangular};
use asperity::Error;
use asperity::block::{Block, Loading, Regime, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Stiffness, Temperature};
use asperity::elastic::coupling::Elasticity;
use asperity::elastic::{RateDependentInterface, RateDependentInterfaceParameters};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::{Exponential, Gamma, SharedLaw};
use asperity::master::{MasterEquation, Transport};
use asperity::rate_dependent::RateDependentContacts;
use asperity::scenario::{self, Scenario, TaskStart};
use asperity::shape::{Edges, Shape};

fn contacts(thresholds: SharedLaw, rules: Rules) -> Contacts {
    Contacts { rules, ..Contacts::new(thresholds, point(0.0)) }
}

fn rules(ageing: Option<Ageing>, temperature: f64, delay: f64) -> Rules {
    let heat = Temperature { barrier: Barrier::Elastic, ..Temperature::new(temperature, 1.0) };
    Rules {
        ageing,
        temperature: Some(heat).filter(|_| temperature > 0.0),
        delay: delay.into(),
        ..Rules::default()
    }
}

fn logarithmic() -> Option<Ageing> {
    Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 })
}

fn frozen_rank() -> Option<Ageing> {
    Some(Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 })
}

fn smoluchowski() -> Option<Ageing> {
    Some(Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion: 0.0025 })
}

fn moving(pieces: &[(f64, f64)]) -> History {
    let piece = |&(velocity, distance): &(f64, f64)| Piece { velocity, duration: distance / velocity };
    History::new(pieces.iter().map(piece).collect()).unwrap()
}

/// Times evenly spaced from the start to the end of a history.
fn times(history: &History, count: u32) -> Vec<f64> {
    (0..=count).map(|k| f64::from(k) / f64::from(count) * history.duration()).collect()
}

/// F_k by the renewal equation, which shares only the description of contacts with transport.
fn kinetic(contacts: &Contacts, velocity: f64) -> f64 {
    let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
    equation.steady_state().kinetic_friction()
}

#[test]
fn nothing_changes_until_the_first_step() {
    let per_threshold = |contacts| Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts };
    let spread = |contacts| Contacts { reforming: rectangular(0.0, 0.2), ..contacts };
    let wide = || gaussian(1.0, 0.25);
    let cases = [
        ("athermal", contacts(gaussian(1.0, 0.1), Rules::default()), 1.0, 1e-6),
        ("athermal, jumps", contacts(rectangular(0.75, 1.25), Rules::default()), 1.0, 1e-5),
        ("athermal, spread", spread(contacts(wide(), Rules::default())), 1.0, 1e-6),
        ("delay", contacts(gaussian(1.0, 0.1), rules(None, 0.0, 0.3)), 1.0, 1e-6),
        ("logarithmic", contacts(wide(), rules(logarithmic(), 0.0, 0.0)), 0.01, 1e-6),
        (
            "logarithmic, k = κx_s",
            per_threshold(contacts(wide(), rules(logarithmic(), 0.0, 0.0))),
            0.01,
            1e-6,
        ),
        ("frozen_rank", contacts(gaussian(0.5, 0.1), rules(frozen_rank(), 0.0, 0.0)), 0.3, 1e-6),
        ("temperature", contacts(gaussian(1.0, 0.1), rules(None, 0.05, 0.0)), 0.01, 1e-5),
        ("temperature, ageing, delay", contacts(wide(), rules(logarithmic(), 0.05, 5.0)), 0.01, 1e-4),
        ("smoluchowski", contacts(gaussian(0.5, 0.1), rules(smoluchowski(), 0.0, 0.0)), 1.0, 1e-4),
    ];
    for (name, contacts, velocity, tolerance) in cases {
        let mut transport = Transport::steady_with(&contacts, velocity, tolerance, &mut ()).unwrap();
        assert_eq!(transport.steady_velocity(), Some(velocity));
        // All contacts break twice or more, so that all cohorts of the start are replaced by others.
        let history = moving(&[(velocity, if name == "smoluchowski" { 1.0 } else { 2.5 })]);
        let trace = transport.follow(&history, &times(&history, 25)).unwrap();
        let friction = kinetic(&contacts, velocity);
        let off = trace.force.iter().map(|force| (force - friction).abs()).fold(0.0, f64::max);
        // The tolerance, in its unit.
        assert!(off < tolerance * transport.unit(), "{name}: {off:e} of {friction}");
        let whole = transport.attached() + transport.free();
        // Rounding.
        assert!((whole - 1.0).abs() < 1e-12, "{name}: {:e}", whole - 1.0);
        assert_eq!(transport.steady_velocity(), Some(velocity));
        transport.step(0.01, 0.005 / velocity, &mut ()).unwrap();
        assert_eq!(transport.steady_velocity(), None);
    }
}

#[test]
fn a_velocity_step_is_that_after_a_long_run_in() {
    // The slowest deviation from steady sliding decays over X* = 1.4 at most; narrower thresholds take longer. Some 25 of
    // these lengths leave e^{-25}, far less than the tolerances.
    const RUN_IN: f64 = 35.0;
    let wide = || gaussian(1.0, 0.25);
    let cases = [
        ("athermal", contacts(wide(), Rules::default()), 1e-6),
        ("logarithmic", contacts(wide(), rules(logarithmic(), 0.0, 0.0)), 1e-6),
        ("delay", contacts(wide(), rules(None, 0.0, 10.0)), 1e-6),
        ("temperature", contacts(wide(), rules(None, 0.05, 0.0)), 1e-4),
    ];
    for (name, contacts, tolerance) in cases {
        let (before, after) = ((0.01, 0.5), (0.1, 2.0));
        let step = moving(&[before, after]);
        let wanted = times(&step, 40);
        let mut steady = Transport::steady_with(&contacts, before.0, tolerance, &mut ()).unwrap();
        let steady = steady.follow(&step, &wanted).unwrap();
        let mut slid = Transport::new_with(contacts, &Initial::default(), tolerance, &mut ()).unwrap();
        let whole = moving(&[(before.0, RUN_IN), before, after]);
        let shift = RUN_IN / before.0;
        let later: Vec<f64> = wanted.iter().map(|time| (shift + time).min(whole.duration())).collect();
        let slid = slid.follow(&whole, &later).unwrap();
        let off = steady.force.iter().zip(&slid.force).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Both within the tolerance.
        assert!(off < 2.0 * tolerance, "{name}: {off:e}");
    }
}

#[test]
fn single_contacts_that_have_slid_in_feel_the_same_velocity_step() {
    let warm = contacts(gaussian(1.0, 0.25), rules(logarithmic(), 0.02, 3.0));
    let (before, after) = ((0.01, 0.5), (1.0, 1.5));
    let step = moving(&[before, after]);
    let wanted = times(&step, 12);
    let steady =
        Transport::steady_with(&warm, before.0, 1e-4, &mut ()).unwrap().follow(&step, &wanted).unwrap();
    let run_in = 20.0;
    let whole = moving(&[(before.0, run_in), before, after]);
    let later: Vec<f64> =
        wanted.iter().map(|time| (run_in / before.0 + time).min(whole.duration())).collect();
    let ensemble = Ensemble::new(warm, Initial::default(), 20_000, 5, Disorder::Annealed).unwrap();
    let followed = ensemble.follow(&whole, &later).unwrap();
    for (i, force) in steady.force.iter().enumerate() {
        let (off, error) = ((force - followed.force[i]).abs(), followed.error[i]);
        // The ensemble within 4 standard errors; the tolerance of transport.
        assert!(off < 4.0 * error + 1e-4, "{i}: {off:e} {error:e}");
    }
}

#[test]
fn a_block_starts_in_balance_with_its_spring() {
    let ageing = contacts(gaussian(1.0, 0.25), rules(logarithmic(), 0.0, 0.0));
    let (velocity, stiffness, damping, tolerance) = (0.01, 2.0, 1.0, 1e-5);
    let friction = kinetic(&ageing, velocity);
    for slip in [Slip::Damped { damping }, Slip::Inertial { mass: 1.0, damping }] {
        let transport = Transport::steady_with(&ageing, velocity, tolerance, &mut ()).unwrap();
        let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
        let drive = moving(&[(velocity, 1.5), (10.0 * velocity, 1.0)]);
        let until = drive.knots()[1].0;
        let wanted: Vec<f64> =
            (0..=20).map(|k| f64::from(k) / 20.0 * until).chain([drive.duration()]).collect();
        let run = block.follow_with(&transport, &drive, &wanted, tolerance, &mut ()).unwrap();
        let pull = friction + damping * velocity;
        assert!((run.trace[0].spring_force - pull).abs() < tolerance && run.trace[0].velocity == velocity);
        for moment in run.trace.iter().take_while(|moment| moment.time <= until) {
            // The step size is chosen for errors of the tolerance; contacts add theirs.
            let off = (moment.spring_force - pull).abs();
            assert!(off < 4.0 * tolerance, "{} {off:e}", moment.time);
            assert!((moment.velocity / velocity - 1.0).abs() < 0.01, "{}", moment.velocity / velocity);
        }
        assert!(matches!(run.regime, Regime::Smooth { .. } | Regime::Undecided { .. }), "{}", run.regime);
        // Every term of the balance has an error of the tolerance times the distance, 2.5.
        assert!(run.energy.imbalance().abs() < 10.0 * tolerance, "{:e}", run.energy.imbalance());
    }
}

#[test]
fn an_interface_slides_steadily_from_the_start() {
    let ageing = contacts(gaussian(1.0, 0.25), rules(logarithmic(), 0.0, 0.0));
    let (velocity, tolerance, cells) = (0.01, 1e-4, 4);
    let cell = |velocity: f64| {
        let steady = Transport::steady_with(&ageing, velocity, tolerance, &mut ()).unwrap();
        Box::new(steady) as Box<dyn RateDependentContacts>
    };
    let coupling = || {
        let neighbours = Elasticity::Neighbours { stiffness: 1.0 };
        neighbours.build(Shape::Chain(cells), Edges::Open, &mut ()).unwrap()
    };
    let setting = RateDependentInterfaceParameters::new(2.0, 1.0, tolerance);
    let alike = (0..cells).map(|_| cell(velocity)).collect();
    let mut interface = RateDependentInterface::new(alike, coupling(), setting).unwrap();
    let (friction, begun) = (kinetic(&ageing, velocity), interface.drive());
    assert!((begun - (friction + velocity) / 2.0).abs() < tolerance);
    let mut events = 0;
    interface.run(begun + 1.5, velocity, &mut |_, _| events += 1).unwrap();
    // As for a block.
    let off = interface.forces().into_iter().map(|force| (force - friction).abs()).fold(0.0, f64::max);
    assert!(events == 0 && off < 4.0 * tolerance, "{events} {off:e}");
    let unlike = (0..cells).map(|j| cell(if j == 2 { 0.02 } else { velocity })).collect();
    assert!(RateDependentInterface::new(unlike, coupling(), setting).is_err());
}

#[test]
fn the_stretches_of_steady_sliding_are_a_distribution() {
    let cases: [(SharedLaw, SharedLaw, Option<f64>); 6] = [
        (gaussian(1.0, 0.1), point(0.0), None),
        (rectangular(0.75, 1.25), point(0.0), None),
        // F_k of contacts that re-form among their thresholds, from 40 digits.
        (rectangular(0.4, 1.6), rectangular(0.0, 0.6), Some(0.717_312_661_498_708)),
        (point(1.0), point(0.0), Some(0.5)),
        (Arc::new(Exponential::new(1.0).unwrap()), point(0.0), Some(1.0)),
        (Arc::new(Gamma::new(1.0, 0.3).unwrap()), gaussian(0.2, 0.05), None),
    ];
    for (i, (thresholds, reforming, known)) in cases.into_iter().enumerate() {
        let simple = reforming.upper_quantile(0.0) == 0.0;
        let contacts = Contacts::new(thresholds.clone(), reforming);
        let steady = MasterEquation::new(contacts.clone(), &Initial::default()).unwrap().steady_state();
        let law = steady.stretch_law().unwrap();
        let friction = steady.kinetic_friction();
        // What is above the highest start, one contact in 10⁹, times its stretch over the mean.
        let cut = 1e-9 * thresholds.upper_quantile(1e-9).max(1.0) * 2.0;
        let allowed = if thresholds.quantile(1.0).is_finite() { 1e-12 } else { cut };
        assert!((law.mean() - friction).abs() < allowed, "{i}: {:e}", law.mean() - friction);
        assert!(known.is_none_or(|known| (friction - known).abs() < 1e-12), "{i}: {friction}");
        for x in [0.1, 0.5, 0.9, 1.1] {
            // Q_s = S/x̄ for contacts that re-form without stretch.
            let closed = thresholds.survival(x) / thresholds.mean();
            assert!(
                !simple || (law.density(x) - closed).abs() < 1e-8,
                "{i} {x}: {} {closed}",
                law.density(x)
            );
        }
        // Pulled on, they stay as they are.
        let start = Initial::new(law);
        let pull =
            MasterEquation::new(contacts.clone(), &start).unwrap().pull_with(6.0, 1e-9, &mut ()).unwrap();
        for x in [0.0, 0.3, 0.7, 1.0, 2.3, 5.9] {
            let off = (pull.force(x) - friction).abs();
            assert!(off < allowed.max(1e-9), "{i} {x}: {off:e}");
        }
        let ensemble = Ensemble::new(contacts, start, 20_000, 3, Disorder::Annealed).unwrap();
        let history = moving(&[(1.0, 1.5)]);
        let followed = ensemble.follow(&history, &[0.01, 0.5, 1.5]).unwrap();
        for (force, error) in followed.force.iter().zip(&followed.error) {
            // 4 standard errors; rounding of identical forces.
            assert!((force - friction).abs() < 4.0 * error + 1e-12, "{i}: {force} {friction} {error:e}");
        }
    }
    let timed = contacts(gaussian(1.0, 0.1), rules(None, 0.0, 1.0));
    let steady = MasterEquation::at(timed, &Initial::default(), 1.0).unwrap().steady_state();
    assert!(steady.stretch_law().unwrap_err().to_string().contains("delay"));
}

fn task(ageing: Option<scenario::Ageing>) -> Scenario {
    let thresholds = Some(scenario::Law::Gaussian { mean: 1.0, std: 0.25 });
    Scenario::new(scenario::Contacts { thresholds, ageing, ..scenario::Contacts::default() })
}

#[test]
fn a_protocol_and_its_ensemble_start_in_steady_sliding() {
    let steady = |velocity| scenario::Step {
        start: Some(TaskStart::Steady),
        points: 6,
        ..scenario::Step::moving(velocity, 0.5 / velocity)
    };
    let ageing = Some(scenario::Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    for ageing in [None, ageing] {
        let faster = scenario::Step { points: 11, ..scenario::Step::moving(0.1, 15.0) };
        let protocol = Some(scenario::Protocol(vec![steady(0.01), faster]));
        let ensemble = Some(scenario::Ensemble { size: Some(20_000), ..scenario::Ensemble::default() });
        let scenario = Scenario { protocol, ensemble, ..task(ageing) };
        let model = scenario.build().unwrap();
        assert_eq!(model.steady, Some(0.01));
        let found = scenario.protocol.unwrap().run(&model).unwrap();
        let values = |name: &str| found.record.values(name).unwrap();
        let friction = kinetic(&model.contacts, 0.01);
        let rest = values("force")[..6].iter().map(|force| (force - friction).abs()).fold(0.0, f64::max);
        // The tolerance of a protocol.
        assert!(rest < 1e-6 && values("time")[0] == 0.0, "{rest:e}");
        for ((force, drawn), error) in
            values("force").iter().zip(values("ensemble_force")).zip(values("ensemble_error"))
        {
            // 4 standard errors.
            assert!((force - drawn).abs() < 4.0 * error, "{force} {drawn} {error:e}");
        }
    }
}

#[test]
fn an_athermal_drive_starts_at_kinetic_friction() {
    let turning_points = Some(vec![3.0, 2.0]);
    let drive = scenario::Drive {
        turning_points,
        points: 51,
        start: TaskStart::Steady,
        ..scenario::Drive::default()
    };
    let block = Some(scenario::Block { stiffness: 0.5, slip: Slip::Overdamped, slip_fraction: 0.05 });
    let scenario = Scenario { drive: Some(drive.clone()), block, ..task(None) };
    let model = scenario.build().unwrap();
    let found = drive.run(&model).unwrap();
    let values = |name: &str| found.record.values(name).unwrap();
    let (drives, forces) = (values("drive"), values("force"));
    let friction = kinetic(&model.contacts, 1.0);
    let (turn, _) = drives.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
    for force in &forces[..=turn] {
        // The aim of the master equation, 1e-10, and one contact in 10⁹ that is missing.
        assert!((force - friction).abs() < 2e-9, "{force} {friction}");
    }
    // Backward, contacts unload along a straight line of slope 1, behind a spring of ½ by a third of the drive, until one breaks.
    let (next, last) = (turn + 1, drives.len() - 1);
    let fall = (forces[turn] - forces[next]) / (drives[turn] - drives[next]);
    assert!((fall - 1.0 / 3.0).abs() < 1e-6, "{fall}");
    assert!(forces[last] < friction - 0.2);
}

#[test]
fn the_reported_accuracy_holds_the_error_of_the_stretches() {
    let gaussian = |mean, std| scenario::Law::Gaussian { mean, std };
    let cases = [(gaussian(1.0, 0.25), scenario::Law::zero()), (gaussian(1.0, 0.1), gaussian(0.9, 0.09))];
    for (thresholds, reforming) in cases {
        let pull = scenario::Pull { distance: 4.0, start: TaskStart::Steady, ..scenario::Pull::default() };
        let contacts =
            scenario::Contacts { thresholds: Some(thresholds), reforming, ..scenario::Contacts::default() };
        let scenario = Scenario { pull: Some(pull.clone()), ..Scenario::new(contacts) };
        let model = scenario.build().unwrap();
        let friction = kinetic(&model.contacts, 1.0);
        let found = pull.run(&model).unwrap();
        let forces = found.record.values("force").unwrap();
        let off = forces.iter().map(|force| (force - friction).abs()).fold(0.0, f64::max);
        let reported = found.accuracy.unwrap();
        // One contact in 1e9 is left out of the stretches, so the force is off, and by less than what such contacts carry.
        assert!(off > 1e-11 && reported < 1e-8, "{off:e} {reported:e}");
        // F_k by the renewal equation at a velocity is that without one but for rounding.
        assert!(off < reported + 1e-14, "{off:e} {reported:e}");
    }
}

#[test]
fn what_does_not_start_in_steady_sliding_is_refused() {
    let key = |scenario: Scenario| match scenario.build() {
        Err(Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let steady = TaskStart::Steady;
    let ageing = || Some(scenario::Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let pull = |derivatives, velocity| {
        Some(scenario::Pull { start: steady, derivatives, velocity, ..scenario::Pull::default() })
    };
    assert_eq!(key(Scenario { pull: pull(false, Some(0.1)), ..task(ageing()) }), "pull.start");
    assert_eq!(key(Scenario { pull: pull(true, None), ..task(None) }), "pull.start");
    let forced = scenario::Drive { start: steady, force_to: Some(0.5), ..scenario::Drive::default() };
    assert_eq!(key(Scenario { drive: Some(forced), ..task(None) }), "drive.start");
    let initial = scenario::Law::Point { at: 0.1 };
    assert_eq!(key(Scenario { initial, pull: pull(false, None), ..task(None) }), "initial");
    Scenario { pull: pull(false, None), ..task(None) }.build().unwrap();
}
