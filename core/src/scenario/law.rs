//! Probability distributions, by name.

use std::sync::Arc;

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::{exactly_one, positive};
use crate::law::{self, SharedLaw, parametric_distributions};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A parametric family of distributions.
#[derive(Debug, Clone, Copy)]
pub struct ParametricFamily {
    /// Its name, as in a scenario.
    pub name: &'static str,
    /// Lowest and highest coefficient of variation of its members, before truncation at 0.
    pub widths: [f64; 2],
    /// The member of a length scale near its mean and a coefficient of variation; the nearest one outside of
    /// `widths`.
    pub member: fn(scale: f64, width: f64) -> Law,
}

/// Adds the ranges of the parameters of distributions to their schema: positions are 0 or above, widths, scales and shapes
/// above 0.
fn with_ranges(schema: &mut Schema) {
    let laws = schema.get_mut("oneOf").and_then(|laws| laws.as_array_mut()).into_iter().flatten();
    for (name, law) in laws.filter_map(|law| law.get_mut("properties")?.as_object_mut()?.iter_mut().next()) {
        let parameters = law.get_mut("properties").and_then(|all| all.as_object_mut()).into_iter().flatten();
        for (parameter, schema) in parameters.filter(|(_, schema)| schema["type"] == "number") {
            let from_zero = matches!(parameter.as_str(), "min" | "at" | "cut" | "coupling")
                || (name.as_str(), parameter.as_str()) == ("gaussian", "mean");
            schema[if from_zero { "minimum" } else { "exclusiveMinimum" }] = 0.into();
        }
    }
}

/// Defines [`Law`] and what depends on the declarations of the parametric distributions.
macro_rules! define_law {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $key:literal, $widths:expr, |$scale:ident, $width:ident| {
            $($(#[doc = $parameter_doc:literal])+ $parameter:ident: $value:expr,)+
        }
        refuses $refused:literal
        shows $example:literal
    )+) => {
        /// A distribution of lengths x ≥ 0, such as `gaussian = { mean = 1.0, std = 0.05 }`.
        ///
        /// A distribution that would have mass below 0 is truncated there and renormalised; its parameters are those
        /// before truncation.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        #[schemars(transform = with_ranges)]
        #[non_exhaustive]
        pub enum Law {
            $(
                $(#[doc = $doc])+
                $name { $($(#[doc = $parameter_doc])+ $parameter: f64,)+ },
            )+
            /// A measured distribution.
            Tabulated(Tabulated),
            /// A density that is a Legendre series on each of some cells; it is normalised.
            Series {
                /// Boundaries of cells, in increasing order, from 0 or above.
                boundaries: Vec<f64>,
                /// For each cell a list of up to 16 Legendre coefficients of the density; it is normalised.
                coefficients: Vec<Vec<f64>>,
                /// Probability of an infinite tail that was truncated at the last boundary, at most 1e-9.
                #[serde(default)]
                cut: f64,
            },
            /// A weighted sum of distributions; point masses and densities may be mixed.
            Mixture(#[schemars(length(min = 1))] Vec<Component>),
            /// Thresholds as functions of the drive where every break stretches all other contacts, relaxed at first.
            Renormalised {
                /// Distribution of the thresholds, without point masses.
                law: Box<Law>,
                /// κ, the fraction of its stretch that a breaking contact transfers to all others together, from 0 to below κ_c.
                coupling: f64,
            },
        }

        impl Law {
            /// The names of all distributions.
            pub const NAMES: &[&str] = &[$($key,)+ "tabulated", "series", "mixture", "renormalised"];

            /// The parametric families.
            pub const FAMILIES: &[ParametricFamily] = &[$(ParametricFamily {
                name: $key,
                widths: $widths,
                member: |$scale, $width| Self::$name { $($parameter: $value),+ },
            }),+];

            /// The name, as in a scenario.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name { .. } => $key,)+
                    Self::Tabulated(_) => "tabulated",
                    Self::Series { .. } => "series",
                    Self::Mixture(_) => "mixture",
                    Self::Renormalised { .. } => "renormalised",
                }
            }

            /// The parameters of a parametric distribution, with their names.
            pub(super) fn parameters_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
                match self {
                    $(Self::$name { $($parameter),+ } => vec![$((stringify!($parameter), $parameter)),+],)+
                    _ => Vec::new(),
                }
            }

            /// The distribution itself.
            ///
            /// # Errors
            /// A parameter that the distribution cannot have.
            pub fn build(&self) -> Result<SharedLaw> {
                self.build_with(&mut ())
            }

            /// The same with a monitor.
            ///
            /// # Errors
            /// As [`Self::build`]; stopped by the monitor.
            pub fn build_with(&self, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
                let built = match self {
                    $(&Self::$name { $($parameter),+ } => shared(law::$name::new($($parameter),+)),)+
                    Self::Tabulated(table) => table.build(monitor),
                    Self::Series { boundaries, coefficients, cut } => {
                        shared(law::Series::new_with(boundaries, coefficients, *cut, monitor))
                    }
                    Self::Mixture(components) => mixture(components, monitor),
                    Self::Renormalised { law, coupling } => renormalised(law, *coupling, monitor),
                };
                built.map_err(|error| error.under(self.name()))
            }
        }
    };
}

parametric_distributions!(define_law);

/// A distribution given by numbers: a density in rows, linear between them, or a sample of lengths.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["file"] }, { "required": ["samples"] }, { "required": ["stretch", "density"] }
]))]
pub struct Tabulated {
    /// CSV with columns `stretch,density`, or with one column of samples; its path is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A sample, instead of a file; its kernel density estimate, unless `exact`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub samples: Option<Vec<f64>>,
    /// Bandwidth of the kernel density estimate of a sample; default: Silverman's rule.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length", "exclusiveMinimum" = 0))]
    pub bandwidth: Option<f64>,
    /// Whether the quantiles of a sample are linear between its values, instead of a kernel density estimate.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exact: bool,
    /// Stretches at which the density is given, in increasing order, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<Vec<f64>>,
    /// The density at these stretches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Vec<f64>>,
}

/// A component of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Weight of the component, above 0; weights sum to 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub weight: f64,
    /// Distribution of the component.
    pub law: Law,
}

impl Law {
    /// A point mass at 0.
    pub fn zero() -> Self {
        Self::Point { at: 0.0 }
    }

    pub(super) fn tables<'a>(&'a mut self, key: &str, tables: &mut Vec<(String, &'a mut Tabulated)>) {
        match self {
            Self::Tabulated(table) => tables.push((format!("{key}.tabulated"), table)),
            Self::Mixture(components) => {
                for (i, component) in components.iter_mut().enumerate() {
                    component.law.tables(&format!("{key}.mixture.{i}.law"), tables);
                }
            }
            Self::Renormalised { law, .. } => law.tables(&format!("{key}.renormalised.law"), tables),
            _ => {}
        }
    }
}

impl Tabulated {
    fn build(&self, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
        let given = [
            ("file", self.file.is_some()),
            ("samples", self.samples.is_some()),
            ("stretch and density", self.stretch.is_some() || self.density.is_some()),
        ];
        exactly_one("", "one of file, samples, or stretch and density", &given)?;
        self.check_smoothing()?;
        match (&self.samples, &self.stretch, &self.density) {
            (Some(samples), ..) if self.exact => shared(law::Tabulated::from_samples_with(samples, monitor)),
            (Some(samples), ..) => law::kernel_density_with(samples, self.bandwidth, monitor),
            (None, Some(stretch), Some(density)) if stretch.len() == density.len() => {
                let rows: Vec<_> = stretch.iter().copied().zip(density.iter().copied()).collect();
                shared(law::Tabulated::from_density_with(&rows, monitor))
            }
            (None, None, None) => Err(Error::invalid("file", "a table read from it", "an unread file")),
            (None, stretch, density) => {
                let [stretch, density] = [stretch, density].map(|column| column.as_ref().map_or(0, Vec::len));
                Err(Error::invalid("density", format!("{stretch} densities, one for each stretch"), density))
            }
        }
    }

    /// `bandwidth` and `exact` say how a sample becomes a distribution; a density needs neither.
    fn check_smoothing(&self) -> Result<()> {
        let sampled = self.samples.is_some();
        match self.bandwidth {
            Some(given) if !sampled => Err(Error::invalid("bandwidth", "none for a density", given)),
            Some(given) if self.exact => Err(Error::invalid("bandwidth", "none beside exact", given)),
            _ if self.exact && !sampled => Err(Error::invalid("exact", "none for a density", "true")),
            _ => Ok(()),
        }
    }
}

fn mixture(components: &[Component], monitor: &mut dyn Monitor) -> Result<SharedLaw> {
    if components.is_empty() {
        return Err(Error::invalid("", "at least one law", "an empty list"));
    }
    let built = components.iter().enumerate().map(|(i, component)| {
        let weight = positive(&format!("{i}.weight"), component.weight)?;
        let law = component.law.build_with(monitor).map_err(|e| e.under(&format!("{i}.law")))?;
        Ok((weight, law))
    });
    shared(law::Mixture::new(built.collect::<Result<_>>()?))
}

fn renormalised(law: &Law, coupling: f64, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
    let thresholds = law.build_with(monitor).map_err(|e| e.under("law"))?;
    shared(law::Renormalised::new(thresholds, coupling))
}

fn shared<L: law::Law + 'static>(law: Result<L>) -> Result<SharedLaw> {
    law.map(|law| Arc::new(law) as SharedLaw)
}
