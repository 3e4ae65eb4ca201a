//! Sliding that needs no steps: at constant velocity once it has become steady, and as long as all contacts are free.
//!
//! With p(a) the density of the time from one break of a contact to its next, free time included, the breaking rate is
//! Γ(t) = ∫Γ(t − a) p(a) da. As an average of its past values it stays within their bounds: a rate that was constant for as long
//! as contacts live and are free remains so, and so do the contacts.

use super::Transport;
use super::broken::BrokenFraction;
use super::cohort::{Cohort, EnergyChange};

/// The time since which the breaking rate has been constant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ConstantRate {
    begun: Option<ConstantPeriod>,
    /// Whether steady sliding is computed step by step all the same.
    unused: bool,
}

/// A time of constant breaking, and what had broken at its beginning.
#[derive(Debug, Clone, Copy)]
struct ConstantPeriod {
    time: f64,
    /// Bounds of the mean rates of steps since.
    rates: (f64, f64),
    /// Sums at its beginning.
    broken: f64,
    slid: f64,
    spent: EnergyChange,
}

impl ConstantRate {
    /// That of contacts that are followed in steps although they slide steadily: two solutions whose difference matters make the
    /// same errors in the same steps.
    pub(super) fn unused() -> Self {
        Self { begun: None, unused: true }
    }

    /// The rate may change from here on.
    pub(super) fn restart(&mut self) {
        self.begun = None;
    }
}

/// Largest relative difference of breaking rates that are constant, in units of the tolerance.
const CONSTANT: f64 = 0.03;

impl Transport {
    /// Updates the time of constant breaking by a step at a constant velocity that broke a fraction of the contacts at this mean
    /// rate.
    pub(super) fn watch_rate(&mut self, rate: f64) {
        let (low, high) = self.constant.begun.map_or((rate, rate), |begun| {
            let (low, high) = begun.rates;
            (low.min(rate), high.max(rate))
        });
        match &mut self.constant.begun {
            Some(begun) if high - low <= CONSTANT * self.tolerance * low => begun.rates = (low, high),
            begun => {
                let (broken, slid, spent) = (self.broken.all(), self.slid, self.spent);
                *begun = Some(ConstantPeriod { time: self.time, rates: (rate, rate), broken, slid, spent });
            }
        }
    }

    /// How long no contact will be attached, if none is. What has not been counted as broken must be rounding, since it would be
    /// spread over that time.
    pub(super) fn free_for(&self) -> Option<f64> {
        let all_free = self.cohorts.is_empty() && self.ages.is_none() && self.dropped <= f64::EPSILON;
        let until = all_free.then(|| self.broken.free_until(super::LEAST * self.tolerance)).flatten()?;
        Some(until - self.time)
    }

    /// Moves for a time in which all contacts are free.
    pub(super) fn slide_free(&mut self, velocity: f64, during: f64) {
        self.slid += velocity.abs() * during * self.free();
        self.broken.keep(self.time, during, BrokenFraction::default(), 0.0);
        self.time += during;
        self.position += velocity * during;
        (self.rate, self.before) = (0.0, None);
        self.pace.restart();
        self.constant.restart();
    }

    /// Whether the contacts slide steadily: they have broken at a constant rate for as long as the oldest of them are attached,
    /// and the longest free.
    pub(super) fn is_settled(&self) -> bool {
        let Some(begun) = &self.constant.begun else { return false };
        let longest = self.time - begun.time - self.broken.longest_free();
        // A rate is not constant yet after its first step, even where the last contacts have just broken.
        !self.constant.unused
            && longest > 0.0
            && begun.rates.0 > 0.0
            && self.ages.is_none()
            && self.kinks.is_empty()
            && !self.broken.is_pending()
            // The oldest come first, so that hardly more than one is looked at before.
            && self.cohorts.iter().all(|cohort| cohort.place.age < longest)
    }

    /// Whether the contacts slide steadily on at a velocity for a time, which they then do. The stretches of time-independent
    /// contacts do not change in steady sliding at any velocity, nor at rest, until the slider moves back.
    pub(super) fn remains_steady(&mut self, velocity: f64, during: f64) -> bool {
        self.steady_breaks = self.steady_breaks.filter(|_| velocity >= 0.0);
        let Some(breaks) = self.steady_breaks else { return false };
        let by = velocity * during;
        self.broken.continue_steadily(during, breaks * by);
        // The energy of the contacts remains, so that they lose the work of the slider.
        self.spent.lost += by * self.cohorts.iter().map(Cohort::force).sum::<f64>();
        self.time += during;
        self.position += by;
        self.rate = breaks * velocity;
        self.before = None;
        true
    }

    /// Continues steady sliding at a velocity for a time, in which breaks and energies increase as they did since the rate has
    /// been constant.
    pub(super) fn slide_steadily(&mut self, velocity: f64, during: f64) {
        let Some(begun) = self.constant.begun else { return };
        let times = during / (self.time - begun.time);
        self.broken.continue_steadily(during, times * (self.broken.all() - begun.broken));
        self.spent = self.spent.plus(times, self.spent.plus(-1.0, begun.spent));
        self.slid += times * (self.slid - begun.slid);
        self.time += during;
        self.position += velocity * during;
        self.before = None;
        self.constant.restart();
    }
}
