//! Healing from computed slide–hold–slide tests.

use std::f64::consts::LN_10;

use super::extent;
use super::separable::{GROWTH, SeparableFit, gradient, linear};
use crate::error::{all_finite, as_many};
use crate::{Error, Result};

/// Healing: static friction grows with the logarithm of the hold time, from a cutoff time on.
///
/// ```
/// use asperity::rate_state::Healing;
///
/// // 0.01 more for every factor of ten, far beyond a cutoff time of 1.
/// let hold = [1.0_f64, 10.0, 100.0, 1e3, 1e4];
/// let force: Vec<f64> = hold.iter().map(|t| 0.6 + 0.01 * (1.0 + t).log10()).collect();
/// let found = Healing::read(&hold, &force).expect("five holds");
/// assert!((found.per_decade - 0.01).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Healing {
    /// Healing rate β ln 10, per factor of ten in hold time in the logarithmic regime, a force.
    pub per_decade: f64,
    /// Cutoff time t_c; `None` if all holds are so much longer that it cannot be determined.
    pub cutoff: Option<f64>,
    /// The fitted force after a hold of 1, a force.
    pub at_one: f64,
    /// Root-mean-square residual of the fit, a force.
    pub residual: f64,
    /// The residual relative to the difference between the largest and the smallest force.
    pub residual_relative: f64,
}

/// Smallest number of holds.
pub(super) const FEWEST: usize = 4;
/// Shortest cutoff time of the search, in units of the shortest hold.
pub(super) const SHORTEST: f64 = 1e-3;
/// Longest cutoff time of the search, in units of the longest hold.
pub(super) const LONGEST: f64 = 2.0;

impl Healing {
    /// Fits the three parameters to static friction after holds, by least squares.
    ///
    /// A cutoff time a thousand times shorter than the shortest hold counts as none. `None` for fewer than 4
    /// holds, or if the longest hold is not longer than the cutoff time: the growth is then not logarithmic.
    pub fn read(hold: &[f64], force: &[f64]) -> Option<Self> {
        let (shortest, longest) = extent(hold);
        if hold.len() < FEWEST || hold.len() != force.len() {
            return None;
        }
        let weights = vec![1.0; hold.len()];
        let range_of_cutoff = (SHORTEST * shortest, LONGEST * longest);
        let fit = SeparableFit::of(&GROWTH, hold, (force, &weights), range_of_cutoff)?;
        if fit.scale >= longest {
            return None;
        }
        if fit.scale <= SHORTEST * shortest {
            return Self::straight(hold, force);
        }
        let at_one = gradient(&GROWTH, fit.size, fit.scale, 1.0);
        Some(Self {
            per_decade: LN_10 * fit.size,
            cutoff: Some(fit.scale),
            at_one: fit.offset + fit.size * at_one[1],
            residual: fit.residual,
            residual_relative: fit.residual / range(force),
        })
    }

    /// Linear regression on the logarithm of the hold time.
    fn straight(hold: &[f64], force: &[f64]) -> Option<Self> {
        let decades: Vec<f64> = hold.iter().map(|t| t.log10()).collect();
        let (at_one, slope, squares) = linear(&decades, force, &vec![1.0; hold.len()])?;
        let residual = (squares / hold.len() as f64).sqrt();
        let residual_relative = residual / range(force);
        Some(Self { per_decade: slope, cutoff: None, at_one, residual, residual_relative })
    }

    /// The fitted static friction after a hold.
    pub fn force(&self, hold: f64) -> f64 {
        let cutoff = self.cutoff.unwrap_or(0.0);
        self.at_one + self.per_decade * ((hold + cutoff) / (1.0 + cutoff)).log10()
    }
}

/// Checks the times of holds, and the lists of forces, each after its name.
///
/// # Errors
/// Fewer than 4 holds; numbers of forces that differ from theirs; numbers that are not finite; hold times that are not above 0.
pub(super) fn check_holds<'a>(
    hold: &[f64],
    forces: impl IntoIterator<Item = (&'a str, &'a [f64])>,
) -> Result<()> {
    if hold.len() < FEWEST {
        return Err(Error::invalid("hold", format!("at least {FEWEST} holds"), hold.len()));
    }
    for (key, forces) in forces {
        as_many(key, forces.len(), (hold.len(), "forces, one for each hold"))?;
        all_finite(key, forces)?;
    }
    all_finite("hold", hold)?;
    match hold.iter().position(|time| *time <= 0.0) {
        Some(i) => Err(Error::invalid(format!("hold.{i}"), "a time above 0", hold[i])),
        None => Ok(()),
    }
}

fn range(force: &[f64]) -> f64 {
    let (low, high) = extent(force);
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

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
            // Rounding of 0.6, 1e-16, over the growth, amplified by the square root of the tolerance.
            assert!((read.per_decade / (growth * LN_10) - 1.0).abs() < 1e-7, "{read:?}");
            assert!((read.cutoff.unwrap() / cutoff - 1.0).abs() < 1e-6, "{read:?}");
            assert!(read.residual_relative < 1e-6, "{read:?}");
            assert!(hold.iter().zip(&force).all(|(&t, f)| (read.force(t) - f).abs() < 1e-9));
        }
    }

    #[test]
    fn growth_without_a_cutoff_among_the_holds_is_a_straight_line() {
        let hold = [1.0, 10.0, 100.0, 1000.0];
        let read = Healing::read(&hold, &hold.map(|t: f64| 0.6 + 0.008 * t.log10())).unwrap();
        // rounding of 0.6
        assert!((read.per_decade - 0.008).abs() < 1e-15 && read.residual < 1e-15);
        assert!((read.at_one - 0.6).abs() < 1e-15 && read.cutoff.is_none());
        assert_eq!(Healing::read(&hold[..3], &[0.6, 0.61, 0.62]), None);
        // Growth that goes with the hold time itself is no healing by a logarithm.
        assert_eq!(Healing::read(&hold, &hold.map(|t| 0.6 + 1e-5 * t)), None);
    }
}
