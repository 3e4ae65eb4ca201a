//! What `[sweep]` keeps of a case: an entry of the summary, or a variable on a common grid.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error as _, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};

use super::sweep_axis::SweepAxis;
use crate::{Error, Result};

/// What is kept of each case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SweepKept {
    /// An entry of the summary, by its path.
    Entry(String),
    /// A variable of the result along one coordinate.
    Curve(SweepCurve),
}

/// A variable of the result, interpolated at common places.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepCurve {
    /// Name of the variable.
    pub variable: String,
    /// The places along its coordinate, rising.
    pub at: SweepAxis,
}

impl SweepKept {
    /// The least number of values that it has of a case.
    pub(super) fn least(&self) -> usize {
        match self {
            Self::Entry(_) => 1,
            Self::Curve(curve) => curve.at.len(),
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let Self::Curve(curve) = self else { return Ok(()) };
        curve.at.check().map_err(|error| error.under("at"))?;
        match curve.at.numbers() {
            Some(places) if places.windows(2).all(|pair| pair[0] < pair[1]) => Ok(()),
            _ => Err(Error::invalid("at", "rising numbers", "others")),
        }
    }
}

struct KeptVisitor;

impl<'de> Visitor<'de> for KeptVisitor {
    type Value = SweepKept;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a path of the summary in quotes, or a table with variable and at")
    }

    fn visit_str<E>(self, path: &str) -> std::result::Result<SweepKept, E> {
        Ok(SweepKept::Entry(path.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<SweepKept, A::Error> {
        let (mut variable, mut at) = (None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "variable" => variable = Some(map.next_value()?),
                "at" => at = Some(map.next_value()?),
                other => {
                    let found = format!("the key {other}");
                    return Err(A::Error::invalid_value(Unexpected::Other(&found), &"variable and at"));
                }
            }
        }
        Ok(SweepKept::Curve(SweepCurve {
            variable: variable.ok_or_else(|| A::Error::missing_field("variable"))?,
            at: at.ok_or_else(|| A::Error::missing_field("at"))?,
        }))
    }
}

impl<'de> Deserialize<'de> for SweepKept {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(KeptVisitor)
    }
}

impl JsonSchema for SweepKept {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "SweepKept".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let at = generator.subschema_for::<SweepAxis>();
        json_schema!({ "anyOf": [
            { "type": "string" },
            {
                "type": "object",
                "properties": { "variable": { "type": "string" }, "at": at },
                "required": ["variable", "at"],
                "additionalProperties": false,
            },
        ] })
    }
}
