//! `[fit.velocity_curve]`: forces of steady sliding at several velocities, instead of a loading curve.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fit::FitKeys;
use super::{Compare, Fit, FitSource, Model, Scenario, Start, VelocityCurve};
use crate::fit::{MeasuredVelocityCurve, VelocityCurveFit, is_of_sliding};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Forces of steady sliding at several velocities give the numbers in `fit.free`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct FitVelocityCurve {
    /// Measured forces, CSV with columns `velocity,force`, or `velocity,force,error`; its path is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The file that the forces were read from; results state it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<FitSource>,
    /// Velocities of the slider, above 0, in any order and as often as each was measured, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub velocity: Option<Vec<f64>>,
    /// Measured forces, each the mean over a distance of steady sliding, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
    /// Standard deviations of the independent errors of the forces, above 0; without them all errors have one size, `fit.reading`,
    /// which is estimated where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub error: Option<Vec<f64>>,
}

impl FitVelocityCurve {
    /// The measured curve.
    ///
    /// # Errors
    /// A file that was not read; no velocities, or no forces.
    pub(crate) fn measured(&self) -> Result<MeasuredVelocityCurve> {
        if self.file.is_some() {
            let expected = "either a file, or the lists velocity and force";
            return Err(Error::invalid("file", expected, "both"));
        }
        let list = |key: &'static str, list: &Option<Vec<f64>>| {
            list.clone().ok_or_else(|| Error::invalid(key, "the list, or a file", "none"))
        };
        Ok(MeasuredVelocityCurve {
            velocities: list("velocity", &self.velocity)?,
            forces: list("force", &self.force)?,
            errors: self.error.clone(),
        })
    }
}

impl Fit {
    /// Checks the values that forces at several velocities have in common with a curve, and that none of a curve only is given.
    ///
    /// # Errors
    /// The first invalid value.
    pub(super) fn check_velocity_curve(&self, curve: &FitVelocityCurve) -> Result<()> {
        self.refuse_of_curves("velocity_curve")?;
        if let Some(velocity) = self.velocity {
            return Err(Error::invalid(
                "velocity",
                "none beside fit.velocity_curve, which has its own",
                velocity,
            ));
        }
        if self.start != Start::Conditional {
            let expected = "none beside fit.velocity_curve: steady sliding does not depend on it";
            return Err(Error::invalid("start", expected, "relaxed"));
        }
        self.check_posterior()?;
        curve.measured().map_err(|error| error.under("velocity_curve")).map(drop)
    }

    /// The fit of the core to forces at several velocities, ready to run, and the keys of its numbers; `None` for another
    /// measurement.
    ///
    /// # Errors
    /// A key that is no number of steady sliding, background or offset; a prior of another one; those of
    /// [`VelocityCurveFit::check`].
    pub(crate) fn prepare_velocity_curve(
        &self,
        model: &Model,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(VelocityCurveFit, FitKeys)>> {
        let Some(curve) = &self.velocity_curve else { return Ok(None) };
        if model.initial.law.quantile(1.0) > 0.0 {
            let expected = "point = { at = 0.0 }, the default, beside fit.velocity_curve: steady sliding does not depend on it";
            return Err(Error::invalid("initial", expected, "another law"));
        }
        Self::refuse_truncated(model)?;
        let curve = curve.measured().map_err(|error| error.under("fit.velocity_curve"))?;
        let mut fit = VelocityCurveFit::new(model.contacts.clone(), curve)
            .background(model.background)
            .offset(self.offset);
        let equation = fit.equation(monitor).map_err(Self::keyed_velocity_curve)?;
        let of_curves = ["compliance", "trend", "origin"];
        let of_sliding = |name: &str| is_of_sliding(name) && !of_curves.contains(&name);
        let keys = FitKeys::new(model, &equation).only(of_sliding);
        fit = fit.free(self.names(&keys)?);
        if let Some(reading) = self.reading {
            fit = fit.reading(reading);
        }
        for (name, prior) in self.priors(&keys)? {
            fit = fit.prior(&name, prior);
        }
        fit.check_at(&equation).map_err(Self::keyed_velocity_curve)?;
        Ok(Some((fit, keys)))
    }

    /// An error of a fit to forces at several velocities, with the key that gave its argument.
    pub(crate) fn keyed_velocity_curve(error: Error) -> Error {
        const OF_CURVE: [&str; 3] = ["velocity", "force", "error"];
        match &error {
            Error::Invalid { key, .. } if OF_CURVE.contains(&key.split('.').next().unwrap_or_default()) => {
                error.under("fit.velocity_curve")
            }
            Error::Invalid { key, .. } if key == "offset" => error.under("fit"),
            _ => Self::keyed(error),
        }
    }
}

impl Scenario {
    /// The same scenario with other values of some of its numbers, by their keys, and with a `[velocity_curve]` over the measured
    /// velocities instead of the fit, compared with the measured forces without `offset`.
    pub fn fitted_velocity_curve(&self, values: &[(String, f64)], offset: f64) -> Self {
        let measured = self.fit.as_ref().and_then(|fit| fit.velocity_curve.as_ref()?.measured().ok());
        let mut fitted = self.fitted(values, (0, 0.0), None);
        fitted.pull = None;
        let Some(MeasuredVelocityCurve { velocities, forces, .. }) = measured else { return fitted };
        let low = velocities.iter().copied().fold(f64::INFINITY, f64::min);
        let high = velocities.iter().copied().fold(0.0, f64::max);
        fitted.velocity_curve = Some(if low < high {
            VelocityCurve::between(low, high)
        } else {
            VelocityCurve {
                from: None,
                to: None,
                velocities: Some(vec![low]),
                ..VelocityCurve::between(low, low)
            }
        });
        fitted.compare = Some(Compare {
            velocity: Some(velocities),
            force: Some(forces.iter().map(|force| force - offset).collect()),
            ..Compare::default()
        });
        fitted
    }
}
