//! Rate-and-state parameters of a computed velocity step.

use super::extent;
use super::separable::{DECAY, SeparableFit};

/// Rate-and-state parameters of a computed velocity step; forces in the unit of the curve.
///
/// ```
/// use asperity::rate_state::VelocityStep;
///
/// // A step by a factor of ten: a = 0.01, b = 0.015, D_c = 5.
/// let ratio = 10.0_f64;
/// let position: Vec<f64> = (0..200).map(|i| 0.2 * f64::from(i)).collect();
/// let curve = |x: f64| 0.6 + ratio.ln() * (0.01 + 0.015 * (-x / 5.0).exp_m1());
/// let force: Vec<f64> = position.iter().map(|&x| curve(x)).collect();
/// let found = VelocityStep::read(&position, &force, 0.6, ratio).expect("enough points");
/// assert!((found.direct - 0.01).abs() < 1e-6 && (found.evolution - 0.015).abs() < 1e-6);
/// assert!((found.distance - 5.0).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VelocityStep {
    /// Direct effect a: the force at the peak above F₀, per ln(v/v₀).
    pub direct: f64,
    /// Evolution effect b: the decrease of the force after the peak, per ln(v/v₀); negative if it increases.
    pub evolution: f64,
    /// Critical slip distance D_c, a length.
    pub distance: f64,
    /// F₀, the force before the step.
    pub before: f64,
    /// X_p, the position of the peak (that of the step itself if there is none), relative to the step.
    pub peak: f64,
    /// Root-mean-square residual of the fit over the distance, a force.
    pub residual: f64,
    /// The residual relative to the difference between the largest and the smallest force from F₀ on.
    pub residual_relative: f64,
}

/// Smallest number of points of a velocity step for a fit of three parameters.
pub(super) const FEWEST: usize = 8;

impl VelocityStep {
    /// Fits the curve after a step of the velocity by the factor `ratio`: `position` relative to the step,
    /// the `force` there, and the steady force F₀ = `before`.
    ///
    /// The squared residuals are integrated over the distance from the peak on by the trapezoidal rule, so that it does not
    /// matter where points are dense, and X is counted from the peak: in elastic contacts, as in machines, the force cannot
    /// jump, so that the direct effect takes some distance. `None` for fewer than 8 points or a ratio of 1.
    pub fn read(position: &[f64], force: &[f64], before: f64, ratio: f64) -> Option<Self> {
        let size = ratio.ln();
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let range = range(force, before);
        let peak = peak(position, force, size.signum())?;
        let (displacement, force) = (position.get(peak..)?, force.get(peak..)?);
        let displacement: Vec<f64> = displacement.iter().map(|x| x - displacement[0]).collect();
        if displacement.len() < FEWEST {
            return None;
        }
        let weights = trapezoids(&displacement);
        let fit = SeparableFit::of(&DECAY, &displacement, (force, &weights), scales(*displacement.last()?))?;
        Some(Self {
            direct: (fit.offset + fit.size - before) / size,
            evolution: fit.size / size,
            distance: fit.scale,
            before,
            peak: position[peak],
            residual: fit.residual,
            residual_relative: fit.residual / range,
        })
    }

    /// The fitted force at `position` after the step by the factor `ratio`; before the peak that of the peak.
    pub fn force(&self, position: f64, ratio: f64) -> f64 {
        let displacement = (position - self.peak).max(0.0);
        let fallen = -(-displacement / self.distance).exp_m1();
        self.before + ratio.ln() * (self.direct - self.evolution * fallen)
    }
}

/// The range of D_c for a curve of length `reach` after the peak.
pub(super) fn scales(reach: f64) -> (f64, f64) {
    (1e-3 * reach, 3.0 * reach)
}

/// The difference between the largest and the smallest of the forces and `before`.
fn range(force: &[f64], before: f64) -> f64 {
    let (low, high) = extent(force.iter().chain([&before]));
    high - low
}

/// The weights of the trapezoidal rule at the points `x`.
fn trapezoids(x: &[f64]) -> Vec<f64> {
    let last = x.len() - 1;
    (0..x.len()).map(|i| 0.5 * (x[(i + 1).min(last)] - x[i.saturating_sub(1)])).collect()
}

/// Index of the point from which on the force relaxes: its extremum in the direction of the change of
/// velocity, or the step itself if the extremum is in the second half of the distance, or too few points follow it.
fn peak(position: &[f64], force: &[f64], side: f64) -> Option<usize> {
    let highest = (0..force.len()).max_by(|&i, &j| (side * force[i]).total_cmp(&(side * force[j])))?;
    let reach = |i: usize| Some(position.get(i)? - position[0]);
    // A curve that only rises has its maximum at the end, and no direct effect to be seen: the fit
    // starts at the step.
    let early = 2.0 * reach(highest)? < reach(force.len() - 1)?;
    Some(if early && force.len() - highest >= FEWEST { highest } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step as rate-and-state friction describes it, reached over a displacement of 0.2.
    fn step(a: f64, b: f64, length: f64, ratio: f64) -> (Vec<f64>, Vec<f64>) {
        let position: Vec<f64> = (0..400).map(|i| 0.05 * f64::from(i)).collect();
        let size = f64::ln(ratio);
        let after = |x: f64| 0.6 + size * (a + b * (-(x - 0.2) / length).exp_m1());
        let force = |x: f64| if x < 0.2 { 0.6 + size * a * x / 0.2 } else { after(x) };
        let forces = position.iter().map(|&x| force(x)).collect();
        (position, forces)
    }

    #[test]
    fn a_step_gives_back_the_numbers_it_was_made_of() {
        for (a, b, ratio) in [(0.01, 0.015, 10.0), (0.012, 0.004, 0.1)] {
            let (position, force) = step(a, b, 1.5, ratio);
            let read = VelocityStep::read(&position, &force, 0.6, ratio).unwrap();
            // The decay is fitted to rounding of the forces, 1e-16, amplified by the square root of the tolerance.
            for (fitted, known) in [(read.direct, a), (read.evolution, b), (read.distance, 1.5)] {
                assert!((fitted - known).abs() < 1e-7 * known, "{fitted:?} is not {known}");
            }
            assert!(read.residual_relative < 1e-7, "{read:?}");
            assert!((read.peak - 0.2).abs() < 1e-12);
            assert!((read.force(3.0, ratio) - force[60]).abs() < 1e-9);
        }
    }

    #[test]
    fn the_residual_is_what_the_equation_does_not_describe() {
        let (position, clean) = step(0.01, 0.015, 1.5, 10.0);
        // An oscillation of root mean square 1e-4 that is no decay.
        let off = |i: usize| 1e-4 * f64::sqrt(2.0) * (2.4 * i as f64).sin();
        let force: Vec<f64> = clean.iter().enumerate().map(|(i, f)| f + off(i)).collect();
        let read = VelocityStep::read(&position, &force, 0.6, 10.0).unwrap();
        // Three parameters of 400 points follow it by chance: less than a hundredth.
        assert!((read.residual / 1e-4 - 1.0).abs() < 0.01, "{}", read.residual);
        // From the peak, a ln 10 above F₀, to the end, b ln 10 below it; the oscillation adds less than 2 × 1.5e-4.
        let range = 0.015 * f64::ln(10.0);
        assert!((read.residual / read.residual_relative - range).abs() < 3e-4, "{read:?}");
    }

    #[test]
    fn dense_points_weigh_no_more() {
        // Two decays, which one does not describe: what is fitted depends on where the squares are summed.
        let force = |x: f64| 0.6 + 0.02 * (-x).exp() + 0.01 * (-0.2 * x).exp();
        let read = |position: Vec<f64>| {
            let forces: Vec<f64> = position.iter().map(|x| force(*x)).collect();
            VelocityStep::read(&position, &forces, 0.6, 10.0).unwrap()
        };
        let even = read((0..=2000).map(|i| 0.01 * f64::from(i)).collect());
        let uneven = read((0..=2000).map(|i| 20.0 * (f64::from(i) / 2000.0).powi(3)).collect());
        // The trapezoidal rule leaves h²/12 of the second derivative, h = 0.03 at the end, where it is small.
        for (even, uneven) in [
            (even.direct, uneven.direct),
            (even.evolution, uneven.evolution),
            (even.distance, uneven.distance),
        ] {
            assert!((even / uneven - 1.0).abs() < 1e-4, "{even} {uneven}");
        }
    }

    #[test]
    fn what_is_no_step_is_not_read() {
        let (position, force) = step(0.01, 0.015, 1.5, 10.0);
        assert_eq!(VelocityStep::read(&position[..5], &force[..5], 0.6, 10.0), None);
        assert_eq!(VelocityStep::read(&position, &force, 0.6, 1.0), None);
    }
}
