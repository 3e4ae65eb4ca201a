//! Contacts that were born together.

use serde::{Deserialize, Serialize};

use super::broken::BrokenShare;
use super::model::{CohortModel, CohortThresholds, Tools};
use super::path::{Path, StepPart};
use super::seeds::Seed;
use crate::monitor::Watch;
use crate::rate_dependent::StretchInterval;

/// Where the contacts of a cohort are: at one stretch, or spread evenly over a cell around it.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Place {
    pub(super) stretch: f64,
    /// How far the cell reaches below the stretch …
    pub(super) below: f64,
    /// … and above it.
    pub(super) above: f64,
    pub(super) age: f64,
}

/// Contacts that were born together: exact in stretch, whatever happens to their thresholds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Cohort {
    /// The fraction of all contacts that it was born with.
    pub(super) mass: f64,
    pub(super) place: Place,
    /// The number of the seed that they re-formed at.
    seed: Option<u32>,
    /// The thresholds of those that are left, …
    state: CohortThresholds,
    /// … their share, and their stiffness per contact born, in units of ⟨k⟩ or κ.
    pub(super) left: f64,
    stiffness: f64,
}

/// Energies, per unit of the stiffness of all.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Spent {
    /// Σ ½k x² of what broke.
    pub(super) lost: f64,
    /// ∫Σ ½x² dk of what holds.
    pub(super) gained: f64,
}

impl Spent {
    /// From the changes of the stiffness in the halves of a way from one stretch to another, and the part that ageing has
    /// in them: ½∫x² dk, the stiffness being a parabola that changes at the rate a + bs, 0 ≤ s ≤ 1.
    fn on(from: f64, to: f64, changes: [f64; 2], aged: [f64; 2]) -> Self {
        let way = to - from;
        let mean = from * from + way * (from + way / 3.0);
        let tilted = 0.5 * from * from + way * (2.0 / 3.0 * from + 0.25 * way);
        let energy = |[first, second]: [f64; 2]| {
            0.5 * ((3.0 * first - second) * mean + 4.0 * (second - first) * tilted)
        };
        let gained = energy(aged);
        Self { lost: gained - energy(changes), gained }
    }

    /// Both together, `other` taken so many times.
    pub(super) fn plus(self, times: f64, other: Self) -> Self {
        Self { lost: self.lost + times * other.lost, gained: self.gained + times * other.gained }
    }
}

impl Place {
    /// Whether all have one stretch.
    pub(super) fn is_point(&self) -> bool {
        self.below + self.above == 0.0
    }
}

impl Cohort {
    /// Contacts of age 0.
    pub(super) fn born(model: &CohortModel, seed: &Seed, mass: f64, watch: &Watch<'_>) -> Self {
        let &Seed { stretch, below, above, number, .. } = seed;
        let place = Place { stretch, below, above, age: 0.0 };
        let state = model.newborn(seed, watch);
        let mut cohort = Self { mass, place, seed: number, state, left: 1.0, stiffness: 0.0 };
        cohort.count(model);
        cohort
    }

    /// Whether it may have been made by a model.
    pub(super) fn fits(&self, model: &CohortModel) -> bool {
        model.fits(&self.state)
    }

    /// Goes a whole step: what breaks, and energies, with the stiffness as a parabola in time.
    pub(super) fn cross(
        &mut self,
        model: &CohortModel,
        path: &Path,
        tools: &mut Tools<'_, '_>,
    ) -> (BrokenShare, Spent) {
        let (from, stiffness) = (self.place.stretch, self.tangent());
        let (middle, first) = self.advance(model, path, StepPart::First, tools);
        let between = self.tangent();
        let (end, second) = self.advance(model, path, StepPart::Second, tools);
        let changes = [between - stiffness, self.tangent() - between];
        let spent = Spent::on(from, self.place.stretch, changes, [first, second]);
        (BrokenShare { middle, end: middle + end }, spent)
    }

    /// Goes from where it is born in a step to its end: the fraction of all contacts that breaks, and energies.
    pub(super) fn arrive(
        &mut self,
        model: &CohortModel,
        path: &Path,
        part: StepPart,
        tools: &mut Tools<'_, '_>,
    ) -> (f64, Spent) {
        let (from, stiffness) = (self.place.stretch, self.tangent());
        let (broken, aged) = self.advance(model, path, part, tools);
        let change = self.tangent() - stiffness;
        (broken, Spent::on(from, self.place.stretch, [0.5 * change; 2], [0.5 * aged; 2]))
    }

    /// Goes a part of a step: the fraction of all contacts that breaks, and by how much ageing makes the others stiffer.
    pub(super) fn advance(
        &mut self,
        model: &CohortModel,
        path: &Path,
        part: StepPart,
        tools: &mut Tools<'_, '_>,
    ) -> (f64, f64) {
        let before = self.left;
        let aged = model.advance(&mut self.state, self.place, path, part, tools);
        let (from, to) = part.ends();
        self.place.stretch += path.advance(from, to);
        self.place.age += path.time(part);
        self.count(model);
        (self.mass * (before - self.left), self.mass * aged)
    }

    /// Breaks those that stand where many do: the fraction of all contacts that does, and the energy lost.
    pub(super) fn strike(&mut self, model: &CohortModel) -> (f64, f64) {
        if !self.place.is_point() || !model.strike(&mut self.state, self.place) {
            return (0.0, 0.0);
        }
        let (before, energy) = (self.left, self.energy());
        self.count(model);
        (self.mass * (before - self.left), energy - self.energy())
    }

    /// When those at one stretch meet a threshold that many share, if they move at `velocity`, up to `limit`.
    pub(super) fn strikes(&self, model: &CohortModel, velocity: f64, limit: f64) -> Option<f64> {
        if self.place.is_point() { model.strikes(&self.state, self.place, velocity, limit) } else { None }
    }

    /// Counts who is left; none comes back.
    fn count(&mut self, model: &CohortModel) {
        let (left, stiffness) = model.measure(&self.state, self.place.age);
        self.left = left.clamp(0.0, self.left);
        self.stiffness = stiffness;
    }

    /// Contacts, as a fraction of all.
    pub(super) fn attached(&self) -> f64 {
        self.mass * self.left
    }

    /// The same by their stretches: over the cells of the law that their seed stands for, or over their own cell.
    pub(super) fn intervals(&self, seeds: &[Seed], cells: &[Vec<StretchInterval>]) -> Vec<StretchInterval> {
        let (Place { stretch, below, above, .. }, all) = (self.place, self.attached());
        let number = self.seed.map_or(usize::MAX, |number| number as usize);
        match (seeds.get(number), cells.get(number)) {
            (Some(seed), Some(cells)) if !cells.is_empty() => {
                // By so much they have been spread as they were born in a step.
                let (before, after) = (below - seed.below, above - seed.above);
                let moved = |cell: &StretchInterval| StretchInterval {
                    low: stretch + cell.low - before,
                    high: stretch + cell.high + after,
                    share: all * cell.share,
                };
                cells.iter().map(moved).collect()
            }
            _ => vec![StretchInterval { low: stretch - below, high: stretch + above, share: all }],
        }
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
