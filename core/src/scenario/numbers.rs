//! The numbers of contacts in a scenario: their keys, and the names that the core has for them.

use super::{Ageing, Delay, Law, Scenario};
use crate::contacts::AgeingRule;
use crate::fit::BACKGROUND;

/// A number of the contacts in a scenario.
#[derive(Debug)]
pub(crate) struct ScenarioNumber<'a> {
    /// Its key, such as `contacts.thresholds.gaussian.mean`.
    pub key: String,
    /// The name of the parameter in [`crate::master::MasterEquation::parameters`], such as `thresholds.mean`, or `background`.
    pub name: String,
    /// Its value.
    pub value: &'a mut f64,
}

impl Scenario {
    /// Every number of the contacts that may be a parameter of the force, in the order of the keys.
    pub(crate) fn numbers(&mut self) -> Vec<ScenarioNumber<'_>> {
        let mut numbers = Vec::new();
        let contacts = &mut self.contacts;
        let mut add = |key: &str, name: &str, value| {
            numbers.push(ScenarioNumber { key: key.to_owned(), name: name.to_owned(), value });
        };
        add("contacts.count", "count", &mut contacts.count);
        match (&mut contacts.stiffness_per_threshold, &contacts.areas) {
            (Some(factor), _) => add("contacts.stiffness_per_threshold", "stiffness_per_threshold", factor),
            (None, None) if contacts.stiffness_of_threshold.is_none() => {
                add("contacts.stiffness", "stiffness", contacts.stiffness.get_or_insert(1.0));
            }
            (None, _) => {}
        }
        if let Some(force) = &mut contacts.background_force {
            add("contacts.background_force", BACKGROUND, force);
        }
        if let Some(heat) = &mut contacts.temperature {
            add("contacts.temperature.energy", "temperature.energy", &mut heat.energy);
            add("contacts.temperature.attempt_rate", "temperature.attempt_rate", &mut heat.attempt_rate);
        }
        let times = match &mut contacts.delay {
            Some(Delay::Time(time)) => {
                add("contacts.delay.time", "delay", time);
                None
            }
            Some(Delay::Law(law)) => Some(law),
            None => None,
        };
        if let Some(velocity) = self.fit.as_mut().and_then(|fit| fit.velocity.as_mut()) {
            add("fit.velocity", "velocity", velocity);
        }
        if let Some(law) = &mut contacts.thresholds {
            law.numbers(("contacts.thresholds", "thresholds"), &mut numbers);
        }
        contacts.reforming.numbers(("contacts.reforming", "reforming"), &mut numbers);
        self.initial.numbers(("initial", "initial"), &mut numbers);
        if let Some(law) = times {
            law.numbers(("contacts.delay", "delay"), &mut numbers);
        }
        if let Some(ageing) = &mut contacts.ageing {
            of_ageing(ageing, &mut numbers);
        }
        numbers
    }
}

fn of_ageing<'a>(ageing: &'a mut Ageing, numbers: &mut Vec<ScenarioNumber<'a>>) {
    let table = format!("contacts.ageing.{}", ageing.name());
    let mut add = |name: &str, value: &'a mut f64| {
        numbers.push(ScenarioNumber {
            key: format!("{table}.{name}"),
            name: format!("ageing.{name}"),
            value,
        });
    };
    let mature = match ageing {
        AgeingRule::Logarithmic { growth, time } => {
            add("growth", growth);
            add("time", time);
            None
        }
        AgeingRule::FrozenRank { mature, time } => {
            add("time", time);
            Some(mature)
        }
        AgeingRule::Smoluchowski { mature, diffusion } | AgeingRule::MeanField { mature, diffusion } => {
            add("diffusion", diffusion);
            Some(mature)
        }
    };
    if let Some(mature) = mature {
        mature.numbers((&format!("{table}.mature"), "ageing.mature"), numbers);
    }
}

impl Law {
    /// Adds the parameters of a named distribution, or those of the components of a mixture, under a key and a name.
    fn numbers<'a>(&'a mut self, (key, name): (&str, &str), numbers: &mut Vec<ScenarioNumber<'a>>) {
        let key = format!("{key}.{}", self.name());
        if let Self::Mixture(components) = self {
            for (i, component) in components.iter_mut().enumerate() {
                component.law.numbers((&format!("{key}.{i}.law"), &format!("{name}.{i}")), numbers);
            }
            return;
        }
        for (parameter, value) in self.parameters_mut() {
            numbers.push(ScenarioNumber {
                key: format!("{key}.{parameter}"),
                name: format!("{name}.{parameter}"),
                value,
            });
        }
    }
}
