//! The likelihood of forces of steady sliding at several velocities.

use faer::Mat;

use super::super::free::{FreeParameter, Role, UNREAD, of_contacts, priors_at, value_of, values_at};
use super::super::matrix::product;
use super::super::score::Score;
use super::super::search::Objective;
use super::VelocityCurveFit;
use crate::contacts::FreeFriction;
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Watch};
use crate::{Error, Result};

/// Step of the central differences by a logarithm, or relative to a number that may have any sign. The truncation is a sixth of its
/// square times a third derivative of the order of the force, 2e-7; the error of the force, 1e-9 or so for contacts with rates, is
/// divided by it.
const STEP: f64 = 1e-3;

/// The likelihood of a curve as a function of the coordinates of the free numbers.
#[derive(Debug)]
pub(super) struct VelocityLikelihood {
    pub fit: VelocityCurveFit,
    pub free: Vec<FreeParameter>,
    /// The contacts of the first values.
    equation: MasterEquation,
    /// The velocities that occur, rising.
    pub velocities: Vec<f64>,
    /// The place in them of each reading.
    pub places: Vec<usize>,
}

/// A point of the likelihood.
#[derive(Debug)]
pub(super) struct VelocityPoint {
    /// F_k of the contacts at each velocity that occurs.
    pub friction: Vec<f64>,
    /// The largest estimated error of F_k/(N_c⟨k⟩).
    pub error: f64,
    /// The constant part of the readings: background and offset.
    pub constant: f64,
    /// Measured less expected forces.
    pub residuals: Vec<f64>,
    /// The standard deviations of the readings.
    pub std: Vec<f64>,
    /// −2 ln L, priors included, for the most probable size of errors where it is not known.
    pub deviance: f64,
    /// What a search makes as low as possible.
    pub restricted: f64,
}

/// F_k and the estimated error of F_k/(N_c⟨k⟩).
pub(super) type FrictionAndError = (f64, f64);

impl VelocityLikelihood {
    pub fn new(fit: VelocityCurveFit, free: Vec<FreeParameter>, equation: MasterEquation) -> Self {
        let (velocities, places) = fit.curve.distinct();
        Self { fit, free, equation, velocities, places }
    }

    /// The names of the numbers of the contacts.
    pub fn parameters(&self) -> Vec<String> {
        self.equation.parameters().into_iter().map(|parameter| parameter.name.into_owned()).collect()
    }

    /// Number of readings.
    pub fn readings(&self) -> usize {
        self.places.len()
    }

    /// Whether the size of the errors is estimated.
    pub fn estimates_errors(&self) -> bool {
        self.fit.reading.is_none() && self.fit.curve.errors.is_none()
    }

    /// The degrees of freedom of a size of errors that is estimated.
    fn degrees(&self) -> f64 {
        (self.readings() as f64 - self.free.len() as f64).max(1.0)
    }

    /// The contacts at these coordinates, at a velocity.
    ///
    /// # Errors
    /// Those of [`MasterEquation::reformed`].
    pub fn equation_at(
        &self,
        coordinates: &[f64],
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<MasterEquation> {
        let values = values_at(&self.free, coordinates);
        let contacts = self.equation.contacts_with(&of_contacts(&self.free, &values, 0))?;
        MasterEquation::reformed(contacts, Some(velocity), monitor)
    }

    /// Steady sliding for each of `jobs`, coordinates and a velocity, on all threads; `None` where numbers are beyond their range.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn frictions(
        &self,
        jobs: &[(&[f64], f64)],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Option<FrictionAndError>>> {
        let watch = Watch::new(monitor);
        let finished = std::sync::atomic::AtomicUsize::new(0);
        let one = |_: &mut (), job: usize| {
            let (coordinates, velocity) = jobs[job];
            let found = self.equation_at(coordinates, velocity, &mut &watch).map(|equation| {
                let steady = equation.steady_state();
                (steady.kinetic_friction(), steady.error_estimate())
            });
            let before = finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            watch.done((before + 1) as f64 / jobs.len() as f64);
            match found {
                Err(Error::Invalid { .. } | Error::TooLarge { .. }) => Ok(None),
                found => found.map(|found| Some(found).filter(|found| found.0.is_finite())),
            }
        };
        watch.share(jobs.len(), || (), one)?.into_iter().collect()
    }

    /// Background and offset.
    pub fn constant(&self, coordinates: &[f64]) -> f64 {
        self.background(coordinates) + self.offset(coordinates)
    }

    /// The offset alone.
    pub fn offset(&self, coordinates: &[f64]) -> f64 {
        value_of(&self.free, Role::Offset, coordinates).unwrap_or(self.fit.offset)
    }

    /// The background force alone.
    pub fn background(&self, coordinates: &[f64]) -> f64 {
        value_of(&self.free, Role::Background, coordinates).unwrap_or(self.fit.background)
    }

    /// The standard deviations of readings with these residuals.
    fn std(&self, residuals: &[f64]) -> Vec<f64> {
        if let Some(errors) = &self.fit.curve.errors {
            return errors.clone();
        }
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        let largest =
            self.fit.curve.forces.iter().fold(f64::MIN_POSITIVE, |most, force| most.max(force.abs()));
        let estimated = (squares / self.degrees()).sqrt().max(UNREAD * largest);
        vec![self.fit.reading.unwrap_or(estimated); residuals.len()]
    }

    /// The point at coordinates with this friction.
    fn point(&self, coordinates: &[f64], friction: Vec<FrictionAndError>) -> Option<VelocityPoint> {
        let constant = self.constant(coordinates);
        let readings = self.fit.curve.forces.iter().zip(&self.places);
        let residuals: Vec<f64> =
            readings.map(|(force, &place)| force - friction[place].0 - constant).collect();
        let std = self.std(&residuals);
        let n = self.readings() as f64;
        let (squares, known) = residuals
            .iter()
            .zip(&std)
            .fold((0.0, 0.0), |(squares, known), (r, s)| (squares + (r / s).powi(2), known + 2.0 * s.ln()));
        let prior = priors_at(&self.free, coordinates);
        let (deviance, restricted) = if self.estimates_errors() {
            // The most probable size, of which s² is n/(n − p) times the square, makes the sum of squares n.
            let degrees = self.degrees();
            let most_probable = n * (degrees / n).ln() + squares * n / degrees - squares;
            (squares + known + most_probable, degrees * 2.0 * std[0].ln())
        } else {
            (squares + known, squares + known)
        };
        let deviance = deviance + n * std::f64::consts::TAU.ln() + prior;
        let error = friction.iter().fold(0.0_f64, |most, one| most.max(one.1));
        let friction = friction.into_iter().map(|one| one.0).collect();
        let restricted = restricted + prior;
        let point = VelocityPoint { friction, error, constant, residuals, std, deviance, restricted };
        point.deviance.is_finite().then_some(point)
    }

    /// Derivatives of the expected force by the coordinates: one row for each of `velocities`, at which the contacts have
    /// `friction`.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn derivatives(
        &self,
        coordinates: &[f64],
        (velocities, friction): (&[f64], &[f64]),
        monitor: &mut dyn Monitor,
    ) -> Result<Mat<f64>> {
        let step = |k: usize| {
            if self.free[k].logarithmic { STEP } else { STEP * coordinates[k].abs().max(self.length()) }
        };
        let by_difference: Vec<usize> =
            (0..self.free.len()).filter(|&k| self.closed_derivative(k).is_none()).collect();
        let moved: Vec<Vec<f64>> = by_difference
            .iter()
            .flat_map(|&k| [1.0, -1.0].map(|side| (k, side)))
            .map(|(k, side)| {
                let mut moved = coordinates.to_vec();
                moved[k] += side * step(k);
                moved
            })
            .collect();
        let jobs: Vec<(&[f64], f64)> =
            moved.iter().flat_map(|moved| velocities.iter().map(|&v| (moved.as_slice(), v))).collect();
        let found = self.frictions(&jobs, monitor)?;
        let count = velocities.len();
        let difference = |i: usize, d: usize| {
            let k = by_difference[d];
            let at = |side: usize| {
                let job = (2 * d + side) * count + i;
                found[job].map_or((coordinates[k], friction[i]), |found| (moved[2 * d + side][k], found.0))
            };
            // At the end of a range the difference is one-sided.
            let ((high, above), (low, below)) = (at(0), at(1));
            if high > low { (above - below) / (high - low) } else { 0.0 }
        };
        let place = |k: usize| by_difference.iter().position(|&other| other == k);
        Ok(Mat::from_fn(count, self.free.len(), |i, k| match (self.closed_derivative(k), place(k)) {
            (Some(ClosedDerivative::Constant), _) => self.free[k].slope(coordinates[k]),
            (Some(ClosedDerivative::Friction), _) => friction[i],
            (None, d) => d.map_or(0.0, |d| difference(i, d)),
        }))
    }

    /// A length of the contacts, for steps of numbers that may be 0.
    fn length(&self) -> f64 {
        self.equation.contacts().thresholds.mean()
    }

    /// How the expected force follows number `k`, where this needs no solution.
    fn closed_derivative(&self, k: usize) -> Option<ClosedDerivative> {
        let contacts = self.equation.contacts();
        // Barriers are proportional to the stiffness; friction of free contacts is not.
        let proportional =
            contacts.rules.temperature.is_none() && contacts.rules.free_friction == FreeFriction::default();
        match self.free[k].role {
            Role::Offset | Role::Background => Some(ClosedDerivative::Constant),
            _ => match self.free[k].name.as_str() {
                "count" => Some(ClosedDerivative::Friction),
                "stiffness" | "stiffness_per_threshold" if proportional => Some(ClosedDerivative::Friction),
                _ => None,
            },
        }
    }
}

/// How an expected force follows a number in closed form.
enum ClosedDerivative {
    /// It is added.
    Constant,
    /// The force of the contacts is proportional to it.
    Friction,
}

impl Objective for VelocityLikelihood {
    type Point = VelocityPoint;

    fn free(&self) -> &[FreeParameter] {
        &self.free
    }

    fn halvings(&self) -> i32 {
        2
    }

    fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<VelocityPoint>> {
        let jobs: Vec<(&[f64], f64)> = self.velocities.iter().map(|&v| (coordinates, v)).collect();
        let friction = self.frictions(&jobs, monitor)?.into_iter().collect::<Option<Vec<_>>>();
        Ok(friction.and_then(|friction| self.point(coordinates, friction)))
    }

    fn deviance(point: &VelocityPoint) -> f64 {
        point.restricted
    }

    fn score(&self, coordinates: &[f64], point: &VelocityPoint, monitor: &mut dyn Monitor) -> Result<Score> {
        let at = (self.velocities.as_slice(), point.friction.as_slice());
        let derivatives = self.derivatives(coordinates, at, monitor)?;
        let whitened = Mat::from_fn(self.readings(), self.free.len(), |i, k| {
            derivatives[(self.places[i], k)] / point.std[i]
        });
        let residuals = Mat::from_fn(self.readings(), 1, |i, _| point.residuals[i] / point.std[i]);
        let mut score = Score {
            slope: -product(whitened.transpose(), residuals.as_ref()),
            information: product(whitened.transpose(), whitened.as_ref()),
        };
        score.add_priors(&self.free, coordinates);
        Ok(score)
    }

    /// The likelihood where the size of the errors has its most probable value.
    fn unrestricted(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(f64, Mat<f64>)>> {
        let trial = self.trial(coordinates, &mut Part::new(monitor, 0.0, 0.3))?;
        let Some(point) = trial else { return Ok(None) };
        let mut score = self.score(coordinates, &point, &mut Part::new(monitor, 0.3, 0.7))?;
        if self.estimates_errors() {
            // n ln Σr² in place of (n − p) ln Σr².
            let ratio = self.readings() as f64 / self.degrees();
            for (k, (parameter, u)) in self.free.iter().zip(coordinates).enumerate() {
                let known = parameter.prior.map_or(0.0, |[mean, std]| (u - mean) / (std * std));
                score.slope[(k, 0)] = ratio * (score.slope[(k, 0)] - known) + known;
            }
        }
        Ok(Some((point.deviance, score.slope)))
    }

    fn freedom(&self) -> Option<f64> {
        self.estimates_errors().then(|| self.degrees())
    }
}
