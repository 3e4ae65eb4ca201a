//! The path of a creeping slider.

use crate::rate_dependent::RateDependentContacts;

/// A state of a creeping slider.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CreepState {
    /// Time t.
    pub time: f64,
    /// Position X.
    pub position: f64,
    /// dt/dX, 0 or below at failure, infinite at rest.
    pub slowness: f64,
    /// Force of the contacts.
    pub force: f64,
}

impl CreepState {
    pub(super) fn of(contacts: &dyn RateDependentContacts, time: f64, position: f64, slowness: f64) -> Self {
        Self { time, position, slowness, force: contacts.force() }
    }

    /// The state at a position between this one and the next.
    fn towards(&self, next: &Self, position: f64) -> Self {
        let (by, during) = (next.position - self.position, next.time - self.time);
        let share = (position - self.position) / by;
        let [start, end] = [self.slowness, next.slowness].map(|slowness| slowness * by / during);
        let rest = 1.0 - share;
        let smooth = share * share * (3.0 - 2.0 * share) + share * rest * (start * rest - end * share);
        // Beside a slider at rest the velocity is not known.
        let smooth = if smooth.is_finite() { smooth.clamp(0.0, 1.0) } else { share };
        Self {
            time: self.time + smooth * during,
            position,
            slowness: rest * self.slowness + share * next.slowness,
            force: rest * self.force + share * next.force,
        }
    }

    /// The velocity, infinite at failure.
    pub fn velocity(&self) -> f64 {
        if self.slowness > 0.0 { 1.0 / self.slowness } else { f64::INFINITY }
    }
}

/// The path of a slider under an imposed force.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CreepPath {
    /// States at rising times, the first at t = 0, the last at the end of the duration or at failure.
    pub states: Vec<CreepState>,
    /// Index of the state at which the force has been raised; that of the last one if the slider fails before.
    pub loaded: usize,
    /// Whether the slider fails at the last state.
    pub fails: bool,
}

impl CreepPath {
    pub(super) fn from(start: CreepState) -> Self {
        Self { states: vec![start], loaded: 0, fails: false }
    }

    pub(super) fn failed(mut self) -> Self {
        let last = self.states.len() - 1;
        if self.loaded == 0 {
            self.loaded = last;
        }
        self.fails = true;
        self
    }

    /// Whether the slider slides steadily after a slip S since the force has been raised: S is at least `shortest`, and the mean
    /// velocities in its second half and in the quarter before differ by less than the tolerance, relatively. Both lengths grow
    /// with S, so that a velocity that drifts as a power of S is not steady.
    pub(super) fn is_steady(&self, shortest: f64, tolerance: f64) -> bool {
        let states = &self.states[self.loaded..];
        let (first, last) = (states[0], self.last());
        let slip = last.position - first.position;
        if slip < shortest {
            return false;
        }
        let after =
            |fraction: f64| states.partition_point(|state| state.position < first.position + fraction * slip);
        let [quarter, half] = [0.25, 0.5].map(|fraction| states[after(fraction)]);
        let slowness =
            |from: CreepState, to: CreepState| (to.time - from.time) / (to.position - from.position);
        (slowness(quarter, half) / slowness(half, last) - 1.0).abs() < tolerance
    }

    /// Adds the state at a time up to which the slider keeps its velocity.
    pub(super) fn slide_steadily(&mut self, end: f64) {
        let last = self.last();
        if last.time < end {
            let position = last.position + (end - last.time) / last.slowness;
            self.states.push(CreepState { time: end, position, ..last });
        }
    }

    /// The last state.
    ///
    /// # Panics
    /// Never: a path has a first state.
    pub fn last(&self) -> CreepState {
        self.states[self.states.len() - 1]
    }

    /// Whether the slider fails before the force has been raised.
    pub fn fails_in_loading(&self) -> bool {
        self.fails && self.loaded + 1 == self.states.len()
    }

    /// Time of the failure; `None` if the slider does not fail.
    pub fn failure_time(&self) -> Option<f64> {
        self.fails.then_some(self.last().time)
    }

    /// The slowest state after the force has been raised: of a slider that fails, secondary creep.
    pub fn slowest(&self) -> CreepState {
        let states = &self.states[self.loaded..];
        let last = self.last();
        states
            .iter()
            .skip(1)
            .fold(last, |slow, state| if state.slowness > slow.slowness { *state } else { slow })
    }

    /// The state at a fraction, from 0 to 1, of the slip after the force has been raised, by cubic Hermite interpolation of t(X);
    /// `None` if the slider fails before.
    pub fn at_fraction(&self, fraction: f64) -> Option<CreepState> {
        if self.fails_in_loading() {
            return None;
        }
        let (states, last) = (&self.states[self.loaded..], self.last());
        let begun = states[0].position;
        let position = begun + fraction * (last.position - begun);
        let after = states.partition_point(|state| state.position <= position);
        if after == states.len() || fraction == 1.0 {
            return Some(last);
        }
        Some(states[after - 1].towards(&states[after], position))
    }

    /// The largest difference from another path as a length: of times to failure relative to them in units of length, or of last
    /// positions.
    pub fn difference(&self, other: &Self, unit: f64) -> f64 {
        match (self.failure_time(), other.failure_time()) {
            (Some(own), Some(other)) => unit * ((own - other) / own).abs(),
            _ => (self.last().position - other.last().position).abs(),
        }
    }
}
