//! A cohort: contacts that formed together.

use serde::{Deserialize, Serialize};

use super::broken::BrokenFraction;
use super::merging_limits::MergingLimits;
use super::model::{CohortModel, CohortThresholds};
use super::path::{Path, Place, StepPart};
use super::seeds::Seed;
use super::step_context::StepContext;
use crate::monitor::Watch;
use crate::rate_dependent::StretchInterval;

/// Contacts that formed together: their stretch is exact, whatever happens to their thresholds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Cohort {
    /// The fraction of all contacts that formed with it.
    pub(super) mass: f64,
    pub(super) place: Place,
    /// Index of the seed at which they re-formed.
    seed: Option<u32>,
    /// The thresholds of the surviving contacts.
    state: CohortThresholds,
    /// Their fraction of the cohort, and their stiffness per formed contact, in units of ⟨k⟩ or κ.
    pub(super) left: f64,
    stiffness: f64,
    /// Attached fraction times the variance of breaking stretches that merging with others has replaced by its mean.
    spread: f64,
}

/// Energies, in units of the total stiffness.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct EnergyChange {
    /// Σ ½k x² of broken contacts.
    pub(super) lost: f64,
    /// ∫Σ ½x² dk of surviving contacts: the work done by ageing.
    pub(super) strengthening: f64,
}

/// Stiffness and force of some cohorts, in units of the total stiffness.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CohortForce {
    pub(super) stiffness: f64,
    pub(super) force: f64,
}

/// What a step does to a cohort, or to several.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CohortStep {
    pub(super) fraction: BrokenFraction,
    pub(super) spent: EnergyChange,
    /// Those of an old cohort in the middle of the step, and of a new one where it formed.
    pub(super) passed: CohortForce,
}

impl CohortForce {
    /// The sum over these cohorts.
    pub(super) fn of(cohorts: &[Cohort]) -> Self {
        cohorts.iter().fold(Self::default(), |sum, cohort| sum.plus(cohort.stiffness_and_force()))
    }

    fn plus(self, other: Self) -> Self {
        Self { stiffness: self.stiffness + other.stiffness, force: self.force + other.force }
    }
}

impl CohortStep {
    pub(super) fn plus(self, other: &Self) -> Self {
        Self {
            fraction: self.fraction.plus(other.fraction),
            spent: self.spent.plus(1.0, other.spent),
            passed: self.passed.plus(other.passed),
        }
    }
}

impl EnergyChange {
    /// From the changes of the stiffness in the two halves of a motion between two stretches, and the parts
    /// of these changes due to ageing: ½∫x² dk, with the stiffness a parabola whose rate of change is a + bs,
    /// 0 ≤ s ≤ 1.
    fn on(from: f64, to: f64, changes: [f64; 2], aged: [f64; 2]) -> Self {
        let way = to - from;
        // ∫x² ds and ∫x² s ds for a stretch linear in s, multiplied out so that nothing cancels for
        // short steps.
        let mean = from * from + way * (from + way / 3.0);
        let tilted = 0.5 * from * from + way * (2.0 / 3.0 * from + 0.25 * way);
        let energy = |[first, second]: [f64; 2]| {
            0.5 * ((3.0 * first - second) * mean + 4.0 * (second - first) * tilted)
        };
        let strengthening = energy(aged);
        Self { lost: strengthening - energy(changes), strengthening }
    }

    /// The sum with `times` × `other`.
    pub(super) fn plus(self, times: f64, other: Self) -> Self {
        Self {
            lost: self.lost + times * other.lost,
            strengthening: self.strengthening + times * other.strengthening,
        }
    }
}

impl Cohort {
    /// Contacts of age 0.
    pub(super) fn born(model: &CohortModel, seed: &Seed, mass: f64, watch: &Watch<'_>) -> Self {
        let &Seed { stretch, below, above, number, .. } = seed;
        let place = Place { stretch, below, above, age: 0.0 };
        let state = model.fresh(seed, watch);
        let mut cohort = Self { mass, place, seed: number, state, left: 1.0, stiffness: 0.0, spread: 0.0 };
        cohort.update(model, watch);
        cohort
    }

    /// Bytes that it takes beside its place in a list.
    pub(super) fn bytes(&self) -> u64 {
        self.state.bytes()
    }

    /// Its seed, if its contacts have re-formed.
    pub(super) fn seed(&self) -> Option<u32> {
        self.seed
    }

    /// Merges with contacts that break at about the same stretch, unless that would replace more than the limits allow: the
    /// attached fraction and the force remain, stretch, age and threshold reached become their means. Returns the elastic
    /// energy of the differences of stretch, which is lost; `None` if they remain apart.
    pub(super) fn absorb(
        &mut self,
        other: &Self,
        model: &CohortModel,
        limits: MergingLimits,
        watch: &Watch<'_>,
    ) -> Option<f64> {
        let [own, more] = [self.attached(), other.attached()];
        let all = own + more;
        let (place, then) = (self.place, other.place);
        let distance = model.distance((&self.state, place), (&other.state, then))?;
        let part = more / all;
        let spread = self.spread + other.spread + own * part * distance * distance;
        let low = (place.stretch - place.below).min(then.stretch - then.below);
        let high = (place.stretch + place.above).max(then.stretch + then.above);
        // The spread of cohorts without contacts is NaN.
        if spread.is_nan() || spread > limits.spread || high - low > limits.width {
            return None;
        }
        let age = place.age + part * (then.age - place.age);
        let state = model.merged((&self.state, self.mass), (&other.state, other.mass), part);
        let (left, measured) = model.measure(&state, age, watch);
        if left.is_nan() || left <= 0.0 {
            return None;
        }
        let energy = self.energy() + other.energy();
        let stiffness = self.tangent() + other.tangent();
        // The force remains where stiffnesses depend on thresholds, too.
        let stretch = place.stretch + other.tangent() / stiffness * (then.stretch - place.stretch);
        self.place = Place { stretch, below: stretch - low, above: high - stretch, age };
        (self.mass, self.left, self.spread) = (all / left, left, spread);
        // Equal stiffnesses are the surviving fraction, to the last digit.
        self.stiffness = if measured == left { left } else { stiffness / self.mass };
        self.state = state;
        self.seed = self.seed.filter(|_| self.seed == other.seed);
        Some(energy - self.energy())
    }

    /// Whether the model can have made it.
    pub(super) fn fits(&self, model: &CohortModel) -> bool {
        model.fits(&self.state)
    }

    /// Advances by a whole step, with the stiffness as a parabola in time for the energies.
    pub(super) fn advance_step(
        &mut self,
        model: &CohortModel,
        path: &Path,
        context: &mut StepContext<'_, '_>,
    ) -> CohortStep {
        let (from, stiffness) = (self.place.stretch, self.tangent());
        let (middle, first) = self.advance(model, path, StepPart::First, context);
        let (between, passed) = (self.tangent(), self.stiffness_and_force());
        let (end, second) = self.advance(model, path, StepPart::Second, context);
        let changes = [between - stiffness, self.tangent() - between];
        let spent = EnergyChange::on(from, self.place.stretch, changes, [first, second]);
        CohortStep { fraction: BrokenFraction { middle, end: middle + end }, spent, passed }
    }

    /// Advances from formation within a step to its end.
    pub(super) fn advance_from_formation(
        &mut self,
        model: &CohortModel,
        path: &Path,
        part: StepPart,
        context: &mut StepContext<'_, '_>,
    ) -> CohortStep {
        let (from, passed) = (self.place.stretch, self.stiffness_and_force());
        let (end, aged) = self.advance(model, path, part, context);
        let change = self.tangent() - passed.stiffness;
        let spent = EnergyChange::on(from, self.place.stretch, [0.5 * change; 2], [0.5 * aged; 2]);
        CohortStep { fraction: BrokenFraction { middle: 0.0, end }, spent, passed }
    }

    /// Advances by a part of a step: the fraction of all contacts that breaks, and the stiffness that the
    /// others gain by ageing.
    pub(super) fn advance(
        &mut self,
        model: &CohortModel,
        path: &Path,
        part: StepPart,
        context: &mut StepContext<'_, '_>,
    ) -> (f64, f64) {
        let before = self.left;
        let plain = model.advance_plain(&mut self.state, self.place, path, part);
        let aged = match plain {
            Some(_) => 0.0,
            None => model.advance(&mut self.state, self.place, path, part, context),
        };
        let (from, to) = part.ends();
        self.place.stretch += path.advance(from, to);
        self.place.age += path.time(part);
        match plain {
            Some(Some(left)) => self.remain(left, left),
            Some(None) => {}
            None => self.update(model, context.watch),
        }
        (self.mass * (before - self.left), self.mass * aged)
    }

    /// Breaks contacts that stand at a point mass of the thresholds: their fraction of all contacts, and the
    /// energy lost.
    pub(super) fn break_at_atom(&mut self, model: &CohortModel) -> (f64, f64) {
        if !self.place.is_point() || !model.break_at_atom(&mut self.state, self.place) {
            return (0.0, 0.0);
        }
        let (before, energy) = (self.left, self.energy());
        self.update(model, &Watch::new(&mut ()));
        (self.mass * (before - self.left), energy - self.energy())
    }

    /// The time at which contacts at one stretch, moving at `velocity`, reach a point mass of the thresholds,
    /// up to `limit`.
    pub(super) fn time_to_atom(&self, model: &CohortModel, velocity: f64, limit: f64) -> Option<f64> {
        if self.place.is_point() {
            model.time_to_atom(&self.state, self.place, velocity, limit)
        } else {
            None
        }
    }

    /// Updates the surviving fraction, which never grows.
    fn update(&mut self, model: &CohortModel, watch: &Watch<'_>) {
        let (left, stiffness) = model.measure(&self.state, self.place.age, watch);
        self.remain(left, stiffness);
    }

    fn remain(&mut self, left: f64, stiffness: f64) {
        self.left = left.clamp(0.0, self.left);
        self.stiffness = stiffness;
    }

    /// Surviving contacts as a fraction of all.
    pub(super) fn attached(&self) -> f64 {
        self.mass * self.left
    }

    /// The same as intervals of stretch: over the cells of the distribution that their seed represents, or
    /// over their own cell.
    pub(super) fn intervals(&self, seeds: &[Seed], cells: &[Vec<StretchInterval>]) -> Vec<StretchInterval> {
        let (Place { stretch, below, above, .. }, all) = (self.place, self.attached());
        let number = self.seed.map_or(usize::MAX, |number| number as usize);
        match (seeds.get(number), cells.get(number)) {
            (Some(seed), Some(cells)) if !cells.is_empty() => {
                // The seed was widened by this much because its contacts formed during a step.
                let (before, after) = (below - seed.below, above - seed.above);
                let moved = |cell: &StretchInterval| StretchInterval {
                    low: stretch + cell.low - before,
                    high: stretch + cell.high + after,
                    fraction: all * cell.fraction,
                };
                cells.iter().map(moved).collect()
            }
            _ => vec![StretchInterval { low: stretch - below, high: stretch + above, fraction: all }],
        }
    }

    /// Force, per unit of the stiffness of all.
    pub(super) fn force(&self) -> f64 {
        self.tangent() * self.place.stretch
    }

    /// dF/dX of the surviving contacts, per unit of the stiffness of all.
    pub(super) fn tangent(&self) -> f64 {
        self.mass * self.stiffness
    }

    fn stiffness_and_force(&self) -> CohortForce {
        CohortForce { stiffness: self.tangent(), force: self.force() }
    }

    /// Elastic energy, per unit of the stiffness of all.
    pub(super) fn energy(&self) -> f64 {
        0.5 * self.force() * self.place.stretch
    }
}
