//! Fits of the parameters of contacts to measured curves of force, with errors that count the noise of the contacts.
//!
//! The readings are y = F(X) + machine + errors ([`Machine`], [`ErrorModel`]). Their errors are normal with the covariance Σ =
//! (covariance of the force of N_c contacts, [`Pull::covariance`](crate::master::Pull::covariance), or (slope of the curve · error of
//! a position)²) + reading² + drift, so that −2 ln L = rᵀΣ⁻¹r + ln|Σ| + n ln 2π with the residuals r. The search is Fisher scoring with the damping of Levenberg and
//! Marquardt; numbers above 0 are varied by their logarithms, but for a compliance. Where sizes of errors are free, a step leads to
//! the most probable numbers for a curve along its tangent, which need no further solutions. If the lengths of the thresholds are
//! several times too large or too small, it begins with those multiplied by one factor that are most like the curve. The
//! covariance of the contacts is computed at the estimates of a fit with independent errors, scaled by N⟨k⟩² in the search, and
//! renewed up to three times; the search with correlated errors begins with every s-th reading. Blocks of that covariance beside
//! its diagonal have low ranks, where thresholds have no jumps, so that its factor is that of a hierarchical matrix. Errors of the
//! estimates are the inverse of the expected information; those of the sizes of errors are larger where the whitened residuals
//! have more than the kurtosis of normal ones. Several curves share their numbers but for those that are free for one of them;
//! their errors are independent.
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

mod cholesky;
mod ended;
mod error_covariance;
mod estimate;
mod estimates;
mod expected;
mod first_values;
mod fixed;
mod free;
mod free_form;
mod friction;
mod hierarchical;
mod interval;
mod likelihood;
mod linearised;
mod low_rank;
mod matrix;
mod measurement;
mod misfit;
mod modelled_errors;
mod noise_size;
mod objective;
mod prediction;
mod restricted;
mod score;
mod search;
mod smoothness;
mod standardised;
mod steady;
mod velocity_curve;

pub use estimate::{Correlation, Estimate};
pub use estimates::{Estimates, Readings};
pub use free::Prior;
pub(crate) use free::{BACKGROUND, ERRORS, MACHINE};
pub use free_form::{FreeForm, ThresholdBand};
pub use friction::{FrictionEstimates, WithError};
pub use measurement::{ErrorModel, Machine, Measurement};
pub use misfit::Misfit;
pub use prediction::Prediction;
pub use standardised::Standardised;
pub use steady::{FittedSpectrum, SteadyEstimates, SteadyFit, SteadyRecord};
pub(crate) use velocity_curve::is_of_sliding;
pub use velocity_curve::{
    FittedVelocityCurve, MeasuredVelocityCurve, VelocityCurveEstimates, VelocityCurveFit,
};

use crate::law::{Law, SharedLaw};
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Rising};
use crate::{Error, Result};
use ended::Ended;
use free::{FreeParameter, Role, first_coordinates};
use likelihood::{Errors, Likelihood};
use search::{ONE_ERROR, Optimum, SHORT, search_each};

/// Most readings with the covariance of the contacts, or with a drift.
const MOST: usize = 4000;

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

    /// The numbers to vary: names of [`MasterEquation::parameters`], and `compliance`, `background`, `offset`, `trend`, `origin`. A name after
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

    /// Refuses a measurement that is only planned: without forces there are no residuals, and what a likelihood would be is that of
    /// forces of 0.
    fn refuse_planned(&self) -> Result<()> {
        if self.is_planned() {
            let expected = "measured forces: a measurement that is only planned has no posterior";
            return Err(Error::invalid("force", expected, "none"));
        }
        Ok(())
    }

    /// The largest force: the scale of forces.
    fn scale(&self) -> f64 {
        self.curves.iter().map(Measurement::scale).fold(0.0, f64::max)
    }

    /// The same fit with thresholds of another law. If all numbers of the present thresholds are free, all of its own are;
    /// otherwise those of the same names. Priors stay with their names.
    ///
    /// # Errors
    /// A free number of thresholds that the other law has not; errors of the solver; stopped by the monitor.
    pub fn with_thresholds(&self, law: SharedLaw, monitor: &mut dyn Monitor) -> Result<Self> {
        let present = names_of(self.equation.contacts().thresholds.as_ref());
        let own = names_of(law.as_ref());
        if present.iter().all(|name| self.free.contains(name)) {
            return self.with_law((law, own), monitor);
        }
        let free: Vec<String> = self.free.iter().filter(|name| is_of_thresholds(name)).cloned().collect();
        if let Some(name) = free.iter().find(|name| !own.contains(name)) {
            let expected = format!(
                "{}, or all numbers of the thresholds, for a fit with the distribution {}",
                own.join(", "),
                law.name()
            );
            return Err(Error::invalid("free", expected, name));
        }
        self.with_law((law, free), monitor)
    }

    /// The same fit with thresholds of another law, of which these numbers are free.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    fn with_law(&self, (law, own): (SharedLaw, Vec<String>), monitor: &mut dyn Monitor) -> Result<Self> {
        let others = self.free.iter().filter(|name| !is_of_thresholds(name)).cloned();
        let priors = self.priors.iter().filter(|(name, _)| !is_of_thresholds(name) || own.contains(name));
        Ok(Self {
            priors: priors.cloned().collect(),
            free: own.into_iter().chain(others).collect(),
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

    /// Finds the most probable values. A search that does not converge is reported by [`Estimates::converged`].
    ///
    /// Without measured forces: the errors that such a measurement would have, at the first values.
    ///
    /// # Errors
    /// A name that is no parameter, is given twice, or none; a planned measurement without the size of errors, or with a drift,
    /// whose size is not known; fewer readings than parameters + 2; more than 4000 with the noise of contacts or a drift;
    /// positions that do not rise; forces that are all equal, or below 0 on average with a known zero; positions up to less than a
    /// fiftieth of the first mean threshold, or forces that rise over more than twenty of them; the noise of contacts for contacts
    /// of different stiffness, or beside errors of the positions; count and stiffness both free without the noise of contacts; numbers
    /// that the data do not determine, with the direction; those of [`crate::master::Pull::covariance`] and
    /// [`crate::master::Pull::gradients`].
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
        let errors = Errors::ProfiledWhite { fitted: free.len() as f64 };
        let white = Likelihood { fit: self.clone(), free, errors, smoothness: None, restricted: None };
        let (starts, solutions) = self.first_values(&white, &mut Part::new(monitor, 0.0, 0.05))?;
        let short = if self.is_profiled() { SHORT } else { ONE_ERROR };
        let mut first = search_each(&white, &starts, short, &mut Part::new(monitor, 0.05, 0.25))?;
        first.solutions += solutions;
        if self.is_profiled() {
            return Ended { likelihood: white, optimum: first }.estimates(&mut Part::new(monitor, 0.3, 0.7));
        }
        self.with_modelled_errors(white.free, first, &mut Part::new(monitor, 0.3, 0.7))
    }

    /// Whether errors are independent and of one unknown size.
    fn is_profiled(&self) -> bool {
        let ErrorModel { contacts, reading, drift, position } = self.errors;
        !contacts && reading.is_none() && drift.is_none() && position.is_none()
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
        let coordinates = first_coordinates(&free);
        let white = Likelihood {
            fit: self.clone(),
            free,
            errors: Errors::Modelled(None),
            smoothness: None,
            restricted: None,
        };
        let readings = white.expected(&coordinates, &mut Part::new(monitor, 0.0, 0.3))?.ok_or_else(|| {
            Error::invalid("free", "first values from which a curve follows", "none at the first values")
        })?;
        let known = self.known_errors(&readings, &coordinates, &mut Part::new(monitor, 0.3, 0.3))?;
        let mut likelihood = Likelihood { errors: Errors::Modelled(known), ..white };
        let indefinite =
            || Error::invalid("reading", "errors whose covariance is positive definite", "a smaller one");
        let trial = likelihood.at_readings(&coordinates, readings).ok_or_else(indefinite)?;
        likelihood.restrict(&coordinates, &trial, &mut Part::new(monitor, 0.6, 0.1))?;
        let readings = trial.curves.into_iter().map(|curve| curve.readings).collect();
        let trial = likelihood.at_readings(&coordinates, readings).ok_or_else(indefinite)?;
        let score = likelihood.score(&coordinates, &trial, &mut Part::new(monitor, 0.7, 0.1))?;
        let at_bound = vec![false; coordinates.len()];
        let optimum =
            Optimum { coordinates, trial, score, at_bound, converged: true, solutions: 1, fall: 0.0 };
        Ended { likelihood, optimum }.estimates(&mut Part::new(monitor, 0.8, 0.2))
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
        let is_free =
            |curve: usize, name: &str| free.iter().any(|one| one.quantity == name && one.applies_to(curve));
        if self.errors.contacts && self.equation.contacts().have_equal_stiffness().is_err() {
            let expected = "\"white\" where the stiffness of a contact depends on its threshold: the noise of contacts is known where all are equally stiff";
            return Err(Error::invalid("noise", expected, "contacts"));
        }
        if let (true, Some(position)) = (self.errors.contacts, self.errors.position) {
            let expected = "none beside noise = \"contacts\", which changes with the true positions: smooth the positions, or take noise = \"white\"";
            return Err(Error::invalid("position_error", expected, position));
        }
        let both = |curve: usize| is_free(curve, "count") && is_free(curve, "stiffness");
        if !self.errors.contacts && (0..self.curves.len()).any(both) {
            let expected =
                "one of count and stiffness: without the noise of contacts only their product is known";
            return Err(Error::invalid("free", expected, "both"));
        }
        let n: usize = self.curves.iter().map(|curve| curve.positions.len()).sum();
        if n < free.len() + 2 {
            let expected = format!("{} readings or more for {} free numbers", free.len() + 2, free.len());
            return Err(Error::invalid("position", expected, n));
        }
        self.check_against_first_values(&free)?;
        Ok(free)
    }

    /// Refuses curves that no contacts near the first values make, before a long search ends nowhere.
    fn check_against_first_values(&self, free: &[FreeParameter]) -> Result<()> {
        let is_free = |names: &[&str]| free.iter().any(|one| names.contains(&one.quantity.as_str()));
        let curves = || self.curves.iter().filter(|curve| !curve.forces.is_empty());
        if let Some(curve) = curves().next()
            && curves().all(|curve| curve.forces.iter().all(|force| *force == curve.forces[0]))
        {
            return Err(Error::invalid("force", "forces that change", format!("{} alone", curve.forces[0])));
        }
        for curve in curves().filter(|_| !is_free(&["offset", "background", "trend"])) {
            let Machine { background, offset, trend, .. } = curve.machine;
            let readings = curve.positions.iter().zip(&curve.forces);
            let mean = readings.map(|(y, force)| force - background - offset - trend * y).sum::<f64>()
                / curve.forces.len() as f64;
            if mean < 0.0 {
                let expected =
                    "forces above 0 on average, as pulled contacts have, or offset among the free numbers";
                return Err(Error::invalid("force", expected, format!("a mean of {mean}")));
            }
        }
        let reach = |curve: &Measurement| curve.last() - curve.machine.origin;
        let farthest = self.curves.iter().map(reach).fold(f64::NEG_INFINITY, f64::max);
        let mean = self.equation.contacts().thresholds.mean();
        if is_free(&["origin"]) || !free.iter().any(|one| is_of_thresholds(&one.quantity)) {
            return Ok(());
        }
        if farthest < SHORTEST * mean {
            let expected = format!(
                "positions beyond {}, a fiftieth of the mean threshold {mean} of the first values: their units may differ",
                SHORTEST * mean
            );
            return Err(Error::invalid("position", expected, format!("positions up to {farthest}")));
        }
        let shortest = self.curves.iter().filter_map(Measurement::rise).fold(f64::INFINITY, f64::min);
        let machine_is_known = !is_free(&["compliance", "offset", "background", "trend"]);
        if machine_is_known && shortest.is_finite() && shortest > LONGEST * mean {
            let expected = format!(
                "a force that rises to half of its median by {}, twenty times the mean threshold {mean} of the first values: their units may differ",
                LONGEST * mean
            );
            return Err(Error::invalid("position", expected, format!("a rise over {shortest}")));
        }
        Ok(())
    }
}

/// Shortest pull, in mean thresholds of the first values, that shows anything of thresholds: with first values that are right, one
/// in a unit that is a thousand times as long goes beyond it only where the contacts are pulled over twenty thresholds.
const SHORTEST: f64 = 0.02;

/// Longest rise of the force to half of its median, in mean thresholds of the first values. Thresholds are at least as long
/// as the rise, and first values may differ from them by factors of eight, which are tried.
const LONGEST: f64 = 20.0;

/// Whether a number belongs to the thresholds, of all curves.
fn is_of_thresholds(name: &str) -> bool {
    name.starts_with("thresholds.")
}

/// The names of the numbers of thresholds.
fn names_of(law: &dyn Law) -> Vec<String> {
    law.parameters().into_iter().map(|parameter| format!("thresholds.{}", parameter.name)).collect()
}
