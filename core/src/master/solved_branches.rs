//! Courses of the contacts of one interface, wherever they begin.

use std::sync::{Arc, OnceLock};

use super::loading::LoadingBranch;
use super::{MasterEquation, Tolerance};
use crate::contacts::{Contacts, Start};
use crate::life::{Layer, LayerSums, Life, life_of, simplified};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A course is first solved for this many mean lives, then for twice as many, and so on.
const FIRST: f64 = 2.0;

/// Legs keep the probability of all stretches to their tolerance where they look; elsewhere to this many.
const SLACK: f64 = 10.0;

/// What lies nearer, in mean thresholds, is there.
const NEAR: f64 = 1e-13;

/// What all courses have in common.
#[derive(Debug)]
pub(super) struct SolvedBranches {
    pub(super) contacts: Contacts,
    pub(super) reborn: Arc<Life>,
    /// Total force per unit of the carried force of a life.
    pub(super) stiffness: f64,
    pub(super) tolerance: Tolerance,
    /// The course from where all contacts have just re-formed.
    fresh: OnceLock<Arc<LoadingBranch>>,
}

impl SolvedBranches {
    /// The interface of a master equation, its courses solved to `tolerance`.
    pub(super) fn of(equation: &MasterEquation, tolerance: Tolerance) -> Self {
        Self {
            contacts: equation.contacts.clone(),
            reborn: equation.reborn.clone(),
            stiffness: equation.stiffness(),
            tolerance,
            fresh: OnceLock::new(),
        }
    }

    /// The course from X = 0, after what breaks there at once.
    pub(super) fn first(
        &self,
        equation: &MasterEquation,
        monitor: &mut dyn Monitor,
    ) -> Result<LoadingBranch> {
        if equation.start == Start::Conditional || self.knows_time() {
            return self.course(equation.first.clone(), monitor);
        }
        let mut layers = equation.first.layers().to_vec();
        let broken = 1.0 - LayerSums::of(&layers, &self.contacts).unbroken;
        layers.extend(self.reborn.layers().iter().map(|layer| layer.clone().scaled(broken)));
        self.renewed(layers, monitor)
    }

    /// The course of contacts with this first life.
    fn course(&self, first: Arc<Life>, monitor: &mut dyn Monitor) -> Result<LoadingBranch> {
        LoadingBranch::renewed(first, &self.reborn, FIRST * self.reborn.mean(), self.tolerance, monitor)
    }

    /// The course of contacts in these layers, whose breaking ones re-form.
    ///
    /// All of them should be there; what the tolerance of earlier courses leaves is made up for, lest it add up.
    pub(super) fn renewed(&self, layers: Vec<Layer>, monitor: &mut dyn Monitor) -> Result<LoadingBranch> {
        let layers = simplified(layers, self.contacts.thresholds.as_ref());
        let there = LayerSums::of(&layers, &self.contacts).unbroken;
        let what = || "the probability of all stretches where the slider turned".to_owned();
        self.tolerance.times(SLACK).allows((there - 1.0).abs(), what)?;
        let layers = layers.into_iter().map(|layer| layer.scaled(1.0 / there)).collect();
        self.course(Arc::new(life_of(&self.contacts, layers, monitor)?), monitor)
    }

    /// The course of contacts in these layers, whose breaking ones stay free.
    pub(super) fn held(&self, layers: Vec<Layer>) -> LoadingBranch {
        let layers = simplified(layers, self.contacts.thresholds.as_ref());
        let life = life_of(&self.contacts, layers, &mut ()).expect("nobody asks to stop");
        LoadingBranch::held(Arc::new(life))
    }

    /// The course of contacts that have all just re-formed.
    pub(super) fn fresh(&self) -> Result<Arc<LoadingBranch>> {
        if let Some(course) = self.fresh.get() {
            return Ok(course.clone());
        }
        let course = Arc::new(self.course(self.reborn.clone(), &mut ())?);
        Ok(self.fresh.get_or_init(|| course).clone())
    }

    /// Mean elastic energy of a contact that has just re-formed, per unit stiffness.
    pub(super) fn newborn_energy(&self) -> f64 {
        self.reborn.newborn_energy()
    }

    /// Mean stiffness of a contact that has just re-formed, per unit stiffness.
    pub(super) fn newborn_stiffness(&self) -> f64 {
        self.reborn.stiffness()
    }

    /// Whether contacts move at a velocity.
    pub(super) fn knows_time(&self) -> bool {
        self.contacts.rules.are_time_dependent()
    }

    /// Refuses what a life at a constant velocity cannot be followed on, since what contacts have been through is more
    /// than how far they have been.
    pub(super) fn forgets(&self, key: &str, found: &str) -> Result<()> {
        let Some(rule) = self.contacts.rules.first() else { return Ok(()) };
        let expected = format!(
            "motion one way on which contacts re-form as they break, since contacts.{rule} makes contacts time-dependent (a [[protocol]] \
             follows contacts anywhere)"
        );
        Err(Error::invalid(key, expected, found))
    }

    /// Lengths below this are rounding.
    pub(super) fn near(&self) -> f64 {
        NEAR * self.contacts.thresholds.mean()
    }
}
