//! Tabulates the friction curve of a population by moving it forward.

use super::Extremes;
use super::curve::{Curve, CurveEnergies, CurvePiece, Quintic, horner};
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::population::{Direction, Population, Response, SmoothInterval};
use crate::{Error, Result};

/// Interpolation error of a piece relative to the largest force on it: about the accuracy of the populations.
const ACCURACY: f64 = 1e-12;

/// Largest number of times that a smooth interval is halved.
const HALVINGS: u32 = 10;

/// Largest number of pieces of a curve: some 10⁸ bytes.
const MOST: usize = 1 << 19;

/// Number of pieces that are dropped together.
const PASSED: usize = 64;

/// A curve that is tabulated as far as it is needed.
///
/// The extremes of the known part of the curve determine the sizes of steps. So that a recalled state continues as it would
/// have from the mark, pieces tabulated since then count as unknown after a recall, until they are needed again.
#[derive(Debug)]
pub(super) struct CurveTable {
    /// The contacts at the end of the table.
    population: Box<dyn Population>,
    /// Their position at first.
    origin: f64,
    pub curve: Curve,
    /// End of the tabulated part.
    end: f64,
    /// ∫F dX up to there.
    work: f64,
    /// Largest interpolation error.
    error: f64,
    /// Whether contacts break where the next piece begins.
    breaks: bool,
    /// Whether the population stands at a break that it has not crossed yet.
    crosses: bool,
    /// Energies at first.
    first: ContactEnergies,
    known: KnownPieces,
    marked: KnownPieces,
    /// What was known after each interval that has been tabulated since the mark.
    since: Vec<KnownPieces>,
}

/// The known part of a curve.
#[derive(Debug, Clone, Copy, Default)]
struct KnownPieces {
    /// Number of smooth intervals of the population.
    intervals: usize,
    /// Where they end.
    end: f64,
    extremes: Extremes,
    /// Estimated error of the force.
    error: f64,
}

/// A part of a smooth interval on which a polynomial of degree 5 is the force.
struct TabulatedPart {
    start: f64,
    length: f64,
    force: Quintic,
    /// Interpolation error.
    error: f64,
}

impl CurveTable {
    /// The curve from the state of the population on.
    pub fn new(mut population: Box<dyn Population>, monitor: &mut dyn Monitor) -> Result<Self> {
        let origin = population.position();
        // Contacts exactly at their thresholds break when the interval is computed, before energies are read.
        population.smooth_interval(Direction::Forward, monitor)?;
        let first = population.energies();
        let curve = Curve::default();
        let (known, marked, since) = (KnownPieces::default(), KnownPieces::default(), Vec::new());
        let (end, work, error, breaks, crosses) = (0.0, 0.0, 0.0, false, false);
        let mut table = Self {
            population,
            origin,
            curve,
            end,
            work,
            error,
            breaks,
            crosses,
            first,
            known,
            marked,
            since,
        };
        table.extend(monitor)?;
        table.curve.index();
        table.mark();
        Ok(table)
    }

    /// End of the known part of the curve.
    pub fn end(&self) -> f64 {
        self.known.end
    }

    /// Whether a place is in the known part.
    pub fn knows(&self, place: f64) -> bool {
        place <= self.known.end
    }

    /// The largest slope from a place on, at least 0.
    pub fn largest_tangent(&self, from: f64) -> f64 {
        self.curve.largest_tangent(from, self.known.end)
    }

    /// Largest slope and force of the known part; forces where pieces end.
    pub fn extremes(&self) -> Extremes {
        self.known.extremes
    }

    /// Estimated error of the force on the known part: that of the population, and that of the interpolation.
    pub fn error(&self) -> f64 {
        self.known.error
    }

    /// Extends the known part to `end` at least, for a cell at `from`.
    pub fn extend_to(&mut self, end: f64, from: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if self.knows(end) {
            return Ok(());
        }
        // To twice the distance, so that many short extensions cost no more than a long one.
        let end = end.max(2.0 * self.known.end - from);
        while !self.knows(end) {
            self.extend(monitor)?;
        }
        self.curve.index();
        Ok(())
    }

    /// Marks the known part, in place of the mark before.
    pub fn mark(&mut self) {
        self.since.drain(..self.known.intervals - self.marked.intervals);
        self.marked = self.known;
    }

    /// Returns to the known part at the mark.
    pub fn recall(&mut self) {
        self.known = self.marked;
    }

    /// Extends the known part to a number of intervals; the part before `from` is not needed.
    pub fn resume(&mut self, intervals: usize, from: f64, monitor: &mut dyn Monitor) -> Result<()> {
        while self.known.intervals < intervals {
            self.extend(monitor)?;
            self.mark();
            if self.curve.len() > PASSED && self.end <= from {
                self.curve.index();
                self.curve.forget(from);
            }
        }
        self.curve.index();
        Ok(())
    }

    /// Number of known smooth intervals.
    pub fn intervals(&self) -> usize {
        self.known.intervals
    }

    /// Extends the known part by one interval.
    fn extend(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let next = self.known.intervals - self.marked.intervals;
        if next == self.since.len() {
            self.tabulate(monitor)?;
            let Self { known, end, ref curve, error, .. } = *self;
            let (intervals, error) = (known.intervals + 1, self.population.error() + error);
            self.since.push(KnownPieces { intervals, end, extremes: curve.extremes(), error });
        }
        self.known = self.since[next];
        Ok(())
    }

    /// Tabulates the next interval. Where the monitor stops it, it goes on later.
    fn tabulate(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        if !self.crosses {
            let interval = self.population.smooth_interval(Direction::Forward, monitor)?;
            if interval.length.is_infinite() {
                self.push_endless();
                return Ok(());
            }
            self.push_interval(interval)?;
            self.crosses = interval.breaks;
        }
        if self.crosses {
            self.population.cross(monitor)?;
            self.crosses = false;
        }
        Ok(())
    }

    /// Tabulates an interval, and moves the population to its end.
    fn push_interval(&mut self, interval: SmoothInterval) -> Result<()> {
        let mut parts = Vec::new();
        self.split(0.0, interval.length, interval, HALVINGS, &mut parts);
        let origin = self.population.position();
        for part in parts {
            self.error = self.error.max(part.error);
            self.push(&part, origin)?;
        }
        self.end = self.population.position() - self.origin;
        self.breaks = interval.breaks;
        Ok(())
    }

    /// Bisects [start, start + length] of the interval ahead until a polynomial of degree 5 is the force on each part.
    fn split(
        &self,
        start: f64,
        length: f64,
        interval: SmoothInterval,
        halvings: u32,
        parts: &mut Vec<TabulatedPart>,
    ) {
        let half = 0.5 * length;
        // Degree 5 from forces and tangents at three points: two evaluations in between, at which
        // the error of Hermite interpolation is near its largest, check it. A cell then reads one
        // cache line per evaluation.
        let at = |t: f64| self.population.ahead((start + half * (1.0 + t)).min(interval.length));
        let force = through([-1.0, 0.0, 1.0].map(at), half);
        let scale = [-1.0, 1.0].map(|t| at(t).force.abs()).into_iter().fold(0.0, f64::max);
        let errors = [-0.5, 0.5].map(|t| (horner(&force, t).0 - at(t).force).abs());
        let error = errors[0].max(errors[1]);
        if interval.straight || halvings == 0 || error <= ACCURACY * scale {
            parts.push(TabulatedPart { start, length, force, error });
        } else {
            self.split(start, half, interval, halvings - 1, parts);
            self.split(start + half, half, interval, halvings - 1, parts);
        }
    }

    /// Moves the population through a part that lies ahead of `origin`, and tabulates the energies on the way.
    fn push(&mut self, part: &TabulatedPart, origin: f64) -> Result<()> {
        if self.curve.len() >= MOST {
            let (needed, allowed) = ((2 * MOST * 256) as u64, (MOST * 256) as u64);
            let (key, what) = ("population".into(), "a friction curve in pieces".into());
            return Err(Error::TooLarge { key, what, needed, allowed });
        }
        let mut read = [self.population.energies(); 6];
        for (i, energies) in read.iter_mut().enumerate().skip(1) {
            // Known, so that nothing has to be solved, and no piece is left half done.
            let interval = self.population.smooth_interval(Direction::Forward, &mut ())?;
            // Energies are read at six equidistant places, by moving the population there: it has
            // their values only, no tangents as for the force.
            let target = origin + part.start + part.length * i as f64 / 5.0;
            let left = target - self.population.position();
            self.population.advance(left.clamp(0.0, interval.length))?;
            *energies = self.population.energies();
        }
        let piece = CurvePiece {
            start: origin + part.start - self.origin,
            rate: 2.0 / part.length,
            force: part.force,
        };
        let column = |of: fn(&ContactEnergies) -> f64, first: f64| {
            interpolated(std::array::from_fn(|i| of(&read[i]) - first))
        };
        let energies = CurveEnergies {
            work: self.work,
            elastic: column(|b| b.elastic, 0.0),
            lost: column(|b| b.lost, self.first.lost),
            broken: column(|b| b.broken, self.first.broken),
        };
        self.work += piece.work(1.0);
        self.curve.push(piece, energies, std::mem::take(&mut self.breaks));
        Ok(())
    }

    /// Adds the rest of the curve, where no contact breaks any more and all work becomes elastic energy.
    fn push_endless(&mut self) {
        let Response { force, tangent } = self.population.ahead(0.0);
        let energies = self.population.energies();
        let piece = CurvePiece {
            start: self.population.position() - self.origin,
            rate: 1.0,
            force: [force + tangent, tangent, 0.0, 0.0, 0.0, 0.0],
        };
        let constant = |value: f64| [value, 0.0, 0.0, 0.0, 0.0, 0.0];
        let elastic =
            [energies.elastic + force + 0.5 * tangent, force + tangent, 0.5 * tangent, 0.0, 0.0, 0.0];
        let energies = CurveEnergies {
            work: self.work,
            elastic,
            lost: constant(energies.lost - self.first.lost),
            broken: constant(energies.broken - self.first.broken),
        };
        self.curve.push(piece, energies, std::mem::take(&mut self.breaks));
        self.end = f64::INFINITY;
    }
}

/// Hermite interpolation: the polynomial in t with these forces and tangents at t = −1, 0 and 1, where t = 1 is `half` long.
fn through([left, middle, right]: [Response; 3], half: f64) -> Quintic {
    let even = 0.5 * (right.force + left.force) - middle.force;
    let odd = 0.5 * (right.force - left.force) - half * middle.tangent;
    let even_slope = 0.5 * half * (right.tangent - left.tangent);
    let odd_slope = 0.5 * half * (right.tangent + left.tangent) - half * middle.tangent;
    let fourth = 0.5 * even_slope - even;
    let fifth = 0.5 * (odd_slope - 3.0 * odd);
    [middle.force, half * middle.tangent, even - fourth, odd - fifth, fourth, fifth]
}

/// Newton interpolation: the polynomial in t through values at six equidistant points of [−1, 1].
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
