//! The derivative of a survival function by a parameter, where it has no closed form.

use super::{Parameter, SharedLaw, SurvivalDerivative};
use crate::{Error, Result};

/// Weights of the central difference of eighth order, for values at distances 1 to 4
/// (B. Fornberg, Math. Comp. 51, 699 (1988)).
pub(crate) const EIGHTH_ORDER: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// Largest change of S over a step. Truncation is of the order of its eighth power, and the rounding of S is
/// divided by it.
const CHANGE: f64 = 0.01;

/// ∂S/∂θ by central differences of S; `with` makes the distribution with another value of the parameter.
pub(super) fn by_differences(
    parameters: &[Parameter],
    name: &str,
    with: &dyn Fn(f64) -> Result<SharedLaw>,
) -> Result<SurvivalDerivative> {
    let (value, step) = step(parameters, name, with)?;
    let mut pairs = Vec::with_capacity(EIGHTH_ORDER.len());
    for (k, weight) in (1..).zip(EIGHTH_ORDER) {
        let away = f64::from(k) * step;
        let exact = (value + away) - value;
        pairs.push((weight * f64::from(k) / exact, with(value + exact)?, with(value - exact)?));
    }
    Ok(Box::new(move |x| {
        pairs.iter().map(|(weight, above, below)| weight * (above.survival(x) - below.survival(x))).sum()
    }))
}

/// The value of a parameter, and the step over which S changes by at most [`CHANGE`].
fn step(parameters: &[Parameter], name: &str, with: &dyn Fn(f64) -> Result<SharedLaw>) -> Result<(f64, f64)> {
    let Some(value) = parameters.iter().find(|p| p.name == name).map(|p| p.value) else {
        // The distribution itself says which parameters it has.
        return with(f64::NAN).map(|_| (f64::NAN, f64::NAN));
    };
    let tiny = 1e-6 * value.abs();
    if tiny == 0.0 {
        return Err(Error::invalid(name, "a value inside of the range of the parameter", value));
    }
    let [below, above] = [with(value - tiny)?, with(value + tiny)?];
    let change = |k: u32| {
        let x = below.quantile(f64::from(k) / 64.0);
        (above.survival(x) - below.survival(x)).abs() / (2.0 * tiny)
    };
    let steepest = (1..64).map(change).fold(0.0, f64::max);
    Ok((value, (CHANGE / steepest).min(0.02 * value.abs())))
}
