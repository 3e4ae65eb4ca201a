//! Fits of the parameters of contacts to forces of steady sliding, measured at several velocities.
//!
//! The readings are y = F_k(v) + background + offset + errors, with F_k of the stationary renewal process,
//! [`SteadyState::kinetic_friction`](crate::master::SteadyState::kinetic_friction). Errors are independent and normal: each of its
//! own standard deviation, or all of one size, which is given or estimated. With residuals r and standard deviations s,
//! −2 ln L = Σ \[r²/s² + ln s²\] + n ln 2π; where the size is estimated, it is s² = Σr²/(n − p) for p free numbers, and
//! intervals have Student's t of n − p degrees of freedom.
//!
//! The search is the method of Levenberg and Marquardt. Its derivatives are central differences. If all times of the contacts
//! are free, it begins also with those multiplied by one factor that are most like the curve: contacts whose times are a times
//! as long have at v the friction of the first ones at av.
//!
//! ```
//! use std::sync::Arc;
//! use asperity::contacts::{Ageing, Contacts};
//! use asperity::fit::{MeasuredVelocityCurve, VelocityCurveFit};
//! use asperity::law::{Gaussian, Point};
//!
//! // Contacts that age: friction falls with velocity.
//! let contacts = |time: f64| -> asperity::Result<_> {
//!     let mut contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.2)?), Arc::new(Point::new(0.0)?));
//!     contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.1, time });
//!     Ok(contacts)
//! };
//! let curve = MeasuredVelocityCurve {
//!     velocities: vec![0.01, 0.1, 1.0, 10.0],
//!     forces: vec![0.7515, 0.6460, 0.5497, 0.5227],
//!     errors: Some(vec![0.002; 4]),
//! };
//! let found = VelocityCurveFit::new(contacts(3.0)?, curve).free(["ageing.growth", "ageing.time"]).run()?;
//! assert!(found.converged && !found.misfit.is_unlikely());
//! # Ok::<(), asperity::Error>(())
//! ```

mod estimates;
mod likelihood;
mod measured;
mod start;

pub use estimates::{FittedVelocityCurve, VelocityCurveEstimates};
pub use measured::MeasuredVelocityCurve;

use super::ended::Ended;
use super::free::{BACKGROUND, FreeParameter, Prior, Role, named, with_priors};
use super::search::{SHORT, search_each};
use crate::contacts::Contacts;
use crate::error::{finite, not_negative, positive};
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Rising};
use crate::{Error, Result};
use likelihood::VelocityLikelihood;

/// The smallest value of a free number, in parts of its scale: the effect on the force is of this order.
const SMALLEST: f64 = 1e-5;

/// A fit of some numbers of contacts to forces of steady sliding at several velocities.
#[derive(Debug, Clone)]
pub struct VelocityCurveFit {
    contacts: Contacts,
    curve: MeasuredVelocityCurve,
    reading: Option<f64>,
    background: f64,
    offset: f64,
    free: Vec<String>,
    priors: Vec<(String, Prior)>,
}

impl VelocityCurveFit {
    /// A fit whose first values are those of `contacts`, with nothing free so far.
    pub fn new(contacts: Contacts, curve: MeasuredVelocityCurve) -> Self {
        let (free, priors) = (Vec::new(), Vec::new());
        Self { contacts, curve, reading: None, background: 0.0, offset: 0.0, free, priors }
    }

    /// The numbers to vary: names of [`MasterEquation::parameters`] but those of the initial stretches and the velocity;
    /// `background` and `offset`.
    #[must_use]
    pub fn free<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.free = names.into_iter().map(Into::into).collect();
        self
    }

    /// The standard deviation of the independent error of every reading, above 0, in place of [`MeasuredVelocityCurve::errors`].
    #[must_use]
    pub fn reading(mut self, error: f64) -> Self {
        self.reading = Some(error);
        self
    }

    /// A background force, 0 or above, which is added to the force of the contacts; 0 without this.
    #[must_use]
    pub fn background(mut self, force: f64) -> Self {
        self.background = force;
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
    pub fn curve(&self) -> &MeasuredVelocityCurve {
        &self.curve
    }

    /// The master equation of the first values, at the first velocity.
    ///
    /// # Errors
    /// No velocity; those of [`MasterEquation::at`]; stopped by the monitor.
    pub(crate) fn equation(&self, monitor: &mut dyn Monitor) -> Result<MasterEquation> {
        self.curve.check()?;
        let first = self.curve.velocities.first().copied();
        MasterEquation::reformed(self.contacts.clone(), first, monitor)
    }

    /// Checks all values.
    ///
    /// # Errors
    /// Those of [`Self::run`] that are known from the first solution; stopped by the monitor.
    pub fn check(&self, monitor: &mut dyn Monitor) -> Result<()> {
        self.check_at(&self.equation(monitor)?)
    }

    /// The same where the master equation of the first values is known.
    pub(crate) fn check_at(&self, equation: &MasterEquation) -> Result<()> {
        self.checked(equation).map(drop)
    }

    /// Finds the most probable values. A search that does not converge is reported by
    /// [`VelocityCurveEstimates::converged`].
    ///
    /// # Errors
    /// A name that is no parameter, is given twice, or none; velocities or errors that are not above 0; fewer readings than free
    /// numbers, or no more where their errors are estimated; first values of which there is no steady sliding; numbers that the
    /// curve does not determine, with the direction; errors of the solver.
    pub fn run(&self) -> Result<VelocityCurveEstimates> {
        self.run_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor.
    pub fn run_with(&self, monitor: &mut dyn Monitor) -> Result<VelocityCurveEstimates> {
        let monitor = &mut Rising::new(monitor);
        let equation = self.equation(&mut Part::new(monitor, 0.0, 0.02))?;
        let free = self.checked(&equation)?;
        let likelihood = VelocityLikelihood::new(self.clone(), free, equation);
        let starts = likelihood.first_values(&mut Part::new(monitor, 0.02, 0.18))?;
        let optimum = search_each(&likelihood, &starts, SHORT, &mut Part::new(monitor, 0.2, 0.6))?;
        VelocityCurveEstimates::new(Ended { likelihood, optimum }, &mut Part::new(monitor, 0.8, 0.2))
    }

    /// The free numbers, after all checks.
    fn checked(&self, equation: &MasterEquation) -> Result<Vec<FreeParameter>> {
        if let Some(reading) = self.reading {
            positive("reading", reading)?;
            if self.curve.errors.is_some() {
                return Err(Error::invalid("reading", "none beside the errors of the readings", reading));
            }
        }
        not_negative(BACKGROUND, self.background)?;
        finite("offset", self.offset)?;
        let free = self.free_parameters(equation)?;
        let known = self.reading.is_some() || self.curve.errors.is_some();
        let without_prior = free.iter().filter(|parameter| parameter.prior.is_none()).count();
        let least = if known { without_prior } else { free.len() + 1 };
        let n = self.curve.forces.len();
        if n < least {
            let of_errors = if known { "" } else { " and the size of their errors" };
            let expected = format!("{least} readings or more for {} free numbers{of_errors}", free.len());
            return Err(Error::invalid("force", expected, n));
        }
        Ok(free)
    }

    /// The free numbers with their priors.
    ///
    /// # Errors
    /// A name that is unknown, given twice, or without a first value above 0; none; a prior of a number that is fixed.
    fn free_parameters(&self, equation: &MasterEquation) -> Result<Vec<FreeParameter>> {
        let others = [(BACKGROUND, Role::Background, self.background), ("offset", Role::Offset, self.offset)];
        let free = named(&self.free, (equation, is_of_sliding), &others, |mut parameter| {
            let start = parameter.start;
            if parameter.logarithmic && start <= 0.0 {
                let expected = "a first value above 0 of a free number that is positive";
                return Err(Error::invalid(parameter.name, expected, start));
            }
            if let Some(scale) = self.scale(&parameter.name, equation) {
                parameter.bounds[0] = (SMALLEST * scale).min(start).ln();
            }
            Ok(parameter)
        })?;
        with_priors(free, &self.priors)
    }

    /// The scale of a number that may be 0: far below it, it has no effect, and only an upper limit of it is known.
    fn scale(&self, name: &str, equation: &MasterEquation) -> Option<f64> {
        let contacts = equation.contacts();
        let threshold = contacts.thresholds.mean();
        let fastest = self.curve.velocities.iter().copied().fold(0.0, f64::max);
        let largest = self.curve.forces.iter().map(|force| force.abs()).fold(0.0, f64::max);
        let scale = match name {
            BACKGROUND => largest,
            "ageing.growth" => 1.0,
            "temperature.energy" => {
                contacts.stiffness.mean(contacts.thresholds.as_ref()) * threshold * threshold
            }
            "delay" => threshold / fastest,
            _ => return None,
        };
        (scale > 0.0).then_some(scale)
    }
}

/// Whether steady sliding depends on a parameter of contacts, and is not what is given with the readings.
pub(crate) fn is_of_sliding(name: &str) -> bool {
    !name.starts_with("initial.") && name != "velocity"
}
