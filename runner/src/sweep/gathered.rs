//! All cases of a sweep, value by value, in the order of their numbers: the order in which they came does not matter.

use std::collections::BTreeMap;

use super::batch::Batch;

/// The values of a variable on its grid, case by case; NaN of cases that have none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Number of places of the grid.
    pub places: usize,
    /// The values.
    pub values: Vec<f64>,
}

/// What is stored of a sweep.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gathered {
    /// Whether a case is there.
    pub there: Vec<bool>,
    /// The numbers of each entry, NaN where there is none.
    pub numbers: BTreeMap<String, Vec<f64>>,
    /// The words of entries, by the numbers of their cases.
    pub words: BTreeMap<String, BTreeMap<usize, String>>,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Why cases failed.
    pub failures: BTreeMap<usize, String>,
}

impl Gathered {
    /// Of `count` cases, none.
    pub fn new(count: usize) -> Self {
        Self { there: vec![false; count], ..Self::default() }
    }

    /// Adds cases. One that is there already is the same.
    pub fn add(&mut self, batch: &Batch) {
        let count = self.there.len();
        let place = |number: u64| usize::try_from(number).ok().filter(|&number| number < count);
        let cases: Vec<Option<usize>> = batch.cases.iter().map(|&number| place(number)).collect();
        cases.iter().flatten().for_each(|&case| self.there[case] = true);
        for (path, numbers) in batch.columns.iter().zip(&batch.numbers) {
            let column = self.numbers.entry(path.clone()).or_insert_with(|| vec![f64::NAN; count]);
            for (case, number) in cases.iter().zip(&numbers.0) {
                case.map(|case| column[case] = *number);
            }
        }
        for (column, place, word) in &batch.words {
            let words = self.words.entry(batch.columns[*column as usize].clone()).or_default();
            cases[*place as usize].map(|case| words.insert(case, word.clone()));
        }
        if self.curves.is_empty() {
            self.curves = vec![Curve::default(); batch.curves.len()];
        }
        for (curve, values) in self.curves.iter_mut().zip(&batch.curves) {
            curve.add(count, &cases, &values.0);
        }
        for (place, reason) in &batch.failures {
            cases[*place as usize].map(|case| self.failures.insert(case, reason.clone()));
        }
    }

    /// The numbers of the cases that are not there.
    pub fn missing(&self) -> impl Iterator<Item = usize> {
        self.there.iter().enumerate().filter(|(_, there)| !**there).map(|(case, _)| case)
    }
}

impl Curve {
    fn add(&mut self, count: usize, cases: &[Option<usize>], values: &[f64]) {
        let places = values.len() / cases.len().max(1);
        if self.values.is_empty() {
            *self = Self { places, values: vec![f64::NAN; places * count] };
        }
        for (case, values) in cases.iter().zip(values.chunks_exact(places.max(1))) {
            case.map(|case| self.values[case * places..][..places].copy_from_slice(values));
        }
    }
}
