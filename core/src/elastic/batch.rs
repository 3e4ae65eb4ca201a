//! Loops over cells with the same bits on any number of threads: chunks do not depend on the threads, and sums are taken in
//! order.

use crate::Result;
use crate::monitor::{Monitor, report};
use crate::parallel;

/// Cells of a chunk, the work of one thread at a time; fewer are not worth a thread.
pub(super) const CHUNK: usize = 1 << 12;

/// Cells after which monitors are asked: costly functions of so many take a hundredth of a second.
const PIECE: usize = 8 * CHUNK;

/// Fills a slice with a function of the cell.
pub(super) fn fill<T: Send>(values: &mut [T], of: impl Fn(usize) -> T + Sync) {
    on_chunks(values, &|first, values| {
        values.iter_mut().enumerate().for_each(|(i, value)| *value = of(first + i));
    });
}

/// The same with a report to the monitor after each piece of many cells.
///
/// # Errors
/// Stopped by the monitor.
pub(super) fn fill_with<T: Send>(
    values: &mut [T],
    of: impl Fn(usize) -> T + Sync,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    for (piece, values) in values.chunks_mut(PIECE).enumerate() {
        fill(values, |cell| of(piece * PIECE + cell));
        if values.len() == PIECE {
            report(monitor, 0.0)?;
        }
    }
    Ok(())
}

/// Changes each value of a slice by a function of the cell and the value.
pub(super) fn change<T: Send + Copy>(values: &mut [T], of: impl Fn(usize, T) -> T + Sync) {
    on_chunks(values, &|first, values| {
        values.iter_mut().enumerate().for_each(|(i, value)| *value = of(first + i, *value));
    });
}

/// Calls a function with the first cell of each chunk and the values of the chunk.
fn on_chunks<T: Send>(values: &mut [T], work: &(dyn Fn(usize, &mut [T]) + Sync)) {
    if values.len() <= CHUNK || parallel::current_num_threads() == 1 {
        work(0, values);
    } else {
        parallel::map(values.chunks_mut(CHUNK).collect(), &|chunk, values| work(chunk * CHUNK, values));
    }
}

/// Changes two slices chunk by chunk, by a function of the first cell of a chunk and of the chunk's parts of the slices;
/// returns the largest value of the function.
pub(super) fn change_chunks(
    values: &mut [f64],
    others: &mut [f64],
    of: impl Fn(usize, &mut [f64], &mut [f64]) -> f64 + Sync,
) -> f64 {
    if values.len() <= CHUNK || parallel::current_num_threads() == 1 {
        return of(0, values, others);
    }
    let chunks =
        values.chunks_mut(CHUNK).zip(others.chunks_mut(CHUNK)).map(|(values, others)| [values, others]);
    let found = parallel::map(chunks.collect(), &|chunk, [values, others]| of(chunk * CHUNK, values, others));
    found.into_iter().fold(0.0, f64::max)
}

/// Folds a function of the cells chunk by chunk, and then the results of the chunks in order.
pub(super) fn gather<T: Send>(
    number: usize,
    nothing: impl Fn() -> T + Sync,
    add: impl Fn(T, usize) -> T + Sync,
    join: impl Fn(T, T) -> T,
) -> T {
    let part = |chunk: usize| {
        let end = number.min((chunk + 1) * CHUNK);
        (chunk * CHUNK..end).fold(nothing(), &add)
    };
    if number <= CHUNK {
        return part(0);
    }
    // Floating-point addition is not associative: partial sums are added in the order of chunks,
    // never in the order in which threads finish.
    let parts = parallel::map((0..number.div_ceil(CHUNK)).collect(), &|_, chunk| part(chunk));
    parts.into_iter().fold(nothing(), join)
}

/// The values of a function of the cell where it has one, in order, chunk by chunk, with a report to the monitor after each
/// piece of many cells.
///
/// # Errors
/// Stopped by the monitor.
pub(super) fn find<T: Send>(
    number: usize,
    of: impl Fn(usize) -> Option<T> + Sync,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Vec<T>>> {
    let part = |chunk: usize| {
        let cells = chunk * CHUNK..number.min((chunk + 1) * CHUNK);
        cells.filter_map(&of).collect::<Vec<_>>()
    };
    if number <= CHUNK {
        return Ok(vec![part(0)]);
    }
    let (mut found, chunks) = (Vec::new(), number.div_ceil(CHUNK));
    for first in (0..chunks).step_by(PIECE / CHUNK) {
        let piece = first..chunks.min(first + PIECE / CHUNK);
        found.extend(parallel::map(piece.collect(), &|_, chunk| part(chunk)));
        report(monitor, 0.0)?;
    }
    Ok(found)
}

/// Σ of a function of the cell.
pub(super) fn sum(number: usize, of: impl Fn(usize) -> f64 + Sync) -> f64 {
    gather(number, || 0.0, |sum, cell| sum + of(cell), |a, b| a + b)
}

/// The largest value of a function of the cell, at least 0.
pub(super) fn largest(number: usize, of: impl Fn(usize) -> f64 + Sync) -> f64 {
    gather(number, || 0.0, |most: f64, cell| most.max(of(cell)), f64::max)
}

/// Whether something holds for every cell.
pub(super) fn all(number: usize, of: impl Fn(usize) -> bool + Sync) -> bool {
    gather(number, || true, |all, cell| all && of(cell), |a, b| a && b)
}

/// One pass through slices of one length: `of` computes new values of the `write` slices from the old ones and from the
/// `read` slices, and a number for each cell. Returns these numbers folded with `join`, from 0.
pub(super) fn sweep<const W: usize, const R: usize>(
    mut write: [&mut [f64]; W],
    read: [&[f64]; R],
    of: impl Fn([f64; W], [f64; R]) -> ([f64; W], f64) + Sync,
    join: impl Fn(f64, f64) -> f64 + Sync,
) -> f64 {
    let number = write.first().map_or_else(|| read[0].len(), |first| first.len());
    // Conjugate gradients are limited by the bandwidth of memory: vectors are updated and sums
    // taken in one pass.
    let part = |write: &mut [&mut [f64]; W], read: [&[f64]; R], length: usize| {
        let write = write.each_mut().map(|values| &mut values[..length]);
        let read = read.map(|values| &values[..length]);
        let mut all = 0.0;
        for i in 0..length {
            let (new, one) = of(write.each_ref().map(|values| values[i]), read.map(|values| values[i]));
            for k in 0..W {
                write[k][i] = new[k];
            }
            all = join(all, one);
        }
        all
    };
    if number <= CHUNK {
        return part(&mut write, read, number);
    }
    let mut rest = write.map(|values| values.chunks_mut(CHUNK));
    let chunks: Vec<_> = (0..number.div_ceil(CHUNK))
        .map(|_| rest.each_mut().map(|chunks| chunks.next().unwrap_or_default()))
        .collect();
    let each = |chunk: usize, mut write: [&mut [f64]; W]| {
        let (start, end) = (chunk * CHUNK, number.min((chunk + 1) * CHUNK));
        part(&mut write, read.map(|values| &values[start..end]), end - start)
    };
    parallel::map(chunks, &each).into_iter().fold(0.0, join)
}
