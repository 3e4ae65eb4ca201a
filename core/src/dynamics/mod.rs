//! Equation of motion of a slider over time-dependent contacts, integrated by TR-BDF2 with control of the step size.
//!
//! M Ẍ_j + η Ẋ_j = K_0j(X_T − X_j) − (AX)_j − F_j[X_j(·), t]
//!
//! Cell j is at X_j. A spring K_0j joins it to the drive X_T, which moves at a constant velocity in a step; the stiffness matrix
//! A of the slider couples the cells; F_j is the friction of its contacts. A deformable interface has many cells and M = 0. A
//! block is one cell, which may have a mass.
//!
//! A step ([`tr_bdf2`]) is implicit in friction, springs and coupling, so that it may be as long as a stick. Its two stages are
//! solved by a [`StageSolver`]: the one of [`OneCell`] is here, that of coupled cells in `elastic`. Contacts move forward only;
//! [`Arrest`] says what becomes of a cell that they would pull back.

mod arrest;
mod cell;
mod equation;
mod one_cell;
mod slip_velocity;
mod step_control;
mod tr_bdf2;

pub use arrest::Arrest;
pub use cell::SlidingCell;
pub use equation::{DriveMotion, EquationOfMotion};
pub use one_cell::OneCell;
pub use slip_velocity::{SLIP_VELOCITY, crossing};
pub use step_control::MotionStepControl;
pub use tr_bdf2::{ImplicitStage, StageSolver};

use self::tr_bdf2::TrBdf2Step;
use crate::Result;
use crate::monitor::{Monitor, Watch};
use crate::numerics::tr_bdf2::GAMMA;
use crate::rate_dependent::ErrorEstimator;

/// Cells in motion, and what has come of them so far.
#[derive(Debug)]
pub struct SliderMotion {
    pub equation: EquationOfMotion,
    pub control: MotionStepControl,
    pub cells: Vec<SlidingCell>,
    /// t, since the start.
    pub time: f64,
    /// X_T.
    pub drive: f64,
    pub energies: MotionEnergies,
    /// Estimators of the errors of the forces of cells, if that is asked for.
    pub estimators: Option<Vec<ErrorEstimator>>,
    /// The largest error of a force so far.
    pub error: f64,
}

/// Energies that came and went since the start, and that contacts do not count.
#[derive(Debug, Clone, Default)]
pub struct MotionEnergies {
    /// Work of the drive.
    pub work: f64,
    /// Lost by viscous drag, ∫ηẊ² dt of each cell.
    pub viscous: Vec<f64>,
    /// Lost in the last swing of a slider after its arrest.
    pub arrest: f64,
    /// What the unloading of a slider at rest adds to the loss in breaks that its contacts count.
    pub breaks: f64,
}

impl SliderMotion {
    /// Cells that start from rest where the drive is at `drive`; steps are right to `tolerance`, a length.
    pub fn new(equation: EquationOfMotion, cells: Vec<SlidingCell>, drive: f64, tolerance: f64) -> Self {
        let energies = MotionEnergies { viscous: vec![0.0; cells.len()], ..MotionEnergies::default() };
        let control = MotionStepControl::new(tolerance);
        Self { equation, control, cells, time: 0.0, drive, energies, estimators: None, error: 0.0 }
    }

    /// The largest error of the force of a cell so far, if that was asked for.
    pub fn error(&self) -> Option<f64> {
        self.estimators.as_ref().map(|_| self.error)
    }

    /// Makes one step of at most `left`, the drive moving at a velocity; returns how long it took.
    ///
    /// # Errors
    /// An accuracy that steps do not reach; those of the contacts; stopped by the monitor, nothing having moved then.
    pub fn step(
        &mut self,
        solver: &mut dyn StageSolver,
        velocity: f64,
        left: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let drive = DriveMotion { position: self.drive, velocity };
        let duration = if self.is_held() {
            self.rest(drive, left, monitor)?
        } else {
            self.advance(solver, drive, left, monitor)?
        };
        self.time += duration;
        self.drive = drive.after(duration);
        Ok(duration)
    }

    /// A step of TR-BDF2, as long as the control of its size allows.
    fn advance(
        &mut self,
        solver: &mut dyn StageSolver,
        drive: DriveMotion,
        left: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let mut duration = self.control.first(left);
        loop {
            self.control.check(duration, left, self.time)?;
            let tried = self.attempt(solver, drive, duration, &Watch::new(monitor))?;
            let Some(step) = tried else {
                duration *= MotionStepControl::SHRINK;
                continue;
            };
            let shorter = self.control.shorter(step.error).or_else(|| self.before_turning(&step.end));
            if let Some(factor) = shorter {
                duration *= factor;
                continue;
            }
            self.estimate(&step, duration, monitor)?;
            self.control.accept(step.error, duration, left);
            self.energies.work += step.work;
            self.energies.viscous.iter_mut().zip(&step.viscous).for_each(|(lost, more)| *lost += more);
            self.cells = step.end;
            self.arrest(drive.after(duration));
            return Ok(duration);
        }
    }

    /// Moves the estimators of errors in the same step; if the monitor stops that, nothing has moved.
    fn estimate(&mut self, step: &TrBdf2Step, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let (cells, time) = (&self.cells, GAMMA * duration);
        let Some(estimators) = &mut self.estimators else { return Ok(()) };
        let watch = &Watch::new(monitor);
        let follow = |(): &mut (), j: usize| {
            let (mut estimator, mut watch) = (estimators[j].copy(), watch);
            let ((middle, force), end) = (step.middle[j], &step.end[j]);
            let first = estimator.step(middle - cells[j].position, time, force, &mut watch)?;
            let second = estimator.step(end.position - middle, duration - time, end.force, &mut watch)?;
            Ok((estimator, first.max(second)))
        };
        let followed = watch.share(cells.len(), || (), follow)?;
        let (followed, apart): (Vec<_>, Vec<f64>) =
            followed.into_iter().collect::<Result<Vec<_>>>()?.into_iter().unzip();
        *estimators = followed;
        self.error = apart.into_iter().fold(self.error, f64::max);
        Ok(())
    }
}
