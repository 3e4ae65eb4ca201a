//! What contacts lose at breaks up to X₁, times their force at X₂: the integral in the covariance.

use crate::master::force_after_break::ForceAfterBreak;
use crate::master::renewal::RenewalSolution;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot};

/// The breaks on [0, X₁], by cells on which their rate is a polynomial, and the force of those contacts at X₂.
pub(super) struct LossesAtBreaks<'a> {
    after: &'a ForceAfterBreak,
    positions: &'a [f64],
    /// The cells of the breaking rate.
    cells: Vec<BreakCell>,
    /// Breaks of many contacts at once.
    simultaneous: Vec<SimultaneousBreak>,
    renewal: &'a RenewalSolution,
}

/// A cell of the breaking rate.
struct BreakCell {
    low: f64,
    high: f64,
    /// The Gauss points.
    places: Nodal,
    /// E_Γ and Γ there.
    lost: Nodal,
    rate: Nodal,
    /// The positions in the cell: the first of them, and for each the weights that take values at the Gauss
    /// points to the integral from `low` to the position.
    first: usize,
    weights: Vec<Nodal>,
}

/// Contacts that break at one position.
struct SimultaneousBreak {
    position: f64,
    /// The sum of their stretches.
    lost: f64,
    fraction: f64,
}

impl<'a> LossesAtBreaks<'a> {
    /// For rising `positions` and contacts of the mean initial stretch `initial`.
    pub(super) fn new(
        renewal: &'a RenewalSolution,
        after: &'a ForceAfterBreak,
        initial: f64,
        positions: &'a [f64],
    ) -> Self {
        let force = &renewal.force;
        let last = positions.last().copied().unwrap_or(0.0);
        let within = |&cell: &usize| force.boundaries[cell] < last;
        let cells = (0..force.coefficients.len()).take_while(within);
        let cells = cells.map(|cell| BreakCell::new(renewal, after.mean_start, cell, positions)).collect();
        let jump = |x: f64| {
            let after = force.nearest(x);
            let before = if after == 0 { initial } else { force.value_in(after - 1, x) };
            force.value_in(after, x) - before
        };
        let simultaneous = renewal.solution.atoms.iter().map(|atom| SimultaneousBreak {
            position: atom.position,
            lost: after.mean_start * atom.weight - jump(atom.position),
            fraction: atom.weight,
        });
        Self { after, positions, cells, simultaneous: simultaneous.collect(), renewal }
    }

    /// ∫₀^{X₁} \[E_Γ(Y) F_R(X₂ − Y) − Γ(Y) F_rR(X₂ − Y)\] dY for X₂ the position number `row` and each X₁ up to
    /// it.
    pub(super) fn lost(&self, row: usize, cuts: &mut Vec<f64>) -> Vec<f64> {
        let x = self.positions[row];
        let (mut before, mut out) = (0.0, vec![0.0; row + 1]);
        for cell in self.cells.iter().take_while(|cell| cell.low < x) {
            let last = (cell.first + cell.weights.len()).min(row + 1);
            let here = cell.first..last.max(cell.first);
            cuts.clear();
            let (near, far) = ((x - cell.high).max(0.0), x - cell.low);
            for kernel in [Some(&self.after.reformed), self.after.weighted.as_ref()].into_iter().flatten() {
                kernel.splits(near, far, cell.high - cell.low, cuts);
            }
            if cuts.is_empty() && cell.high <= x {
                let values = self.integrand(x, cell);
                for (entry, weights) in out[here].iter_mut().zip(&cell.weights) {
                    *entry = before + dot(weights, &values);
                }
                before += 0.5 * (cell.high - cell.low) * dot(&RULE.weights, &values);
            } else {
                cuts.iter_mut().for_each(|u| *u = x - *u);
                before = self.lost_in_sections(x, cell, cuts, before, &mut out, here);
            }
        }
        self.add_simultaneous(x, &mut out);
        out
    }

    /// The integrand at the Gauss points of a cell.
    fn integrand(&self, x: f64, cell: &BreakCell) -> Nodal {
        let distances = cell.places.map(|y| x - y);
        let force = self.after.reformed.curve().values(&distances);
        let mut values: Nodal = std::array::from_fn(|i| cell.lost[i] * force[i]);
        if let Some(weighted) = &self.after.weighted {
            let weighted = weighted.curve().values(&distances);
            (0..NODES).for_each(|i| values[i] -= cell.rate[i] * weighted[i]);
        }
        values
    }

    /// The integral over a cell that is cut where the force after a break is not smooth, or that ends beyond x.
    fn lost_in_sections(
        &self,
        x: f64,
        cell: &BreakCell,
        cuts: &mut Vec<f64>,
        mut before: f64,
        out: &mut [f64],
        here: std::ops::Range<usize>,
    ) -> f64 {
        let high = cell.high.min(x);
        cuts.extend([cell.low, high]);
        cuts.retain(|&y| y >= cell.low && y <= high);
        cuts.sort_by(f64::total_cmp);
        let mut next = here.start;
        for section in cuts.windows(2).filter(|section| section[1] > section[0]) {
            let (low, high) = (section[0], section[1]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            let values = RULE.nodes.map(|t| self.integrand_at(x, cell, middle + half * t));
            while next < here.end && self.positions[next] <= high {
                let weights = weights_to((self.positions[next] - middle) / half);
                out[next] = before + half * dot(&weights, &values);
                next += 1;
            }
            before += half * dot(&RULE.weights, &values);
        }
        out[next..here.end].fill(before);
        before
    }

    fn integrand_at(&self, x: f64, cell: &BreakCell, y: f64) -> f64 {
        let number = self.renewal.force.nearest(0.5 * (cell.low + cell.high));
        let rate = self.renewal.solution.density.value_in(number, y);
        let lost = 1.0 + self.after.mean_start * rate - self.renewal.slope.value_in(number, y);
        lost * self.after.force(x - y) - rate * self.after.weighted_force(x - y)
    }

    fn add_simultaneous(&self, x: f64, out: &mut [f64]) {
        let reached = |position: f64, x: f64| position <= x * (1.0 + 1e-12);
        for broken in self.simultaneous.iter().take_while(|broken| reached(broken.position, x)) {
            let since = (x - broken.position).max(0.0);
            let term =
                broken.lost * self.after.force(since) - broken.fraction * self.after.weighted_force(since);
            let first = self.positions.partition_point(|&p| !reached(broken.position, p));
            out.iter_mut().skip(first).for_each(|entry| *entry += term);
        }
    }
}

impl BreakCell {
    fn new(renewal: &RenewalSolution, mean_start: f64, cell: usize, positions: &[f64]) -> Self {
        let (middle, half) = renewal.force.cell(cell);
        let (low, high) = (renewal.force.boundaries[cell], renewal.force.boundaries[cell + 1]);
        let places = RULE.nodes.map(|t| middle + half * t);
        let rate = renewal.solution.density.values_in(cell, &places);
        let slope = renewal.slope.values_in(cell, &places);
        let lost = std::array::from_fn(|i| 1.0 + mean_start * rate[i] - slope[i]);
        let first = positions.partition_point(|&p| p <= low);
        let last = positions.partition_point(|&p| p <= high);
        let weights = |&p: &f64| weights_to((p - middle) / half).map(|weight| half * weight);
        let weights = positions[first..last].iter().map(weights).collect();
        Self { low, high, places, lost, rate, first, weights }
    }
}

/// The weights of values at the Gauss points in ∫₋₁^t of the polynomial through them. ∫₋₁^t P_n = (P_{n+1}(t) −
/// P_{n−1}(t))/(2n + 1), and 1 + t for n = 0.
fn weights_to(t: f64) -> Nodal {
    let mut legendre = [0.0; NODES + 1];
    (legendre[0], legendre[1]) = (1.0, t);
    for n in 1..NODES {
        let k = n as f64;
        legendre[n + 1] = ((2.0 * k + 1.0) * t * legendre[n] - k * legendre[n - 1]) / (k + 1.0);
    }
    let moment = |n: usize| (legendre[n + 1] - legendre[n - 1]) / (2 * n + 1) as f64;
    RULE.functional(&std::array::from_fn(|n| if n == 0 { 1.0 + t } else { moment(n) }))
}
