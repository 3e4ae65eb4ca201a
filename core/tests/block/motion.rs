//! A slider in time that is moved step by step: it moves as along a history, whatever is looked at, kept or stopped on the way.

use crate::common::pulled::near;
use crate::common::sliders::Impatient;
use crate::common::{contacts, gaussian, initial, point};
use asperity::Error;
use asperity::block::{Block, BlockMotion, BlockMotionState, Loading, RateDependentSlip, Slip};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::Transport;
use asperity::rate_dependent::RateDependentContacts;

/// Runs are compared bit for bit, at whatever tolerance.
const TOLERANCE: f64 = 1e-3;
const VELOCITY: f64 = 0.1;

/// Contacts that strengthen with age, under a spring so soft that they stick and slip.
fn ageing() -> Contacts {
    let ageing = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    let rules = Rules { ageing, ..Rules::default() };
    Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) }
}

fn block(slip: Slip) -> Block {
    Block::new(Loading::Spring(0.5), slip, Some(0.05)).unwrap()
}

const DAMPED: Slip = Slip::Damped { damping: 0.01 };
const INERTIAL: Slip = Slip::Inertial { mass: 1e-3, damping: 1e-3 };

/// Cohorts, and contacts one by one.
fn moved() -> [Box<dyn RateDependentContacts>; 2] {
    let rest = initial(&point(0.0));
    let ensemble = Ensemble::new(ageing(), rest.clone(), 500, 3, Disorder::Annealed).unwrap();
    [Box::new(Transport::new(ageing(), &rest).unwrap()), Box::new(ensemble.in_time().unwrap())]
}

fn slips(slider: &mut BlockMotion, drive: f64) -> Vec<RateDependentSlip> {
    std::iter::from_fn(|| slider.next(drive, VELOCITY).unwrap()).collect()
}

/// As bytes and back.
fn kept(slider: &BlockMotion) -> BlockMotionState {
    let mut bytes = Vec::new();
    ciborium::into_writer(&slider.state(), &mut bytes).unwrap();
    ciborium::from_reader(bytes.as_slice()).unwrap()
}

#[test]
fn it_moves_as_along_a_history() {
    for slip in [DAMPED, INERTIAL] {
        for contacts in moved() {
            let pieces = [(VELOCITY, 40.0), (0.0, 30.0), (0.5, 6.0)];
            let history =
                History::new(pieces.map(|(velocity, duration)| Piece { velocity, duration }).to_vec());
            let history = history.unwrap();
            let whole = block(slip)
                .follow_with(contacts.as_ref(), &history, &[history.duration()], TOLERANCE, &mut ())
                .unwrap();
            let mut slider = block(slip).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
            let mut found = slips(&mut slider, 4.0);
            found.extend(slider.hold(30.0).unwrap());
            while let Some(slip) = slider.next(7.0, 0.5).unwrap() {
                found.push(slip);
            }
            assert!(found.len() > 1, "{slip:?}");
            assert_eq!(found, whole.slips, "{slip:?}");
            assert_eq!(slider.energy(), whole.energy);
            assert_eq!(slider.moment(), *whole.trace.last().unwrap());
        }
    }
}

#[test]
fn energies_are_in_balance_at_every_stop() {
    const FINE: f64 = 1e-4;
    let [contacts, _] = moved();
    let mut slider = block(DAMPED).motion_with(contacts.as_ref(), FINE).unwrap();
    for stop in 1..=20 {
        let drive = 0.2 * f64::from(stop);
        slips(&mut slider, drive);
        assert_eq!(slider.moment().drive, drive);
        // The error of steps, tolerance times the stiffness of spring and contacts, 1.5, of hundreds of steps with both signs.
        near(slider.energy().imbalance(), 0.0, 20.0 * FINE);
        let inside: f64 = slider.stretches().iter().map(|interval| interval.fraction).sum();
        // All contacts are attached, to the accuracy of the cohorts.
        near(inside, 1.0, 1e-9);
    }
}

#[test]
fn it_continues_from_its_state_bit_for_bit() {
    for contacts in moved() {
        let mut whole = block(INERTIAL).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
        let mut other = block(INERTIAL).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
        for (drive, then) in [(0.7, 1.8), (2.2, 3.1), (3.3, 4.0)] {
            slips(&mut whole, drive);
            whole.hold(2.0).unwrap();
            let state = kept(&whole);
            assert_eq!(state, whole.state());
            other.restore(state).unwrap();
            assert_eq!(slips(&mut other, then), slips(&mut whole, then));
            assert_eq!((other.moment(), other.energy()), (whole.moment(), whole.energy()));
            assert_eq!(other.state(), whole.state());
        }
    }
}

#[test]
fn an_interruption_changes_nothing_that_follows() {
    let [contacts, _] = moved();
    let mut whole = block(DAMPED).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
    let expected = slips(&mut whole, 4.0);
    let mut slider = block(DAMPED).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
    let (mut found, mut stops) = (Vec::new(), 0);
    loop {
        match slider.next_with(4.0, VELOCITY, &mut Impatient(100 * (stops + 1))) {
            Ok(Some(slip)) => found.push(slip),
            Ok(None) => break,
            Err(error) => {
                assert!(matches!(error, Error::Stopped), "{error}");
                stops += 1;
            }
        }
    }
    assert!(stops > 3, "{stops}");
    assert_eq!(found, expected);
    assert_eq!(slider.state(), whole.state());
}

/// The step in which a slip ends is the last one before the stop, whose drive is that asked for, without rounding.
#[test]
fn a_slip_may_end_where_the_load_point_stops() {
    let [contacts, _] = moved();
    let mut ended_there = 0;
    // Drives and velocities whose quotients and products are rounded, so that the last time times the velocity is not the drive.
    for (i, velocity) in [0.1, 0.07, 0.13, 0.03].into_iter().enumerate() {
        let mut whole = block(DAMPED).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
        whole.next(4.0, velocity).unwrap().expect("the first slip");
        let end = whole.moment().drive + 1e-4 * i as f64;
        let mut slider = block(DAMPED).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
        while slider.next(end, velocity).unwrap().is_some() {
            ended_there += usize::from(slider.moment().drive == end);
        }
        assert_eq!(slider.moment().drive, end);
    }
    assert!(ended_there > 0, "no slip ended at a stop");
}

#[test]
fn wrong_motions_are_refused_and_change_nothing() {
    let [contacts, others] = moved();
    let mut slider = block(DAMPED).motion_with(contacts.as_ref(), TOLERANCE).unwrap();
    slips(&mut slider, 1.0);
    let state = slider.state();
    for (drive, velocity, key) in
        [(0.5, 1.0, "drive"), (f64::NAN, 1.0, "drive"), (2.0, 0.0, "velocity"), (2.0, f64::NAN, "velocity")]
    {
        let error = slider.next(drive, velocity).unwrap_err();
        assert!(error.to_string().starts_with(key), "{error}");
    }
    for duration in [-1.0, f64::INFINITY, f64::NAN] {
        let error = slider.hold(duration).unwrap_err();
        assert!(error.to_string().starts_with("duration"), "{error}");
    }
    let foreign = block(DAMPED).motion_with(others.as_ref(), TOLERANCE).unwrap().state();
    assert!(slider.restore(foreign).is_err());
    assert_eq!(slider.state(), state);
    let rigid = Block::new(Loading::Rigid, Slip::Reset, None).unwrap();
    let error = rigid.motion_with(contacts.as_ref(), TOLERANCE).unwrap_err();
    assert!(error.to_string().starts_with("stiffness"), "{error}");
}
