//! A finished sweep as labelled arrays along its axes: what files, pictures and xarray are made of.

use std::borrow::Cow;
use std::io;
use std::sync::Arc;

use asperity::record::Quantity;
use asperity::scenario::{SweepDimension, SweepValue, Units};

use super::gathered::{Curve, CurveValues, Gathered};
use super::keep::{ACCURACY, Keep};
use super::plan::Plan;
use super::schema;
use crate::input;
use crate::numbers::NumbersInFile;

/// Values of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; NaN where there is none.
    Numbers(Vec<f64>),
    /// Words; empty where there is none.
    Texts(Vec<String>),
    /// Numbers in a file; NaN where there is none.
    Stored(Arc<NumbersInFile>),
}

impl Values {
    /// Number of values.
    pub fn count(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
            Self::Stored(numbers) => numbers.count(),
        }
    }

    /// Numbers from an index on, at most `count`; none of words.
    ///
    /// # Errors
    /// The system refuses to read a file.
    pub fn read(&self, from: usize, count: usize) -> io::Result<Cow<'_, [f64]>> {
        match self {
            Self::Numbers(numbers) => {
                let end = from.saturating_add(count).min(numbers.len());
                Ok(Cow::Borrowed(&numbers[from.min(end)..end]))
            }
            Self::Texts(_) => Ok(Cow::Borrowed(&[])),
            Self::Stored(numbers) => numbers.read(from, count).map(Cow::Owned),
        }
    }
}

/// A variable with its labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Labelled {
    /// Name in files.
    pub name: String,
    /// Name for people.
    pub long_name: String,
    /// The key of the scenario, or the path in the summary.
    pub key: String,
    /// Label of the unit; empty where it is not known.
    pub units: String,
    /// Names of its dimensions, slowest first.
    pub dimensions: Vec<String>,
    /// The values.
    pub values: Values,
}

/// A dimension, and its coordinates, the first of which has its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its name.
    pub name: String,
    /// Its length.
    pub length: usize,
    /// Its coordinates.
    pub coordinates: Vec<Labelled>,
}

/// Largest difference of steps that are equal, relative to them: the rounding of values that are written with six digits.
const EQUAL: f64 = 1e-4;

impl Axis {
    /// Whether its values are evenly spaced in their logarithm: three or more, above 0.
    pub fn is_logarithmic(&self) -> bool {
        let Values::Numbers(values) = &self.coordinates[0].values else { return false };
        let [first, .., last] = values[..] else { return false };
        let step = (last / first).ln() / (values.len() - 1) as f64;
        let even = |pair: &[f64]| ((pair[1] / pair[0]).ln() / step - 1.0).abs() < EQUAL;
        values.len() > 2 && values.iter().all(|&value| value > 0.0) && values.windows(2).all(even)
    }
}

/// All variables of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    /// Heading of summary and pictures.
    pub title: String,
    /// The hash of all that determines the results.
    pub hash: String,
    /// The scenario with its axes, or what stands in its place.
    pub scenario: String,
    /// The axes of the sweep, slowest first.
    pub axes: Vec<Axis>,
    /// The grids of variables, beside the axes.
    pub grids: Vec<Axis>,
    /// What was kept.
    pub variables: Vec<Labelled>,
    /// Number of cases that failed.
    pub failed: usize,
}

/// The name of a variable for a dotted path.
pub fn named(path: &str) -> String {
    path.replace('.', "_")
}

impl Dataset {
    /// The data set of a plan.
    pub fn of_plan(plan: &Plan, mut gathered: Gathered) -> Self {
        let units = &plan.scenario.units;
        let scenario = schemars::schema_for!(asperity::scenario::Scenario).to_value();
        let label = |path: &str| {
            let found = plan.summaries.find(path).unwrap_or_default();
            (found.meaning, found.quantity.map_or_else(String::new, |quantity| units.label(quantity)))
        };
        let axes = plan.dimensions.iter().map(|dimension| axis(dimension, &scenario, units)).collect();
        let kept = plan.keep.iter().filter_map(|keep| match keep {
            Keep::Entry(path) => Some(path.as_str()),
            Keep::Curve { .. } => None,
        });
        let kept: Vec<&str> = kept.collect();
        let mut dataset = Self {
            title: plan.scenario.title.clone(),
            hash: plan.identity().hash,
            scenario: input::to_text(&plan.scenario),
            axes,
            grids: Vec::new(),
            variables: Vec::new(),
            failed: gathered.failures.len(),
        };
        dataset.add_entries(&mut gathered, &kept, label);
        dataset.add_curves(std::mem::take(&mut gathered.curves), plan);
        dataset.add_failures(&gathered);
        dataset
    }

    /// The data set of cases without a scenario.
    pub fn of_cases(
        title: &str,
        (hash, text): (&str, &str),
        axes: Vec<Axis>,
        mut gathered: Gathered,
    ) -> Self {
        let mut dataset = Self {
            title: title.to_owned(),
            hash: hash.to_owned(),
            scenario: text.to_owned(),
            axes,
            grids: Vec::new(),
            variables: Vec::new(),
            failed: gathered.failures.len(),
        };
        dataset.add_entries(&mut gathered, &[], |_| (String::new(), String::new()));
        dataset.add_failures(&gathered);
        dataset
    }

    /// Number of cases.
    pub fn cases(&self) -> usize {
        self.axes.iter().map(|axis| axis.length).product()
    }

    /// The axes and the grids.
    pub fn dimensions(&self) -> impl Iterator<Item = &Axis> {
        self.axes.iter().chain(&self.grids)
    }

    /// The variable called `name`.
    pub fn get(&self, name: &str) -> Option<&Labelled> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    fn along(&self) -> Vec<String> {
        self.axes.iter().map(|axis| axis.name.clone()).collect()
    }

    /// Adds the entries of summaries: those of a kept path in the order of what is kept, and by their names below it.
    fn add_entries(
        &mut self,
        gathered: &mut Gathered,
        kept: &[&str],
        label: impl Fn(&str) -> (String, String),
    ) {
        let found: Vec<String> = gathered.numbers.keys().cloned().collect();
        let mut paths: Vec<&str> = found.iter().map(String::as_str).collect();
        // An entry that no case has is there, too.
        let below = |path: &str, kept: &str| {
            path.strip_prefix(kept).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let lacking =
            kept.iter().filter(|kept| **kept != ACCURACY && !paths.iter().any(|path| below(path, kept)));
        let lacking: Vec<&str> = lacking.copied().collect();
        paths.extend(lacking);
        paths.sort_by_key(|path| {
            let place = kept.iter().position(|kept| below(path, kept));
            let parts: Vec<(u64, &str)> =
                path.split('.').map(|part| (part.parse().unwrap_or(u64::MAX), part)).collect();
            (place, parts)
        });
        for path in paths {
            let (long_name, units) = label(path);
            let values = values(gathered, path, self.cases());
            let (name, key, dimensions) = (named(path), path.to_owned(), self.along());
            self.variables.push(Labelled { name, long_name, key, units, dimensions, values });
        }
    }

    fn add_curves(&mut self, curves: Vec<Curve>, plan: &Plan) {
        let kept = plan.keep.iter().filter_map(|keep| match keep {
            Keep::Curve { variable, long_name, quantity, along, places } => {
                Some((variable, long_name, *quantity, along, places))
            }
            Keep::Entry(_) => None,
        });
        for ((variable, long_name, quantity, along, places), curve) in kept.zip(curves) {
            let grid = self.grid(variable, along, places, &plan.scenario.units);
            let mut dimensions = self.along();
            dimensions.push(grid);
            let values = match curve.into_values() {
                CurveValues::Kept(values) => Values::Numbers(values),
                CurveValues::Stored(values) => Values::Stored(values),
            };
            let units = plan.scenario.units.label(quantity);
            let (name, long_name, key) = (variable.clone(), long_name.clone(), variable.clone());
            self.variables.push(Labelled { name, long_name, key, units, dimensions, values });
        }
    }

    /// The name of a grid: that of the coordinate, unless another grid has it.
    fn grid(&mut self, variable: &str, along: &(String, Quantity), places: &[f64], units: &Units) -> String {
        let (coordinate, quantity) = along;
        let values = Values::Numbers(places.to_vec());
        let same =
            |axis: &&Axis| axis.coordinates[0].key == *coordinate && axis.coordinates[0].values == values;
        if let Some(axis) = self.grids.iter().find(same) {
            return axis.name.clone();
        }
        let taken = |name: &String| self.grids.iter().chain(&self.axes).any(|axis| axis.name == *name);
        let name = Some(coordinate.clone()).filter(|name| !taken(name));
        let name = name.unwrap_or_else(|| format!("{variable}_{coordinate}"));
        let labelled = Labelled {
            name: name.clone(),
            long_name: coordinate.replace('_', " "),
            key: coordinate.clone(),
            units: units.label(*quantity),
            dimensions: vec![name.clone()],
            values,
        };
        let (length, coordinates) = (places.len(), vec![labelled]);
        self.grids.push(Axis { name: name.clone(), length, coordinates });
        name
    }

    /// Adds why cases failed, if any did.
    fn add_failures(&mut self, gathered: &Gathered) {
        if gathered.failures.is_empty() {
            return;
        }
        let text = |case: usize| gathered.failures.get(&case).cloned().unwrap_or_default();
        self.variables.push(Labelled {
            name: "failure".into(),
            long_name: "Why the case failed".into(),
            key: "failure".into(),
            units: String::new(),
            dimensions: self.along(),
            values: Values::Texts((0..self.cases()).map(text).collect()),
        });
    }
}

/// The values of an entry: words if any case has one.
fn values(gathered: &mut Gathered, path: &str, count: usize) -> Values {
    let numbers = gathered.numbers.remove(path);
    let Some(words) = gathered.words.remove(path) else {
        return Values::Numbers(numbers.unwrap_or_else(|| vec![f64::NAN; count]));
    };
    let number =
        |case: usize| numbers.as_ref().map(|numbers| numbers[case]).filter(|number| !number.is_nan());
    let text = |case: usize| {
        let word = words.get(&case).cloned();
        word.or_else(|| number(case).map(crate::output::shortest)).unwrap_or_default()
    };
    Values::Texts((0..count).map(text).collect())
}

/// An axis with the coordinates of its keys.
fn axis(dimension: &SweepDimension, scenario: &serde_json::Value, units: &Units) -> Axis {
    let SweepDimension { keys, length } = dimension;
    let length = *length;
    let Some((first, _)) = keys.first() else {
        let name = "repeat".to_owned();
        let coordinates = vec![Labelled {
            name: name.clone(),
            long_name: "Number of the replica, added to every seed".into(),
            key: "sweep.repeat".into(),
            units: "1".into(),
            dimensions: vec![name.clone()],
            values: Values::Numbers((0..length).map(|i| i as f64).collect()),
        }];
        return Axis { name, length, coordinates };
    };
    let name = named(first);
    let coordinates = keys.iter().map(|(key, values)| {
        let entry = schema::find(scenario, key).unwrap_or_default();
        let numbers: Option<Vec<f64>> = values.iter().map(SweepValue::number).collect();
        let texts = || values.iter().map(written).collect();
        Labelled {
            name: named(key),
            long_name: if entry.meaning.is_empty() { key.clone() } else { entry.meaning },
            key: key.clone(),
            units: entry.quantity.map_or_else(String::new, |quantity| units.label(quantity)),
            dimensions: vec![name.clone()],
            values: numbers.map_or_else(|| Values::Texts(texts()), Values::Numbers),
        }
    });
    let coordinates = coordinates.collect();
    Axis { name, length, coordinates }
}

/// A value as it is written in a scenario; a text without its quotes.
fn written(value: &SweepValue) -> String {
    match value {
        SweepValue::Text(text) => text.clone(),
        other => toml::Value::try_from(other).map_or_else(|_| String::new(), |value| value.to_string()),
    }
}
