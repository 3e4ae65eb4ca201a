//! Slides at a fixed drive, from the loss of balance to the next one.

use super::balance::Step;
use super::batch::{fill, sum};
use super::catalogue::{Fallen, Slide};
use super::{Event, Interface, Slip, Slipped};
use crate::monitor::Monitor;
use crate::{Error, Float, Result};

/// Steps of time, in the time in which the steepest slope acts.
const PACE: f64 = 0.02;

/// Excess force, of the strongest one, below which steps grow: what moves so slowly is followed by its way.
const SLOW: f64 = 2e-3;

/// The least damping of a step where cells are not stable, of the steepest slope.
const DAMPED: f64 = 1e-3;

/// By how much damping changes where it was too little.
const LONGER: f64 = 4.0;

/// By how much it falls at most.
const EASED: f64 = 2.0;

/// Damping of the next step, in the negative stiffness that the last one saw.
const SPARE: f64 = 3.0;

/// A slide is over when no cell begins to slip any more, and the excess force is this part of its largest.
const OVER: f64 = 0.01;

/// Forces out of balance that become no smaller are rounding up to so many times what is expected of it.
pub(super) const STALLED: f64 = 10.0;

/// Steps of a cell between two reports to the monitor.
const REPORT: u64 = 1 << 12;

/// Steps after which a slide is given up: some 10⁴ times what they take.
const MOST_STEPS: u64 = 10_000_000;

impl Interface {
    /// Slides to the next balance at this drive. Where it is stopped all is as it was before.
    pub(super) fn slide(&mut self, monitor: &mut dyn Monitor) -> Result<Vec<(Event, Vec<Slipped>)>> {
        self.excess_here()?;
        let mut slide = self.before();
        self.cells.mark();
        if let Err(error) = self.follow(&mut slide, monitor) {
            self.cells.recall(monitor)?;
            self.by.fill(0.0);
            self.positions.copy_from_slice(&slide.before);
            self.coupling.forces(&self.positions, &mut self.held);
            return Err(error);
        }
        self.cells.rejoin();
        self.excess_here()?;
        let lost = self.lost(&slide);
        self.enter_slide(lost);
        let events = self.events(&slide);
        if self.setting.viscosity.is_some() {
            self.time += slide.over;
        }
        Ok(events)
    }

    /// What has to be known of the state before.
    fn before(&self) -> Slide {
        let mut pull = vec![0.0; self.len()];
        fill(&mut pull, |j| self.excess[j] + self.responses[j].force);
        Slide {
            before: self.positions.clone(),
            pull,
            force: self.total_force(),
            work: self.cells.account().work,
            fallen: Vec::new(),
            slipped: vec![false; self.len()],
            over: 0.0,
        }
    }

    /// Steps until there is balance.
    fn follow(&mut self, slide: &mut Slide, monitor: &mut dyn Monitor) -> Result<()> {
        let (mut time, mut most, mut before, mut settled) = (0.0, 0.0_f64, f64::INFINITY, false);
        let mut damping = 0.0;
        let quiet = REPORT.div_ceil(self.len() as u64);
        for steps in 0..MOST_STEPS {
            let excess = self.excess_here()?;
            let precision = self.precision();
            damping = self.eased(damping, excess / before);
            if settled && (excess <= precision || (excess <= STALLED * precision && excess > 0.5 * before)) {
                return Ok(());
            }
            before = excess;
            let step = self.step_on(excess, &mut damping)?;
            let during = self.setting.viscosity.map_or(1.0, |viscosity| viscosity / step.rate);
            settled = damping == 0.0 && !step.curved;
            let fallen = slide.fallen.len();
            self.notice(slide, time, during, monitor)?;
            self.commit(monitor)?;
            most = most.max(excess);
            time += during;
            if excess > OVER * most || slide.fallen.len() > fallen {
                slide.over = time;
            }
            if steps % quiet == 0 {
                self.tell(monitor)?;
            }
        }
        let (reached, wanted) = (Float(before), Float(self.precision()));
        Err(Error::Accuracy { what: "the balance of a slide".into(), reached, wanted })
    }

    /// Makes a step, at the damping η/dt that it needs where cells are not stable.
    fn step_on(&mut self, excess: f64, damping: &mut f64) -> Result<Step> {
        let least = self.rate(excess);
        loop {
            let rate = least.max(*damping);
            if let Some(step) = self.step(rate)? {
                return Ok(step);
            }
            *damping = (LONGER * rate).max(DAMPED * self.cells.steepest());
        }
    }

    /// Damping of the next step, the last one having changed the largest excess force by a factor: on the softest way, of
    /// stiffness λ, that is damping/(damping + λ).
    fn eased(&self, damping: f64, factor: f64) -> f64 {
        let needed = SPARE * damping * (1.0 - 1.0 / factor);
        let eased = damping / EASED;
        if needed > 0.0 {
            needed
        } else if eased > DAMPED * self.cells.steepest() {
            eased
        } else {
            0.0
        }
    }

    /// η/dt of a step: short where cells move fast, and ever longer as they come to rest; 0 without viscosity.
    fn rate(&self, excess: f64) -> f64 {
        if self.setting.viscosity.is_none() {
            return 0.0;
        }
        self.cells.steepest() / PACE * (excess / (SLOW * self.cells.strongest())).min(1.0)
    }

    /// Finds the cells that begin to slip in a step that has been tried; in a reset their contacts break there.
    fn notice(&mut self, slide: &mut Slide, time: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.cells.slopes(None, &self.by, &mut self.slopes)?;
        let steep = -self.mean_connection();
        for cell in 0..self.len() {
            let way = self.positions[cell] + self.by[cell] - slide.before[cell];
            let least = self.slopes[cell].least;
            let far = way > self.setting.drive_tolerance || least == f64::NEG_INFINITY;
            if slide.slipped[cell] || !far || least >= steep {
                continue;
            }
            let Some(on) = self.cells.fall(cell, self.by[cell], steep) else { continue };
            slide.slipped[cell] = true;
            let part = if self.by[cell] > 0.0 { on / self.by[cell] } else { 0.0 };
            slide.fallen.push(Fallen { cell, time: time + part * during, way: self.by[cell] });
            if self.setting.slip == Slip::Reset {
                self.cells.part(cell, on, monitor)?;
            }
        }
        Ok(())
    }

    /// ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j of a slide: pulls are linear in positions and A is symmetric, so that
    /// their means before and after do for every way.
    fn lost(&self, slide: &Slide) -> f64 {
        let pulled = sum(self.len(), |j| self.pulled(slide, j));
        pulled - (self.cells.account().work - slide.work)
    }

    /// Work of drive and slider on a cell in a slide.
    pub(super) fn pulled(&self, slide: &Slide, cell: usize) -> f64 {
        let after = self.excess[cell] + self.responses[cell].force;
        0.5 * (slide.pull[cell] + after) * (self.positions[cell] - slide.before[cell])
    }
}
