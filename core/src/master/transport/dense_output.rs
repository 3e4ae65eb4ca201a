//! Results inside time steps, so that the times asked for do not end steps (dense output), where the density of
//! thresholds has no jumps: contacts formed in a step with a jump are not known well enough inside it.
//!
//! Cohorts are exact at any time: those from before the step are advanced from its start to a few points
//! inside it, and what forms on the way is known from [`FormedInStep`](super::formed::FormedInStep). Between
//! these points a polynomial interpolates. Its degree grows until its last terms are below the tolerance; if
//! they never are, each time asked for is such a point.

use super::cohort::{Cohort, CohortForce};
use super::path::Path;
use super::trial::{StepAttempt, Trial};
use crate::Result;
use crate::monitor::Monitor;
use crate::numerics::order::sort_by_number;

/// What a trace shows of the contacts at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    /// Force, in units of the total stiffness.
    pub(super) force: f64,
    /// Breaking rate, a fraction of contacts per time.
    pub(super) rate: f64,
    /// The fraction of free contacts.
    pub(super) free: f64,
}

/// Times of a motion at one velocity at which readings are asked for, and the readings so far.
#[derive(Debug, Default)]
pub(super) struct RequestedReadings {
    times: Vec<f64>,
    found: Vec<Reading>,
}

/// A point of a step: its fraction s, force, breaks since the start of the step, free contacts.
#[derive(Debug, Clone, Copy)]
struct Node {
    s: f64,
    values: [f64; 3],
}

/// The start and the middle of a step, for the next one to continue.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepReadings {
    duration: f64,
    /// With s and breaks relative to the end of the step.
    nodes: [Node; 2],
}

/// Readings inside a step.
pub(super) struct DenseOutput<'a> {
    attempt: &'a StepAttempt<'a>,
    cohorts: &'a [Cohort],
    trial: &'a Trial,
    path: &'a Path,
    /// The last step, if this one continues it.
    before: Option<StepReadings>,
    /// Start, middle and end first.
    nodes: Vec<Node>,
    /// Allowed errors of interpolated forces and fractions of breaks.
    errors: [f64; 2],
}

/// Points that halve the angles between extrema of Chebyshev polynomials on [0, 1]: with 0, ½ and 1, those of
/// degree 4, then of degree 8.
const CHEBYSHEV: [&[f64]; 2] = [
    &[0.146_446_609_406_726_24, 0.853_553_390_593_273_8],
    &[0.038_060_233_744_356_62, 0.308_658_283_817_455_1, 0.691_341_716_182_544_9, 0.961_939_766_255_643_4],
];

/// Points closer than this are one.
const SAME: f64 = 1e-6;

impl RequestedReadings {
    /// Readings at ascending times.
    pub(super) fn new(times: impl Iterator<Item = f64>) -> Self {
        Self { times: times.collect(), found: Vec::new() }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Adds those inside a step that begins at `elapsed`.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn read(
        &mut self,
        elapsed: f64,
        duration: f64,
        step: &mut DenseOutput<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let rest = &self.times[self.found.len()..];
        let inside = rest.iter().map(|time| (time - elapsed) / duration).take_while(|&s| s < 1.0);
        let inside: Vec<f64> = inside.map(|s| s.max(0.0)).collect();
        if !inside.is_empty() {
            self.found.extend(step.read(&inside, monitor)?);
        }
        Ok(())
    }

    /// Adds those before a time, during which nothing changes.
    pub(super) fn read_same(&mut self, until: f64, reading: Reading) {
        let before = self.times.partition_point(|time| *time < until);
        self.found.resize(before.max(self.found.len()), reading);
    }

    /// The end of the motion answers what rounding has left.
    pub(super) fn read_rest(&mut self, end: Reading) {
        self.found.resize(self.times.len(), end);
    }

    /// The readings, one for each time after [`Self::read_rest`].
    pub(super) fn found(self) -> Vec<Reading> {
        self.found
    }
}

impl<'a> DenseOutput<'a> {
    /// Readings inside a step of these cohorts, with forces, in units of the total stiffness, and fractions of
    /// breaks interpolated to `errors`.
    pub(super) fn new(
        attempt: &'a StepAttempt<'a>,
        (cohorts, trial): (&'a [Cohort], &'a Trial),
        path: &'a Path,
        before: Option<StepReadings>,
        errors: [f64; 2],
    ) -> Self {
        let mut output = Self { attempt, cohorts, trial, path, before, nodes: Vec::new(), errors };
        let [start, end] = [cohorts, &trial.cohorts].map(|cohorts| CohortForce::of(cohorts).force);
        let fraction = trial.fraction;
        let middle = trial.formed.force(0.5, output.born(0.5, fraction.middle)) + trial.middle_force;
        let nodes = [(0.0, start, 0.0), (0.5, middle, fraction.middle), (1.0, end, fraction.end)];
        output.nodes = nodes.map(|(s, force, broken)| output.node(s, force, broken)).into();
        output
    }

    /// The start and the middle, for the next step; before others are added.
    pub(super) fn readings(&self) -> StepReadings {
        let end = self.nodes[2].values[1];
        let relative = |node: Node| {
            let [force, broken, free] = node.values;
            Node { s: node.s - 1.0, values: [force, broken - end, free] }
        };
        StepReadings { duration: self.path.duration, nodes: [self.nodes[0], self.nodes[1]].map(relative) }
    }

    /// The fraction of all contacts that has formed up to s if `broken` has broken.
    fn born(&self, s: f64, broken: f64) -> f64 {
        let (attempt, whole) = (self.attempt, self.trial.fraction);
        if attempt.broken.is_immediate() {
            return broken + (self.trial.formed.mass() - whole.end);
        }
        if s == 0.0 {
            return 0.0;
        }
        let part = s * self.path.duration;
        let known = attempt.broken.free_before(attempt.time, part);
        attempt.broken.births(attempt.time, part, whole.up_to(s), known).mass
    }

    fn node(&self, s: f64, force: f64, broken: f64) -> Node {
        let free = self.attempt.broken.free() + self.attempt.dropped + broken - self.born(s, broken);
        Node { s, values: [force, broken, free] }
    }

    /// The point s.
    fn at(&self, s: f64, monitor: &mut dyn Monitor) -> Result<Node> {
        let (broken, force) =
            self.attempt.partly((self.cohorts, self.trial.thresholds.as_ref()), self.path, s, monitor)?;
        let broken = broken + s * self.attempt.dropped + self.trial.formed.broken(s);
        Ok(self.node(s, force + self.trial.formed.force(s, self.born(s, broken)), broken))
    }

    /// Readings at rising fractions of the step.
    fn read(&mut self, at: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<Reading>> {
        if let Some(found) = self.continued(at) {
            return Ok(found);
        }
        for points in CHEBYSHEV.into_iter().take_while(|points| at.len() > points.len()) {
            for &s in points {
                self.nodes.push(self.at(s, monitor)?);
            }
            if self.is_resolved() {
                return Ok(at.iter().map(|&s| self.reading(&self.nodes, s)).collect());
            }
        }
        for &s in at {
            if self.nodes.iter().all(|node| (node.s - s).abs() > SAME) {
                self.nodes.push(self.at(s, monitor)?);
            }
        }
        sort_by_number(&mut self.nodes, |item| item.s);
        Ok(at.iter().map(|&s| self.reading(self.nearest(s), s)).collect())
    }

    /// The points nearest to s, of rising ones.
    fn nearest(&self, s: f64) -> &[Node] {
        /// For rates of third order.
        const POINTS: usize = 4;
        let (mut from, mut to) = (0, self.nodes.len());
        while to - from > POINTS {
            let below_is_farther = s - self.nodes[from].s > self.nodes[to - 1].s - s;
            if below_is_farther { from += 1 } else { to -= 1 }
        }
        &self.nodes[from..to]
    }

    /// Readings of the polynomial through this step and the one before, if it is accurate enough.
    fn continued(&self, at: &[f64]) -> Option<Vec<Reading>> {
        /// Largest change by the last term, in units of the allowed error.
        const LAST: f64 = 0.25;
        let before = self.before.as_ref()?;
        let ratio = before.duration / self.path.duration;
        let earlier = before.nodes.map(|node| Node { s: ratio * node.s, ..node });
        let mut nodes = self.nodes.clone();
        nodes.push(earlier[1]);
        let without = nodes.clone();
        nodes.push(earlier[0]);
        let changes = |s: f64| (value(&nodes, s, 0) - value(&without, s, 0)).abs();
        let accurate = at.iter().all(|&s| changes(s) <= LAST * self.errors[0]);
        accurate.then(|| at.iter().map(|&s| self.reading(&nodes, s)).collect())
    }

    /// Whether forces and breaks are polynomials of the degree of the points, as the last terms of their Chebyshev series
    /// show.
    fn is_resolved(&self) -> bool {
        let mut nodes = self.nodes.clone();
        sort_by_number(&mut nodes, |item| item.s);
        self.errors.iter().enumerate().all(|(of, &error)| {
            let values: Vec<f64> = nodes.iter().map(|node| node.values[of]).collect();
            left_out(&values) <= error
        })
    }

    fn reading(&self, nodes: &[Node], s: f64) -> Reading {
        Reading {
            force: value(nodes, s, 0),
            rate: slope(nodes, s, 1) / self.path.duration,
            free: value(nodes, s, 2).max(0.0),
        }
    }
}

/// About what the polynomial of degree N through values at the extrema of the Chebyshev polynomial T_N misses.
///
/// With a the last two coefficients of its series and q the ratio to those before, it is 2aq/(1 − q)², of the size of the rest
/// of a geometric series and of the rest of the series of a kink, whose coefficients fall like 1/n²; and at most 4a.
fn left_out(values: &[f64]) -> f64 {
    /// For kinks at N = 8.
    const KINK: f64 = 4.0;
    /// Weight of the last but three, of which one of degree 1 says little about the others.
    const LINEAR: f64 = 0.125;
    let degree = values.len() - 1;
    let halved = |k: usize| if k == 0 || k == degree { 0.5 } else { 1.0 };
    let term = |n: usize| {
        let angle = std::f64::consts::PI * n as f64 / degree as f64;
        let sum: f64 = (0..=degree).map(|k| halved(k) * values[k] * (angle * k as f64).cos()).sum();
        2.0 / degree as f64 * halved(n) * sum.abs()
    };
    let last = term(degree).max(term(degree - 1));
    let ratio = last / (term(degree - 2) + LINEAR * term(degree - 3)).max(f64::MIN_POSITIVE);
    let rest = if ratio < 1.0 { 2.0 * ratio / (1.0 - ratio).powi(2) } else { KINK };
    last * rest.min(KINK)
}

/// Value at s of the polynomial through the values number `of` at these points.
fn value(nodes: &[Node], s: f64, of: usize) -> f64 {
    let weight = |i: usize| -> f64 {
        let others = (0..nodes.len()).filter(|&j| j != i);
        others.map(|j| (s - nodes[j].s) / (nodes[i].s - nodes[j].s)).product()
    };
    (0..nodes.len()).map(|i| weight(i) * nodes[i].values[of]).sum()
}

/// Its derivative.
fn slope(nodes: &[Node], s: f64, of: usize) -> f64 {
    let weight = |i: usize| -> f64 {
        let others = || (0..nodes.len()).filter(move |&j| j != i);
        let without = |left: usize| -> f64 {
            let rest = others().filter(|&j| j != left);
            rest.map(|j| (s - nodes[j].s) / (nodes[i].s - nodes[j].s)).product()
        };
        others().map(|j| without(j) / (nodes[i].s - nodes[j].s)).sum()
    };
    (0..nodes.len()).map(|i| weight(i) * nodes[i].values[of]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Case<'a> = (&'a dyn Fn(f64) -> f64, [f64; 2]);

    #[test]
    fn what_is_left_out_is_reported_of_smooth_functions_and_of_kinks() {
        // A kink of the slope's slope may lie so that the last terms of degree 4 nearly vanish, not those of degree 8.
        let functions: [Case<'_>; 4] = [
            (&|s| (0.4 * s).exp(), [1.0, 1.0]),
            (&|s| (-2.0 * (s - 0.3) * (s - 0.3)).exp(), [1.0, 1.0]),
            (&|s| (s - 0.1).max(0.0).powi(2), [0.02, 0.8]),
            (&|s| (s - 0.61).max(0.0).powi(2), [0.02, 0.8]),
        ];
        for (of, least) in functions {
            for (degree, least) in [4, 8].into_iter().zip(least) {
                let at = |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / degree as f64).cos();
                let nodes: Vec<_> =
                    (0..=degree).map(at).map(|s| Node { s, values: [of(s), 0.0, 0.0] }).collect();
                let missed =
                    |k: u32| (value(&nodes, f64::from(k) / 200.0, 0) - of(f64::from(k) / 200.0)).abs();
                let most = (0..=200).map(missed).fold(0.0, f64::max);
                let reported = left_out(&nodes.iter().map(|node| node.values[0]).collect::<Vec<_>>());
                // Rounding apart.
                assert!(reported > least * most - 1e-14, "{degree}: {reported:e} {most:e}");
                assert!(reported < 100.0 * most, "{degree}: {reported:e} {most:e}");
            }
        }
    }

    #[test]
    fn the_points_are_extrema_of_chebyshev_polynomials() {
        for (level, degree) in [(0, 4), (1, 8)] {
            let at = |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / degree as f64).cos();
            let odd: Vec<f64> = (1..degree).step_by(2).map(at).collect();
            assert!(CHEBYSHEV[level].iter().zip(&odd).all(|(a, b)| (a - b).abs() < 1e-15), "{degree}");
        }
    }

    #[test]
    fn polynomials_and_their_slopes_are_exact() {
        let of = |s: f64| 1.0 + s - 3.0 * s * s + 0.5 * s.powi(3);
        let nodes = [-0.7, 0.0, 0.5, 1.0].map(|s| Node { s, values: [0.0, of(s), 0.0] });
        for s in [0.0, 0.2, 0.5, 0.9] {
            // Rounding.
            assert!((value(&nodes, s, 1) - of(s)).abs() < 1e-14, "{s}");
            assert!((slope(&nodes, s, 1) - (1.0 - 6.0 * s + 1.5 * s * s)).abs() < 1e-14, "{s}");
        }
    }
}
