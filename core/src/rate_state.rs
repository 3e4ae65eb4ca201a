//! Rate-and-state parameters from friction curves: direct effect, evolution effect and critical distance of a
//! velocity step, healing rate of slide–hold–slide tests.
//!
//! Rate-and-state friction (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979); A. Ruina, J. Geophys. Res. 88,
//! 10359 (1983)) describes the force after the velocity jumps from v₀ to v by
//!
//! F(X) = F₀ + a ln(v/v₀) − b ln(v/v₀) (1 − e^{−(X − X_p)/D_c}),
//!
//! and static friction after a hold of duration t by
//!
//! F_s(t) = F_s(0) + β ln(1 + t/t_c),
//!
//! which heals by β ln 10 per factor of ten in hold time for t ≫ t_c. These functions fit curves, computed or
//! measured; the errors of the fit show whether a curve has that form.

use std::f64::consts::LN_10;

use serde::{Deserialize, Serialize};

use crate::numerics::linear::solve;
use crate::numerics::roots::brent_minimum;

/// A fitted parameter with its standard error, which assumes that the residuals are noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// Rate-and-state parameters of a velocity step; forces in the unit of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityStep {
    /// Direct effect a: the force at the peak above F₀, per ln(v/v₀).
    pub direct: Fitted,
    /// Evolution effect b: the decrease of the force after the peak, per ln(v/v₀); negative if it increases.
    pub evolution: Fitted,
    /// Critical slip distance D_c, a length.
    pub distance: Fitted,
    /// F₀, the force before the step.
    pub before: f64,
    /// X_p, the position of the peak (that of the step itself if there is none), relative to the step.
    pub peak: f64,
    /// Root-mean-square residual of the fit.
    pub residual: f64,
}

/// Healing: static friction grows with the logarithm of the hold time, from a cutoff time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Healing {
    /// Healing rate β ln 10, per factor of ten in hold time in the logarithmic regime, a force.
    pub per_decade: Fitted,
    /// Cutoff time t_c; `None` if all holds are so much longer that it cannot be determined.
    pub cutoff: Option<Fitted>,
    /// The fitted force after a hold of 1, a force.
    pub at_one: Fitted,
    /// Root-mean-square residual of the fit.
    pub residual: f64,
}

/// Smallest number of points of a velocity step for a fit of three parameters.
const FEWEST: usize = 8;
/// Smallest number of holds.
const FEWEST_HOLDS: usize = 4;
/// Number of trial scales before the best one is refined.
const CANDIDATES: usize = 60;

impl VelocityStep {
    /// Fits the curve after a step of the velocity by the factor `ratio`: `position` relative to the step,
    /// the `force` there, and the steady force F₀ = `before`.
    ///
    /// Least squares over all points from the peak on, with X counted from it: in elastic contacts, as in
    /// machines, the force cannot jump, so that the direct effect takes some distance. `None` for fewer than
    /// 8 points or a ratio of 1.
    pub fn read(position: &[f64], force: &[f64], before: f64, ratio: f64) -> Option<Self> {
        let size = ratio.ln();
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let peak = peak(force, size.signum())?;
        let (displacement, force) = (position.get(peak..)?, force.get(peak..)?);
        let displacement: Vec<f64> = displacement.iter().map(|x| x - displacement[0]).collect();
        if displacement.len() < FEWEST {
            return None;
        }
        let reach = *displacement.last()?;
        let fit = StepFit::of(&DECAY, &displacement, force, (1e-3 * reach, 3.0 * reach))?;
        let error = |gradient: [f64; 3]| fit.error(gradient) / size.abs();
        Some(Self {
            direct: Fitted { value: (fit.offset + fit.size - before) / size, error: error([1.0, 1.0, 0.0]) },
            evolution: Fitted { value: fit.size / size, error: error([0.0, 1.0, 0.0]) },
            distance: Fitted { value: fit.scale, error: fit.error([0.0, 0.0, 1.0]) },
            before,
            peak: position[peak],
            residual: fit.residual(),
        })
    }

    /// The fitted force at `position` after the step by the factor `ratio`; before the peak that of the peak.
    pub fn force(&self, position: f64, ratio: f64) -> f64 {
        let displacement = (position - self.peak).max(0.0);
        let fallen = -(-displacement / self.distance.value).exp_m1();
        self.before + ratio.ln() * (self.direct.value - self.evolution.value * fallen)
    }
}

/// Index of the point from which on the force relaxes: its extremum in the direction of the change of
/// velocity, or the step itself if too few points follow the extremum.
fn peak(force: &[f64], side: f64) -> Option<usize> {
    let highest = (0..force.len()).max_by(|&i, &j| (side * force[i]).total_cmp(&(side * force[j])))?;
    // A curve that only rises has its maximum at the end, and no direct effect to be seen: the fit
    // starts at the step.
    Some(if 2 * highest < force.len() && force.len() - highest >= FEWEST { highest } else { 0 })
}

/// A curve s(z) and its slope.
struct FitShape {
    value: fn(f64) -> f64,
    slope: fn(f64) -> f64,
}

/// e^{−z}.
const DECAY: FitShape = FitShape { value: |z| (-z).exp(), slope: |z| -(-z).exp() };

/// ln(1 + z).
const GROWTH: FitShape = FitShape { value: f64::ln_1p, slope: |z| 1.0 / (1.0 + z) };

/// The fit y = offset + size s(x/scale), with the covariance of its parameters.
struct StepFit {
    offset: f64,
    size: f64,
    scale: f64,
    covariance: [[f64; 3]; 3],
    squares: f64,
    points: usize,
}

impl StepFit {
    /// Least squares, with a scale between `low` and `high`: linear in offset and size for each scale.
    fn of(shape: &FitShape, x: &[f64], y: &[f64], (low, high): (f64, f64)) -> Option<Self> {
        if x.len() < 4 || x.len() != y.len() || !(low > 0.0 && high.is_finite()) {
            return None;
        }
        let best = |scale: f64| linear(x.iter().map(|x| (shape.value)(x / scale)), y);
        let residual_of = |log: f64| best(log.exp()).map_or(f64::INFINITY, |fit| fit.2);
        let (low, high) = (low.ln(), high.ln());
        let step = (high - low) / CANDIDATES as f64;
        // Variable projection (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 413 (1973)): offset and
        // size are eliminated, and only the scale is searched. A scan comes first, as there may be several
        // minima.
        let candidates = (0..=CANDIDATES).map(|i| low + step * i as f64);
        let nearest = candidates.min_by(|a, b| residual_of(*a).total_cmp(&residual_of(*b)))?;
        let scale = brent_minimum(residual_of, nearest - step, nearest + step, 1e-10).0.exp();
        let (offset, size, squares) = best(scale)?;
        let gradients = x.iter().map(|x| gradient(shape, size, scale, *x));
        // The usual linearised covariance of least squares, residual variance × (JᵀJ)⁻¹.
        let covariance = inverse(normal(gradients))?;
        Some(Self { offset, size, scale, covariance, squares, points: x.len() })
    }

    /// Standard error of a sum of the three numbers with the weights `gradient`.
    fn error(&self, gradient: [f64; 3]) -> f64 {
        let freedom = (self.points - 3) as f64;
        let row = |i: usize| (0..3).map(|j| gradient[i] * self.covariance[i][j] * gradient[j]).sum::<f64>();
        (self.squares / freedom * (0..3).map(row).sum::<f64>()).max(0.0).sqrt()
    }

    fn residual(&self) -> f64 {
        (self.squares / self.points as f64).sqrt()
    }
}

/// Derivatives of the fitted curve at x with respect to offset, size and scale.
fn gradient(shape: &FitShape, size: f64, scale: f64, x: f64) -> [f64; 3] {
    let z = x / scale;
    [1.0, (shape.value)(z), -size * (shape.slope)(z) * z / scale]
}

/// Linear regression of y on a column: offset, size and the sum of squared residuals.
fn linear(column: impl Iterator<Item = f64> + Clone, y: &[f64]) -> Option<(f64, f64, f64)> {
    let rows = || column.clone().map(|c| [1.0, c]).zip(y);
    let right = rows().fold([0.0; 2], |sum, (row, y)| [sum[0] + y * row[0], sum[1] + y * row[1]]);
    let [offset, size] = solve(normal(rows().map(|row| row.0)), right)?;
    let squares = rows().map(|(row, y)| (y - offset - size * row[1]).powi(2)).sum();
    Some((offset, size, squares))
}

/// Σ g gᵀ, the matrix of the normal equations.
fn normal<const N: usize>(rows: impl Iterator<Item = [f64; N]>) -> [[f64; N]; N] {
    rows.fold([[0.0; N]; N], |sum, row| {
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + row[i] * row[j]))
    })
}

/// The inverse of a symmetric matrix.
fn inverse<const N: usize>(matrix: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut rows = [[0.0; N]; N];
    for (i, row) in rows.iter_mut().enumerate() {
        *row = solve(matrix, std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))?;
    }
    Some(rows)
}

impl Healing {
    /// Fits the three parameters to static friction after holds, by least squares.
    ///
    /// A cutoff time a thousand times shorter than the shortest hold counts as none. `None` for fewer than 4
    /// holds, or if the longest hold is not longer than the cutoff time: the growth is then not logarithmic.
    pub fn read(hold: &[f64], force: &[f64]) -> Option<Self> {
        /// Shortest cutoff time of the search, in units of the shortest hold.
        const SHORTEST: f64 = 1e-3;
        let shortest = hold.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = hold.iter().copied().fold(0.0, f64::max);
        if hold.len() < FEWEST_HOLDS || hold.len() != force.len() {
            return None;
        }
        let fit = StepFit::of(&GROWTH, hold, force, (SHORTEST * shortest, 2.0 * longest))?;
        if fit.scale >= longest {
            return None;
        }
        if fit.scale <= SHORTEST * shortest {
            return Self::straight(hold, force);
        }
        let decade = LN_10 * fit.size;
        let at_one = gradient(&GROWTH, fit.size, fit.scale, 1.0);
        Some(Self {
            per_decade: Fitted { value: decade, error: LN_10 * fit.error([0.0, 1.0, 0.0]) },
            cutoff: Some(Fitted { value: fit.scale, error: fit.error([0.0, 0.0, 1.0]) }),
            at_one: Fitted { value: fit.offset + fit.size * at_one[1], error: fit.error(at_one) },
            residual: fit.residual(),
        })
    }

    /// Linear regression on the logarithm of the hold time.
    fn straight(hold: &[f64], force: &[f64]) -> Option<Self> {
        let logs = || hold.iter().map(|t| t.log10());
        let (at_one, slope, squares) = linear(logs(), force)?;
        let covariance = inverse(normal(logs().map(|log| [1.0, log])))?;
        let error = |i: usize| (squares / (hold.len() - 2) as f64 * covariance[i][i]).sqrt();
        Some(Self {
            per_decade: Fitted { value: slope, error: error(1) },
            cutoff: None,
            at_one: Fitted { value: at_one, error: error(0) },
            residual: (squares / hold.len() as f64).sqrt(),
        })
    }

    /// The fitted static friction after a hold.
    pub fn force(&self, hold: f64) -> f64 {
        let cutoff = self.cutoff.map_or(0.0, |cutoff| cutoff.value);
        self.at_one.value + self.per_decade.value * ((hold + cutoff) / (1.0 + cutoff)).log10()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step as the words of rate and state have it, reached over a displacement of 0.2.
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
                assert!((fitted.value - known).abs() < 1e-7 * known, "{fitted:?} is not {known}");
                assert!(fitted.error < 1e-7 * known, "{fitted:?}");
            }
            assert!((read.peak - 0.2).abs() < 1e-12);
            assert!((read.force(3.0, ratio) - force[60]).abs() < 1e-9);
        }
    }

    #[test]
    fn errors_are_those_of_the_scatter() {
        let (position, clean) = step(0.01, 0.015, 1.5, 10.0);
        // A deterministic scatter of standard deviation 1e-4 that is no decay.
        let noise = |i: usize| 1e-4 * f64::sqrt(2.0) * (2.4 * i as f64).sin();
        let force: Vec<f64> = clean.iter().enumerate().map(|(i, f)| f + noise(i)).collect();
        let read = VelocityStep::read(&position, &force, 0.6, 10.0).unwrap();
        assert!((read.residual / 1e-4 - 1.0).abs() < 0.05, "{}", read.residual);
        for (fitted, known) in [(read.direct, 0.01), (read.evolution, 0.015), (read.distance, 1.5)] {
            // within 4 standard errors, and the errors are no wider than a tenth
            assert!((fitted.value - known).abs() < 4.0 * fitted.error, "{fitted:?} is not {known}");
            assert!(fitted.error < 0.1 * known, "{fitted:?}");
        }
    }

    #[test]
    fn what_is_no_step_is_not_read() {
        let (position, force) = step(0.01, 0.015, 1.5, 10.0);
        assert_eq!(VelocityStep::read(&position[..5], &force[..5], 0.6, 10.0), None);
        assert_eq!(VelocityStep::read(&position, &force, 0.6, 1.0), None);
    }

    /// Hold times from 0.1 on, four a decade.
    fn holds(decades: u32) -> Vec<f64> {
        (0..=4 * decades).map(|i| 0.1 * 10.0_f64.powf(0.25 * f64::from(i))).collect()
    }

    #[test]
    fn healing_gives_back_growth_and_cutoff_time() {
        let hold = holds(6);
        for (growth, cutoff) in [(0.008, 3.0), (0.02, 0.05), (0.002, 1e3)] {
            let force: Vec<f64> = hold.iter().map(|t| 0.6 + growth * (1.0 + t / cutoff).ln()).collect();
            let read = Healing::read(&hold, &force).unwrap();
            let time = read.cutoff.unwrap();
            // Rounding of 0.6, 1e-16, over the growth, amplified by the square root of the tolerance.
            assert!((read.per_decade.value / (growth * LN_10) - 1.0).abs() < 1e-7, "{read:?}");
            assert!((time.value / cutoff - 1.0).abs() < 1e-6, "{read:?}");
            assert!(read.per_decade.error < 1e-7 * growth && time.error < 1e-6 * cutoff, "{read:?}");
            assert!(hold.iter().zip(&force).all(|(&t, f)| (read.force(t) - f).abs() < 1e-9));
        }
    }

    #[test]
    fn errors_of_healing_are_those_of_the_scatter() {
        let hold = holds(6);
        // A deterministic scatter of standard deviation 1e-4.
        let noise = |i: usize| 1e-4 * f64::sqrt(2.0) * (2.4 * i as f64).sin();
        let law = |(i, t): (usize, &f64)| 0.6 + 0.008 * (1.0 + t / 3.0).ln() + noise(i);
        let force: Vec<f64> = hold.iter().enumerate().map(law).collect();
        let read = Healing::read(&hold, &force).unwrap();
        // within 4 standard errors, and those no wider than a twentieth of growth and a fifth of the cutoff time
        for (fitted, known, part) in
            [(read.per_decade, 0.008 * LN_10, 0.05), (read.cutoff.unwrap(), 3.0, 0.2)]
        {
            assert!((fitted.value - known).abs() < 4.0 * fitted.error, "{fitted:?} is not {known}");
            assert!(fitted.error < part * known && fitted.error > 0.0, "{fitted:?}");
        }
        assert!((read.residual / 1e-4 - 1.0).abs() < 0.15, "{}", read.residual);
    }

    #[test]
    fn growth_without_a_cutoff_among_the_holds_is_a_straight_line() {
        let hold = [1.0, 10.0, 100.0, 1000.0];
        let read = Healing::read(&hold, &hold.map(|t: f64| 0.6 + 0.008 * t.log10())).unwrap();
        // rounding of 0.6
        assert!((read.per_decade.value - 0.008).abs() < 1e-15 && read.per_decade.error < 1e-15);
        assert!((read.at_one.value - 0.6).abs() < 1e-15 && read.cutoff.is_none());
        assert_eq!(Healing::read(&hold[..3], &[0.6, 0.61, 0.62]), None);
        // Growth that goes with the hold time itself is no healing by a logarithm.
        assert_eq!(Healing::read(&hold, &hold.map(|t| 0.6 + 1e-5 * t)), None);
    }
}
