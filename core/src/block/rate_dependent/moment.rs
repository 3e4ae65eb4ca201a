//! The state of a slider at one time.

use serde::{Deserialize, Serialize};

use crate::block::{EnergyBalance, Point};
use crate::dynamics::crossing;

/// The state of a slider at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Moment {
    /// Time t since the start.
    pub time: f64,
    /// Drive X_T.
    pub drive: f64,
    /// Position X.
    pub position: f64,
    /// Velocity Ẋ.
    pub velocity: f64,
    /// Friction force F.
    pub force: f64,
    /// Force of the spring, K(X_T − X).
    pub spring_force: f64,
    /// Fraction of detached contacts.
    pub free: f64,
    /// Breaks so far, per contact.
    pub broken: f64,
    /// Present stored energies, and energies supplied and dissipated since the start.
    pub energy: EnergyBalance,
}

impl Moment {
    /// The state between this one and `next` at which the velocity is `velocity`, by linear interpolation in time.
    pub(super) fn until(&self, next: &Self, velocity: f64) -> Self {
        let fraction = crossing(self.velocity, next.velocity, velocity);
        let between = |value: fn(&Self) -> f64| value(self) + fraction * (value(next) - value(self));
        Self {
            time: between(|m| m.time),
            drive: between(|m| m.drive),
            position: between(|m| m.position),
            velocity,
            force: between(|m| m.force),
            spring_force: between(|m| m.spring_force),
            free: between(|m| m.free),
            broken: between(|m| m.broken),
            energy: self.energy + (next.energy - self.energy) * fraction,
        }
    }

    /// Time and velocity.
    pub(super) fn time_and_velocity(&self) -> (f64, f64) {
        (self.time, self.velocity)
    }

    /// Drive, position and forces.
    pub fn point(&self) -> Point {
        let &Self { drive, position, force, spring_force, .. } = self;
        Point { drive, position, force, spring_force }
    }
}
