//! The parameters of contacts by name: what derivatives, and fits, vary.

use std::fmt::{self, Display, Formatter};

use super::MasterEquation;
use crate::contacts::{Ageing, AgeingRule, Contacts, FreeTime, Initial, Stiffness};
use crate::law::{Parameter, SharedLaw};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// The distributions by name.
const LAWS: [&str; 5] = ["thresholds", "reforming", "initial", "ageing.mature", "delay"];

/// The other numbers by name.
const NUMBERS: [&str; 10] = [
    "count",
    "stiffness",
    "stiffness_per_threshold",
    "temperature.energy",
    "temperature.attempt_rate",
    "ageing.growth",
    "ageing.time",
    "ageing.diffusion",
    "delay",
    "velocity",
];

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Named<'a> {
    /// A distribution and its parameter.
    OfLaw(&'static str, &'a str),
    /// A number of the contacts, or the velocity.
    Number(&'static str),
}

impl Display for Named<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::OfLaw(owner, name) => write!(f, "{owner}.{name}"),
            Self::Number(name) => f.write_str(name),
        }
    }
}

/// Contacts, their start and their velocity.
#[derive(Clone)]
pub(super) struct Description {
    contacts: Contacts,
    initial: Initial,
    velocity: Option<f64>,
}

impl Description {
    /// The distribution of this name, if there is one.
    pub(super) fn law(&mut self, name: &str) -> Option<&mut SharedLaw> {
        match name {
            "thresholds" => Some(&mut self.contacts.thresholds),
            "reforming" => Some(&mut self.contacts.reforming),
            "initial" => Some(&mut self.initial.law),
            "delay" => match &mut self.contacts.rules.delay {
                FreeTime::Distributed(law) => Some(law),
                FreeTime::Fixed(_) => None,
            },
            _ => match &mut self.contacts.rules.ageing {
                Some(
                    AgeingRule::Smoluchowski { mature, .. }
                    | AgeingRule::FrozenRank { mature, .. }
                    | AgeingRule::MeanField { mature, .. },
                ) => Some(mature),
                _ => None,
            },
        }
    }

    /// The number of this name, if the contacts have it.
    fn number(&mut self, name: &str) -> Option<&mut f64> {
        let rules = &mut self.contacts.rules;
        match (name, &mut self.contacts.stiffness, &mut rules.ageing) {
            ("count", ..) => Some(&mut self.contacts.count),
            ("stiffness", Stiffness::Equal(stiffness), _) => Some(stiffness),
            ("stiffness_per_threshold", Stiffness::PerThreshold(factor), _) => Some(factor),
            ("temperature.energy", ..) => rules.temperature.as_mut().map(|heat| &mut heat.energy),
            ("temperature.attempt_rate", ..) => rules.temperature.as_mut().map(|heat| &mut heat.attempt_rate),
            ("ageing.growth", _, Some(Ageing::Logarithmic { growth, .. })) => Some(growth),
            ("ageing.time", _, Some(Ageing::Logarithmic { time, .. } | Ageing::FrozenRank { time, .. })) => {
                Some(time)
            }
            (
                "ageing.diffusion",
                _,
                Some(Ageing::Smoluchowski { diffusion, .. } | Ageing::MeanField { diffusion, .. }),
            ) => Some(diffusion),
            ("delay", ..) => match &mut rules.delay {
                FreeTime::Fixed(time) if *time > 0.0 => Some(time),
                _ => None,
            },
            ("velocity", ..) => self.velocity.as_mut(),
            _ => None,
        }
    }

    /// The same with another value of a parameter.
    ///
    /// # Errors
    /// A value outside of the range of the parameter of a distribution.
    pub(super) fn with(mut self, named: Named<'_>, value: f64) -> Result<Self> {
        match named {
            Named::OfLaw(owner, name) => {
                if let Some(law) = self.law(owner) {
                    *law = law.with_parameter(name, value).map_err(|error| error.under(owner))?;
                }
            }
            Named::Number(name) => {
                if let Some(number) = self.number(name) {
                    *number = value;
                }
            }
        }
        Ok(self)
    }

    /// The same but that another velocity leaves the advance for which contacts are free for a fixed time as it is.
    ///
    /// # Errors
    /// Those of [`Self::with`].
    pub(super) fn vary(mut self, named: Named<'_>, value: f64) -> Result<Self> {
        if named == Named::Number("velocity")
            && let FreeTime::Fixed(time) = &mut self.contacts.rules.delay
        {
            *time *= self.velocity.map_or(1.0, |before| before / value);
        }
        self.with(named, value)
    }

    /// The value of a parameter; NaN if there is none.
    pub(super) fn value(&self, named: Named<'_>) -> f64 {
        let mut all = self.clone();
        let value = match named {
            Named::OfLaw(owner, name) => all.law(owner).and_then(|law| {
                law.parameters().into_iter().find(|parameter| parameter.name == name).map(|p| p.value)
            }),
            Named::Number(name) => all.number(name).copied(),
        };
        value.unwrap_or(f64::NAN)
    }

    /// The master equation.
    ///
    /// # Errors
    /// Those of [`MasterEquation::new`] and [`MasterEquation::at`].
    pub(super) fn equation(self, monitor: &mut dyn Monitor) -> Result<MasterEquation> {
        match self.velocity {
            Some(velocity) => MasterEquation::at_with(self.contacts, &self.initial, velocity, monitor),
            None => MasterEquation::new_with(self.contacts, &self.initial, monitor),
        }
    }
}

impl MasterEquation {
    /// The parameters by which the force on a pull has a derivative, with their values: those of the distributions
    /// (`thresholds.mean`, `reforming.std`, `initial.max`, `ageing.mature.mean`), `count`, `stiffness` or
    /// `stiffness_per_threshold`, and the numbers of the rules, as far as the contacts have them (`temperature.energy`,
    /// `temperature.attempt_rate`, `ageing.growth`, `ageing.time`, `ageing.diffusion`, `delay`, or `delay.mean` of a
    /// distribution, `velocity`). The position of a point mass, a parameter that a table would have, and a number that is 0 are none.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut all = self.description();
        let mut found = Vec::new();
        for owner in LAWS {
            let Some(law) = all.law(owner) else { continue };
            for parameter in law.parameters() {
                if law.survival_derivative(&parameter.name).is_ok() {
                    found.push(Parameter { name: format!("{owner}.{}", parameter.name).into(), ..parameter });
                }
            }
        }
        for name in NUMBERS {
            if let Some(&mut value) = all.number(name).filter(|value| **value != 0.0) {
                found.push(Parameter { name: name.into(), value });
            }
        }
        found
    }

    /// The same contacts with other values of some of [`Self::parameters`].
    ///
    /// # Errors
    /// An unknown parameter; those of [`Self::new`] and [`Self::at`]; stopped by the monitor.
    pub fn with_parameters(&self, values: &[(&str, f64)], monitor: &mut dyn Monitor) -> Result<Self> {
        self.described_with(values)?.equation(monitor)
    }

    /// Contacts with other values of some of [`Self::parameters`], before anything is solved for them.
    ///
    /// # Errors
    /// An unknown parameter; a value outside of the range of a parameter of a distribution.
    pub(crate) fn contacts_with(&self, values: &[(&str, f64)]) -> Result<Contacts> {
        Ok(self.described_with(values)?.contacts)
    }

    fn described_with<'a>(&self, values: &[(&'a str, f64)]) -> Result<Description> {
        let named = values.iter().map(|&(name, value)| Ok((self.named(name)?, value)));
        let named = named.collect::<Result<Vec<_>>>()?;
        let mut all = self.description();
        for owner in LAWS {
            let of_law = |&(named, value): &(Named<'a>, f64)| match named {
                Named::OfLaw(of, name) if of == owner => Some((name, value)),
                _ => None,
            };
            let values: Vec<(&str, f64)> = named.iter().filter_map(of_law).collect();
            if let (false, Some(law)) = (values.is_empty(), all.law(owner)) {
                *law = law.with_parameters(&values).map_err(|error| error.under(owner))?;
            }
        }
        for &(named, value) in named.iter().filter(|(named, _)| matches!(named, Named::Number(_))) {
            all = all.with(named, value)?;
        }
        Ok(all)
    }

    /// The same contacts with another distribution of thresholds.
    ///
    /// # Errors
    /// Those of [`Self::new`] and [`Self::at`]; stopped by the monitor.
    pub fn with_thresholds(&self, law: SharedLaw, monitor: &mut dyn Monitor) -> Result<Self> {
        let mut all = self.description();
        all.contacts.thresholds = law;
        all.equation(monitor)
    }

    /// Whether a parameter is above 0 by its meaning.
    ///
    /// # Errors
    /// An unknown parameter.
    pub(crate) fn is_positive(&self, name: &str) -> Result<bool> {
        Ok(match self.named(name)? {
            Named::Number(_) => true,
            Named::OfLaw(owner, inner) => {
                self.description().law(owner).is_some_and(|law| law.with_parameter(inner, 0.0).is_err())
            }
        })
    }

    pub(super) fn description(&self) -> Description {
        Description {
            contacts: self.contacts.clone(),
            initial: self.initial.clone(),
            velocity: self.velocity,
        }
    }

    /// What a name stands for.
    ///
    /// # Errors
    /// A name that is none of [`Self::parameters`] nor of a point mass.
    pub(super) fn named<'a>(&self, name: &'a str) -> Result<Named<'a>> {
        let mut all = self.description();
        let of_law = LAWS.into_iter().find_map(|owner| {
            let inner = name.strip_prefix(owner)?.strip_prefix('.')?;
            let known = all.law(owner)?.parameters().iter().any(|parameter| parameter.name == inner);
            known.then_some(Named::OfLaw(owner, inner))
        });
        let number = NUMBERS.into_iter().find(|number| *number == name && all.number(number).is_some());
        of_law.or(number.map(Named::Number)).ok_or_else(|| {
            let names: Vec<_> = self.parameters().into_iter().map(|parameter| parameter.name).collect();
            Error::invalid("parameter", format!("one of {}", names.join(", ")), name)
        })
    }
}
