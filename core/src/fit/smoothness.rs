//! What is known beforehand of a distribution of free form: that its logarithm is smooth.

use std::ops::Range;

use faer::Mat;

use super::matrix;

/// A normal prior of third differences of neighbouring coordinates, of variance 1/λ: the penalty λ Σ(Δ³θ)² in −2 ln L.
///
/// P. H. C. Eilers and B. D. Marx, Stat. Sci. 11, 89 (1996). A penalty for the mean of the coordinates keeps it where it is, since a
/// constant added to a logarithmic density changes nothing. Coordinates far from all that the curve shows also have a normal prior of
/// their own: without it, quadratic polynomials that rise again would cost nothing there.
#[derive(Debug, Clone)]
pub(super) struct Smoothness {
    /// The coordinates.
    pub places: Range<usize>,
    /// λ.
    pub strength: f64,
    /// The mean of the coordinates.
    pub level: f64,
    /// Coordinates far from what the curve shows, and their means.
    pub far: Vec<(usize, f64)>,
}

/// 1/s² for the standard deviation s = 3 of a coordinate far from what the curve shows: a density within a factor of 400 of the
/// expected one.
const FAR: f64 = 1.0 / 9.0;

/// Weights of a third difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

impl Smoothness {
    /// Σ(Δ³θ)².
    pub fn roughness(&self, coordinates: &[f64]) -> f64 {
        let own = &coordinates[self.places.clone()];
        own.windows(4).map(|four| dot(&THIRD, four).powi(2)).sum()
    }

    /// The penalty in −2 ln L.
    pub fn penalty(&self, coordinates: &[f64]) -> f64 {
        let far = self.far.iter().map(|&(k, mean)| FAR * (coordinates[k] - mean).powi(2)).sum::<f64>();
        self.strength * self.roughness(coordinates) + self.excess(coordinates).powi(2) + far
    }

    /// The mean of the coordinates above its level.
    fn excess(&self, coordinates: &[f64]) -> f64 {
        let own = &coordinates[self.places.clone()];
        own.iter().sum::<f64>() / own.len() as f64 - self.level
    }

    /// Adds the derivatives of half the penalty to the slope and to the information of half the deviance.
    pub fn add(&self, coordinates: &[f64], slope: &mut Mat<f64>, information: &mut Mat<f64>) {
        self.add_roughness((self.strength, coordinates), slope, information);
        let (excess, share) = (self.excess(coordinates), 1.0 / self.places.len() as f64);
        for a in self.places.clone() {
            slope[(a, 0)] += excess * share;
            for b in self.places.clone() {
                information[(a, b)] += share * share;
            }
        }
        for &(k, mean) in &self.far {
            slope[(k, 0)] += FAR * (coordinates[k] - mean);
            information[(k, k)] += FAR;
        }
    }

    /// Adds those of `strength` Σ(Δ³θ)² alone.
    pub fn add_roughness(
        &self,
        (strength, coordinates): (f64, &[f64]),
        slope: &mut Mat<f64>,
        information: &mut Mat<f64>,
    ) {
        let own = &coordinates[self.places.clone()];
        for (i, four) in own.windows(4).enumerate() {
            let difference = dot(&THIRD, four);
            let first = self.places.start + i;
            for (a, wa) in THIRD.iter().enumerate() {
                slope[(first + a, 0)] += strength * difference * wa;
                for (b, wb) in THIRD.iter().enumerate() {
                    information[(first + a, first + b)] += strength * wa * wb;
                }
            }
        }
    }

    /// DᵀD among so many coordinates, with D the third differences.
    fn differences(&self, coordinates: usize) -> Mat<f64> {
        let mut squared = Mat::zeros(coordinates, coordinates);
        self.add_roughness((1.0, &vec![0.0; coordinates]), &mut Mat::zeros(coordinates, 1), &mut squared);
        squared
    }

    /// γ = λ tr (Π⁻¹ − V) DᵀD, with the precision Π of what is known beforehand and the inverse V of the information of the numbers
    /// that are not at the end of their range: how many third differences the curve determines. Π⁻¹ counts K − 3 of them where no
    /// coordinate has a prior of its own.
    pub fn effective(&self, information: &Mat<f64>, at_bound: &[bool]) -> f64 {
        let active: Vec<usize> = (0..at_bound.len()).filter(|&k| !at_bound[k]).collect();
        let differences = || self.differences(at_bound.len());
        let trace = match matrix::covariance(information, &active) {
            Some(covariance) => self.trace(&covariance),
            // A strong penalty leaves no digits of what the data say of quadratic polynomials.
            None => matrix::trace_with_inverse(&differences(), information, &active).unwrap_or_default(),
        };
        let own: Vec<usize> = self.places.clone().filter(|&k| !at_bound[k]).collect();
        let precision = self.precision(at_bound.len());
        let before = matrix::trace_with_inverse(&differences(), &precision, &own).unwrap_or_default();
        (self.strength * (before - trace)).max(0.0)
    }

    /// tr V Π: how many numbers are known beforehand.
    pub fn known(&self, information: &Mat<f64>, at_bound: &[bool]) -> f64 {
        let active: Vec<usize> = (0..at_bound.len()).filter(|&k| !at_bound[k]).collect();
        matrix::trace_with_inverse(&self.precision(at_bound.len()), information, &active).unwrap_or_default()
    }

    /// Π, the precision of what is known beforehand, among so many coordinates.
    fn precision(&self, coordinates: usize) -> Mat<f64> {
        let mut precision = Mat::zeros(coordinates, coordinates);
        self.add(&vec![0.0; coordinates], &mut Mat::zeros(coordinates, 1), &mut precision);
        precision
    }

    /// tr V DᵀD, with D the third differences and V a covariance of all coordinates.
    fn trace(&self, covariance: &Mat<f64>) -> f64 {
        let term = |first: usize| -> f64 {
            let pairs = (0..4).flat_map(|a| (0..4).map(move |b| (a, b)));
            pairs.map(|(a, b)| THIRD[a] * THIRD[b] * covariance[(first + a, first + b)]).sum()
        };
        (self.places.start..self.places.end - 3).map(term).sum()
    }
}

fn dot(a: &[f64; 4], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
