//! `[fit.steady]`: a record of the force in steady sliding, instead of a loading curve.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fit::FitKeys;
use super::{Fit, FitNoise, FitSource, FitThresholds, Model, Scenario, Spectrum, exactly_one, positive};
use crate::fit::{SteadyFit, SteadyRecord};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A record of the force in steady sliding: its mean and its noise, instead of a curve, give the numbers in `fit.free`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct FitSteady {
    /// Measured record, CSV with columns `position,force` at equal steps, or a column `force` with `fit.steady.spacing`; its path
    /// is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The file that the record was read from; results state it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<FitSource>,
    /// Positions of the slider at the readings, rising in equal steps, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub position: Option<Vec<f64>>,
    /// Displacement of the slider from one reading to the next, above 0; required where no positions are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub spacing: Option<f64>,
    /// Measured forces, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
}

impl FitSteady {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        if self.file.is_some() {
            return Err(Error::invalid("file", "a record read from it", "an unread file"));
        }
        let given = [("position", self.position.is_some()), ("spacing", self.spacing.is_some())];
        exactly_one("", "one of position and spacing", &given)?;
        self.spacing.map(|spacing| positive("spacing", spacing)).transpose()?;
        if self.force.is_none() {
            return Err(Error::invalid("force", "the measured forces", "none"));
        }
        Ok(())
    }

    /// The record.
    ///
    /// # Errors
    /// Those of [`Self::check`]; positions that do not rise in equal steps.
    pub(crate) fn record(&self) -> Result<SteadyRecord> {
        self.check()?;
        let forces = self.force.clone().unwrap_or_default();
        match (&self.position, self.spacing) {
            (Some(positions), _) => SteadyRecord::at_positions(positions, forces),
            (None, spacing) => Ok(SteadyRecord { spacing: spacing.unwrap_or_default(), forces }),
        }
    }
}

impl Fit {
    /// Checks the values that a record in steady sliding has in common with a curve, and that none of a curve only is given.
    ///
    /// # Errors
    /// The first invalid value.
    pub(super) fn check_steady(&self, steady: &FitSteady) -> Result<()> {
        self.refuse_of_curves("steady")?;
        self.velocity.map(|velocity| positive("velocity", velocity)).transpose()?;
        self.check_posterior()?;
        steady.check().map_err(|error| error.under("steady"))
    }

    /// Refuses a table without free numbers, and what belongs to a loading curve beside the table `measured` of another
    /// measurement.
    pub(super) fn refuse_of_curves(&self, measured: &str) -> Result<()> {
        let of_curves = [
            ("force", self.force.is_some()),
            ("drift", self.drift.is_some()),
            ("position_error", self.position_error.is_some()),
            ("compliance", self.compliance.is_some()),
            ("trend", self.trend != 0.0),
            ("origin", self.origin != 0.0),
            ("range", self.range.is_some()),
            ("average", self.average != 1),
            ("laws", !self.laws.is_empty()),
            ("thresholds", self.thresholds != FitThresholds::Law),
            ("noise", self.noise != FitNoise::Contacts),
        ];
        if let Some((key, _)) = of_curves.into_iter().find(|(_, given)| *given) {
            let expected = format!("none beside fit.{measured}: it belongs to a loading curve");
            return Err(Error::invalid(key, expected, "one"));
        }
        if self.free.is_empty() {
            return Err(Error::invalid("free", "at least one key", "none"));
        }
        Ok(())
    }

    /// The fit of the core to a record in steady sliding, ready to run, and the keys of its numbers; `None` for a curve.
    ///
    /// # Errors
    /// A key that is no number of the contacts and not `fit.offset`; a prior of another one; those of [`SteadyFit::check`].
    pub(crate) fn prepare_steady(
        &self,
        model: &Model,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(SteadyFit, FitKeys)>> {
        let Some(steady) = &self.steady else { return Ok(None) };
        let equation = self.equation(model, monitor)?;
        let of_curves = ["compliance", "background", "trend", "origin"];
        let of_steady = |name: &str| !(name.starts_with("initial.") || of_curves.contains(&name));
        let keys = FitKeys::new(model, &equation).only(of_steady);
        let (names, priors) = (self.names(&keys)?, self.priors(&keys)?);
        let record = steady.record().map_err(|error| error.under("fit.steady"))?;
        let mut fit = SteadyFit::new(equation, record).free(names).offset(self.offset);
        if let Some(reading) = self.reading {
            fit = fit.reading(reading);
        }
        for (name, prior) in priors {
            fit = fit.prior(&name, prior);
        }
        fit.check().map_err(Self::keyed_steady)?;
        Ok(Some((fit, keys)))
    }

    /// An error of a fit to a record, with the key that gave its argument.
    pub(crate) fn keyed_steady(error: Error) -> Error {
        const OF_RECORD: [&str; 3] = ["force", "position", "spacing"];
        match &error {
            Error::Invalid { key, .. } if OF_RECORD.contains(&key.split('.').next().unwrap_or_default()) => {
                error.under("fit.steady")
            }
            Error::Invalid { key, .. } if key == "offset" => error.under("fit"),
            _ => Self::keyed(error),
        }
    }
}

impl Scenario {
    /// The same scenario with other values of some of its numbers, by their keys, and with a `[spectrum]` up to the wave number
    /// `highest` instead of the fit.
    pub fn fitted_spectrum(&self, values: &[(String, f64)], highest: f64) -> Self {
        let mut fitted = self.fitted(values, (0, highest), None);
        let velocity = fitted.pull.take().and_then(|pull| pull.velocity);
        fitted.spectrum = Some(Spectrum { highest: Some(highest), velocity, ..Spectrum::default() });
        fitted
    }
}
