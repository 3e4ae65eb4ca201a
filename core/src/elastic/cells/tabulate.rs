//! The curve of a population, made by moving it forward through its seam.

use super::Extremes;
use super::curve::{Curve, CurveEnergies, CurvePiece, Quintic, horner};
use crate::monitor::Monitor;
use crate::population::{self, Direction, Population, Response, Way};
use crate::{Error, Result};

/// What a piece may be off by, of the largest force on its way: populations are hardly better.
const ACCURACY: f64 = 1e-12;

/// A way is halved so often at most.
const HALVINGS: u32 = 10;

/// Pieces that a curve may have: some 10⁸ bytes.
const MOST: usize = 1 << 19;

/// Pieces that are forgotten together.
const PASSED: usize = 64;

/// A curve that grows as it is asked for.
///
/// How far it is known decides on steps, by what it is at most. So that what is recalled goes on
/// as it would have done, what was tabulated since the mark is not known then, until it is asked for again.
pub(super) struct CurveTable {
    population: Box<dyn Population>,
    origin: f64,
    pub curve: Curve,
    /// Where what is tabulated ends.
    end: f64,
    work: f64,
    /// What pieces are off by, at most.
    off: f64,
    /// Whether contacts break where the next piece begins.
    breaks: bool,
    begun: population::Books,
    known: KnownPieces,
    marked: KnownPieces,
    /// What was known after each way that has been tabulated since the mark.
    since: Vec<KnownPieces>,
}

/// How far a curve is known.
#[derive(Debug, Clone, Copy, Default)]
struct KnownPieces {
    /// Ways of the population.
    ways: usize,
    /// Where they end.
    end: f64,
    extremes: Extremes,
    /// Estimated error of the force.
    error: f64,
}

/// Part of a way: where it begins, its length, F on it.
struct TabulatedPart {
    start: f64,
    length: f64,
    force: Quintic,
    /// What it is off by.
    off: f64,
}

impl CurveTable {
    /// The curve from where the population stands.
    pub fn new(mut population: Box<dyn Population>, monitor: &mut dyn Monitor) -> Result<Self> {
        let origin = population.position();
        // What stands at its threshold breaks as the population is asked for its way, before its energies are read.
        population.way(Direction::Forward, monitor)?;
        let begun = population.books();
        let curve = Curve::default();
        let (known, marked, since) = (KnownPieces::default(), KnownPieces::default(), Vec::new());
        let (end, work, off, breaks) = (0.0, 0.0, 0.0, false);
        let mut table =
            Self { population, origin, curve, end, work, off, breaks, begun, known, marked, since };
        table.go_on(monitor)?;
        table.curve.index();
        table.mark();
        Ok(table)
    }

    /// Where what is known of the curve ends.
    pub fn end(&self) -> f64 {
        self.known.end
    }

    /// Whether the curve reaches a place.
    pub fn knows(&self, place: f64) -> bool {
        place <= self.known.end
    }

    /// The largest slope from a place on, or 0.
    pub fn stiffest(&self, from: f64) -> f64 {
        self.curve.stiffest(from, self.known.end)
    }

    /// What is known of the curve is at most, forces where pieces end.
    pub fn extremes(&self) -> Extremes {
        self.known.extremes
    }

    /// Estimated error of the force as far as the curve is known: that of the population, and of the pieces.
    pub fn error(&self) -> f64 {
        self.known.error
    }

    /// Brings the curve to `end` at least; what asks stands at `from`.
    pub fn reach(&mut self, end: f64, from: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if self.knows(end) {
            return Ok(());
        }
        // Twice as much, so that asking again and again costs no more than asking once.
        let end = end.max(2.0 * self.known.end - from);
        while !self.knows(end) {
            self.go_on(monitor)?;
        }
        self.curve.index();
        Ok(())
    }

    /// Remembers how far the curve is known, in place of the time before.
    pub fn mark(&mut self) {
        self.since.drain(..self.known.ways - self.marked.ways);
        self.marked = self.known;
    }

    /// Knows no more than at the mark.
    pub fn recall(&mut self) {
        self.known = self.marked;
    }

    /// Brings the curve to as many ways as it had before; nothing is asked for before `from`.
    pub fn resume(&mut self, ways: usize, from: f64, monitor: &mut dyn Monitor) -> Result<()> {
        while self.known.ways < ways {
            self.go_on(monitor)?;
            self.mark();
            if self.curve.len() > PASSED && self.end <= from {
                self.curve.index();
                self.curve.forget(from);
            }
        }
        self.curve.index();
        Ok(())
    }

    /// Ways of the population that are known.
    pub fn ways(&self) -> usize {
        self.known.ways
    }

    /// Knows the next way.
    fn go_on(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let next = self.known.ways - self.marked.ways;
        if next == self.since.len() {
            self.tabulate(monitor)?;
            let Self { known, end, ref curve, off, .. } = *self;
            let error = self.population.error() + off;
            self.since.push(KnownPieces { ways: known.ways + 1, end, extremes: curve.extremes(), error });
        }
        self.known = self.since[next];
        Ok(())
    }

    /// Tabulates the next way.
    fn tabulate(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let way = self.population.way(Direction::Forward, monitor)?;
        if way.length.is_infinite() {
            self.push_endless();
            return Ok(());
        }
        let mut parts = Vec::new();
        self.split(0.0, way.length, way, HALVINGS, &mut parts);
        let origin = self.population.position();
        for part in parts {
            self.off = self.off.max(part.off);
            self.push(&part, origin, monitor)?;
        }
        self.end = self.population.position() - self.origin;
        self.breaks = way.breaks;
        if way.breaks {
            self.population.cross(monitor)?;
        }
        Ok(())
    }

    /// Parts of [start, start + length] of the way ahead on which a polynomial of degree 5 is the force.
    fn split(&self, start: f64, length: f64, way: Way, halvings: u32, parts: &mut Vec<TabulatedPart>) {
        let half = 0.5 * length;
        let at = |t: f64| self.population.ahead((start + half * (1.0 + t)).min(way.length));
        let force = through([-1.0, 0.0, 1.0].map(at), half);
        let scale = [-1.0, 1.0].map(|t| at(t).force.abs()).into_iter().fold(0.0, f64::max);
        let wrong = [-0.5, 0.5].map(|t| (horner(&force, t).0 - at(t).force).abs());
        let off = wrong[0].max(wrong[1]);
        if way.straight || halvings == 0 || off <= ACCURACY * scale {
            parts.push(TabulatedPart { start, length, force, off });
        } else {
            self.split(start, half, way, halvings - 1, parts);
            self.split(start + half, half, way, halvings - 1, parts);
        }
    }

    /// Goes through a part that lies ahead of `origin`, with the energies on the way.
    fn push(&mut self, part: &TabulatedPart, origin: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if self.curve.len() >= MOST {
            let (needed, allowed) = ((2 * MOST * 256) as u64, (MOST * 256) as u64);
            let (key, what) = ("contacts.thresholds".into(), "a friction curve in pieces".into());
            return Err(Error::TooLarge { key, what, needed, allowed });
        }
        let mut read = [self.population.books(); 6];
        for (i, books) in read.iter_mut().enumerate().skip(1) {
            let way = self.population.way(Direction::Forward, monitor)?;
            let target = origin + part.start + part.length * i as f64 / 5.0;
            let left = target - self.population.position();
            self.population.advance(left.clamp(0.0, way.length))?;
            *books = self.population.books();
        }
        let piece = CurvePiece {
            start: origin + part.start - self.origin,
            rate: 2.0 / part.length,
            force: part.force,
        };
        let column = |of: fn(&population::Books) -> f64, begun: f64| {
            interpolated(std::array::from_fn(|i| of(&read[i]) - begun))
        };
        let books = CurveEnergies {
            work: self.work,
            elastic: column(|b| b.elastic, 0.0),
            lost: column(|b| b.lost, self.begun.lost),
            broken: column(|b| b.broken, self.begun.broken),
        };
        self.work += piece.work(1.0);
        self.curve.push(piece, books, std::mem::take(&mut self.breaks));
        Ok(())
    }

    /// The rest of the curve, on which nothing breaks any more: elastic energy takes all of the work.
    fn push_endless(&mut self) {
        let Response { force, tangent } = self.population.ahead(0.0);
        let books = self.population.books();
        let piece = CurvePiece {
            start: self.population.position() - self.origin,
            rate: 1.0,
            force: [force + tangent, tangent, 0.0, 0.0, 0.0, 0.0],
        };
        let constant = |value: f64| [value, 0.0, 0.0, 0.0, 0.0, 0.0];
        let elastic = [books.elastic + force + 0.5 * tangent, force + tangent, 0.5 * tangent, 0.0, 0.0, 0.0];
        let books = CurveEnergies {
            work: self.work,
            elastic,
            lost: constant(books.lost - self.begun.lost),
            broken: constant(books.broken - self.begun.broken),
        };
        self.curve.push(piece, books, std::mem::take(&mut self.breaks));
        self.end = f64::INFINITY;
    }
}

/// The polynomial in t with these forces and tangents at t = −1, 0 and 1, `half` being the length of t = 1.
fn through([left, middle, right]: [Response; 3], half: f64) -> Quintic {
    let even = 0.5 * (right.force + left.force) - middle.force;
    let odd = 0.5 * (right.force - left.force) - half * middle.tangent;
    let even_slope = 0.5 * half * (right.tangent - left.tangent);
    let odd_slope = 0.5 * half * (right.tangent + left.tangent) - half * middle.tangent;
    let fourth = 0.5 * even_slope - even;
    let fifth = 0.5 * (odd_slope - 3.0 * odd);
    [middle.force, half * middle.tangent, even - fourth, odd - fifth, fourth, fifth]
}

/// The polynomial in t through values at six even places of [−1, 1].
fn interpolated(values: [f64; 6]) -> Quintic {
    let place = |i: usize| 0.4 * i as f64 - 1.0;
    let mut divided = values;
    for order in 1..6 {
        for i in (order..6).rev() {
            divided[i] = (divided[i] - divided[i - 1]) / (place(i) - place(i - order));
        }
    }
    let mut c = [0.0; 6];
    for i in (0..6).rev() {
        for k in (1..6).rev() {
            c[k] = c[k - 1] - place(i) * c[k];
        }
        c[0] = divided[i] - place(i) * c[0];
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_5_are_found_from_values_and_tangents() {
        let c: Quintic = [0.3, -1.2, 0.7, 2.0, -0.4, 0.9];
        let values = std::array::from_fn(|i| horner(&c, 0.4 * i as f64 - 1.0).0);
        let half = 0.25;
        let at = |t: f64| {
            let (force, slope) = horner(&c, t);
            Response { force, tangent: slope / half }
        };
        let found = [interpolated(values), through([-1.0, 0.0, 1.0].map(at), half)];
        for (wrong, k) in found.iter().flat_map(|f| (0..6).map(move |k| (f[k] - c[k], k))) {
            assert!(wrong.abs() < 1e-14, "coefficient {k} is off by {wrong:e}");
        }
    }
}
