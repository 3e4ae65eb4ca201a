//! All cases of a sweep, value by value, in the order of their numbers: the order in which they came does not matter.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

use super::batch::Batch;
use crate::numbers::NumbersInFile;

/// The values of a variable on its grid, case by case; NaN of cases that have none.
#[derive(Debug)]
pub struct Curve {
    /// Number of places of the grid.
    places: usize,
    values: CurveValues,
}

/// Where the values of a curve are.
#[derive(Debug)]
pub enum CurveValues {
    /// In memory.
    Kept(Vec<f64>),
    /// In a file.
    Stored(Arc<NumbersInFile>),
}

/// What is stored of a sweep.
#[derive(Debug, Default)]
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
    /// Of `count` cases, none; each has curves on grids of so many places.
    pub fn new(count: usize, places: &[usize]) -> Self {
        let curve =
            |&places: &usize| Curve { places, values: CurveValues::Kept(vec![f64::NAN; places * count]) };
        Self { there: vec![false; count], curves: places.iter().map(curve).collect(), ..Self::default() }
    }

    /// The same, with curves in files without names in a folder.
    ///
    /// # Errors
    /// The system refuses.
    pub fn with_curves_in(folder: &Path, count: usize, places: &[usize]) -> io::Result<Self> {
        let curve = |&places: &usize| -> io::Result<Curve> {
            let mut values = NumbersInFile::within(folder)?;
            values.extend_to(places * count)?;
            Ok(Curve { places, values: CurveValues::Stored(Arc::new(values)) })
        };
        let curves = places.iter().map(curve).collect::<io::Result<_>>()?;
        Ok(Self { there: vec![false; count], curves, ..Self::default() })
    }

    /// Forgets the cases that failed, as if they were not there.
    pub fn forget_failures(&mut self) {
        for (case, _) in std::mem::take(&mut self.failures) {
            self.there[case] = false;
        }
    }

    /// Adds cases. One that is there already is the same, unless it failed before and was computed again.
    ///
    /// # Errors
    /// Curves in files cannot be written.
    pub fn add(&mut self, batch: &Batch) -> io::Result<()> {
        let count = self.there.len();
        let place = |number: u64| usize::try_from(number).ok().filter(|&number| number < count);
        let mut cases: Vec<Option<usize>> = batch.cases.iter().map(|&number| place(number)).collect();
        for (place, _) in &batch.failures {
            let case = &mut cases[*place as usize];
            *case = case.filter(|case| !self.there[*case] || self.failures.contains_key(case));
        }
        for &case in cases.iter().flatten() {
            self.there[case] = true;
            self.failures.remove(&case);
        }
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
        for (place, reason) in &batch.failures {
            cases[*place as usize].map(|case| self.failures.insert(case, reason.clone()));
        }
        self.curves.iter_mut().zip(&batch.curves).try_for_each(|(curve, values)| curve.add(&cases, &values.0))
    }
}

impl Curve {
    /// Its values.
    pub fn into_values(self) -> CurveValues {
        self.values
    }

    fn add(&mut self, cases: &[Option<usize>], values: &[f64]) -> io::Result<()> {
        let each = cases.iter().zip(values.chunks_exact(self.places.max(1)));
        for (case, values) in each.filter_map(|(case, values)| Some(((*case)?, values))) {
            let from = case * self.places;
            match &mut self.values {
                CurveValues::Kept(kept) => kept[from..][..self.places].copy_from_slice(values),
                CurveValues::Stored(file) => {
                    Arc::get_mut(file).expect("nobody else has it yet").put(from, values)?;
                }
            }
        }
        Ok(())
    }
}
