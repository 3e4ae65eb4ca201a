//! A friction curve F(X) as a table: force, slopes and energies of contacts that move forward.

use super::{CellEnergies, Extremes, Instability, Slopes};
use crate::numerics::roots::brent_root;

/// Coefficients of a polynomial of degree 5 in t ∈ [−1, 1].
pub(super) type Quintic = [f64; 6];

/// Number of places evaluated together, so that the compiler uses wide registers.
pub(super) const LANES: usize = 8;

/// Relative rounding error of a place.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Number of intervals of a piece at whose ends slopes are evaluated.
const PLACES: u32 = 16;

/// A piece of the curve, one cache line: F = Σ c_k t^k, t = 2(X − start)/length − 1.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct CurvePiece {
    pub start: f64,
    /// 2/length.
    pub rate: f64,
    pub force: Quintic,
}

/// Energies and breaks on a piece, apart from the force since they are seldom needed.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveEnergies {
    /// ∫F dX before it.
    pub work: f64,
    pub elastic: Quintic,
    pub lost: Quintic,
    pub broken: Quintic,
}

/// Buckets per piece: with as many, few buckets overlap more than two pieces.
const FINE: usize = 4;

/// The pieces in one of equal parts of the curve, for a search in constant time.
#[derive(Debug, Clone, Copy)]
struct Bucket {
    /// Where the second piece begins.
    second: f64,
    /// Number of the first piece.
    piece: u32,
    /// Whether there are more than two pieces.
    many: bool,
}

/// F(X) for X ≥ 0 as piecewise polynomials of degree 5, with jumps between pieces where contacts break together. The first
/// and the last piece extrapolate.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    starts: Vec<f64>,
    pieces: Vec<CurvePiece>,
    energies: Vec<CurveEnergies>,
    slopes: Vec<Slopes>,
    /// Whether the extremes of the slope of a piece are at its ends.
    monotone: Vec<bool>,
    /// Whether contacts break where a piece begins.
    breaks: Vec<bool>,
    /// Equal parts of the curve, and their number per length.
    buckets: Vec<Bucket>,
    density: f64,
    extremes: Extremes,
}

/// Value and derivative by t, by Horner's rule.
#[inline]
pub(super) fn horner(c: &Quintic, t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (c[5], c[5]);
    for k in [4, 3, 2, 1] {
        value = c[k] + t * value;
        slope = value + t * slope;
    }
    (c[0] + t * value, slope)
}

/// ∫₋₁^t.
fn primitive(c: &Quintic, t: f64) -> f64 {
    let power = |n: i32| (t.powi(n) - (-1.0_f64).powi(n)) / f64::from(n);
    (0..6).map(|k| c[k as usize] * power(k + 1)).sum()
}

impl CurvePiece {
    #[inline]
    fn at(&self, x: f64) -> f64 {
        (x - self.start) * self.rate - 1.0
    }

    #[inline]
    fn response(&self, x: f64) -> (f64, f64) {
        let (force, slope) = horner(&self.force, self.at(x));
        (force, slope * self.rate)
    }

    pub fn work(&self, t: f64) -> f64 {
        primitive(&self.force, t) / self.rate
    }

    /// Least and largest slope at [`PLACES`] intervals.
    fn slopes(&self) -> Slopes {
        let all = (0..=PLACES).map(|i| 2.0 * f64::from(i) / f64::from(PLACES) - 1.0);
        let slopes = all.map(|t| horner(&self.force, t).1 * self.rate);
        let start = Slopes { least: f64::INFINITY, largest: f64::NEG_INFINITY };
        slopes.fold(start, |s, x| Slopes { least: s.least.min(x), largest: s.largest.max(x) })
    }
}

impl Curve {
    pub fn push(&mut self, piece: CurvePiece, energies: CurveEnergies, breaks: bool) {
        let slopes = piece.slopes();
        self.extremes = self.extremes.and(Extremes {
            steepest: slopes.largest.abs().max(slopes.least.abs()),
            strongest: horner(&piece.force, 1.0).0.abs(),
            jumps: breaks,
        });
        self.starts.push(piece.start);
        self.pieces.push(piece);
        self.energies.push(energies);
        let [a, b] = [-1.0, 1.0].map(|t| horner(&piece.force, t).1 * piece.rate);
        self.monotone.push(a.min(b) == slopes.least && a.max(b) == slopes.largest);
        self.slopes.push(slopes);
        self.breaks.push(breaks);
    }

    /// Largest slope and force so far; forces where pieces end.
    pub fn extremes(&self) -> Extremes {
        self.extremes
    }

    /// Number of pieces.
    pub fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Beginning of the first piece that is kept.
    #[inline]
    pub fn first(&self) -> f64 {
        self.starts[0]
    }

    /// Drops the pieces before that of x. Energies keep counting from the beginning.
    pub fn forget(&mut self, x: f64) {
        let passed = ..self.find(x);
        if passed.end == 0 {
            return;
        }
        self.starts.drain(passed);
        self.pieces.drain(passed);
        self.energies.drain(passed);
        self.slopes.drain(passed);
        self.monotone.drain(passed);
        self.breaks.drain(passed);
        self.index();
    }

    /// Builds the buckets; needed after pieces were added or dropped.
    pub fn index(&mut self) {
        // Buckets of equal length make a search O(1) where pieces have similar lengths; those that
        // overlap more than two pieces are searched.
        let (number, last) = (FINE * self.pieces.len(), self.starts.len() - 1);
        let (first, length) = (self.first(), self.starts[last] - self.first());
        self.density = if length > 0.0 { number as f64 / length } else { 0.0 };
        self.buckets.clear();
        let place = |bucket: usize| first + bucket as f64 * length / number as f64;
        let mut piece = 0;
        for bucket in 0..=number {
            // Rounding may put what is right before a bucket into it.
            let (begin, end) = (place(bucket) * (1.0 - ROUNDING), place(bucket + 1) * (1.0 + ROUNDING));
            while piece < last && self.starts[piece + 1] <= begin {
                piece += 1;
            }
            let second = self.starts.get(piece + 1).copied().unwrap_or(f64::INFINITY);
            let many = self.starts.get(piece + 2).is_some_and(|third| *third <= end);
            self.buckets.push(Bucket { second, piece: piece as u32, many });
        }
    }

    /// The piece that x is in.
    #[inline]
    fn find(&self, x: f64) -> usize {
        // One look-up and one comparison for nearly all x, instead of a bisection.
        let bucket = (((x - self.starts[0]) * self.density) as usize).min(self.buckets.len() - 1);
        let Bucket { second, piece, many } = self.buckets[bucket];
        let piece = piece as usize + usize::from(x >= second);
        if many { self.find_from(piece, x) } else { piece }
    }

    /// The same, searched from a piece that does not begin after x.
    #[cold]
    fn find_from(&self, piece: usize, x: f64) -> usize {
        piece + self.starts[piece + 1..].iter().take_while(|start| **start <= x).count()
    }

    /// F and F'; where contacts break together, the right limits.
    #[inline]
    pub fn response(&self, x: f64) -> (f64, f64) {
        self.pieces[self.find(x)].response(x)
    }

    /// The same at several places, bit for bit.
    #[inline(always)]
    pub fn responses(&self, places: [f64; LANES]) -> [[f64; LANES]; 2] {
        let mut at = [[0.0; LANES]; 2];
        let mut force = [[0.0; LANES]; 6];
        for lane in 0..LANES {
            let piece = &self.pieces[self.find(places[lane])];
            (at[0][lane], at[1][lane]) = (piece.start, piece.rate);
            (0..6).for_each(|k| force[k][lane] = piece.force[k]);
        }
        // The coefficients are gathered first, so that Horner's rule runs on all lanes at once. The operations
        // are those of `horner` in the same order, which gives the same bits.
        let [start, rate] = at;
        let t: [f64; LANES] = std::array::from_fn(|lane| (places[lane] - start[lane]) * rate[lane] - 1.0);
        let (mut value, mut slope) = (force[5], force[5]);
        for k in [4, 3, 2, 1] {
            for lane in 0..LANES {
                value[lane] = force[k][lane] + t[lane] * value[lane];
                slope[lane] = value[lane] + t[lane] * slope[lane];
            }
        }
        for lane in 0..LANES {
            value[lane] = force[0][lane] + t[lane] * value[lane];
            slope[lane] *= rate[lane];
        }
        [value, slope]
    }

    /// The largest slope of the pieces from one place to another, at least 0.
    pub fn largest_tangent(&self, from: f64, to: f64) -> f64 {
        let (first, last) = (self.find(from), self.find(to));
        // A piece that begins at the end is not known yet, also where a stopped slide has tabulated it.
        let last = if last > first && self.starts[last] >= to { last - 1 } else { last };
        self.slopes[first..=last].iter().fold(0.0, |most, slopes| slopes.largest.max(most))
    }

    /// Least and largest slope from one place to a later one.
    pub fn slopes(&self, from: f64, to: f64) -> Slopes {
        let (first, last) = (self.find(from), self.find(to));
        let mut all = Slopes { least: f64::INFINITY, largest: f64::NEG_INFINITY };
        for piece in first..=last {
            let start = if piece == first { self.pieces[piece].at(from) } else { -1.0 };
            let end = if piece == last { self.pieces[piece].at(to) } else { 1.0 };
            let here = self.slopes_on(piece, start, end);
            all = Slopes { least: all.least.min(here.least), largest: all.largest.max(here.largest) };
            if piece > first && self.breaks[piece] {
                all.least = f64::NEG_INFINITY;
            }
        }
        all
    }

    /// Least and largest slope on a part of a piece.
    fn slopes_on(&self, piece: usize, start: f64, end: f64) -> Slopes {
        if !self.monotone[piece] {
            return self.slopes[piece];
        }
        let CurvePiece { force, rate, .. } = &self.pieces[piece];
        let [a, b] = [start, end].map(|t| horner(force, t).1 * rate);
        Slopes { least: a.min(b), largest: a.max(b) }
    }

    /// The first place in [from, to] at which F' falls below `slope`, or right before contacts break together.
    pub fn instability(&self, from: f64, to: f64, slope: f64) -> Option<Instability> {
        let (first, last) = (self.find(from), self.find(to));
        let at = (first..=last).find_map(|piece| {
            if piece > first && self.breaks[piece] {
                // Just before the jump: at the place itself the contacts have broken already.
                return Some(self.starts[piece] * (1.0 - 4.0 * f64::EPSILON));
            }
            if self.slopes[piece].least >= slope {
                return None;
            }
            let start = if piece == first { from } else { self.starts[piece] };
            let end = if piece == last { to } else { self.starts[piece + 1] };
            self.instability_on(piece, start, end, slope)
        })?;
        Some(Instability { at, together: (first + 1..=last).any(|piece| self.breaks[piece]) })
    }

    fn instability_on(&self, piece: usize, start: f64, end: f64, slope: f64) -> Option<f64> {
        let height = |x: f64| self.pieces[piece].response(x).1 - slope;
        let place = |i: u32| start + (end - start) * f64::from(i) / f64::from(PLACES);
        // F' has degree 4 on a piece. A dip between two neighbouring places is missed; it is
        // shorter than a sixteenth of the piece.
        let below = (0..=PLACES).find(|&i| height(place(i)) < 0.0)?;
        if below == 0 {
            return Some(start);
        }
        brent_root(height, place(below - 1), place(below), 0.0)
    }

    /// Energies and breaks of the contacts from 0 to x.
    pub fn energies(&self, x: f64) -> CellEnergies {
        let found = self.find(x);
        let (piece, energies) = (&self.pieces[found], &self.energies[found]);
        let t = piece.at(x);
        CellEnergies {
            work: energies.work + piece.work(t),
            elastic: horner(&energies.elastic, t).0,
            lost: horner(&energies.lost, t).0,
            broken: horner(&energies.broken, t).0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of very different lengths, at and beside where they begin, before the first and behind the last.
    #[test]
    fn every_place_is_found_in_its_piece() {
        let lengths = [1.0, 1e-9, 1e-9, 1e-9, 0.3, 0.01, 0.02, 1e-12, 2.0, 0.1, 0.1, 0.1];
        let mut curve = Curve::default();
        let mut start = 0.7;
        for length in lengths {
            let piece = CurvePiece { start, rate: 2.0 / length, force: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
            let none = [0.0; 6];
            curve.push(piece, CurveEnergies { work: 0.0, elastic: none, lost: none, broken: none }, false);
            start += length;
        }
        curve.index();
        let even = (0..10_000).map(|i| 4.8 * f64::from(i) / 10_000.0);
        let begins = curve.starts.iter().flat_map(|x| [x.next_down(), *x, x.next_up()]);
        for x in even.chain(begins) {
            let expected = curve.starts.partition_point(|start| *start <= x).saturating_sub(1);
            assert_eq!(curve.find(x), expected, "{x}");
        }
    }

    /// Bit for bit, on pieces of different lengths.
    #[test]
    fn places_are_asked_together_as_one_by_one() {
        let mut curve = Curve::default();
        for (i, length) in [1.0, 0.3, 0.01, 2.0].into_iter().enumerate() {
            let shift = i as f64;
            let force = [0.7 - shift, 0.3, -0.1 * shift, 0.9, 1.3 + shift, -0.2];
            let piece = CurvePiece { start: 3.0 * shift, rate: 2.0 / length, force };
            let none = [0.0; 6];
            curve.push(piece, CurveEnergies { work: 0.0, elastic: none, lost: none, broken: none }, false);
        }
        curve.index();
        for first in 0..100 {
            let places: [f64; LANES] = std::array::from_fn(|lane| 0.013 * (first + 91 * lane) as f64);
            let [forces, slopes] = curve.responses(places);
            let alone = places.map(|x| curve.response(x));
            assert_eq!((0..LANES).map(|lane| (forces[lane], slopes[lane])).collect::<Vec<_>>(), alone);
        }
    }
}
