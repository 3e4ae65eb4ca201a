//! The likelihood of a measured curve, its slope and the expected information.

use faer::Mat;

use super::Fit;
use super::error_covariance::{ErrorCovariance, ErrorPart, ErrorSizes};
use super::expected::ExpectedReadings;
use super::free::{FreeParameter, Role};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Smallest error of a reading, in multiples of the largest force: below it are errors of the solution and of its derivatives,
/// which are not normal.
const UNREAD: f64 = 1e-8;

/// The likelihood of a measured curve as a function of the coordinates of the free numbers.
#[derive(Debug)]
pub(super) struct Likelihood {
    pub fit: Fit,
    pub free: Vec<FreeParameter>,
    pub errors: Errors,
}

/// How the errors of readings are known.
#[derive(Debug)]
pub(super) enum Errors {
    /// Independent, of one unknown size: the most probable one at each values of the other numbers.
    ProfiledWhite,
    /// Of the sizes of the model, some of which may be free.
    Modelled(Option<ContactNoise>),
}

/// The covariance of the noise of contacts, as it is at some values of the free numbers. Elsewhere it is scaled by N⟨k⟩².
#[derive(Debug)]
pub(super) struct ContactNoise {
    pub covariance: Mat<f64>,
    pub coordinates: Vec<f64>,
}

/// A point of the likelihood.
#[derive(Debug)]
pub(super) struct LikelihoodPoint {
    pub readings: ExpectedReadings,
    pub covariance: ErrorCovariance,
    /// Measured minus expected forces, as a column.
    pub residuals: Mat<f64>,
    /// The same whitened: L⁻¹r.
    pub whitened: Mat<f64>,
    pub sizes: ErrorSizes,
    /// −2 ln L, priors included.
    pub deviance: f64,
}

/// Derivatives of half the deviance.
#[derive(Debug)]
pub(super) struct Score {
    pub slope: Mat<f64>,
    /// The expected information.
    pub information: Mat<f64>,
}

impl Likelihood {
    /// The values at coordinates.
    pub fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        self.free.iter().zip(coordinates).map(|(parameter, &u)| parameter.value(u)).collect()
    }

    /// The likelihood at coordinates; `None` where it is 0 or not defined, such as beyond the range of a number.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<LikelihoodPoint>> {
        let values = self.values(coordinates);
        let (measurement, free) = (&self.fit.measurement, &self.free);
        let readings =
            match ExpectedReadings::new((&self.fit.equation, measurement), (free, &values), monitor) {
                Err(Error::Invalid { .. } | Error::TooLarge { .. }) => return Ok(None),
                readings => readings?,
            };
        let Some(readings) = readings else { return Ok(None) };
        let n = measurement.positions.len();
        let residual = |i: usize| measurement.forces.get(i).map_or(0.0, |force| force - readings.forces[i]);
        let residuals = Mat::from_fn(n, 1, |i, _| residual(i));
        let sizes = self.sizes(coordinates, &residuals);
        let noise = match &self.errors {
            Errors::Modelled(noise) => noise.as_ref().map(|noise| &noise.covariance),
            Errors::ProfiledWhite => None,
        };
        let Some(covariance) = ErrorCovariance::new(&measurement.positions, noise, sizes) else {
            return Ok(None);
        };
        let mut whitened = residuals.clone();
        covariance.whiten(&mut whitened);
        let deviance = whitened.squared_norm_l2()
            + covariance.log_determinant(n)
            + n as f64 * std::f64::consts::TAU.ln()
            + self.prior(coordinates);
        let trial = LikelihoodPoint { readings, covariance, residuals, whitened, sizes, deviance };
        Ok(deviance.is_finite().then_some(trial))
    }

    /// The sizes of errors at coordinates.
    fn sizes(&self, coordinates: &[f64], residuals: &Mat<f64>) -> ErrorSizes {
        let value = |role: Role| {
            let found = self.free.iter().zip(coordinates).find(|(parameter, _)| parameter.role == role);
            found.map(|(parameter, &u)| parameter.value(u))
        };
        let n = residuals.nrows() as f64;
        let smallest = UNREAD * self.fit.measurement.scale();
        let reading = match self.errors {
            Errors::ProfiledWhite => residuals.norm_l2() / n.sqrt(),
            Errors::Modelled(_) => value(Role::Reading).or(self.fit.errors.reading).unwrap_or(0.0),
        };
        ErrorSizes {
            noise: self.noise_factor(coordinates),
            reading: reading.max(smallest),
            drift: [value(Role::DriftAmplitude).unwrap_or(0.0), value(Role::DriftLength).unwrap_or(1.0)],
        }
    }

    /// Factor of the covariance of the noise of contacts.
    fn noise_factor(&self, coordinates: &[f64]) -> f64 {
        let Errors::Modelled(Some(noise)) = &self.errors else { return 0.0 };
        let powers = self.free.iter().map(FreeParameter::noise_power);
        let moved = coordinates.iter().zip(&noise.coordinates).map(|(u, before)| u - before);
        powers
            .zip(moved)
            .map(|(power, moved)| if power == 0.0 { 0.0 } else { power * moved })
            .sum::<f64>()
            .exp()
    }

    /// Σ(u − m)²/s² over the priors.
    fn prior(&self, coordinates: &[f64]) -> f64 {
        let known = self.free.iter().zip(coordinates);
        known.filter_map(|(parameter, u)| parameter.prior.map(|[mean, std]| ((u - mean) / std).powi(2))).sum()
    }

    /// The slope and the information at a point.
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
        let measured = &self.fit.measurement.positions;
        let values = self.values(coordinates);
        let mut derivatives = trial.readings.derivatives(measured, (&self.free, &values), monitor)?;
        trial.covariance.whiten(&mut derivatives);
        let mut slope = derivatives.transpose() * &trial.whitened * faer::Scale(-1.0);
        let mut information = derivatives.transpose() * &derivatives;
        let shares = self.shares();
        if !shares.is_empty() {
            let mut parts: Vec<ErrorPart> = shares.iter().map(|share| share.1).collect();
            parts.dedup();
            let of_errors = trial.covariance.derivatives(measured, &parts, &trial.residuals);
            let number = |part: ErrorPart| parts.iter().position(|other| *other == part).unwrap_or(0);
            for &(a, part, power) in &shares {
                slope[(a, 0)] += power * of_errors.slope[number(part)];
                for &(b, other, other_power) in &shares {
                    information[(a, b)] +=
                        power * other_power * of_errors.information[(number(part), number(other))];
                }
            }
        }
        for (k, (parameter, u)) in self.free.iter().zip(coordinates).enumerate() {
            if let Some([mean, std]) = parameter.prior {
                slope[(k, 0)] += (u - mean) / (std * std);
                information[(k, k)] += 1.0 / (std * std);
            }
        }
        Ok(Score { slope, information })
    }

    /// Which free numbers change which part of Σ, and by which power of its size; sorted by part.
    fn shares(&self) -> Vec<(usize, ErrorPart, f64)> {
        let Errors::Modelled(noise) = &self.errors else { return Vec::new() };
        let of = |part: ErrorPart, role: Role| {
            let found = self.free.iter().position(|parameter| parameter.role == role);
            found.map(|k| (k, part, 1.0))
        };
        let noisy = self.free.iter().enumerate().filter(|(_, parameter)| parameter.noise_power() != 0.0);
        let noisy = noisy.map(|(k, parameter)| (k, ErrorPart::Noise, parameter.noise_power()));
        noisy
            .filter(|_| noise.is_some())
            .chain(of(ErrorPart::Reading, Role::Reading))
            .chain(of(ErrorPart::DriftAmplitude, Role::DriftAmplitude))
            .chain(of(ErrorPart::DriftLength, Role::DriftLength))
            .collect()
    }
}
