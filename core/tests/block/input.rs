//! What the block refuses, and how it is watched.

use std::ops::ControlFlow;

use crate::common::curve;
use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::monitor::Monitor;

#[track_caller]
fn refused<T: std::fmt::Debug>(result: Result<T, Error>, key: &str, word: &str) {
    let Err(Error::Invalid { key: found, expected, .. }) = result else { panic!("{result:?}") };
    assert_eq!(found, key);
    assert!(expected.contains(word), "{expected}");
}

#[test]
fn blocks_that_make_no_sense_are_refused() {
    let block = |loading, slip, fraction| Block::new(loading, slip, fraction);
    for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(block(Loading::Spring(stiffness), Slip::Reset, None), "stiffness", "above 0");
    }
    let inertial = |mass, damping| block(Loading::Spring(4.0), Slip::Inertial { mass, damping }, None);
    refused(inertial(0.0, 0.0), "slip.inertial.mass", "above 0");
    refused(inertial(f64::NAN, 0.0), "slip.inertial.mass", "above 0");
    refused(inertial(1.0, -1.0), "slip.inertial.damping", "0 or above");
    // 10³ √(0.25 × 4).
    refused(inertial(0.25, 1001.0), "slip.inertial.damping", "= 1000.000000");
    inertial(0.25, 1000.0).unwrap();
    for damping in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(block(Loading::Rigid, Slip::Damped { damping }, None), "slip.damped.damping", "above 0");
    }
    for fraction in [0.0, 1.1, f64::NAN] {
        refused(block(Loading::Spring(1.0), Slip::Reset, Some(fraction)), "slip_fraction", "up to 1");
    }
}

#[test]
fn drives_that_do_not_turn_are_refused() {
    let pull = |turning_points: &[f64], points: usize| {
        let block = Block::new(Loading::Spring(1.0), Slip::Overdamped, None).unwrap();
        let drive = Drive { turning_points: turning_points.to_vec(), points };
        block.pull(&mut curve::gaussian(0.1), &drive)
    };
    refused(pull(&[], 2), "turning_points", "finite");
    refused(pull(&[1.0, 2.0], 2), "turning_points", "other side");
    refused(pull(&[1.0, 0.5, 0.2], 2), "turning_points", "other side");
    refused(pull(&[1.0, 1.0], 2), "turning_points", "other side");
    refused(pull(&[f64::NAN], 2), "turning_points", "finite");
    refused(pull(&[1.0], 1), "points", "2");
    let heavy = Block::new(Loading::Force, Slip::Inertial { mass: 1.0, damping: 2e3 }, None).unwrap();
    let drive = Drive { turning_points: vec![1.0], points: 2 };
    refused(heavy.pull(&mut curve::gaussian(0.1), &drive), "slip.inertial.damping", "1000");
}

/// Stops at a share of the work.
struct Impatient {
    patience: f64,
    heard: Vec<f64>,
}

impl Monitor for Impatient {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.heard.push(fraction);
        if fraction >= self.patience { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_monitor_hears_how_far_the_drive_is_and_stops_it() {
    let block = Block::new(Loading::Spring(1.0), Slip::Overdamped, None).unwrap();
    let drive = Drive { turning_points: vec![200.0, 150.0, 220.0], points: 10 };
    let run = |patience: f64| {
        let mut monitor = Impatient { patience, heard: Vec::new() };
        let result = block.pull_with(&mut curve::gaussian(0.1), &drive, &mut monitor);
        (result, monitor.heard)
    };
    let (result, heard) = run(2.0);
    result.unwrap();
    assert!(heard.len() > 3 && heard.is_sorted() && heard.last() == Some(&1.0), "{heard:?}");
    let (result, heard) = run(0.3);
    assert_eq!(result.err(), Some(Error::Stopped));
    assert!(*heard.last().unwrap() < 0.9, "{heard:?}");
}
