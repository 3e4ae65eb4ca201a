//! Fits of the parameters of contacts to a record of the force in steady sliding: to its mean and to its noise.
//!
//! The force of N_c contacts in steady sliding is a stationary process with the mean F_k and the autocovariance
//! [`SteadyState::autocovariance`](crate::master::SteadyState::autocovariance); it is nearly normal, as the sum of many. The
//! likelihood of n readings is the debiased one of Whittle (A. M. Sykulski, S. C. Olhede, A. P. Guillaumin, J. M. Lilly and
//! J. J. Early, Biometrika 106, 251 (2019)): the components of the discrete Fourier transform count as independent, with their
//! exact variances, which follow from the autocovariance at the lags of the record by one transform. Aliasing and leakage,
//! which bias fits of a spectrum to a periodogram, are in them. The mean of the record is the component of wave number 0.
//!
//! Errors are the inverse of the expected information, by which ordinates are independent. Derivatives of the variances are
//! central differences, but for those by `count` and `stiffness`, in proportion to which the force varies.
//!
//! ```
//! use std::sync::Arc;
//! use asperity::contacts::{Contacts, Initial};
//! use asperity::ensemble::{Disorder, Ensemble};
//! use asperity::fit::{SteadyFit, SteadyRecord};
//! use asperity::law::{Gaussian, Point};
//! use asperity::master::MasterEquation;
//!
//! let contacts = |mean: f64, std: f64, count: f64| -> asperity::Result<_> {
//!     let reformed = Arc::new(Point::new(0.0)?);
//!     Ok(Contacts { count, ..Contacts::new(Arc::new(Gaussian::new(mean, std)?), reformed) })
//! };
//! // What 500 contacts do, one by one, long after the start.
//! let positions: Vec<f64> = (0..1000).map(|i| 30.0 + 0.1 * i as f64).collect();
//! let simulated = Ensemble::new(contacts(1.0, 0.2, 500.0)?, Initial::default(), 500, 7, Disorder::Annealed)?;
//! let record = SteadyRecord::at_positions(&positions, simulated.pull(&positions)?.force)?;
//! let guess = MasterEquation::new(contacts(1.1, 0.3, 300.0)?, &Initial::default())?;
//! let found = SteadyFit::new(guess, record).free(["thresholds.mean", "thresholds.std", "count"]).run()?;
//! let count = found.estimate("count").unwrap();
//! assert!((count.value - 500.0).abs() < 4.0 * count.error);
//! # Ok::<(), asperity::Error>(())
//! ```

mod estimates;
mod expected;
mod likelihood;
mod record;
mod start;

pub use estimates::{FittedSpectrum, SteadyEstimates};
pub use record::SteadyRecord;

use super::ended::Ended;
use super::free::{FreeParameter, Prior, Role, named, with_priors};
use super::search::{SHORT, search_each};
use crate::error::{finite, not_negative, positive};
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Rising};
use crate::{Error, Result};
use likelihood::SteadyLikelihood;

/// Fewest readings for each free number: the expected information holds for many.
const LEAST: usize = 16;
/// Smallest free error of a reading, and its first value, in multiples of the standard deviation of the record.
const SMALLEST: f64 = 1e-3;
const FIRST: f64 = 0.05;

/// A fit of some numbers of contacts to a record of the force in steady sliding.
#[derive(Debug, Clone)]
pub struct SteadyFit {
    equation: MasterEquation,
    record: SteadyRecord,
    reading: Option<f64>,
    offset: f64,
    free: Vec<String>,
    priors: Vec<(String, Prior)>,
}

impl SteadyFit {
    /// A fit whose first values are those of `equation`, with nothing free so far. Errors of readings are independent and
    /// of a size that is estimated.
    pub fn new(equation: MasterEquation, record: SteadyRecord) -> Self {
        Self { equation, record, reading: None, offset: 0.0, free: Vec::new(), priors: Vec::new() }
    }

    /// The numbers to vary: names of [`MasterEquation::parameters`] but those of the initial stretches, of which steady sliding
    /// is independent; and `offset`.
    #[must_use]
    pub fn free<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.free = names.into_iter().map(Into::into).collect();
        self
    }

    /// The standard deviation of the independent error of a reading, 0 or above.
    #[must_use]
    pub fn reading(mut self, error: f64) -> Self {
        self.reading = Some(error);
        self
    }

    /// The reading of the force where there is none; 0 without this.
    #[must_use]
    pub fn offset(mut self, offset: f64) -> Self {
        self.offset = offset;
        self
    }

    /// What is known of a free number beforehand.
    #[must_use]
    pub fn prior(mut self, name: &str, prior: Prior) -> Self {
        self.priors.push((name.to_owned(), prior));
        self
    }

    /// What was measured.
    pub fn record(&self) -> &SteadyRecord {
        &self.record
    }

    /// Checks all values.
    ///
    /// # Errors
    /// Those of [`Self::run`] that are known without a solution.
    pub fn check(&self) -> Result<()> {
        self.checked().map(drop)
    }

    /// Finds the most probable values. A search that does not converge is reported by [`SteadyEstimates::converged`].
    ///
    /// # Errors
    /// A name that is no parameter, is given twice, or none; fewer than 16 readings for each free number; forces that are not
    /// finite, or all the same; contacts whose noise is not known or consists of lines, see
    /// [`SteadyState::spectrum`](crate::master::SteadyState::spectrum); first values of which there is no noise; numbers that
    /// the record does not determine, with the direction: without the zero of the force, count and stiffness are one number.
    pub fn run(&self) -> Result<SteadyEstimates> {
        self.run_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor.
    pub fn run_with(&self, monitor: &mut dyn Monitor) -> Result<SteadyEstimates> {
        let free = self.checked()?;
        let monitor = &mut Rising::new(monitor);
        let likelihood = SteadyLikelihood::new(self.clone(), free);
        let starts = likelihood.first_values(&mut Part::new(monitor, 0.0, 0.2))?.ok_or_else(|| {
            Error::invalid("free", "first values that have a noise", "none at the first values")
        })?;
        let optimum = search_each(&likelihood, &starts, SHORT, &mut Part::new(monitor, 0.2, 0.7))?;
        SteadyEstimates::new(Ended { likelihood, optimum }, &mut Part::new(monitor, 0.9, 0.1))
    }

    /// The free numbers, after all checks.
    fn checked(&self) -> Result<Vec<FreeParameter>> {
        self.record.check()?;
        if let Some(reading) = self.reading {
            not_negative("reading", reading)?;
        }
        finite("offset", self.offset)?;
        let mut free = self.free_parameters()?;
        let (n, least) = (self.record.forces.len(), LEAST * free.len());
        if n < least {
            let expected = format!("{least} readings or more for {} free numbers", free.len());
            return Err(Error::invalid("force", expected, n));
        }
        // Lines have no density, and contacts that do not renew completely no noise that is known.
        self.equation.steady_state().noise_at_zero(self.equation.contacts().count)?;
        if self.reading.is_none() {
            free.push(self.free_reading());
        }
        Ok(free)
    }

    /// The free numbers of the contacts and the offset, with their priors.
    ///
    /// # Errors
    /// A name that is unknown, given twice, or without a derivative; none; a prior of a number that is fixed.
    fn free_parameters(&self) -> Result<Vec<FreeParameter>> {
        let contacts = (&self.equation, |name: &str| !name.starts_with("initial."));
        let free = named(&self.free, contacts, &[("offset", Role::Offset, self.offset)], |parameter| {
            if parameter.logarithmic {
                positive(&parameter.name, parameter.start)?;
            }
            Ok(parameter)
        })?;
        with_priors(free, &self.priors)
    }

    /// The size of the independent errors of readings, where it is free.
    fn free_reading(&self) -> FreeParameter {
        let mean = self.record.mean();
        let squares: f64 = self.record.forces.iter().map(|force| (force - mean).powi(2)).sum();
        let std = (squares / self.record.forces.len() as f64).sqrt();
        FreeParameter {
            bounds: [(SMALLEST * std).ln(), f64::INFINITY],
            ..FreeParameter::new("reading", Role::Reading, true, FIRST * std)
        }
    }
}
