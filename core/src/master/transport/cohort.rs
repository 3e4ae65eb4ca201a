//! Contacts that were born together.

use super::diffusing::Room;
use super::model::{Model, State, Way};
use super::path::Part;
use super::seeds::Seed;

/// Where the contacts of a cohort are: at one stretch, or spread evenly over a cell around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) stretch: f64,
    /// How far the cell reaches below the stretch …
    pub(super) below: f64,
    /// … and above it.
    pub(super) above: f64,
    pub(super) age: f64,
}

/// Contacts that were born together: exact in stretch, whatever happens to their thresholds.
#[derive(Debug, Clone)]
pub(super) struct Cohort {
    /// The fraction of all contacts that it was born with.
    pub(super) mass: f64,
    pub(super) place: Place,
    /// The thresholds of those that are left, …
    state: State,
    /// … their share, and their stiffness per contact born, in units of ⟨k⟩ or κ.
    pub(super) left: f64,
    stiffness: f64,
}

impl Place {
    /// Whether all have one stretch.
    pub(super) fn is_point(&self) -> bool {
        self.below + self.above == 0.0
    }
}

impl Cohort {
    /// Contacts of age 0.
    pub(super) fn born(model: &Model, seed: &Seed, mass: f64) -> Self {
        let &Seed { stretch, below, above, .. } = seed;
        let place = Place { stretch, below, above, age: 0.0 };
        let mut cohort = Self { mass, place, state: model.newborn(seed), left: 1.0, stiffness: 0.0 };
        cohort.count(model);
        cohort
    }

    /// Goes a part of a step; the fraction of all contacts that breaks.
    pub(super) fn advance(&mut self, model: &Model, way: &Way, part: Part, room: &mut Room) -> f64 {
        let before = self.left;
        model.advance(&mut self.state, self.place, way, part, room);
        let (from, to) = part.ends();
        self.place.stretch += way.path.advance(from, to);
        self.place.age += way.path.time(part);
        self.count(model);
        self.mass * (before - self.left)
    }

    /// Breaks those that stand where many do; the fraction of all contacts that does.
    pub(super) fn strike(&mut self, model: &Model) -> f64 {
        if !self.place.is_point() || !model.strike(&mut self.state, self.place) {
            return 0.0;
        }
        let before = self.left;
        self.count(model);
        self.mass * (before - self.left)
    }

    /// When those at one stretch meet a threshold that many share, if they move at `velocity`, up to `limit`.
    pub(super) fn strikes(&self, model: &Model, velocity: f64, limit: f64) -> Option<f64> {
        if self.place.is_point() { model.strikes(&self.state, self.place, velocity, limit) } else { None }
    }

    /// Counts who is left; none comes back.
    fn count(&mut self, model: &Model) {
        let (left, stiffness) = model.measure(&self.state, self.place.age);
        self.left = left.clamp(0.0, self.left);
        self.stiffness = stiffness;
    }

    /// Contacts, as a fraction of all.
    pub(super) fn attached(&self) -> f64 {
        self.mass * self.left
    }

    /// Force, per unit of the stiffness of all.
    pub(super) fn force(&self) -> f64 {
        self.tangent() * self.place.stretch
    }

    /// dF/dX of what is left, per unit of the stiffness of all.
    pub(super) fn tangent(&self) -> f64 {
        self.mass * self.stiffness
    }

    /// Elastic energy, per unit of the stiffness of all.
    pub(super) fn energy(&self) -> f64 {
        0.5 * self.force() * self.place.stretch
    }
}
