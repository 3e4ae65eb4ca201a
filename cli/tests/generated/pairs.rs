//! Cases in which all pairs of options occur.

use std::collections::{BTreeMap, HashSet};

use super::scenario::{Case, Schema};

/// Cases among which each next one is chosen.
const CANDIDATES: u64 = 24;

/// Two options, each as a number for a path and what was taken there.
type Pair = (u32, u32);

/// Cases chosen one after the other, each the one of the next [`CANDIDATES`] numbers that has most pairs of options that none
/// before it has (the greedy rule of D. M. Cohen et al., IEEE Trans. Softw. Eng. 23, 437 (1997)).
pub struct Pairs<'a> {
    schema: &'a Schema,
    next: u64,
    /// The difference of the numbers of two candidates.
    stride: u64,
    names: Names,
    seen: HashSet<Pair>,
}

impl<'a> Pairs<'a> {
    /// From the numbers `first`, `first + stride`, …
    pub fn new(schema: &'a Schema, first: u64, stride: u64) -> Self {
        Self { schema, next: first, stride, names: Names::default(), seen: HashSet::new() }
    }
}

/// Options as numbers.
#[derive(Default)]
struct Names(BTreeMap<String, u32>);

impl Names {
    /// The pairs of a case.
    fn pairs(&mut self, case: &Case) -> Vec<Pair> {
        let number = |(path, option): (&String, &String)| {
            let next = self.0.len() as u32;
            *self.0.entry(format!("{path} = {option}")).or_insert(next)
        };
        let mut taken: Vec<u32> = case.options.iter().map(number).collect();
        taken.sort_unstable();
        let with_later = |(i, &one): (usize, &u32)| {
            taken[i + 1..].iter().map(move |&other| (one, other)).collect::<Vec<_>>()
        };
        taken.iter().enumerate().flat_map(with_later).collect()
    }
}

/// How many pairs of options there are in cases.
pub fn in_cases(cases: &[Case]) -> usize {
    let mut names = Names::default();
    cases.iter().flat_map(|case| names.pairs(case)).collect::<HashSet<_>>().len()
}

impl Iterator for Pairs<'_> {
    type Item = Case;

    fn next(&mut self) -> Option<Case> {
        let candidates =
            (0..CANDIDATES).map(|k| self.schema.case(self.next + k * self.stride)).collect::<Vec<_>>();
        self.next += CANDIDATES * self.stride;
        let best = candidates.into_iter().map(|case| {
            let pairs = self.names.pairs(&case);
            let new = pairs.iter().filter(|pair| !self.seen.contains(pair)).count();
            (new, case, pairs)
        });
        // The first of several that are equally good.
        let (_, case, pairs) = best.reduce(|best, other| if other.0 > best.0 { other } else { best })?;
        self.seen.extend(pairs);
        Some(case)
    }
}
