//! The contacts of [`Transport`] under a block or a cell, which moves them step by step.

use super::Transport;
use super::merging::MergingRule;
use crate::Result;
use crate::contacts::FreeFriction;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::rate_dependent::{ContactsState, RateDependentContacts, StretchInterval};

impl RateDependentContacts for Transport {
    fn position(&self) -> f64 {
        self.position
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn force(&self) -> f64 {
        Self::force(self)
    }

    fn tangent(&self) -> f64 {
        Self::tangent(self)
    }

    fn free_friction(&self) -> FreeFriction {
        Self::free_friction(self)
    }

    fn energies(&self) -> ContactEnergies {
        Self::energies(self)
    }

    fn free(&self) -> f64 {
        Self::free(self)
    }

    fn is_constant_at_rest(&self) -> bool {
        self.broken.is_immediate() && self.model.is_constant_at_rest()
    }

    fn steady_velocity(&self) -> Option<f64> {
        self.steady
    }

    fn mean_threshold(&self) -> Option<f64> {
        Some(self.mean_threshold)
    }

    fn stretches(&self) -> Vec<StretchInterval> {
        self.cohorts.iter().flat_map(|cohort| cohort.intervals(&self.seeds, &self.cells)).collect()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.step_with(by, during, MergingRule::WhenMany, monitor)
    }

    fn settle(&mut self) {
        self.merge_cohorts();
    }

    fn rough(&self) -> Option<Box<dyn RateDependentContacts>> {
        self.rough.as_ref().map(|rough| rough.copy())
    }

    /// Without the second solution, which only [`Transport::follow`] uses.
    fn copy(&self) -> Box<dyn RateDependentContacts> {
        let Self { model, seeds, cells, cohorts, broken, pace, kinks, ages, .. } = self;
        Box::new(Self {
            model: model.clone(),
            seeds: seeds.clone(),
            cells: cells.clone(),
            cohorts: cohorts.clone(),
            broken: broken.clone(),
            pace: pace.clone(),
            kinks: kinks.clone(),
            ages: ages.clone(),
            before: None,
            rough: None,
            ..*self
        })
    }

    fn state(&self) -> ContactsState {
        self.snapshot()
    }

    /// Without the second solution, as for a copy.
    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        self.resume(state)
    }
}
