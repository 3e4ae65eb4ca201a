//! Short names for the tests of the block.
#![allow(dead_code)]

use asperity::block::{Block, Drive, Loading, Slip, StickSlip};
use asperity::population::Population;

pub const UNDAMPED: Slip = Slip::Inertial { mass: 1.0, damping: 0.0 };

/// What a slider does whose drive goes through the turning points.
pub fn drive(
    population: &mut dyn Population,
    loading: Loading,
    slip: Slip,
    turning_points: &[f64],
) -> StickSlip {
    let block = Block::new(loading, slip, None).unwrap();
    let drive = Drive { turning_points: turning_points.to_vec(), points: 101 };
    block.pull(population, &drive).unwrap()
}

/// The same, behind a spring.
pub fn pull(
    population: &mut dyn Population,
    stiffness: f64,
    slip: Slip,
    turning_points: &[f64],
) -> StickSlip {
    drive(population, Loading::Spring(stiffness), slip, turning_points)
}

#[track_caller]
pub fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}: {:e}", found - expected);
}
