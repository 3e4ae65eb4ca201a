//! Snapshots of contacts followed through time.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Transport;
use super::broken::Broken;
use super::cohort::{Cohort, EnergyChange};
use super::contact_ages::ContactAges;
use super::step_control::StepControl;
use crate::Result;
use crate::rate_dependent::ContactsState;

/// The state of the contacts, without the second solution.
#[derive(Serialize, Deserialize)]
struct TransportSnapshot {
    time: f64,
    position: f64,
    cohorts: Vec<Cohort>,
    broken: Broken,
    dropped: f64,
    slid: f64,
    spent: EnergyChange,
    pace: StepControl,
    rate: f64,
    steady_breaks: Option<f64>,
    kinks: Vec<f64>,
    ages: Option<ContactAges>,
}

impl Transport {
    /// The present state.
    pub(super) fn snapshot(&self) -> ContactsState {
        let &Self { time, position, dropped, slid, spent, rate, steady_breaks, .. } = self;
        let Self { broken, pace, kinks, ages, .. } = self.clone();
        let cohorts = self.cohorts.to_vec();
        ContactsState::of(&TransportSnapshot {
            time,
            position,
            cohorts,
            broken,
            dropped,
            slid,
            spent,
            pace,
            rate,
            steady_breaks,
            kinks,
            ages,
        })
    }

    /// Restores a state of contacts with the same description.
    pub(super) fn resume(&mut self, state: &ContactsState) -> Result<()> {
        let read: TransportSnapshot = state.read()?;
        let TransportSnapshot { time, position, dropped, slid, spent, rate, steady_breaks, .. } = read;
        let TransportSnapshot { cohorts, broken, pace, kinks, ages, .. } = read;
        if !cohorts.iter().all(|cohort| cohort.fits(&self.model)) || ages.is_some() != self.ages.is_some() {
            return Err(ContactsState::another("that of contacts whose thresholds follow other rules"));
        }
        (self.time, self.position, self.dropped, self.slid, self.spent, self.rate) =
            (time, position, dropped, slid, spent, rate);
        (self.cohorts, self.kinks, self.ages) = (Arc::new(cohorts), kinks, ages);
        self.steady_breaks = steady_breaks;
        (self.broken, self.pace) = (broken.of(&self.broken), pace.of(&self.pace));
        (self.rough, self.steady, self.before) = (None, None, None);
        self.constant.restart();
        Ok(())
    }
}
