//! The tridiagonal equation (1 − aL + aw)u = m, eliminated from the top down.

use super::Diffusion;
use super::floor::Cut;

/// The elimination, done once for all floors: a floor changes its own cell and the next one only.
///
/// With r_i, l_i the rates up and down from a cell, d_i = 1 + a(w_i + l_i + r_i q_{i+1}) and q_i = 1 − a l_i/d_i. All terms are
/// positive; nothing cancels, so that what is lost and what is left are the whole to rounding.
#[derive(Debug, Clone, Default)]
pub struct Factors {
    /// a.
    time: f64,
    cells: Vec<Factor>,
}

/// What is known of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Factor {
    /// a l_i/d_i: what the cell hands down.
    handed: f64,
    /// q_i: what it keeps of what comes up.
    kept: f64,
    /// 1/d_i.
    inverse: f64,
    /// a r_{i−1}/d_i.
    lifted: f64,
}

impl Factors {
    /// The factors for the time a, with or without a `sink` w, a rate per cell.
    pub fn new(operator: &Diffusion, a: f64, sink: Option<&[f64]>) -> Self {
        let mut factors = Self::default();
        factors.renew(operator, a, sink);
        factors
    }

    /// Makes them anew, in place.
    pub(super) fn renew(&mut self, operator: &Diffusion, a: f64, sink: Option<&[f64]>) {
        self.time = a;
        self.cells.resize(operator.cells(), Factor::default());
        let mut above = 0.0;
        for i in (0..operator.cells()).rev() {
            let rest = 1.0 + a * (sink.map_or(0.0, |w| w[i]) + operator.up[i] * above);
            let down = a * operator.down[i];
            let inverse = 1.0 / (rest + down);
            let from_below = if i > 0 { operator.up[i - 1] } else { 0.0 };
            above = rest * inverse;
            self.cells[i] =
                Factor { handed: down * inverse, kept: above, inverse, lifted: a * from_below * inverse };
        }
    }

    /// Writes (1 − aL + aw)⁻¹ `right` into `out`; returns what the floor absorbs.
    pub(super) fn solve(
        &self,
        operator: &Diffusion,
        cut: &Cut,
        sink: Option<&[f64]>,
        right: &[f64],
        out: &mut [f64],
    ) -> f64 {
        let (a, j, top) = (self.time, cut.cell, operator.cells() - 1);
        let sunk = |i: usize| sink.map_or(0.0, |w| w[i]);
        let below: f64 = right[cut.from..j].iter().sum();
        out[cut.from..j].fill(0.0);
        if j > top {
            return below;
        }
        let loss = a * cut.loss + cut.passed;
        if j == top {
            out[j] = right[j] / (1.0 + a * sunk(j) + loss);
            return below + loss * out[j];
        }
        let mut carried = 0.0;
        for ((out, right), factor) in
            out[j + 1..].iter_mut().zip(&right[j + 1..]).zip(&self.cells[j + 1..]).rev()
        {
            *out = right + carried;
            carried = factor.handed * *out;
        }
        let above = if j + 1 == top { 0.0 } else { operator.up[j + 1] * self.cells[j + 2].kept };
        let rest = 1.0 + a * (sunk(j + 1) + above);
        let next = rest + a * cut.down;
        let lowest = 1.0 + a * (sunk(j) + cut.up * rest / next) + loss;
        out[j] = (right[j] + a * cut.down / next * out[j + 1]) / lowest;
        out[j + 1] = (out[j + 1] + a * cut.up * out[j]) / next;
        let mut lower = out[j + 1];
        for (out, factor) in out[j + 2..].iter_mut().zip(&self.cells[j + 2..]) {
            lower = factor.inverse * *out + factor.lifted * lower;
            *out = lower;
        }
        below + loss * out[j]
    }
}
