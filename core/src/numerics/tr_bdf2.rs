//! A step in time of two stages: the trapezoidal rule to a point within it, the second backward difference to its end.
//!
//! R. E. Bank et al., *Transient simulation of silicon devices and circuits*, IEEE Trans. Electron Devices 32, 1992 (1985);
//! the estimate of the error is that of M. E. Hosea and L. F. Shampine, Appl. Numer. Math. 20, 21 (1996). The rule is of
//! second order and damps at once whatever is too fast for it. At the end of either stage the rate of change of what has
//! advanced by δ in it is αδ + `carried`.

/// The fraction of a step at which the stages meet, 2 − √2: then both have the same α.
pub const GAMMA: f64 = 2.0 - std::f64::consts::SQRT_2;

/// (1 − GAMMA)²/[GAMMA (2 − GAMMA)], how much of the first advance the second backward difference goes on with.
pub const HISTORY: f64 = (1.0 - GAMMA) * (1.0 - GAMMA) / (GAMMA * (2.0 - GAMMA));

/// Weights of the quadrature of second degree through the ends of the stages.
pub const WEIGHTS: [f64; 3] =
    [0.5 - 1.0 / (6.0 * GAMMA), 1.0 / (6.0 * GAMMA * (1.0 - GAMMA)), 0.5 - 1.0 / (6.0 * (1.0 - GAMMA))];

/// Twice the constant of the local error, times the third derivative.
const ERROR: f64 = (-3.0 * GAMMA * GAMMA + 4.0 * GAMMA - 2.0) / (6.0 * (2.0 - GAMMA));

/// The largest factor by which a step grows, and the least by which it shrinks.
pub const CHANGE: (f64, f64) = (3.0, 0.2);

/// α of a step.
pub fn alpha(duration: f64) -> f64 {
    2.0 / (GAMMA * duration)
}

/// The estimate of the error of a step, from the rates at its start, between its stages and at its end.
pub fn error(duration: f64, rates: [f64; 3]) -> f64 {
    ERROR * duration * (rates[0] / GAMMA - rates[1] / (GAMMA * (1.0 - GAMMA)) + rates[2] / (1.0 - GAMMA))
}

/// By which factor a step may grow, or has to shrink, whose error is this part of what it may be.
pub fn change(error: f64) -> f64 {
    (0.9 / error.cbrt()).clamp(CHANGE.1, CHANGE.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of X' = −X: as good as its order says, and the error estimated.
    #[test]
    fn a_step_is_of_second_order_and_knows_its_error() {
        let step = |h: f64| {
            let alpha = alpha(h);
            // αδ + carried = −(X + δ).
            let stage = |x: f64, carried: f64| -(x + carried) / (1.0 + alpha);
            let first = stage(1.0, 1.0);
            let second = stage(1.0 + first, -alpha * HISTORY * first);
            let end = 1.0 + first + second;
            (end - (-h).exp(), error(h, [-1.0, -(1.0 + first), -end]))
        };
        for h in [0.02, 0.01] {
            let (off, told) = step(h);
            // The next order, of h, in units of this one.
            assert!((off / told + 1.0).abs() < h, "{off} {told}");
        }
        let order = (step(0.02).0 / step(0.01).0).log2();
        assert!((order - 3.0).abs() < 0.05, "{order}");
    }
}
