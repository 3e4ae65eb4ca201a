//! Probability distributions on x ≥ 0: of thresholds, of the stretch of re-formed contacts, of initial
//! stretches.
//!
//! Every distribution is a sum of point masses ([`Atom`]) and a density that is smooth between its
//! [`Breakpoint`]s. A distribution whose parent has mass below 0 is the parent conditioned on x ≥ 0: its
//! documented parameters are the parent's, while [`Law::mean`] and [`Law::std`] are those of the conditioned
//! distribution.
//!
//! To add a distribution: see CONTRIBUTING.md, which lists all files. The code calls a distribution a *law*.

mod critical_coupling;
mod derivative;
mod drive_map;
mod expectation;
mod exponential;
mod gamma;
mod gaussian;
mod incomplete_gamma;
mod inversion;
mod kernel_density;
mod log_kernels;
mod lognormal;
mod maximum_likelihood;
mod mixture;
mod normal;
mod panels;
mod parametric;
mod point;
mod quadrature;
mod range;
mod rectangular;
mod refine;
mod renormalised;
mod root;
mod scattered;
mod series;
mod size_biased;
mod tabulated;
mod truncated;
mod weibull;
mod ziggurat;

pub use critical_coupling::critical_coupling;
pub(crate) use derivative::EIGHTH_ORDER;
pub use expectation::{entropy, expectation, within_support};
pub use exponential::Exponential;
pub use gamma::Gamma;
pub use gaussian::Gaussian;
pub use kernel_density::{kernel_density, kernel_density_with};
pub use log_kernels::LogKernels;
pub use lognormal::Lognormal;
pub use maximum_likelihood::{maximum_likelihood, maximum_likelihood_with};
pub use mixture::Mixture;
#[doc(hidden)]
pub use parametric::parametric_distributions;
pub use point::Point;
pub use rectangular::Rectangular;
pub use renormalised::Renormalised;
pub use root::Root;
pub use scattered::scattered;
pub use series::Series;
pub(crate) use size_biased::SizeBiased;
pub use tabulated::Tabulated;
pub use truncated::Truncated;
pub use weibull::Weibull;

pub use crate::numerics::breakpoints::{Atom, Breakpoint};

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Debug;
use std::sync::Arc;

use num_complex::Complex64;

use crate::error::{not_negative, positive};
use crate::random::Stream;
use crate::{Error, Result};
use inversion::invert_ln_survival;

/// A shared distribution.
pub type SharedLaw = Arc<dyn Law>;

/// The derivative of a survival function by a parameter, as a function of x.
pub type SurvivalDerivative = Box<dyn Fn(f64) -> f64 + Send + Sync>;

/// A named parameter of a distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, as in a scenario; in a mixture with the index of the component, `0.weight`, `0.mean`, ….
    pub name: Cow<'static, str>,
    /// Its value.
    pub value: f64,
}

impl Parameter {
    fn new(name: &'static str, value: f64) -> Self {
        Self { name: Cow::Borrowed(name), value }
    }
}

/// An interval that holds all but 1e-18 of a density or the bulk of a long tail, with the length scale on
/// which the density varies there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Length over which the density varies little between its breakpoints (the standard deviation of a
    /// Gaussian); infinite for piecewise polynomials.
    pub resolution: f64,
}

/// Mass that a zone may leave out at either end.
const ALL: f64 = 1e-18;

impl Zone {
    /// Width in resolutions of cells on which 16 Legendre terms represent a Gaussian to 1e-14.
    pub(crate) const CELL: f64 = 1.4;

    /// The zone from `low` to `high`, cut ten standard deviations above the mean.
    fn of(low: f64, high: f64, mean: f64, std: f64) -> Self {
        Self { low, high: high.min(mean + 10.0 * std), resolution: std }
    }
}

/// A distribution with several parameters replaced; `first` replaces one of the original. Compiled once for all distributions.
fn replaced(first: &dyn Fn(&str, f64) -> Result<SharedLaw>, values: &[(&str, f64)]) -> Result<SharedLaw> {
    let in_order = |mut values: Vec<(&str, f64)>| {
        let (name, value) = values.remove(0);
        let law = first(name, value)?;
        values.into_iter().try_fold(law, |law, (name, value)| law.with_parameter(name, value))
    };
    if values.is_empty() {
        return Err(Error::invalid("parameters", "one or more", "none"));
    }
    // The ends of a range that moves are replaced one after the other: the far one must come first.
    in_order(values.to_vec()).or_else(|_| in_order(values.iter().rev().copied().collect()))
}

/// A probability distribution on x ≥ 0. x is in the unit of the stretch.
pub trait Law: Debug + Send + Sync {
    /// The name, as in a scenario.
    fn name(&self) -> &'static str;

    /// The parameters in the order of the documentation; empty for distributions given by a table.
    fn parameters(&self) -> Vec<Parameter>;

    /// The same distribution with one parameter replaced.
    ///
    /// # Errors
    /// An unknown name, or a value outside the range of the parameter.
    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw>;

    /// The same distribution with several parameters replaced, one or more.
    ///
    /// # Errors
    /// As [`Self::with_parameter`].
    fn with_parameters(&self, values: &[(&str, f64)]) -> Result<SharedLaw> {
        replaced(&|name, value| self.with_parameter(name, value), values)
    }

    /// ∂S(x)/∂θ for one parameter θ, as a function of x: in closed form, or else by central differences of
    /// eighth order of S, with a relative error of about 1e-11.
    ///
    /// # Errors
    /// An unknown name; a parameter at the end of its range; the position of a point mass, for which ∂S/∂θ is
    /// a point mass itself.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        derivative::by_differences(&self.parameters(), name, &|value| self.with_parameter(name, value))
    }

    /// Density p(x) of the part without point masses, per unit length; 0 for x < 0.
    fn density(&self, x: f64) -> f64;

    /// ln p(x), also where p underflows; −∞ where p is 0. Without a closed form it is taken from the hazard rate and ln S, neither
    /// of which underflows in the upper tail.
    fn ln_density(&self, x: f64) -> f64 {
        let (density, ln_survival) = (self.density(x), self.ln_survival(x));
        // The hazard is infinite beyond the support.
        if density > f64::MIN_POSITIVE || ln_survival == f64::NEG_INFINITY {
            return density.ln();
        }
        self.hazard(x).ln() + ln_survival
    }

    /// Survival function S(x) = P(ξ > x): 1 for x < 0, continuous from the right.
    fn survival(&self, x: f64) -> f64;

    /// ln S(x), accurate far into the tail; −∞ where S = 0.
    fn ln_survival(&self, x: f64) -> f64;

    /// Distribution function P(ξ ≤ x) = 1 − S(x), without cancellation where it is small.
    fn cumulative(&self, x: f64) -> f64 {
        -self.ln_survival(x).exp_m1()
    }

    /// ln P(ξ ≤ x), accurate in both tails; −∞ where P is 0. Distributions whose lower tail has no end on x > 0 override this, so
    /// that it does not underflow there.
    fn ln_cumulative(&self, x: f64) -> f64 {
        let below = self.cumulative(x);
        if below < 0.5 { below.ln() } else { (-self.survival(x)).ln_1p() }
    }

    /// Hazard rate p(x)/S(x) of the part without point masses, accurate far into the tail; ∞ where S = 0.
    fn hazard(&self, x: f64) -> f64;

    /// The smallest x with P(ξ ≤ x) ≥ p, for p in `[0, 1]`: the lower end of the support for p = 0, the upper
    /// end, perhaps infinite, for p = 1.
    fn quantile(&self, p: f64) -> f64;

    /// The smallest x with S(x) ≤ q, for q in `[0, 1]`: accurate for small q, where `quantile(1 - q)` is not.
    fn upper_quantile(&self, q: f64) -> f64;

    /// Partial moment ∫_{(x, ∞)} ξⁿ dP(ξ) of order n; the whole moment for x < 0.
    fn upper_moment(&self, order: u32, x: f64) -> f64;

    /// The mean.
    fn mean(&self) -> f64 {
        self.upper_moment(1, -1.0)
    }

    /// The standard deviation.
    fn std(&self) -> f64;

    /// The point masses, by rising position.
    fn atoms(&self) -> Vec<Atom> {
        Vec::new()
    }

    /// The points x ≥ 0 at which the density is not smooth, by rising position. They include the ends of a
    /// compact support, and x = 0 if p(0⁺) or a low derivative there is not 0.
    fn breakpoints(&self) -> Vec<Breakpoint>;

    /// Where the density is not negligible, and on which length scale it varies: one zone for a unimodal
    /// distribution, several for a mixture.
    fn zones(&self) -> Vec<Zone> {
        vec![Zone::of(self.quantile(ALL), self.upper_quantile(ALL), self.mean(), self.std())]
    }

    /// The boundaries of the pieces of a density that is given piece by piece, whether it is smooth there or
    /// not.
    fn seams(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The rate λ of an exponential tail, S(x) ~ exp(−λx): infinite if S falls faster, 0 if it falls more
    /// slowly.
    fn decay_rate(&self) -> f64 {
        f64::INFINITY
    }

    /// The hazard rate of a distribution without memory, where it is the same at every x; `None` for others.
    fn constant_hazard(&self) -> Option<f64> {
        None
    }

    /// Largest λ for which E[e^{λξ}] is reliable: infinite unless the tail was truncated. Relaxation faster
    /// than exp(−λX) is then not determined.
    fn known_rate(&self) -> f64 {
        f64::INFINITY
    }

    /// The components of a mixture with their weights; `None` for others.
    fn components(&self) -> Option<&[(f64, SharedLaw)]> {
        None
    }

    /// Whether [`Law::laplace`] is a closed form, not a quadrature.
    fn laplace_is_closed(&self) -> bool {
        true
    }

    /// Laplace transform E[e^{−sξ}], continued analytically to Re s < 0 as far as possible.
    fn laplace(&self, s: Complex64) -> Complex64;

    /// The Laplace transform and its derivative −E[ξ e^{−sξ}]: in closed form, or else by Cauchy's formula from eight
    /// points around s, on a circle that is small against mean/variance, about the distance from 0 to singularities.
    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let (mean, std) = (self.mean(), self.std());
        let radius = 0.02 * (1.0 / mean).min(mean / (std * std));
        let around = (0..8).map(|k| Complex64::from_polar(radius, f64::from(k) * FRAC_PI_4));
        [self.laplace(s), around.map(|h| self.laplace(s + h) / h).sum::<Complex64>() / 8.0]
    }

    /// Fills `out` with independent draws. Numbers are taken from the stream strictly in order, so that
    /// filling in pieces gives the same numbers as filling at once.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]);
}

/// The error for a parameter `name` that the distribution does not have.
fn unknown(law: &dyn Law, name: &str) -> Error {
    let names: Vec<_> = law.parameters().into_iter().map(|p| p.name).collect();
    let expected = if names.is_empty() {
        format!("no parameter: {} has none", law.name())
    } else {
        format!("a parameter of {}: {}", law.name(), names.join(", "))
    };
    Error::invalid(name, expected, name)
}

/// Wraps a new distribution in an `Arc`.
fn shared<L: Law + 'static>(law: Result<L>) -> Result<SharedLaw> {
    law.map(|law| Arc::new(law) as SharedLaw)
}

/// The breakpoint at 0 of a density that starts as `amplitude` x^`exponent`/Γ(`exponent` + 1), if any.
///
/// High powers are omitted: derivatives of that order matter to no method.
fn breakpoint_at_zero(exponent: f64, amplitude: f64) -> Vec<Breakpoint> {
    const SMOOTH: f64 = 12.0;
    if amplitude == 0.0 || exponent > SMOOTH {
        return Vec::new();
    }
    vec![Breakpoint { position: 0.0, exponent, amplitude }]
}
