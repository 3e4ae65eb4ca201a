//! The two-point Gauss rule with the weight e^{−cz} on [0, 1], for rates that fall exponentially from one end
//! of a step by any amount.

/// Nodes z with weights of ∫₀¹ f dz, exact for f = e^{−cz} times a polynomial of degree 3; c ≥ 0.
pub(super) fn fitted(c: f64) -> [(f64, f64); 2] {
    // In units of t = z max(c, 1), in which no moment underflows.
    let unit = c.max(1.0);
    let [m0, m1, m2, m3] = moments(c);
    // t² + at + b is orthogonal to polynomials of degree 1.
    let determinant = m1 * m1 - m0 * m2;
    let a = (m0 * m3 - m1 * m2) / determinant;
    let b = (m2 * m2 - m1 * m3) / determinant;
    let root = (0.25 * a * a - b).sqrt();
    let points = [-0.5 * a - root, -0.5 * a + root];
    let second = (m1 - points[0] * m0) / (2.0 * root);
    let weights = [m0 - second, second];
    std::array::from_fn(|i| {
        let z = points[i] / unit;
        (z, weights[i] / unit * (c * z).exp())
    })
}

/// ∫ t^j e^{−t c/u} dt from 0 to u = max(c, 1), for j up to 3.
fn moments(c: f64) -> [f64; 4] {
    let end = (-c).exp();
    if c >= 1.0 {
        let m0 = 1.0 - end;
        let m1 = m0 - c * end;
        let m2 = 2.0 * m1 - c * c * end;
        return [m0, m1, m2, 3.0 * m2 - c * c * c * end];
    }
    /// Terms of Σ (−c)^k/[k! (k + 4)].
    const TERMS: u32 = 18;
    let (mut m3, mut power) = (0.0, 1.0);
    for k in 0..TERMS {
        m3 += power / f64::from(k + 4);
        power *= -c / f64::from(k + 1);
    }
    let m2 = (c * m3 + end) / 3.0;
    let m1 = (c * m2 + end) / 2.0;
    [c * m1 + end, m1, m2, m3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::RULE;

    #[test]
    fn exponentials_times_cubics_are_integrated_exactly() {
        for c in [0.0_f64, 1e-3, 0.3, 0.999, 1.0, 1.5, 10.0, 100.0, 1e6] {
            for power in 0..4 {
                let f = |z: f64| (z * c.max(1.0)).powi(power) * (-c * z).exp();
                let sum: f64 = fitted(c).iter().map(|&(z, weight)| weight * f(z)).sum();
                // Parts on which sixteen points are exact to rounding, up to where e^{−cz} is 1e-20.
                let end = 1.0_f64.min(46.0 / c.max(1e-9));
                let parts = (0..20).map(|k| [k, k + 1].map(|k| end * f64::from(k) / 20.0));
                let exact: f64 = parts.map(|[from, to]| RULE.integrate(from, to, f)).sum();
                // Rounding, that the differences of moments near c = 1 amplify.
                assert!((sum / exact - 1.0).abs() < 1e-11, "{c} {power}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn without_a_weight_it_is_that_of_legendre() {
        for ((z, weight), sign) in fitted(0.0).into_iter().zip([-1.0, 1.0]) {
            // Rounding.
            assert!((z - 0.5 - sign / 12.0_f64.sqrt()).abs() < 1e-13 && (weight - 0.5).abs() < 1e-13);
        }
    }
}
