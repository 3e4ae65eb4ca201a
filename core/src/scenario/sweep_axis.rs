//! The axes of `[sweep]`: lists of values, and ranges.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::ser::SerializeMap as _;
use serde::{Deserialize, Serialize, Serializer};

use super::{logarithmic, size};
use crate::{Error, Result};

/// Axes by key, in the order of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepAxes(pub Vec<(String, SweepAxis)>);

/// The values of a key.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum SweepAxis {
    /// These values.
    List(Vec<SweepValue>),
    /// Evenly spaced ones.
    Range(SweepRange),
}

/// Evenly spaced numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepRange {
    /// The first.
    pub from: f64,
    /// The last.
    pub to: f64,
    /// How many, with both ends.
    pub points: usize,
    /// In what they are evenly spaced.
    pub scale: SweepScale,
}

/// In what the values of a range are evenly spaced.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SweepScale {
    /// In their values.
    #[default]
    Linear,
    /// In their logarithms.
    Log,
}

/// A value of a key.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SweepValue {
    /// Whether something holds.
    Boolean(bool),
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// A word or a text.
    Text(String),
    /// A list, such as the cells of an interface.
    List(Vec<Self>),
    /// A table, such as a distribution.
    Table(SweepTable),
}

/// A table as a value of a key.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable(Vec<(String, SweepValue)>);

impl SweepAxes {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl SweepAxis {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::List(values) => values.len(),
            Self::Range(range) => range.points,
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All values.
    pub fn values(&self) -> Vec<SweepValue> {
        match self {
            Self::List(values) => values.clone(),
            Self::Range(range) => range.numbers().into_iter().map(SweepValue::Number).collect(),
        }
    }

    /// The values, if all are numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Self::List(values) => values.iter().map(SweepValue::number).collect(),
            Self::Range(range) => Some(range.numbers()),
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Range(range) => range.check(),
            Self::List(values) if values.is_empty() => {
                Err(Error::invalid("", "one value or more", "an empty list"))
            }
            Self::List(values) => {
                let mut numbers =
                    values.iter().enumerate().filter_map(|(i, value)| Some((i, value.number()?)));
                match numbers.find(|(_, number)| !number.is_finite()) {
                    None => Ok(()),
                    Some((i, number)) => Err(Error::invalid(i.to_string(), "a finite number", number)),
                }
            }
        }
    }
}

impl SweepRange {
    /// The numbers.
    fn numbers(&self) -> Vec<f64> {
        let Self { from, to, points, scale } = *self;
        let last = points.saturating_sub(1).max(1);
        match scale {
            SweepScale::Log => logarithmic::spaced(from, to, points),
            SweepScale::Linear => (0..points)
                .map(|i| if i == last { to } else { from + (to - from) * (i as f64 / last as f64) })
                .collect(),
        }
    }

    fn check(&self) -> Result<()> {
        let Self { from, to, points, scale } = *self;
        for (key, end) in [("from", from), ("to", to)] {
            if !end.is_finite() || (scale == SweepScale::Log && end <= 0.0) {
                let expected = if scale == SweepScale::Log {
                    "a number above 0 on a logarithmic scale"
                } else {
                    "a finite number"
                };
                return Err(Error::invalid(key, expected, end));
            }
        }
        if points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", points));
        }
        size::check("points", points, size::BYTES_PER_POINT)?;
        if from == to {
            return Err(Error::invalid("to", format!("another number than from = {from}"), to));
        }
        Ok(())
    }
}

impl SweepValue {
    /// The value, if it is a number that floating-point numbers have: whole ones up to 2⁵³.
    pub fn number(&self) -> Option<f64> {
        match *self {
            Self::Whole(number) => (number.unsigned_abs() <= 1 << 53).then_some(number as f64),
            Self::Number(number) => Some(number),
            _ => None,
        }
    }

    /// Text that is the same for values that are: 1 and 1.0.
    pub(super) fn distinct(&self) -> String {
        self.number().map_or_else(|| format!("{self:?}"), |number| format!("{number:?}"))
    }
}

impl Serialize for SweepAxes {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        pairs(&self.0, serializer)
    }
}

impl Serialize for SweepTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        pairs(&self.0, serializer)
    }
}

fn pairs<S: Serializer, T: Serialize>(
    pairs: &[(String, T)],
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(pairs.len()))?;
    pairs.iter().try_for_each(|(key, value)| map.serialize_entry(key, value))?;
    map.end()
}

/// Reads a table in its order.
struct PairsVisitor<T>(std::marker::PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for PairsVisitor<T> {
    type Value = Vec<(String, T)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table with keys of the scenario in quotes")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Self::Value, A::Error> {
        let mut found = Vec::new();
        while let Some(entry) = map.next_entry()? {
            found.push(entry);
        }
        Ok(found)
    }
}

impl<'de> Deserialize<'de> for SweepAxes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_map(PairsVisitor(std::marker::PhantomData)).map(Self)
    }
}

struct AxisVisitor;

impl<'de> Visitor<'de> for AxisVisitor {
    type Value = SweepAxis;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of values, or a table with from, to, points and scale")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> std::result::Result<SweepAxis, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = items.next_element()? {
            values.push(value);
        }
        Ok(SweepAxis::List(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<SweepAxis, A::Error> {
        let (mut from, mut to, mut points, mut scale) = (None, None, None, SweepScale::default());
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "from" => from = Some(map.next_value()?),
                "to" => to = Some(map.next_value()?),
                "points" => points = Some(map.next_value()?),
                "scale" => scale = map.next_value()?,
                other => {
                    let expected =
                        "from, to, points and scale (a dotted key of the scenario stands in quotes)";
                    return Err(A::Error::invalid_value(
                        Unexpected::Other(&format!("the key {other}")),
                        &expected,
                    ));
                }
            }
        }
        let missing = A::Error::missing_field;
        Ok(SweepAxis::Range(SweepRange {
            from: from.ok_or_else(|| missing("from"))?,
            to: to.ok_or_else(|| missing("to"))?,
            points: points.ok_or_else(|| missing("points"))?,
            scale,
        }))
    }
}

impl<'de> Deserialize<'de> for SweepAxis {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(AxisVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = SweepValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value of the key")
    }

    fn visit_bool<E>(self, value: bool) -> std::result::Result<SweepValue, E> {
        Ok(SweepValue::Boolean(value))
    }

    fn visit_i64<E>(self, value: i64) -> std::result::Result<SweepValue, E> {
        Ok(SweepValue::Whole(value))
    }

    fn visit_u64<E>(self, value: u64) -> std::result::Result<SweepValue, E> {
        Ok(i64::try_from(value).map_or(SweepValue::Number(value as f64), SweepValue::Whole))
    }

    fn visit_f64<E>(self, value: f64) -> std::result::Result<SweepValue, E> {
        Ok(SweepValue::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> std::result::Result<SweepValue, E> {
        Ok(SweepValue::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> std::result::Result<SweepValue, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = items.next_element()? {
            values.push(value);
        }
        Ok(SweepValue::List(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<SweepValue, A::Error> {
        PairsVisitor(std::marker::PhantomData)
            .visit_map(map)
            .map(|pairs| SweepValue::Table(SweepTable(pairs)))
    }
}

impl<'de> Deserialize<'de> for SweepValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

impl JsonSchema for SweepAxes {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "SweepAxes".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let axis = generator.subschema_for::<SweepAxis>();
        json_schema!({ "type": "object", "additionalProperties": axis })
    }
}

impl JsonSchema for SweepAxis {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "SweepAxis".into()
    }

    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        let range = json_schema!({
            "type": "object",
            "properties": {
                "from": { "type": "number" },
                "to": { "type": "number" },
                "points": { "type": "integer", "minimum": 2 },
                "scale": { "enum": ["linear", "log"], "default": "linear" },
            },
            "required": ["from", "to", "points"],
            "additionalProperties": false,
        });
        json_schema!({ "anyOf": [{ "type": "array", "minItems": 1 }, range] })
    }
}
