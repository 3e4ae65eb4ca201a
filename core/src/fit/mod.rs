//! Fits of the parameters of contacts to measured curves of force, with errors that count the noise of the contacts.
//!
//! The readings are y = F(X) + machine + errors ([`Machine`], [`ErrorModel`]). Their errors are normal with the covariance Σ =
//! (covariance of the force of N_c contacts, [`Pull::covariance`](crate::master::Pull::covariance)) + reading² + drift, so that
//! −2 ln L = rᵀΣ⁻¹r + ln|Σ| + n ln 2π with the residuals r. The search is Fisher scoring with the damping of Levenberg and
//! Marquardt; numbers above 0 are varied by their logarithms. The covariance of the contacts is computed at the estimates of a
//! fit with independent errors, scaled by N⟨k⟩² in the search, and renewed up to three times. Errors of the estimates are the
//! inverse of the expected information. Several curves share their numbers but for those that are free for one of them; their
//! errors are independent.
//!
//! ```
//! use std::sync::Arc;
//! use asperity::contacts::{Contacts, Initial};
//! use asperity::ensemble::{Disorder, Ensemble};
//! use asperity::fit::{Fit, Measurement};
//! use asperity::law::{Gaussian, Point};
//! use asperity::master::MasterEquation;
//!
//! let contacts = |mean: f64, std: f64| -> asperity::Result<_> {
//!     let reformed = Arc::new(Point::new(0.0)?);
//!     Ok(Contacts { count: 2000.0, ..Contacts::new(Arc::new(Gaussian::new(mean, std)?), reformed) })
//! };
//! // What 2000 contacts do, one by one.
//! let positions: Vec<f64> = (1..=100).map(|i| 0.04 * i as f64).collect();
//! let simulated = Ensemble::new(contacts(1.0, 0.12)?, Initial::default(), 2000, 7, Disorder::Annealed)?;
//! let forces = simulated.pull(&positions)?.force;
//! let guess = MasterEquation::new(contacts(0.9, 0.2)?, &Initial::default())?;
//! let found = Fit::new(guess, Measurement::new(positions, forces)).free(["thresholds.mean", "thresholds.std"]).run()?;
//! let mean = found.estimate("thresholds.mean").unwrap();
//! assert!((mean.value - 1.0).abs() < 4.0 * mean.error && mean.error < 0.01);
//! # Ok::<(), asperity::Error>(())
//! ```

mod error_covariance;
mod estimates;
mod expected;
mod free;
mod free_form;
mod friction;
mod interval;
mod likelihood;
mod matrix;
mod measurement;
mod misfit;
mod prediction;
mod search;
mod smoothness;
mod standardised;
mod steady;

pub use estimates::{Correlation, Estimate, Estimates, Readings};
pub use free::Prior;
pub(crate) use free::{BACKGROUND, ERRORS, MACHINE};
pub use free_form::{FreeForm, ThresholdBand};
pub use friction::{FrictionEstimates, WithError};
pub use measurement::{ErrorModel, Machine, Measurement};
pub use misfit::Misfit;
pub use prediction::Prediction;
pub use standardised::Standardised;
pub use steady::{FittedSpectrum, SteadyEstimates, SteadyFit, SteadyRecord};

use faer::Mat;

use crate::law::SharedLaw;
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Rising};
use crate::{Error, Result};
use estimates::Ended;
use free::{FreeParameter, Role};
use likelihood::{ContactNoise, CurvePoint, Errors, Likelihood, LikelihoodPoint};
use search::{Optimum, search};

/// Most readings with the covariance of the contacts, or with a drift.
const MOST: usize = 4000;
/// Times that the covariance of the contacts is computed again.
const RENEWALS: usize = 3;
/// It is not, where no estimate has moved by this many of its errors.
const SETTLED: f64 = 0.1;

/// A fit of some numbers of contacts, and of the machine, to one or more measured curves of force.
#[derive(Debug, Clone)]
pub struct Fit {
    equation: MasterEquation,
    curves: Vec<Measurement>,
    errors: ErrorModel,
    free: Vec<String>,
    priors: Vec<(String, Prior)>,
}

impl Fit {
    /// A fit whose first values are those of `equation`, with nothing free so far.
    pub fn new(equation: MasterEquation, measurement: Measurement) -> Self {
        let (curves, errors) = (vec![measurement], ErrorModel::default());
        Self { equation, curves, errors, free: Vec::new(), priors: Vec::new() }
    }

    /// Another curve of the same contacts, with errors of the same sizes and the noise of other contacts.
    #[must_use]
    pub fn curve(mut self, measurement: Measurement) -> Self {
        self.curves.push(measurement);
        self
    }

    /// The numbers to vary: names of [`MasterEquation::parameters`], and `compliance`, `offset`, `trend`, `origin`. A name after
    /// `curve.0.`, `curve.1.`, … is that of a number of one curve, all others are common to the curves.
    #[must_use]
    pub fn free<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.free = names.into_iter().map(Into::into).collect();
        self
    }

    /// What the errors of readings are; without this, the noise of the contacts and independent errors of unknown size.
    #[must_use]
    pub fn errors(mut self, errors: ErrorModel) -> Self {
        self.errors = errors;
        self
    }

    /// What is known of a free number beforehand.
    #[must_use]
    pub fn prior(mut self, name: &str, prior: Prior) -> Self {
        self.priors.push((name.to_owned(), prior));
        self
    }

    /// What was measured: the curves.
    pub fn curves(&self) -> &[Measurement] {
        &self.curves
    }

    /// Whether forces are to be measured yet.
    fn is_planned(&self) -> bool {
        self.curves.iter().all(|curve| curve.forces.is_empty())
    }

    /// The largest force: the scale of forces.
    fn scale(&self) -> f64 {
        self.curves.iter().map(Measurement::scale).fold(0.0, f64::max)
    }

    /// The same fit with thresholds of another law, all numbers of which are free in place of those of the present one; priors of
    /// numbers of thresholds are left out.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn with_thresholds(&self, law: SharedLaw, monitor: &mut dyn Monitor) -> Result<Self> {
        let of_thresholds = |name: &str| name.starts_with("thresholds.");
        let own = law.parameters().into_iter().map(|parameter| format!("thresholds.{}", parameter.name));
        let others = self.free.iter().filter(|name| !of_thresholds(name)).cloned();
        Ok(Self {
            free: own.chain(others).collect(),
            priors: self.priors.iter().filter(|(name, _)| !of_thresholds(name)).cloned().collect(),
            equation: self.equation.with_thresholds(law, monitor)?,
            ..self.clone()
        })
    }

    /// Checks all values.
    ///
    /// # Errors
    /// Those of [`Self::run`] that are known without a solution.
    pub fn check(&self) -> Result<()> {
        self.checked().map(drop)
    }

    /// Finds the most probable values. A search that does not converge is told by [`Estimates::converged`].
    ///
    /// Without measured forces: the errors that such a measurement would have, at the first values.
    ///
    /// # Errors
    /// A name that is no parameter, is given twice, or none; a planned measurement without the size of errors, or with a drift,
    /// whose size is not known; fewer readings than parameters + 2; more than 4000 with the noise of contacts or a drift;
    /// positions that do not rise; count and stiffness both free without the noise of contacts; numbers that the data do not
    /// determine, with the direction; those of [`crate::master::Pull::covariance`] and [`crate::master::Pull::gradients`].
    pub fn run(&self) -> Result<Estimates> {
        self.run_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor.
    pub fn run_with(&self, monitor: &mut dyn Monitor) -> Result<Estimates> {
        let free = self.checked()?;
        let monitor = &mut Rising::new(monitor);
        if self.is_planned() {
            return self.planned(free, monitor);
        }
        let coordinates: Vec<f64> =
            free.iter().map(|parameter| parameter.coordinate(parameter.start)).collect();
        let white = Likelihood { fit: self.clone(), free, errors: Errors::ProfiledWhite, smoothness: None };
        let held = vec![false; coordinates.len()];
        let first = search(&white, &coordinates, &held, &mut Part::new(monitor, 0.0, 0.3))?;
        if self.is_profiled() {
            return Ended { likelihood: white, optimum: first }.estimates(&mut Part::new(monitor, 0.3, 0.7));
        }
        self.with_modelled_errors(white.free, first, &mut Part::new(monitor, 0.3, 0.7))
    }

    /// Whether errors are independent and of one unknown size.
    fn is_profiled(&self) -> bool {
        let ErrorModel { contacts, reading, drift } = self.errors;
        !contacts && reading.is_none() && drift.is_none()
    }

    /// The search with the noise of contacts, or other errors that are modelled, after one with independent errors.
    fn with_modelled_errors(
        &self,
        mut free: Vec<FreeParameter>,
        first: Optimum,
        monitor: &mut dyn Monitor,
    ) -> Result<Estimates> {
        let Optimum { mut coordinates, mut trial, mut solutions, .. } = first;
        free.extend(self.free_errors(0.02 * roughness(&trial), 0.5 * trial.reading()));
        let errors = free[coordinates.len()..].iter().map(|parameter| parameter.coordinate(parameter.start));
        let errors: Vec<f64> = errors.collect();
        coordinates.extend(errors);
        for renewal in 0..=RENEWALS {
            let start = 0.8 * renewal as f64 / (RENEWALS + 1) as f64;
            let noise = self.contact_noise(&trial, &coordinates, &mut Part::new(monitor, start, 0.05))?;
            if let (0, Some(noise)) = (renewal, &noise) {
                divide_noise(&free, &mut coordinates, &trial, noise);
            }
            let likelihood =
                Likelihood { fit: self.clone(), free, errors: Errors::Modelled(noise), smoothness: None };
            let held = vec![false; coordinates.len()];
            let mut found =
                search(&likelihood, &coordinates, &held, &mut Part::new(monitor, start + 0.05, 0.15))?;
            found.solutions += solutions;
            let settled = !self.errors.contacts || has_settled(&found, &coordinates);
            if settled || renewal == RENEWALS || !found.converged {
                return Ended { likelihood, optimum: found }.estimates(&mut Part::new(monitor, 0.8, 0.2));
            }
            Optimum { coordinates, trial, solutions, .. } = found;
            free = likelihood.free;
        }
        unreachable!("the last renewal returns")
    }

    /// The errors that a planned measurement would have.
    fn planned(&self, mut free: Vec<FreeParameter>, monitor: &mut dyn Monitor) -> Result<Estimates> {
        if self.errors.reading.is_none() {
            let expected = "the standard deviation of a reading, for a measurement that is only planned";
            return Err(Error::invalid("reading", expected, "none"));
        }
        if let Some(longest) = self.errors.drift {
            let expected = "no drift for a measurement that is only planned, since its size is not known";
            return Err(Error::invalid("drift.longest", expected, longest));
        }
        free.extend(self.free_errors(0.0, 0.0));
        let coordinates: Vec<f64> =
            free.iter().map(|parameter| parameter.coordinate(parameter.start)).collect();
        let white = Likelihood { fit: self.clone(), free, errors: Errors::Modelled(None), smoothness: None };
        let trial = white.trial(&coordinates, &mut Part::new(monitor, 0.0, 0.3))?.ok_or_else(|| {
            Error::invalid("free", "first values from which a curve follows", "none at the first values")
        })?;
        let noise = self.contact_noise(&trial, &coordinates, &mut Part::new(monitor, 0.3, 0.3))?;
        let likelihood = Likelihood { errors: Errors::Modelled(noise), ..white };
        let trial = likelihood.trial(&coordinates, &mut Part::new(monitor, 0.6, 0.1))?.ok_or_else(|| {
            Error::invalid("reading", "errors whose covariance is positive definite", "a smaller one")
        })?;
        let score = likelihood.score(&coordinates, &trial, &mut Part::new(monitor, 0.7, 0.1))?;
        let at_bound = vec![false; coordinates.len()];
        let optimum = Optimum { coordinates, trial, score, at_bound, converged: true, solutions: 1 };
        Ended { likelihood, optimum }.estimates(&mut Part::new(monitor, 0.8, 0.2))
    }

    /// The covariance of the noise of contacts at a point of the likelihood, if it is part of the errors.
    fn contact_noise(
        &self,
        trial: &LikelihoodPoint,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<ContactNoise>> {
        if !self.errors.contacts {
            return Ok(None);
        }
        let share = 1.0 / trial.curves.len() as f64;
        let of_curve = |(c, point): (usize, &CurvePoint)| {
            point.readings.noise(&mut Part::new(monitor, c as f64 * share, share))
        };
        let covariances = trial.curves.iter().enumerate().map(of_curve).collect::<Result<_>>()?;
        Ok(Some(ContactNoise { covariances, coordinates: coordinates.to_vec() }))
    }

    /// The free numbers, after all checks.
    fn checked(&self) -> Result<Vec<FreeParameter>> {
        for (c, curve) in self.curves.iter().enumerate() {
            let of_curve =
                |error: Error| if self.curves.len() > 1 { error.under(&format!("curve.{c}")) } else { error };
            curve.check().map_err(of_curve)?;
            self.errors.check(curve.range())?;
            let n = curve.positions.len();
            if n > MOST && (self.errors.contacts || self.errors.drift.is_some()) {
                let expected =
                    format!("at most {MOST} readings with correlated errors: average neighbouring ones");
                return Err(of_curve(Error::invalid("position", expected, n)));
            }
            if curve.forces.is_empty() != self.is_planned() {
                let expected = "forces for all curves, or for none";
                return Err(Error::invalid("force", expected, format!("none for curve {c}")));
            }
        }
        let free = self.free_parameters()?;
        let is_free = |name: &str| free.iter().any(|parameter| parameter.name == name);
        if !self.errors.contacts && is_free("count") && is_free("stiffness") {
            let expected =
                "one of count and stiffness: without the noise of contacts only their product is known";
            return Err(Error::invalid("free", expected, "both"));
        }
        let n: usize = self.curves.iter().map(|curve| curve.positions.len()).sum();
        if n < free.len() + 2 {
            let expected = format!("{} readings or more for {} free numbers", free.len() + 2, free.len());
            return Err(Error::invalid("position", expected, n));
        }
        Ok(free)
    }
}

/// The size of independent errors, from the second differences of the residuals.
fn roughness(trial: &LikelihoodPoint) -> f64 {
    let of_curve = |curve: &CurvePoint| {
        let r = &curve.residuals;
        let second = |i: usize| r[(i, 0)] - 2.0 * r[(i + 1, 0)] + r[(i + 2, 0)];
        let squares: f64 = (0..r.nrows().saturating_sub(2)).map(|i| second(i).powi(2)).sum();
        (squares, r.nrows())
    };
    let (squares, n) =
        trial.curves.iter().map(of_curve).fold((0.0, 0), |all, one| (all.0 + one.0, all.1 + one.1));
    (squares / (6.0 * n as f64)).sqrt()
}

/// Divides N⟨k⟩ anew where both are free, so that the noise of contacts is as large as the residuals.
fn divide_noise(
    free: &[FreeParameter],
    coordinates: &mut [f64],
    trial: &LikelihoodPoint,
    noise: &ContactNoise,
) {
    let place = |name: &str| free.iter().position(|parameter| parameter.name == name);
    let (Some(count), Some(stiffness)) = (place("count"), place("stiffness")) else { return };
    let trace = |covariance: &Mat<f64>| (0..covariance.nrows()).map(|i| covariance[(i, i)]).sum::<f64>();
    let expected: f64 = noise.covariances.iter().map(trace).sum();
    let ratio = trial.curves.iter().map(|curve| curve.residuals.squared_norm_l2()).sum::<f64>() / expected;
    if ratio.is_finite() && ratio > 0.0 {
        coordinates[count] -= ratio.ln();
        coordinates[stiffness] += ratio.ln();
    }
}

/// Whether no estimate has moved by much of its error.
fn has_settled(found: &Optimum, before: &[f64]) -> bool {
    let moved = found.coordinates.iter().zip(before).enumerate();
    moved
        .map(|(k, (u, before))| (u - before).abs() * found.score.information[(k, k)].sqrt())
        .all(|errors| errors < SETTLED)
}
