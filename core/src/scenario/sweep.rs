//! `[sweep]`: the values of keys for which a scenario is computed, and what is kept of each case.

use std::collections::HashSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sweep_axis::{SweepAxes, SweepAxis, SweepValue};
use super::sweep_kept::SweepKept;
use super::{Scenario, exactly_one};
use crate::{Error, Result};

/// A parameter sweep: the task of the scenario is computed for every combination of the values of its axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Axes by key of the scenario, in quotes, as in `"block.stiffness" = [0.5, 1.0]`: a list of values, or
    /// `{ from, to, points, scale }` with both ends. The last axis runs fastest.
    #[serde(default, skip_serializing_if = "SweepAxes::is_empty")]
    #[schemars(extend("x-dimension" = "any"))]
    pub over: SweepAxes,
    /// Lists of keys of `over` whose values are taken together, the first with the first, as one axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub zip: Vec<Vec<String>>,
    /// Number of replicas of each case: 0, 1, … is added to every seed of the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "x-dimension" = "1"))]
    pub repeat: Option<usize>,
    /// What is kept of each case: paths of the summary, such as `"static_friction.force"` or `"regime"`, with all that is
    /// below them; variables of `result.nc` on a common grid, as `{ variable = "force", at = { from, to, points } }`.
    #[schemars(extend("minItems" = 1))]
    pub keep: Vec<SweepKept>,
}

/// One dimension of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepDimension {
    /// Its keys, each with its values; several for zipped axes, none for replicas.
    pub keys: Vec<(String, Vec<SweepValue>)>,
    /// Number of values.
    pub length: usize,
}

/// Tables whose keys change no number.
const LABELS: [&str; 3] = ["title", "units", "sweep"];

impl Sweep {
    /// Largest number of cases.
    pub const MOST: f64 = 1e7;
    /// Largest number of axes.
    pub const AXES: usize = 10;
    /// Largest number of kept values: 8 TB, beyond which they were asked for by mistake.
    pub const VALUES: f64 = 1e12;

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        for (i, (key, axis)) in self.over.0.iter().enumerate() {
            let found =
                |expected: &str, found: &str| Err(Error::invalid(format!("over.{key}"), expected, found));
            let first = key.split('.').next().unwrap_or_default();
            if LABELS.contains(&first) {
                let what = if first == "sweep" { "one of the sweep itself" } else { "a label" };
                return found("a key that the results depend on", what);
            }
            if let Some((other, _)) = self.over.0[..i].iter().find(|(other, _)| excludes(key, other)) {
                return found("keys that do not exclude one another", &format!("{key} beside {other}"));
            }
            axis.check().map_err(|error| error.under(&format!("over.{key}")))?;
        }
        exactly_one(
            "over",
            "one axis or more, or repeat",
            &[("axes", !self.over.is_empty() || self.repeat.is_some())],
        )?;
        if self.over.0.len() > Self::AXES {
            return Err(Error::invalid("over", format!("{} axes or fewer", Self::AXES), self.over.0.len()));
        }
        self.check_zip()?;
        self.check_differences()?;
        if self.repeat == Some(0) {
            return Err(Error::invalid("repeat", "1 or more", 0));
        }
        if self.keep.is_empty() {
            return Err(Error::invalid("keep", "the name of a number of the summary or more", "none"));
        }
        self.keep
            .iter()
            .enumerate()
            .try_for_each(|(i, kept)| kept.check().map_err(|e| e.under(&format!("keep.{i}"))))?;
        self.check_size()
    }

    /// Every zipped key is an axis, in one list only, and the axes of a list have the same number of values.
    fn check_zip(&self) -> Result<()> {
        let mut seen: Vec<&String> = Vec::new();
        for (i, keys) in self.zip.iter().enumerate() {
            let name = format!("zip.{i}");
            if keys.len() < 2 {
                return Err(Error::invalid(name, "two keys of over or more", keys.len()));
            }
            let mut first: Option<(&str, usize)> = None;
            for key in keys {
                let Some(axis) = self.over.get(key) else {
                    return Err(Error::invalid(name, "keys of over", format!("\"{key}\"")));
                };
                if seen.contains(&key) {
                    return Err(Error::invalid(name, "each key once", format!("\"{key}\" twice")));
                }
                seen.push(key);
                let (other, length) = *first.get_or_insert((key, axis.len()));
                if axis.len() != length {
                    let found = format!("{length} of {other} and {} of {key}", axis.len());
                    return Err(Error::invalid(name, "axes with the same number of values", found));
                }
            }
        }
        Ok(())
    }

    /// No value of an axis comes twice, unless it is zipped with others, and each variable is kept once.
    fn check_differences(&self) -> Result<()> {
        for (key, axis) in
            self.over.0.iter().filter(|(key, _)| !self.zip.iter().any(|keys| keys.contains(key)))
        {
            let SweepAxis::List(values) = axis else { continue };
            let mut seen = HashSet::new();
            for (i, value) in values.iter().enumerate() {
                if !seen.insert(value.distinct()) {
                    return Err(Error::invalid(
                        format!("over.{key}.{i}"),
                        "values that differ",
                        "the same twice",
                    ));
                }
            }
        }
        let curves = self.keep.iter().enumerate().filter_map(|(i, kept)| match kept {
            SweepKept::Curve(curve) => Some((i, &curve.variable)),
            SweepKept::Entry(_) => None,
        });
        let mut seen = HashSet::new();
        for (i, variable) in curves {
            if !seen.insert(variable) {
                let found = format!("\"{variable}\" twice");
                return Err(Error::invalid(format!("keep.{i}"), "each variable once, on one grid", found));
            }
        }
        Ok(())
    }

    /// The number of cases, and of values that are kept.
    fn check_size(&self) -> Result<()> {
        let cases = self.count();
        if cases > Self::MOST {
            let expected = format!("{:e} cases or fewer", Self::MOST);
            return Err(Error::invalid("", expected, format!("{cases:e} cases")));
        }
        let each: usize = self.keep.iter().map(SweepKept::least).sum();
        let values = cases * each as f64;
        if values > Self::VALUES {
            let expected = format!("{:e} values of all cases or fewer", Self::VALUES);
            return Err(Error::invalid("keep", expected, format!("{values:e} values of {cases:e} cases")));
        }
        Ok(())
    }

    /// Number of cases. It may be too large for an integer.
    pub fn count(&self) -> f64 {
        let zipped = |key: &String| self.zip.iter().any(|keys| keys[1..].contains(key));
        let axes = self.over.0.iter().filter(|(key, _)| !zipped(key));
        axes.map(|(_, axis)| axis.len() as f64).product::<f64>() * self.repeat.unwrap_or(1) as f64
    }

    /// The dimensions of a valid sweep, slowest first; that of replicas is the last.
    pub fn dimensions(&self) -> Vec<SweepDimension> {
        let mut dimensions = Vec::new();
        for (key, axis) in &self.over.0 {
            let group = self.zip.iter().find(|keys| keys.contains(key));
            let alone = vec![key.clone()];
            let keys = group.unwrap_or(&alone);
            // Zipped axes are where the first of them is.
            if self
                .over
                .0
                .iter()
                .find(|(other, _)| keys.contains(other))
                .is_some_and(|(first, _)| first != key)
            {
                continue;
            }
            let values = |key: &String| self.over.get(key).map(|axis| (key.clone(), axis.values()));
            dimensions
                .push(SweepDimension { keys: keys.iter().filter_map(values).collect(), length: axis.len() });
        }
        dimensions.extend(self.repeat.map(|length| SweepDimension { keys: Vec::new(), length }));
        dimensions
    }
}

/// Whether two keys are the same, or one is a part of the other.
fn excludes(a: &str, b: &str) -> bool {
    let within =
        |a: &str, b: &str| a.strip_prefix(b).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    within(a, b) || within(b, a)
}

impl Scenario {
    /// The keys of the seeds of random numbers that the scenario draws, with their values.
    pub fn seeds(&self) -> Vec<(&'static str, u64)> {
        let scales = self.interface.as_ref().and_then(|interface| interface.disorder.as_ref());
        let scales = scales.filter(|scales| scales.scale.is_none() && scales.file.is_none());
        let posterior = self.fit.as_ref().and_then(|fit| fit.posterior);
        [
            self.ensemble.as_ref().map(|ensemble| ("ensemble.seed", ensemble.seed)),
            scales.map(|scales| ("interface.disorder.seed", scales.seed())),
            posterior.map(|posterior| ("fit.posterior.seed", posterior.seed)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// How many seeds from the given ones on a case uses, which replicas are to have for themselves.
    pub fn seeds_of_a_case(&self) -> u64 {
        self.renormalisation.as_ref().map_or(1, |renormalisation| renormalisation.runs as u64)
    }

    /// Checks that the scenario is one case; `instead` says what computes a sweep.
    ///
    /// # Errors
    /// A scenario with `[sweep]`.
    pub fn is_one_case(&self, instead: &str) -> Result<()> {
        match &self.sweep {
            None => Ok(()),
            Some(sweep) => {
                let expected = format!("{instead}, which computes all cases, or no such table");
                Err(Error::invalid("sweep", expected, format!("a sweep of {} cases", sweep.count())))
            }
        }
    }

    /// Checks the values of `[sweep]`, and that replicas have a seed of their own.
    pub(super) fn check_sweep(&self) -> Result<()> {
        let Some(sweep) = &self.sweep else { return Ok(()) };
        sweep.check().map_err(|error| error.under("sweep"))?;
        if sweep.repeat.is_none() {
            return Ok(());
        }
        let seeds = self.seeds();
        if seeds.is_empty() {
            let found = "a scenario without a seed, whose replicas would be equal";
            return Err(Error::invalid("sweep.repeat", "a scenario that draws random numbers", found));
        }
        match seeds.iter().find(|(seed, _)| sweep.over.0.iter().any(|(key, _)| excludes(key, seed))) {
            None => Ok(()),
            Some((seed, _)) => Err(Error::invalid(
                "sweep.repeat",
                "replicas or an axis, not both",
                format!("an axis with {seed}"),
            )),
        }
    }
}

impl SweepAxes {
    fn get(&self, key: &str) -> Option<&SweepAxis> {
        self.0.iter().find(|(other, _)| other == key).map(|(_, axis)| axis)
    }
}
