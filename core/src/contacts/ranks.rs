//! Contacts that keep their rank while the law of their thresholds matures.

use std::sync::Arc;

use super::Maturing;
use crate::law::SharedLaw;
use crate::numerics::diffusion::{Step, Work};
use crate::numerics::roots::brent_root;
use crate::numerics::stencil::Stencil;

/// Ranks q are told by ψ = ln[q/(1 − q)], evenly from −30 to 30: all but 1e-13 of the contacts at either end.
const FAR: f64 = 30.0;
const RANKS: usize = 481;

/// Ages t are told by ln(1 + t/τ), evenly up to 200 τ; from there on nothing changes.
const AGES: usize = 129;
const OLDEST: f64 = 200.0;

/// Cells, and steps between two ages, at the coarsest of three levels.
const CELLS: usize = 512;
const STEPS: usize = 2;

/// The threshold h(q, t) of rank q, G(h; t) = q, where G is the distribution function at the age t of the law that evolves
/// as [`Maturing`] tells.
///
/// The law is carried on by [`Step`] at three levels, each with twice as many cells and steps as the one before, and the
/// thresholds are extrapolated.
pub(super) struct Ranks {
    newborn: SharedLaw,
    time: f64,
    /// h at even ψ, for each age.
    rows: Vec<Vec<f64>>,
}

/// The thresholds at one age.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranked<'a> {
    ranks: &'a Ranks,
    ages: Stencil,
    /// d(place among the ages)/dt; 0 beyond the oldest.
    pace: f64,
}

impl std::fmt::Debug for Ranks {
    /// Without the table.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ranks")
            .field("newborn", &self.newborn)
            .field("time", &self.time)
            .finish_non_exhaustive()
    }
}

impl Ranks {
    /// The thresholds of contacts of the law `newborn`, which matures in the time τ.
    pub(super) fn new(newborn: &SharedLaw, maturing: &Maturing, time: f64) -> Self {
        let levels = [1, 2, 4].map(|fine| evolved(maturing, time, fine));
        let extrapolated = |age: usize, rank: usize| {
            let [coarse, fine, finest] = levels.each_ref().map(|level| level[age][rank]);
            let (better, best) = (fine + (fine - coarse) / 3.0, finest + (finest - fine) / 3.0);
            best + (best - better) / 15.0
        };
        let row = |age: usize| (0..RANKS).map(|rank| extrapolated(age, rank)).collect();
        let born = (0..RANKS).map(|rank| quantile(newborn, psi(rank))).collect();
        let rows = std::iter::once(born).chain((0..AGES - 1).map(row)).collect();
        Self { newborn: newborn.clone(), time, rows }
    }

    /// The thresholds at an age.
    pub(super) fn at(&self, age: f64) -> Ranked<'_> {
        let spacing = OLDEST.ln_1p() / (AGES - 1) as f64;
        let place = (age / self.time).ln_1p() / spacing;
        let last = (AGES - 1) as f64;
        let pace = if place < last { 1.0 / (spacing * (self.time + age)) } else { 0.0 };
        Ranked { ranks: self, ages: Stencil::at(place.min(last), AGES), pace }
    }

    /// ψ of a newborn threshold.
    fn psi(&self, newborn: f64) -> f64 {
        self.newborn.cumulative(newborn).ln() - self.newborn.ln_survival(newborn)
    }
}

impl Ranked<'_> {
    /// h of a contact born with h_0. Beyond the ranks told it goes on as h_0 does.
    pub(super) fn threshold(&self, newborn: f64) -> f64 {
        let psi = self.ranks.psi(newborn);
        let end = psi.clamp(-FAR, FAR);
        let beyond = if end == psi { 0.0 } else { newborn - quantile(&self.ranks.newborn, end) };
        self.value(end) + beyond
    }

    /// h_0 of a contact whose threshold is h.
    pub(super) fn newborn(&self, threshold: f64) -> f64 {
        let (low, high) = (self.value(-FAR), self.value(FAR));
        let end =
            if threshold <= low { Some((-FAR, low)) } else { (threshold >= high).then_some((FAR, high)) };
        if let Some((psi, end)) = end {
            return quantile(&self.ranks.newborn, psi) + threshold - end;
        }
        let psi = brent_root(|psi| self.value(psi) - threshold, -FAR, FAR, 0.0).unwrap_or(FAR);
        quantile(&self.ranks.newborn, psi)
    }

    /// ∂h/∂h_0 = ∂h/∂ψ p_i/[G_i(1 − G_i)].
    pub(super) fn spread(&self, newborn: f64) -> f64 {
        let psi = self.ranks.psi(newborn);
        if psi.abs() > FAR {
            return 1.0;
        }
        let ranks = stencil(psi);
        let slope = ranks.slope(|rank| self.ages.value(|age| self.ranks.rows[age][rank]));
        let law = &self.ranks.newborn;
        let per_rank = law.density(newborn) / (law.cumulative(newborn) * law.survival(newborn));
        slope / (2.0 * FAR / (RANKS - 1) as f64) * per_rank
    }

    /// ∂h/∂t.
    pub(super) fn drift(&self, newborn: f64) -> f64 {
        let ranks = stencil(self.ranks.psi(newborn).clamp(-FAR, FAR));
        self.pace * self.ages.slope(|age| ranks.value(|rank| self.ranks.rows[age][rank]))
    }

    fn value(&self, psi: f64) -> f64 {
        let ranks = stencil(psi);
        self.ages.value(|age| ranks.value(|rank| self.ranks.rows[age][rank]))
    }
}

fn stencil(psi: f64) -> Stencil {
    Stencil::at((psi + FAR) * (RANKS - 1) as f64 / (2.0 * FAR), RANKS)
}

fn psi(rank: usize) -> f64 {
    2.0 * FAR * rank as f64 / (RANKS - 1) as f64 - FAR
}

/// The threshold of rank ψ in a law.
fn quantile(law: &SharedLaw, psi: f64) -> f64 {
    let minor = 1.0 / (1.0 + psi.abs().exp());
    if psi < 0.0 { law.quantile(minor) } else { law.upper_quantile(minor) }
}

/// The thresholds of all ranks at all ages above 0, on `fine` times as many cells and steps as at the coarsest level.
fn evolved(maturing: &Maturing, time: f64, fine: usize) -> Vec<Vec<f64>> {
    let operator = Arc::new(maturing.operator(CELLS * fine));
    let mut masses = maturing.newborn(&operator.middles(), -1.0);
    let age = |row: usize| time * (OLDEST.ln_1p() * row as f64 / (AGES - 1) as f64).exp_m1();
    let edges: Vec<f64> = (1..operator.cells()).map(|cell| operator.edge(cell)).collect();
    let mut work = Work::default();
    let mut next = |row: usize| {
        let count = STEPS * fine;
        let step = Step::new(&operator, (age(row) - age(row - 1)) / count as f64);
        for _ in 0..count {
            step.advance(&mut masses, (f64::NEG_INFINITY, f64::NEG_INFINITY), None, &mut work);
        }
        inverted(&edges, &masses, maturing.support)
    };
    (1..AGES).map(&mut next).collect()
}

/// The places at which masses below and above, split at the `edges`, have the ranks ψ.
fn inverted(edges: &[f64], masses: &[f64], support: (f64, f64)) -> Vec<f64> {
    let sums = |masses: &mut dyn Iterator<Item = &f64>| -> Vec<f64> {
        masses
            .scan(0.0, |sum, mass| {
                *sum += mass;
                Some(*sum)
            })
            .collect()
    };
    let (below, above) = (sums(&mut masses.iter()), sums(&mut masses.iter().rev()));
    let count = edges.len();
    let known = edges.iter().enumerate().map(|(i, &edge)| (below[i].ln() - above[count - 1 - i].ln(), edge));
    let known: Vec<(f64, f64)> = known.filter(|point| point.0.abs() < FAR + 2.0).collect();
    (0..RANKS).map(|rank| place(&known, psi(rank), support)).collect()
}

/// The place at which ψ is met, by the polynomial through the eight points around; beyond them, in the last cell, masses
/// are even.
fn place(known: &[(f64, f64)], psi: f64, (low, high): (f64, f64)) -> f64 {
    let (first, last) = (known[0], known[known.len() - 1]);
    if psi < first.0 {
        return low + (first.1 - low) * (psi - first.0).exp();
    }
    if psi > last.0 {
        return high - (high - last.1) * (last.0 - psi).exp();
    }
    const POINTS: usize = 8;
    let above = known.partition_point(|point| point.0 < psi);
    let first = above.saturating_sub(POINTS / 2).min(known.len().saturating_sub(POINTS));
    let around = &known[first..known.len().min(first + POINTS)];
    let weight = |k: usize| {
        let others = around.iter().enumerate().filter(|other| other.0 != k);
        others.map(|(_, other)| (psi - other.0) / (around[k].0 - other.0)).product::<f64>()
    };
    (0..around.len()).map(|k| weight(k) * around[k].1).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gaussian;

    #[test]
    fn between_gaussians_thresholds_are_those_of_the_closed_form() {
        let [newborn, mature] =
            [(0.8, 0.1), (1.0, 0.05)].map(|(m, s)| Arc::new(Gaussian::new(m, s).unwrap()) as SharedLaw);
        let time = 2.0;
        let maturing = Maturing::new(newborn.clone(), mature, 0.05_f64.powi(2) / time);
        let ranks = Ranks::new(&newborn, &maturing, time);
        for age in [0.0, 0.003, 0.1, 1.0, 5.0, 30.0, 1e4] {
            let (aged, left) = (ranks.at(age), (-age / time).exp());
            let (mean, std) = (1.0 - 0.2 * left, (0.0025 + 0.0075 * left * left).sqrt());
            for z in [-3.0, -1.0, 0.0, 0.5, 3.0, 5.0] {
                let (newborn, exact) = (0.8 + 0.1 * z, mean + std * z);
                let found = aged.threshold(newborn);
                // Cells of a fiftieth of σ_f, extrapolated twice.
                assert!((found - exact).abs() < 1e-7, "{age} {z} {:e}", found - exact);
                let drift = (0.2 * left - z * 0.0075 * left * left / std) / time;
                let drift = if age < 400.0 { drift } else { 0.0 };
                // Slopes lose what ages and ranks are apart: 1/25 in ln t, 1/100 in h.
                assert!((aged.drift(newborn) - drift).abs() < 3e-6, "{age} {z}");
                assert!((aged.spread(newborn) - std / 0.1).abs() < 1e-5, "{age} {z}");
                // Bisection to rounding.
                assert!((aged.newborn(found) - newborn).abs() < 1e-14);
            }
        }
    }
}
