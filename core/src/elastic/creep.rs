//! Creep in balance as the drive rises, up to where balance is lost.

use serde::{Deserialize, Serialize};

use super::Interface;
use super::batch::fill;
use super::differences::Differences;
use super::fold_prediction::FoldPrediction;
use super::slide::STALLED;
use crate::Result;

/// Steps after which a stride was too long.
const MOST_STEPS: usize = 30;

/// What Newton's step leaves of the excess force where there is a balance; right at a fold it is a quarter.
const CONVERGING: f64 = 0.3;

/// The first stride, in tolerances of the drive.
const FIRST: f64 = 1e3;

/// What a stride leaves of the way to where balance will be lost: so much of the doubt about it, and no less than that.
const CAREFUL: f64 = 4.0;
const LEAVE: f64 = 0.01;

/// Doubt above which balance will hardly be lost: cells that hurry recover, and a stride may pass where they seemed to go,
/// by so much.
const DOUBTED: f64 = 0.02;
const BOLD: f64 = 2.0;

/// Roundings of a drive within which no other is found.
const ROUNDINGS: f64 = 8.0;

/// How far the drive goes at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct CreepPace {
    stride: f64,
    tolerance: f64,
}

impl CreepPace {
    /// Where balance is lost is to be known to `tolerance`.
    pub fn new(tolerance: f64) -> Self {
        Self { stride: FIRST * tolerance, tolerance }
    }

    /// The least stride from a drive.
    fn least(&self, drive: f64) -> f64 {
        self.tolerance.max(ROUNDINGS * f64::EPSILON * drive.abs())
    }

    /// The next stride from a drive.
    fn next(&self, drive: f64, outlook: &FoldPrediction) -> f64 {
        let part = if outlook.doubt > DOUBTED { BOLD } else { 1.0 - (CAREFUL * outlook.doubt).max(LEAVE) };
        self.stride.min(part * outlook.fold).min(outlook.limit).max(self.least(drive))
    }

    /// A stride was made in balance.
    fn made(&mut self, stride: f64) {
        self.stride = self.stride.max(2.0 * stride);
    }

    /// A stride lost balance.
    fn failed(&mut self, stride: f64) {
        self.stride = 0.5 * stride;
    }
}

impl Interface {
    /// Makes a stride in balance towards `end`. Where balance is lost within the tolerance the drive alone goes there:
    /// whether it is.
    pub(super) fn creep(&mut self, end: f64) -> Result<bool> {
        let from = self.drive;
        let least = self.pace.least(from);
        let Some(outlook) = self.outlook()? else {
            self.lose(end.min(from + least));
            return Ok(true);
        };
        loop {
            let stride = self.pace.next(from, &outlook);
            let to = end.min(from + stride);
            if self.attempt(to, &outlook)? {
                self.commit(&mut ())?;
                self.pace.made(to - from);
                return Ok(false);
            }
            self.stand();
            self.drive = from;
            if stride <= least {
                self.lose(to);
                return Ok(true);
            }
            self.pace.failed(stride.min(end - from));
        }
    }

    /// Tries to go to a drive in balance, from what is ahead by Newton's method; whether there is one way to do so.
    fn attempt(&mut self, to: f64, outlook: &FoldPrediction) -> Result<bool> {
        let distance = to - self.drive;
        let mut held = vec![0.0; self.len()];
        self.coupling.forces(Differences::now(self.differences.as_ref(), &self.positions), &mut held);
        self.drive = to;
        fill(&mut self.by, |j| outlook.way(j, distance));
        if let Some(differences) = &mut self.differences {
            differences.aim(&self.by);
        }
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let excess = self.excess_ahead(&held)?;
            let calm = self.calm();
            if excess <= calm || (excess <= STALLED * calm && excess > 0.5 * before) {
                drop(held);
                return self.is_stable_ahead();
            }
            if excess > CONVERGING * before || !self.newton(excess) {
                return Ok(false);
            }
            before = excess;
        }
        Ok(false)
    }

    /// Moves the drive alone to where balance is lost.
    fn lose(&mut self, drive: f64) {
        self.enter_creep();
        let from = std::mem::replace(&mut self.drive, drive);
        self.enter_drive(from);
    }
}
