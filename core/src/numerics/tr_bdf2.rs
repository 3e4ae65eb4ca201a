//! TR-BDF2: a time step of the trapezoidal rule to an intermediate time, then of the second-order backward
//! difference formula to the end.
//!
//! R. E. Bank et al., *Transient simulation of silicon devices and circuits*, IEEE Trans. Electron Devices
//! 32, 1992 (1985); the error estimate is that of M. E. Hosea and L. F. Shampine, Appl. Numer. Math. 20, 21
//! (1996). The method is of second order and L-stable: it damps at once what is too fast for it. At the end
//! of either stage the rate of change of a quantity that has changed by δ in that stage is αδ + a known part.

/// The intermediate time as a fraction of the step, γ = 2 − √2: then both stages have the same α.
pub const GAMMA: f64 = 2.0 - std::f64::consts::SQRT_2;

/// (1 − γ)²/[γ (2 − γ)]: the weight of the change in the first stage in the second-order backward difference.
pub const HISTORY: f64 = (1.0 - GAMMA) * (1.0 - GAMMA) / (GAMMA * (2.0 - GAMMA));

/// Weights of the quadrature of degree 2 with nodes at the start, the intermediate time and the end.
pub const WEIGHTS: [f64; 3] =
    [0.5 - 1.0 / (6.0 * GAMMA), 1.0 / (6.0 * GAMMA * (1.0 - GAMMA)), 0.5 - 1.0 / (6.0 * (1.0 - GAMMA))];

/// Twice the error constant: the local error is the constant × the third derivative.
const ERROR: f64 = (-3.0 * GAMMA * GAMMA + 4.0 * GAMMA - 2.0) / (6.0 * (2.0 - GAMMA));

/// The largest factor by which a step grows, and the smallest by which it shrinks.
pub const CHANGE: (f64, f64) = (3.0, 0.2);

/// α of a step of this duration.
pub fn alpha(duration: f64) -> f64 {
    2.0 / (GAMMA * duration)
}

/// The estimated local error of a step, from the rates at its start, intermediate time and end.
pub fn error(duration: f64, rates: [f64; 3]) -> f64 {
    ERROR * duration * (rates[0] / GAMMA - rates[1] / (GAMMA * (1.0 - GAMMA)) + rates[2] / (1.0 - GAMMA))
}

/// The factor by which the step should change, for an error given as a fraction of the tolerance.
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
