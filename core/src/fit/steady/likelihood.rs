//! The debiased Whittle likelihood of a record in steady sliding.

use faer::Mat;

use super::super::free::{FreeParameter, Role, of_contacts, priors_at, value_of, values_at};
use super::super::matrix::product;
use super::super::score::Score;
use super::super::search::Objective;
use super::SteadyFit;
use super::expected::ExpectedRecord;
use super::record::multiplicity;
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Step of the central differences by the parameters of contacts: the change of the phase of the slowest oscillation of the
/// autocovariance over the length on which it decays. The truncation is a sixth of its square, and the error of the
/// autocovariance, of the order of 1e-9, is divided by it.
const STEP: f64 = 2e-3;

/// The likelihood of a record as a function of the coordinates of the free numbers.
///
/// The components of the discrete Fourier transform of the record, scaled to be orthonormal, count as independent and normal,
/// each with its exact variance v_k + s²; that of k = 0 has the mean √n (F_k + offset). With P_k their squares and w_k = 2 real
/// ones for each k, 1 for k = 0 and k = n/2,
///
/// −2 ln L = n ln 2π + Σ_k w_k \[ln(v_k + s²) + P_k/(v_k + s²)\].
#[derive(Debug)]
pub(super) struct SteadyLikelihood {
    pub fit: SteadyFit,
    pub free: Vec<FreeParameter>,
    /// P_k for k = 1 … n/2; the first entry, of k = 0, is not used.
    pub squares: Vec<f64>,
    /// The mean of the record.
    pub mean: f64,
}

/// A point of the likelihood.
#[derive(Debug)]
pub(super) struct SteadyPoint {
    pub equation: MasterEquation,
    pub expected: ExpectedRecord,
    /// The reading of the force where there is none.
    pub offset: f64,
    /// The standard deviation s of the independent error of a reading.
    pub reading: f64,
    /// −2 ln L, priors included.
    pub deviance: f64,
}

impl SteadyPoint {
    /// The expected square of component k, with the error of a reading.
    pub fn square(&self, k: usize) -> f64 {
        self.expected.squares[k] + self.reading * self.reading
    }
}

/// The derivatives of what is expected by a coordinate.
struct ExpectedChange {
    mean: f64,
    squares: Vec<f64>,
}

impl SteadyLikelihood {
    pub fn new(fit: SteadyFit, free: Vec<FreeParameter>) -> Self {
        let squares = fit.record.modes().iter().map(|mode| mode.norm_sqr()).collect();
        let mean = fit.record.mean();
        Self { fit, free, squares, mean }
    }

    /// Number of readings.
    pub fn readings(&self) -> usize {
        self.fit.record.forces.len()
    }

    /// The observed square of component k.
    pub fn observed(&self, k: usize, point: &SteadyPoint) -> f64 {
        if k == 0 {
            let apart = self.mean - point.expected.mean - point.offset;
            return self.readings() as f64 * apart * apart;
        }
        self.squares[k]
    }

    fn equation(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<MasterEquation> {
        let values = values_at(&self.free, coordinates);
        self.fit.equation.with_parameters(&of_contacts(&self.free, &values, 0), monitor)
    }

    fn expected(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(MasterEquation, ExpectedRecord)>> {
        let mut found = || {
            let equation = self.equation(coordinates, &mut Part::new(monitor, 0.0, 0.5))?;
            let record = (self.readings(), self.fit.record.spacing);
            let expected = ExpectedRecord::new(&equation, record, &mut Part::new(monitor, 0.5, 0.5))?;
            Ok((equation, expected))
        };
        match found() {
            Err(Error::Invalid { .. } | Error::TooLarge { .. }) => Ok(None),
            found => found.map(Some),
        }
    }

    /// The derivatives by coordinate `k`: closed where forces are proportional to it, else central differences, or one-sided
    /// ones at the end of a range.
    fn change(
        &self,
        k: usize,
        coordinates: &[f64],
        point: &SteadyPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<ExpectedChange> {
        let expected = &point.expected;
        let scaled = |power: f64| ExpectedChange {
            mean: expected.mean,
            squares: expected.squares.iter().map(|square| power * square).collect(),
        };
        let parameter = &self.free[k];
        let heated = self.fit.equation.contacts().rules.temperature.is_some();
        match parameter.role {
            Role::Offset => {
                return Ok(ExpectedChange { mean: 1.0, squares: vec![0.0; expected.squares.len()] });
            }
            Role::Reading => {
                let square = 2.0 * point.reading * point.reading;
                return Ok(ExpectedChange { mean: 0.0, squares: vec![square; expected.squares.len()] });
            }
            _ if parameter.name == "count" => return Ok(scaled(1.0)),
            // Barriers are proportional to the stiffness.
            _ if parameter.name == "stiffness" && !heated => return Ok(scaled(2.0)),
            _ => {}
        }
        let step = self.step(parameter, coordinates[k], point);
        let mut at = |side: f64, part: f64| -> Result<(f64, Option<ExpectedRecord>)> {
            let mut moved = coordinates.to_vec();
            moved[k] += side * step;
            let found = self.expected(&moved, &mut Part::new(monitor, part, 0.5))?;
            Ok((moved[k], found.map(|found| found.1)))
        };
        let (above, below) = (at(1.0, 0.0)?, at(-1.0, 0.5)?);
        let here = || (coordinates[k], expected.clone());
        let or_here = |(u, found): (f64, Option<ExpectedRecord>)| found.map_or_else(here, |found| (u, found));
        let ((high, above), (low, below)) = (or_here(above), or_here(below));
        let slope = |a: f64, b: f64| if high > low { (a - b) / (high - low) } else { 0.0 };
        let squares = above.squares.iter().zip(&below.squares).map(|(&a, &b)| slope(a, b)).collect();
        Ok(ExpectedChange { mean: slope(above.mean, below.mean), squares })
    }

    /// The step of the differences by a parameter of contacts.
    fn step(&self, parameter: &FreeParameter, coordinate: f64, point: &SteadyPoint) -> f64 {
        let steady = point.equation.steady_state();
        let turns = std::f64::consts::TAU * steady.dephasing_length() / steady.mean_life();
        let relative = STEP / turns.clamp(1.0, 1e3);
        if parameter.logarithmic { relative } else { relative * coordinate.abs().max(steady.mean_life()) }
    }
}

impl Objective for SteadyLikelihood {
    type Point = SteadyPoint;

    fn free(&self) -> &[FreeParameter] {
        &self.free
    }

    /// The mean of a record is known far better than its noise determines it.
    fn halvings(&self) -> i32 {
        6
    }

    fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<SteadyPoint>> {
        let Some((equation, expected)) = self.expected(coordinates, monitor)? else { return Ok(None) };
        let value = |role: Role| value_of(&self.free, role, coordinates);
        let offset = value(Role::Offset).unwrap_or(self.fit.offset);
        let reading = value(Role::Reading).or(self.fit.reading).unwrap_or(0.0);
        let mut point = SteadyPoint { equation, expected, offset, reading, deviance: 0.0 };
        let n = self.readings();
        let term = |k: usize| {
            let square = point.square(k);
            multiplicity(k, n) * (square.ln() + self.observed(k, &point) / square)
        };
        let sum: f64 = (0..=n / 2).map(term).sum();
        point.deviance = sum + n as f64 * std::f64::consts::TAU.ln() + priors_at(&self.free, coordinates);
        Ok(point.deviance.is_finite().then_some(point))
    }

    fn deviance(point: &SteadyPoint) -> f64 {
        point.deviance
    }

    // With D_k the relative derivative of v_k + s² by u, and M that of the mean: the slope of half the deviance is
    // ½Σ w_k D_k (1 − P_k/(v_k + s²)) − nM(F̄ − F_k − offset)/(v₀ + s²), the information ½Σ w_k D_k D_k' + nMM'/(v₀ + s²).
    fn score(&self, coordinates: &[f64], point: &SteadyPoint, monitor: &mut dyn Monitor) -> Result<Score> {
        let (n, count) = (self.readings(), self.free.len());
        let half = n / 2 + 1;
        let weight = |k: usize| (0.5 * multiplicity(k, n)).sqrt();
        // One row for each component, and one for the mean.
        let mut derivatives = Mat::zeros(half + 1, count);
        let mut excess = Mat::zeros(half + 1, 1);
        for k in 0..half {
            excess[(k, 0)] = weight(k) * (1.0 - self.observed(k, point) / point.square(k));
        }
        let accuracy = (n as f64 / point.square(0)).sqrt();
        excess[(half, 0)] = -accuracy * (self.mean - point.expected.mean - point.offset);
        let share = 1.0 / count as f64;
        for a in 0..count {
            let part = &mut Part::new(monitor, a as f64 * share, share);
            let change = self.change(a, coordinates, point, part)?;
            for k in 0..half {
                derivatives[(k, a)] = weight(k) * change.squares[k] / point.square(k);
            }
            derivatives[(half, a)] = accuracy * change.mean;
        }
        let mut score = Score {
            slope: product(derivatives.transpose(), excess.as_ref()),
            information: product(derivatives.transpose(), derivatives.as_ref()),
        };
        score.add_priors(&self.free, coordinates);
        Ok(score)
    }
}
