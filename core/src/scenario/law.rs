//! Laws, by name.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{exactly_one, positive};
use crate::law::{self, SharedLaw};
use crate::{Error, Result};

/// A law of lengths x ≥ 0, such as `gaussian = { mean = 1.0, std = 0.05 }`.
///
/// A law that would have mass below 0 is cut there and renormalised; its parameters are those before the cut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Law {
    /// The bell curve.
    Gaussian {
        /// Mean before truncation at 0, 0 or above.
        mean: f64,
        /// Standard deviation before truncation, above 0.
        std: f64,
    },
    /// The gamma law.
    Gamma {
        /// Mean, above 0.
        mean: f64,
        /// Standard deviation, above 0.
        std: f64,
    },
    /// A law whose logarithm is Gaussian.
    Lognormal {
        /// Mean of the variable itself, not of its logarithm, above 0.
        mean: f64,
        /// Standard deviation of the variable itself, above 0.
        std: f64,
    },
    /// The same density everywhere between two ends.
    Rectangular {
        /// Lower end, 0 or above.
        min: f64,
        /// Upper end, above the lower.
        max: f64,
    },
    /// One value only.
    Point {
        /// The single value, 0 or above.
        at: f64,
    },
    /// The exponential law.
    Exponential {
        /// Mean, above 0.
        mean: f64,
    },
    /// The Weibull law: survival exp(−(x/scale)^shape).
    Weibull {
        /// Shape k of e^{−(x/λ)^k}, above 0.
        shape: f64,
        /// Scale λ, above 0.
        scale: f64,
    },
    /// A measured law.
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
    /// A weighted sum of laws; points and densities may be mixed.
    Mixture(Vec<Component>),
    /// Thresholds as the drive sees them where every break stretches all other contacts, relaxed at first.
    Renormalised {
        /// Distribution of the thresholds, without point masses.
        law: Box<Law>,
        /// κ, the fraction of its stretch that a breaking contact transfers to all others together, from 0 to below κ_c.
        coupling: f64,
    },
}

/// A law given by numbers: a density in rows, linear between them, or a sample of lengths.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Tabulated {
    /// CSV with columns `stretch,density`, or with one column of samples; its path is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A sample, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Vec<f64>>,
    /// Stretches at which the density is given, in increasing order, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<Vec<f64>>,
    /// The density at these stretches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Vec<f64>>,
}

/// A part of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Weight of a part, above 0; weights sum to 1.
    pub weight: f64,
    /// Distribution of the part.
    pub law: Law,
}

impl Law {
    /// The names of all laws.
    pub const NAMES: [&str; 11] = [
        "gaussian",
        "gamma",
        "lognormal",
        "rectangular",
        "point",
        "exponential",
        "weibull",
        "tabulated",
        "series",
        "mixture",
        "renormalised",
    ];

    /// All at 0.
    pub fn zero() -> Self {
        Self::Point { at: 0.0 }
    }

    /// The law itself.
    ///
    /// # Errors
    /// A parameter that the law cannot have.
    pub fn build(&self) -> Result<SharedLaw> {
        let (name, law) = match *self {
            Self::Gaussian { mean, std } => ("gaussian", shared(law::Gaussian::new(mean, std))),
            Self::Gamma { mean, std } => ("gamma", shared(law::Gamma::new(mean, std))),
            Self::Lognormal { mean, std } => ("lognormal", shared(law::Lognormal::new(mean, std))),
            Self::Rectangular { min, max } => ("rectangular", shared(law::Rectangular::new(min, max))),
            Self::Point { at } => ("point", shared(law::Point::new(at))),
            Self::Exponential { mean } => ("exponential", shared(law::Exponential::new(mean))),
            Self::Weibull { shape, scale } => ("weibull", shared(law::Weibull::new(shape, scale))),
            Self::Tabulated(ref table) => ("tabulated", table.build()),
            Self::Series { ref boundaries, ref coefficients, cut } => {
                ("series", shared(law::Series::new(boundaries, coefficients, cut)))
            }
            Self::Mixture(ref components) => ("mixture", mixture(components)),
            Self::Renormalised { ref law, coupling } => ("renormalised", renormalised(law, coupling)),
        };
        law.map_err(|e| e.under(name))
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
    fn build(&self) -> Result<SharedLaw> {
        let given = [
            ("file", self.file.is_some()),
            ("samples", self.samples.is_some()),
            ("stretch and density", self.stretch.is_some() || self.density.is_some()),
        ];
        exactly_one("", "one of file, samples, or stretch and density", &given)?;
        match (&self.samples, &self.stretch, &self.density) {
            (Some(samples), ..) => shared(law::Tabulated::from_samples(samples)),
            (None, Some(stretch), Some(density)) if stretch.len() == density.len() => {
                let rows: Vec<_> = stretch.iter().copied().zip(density.iter().copied()).collect();
                shared(law::Tabulated::from_density(&rows))
            }
            (None, None, None) => Err(Error::invalid("file", "a table read from it", "an unread file")),
            (None, stretch, density) => {
                let [stretch, density] = [stretch, density].map(|column| column.as_ref().map_or(0, Vec::len));
                Err(Error::invalid("density", format!("{stretch} densities, one for each stretch"), density))
            }
        }
    }
}

fn mixture(components: &[Component]) -> Result<SharedLaw> {
    if components.is_empty() {
        return Err(Error::invalid("", "at least one law", "an empty list"));
    }
    let built = components.iter().enumerate().map(|(i, component)| {
        let weight = positive(&format!("{i}.weight"), component.weight)?;
        let law = component.law.build().map_err(|e| e.under(&format!("{i}.law")))?;
        Ok((weight, law))
    });
    shared(law::Mixture::new(built.collect::<Result<_>>()?))
}

fn renormalised(law: &Law, coupling: f64) -> Result<SharedLaw> {
    let thresholds = law.build().map_err(|e| e.under("law"))?;
    shared(law::Renormalised::new(thresholds, coupling))
}

fn shared<L: law::Law + 'static>(law: Result<L>) -> Result<SharedLaw> {
    law.map(|law| Arc::new(law) as SharedLaw)
}
