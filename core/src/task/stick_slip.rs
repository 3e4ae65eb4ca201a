//! Whether a slider sticks and slips behind its spring: from motions of a block, beside the critical stiffnesses of the first
//! pull and of steady sliding.

use super::drive::first_loading_distance;
use super::in_time::finite_size_tolerance;
use super::summary::{Extended, StickSlipNumbers};
use crate::block::{Block, PersistenceLimit, Regime};
use crate::contacts::Contacts;
use crate::ensemble::Ensemble;
use crate::error::positive;
use crate::master::{DynamicStiffness, MasterEquation, Slider, Transport};
use crate::monitor::{Aside, Monitor, Part, report};
use crate::population::Population;
use crate::rate_dependent::RateDependentContacts;
use crate::scenario::{self, Drive, Model};
use crate::{Error, Result};

/// First length of a drive beyond the first loading, in mean thresholds. Where that does not decide, it is doubled.
const SLIDE: f64 = 20.0;
/// Softest spring of the search, in units of the stiffness of all contacts: behind a softer one, the first loading alone takes
/// more than a thousand mean thresholds.
const SOFTEST: f64 = 1e-3;

/// Whether a slider sticks and slips, and behind which springs it does.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StickSlipStability {
    /// Stiffness K of the spring of the block.
    pub stiffness: f64,
    /// What the block of this stiffness does: [`Regime::Smooth`] (no slips), [`Regime::Transient`] or [`Regime::Persistent`].
    pub regime: Regime,
    /// The stiffness at which persistent stick-slip ends.
    pub limit: PersistenceLimit,
    /// K_c = −min F' of a first pull from the initial state, at this velocity: a softer spring begins with a slip; 0 if F never
    /// falls, infinite if it jumps.
    pub critical_stiffness: f64,
    /// K_c of steady sliding, for the mass and the damping of the block: a softer spring makes small deviations from steady
    /// sliding grow; 0 if they never do, infinite if they always do. 0 for time-independent contacts, over which steady sliding
    /// is neutrally stable.
    pub critical_stiffness_sliding: f64,
}

/// Whether the block of `model` sticks and slips over its contacts, pulled from its initial state at a constant velocity of the
/// load point, which time-dependent contacts need. The stiffness at which persistent stick-slip ends is enclosed to a ratio of
/// 1 + `resolution`, by motions of the block behind springs of other stiffnesses, down to 1e-3 of the stiffness of all contacts.
///
/// ```
/// use std::sync::Arc;
/// use asperity::block::{Regime, Slip};
/// use asperity::contacts::{Contacts, Initial};
/// use asperity::law::{Gaussian, Point};
/// use asperity::scenario::{Block, Model};
/// use asperity::task::stick_slip_stability;
///
/// let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// let block = Block { stiffness: 1.0, slip: Slip::Overdamped, slip_fraction: Block::SLIP_FRACTION };
/// let model = Model { block: Some(block), ..Model::new(contacts, Initial::default()) };
/// let found = stick_slip_stability(&model, None, 0.02, &mut ())?;
/// // Contacts that re-form as they break lose their common phase after three slips.
/// assert!(matches!(found.regime, Regime::Transient { slips: 3, .. }));
/// assert_eq!(found.limit.persists, 0.0);
/// assert!((found.critical_stiffness - 3.009222675584).abs() < 1e-6);
/// # Ok::<(), asperity::Error>(())
/// ```
///
/// # Errors
/// A model without a block; time-dependent contacts without a velocity, or with a slip rule that has no meaning in time, or that
/// slip without a mass or a damping; those of the solvers; stopped by the monitor.
pub fn stick_slip_stability(
    model: &Model,
    velocity: Option<f64>,
    resolution: f64,
    monitor: &mut dyn Monitor,
) -> Result<StickSlipStability> {
    let (_, answer) = Springs::answered(model, velocity, resolution, monitor)?;
    report(monitor, 1.0)?;
    Ok(answer)
}

/// About how often the stiffness is halved until stick-slip persists.
const HALVINGS: f64 = 3.0;

/// Progress of the search for the stiffness at which persistent stick-slip ends. Each motion takes an equal share of what is left:
/// at least one more halving until stick-slip persists, and the bisections.
struct SearchProgress {
    /// Of the whole that is done.
    fraction: f64,
    halvings: f64,
    bisections: f64,
    /// Whether stick-slip has persisted behind a spring.
    persists: bool,
}

impl SearchProgress {
    /// The fraction of the whole that is done before the next motion, and the share of this motion.
    fn next_motion(&mut self) -> (f64, f64) {
        let halvings = if self.persists { 0.0 } else { self.halvings.max(1.0) };
        let share = (1.0 - self.fraction) / (halvings + self.bisections).max(1.0);
        *(if self.persists { &mut self.bisections } else { &mut self.halvings }) -= 1.0;
        let done = self.fraction;
        self.fraction += share;
        (done, share)
    }
}

/// Contacts that wait for a slider behind springs of any stiffness.
pub(super) struct Springs {
    table: scenario::Block,
    block: Block,
    contacts: Waiting,
    /// Mean threshold x̄.
    mean: f64,
    /// N_c⟨k⟩.
    all: f64,
    /// K_c of the first pull and of steady sliding.
    critical: [f64; 2],
    /// Estimated error of F/(N_c⟨k⟩) of the first pull.
    pub error: f64,
    /// Mean life of a contact.
    pub life: f64,
}

/// Contacts at the start, which are copied for every motion.
enum Waiting {
    Quasistatic(Box<dyn Population>),
    InTime { contacts: Box<dyn RateDependentContacts>, velocity: f64, tolerance: f64 },
}

impl Springs {
    /// Solved by the master equation.
    ///
    /// # Errors
    /// Those of [`stick_slip_stability`].
    pub fn new(model: &Model, velocity: Option<f64>, monitor: &mut dyn Monitor) -> Result<Self> {
        let Model { contacts, initial, .. } = model;
        let table = block_of(model)?.clone();
        let block = slider(model)?;
        let velocity = velocity_of(contacts, velocity)?;
        let part = &mut Part::new(monitor, 0.0, 0.1);
        let equation = match velocity {
            Some(velocity) => MasterEquation::at_with(contacts.clone(), initial, velocity, part)?,
            None => MasterEquation::new_with(contacts.clone(), initial, part)?,
        };
        let tolerance = model.master_equation.tolerance();
        let part = &mut Part::new(monitor, 0.1, 0.2);
        let pull = equation.pull_with(first_loading_distance(contacts), tolerance, part)?;
        let part = &mut Part::new(monitor, 0.3, 0.7);
        let mean = contacts.thresholds.mean();
        let (sliding, waiting) = match velocity {
            None => (0.0, Waiting::Quasistatic(Box::new(equation.population_with(tolerance, part)?))),
            Some(velocity) => {
                let sliding = critical_in_sliding(contacts, velocity, &table, part)?;
                let aside = &mut Aside { fraction: 1.0, monitor: part };
                let tolerance = model.master_equation.tolerance_of_a_block();
                let transport = Transport::new_with(contacts.clone(), initial, tolerance, aside)?;
                let tolerance = tolerance * mean;
                (sliding, Waiting::InTime { contacts: Box::new(transport), velocity, tolerance })
            }
        };
        Ok(Self {
            table,
            block,
            contacts: waiting,
            mean,
            all: model.stiffness(),
            critical: [pull.critical_stiffness(), sliding],
            error: pull.error_estimate(),
            life: equation.steady_state().mean_life(),
        })
    }

    /// The same with the answer for the spring of the block.
    ///
    /// # Errors
    /// Those of [`stick_slip_stability`].
    pub fn answered(
        model: &Model,
        velocity: Option<f64>,
        resolution: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<(Self, StickSlipStability)> {
        let springs = Self::new(model, velocity, &mut Part::new(monitor, 0.0, 0.1))?;
        let regime = springs.regime(springs.stiffness(), &mut Part::new(monitor, 0.1, 0.1))?;
        let limit = springs.limit(resolution, &mut Part::new(monitor, 0.2, 0.8))?;
        let answer = springs.answer(regime, limit);
        Ok((springs, answer))
    }

    /// The same slider over single contacts.
    ///
    /// # Errors
    /// Those of [`Ensemble::population_with`] and [`Ensemble::in_time_with`].
    pub fn over(&self, ensemble: &Ensemble, monitor: &mut dyn Monitor) -> Result<Self> {
        let (built, contacts) = match &self.contacts {
            Waiting::Quasistatic(_) => {
                let contacts = Waiting::Quasistatic(Box::new(ensemble.population_with(monitor)?));
                (Drive::default().slider(Some(&self.table), true), contacts)
            }
            Waiting::InTime { velocity, tolerance, .. } => {
                let contacts = Box::new(ensemble.in_time_with(monitor)?);
                // Single contacts break at random: the scatter of slips is far above the tolerance of the master equation.
                let tolerance = tolerance.max(self.mean * finite_size_tolerance(ensemble.size()));
                (self.table.in_time(true), Waiting::InTime { contacts, velocity: *velocity, tolerance })
            }
        };
        let block = built?.with_background(self.block.background())?;
        Ok(Self { table: self.table.clone(), block, contacts, ..*self })
    }

    /// The regime behind a spring.
    ///
    /// # Errors
    /// Those of [`Block::regime`] and [`Block::regime_in_time`].
    pub fn regime(&self, stiffness: f64, monitor: &mut dyn Monitor) -> Result<Regime> {
        let block = self.block.with_stiffness(stiffness).map_err(|e| e.under("block"))?;
        // The first loading, up to the force at which all contacts are stretched by the mean threshold.
        let [loading, sliding] = [self.mean * self.all / stiffness, self.mean * SLIDE];
        match &self.contacts {
            Waiting::Quasistatic(contacts) => block.regime(contacts.as_ref(), loading + sliding, monitor),
            Waiting::InTime { contacts, velocity, tolerance } => {
                block.regime_in_time(contacts.as_ref(), *velocity, [loading, sliding], *tolerance, monitor)
            }
        }
    }

    /// The stiffness at which persistent stick-slip ends.
    ///
    /// # Errors
    /// Those of [`PersistenceLimit::find`].
    pub fn limit(&self, resolution: f64, monitor: &mut dyn Monitor) -> Result<PersistenceLimit> {
        // Stick-slip has to begin, by the first pull or from steady sliding, so that the search begins there; behind any spring
        // where the force jumps.
        let begins = self.critical.map(|critical| if critical.is_finite() { critical } else { self.all });
        self.limit_from(begins.into_iter().fold(0.0, f64::max), resolution, monitor)
    }

    /// The same in a search that begins where stick-slip over infinitely many contacts ends, `expected`, if it does.
    ///
    /// # Errors
    /// Those of [`PersistenceLimit::find`].
    pub fn limit_near(
        &self,
        expected: PersistenceLimit,
        resolution: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<PersistenceLimit> {
        if expected.persists > 0.0 && expected.ended.is_finite() {
            return self.limit_from(expected.ended, resolution, monitor);
        }
        self.limit(resolution, monitor)
    }

    fn limit_from(
        &self,
        highest: f64,
        resolution: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<PersistenceLimit> {
        let highest = highest.max(SOFTEST * self.all);
        let lowest = (SOFTEST * self.all).max(self.block.least_stiffness());
        let range = [lowest.min(highest), highest];
        let bisections = (2f64.ln() / resolution.ln_1p()).log2().max(0.0).ceil();
        let mut progress = SearchProgress { fraction: 0.0, halvings: HALVINGS, bisections, persists: false };
        PersistenceLimit::find(range, resolution, |stiffness| {
            let (done, share) = progress.next_motion();
            let regime = self.regime(stiffness, &mut Part::new(monitor, done, share))?;
            progress.persists |= matches!(regime, Regime::Persistent { .. });
            Ok(regime)
        })
    }

    /// Stiffness of the spring of the block.
    pub fn stiffness(&self) -> f64 {
        self.table.stiffness
    }

    /// The answer, with the regime of the block and a limit that were found.
    pub fn answer(&self, regime: Regime, limit: PersistenceLimit) -> StickSlipStability {
        let [critical_stiffness, critical_stiffness_sliding] = self.critical;
        let stiffness = self.stiffness();
        let limit = limit.with(stiffness, &regime);
        StickSlipStability { stiffness, regime, limit, critical_stiffness, critical_stiffness_sliding }
    }
}

impl StickSlipStability {
    /// The numbers of a summary, at a velocity of the load point.
    pub fn numbers(&self, velocity: Option<f64>) -> StickSlipNumbers {
        StickSlipNumbers {
            velocity,
            stiffness: self.stiffness,
            stick_slip: self.regime.into(),
            reason: self.regime.to_string(),
            mean_drop: match self.regime {
                Regime::Persistent { drop, .. } => Some(drop),
                _ => None,
            },
            persistent_stiffness: self.limit.persists,
            persistent_stiffness_above: Extended(self.limit.ended),
            critical_stiffness: Extended(self.critical_stiffness),
            critical_stiffness_sliding: Extended(self.critical_stiffness_sliding),
            ensemble: None,
        }
    }
}

fn block_of(model: &Model) -> Result<&scenario::Block> {
    model.block.as_ref().ok_or_else(|| Error::invalid("block", "a slider behind a spring", "none"))
}

/// The slider of `model`.
fn slider(model: &Model) -> Result<Block> {
    let table = block_of(model)?;
    let built = if model.contacts.rules.are_time_dependent() {
        table.in_time(false)
    } else {
        Drive::default().slider(Some(table), false)
    };
    built.and_then(|block| block.with_background(model.background))
}

/// The velocity, if the contacts depend on time.
fn velocity_of(contacts: &Contacts, velocity: Option<f64>) -> Result<Option<f64>> {
    let Some(rule) = contacts.rules.first() else { return Ok(None) };
    let expected = || format!("a velocity above 0, since contacts.{rule} makes contacts time-dependent");
    let velocity = velocity.ok_or_else(|| Error::invalid("velocity", expected(), "none"))?;
    positive("velocity", velocity)?;
    Ok(Some(velocity))
}

/// K_c of steady sliding, for the mass and the damping of a block; 0 if small deviations never grow.
fn critical_in_sliding(
    contacts: &Contacts,
    velocity: f64,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    let (mass, damping) = block.slip.inertia_and_drag()?;
    let response = DynamicStiffness::new_with(contacts, velocity, monitor)?;
    let aside = &mut Part::new(monitor, 1.0, 0.0);
    let critical = response.critical_stiffness(Slider { mass, damping }, aside)?;
    Ok(critical.map_or(0.0, |found| found.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_rises_with_each_motion_and_ends_at_one() {
        for halvings in [0, 2, 9] {
            let mut progress =
                SearchProgress { fraction: 0.0, halvings: HALVINGS, bisections: 7.0, persists: false };
            let mut ends: f64 = 0.0;
            for motion in 0..halvings + 1 + 7 {
                progress.persists = motion > halvings;
                let (done, share) = progress.next_motion();
                // Each motion begins where the one before ended.
                assert!((done - ends).abs() < 1e-14 && share > 0.01, "{halvings}, {motion}: {done} {share}");
                ends = done + share;
            }
            assert!((ends - 1.0).abs() < 1e-14, "{ends}");
        }
    }
}
