//! What contacts lose at breaks up to X₁, times their force at X₂: the integral in the covariance.

use crate::master::force_after_break::ForceAfterBreak;
use crate::master::renewal::RenewalSolution;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot, gauss_points, integral, series_at};
use crate::numerics::wide::vectorised;

/// The breaks on [0, X₁], by cells on which their rate is a polynomial, and the force of those contacts at X₂.
pub(super) struct LossesAtBreaks<'a> {
    after: &'a ForceAfterBreak,
    positions: &'a [f64],
    /// The cells of the breaking rate.
    cells: Vec<BreakCell>,
    /// Breaks of many contacts at once.
    simultaneous: Vec<SimultaneousBreak>,
}

/// A cell of the breaking rate.
struct BreakCell {
    low: f64,
    high: f64,
    /// The Gauss points.
    places: Nodal,
    /// E_Γ and Γ there, and their Legendre coefficients.
    lost: Nodal,
    rate: Nodal,
    lost_series: Nodal,
    rate_series: Nodal,
    /// The first position in the cell.
    first: usize,
    /// The number of positions in it.
    count: usize,
    /// In groups of positions, for each Gauss point the weights of the value there in the integrals from `low` to the
    /// positions.
    weights: Vec<[[f64; GROUP]; NODES]>,
}

/// Positions whose integrals are computed together.
const GROUP: usize = 16;

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
        renewal: &RenewalSolution,
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
        Self { after, positions, cells, simultaneous: simultaneous.collect() }
    }

    /// ∫₀^{X₁} \[E_Γ(Y) F_R(X₂ − Y) − Γ(Y) F_rR(X₂ − Y)\] dY for X₂ the position number `row` and each X₁ up to
    /// it.
    pub(super) fn lost(&self, row: usize, cuts: &mut Vec<f64>) -> Vec<f64> {
        let mut out = vec![0.0; row + 1];
        vectorised(
            #[inline(always)]
            || self.add_continuous(row, cuts, &mut out),
        );
        self.add_simultaneous(self.positions[row], &mut out);
        out
    }

    /// The same without simultaneous breaks.
    #[inline(always)]
    fn add_continuous(&self, row: usize, cuts: &mut Vec<f64>, out: &mut [f64]) {
        let (x, mut before) = (self.positions[row], 0.0);
        for cell in self.cells.iter().take_while(|cell| cell.low < x) {
            let last = (cell.first + cell.count).min(row + 1);
            let here = cell.first..last.max(cell.first);
            cuts.clear();
            let (near, far) = ((x - cell.high).max(0.0), x - cell.low);
            for kernel in [Some(&self.after.reformed), self.after.weighted.as_ref()].into_iter().flatten() {
                kernel.splits(near, far, cell.high - cell.low, cuts);
            }
            if cuts.is_empty() && cell.high <= x {
                let values = self.integrand(x, &cell.places, [&cell.lost, &cell.rate]);
                cell.integrate(before, &values, &mut out[here]);
                before += 0.5 * (cell.high - cell.low) * dot(&RULE.weights, &values);
            } else {
                cuts.iter_mut().for_each(|u| *u = x - *u);
                let up_to = (&self.positions[here.clone()], &mut out[here]);
                before = self.lost_in_sections(x, cell, cuts, before, up_to);
            }
        }
    }

    /// The integrand at 16 rising `places` up to x, at which E_Γ and Γ have these values.
    #[inline(always)]
    fn integrand(&self, x: f64, places: &Nodal, [lost, rate]: [&Nodal; 2]) -> Nodal {
        // Rounding may put a place above x.
        let mut distances = *places;
        distances.iter_mut().for_each(|y| *y = (x - *y).max(0.0));
        let force = self.after.reformed.curve().values(&distances);
        let mut values = [0.0; NODES];
        (0..NODES).for_each(|i| values[i] = lost[i] * force[i]);
        if let Some(weighted) = &self.after.weighted {
            let weighted = weighted.curve().values(&distances);
            (0..NODES).for_each(|i| values[i] -= rate[i] * weighted[i]);
        }
        values
    }

    /// The integral over a cell that is cut where the force after a break is not smooth, or that ends beyond x; with
    /// those up to the `positions` in the cell, into `out`.
    #[inline(always)]
    fn lost_in_sections(
        &self,
        x: f64,
        cell: &BreakCell,
        cuts: &mut Vec<f64>,
        mut before: f64,
        (mut positions, mut out): (&[f64], &mut [f64]),
    ) -> f64 {
        let high = cell.high.min(x);
        cuts.extend([cell.low, high]);
        cuts.retain(|&y| y >= cell.low && y <= high);
        cuts.sort_unstable_by(f64::total_cmp);
        for section in cuts.windows(2).filter(|section| section[1] > section[0]) {
            let (low, high) = (section[0], section[1]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            let places = gauss_points(middle, half);
            let [lost, rate] = cell.at(&places, self.after.weighted.is_some());
            let values = self.integrand(x, &places, [&lost, &rate]);
            let here = positions.partition_point(|&p| p <= high);
            let (inside, filled);
            (inside, positions) = positions.split_at(here);
            (filled, out) = out.split_at_mut(here);
            integrate_to(inside, (middle, half, before), &values, filled);
            before += half * dot(&RULE.weights, &values);
        }
        out.fill(before);
        before
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
        let places = gauss_points(middle, half);
        let (rate_series, slope_series) =
            (renewal.solution.density.coefficients[cell], renewal.slope.coefficients[cell]);
        let rate = renewal.solution.density.values_in(cell, &places);
        let slope = renewal.slope.values_in(cell, &places);
        let lost = std::array::from_fn(|i| 1.0 + mean_start * rate[i] - slope[i]);
        let mut lost_series = std::array::from_fn(|n| mean_start * rate_series[n] - slope_series[n]);
        lost_series[0] += 1.0;
        let first = positions.partition_point(|&p| p <= low);
        let last = positions.partition_point(|&p| p <= high);
        let group = |positions: &[f64]| {
            let mut weights = [[0.0; GROUP]; NODES];
            for (k, p) in positions.iter().enumerate() {
                let to_here = weights_to((p - middle) / half);
                (0..NODES).for_each(|i| weights[i][k] = half * to_here[i]);
            }
            weights
        };
        let weights = positions[first..last].chunks(GROUP).map(group).collect();
        let count = last - first;
        Self { low, high, places, lost, rate, lost_series, rate_series, first, count, weights }
    }

    /// The integrals from `low` to the first positions in the cell of what has these values at the Gauss points, plus
    /// `before`.
    #[inline(always)]
    fn integrate(&self, before: f64, values: &Nodal, out: &mut [f64]) {
        let values = *values;
        for (entries, weights) in out.chunks_mut(GROUP).zip(&self.weights) {
            let mut sums = [0.0; GROUP];
            for k in 0..GROUP {
                let mut sum = 0.0;
                for i in 0..NODES {
                    sum += weights[i][k] * values[i];
                }
                sums[k] = before + sum;
            }
            entries.copy_from_slice(&sums[..entries.len()]);
        }
    }

    /// E_Γ and Γ at 16 places in the cell; Γ is 0 where it is not `needed`.
    #[inline(always)]
    fn at(&self, places: &Nodal, needed: bool) -> [Nodal; 2] {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 * (self.high - self.low));
        let mut t = *places;
        t.iter_mut().for_each(|y| *y = (*y - middle) / half);
        let rate = if needed { series_at(&self.rate_series, &t) } else { [0.0; NODES] };
        [series_at(&self.lost_series, &t), rate]
    }
}

/// The integrals up to rising `positions` in the section of this middle and half width, of what has these values at its
/// Gauss points, plus `before`.
#[inline(always)]
fn integrate_to(positions: &[f64], (middle, half, before): (f64, f64, f64), values: &Nodal, out: &mut [f64]) {
    if positions.is_empty() {
        return;
    }
    let series = integral(&RULE.coefficients(values));
    for (positions, entries) in positions.chunks(NODES).zip(out.chunks_mut(NODES)) {
        let mut t = [0.0; NODES];
        t.iter_mut().zip(positions).for_each(|(t, p)| *t = (p - middle) / half);
        let integrals = series_at(&series, &t);
        entries.iter_mut().zip(integrals).for_each(|(entry, value)| *entry = before + half * value);
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
