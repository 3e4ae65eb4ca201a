//! How much the merging of cohorts may replace.

use super::step_control::{coarsest, scale};
use crate::contacts::Contacts;

/// How much merging may replace.
#[derive(Debug, Clone, Copy)]
pub(super) struct MergingLimits {
    /// Largest spread of a cohort, fraction × length².
    pub(super) spread: f64,
    /// Largest extent of the cell of a cohort: where densities jump, as that of the stretches at which contacts form.
    pub(super) width: f64,
}

impl MergingLimits {
    pub(super) fn new(contacts: &Contacts, tolerance: f64) -> Self {
        /// In units of the tolerance times the square of the length on which lives vary.
        const SPREAD: f64 = 0.02;
        /// The same with temperature, where the survivors of each threshold have a mean stretch of their own.
        const THERMAL: f64 = 0.005;
        let most = if contacts.rules.temperature.is_some() { THERMAL } else { SPREAD };
        Self {
            spread: most * tolerance * scale(contacts).powi(2),
            width: 0.5 * coarsest(contacts, tolerance),
        }
    }
}
