//! The integrals of e^{x²} from 0 and of e^{−τ³} to infinity, without their exponentials, from tables.

use std::sync::LazyLock;

use super::dawson::dawson;
use super::legendre::{NODES, Nodal, RULE};
use super::table::Table;

/// (1 + x)² D(x)/x.
static DAWSON: LazyLock<Table> = LazyLock::new(|| Table::of(|x| (1.0 + x).powi(2) * dawson(x) / x));
/// (1 + t) g(t).
static CUBIC: LazyLock<Table> = LazyLock::new(|| Table::of(|t| (1.0 + t) * cubic_by_panels(t)));

/// D(x) = e^{−x²} ∫₀ˣ e^{s²} ds for x ≥ 0, Dawson's integral.
#[inline]
pub fn dawson_by_table(x: f64) -> f64 {
    x / (1.0 + x).powi(2) * DAWSON.value(x)
}

/// D at sixteen places.
#[inline(always)]
pub fn dawsons_by_table(x: &Nodal) -> Nodal {
    let mut values = DAWSON.values(x);
    for i in 0..NODES {
        values[i] *= x[i] / ((1.0 + x[i]) * (1.0 + x[i]));
    }
    values
}

/// g(t) = e^{t³} ∫_t^∞ 2τ e^{−τ³} dτ for t ≥ 0, an incomplete gamma function.
#[inline]
pub fn cubic(t: f64) -> f64 {
    CUBIC.value(t) / (1.0 + t)
}

/// g at sixteen places.
#[inline(always)]
pub fn cubics(t: &Nodal) -> Nodal {
    let mut values = CUBIC.values(t);
    for i in 0..NODES {
        values[i] /= 1.0 + t[i];
    }
    values
}

/// g(t), up to e^{−40} of its integrand, in panels over which that falls by e⁻⁴.
fn cubic_by_panels(t: f64) -> f64 {
    const PART: f64 = 4.0;
    const PARTS: u32 = 10;
    let cube = t.powi(3);
    // τ − t from τ³ − t³, without cancellation.
    let beyond = |excess: f64| {
        let tau = (cube + excess).cbrt();
        excess / (tau * tau + tau * t + t * t).max(f64::MIN_POSITIVE)
    };
    let part = |k: u32| {
        let [low, high] = [k, k + 1].map(|k| beyond(PART * f64::from(k)));
        RULE.integrate(low, high, |r| 2.0 * (t + r) * (-r * (3.0 * t * t + r * (3.0 * t + r))).exp())
    };
    (0..PARTS).map(part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_incomplete_gamma_function_is_right_at_its_ends() {
        // ∫2τ e^{−τ³} dτ = ⅔Γ(⅔), and 2/3t (1 − 1/3t³ + 4/9t⁶ − 28/27t⁹ …).
        assert!((cubic_by_panels(0.0) - 2.0 / 3.0 * libm::tgamma(2.0 / 3.0)).abs() < 2e-15);
        let s = 1e-6;
        let far = 2.0 / 300.0 * (1.0 - s / 3.0 + 4.0 / 9.0 * s * s);
        assert!((cubic_by_panels(100.0) / far - 1.0).abs() < 2e-15);
        for k in 0..1000 {
            let t = 1e-3 * 1.01_f64.powi(k);
            assert!((cubic(t) / cubic_by_panels(t) - 1.0).abs() < 3e-15, "{t}");
        }
    }
}
