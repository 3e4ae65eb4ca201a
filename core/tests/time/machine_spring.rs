//! Velocity steps and holds behind a machine spring without mass and damping: against a rigid machine, the linear response of
//! steady sliding, contacts followed one by one, and the balance of forces and energies.

use crate::common::{gaussian, point};
use asperity::block::{Block, Loading, Slide, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, FreeFriction, Initial, Rules, Temperature};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::{DynamicStiffness, MasterEquation, Slider, Transport};
use asperity::scenario;

const VELOCITY: f64 = 0.01;

fn contacts(rules: Rules) -> Contacts {
    Contacts { rules, ..crate::common::contacts(&gaussian(1.0, 0.25), &point(0.0)) }
}

fn ageing() -> Contacts {
    contacts(Rules { ageing: Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 }), ..Rules::default() })
}

/// Thermally activated breaking is a direct effect, and ageing an evolution effect that exceeds it.
fn warm() -> Contacts {
    let temperature = Some(Temperature { barrier: Barrier::default(), ..Temperature::new(0.05, 1e3) });
    let ageing = Some(Ageing::Logarithmic { growth: 0.2, time: 1.0 });
    contacts(Rules { temperature, ageing, ..Rules::default() })
}

/// Motion in pieces of a velocity and a duration.
fn moving(pieces: &[(f64, f64)]) -> History {
    History::new(pieces.iter().map(|&(velocity, duration)| Piece { velocity, duration }).collect()).unwrap()
}

/// Steady sliding, a step of the velocity up by `factor`, and on.
fn step(factor: f64, distance: f64) -> History {
    let after = factor * VELOCITY;
    moving(&[(VELOCITY, 0.2 / VELOCITY), (after, distance / after)])
}

/// Times evenly spaced along a history.
fn times(history: &History, count: u32) -> Vec<f64> {
    (0..=count).map(|i| f64::from(i) / f64::from(count) * history.duration()).collect()
}

fn sliding(contacts: &Contacts, tolerance: f64) -> Transport {
    Transport::steady_with(contacts, VELOCITY, tolerance, &mut ()).unwrap()
}

/// The motion behind a spring of contacts that slide steadily.
fn follow(contacts: &Contacts, stiffness: f64, drive: &History, wanted: &[f64], tolerance: f64) -> Slide {
    let block = Block::new(Loading::Spring(stiffness), Slip::Reset, None).unwrap();
    block.follow_with(&sliding(contacts, tolerance), drive, wanted, tolerance, &mut ()).unwrap()
}

fn response(contacts: &Contacts) -> DynamicStiffness {
    DynamicStiffness::new(contacts, VELOCITY).unwrap()
}

/// The critical stiffness, and the angular frequency there per velocity.
fn critical_stiffness(contacts: &Contacts) -> (f64, f64) {
    let (stiffness, frequency) =
        response(contacts).critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
    (stiffness, frequency / VELOCITY)
}

fn kinetic_friction(contacts: &Contacts, velocity: f64) -> f64 {
    let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
    equation.steady_state().kinetic_friction()
}

#[test]
fn a_stiff_machine_is_a_rigid_one() {
    const TOLERANCE: f64 = 1e-4;
    let drive = moving(&[(VELOCITY, 20.0), (0.1, 10.0), (0.0, 100.0), (0.1, 10.0)]);
    let wanted = times(&drive, 40);
    for contacts in [ageing(), warm()] {
        let rigid = sliding(&contacts, TOLERANCE).follow(&drive, &wanted).unwrap();
        let off = |stiffness: f64| {
            let run = follow(&contacts, stiffness, &drive, &wanted, TOLERANCE);
            let each = run.trace.iter().zip(&rigid.force).map(|(moment, force)| (moment.force - force).abs());
            each.fold(0.0, f64::max)
        };
        let [soft, stiff] = [off(2.0), off(1e5)];
        println!("{soft:e} {stiff:e}");
        // The slider lags behind by F/K, some 1e-5, times the stiffness 1 of the contacts; both solutions are within the
        // tolerance.
        assert!(stiff < 2.0 * TOLERANCE + 1e-5, "{stiff:e}");
        // A spring that is no stiffer than the contacts shows.
        assert!(soft > 1e-3, "{soft:e}");
    }
}

#[test]
fn forces_are_in_balance_and_a_hold_relaxes_against_the_spring() {
    const TOLERANCE: f64 = 1e-4;
    let (stiffness, contacts) = (1.0, warm());
    let drive = moving(&[(VELOCITY, 20.0), (0.0, 1e4), (VELOCITY, 60.0)]);
    // The hold in equal steps of ln t.
    let hold = (0..=60).map(|k| 20.0 + 10.0_f64.powf(-2.0 + 0.1 * f64::from(k)).min(1e4));
    let again = (1..=60).map(|k| 10_020.0 + f64::from(k));
    let wanted: Vec<f64> = [0.0, 10.0, 20.0].into_iter().chain(hold).chain(again).collect();
    let run = follow(&contacts, stiffness, &drive, &wanted, TOLERANCE);
    for moment in &run.trace {
        let off = moment.spring_force - moment.force;
        // Stages are solved to a hundredth of the tolerance, times K + F' = 2.
        assert!(off.abs() < 0.03 * TOLERANCE, "{} {off:e}", moment.time);
    }
    let held: Vec<_> = run.trace.iter().filter(|m| (20.0..=10_020.0).contains(&m.time)).collect();
    for pair in held.windows(2) {
        let (moved, fell) = (pair[1].position - pair[0].position, pair[0].force - pair[1].force);
        assert!(moved > -0.03 * TOLERANCE, "{moved:e} at {}", pair[1].time);
        // dX = −dF/K while the load point rests, to the accuracy of the balance.
        assert!((moved - fell / stiffness).abs() < 0.06 * TOLERANCE, "{moved:e} {fell:e}");
    }
    // The contacts moved along the path found, in straight lines between its points, by transport alone.
    let path = run.trace.windows(2).map(|pair| {
        let duration = pair[1].time - pair[0].time;
        // At rest the balance is known to its accuracy only.
        Piece { velocity: ((pair[1].position - pair[0].position) / duration).max(0.0), duration }
    });
    let path = History::new(path.collect()).unwrap();
    let knots: Vec<f64> = path.knots().iter().map(|knot| knot.0).collect();
    let alone = sliding(&contacts, TOLERANCE).follow(&path, &knots).unwrap();
    let off = run.trace.iter().zip(&alone.force).map(|(moment, force)| (moment.force - force).abs());
    let off = off.fold(0.0, f64::max);
    let relaxed = held[0].force - held[held.len() - 1].force;
    println!("relaxed by {relaxed}, off {off:e}, imbalance {:e}", run.energy.imbalance());
    // Both tolerances, and straight lines over 1e-2 in length or 26 % of the time.
    assert!(off < 5.0 * TOLERANCE, "{off:e}");
    assert!(relaxed > 0.03, "{relaxed}");
    // The distance 0.8 times forces below 1, each to the tolerance.
    assert!(run.energy.imbalance().abs() < TOLERANCE, "{:e}", run.energy.imbalance());
}

#[test]
fn nothing_changes_until_the_first_step() {
    const TOLERANCE: f64 = 1e-4;
    for contacts in [ageing(), warm()] {
        let stiffness = 1.5 * critical_stiffness(&contacts).0;
        let drive = moving(&[(VELOCITY, 200.0)]);
        let run = follow(&contacts, stiffness, &drive, &times(&drive, 40), TOLERANCE);
        let friction = kinetic_friction(&contacts, VELOCITY);
        let off = run.trace.iter().map(|moment| (moment.force - friction).abs()).fold(0.0, f64::max);
        println!("K {stiffness}: {off:e}");
        // That of the contacts, and that of steps.
        assert!(off < 2.0 * TOLERANCE, "{off:e}");
    }
}

#[test]
fn slow_deviations_follow_the_velocity_curve() {
    let delayed = Contacts { rules: Rules { delay: 5.0.into(), ..warm().rules }, ..warm() };
    for contacts in [ageing(), warm(), delayed] {
        let [slow, fast] = [0.99, 1.01].map(|factor| kinetic_friction(&contacts, factor * VELOCITY));
        let slope = (fast - slow) / 0.02;
        // F̂ = iω dF_k/dv, per change of ln v.
        let frequency = 1e-3 * VELOCITY;
        let found =
            response(&contacts).at(num_complex::Complex64::new(0.0, frequency)).im * VELOCITY / frequency;
        println!("{slope} {found}");
        // Sums over ages and thresholds, some 1e-5 of forces of 0.5, over the slope; (ω/v)² and the difference of 2 % less.
        assert!((found - slope).abs() < 2e-4, "{found} instead of {slope}");
    }
}

/// The largest difference of the force from its linear response to a step of the velocity by 1 + `change`, and the largest
/// change of the force.
fn nonlinear(contacts: &Contacts, stiffness: f64, change: f64, tolerance: f64) -> (f64, f64) {
    let drive = moving(&[(VELOCITY * (1.0 + change), 3.0 / VELOCITY)]);
    let wanted = times(&drive, 50);
    let linear = response(contacts).after_velocity_change(stiffness, &wanted, &mut ()).unwrap();
    let block = Block::new(Loading::Spring(stiffness), Slip::Reset, None).unwrap();
    let run = block.follow_with(&sliding(contacts, tolerance), &drive, &wanted, tolerance, &mut ()).unwrap();
    let before = run.trace[0].force;
    let off = |(moment, force): (&asperity::block::Moment, &f64)| {
        (moment.force - before - change * VELOCITY * force).abs()
    };
    let largest = run.trace.iter().map(|moment| (moment.force - before).abs()).fold(0.0, f64::max);
    (run.trace.iter().zip(&linear.force).map(off).fold(0.0, f64::max), largest)
}

#[test]
fn a_small_step_is_the_linear_response() {
    for (contacts, tolerance) in [(ageing(), 1e-5), (warm(), 1e-4)] {
        let stiffness = 1.5 * critical_stiffness(&contacts).0;
        let [large, small] = [0.08, 0.02].map(|change| nonlinear(&contacts, stiffness, change, tolerance));
        println!("K {stiffness}: {large:?} {small:?}");
        // The response is proportional to the step and what it leaves out to the square: twice the step, relative to it. Filon's
        // rule adds 1e-2, contacts their tolerance.
        assert!(small.0 < 0.05 * small.1 + tolerance, "{small:?}");
        assert!(large.0 < 0.17 * large.1 + tolerance, "{large:?}");
        // Linear in the step, but for the same.
        assert!((large.1 / small.1 - 4.0).abs() < 0.4, "{large:?} {small:?}");
    }
}

#[test]
fn swings_decay_above_the_critical_stiffness_and_grow_below_it() {
    let contacts = warm();
    let (critical, frequency) = critical_stiffness(&contacts);
    let period = 2.0 * std::f64::consts::PI / frequency;
    // Swings of the force in the second period after a step of 2 %, and in the third: some 0.003 to 0.013.
    let swings = |stiffness: f64| {
        let drive = moving(&[(1.02 * VELOCITY, 3.0 * period / VELOCITY)]);
        let run = follow(&contacts, stiffness, &drive, &times(&drive, 120), 3e-4);
        let swing = |points: std::ops::Range<usize>| {
            let forces = || run.trace[points.clone()].iter().map(|moment| moment.force);
            forces().fold(f64::NEG_INFINITY, f64::max) - forces().fold(f64::INFINITY, f64::min)
        };
        [swing(40..80), swing(80..120)]
    };
    let [below, above] = [0.9, 1.1].map(|factor| swings(factor * critical));
    println!("K_c {critical} at {frequency}: {below:?} {above:?}");
    assert!(frequency.is_finite());
    // By a factor of 1.4 to 1.5 per period.
    assert!(below[1] > 1.2 * below[0], "{below:?}");
    assert!(above[1] < above[0] / 1.2, "{above:?}");
}

#[test]
fn steps_are_of_second_order() {
    // A spring so soft that the velocity changes much; contacts far more accurate than steps.
    let contacts = ageing();
    let drive = step(3.0, 1.0);
    let contacts = sliding(&contacts, 1e-7);
    let run = |tolerance: f64| {
        let block = Block::new(Loading::Spring(0.2), Slip::Reset, None).unwrap();
        block.follow_with(&contacts, &drive, &[drive.duration()], tolerance, &mut ()).unwrap()
    };
    let finest = run(1e-7).trace[0].force;
    let [rough, fine] = [1e-3, 1e-5].map(|tolerance| (run(tolerance).trace[0].force - finest).abs());
    let exponent = (rough / fine).log10() / 2.0;
    println!("{rough:e} {fine:e}: {exponent}");
    // An error of a step of third order gives one of the motion of second order, tolerance^{2/3}; steps change by factors.
    assert!((exponent - 2.0 / 3.0).abs() < 0.2, "{exponent}");
    assert!(fine < 1e-4, "{fine:e}");
}

#[test]
fn contacts_followed_one_by_one_feel_the_same_spring() {
    const SIZE: usize = 500;
    const RUNS: u64 = 8;
    // Stiffer than the first pull of relaxed contacts requires, also of so few of them.
    let (contacts, stiffness) = (warm(), 4.0);
    let drive = moving(&[(0.1, 20.0), (0.0, 100.0)]);
    let wanted: Vec<f64> = (1..=10).map(|k| 2.0 * f64::from(k)).chain([30.0, drive.duration()]).collect();
    let block = Block::new(Loading::Spring(stiffness), Slip::Reset, None).unwrap();
    let begun = Transport::new_with(contacts.clone(), &Initial::default(), 1e-4, &mut ()).unwrap();
    let master = block.follow_with(&begun, &drive, &wanted, 1e-4, &mut ()).unwrap();
    let singles: Vec<Slide> = (0..RUNS)
        .map(|seed| {
            let drawn =
                Ensemble::new(contacts.clone(), Initial::default(), SIZE, seed, Disorder::Annealed).unwrap();
            block.follow_with(&drawn.in_time().unwrap(), &drive, &wanted, 1e-3, &mut ()).unwrap()
        })
        .collect();
    for (i, moment) in master.trace.iter().enumerate() {
        let forces: Vec<f64> = singles.iter().map(|run| run.trace[i].force).collect();
        let runs = RUNS as f64;
        let mean = forces.iter().sum::<f64>() / runs;
        let variance = forces.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (runs - 1.0);
        let error = (variance / runs).sqrt();
        println!("{} {} {mean} {error:e}", moment.time, moment.force);
        // 4 standard errors, which for 8 runs are 5.4 by Student's t, and the tolerances of steps.
        assert!((moment.force - mean).abs() < 5.4 * error + 1e-3, "{} {mean} {error:e}", moment.force);
    }
}

#[test]
fn a_spring_too_soft_for_balance_asks_for_a_damping_or_a_mass() {
    let contacts = ageing();
    let critical = critical_stiffness(&contacts).0;
    let block = Block::new(Loading::Spring(0.5 * critical), Slip::Reset, None).unwrap();
    let drive = moving(&[(2.0 * VELOCITY, 4000.0)]);
    let error =
        block.follow_with(&sliding(&contacts, 1e-4), &drive, &[], 1e-4, &mut ()).unwrap_err().to_string();
    assert!(
        error.starts_with("slip: expected damped or inertial") && error.contains("no balance"),
        "{error}"
    );
}

#[test]
fn a_scenario_without_a_slip_rule_has_the_spring_of_a_machine() {
    let thresholds = Some(scenario::Law::Gaussian { mean: 1.0, std: 0.2 });
    let ageing = Some(scenario::Ageing::Logarithmic { growth: 0.02, time: 1.0 });
    let contacts = scenario::Contacts { thresholds, ageing, ..scenario::Contacts::default() };
    let with = |slip: Slip| {
        let steady = Some(scenario::TaskStart::Steady);
        let first = scenario::Step { start: steady, points: 2, ..scenario::Step::moving(0.1, 1.0) };
        let protocol = Some(scenario::Protocol(vec![first, scenario::Step::moving(1.0, 5.0)]));
        let block =
            Some(scenario::Block { stiffness: 1.0, slip, slip_fraction: scenario::Block::SLIP_FRACTION });
        scenario::Scenario { protocol, block, ..scenario::Scenario::new(contacts.clone()) }
    };
    let machine = with(Slip::default());
    let found = machine.protocol.as_ref().unwrap().run_block(&machine.build().unwrap(), &mut ()).unwrap();
    let values = |name: &str| found.record.values(name).unwrap();
    for i in 0..values("time").len() {
        let [force, pull] = ["force", "spring_force"].map(|name| values(name)[i]);
        // A hundredth of the tolerance 1e-4 of a step, times K + F'.
        assert!((force - pull).abs() < 3e-6, "{force} {pull}");
        assert!((values("drive")[i] - values("position")[i] - force).abs() < 3e-6);
    }
    for slip in [Slip::Overdamped, Slip::Arrest] {
        let error = with(slip).build().unwrap_err().to_string();
        assert!(error.starts_with("block.slip: expected damped or inertial"), "{error}");
    }
}

#[test]
fn contacts_without_a_linear_response_are_refused() {
    let key = |contacts: &Contacts, velocity: f64| match DynamicStiffness::new(contacts, velocity) {
        Err(asperity::Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    assert_eq!(key(&ageing(), 0.0), "velocity");
    let free_friction = FreeFriction { viscosity: 0.1, ..FreeFriction::default() };
    let viscous = contacts(Rules { delay: 1.0.into(), free_friction, ..Rules::default() });
    assert_eq!(key(&viscous, 1.0), "free_friction.viscosity");
    assert!(response(&ageing()).after_velocity_change(0.0, &[1.0], &mut ()).is_err());
}
