//! What time does to the thresholds of a cohort.

use serde::{Deserialize, Serialize};

use super::cohort::Place;
use super::diffusing::{Diffusing, ThresholdMasses};
use super::path::{Path, StepPart};
use super::ranked::{Left, RankedThresholds};
use super::seeds::Seed;
use crate::monitor::Watch;
use crate::numerics::diffusion::Workspace;

/// The rules of the thresholds.
#[derive(Debug)]
pub(super) enum CohortModel {
    /// They follow from the age of a contact.
    Ranked(Box<RankedThresholds>),
    /// They diffuse.
    Diffusing(Box<Diffusing>),
}

/// What steps of cohorts take: memory to work in, and who may stop them, after which they are of no use.
pub(super) struct Tools<'a, 'm> {
    pub(super) room: Workspace,
    pub(super) watch: &'a Watch<'m>,
}

impl<'a, 'm> Tools<'a, 'm> {
    pub(super) fn new(watch: &'a Watch<'m>) -> Self {
        Self { room: Workspace::default(), watch }
    }
}

/// The thresholds of a cohort.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum CohortThresholds {
    Ranked(Left),
    Diffusing(ThresholdMasses),
}

impl CohortModel {
    /// The thresholds of contacts born at a seed.
    pub(super) fn newborn(&self, seed: &Seed, watch: &Watch<'_>) -> CohortThresholds {
        match self {
            Self::Ranked(ranks) => CohortThresholds::Ranked(ranks.newborn(seed)),
            Self::Diffusing(diffusing) => CohortThresholds::Diffusing(diffusing.newborn(seed, watch)),
        }
    }

    /// Whether these thresholds are told as this model tells them.
    pub(super) fn fits(&self, state: &CohortThresholds) -> bool {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.fits(left),
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => diffusing.fits(masses),
            _ => false,
        }
    }

    /// Time passes; `place` is where the contacts are at the beginning. By how much ageing makes those stiffer that do not
    /// break, per contact born.
    pub(super) fn advance(
        &self,
        state: &mut CohortThresholds,
        place: Place,
        path: &Path,
        part: StepPart,
        tools: &mut Tools<'_, '_>,
    ) -> f64 {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => {
                ranks.advance(place, left, path, part.ends())
            }
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => {
                diffusing.advance(place, masses, path, part, tools)
            }
            _ => unreachable!("cohorts are made by the model that moves them"),
        }
    }

    /// The share of the contacts that is left, and their stiffness per contact born.
    pub(super) fn measure(&self, state: &CohortThresholds, age: f64) -> (f64, f64) {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.measure(left, age),
            (Self::Diffusing(diffusing), CohortThresholds::Diffusing(masses)) => diffusing.measure(masses),
            _ => unreachable!("cohorts are made by the model that moves them"),
        }
    }

    /// Lets go those that stand at a threshold that many share; whether there may be such.
    pub(super) fn strike(&self, state: &mut CohortThresholds, place: Place) -> bool {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => ranks.strike(place, left),
            _ => false,
        }
    }

    /// When contacts at one stretch that move at `velocity` meet a threshold that many share, up to `limit`.
    pub(super) fn strikes(
        &self,
        state: &CohortThresholds,
        place: Place,
        velocity: f64,
        limit: f64,
    ) -> Option<f64> {
        match (self, state) {
            (Self::Ranked(ranks), CohortThresholds::Ranked(left)) => {
                ranks.strikes(place, left, velocity, limit)
            }
            _ => None,
        }
    }

    /// How many numbers a step of a cohort goes through.
    pub(super) fn cells(&self) -> usize {
        match self {
            Self::Ranked(ranks) => ranks.cells(),
            Self::Diffusing(diffusing) => diffusing.cells(),
        }
    }
}
