//! The incomplete gamma functions, accurate in both tails and for any shape.
//!
//! D(a, x) = xᵃ e⁻ˣ/Γ(a) is factored out, so that ratios stay accurate where P or Q underflow. Methods: the
//! power series of P/D below max(a, 1); Legendre's continued fraction of Q/D above (DLMF 8.7.1, 8.9.2); for
//! shapes above 20 around x = a Temme's uniform asymptotic expansion, its coefficients by backward recurrence
//! (Gil, Segura & Temme, SIAM J. Sci. Comput. 34, A2965, 2012, §2.5).

use std::f64::consts::{PI, TAU};

use puruspe::erfcx;

/// Shapes from here on use asymptotic expansions.
const LARGE: f64 = 20.0;

/// As good as infinite, and nothing overflows.
const FAR: f64 = 1e200;

/// A shape a > 0 with Γ(a).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GammaShape {
    pub(super) a: f64,
    gamma: GammaOfShape,
}

/// Γ(a) in a form that does not overflow.
#[derive(Debug, Clone, Copy, PartialEq)]
enum GammaOfShape {
    /// Γ(a) and ln Γ(a).
    Direct { gamma: f64, ln: f64 },
    /// For a large shape: the remainder of Stirling's formula for ln Γ(a).
    Stirling(f64),
}

/// The regularised functions P(a, x) and Q(a, x) at one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct IncompleteGamma {
    kernel: f64,
    ln_kernel: f64,
    tail: Tail,
}

/// The tail that does not approach 1, divided by D.
#[derive(Debug, Clone, Copy)]
enum Tail {
    Lower(f64),
    Upper(f64),
}

impl GammaShape {
    pub(super) fn new(a: f64) -> Self {
        let direct = || GammaOfShape::Direct { gamma: libm::tgamma(a), ln: libm::lgamma(a) };
        Self { a, gamma: if a >= LARGE { GammaOfShape::Stirling(stirling(a)) } else { direct() } }
    }
}

impl IncompleteGamma {
    /// At x ≥ 0. `excess` is x/a − 1, which the caller may know more accurately than a and x give it.
    pub(super) fn new(shape: &GammaShape, x: f64, excess: f64) -> Self {
        let (x, excess) = (x.min(FAR), excess.min(FAR));
        let a = shape.a;
        let (kernel, ln_kernel) = kernel(shape, x, excess);
        let tail = if is_uniform(a, excess) {
            uniform(a, excess)
        } else if x < a.max(1.0) {
            Tail::Lower(series(a, x))
        } else {
            Tail::Upper(continued_fraction(a, x))
        };
        Self { kernel, ln_kernel, tail }
    }

    /// D(a, x).
    pub(super) fn kernel(&self) -> f64 {
        self.kernel
    }

    /// ln D(a, x).
    pub(super) fn ln_kernel(&self) -> f64 {
        self.ln_kernel
    }

    /// ln P(a, x).
    pub(super) fn ln_lower(&self) -> f64 {
        match self.tail {
            Tail::Lower(ratio) => self.ln_kernel + ratio.ln(),
            Tail::Upper(ratio) => (-self.kernel * ratio).ln_1p(),
        }
    }

    /// Q(a, x).
    pub(super) fn upper(&self) -> f64 {
        match self.tail {
            Tail::Lower(ratio) => 1.0 - self.kernel * ratio,
            Tail::Upper(ratio) => self.kernel * ratio,
        }
    }

    /// ln Q(a, x).
    pub(super) fn ln_upper(&self) -> f64 {
        match self.tail {
            Tail::Lower(ratio) => (-self.kernel * ratio).ln_1p(),
            Tail::Upper(ratio) => self.ln_kernel + ratio.ln(),
        }
    }

    /// D(a, x)/Q(a, x).
    pub(super) fn kernel_over_upper(&self) -> f64 {
        match self.tail {
            Tail::Lower(_) => self.kernel / self.upper(),
            Tail::Upper(ratio) => 1.0 / ratio,
        }
    }
}

/// a ∂Q(a, x)/∂a, from the derivatives of the series, the continued fraction and the uniform expansion by a (the first as
/// by R. J. Moore, Algorithm AS 187, Appl. Statist. 31, 330, 1982). Its error is a few roundings of D(a, x).
pub(super) fn upper_by_shape(shape: &GammaShape, x: f64, excess: f64) -> f64 {
    if !(x > 0.0 && x < FAR) {
        return 0.0;
    }
    let a = shape.a;
    let (kernel, _) = kernel(shape, x, excess);
    // ∂ ln D/∂a = ln x − ψ(a) = ln(x/a) + [ln a − ψ(a)].
    let of_kernel = if excess.abs() < 0.5 { excess.ln_1p() } else { (x / a).ln() } + ln_minus_digamma(a);
    let by_shape = if kernel == 0.0 {
        0.0
    } else if is_uniform(a, excess) {
        uniform_by_shape(a, excess, of_kernel)
    } else if x < a.max(1.0) {
        let (sum, slope) = series_by_shape(a, x);
        -a * (of_kernel * sum + slope)
    } else {
        let (value, slope) = continued_fraction_by_shape(a, x);
        a * (of_kernel * value + slope)
    };
    kernel * by_shape
}

/// ln a − ψ(a): the asymptotic expansion (DLMF 5.11.2) after steps of the recurrence up to large arguments.
pub(super) fn ln_minus_digamma(a: f64) -> f64 {
    const ENOUGH: f64 = 12.0;
    if a < ENOUGH {
        let (steps, mut sum) = ((ENOUGH - a).ceil(), 0.0);
        for k in 0..steps as u32 {
            sum += 1.0 / (a + f64::from(k));
        }
        return ln_minus_digamma(a + steps) - (steps / a).ln_1p() + sum;
    }
    let square = 1.0 / (a * a);
    let terms = 1.0 / 252.0 - square * (1.0 / 240.0 - square * (1.0 / 132.0 - square * (691.0 / 32760.0)));
    0.5 / a + square * (1.0 / 12.0 - square * (1.0 / 120.0 - square * terms))
}

/// The power series of P/D, and its derivative by a.
fn series_by_shape(a: f64, x: f64) -> (f64, f64) {
    let (mut term, mut harmonic, mut n) = (1.0 / a, 1.0 / a, a);
    let (mut sum, mut slope) = (term, -term * harmonic);
    while term * harmonic > -slope * 0.1 * f64::EPSILON {
        n += 1.0;
        term *= x / n;
        harmonic += 1.0 / n;
        sum += term;
        slope -= term * harmonic;
    }
    (sum, slope)
}

/// The continued fraction of Q/D, and its derivative by a: Lentz's method, differentiated.
fn continued_fraction_by_shape(a: f64, x: f64) -> (f64, f64) {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = ((1.0 / f64::MIN_POSITIVE, 0.0), (1.0 / b, 1.0 / (b * b)));
    // The value and its logarithmic derivative.
    let (mut value, mut slope) = (d.0, d.1 / d.0);
    for n in 1..5000 {
        let n = f64::from(n);
        let numerator = n * (a - n);
        b += 2.0;
        let below = 1.0 / (numerator * d.0 + b);
        d = (below, -(n * d.0 + numerator * d.1 - 1.0) * below * below);
        c = (b + numerator / c.0, -1.0 + n / c.0 - numerator / c.0 * (c.1 / c.0));
        value *= c.0 * d.0;
        let more = c.1 / c.0 + d.1 / d.0;
        slope += more;
        if (c.0 * d.0 - 1.0).abs() < 0.5 * f64::EPSILON && more.abs() < f64::EPSILON * slope.abs() {
            break;
        }
    }
    (value, value * slope)
}

/// a/D × ∂Q/∂a of Temme's expansion. With η ∂η/∂a = −μ/a its first term gives D Γ*(a) (μ/η − η/2); the second, D/a Σ βₙ ηⁿ
/// as in [`uniform`], is differentiated term by term.
fn uniform_by_shape(a: f64, excess: f64, of_kernel: f64) -> f64 {
    let eta = eta(excess);
    let (mut after, mut beta, mut sum) = ((0.0, 0.0), (0.0, 0.0), 0.0);
    let (mut by_eta, mut by_shape) = (0.0, 0.0);
    for (n, coefficient) in ETA_OVER_MU.iter().enumerate().rev() {
        let factor = (n as f64 + 2.0) / a;
        (after, beta) = (beta, (factor * after.0 + coefficient, factor * (after.1 - after.0 / a)));
        by_eta = by_eta * eta + sum;
        sum = sum * eta + beta.0;
        by_shape = by_shape * eta + beta.1;
    }
    let gamma_star = 1.0 + after.0 / a;
    let ratio = if eta == 0.0 { 1.0 } else { excess / eta };
    gamma_star * (ratio - 0.5 * eta) + sum * (of_kernel - 1.0 / a) + by_shape - by_eta * ratio / a
}

/// η of Temme's expansion.
fn eta(excess: f64) -> f64 {
    (-2.0 * ln_1p_minus(excess)).sqrt().copysign(excess)
}

/// Whether the uniform expansion holds.
fn is_uniform(a: f64, excess: f64) -> bool {
    a >= LARGE && (-0.5..1.0).contains(&excess)
}

/// D(a, x) and its logarithm.
fn kernel(&GammaShape { a, gamma }: &GammaShape, x: f64, excess: f64) -> (f64, f64) {
    match gamma {
        GammaOfShape::Stirling(rest) => {
            // Far below x = a, 1 + excess has lost digits that x has.
            let exponent = if excess < -0.5 { (x / a).ln() - excess } else { ln_1p_minus(excess) };
            let ln = 0.5 * (a / TAU).ln() + a * exponent - rest;
            ((a / TAU).sqrt() * (a * exponent - rest).exp(), ln)
        }
        GammaOfShape::Direct { gamma, ln: ln_gamma } => {
            let ln = a * x.ln() - x - ln_gamma;
            if x > 700.0 {
                return (ln.exp(), ln);
            }
            let kernel = x.powf(a) * (-x).exp() / gamma;
            (kernel, if kernel.is_normal() { kernel.ln() } else { ln })
        }
    }
}

/// Power series P/D = Σ xⁿ/(a (a+1) … (a+n)).
fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
    while term > sum * 0.1 * f64::EPSILON {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum
}

/// Q/D = 1/(x+1−a − 1(1−a)/(x+3−a − 2(2−a)/(x+5−a − …))), by Lentz's method.
fn continued_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / f64::MIN_POSITIVE, 1.0 / b);
    let mut value = d;
    for n in 1..5000 {
        let n = f64::from(n);
        let numerator = n * (a - n);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        value *= c * d;
        if (c * d - 1.0).abs() < 0.5 * f64::EPSILON {
            break;
        }
    }
    value
}

/// Temme's expansion: Q = ½ erfc(η√(a/2)) + e^{−aη²/2} T/√(2πa) and P = 1 − Q, divided by D; η²/2 = μ − ln(1
/// + μ), μ = x/a − 1.
///
/// T = (1 + β₁/a)⁻¹ Σ βₙ ηⁿ with βₙ₋₁ = (n+1) βₙ₊₁/a + fₙ, fₙ the Taylor coefficients of η/μ.
fn uniform(a: f64, excess: f64) -> Tail {
    let eta = eta(excess);
    let (mut after, mut beta, mut sum) = (0.0, 0.0, 0.0);
    for (n, coefficient) in ETA_OVER_MU.iter().enumerate().rev() {
        // β_n from β_{n+2}.
        (after, beta) = (beta, (n as f64 + 2.0) * after / a + coefficient);
        sum = sum * eta + beta;
    }
    // D = √(a/2π) e^{−aη²/2}/Γ*, and 1 + β₁/a = Γ*.
    let gamma_star = 1.0 + after / a;
    let correction = sum / a;
    let half = (0.5 * PI / a).sqrt() * gamma_star;
    let t = eta * (0.5 * a).sqrt();
    if excess < 0.0 {
        Tail::Lower(half * erfcx(-t) - correction)
    } else {
        Tail::Upper(half * erfcx(t) + correction)
    }
}

/// ln(1 + u) − u without cancellation: with r = u/(2 + u), r (2r² Σ r²ⁿ/(2n+3) − u).
fn ln_1p_minus(u: f64) -> f64 {
    if !(-0.6..1.2).contains(&u) {
        return u.ln_1p() - u;
    }
    let r = u / (2.0 + u);
    let square = r * r;
    let (mut power, mut sum, mut n) = (1.0, 1.0 / 3.0, 3.0);
    while power > f64::EPSILON {
        power *= square;
        n += 2.0;
        sum += power / n;
    }
    r * (2.0 * square * sum - u)
}

/// ln Γ(a) − [(a − ½) ln a − a + ½ ln 2π] for large a.
fn stirling(a: f64) -> f64 {
    let square = 1.0 / (a * a);
    (1.0 / 12.0
        - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square * (1.0 / 1680.0 - square / 1188.0))))
        / a
}

/// f₁, f₂, … of η/μ = 1 + Σ fₙ ηⁿ.
const ETA_OVER_MU: [f64; 26] = [
    -0.3333333333333333,
    0.08333333333333333,
    -0.014814814814814815,
    0.0011574074074074073,
    0.0003527336860670194,
    -0.0001787551440329218,
    3.919263178522438e-05,
    -2.185448510679992e-06,
    -1.85406221071516e-06,
    8.296711340953087e-07,
    -1.7665952736826078e-07,
    6.707853543401498e-09,
    1.0261809784240309e-08,
    -4.382036018453353e-09,
    9.14769958223679e-10,
    -2.5514193994946248e-11,
    -5.830772132550426e-11,
    2.4361948020667415e-11,
    -5.0276692801141755e-12,
    1.1004392031956135e-13,
    3.371763262400985e-13,
    -1.392388722418162e-13,
    2.8534893807047445e-14,
    -5.139111834242572e-16,
    -1.9752288294349442e-15,
    8.099521156704561e-16,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_methods_meet() {
        // Shape 20 lies where all three converge; each is right to a few 1e-15.
        for x in [15.0, 20.0, 26.0] {
            let excess = x / 20.0 - 1.0;
            let (kernel, _) = kernel(&GammaShape::new(20.0), x, excess);
            let (lower, upper) = (kernel * series(20.0, x), kernel * continued_fraction(20.0, x));
            assert!((lower + upper - 1.0).abs() < 1e-14);
            match uniform(20.0, excess) {
                Tail::Lower(ratio) => assert!((kernel * ratio / lower - 1.0).abs() < 1e-14),
                Tail::Upper(ratio) => assert!((kernel * ratio / upper - 1.0).abs() < 1e-14),
            }
        }
    }

    /// Where two methods meet they agree to rounding: below and above x = a, and at shape 20.
    #[test]
    fn the_methods_of_the_derivative_meet() {
        for a in [0.3, 1.0, 5.0, 19.0_f64] {
            let (x, shape) = (a.max(1.0), GammaShape::new(a));
            let [below, above] = [x * (1.0 - 1e-15), x].map(|x| upper_by_shape(&shape, x, x / a - 1.0));
            assert!((below - above).abs() < 1e-14, "{a}: {:e}", below - above);
        }
        for x in [12.0, 19.9, 20.0, 27.0, 38.0_f64] {
            let (a, excess) = (20.0, x / 20.0 - 1.0);
            let (kernel, _) = kernel(&GammaShape::new(a), x, excess);
            let of_kernel = (x / a).ln() + ln_minus_digamma(a);
            let (sum, slope) = series_by_shape(a, x);
            let (uniform, series) = (uniform_by_shape(a, excess, of_kernel), -a * (of_kernel * sum + slope));
            assert!((kernel * (uniform - series)).abs() < 3e-14, "{x}: {:e}", kernel * (uniform - series));
        }
    }

    /// xᵃ by exact powers of 2: far below the mean, where 1 + excess keeps no digits.
    #[test]
    fn the_kernel_keeps_its_digits_far_below_the_mean() {
        let at = |power: i32| 25.0 * 2.0_f64.powi(power);
        let value = |power: i32| kernel(&GammaShape::new(25.0), at(power), at(power) / 25.0 - 1.0).0;
        for power in [-10, -20, -25] {
            let ratio = 2.0_f64.powi(25) * (at(power - 1) - at(power)).exp();
            // Roundings of an exponent of up to 430.
            assert!((value(power) / value(power - 1) / ratio - 1.0).abs() < 1e-12, "{power}");
        }
    }

    #[test]
    fn the_kernel_is_one_function() {
        // Both forms at shape 20; the logarithm's error is its own size in roundings.
        let direct = 20.0_f64.powf(20.0) * (-20.0_f64).exp() / libm::tgamma(20.0);
        assert!((kernel(&GammaShape::new(20.0), 20.0, 0.0).0 / direct - 1.0).abs() < 1e-14);
    }
}
