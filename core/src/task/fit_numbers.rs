//! What the summaries of fits to curves and to records have in common.

use super::summary::{Extended, FitFixed, FitFriction, FitNumber, Uncertain};
use crate::fit::{Correlation, Estimate, FrictionEstimates, WithError};
use crate::scenario::FitKeys;

/// The warning of a search that has not converged.
pub(super) fn not_converged(converged: bool) -> Vec<String> {
    let text = "fit: the search has not converged; the values are the last ones, without meaningful errors";
    if converged { Vec::new() } else { vec![text.into()] }
}

/// A value with its error, as the summary has it.
pub(super) fn uncertain(of: WithError) -> Uncertain {
    Uncertain { value: Extended(of.value), error: Extended(of.error) }
}

/// Friction with its errors.
pub(super) fn friction(found: &FrictionEstimates) -> FitFriction {
    FitFriction {
        static_friction: found.static_friction.map(uncertain),
        kinetic_friction: uncertain(found.kinetic_friction),
        relaxation_length: uncertain(found.relaxation_length),
        critical_stiffness: uncertain(found.critical_stiffness),
    }
}

/// An estimate, with its key.
pub(super) fn number(keys: &FitKeys, estimate: &Estimate) -> FitNumber {
    let Estimate { name, value, error, interval, limit } = estimate;
    FitNumber {
        key: keys.key(name),
        value: *value,
        error: *error,
        interval: interval.map(Extended),
        limit: limit.map(Extended),
    }
}

/// Numbers that were not free, with their keys.
pub(super) fn fixed(keys: &FitKeys, numbers: Vec<(String, f64)>) -> Vec<FitFixed> {
    numbers.into_iter().map(|(name, value)| FitFixed { key: keys.key(&name), value }).collect()
}

/// Correlations between estimates, with their keys.
pub(super) fn correlations(keys: &FitKeys, reported: Vec<Correlation>) -> Vec<Correlation> {
    let named = |correlation: Correlation| Correlation {
        between: correlation.between.map(|name| keys.key(&name)),
        coefficient: correlation.coefficient,
    };
    reported.into_iter().map(named).collect()
}
