//! The standard normal law on the whole line, right far into its upper tail.

use std::f64::consts::{FRAC_1_SQRT_2, LN_2, TAU};

use puruspe::erfcx;

/// √(2/π).
const SQRT_2_OVER_PI: f64 = 0.797_884_560_802_865_4;

/// φ(z) = exp(−z²/2)/√(2π).
pub(super) fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / TAU.sqrt()
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
