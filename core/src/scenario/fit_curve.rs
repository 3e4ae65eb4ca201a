//! The curves of `[fit]`: one given in the table itself, or several as `[[fit.curve]]`.

use std::fmt::{self, Formatter};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{exactly_one, positive};
use crate::fit::{Machine, Measurement};
use crate::{Error, Result};

/// A measured curve, of several that are fitted together.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FitCurve {
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
    /// Positions of the drive at the readings, rising, instead of a file; with a compliance.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub drive: Option<Vec<f64>>,
    /// Measured forces, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
    /// As `fit.compliance`, of this curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/force"))]
    pub compliance: Option<FitCompliance>,
    /// As `fit.offset`, of this curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub offset: Option<f64>,
    /// As `fit.trend`, of this curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force/length"))]
    pub trend: Option<f64>,
    /// As `fit.origin`, of this curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub origin: Option<f64>,
    /// As `fit.range`, of this curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub range: Option<[f64; 2]>,
}

/// A file that was read, and its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitSource {
    /// Its name, as it was given.
    pub name: String,
    /// The SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
}

/// Displacement of the drive against the slider per force: a number above 0, or `"free"`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FitCompliance {
    /// Known, or the first value of a free one.
    Value(f64),
    /// Found by the fit, from a first value that follows from the first slope of the curve.
    Free,
}

/// The text for a free compliance.
const FREE: &str = "free";

impl Serialize for FitCompliance {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => serializer.serialize_f64(*value),
            Self::Free => serializer.serialize_str(FREE),
        }
    }
}

impl<'de> Deserialize<'de> for FitCompliance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct NumberOrFree;
        impl Visitor<'_> for NumberOrFree {
            type Value = FitCompliance;

            fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
                f.write_str("a number above 0 or \"free\"")
            }

            fn visit_f64<E>(self, value: f64) -> std::result::Result<FitCompliance, E> {
                Ok(FitCompliance::Value(value))
            }

            fn visit_i64<E>(self, value: i64) -> std::result::Result<FitCompliance, E> {
                Ok(FitCompliance::Value(value as f64))
            }

            fn visit_str<E: serde::de::Error>(self, value: &str) -> std::result::Result<FitCompliance, E> {
                if value == FREE {
                    return Ok(FitCompliance::Free);
                }
                Err(E::invalid_value(Unexpected::Str(value), &self))
            }
        }
        deserializer.deserialize_any(NumberOrFree)
    }
}

impl JsonSchema for FitCompliance {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "FitCompliance".into()
    }

    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "string"], "pattern": format!("^{FREE}$"), "x-dimension": "length/force" })
    }
}

impl FitCurve {
    /// # Errors
    /// The first invalid value.
    pub(super) fn check(&self, planned: bool) -> Result<()> {
        let given = [
            ("file", self.file.is_some()),
            ("position", self.position.is_some()),
            ("drive", self.drive.is_some()),
        ];
        exactly_one("", "one of file, position and drive", &given)?;
        if self.file.is_some() {
            return Err(Error::invalid("file", "a curve read from it", "an unread file"));
        }
        if let Some(FitCompliance::Value(compliance)) = self.compliance {
            positive("compliance", compliance)?;
        }
        match (&self.drive, self.compliance) {
            (Some(_), None) => {
                let expected =
                    "the compliance of the machine, or \"free\", since positions are those of the drive";
                return Err(Error::invalid("compliance", expected, "none"));
            }
            (None, Some(_)) => {
                let expected = "no compliance: positions are those of the slider (those of the drive have the heading drive)";
                return Err(Error::invalid("compliance", expected, "one"));
            }
            _ => {}
        }
        if self.force.is_none() && !planned {
            let expected = "forces; or fit.reading, for the errors of a measurement that is only planned";
            return Err(Error::invalid("force", expected, "neither"));
        }
        if let Some([from, to]) = self.range
            && (from >= to || !(to - from).is_finite())
        {
            let expected = "two positions, the first below the second";
            return Err(Error::invalid("range", expected, format!("{:?}", [from, to])));
        }
        Ok(())
    }

    /// Whether the fit finds the compliance without a given first value.
    pub(crate) fn has_free_compliance(&self) -> bool {
        self.compliance == Some(FitCompliance::Free)
    }

    /// The measured curve: the readings in the range, averaged, and the machine; `stiffness` is that of all contacts together.
    ///
    /// # Errors
    /// Positions that do not rise, numbers that are not finite; no reading in the range.
    pub(super) fn measurement(&self, average: usize, stiffness: f64) -> Result<Measurement> {
        let positions = self.position.as_ref().or(self.drive.as_ref()).cloned().unwrap_or_default();
        let mut machine = Machine {
            compliance: 0.0,
            background: 0.0,
            offset: self.offset.unwrap_or(0.0),
            trend: self.trend.unwrap_or(0.0),
            origin: self.origin.unwrap_or(0.0),
        };
        if let Some(FitCompliance::Value(compliance)) = self.compliance {
            machine.compliance = compliance;
        }
        let forces = self.force.clone().unwrap_or_default();
        let all = Measurement { positions, forces, machine, ..Measurement::default() };
        // Positions of a noisy sensor need not rise where readings are averaged.
        if average > 1 {
            all.check_readings()?
        } else {
            all.check()?
        }
        let inside = self.range.map_or_else(|| all.clone(), |range| all.within(range));
        if inside.positions.is_empty() {
            let [from, to] = self.range.unwrap_or_default();
            return Err(Error::invalid("range", "one that holds readings", format!("{from} to {to}")));
        }
        let mut averaged = inside.average(average)?;
        if self.has_free_compliance() {
            averaged.machine.compliance = averaged.first_compliance(stiffness);
        }
        Ok(averaged)
    }
}
