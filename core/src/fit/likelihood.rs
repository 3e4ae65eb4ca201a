//! The likelihood of measured curves, its slope and the expected information. Errors of different curves are independent.

use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;

use super::Fit;
use super::error_covariance::{ErrorCovariance, ErrorPart, ErrorSizes, KnownCovariance, trace_of_product};
use super::expected::{self, ExpectedReadings};
use super::free::{FreeParameter, Role, UNREAD, priors_at, value_of, values_at};
use super::matrix::product;
use super::restricted::Restricted;
use super::score::Score;
use super::smoothness::Smoothness;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// The likelihood of the measured curves as a function of the coordinates of the free numbers.
#[derive(Debug)]
pub(super) struct Likelihood {
    pub fit: Fit,
    pub free: Vec<FreeParameter>,
    pub errors: Errors,
    /// What is known beforehand of thresholds of free form.
    pub smoothness: Option<Smoothness>,
    /// The term of the restricted likelihood, by which a search finds free sizes of errors.
    pub restricted: Option<Restricted>,
}

/// How the errors of readings are known.
#[derive(Debug)]
pub(super) enum Errors {
    /// Independent, of one unknown size: for any values of the other numbers that of the highest restricted likelihood, σ² =
    /// Σr²/(n − p), where p numbers of the curve are `fitted`, those with priors among them. Without priors ln |M| is −p ln σ² but
    /// for what does not change with σ.
    ProfiledWhite { fitted: f64 },
    /// Independent, of this standard deviation, σ² = Σr²/(n − p) for p `fitted` numbers, which is renewed between searches: thresholds
    /// of free form can follow all readings of a short record, so that ln Σr² has no minimum.
    RenewedWhite { reading: f64, fitted: f64 },
    /// Of the sizes of the model, some of which may be free.
    Modelled(Option<KnownErrors>),
}

impl Errors {
    /// Whether the noise of contacts is part of them.
    pub fn have_contacts(&self) -> bool {
        let Self::Modelled(Some(known)) = self else { return false };
        matches!(known.covariances.as_slice(), [KnownCovariance::Contacts(_), ..])
    }
}

/// The covariance of the noise of contacts in each curve, or the variances that errors of the positions make, as they are at some
/// values of the free numbers. Elsewhere the former is scaled by N⟨k⟩², the latter stay.
#[derive(Debug)]
pub(super) struct KnownErrors {
    pub covariances: Vec<KnownCovariance>,
    pub coordinates: Vec<f64>,
    pub last: LastErrors,
}

/// The last covariance of the errors of each curve. Where only the curves change, as from a straight one to the true one, the next
/// is the same.
#[derive(Debug, Default)]
pub(super) struct LastErrors(Mutex<Vec<(usize, ErrorSizes, Arc<ErrorCovariance>)>>);

impl LastErrors {
    /// The covariance of the errors of these sizes in a curve: the last one, or one that is made.
    fn of(
        &self,
        (curve, sizes): (usize, ErrorSizes),
        made: impl FnOnce() -> Option<ErrorCovariance>,
    ) -> Option<Arc<ErrorCovariance>> {
        let last = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = last().iter().find(|(c, of, _)| *c == curve && *of == sizes).map(|last| last.2.clone());
        if same.is_some() {
            return same;
        }
        let covariance = Arc::new(made()?);
        let mut last = last();
        last.retain(|(c, ..)| *c != curve);
        last.push((curve, sizes, covariance.clone()));
        Some(covariance)
    }
}

/// A point of the likelihood.
#[derive(Debug)]
pub(super) struct LikelihoodPoint {
    /// What belongs to each curve.
    pub curves: Vec<CurvePoint>,
    /// −2 ln L, priors included.
    pub deviance: f64,
    /// What the restricted likelihood adds to it.
    pub restriction: f64,
}

/// The part of one curve in a point of the likelihood.
#[derive(Debug)]
pub(super) struct CurvePoint {
    pub readings: ExpectedReadings,
    pub covariance: Arc<ErrorCovariance>,
    /// Measured minus expected forces, as a column.
    pub residuals: Mat<f64>,
    /// The same whitened: L⁻¹r.
    pub whitened: Mat<f64>,
    pub sizes: ErrorSizes,
}

impl LikelihoodPoint {
    /// What a search makes as low as possible.
    pub fn restricted_deviance(&self) -> f64 {
        self.deviance + self.restriction
    }

    /// The covariance of the errors of each curve.
    fn covariances(&self) -> impl Iterator<Item = &ErrorCovariance> {
        self.curves.iter().map(|curve| &*curve.covariance)
    }

    /// rᵀΣ⁻¹r.
    pub fn chi_squared(&self) -> f64 {
        self.curves.iter().map(|curve| curve.whitened.squared_norm_l2()).sum()
    }

    /// The standard deviation of the independent error of a reading.
    pub fn reading(&self) -> f64 {
        self.curves[0].sizes.reading
    }
}

impl Likelihood {
    /// Number of readings.
    pub fn count(&self) -> usize {
        self.fit.curves.iter().map(|curve| curve.positions.len()).sum()
    }

    /// Number of free numbers; of thresholds of free form, as many as the curve determines at this information. The common level of
    /// their coefficients changes nothing.
    pub fn determined(&self, information: &Mat<f64>, at_bound: &[bool]) -> f64 {
        let penalised =
            self.smoothness.as_ref().map_or(0.0, |smoothness| smoothness.known(information, at_bound));
        self.free.len() as f64 - penalised
    }

    /// The likelihood at coordinates; `None` where it is 0 or not defined, such as beyond the range of a number.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<LikelihoodPoint>> {
        let readings = self.expected(coordinates, monitor)?;
        Ok(readings.and_then(|readings| self.at_readings(coordinates, readings)))
    }

    /// The readings expected at coordinates; `None` beyond the range of a number, or where the machine slips.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn expected(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<ExpectedReadings>>> {
        let values = values_at(&self.free, coordinates);
        let numbers = (self.free.as_slice(), values.as_slice());
        match expected::expected_readings((&self.fit.equation, &self.fit.curves), numbers, monitor) {
            Err(Error::Invalid { .. } | Error::TooLarge { .. }) => Ok(None),
            readings => readings,
        }
    }

    /// The likelihood at coordinates where these readings are expected; `None` where it is 0 or not defined.
    pub fn at_readings(
        &self,
        coordinates: &[f64],
        readings: Vec<ExpectedReadings>,
    ) -> Option<LikelihoodPoint> {
        let mut point = self.with_fitted((coordinates, self.fitted()), readings)?;
        if let Some(restricted) = &self.restricted {
            point.restriction += restricted.log_determinant(point.covariances())?;
        }
        point.restriction.is_finite().then_some(point)
    }

    /// The number of fitted numbers, where errors are independent and of one unknown size.
    fn fitted(&self) -> f64 {
        if let Errors::ProfiledWhite { fitted } = self.errors { fitted } else { 0.0 }
    }

    /// The likelihood at coordinates without what the restricted one adds, where errors of one unknown size have their most probable
    /// one; `None` where it is 0 or not defined.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn unrestricted_trial(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<LikelihoodPoint>> {
        let readings = self.expected(coordinates, monitor)?;
        Ok(readings.and_then(|readings| self.with_fitted((coordinates, 0.0), readings)))
    }

    fn with_fitted(
        &self,
        (coordinates, fitted): (&[f64], f64),
        readings: Vec<ExpectedReadings>,
    ) -> Option<LikelihoodPoint> {
        let residuals: Vec<Mat<f64>> = readings
            .iter()
            .zip(&self.fit.curves)
            .map(|(readings, measured)| {
                let residual =
                    |i: usize| measured.forces.get(i).map_or(0.0, |force| force - readings.forces[i]);
                Mat::from_fn(measured.positions.len(), 1, |i, _| residual(i))
            })
            .collect();
        let reading = self.reading((coordinates, fitted), &residuals);
        let points = readings.into_iter().zip(residuals).enumerate();
        let points = points.map(|(c, (readings, residuals))| {
            let sizes = self.sizes((c, coordinates), reading);
            self.point((c, readings), residuals, sizes)
        });
        let points = points.collect::<Option<Vec<CurvePoint>>>()?;
        let of_curve = |point: &CurvePoint| {
            let n = point.residuals.nrows();
            point.whitened.squared_norm_l2()
                + point.covariance.log_determinant(n)
                + n as f64 * std::f64::consts::TAU.ln()
        };
        let sum = points.iter().map(of_curve).sum::<f64>() + self.prior(coordinates);
        let n = self.count() as f64;
        // n ln Σr²/n + n in place of n ln Σr²/(n − p) + n − p, if Σr² is not of rounding.
        let lower = if reading > self.least_reading() { n * (-fitted / n).ln_1p() + fitted } else { 0.0 };
        let deviance = sum + lower;
        let restriction = -lower - 2.0 * fitted * reading.ln();
        deviance.is_finite().then_some(LikelihoodPoint { curves: points, deviance, restriction })
    }

    /// The part of curve `curve`; `None` where its covariance is not positive definite.
    fn point(
        &self,
        (curve, readings): (usize, ExpectedReadings),
        residuals: Mat<f64>,
        sizes: ErrorSizes,
    ) -> Option<CurvePoint> {
        let measured = &self.fit.curves[curve];
        let covariance = match &self.errors {
            Errors::Modelled(Some(known)) => {
                let made = || ErrorCovariance::new(measured, &known.covariances[curve], sizes);
                known.last.of((curve, sizes), made)?
            }
            Errors::Modelled(None) | Errors::ProfiledWhite { .. } | Errors::RenewedWhite { .. } => {
                Arc::new(ErrorCovariance::new(measured, &KnownCovariance::None, sizes)?)
            }
        };
        let mut whitened = residuals.clone();
        covariance.whiten(&mut whitened);
        Some(CurvePoint { readings, covariance, residuals, whitened, sizes })
    }

    /// The standard deviation of the independent error of a reading at coordinates.
    fn reading(&self, (coordinates, fitted): (&[f64], f64), residuals: &[Mat<f64>]) -> f64 {
        let reading = match self.errors {
            Errors::ProfiledWhite { .. } => {
                let squares: f64 = residuals.iter().map(|r| r.squared_norm_l2()).sum();
                (squares / (self.count() as f64 - fitted)).sqrt()
            }
            Errors::RenewedWhite { reading, .. } => reading,
            Errors::Modelled(_) => {
                value_of(&self.free, Role::Reading, coordinates).or(self.fit.errors.reading).unwrap_or(0.0)
            }
        };
        reading.max(self.least_reading())
    }

    /// The smallest one that is tried.
    pub fn least_reading(&self) -> f64 {
        UNREAD * self.fit.scale()
    }

    /// The sizes of errors of a curve at coordinates.
    fn sizes(&self, (curve, coordinates): (usize, &[f64]), reading: f64) -> ErrorSizes {
        let drift = |role| value_of(&self.free, role, coordinates);
        ErrorSizes {
            noise: self.noise_factor(curve, coordinates),
            reading,
            drift: [drift(Role::DriftAmplitude).unwrap_or(0.0), drift(Role::DriftLength).unwrap_or(1.0)],
        }
    }

    /// Factor of the covariance of the noise of contacts in a curve.
    fn noise_factor(&self, curve: usize, coordinates: &[f64]) -> f64 {
        let Errors::Modelled(Some(known)) = &self.errors else { return 0.0 };
        let moved = coordinates.iter().zip(&known.coordinates).map(|(u, before)| u - before);
        self.free
            .iter()
            .zip(moved)
            .filter(|(parameter, _)| parameter.noise_power() != 0.0 && parameter.applies_to(curve))
            .map(|(parameter, moved)| parameter.noise_power() * moved)
            .sum::<f64>()
            .exp()
    }

    /// Σ(u − m)²/s² over the priors, and the penalty of a free form.
    fn prior(&self, coordinates: &[f64]) -> f64 {
        priors_at(&self.free, coordinates)
            + self.smoothness.as_ref().map_or(0.0, |smoothness| smoothness.penalty(coordinates))
    }

    /// The slope and the information at a point, those of the restriction included.
    ///
    /// With J = ∂F/∂u and the errors' part, see [`super::error_covariance::CovarianceDerivatives`]: the slope of half the
    /// deviance is −JᵀΣ⁻¹r + ½(tr Σ⁻¹Σ_u − rᵀΣ⁻¹Σ_uΣ⁻¹r), the information JᵀΣ⁻¹J + ½ tr Σ⁻¹Σ_uΣ⁻¹Σ_v.
    ///
    /// # Errors
    /// Those of [`crate::master::Pull::gradients`].
    pub fn score(
        &self,
        coordinates: &[f64],
        trial: &LikelihoodPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<Score> {
        let derivatives = self.derivatives(coordinates, trial, monitor)?;
        Ok(self.score_by(derivatives, (coordinates, trial)))
    }

    /// The derivatives of the readings of each curve by the coordinates, at a point.
    ///
    /// # Errors
    /// As [`Self::score`].
    pub fn derivatives(
        &self,
        coordinates: &[f64],
        trial: &LikelihoodPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Mat<f64>>> {
        let values = values_at(&self.free, coordinates);
        let numbers = (self.free.as_slice(), values.as_slice());
        let readings: Vec<&ExpectedReadings> = trial.curves.iter().map(|curve| &curve.readings).collect();
        expected::derivatives((&readings, &self.fit.curves), numbers, monitor)
    }

    /// The slope and the information at a point where the readings have these derivatives.
    pub fn score_by(&self, derivatives: Vec<Mat<f64>>, at: (&[f64], &LikelihoodPoint)) -> Score {
        let mut score = self.unrestricted_score(derivatives, at);
        self.add_restriction(at.1, &mut score);
        score
    }

    /// Those of −2 ln L alone.
    pub fn unrestricted_score(
        &self,
        derivatives: Vec<Mat<f64>>,
        (coordinates, trial): (&[f64], &LikelihoodPoint),
    ) -> Score {
        let count = self.free.len();
        let (mut slope, mut information) = (Mat::zeros(count, 1), Mat::zeros(count, count));
        for (c, (point, mut derivatives)) in trial.curves.iter().zip(derivatives).enumerate() {
            point.covariance.whiten(&mut derivatives);
            slope -= product(derivatives.transpose(), point.whitened.as_ref());
            information += product(derivatives.transpose(), derivatives.as_ref());
            self.add_errors((c, point), &mut slope, &mut information);
        }
        let mut score = Score { slope, information };
        score.add_priors(&self.free, coordinates);
        if let Some(smoothness) = &self.smoothness {
            smoothness.add(coordinates, &mut score.slope, &mut score.information);
        }
        score
    }

    /// Whether sizes of errors are free beside the curve: those of readings and drift, or N and ⟨k⟩ at a given N⟨k⟩.
    pub fn estimates_errors(&self) -> bool {
        let noisy =
            |curve: usize| self.shares(curve).iter().filter(|share| share.1 == ErrorPart::Noise).count();
        self.free.iter().any(FreeParameter::is_of_errors)
            || (0..self.fit.curves.len()).any(|curve| noisy(curve) == 2)
    }

    /// Whether free numbers change the errors.
    pub fn has_free_errors(&self) -> bool {
        (0..self.fit.curves.len()).any(|curve| !self.shares(curve).is_empty())
    }

    /// Adds what the sizes of the errors of a curve contribute to the slope and to the information.
    fn add_errors(
        &self,
        (curve, point): (usize, &CurvePoint),
        slope: &mut Mat<f64>,
        information: &mut Mat<f64>,
    ) {
        let shares = self.shares(curve);
        if shares.is_empty() {
            return;
        }
        let mut parts: Vec<ErrorPart> = shares.iter().map(|share| share.1).collect();
        parts.dedup();
        let measured = &self.fit.curves[curve];
        let of_errors = point.covariance.derivatives(measured, &parts, &point.residuals);
        let number = |part: ErrorPart| parts.iter().position(|other| *other == part).unwrap_or(0);
        for &(a, part, power) in &shares {
            slope[(a, 0)] += power * of_errors.slope[number(part)];
            for &(b, other, other_power) in &shares {
                information[(a, b)] +=
                    power * other_power * of_errors.information[(number(part), number(other))];
            }
        }
    }

    /// Adds what the restricted likelihood contributes. With Z = Σ⁻¹JL⁻ᵀ, M = LLᵀ: the slope of ½ ln |M| is −½ tr ZᵀΣ_uZ, and
    /// the information changes by −tr ZᵀΣ_uΣ⁻¹Σ_vZ + ½ tr ZᵀΣ_uZ ZᵀΣ_vZ, to ½ tr PΣ_uPΣ_v with P = Σ⁻¹ − ZZᵀ.
    fn add_restriction(&self, trial: &LikelihoodPoint, score: &mut Score) {
        let Some(restricted) = &self.restricted else { return };
        let Some(standardised) = restricted.standardised(trial.covariances()) else { return };
        let count = standardised[0].ncols();
        let mut changes = vec![Mat::zeros(count, count); self.free.len()];
        for (c, (point, derivatives)) in trial.curves.iter().zip(&standardised).enumerate() {
            let shares = self.shares(c);
            let mut parts: Vec<ErrorPart> = shares.iter().map(|share| share.1).collect();
            parts.dedup();
            let along = point.covariance.along_curve(&self.fit.curves[c], &parts, derivatives);
            let number = |part: ErrorPart| parts.iter().position(|other| *other == part).unwrap_or(0);
            for &(a, part, power) in &shares {
                changes[a] += &along.changes[number(part)] * faer::Scale(power);
                for &(b, other, other_power) in &shares {
                    let trace = along.traces[(number(part), number(other))];
                    score.information[(a, b)] -= power * other_power * trace;
                }
            }
        }
        for (a, of) in changes.iter().enumerate() {
            score.slope[(a, 0)] -= 0.5 * (0..count).map(|i| of[(i, i)]).sum::<f64>();
            for (b, other) in changes.iter().enumerate() {
                score.information[(a, b)] += 0.5 * trace_of_product(of, other);
            }
        }
    }

    /// The restricted likelihood with the derivatives of the curves at a point, where sizes of errors are free.
    ///
    /// # Errors
    /// As [`Self::score`].
    pub fn restrict(
        &mut self,
        coordinates: &[f64],
        trial: &LikelihoodPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        if self.estimates_errors() {
            let derivatives = self.derivatives(coordinates, trial, monitor)?;
            let precision = |parameter: &FreeParameter| {
                let prior = parameter.prior.filter(|_| !parameter.is_of_errors());
                prior.map_or(0.0, |[_, std]| 1.0 / (std * std))
            };
            let precision: Vec<f64> = self.free.iter().map(precision).collect();
            self.restricted = Restricted::new(derivatives, trial.covariances(), &precision);
        }
        Ok(())
    }

    /// Which free numbers change which part of Σ of a curve, and by which power of its size; sorted by part.
    fn shares(&self, curve: usize) -> Vec<(usize, ErrorPart, f64)> {
        if !matches!(self.errors, Errors::Modelled(_)) {
            return Vec::new();
        }
        let of = |part: ErrorPart, role: Role| {
            let found = self.free.iter().position(|parameter| parameter.role == role);
            found.map(|k| (k, part, 1.0))
        };
        let noisy = self.free.iter().enumerate();
        let noisy = noisy
            .filter(|(_, parameter)| parameter.noise_power() != 0.0 && parameter.applies_to(curve))
            .map(|(k, parameter)| (k, ErrorPart::Noise, parameter.noise_power()));
        noisy
            .filter(|_| self.errors.have_contacts())
            .chain(of(ErrorPart::Reading, Role::Reading))
            .chain(of(ErrorPart::DriftAmplitude, Role::DriftAmplitude))
            .chain(of(ErrorPart::DriftLength, Role::DriftLength))
            .collect()
    }
}
