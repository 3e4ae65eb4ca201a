//! TR-BDF2: a step in time by the trapezoidal rule up to a fraction γ of it, and by the second-order backward difference to its end.
//!
//! R. E. Bank et al., *Transient simulation of silicon devices and circuits*, IEEE Trans. Electron Devices 32, 1992 (1985);
//! the estimate of the error is that of M. E. Hosea and L. F. Shampine, Appl. Numer. Math. 20, 21 (1996). The method is of
//! second order and L-stable: it damps at once whatever is too fast for the step.

/// γ = 2 − √2: then both stages have the same α in [`StageRates`].
pub const GAMMA: f64 = 2.0 - std::f64::consts::SQRT_2;

/// (1 − γ)²/[γ(2 − γ)], the weight of the advance of the first stage in the backward difference.
const BACKWARD: f64 = (1.0 - GAMMA) * (1.0 - GAMMA) / (GAMMA * (2.0 - GAMMA));

/// Weights of the quadrature of second degree through the start, the end of the first stage and the end of a step.
pub const WEIGHTS: [f64; 3] =
    [0.5 - 1.0 / (6.0 * GAMMA), 1.0 / (6.0 * GAMMA * (1.0 - GAMMA)), 0.5 - 1.0 / (6.0 * (1.0 - GAMMA))];

/// Twice the constant of the local error, times the third derivative.
const ERROR: f64 = (-3.0 * GAMMA * GAMMA + 4.0 * GAMMA - 2.0) / (6.0 * (2.0 - GAMMA));

/// Velocity and acceleration at the end of a stage as functions of its advance δ: Ẋ = αδ + `velocity`,
/// Ẍ = αẊ + `acceleration`.
#[derive(Debug, Clone, Copy)]
pub struct StageRates {
    /// α.
    pub alpha: f64,
    velocity: f64,
    acceleration: f64,
}

impl StageRates {
    /// Of the first stage of a step of this `duration`, from velocity and acceleration at its start.
    pub fn trapezoidal(duration: f64, velocity: f64, acceleration: f64) -> Self {
        let alpha = alpha(duration);
        Self { alpha, velocity: -velocity, acceleration: -alpha * velocity - acceleration }
    }

    /// Of the second stage, from the advance of the first one and the velocities at its start and end.
    pub fn backward_difference(duration: f64, advance: f64, velocities: [f64; 2]) -> Self {
        let (alpha, [start, middle]) = (alpha(duration), velocities);
        // The same backward difference formula, applied to the velocity.
        let acceleration = -alpha * (middle + BACKWARD * (middle - start));
        Self { alpha, velocity: -alpha * BACKWARD * advance, acceleration }
    }

    /// Ẋ after an advance.
    pub fn velocity(&self, advance: f64) -> f64 {
        self.alpha * advance + self.velocity
    }

    /// Ẍ at a velocity.
    pub fn acceleration(&self, velocity: f64) -> f64 {
        self.alpha * velocity + self.acceleration
    }
}

fn alpha(duration: f64) -> f64 {
    2.0 / (GAMMA * duration)
}

/// The estimate of the error of a step, from the rates of change at its start, between its stages and at its end.
pub fn error(duration: f64, rates: [f64; 3]) -> f64 {
    ERROR * duration * (rates[0] / GAMMA - rates[1] / (GAMMA * (1.0 - GAMMA)) + rates[2] / (1.0 - GAMMA))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of X' = −X: as good as its order says, and the error estimated.
    #[test]
    fn a_step_is_of_second_order_and_knows_its_error() {
        let step = |h: f64| {
            // αδ + velocity = −(X + δ).
            let stage = |x: f64, rates: StageRates| -(x + rates.velocity(0.0)) / (1.0 + rates.alpha);
            let first = stage(1.0, StageRates::trapezoidal(h, -1.0, 0.0));
            let rates = StageRates::backward_difference(h, first, [-1.0, -(1.0 + first)]);
            let second = stage(1.0 + first, rates);
            let end = 1.0 + first + second;
            (end - (-h).exp(), error(h, [-1.0, -(1.0 + first), -end]))
        };
        for h in [0.02, 0.01] {
            let (off, reported) = step(h);
            // The next order, of h, in units of this one.
            assert!((off / reported + 1.0).abs() < h, "{off} {reported}");
        }
        let order = (step(0.02).0 / step(0.01).0).log2();
        assert!((order - 3.0).abs() < 0.05, "{order}");
    }
}
