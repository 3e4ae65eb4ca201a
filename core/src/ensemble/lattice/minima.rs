//! The minimum of many numbers, few of which change at a time: a tournament tree (tree of minima).

/// Children of a node: as many as are compared in the time of one memory access.
const ARITY: usize = 16;

/// Minima of runs of 16 numbers, of 16 runs, and so on.
///
/// The numbers are stored elsewhere. Changes are announced one by one by [`Minima::touch`]; [`Minima::update`]
/// then updates the tree, in a time proportional to the runs touched, for any number of numbers.
#[derive(Debug, Clone)]
pub(super) struct Minima {
    /// From runs of numbers upward; the last has at most `ARITY`.
    levels: Vec<Vec<f64>>,
    /// Whether a run has been touched; the list of these runs.
    touched: Vec<bool>,
    /// The runs touched.
    runs: Vec<u32>,
}

impl Minima {
    pub(super) fn new(values: &[f64]) -> Self {
        let mut levels = vec![runs(values)];
        while let Some(level) = levels.last().filter(|level| level.len() > ARITY) {
            levels.push(runs(level));
        }
        Self { touched: vec![false; levels[0].len()], runs: Vec::new(), levels }
    }

    /// Announces that the number at `index` has changed.
    #[inline]
    pub(super) fn touch(&mut self, index: usize) {
        let run = index / ARITY;
        if !self.touched[run] {
            self.touched[run] = true;
            self.runs.push(run as u32);
        }
    }

    /// Updates the minima.
    pub(super) fn update(&mut self, values: &[f64]) {
        self.runs.iter().for_each(|&run| self.touched[run as usize] = false);
        for level in 0..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            let below = below.last().map_or(values, Vec::as_slice);
            update_level(below, &mut above[0], &mut self.runs);
        }
        self.runs.clear();
    }

    /// The least number.
    pub(super) fn least(&self) -> f64 {
        least(&self.levels[self.levels.len() - 1])
    }

    /// Appends the indices of all numbers up to `bound`, rising, in a time proportional to their number.
    pub(super) fn up_to(&self, bound: f64, values: &[f64], found: &mut Vec<u32>) {
        let top = self.levels.len();
        self.search(top, 0..self.levels[top - 1].len(), bound, values, found);
    }

    /// Searches some children at `level`, descending where the minimum is below the bound.
    fn search(
        &self,
        level: usize,
        places: std::ops::Range<usize>,
        bound: f64,
        values: &[f64],
        found: &mut Vec<u32>,
    ) {
        let all = if level == 0 { values } else { &self.levels[level - 1] };
        for place in places.start..places.end.min(all.len()) {
            if all[place] > bound {
                continue;
            }
            if level == 0 {
                found.push(place as u32);
            } else {
                self.search(level - 1, place * ARITY..(place + 1) * ARITY, bound, values, found);
            }
        }
    }
}

/// Updates the minima `above` of some `runs`; on return `runs` holds the nodes to update on the next level.
fn update_level(below: &[f64], above: &mut [f64], runs: &mut Vec<u32>) {
    let mut kept = 0;
    for i in 0..runs.len() {
        let run = runs[i] as usize;
        let value = least(&below[run * ARITY..below.len().min((run + 1) * ARITY)]);
        // An unchanged minimum leaves all nodes above it unchanged.
        if value == above[run] {
            continue;
        }
        above[run] = value;
        // Runs of one parent mostly follow each other, so that this comparison removes most duplicates. The
        // others cost time, but change nothing.
        let parent = (run / ARITY) as u32;
        if kept == 0 || runs[kept - 1] != parent {
            runs[kept] = parent;
            kept += 1;
        }
    }
    runs.truncate(kept);
}

fn runs(values: &[f64]) -> Vec<f64> {
    values.chunks(ARITY).map(least).collect()
}

/// The minimum, with the comparison that compiles to one instruction.
#[inline]
fn least(values: &[f64]) -> f64 {
    values.iter().fold(f64::INFINITY, |low, &value| if value < low { value } else { low })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// After any changes the tree is that of the numbers as they are.
    #[test]
    fn mended_is_made_anew() {
        let mut stream = Stream::new(1, Purpose::Sample, 0);
        for size in [1, 15, 16, 17, 300, 5000] {
            let mut values: Vec<f64> = (0..size).map(|_| stream.uniform()).collect();
            let mut minima = Minima::new(&values);
            for round in 0..200 {
                for _ in 0..=round % 7 {
                    let index = (stream.word() % size) as usize;
                    values[index] = stream.uniform();
                    minima.touch(index);
                }
                minima.update(&values);
                assert_eq!(minima.levels, Minima::new(&values).levels);
                let bound = minima.least() + 0.01;
                let mut found = Vec::new();
                minima.up_to(bound, &values, &mut found);
                assert!(found.into_iter().eq((0..size as u32).filter(|&i| values[i as usize] <= bound)));
            }
        }
    }
}
