//! Which numbers a fit varies, for which of its curves, and in which coordinate.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Fit, Measurement};
use crate::master::MasterEquation;
use crate::{Error, Result};

/// The numbers of the sizes of errors, which are free where they are not given.
pub(crate) const ERRORS: [&str; 3] = ["reading", "drift.amplitude", "drift.length"];

/// The numbers of the machine that may be free.
pub(crate) const MACHINE: [&str; 4] = ["compliance", "offset", "trend", "origin"];

/// The background force, a free number beside those of the machine.
pub(crate) const BACKGROUND: &str = "background";

/// Correlation length at which the drift begins, in multiples of the longest.
const DRIFT_LENGTH: f64 = 0.3;

/// What is known of a number beforehand: a normal distribution, of its logarithm if the number is above 0 and no compliance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// The most probable value.
    #[schemars(extend("x-dimension" = "any"))]
    pub value: f64,
    /// The standard deviation, in the unit of the value, above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "any"))]
    pub error: f64,
}

/// Smallest errors that are estimated, in multiples of the largest force.
const SMALLEST: f64 = 1e-5;
/// Smallest error of a reading, in multiples of the largest force: below it are errors of the solution and of its derivatives, which
/// are not normal.
pub(super) const UNREAD: f64 = 1e-8;

/// Smallest compliance, in multiples of its first value.
const STIFFEST: f64 = 1e-6;

/// What a free number belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Contacts,
    Compliance,
    Background,
    Offset,
    Trend,
    Origin,
    Reading,
    DriftAmplitude,
    DriftLength,
}

/// The coefficients of thresholds of free form.
const COEFFICIENTS: &str = "thresholds.coefficient_";
/// Longest step of the logarithm of a number, and of one of a distribution: a curve that has turned over in between has other
/// slopes.
const LONGEST: f64 = 1.5;
const LONGEST_OF_DISTRIBUTIONS: f64 = 0.7;
/// Of a coefficient of a logarithmic density, which may be of its tails.
const LONGEST_OF_TAILS: f64 = 10.0;
/// Longest step of a mean or an end of a distribution, in first mean thresholds or parts of itself: more would change the phase
/// of what follows after the first peak.
const LONGEST_SHIFT: f64 = 0.15;

/// A number that a fit varies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FreeParameter {
    /// Its name: that of its quantity, or `curve.1.` and that of its quantity.
    pub name: String,
    /// What it is the value of, such as `thresholds.mean` or `offset`.
    pub quantity: String,
    /// The curve that it belongs to; `None` for all of them.
    pub curve: Option<usize>,
    pub role: Role,
    /// Whether it is varied by its logarithm, as what is above 0 is, except for a compliance.
    pub logarithmic: bool,
    /// Its first value.
    pub start: f64,
    /// The longest step of its coordinate in a search: see [`Self::longest_step`].
    pub longest: f64,
    /// The range of its coordinate.
    pub bounds: [f64; 2],
    /// Mean and standard deviation of its coordinate.
    pub prior: Option<[f64; 2]>,
}

impl FreeParameter {
    pub fn new(name: &str, role: Role, logarithmic: bool, start: f64) -> Self {
        let bounds = [f64::NEG_INFINITY, f64::INFINITY];
        let (curve, quantity) = of_curve(name);
        let longest = match quantity {
            _ if quantity.starts_with(COEFFICIENTS) => LONGEST_OF_TAILS,
            _ if logarithmic && quantity.contains('.') => LONGEST_OF_DISTRIBUTIONS,
            _ if logarithmic => LONGEST,
            _ => f64::INFINITY,
        };
        let (name, quantity) = (name.to_owned(), quantity.to_owned());
        Self { name, quantity, curve, role, logarithmic, start, longest, bounds, prior: None }
    }

    /// Whether it is a number of this curve.
    pub fn applies_to(&self, curve: usize) -> bool {
        self.curve.is_none_or(|own| own == curve)
    }

    /// The value at a coordinate.
    pub fn value(&self, coordinate: f64) -> f64 {
        if self.logarithmic { coordinate.exp() } else { coordinate }
    }

    /// The coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        if self.logarithmic { value.ln() } else { value }
    }

    /// The derivative of the value by the coordinate.
    pub fn slope(&self, coordinate: f64) -> f64 {
        if self.logarithmic { coordinate.exp() } else { 1.0 }
    }

    /// The longest step of its coordinate in a search from `coordinate`. From first values far too small, steps grow.
    pub fn longest_step(&self, coordinate: f64) -> f64 {
        if self.logarithmic { self.longest } else { self.longest.max(LONGEST_SHIFT * coordinate.abs()) }
    }

    /// Whether it only says how large errors are.
    pub fn is_of_errors(&self) -> bool {
        matches!(self.role, Role::Reading | Role::DriftAmplitude | Role::DriftLength)
    }

    /// By how much the logarithm of the covariance of the noise of contacts changes with its logarithm: N⟨k⟩².
    pub fn noise_power(&self) -> f64 {
        match self.quantity.as_str() {
            "count" => 1.0,
            "stiffness" => 2.0,
            _ => 0.0,
        }
    }
}

/// The coordinates of the first values.
pub(super) fn first_coordinates(free: &[FreeParameter]) -> Vec<f64> {
    free.iter().map(|parameter| parameter.coordinate(parameter.start)).collect()
}

/// The values at coordinates.
pub(super) fn values_at(free: &[FreeParameter], coordinates: &[f64]) -> Vec<f64> {
    free.iter().zip(coordinates).map(|(parameter, &u)| parameter.value(u)).collect()
}

/// The value of a role at these coordinates, if it is free.
pub(super) fn value_of(free: &[FreeParameter], role: Role, coordinates: &[f64]) -> Option<f64> {
    let found = free.iter().zip(coordinates).find(|(parameter, _)| parameter.role == role);
    found.map(|(parameter, &u)| parameter.value(u))
}

/// The names and values of the numbers of the contacts of a curve, from the values of all numbers.
pub(super) fn of_contacts<'a>(
    free: &'a [FreeParameter],
    values: &[f64],
    curve: usize,
) -> Vec<(&'a str, f64)> {
    let own = |parameter: &FreeParameter| parameter.role == Role::Contacts && parameter.applies_to(curve);
    let of_contacts = free.iter().zip(values).filter(|(parameter, _)| own(parameter));
    of_contacts.map(|(parameter, &value)| (parameter.quantity.as_str(), value)).collect()
}

/// Σ(u − m)²/s² over the priors.
pub(super) fn priors_at(free: &[FreeParameter], coordinates: &[f64]) -> f64 {
    let known = free.iter().zip(coordinates);
    known.filter_map(|(parameter, u)| parameter.prior.map(|[mean, std]| ((u - mean) / std).powi(2))).sum()
}

/// The free numbers of these names in a fit of steady sliding, each as `finished` leaves it: numbers of the contacts for which
/// `is_known` is true, or one of `others`, which have a name, a role and a first value.
///
/// # Errors
/// A name that is unknown, given twice, or without a derivative; those of `finished`.
pub(super) fn named(
    names: &[String],
    (equation, is_known): (&MasterEquation, impl Fn(&str) -> bool),
    others: &[(&str, Role, f64)],
    finished: impl Fn(FreeParameter) -> Result<FreeParameter>,
) -> Result<Vec<FreeParameter>> {
    let parameters = equation.parameters();
    let known = parameters.iter().filter(|known| is_known(&known.name));
    let known = known.map(|known| (known.name.as_ref(), Role::Contacts, known.value));
    let known: Vec<_> = known.chain(others.iter().copied()).collect();
    let mut free: Vec<FreeParameter> = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let key = format!("free.{i}");
        if free.iter().any(|other| other.name == *name) {
            return Err(Error::invalid(key, "each key once", name));
        }
        let Some(&(_, role, start)) = known.iter().find(|known| known.0 == name) else {
            let known: Vec<&str> = known.iter().map(|known| known.0).collect();
            return Err(Error::invalid(key, format!("one of {}", known.join(", ")), name));
        };
        let logarithmic =
            if role == Role::Contacts { equation.is_positive(name)? } else { role == Role::Background };
        free.push(finished(FreeParameter::new(name, role, logarithmic, start))?);
    }
    Ok(free)
}

/// The free numbers with what is known of them beforehand.
///
/// # Errors
/// No free number; two weights of one mixture; a prior of a number that is fixed, or one that is not finite.
pub(super) fn with_priors(
    mut free: Vec<FreeParameter>,
    priors: &[(String, Prior)],
) -> Result<Vec<FreeParameter>> {
    if free.is_empty() {
        return Err(Error::invalid("free", "at least one key", "none"));
    }
    for (i, parameter) in free.iter().enumerate() {
        let same = |other: &&FreeParameter| {
            let both = other.curve.is_none() || parameter.curve.is_none() || other.curve == parameter.curve;
            mixture_of_weight(parameter).is_some_and(|own| mixture_of_weight(other) == Some(own)) && both
        };
        if let Some(other) = free[..i].iter().find(same) {
            let expected = "one weight of a mixture, to which the others are in proportion";
            let found = format!("{} beside {}", parameter.name, other.name);
            return Err(Error::invalid(format!("free.{i}"), expected, found));
        }
    }
    for (name, prior) in priors {
        let Some(parameter) = free.iter_mut().find(|parameter| parameter.name == *name) else {
            let expected = "priors of free numbers only";
            return Err(Error::invalid(format!("prior.{name}"), expected, "a fixed one"));
        };
        parameter.prior = Some(prior.of(parameter)?);
    }
    Ok(free)
}

/// The mixture of which a number is a weight, such as `thresholds` or `thresholds.1` of a mixture in it.
fn mixture_of_weight(parameter: &FreeParameter) -> Option<&str> {
    Some(parameter.quantity.strip_suffix(".weight")?.rsplit_once('.')?.0)
}

/// The curve that a name belongs to, if it begins with `curve.` and its number, and the name of the quantity.
pub(super) fn of_curve(name: &str) -> (Option<usize>, &str) {
    let own = name.strip_prefix("curve.").and_then(|rest| rest.split_once('.'));
    own.and_then(|(curve, quantity)| Some((curve.parse().ok()?, quantity)))
        .map_or((None, name), |(curve, quantity)| (Some(curve), quantity))
}

impl Fit {
    /// The free numbers of the contacts and of the machine, checked.
    ///
    /// # Errors
    /// A name that is unknown, given twice, or without a derivative; none; a prior of a number that is fixed.
    pub(super) fn free_parameters(&self) -> Result<Vec<FreeParameter>> {
        let known = self.equation.parameters();
        let mut free: Vec<FreeParameter> = Vec::new();
        for (i, name) in self.free.iter().enumerate() {
            let parameter = self.free_parameter(name, &known).ok_or_else(|| {
                let names: Vec<&str> = known
                    .iter()
                    .map(|parameter| parameter.name.as_ref())
                    .chain(MACHINE)
                    .chain([BACKGROUND])
                    .collect();
                let of_curves =
                    if self.curves.len() > 1 { ", each with curve.0., curve.1., … before it" } else { "" };
                Error::invalid(format!("free.{i}"), format!("one of {}{of_curves}", names.join(", ")), name)
            })??;
            let same = |other: &FreeParameter| {
                let both =
                    other.curve.is_none() || parameter.curve.is_none() || other.curve == parameter.curve;
                other.quantity == parameter.quantity && both
            };
            if let Some(other) = free.iter().find(|other| same(other)) {
                let twice = other.name == *name;
                let expected =
                    if twice { "each key once" } else { "each key once, for all curves or for one of them" };
                let found = if twice { name.clone() } else { format!("{name} beside {}", other.name) };
                return Err(Error::invalid(format!("free.{i}"), expected, found));
            }
            free.push(parameter);
        }
        with_priors(free, &self.priors)
    }

    fn free_parameter(&self, name: &str, known: &[crate::law::Parameter]) -> Option<Result<FreeParameter>> {
        let (curve, quantity) = of_curve(name);
        let machine = &self.curves.get(curve.unwrap_or(0))?.machine;
        let (role, start) = match quantity {
            "compliance" => (Role::Compliance, machine.compliance),
            BACKGROUND => (Role::Background, machine.background),
            "offset" => (Role::Offset, machine.offset),
            "trend" => (Role::Trend, machine.trend),
            "origin" => (Role::Origin, machine.origin),
            _ => (Role::Contacts, known.iter().find(|parameter| parameter.name == quantity)?.value),
        };
        let logarithmic = match role {
            Role::Contacts => self.equation.is_positive(quantity),
            role => Ok(role == Role::Background),
        };
        Some(logarithmic.and_then(|logarithmic| {
            if (logarithmic || role == Role::Compliance) && start <= 0.0 {
                return Err(Error::invalid(
                    name,
                    "a first value above 0 of a free number that is positive",
                    start,
                ));
            }
            let mut parameter = FreeParameter::new(name, role, logarithmic, start);
            if role == Role::Compliance {
                // Varied as it is: contacts of larger thresholds behind a stiffer machine make nearly the same curve along a line.
                parameter.bounds[0] = STIFFEST * start;
            }
            if ["mean", "min", "max"].iter().any(|of| !logarithmic && quantity.ends_with(&format!(".{of}"))) {
                parameter.longest = LONGEST_SHIFT * self.equation.contacts().thresholds.mean();
            }
            Ok(parameter)
        }))
    }

    /// The smallest standard deviation of the independent error of a reading that is tried.
    pub(super) fn smallest_reading(&self) -> f64 {
        self.errors.reading.map_or(SMALLEST * self.scale(), |reading| reading.max(UNREAD * self.scale()))
    }

    /// The free numbers of the errors, with first values for independent errors of the size `reading` and a drift of the size
    /// `drift`.
    pub(super) fn free_errors(&self, reading: f64, drift: f64) -> Vec<FreeParameter> {
        let smallest = SMALLEST * self.scale();
        let of_force = |name: &str, role, start: f64| FreeParameter {
            bounds: [smallest.ln(), f64::INFINITY],
            ..FreeParameter::new(name, role, true, start.max(2.0 * smallest))
        };
        let mut free = Vec::new();
        if self.errors.reading.is_none() {
            free.push(of_force("reading", Role::Reading, reading));
        }
        if let Some(longest) = self.errors.drift {
            let spacing = self.curves.iter().map(Measurement::spacing).fold(f64::INFINITY, f64::min);
            free.push(of_force("drift.amplitude", Role::DriftAmplitude, drift));
            free.push(FreeParameter {
                bounds: [spacing.min(DRIFT_LENGTH * longest).ln(), longest.ln()],
                ..FreeParameter::new("drift.length", Role::DriftLength, true, DRIFT_LENGTH * longest)
            });
        }
        free
    }
}

impl Prior {
    /// Mean and standard deviation of the coordinate of `parameter`.
    fn of(&self, parameter: &FreeParameter) -> Result<[f64; 2]> {
        let key = |part: &str| format!("prior.{}.{part}", parameter.name);
        let error = crate::error::positive(&key("error"), self.error)?;
        if !self.value.is_finite() || (parameter.logarithmic && self.value <= 0.0) {
            let expected = if parameter.logarithmic { "a finite number above 0" } else { "a finite number" };
            return Err(Error::invalid(key("value"), expected, self.value));
        }
        let slope = parameter.slope(parameter.coordinate(self.value));
        Ok([parameter.coordinate(self.value), error / slope])
    }
}
