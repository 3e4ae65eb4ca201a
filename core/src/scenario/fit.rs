//! `[fit]`: numbers of the scenario from a measured curve.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Compare, FitSteady, Model, Pull, Scenario, Start, exactly_one, positive};
use crate::fit::{ERRORS, ErrorModel, MACHINE, Machine, Measurement, Prior};
use crate::master::MasterEquation;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Finds the numbers of a scenario for which its force agrees best with a measured curve, with their errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Fit {
    /// Measured curve, CSV with columns `position,force`, or `drive,force` where the machine has a compliance; its path is
    /// relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Positions of the slider at the readings, rising, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub position: Option<Vec<f64>>,
    /// Positions of the drive at the readings, rising, instead of a file; with `fit.compliance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub drive: Option<Vec<f64>>,
    /// A record of the force in steady sliding, instead of a curve; with `fit.free`, `fit.reading`, `fit.offset`, `fit.prior` and
    /// `fit.velocity` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady: Option<FitSteady>,
    /// Measured forces, instead of a file; without them, and with `fit.reading`, the errors that such a measurement would have.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
    /// The keys whose numbers are found, such as `contacts.thresholds.gaussian.mean`, `contacts.count`, `fit.offset`; the
    /// numbers of the scenario are the first values.
    pub free: Vec<String>,
    /// `"contacts"`: readings have the noise of a finite number `contacts.count` of contacts, in addition to `fit.reading` and
    /// `fit.drift`; `"white"`: without it.
    pub noise: FitNoise,
    /// Standard deviation of the independent error of a force, above 0; without it, it is estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub reading: Option<f64>,
    /// A slow drift of the force, a normal process whose amplitude and correlation length are estimated; without this table
    /// there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift: Option<FitDrift>,
    /// Displacement of the drive against the slider per force, above 0; required where positions are those of the drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/force"))]
    pub compliance: Option<f64>,
    /// Reading of the force where there is none.
    #[schemars(extend("x-dimension" = "force"))]
    pub offset: f64,
    /// Change of this reading per length.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub trend: f64,
    /// Reading of the position at X = 0.
    #[schemars(extend("x-dimension" = "length"))]
    pub origin: f64,
    /// First and last position of the readings that are used; without it, all are.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub range: Option<[f64; 2]>,
    /// Number of neighbouring readings that are averaged to one, 1 or more.
    pub average: usize,
    /// What is known of free keys beforehand: for each key its most probable `value` and its standard deviation `error`; a
    /// normal distribution, of the logarithm where the number is above 0.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(extend("x-dimension" = "any"))]
    pub prior: BTreeMap<String, Prior>,
    /// `"conditional"` or `"relaxed"`: relation between initial stretches and thresholds.
    pub start: Start,
    /// Velocity of the slider, above 0; required for time-dependent contacts (temperature, ageing, delay), without effect
    /// for others.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
}

/// What the errors of readings are made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitNoise {
    /// The noise of a finite number of contacts, and independent errors.
    #[default]
    Contacts,
    /// Independent errors.
    White,
}

/// A slow drift of the measured force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitDrift {
    /// Longest correlation length of the drift, below a quarter of the range of positions.
    #[schemars(extend("x-dimension" = "length"))]
    pub longest: f64,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            file: None,
            position: None,
            drive: None,
            steady: None,
            force: None,
            free: Vec::new(),
            noise: FitNoise::Contacts,
            reading: None,
            drift: None,
            compliance: None,
            offset: 0.0,
            trend: 0.0,
            origin: 0.0,
            range: None,
            average: 1,
            prior: BTreeMap::new(),
            start: Start::Conditional,
            velocity: None,
        }
    }
}

impl Fit {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        let given = [
            ("file", self.file.is_some()),
            ("position", self.position.is_some()),
            ("drive", self.drive.is_some()),
            ("steady", self.steady.is_some()),
        ];
        exactly_one("", "one of file, position, drive and steady", &given)?;
        if let Some(steady) = &self.steady {
            return self.check_steady(steady);
        }
        if self.file.is_some() {
            return Err(Error::invalid("file", "a curve read from it", "an unread file"));
        }
        self.velocity.map(|velocity| positive("velocity", velocity)).transpose()?;
        self.compliance.map(|compliance| positive("compliance", compliance)).transpose()?;
        match (&self.drive, self.compliance) {
            (Some(_), None) => {
                let expected = "the compliance of the machine, since positions are those of the drive";
                return Err(Error::invalid("compliance", expected, "none"));
            }
            (None, Some(compliance)) => {
                let expected = "no compliance: positions are those of the slider (those of the drive have the heading drive)";
                return Err(Error::invalid("compliance", expected, compliance));
            }
            _ => {}
        }
        if self.force.is_none() && self.reading.is_none() {
            let expected = "forces; or fit.reading, for the errors of a measurement that is only planned";
            return Err(Error::invalid("force", expected, "neither"));
        }
        if self.free.is_empty() {
            return Err(Error::invalid("free", "at least one key", "none"));
        }
        if self.average == 0 {
            return Err(Error::invalid("average", "1 reading or more", 0));
        }
        if self.range.is_some_and(|[from, to]| from >= to || !(to - from).is_finite()) {
            let expected = "two positions, the first below the second";
            return Err(Error::invalid("range", expected, format!("{:?}", self.range.unwrap_or_default())));
        }
        Ok(())
    }

    /// The measured curve: the readings in the range, averaged, and the machine.
    ///
    /// # Errors
    /// No reading in the range.
    pub(crate) fn measurement(&self) -> Result<Measurement> {
        let positions = self.position.as_ref().or(self.drive.as_ref()).cloned().unwrap_or_default();
        let machine = Machine {
            compliance: self.compliance.unwrap_or(0.0),
            offset: self.offset,
            trend: self.trend,
            origin: self.origin,
        };
        let all = Measurement { positions, forces: self.force.clone().unwrap_or_default(), machine };
        all.check()?;
        let inside = self.range.map_or_else(|| all.clone(), |range| all.within(range));
        if inside.positions.is_empty() {
            return Err(Error::invalid("range", "one that holds readings", format!("{:?}", self.range)));
        }
        inside.average(self.average)
    }

    /// The fit of the core that this table describes, ready to run, and the keys of its numbers.
    ///
    /// # Errors
    /// A key that is no number of the contacts or of the machine; a prior of another one; those of
    /// [`crate::fit::Fit::check`].
    pub(crate) fn prepare(
        &self,
        model: &Model,
        monitor: &mut dyn Monitor,
    ) -> Result<(crate::fit::Fit, FitKeys)> {
        let equation = self.equation(model, monitor)?;
        let keys = FitKeys::new(model, &equation);
        let (names, priors) = (self.names(&keys)?, self.priors(&keys)?);
        let measurement = self.measurement().map_err(|error| error.under("fit"))?;
        let mut fit = crate::fit::Fit::new(equation, measurement).free(names).errors(self.errors());
        for (name, prior) in priors {
            fit = fit.prior(&name, prior);
        }
        fit.check().map_err(Self::keyed)?;
        Ok((fit, keys))
    }

    /// The master equation of the first values.
    ///
    /// # Errors
    /// Those of [`MasterEquation::new`] and [`MasterEquation::at`].
    pub(super) fn equation(&self, model: &Model, monitor: &mut dyn Monitor) -> Result<MasterEquation> {
        let Model { contacts, initial, .. } = model;
        match self.velocity {
            Some(velocity) => MasterEquation::at_with(contacts.clone(), initial, velocity, monitor),
            None => MasterEquation::new_with(contacts.clone(), initial, monitor),
        }
    }

    /// The names of the free numbers in the core.
    ///
    /// # Errors
    /// A key that is none of `keys`.
    pub(super) fn names(&self, keys: &FitKeys) -> Result<Vec<String>> {
        let names = self.free.iter().enumerate();
        names.map(|(i, key)| keys.name(&format!("fit.free.{i}"), key)).collect()
    }

    /// The priors by the names of the core.
    ///
    /// # Errors
    /// A prior of a number that is not free.
    pub(super) fn priors(&self, keys: &FitKeys) -> Result<Vec<(String, Prior)>> {
        let mut priors = Vec::new();
        for (key, prior) in &self.prior {
            let place = format!("fit.prior.{key}");
            if !self.free.contains(key) {
                let expected = format!("priors of the keys in fit.free: {}", self.free.join(", "));
                return Err(Error::invalid(place, expected, "another key"));
            }
            priors.push((keys.name(&place, key)?, *prior));
        }
        Ok(priors)
    }

    /// An error of a fit, with the key that gave its argument.
    pub(crate) fn keyed(error: Error) -> Error {
        const ARGUMENTS: [&str; 7] = ["free", "prior", "position", "force", "drift", "reading", "compliance"];
        match &error {
            Error::Invalid { key, .. } if ARGUMENTS.contains(&key.split('.').next().unwrap_or_default()) => {
                error.under("fit")
            }
            _ => error,
        }
    }

    pub(crate) fn errors(&self) -> ErrorModel {
        ErrorModel {
            contacts: self.noise == FitNoise::Contacts,
            reading: self.reading,
            drift: self.drift.map(|drift| drift.longest),
        }
    }
}

impl Scenario {
    /// The same scenario with other values of some of its numbers, by their keys, and with a `[pull]` over `distance` instead of
    /// the fit; `compare` is the measured curve.
    pub fn fitted(&self, values: &[(String, f64)], distance: f64, compare: Option<Compare>) -> Self {
        let mut fitted = self.clone();
        let Some(fit) = fitted.fit.take() else { return fitted };
        for number in fitted.numbers() {
            if let Some((_, value)) = values.iter().find(|(key, _)| *key == number.key) {
                *number.value = *value;
            }
        }
        let velocity = values.iter().find(|(key, _)| key == "fit.velocity").map(|(_, value)| *value);
        let velocity = velocity.or(fit.velocity);
        fitted.pull = Some(Pull { distance, start: fit.start, velocity, ..Pull::default() });
        fitted.compare = compare;
        fitted
    }
}

/// The keys of numbers that a fit may find, and the names that the core has for them.
#[derive(Debug)]
pub(crate) struct FitKeys(Vec<(String, String)>);

impl FitKeys {
    /// Numbers of the machine and of the errors, and those of the contacts as far as they are parameters of the force.
    pub(super) fn new(model: &Model, equation: &MasterEquation) -> Self {
        let known = equation.parameters();
        let is_parameter = |name: &str| known.iter().any(|parameter| parameter.name == name);
        let of_contacts = model.keys.iter().filter(|(_, name)| is_parameter(name)).cloned();
        let named = known.iter().map(|parameter| (parameter.name.to_string(), parameter.name.to_string()));
        let named = named.filter(|_| model.keys.is_empty());
        let of_machine = MACHINE.iter().chain(&ERRORS);
        let of_machine = of_machine.map(|name| (format!("fit.{name}"), (*name).to_owned()));
        Self(of_contacts.chain(named).chain(of_machine).collect())
    }

    /// Those whose names are of a kind.
    pub(super) fn only(mut self, kind: impl Fn(&str) -> bool) -> Self {
        self.0.retain(|(_, name)| kind(name));
        self
    }

    /// The name for a key; `place` is where the key is given.
    fn name(&self, place: &str, key: &str) -> Result<String> {
        let free = self.0.iter().filter(|(_, name)| !ERRORS.contains(&name.as_str()));
        match free.clone().find(|(known, _)| known == key) {
            Some((_, name)) => Ok(name.clone()),
            None => {
                let known: Vec<&str> = free.map(|(key, _)| key.as_str()).collect();
                Err(Error::invalid(place, format!("one of {}", known.join(", ")), format!("\"{key}\"")))
            }
        }
    }

    /// The key for a name.
    pub fn key(&self, name: &str) -> String {
        let found = self.0.iter().find(|(_, known)| known == name);
        found.map_or_else(|| name.to_owned(), |(key, _)| key.clone())
    }
}
