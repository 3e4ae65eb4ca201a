//! All that changes as contacts are followed, to be kept and taken up again.

use serde::{Deserialize, Serialize};

use super::Transport;
use super::broken::Broken;
use super::cohort::{Cohort, Spent};
use super::pace::Pace;
use crate::Result;
use crate::rate_dependent::ContactsState;

/// What contacts have come to, without the rough follower beside them.
#[derive(Serialize, Deserialize)]
struct TransportSnapshot {
    time: f64,
    position: f64,
    cohorts: Vec<Cohort>,
    broken: Broken,
    dropped: f64,
    spent: Spent,
    pace: Pace,
    rate: f64,
    kinks: Vec<f64>,
}

impl Transport {
    /// What the contacts have come to.
    pub(super) fn kept(&self) -> ContactsState {
        let &Self { time, position, dropped, spent, rate, .. } = self;
        let Self { cohorts, broken, pace, kinks, .. } = self.clone();
        ContactsState::of(&TransportSnapshot {
            time,
            position,
            cohorts,
            broken,
            dropped,
            spent,
            pace,
            rate,
            kinks,
        })
    }

    /// Goes to what contacts of the same description have come to.
    pub(super) fn resume(&mut self, state: &ContactsState) -> Result<()> {
        let TransportSnapshot { time, position, cohorts, broken, dropped, spent, pace, rate, kinks } =
            state.read()?;
        if !cohorts.iter().all(|cohort| cohort.fits(&self.model)) {
            return Err(ContactsState::another("that of contacts whose thresholds follow other rules"));
        }
        (self.time, self.position, self.dropped, self.spent, self.rate) =
            (time, position, dropped, spent, rate);
        (self.cohorts, self.kinks) = (cohorts, kinks);
        (self.broken, self.pace) = (broken.of(self.delay), pace.of(&self.pace));
        self.rough = None;
        Ok(())
    }
}
