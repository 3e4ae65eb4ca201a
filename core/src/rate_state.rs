//! Friction read in the words of rate and state: direct effect, evolution effect and length of a velocity step, healing of holds.
//!
//! Rate-and-state friction (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979); A. Ruina, J. Geophys. Res. 88, 10359
//! (1983)) describes what is measured when the velocity jumps from v₀ to v:
//!
//! F(X) = F₀ + a ln(v/v₀) − b ln(v/v₀) (1 − e^{−(X − X_p)/D_c}),
//!
//! and static friction that grows with the logarithm of the hold time. What is read here are numbers on a curve,
//! computed or measured: whether the curve has that form is told by the errors of the fit.

use crate::numerics::linear::solve;
use crate::numerics::roots::brent_minimum;

/// A fitted number and its standard error, as far as what the fit leaves over is noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// A velocity step in the words of rate and state; forces in the unit of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityStep {
    /// a: the force at the peak above F₀, per ln(v/v₀).
    pub direct: Fitted,
    /// b: the fall of the force after the peak, per ln(v/v₀); below 0 where it rises on.
    pub evolution: Fitted,
    /// D_c, a length.
    pub distance: Fitted,
    /// F₀, the force before the step.
    pub before: f64,
    /// X_p, where the force peaks (at the step itself where it has no peak), from the step on.
    pub peak: f64,
    /// Root mean square of what the fit leaves over.
    pub residual: f64,
}

/// Healing: static friction grows by so much per factor of ten in hold time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Healing {
    /// The growth per factor of ten, a force.
    pub per_decade: Fitted,
    /// The fitted force at a hold of 1, a force.
    pub at_one: Fitted,
}

/// Fewest points that a fit of three numbers is made to.
const FEWEST: usize = 8;
/// Candidate lengths that are tried before the best of them is refined.
const CANDIDATES: usize = 60;

impl VelocityStep {
    /// Reads the curve after a step of the velocity by the factor `ratio`: `position` from the step on (0 is the step),
    /// `force` there, `before` the steady force F₀.
    ///
    /// The fit is least squares over all points from the peak on, X counted from it: of contacts that are elastic, as of
    /// machines, the force cannot jump, and the direct effect takes some way. `None` for fewer than 8 points, a ratio that
    /// is no step.
    pub fn read(position: &[f64], force: &[f64], before: f64, ratio: f64) -> Option<Self> {
        let size = ratio.ln();
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let peak = peak(force, size.signum())?;
        let (way, force) = (position.get(peak..)?, force.get(peak..)?);
        let way: Vec<f64> = way.iter().map(|x| x - way[0]).collect();
        let fit = Decay::fit(&way, force)?;
        let error = |gradient: [f64; 3]| fit.error(gradient) / size.abs();
        Some(Self {
            direct: Fitted { value: (fit.end + fit.height - before) / size, error: error([1.0, 1.0, 0.0]) },
            evolution: Fitted { value: fit.height / size, error: error([0.0, 1.0, 0.0]) },
            distance: Fitted { value: fit.length, error: fit.error([0.0, 0.0, 1.0]) },
            before,
            peak: position[peak],
            residual: fit.residual(),
        })
    }

    /// The fitted force at a way `position` after the step by the factor `ratio`; before the peak that of the peak.
    pub fn force(&self, position: f64, ratio: f64) -> f64 {
        let way = (position - self.peak).max(0.0);
        let fallen = -(-way / self.distance.value).exp_m1();
        self.before + ratio.ln() * (self.direct.value - self.evolution.value * fallen)
    }
}

/// The number of the point from which on the force relaxes: its extremum on the `side` to which the velocity went, or
/// the step itself where what follows the extremum is too little to fit.
fn peak(force: &[f64], side: f64) -> Option<usize> {
    let highest = (0..force.len()).max_by(|&i, &j| (side * force[i]).total_cmp(&(side * force[j])))?;
    Some(if 2 * highest < force.len() && force.len() - highest >= FEWEST { highest } else { 0 })
}

/// y = end + height e^{−x/length}, with the covariance of the three.
struct Decay {
    end: f64,
    height: f64,
    length: f64,
    covariance: [[f64; 3]; 3],
    squares: f64,
    points: usize,
}

impl Decay {
    fn fit(x: &[f64], y: &[f64]) -> Option<Self> {
        let reach = *x.last()?;
        if x.len() < FEWEST || x.len() != y.len() || reach.is_nan() || reach <= 0.0 {
            return None;
        }
        let left_over = |log: f64| linear(x, y, log.exp()).map_or(f64::INFINITY, |fit| fit.2);
        let (low, high) = ((1e-3 * reach).ln(), (3.0 * reach).ln());
        let step = (high - low) / CANDIDATES as f64;
        let candidates = (0..=CANDIDATES).map(|i| low + step * i as f64);
        let best = candidates.min_by(|a, b| left_over(*a).total_cmp(&left_over(*b)))?;
        let length = brent_minimum(left_over, best - step, best + step, 1e-10).0.exp();
        let (end, height, squares) = linear(x, y, length)?;
        let gradients = x.iter().map(|x| {
            let decayed = (-x / length).exp();
            [1.0, decayed, height * decayed * x / (length * length)]
        });
        let covariance = inverse(normal(gradients))?;
        Some(Self { end, height, length, covariance, squares, points: x.len() })
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

/// The best end and height at a length, and the sum of squares that they leave over.
fn linear(x: &[f64], y: &[f64], length: f64) -> Option<(f64, f64, f64)> {
    let columns = || x.iter().map(|x| [1.0, (-x / length).exp()]);
    let right = columns().zip(y).fold([0.0; 2], |sum, (row, y)| [sum[0] + y * row[0], sum[1] + y * row[1]]);
    let [end, height] = solve(normal(columns()), right)?;
    let squares = columns().zip(y).map(|(row, y)| (y - end * row[0] - height * row[1]).powi(2)).sum();
    Some((end, height, squares))
}

/// Σ g gᵀ.
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
    /// The straight line through static friction against the decimal logarithm of the hold time, by least squares.
    ///
    /// `None` for fewer than 3 holds.
    pub fn read(hold: &[f64], force: &[f64]) -> Option<Self> {
        if hold.len() < 3 || hold.len() != force.len() {
            return None;
        }
        let rows = || hold.iter().map(|t| [1.0, t.log10()]);
        let covariance = inverse(normal(rows()))?;
        let right =
            rows().zip(force).fold([0.0; 2], |sum, (row, f)| [sum[0] + f * row[0], sum[1] + f * row[1]]);
        let [at_one, slope] = [0, 1].map(|i| covariance[i][0] * right[0] + covariance[i][1] * right[1]);
        let squares: f64 = rows().zip(force).map(|(row, f)| (f - at_one - slope * row[1]).powi(2)).sum();
        let error = |i: usize| (squares / (hold.len() - 2) as f64 * covariance[i][i]).sqrt();
        Some(Self {
            per_decade: Fitted { value: slope, error: error(1) },
            at_one: Fitted { value: at_one, error: error(0) },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step as the words of rate and state have it, reached over a way of 0.2.
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

    #[test]
    fn healing_is_the_slope_per_decade() {
        let hold = [1.0, 10.0, 100.0, 1000.0];
        let read = Healing::read(&hold, &hold.map(|t: f64| 0.6 + 0.008 * t.log10())).unwrap();
        // rounding of 0.6
        assert!((read.per_decade.value - 0.008).abs() < 1e-15 && read.per_decade.error < 1e-15);
        assert!((read.at_one.value - 0.6).abs() < 1e-15);
        assert_eq!(Healing::read(&hold[..2], &[0.6, 0.61]), None);
    }
}
