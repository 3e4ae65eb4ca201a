//! The search with modelled errors: the noise of contacts or the errors of positions, whose covariance is renewed at the estimates, and
//! drift. What an error of a position makes of the force follows from the slope of the curve (the effective variance of J. Orear,
//! Am. J. Phys. 50, 912 (1982)).

use super::ended::Ended;
use super::error_covariance::{KnownCovariance, NEGLIGIBLE};
use super::estimates::Estimates;
use super::expected::ExpectedReadings;
use super::free::{FreeParameter, first_coordinates};
use super::hierarchical::Hierarchical;
use super::likelihood::{CurvePoint, Errors, KnownErrors, LastErrors, Likelihood, LikelihoodPoint};
use super::search::{COARSE, Optimum, SHORT, search_from};
use super::{ErrorModel, Fit, Measurement};
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Times that the covariance of the contacts and the variances by errors of positions are computed again.
const RENEWALS: usize = 3;
/// It is not, where no estimate on which its shape depends has moved by this many of its errors.
const SETTLED: f64 = 0.1;
/// Readings of a curve that are enough for a first search: where their covariance has no blocks of low rank, it costs the cube of
/// their number.
const ENOUGH: usize = 200;

impl Fit {
    /// The search with modelled errors, after one with independent errors: with every s-th reading, then from there with all.
    ///
    /// # Errors
    /// Those of [`Fit::run`].
    pub(super) fn with_modelled_errors(
        &self,
        mut free: Vec<FreeParameter>,
        first: Optimum,
        monitor: &mut dyn Monitor,
    ) -> Result<Estimates> {
        let Optimum { mut coordinates, trial, mut solutions, .. } = first;
        free.extend(self.free_errors(0.02 * roughness(&trial), 0.5 * trial.reading()));
        coordinates.extend(first_coordinates(&free[coordinates.len()..]));
        let likelihood = |fit: Self| Likelihood {
            fit,
            free: free.clone(),
            errors: Errors::Modelled(None),
            smoothness: None,
            restricted: None,
        };
        let mut known: Vec<_> = trial.curves.into_iter().map(|curve| curve.readings).collect();
        let mut divided = false;
        let thinned = self.thinned();
        let share = 0.3 / thinned.len().max(1) as f64;
        for (k, fewer) in thinned.into_iter().enumerate() {
            let part = &mut Part::new(monitor, share * k as f64, share);
            let coarse = Renewed { divided, short: COARSE, renewals: 0 };
            let found = likelihood(fewer).renewed((coordinates.clone(), &known), coarse, part)?.optimum;
            solutions += found.solutions;
            if found.converged {
                known = found.trial.curves.into_iter().map(|curve| curve.readings).collect();
                (coordinates, divided) = (found.coordinates, true);
            }
        }
        let part = &mut Part::new(monitor, 0.3, 0.5);
        let last = Renewed { divided, short: SHORT, renewals: RENEWALS };
        let mut ended = likelihood(self.clone()).renewed((coordinates, &known), last, part)?;
        ended.optimum.solutions += solutions;
        ended.estimates(&mut Part::new(monitor, 0.8, 0.2))
    }

    /// The same fit to every s-th reading of each curve, where the errors are correlated: first with [`ENOUGH`] readings of each,
    /// then with some three times as many, as long as this leaves out any.
    fn thinned(&self) -> Vec<Self> {
        let fewest = self.curves.iter().map(|curve| curve.positions.len()).min().unwrap_or(0);
        let correlated = self.errors.contacts || self.errors.drift.is_some();
        let steps = std::iter::successors(correlated.then_some(fewest / ENOUGH), |step| Some(step / 3));
        let fewer = |step| Self {
            curves: self.curves.iter().map(|curve| curve.thinned(step)).collect(),
            ..self.clone()
        };
        steps.take_while(|&step| step >= 2).map(fewer).collect()
    }

    /// The covariance of the noise of contacts, or of errors of positions, where these readings are expected, if one of them is part
    /// of the errors.
    ///
    /// # Errors
    /// Those of [`crate::master::Pull::covariance`].
    pub(super) fn known_errors(
        &self,
        readings: &[ExpectedReadings],
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<KnownErrors>> {
        let ErrorModel { contacts, position, .. } = self.errors;
        if !contacts && position.is_none() {
            return Ok(None);
        }
        let share = 1.0 / readings.len() as f64;
        let tolerance = NEGLIGIBLE * self.smallest_reading().powi(2);
        let of_curve = |(c, readings): (usize, &ExpectedReadings)| {
            if let Some(std) = position {
                return Ok(KnownCovariance::Positions(readings.variances_by_positions(std)));
            }
            let part = &mut Part::new(monitor, c as f64 * share, share);
            let covariance = readings.noise(&self.curves[c], part)?;
            Ok(KnownCovariance::Contacts(Hierarchical::new(covariance.as_ref(), tolerance)))
        };
        let covariances = readings.iter().enumerate().map(of_curve).collect::<Result<_>>()?;
        let coordinates = coordinates.to_vec();
        Ok(Some(KnownErrors { covariances, coordinates, last: LastErrors::default() }))
    }

    /// Whether the covariance of the noise of contacts is in proportion to a power of this number, and nothing else depends on it.
    fn scales_noise(&self, parameter: &FreeParameter) -> bool {
        let warm = self.equation.contacts().rules.temperature.is_some();
        let alone = self.errors.position.is_none();
        alone && parameter.noise_power() != 0.0 && !(warm && parameter.quantity == "stiffness")
    }
}

/// A search with the noise of contacts at its end.
struct Renewed {
    /// Whether N⟨k⟩ is already divided into the number of contacts and their stiffness.
    divided: bool,
    /// The search ends where a step would be this short.
    short: f64,
    /// Most renewals of the noise.
    renewals: usize,
}

impl Likelihood {
    /// The search from `start`, where the contacts are those of the readings `known`, with the noise of the contacts at its end.
    ///
    /// # Errors
    /// A start where the likelihood is not defined; errors of the solver; stopped by the monitor.
    fn renewed(
        mut self,
        (start, known): (Vec<f64>, &[ExpectedReadings]),
        Renewed { divided, short, renewals }: Renewed,
        monitor: &mut dyn Monitor,
    ) -> Result<Ended<Likelihood>> {
        let mut coordinates = start;
        let mut solutions = 0;
        let mut readings = if let Some(readings) = ExpectedReadings::again(known, &self.fit.curves) {
            readings
        } else {
            solutions += 1;
            self.expected(&coordinates, &mut Part::new(monitor, 0.0, 0.1))?.ok_or_else(none)?
        };
        let mut settled = false;
        for renewal in 0..=renewals {
            let monitor = &mut Part::new(monitor, 0.1 + 0.2 * renewal as f64, 0.2);
            let part = &mut Part::new(monitor, 0.0, 0.2);
            if !settled {
                self.errors = Errors::Modelled(self.fit.known_errors(&readings, &coordinates, part)?);
            }
            if renewal == 0 && !divided && self.divide_noise(&mut coordinates, &readings) {
                let part = &mut Part::new(monitor, 0.2, 0.1);
                readings = self.expected(&coordinates, part)?.ok_or_else(none)?;
                solutions += 1;
            }
            let trial = self.at_readings(&coordinates, readings).ok_or_else(none)?;
            let held = vec![false; coordinates.len()];
            let part = &mut Part::new(monitor, 0.3, 0.7);
            let mut found = search_from(&self, (&coordinates, trial), (&held, short), part)?;
            solutions += found.solutions;
            settled = self.has_settled(&found);
            let restricted = self.restricted.is_some() || !self.estimates_errors();
            if renewal == renewals || !found.converged || (settled && restricted) {
                found.solutions = solutions;
                return Ok(Ended { likelihood: self, optimum: found });
            }
            self.restrict(&found.coordinates, &found.trial, &mut Part::new(monitor, 1.0, 0.0))?;
            readings = found.trial.curves.into_iter().map(|curve| curve.readings).collect();
            coordinates = found.coordinates;
        }
        unreachable!("the last renewal returns")
    }

    /// Divides N⟨k⟩ anew where both are free for each curve, so that the noise of contacts is as large as the residuals; whether it has.
    fn divide_noise(&self, coordinates: &mut [f64], readings: &[ExpectedReadings]) -> bool {
        let Errors::Modelled(Some(known)) = &self.errors else { return false };
        if !self.divides_all_noise() {
            return false;
        }
        let trace = |known: &KnownCovariance| match known {
            KnownCovariance::Contacts(covariance) => covariance.diagonal().iter().sum::<f64>(),
            KnownCovariance::None | KnownCovariance::Positions(_) => 0.0,
        };
        let expected: f64 = known.covariances.iter().map(trace).sum();
        let squares = |(readings, measured): (&ExpectedReadings, &Measurement)| {
            let residuals = measured.forces.iter().zip(&readings.forces);
            residuals.map(|(measured, expected)| (measured - expected).powi(2)).sum::<f64>()
        };
        let ratio = readings.iter().zip(&self.fit.curves).map(squares).sum::<f64>() / expected;
        let divides = ratio.is_finite() && ratio > 0.0;
        if divides {
            for (coordinate, parameter) in coordinates.iter_mut().zip(&self.free) {
                *coordinate += match parameter.quantity.as_str() {
                    "count" => -ratio.ln(),
                    "stiffness" => ratio.ln(),
                    _ => 0.0,
                };
            }
        }
        divides
    }

    /// Whether the noise of contacts is that at the end of a search, but for a factor.
    fn has_settled(&self, found: &Optimum) -> bool {
        let Errors::Modelled(Some(known)) = &self.errors else { return true };
        let moved = found.coordinates.iter().zip(&known.coordinates).enumerate();
        moved
            .filter(|(k, _)| !self.free[*k].is_of_errors() && !self.fit.scales_noise(&self.free[*k]))
            .map(|(k, (u, before))| (u - before).abs() * found.score.information[(k, k)].sqrt())
            .all(|errors| errors < SETTLED)
    }
}

/// The error of a start where the likelihood is not defined.
fn none() -> Error {
    let expected = "first values with positive definite errors, and from which a curve follows";
    Error::invalid("free", expected, "none at those of the fit with independent errors")
}

/// The size of independent errors, from the second differences of the residuals.
fn roughness(trial: &LikelihoodPoint) -> f64 {
    let of_curve = |curve: &CurvePoint| {
        let r = &curve.residuals;
        let second = |i: usize| r[(i, 0)] - 2.0 * r[(i + 1, 0)] + r[(i + 2, 0)];
        let squares: f64 = (0..r.nrows().saturating_sub(2)).map(|i| second(i).powi(2)).sum();
        (squares, r.nrows().saturating_sub(2))
    };
    let (squares, n) =
        trial.curves.iter().map(of_curve).fold((0.0, 0), |all, one| (all.0 + one.0, all.1 + one.1));
    if n == 0 { 0.0 } else { (squares / (6.0 * n as f64)).sqrt() }
}
