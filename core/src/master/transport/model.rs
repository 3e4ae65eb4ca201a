//! The rules of the thresholds of a cohort.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::diffusing::{Diffusing, ThresholdMasses};
use super::merged_ranks::MergedPart;
use super::path::{Path, Place, StepPart};
use super::ranked::{RankedThresholds, SurvivingRanks};
use super::seeds::Seed;
use super::shared_thresholds::SurvivingFraction;
use super::step_context::StepContext;
use crate::contacts::MaturingTable;
use crate::monitor::Watch;

/// The rules of the thresholds.
#[derive(Debug)]
pub(super) enum CohortModel {
    /// They follow from the age of a contact.
    Ranked(Box<RankedThresholds>),
    /// They diffuse.
    Diffusing(Box<Diffusing>),
    /// All contacts share one distribution of them.
    Shared(Arc<MaturingTable>),
}

/// The thresholds of a cohort.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum CohortThresholds {
    Ranked(SurvivingRanks),
    Diffusing(ThresholdMasses),
    Shared(SurvivingFraction),
}

impl CohortThresholds {
    /// Bytes that they take beside their cohort.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Ranked(left) => left.bytes(),
            Self::Diffusing(masses) => masses.bytes(),
            Self::Shared(_) => 0,
        }
    }
}

impl CohortModel {
    /// The thresholds of contacts that form at a seed.
    pub(super) fn fresh(&self, seed: &Seed, watch: &Watch<'_>) -> CohortThresholds {
        match self {
            Self::Ranked(ranks) => CohortThresholds::Ranked(ranks.fresh(seed)),
            Self::Diffusing(diffusing) => CohortThresholds::Diffusing(diffusing.fresh(seed, watch)),
            Self::Shared(_) => CohortThresholds::Shared(SurvivingFraction::fresh(seed.stretch)),
        }
    }

    /// Whether these thresholds are of the kind of this model.
    pub(super) fn fits(&self, state: &CohortThresholds) -> bool {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.fits(left),
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => diffusing.fits(masses),
            (Self::Shared(_), CohortThresholds::Shared(_)) => true,
            _ => false,
        }
    }

    /// Advances in time from `place`. Returns the stiffness that surviving contacts gain by ageing, per
    /// formed contact.
    pub(super) fn advance(
        &self,
        state: &mut CohortThresholds,
        place: Place,
        path: &Path,
        part: StepPart,
        context: &mut StepContext<'_, '_>,
    ) -> f64 {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => {
                ranks.advance(place, left, path, part.ends(), context.watch)
            }
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => {
                diffusing.advance(place, masses, path, part, context)
            }
            (Self::Shared(_), CohortThresholds::Shared(left)) => {
                let thresholds =
                    context.thresholds.expect("a step of contacts that share thresholds has them");
                left.advance(place, path, part, thresholds);
                0.0
            }
            _ => unreachable!("cohorts are made by the model that moves them"),
        }
    }

    /// Advances contacts for which the surviving fraction is all that changes; as [`RankedThresholds::advance_plain`].
    pub(super) fn advance_plain(
        &self,
        state: &mut CohortThresholds,
        place: Place,
        path: &Path,
        part: StepPart,
    ) -> Option<Option<f64>> {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => {
                ranks.advance_plain(place, left, path, part.ends())
            }
            _ => None,
        }
    }

    /// Whether the life of a contact depends on its stretch alone, not on its age.
    pub(super) fn ignores_age(&self) -> bool {
        match self {
            Self::Ranked(ranks) => ranks.are_constant(),
            Self::Diffusing(_) => false,
            Self::Shared(_) => true,
        }
    }

    /// How far apart the stretches are at which the contacts of two cohorts break. `None` for cohorts that stay apart.
    pub(super) fn distance(
        &self,
        first: (&CohortThresholds, Place),
        second: (&CohortThresholds, Place),
    ) -> Option<f64> {
        match (self, first.0, second.0) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(one), CohortThresholds::Ranked(two)) => {
                ranks.distance((one, first.1), (two, second.1))
            }
            (Self::Shared(_), CohortThresholds::Shared(one), CohortThresholds::Shared(two)) => {
                Some(one.distance(*two).max((first.1.stretch - second.1.stretch).abs()))
            }
            (
                Self::Diffusing(diffusing),
                CohortThresholds::Diffusing(one),
                CohortThresholds::Diffusing(two),
            ) => Some(diffusing.distance((one, first.1), (two, second.1))),
            _ => None,
        }
    }

    /// The thresholds of two cohorts of these masses that have a [`Self::distance`] as one, `part` of whose attached contacts
    /// are of the second.
    pub(super) fn merged(
        &self,
        first: (&CohortThresholds, f64),
        second: (&CohortThresholds, f64),
        part: f64,
    ) -> CohortThresholds {
        match (self, first.0, second.0) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(one), CohortThresholds::Ranked(two)) => {
                let one = MergedPart { left: one, mass: first.1 };
                let two = MergedPart { left: two, mass: second.1 };
                CohortThresholds::Ranked(ranks.merged(one, two, part))
            }
            (Self::Shared(_), CohortThresholds::Shared(one), CohortThresholds::Shared(two)) => {
                CohortThresholds::Shared(one.merged(*two, part))
            }
            (Self::Diffusing(_), CohortThresholds::Diffusing(one), CohortThresholds::Diffusing(two)) => {
                CohortThresholds::Diffusing(Diffusing::merged((one, first.1), (two, second.1), part))
            }
            _ => unreachable!("only cohorts with a distance are merged"),
        }
    }

    /// Whether nothing breaks at rest and stiffnesses stay.
    pub(super) fn is_constant_at_rest(&self) -> bool {
        match self {
            Self::Ranked(ranks) => ranks.is_plain() && ranks.only_strengthen(),
            Self::Diffusing(_) => false,
            Self::Shared(_) => true,
        }
    }

    /// Whether contacts may break simultaneously.
    pub(super) fn has_atoms(&self) -> bool {
        match self {
            Self::Ranked(ranks) => ranks.has_atoms(),
            Self::Diffusing(_) | Self::Shared(_) => false,
        }
    }

    /// The surviving fraction, and its stiffness per formed contact.
    pub(super) fn measure(&self, state: &CohortThresholds, age: f64, watch: &Watch<'_>) -> (f64, f64) {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.measure(left, age, watch),
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => diffusing.measure(masses),
            (Self::Shared(_), CohortThresholds::Shared(left)) => (left.left(), left.left()),
            _ => unreachable!("cohorts are made by the model that moves them"),
        }
    }

    /// Lets go those that stand at a threshold that many share; whether there may be such.
    pub(super) fn break_at_atom(&self, state: &mut CohortThresholds, place: Place) -> bool {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.break_at_atom(place, left),
            _ => false,
        }
    }

    /// The time at which contacts at one stretch that move at `velocity` reach a point mass of the
    /// thresholds, up to `limit`.
    pub(super) fn time_to_atom(
        &self,
        state: &CohortThresholds,
        place: Place,
        velocity: f64,
        limit: f64,
    ) -> Option<f64> {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => {
                ranks.time_to_atom(place, left, velocity, limit)
            }
            _ => None,
        }
    }

    /// Amount of work of a step of a cohort.
    pub(super) fn cells(&self) -> usize {
        match self {
            Self::Ranked(ranks) => ranks.cells(),
            Self::Diffusing(diffusing) => diffusing.cells(),
            Self::Shared(_) => SHARED,
        }
    }

    /// The thresholds of all ages, where contacts share one distribution.
    pub(super) fn table(&self) -> Option<&MaturingTable> {
        if let Self::Shared(table) = self { Some(table) } else { None }
    }
}

/// Work of a step of a cohort of shared thresholds, in units of that of one whose S is tabulated.
const SHARED: usize = 16;
