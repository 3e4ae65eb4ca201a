//! Diffusion above a floor that rises steadily, on cells that follow it.
//!
//! On [x, H], H at rest, the faces are h_i = x + (H − x)φ_i with fixed fractions φ_i, denser towards the floor, so that the
//! layer of width D/v above it is resolved however thin, and nothing ever jumps: errors are even powers of the width of the
//! cells and whole ones of the length of a step, from the second on, and can be extrapolated away. Through a face that
//! moves at the speed w_i the flux is that of Scharfetter and Gummel less w_i times the density there, between the two
//! cells. In exchange, cells whose content is rough may turn slightly negative.

use super::step::{GAMMA, SQRT_2};
use super::{Potential, bernoulli};
use crate::numerics::roots::brent_root;

/// The cells, as fractions of the interval, and room for the elimination.
#[derive(Debug, Clone)]
pub struct Followed {
    cells: Vec<Cell>,
    rows: Vec<Row>,
    stage: Vec<f64>,
}

/// A cell of width 1/`inverse` with its upper face; all relative to the interval.
#[derive(Debug, Clone, Copy)]
struct Cell {
    middle: f64,
    inverse: f64,
    /// 1/(distance of the next middle).
    next: f64,
    /// Weight of the next cell's density at the face between.
    beyond: f64,
    /// 1 − φ of the upper face: its speed over that of the floor.
    lag: f64,
}

/// Rates down and up from a cell, then 1/d of the elimination.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    down: f64,
    up: f64,
    inverse: f64,
}

/// A step from one place of the floor to another.
#[derive(Debug, Clone, Copy)]
pub struct Rise {
    /// Where the floor is before and after.
    pub floor: (f64, f64),
    /// Where the axis ends, and reflects.
    pub ceiling: f64,
    /// How long it takes.
    pub duration: f64,
    /// Whether the floor absorbs; else it reflects.
    pub absorbing: bool,
}

/// A rate per time at which mass is taken away: of the place h, and of the fraction of the step that has passed.
pub type Sink<'a> = &'a dyn Fn(f64, f64) -> f64;

impl Followed {
    /// So many cells, the lowest about `finest` times as wide as even ones: φ = sinh(bξ)/sinh b.
    pub fn new(cells: usize, finest: f64) -> Self {
        let bend = bend(finest);
        let face = |i: usize| {
            let part = i as f64 / cells as f64;
            if bend > 0.0 { (bend * part).sinh() / bend.sinh() } else { part }
        };
        let width = |i: usize| face(i + 1) - face(i);
        let middle = |i: usize| 0.5 * (face(i) + face(i + 1));
        let cell = |i: usize| Cell {
            middle: middle(i),
            inverse: 1.0 / width(i),
            next: 1.0 / (middle(i + 1) - middle(i)),
            beyond: width(i) / (width(i) + width(i + 1)),
            lag: 1.0 - face(i + 1),
        };
        Self {
            cells: (0..cells).map(cell).collect(),
            rows: vec![Row::default(); cells],
            stage: vec![0.0; cells],
        }
    }

    /// The middles of the cells between a floor and a ceiling.
    pub fn middles(&self, floor: f64, ceiling: f64) -> impl Iterator<Item = f64> + '_ {
        self.cells.iter().map(move |cell| floor + (ceiling - floor) * cell.middle)
    }

    /// Moves masses on: the two stages of [`super::Step`].
    pub fn advance(
        &mut self,
        rise: &Rise,
        (potential, diffusion): (&Potential, f64),
        sink: Option<Sink<'_>>,
        masses: &mut [f64],
    ) {
        let mut stage = std::mem::take(&mut self.stage);
        self.solve(rise, GAMMA, (potential, diffusion), sink, masses, &mut stage);
        for (stage, mass) in stage.iter_mut().zip(masses.iter()) {
            *stage = (1.0 + SQRT_2) * *stage - SQRT_2 * mass;
        }
        self.solve(rise, 1.0, (potential, diffusion), sink, &stage, masses);
        self.stage = stage;
    }

    /// The stage at a fraction of the step.
    fn solve(
        &mut self,
        rise: &Rise,
        fraction: f64,
        (potential, diffusion): (&Potential, f64),
        sink: Option<Sink<'_>>,
        right: &[f64],
        out: &mut [f64],
    ) {
        let (start, end) = rise.floor;
        let (a, x) = (GAMMA * rise.duration, start + fraction * (end - start));
        self.rates(x, rise, (a * diffusion, GAMMA * (end - start)), potential);
        let length = rise.ceiling - x;
        let (mut kept, mut carried) = (0.0, 0.0);
        for (i, row) in self.rows.iter_mut().enumerate().rev() {
            let sunk = sink.map_or(0.0, |w| a * w(x + length * self.cells[i].middle, fraction));
            let rest = 1.0 + sunk + row.up * kept;
            row.inverse = 1.0 / (rest + row.down);
            out[i] = right[i] + carried;
            carried = row.down * row.inverse * out[i];
            kept = rest * row.inverse;
        }
        let mut lifted = 0.0;
        for (row, out) in self.rows.iter().zip(out) {
            *out = (*out + lifted) * row.inverse;
            lifted = row.up * *out;
        }
    }

    /// Rates times a between the cells, of a `spread` aD and a `travel` av.
    fn rates(&mut self, x: f64, rise: &Rise, (spread, travel): (f64, f64), potential: &Potential) {
        let length = rise.ceiling - x;
        let per_length = 1.0 / length;
        let at = |cell: &Cell| potential.at(x + length * cell.middle);
        let mut low = at(&self.cells[0]);
        self.rows[0].down = 0.0;
        if rise.absorbing {
            let (cell, half) = (self.cells[0], length * self.cells[0].middle);
            let slope = at(&self.cells[1]) - low;
            let fall = -slope * cell.next * cell.middle;
            self.rows[0].down = spread * bernoulli(fall) / half * cell.inverse * per_length;
        }
        for i in 0..self.cells.len() - 1 {
            let (cell, next) = (&self.cells[i], &self.cells[i + 1]);
            let high = at(next);
            let (rise, rate, carried) = (high - low, spread * cell.next * per_length, travel * cell.lag);
            let gentle = bernoulli(rise);
            self.rows[i].up = (rate * gentle - carried * (1.0 - cell.beyond)) * cell.inverse * per_length;
            self.rows[i + 1].down =
                (rate * (gentle + rise) + carried * cell.beyond) * next.inverse * per_length;
            low = high;
        }
        let last = self.rows.len() - 1;
        self.rows[last].up = 0.0;
    }
}

/// b with b/sinh b = `finest`; 0 for 1 and above.
fn bend(finest: f64) -> f64 {
    let over = |bend: f64| bend - finest * bend.sinh();
    if finest >= 1.0 { 0.0 } else { brent_root(over, 1e-9, 100.0, 0.0).unwrap_or(0.0) }
}
