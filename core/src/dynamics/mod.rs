//! Equation of motion of a slider over time-dependent contacts, integrated by TR-BDF2 with control of the step size.
//!
//! M Ẍ_j + η Ẋ_j = K_0j(X_T − X_j) − (AX)_j − F_j[X_j(·), t]
//!
//! Cell j is at X_j. A spring K_0j connects it to the drive X_T, which moves at a constant velocity in a step. The stiffness
//! matrix A of the slider couples the cells, and F_j is the friction of the contacts. A background force only shifts forces
//! and the zero of X_T, except at rest ([`Arrest::Unload`]). A deformable interface has many cells, a block is one cell.
//!
//! Without mass and drag, M = η = 0, the forces are in balance at every time ([`EquationOfMotion::is_quasistatic`]): each stage
//! ends in balance, and the path between is straight, which again gives second order. Where no balance follows continuously,
//! the motion ends with an error.
//!
//! A step ([`tr_bdf2`]) is implicit in friction, springs and coupling, so that it may be as long as a stick phase. Its two stages
//! are solved by a [`StageSolver`]: [`OneCell`] for a block, and a solver for coupled cells in `elastic`. Time-dependent contacts
//! move forward only, and [`Arrest`] is the rule for a cell that they would pull back; cells over other contacts swing back.

mod arrest;
mod cell;
mod equation;
mod lag;
mod one_cell;
mod slip_velocity;
mod state;
mod step_control;
mod tr_bdf2;

pub use arrest::Arrest;
pub use cell::{SlidingCell, SlopeTrend};
pub use equation::{DriveMotion, EquationOfMotion};
pub use lag::ContactLag;
pub use one_cell::OneCell;
pub use slip_velocity::{SLIP_VELOCITY, crossing};
pub use state::MotionState;
pub use step_control::MotionStepControl;
pub use tr_bdf2::{ImplicitStage, StageSolver};

use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::monitor::{Cost, Monitor, Watch};
use crate::{Error, Result};

/// What errors of slip rules over time-dependent contacts expect.
pub const LIMITED_SLIP: &str = "damped or inertial where contacts are time-dependent: during a slip the velocity must be limited by a damping or a mass";

/// Cells in motion, with their energies so far.
#[derive(Debug)]
pub struct SliderMotion {
    pub equation: EquationOfMotion,
    pub control: MotionStepControl,
    pub cells: Vec<SlidingCell>,
    /// Time t since the start.
    pub time: f64,
    /// Drive X_T.
    pub drive: f64,
    pub energies: MotionEnergies,
}

/// Energies since the start that are not part of the energies of the contacts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionEnergies {
    /// Work of the drive.
    pub work: f64,
    /// Dissipated by viscous drag, ∫ηẊ² dt of each cell.
    pub viscous: Vec<f64>,
    /// Dissipated when a slider moves back after its arrest, and by cells that stand instead.
    pub arrest: f64,
    /// Dissipated by the background force, ∫B|dX|.
    pub background: f64,
    /// Correction of the energy dissipated in breaks for the unloading of a slider at rest.
    pub breaks: f64,
}

impl SliderMotion {
    /// Cells that start from rest at `drive`. The tolerance of a step is a length.
    pub fn new(equation: EquationOfMotion, cells: Vec<SlidingCell>, drive: f64, tolerance: f64) -> Self {
        let energies = MotionEnergies { viscous: vec![0.0; cells.len()], ..MotionEnergies::default() };
        let control = MotionStepControl::new(tolerance);
        Self { equation, control, cells, time: 0.0, drive, energies }
    }

    /// The velocity of the drive changes by `change`. In balance with springs alone the velocity of a cell that is connected
    /// jumps, too: until contacts break, by K_0/(K_0 + F') of it.
    pub fn change_drive_velocity(&mut self, change: f64) {
        if !self.equation.is_quasistatic() {
            return;
        }
        for (j, cell) in self.cells.iter_mut().enumerate() {
            let connection = self.equation.connection(j, cell);
            let jump = connection * change / (connection + cell.contacts.tangent());
            cell.velocity = (cell.velocity + jump).max(0.0);
        }
    }

    /// Makes one step of at most `left`, with a velocity of the drive. Returns its duration.
    ///
    /// # Errors
    /// An accuracy that steps do not reach; those of the contacts; a stop by the monitor, after which nothing has moved.
    pub fn step(
        &mut self,
        solver: &mut dyn StageSolver,
        velocity: f64,
        left: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        // What earlier steps have left by rounding is no step.
        if self.control.is_too_short(left, self.time + left) {
            return Ok(left);
        }
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

    /// One accepted step of TR-BDF2 with the size from the step-size control.
    fn advance(
        &mut self,
        solver: &mut dyn StageSolver,
        drive: DriveMotion,
        left: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let mut duration = self.control.first(left);
        let mut before = None;
        loop {
            let resolved = self.control.check(duration, left, self.time);
            resolved.map_err(|error| self.lost_balance().unwrap_or(error))?;
            // A trial step is repeated with a shorter duration until its stages converge, its error is
            // within the tolerance, and the cell does not move back.
            let tried = self.attempt(solver, drive, duration, &Watch::new(monitor))?;
            let Some(step) = tried else {
                monitor.cost(Cost::RejectedSteps, 1);
                duration *= MotionStepControl::SHRINK;
                continue;
            };
            let trial = (duration, step.error);
            let shorter = self.control.shorter(step.error).filter(|_| !self.is_jump(before, trial));
            before = Some(trial);
            let shorter = shorter.or_else(|| self.before_turning(&step.end, solver));
            if let Some(factor) = shorter {
                monitor.cost(Cost::RejectedSteps, 1);
                duration *= factor;
                continue;
            }
            // What may be stopped comes before the step is accepted: then nothing has moved.
            let mut step = step;
            settle(&mut step.end, monitor)?;
            monitor.cost(Cost::Steps, 1);
            self.control.accept(step.error.min(self.control.tolerance), duration, left);
            self.energies.work += step.work;
            self.energies.viscous.iter_mut().zip(&step.viscous).for_each(|(lost, more)| *lost += more);
            let moved: f64 =
                step.end.iter().zip(&self.cells).map(|(end, cell)| end.position - cell.position).sum();
            self.energies.background += self.equation.background * moved;
            self.energies.work += self.equation.background * drive.velocity * duration;
            self.cells = step.end;
            self.arrest(drive.after(duration));
            return Ok(duration);
        }
    }

    /// Whether the error of a trial step is that of a small jump of the positions, not of its duration: where the force of the
    /// contacts has changed by the error with which cohorts are merged, or by the break of a single contact, a balance without
    /// mass and drag follows at once, and no shorter step makes the error smaller.
    fn is_jump(&self, before: Option<(f64, f64)>, (duration, error): (f64, f64)) -> bool {
        /// The largest jump, in tolerances of a step, and in mean stretches. A slip goes on as far as contacts are stretched.
        const TOLERANCES: f64 = 100.0;
        const STRETCHES: f64 = 0.01;
        /// The error of a method of second order falls with the third power of the duration; this part of it does not.
        const KEPT: f64 = 0.9;
        let is_kept = |(longer, larger): (f64, f64)| {
            error > KEPT * larger && duration.powi(3) < KEPT.powi(2) * longer.powi(3)
        };
        if !self.equation.is_quasistatic() || !before.is_some_and(is_kept) {
            return false;
        }
        let stretch = |cell: &SlidingCell| cell.force.abs() / cell.contacts.tangent();
        let least = self.cells.iter().map(stretch).fold(f64::INFINITY, f64::min);
        error < (TOLERANCES * self.control.tolerance).min(STRETCHES * least)
    }

    /// The error of a balance that has no continuation without a finite displacement in no time; `None` with a mass or a
    /// drag, which limit the velocity.
    fn lost_balance(&self) -> Option<Error> {
        let found = format!(
            "neither, and no balance with the spring after t = {}, X = {}",
            self.time, self.cells[0].position
        );
        self.equation.is_quasistatic().then(|| Error::invalid("slip", LIMITED_SLIP, found))
    }
}

/// Simplifies the contacts of all cells, of many on all threads.
fn settle(cells: &mut [SlidingCell], monitor: &mut dyn Monitor) -> Result<()> {
    /// Cells of a thread, which repay its start.
    const SHARE: usize = 16;
    if cells.len() <= SHARE {
        cells.iter_mut().for_each(SlidingCell::settle);
        return Ok(());
    }
    let shares: Vec<Mutex<&mut [SlidingCell]>> = cells.chunks_mut(SHARE).map(Mutex::new).collect();
    let share = |(): &mut (), number: usize| {
        let mut cells = shares[number].lock().unwrap_or_else(PoisonError::into_inner);
        cells.iter_mut().for_each(SlidingCell::settle);
    };
    Watch::new(monitor).share(shares.len(), || (), share).map(drop)
}
