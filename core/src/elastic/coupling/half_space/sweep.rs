//! What one cell of many does to all others, summed directly.

use rayon::prelude::*;

/// Cells below which work is not shared among threads.
const SHARE: usize = 1 << 16;

/// What a cell does to others at so many rows and columns away, either way.
pub(super) struct Weights {
    pub(super) values: Vec<f64>,
    /// Columns of `values`: distances 0, 1, ….
    pub(super) columns: usize,
    /// Whether the lattice goes on behind its edges.
    pub(super) periodic: bool,
}

impl Weights {
    /// Adds `amount` times the weights around `cell` to a field of `sides` (rows, columns).
    pub(super) fn add(&self, [rows, columns]: [usize; 2], cell: usize, amount: f64, field: &mut [f64]) {
        let (row, column) = (cell / columns, cell % columns);
        let add = |(other, field): (usize, &mut [f64])| {
            let away = self.apart(row.abs_diff(other), rows);
            self.add_row(&self.values[away * self.columns..(away + 1) * self.columns], column, amount, field);
        };
        field.par_chunks_mut(columns).enumerate().with_min_len(SHARE.div_ceil(columns)).for_each(add);
    }

    /// The shorter way between two places.
    fn apart(&self, distance: usize, length: usize) -> usize {
        if self.periodic { distance.min(length - distance) } else { distance }
    }

    /// Adds `amount` times the weights of distances along a row from the place `from`.
    fn add_row(&self, weights: &[f64], from: usize, amount: f64, row: &mut [f64]) {
        let length = row.len();
        // Further than this the way round is shorter.
        let reach = if self.periodic { length / 2 } else { length };
        let (before, after) = row.split_at_mut(from);
        let (round, near) = before.split_at_mut(from.saturating_sub(reach));
        falling(near, &weights[1..], amount);
        rising(round, &weights[(length - from).min(weights.len())..], amount);
        let (near, round) = after.split_at_mut(after.len().min(reach + 1));
        rising(near, weights, amount);
        // Distances length − reach − 1, …, from + 1.
        falling(round, &weights[(from + 1).min(weights.len())..], amount);
    }
}

/// The first place has the first weight.
fn rising(row: &mut [f64], weights: &[f64], amount: f64) {
    row.iter_mut().zip(weights).for_each(|(x, weight)| *x += amount * weight);
}

/// The last place has the first weight.
fn falling(row: &mut [f64], weights: &[f64], amount: f64) {
    let weights = &weights[..row.len()];
    row.iter_mut().zip(weights.iter().rev()).for_each(|(x, weight)| *x += amount * weight);
}
