//! Standard normal random numbers, many at a time, by the ziggurat method.

use std::sync::LazyLock;

use rand_distr::{Distribution, StandardNormal};

use crate::random::Stream;

/// Layers of the ziggurat.
const LAYERS: usize = 256;

/// Start of the tail, and the area of a layer, as printed by Marsaglia and Tsang, J. Stat. Softw. 5 (8),
/// 2000; the tables of `rand_distr` follow from the same digits.
const TAIL: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_99;

/// Right ends of the layers: that of a rectangle with the area of the base layer, then the start of the tail,
/// …, 0 at the top.
static EDGES: LazyLock<[f64; LAYERS + 1]> = LazyLock::new(|| {
    let bell = |x: f64| libm::exp(-0.5 * x * x);
    let mut edges = [0.0; LAYERS + 1];
    (edges[0], edges[1]) = (AREA / bell(TAIL), TAIL);
    for i in 1..LAYERS - 1 {
        edges[i + 1] = (-2.0 * libm::log(AREA / edges[i] + bell(edges[i]))).sqrt();
    }
    edges
});

/// Fills `out` with `accept`ed values of `scale(z)`, z standard normal.
///
/// The numbers are those of the ziggurat of `rand_distr`. 99 in 100 need one random word and are computed
/// here in a loop without calls; the others are left to `rand_distr`.
pub fn fill(stream: &mut Stream, out: &mut [f64], scale: impl Fn(f64) -> f64, accept: impl Fn(f64) -> bool) {
    let edges = &*EDGES;
    let mut done = 0;
    while done < out.len() {
        let words = stream.coming(out.len() - done);
        let mut taken = 0;
        for (x, &word) in out[done..].iter_mut().zip(words) {
            let layer = (word & 0xff) as usize;
            // 52 bits as the mantissa of a number in [2, 4).
            let z = (f64::from_bits(word >> 12 | 0x4000_0000_0000_0000) - 3.0) * edges[layer];
            *x = scale(z);
            if z.abs() >= edges[layer + 1] || !accept(*x) {
                break;
            }
            taken += 1;
        }
        let all = taken == words.len() || done + taken == out.len();
        stream.skip(taken);
        done += taken;
        if !all {
            out[done] = rest(stream, &scale, &accept);
            done += 1;
        }
    }
}

#[cold]
fn rest(stream: &mut Stream, scale: &impl Fn(f64) -> f64, accept: &impl Fn(f64) -> bool) -> f64 {
    loop {
        let x = scale(StandardNormal.sample(stream));
        if accept(x) {
            return x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    /// Edges differ by roundings; a draw at such an edge, once in 10¹³, would go another way.
    #[test]
    fn draws_are_those_of_rand_distr() {
        let mut stream = Stream::new(5, Purpose::Sample, 0);
        let mut theirs = stream.clone();
        let mut ours = vec![0.0; 100_003];
        for part in ours.chunks_mut(37) {
            fill(&mut stream, part, |z| z, |z| z > -1.0);
        }
        for z in ours {
            let expected: f64 =
                std::iter::repeat_with(|| StandardNormal.sample(&mut theirs)).find(|&z| z > -1.0).unwrap();
            assert!((z - expected).abs() <= 1e-13 * expected.abs(), "{z} {expected}");
        }
    }
}
