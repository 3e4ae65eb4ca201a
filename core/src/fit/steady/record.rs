//! A record of the force in steady sliding, and its discrete Fourier transform.

use num_complex::Complex64;

use crate::error::{all_finite, as_many, positive};
use crate::numerics::real_transform::RealTransform;
use crate::{Error, Result};

/// How far a position may be from its place in a record of equal spacing, in spacings: positions are written with few digits.
const UNEQUAL: f64 = 0.01;

/// A record of the force in steady sliding, at equal spacing of the position of the slider.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SteadyRecord {
    /// The displacement h of the slider from one reading to the next.
    pub spacing: f64,
    /// The n measured forces.
    pub forces: Vec<f64>,
}

impl SteadyRecord {
    /// A record at positions that rise in equal steps.
    ///
    /// # Errors
    /// Fewer than two positions; a position that is more than a hundredth of the spacing from its place; another
    /// number of forces than positions.
    pub fn at_positions(positions: &[f64], forces: Vec<f64>) -> Result<Self> {
        let n = positions.len();
        if n < 2 {
            return Err(Error::invalid("position", "two positions or more", n));
        }
        as_many("force", forces.len(), (n, "forces, one for each position"))?;
        let spacing = (positions[n - 1] - positions[0]) / (n - 1) as f64;
        let key = |i: usize| format!("position.{i}");
        all_finite("position", positions)?;
        if spacing <= 0.0 {
            return Err(Error::invalid(key(n - 1), "positions that rise", positions[n - 1]));
        }
        let place = |i: usize| positions[0] + spacing * i as f64;
        let unequal = |&i: &usize| (positions[i] - place(i)).abs() > UNEQUAL * spacing;
        if let Some(i) = (0..n).find(unequal) {
            let expected = format!("equal steps, here of {spacing}: a position of {}", place(i));
            return Err(Error::invalid(key(i), expected, positions[i]));
        }
        Ok(Self { spacing, forces })
    }

    /// The displacement from the first reading to the last.
    pub fn distance(&self) -> f64 {
        self.spacing * self.forces.len().saturating_sub(1) as f64
    }

    /// The mean force.
    pub fn mean(&self) -> f64 {
        self.forces.iter().sum::<f64>() / self.forces.len() as f64
    }

    /// The wave numbers q_k = 2πk/nh of the periodogram, k = 1 … n/2.
    pub(super) fn wave_numbers(&self) -> Vec<f64> {
        let n = self.forces.len();
        let lowest = std::f64::consts::TAU / (n as f64 * self.spacing);
        (1..=n / 2).map(|k| lowest * k as f64).collect()
    }

    /// # Errors
    /// A spacing that is not above 0; a force that is not finite; forces that are all the same.
    pub(super) fn check(&self) -> Result<()> {
        positive("spacing", self.spacing)?;
        all_finite("force", &self.forces)?;
        if let Some(first) = self.forces.first().filter(|first| self.forces.iter().all(|f| f == *first)) {
            return Err(Error::invalid("force", "forces that scatter", format!("{first} only")));
        }
        Ok(())
    }

    /// The transform Σ_j (F_j − F̄) e^{−2πijk/n}/√n for k = 0 … n/2; the mean F̄ is subtracted for rounding only.
    pub(super) fn modes(&self) -> Vec<Complex64> {
        let (n, mean) = (self.forces.len(), self.mean());
        transform(self.forces.iter().map(|force| (force - mean) / (n as f64).sqrt()).collect())
    }
}

/// Σ_j x_j e^{−2πijk/n} for k = 0 … n/2.
pub(super) fn transform(values: Vec<f64>) -> Vec<Complex64> {
    RealTransform::new(values.len()).spectrum(values)
}

/// The n real values whose [`transform`] is √n times `modes`.
pub(super) fn inverse(mut modes: Vec<Complex64>, n: usize) -> Vec<f64> {
    let plan = RealTransform::new(n);
    let mut values = vec![0.0; n];
    // The first and, of an even number, the last are real.
    modes[0].im = 0.0;
    if n.is_multiple_of(2) {
        modes[n / 2].im = 0.0;
    }
    plan.inverse(&mut modes, &mut values, &mut plan.scratch());
    values.into_iter().map(|value| value / (n as f64).sqrt()).collect()
}

/// How many of the n real numbers of a record have the wave number k: its real and imaginary part.
pub(super) fn multiplicity(k: usize, n: usize) -> f64 {
    if k == 0 || 2 * k == n { 1.0 } else { 2.0 }
}
