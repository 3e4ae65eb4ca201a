//! Sums over contacts at given positions, from the changes at each break.
//!
//! Between breaks a contact of stiffness k carries kx with dx/dX = 1. Sums of kx and (kx)² at successive
//! positions therefore follow from each other and from the jumps at the breaks in between, *both sides of
//! which are evaluated at the later position*: nothing grows with X, so nothing cancels.

use crate::Result;
use crate::monitor::{Monitor, report};

/// The jumps between two positions, summed over breaks.
pub(super) trait TallyCell: Copy + Send + Sync {
    /// What a break adds.
    type Change: Copy + Default;
    const ZERO: Self;
    /// Whether all stiffnesses are 1.
    const EQUAL: bool;
    /// Adds a contact of stretch `x` and stiffness `k`.
    fn add(&mut self, x: f64, k: f64);
    /// A break, by the stretch and stiffness of its contact before and after.
    fn change(before: (f64, f64), after: (f64, f64)) -> Self::Change;
    /// Adds a break.
    fn apply(&mut self, change: Self::Change);
    fn merge(&mut self, other: &Self);
    /// Sums of k, kx, k², k²x, (kx)².
    fn sums(&self) -> [f64; 5];
    /// The part of these sums, of `size` contacts, that is constant and not stored.
    fn constant(size: f64) -> [f64; 5];
}

/// Contacts of equal stiffness 1: Σx and Σx².
#[derive(Debug, Clone, Copy)]
pub(super) struct Equal([f64; 2]);

impl TallyCell for Equal {
    type Change = [f64; 2];
    const ZERO: Self = Self([0.0; 2]);
    const EQUAL: bool = true;

    fn add(&mut self, x: f64, _k: f64) {
        self.0[0] += x;
        self.0[1] += x * x;
    }

    #[inline(always)]
    fn change((before, _): (f64, f64), (after, _): (f64, f64)) -> [f64; 2] {
        let jump = after - before;
        // x_a² − x_b² as a product: no cancellation where both are nearly equal.
        [jump, jump * (after + before)]
    }

    #[inline(always)]
    fn apply(&mut self, [first, second]: [f64; 2]) {
        self.0[0] += first;
        self.0[1] += second;
    }

    fn merge(&mut self, other: &Self) {
        self.0[0] += other.0[0];
        self.0[1] += other.0[1];
    }

    fn sums(&self) -> [f64; 5] {
        [0.0, self.0[0], 0.0, self.0[0], self.0[1]]
    }

    fn constant(size: f64) -> [f64; 5] {
        [size, 0.0, size, 0.0, 0.0]
    }
}

/// Contacts of different stiffnesses: all five sums.
#[derive(Debug, Clone, Copy)]
pub(super) struct Different([f64; 5]);

impl Different {
    #[inline(always)]
    fn weigh(&mut self, sign: f64, x: f64, k: f64) {
        let terms = [k, k * x, k * k, k * k * x, k * x * k * x];
        self.0.iter_mut().zip(terms).for_each(|(sum, term)| *sum += sign * term);
    }
}

impl TallyCell for Different {
    type Change = [(f64, f64); 2];
    const ZERO: Self = Self([0.0; 5]);
    const EQUAL: bool = false;

    fn add(&mut self, x: f64, k: f64) {
        self.weigh(1.0, x, k);
    }

    #[inline(always)]
    fn change(before: (f64, f64), after: (f64, f64)) -> Self::Change {
        [before, after]
    }

    #[inline(always)]
    fn apply(&mut self, [before, after]: Self::Change) {
        self.weigh(-1.0, before.0, before.1);
        self.weigh(1.0, after.0, after.1);
    }

    fn merge(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, term)| *sum += term);
    }

    fn sums(&self) -> [f64; 5] {
        self.0
    }

    fn constant(_size: f64) -> [f64; 5] {
        [0.0; 5]
    }
}

/// Rising values, with a search for the first that is not below a given one.
pub(super) struct PositionGrid<'a> {
    values: &'a [f64],
    /// Steps per length and the offset, if the values are evenly spaced to a thousandth of a step.
    even: Option<(f64, f64)>,
}

impl<'a> PositionGrid<'a> {
    pub(super) fn new(values: &'a [f64]) -> Self {
        let (first, last) = (values[0], values[values.len() - 1]);
        let step = (last - first) / (values.len() - 1).max(1) as f64;
        let off = |(i, x): (usize, &f64)| (x - (first + i as f64 * step)).abs() > 1e-3 * step;
        let even = step > 0.0 && !values.iter().enumerate().any(off);
        // Never too high, since values are right to a thousandth; hardly ever too low.
        Self { values, even: even.then_some((1.0 / step, 0.498 - first / step)) }
    }

    /// The index of the first value ≥ `x`, and that value; `x` is not above the last value.
    #[inline]
    pub(super) fn at_or_above(&self, x: f64) -> (usize, f64) {
        let guess = match self.even {
            Some((density, offset)) => nearest(x * density + offset),
            None => self.values.partition_point(|&value| value < x),
        };
        let value = self.values[guess];
        if value < x { (guess + 1, self.values[guess + 1]) } else { (guess, value) }
    }
}

/// A uniform grid `first` + `reach` (i/`steps`); the next node is computed, not searched, so that the loop
/// vectorises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UniformGrid {
    first: f64,
    reach: f64,
    steps: f64,
    /// Steps per length, and the offset.
    density: f64,
    offset: f64,
}

impl UniformGrid {
    /// The grid with exactly these values, if there is one.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        // In steps: more than the rounding of a value.
        const OFF: f64 = 1e-6;
        let (first, last) = (values[0], values[values.len() - 1]);
        let (distance, steps) = (last - first, (values.len() - 1) as f64);
        let (density, offset) = (steps / distance, 0.5 - OFF - first * (steps / distance));
        let grid = |reach, steps| Self { first, reach, steps, density, offset };
        let exact = |grid: &Self| values.iter().enumerate().all(|(i, &x)| x == grid.value(i as f64));
        [grid(distance, steps), grid(distance / steps, 1.0)]
            .into_iter()
            .find(exact)
            .filter(|_| distance > 0.0)
    }

    #[inline(always)]
    fn value(&self, index: f64) -> f64 {
        self.first + self.reach * (index / self.steps)
    }

    /// The index of the first value ≥ `x`, and that value; with a probability of 1e-6 the one before, which
    /// is below.
    #[inline(always)]
    pub(super) fn guess(&self, x: f64) -> (u32, f64) {
        // The addition rounds to an integer, which is then in the low bits of the mantissa.
        let whole = (x * self.density + self.offset).max(0.0) + POWER;
        (whole.to_bits() as u32, self.value(whole - POWER))
    }
}

/// Adding this shifts the fraction out of the mantissa and leaves the nearest integer there.
const POWER: f64 = (1u64 << 52) as f64;

/// The whole number next to `x` < 2³², 0 for negative ones, in fewer instructions than a cast.
#[inline]
fn nearest(x: f64) -> usize {
    (x.max(0.0) + POWER).to_bits() as u32 as usize
}

/// Positions between two reports to the monitor.
const PART: usize = 1 << 20;

/// The mean force of `size` contacts at each position, and its standard error, both times `scale`.
///
/// `cells[g]` holds what changed after position g − 1 and not after position g.
///
/// # Errors
/// Stopped by `monitor`.
pub(super) fn forces<C: TallyCell>(
    cells: &[C],
    positions: &[f64],
    size: usize,
    scale: f64,
    monitor: &mut dyn Monitor,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let n = size as f64;
    let [mut k, mut f, mut kk, mut kf, mut ff] = C::constant(n);
    let mut before = positions[0];
    let mut point = |(cell, &position): (&C, &f64)| {
        let step = position - before;
        before = position;
        // Propagation of Σf² and Σf over one interval without breaks, then the jumps at its end.
        ff += step * (2.0 * kf + step * kk);
        f += step * k;
        kf += step * kk;
        let [dk, df, dkk, dkf, dff] = cell.sums();
        (k, f, kk, kf, ff) = (k + dk, f + df, kk + dkk, kf + dkf, ff + dff);
        let mean = f / n;
        // The standard error of a mean of n independent contacts; rounding may make a vanishing
        // variance negative.
        (scale * mean, scale * ((ff / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
    };
    let mut all = (Vec::with_capacity(cells.len()), Vec::with_capacity(cells.len()));
    for (cells, positions) in cells.chunks(PART).zip(positions.chunks(PART)) {
        all.extend(cells.iter().zip(positions).map(&mut point));
        report(monitor, 0.0)?;
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::{PositionGrid, UniformGrid, nearest};

    #[test]
    fn a_uniform_grid_finds_the_same_positions() {
        let by_steps = |first: f64, step: f64| (0..=2000).map(move |i| first + f64::from(i) * step).collect();
        let to_the_end = (0..=2000).map(|i| 0.7 * (f64::from(i) / 2000.0)).collect();
        let grids: [Vec<f64>; 4] =
            [by_steps(0.0, 0.05), by_steps(3.0, 0.25), by_steps(0.0, 1e-3), to_the_end];
        for values in grids {
            let (positions, grid) = (PositionGrid::new(&values), UniformGrid::of(&values).unwrap());
            let step = values[1] - values[0];
            let near =
                values[..2000].iter().flat_map(|&x| [x - 1e-5 * step, x, x + 1e-5 * step, x + 0.6 * step]);
            for x in near.chain([-1.0]) {
                let (index, value) = grid.guess(x);
                assert_eq!((index as usize, value), positions.at_or_above(x), "{x}");
            }
            // Nothing is compared: just above a value, it is taken for the next one.
            let (index, value) = grid.guess(values[7].next_up());
            assert_eq!((index, value), (7, values[7]));
        }
    }

    #[test]
    fn other_positions_have_no_uniform_grid() {
        for values in [&[0.0, 0.1, 0.2 + 1e-12, 0.3][..], &[0.0, 0.1, 0.5], &[1.0], &[1.0, 1.0]] {
            assert_eq!(UniformGrid::of(values), None);
        }
    }

    #[test]
    fn nearest_whole_number() {
        let cases = [
            (-1e9, 0),
            (-0.3, 0),
            (0.49, 0),
            (0.51, 1),
            (2000.4999, 2000),
            (4_294_967_295.0, u32::MAX as usize),
        ];
        for (x, whole) in cases {
            assert_eq!(nearest(x), whole, "{x}");
        }
    }
}
