//! Gamma thresholds of any shape: a sum of incomplete gamma functions.

use std::f64::consts::TAU;

use super::extrema::{highest, steepest_fall, window};
use super::{ClosedForm, positive};
use crate::Result;

/// P_c = x^{k−1} e^{−x/θ}/(θ^k Γ(k)); R = Q_ini = δ.
///
/// The n-fold convolution p_n is the gamma density of shape nk, and X p_n(X)/n = x̄ g_{nk+1}(X), with g_a the gamma density of
/// shape a and scale θ, and x̄ = kθ. So
///
/// F'(X) = 1 − x̄ Σ_{n≥1} g_{nk+1}(X), F = X − x̄ Σ_{n≥1} P(nk + 1, X/θ),
///
/// with the regularised incomplete gamma function P, and F_k = (k+1)θ/2. Cost ∝ X/x̄; the difference loses log₁₀(X/F_k) digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gamma {
    /// x̄ = kθ > 0, the mean.
    pub mean: f64,
    /// σ = θ√k > 0, the standard deviation.
    pub std: f64,
}

impl Gamma {
    /// k, the shape.
    fn shape(&self) -> f64 {
        (self.mean / self.std).powi(2)
    }

    /// θ, the scale, a length.
    fn scale(&self) -> f64 {
        self.std * (self.std / self.mean)
    }

    /// Sum over the breaks n = 1, 2, … of a term that falls with n once n x̄ > X.
    fn over_breaks(&self, position: f64, term: impl Fn(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for n in 1.. {
            let n = f64::from(n);
            let added = term(n * self.shape() + 1.0);
            sum += added;
            if n * self.mean > position && added <= 1e-18 * sum {
                break;
            }
        }
        sum
    }

    fn grid(&self) -> Vec<f64> {
        window(self.mean, self.std)
    }
}

impl ClosedForm for Gamma {
    fn check(&self) -> Result<()> {
        positive("mean", self.mean)?;
        positive("std", self.std).map(drop)
    }

    fn reach(&self) -> f64 {
        1e5 * self.mean
    }

    fn force(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let x = position / self.scale();
        position - self.mean * self.over_breaks(position, |a| lower(a, x))
    }

    fn slope(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        if position == 0.0 {
            return 1.0;
        }
        let x = position / self.scale();
        1.0 - self.shape() * self.over_breaks(position, |a| poisson(a - 1.0, x))
    }

    fn kinetic_friction(&self) -> f64 {
        0.5 * (self.mean + self.scale())
    }

    fn static_friction(&self) -> Option<(f64, f64)> {
        highest(|x| self.force(x), |x| self.slope(x), &self.grid())
    }

    fn critical_stiffness(&self) -> f64 {
        steepest_fall(|x| self.slope(x), &self.grid())
    }
}

/// Shapes from here on use Stirling's formula, whose next term is 3e-16 there.
const LARGE: f64 = 24.0;

/// x^a e^{−x}/Γ(a + 1), the probability of a events of which x are expected; for large a as C. Loader, *Fast and accurate
/// computation of binomial probabilities* (2000), computes it, without the difference of large logarithms.
fn poisson(a: f64, x: f64) -> f64 {
    if a < LARGE {
        return x.powf(a) * (-x).exp() / libm::tgamma(a + 1.0);
    }
    let excess = (x - a) / a;
    let square = 1.0 / (a * a);
    let remainder = (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0))) / a;
    (-a * (excess - excess.ln_1p()) - remainder).exp() / (TAU * a).sqrt()
}

/// P(a, x), the regularised lower incomplete gamma function, by its series of positive terms (DLMF 8.7.1):
/// P = x^a e^{−x}/Γ(a + 1) Σ_{j≥0} x^j/[(a + 1) … (a + j)]. Distributions have a function of their own, with which this one
/// shares nothing.
fn lower(a: f64, x: f64) -> f64 {
    // 1 − P is below 1e-20 there.
    if x - a > 10.0 * x.sqrt() + 50.0 {
        return 1.0;
    }
    let (mut sum, mut term, mut denominator) = (1.0, 1.0, a);
    while term > 1e-17 * sum {
        denominator += 1.0;
        term *= x / denominator;
        sum += term;
    }
    poisson(a, x) * sum
}
