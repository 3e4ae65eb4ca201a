//! Errors that are estimated in time are above those that are made, at every tolerance.

use crate::common::ways::{Kind, kinds};
use crate::common::{contacts, gaussian, initial, point};
use asperity::block::{Block, CreepAccuracy, CreepLoad, Loading, Slide, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{RateDependentInterface, RateDependentInterfaceParameters};
use asperity::history::{History, Piece};
use asperity::master::{Transport, as_required};
use asperity::rate_dependent::{ROUGH, RateDependentContacts};
use asperity::shape::{Edges, Shape};
use asperity::{Error, Float, Result};

/// From the largest one to one that is reached by a refusal of a larger one.
const TOLERANCES: [f64; 5] = [1e-2, 2e-3, 5e-4, 1e-4, 1e-5];

/// Diffusing thresholds are of the same code but for their grid, and take a hundred times as long.
fn quick_kinds() -> impl Iterator<Item = Kind> {
    kinds().into_iter().filter(|kind| kind.name != "smoluchowski")
}

fn transport(contacts: &Contacts, tolerance: f64) -> Transport {
    Transport::new_with(contacts.clone(), &initial(&point(0.0)), tolerance, &mut ()).unwrap()
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

fn times(history: &History, count: u32) -> Vec<f64> {
    (1..=count).map(|k| f64::from(k) / f64::from(count) * history.duration()).collect()
}

/// Where a slip makes F fall by its size within a few steps, F at a time is no better than the reference states.
#[test]
fn of_a_rigid_slider() {
    for kind in quick_kinds() {
        for (way, history) in kind.ways() {
            let times = times(&history, 97);
            let follow = |tolerance| transport(&kind.contacts, tolerance).follow(&history, &times).unwrap();
            let best = follow(1e-6);
            for tolerance in TOLERANCES {
                let found = follow(tolerance);
                let off = largest_difference(&found.force, &best.force);
                let stated = found.error;
                assert!(
                    off <= stated + best.error,
                    "{}, {way}, {tolerance:e}: {off:e}, said {stated:e}",
                    kind.name
                );
            }
        }
    }
}

/// The path of a block, with the errors of all its steps: slip, hold and further slip.
#[test]
fn of_a_block() {
    let slips = [(0.2, Slip::Damped { damping: 0.1 }), (0.2, Slip::Inertial { mass: 1.0, damping: 0.1 })];
    // The other barriers differ from this one by a function of the threshold.
    let barriers = ["bell barrier", "catastrophe barrier"];
    // A slider without a mass and one with it take turns.
    let kinds = quick_kinds().filter(|kind| !barriers.contains(&kind.name)).zip(slips.into_iter().cycle());
    for (kind, (stiffness, slip)) in kinds {
        let drive = slide_hold_slide(&kind, 3.0);
        let times = times(&drive, 60);
        let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
        let forces = |slide: &Slide| -> Vec<f64> {
            let at = |time: &f64| slide.trace.iter().find(|moment| moment.time >= *time).unwrap().force;
            times.iter().map(at).collect()
        };
        let moved = |tolerance: f64, step: f64| {
            let contacts = transport(&kind.contacts, tolerance);
            forces(&block.follow_with(&contacts, &drive, &times, step, &mut ()).unwrap())
        };
        // The tolerance of its steps is an eleventh of that for 5e-4. Errors go with its power 2/3: a fifth is left.
        let best = moved(1e-4, Block::step_for(1e-4));
        // What the page of the theory says of the default; forces are fractions of the unit, 1 or ½.
        let usual = moved(Block::TOLERANCE_IN_TIME, Block::TOLERANCE_IN_TIME);
        let off = largest_difference(&usual, &best);
        assert!((1e-4..2e-2).contains(&off), "{}, {slip:?}: {off:e}", kind.name);
        let mut before = f64::INFINITY;
        for tolerance in [1e-2, 5e-4] {
            let (contacts, step) = (transport(&kind.contacts, tolerance), Block::step_for(tolerance));
            let slide = block.follow_with_error(&contacts, &drive, &times, step, &mut ()).unwrap();
            let (off, stated) = (largest_difference(&forces(&slide), &best), slide.error.unwrap());
            assert!(off <= stated, "{}, {slip:?}, {tolerance:e}: {off:e}, said {stated:e}", kind.name);
            assert!(stated < before, "{}: {stated:e} {before:e}", kind.name);
            before = stated;
        }
    }
}

/// Moved by three lengths at the velocity of the kind, held, and moved on `faster`.
fn slide_hold_slide(kind: &Kind, faster: f64) -> History {
    let velocity = kind.ways()[0].1.pieces()[0].velocity;
    let piece = |(factor, part): (f64, f64)| Piece { velocity: factor * velocity, duration: part / velocity };
    History::new([(1.0, 3.0), (0.0, 1.0), (faster, 1.0)].map(piece).to_vec()).unwrap()
}

/// Cells that slip one after the other, at the same drives.
#[test]
fn of_an_interface() {
    let couple = || neighbours(Shape::Chain(3), Edges::Open, 1.0).unwrap();
    let built = |step: f64| {
        let cell = |mean: f64| -> Box<dyn RateDependentContacts> {
            let strengthening = crate::common::ways::ageing(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
            Box::new(transport(&crate::common::ways::contacts(gaussian(mean, 0.1), strengthening), 1e-4))
        };
        let cells = [0.9, 1.0, 1.1].map(cell).into_iter().collect();
        let parameters = RateDependentInterfaceParameters::new(0.1, 1.0, step);
        RateDependentInterface::new(cells, couple(), parameters).unwrap()
    };
    let forces = |mut interface: RateDependentInterface| -> (Vec<f64>, usize) {
        let (from, mut events) = (interface.drive(), 0);
        let mut forces = Vec::new();
        for k in 1..=30 {
            interface.run(from + 0.5 * f64::from(k), 1e-3, &mut |_, _| events += 1).unwrap();
            forces.extend(interface.forces());
        }
        (forces, events)
    };
    // A tenth of the next tolerance leaves a fifth of its error.
    let best = forces(built(1e-6));
    assert!(best.1 >= 2, "{}", best.1);
    for step in [1e-4, 1e-5] {
        let fine = built(step);
        let rough = forces(fine.rough(couple(), &mut ()).unwrap().unwrap());
        let fine = forces(fine);
        let (off, stated) = (largest_difference(&fine.0, &best.0), largest_difference(&fine.0, &rough.0));
        assert!(off <= stated, "{step:e}: {off:e}, said {stated:e}");
    }
}

/// The time to failure under a constant force.
#[test]
fn of_creep() {
    let temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.03, 1.0) });
    let warm = Contacts {
        rules: Rules { temperature, ..Rules::default() },
        ..contacts(&gaussian(1.0, 0.1), &point(0.0))
    };
    let follow = |contacts: &dyn RateDependentContacts, tolerance: f64| {
        let load = CreepLoad { force: 0.7, rate: 1e9, duration: 1e3 };
        load.follow(contacts, CreepAccuracy { unit: 1.0, tolerance }, &mut ()).unwrap()
    };
    let best = follow(&transport(&warm, 1e-6), 1e-6);
    assert!(best.failure_time().is_some());
    for tolerance in [1e-4, 1e-5] {
        let contacts = transport(&warm, tolerance);
        let step = tolerance.min(CreepAccuracy::LARGEST_TOLERANCE);
        let fine = follow(&contacts, step);
        let rough = follow(contacts.rough().unwrap().as_ref(), ROUGH * step);
        let (off, stated) = (fine.difference(&best, 1.0), fine.difference(&rough, 1.0));
        assert!(off <= stated, "{tolerance:e}: {off:e}, said {stated:e}");
    }
}

/// A method whose error is the square root of the tolerance.
fn of_half_order(tolerance: f64, required: f64) -> (f64, f64) {
    (tolerance, tolerance.sqrt() / required)
}

#[test]
fn smaller_tolerances_are_tried_until_the_error_is_as_required() {
    let mut tried = Vec::new();
    let solve = |tolerance: f64, required: f64, tried: &mut Vec<f64>| {
        tried.push(tolerance);
        Ok(of_half_order(tolerance, required))
    };
    let (found, excess) = as_required(1e-4, true, &mut (), |t, _| solve(t, 1e-4, &mut tried)).unwrap();
    // The error is 1e-4 at the tolerance of 1e-8.
    assert!(excess <= 1.0 && found == *tried.last().unwrap() && found <= 1e-8);
    assert!(tried.len() == 4 && tried.is_sorted_by(|one, next| one > next), "{tried:?}");
    // Without a requirement the first one is the last one.
    tried.clear();
    as_required(1e-4, false, &mut (), |t, _| solve(t, f64::INFINITY, &mut tried)).unwrap();
    assert_eq!(tried, [1e-4]);
    // What is never reached ends with the best one after four attempts.
    tried.clear();
    let (found, excess) = as_required(1e-4, true, &mut (), |t, _| solve(t, 1e-9, &mut tried)).unwrap();
    assert!(excess > 1.0 && tried.len() <= 4 && found == *tried.last().unwrap(), "{tried:?}");
}

#[test]
fn a_smaller_tolerance_that_is_too_small_leaves_the_result_before() {
    let too_short = |tolerance: f64| Error::StepTooShort {
        what: "a slider".to_owned(),
        time: Float(1.0),
        tolerance: Float(tolerance),
    };
    // A method that gives up below 1e-5.
    let solve = |tolerance: f64| -> Result<(f64, f64)> {
        if tolerance < 1e-5 { Err(too_short(tolerance)) } else { Ok((tolerance, 2.0)) }
    };
    assert_eq!(as_required(1e-4, true, &mut (), |t, _| solve(t)), Ok((1e-4, 2.0)));
    assert_eq!(as_required(1e-6, true, &mut (), |t, _| solve(t)), Err(too_short(1e-6)));
    let text = too_short(1e-6).to_string();
    assert_eq!(text, "a slider: steps that meet the tolerance of 1e-6 became too short to go on from t = 1");
}

/// The rest of a hold that steps have left by rounding is no step that is too short.
#[test]
fn a_hold_ends_where_rounding_leaves_it() {
    let kind = quick_kinds().find(|kind| kind.name == "frozen_rank").unwrap();
    let block = Block::new(Loading::Spring(0.2), Slip::Damped { damping: 0.1 }, None).unwrap();
    let drive = slide_hold_slide(&kind, 3.0);
    for tolerance in [1e-5, 1e-6] {
        let contacts = transport(&kind.contacts, 1e-5);
        let slide = block.follow_with(&contacts, &drive, &times(&drive, 60), tolerance, &mut ()).unwrap();
        assert_eq!(slide.trace.last().unwrap().time, drive.duration());
    }
}
