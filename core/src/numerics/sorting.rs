//! Sorting of long lists, which asks a monitor between pieces of the work.

use crate::Result;
use crate::monitor::{Monitor, Part, report};

/// Numbers that are sorted or merged between two questions, in some milliseconds.
const PIECE: usize = 1 << 16;

/// The numbers in rising order, by merge sort from the bottom up (D. E. Knuth, The Art of Computer Programming, vol. 3, sect. 5.2.4).
///
/// # Errors
/// Stopped by the monitor.
pub(crate) fn sorted(numbers: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
    let mut values = numbers.to_vec();
    let merges = values.len().div_ceil(PIECE).next_power_of_two().ilog2();
    let share = 1.0 / f64::from(merges + 1);
    for run in values.chunks_mut(PIECE) {
        run.sort_unstable_by(f64::total_cmp);
        report(monitor, 0.0)?;
    }
    let mut merged = vec![0.0; if merges > 0 { values.len() } else { 0 }];
    for merge in 0..merges {
        let part = &mut Part::new(monitor, share * f64::from(merge + 1), share);
        merge_pairs(&values, PIECE << merge, &mut merged, part)?;
        std::mem::swap(&mut values, &mut merged);
    }
    Ok(values)
}

/// Merges pairs of rising runs of this length.
fn merge_pairs(runs: &[f64], length: usize, merged: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
    let whole = runs.len() as f64;
    let mut done = 0;
    for (pair, merged) in runs.chunks(2 * length).zip(merged.chunks_mut(2 * length)) {
        let (mut one, mut other) = pair.split_at(length.min(pair.len()));
        for piece in merged.chunks_mut(PIECE) {
            for place in &mut *piece {
                let from = match (one.first(), other.first()) {
                    (Some(a), Some(b)) if b < a => &mut other,
                    (Some(_), _) => &mut one,
                    (None, _) => &mut other,
                };
                let (first, rest) = from.split_first().expect("as many places as numbers");
                (*place, *from) = (*first, rest);
            }
            done += piece.len();
            report(monitor, done as f64 / whole)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    #[test]
    fn it_sorts_as_the_standard_library_does() {
        for length in [0, 1, 5, PIECE, PIECE + 1, 2 * PIECE - 1, 3 * PIECE, 5 * PIECE + 17] {
            let mut stream = Stream::new(1, Purpose::Sample, length as u64);
            // Many equal numbers, and zeros.
            let numbers: Vec<f64> = (0..length).map(|_| (1e5 * stream.uniform()).floor()).collect();
            let mut expected = numbers.clone();
            expected.sort_by(f64::total_cmp);
            assert_eq!(sorted(&numbers, &mut ()).unwrap(), expected, "{length}");
        }
    }
}
