//! The standard normal distribution on the whole line, accurate far into its upper tail.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI, LN_2, TAU};

use num_complex::Complex64;
use puruspe::{erfcx, faddeeva};

/// √(2/π).
const SQRT_2_OVER_PI: f64 = 0.797_884_560_802_865_4;

/// ln √(2π).
const LN_SQRT_TAU: f64 = 0.918_938_533_204_672_7;

/// φ(z) = exp(−z²/2)/√(2π).
pub(super) fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / TAU.sqrt()
}

/// ln φ(z).
pub(super) fn ln_density(z: f64) -> f64 {
    -0.5 * z * z - LN_SQRT_TAU
}

/// P(Z > z) = ½ erfc(z/√2).
pub(super) fn survival(z: f64) -> f64 {
    0.5 * libm::erfc(z * FRAC_1_SQRT_2)
}

/// ln P(Z > z), with erfc(t) = exp(−t²) erfcx(t) above 0.
pub(super) fn ln_survival(z: f64) -> f64 {
    if z < 0.0 {
        return (-survival(-z)).ln_1p();
    }
    (erfcx(z * FRAC_1_SQRT_2)).ln() - LN_2 - 0.5 * z * z
}

/// φ(z)/P(Z > z) = √(2/π)/erfcx(z/√2).
pub(super) fn hazard(z: f64) -> f64 {
    if z < -1.0 {
        return density(z) / survival(z);
    }
    SQRT_2_OVER_PI / erfcx(z * FRAC_1_SQRT_2)
}

/// Scaled complementary error function erfcx(z) = exp(z²) erfc(z) for Re z ≥ 0.
pub(super) fn complex_erfcx(z: Complex64) -> Complex64 {
    let at = |re: f64, im: f64| {
        let (re, im) = faddeeva(-im, re);
        Complex64::new(re, im)
    };
    // Closer to the imaginary axis than 1e-8 |z| the library has seven digits: a Taylor step from a point
    // away from it.
    let offset = 2e-8 * z.im.abs();
    if z.re >= offset {
        return at(z.re, z.im);
    }
    let (near, value) = (Complex64::new(offset, z.im), at(offset, z.im));
    value + (z.re - offset) * (2.0 * near * value - FRAC_2_SQRT_PI)
}
