//! What a small step of the slider changes of the survival of contacts in steady sliding: the linear response follows from it.

use super::{ageing_correlation, hazard_correlation};
use crate::Result;
use crate::contacts::Contacts;
use crate::monitor::Watch;
use crate::numerics::piecewise::Piecewise;

/// Two curves against an advance u, means over all contacts.
///
/// A step δX of the slider at the advance u₀ of a contact lowers its surviving fraction at a later advance u by D(u, u₀) δX. If
/// contacts broke at stretches that do not depend on how they got there, D(u, u₀) would be their breaking density φ(u) whatever
/// u₀, and the force of steady sliding would not respond.
#[derive(Debug, Clone)]
pub(crate) struct StepCorrelation {
    /// C(u) = ∫ [φ(u₀ + u) − D(u₀ + u, u₀)] du₀.
    pub(crate) survival: Piecewise,
    /// C_x(u), the same with φ and D of each contact times its force at u₀ + u, in the unit of [`super::Life::force`].
    pub(crate) force: Piecewise,
}

impl StepCorrelation {
    /// Of contacts that slide at `velocity`, where it has a closed form: with temperature or with ageing, not with both; none
    /// elsewhere.
    ///
    /// # Errors
    /// Those of [`ThresholdEvolution::of`](crate::contacts::ThresholdEvolution::of); stopped by the monitor.
    pub(crate) fn of(contacts: &Contacts, velocity: f64, watch: &Watch<'_>) -> Result<Option<Self>> {
        let curves = match (&contacts.rules.temperature, &contacts.rules.ageing) {
            (Some(temperature), None) => hazard_correlation::of(contacts, *temperature, velocity, watch)?,
            (None, Some(ageing)) => ageing_correlation::of(contacts, ageing, velocity, watch)?,
            _ => None,
        };
        Ok(curves.map(|[survival, force]| Self { survival, force }))
    }
}
