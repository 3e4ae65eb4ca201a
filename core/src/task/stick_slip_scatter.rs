//! Stick-slip over N single contacts: the answers of simulations with different contacts, and their scatter.

use super::stick_slip::{Springs, StickSlipStability};
use super::summary::{Extended, SimulatedStickSlip, StickSlipKind};
use crate::block::{PersistenceLimit, Regime};
use crate::monitor::{Monitor, Part, report};
use crate::scenario::Model;
use crate::{Error, Result};

/// Fraction of the work for the master equation.
const MASTER: f64 = 0.2;

/// What a slider does over N single contacts, in several simulations.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StickSlipScatter {
    /// What the block does behind its spring, in each simulation.
    pub regimes: Vec<Regime>,
    /// The stiffness at which persistent stick-slip ends, in each simulation.
    pub limits: Vec<PersistenceLimit>,
}

/// As [`stick_slip_stability`](super::stick_slip_stability), and in addition the answers over the single contacts of the ensemble
/// of `model`, in `simulations` simulations with different contacts. An event is a slip if it breaks more than
/// `block.slip_fraction` of the contacts, and breaks of single contacts set off small slips at any stiffness: with few contacts
/// stick-slip may be found to persist above the stiffness at which it ends for infinitely many, with smaller drops of the force.
///
/// ```
/// use std::sync::Arc;
/// use asperity::block::{Regime, Slip};
/// use asperity::contacts::{Contacts, Initial};
/// use asperity::law::{Gaussian, Point};
/// use asperity::scenario::{Block, Ensemble, Model};
/// use asperity::task::stick_slip_scatter;
///
/// let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// let block = Block { stiffness: 0.5, slip: Slip::Arrest, slip_fraction: 0.3 };
/// let ensemble = Ensemble { size: Some(200), ..Ensemble::default() };
/// let model = Model {
///     block: Some(block),
///     ensemble: Some(ensemble),
///     ..Model::new(contacts, Initial::default())
/// };
/// let (expected, found) = stick_slip_scatter(&model, None, 0.1, 3, &mut ())?;
/// assert!(matches!(expected.regime, Regime::Persistent { .. }));
/// assert!(found.regimes.iter().all(|regime| matches!(regime, Regime::Persistent { .. })));
/// # Ok::<(), asperity::Error>(())
/// ```
///
/// # Errors
/// Those of [`stick_slip_stability`](super::stick_slip_stability); a model without an ensemble, no simulations; contacts that
/// cannot be followed one by one, or do not fit in memory.
pub fn stick_slip_scatter(
    model: &Model,
    velocity: Option<f64>,
    resolution: f64,
    simulations: usize,
    monitor: &mut dyn Monitor,
) -> Result<(StickSlipStability, StickSlipScatter)> {
    if simulations == 0 {
        return Err(Error::invalid("simulations", "1 simulation or more", 0));
    }
    let part = &mut Part::new(monitor, 0.0, MASTER);
    let (springs, expected) = Springs::answered(model, velocity, resolution, part)?;
    let part = &mut Part::new(monitor, MASTER, 1.0 - MASTER);
    let found = each_simulation(model, &springs, simulations, part, |springs, part| {
        let regime = springs.regime(springs.stiffness(), &mut Part::new(part, 0.0, 0.1))?;
        let limit = springs.limit_near(expected.limit, resolution, &mut Part::new(part, 0.1, 0.9))?;
        Ok((regime, limit.with(springs.stiffness(), &regime)))
    })?;
    report(monitor, 1.0)?;
    let (regimes, limits) = found.into_iter().unzip();
    Ok((expected, StickSlipScatter { regimes, limits }))
}

/// What `answer` finds for the slider over the single contacts of each simulation. The contacts of a simulation have numbers of
/// their own in the random streams of the seed.
///
/// # Errors
/// A model without an ensemble; contacts that cannot be followed one by one, or do not fit in memory; those of `answer`.
pub(super) fn each_simulation<T>(
    model: &Model,
    springs: &Springs,
    simulations: usize,
    monitor: &mut dyn Monitor,
    mut answer: impl FnMut(&Springs, &mut dyn Monitor) -> Result<T>,
) -> Result<Vec<T>> {
    let missing = || Error::invalid("ensemble", "a table that describes the single contacts", "none");
    let table = model.ensemble.as_ref().ok_or_else(missing)?;
    let drawn = table.build(model.contacts.clone(), model.initial.clone())?;
    let share = 1.0 / simulations as f64;
    let one = |i: usize| {
        let part = &mut Part::new(monitor, i as f64 * share, share);
        let contacts = drawn.clone().numbered_from((i * drawn.size()) as u64);
        let springs = springs.over(&contacts, &mut Part::new(part, 0.0, 0.0))?;
        answer(&springs, part)
    };
    (0..simulations).map(one).collect()
}

impl StickSlipScatter {
    /// The numbers of a summary.
    pub fn numbers(&self) -> SimulatedStickSlip {
        let counted =
            |kind| self.regimes.iter().filter(|regime| StickSlipKind::from(**regime) == kind).count();
        let drops = drops(&self.regimes);
        let ends: Vec<f64> = self.limits.iter().map(end).collect();
        let scatters: Vec<f64> = self.regimes.iter().filter_map(period_scatter).collect();
        SimulatedStickSlip {
            simulations: self.regimes.len(),
            none: counted(StickSlipKind::None),
            transient: counted(StickSlipKind::Transient),
            persistent: counted(StickSlipKind::Persistent),
            undecided: counted(StickSlipKind::Undecided),
            mean_drop: mean(&drops),
            drop_std: deviation(&drops),
            period_scatter: mean(&scatters),
            persistent_stiffness: Extended(mean(&ends).unwrap_or(f64::NAN)),
            persistent_stiffness_std: deviation(&ends),
        }
    }
}

/// The stiffness up to which stick-slip persists; infinite where it persisted at all that were tried.
pub(super) fn end(limit: &PersistenceLimit) -> f64 {
    if limit.persists > 0.0 && limit.ended.is_infinite() { f64::INFINITY } else { limit.persists }
}

/// The mean force drops of persistent stick-slip.
pub(super) fn drops(regimes: &[Regime]) -> Vec<f64> {
    let drop = |regime: &Regime| match *regime {
        Regime::Persistent { drop, .. } => Some(drop),
        _ => None,
    };
    regimes.iter().filter_map(drop).collect()
}

fn period_scatter(regime: &Regime) -> Option<f64> {
    match *regime {
        Regime::Persistent { scatter, .. } => Some(scatter),
        _ => None,
    }
}

/// The mean; `None` without values.
pub(super) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The standard deviation, of which that of a sample is an estimate; `None` unless there are two values or more, all finite.
pub(super) fn deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|mean| mean.is_finite() && values.len() > 1)?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}
