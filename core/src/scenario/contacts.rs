//! `[contacts]`: number, stiffness, thresholds and re-forming of contacts.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Ageing, Delay, Law, Temperature, positive};
use crate::contacts::{FreeFriction, Stiffness, StiffnessTable};
use crate::error::not_negative;
use crate::law::{Root, SharedLaw};
use crate::monitor::Monitor;
use crate::{Error, Result, contacts};

/// The contacts of the interface: either `thresholds`, or `areas` from which thresholds and stiffnesses follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [
        { "required": ["thresholds"] },
        { "required": ["areas"], "not": { "anyOf": [
            { "required": ["stiffness"] }, { "required": ["stiffness_per_threshold"] }, { "required": ["stiffness_of_threshold"] },
        ] } },
    ],
    "not" = { "anyOf": [
        { "required": ["stiffness", "stiffness_per_threshold"] },
        { "required": ["stiffness", "stiffness_of_threshold"] },
        { "required": ["stiffness_per_threshold", "stiffness_of_threshold"] },
        { "required": ["stiffness_of_threshold", "temperature"] },
        { "required": ["stiffness_of_threshold", "ageing"] },
        { "required": ["stiffness_of_threshold", "delay"] },
        { "required": ["background_force", "background_coefficient"] },
    ] },
    "dependentRequired" = { "background_coefficient": ["normal_load"] },
))]
pub struct Contacts {
    /// Number N_c of contacts, above 0; with 1, forces are per contact.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub count: f64,
    /// Stiffness ⟨k⟩ of a contact, force per length, above 0, independent of its threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "default" = 1.0, "x-dimension" = "force/length"))]
    pub stiffness: Option<f64>,
    /// Factor κ, above 0, for stiffnesses k = κ x_s; instead of `contacts.stiffness`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length^2"))]
    pub stiffness_per_threshold: Option<f64>,
    /// Stiffnesses k(x_s) from a table against the threshold, for contacts without temperature, ageing and delay; instead of
    /// `contacts.stiffness`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_of_threshold: Option<StiffnessOfThreshold>,
    /// Normal load carried by the interface, or by each cell of `[interface]`, a force, above 0; if given, friction coefficients
    /// are reported in addition to forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force"))]
    pub normal_load: Option<f64>,
    /// Background force B, 0 or above, of each cell with `[interface]`: a friction force in addition to that of the contacts,
    /// against the motion; all forces of results contain it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "x-dimension" = "force"))]
    pub background_force: Option<f64>,
    /// The same as a friction coefficient μ_b, 0 or above, B = μ_b `contacts.normal_load`; instead of
    /// `contacts.background_force`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "x-dimension" = "1"))]
    pub background_coefficient: Option<f64>,
    /// Distribution P_c of the stretches at which contacts break; either this or `contacts.areas` is required.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thresholds: Option<Law>,
    /// Contacts described by their areas, instead of `thresholds` and stiffnesses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub areas: Option<Areas>,
    /// Distribution R of the stretches at which contacts re-form. Stretches beyond the thresholds are left out, at most half of
    /// them, and their share is reported.
    pub reforming: Law,
    /// Thermally activated breaking below the thresholds; without this table there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Temperature>,
    /// `smoluchowski = { mature, diffusion }`, `frozen_rank = { mature, time }`, `logarithmic = { growth, time }` or
    /// `mean_field = { mature, diffusion }`: thresholds change with the age of a contact; `mature` is the distribution of
    /// mature thresholds, `contacts.thresholds` that of fresh ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ageing: Option<Ageing>,
    /// Time for which a broken contact is detached before it re-forms: the same `time`, 0 or above, for all, or a distribution of
    /// times, such as `exponential = { mean = 0.5 }`, which is re-forming at the rate 2; without this table it re-forms at once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay: Option<Delay>,
    /// Friction force of a detached contact, which slides, with `contacts.delay`; without this table it carries no force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free_friction: Option<FreeFriction>,
}

/// The stiffness of contacts against their threshold: linear between the rows of a table, constant beyond its ends.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["file"] }, { "required": ["threshold", "stiffness"] }]))]
pub struct StiffnessOfThreshold {
    /// CSV with columns `threshold,stiffness`; its path is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Thresholds x_s of the table, in increasing order, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 2), extend("x-dimension" = "length"))]
    pub threshold: Option<Vec<f64>>,
    /// Stiffness k of a contact with each of these thresholds, 0 or above, at least one above 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force/length"))]
    pub stiffness: Option<Vec<f64>>,
}

impl StiffnessOfThreshold {
    fn build(&self) -> Result<Stiffness> {
        let (threshold, stiffness) = match (&self.file, &self.threshold, &self.stiffness) {
            (None, Some(threshold), Some(stiffness)) => (threshold, stiffness),
            (Some(_), None, None) => {
                return Err(Error::invalid("file", "a table read from it", "an unread file"));
            }
            (Some(_), ..) => {
                return Err(Error::invalid("file", "either a file, or threshold and stiffness", "both"));
            }
            (None, None, _) => {
                return Err(Error::invalid("threshold", "thresholds of the table, or a file", "none"));
            }
            (None, Some(_), None) => {
                return Err(Error::invalid("stiffness", "a stiffness for each threshold", "none"));
            }
        };
        if threshold.len() != stiffness.len() {
            let expected = format!("{} stiffnesses, one for each threshold", threshold.len());
            return Err(Error::invalid("stiffness", expected, stiffness.len()));
        }
        let rows = threshold.iter().copied().zip(stiffness.iter().copied()).collect();
        StiffnessTable::new(rows).map(Stiffness::Tabulated)
    }
}

/// Contacts of area A with stiffness k = modulus √A and strength f_s = strength A.
///
/// They break at x_s = f_s/k = (strength/modulus) √A, so that k = κ x_s with κ = modulus²/strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Areas {
    /// Distribution of the contact areas, in units of length²; instead of thresholds and stiffnesses.
    pub law: Law,
    /// Stiffness of a contact divided by the square root of its area, ρc², force per length², above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length^2"))]
    pub modulus: f64,
    /// Force per area at which a contact breaks, above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length^2"))]
    pub strength: f64,
}

impl Default for Contacts {
    fn default() -> Self {
        Self {
            count: 1.0,
            stiffness: None,
            stiffness_per_threshold: None,
            stiffness_of_threshold: None,
            normal_load: None,
            background_force: None,
            background_coefficient: None,
            thresholds: None,
            areas: None,
            reforming: Law::zero(),
            temperature: None,
            ageing: None,
            delay: None,
            free_friction: None,
        }
    }
}

impl Contacts {
    /// Builds the contacts.
    ///
    /// # Errors
    /// An invalid value; thresholds described twice, or not at all.
    pub fn build(&self) -> Result<contacts::Contacts> {
        self.build_with(&mut ())
    }

    /// The same with a monitor, which is asked while distributions are made of many numbers.
    ///
    /// # Errors
    /// As [`Self::build`]; stopped by the monitor.
    pub fn build_with(&self, monitor: &mut dyn Monitor) -> Result<contacts::Contacts> {
        let count = positive("count", self.count)?;
        self.normal_load.map(|load| positive("normal_load", load)).transpose()?;
        self.background()?;
        let reforming = self.reforming.build_with(monitor).map_err(|e| e.under("reforming"))?;
        let (stiffness, thresholds) = match (&self.thresholds, &self.areas) {
            (Some(thresholds), None) => {
                (self.stiffness()?, thresholds.build_with(monitor).map_err(|e| e.under("thresholds"))?)
            }
            (None, Some(areas)) => {
                self.refuse_stiffness()?;
                areas.build_with(monitor).map_err(|e| e.under("areas"))?
            }
            (Some(_), Some(_)) => {
                return Err(Error::invalid("areas", "either thresholds or areas", "both"));
            }
            (None, None) => {
                let expected = "a distribution at which contacts break, such as thresholds.gaussian = { mean = 1, std = 0.1 }";
                return Err(Error::invalid("thresholds", expected, "none"));
            }
        };
        Ok(contacts::Contacts { count, stiffness, thresholds, reforming, rules: self.rules(monitor)? })
    }

    /// The background force B: the one given, or the coefficient times the normal load; 0 by default.
    ///
    /// # Errors
    /// A number below 0, both numbers, or a coefficient without a normal load.
    pub fn background(&self) -> Result<f64> {
        match (self.background_force, self.background_coefficient, self.normal_load) {
            (None, None, _) => Ok(0.0),
            (Some(force), None, _) => not_negative("background_force", force),
            (None, Some(coefficient), Some(load)) => {
                not_negative("background_coefficient", coefficient).map(|coefficient| coefficient * load)
            }
            (None, Some(_), None) => {
                let expected = "a normal load beside background_coefficient, which it multiplies";
                Err(Error::invalid("normal_load", expected, "none"))
            }
            (Some(_), Some(_), _) => {
                let expected = "either background_force or background_coefficient";
                Err(Error::invalid("background_coefficient", expected, "both"))
            }
        }
    }

    /// Whether contacts are time-dependent.
    pub fn are_time_dependent(&self) -> bool {
        self.temperature.is_some() || self.ageing.is_some() || self.delay.is_some()
    }

    fn rules(&self, monitor: &mut dyn Monitor) -> Result<contacts::Rules> {
        let ageing = self.ageing.as_ref().map(|ageing| ageing.build(monitor).map_err(|e| e.under("ageing")));
        let delay = self.delay.as_ref().map(|delay| delay.build(monitor).map_err(|e| e.under("delay")));
        Ok(contacts::Rules {
            temperature: self.temperature,
            ageing: ageing.transpose()?,
            delay: delay.transpose()?.unwrap_or_default(),
            free_friction: self.free_friction.unwrap_or_default(),
            ranks: contacts::SharedRanks::default(),
        })
    }

    fn stiffness(&self) -> Result<Stiffness> {
        match (self.stiffness, self.stiffness_per_threshold, &self.stiffness_of_threshold) {
            (None, None, None) => Ok(Stiffness::Equal(1.0)),
            (Some(k), None, None) => positive("stiffness", k).map(Stiffness::Equal),
            (None, Some(kappa), None) => {
                positive("stiffness_per_threshold", kappa).map(Stiffness::PerThreshold)
            }
            (None, None, Some(table)) => table.build().map_err(|e| e.under("stiffness_of_threshold")),
            (Some(_), Some(_), None) => {
                let expected = "either stiffness or stiffness_per_threshold";
                Err(Error::invalid("stiffness_per_threshold", expected, "both"))
            }
            (_, _, Some(_)) => {
                let expected = "one of stiffness, stiffness_per_threshold and stiffness_of_threshold";
                Err(Error::invalid("stiffness_of_threshold", expected, "another one beside it"))
            }
        }
    }

    fn refuse_stiffness(&self) -> Result<()> {
        let number = |value: Option<f64>| value.map(|value| value.to_string());
        let given = [
            ("stiffness", number(self.stiffness)),
            ("stiffness_per_threshold", number(self.stiffness_per_threshold)),
            ("stiffness_of_threshold", self.stiffness_of_threshold.as_ref().map(|_| "a table".to_owned())),
        ];
        match given.into_iter().find_map(|(key, value)| Some((key, value?))) {
            Some((key, value)) => {
                Err(Error::invalid(key, "no stiffness beside areas, which give one to each contact", value))
            }
            None => Ok(()),
        }
    }
}

impl Areas {
    /// The stiffness of contacts and the distribution of thresholds that follow.
    ///
    /// # Errors
    /// An invalid value.
    pub fn build(&self) -> Result<(Stiffness, SharedLaw)> {
        self.build_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::build`]; stopped by the monitor.
    pub fn build_with(&self, monitor: &mut dyn Monitor) -> Result<(Stiffness, SharedLaw)> {
        let modulus = positive("modulus", self.modulus)?;
        let strength = positive("strength", self.strength)?;
        let areas = self.law.build_with(monitor).map_err(|e| e.under("law"))?;
        let stiffness = in_range("modulus", modulus * modulus / strength, "modulus²/strength")?;
        let factor = in_range("strength", strength / modulus, "strength/modulus")?;
        Ok((Stiffness::PerThreshold(stiffness), Arc::new(Root::new(factor, areas)?)))
    }
}

/// Returns a derived number if it is neither 0 nor infinite nor subnormal.
fn in_range(key: &str, value: f64, name: &str) -> Result<f64> {
    if value.is_normal() {
        return Ok(value);
    }
    Err(Error::invalid(
        key,
        format!("a number for which {name} is neither 0 nor infinite"),
        format!("{value}"),
    ))
}
