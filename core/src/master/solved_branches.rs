//! Loading branches of the contacts of one interface, from any state.

use std::sync::{Arc, OnceLock};

use super::loading::LoadingBranch;
use super::{MasterEquation, Tolerance};
use crate::contacts::{Contacts, Start};
use crate::life::{Layer, LayerSums, Life, life_of, simplified};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A branch is first solved for this many mean lives, then for twice as many, and so on.
const FIRST: f64 = 2.0;

/// Factor by which the total probability may be less accurate than the tolerance at the points at which it is
/// not checked.
const SLACK: f64 = 10.0;

/// Lengths below this, in mean thresholds, are rounding.
const NEAR: f64 = 1e-13;

/// What all branches have in common.
#[derive(Debug)]
pub(super) struct SolvedBranches {
    pub(super) contacts: Contacts,
    pub(super) reformed: Arc<Life>,
    /// Total force per unit of the carried force of a life.
    pub(super) stiffness: f64,
    pub(super) tolerance: Tolerance,
    /// The branch from the state in which all contacts have just re-formed.
    fresh: OnceLock<Arc<LoadingBranch>>,
}

impl SolvedBranches {
    /// The branches of a master equation, solved to `tolerance`.
    pub(super) fn of(equation: &MasterEquation, tolerance: Tolerance) -> Self {
        Self {
            contacts: equation.contacts.clone(),
            reformed: equation.reformed.clone(),
            stiffness: equation.stiffness(),
            tolerance,
            fresh: OnceLock::new(),
        }
    }

    /// The branch from X = 0, after contacts at or above their thresholds have broken there.
    pub(super) fn first(
        &self,
        equation: &MasterEquation,
        monitor: &mut dyn Monitor,
    ) -> Result<LoadingBranch> {
        if equation.initial.start == Start::Conditional || self.is_time_dependent() {
            return self.branch(equation.first.clone(), monitor);
        }
        let mut layers = equation.first.layers().to_vec();
        let broken = 1.0 - LayerSums::of(&layers, &self.contacts).unbroken;
        layers.extend(self.reformed.layers().iter().map(|layer| layer.clone().scaled(broken)));
        self.renewed(layers, monitor)
    }

    /// The branch of contacts with this first life.
    fn branch(&self, first: Arc<Life>, monitor: &mut dyn Monitor) -> Result<LoadingBranch> {
        LoadingBranch::renewed(first, &self.reformed, FIRST * self.reformed.mean(), self.tolerance, monitor)
    }

    /// The branch of contacts in these layers, re-forming as they break.
    ///
    /// The layers should contain all contacts; the error that the tolerance of earlier branches leaves is
    /// normalised away, so that errors do not accumulate.
    pub(super) fn renewed(&self, layers: Vec<Layer>, monitor: &mut dyn Monitor) -> Result<LoadingBranch> {
        let layers = simplified(layers, self.contacts.thresholds.as_ref());
        let there = LayerSums::of(&layers, &self.contacts).unbroken;
        let what = || "the probability of all stretches where the slider turned".to_owned();
        self.tolerance.times(SLACK).allows((there - 1.0).abs(), what)?;
        let layers = layers.into_iter().map(|layer| layer.scaled(1.0 / there)).collect();
        self.branch(Arc::new(life_of(&self.contacts, layers, monitor)?), monitor)
    }

    /// The branch of contacts in these layers, staying free as they break.
    pub(super) fn held(&self, layers: Vec<Layer>) -> LoadingBranch {
        let layers = simplified(layers, self.contacts.thresholds.as_ref());
        let life = life_of(&self.contacts, layers, &mut ()).expect("no monitor stops it");
        LoadingBranch::held(Arc::new(life))
    }

    /// The branch of contacts that have all just re-formed.
    pub(super) fn fresh(&self, monitor: &mut dyn Monitor) -> Result<Arc<LoadingBranch>> {
        if let Some(branch) = self.fresh.get() {
            return Ok(branch.clone());
        }
        let branch = Arc::new(self.branch(self.reformed.clone(), monitor)?);
        Ok(self.fresh.get_or_init(|| branch).clone())
    }

    /// Mean elastic energy of a contact that has just re-formed, per unit stiffness.
    pub(super) fn fresh_energy(&self) -> f64 {
        self.reformed.fresh_energy()
    }

    /// Mean stiffness of a contact that has just re-formed, per unit stiffness.
    pub(super) fn fresh_stiffness(&self) -> f64 {
        self.reformed.stiffness()
    }

    /// Whether contacts move at a velocity.
    pub(super) fn is_time_dependent(&self) -> bool {
        self.contacts.rules.are_time_dependent()
    }

    /// Refuses motions on which the state of time-dependent contacts depends on more than how far they have
    /// been stretched.
    pub(super) fn require_one_way(&self, key: &str, found: &str) -> Result<()> {
        let Some(rule) = self.contacts.rules.first() else { return Ok(()) };
        let expected = format!(
            "motion one way on which contacts re-form as they break, since {rule} makes contacts time-dependent (`Transport` \
             follows contacts anywhere)"
        );
        Err(Error::invalid(key, expected, found))
    }

    /// Lengths below this are rounding.
    pub(super) fn rounding(&self) -> f64 {
        NEAR * self.contacts.thresholds.mean()
    }
}
