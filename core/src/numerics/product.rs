//! Scalar products of long vectors, with the same bits on any number of threads.

use crate::parallel;

/// Terms summed by one thread.
const CHUNK: usize = 1 << 14;

/// Number of partial sums, so that an addition does not wait for the previous one and the loop vectorises.
const LANES: usize = 8;

/// Σ a_j b_j. Chunks are of fixed size and summed in order.
pub fn product(a: &[f64], b: &[f64]) -> f64 {
    if a.len() <= CHUNK {
        return in_lanes(a, b);
    }
    let chunks = a.chunks(CHUNK).zip(b.chunks(CHUNK)).collect();
    parallel::map(chunks, &|_, (a, b)| in_lanes(a, b)).iter().sum()
}

fn in_lanes(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}
