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

use super::{Potential, bernoulli};
use crate::numerics::roots::brent_root;

/// √2.
const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// γ = 1 − 1/√2.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The cells, as fractions of the interval.
#[derive(Debug, Clone)]
pub struct MovingGrid {
    cells: Vec<GridCell>,
}

/// Work space of a step.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    rows: Vec<Row>,
    stage: Vec<f64>,
}

/// A cell of width 1/`inverse` with its upper face, relative to the interval.
#[derive(Debug, Clone, Copy)]
struct GridCell {
    middle: f64,
    inverse: f64,
    /// 1/(distance to the next middle).
    next: f64,
    /// 1 − φ of the upper face: its velocity over that of the floor.
    lag: f64,
}

/// A row of the elimination: the rates down and up times a, 1/d, and the fraction handed down.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    down: f64,
    up: f64,
    inverse: f64,
    handed: f64,
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

/// A loss rate as a function of the position h, at the middle of the step.
pub type Sink<'a> = &'a dyn Fn(f64) -> f64;

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
        let width = |i: usize| faces[i + 1] - faces[i];
        let middle = |i: usize| 0.5 * (faces[i] + faces[i + 1]);
        let cell = |i: usize| GridCell {
            middle: middle(i),
            inverse: 1.0 / width(i),
            next: 1.0 / (middle(i + 1) - middle(i)),
            lag: 1.0 - faces[i + 1],
        };
        Self { cells: (0..cells).map(cell).collect() }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// Middles of the cells between a floor and a ceiling.
    pub fn middles(&self, floor: f64, ceiling: f64) -> impl Iterator<Item = f64> + '_ {
        self.cells.iter().map(move |cell| floor + (ceiling - floor) * cell.middle)
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
        let Workspace { rows, stage } = room;
        rows.resize(masses.len(), Row::default());
        stage.resize(masses.len(), 0.0);
        let Some(held) = held(masses) else { return };
        let reached = self.eliminate(rise, medium, held, rows);
        let (rows, stage, masses) =
            (&rows[reached.clone()], &mut stage[reached.clone()], &mut masses[reached]);
        solve(rows, masses, stage);
        // Both stages have the same matrix, factorised once: γ is the same in both, which is the
        // reason for an SDIRK method.
        for (stage, mass) in stage.iter_mut().zip(masses.iter()) {
            *stage = (1.0 + SQRT_2) * *stage - SQRT_2 * mass;
        }
        solve(rows, stage, masses);
    }

    /// Factorises (1 − aL + aw) by the Thomas algorithm, from the top down, for the cells that what is held can reach, which
    /// are returned.
    fn eliminate(
        &self,
        rise: &MovingBoundary,
        medium: &Coefficients<'_>,
        held: Range<usize>,
        rows: &mut [Row],
    ) -> Range<usize> {
        let (start, end) = rise.floor;
        let (a, x) = (GAMMA * rise.duration, 0.5 * (start + end));
        let motion = (a * medium.diffusion, GAMMA * (end - start));
        let reached = self.rates(x, rise, motion, medium.potential, held, rows);
        let (length, mut kept) = (rise.ceiling - x, 0.0);
        for (row, cell) in rows[reached.clone()].iter_mut().zip(&self.cells[reached.clone()]).rev() {
            let rest = 1.0 + medium.sink.map_or(0.0, |w| a * w(x + length * cell.middle)) + row.up * kept;
            // All sums are of terms ≥ 0 where the rates are: no digits are lost by cancellation,
            // however stiff the system.
            row.inverse = 1.0 / (rest + row.down);
            row.handed = row.down * row.inverse;
            kept = rest * row.inverse;
        }
        reached
    }

    /// Rates between cells times a, for `spread` = aD and `travel` = av, of those that what is `held` can reach: what a step
    /// carries on falls by |up|/(1 + down) from cell to cell, or by the root of this where rates are negative.
    fn rates(
        &self,
        x: f64,
        rise: &MovingBoundary,
        (spread, travel): (f64, f64),
        potential: &Potential,
        held: Range<usize>,
        rows: &mut [Row],
    ) -> Range<usize> {
        /// The square of the part of the masses that no result shows.
        const UNSEEN: f64 = 1e-40;
        let length = rise.ceiling - x;
        let per_length = 1.0 / length;
        let at = |cell: &GridCell| potential.at(x + length * cell.middle);
        let couple = |rows: &mut [Row], i: usize, low: f64, high: f64| {
            let (cell, next) = (&self.cells[i], &self.cells[i + 1]);
            let (rise, rate, carried) =
                (high - low, spread * cell.next * per_length, 0.5 * travel * cell.lag);
            // B(−δ) = B(δ) + δ.
            // Bernoulli functions of the potential difference make the flux of the Boltzmann
            // distribution vanish exactly (D. L. Scharfetter and H. K. Gummel, IEEE Trans. Electron
            // Devices 16, 64 (1969)).
            let gentle = bernoulli(rise);
            rows[i].up = (rate * gentle - carried) * cell.inverse * per_length;
            rows[i + 1].down = (rate * (gentle + rise) + carried) * next.inverse * per_length;
        };
        let (mut first, mut last, lowest) = (held.start, held.start, at(&self.cells[held.start]));
        let (mut low, mut reach) = (lowest, 1.0);
        while last + 1 < held.end || last + 1 < self.cells.len() && reach > UNSEEN {
            let high = at(&self.cells[last + 1]);
            couple(rows, last, low, high);
            if last + 1 >= held.end {
                reach *= rows[last].up.abs() / (1.0 + rows[last + 1].down.abs());
            }
            (low, last) = (high, last + 1);
        }
        let (mut high, mut reach) = (lowest, 1.0);
        while first > 0 && reach > UNSEEN {
            let low = at(&self.cells[first - 1]);
            couple(rows, first - 1, low, high);
            reach *= rows[first].down.abs() / (1.0 + rows[first].down.abs());
            (high, first) = (low, first - 1);
        }
        rows[first].down = 0.0;
        rows[last].up = 0.0;
        if first == 0 && rise.absorbing {
            let (cell, half) = (self.cells[0], length * self.cells[0].middle);
            // Scharfetter–Gummel flux over the half cell next to the floor, in the frame of the floor.
            let slope = at(&self.cells[1]) - at(&self.cells[0]);
            let fall = -slope * cell.next * cell.middle - travel / spread * half;
            rows[0].down = spread * bernoulli(fall) / half * cell.inverse * per_length;
        }
        first..last + 1
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

/// Writes (1 − aL + aw)⁻¹ `right` into `out`.
fn solve(rows: &[Row], right: &[f64], out: &mut [f64]) {
    let (mut carried, mut lifted) = (0.0, 0.0);
    for ((row, right), out) in rows.iter().zip(right).zip(out.iter_mut()).rev() {
        *out = right + carried;
        carried = row.handed * *out;
    }
    for (row, out) in rows.iter().zip(out) {
        *out = (*out + lifted) * row.inverse;
        lifted = row.up * *out;
    }
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
        let mass = |cell: &GridCell| {
            let high = 1.0 - cell.lag;
            below(face(high)) - below(face(std::mem::replace(&mut low, high)))
        };
        grid.cells.iter().map(mass).collect()
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
        let solved = room.rows.iter().filter(|row| row.inverse != 0.0).count();
        assert!(solved < 2000, "{solved} cells");
    }
}
