//! A slide at a fixed drive, from the loss of balance to the next balance, with a record of the cells that become unstable.

use super::batch::{find, sum};
use super::cells::Instability;
use super::configuration::{Advances, Configuration};
use super::parameters::{CellSlip, InterfaceParameters};
use super::residual::InterfaceModel;
use super::stepper::{SlideStep, Stepper};
use crate::monitor::{Monitor, report};
use crate::{Error, Float, Result};

/// A slide is over when no cell becomes unstable any more, and the residual is this fraction of its largest.
const OVER: f64 = 0.01;

/// Steps of a cell between two reports to the monitor.
const REPORT: u64 = 1 << 12;

/// Steps after which a slide is given up: some 10⁴ times the number of a usual one.
const MOST_STEPS: u64 = 10_000_000;

/// The record of a slide.
pub(super) struct SlideRecord {
    pub parameters: InterfaceParameters,
    /// Where cells were before.
    pub before: Configuration,
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

impl SlideRecord {
    /// A slide from here.
    pub fn new(
        model: &InterfaceModel,
        parameters: InterfaceParameters,
        configuration: &Configuration,
    ) -> Self {
        Self {
            parameters,
            before: configuration.clone(),
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

    /// Moves the cells until there is balance. Returns the mean pulls of the slide, and the energy of the slider after it.
    ///
    /// # Errors
    /// A balance that steps do not reach; those of the cells; stopped by the monitor.
    pub fn whole(
        &mut self,
        model: &mut InterfaceModel,
        configuration: &mut Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, f64)> {
        self.run(model, configuration, monitor)?;
        let coupling = model.coupling_energy(configuration, monitor)?;
        Ok((model.mean_pulls(&self.before, configuration, monitor)?, coupling))
    }

    /// Moves the cells step by step until there is balance.
    fn run(
        &mut self,
        model: &mut InterfaceModel,
        configuration: &mut Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let (mut time, mut most) = (0.0, 0.0_f64);
        let mut stepper = Stepper::new(model, self.parameters.viscosity, configuration);
        // Reports after a fixed number of steps of single cells: their cost is negligible for few cells, too.
        let quiet = REPORT.div_ceil(model.len() as u64);
        for steps in 0..MOST_STEPS {
            let Some(SlideStep { by, duration, residual }) = stepper.next(model, configuration, monitor)?
            else {
                return Ok(());
            };
            let unstable = self.unstable.len();
            self.find_unstable(model, configuration, &by, [time, duration], monitor)?;
            model.cells.advance(&by, monitor)?;
            configuration.advance(&Advances::new(by));
            most = most.max(residual);
            time += duration;
            // With viscosity the residual decays exponentially and never quite reaches 0: the end
            // of a slide is where it has become small.
            if residual > OVER * most || self.unstable.len() > unstable {
                self.over = time;
            }
            if steps % quiet == 0 {
                report(monitor, 0.0)?;
            }
        }
        let (reached, wanted) = (stepper.residual(), model.rounding(configuration, configuration.drive));
        let (reached, wanted) = (Float(reached), Float(wanted));
        Err(Error::Accuracy { key: String::new(), what: "the balance of a slide".into(), reached, wanted })
    }

    /// Finds the cells that become unstable in a step that begins and lasts as `times` say; in a reset their contacts break
    /// there.
    fn find_unstable(
        &mut self,
        model: &mut InterfaceModel,
        configuration: &Configuration,
        by: &[f64],
        times: [f64; 2],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let ([begin, duration], known) = (times, self.unstable.len());
        let found = self.newly_unstable(model, configuration, by, monitor)?;
        for (advance, cell, together) in found.into_iter().flatten() {
            self.together |= together;
            self.unstable.push(cell);
            let cell = cell as usize;
            // Cells move uniformly in a step, which interpolates their times of instability.
            let part = if by[cell] > 0.0 { advance / by[cell] } else { 0.0 };
            self.starts[cell] = begin + part * duration;
            if self.parameters.slip == CellSlip::Reset {
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
        model: &InterfaceModel,
        configuration: &Configuration,
        by: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Vec<(f64, u32, bool)>>> {
        // Between −K_0j − A_jj and this slope per area a cell is held by neighbours that stand still, but
        // not by neighbours that move along with it.
        let (steep, jumps) = (-model.springs.per_area(), model.cells.extremes().jumps);
        let areas = model.springs.areas();
        let moved = |cell: usize| configuration.positions[cell] + by[cell] - self.before.positions[cell];
        let is_far = |cell: usize| moved(cell) > self.parameters.drive_tolerance;
        let begins = |cell: usize| {
            let below = if is_far(cell) { areas.of(cell) * steep } else { f64::NEG_INFINITY };
            let Instability { at, together } = model.cells.instability(cell, by[cell], below)?;
            Some((at, cell as u32, together))
        };
        let may = |cell: usize| !self.is_unstable(cell) && (jumps || is_far(cell));
        find(model.len(), |cell| if may(cell) { begins(cell) } else { None }, monitor)
    }

    /// Energy ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j that the slide has dissipated, with [`InterfaceModel::mean_pulls`].
    pub fn dissipated(&self, model: &InterfaceModel, positions: &[f64], pulls: &[f64]) -> f64 {
        let work = sum(model.len(), |j| pulls[j] * (positions[j] - self.before.positions[j]));
        work - (model.cells.energies().work - self.work)
    }
}
