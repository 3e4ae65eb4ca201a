//! A slide at a fixed drive, from the loss of balance to the next balance.
//!
//! With viscosity each step is one of the linearly implicit Euler method for η Ẋ = r. Without it steps are monotone Newton
//! steps, damped by a fictitious η/dt where cells are not stable, as in pseudo-transient continuation (C. T. Kelley and
//! D. E. Keyes, SIAM J. Numer. Anal. 35, 508 (1998), doi:10.1137/S0036142996304796), or steps with uniform stiffness. All
//! of them move cells forward only and pass no balance, so that every sequence of steps ends in the same state, the nearest
//! balance ahead.

use super::batch::{find, sum};
use super::cells::{Extremes, Instability};
use super::configuration::{Advances, Configuration};
use super::creep::STALLED;
use super::newton::MonotoneStep;
use super::parameters::{InterfaceParameters, Slip};
use super::residual::{Model, Residual};
use super::uniform_stiffness::UniformStiffnessStep;
use crate::monitor::{Monitor, report};
use crate::{Error, Float, Result};

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

/// A slide is over when no cell becomes unstable any more, and the residual is this fraction of its largest.
const OVER: f64 = 0.01;

/// Steps of a cell between two reports to the monitor.
const REPORT: u64 = 1 << 12;

/// Steps after which a slide is given up: some 10⁴ times the number of a usual one.
const MOST_STEPS: u64 = 10_000_000;

/// What is known of a slide.
pub(super) struct Slide {
    pub parameters: InterfaceParameters,
    /// Where cells were before.
    pub before: Configuration,
    /// Friction force before.
    pub force: f64,
    /// Work done on the contacts before, since the beginning.
    pub work: f64,
    /// Cells that became unstable, in this order.
    pub unstable: Vec<u32>,
    /// When each cell did, from the beginning of the slide; NaN where it did not.
    pub starts: Vec<f64>,
    /// Whether contacts broke together.
    pub together: bool,
    /// When it was over.
    pub over: f64,
}

impl Slide {
    /// A slide from here.
    pub fn new(model: &Model, parameters: InterfaceParameters, configuration: &Configuration) -> Self {
        Self {
            parameters,
            before: configuration.clone(),
            force: model.force(),
            work: model.cells.energies().work,
            unstable: Vec::with_capacity(model.len()),
            starts: vec![f64::NAN; model.len()],
            together: false,
            over: 0.0,
        }
    }

    /// Whether a cell has become unstable.
    pub fn is_unstable(&self, cell: usize) -> bool {
        !self.starts[cell].is_nan()
    }

    /// Moves the cells step by step until there is balance. The monitor hears that of the run `fraction` is done.
    pub fn run(
        &mut self,
        model: &mut Model,
        configuration: &mut Configuration,
        fraction: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let (mut time, mut most, mut before, mut settled) = (0.0, 0.0_f64, f64::INFINITY, false);
        let (mut damping, mut uniform) = (0.0, UniformStiffnessStep::new());
        let mut rounding = model.rounding(configuration, configuration.drive);
        let quiet = REPORT.div_ceil(model.len() as u64);
        for steps in 0..MOST_STEPS {
            let residual = uniform.residual(model, configuration)?;
            let largest = residual.largest;
            damping = eased(damping, largest / before, model.cells.extremes().steepest);
            // Balance is where only rounding errors are left of the residual, after a step that had converged.
            let stalled = largest <= STALLED * rounding && largest > 0.5 * before;
            if settled && (largest <= rounding || stalled) {
                return Ok(());
            }
            before = largest;
            let (by, duration);
            if uniform.is_next(largest, rounding) {
                (by, duration) = (uniform.step(model, &residual.forces)?, 1.0);
                settled = false;
            } else {
                rounding = model.rounding(configuration, configuration.drive);
                let viscosity = self.parameters.viscosity;
                let step = variable_step(
                    model,
                    configuration,
                    residual,
                    viscosity,
                    rounding,
                    &mut damping,
                    &mut uniform,
                )?;
                settled = damping == 0.0 && !step.curved;
                duration = viscosity.map_or(1.0, |viscosity| viscosity / step.rate);
                by = step.by;
            }
            let unstable = self.unstable.len();
            self.find_unstable(model, configuration, &by, [time, duration], monitor)?;
            model.cells.advance(&by, monitor)?;
            configuration.advance(&Advances::new(by));
            most = most.max(largest);
            time += duration;
            if largest > OVER * most || self.unstable.len() > unstable {
                self.over = time;
            }
            if steps % quiet == 0 {
                report(monitor, fraction)?;
            }
        }
        let (reached, wanted) = (Float(before), Float(model.rounding(configuration, configuration.drive)));
        Err(Error::Accuracy { key: String::new(), what: "the balance of a slide".into(), reached, wanted })
    }

    /// Finds the cells that become unstable in a step that begins and lasts as `times` say; in a reset their contacts break
    /// there.
    fn find_unstable(
        &mut self,
        model: &mut Model,
        configuration: &Configuration,
        by: &[f64],
        times: [f64; 2],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let ([begin, duration], known) = (times, self.unstable.len());
        let found = self.newly_unstable(model, configuration, by);
        for (advance, cell, together) in found.into_iter().flatten() {
            self.together |= together;
            self.unstable.push(cell);
            let cell = cell as usize;
            let part = if by[cell] > 0.0 { advance / by[cell] } else { 0.0 };
            self.starts[cell] = begin + part * duration;
            if self.parameters.slip == Slip::Reset {
                model.cells.detach(cell, advance, monitor)?;
            }
        }
        // Of cells that begin at the same time the fastest one comes first.
        let order = |cell: u32| (self.starts[cell as usize], -by[cell as usize], cell);
        self.unstable[known..].sort_unstable_by(|a, b| {
            let (a, b) = (order(*a), order(*b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
        });
        Ok(())
    }

    /// Cells that become unstable in a step: after which advance, which cell, and whether contacts break together.
    fn newly_unstable(
        &self,
        model: &Model,
        configuration: &Configuration,
        by: &[f64],
    ) -> Vec<Vec<(f64, u32, bool)>> {
        let (steep, jumps) = (-model.springs.mean(), model.cells.extremes().jumps);
        let moved = |cell: usize| configuration.positions[cell] + by[cell] - self.before.positions[cell];
        let is_far = |cell: usize| moved(cell) > self.parameters.drive_tolerance;
        let begins = |cell: usize| {
            let below = if is_far(cell) { steep } else { f64::NEG_INFINITY };
            let Instability { at, together } = model.cells.instability(cell, by[cell], below)?;
            Some((at, cell as u32, together))
        };
        let may = |cell: usize| !self.is_unstable(cell) && (jumps || is_far(cell));
        find(model.len(), |cell| if may(cell) { begins(cell) } else { None })
    }

    /// Energy ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j that the slide has dissipated, with [`Model::mean_pulls`].
    pub fn dissipated(&self, model: &Model, positions: &[f64], pulls: &[f64]) -> f64 {
        let work = sum(model.len(), |j| pulls[j] * (positions[j] - self.before.positions[j]));
        work - (model.cells.energies().work - self.work)
    }
}

/// Makes a monotone step, with the viscosity and with the damping that it needs where cells are not stable. Without
/// viscosity its advances are compared with those of a step with uniform stiffness.
fn variable_step(
    model: &mut Model,
    configuration: &Configuration,
    mut residual: Residual,
    viscosity: Option<f64>,
    rounding: f64,
    damping: &mut f64,
    uniform: &mut UniformStiffnessStep,
) -> Result<MonotoneStep> {
    let (number, largest, stiffness) = (model.len(), residual.largest, model.uniform_stiffness());
    let least = viscosity.map_or(0.0, |_| euler_rate(model.cells.extremes(), largest));
    let pull = sum(number, |j| residual.forces[j]);
    loop {
        let rate = least.max(*damping);
        if let Some(step) = model.monotone_step(residual, rate, rounding)? {
            if viscosity.is_none() {
                // All rows of A add up to ≥ 0: with a uniform stiffness c the advances add up to Σr/c at most.
                let gain = stiffness * sum(number, |j| step.by[j]) / pull;
                uniform.compare(largest, gain, step.iterations, stiffness);
            }
            return Ok(step);
        }
        residual = model.residual(configuration)?;
        *damping = (GROWTH * rate).max(DAMPED * model.cells.extremes().steepest);
    }
}

/// η/dt of a step in time: short steps where cells move fast, and ever longer ones as they come to rest.
fn euler_rate(extremes: Extremes, residual: f64) -> f64 {
    let Extremes { steepest, strongest, .. } = extremes;
    steepest / PACE * (residual / (SLOW * strongest)).min(1.0)
}

/// Damping of the next step, after one that changed the largest residual by a factor: in the softest mode, of stiffness λ,
/// that factor is damping/(damping + λ).
fn eased(damping: f64, factor: f64, steepest: f64) -> f64 {
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
