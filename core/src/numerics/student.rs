//! Quantiles of Student's t distribution.

use puruspe::invbetai;

/// The t that |T| exceeds with probability `tail`, for T of Student's distribution with `freedom` > 0 degrees
/// of freedom.
///
/// P(|T| > t) = I_x(ν/2, ½) with x = ν/(ν + t²), I being the regularised incomplete beta function.
pub fn two_sided(tail: f64, freedom: f64) -> f64 {
    let x = invbetai(tail, 0.5 * freedom, 0.5);
    (freedom * (1.0 - x) / x).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Closed forms for one degree of freedom, cot(πp/2), and for two, (1 − p)√(2/(p(2 − p))); the normal
    /// distribution for many; tables for ten.
    #[test]
    fn agrees_with_closed_forms_and_tables() {
        for tail in [0.3, 0.05, 0.01] {
            let one = 1.0 / (0.5 * PI * tail).tan();
            let two = (1.0 - tail) * (2.0 / (tail * (2.0 - tail))).sqrt();
            // invbetai is iterated to 1e-8.
            assert!((two_sided(tail, 1.0) / one - 1.0).abs() < 1e-6, "{} {one}", two_sided(tail, 1.0));
            assert!((two_sided(tail, 2.0) / two - 1.0).abs() < 1e-6, "{} {two}", two_sided(tail, 2.0));
        }
        // Printed digits of tables; the first correction to the normal quantile is (z³ + z)/4ν = 2.4e-6.
        assert!((two_sided(0.05, 10.0) - 2.228).abs() < 5e-4);
        assert!((two_sided(0.05, 1e6) - 1.959_966_4).abs() < 1e-6);
    }
}
