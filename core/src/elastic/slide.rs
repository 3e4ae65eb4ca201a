//! Slides at a fixed drive, from the loss of balance to the next one.

use super::balance::BalanceStep;
use super::batch::{change, fill, find, sum};
use super::catalogue::ClusterSlide;
use super::cells::{Extremes, Fall};
use super::uniform_stiffness::UniformStiffnessStep;
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
        let mut slide = self.before()?;
        self.cells.mark();
        if let Err(error) = self.follow(&mut slide, monitor) {
            self.cells.recall(monitor)?;
            self.stand();
            self.positions.copy_from_slice(&slide.before);
            self.differences = slide.differences;
            return Err(error);
        }
        self.cells.reattach();
        let force_after = self.force()?;
        self.pull_halfway(&slide);
        let events = self.events(&slide, force_after);
        let lost = self.lost(&slide);
        self.cells.unmark();
        self.enter_slide(lost);
        if self.setting.viscosity.is_some() {
            self.time += slide.over;
        }
        Ok(events)
    }

    /// What has to be known of the state before.
    fn before(&mut self) -> Result<ClusterSlide> {
        Ok(ClusterSlide {
            before: self.positions.clone(),
            differences: self.differences.clone(),
            force: self.force()?,
            work: self.cells.account().work,
            fallen: Vec::with_capacity(self.len()),
            starts: vec![f64::NAN; self.len()],
            together: false,
            over: 0.0,
        })
    }

    /// Steps until there is balance.
    fn follow(&mut self, slide: &mut ClusterSlide, monitor: &mut dyn Monitor) -> Result<()> {
        let (mut time, mut most, mut before, mut settled) = (0.0, 0.0_f64, f64::INFINITY, false);
        let (mut damping, mut plain, mut precision) = (0.0, UniformStiffnessStep::new(), self.precision());
        let quiet = REPORT.div_ceil(self.len() as u64);
        for steps in 0..MOST_STEPS {
            let excess = self.excess_after(&mut plain)?;
            damping = self.eased(damping, excess / before);
            if settled && (excess <= precision || (excess <= STALLED * precision && excess > 0.5 * before)) {
                return Ok(());
            }
            before = excess;
            let mut during = 1.0;
            if plain.is_next(excess, precision) {
                self.plain_step(&mut plain)?;
                settled = false;
            } else {
                precision = self.precision();
                let step = self.step_on(excess, &mut damping, &mut plain)?;
                settled = damping == 0.0 && !step.curved;
                during = self.setting.viscosity.map_or(1.0, |viscosity| viscosity / step.rate);
            }
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
        Err(Error::Accuracy { key: String::new(), what: "the balance of a slide".into(), reached, wanted })
    }

    /// Makes a step that tells springs apart, at the damping η/dt that it needs where cells are not stable; without viscosity
    /// it is weighed against plain ones.
    fn step_on(
        &mut self,
        excess: f64,
        damping: &mut f64,
        plain: &mut UniformStiffnessStep,
    ) -> Result<BalanceStep> {
        let (least, out, spring) =
            (self.rate(excess), sum(self.len(), |j| self.excess[j]), self.plain_spring());
        loop {
            let rate = least.max(*damping);
            if let Some(step) = self.step(rate)? {
                if self.setting.viscosity.is_none() {
                    // All rows of A add to no less than 0: in a plain step all go out/c together, or less.
                    let gain = spring * sum(self.len(), |j| self.by[j]) / out;
                    plain.weigh(excess, gain, step.taken, spring);
                }
                return Ok(step);
            }
            self.excess_here()?;
            *damping = (LONGER * rate).max(DAMPED * self.cells.extremes().steepest);
        }
    }

    /// Damping of the next step, the last one having changed the largest excess force by a factor: on the softest way, of
    /// stiffness λ, that is damping/(damping + λ).
    fn eased(&self, damping: f64, factor: f64) -> f64 {
        let needed = SPARE * damping * (1.0 - 1.0 / factor);
        let eased = damping / EASED;
        if needed > 0.0 {
            needed
        } else if eased > DAMPED * self.cells.extremes().steepest {
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
        let Extremes { steepest, strongest, .. } = self.cells.extremes();
        steepest / PACE * (excess / (SLOW * strongest)).min(1.0)
    }

    /// Finds the cells that begin to slip in a step that has been tried; in a reset their contacts break there.
    fn notice(
        &mut self,
        slide: &mut ClusterSlide,
        time: f64,
        during: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let known = slide.fallen.len();
        for (on, cell, together) in self.falls(slide).into_iter().flatten() {
            slide.together |= together;
            slide.fallen.push(cell);
            let cell = cell as usize;
            let part = if self.by[cell] > 0.0 { on / self.by[cell] } else { 0.0 };
            slide.starts[cell] = time + part * during;
            if self.setting.slip == Slip::Reset {
                self.cells.detach(cell, on, monitor)?;
            }
        }
        // Of cells that begin together the fastest one comes first.
        let begun = |cell: u32| (slide.starts[cell as usize], -self.by[cell as usize], cell);
        slide.fallen[known..].sort_unstable_by(|a, b| {
            let (a, b) = (begun(*a), begun(*b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
        });
        Ok(())
    }

    /// Cells that have not fallen yet and begin to on the ways that are tried: after which advance, which one, and whether
    /// contacts break together on it.
    fn falls(&self, slide: &ClusterSlide) -> Vec<Vec<(f64, u32, bool)>> {
        let (steep, jumps) = (-self.mean_connection(), self.cells.extremes().jumps);
        let way = |cell: usize| self.positions[cell] + self.by[cell] - slide.before[cell];
        let is_far = |cell: usize| way(cell) > self.setting.drive_tolerance;
        let begins = |cell: usize| {
            let below = if is_far(cell) { steep } else { f64::NEG_INFINITY };
            let Fall { on, together } = self.cells.fall(cell, self.by[cell], below)?;
            Some((on, cell as u32, together))
        };
        let may = |cell: usize| !slide.has_fallen(cell) && (jumps || is_far(cell));
        find(self.len(), |cell| if may(cell) { begins(cell) } else { None })
    }

    /// The pulls of drive and slider where cells are halfway between the positions before and now, in place of the excess:
    /// their means on any way, as they are linear in positions and A is symmetric.
    fn pull_halfway(&mut self, slide: &ClusterSlide) {
        let connection = self.connections();
        let (before, positions) = (&slide.before, &self.positions);
        let middle = |j: usize| 0.5 * (before[j] + positions[j]);
        match (&self.differences, &slide.differences) {
            (Some(differences), Some(before)) => differences.halfway(before, &mut self.by),
            _ => fill(&mut self.by, middle),
        }
        self.coupling.forces(&self.by, &mut self.excess);
        let drive = self.drive;
        change(&mut self.excess, |j, held| connection(j) * (drive - middle(j)) + held);
        self.by.fill(0.0);
    }

    /// ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j of a slide, pulls being known halfway.
    fn lost(&self, slide: &ClusterSlide) -> f64 {
        let pulled = sum(self.len(), |j| self.pulled(slide, j));
        pulled - (self.cells.account().work - slide.work)
    }

    /// Work of drive and slider on a cell in a slide, pulls being known halfway.
    pub(super) fn pulled(&self, slide: &ClusterSlide, cell: usize) -> f64 {
        self.excess[cell] * (self.positions[cell] - slide.before[cell])
    }
}
