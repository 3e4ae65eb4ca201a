//! The plan of a sweep: its cases in order, and the check of its corners before any work.

use std::fmt::Write as _;

use asperity::scenario::{Scenario, Sweep, SweepDimension, SweepValue};
use sha2::{Digest as _, Sha256};

use super::keep::{self, Keep, Summaries};
use super::store::Identity;
use crate::input::{self, Cases, Choice, Diagnostic, Input};

/// A sweep whose corners are valid.
#[derive(Debug)]
pub struct Plan {
    cases: Cases,
    /// The scenario with its table `[sweep]`.
    pub scenario: Scenario,
    /// The dimensions, slowest first.
    pub dimensions: Vec<SweepDimension>,
    /// The seeds that replicas raise.
    seeds: Vec<(&'static str, u64)>,
    /// What is kept of each case.
    pub keep: Vec<Keep>,
    /// The summaries of the task.
    pub summaries: Summaries,
    /// The digest of what the corners are, resolved.
    corners: Sha256,
}

/// Largest number of corners that are built, which takes some 40 µs for each.
const CORNERS: usize = 1 << 17;

impl Plan {
    /// The plan of a scenario with `[sweep]`.
    ///
    /// # Errors
    /// A scenario without it; a corner that is not valid, with its position.
    pub fn new(input: &Input) -> Result<Self, Box<Diagnostic>> {
        let mut plan = Self::unchecked(input)?;
        for corner in plan.corners() {
            let scenario = plan.build(&corner, true)?;
            update(&mut plan.corners, &input::to_text(&scenario));
        }
        Ok(plan)
    }

    /// The same without the check of its corners, for a worker that is given cases of a plan.
    ///
    /// # Errors
    /// A scenario without `[sweep]`; a name that is kept and is not known.
    pub fn unchecked(input: &Input) -> Result<Self, Box<Diagnostic>> {
        let reported = |error: asperity::Error| input.diagnose(&error);
        let scenario = input.scenario.clone();
        let missing =
            || asperity::Error::invalid("sweep", "a table [sweep] with axes and what to keep", "none");
        let sweep = scenario.sweep.clone().ok_or_else(missing).map_err(reported)?;
        let summaries = Summaries::new(&scenario).map_err(reported)?;
        let keep = keep::keep(&scenario, &sweep.keep, &summaries).map_err(reported)?;
        let seeds = if sweep.repeat.is_some() { scenario.seeds() } else { Vec::new() };
        let (cases, dimensions) = (Cases::new(input), sweep.dimensions());
        Ok(Self { cases, scenario, dimensions, seeds, keep, summaries, corners: Sha256::new() })
    }

    /// Number of cases.
    pub fn count(&self) -> usize {
        self.dimensions.iter().map(|dimension| dimension.length).product()
    }

    /// Numbers of places of the grids of curves, in the order of the scenario.
    pub fn places(&self) -> Vec<usize> {
        let places = |keep: &Keep| match keep {
            Keep::Curve { places, .. } => Some(places.len()),
            Keep::Entry(_) => None,
        };
        self.keep.iter().filter_map(places).collect()
    }

    /// Bytes of the curves of all cases.
    pub fn bytes_of_curves(&self) -> u64 {
        self.places().iter().map(|&places| (places * self.count() * size_of::<f64>()) as u64).sum()
    }

    /// The table `[sweep]`.
    ///
    /// # Panics
    /// Never: a plan has one.
    pub fn sweep(&self) -> &Sweep {
        self.scenario.sweep.as_ref().expect("a plan has one")
    }

    /// The scenario of a case. Its values are checked when it is run.
    ///
    /// # Errors
    /// Values that do not fit together.
    pub fn case(&self, number: usize) -> Result<Scenario, Box<Diagnostic>> {
        self.build(&self.place(number), false)
    }

    /// What identifies the sweep and determines its results: the version, the resolved scenario with its axes and what is kept,
    /// and its corners, which have the content of files that axes name.
    pub fn identity(&self) -> Identity {
        let text = input::to_text(&self.scenario);
        let mut digest = self.corners.clone();
        update(&mut digest, env!("CARGO_PKG_VERSION"));
        update(&mut digest, &text);
        let hash = digest.finalize().iter().take(8).fold(String::new(), |mut hash, byte| {
            let _ = write!(hash, "{byte:02x}");
            hash
        });
        Identity { hash, text, cases: self.count() }
    }

    /// The indices of a case along the dimensions.
    pub fn place(&self, number: usize) -> Vec<usize> {
        let mut rest = number;
        let mut place: Vec<usize> = self
            .dimensions
            .iter()
            .rev()
            .map(|dimension| {
                let index = rest % dimension.length;
                rest /= dimension.length;
                index
            })
            .collect();
        place.reverse();
        place
    }

    fn build(&self, place: &[usize], check: bool) -> Result<Scenario, Box<Diagnostic>> {
        let (mut choices, mut seeds) = (Vec::new(), Vec::new());
        for (dimension, &index) in self.dimensions.iter().zip(place) {
            for (key, values) in &dimension.keys {
                choices.push(Choice { key, index, number: values[index].number() });
            }
            if dimension.keys.is_empty() {
                let further = (index as u64).wrapping_mul(self.scenario.seeds_of_a_case());
                seeds.extend(self.seeds.iter().map(|&(key, seed)| (key, seed.wrapping_add(further))));
            }
        }
        if check { self.cases.check(&choices, &seeds) } else { self.cases.scenario(&choices, &seeds) }
    }

    /// The places of the corners: all combinations of the ends of the axes; of too many, each end with the first values of the
    /// other axes.
    fn corners(&self) -> Vec<Vec<usize>> {
        let ends: Vec<Vec<usize>> = self.dimensions.iter().map(ends).collect();
        let count = ends.iter().map(|ends| ends.len() as f64).product::<f64>();
        if count <= CORNERS as f64 {
            let first = vec![Vec::new()];
            return ends.iter().fold(first, |corners, ends| {
                let longer = |corner: Vec<usize>| ends.iter().map(move |&end| [&corner[..], &[end]].concat());
                corners.into_iter().flat_map(longer).collect()
            });
        }
        let first: Vec<usize> = ends.iter().map(|ends| ends[0]).collect();
        let at = |d: usize, end: usize| {
            let mut place = first.clone();
            place[d] = end;
            place
        };
        (0..ends.len())
            .flat_map(|d| ends[d].iter().map(move |&end| (d, end)))
            .map(|(d, end)| at(d, end))
            .collect()
    }
}

/// Adds a text and its length.
fn update(digest: &mut Sha256, text: &str) {
    digest.update((text.len() as u64).to_le_bytes());
    digest.update(text);
}

/// The indices of the ends of a dimension: of the smallest and the largest number of each key, and of all values that are no
/// numbers.
fn ends(dimension: &SweepDimension) -> Vec<usize> {
    let mut ends = vec![0, dimension.length - 1];
    for (_, values) in &dimension.keys {
        let numbers: Option<Vec<f64>> = values.iter().map(SweepValue::number).collect();
        match numbers {
            None => ends.extend(0..dimension.length),
            Some(numbers) => {
                let by_value = |&a: &usize, &b: &usize| numbers[a].total_cmp(&numbers[b]);
                ends.extend((0..numbers.len()).min_by(by_value));
                ends.extend((0..numbers.len()).max_by(by_value));
            }
        }
    }
    ends.sort_unstable();
    ends.dedup();
    ends
}
