//! Creep in balance as the drive rises, up to where balance is lost.
//!
//! This is numerical continuation by predictor and corrector (E. L. Allgower and K. Georg, *Introduction to Numerical
//! Continuation Methods*, SIAM 2003, doi:10.1137/1.9780898719154), with the drive as its parameter: advances are predicted
//! from the present balance and corrected by Newton's method. A stride is made only if every balance on the way is stable,
//! so that creep follows the one path of balances and cannot jump over a fold.

use serde::{Deserialize, Serialize};

use super::batch::fill;
use super::configuration::{Advances, Configuration};
use super::fold_prediction::FoldPrediction;
use super::residual::InterfaceModel;
use crate::Result;
use crate::monitor::Monitor;

/// Newton steps after which a stride was too long.
const MOST_STEPS: usize = 30;

/// Residual that a Newton step leaves where there is a balance, relative to the one before; right at a fold it is a quarter.
const CONVERGING: f64 = 0.3;

/// A residual that no longer decreases may be larger than expected of rounding by this factor.
pub(super) const STALLED: f64 = 10.0;

/// The first stride, in tolerances of the drive.
const FIRST: f64 = 1e3;

/// Safety margin of a stride towards the predicted fold, relative to its distance: so many uncertainties, at least LEAVE.
const CAREFUL: f64 = 4.0;
const LEAVE: f64 = 0.01;

/// Uncertainty above which the fold is unlikely to exist: fast cells will slow down again, and a stride may go beyond the
/// predicted fold by the factor BOLD.
const UNLIKELY: f64 = 0.02;
const BOLD: f64 = 2.0;

/// Shortest stride, in units in the last place of the drive.
const ROUNDINGS: f64 = 8.0;

/// Length of the strides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct CreepPace {
    stride: f64,
    tolerance: f64,
}

/// Result of a stride.
pub(super) enum Stride {
    /// Drive and cells have moved in balance.
    Balanced,
    /// Nothing has moved: balance is lost before this drive, by less than the tolerance.
    Lost(f64),
}

impl CreepPace {
    /// Strides that find the loss of balance to `tolerance`.
    pub fn new(tolerance: f64) -> Self {
        Self { stride: FIRST * tolerance, tolerance }
    }

    /// The shortest stride from a drive.
    fn least(&self, drive: f64) -> f64 {
        self.tolerance.max(ROUNDINGS * f64::EPSILON * drive.abs())
    }

    /// The next stride from a drive.
    fn next(&self, drive: f64, ahead: &FoldPrediction) -> f64 {
        let unlikely = ahead.uncertainty > UNLIKELY;
        let part = if unlikely { BOLD } else { 1.0 - (CAREFUL * ahead.uncertainty).max(LEAVE) };
        self.stride.min(part * ahead.fold).min(ahead.limit).max(self.least(drive))
    }

    fn succeeded(&mut self, stride: f64) {
        self.stride = self.stride.max(2.0 * stride);
    }

    fn failed(&mut self, stride: f64) {
        self.stride = 0.5 * stride;
    }
}

impl InterfaceModel {
    /// Makes a stride in balance towards `end`. Where the monitor stops it nothing has moved.
    pub fn creep(
        &mut self,
        configuration: &mut Configuration,
        pace: &mut CreepPace,
        end: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Stride> {
        let from = configuration.drive;
        let least = pace.least(from);
        let Some(ahead) = self.predict_fold(configuration, monitor)? else {
            return Ok(Stride::Lost(end.min(from + least)));
        };
        loop {
            // The prediction may be wrong, as where another cell becomes the unstable one. Each
            // stride is checked by the corrector and the stability test, and halved until both
            // succeed or it is as short as the tolerance.
            let stride = pace.next(from, &ahead);
            let to = end.min(from + stride);
            if let Some(advances) = self.balance_at(to, configuration, &ahead, monitor)? {
                self.cells.advance(&advances.by, monitor)?;
                configuration.drive = to;
                configuration.advance(&advances);
                pace.succeeded(to - from);
                return Ok(Stride::Balanced);
            }
            if stride <= least {
                return Ok(Stride::Lost(to));
            }
            pace.failed(stride.min(end - from));
        }
    }

    /// Advances to the balance at a drive, by Newton's method from the prediction; none if there is no single path of stable
    /// balances to it.
    fn balance_at(
        &mut self,
        drive: f64,
        configuration: &Configuration,
        ahead: &FoldPrediction,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Advances>> {
        let distance = drive - configuration.drive;
        let elastic = self.elastic_forces(configuration.displacements(), monitor)?;
        let mut by = vec![0.0; self.len()];
        fill(&mut by, |j| ahead.advance(j, distance));
        let mut advances = configuration.correctable(by);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let residual = self.residual_after(configuration, drive, &advances, &elastic, monitor)?;
            let (largest, tolerance) = (residual.largest, self.creep_tolerance(configuration, drive));
            if largest <= tolerance || (largest <= STALLED * tolerance && largest > 0.5 * before) {
                drop((elastic, residual));
                return Ok(self.is_stable_ahead(&advances, monitor)?.then_some(advances));
            }
            // Slower than at a fold: there is no balance at this drive, or the prediction was too
            // far from it.
            if largest > CONVERGING * before {
                return Ok(None);
            }
            let Some(correction) = self.newton_correction(residual, tolerance, monitor)? else {
                return Ok(None);
            };
            advances.correct(&correction);
            before = largest;
        }
        Ok(None)
    }
}
