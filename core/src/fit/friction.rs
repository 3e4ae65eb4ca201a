//! Friction of the fitted contacts, with the errors of the estimates propagated to it.

use super::estimates::Estimates;
use super::free::{FreeParameter, Role};
use crate::Result;
use crate::master::{FrictionGradient, MasterEquation, Pull};
use crate::monitor::{Monitor, Part};

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WithError {
    /// The value.
    pub value: f64,
    /// Its standard error; NaN where the value has no derivative.
    pub error: f64,
}

/// Friction of the fitted contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrictionEstimates {
    /// F_s, if it is reached, with the background force.
    pub static_friction: Option<WithError>,
    /// F_k, with the background force.
    pub kinetic_friction: WithError,
    /// X*.
    pub relaxation_length: WithError,
    /// K_c.
    pub critical_stiffness: WithError,
}

impl Estimates {
    /// F_s, F_k, X* and K_c of the contacts (of curve 0 where curves differ), with the errors √(gᵀVg) of the covariance V of
    /// the estimates, g the derivatives of
    /// [`crate::master::Pull::friction_gradients`].
    ///
    /// # Errors
    /// Those of [`crate::master::Pull::friction_gradients`].
    pub fn friction(&self, monitor: &mut dyn Monitor) -> Result<FrictionEstimates> {
        let of_first: Vec<usize> =
            (0..self.parameters.len()).filter(|&k| self.ended.likelihood.free[k].applies_to(0)).collect();
        let free: Vec<FreeParameter> =
            of_first.iter().map(|&k| self.ended.likelihood.free[k].clone()).collect();
        let n = self.parameters.len();
        let pairs = of_first.iter().flat_map(|&i| of_first.iter().map(move |&j| (i, j)));
        let covariance: Vec<f64> = pairs.map(|(i, j)| self.covariance[i * n + j]).collect();
        let background = self.machine(0).background;
        friction((self.equation(), self.pull(0), background), (&free, &covariance), monitor)
    }
}

/// Friction of contacts on a pull, with a background force, and the errors that follow from the covariance of the estimates
/// of `free`.
///
/// # Errors
/// Those of [`Pull::friction_gradients`].
pub(super) fn friction(
    (equation, pull, background): (&MasterEquation, &Pull, f64),
    (free, covariance): (&[FreeParameter], &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<FrictionEstimates> {
    let count = free.len();
    let of_contacts: Vec<usize> = (0..count).filter(|&k| free[k].role == Role::Contacts).collect();
    let names: Vec<&str> = of_contacts.iter().map(|&k| free[k].quantity.as_str()).collect();
    let gradients = pull.friction_gradients_with(&names, &mut Part::new(monitor, 0.0, 0.8))?;
    let relaxation = equation.relaxation_with(&mut Part::new(monitor, 0.8, 0.2))?;
    let steady = equation.steady_state();
    let of_background = free.iter().position(|parameter| parameter.role == Role::Background);
    // `by` is the derivative by the background force.
    let with_error = |value: f64, of: &dyn Fn(&FrictionGradient) -> f64, by: f64| {
        let contacts = of_contacts.iter().zip(&gradients).map(|(&k, gradient)| (k, of(gradient)));
        let slopes: Vec<(usize, f64)> = contacts.chain(of_background.map(|k| (k, by))).collect();
        let products = slopes.iter().flat_map(|a| slopes.iter().map(move |b| (a, b)));
        let variance: f64 = products.map(|(a, b)| covariance[a.0 * count + b.0] * a.1 * b.1).sum();
        // Rounding may make the variance of what does not vary negative.
        WithError { value, error: if variance.is_nan() { f64::NAN } else { variance.max(0.0).sqrt() } }
    };
    let peak = pull.static_friction();
    let at_peak = |gradient: &FrictionGradient| gradient.static_friction.unwrap_or(f64::NAN);
    Ok(FrictionEstimates {
        static_friction: peak.map(|peak| with_error(peak.value + background, &at_peak, 1.0)),
        kinetic_friction: with_error(
            steady.kinetic_friction() + background,
            &|gradient| gradient.kinetic_friction,
            1.0,
        ),
        relaxation_length: with_error(relaxation.length(), &|gradient| gradient.relaxation_length, 0.0),
        critical_stiffness: with_error(
            pull.critical_stiffness(),
            &|gradient| gradient.critical_stiffness,
            0.0,
        ),
    })
}
