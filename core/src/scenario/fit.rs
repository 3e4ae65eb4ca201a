//! `[fit]`: numbers of the scenario from measured curves.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::law::ParametricFamily;
use super::{
    Compare, FitCompliance, FitCurve, FitPosterior, FitSource, FitSteady, FitVelocityCurve, Law, Model, Pull,
    Scenario, Start, exactly_one, positive,
};
use crate::fit::{BACKGROUND, ERRORS, ErrorModel, MACHINE, Prior};
use crate::law;
use crate::master::MasterEquation;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Finds the numbers of a scenario for which its force agrees best with a measured curve, or several, with their errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Fit {
    /// Measured curve, CSV with columns `position,force`, or `drive,force` where the machine has a compliance; its path is
    /// relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The file that the curve was read from; results state it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<FitSource>,
    /// Positions of the slider at the readings, rising, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub position: Option<Vec<f64>>,
    /// Positions of the drive at the readings, rising, instead of a file; with `fit.compliance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub drive: Option<Vec<f64>>,
    /// A record of the force in steady sliding, instead of a curve; with `fit.free`, `fit.reading`, `fit.offset`, `fit.prior`,
    /// `fit.posterior` and `fit.velocity` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady: Option<FitSteady>,
    /// Forces of steady sliding at several velocities, instead of a curve; with `fit.free`, `fit.reading`, `fit.offset`,
    /// `fit.prior` and `fit.posterior` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_curve: Option<FitVelocityCurve>,
    /// Measured forces, instead of a file; without them, and with `fit.reading`, the errors that such a measurement would have.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
    /// Several curves of the same contacts, fitted together, instead of the one above; each with the noise of other contacts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curve: Vec<FitCurve>,
    /// The keys whose numbers are found, such as `contacts.thresholds.gaussian.mean`, `contacts.count`, `fit.offset`; the
    /// numbers of the scenario are the first values. A key after `fit.curve.0.`, `fit.curve.1.`, … is that of a number of one
    /// curve: `fit.curve.0.offset`, `fit.curve.0.contacts.count`.
    pub free: Vec<String>,
    /// `"contacts"`: readings have the noise of a finite number `contacts.count` of contacts, in addition to `fit.reading` and
    /// `fit.drift`; `"white"`: without it.
    pub noise: FitNoise,
    /// Standard deviation of the independent error of a force, above 0; without it, it is estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force"))]
    pub reading: Option<f64>,
    /// Standard deviation of the independent error of a position, above 0, with `noise = "white"`: the error of a force is then larger
    /// by it times the slope of the curve; without it, positions are exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub position_error: Option<f64>,
    /// A slow drift of the force, a normal process whose amplitude and correlation length are estimated; without this table
    /// there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift: Option<FitDrift>,
    /// Displacement of the drive against the slider per force, above 0, or `"free"`; required where positions are those of the
    /// drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/force"))]
    pub compliance: Option<FitCompliance>,
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
    #[schemars(extend("minimum" = 1))]
    pub average: usize,
    /// What is known of free keys beforehand: for each key its most probable `value` and its standard deviation `error`; a
    /// normal distribution, of the logarithm where the number is above 0 and no compliance.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(extend("x-dimension" = "any"))]
    pub prior: BTreeMap<String, Prior>,
    /// Names of distributions of the thresholds, such as `"gamma"` and `"lognormal"`: the same fit with each of them, for a
    /// comparison by Akaike's criterion. Where all numbers of `contacts.thresholds` are free, all of theirs are; otherwise those
    /// of the same names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laws: Vec<String>,
    /// Draws from the posterior, beside the estimates and their errors; without this table there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<FitPosterior>,
    /// `"free_form"`: in addition to the fit with the distribution of `contacts.thresholds`, one of the density itself, as smooth
    /// as the curve allows; `"law"`: without it.
    pub thresholds: FitThresholds,
    /// Number of kernels in the density of free form, 12 or more.
    #[schemars(extend("minimum" = 12))]
    pub kernels: usize,
    /// `"conditional"` or `"relaxed"`: relation between initial stretches and thresholds.
    pub start: Start,
    /// Velocity of the slider, above 0; required for time-dependent contacts (temperature, ageing, delay), without effect
    /// for others.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
}

/// What the errors of readings are made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FitNoise {
    /// The noise of a finite number of contacts, and independent errors.
    #[default]
    Contacts,
    /// Independent errors.
    White,
}

/// What is known of the form of the distribution of thresholds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FitThresholds {
    /// It is that of `contacts.thresholds`.
    #[default]
    Law,
    /// It is smooth.
    FreeForm,
}

/// A slow drift of the measured force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitDrift {
    /// Longest correlation length of the drift, below a quarter of the range of positions.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub longest: f64,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            file: None,
            source: None,
            position: None,
            drive: None,
            steady: None,
            velocity_curve: None,
            force: None,
            curve: Vec::new(),
            free: Vec::new(),
            noise: FitNoise::Contacts,
            reading: None,
            position_error: None,
            drift: None,
            compliance: None,
            offset: 0.0,
            trend: 0.0,
            origin: 0.0,
            range: None,
            average: 1,
            prior: BTreeMap::new(),
            laws: Vec::new(),
            thresholds: FitThresholds::Law,
            kernels: 36,
            posterior: None,
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
        let alone = [
            ("file", self.file.is_some()),
            ("position", self.position.is_some()),
            ("drive", self.drive.is_some()),
            ("force", self.force.is_some()),
        ];
        if let (false, Some((key, _))) = (self.curve.is_empty(), alone.iter().find(|(_, given)| *given)) {
            return Err(Error::invalid(*key, "none beside [[fit.curve]]", "one"));
        }
        let given = [
            ("file", self.file.is_some()),
            ("position", self.position.is_some()),
            ("drive", self.drive.is_some()),
            ("curve", !self.curve.is_empty()),
            ("steady", self.steady.is_some()),
            ("velocity_curve", self.velocity_curve.is_some()),
        ];
        exactly_one("", "one of file, position, drive, curve, steady and velocity_curve", &given)?;
        if let Some(steady) = &self.steady {
            return self.check_steady(steady);
        }
        if let Some(curve) = &self.velocity_curve {
            return self.check_velocity_curve(curve);
        }
        for (c, curve) in self.curves().iter().enumerate() {
            let checked = curve.check(self.reading.is_some());
            checked.map_err(|error| self.of_curve(c, error))?;
        }
        self.velocity.map(|velocity| positive("velocity", velocity)).transpose()?;
        if self.free.is_empty() && !self.curves().iter().any(FitCurve::has_free_compliance) {
            return Err(Error::invalid("free", "at least one key", "none"));
        }
        for (i, name) in self.laws.iter().enumerate() {
            threshold_family(&format!("laws.{i}"), name)?;
        }
        self.check_posterior()?;
        if self.average == 0 {
            return Err(Error::invalid("average", "1 reading or more", 0));
        }
        Ok(())
    }

    /// Checks what is known of the first values: the contacts, and the names of numbers.
    ///
    /// # Errors
    /// Those of a preparation.
    pub(super) fn check_first_values(&self, model: &Model, monitor: &mut dyn Monitor) -> Result<()> {
        if self.velocity_curve.is_some() {
            return self.prepare_velocity_curve(model, monitor).map(drop);
        }
        if self.steady.is_some() {
            return self.prepare_steady(model, monitor).map(drop);
        }
        self.prepare(model, monitor).map(drop)
    }

    pub(super) fn check_posterior(&self) -> Result<()> {
        let checked = self.posterior.map_or(Ok(()), |posterior| posterior.check());
        checked.map_err(|error| error.under("posterior"))
    }

    /// The curves, each with all that the table says of it.
    pub fn curves(&self) -> Vec<FitCurve> {
        let own = FitCurve {
            file: self.file.clone(),
            source: self.source.clone(),
            position: self.position.clone(),
            drive: self.drive.clone(),
            force: self.force.clone(),
            ..FitCurve::default()
        };
        let given = if self.curve.is_empty() { vec![own] } else { self.curve.clone() };
        given.into_iter().map(|curve| self.completed(curve)).collect()
    }

    /// A curve with the numbers of the table where it has none.
    fn completed(&self, curve: FitCurve) -> FitCurve {
        FitCurve {
            compliance: curve.compliance.or(self.compliance),
            offset: curve.offset.or(Some(self.offset)),
            trend: curve.trend.or(Some(self.trend)),
            origin: curve.origin.or(Some(self.origin)),
            range: curve.range.or(self.range),
            ..curve
        }
    }

    /// An error of curve `c`, with the key of the curve if there are several.
    fn of_curve(&self, c: usize, error: Error) -> Error {
        if self.curve.is_empty() { error } else { error.under(&format!("curve.{c}")) }
    }

    /// The keys of free numbers, a free compliance among them.
    fn free_keys(&self) -> Vec<String> {
        let mut keys = self.free.clone();
        let curves = self.curves();
        let mut add = |key: String| {
            if !keys.contains(&key) {
                keys.push(key);
            }
        };
        if curves.iter().all(FitCurve::has_free_compliance)
            && !self.curve.iter().any(|curve| curve.compliance.is_some())
        {
            add("fit.compliance".to_owned());
        } else {
            let free = (0..curves.len()).filter(|&c| curves[c].has_free_compliance());
            free.for_each(|c| add(format!("fit.curve.{c}.compliance")));
        }
        keys
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
        let mut measured = Vec::new();
        let contacts = &model.contacts;
        let stiffness = contacts.count * contacts.stiffness.mean(contacts.thresholds.as_ref());
        for (c, curve) in self.curves().iter().enumerate() {
            let found = curve.measurement(self.average, stiffness);
            let mut found = found.map_err(|error| self.of_curve(c, error).under("fit"))?;
            found.machine.background = model.background;
            measured.push(found);
        }
        let mut measured = measured.into_iter();
        let Some(first) = measured.next() else {
            return Err(Error::invalid("fit.curve", "at least one curve", "none"));
        };
        let fit = crate::fit::Fit::new(equation, first).free(names).errors(self.errors());
        let mut fit = measured.fold(fit, crate::fit::Fit::curve);
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
        Self::refuse_truncated(model)?;
        let Model { contacts, initial, .. } = model;
        match self.velocity {
            Some(velocity) => MasterEquation::at_with(contacts.clone(), initial, velocity, monitor),
            None => MasterEquation::new_with(contacts.clone(), initial, monitor),
        }
    }

    /// Refuses stretches of which what lies above the thresholds was left out.
    pub(super) fn refuse_truncated(model: &Model) -> Result<()> {
        let laws = [("contacts.reforming", &model.contacts.reforming), ("initial", &model.initial.law)];
        match laws.into_iter().find(|(_, law)| law.name() == "truncated") {
            Some((key, _)) => {
                let expected = "stretches below the thresholds: a smaller mean or std, or a distribution with an end, \
                                such as rectangular, since what is left out changes with the thresholds";
                Err(Error::invalid(key, expected, "stretches at which hardly any contact holds"))
            }
            None => Ok(()),
        }
    }

    /// The names of the free numbers in the core.
    ///
    /// # Errors
    /// A key that is none of `keys`.
    pub(super) fn names(&self, keys: &FitKeys) -> Result<Vec<String>> {
        let names = self.free_keys().into_iter().enumerate();
        names.map(|(i, key)| keys.name(&format!("fit.free.{i}"), &key)).collect()
    }

    /// The priors by the names of the core.
    ///
    /// # Errors
    /// A prior of a number that is not free.
    pub(super) fn priors(&self, keys: &FitKeys) -> Result<Vec<(String, Prior)>> {
        let mut priors = Vec::new();
        let free = self.free_keys();
        for (key, prior) in &self.prior {
            let place = format!("fit.prior.{key}");
            if !free.contains(key) {
                let expected = format!("priors of the keys in fit.free: {}", free.join(", "));
                return Err(Error::invalid(place, expected, "another key"));
            }
            priors.push((keys.name(&place, key)?, *prior));
        }
        Ok(priors)
    }

    /// The fit of the core with other thresholds, those of the distribution `name` with mean and standard deviation near those of
    /// `thresholds`, and the keys of its numbers.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub(crate) fn of_law(
        fit: &crate::fit::Fit,
        keys: &FitKeys,
        (name, thresholds): (&str, &dyn law::Law),
        monitor: &mut dyn Monitor,
    ) -> Result<(crate::fit::Fit, FitKeys)> {
        let member = threshold_family("laws", name)?.member;
        let law = member(thresholds.mean(), thresholds.std() / thresholds.mean()).build()?;
        let keys = keys.with_thresholds(name, law.as_ref());
        Ok((fit.with_thresholds(law, monitor)?, keys))
    }

    /// An error of a fit, with the key that gave its argument.
    pub(crate) fn keyed(error: Error) -> Error {
        const ARGUMENTS: [&str; 10] = [
            "free",
            "prior",
            "position",
            "position_error",
            "force",
            "drift",
            "reading",
            "compliance",
            "curve",
            "kernels",
        ];
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
            position: self.position_error,
        }
    }
}

impl Scenario {
    /// The same scenario with other values of some of its numbers, by their keys, and with a `[pull]` over `distance` instead of
    /// the fit; `compare` is the measured curve `curve`.
    pub fn fitted(
        &self,
        values: &[(String, f64)],
        (curve, distance): (usize, f64),
        compare: Option<Compare>,
    ) -> Self {
        let mut fitted = self.clone();
        let Some(fit) = fitted.fit.take() else { return fitted };
        let value = |key: &str| {
            let own = format!("fit.curve.{curve}.{key}");
            values.iter().find(|(known, _)| *known == key || *known == own).map(|(_, value)| *value)
        };
        for number in fitted.numbers() {
            if let Some(value) = value(&number.key) {
                *number.value = value;
            }
        }
        let velocity = value("fit.velocity").or(fit.velocity);
        fitted.pull = Some(Pull { distance, start: fit.start.into(), velocity, ..Pull::default() });
        fitted.compare = compare;
        fitted
    }
}

/// The family of this name of distributions that thresholds may have in a comparison: those with a density. `place` is where the
/// name is given.
///
/// # Errors
/// Another name.
pub fn threshold_family(place: &str, name: &str) -> Result<&'static ParametricFamily> {
    let with_density = || Law::FAMILIES.iter().filter(|family| family.widths[1] > 0.0);
    with_density().find(|family| family.name == name).ok_or_else(|| {
        let names: Vec<&str> = with_density().map(|family| family.name).collect();
        Error::invalid(place, format!("one of {}", names.join(", ")), format!("\"{name}\""))
    })
}

/// Before the number of a curve, in the key of a number of that curve.
const OF_CURVE: &str = "fit.curve.";

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
        let background = model.keys.iter().filter(|(_, name)| name == BACKGROUND).cloned();
        Self(of_contacts.chain(named).chain(background).chain(of_machine).collect())
    }

    /// The same with the thresholds of another distribution.
    fn with_thresholds(&self, name: &str, law: &dyn law::Law) -> Self {
        let others = self.0.iter().filter(|(_, known)| !known.starts_with("thresholds.")).cloned();
        let own = law.parameters().into_iter().map(|parameter| {
            let inner = &parameter.name;
            (format!("contacts.thresholds.{name}.{inner}"), format!("thresholds.{inner}"))
        });
        Self(own.chain(others).collect())
    }

    /// Those whose names are of a kind.
    pub(super) fn only(mut self, kind: impl Fn(&str) -> bool) -> Self {
        self.0.retain(|(_, name)| kind(name));
        self
    }

    /// The name for a key; `place` is where the key is given.
    fn name(&self, place: &str, key: &str) -> Result<String> {
        let free = self.0.iter().filter(|(_, name)| !ERRORS.contains(&name.as_str()));
        let own = |(known, name): &&(String, String)| {
            let (curve, quantity) = key.strip_prefix(OF_CURVE)?.split_once('.')?;
            let short = known.strip_prefix("fit.").unwrap_or(known);
            let same = curve.parse::<usize>().is_ok() && (quantity == known || quantity == short);
            same.then(|| format!("curve.{curve}.{name}"))
        };
        if let Some(name) = free.clone().find_map(|number| own(&number)) {
            return Ok(name);
        }
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
        if let Some((curve, quantity)) = name.strip_prefix("curve.").and_then(|rest| rest.split_once('.')) {
            let key = self.key(quantity);
            return format!("{OF_CURVE}{curve}.{}", key.strip_prefix("fit.").unwrap_or(&key));
        }
        let found = self.0.iter().find(|(_, known)| known == name);
        found.map_or_else(|| name.to_owned(), |(key, _)| key.clone())
    }
}
