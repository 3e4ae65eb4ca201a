//! The cumulative hazards of ageing contacts, tabulated over the advance and interpolated between fresh thresholds.

use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::logarithm::ln;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::wide::wide;

/// The largest difference of exponents E = ΔE/T over a panel.
pub(super) const SPREAD: f64 = 8.0;

/// Cumulative hazards below this are negligible.
pub(super) const NEGLIGIBLE: f64 = 1e-18;

/// A range of fresh thresholds over which E and ln A are polynomials.
#[derive(Debug)]
pub(super) struct ThresholdPanel {
    pub(super) ends: [f64; 2],
    /// The thresholds between which is interpolated.
    pub(super) points: Nodal,
}

/// A of contacts at the points of a panel, as functions of the advance.
#[derive(Debug)]
pub(super) struct HazardTable {
    boundaries: Vec<f64>,
    cells: Vec<HazardCell>,
}

/// An interval of advances on which hazards are polynomials.
#[derive(Debug)]
struct HazardCell {
    /// A at its start.
    before: Nodal,
    /// Legendre coefficients of w/v: of each degree, those of all thresholds.
    coefficients: [Nodal; NODES],
}

/// ln A and E of the contacts of a panel, at one advance.
#[derive(Debug, Clone, Copy)]
pub(super) struct PanelHazards {
    middle: f64,
    half: f64,
    logarithms: Nodal,
    exponents: Nodal,
}

/// The panels of a range of fresh thresholds, each bisected until `is_smooth`, at most `halvings` times.
pub(super) fn panels(
    ends: [f64; 2],
    is_smooth: &impl Fn([f64; 2]) -> bool,
    halvings: u32,
) -> Vec<ThresholdPanel> {
    let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
    if is_smooth(ends) {
        return vec![ThresholdPanel { ends, points: RULE.nodes.map(|t| middle + half * t) }];
    }
    if halvings == 0 {
        return Vec::new();
    }
    [[ends[0], middle], [middle, ends[1]]]
        .into_iter()
        .flat_map(|part| panels(part, is_smooth, halvings - 1))
        .collect()
}

impl HazardTable {
    /// The table of these hazards w/v, all on the same cells.
    pub(super) fn new(rates: &[Piecewise; NODES]) -> Self {
        let boundaries = rates[0].boundaries.clone();
        let (mut before, mut cells) = ([0.0; NODES], Vec::with_capacity(boundaries.len()));
        for (number, ends) in boundaries.windows(2).enumerate() {
            let coefficients =
                std::array::from_fn(|n| std::array::from_fn(|i| rates[i].coefficients[number][n]));
            cells.push(HazardCell { before, coefficients });
            // Only the constant term has an integral over the whole cell.
            let width = ends[1] - ends[0];
            before.iter_mut().zip(&coefficients[0]).for_each(|(sum, mean)| *sum += width * mean);
        }
        Self { boundaries, cells }
    }

    /// Numbers that it keeps.
    pub(super) fn size(&self) -> usize {
        self.cells.len() * size_of::<HazardCell>() / size_of::<f64>()
    }

    /// A at an advance, or at its end if that is beyond.
    pub(super) fn at(&self, advance: f64) -> Nodal {
        let number = self.boundaries.partition_point(|&edge| edge <= advance).clamp(1, self.cells.len());
        let (low, high) = (self.boundaries[number - 1], self.boundaries[number]);
        let half = 0.5 * (high - low);
        let t = ((advance - low) / half - 1.0).min(1.0);
        let cell = &self.cells[number - 1];
        let sum = || cell.at(t, half);
        wide(sum).unwrap_or_else(sum)
    }
}

impl HazardCell {
    /// A at t in [−1, 1], in a cell of this half width.
    #[inline(always)]
    fn at(&self, t: f64, half: f64) -> Nodal {
        let mut integrals = [0.0; NODES];
        for i in 0..NODES {
            integrals[i] = (1.0 + t) * self.coefficients[0][i];
        }
        // P_{n−1} and P_n; the integral of P_n is (P_{n+1} − P_{n−1})/(2n + 1).
        let (mut last, mut here) = (1.0, t);
        for n in 1..NODES {
            let k = n as f64;
            let next = ((2.0 * k + 1.0) * t * here - k * last) / (k + 1.0);
            let integral = (next - last) / (2.0 * k + 1.0);
            let row = self.coefficients[n];
            for i in 0..NODES {
                integrals[i] += integral * row[i];
            }
            (last, here) = (here, next);
        }
        let mut out = [0.0; NODES];
        for i in 0..NODES {
            out[i] = self.before[i] + half * integrals[i];
        }
        out
    }
}

impl PanelHazards {
    pub(super) fn new(panel: &ThresholdPanel, broken: &Nodal, exponents: Nodal) -> Self {
        // Where A is below this at one point, it is negligible at all of them.
        let least = NEGLIGIBLE * (-SPREAD).exp();
        let logarithms = || {
            let (broken, mut out) = (*broken, [0.0; NODES]);
            for i in 0..NODES {
                out[i] = ln(broken[i].max(least));
            }
            out
        };
        let [low, high] = panel.ends;
        let logarithms = wide(logarithms).unwrap_or_else(logarithms);
        Self { middle: 0.5 * (low + high), half: 0.5 * (high - low), logarithms, exponents }
    }

    /// A and e^{−E} at a fresh threshold, by barycentric interpolation.
    pub(super) fn at(&self, newborn: f64) -> (f64, f64) {
        let t = (newborn - self.middle) / self.half;
        let [logarithm, exponent] = RULE.interpolated([&self.logarithms, &self.exponents], t);
        (exp(logarithm), exp(-exponent))
    }
}
