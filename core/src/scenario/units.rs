//! `[units]`: labels, never conversions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::record::Quantity;

/// Names of the units in which the scenario is written, empty where dimensionless; numbers are never converted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Units {
    /// Label of lengths on axes and in files, such as `µm`; without it they are dimensionless; numbers are never converted.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub length: String,
    /// Label of forces, such as `mN`.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub force: String,
    /// Label of times, such as `s`.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub time: String,
}

impl Units {
    /// Whether no unit is named.
    pub fn is_dimensionless(&self) -> bool {
        *self == Self::default()
    }

    /// The label of `quantity`, `1` for a pure number.
    pub fn label(&self, quantity: Quantity) -> String {
        match quantity {
            Quantity::Length => over(&self.length, ""),
            Quantity::Force => over(&self.force, ""),
            Quantity::ForceSquared => power(&self.force, '²'),
            Quantity::ForceSquaredLength => match self.force.as_str() {
                "" => over(&self.length, ""),
                force => times(&power(force, '²'), &self.length),
            },
            Quantity::PerLength => over("", &self.length),
            Quantity::Stiffness => over(&self.force, &self.length),
            Quantity::Energy => times(&self.force, &self.length),
            Quantity::Area => power(&self.length, '²'),
            Quantity::Volume => power(&self.length, '³'),
            Quantity::Time => over(&self.time, ""),
            Quantity::Velocity => over(&self.length, &self.time),
            Quantity::PerTime => over("", &self.time),
            Quantity::Number | Quantity::Count | Quantity::Flag => over("", ""),
        }
    }
}

/// What holds the parts of a compound unit together.
const COMPOUND: [char; 4] = [' ', '/', '*', '·'];

fn over(numerator: &str, denominator: &str) -> String {
    let numerator = if numerator.is_empty() { "1" } else { numerator };
    match denominator {
        "" => numerator.to_owned(),
        compound if compound.contains(COMPOUND) => format!("{numerator}/({compound})"),
        simple => format!("{numerator}/{simple}"),
    }
}

fn power(unit: &str, exponent: char) -> String {
    match unit {
        "" => "1".to_owned(),
        compound if compound.contains(COMPOUND) => format!("({compound}){exponent}"),
        simple => format!("{simple}{exponent}"),
    }
}

fn times(one: &str, other: &str) -> String {
    match (one, other) {
        ("", "") => "1".to_owned(),
        ("", unit) | (unit, "") => unit.to_owned(),
        _ => format!("{one}·{other}"),
    }
}
