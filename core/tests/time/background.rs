//! A background force: shifted curves where the slider goes one way, and what holds it where it would turn back.

use std::sync::Arc;

use crate::common::pulled::near;
use asperity::block::{Block, Drive, Loading, Regime, Slip, StickSlip};
use asperity::contacts::{Ageing, Contacts, Initial};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Point};
use asperity::master::{MasterEquation, Transport};

/// Background force, larger than any force of the contacts.
const BACKGROUND: f64 = 5.0;
/// Stiffness at which the contacts below stick and slip.
const SOFT: f64 = 0.4;

fn contacts() -> Contacts {
    Contacts::new(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), Arc::new(Point::new(0.0).unwrap()))
}

fn slider(loading: Loading, slip: Slip, background: f64) -> Block {
    Block::new(loading, slip, None).unwrap().with_background(background).unwrap()
}

fn pulled(block: &Block, turning_points: &[f64]) -> StickSlip {
    let equation = MasterEquation::new(contacts(), &Initial::default()).unwrap();
    let mut population = equation.population().unwrap();
    let drive = Drive { turning_points: turning_points.to_vec(), points: 41 };
    block.pull(&mut population, &drive).unwrap()
}

/// Largest error of a force, a position or an energy: the tolerance of the master equation, 1e-10, over some ten contacts' lives
/// and amplified by 1/(1 + F'/K) near an instability.
const CLOSE: f64 = 1e-7;

#[test]
fn a_slider_that_goes_one_way_is_shifted() {
    for slip in [Slip::Reset, Slip::Overdamped, Slip::Arrest] {
        let (bare, loaded) =
            (slider(Loading::Spring(SOFT), slip, 0.0), slider(Loading::Spring(SOFT), slip, BACKGROUND));
        let (bare, loaded) = (pulled(&bare, &[10.0]), pulled(&loaded, &[10.0]));
        assert!(bare.events.len() > 1);
        assert_eq!(bare.events.len(), loaded.events.len());
        assert_eq!(bare.trace.len(), loaded.trace.len());
        for (a, b) in bare.trace.iter().zip(&loaded.trace) {
            // Sliding forward the background force is in no equation.
            assert_eq!((b.drive, b.position), (a.drive, a.position));
            near(b.force, a.force + BACKGROUND, CLOSE);
            near(b.spring_force, a.spring_force + BACKGROUND, CLOSE);
        }
        for (a, b) in bare.events.iter().zip(&loaded.events) {
            near(b.drop(), a.drop(), CLOSE);
            near(b.energy.breaks, a.energy.breaks, CLOSE);
            near(b.energy.background, BACKGROUND * (b.after.position - b.before.position), CLOSE);
            near(b.energy.slip, a.energy.slip, CLOSE);
        }
        near(loaded.energy.imbalance(), 0.0, CLOSE);
        let advanced = loaded.trace[loaded.trace.len() - 1].position - loaded.trace[0].position;
        near(loaded.energy.background, BACKGROUND * advanced, CLOSE);
    }
}

/// After an overshoot a slider without a background force moves back to where spring and contacts balance; one with a large one
/// stays where it came to rest, and its drop is larger.
#[test]
fn an_overshoot_is_held() {
    let slip = Slip::Inertial { mass: 1.0, damping: 0.0 };
    let bare = pulled(&slider(Loading::Spring(SOFT), slip, 0.0), &[4.0]);
    let loaded = pulled(&slider(Loading::Spring(SOFT), slip, BACKGROUND), &[4.0]);
    let (a, b) = (&bare.events[0], &loaded.events[0]);
    // The motion up to the rest is the same.
    near(b.position_turn, a.position_turn, CLOSE);
    assert!(a.after.position < a.position_turn - 0.01);
    assert_eq!(b.after.position, b.position_turn);
    // The spring force there is that of the spring at this position.
    near(b.after.force, SOFT * (b.before.drive - b.position_turn) + BACKGROUND, CLOSE);
    near(b.drop() - a.drop(), SOFT * (a.position_turn - a.after.position), CLOSE);
    // Held: the position does not change until the spring has regained what it lost below the force of the contacts and B.
    let held: Vec<_> = loaded.trace.iter().filter(|p| p.position == b.position_turn).collect();
    assert!(held.len() > 2, "{}", held.len());
    assert!(held.iter().all(|p| (p.force - p.spring_force).abs() < CLOSE));
    near(loaded.energy.imbalance(), 0.0, CLOSE);
    near(bare.energy.imbalance(), 0.0, CLOSE);
}

/// A small background force lets the slider move back, by less: (net force − 2B)/(K + k), with the stiffness k = 1 of all
/// contacts, as nothing breaks on the way back.
#[test]
fn a_small_background_force_shortens_the_way_back() {
    let slip = Slip::Inertial { mass: 1.0, damping: 0.0 };
    let bare = pulled(&slider(Loading::Spring(SOFT), slip, 0.0), &[4.0]);
    let back = bare.events[0].position_turn - bare.events[0].after.position;
    let background = 0.2 * back * (SOFT + 1.0);
    let loaded = pulled(&slider(Loading::Spring(SOFT), slip, background), &[4.0]);
    let event = &loaded.events[0];
    near(event.position_turn - event.after.position, 0.6 * back, CLOSE);
    near(loaded.energy.imbalance(), 0.0, CLOSE);
}

/// Where the drive turns, the slider is at rest until the spring has lost 2B; then B resists the motion back. A rigid slider
/// has ±B at once.
#[test]
fn a_drive_that_turns() {
    let (stiffness, background) = (10.0, 1.0);
    let block = slider(Loading::Spring(stiffness), Slip::Overdamped, background);
    let run = pulled(&block, &[3.0, 2.6, 3.2]);
    near(run.energy.imbalance(), 0.0, CLOSE);
    let turn = run.trace.iter().position(|p| p.drive == 3.0).unwrap();
    let top = run.trace[turn];
    let back = run.trace[turn..].iter().position(|p| p.drive == 2.6).unwrap();
    assert!(back > 3);
    for point in &run.trace[turn..=turn + back] {
        let lost = stiffness * (top.drive - point.drive);
        if lost <= 2.0 * background {
            assert_eq!(point.position, top.position);
            near(point.force, top.force - lost, CLOSE);
        } else {
            // On a way back of at most 0.2 nothing breaks, as hardly a threshold is below 0.2: contacts unload along k = 1.
            let back = (lost - 2.0 * background) / (stiffness + 1.0);
            near(point.position, top.position - back, CLOSE);
            near(point.force, top.force - 2.0 * background - back, CLOSE);
        }
    }
    let rigid = pulled(&slider(Loading::Rigid, Slip::Overdamped, background), &[3.0, 2.5]);
    let bare = pulled(&slider(Loading::Rigid, Slip::Overdamped, 0.0), &[3.0, 2.5]);
    for (a, b) in bare.trace.iter().zip(&rigid.trace) {
        assert_eq!(a.position, b.position);
        assert!(((b.force - a.force).abs() - background).abs() < CLOSE);
    }
    near(rigid.trace.last().unwrap().force - bare.trace.last().unwrap().force, -background, CLOSE);
    near(rigid.energy.background, 3.5 * background, CLOSE);
    near(rigid.energy.imbalance(), 0.0, CLOSE);
}

/// A simulation from event to event is the run along the drive, also where the slider is held.
#[test]
fn a_simulation_is_the_same_run() {
    let slip = Slip::Inertial { mass: 1.0, damping: 0.0 };
    let block = slider(Loading::Spring(SOFT), slip, BACKGROUND);
    let end = 6.0;
    let whole = pulled(&block, &[end]);
    let population = MasterEquation::new(contacts(), &Initial::default()).unwrap().population().unwrap();
    let mut simulation = block.simulation(Box::new(population)).unwrap();
    let (mut events, mut drive) = (Vec::new(), simulation.drive());
    while drive < end {
        drive = (drive + 0.05).min(end);
        simulation.run(drive, &mut |event| events.push(*event)).unwrap();
    }
    assert_eq!(events.len(), whole.events.len());
    for (a, b) in events.iter().zip(&whole.events) {
        near(a.before.drive, b.before.drive, CLOSE);
        near(a.after.position, b.after.position, CLOSE);
    }
    let (a, b) = (simulation.energy().unwrap(), whole.energy);
    for (a, b) in [(a.work, b.work), (a.background, b.background), (a.spring, b.spring), (a.imbalance(), 0.0)]
    {
        near(a, b, CLOSE);
    }
}

fn ageing() -> Contacts {
    let mut contacts = contacts();
    contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    contacts
}

/// A block in time, at a velocity over a distance, then held for a while.
fn followed(slip: Slip, background: f64, velocity: f64, tolerance: f64) -> asperity::block::Slide {
    let transport = Transport::new_with(ageing(), &Initial::default(), tolerance, &mut ()).unwrap();
    let pieces = [(velocity, 4.0 / velocity), (0.0, 10.0), (velocity, 2.0 / velocity)];
    let pieces = pieces.map(|(velocity, duration)| Piece { velocity, duration });
    let history = History::new(pieces.to_vec()).unwrap();
    let times: Vec<f64> = (0..=60).map(|i| history.duration() * f64::from(i) / 60.0).collect();
    slider(Loading::Spring(SOFT), slip, background)
        .follow_with(&transport, &history, &times, tolerance, &mut ())
        .unwrap()
}

/// A damped slider does not overshoot, so that everything is shifted.
#[test]
fn a_block_in_time_is_shifted() {
    let tolerance = 1e-4;
    let [bare, loaded] =
        [0.0, BACKGROUND].map(|b| followed(Slip::Damped { damping: 1.0 }, b, 0.1, tolerance));
    assert_eq!(bare.slips.len(), loaded.slips.len());
    assert_eq!(bare.trace.len(), loaded.trace.len());
    for (a, b) in bare.trace.iter().zip(&loaded.trace) {
        assert_eq!((b.drive, b.position), (a.drive, a.position));
        near(b.force, a.force + BACKGROUND, CLOSE);
    }
    // The work is BACKGROUND times the advance larger; both balances close to the tolerance.
    near(loaded.energy.background, BACKGROUND * (loaded.trace.last().unwrap().position), 10.0 * tolerance);
    near(loaded.energy.imbalance(), 0.0, 20.0 * tolerance);
}

/// With inertia: held at the first rest by a large background force, so that the drop is larger by what the slider would have
/// moved back times the stiffness.
#[test]
fn a_block_in_time_is_held_after_a_slip() {
    let tolerance = 1e-4;
    let slip = Slip::Inertial { mass: 1.0, damping: 0.05 };
    let [bare, small, loaded] = [0.0, 0.05, BACKGROUND].map(|b| followed(slip, b, 0.01, tolerance));
    let (a, s, b) = (&bare.slips[0], &small.slips[0], &loaded.slips[0]);
    near(a.position_turn, b.position_turn, 20.0 * tolerance);
    assert!(a.after.position < a.position_turn - 0.05);
    assert_eq!(b.after.position, b.position_turn);
    near(b.after.spring_force, b.after.force, tolerance);
    // A small one shortens the way back by 2B/(K + k).
    let shorter = (a.position_turn - a.after.position) - (s.position_turn - s.after.position);
    near(shorter, 2.0 * 0.05 / (SOFT + 1.0), 20.0 * tolerance);
    for run in [&bare, &small, &loaded] {
        // The error of the energies is of the order of that of the positions, times forces of BACKGROUND.
        near(run.energy.imbalance(), 0.0, 100.0 * tolerance);
    }
}

/// Slips end in balance: the drop is that of the spring, K times the slip, whatever the background force and however often the
/// motion is observed.
#[test]
fn drops_in_time_are_those_of_the_spring() {
    let slip = Slip::Inertial { mass: 1.0, damping: 0.1 };
    let (velocity, stiffness, tolerance) = (1e-5, 0.1, 1e-4);
    let transport = Transport::new_with(contacts(), &Initial::default(), tolerance, &mut ()).unwrap();
    let history = History::new(vec![Piece { velocity, duration: 20.0 / velocity }]).unwrap();
    for (background, points) in [(0.0, 10), (0.1, 10), (0.3, 10), (0.3, 300), (1.0, 30)] {
        let times: Vec<f64> =
            (0..=points).map(|i| history.duration() * f64::from(i) / f64::from(points)).collect();
        let slide = slider(Loading::Spring(stiffness), slip, background)
            .follow_with(&transport, &history, &times, tolerance, &mut ())
            .unwrap();
        assert!(slide.slips.len() > 1);
        for slip in &slide.slips {
            near(slip.after.force, slip.after.spring_force, 10.0 * tolerance);
            // A slip begins at ten times the velocity of the drive, where inertia and damping carry next to nothing, and the drive
            // moves by some 1e-4 in it: 1e-3 is less than one per cent of the drop.
            near(slip.drop(), stiffness * slip.slip(), 1e-3);
        }
    }
}

#[test]
fn a_slider_that_turns_below_its_background_force_does_not_run_away() {
    // It turns at drives below B, from which it slides back only at 0.4 − B: the contacts carry at most 0.6 of their 0.796.
    let run = pulled(&slider(Loading::Force, Slip::Reset, 1.0), &[1.6, 0.0, 0.3, -1.6]);
    let last = run.trace[run.trace.len() - 1];
    assert!(!matches!(run.regime, Regime::Runaway), "{}", run.regime);
    near(last.drive, -1.6, 1e-12);
    near(last.force, -1.6, CLOSE);
}

#[test]
fn wrong_forces_are_refused() {
    for force in [-1.0, f64::NAN, f64::INFINITY] {
        let error =
            Block::new(Loading::Rigid, Slip::Reset, None).unwrap().with_background(force).unwrap_err();
        assert!(error.to_string().starts_with("background: expected a finite number, 0 or above"), "{error}");
    }
}
