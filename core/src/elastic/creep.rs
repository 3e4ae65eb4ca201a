//! Creep in balance as the drive rises, up to where balance is lost.

use serde::{Deserialize, Serialize};

use super::Interface;
use super::slide::STALLED;
use crate::Result;

/// Steps after which a stride was too long.
const MOST_STEPS: usize = 30;

/// What Newton's step leaves of the excess force where there is a balance; right at a fold it is a quarter.
const CONVERGING: f64 = 0.3;

/// The first stride, in tolerances of the drive.
const FIRST: f64 = 1e3;

/// How much of the way to where balance will be lost a stride goes.
const CAREFUL: f64 = 0.9;

/// Roundings of a drive within which no other is found.
const ROUNDINGS: f64 = 8.0;

/// The first stride after a slide, of the longest before it.
const AGAIN: f64 = 0.25;

/// How far the drive goes at a time.
///
/// Where balance is lost, at a fold of the states in balance, speeds dX/dX_T grow as 1/√(X_c − X_T): from two of them
/// X_c is known ahead.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Pace {
    stride: f64,
    least: f64,
    /// The longest stride since the last slide.
    longest: f64,
    /// Where the last stride began, and 1/speed² there.
    before: Option<(f64, f64)>,
    /// A drive at which balance is lost.
    lost: Option<f64>,
}

impl Pace {
    /// Where balance is lost is to be known to `tolerance`.
    pub fn new(tolerance: f64) -> Self {
        let stride = FIRST * tolerance;
        Self { stride, least: tolerance, longest: stride, before: None, lost: None }
    }

    /// The end of the next stride.
    fn aim(&self, drive: f64, end: f64) -> f64 {
        (drive + self.stride).min(end).min(self.lost.unwrap_or(f64::INFINITY))
    }

    /// A stride was made in balance, at a largest speed dX/dX_T where it began.
    fn made(&mut self, from: f64, to: f64, speed: f64) {
        let (now, made) = (speed.powi(-2), to - from);
        let mut stride = 2.0 * made;
        self.longest = self.longest.max(made);
        let fold = self.before.filter(|(_, before)| now < *before);
        if let Some((before, then)) = fold {
            let end = from + now * (from - before) / (then - now);
            stride = stride.min((CAREFUL * (end - to)).max(0.25 * made));
        }
        if let Some(lost) = self.lost {
            stride = stride.min(if fold.is_some() { lost - to } else { 0.5 * (lost - to) });
        }
        self.before = Some((from, now));
        self.stride = stride.max(0.5 * self.least);
    }

    /// A stride lost balance.
    fn failed(&mut self, from: f64, to: f64) {
        self.lost = Some(to);
        self.stride = (0.5 * (to - from)).max(0.5 * self.least);
    }

    /// There was a slide.
    pub fn renew(&mut self) {
        let stride = (AGAIN * self.longest).max(self.least);
        *self = Self { stride, longest: stride, before: None, lost: None, ..*self };
    }
}

impl Interface {
    /// Makes a stride in balance towards `end`, or tries to. Where balance is known to be lost within the tolerance the
    /// drive alone goes there: whether it is.
    pub(super) fn creep(&mut self, end: f64) -> Result<bool> {
        let (from, to) = (self.drive, self.pace.aim(self.drive, end));
        if self.pace.lost == Some(to) && to - from <= self.pace.least.max(ROUNDINGS * f64::EPSILON * to.abs())
        {
            self.lose(to);
            return Ok(true);
        }
        match self.attempt(to)? {
            Some(speed) => {
                self.commit(&mut ())?;
                self.pace.made(from, to, speed);
            }
            None => {
                self.by.fill(0.0);
                self.drive = from;
                self.pace.failed(from, to);
            }
        }
        Ok(false)
    }

    /// Tries to go to a drive in balance, by Newton's method, and where that fails by steps that pass no balance; the largest
    /// speed dX/dX_T at the beginning if there is one way to do so.
    fn attempt(&mut self, to: f64) -> Result<Option<f64>> {
        let distance = to - self.drive;
        self.drive = to;
        let (mut speed, mut before, mut bounded) = (0.0, f64::INFINITY, false);
        let mut forces = Vec::new();
        for _ in 0..MOST_STEPS {
            let excess = self.excess_ahead()?;
            if forces.is_empty() {
                forces.extend(self.responses.iter().map(|response| response.force));
            }
            if excess <= self.precision() || (excess <= STALLED * self.precision() && excess > 0.5 * before) {
                return Ok(self.is_stable_ahead(&forces, distance)?.then_some(speed));
            }
            if excess > CONVERGING * before && !bounded {
                (bounded, before) = (true, f64::INFINITY);
                self.by.fill(0.0);
                continue;
            }
            before = excess;
            if bounded {
                if !self.step(0.0)?.stable {
                    return Ok(None);
                }
                continue;
            }
            let Some(largest) = self.newton()? else { return Ok(None) };
            speed = f64::max(speed, largest / distance);
        }
        Ok(None)
    }

    /// Moves the drive to where balance is lost.
    fn lose(&mut self, drive: f64) {
        self.enter_creep();
        self.pace.lost = None;
        let from = std::mem::replace(&mut self.drive, drive);
        self.enter_drive(from);
    }
}
