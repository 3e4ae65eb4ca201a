//! The steps of a slide.
//!
//! With viscosity each step is one of the linearly implicit Euler method for η Ẋ = r. Without it steps are monotone Newton
//! steps, damped by a fictitious η/dt where cells are not stable, as in pseudo-transient continuation (C. T. Kelley and
//! D. E. Keyes, SIAM J. Numer. Anal. 35, 508 (1998), doi:10.1137/S0036142996304796), or steps with uniform stiffness. All
//! of them move cells forward only and pass no balance, so that every sequence of steps ends in the same state, the nearest
//! balance ahead.

use super::batch::sum;
use super::cells::Extremes;
use super::configuration::Configuration;
use super::creep::STALLED;
use super::newton::MonotoneStep;
use super::residual::{InterfaceModel, Residual};
use super::uniform_stiffness::UniformStiffnessStep;
use crate::Result;
use crate::monitor::Monitor;

/// Length of a step in time, relative to η over the steepest slope.
const PACE: f64 = 0.02;

/// Residual, relative to the strongest force, below which steps in time grow: cells that move slowly are resolved by their
/// displacement.
const SLOW: f64 = 2e-3;

/// The least damping η/dt of a step where cells are not stable, relative to the steepest slope.
const DAMPED: f64 = 1e-3;

/// Factor by which damping grows where it was too small.
const GROWTH: f64 = 4.0;

/// Largest factor by which it falls.
const DECAY: f64 = 2.0;

/// Damping of the next step, relative to the negative stiffness that the last one has found.
const MARGIN: f64 = 3.0;

/// Chooses and makes the steps of a slide.
pub(super) struct Stepper {
    /// η, if slides last some time.
    viscosity: Option<f64>,
    /// Damping of the next step where cells are not stable, of a cell of area 1.
    damping: f64,
    /// Rounding error of the residual.
    rounding: f64,
    /// Largest residual before the last step.
    residual: f64,
    /// Whether only rounding errors were left of the residual after the last step, if it led to a balance.
    converged: bool,
    uniform: UniformStiffnessStep,
}

/// A step, not made yet.
pub(super) struct SlideStep {
    /// δ_j.
    pub by: Vec<f64>,
    /// A time, or 1 without viscosity.
    pub duration: f64,
    /// Largest residual before it.
    pub residual: f64,
}

impl Stepper {
    pub fn new(model: &InterfaceModel, viscosity: Option<f64>, configuration: &Configuration) -> Self {
        Self {
            viscosity,
            damping: 0.0,
            rounding: model.rounding(configuration, configuration.drive),
            residual: f64::INFINITY,
            converged: false,
            uniform: UniformStiffnessStep::new(),
        }
    }

    /// Largest residual before the last step.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// The next step; none in balance.
    pub fn next(
        &mut self,
        model: &mut InterfaceModel,
        configuration: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<SlideStep>> {
        let r = self.uniform.residual(model, configuration, monitor)?;
        let residual = r.largest;
        self.damping = eased(self.damping, residual / self.residual, model.steepest_per_area());
        if self.is_balance(residual) {
            return Ok(None);
        }
        self.residual = residual;
        if self.uniform.is_next(residual, self.rounding) {
            self.converged = false;
            let by = self.uniform.step(model, &r.forces, monitor)?;
            return Ok(Some(SlideStep { by, duration: 1.0, residual }));
        }
        self.rounding = model.rounding(configuration, configuration.drive);
        let MonotoneStep { by, rate, curved, .. } = self.variable_step(model, configuration, r, monitor)?;
        self.converged = self.damping == 0.0 && !curved;
        let duration = self.viscosity.map_or(1.0, |viscosity| viscosity / rate);
        Ok(Some(SlideStep { by, duration, residual }))
    }

    /// Whether a residual is one of rounding errors, after a step that has converged.
    fn is_balance(&self, residual: f64) -> bool {
        let stalled = residual <= STALLED * self.rounding && residual > 0.5 * self.residual;
        self.converged && (residual <= self.rounding || stalled)
    }

    /// A step with a stiffness for each cell, with the viscosity, and with the damping that it needs where cells are not
    /// stable. Without viscosity its advances are compared with those of a step with uniform stiffness.
    fn variable_step(
        &mut self,
        model: &mut InterfaceModel,
        configuration: &Configuration,
        mut residual: Residual,
        monitor: &mut dyn Monitor,
    ) -> Result<MonotoneStep> {
        let (number, largest, stiffness) = (model.len(), residual.largest, model.uniform_stiffness());
        let (steepest, Extremes { strongest, .. }) = (model.steepest_per_area(), model.cells.extremes());
        let least = self.viscosity.map_or(0.0, |_| euler_rate([steepest, strongest], largest));
        let pull = sum(number, |j| residual.forces[j]);
        loop {
            let rate = least.max(self.damping);
            if let Some(step) = model.monotone_step(residual, rate, self.rounding, monitor)? {
                if self.viscosity.is_none() {
                    // All rows of A add up to ≥ 0: with a uniform stiffness c the advances add up to Σr/c at most.
                    let gain = stiffness * sum(number, |j| step.by[j]) / pull;
                    self.uniform.compare(largest, gain, step.iterations, stiffness);
                }
                return Ok(step);
            }
            // The failed attempt has used up the residual; computing it anew is seldom needed, a
            // copy would be made in every step.
            residual = model.residual(configuration, monitor)?;
            self.damping = (GROWTH * rate).max(DAMPED * steepest);
        }
    }
}

/// η/dt of a step in time of a cell of area 1, from the steepest slope per area and the strongest force: short steps where cells
/// move fast, and ever longer ones as they come to rest.
fn euler_rate([steepest, strongest]: [f64; 2], residual: f64) -> f64 {
    steepest / PACE * (residual / (SLOW * strongest)).min(1.0)
}

/// Damping of the next step, after one that changed the largest residual by a factor: in the softest mode, of stiffness λ,
/// that factor is damping/(damping + λ).
fn eased(damping: f64, factor: f64, steepest: f64) -> f64 {
    // A factor above 1 means that the residual has grown: the softest mode has λ < 0, and the
    // damping must exceed −λ.
    let needed = MARGIN * damping * (1.0 - 1.0 / factor);
    let eased = damping / DECAY;
    if needed > 0.0 {
        needed
    } else if eased > DAMPED * steepest {
        eased
    } else {
        0.0
    }
}
