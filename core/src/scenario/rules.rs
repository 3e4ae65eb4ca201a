//! `[contacts]`: `ageing` and `delay`.

use std::borrow::Cow;
use std::fmt::{self, Formatter};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::EnumAccessDeserializer;
use serde::de::{DeserializeSeed, EnumAccess, IntoDeserializer, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::{Law, Tabulated, not_negative};
use crate::monitor::Monitor;
use crate::{Result, contacts};

/// How thresholds change with the age of a contact.
pub type Ageing = contacts::AgeingRule<Law>;

/// The time for which a broken contact is detached before it re-forms.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Delay {
    /// The same time τ for all, 0 or above.
    Time(f64),
    /// A time drawn anew at each break.
    #[serde(untagged)]
    Law(Law),
}

impl Delay {
    pub(super) fn build(&self, monitor: &mut dyn Monitor) -> Result<contacts::FreeTime> {
        match self {
            Self::Time(time) => not_negative("time", *time).map(contacts::FreeTime::Fixed),
            Self::Law(law) => law.build_with(monitor).map(contacts::FreeTime::from),
        }
    }

    pub(super) fn tables<'a>(&'a mut self, key: &str, tables: &mut Vec<(String, &'a mut Tabulated)>) {
        if let Self::Law(law) = self {
            law.tables(key, tables);
        }
    }
}

impl<'de> Deserialize<'de> for Delay {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_enum("Delay", &DELAYS, DelayVisitor)
    }
}

/// The names of what a delay may be.
const DELAYS: [&str; Law::NAMES.len() + 1] = {
    let mut names = ["time"; Law::NAMES.len() + 1];
    let mut k = 0;
    while k < Law::NAMES.len() {
        names[k + 1] = Law::NAMES[k];
        k += 1;
    }
    names
};

/// Reads a delay: a time, or a distribution by its name.
struct DelayVisitor;

impl<'de> Visitor<'de> for DelayVisitor {
    type Value = Delay;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("a time or a distribution of times")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> std::result::Result<Delay, A::Error> {
        let (name, variant): (String, _) = access.variant()?;
        if name == "time" {
            return variant.newtype_variant().map(Delay::Time);
        }
        if !Law::NAMES.contains(&name.as_str()) {
            return Err(serde::de::Error::unknown_variant(&name, &DELAYS));
        }
        Law::deserialize(EnumAccessDeserializer::new(NamedVariant { name, variant })).map(Delay::Law)
    }
}

/// A variant whose name has been read.
struct NamedVariant<V> {
    name: String,
    variant: V,
}

impl<'de, V: VariantAccess<'de>> EnumAccess<'de> for NamedVariant<V> {
    type Error = V::Error;
    type Variant = V;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> std::result::Result<(S::Value, V), V::Error> {
        Ok((seed.deserialize(self.name.into_deserializer())?, self.variant))
    }
}

impl JsonSchema for Delay {
    fn schema_name() -> Cow<'static, str> {
        "Delay".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let law = generator.subschema_for::<Law>();
        json_schema!({
            "description": "The time for which a broken contact is detached before it re-forms: one `time`, or a distribution of times.",
            "anyOf": [
                {
                    "type": "object",
                    "properties": { "time": {
                        "description": "Time τ, 0 or above, for which a broken contact is detached before it re-forms, the same for all contacts; instead, a distribution of times can be given, such as `exponential = { mean = 0.5 }`, which is re-forming at the rate 1/`mean`. Without `[contacts.delay]` contacts re-form at once.",
                        "type": "number",
                        "format": "double",
                        "minimum": 0,
                        "x-dimension": "time",
                    } },
                    "required": ["time"],
                    "additionalProperties": false,
                },
                law,
            ],
        })
    }
}

impl Ageing {
    pub(super) fn build(&self, monitor: &mut dyn Monitor) -> Result<contacts::Ageing> {
        self.try_map(|law| law.build_with(monitor).map_err(|e| e.under("mature").under(self.name())))
    }

    pub(super) fn tables<'a>(&'a mut self, key: &str, tables: &mut Vec<(String, &'a mut Tabulated)>) {
        let name = self.name();
        match self {
            Self::Smoluchowski { mature, .. }
            | Self::FrozenRank { mature, .. }
            | Self::MeanField { mature, .. } => {
                mature.tables(&format!("{key}.{name}.mature"), tables);
            }
            Self::Logarithmic { .. } => {}
        }
    }
}
