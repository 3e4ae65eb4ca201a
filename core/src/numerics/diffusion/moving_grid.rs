//! Finite volumes above a floor that rises steadily, on cells that move with it (an arbitrary
//! Lagrangian–Eulerian grid).
//!
//! On [x, H], H at rest, the faces are h_i = x + (H − x)φ_i with fixed fractions φ_i, denser towards the
//! floor, so that the layer of width D/v above it is resolved however thin it is, and nothing jumps from cell
//! to cell. The error is a series in even powers of the cell width and whole powers of the time step, from
//! the second on, and can be removed by Richardson extrapolation. Through a face that moves at the velocity
//! w_i the flux is that of Scharfetter and Gummel minus w_i times the mean of the two densities, a central
//! difference that neither amplifies nor damps. At rest the distribution with density e^{−U} at the middles
//! is stationary to rounding. The flux into the floor is the Scharfetter–Gummel flux in the frame of the
//! floor, with U' + v/D in place of U'; it absorbs all that the floor meets where the layer is thinner than
//! the lowest cell. Cells with rough content may turn slightly negative.
//!
//! A step solves for the cells that hold something, and for as many beside them as it can reach: of a narrow distribution, which
//! needs narrow cells everywhere, these are few.

use std::ops::Range;

use super::Potential;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal};
use crate::numerics::roots::brent_root;
use crate::numerics::wide::vectorised;

/// √2.
const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// γ = 1 − 1/√2.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The cells, as fractions of the interval.
#[derive(Debug, Clone)]
pub struct MovingGrid {
    middles: Vec<f64>,
    /// 1/width.
    inverses: Vec<f64>,
    /// 1/(distance to the next middle).
    nexts: Vec<f64>,
    /// 1 − φ of the upper face: its velocity over that of the floor.
    lags: Vec<f64>,
}

/// Work space of a step.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    rates: Rates,
    factorisation: TwistedFactorisation,
    masses: PairedMasses,
    /// The masses before the step.
    begun: PairedMasses,
}

/// What a step knows of each cell.
#[derive(Debug, Clone, Default)]
struct Rates {
    /// U at its middle.
    potential: Vec<f64>,
    /// The rates into the next cell and into the one before, times a.
    up: Vec<f64>,
    down: Vec<f64>,
    /// 1 + aw.
    diagonal: Vec<f64>,
}

/// A number for each of an odd number of cells, as pairs from both ends to the middle.
#[derive(Debug, Clone, Default)]
struct PairedMasses {
    pairs: Vec<[f64; 2]>,
    middle: f64,
}

/// A factorised matrix: the elimination goes from both ends to the middle, which are two chains of operations at once (a twisted
/// factorisation).
#[derive(Debug, Clone, Default)]
struct TwistedFactorisation {
    rows: Vec<Row>,
    /// 1/d of the middle.
    middle: f64,
}

/// A pair of rows of the elimination: 1/d, the fraction handed on towards the middle, and that of the next row which comes back.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    inverse: [f64; 2],
    handed: [f64; 2],
    back: [f64; 2],
}

/// The motion of the floor in a step.
#[derive(Debug, Clone, Copy)]
pub struct MovingBoundary {
    /// Position of the floor before and after.
    pub floor: (f64, f64),
    /// Upper end of the axis, which reflects.
    pub ceiling: f64,
    /// Duration.
    pub duration: f64,
    /// Whether the floor absorbs; else it reflects.
    pub absorbing: bool,
}

/// Loss rates at sixteen positions h, at the middle of the step.
pub type Sink<'a> = &'a dyn Fn(&Nodal) -> Nodal;

/// Drift, diffusion and loss.
#[derive(Clone, Copy)]
pub struct Coefficients<'a> {
    /// U.
    pub potential: &'a Potential,
    /// D, above 0.
    pub diffusion: f64,
    /// Loss rate in addition to absorption at the floor.
    pub sink: Option<Sink<'a>>,
}

impl std::fmt::Debug for Coefficients<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Coefficients")
            .field("potential", &self.potential)
            .field("diffusion", &self.diffusion)
            .finish_non_exhaustive()
    }
}

impl MovingGrid {
    /// A grid whose lowest cell is about `finest` times as wide as equal ones. Half of the cells are spaced
    /// evenly, half are concentrated towards the floor: ξ = ½φ + ½ ln(1 + φ/δ)/ln(1 + 1/δ) for the fraction ξ
    /// of the cells below φ.
    pub fn new(cells: usize, finest: f64) -> Self {
        let grading = grading(finest);
        let face = |i: usize| face_position(i as f64 / cells as f64, grading);
        let faces: Vec<f64> = (0..cells + 2).map(face).collect();
        let middle = |i: usize| 0.5 * (faces[i] + faces[i + 1]);
        let each = |of: &dyn Fn(usize) -> f64| (0..cells).map(of).collect();
        Self {
            middles: each(&middle),
            inverses: each(&|i| 1.0 / (faces[i + 1] - faces[i])),
            nexts: each(&|i| 1.0 / (middle(i + 1) - middle(i))),
            lags: each(&|i| 1.0 - faces[i + 1]),
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.middles.len()
    }

    /// Middles of the cells between a floor and a ceiling.
    pub fn middles(&self, floor: f64, ceiling: f64) -> impl Iterator<Item = f64> + '_ {
        self.middles.iter().map(move |middle| floor + (ceiling - floor) * middle)
    }

    /// The Wasserstein distance ∫|F₁ − F₂| of two distributions of these masses, as a fraction of the interval. It is NaN without
    /// masses.
    pub fn wasserstein_distance(&self, first: &[f64], second: &[f64]) -> f64 {
        let [whole, other] = [first, second].map(|masses| masses.iter().sum::<f64>());
        let (mut below, mut distance) = (0.0, 0.0);
        for (inverse, (one, two)) in self.inverses.iter().zip(first.iter().zip(second)) {
            below += one / whole - two / other;
            distance += f64::abs(below) / inverse;
        }
        distance
    }

    /// Advances masses by one step of the two-stage SDIRK method of R. Alexander, SIAM J. Numer. Anal. 14,
    /// 1006 (1977): u₁ = Am, then A[(1 + √2)u₁ − √2m] with A = (1 − γtL)⁻¹, γ = 1 − 1/√2, of second order and
    /// L-stable. The rates are those at the middle of the step.
    pub fn advance(
        &self,
        rise: &MovingBoundary,
        medium: &Coefficients<'_>,
        masses: &mut [f64],
        room: &mut Workspace,
    ) {
        let Some(held) = held(masses) else { return };
        let Workspace { rates, factorisation, masses: pairs, begun } = room;
        let reached = self.find_rates(rise, medium, held, rates);
        factorisation.factorise(rates, reached.clone());
        pairs.set(masses, reached.start, factorisation.rows.len());
        factorisation.advance(pairs, begun);
        pairs.put(&mut masses[reached.clone()]);
    }

    /// The rates of the cells that what is `held` can reach, which are returned: what a step carries on falls by |up|/(1 + down)
    /// from cell to cell, or by the root of this where rates are negative.
    fn find_rates(
        &self,
        rise: &MovingBoundary,
        medium: &Coefficients<'_>,
        held: Range<usize>,
        rates: &mut Rates,
    ) -> Range<usize> {
        /// The square of the part of the masses that no result shows.
        const UNSEEN: f64 = 1e-40;
        /// Cells whose rates are found at once.
        const CHUNK: usize = 16;
        rates.resize(self.cells() + 1);
        let step = FloorStep::of(rise, medium);
        let (mut first, mut last) = (held.start, held.end - 1);
        self.couple(first..last, &step, medium.potential, rates);
        let mut reach = 1.0;
        while last + 1 < self.cells() && reach > UNSEEN {
            let end = (last + CHUNK).min(self.cells() - 1);
            self.couple(last..end, &step, medium.potential, rates);
            while last < end && reach > UNSEEN {
                reach *= rates.up[last].abs() / (1.0 + rates.down[last + 1].abs());
                last += 1;
            }
        }
        reach = 1.0;
        while first > 0 && reach > UNSEEN {
            let start = first.saturating_sub(CHUNK);
            self.couple(start..first, &step, medium.potential, rates);
            while first > start && reach > UNSEEN {
                first -= 1;
                reach *= rates.down[first + 1].abs() / (1.0 + rates.down[first + 1].abs());
            }
        }
        rates.down[first] = 0.0;
        rates.up[last] = 0.0;
        if first == 0 && rise.absorbing {
            rates.down[0] = self.absorption(&step, medium.potential);
        }
        let reached = first..last + 1;
        rates.diagonal[reached.clone()].fill(1.0);
        if let Some(sink) = medium.sink {
            self.add_losses(reached.clone(), &step, sink, rates);
        }
        reached
    }

    fn add_losses(&self, cells: Range<usize>, step: &FloorStep, sink: Sink<'_>, rates: &mut Rates) {
        let middles = self.middles[cells.clone()].chunks(NODES);
        for (diagonals, middles) in rates.diagonal[cells].chunks_mut(NODES).zip(middles) {
            let mut positions = [step.floor + step.length; NODES];
            for (position, middle) in positions.iter_mut().zip(middles) {
                *position = step.floor + step.length * middle;
            }
            for (diagonal, loss) in diagonals.iter_mut().zip(sink(&positions)) {
                *diagonal += step.a * loss;
            }
        }
    }

    /// Rates times a between each of these cells and the next one.
    fn couple(&self, cells: Range<usize>, step: &FloorStep, potential: &Potential, rates: &mut Rates) {
        vectorised(
            #[inline(always)]
            || self.couple_all(cells, step, potential, rates),
        );
    }

    #[inline(always)]
    fn couple_all(&self, cells: Range<usize>, step: &FloorStep, potential: &Potential, rates: &mut Rates) {
        let Range { start, end } = cells;
        let count = end - start;
        for (value, middle) in rates.potential[start..=end].iter_mut().zip(&self.middles[start..=end]) {
            *value = potential.at(step.floor + step.length * middle);
        }
        let spread = step.spread / (step.length * step.length);
        let travel = 0.5 * step.travel / step.length;
        let [low, high] = [start, start + 1].map(|i| &rates.potential[i..][..count]);
        let [inverses, above] = [start, start + 1].map(|i| &self.inverses[i..][..count]);
        let (nexts, lags) = (&self.nexts[start..end], &self.lags[start..end]);
        let (up, down) = (&mut rates.up[start..end], &mut rates.down[start + 1..=end]);
        for i in 0..count {
            let (rise, rate, carried) = (high[i] - low[i], spread * nexts[i], travel * lags[i]);
            // Bernoulli functions of the potential difference make the flux of the Boltzmann
            // distribution vanish exactly (D. L. Scharfetter and H. K. Gummel, IEEE Trans. Electron
            // Devices 16, 64 (1969)). B(−δ) = B(δ) + δ.
            let gentle = bernoulli(rise);
            up[i] = (rate * gentle - carried) * inverses[i];
            down[i] = (rate * (gentle + rise) + carried) * above[i];
        }
    }

    /// The rate times a at which the floor absorbs the lowest cell: the Scharfetter–Gummel flux over the half cell next to it, in
    /// the frame of the floor.
    fn absorption(&self, step: &FloorStep, potential: &Potential) -> f64 {
        let [low, high] = [0, 1].map(|i| potential.at(step.floor + step.length * self.middles[i]));
        let half = step.length * self.middles[0];
        let fall = -(high - low) * self.nexts[0] * self.middles[0] - step.travel / step.spread * half;
        step.spread * bernoulli(fall) / half * self.inverses[0] / step.length
    }
}

/// A step of the moving floor: a = γt, the floor in its middle and the length above it, and what a cell exchanges in a.
struct FloorStep {
    a: f64,
    floor: f64,
    length: f64,
    /// aD.
    spread: f64,
    /// av.
    travel: f64,
}

impl FloorStep {
    fn of(rise: &MovingBoundary, medium: &Coefficients<'_>) -> Self {
        let (start, end) = rise.floor;
        let (a, floor) = (GAMMA * rise.duration, 0.5 * (start + end));
        let (spread, travel) = (a * medium.diffusion, GAMMA * (end - start));
        Self { a, floor, length: rise.ceiling - floor, spread, travel }
    }
}

impl Rates {
    fn resize(&mut self, cells: usize) {
        for numbers in [&mut self.potential, &mut self.up, &mut self.down, &mut self.diagonal] {
            numbers.resize(cells, 0.0);
        }
    }
}

impl PairedMasses {
    /// Takes the masses from a cell on, as many pairs; there is nothing beyond the last cell.
    fn set(&mut self, masses: &[f64], first: usize, pairs: usize) {
        let top = first + 2 * pairs;
        let at = |i: usize| masses.get(i).copied().unwrap_or(0.0);
        self.pairs.clear();
        self.pairs.extend((0..pairs).map(|k| [at(first + k), at(top - k)]));
        self.middle = at(first + pairs);
    }

    /// Writes the masses.
    fn put(&self, masses: &mut [f64]) {
        let (count, top) = (self.pairs.len(), 2 * self.pairs.len());
        for (k, [low, high]) in self.pairs.iter().enumerate() {
            masses[k] = *low;
            if let Some(mass) = masses.get_mut(top - k) {
                *mass = *high;
            }
        }
        masses[count] = self.middle;
    }
}

impl TwistedFactorisation {
    /// Factorises (1 − aL + aw) for these cells, and one above them if they are an even number.
    fn factorise(&mut self, rates: &mut Rates, cells: Range<usize>) {
        let (first, pairs) = (cells.start, cells.len() / 2);
        let (middle, top) = (first + pairs, first + 2 * pairs);
        if top == cells.end {
            (rates.up[top], rates.down[top], rates.diagonal[top]) = (0.0, 0.0, 1.0);
        }
        let Rates { up, down, diagonal, .. } = &*rates;
        self.rows.clear();
        let mut kept = [1.0; 2];
        for k in 0..pairs {
            let (low, high) = (first + k, top - k);
            let (inwards, outwards) = ([up[low], down[high]], [down[low], up[high]]);
            let returning = [down[low + 1], up[high - 1]];
            let own = [diagonal[low], diagonal[high]];
            let mut row = Row::default();
            for i in 0..2 {
                // All sums are of terms ≥ 0 where the rates are: no digits are lost by cancellation,
                // however stiff the system.
                let rest = own[i] + outwards[i] * kept[i];
                row.inverse[i] = 1.0 / (rest + inwards[i]);
                row.handed[i] = inwards[i] * row.inverse[i];
                row.back[i] = returning[i] * row.inverse[i];
                kept[i] = rest * row.inverse[i];
            }
            self.rows.push(row);
        }
        self.middle = 1.0 / (diagonal[middle] + down[middle] * kept[0] + up[middle] * kept[1]);
    }

    /// Both stages of a step. They have the same matrix, factorised once: γ is the same in both, which is the reason for an
    /// SDIRK method.
    fn advance(&self, masses: &mut PairedMasses, begun: &mut PairedMasses) {
        begun.pairs.clone_from(&masses.pairs);
        begun.middle = masses.middle;
        self.solve(masses);
        for (stage, mass) in masses.pairs.iter_mut().zip(&begun.pairs) {
            for i in 0..2 {
                stage[i] = (1.0 + SQRT_2) * stage[i] - SQRT_2 * mass[i];
            }
        }
        masses.middle = (1.0 + SQRT_2) * masses.middle - SQRT_2 * begun.middle;
        self.solve(masses);
    }

    /// Multiplies by (1 − aL + aw)⁻¹.
    fn solve(&self, numbers: &mut PairedMasses) {
        let mut carried = [0.0; 2];
        for (row, pair) in self.rows.iter().zip(&mut numbers.pairs) {
            for i in 0..2 {
                pair[i] += carried[i];
                carried[i] = row.handed[i] * pair[i];
            }
        }
        numbers.middle = (numbers.middle + carried[0] + carried[1]) * self.middle;
        let mut inner = [numbers.middle; 2];
        for (row, pair) in self.rows.iter().zip(&mut numbers.pairs).rev() {
            for i in 0..2 {
                pair[i] = pair[i] * row.inverse[i] + row.back[i] * inner[i];
                inner[i] = pair[i];
            }
        }
    }
}

/// The cells that hold masses; `None` if none does. Others hold as much as rounding leaves in them: what central differences make of
/// it goes through all cells.
fn held(masses: &[f64]) -> Option<Range<usize>> {
    const FAINT: f64 = 1e-16;
    let least = FAINT * masses.iter().fold(0.0, |most: f64, mass| most.max(mass.abs()));
    let holds = |mass: &f64| mass.abs() > least;
    Some(masses.iter().position(holds)?..masses.iter().rposition(holds)? + 1)
}

/// The Bernoulli function B(z) = z/(e^z − 1).
#[inline(always)]
fn bernoulli(z: f64) -> f64 {
    /// Below this |z| a series is summed, with a relative error of z¹⁰/5e7.
    const SMALL: f64 = 0.2;
    let square = z * z;
    let inner = 1.0 - square * (1.0 / 42.0) * (1.0 - square * (1.0 / 40.0));
    let series = 1.0 - 0.5 * z + square * (1.0 / 12.0) * (1.0 - square * (1.0 / 60.0) * inner);
    // The quotient keeps all digits but one.
    let quotient = z / (exp(z) - 1.0);
    if z.abs() > SMALL { quotient } else { series }
}

/// δ for a lowest cell of `finest` times the width of equal cells; infinite for equal cells.
fn grading(finest: f64) -> f64 {
    let wanted = finest / (2.0 - finest);
    let over = |log: f64| log.exp() * (-log).exp().ln_1p() - wanted;
    if finest >= 1.0 {
        f64::INFINITY
    } else {
        brent_root(over, -100.0, 40.0, 0.0).map_or(f64::INFINITY, f64::exp)
    }
}

/// φ for a fraction ξ of the cells.
fn face_position(part: f64, grading: f64) -> f64 {
    if !grading.is_finite() || part == 0.0 {
        return part;
    }
    let whole = grading.recip().ln_1p();
    let over = |face_position: f64| 0.5 * (face_position + (face_position / grading).ln_1p() / whole) - part;
    brent_root(over, 0.0, 2.0, 0.0).unwrap_or(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard deviation to begin with.
    const WIDTH: f64 = 1e-3;

    /// Masses of a Gaussian around 1 of this standard deviation, on cells between a floor and 4.
    fn bell(grid: &MovingGrid, floor: f64, std: f64) -> Vec<f64> {
        let below = |h: f64| 0.5 * libm::erfc(-(h - 1.0) / (std * SQRT_2));
        let face = |fraction: f64| floor + (4.0 - floor) * fraction;
        let mut low = 0.0;
        let mass = |lag: &f64| {
            let high = 1.0 - lag;
            below(face(high)) - below(face(std::mem::replace(&mut low, high)))
        };
        grid.lags.iter().map(mass).collect()
    }

    #[test]
    fn distributions_that_are_shifted_are_apart_by_the_shift() {
        let grid = MovingGrid::new(4000, 0.05);
        // Both between a floor of 0.2 and 4.
        let [first, wider] = [10.0 * WIDTH, 30.0 * WIDTH].map(|std| bell(&grid, 0.2, std));
        let shifted: Vec<f64> = bell(&grid, 0.1, 10.0 * WIDTH).iter().map(|mass| 0.4 * mass).collect();
        let length = 3.8;
        // A bell on [0.1, 4] in its middle, at (1 − 0.1)/3.9, is at 0.2 + 3.8 (1 − 0.1)/3.9 on [0.2, 4].
        let shift = 0.2 + length * 0.9 / 3.9 - 1.0;
        let found = length * grid.wasserstein_distance(&first, &shifted);
        // To the square of a cell, 1e-3, over the width.
        assert!((found - shift).abs() < 1e-4, "{found} {shift}");
        // ∫|Φ(x/σ₁) − Φ(x/σ₂)| dx = (σ₂ − σ₁)√(2/π).
        let found = length * grid.wasserstein_distance(&first, &wider);
        let expected = 20.0 * WIDTH * std::f64::consts::FRAC_2_PI.sqrt();
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }

    #[test]
    fn a_narrow_distribution_spreads_and_takes_few_of_many_cells() {
        let (diffusion, time, steps) = (0.5 * WIDTH * WIDTH, 3.0, 200);
        let grid = MovingGrid::new(40_000, 0.05);
        let potential = Potential::of(|_| 1.0, (0.0, 4.0), 64);
        let medium = Coefficients { potential: &potential, diffusion, sink: None };
        let mut masses = bell(&grid, 0.2, WIDTH);
        let mut room = Workspace::default();
        let floor = |step: u32| 0.2 + 0.02 * WIDTH * f64::from(step);
        for step in 0..steps {
            let rise = MovingBoundary {
                floor: (floor(step), floor(step + 1)),
                ceiling: 4.0,
                duration: time / f64::from(steps),
                absorbing: true,
            };
            grid.advance(&rise, &medium, &mut masses, &mut room);
        }
        // Variances add up: 1 + 2Dt/σ² = 4.
        let exact = bell(&grid, floor(steps), 2.0 * WIDTH);
        let apart: f64 = masses.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum();
        // Cells of a tenth of the width, Δ, go through it, X, four times: waves of length k⁻¹ are late by k²Δ²X/6 there.
        assert!(apart < 0.02, "{apart:e}");
        // What a step leaves at its ends, in steps that carry all along, is nothing.
        let whole: f64 = masses.iter().sum();
        assert!((whole - 1.0).abs() < 1e-13, "{:e}", whole - 1.0);
        // Ten of the last standard deviation at either side are 400 cells, and a step reaches some hundred more.
        let solved = 2 * room.factorisation.rows.len() + 1;
        assert!(solved < 2000, "{solved} cells");
    }
}
