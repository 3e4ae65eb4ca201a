//! Probability laws on x ≥ 0: of thresholds, of re-formed stretches, of initial stretches.
//!
//! Every law is a sum of point masses ([`Atom`]) and a density that is smooth between [`Breakpoint`]s.
//! A law whose parent has mass below 0 is that parent conditioned on x ≥ 0: its documented
//! parameters are the parent's, [`Law::mean`] and [`Law::std`] those of the conditioned law.
//!
//! To add a law: a file of its own, shaped like its neighbours; its name in the list below; a variant
//! of the scenario; a row of the table of laws in the documentation; a line in the tests of the family.

mod critical_coupling;
mod drives;
mod exponential;
mod gamma;
mod gaussian;
mod incomplete_gamma;
mod lognormal;
mod mixture;
mod normal;
mod places;
mod point;
mod quadrature;
mod rectangular;
mod refine;
mod renormalised;
mod root;
mod scattered;
mod series;
mod tabulated;
mod weibull;
mod ziggurat;

pub use critical_coupling::critical_coupling;
pub use exponential::Exponential;
pub use gamma::Gamma;
pub use gaussian::Gaussian;
pub use lognormal::Lognormal;
pub use mixture::Mixture;
pub use point::Point;
pub use rectangular::Rectangular;
pub use renormalised::Renormalised;
pub use root::Root;
pub use scattered::scattered;
pub use series::Series;
pub use tabulated::Tabulated;
pub use weibull::Weibull;

pub use crate::numerics::breakpoints::{Atom, Breakpoint};

use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;

use num_complex::Complex64;

use crate::random::Stream;
use crate::{Error, Result};

/// A law, shared.
pub type SharedLaw = Arc<dyn Law>;

/// A named parameter of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, as in a scenario; in a mixture `0.weight`, `0.mean`, … by place.
    pub name: Cow<'static, str>,
    /// Its value.
    pub value: f64,
}

impl Parameter {
    fn new(name: &'static str, value: f64) -> Self {
        Self { name: Cow::Borrowed(name), value }
    }
}

/// A stretch of x that holds all but 1e-18 of a density or the bulk of a long tail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Where it starts.
    pub low: f64,
    /// Where it ends.
    pub high: f64,
    /// A length over which the density varies little between its breaks (a Gaussian's std); infinite for polynomials.
    pub resolution: f64,
}

/// What a zone may leave out at either end.
const ALL: f64 = 1e-18;

impl Zone {
    /// Cells of 16 terms that are this many resolutions wide leave out 1e-14 of a Gaussian.
    pub(crate) const CELL: f64 = 1.4;

    /// The zone from `low` to `high`, at most ten standard deviations above the mean.
    fn of(low: f64, high: f64, mean: f64, std: f64) -> Self {
        Self { low, high: high.min(mean + 10.0 * std), resolution: std }
    }
}

/// A probability law on x ≥ 0. Lengths are in the unit of the stretch.
pub trait Law: Debug + Send + Sync {
    /// The law's name, as in a scenario.
    fn name(&self) -> &'static str;

    /// The parameters, in the order of the documentation; empty for laws given by a table.
    fn parameters(&self) -> Vec<Parameter>;

    /// The same law with one parameter replaced.
    ///
    /// # Errors
    /// An unknown name, or a value that the law cannot have.
    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw>;

    /// Density p(x) of the part without point masses, per unit length; 0 for x < 0.
    fn density(&self, x: f64) -> f64;

    /// Survival S(x) = P(ξ > x): 1 for x < 0, continuous from the right.
    fn survival(&self, x: f64) -> f64;

    /// ln S(x), right far into the tail; −∞ where S = 0.
    fn ln_survival(&self, x: f64) -> f64;

    /// P(ξ ≤ x) = 1 − S(x), without cancellation where it is small.
    fn cumulative(&self, x: f64) -> f64 {
        -self.ln_survival(x).exp_m1()
    }

    /// Hazard p(x)/S(x) of the part without point masses, right far into the tail; ∞ where S = 0.
    fn hazard(&self, x: f64) -> f64;

    /// The smallest x with P(ξ ≤ x) ≥ p, for p in `[0, 1]`; at 0 the lower end of the support, at 1 the upper one,
    /// perhaps infinite.
    fn quantile(&self, p: f64) -> f64;

    /// The smallest x with S(x) ≤ q, for q in `[0, 1]`: accurate for tiny q, where `quantile(1 - q)` is not.
    fn upper_quantile(&self, q: f64) -> f64;

    /// ∫_{(x, ∞)} ξⁿ dP(ξ); the moment of order n for x < 0.
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

    /// Where the density is not smooth on x ≥ 0, by rising position; includes the ends of a compact support and x = 0
    /// where p(0⁺) or a low derivative there is not 0.
    fn breakpoints(&self) -> Vec<Breakpoint>;

    /// Where the density is to be looked for, and how finely: one zone for a law of one shape, several for a mixture.
    fn zones(&self) -> Vec<Zone> {
        vec![Zone::of(self.quantile(ALL), self.upper_quantile(ALL), self.mean(), self.std())]
    }

    /// Where a density that is given piece by piece goes over from one piece to the next, smoothly or not: between them it
    /// can be followed more closely than across.
    fn seams(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The rate λ of an exponential tail, S(x) ~ exp(−λx): infinite where S falls faster, 0 where it falls slower.
    fn decay_rate(&self) -> f64 {
        f64::INFINITY
    }

    /// The rate λ such that the law tells what hangs on e^{λξ}: infinite but for a law whose tail was cut off, of which
    /// nothing is claimed that decays faster than exp(−λX).
    fn known_rate(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether [`Law::laplace`] is a closed form, not a quadrature.
    fn laplace_is_closed(&self) -> bool {
        true
    }

    /// Laplace transform E[e^{−sξ}], continued analytically to Re s < 0 as far as it goes.
    fn laplace(&self, s: Complex64) -> Complex64;

    /// Fills `out` with independent draws, taken from the stream strictly in order: filling in pieces is filling at once.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]);
}

/// `value`, if it is a finite number above 0.
fn positive(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(key, "a finite number above 0", value))
}

/// `value`, if it is a finite number, 0 or above.
fn not_negative(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(key, "a finite number, 0 or above", value))
}

/// A law that has no parameter `name`.
fn unknown(law: &dyn Law, name: &str) -> Error {
    let names: Vec<_> = law.parameters().into_iter().map(|p| p.name).collect();
    let expected = if names.is_empty() {
        format!("no parameter: {} has none", law.name())
    } else {
        format!("a parameter of {}: {}", law.name(), names.join(", "))
    };
    Error::invalid(name, expected, name)
}

/// A law just made, to be shared.
fn shared<L: Law + 'static>(law: Result<L>) -> Result<SharedLaw> {
    law.map(|law| Arc::new(law) as SharedLaw)
}

/// The smallest x ≥ 0 with ln S(x) ≤ `level`; infinite for −∞.
///
/// Doubles above 0 are ordered like their bits: 63 bisections end between two neighbours.
fn crossing(ln_survival: impl Fn(f64) -> f64, level: f64) -> f64 {
    // Its square is finite.
    const FAR: f64 = 1e150;
    if level == f64::NEG_INFINITY {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0, FAR.to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        if ln_survival(f64::from_bits(middle)) <= level { high = middle } else { low = middle + 1 }
    }
    f64::from_bits(low)
}

/// The break at 0 of a density that sets out as `amplitude` x^`exponent`/Γ(`exponent` + 1), if any.
///
/// A high power is left out: no derivative that a method could use is broken there.
fn onset(exponent: f64, amplitude: f64) -> Vec<Breakpoint> {
    const SMOOTH: f64 = 12.0;
    if amplitude == 0.0 || exponent > SMOOTH {
        return Vec::new();
    }
    vec![Breakpoint { position: 0.0, exponent, amplitude }]
}
