//! Thresholds of contacts that keep their rank (quantile) while the distribution of thresholds evolves: a
//! table of quantiles against age.

use std::cell::Cell;

use super::ThresholdFokkerPlanck;
use crate::Result;
use crate::law::{Law, SharedLaw};
use crate::monitor::{Monitor, Part, Watch, report};
use crate::numerics::diffusion::{Elements, TimeStep};
use crate::numerics::legendre::{NODES, Nodal, RULE, primitive, series};
use crate::numerics::logarithm::ln;
use crate::numerics::roots::brent_root;
use crate::numerics::stencil::{POINTS, Stencil, interpolated};

/// Ranks q are tabulated as ψ = ln[q/(1 − q)] at equal steps from −23 to 23: all but 1e-10 of the contacts at
/// either end.
const FAR: f64 = 23.0;
const RANKS: usize = 369;
/// The share of a table in the work, for its monitor: lives with its thresholds follow.
const SHARE: f64 = 0.5;

/// Step in ψ.
const SPREAD: f64 = 2.0 * FAR / (RANKS - 1) as f64;

/// Ages t are tabulated at equal steps of ln(1 + t/s) up to 200 τ; from there on nothing changes.
const SPACING: f64 = 0.04;
const OLDEST: f64 = 200.0;

/// s in units of τ, or of the time in which diffusion broadens a narrower distribution of fresh thresholds by its own width; if it
/// has jumps, these change at once.
const SOON: f64 = 0.2;
const AT_ONCE: f64 = 1e-6;

/// An error of the distribution function above which s may have been too long.
const ENOUGH: f64 = 1e-9;

/// A contact whose present threshold is given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactAtThreshold {
    /// h_0; below 0 if every contact has a higher threshold.
    pub(crate) fresh: f64,
    /// ∂h/∂t at constant h_0.
    pub(crate) drift: f64,
    /// ∂h/∂h_0 at constant age.
    pub(crate) spread: f64,
}

/// The threshold h(q, t) of rank q, G(h; t) = q, where G is the distribution function at age t, from
/// [`ThresholdFokkerPlanck`] integrated by [`Evolution`].
pub(super) struct RankTable {
    fresh: SharedLaw,
    /// s.
    time: f64,
    /// h at equally spaced ψ, for each age.
    rows: Vec<Vec<f64>>,
    /// The lowest h of each of these ranks at any age.
    lowest: Vec<f64>,
    /// The means of h and of h² over the contacts above each of these ranks.
    means: Vec<Vec<[f64; 2]>>,
    error: f64,
}

/// The thresholds at one age.
#[derive(Debug, Clone, Copy)]
pub(super) struct RanksAtAge<'a> {
    ranks: &'a RankTable,
    ages: Stencil,
    /// d(position among the ages)/dt; 0 beyond the oldest.
    pace: f64,
}

/// The rank of a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rank {
    ranks: Stencil,
    /// Distance of its threshold from those of the tabulated ranks.
    beyond: f64,
}

/// The threshold of one contact at many ages; interpolated values are cached.
#[derive(Debug)]
pub(crate) struct RankTrajectory<'a> {
    ranks: &'a RankTable,
    rank: Rank,
    /// Its threshold at the tabulated ages; NaN where not yet computed.
    thresholds: Vec<Cell<f64>>,
}

impl RankTrajectory<'_> {
    pub(super) fn threshold(&self, age: f64) -> f64 {
        self.ranks.at(age).ages.value(|row| self.tabulated(row)) + self.rank.beyond
    }

    /// The thresholds at sixteen ages.
    #[inline(always)]
    pub(super) fn thresholds(&self, ages: &Nodal) -> Nodal {
        let last = (self.ranks.rows.len() - 1) as f64;
        let mut places = *ages;
        for place in &mut places {
            // As in `RankTable::at` but for the rounding of 1 + t/s, which moves the position by 1e-14 at most.
            *place = (ln(1.0 + *place / self.ranks.time) / SPACING).min(last);
        }
        interpolated(&places, self.ranks.rows.len(), |row| self.tabulated(row))
            .map(|h| (h + self.rank.beyond).max(0.0))
    }

    /// ∂h/∂t.
    pub(super) fn drift(&self, age: f64) -> f64 {
        let aged = self.ranks.at(age);
        aged.pace * aged.ages.slope(|row| self.tabulated(row))
    }

    /// A threshold that h is never below: that of the second tabulated rank below, since interpolation may overshoot the next.
    pub(super) fn lowest(&self) -> f64 {
        self.ranks.lowest[self.rank.ranks.below().saturating_sub(1)] + self.rank.beyond
    }

    /// The threshold at a tabulated age.
    fn tabulated(&self, row: usize) -> f64 {
        let known = &self.thresholds[row];
        if known.get().is_nan() {
            known.set(self.rank.ranks.value(|rank| self.ranks.rows[row][rank]));
        }
        known.get()
    }
}

impl std::fmt::Debug for RankTable {
    /// Without the table.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ranks").field("fresh", &self.fresh).field("time", &self.time).finish_non_exhaustive()
    }
}

impl RankTable {
    /// Ages from s to τ, each twice the one before.
    pub(super) fn octaves(&self) -> Vec<f64> {
        let (oldest, doubled) = (self.oldest(), |age: &f64| Some(2.0 * age));
        std::iter::successors(Some(self.time), doubled).take_while(|age| *age < oldest / OLDEST).collect()
    }

    /// The last tabulated age, from which on thresholds are those of mature contacts.
    pub(super) fn oldest(&self) -> f64 {
        self.time * (SPACING * (self.rows.len() - 1) as f64).exp_m1()
    }

    /// The thresholds of contacts whose distribution is `fresh` when they form, which matures in the time τ.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn new(
        fresh: &SharedLaw,
        maturing: &ThresholdFokkerPlanck,
        time: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        // The time in which diffusion broadens the fresh distribution by its own width, in units of τ. The table
        // must resolve it; edges change faster than any width.
        let own = (fresh.std() * fresh.std() / time / maturing.diffusion).min(1.0);
        let soon = own * if maturing.begins_with_jumps() { AT_ONCE } else { SOON };
        if soon <= AT_ONCE {
            return Self::starting(fresh, maturing, time, soon, monitor);
        }
        let ranks = Self::starting(fresh, maturing, time, soon, &mut Part::new(monitor, 0.0, 0.5))?;
        if ranks.error <= ENOUGH {
            return Ok(ranks);
        }
        let again = &mut Part::new(monitor, 0.5 * SHARE, 0.5);
        // A mature distribution that is steep far from its bulk moves the ends of the fresh one at once.
        let sooner = Self::starting(fresh, maturing, time, AT_ONCE, again)?;
        Ok(if sooner.error < ranks.error { sooner } else { ranks })
    }

    /// The same, with the first tabulated age about `soon` τ.
    fn starting(
        fresh: &SharedLaw,
        maturing: &ThresholdFokkerPlanck,
        time: f64,
        soon: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let scale = soon * time;
        let count = ((OLDEST * time / scale).ln_1p() / SPACING).ceil() as usize + 1;
        let age = |row: usize| scale * (SPACING * row as f64).exp_m1();
        let mut quantile_of = |rank| report(monitor, 0.0).map(|()| quantile(fresh, psi(rank)));
        let born = (0..RANKS).map(&mut quantile_of).collect::<Result<Vec<f64>>>()?;
        let ages: Vec<f64> = (1..count).map(age).collect();
        let rows: Vec<Vec<f64>> =
            std::iter::once(born).chain(evolve_quantiles(maturing, &ages, monitor)?).collect();
        report(monitor, SHARE)?;
        let means = means_above(fresh.as_ref(), &rows, &mut || report(monitor, SHARE))?;
        let lowest_of = |rank: usize| rows.iter().map(|row| row[rank]).fold(f64::INFINITY, f64::min);
        let lowest = (0..RANKS).map(lowest_of).collect();
        let mut ranks = Self { fresh: fresh.clone(), time: scale, rows, lowest, means, error: 0.0 };
        // Rounding, and what the solution of the equation leaves out.
        let least = 10.0 * maturing.tolerance();
        ranks.error = ranks.interpolation_error(&mut || report(monitor, SHARE))?.max(least);
        Ok(ranks)
    }

    /// A time over which thresholds change smoothly from formation on: the first tabulated age.
    pub(super) fn soon(&self) -> f64 {
        self.time * SPACING.exp_m1()
    }

    /// Thresholds change on the scale of this time plus the age.
    pub(super) fn time_scale(&self) -> f64 {
        self.time
    }

    /// Estimated error of the distribution function at any age.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The interpolation error of the distribution function, extrapolated from the errors of interpolating
    /// every second and every fourth row and rank.
    ///
    /// # Errors
    /// Those of `ask`, which asks the monitor.
    fn interpolation_error(&self, ask: &mut dyn FnMut() -> Result<()>) -> Result<f64> {
        let (second, fourth) = (self.subsampling_error(2, ask)?, self.subsampling_error(4, ask)?);
        // If halving the spacing reduces the error by a factor, the next halving reduces it by the
        // same: the error of the whole table is that of every second entry times second/fourth.
        Ok(second * (second / fourth.max(f64::MIN_POSITIVE)).min(1.0))
    }

    /// The largest error, as a fraction of contacts, of interpolating the rows and ranks halfway between
    /// every `every`-th.
    fn subsampling_error(&self, every: usize, ask: &mut dyn FnMut() -> Result<()>) -> Result<f64> {
        let (ages, ranks) = ((self.rows.len() - 1) / every, (RANKS - 1) / every);
        let (older, farther) = (ages * every, ranks * every);
        let mut most = 0.0_f64;
        for rank in 1..RANKS - 1 {
            ask()?;
            for row in (every / 2..older).step_by(every) {
                let stencil = Stencil::at(row as f64 / every as f64, ages + 1);
                let interpolated = stencil.value(|age| self.rows[age * every][rank]);
                most = most.max(contacts_between(&self.rows[row], rank, interpolated));
            }
            if rank % every == every / 2 && rank < farther {
                for row in &self.rows {
                    // The values left out are known: the difference is the interpolation error at this spacing.
                    let interpolated =
                        Stencil::at(rank as f64 / every as f64, ranks + 1).value(|k| row[k * every]);
                    most = most.max(contacts_between(row, rank, interpolated));
                }
            }
        }
        Ok(most)
    }

    /// The thresholds at an age.
    pub(super) fn at(&self, age: f64) -> RanksAtAge<'_> {
        // Ages are tabulated at equal steps of ln(1 + t/s): the position in the table is computed, not searched.
        let place = (age / self.time).ln_1p() / SPACING;
        let last = (self.rows.len() - 1) as f64;
        let pace = if place < last { 1.0 / (SPACING * (self.time + age)) } else { 0.0 };
        RanksAtAge { ranks: self, ages: Stencil::at(place.min(last), self.rows.len()), pace }
    }

    /// The rank of a contact whose threshold was h_0 when fresh. Beyond the tabulated ranks its threshold
    /// changes by as much as that of the last rank.
    pub(super) fn rank(&self, fresh: f64) -> Rank {
        let psi = self.psi(fresh);
        let beyond = end(psi).map_or(0.0, |end| fresh - self.rows[0][end]);
        Rank { ranks: stencil(psi.clamp(-FAR, FAR)), beyond }
    }

    /// The thresholds of contacts of these ranks at each tabulated age.
    pub(super) fn rows_of(&self, ranks: &[Rank; NODES]) -> Vec<Nodal> {
        let at = |row: &Vec<f64>, rank: &Rank| rank.ranks.value(|rank| row[rank]) + rank.beyond;
        self.rows.iter().map(|row| ranks.each_ref().map(|rank| at(row, rank))).collect()
    }

    /// The contact whose threshold was h_0 when fresh, for many ages.
    pub(super) fn followed(&self, fresh: f64) -> RankTrajectory<'_> {
        let thresholds = vec![Cell::new(f64::NAN); self.rows.len()];
        RankTrajectory { ranks: self, rank: self.rank(fresh), thresholds }
    }

    /// The fresh threshold of rank ψ: interpolated, then one Newton step where that is as accurate as the
    /// quantile.
    fn born(&self, psi: f64) -> f64 {
        /// Largest Newton step: its error is about its square, in widths of the distribution.
        const NEAR: f64 = 1e-7;
        let interpolated = stencil(psi).value(|rank| self.rows[0][rank]);
        let law = &self.fresh;
        let slope = law.density(interpolated) / contacts_at(psi);
        let step = (self.psi(interpolated) - psi) / slope;
        if step.abs() < NEAR * law.std() { interpolated - step } else { quantile(law, psi) }
    }

    /// ψ of a fresh threshold.
    fn psi(&self, fresh: f64) -> f64 {
        self.fresh.cumulative(fresh).ln() - self.fresh.ln_survival(fresh)
    }
}

impl RanksAtAge<'_> {
    /// h of a contact whose threshold was h_0 when fresh.
    pub(super) fn threshold(&self, fresh: f64) -> f64 {
        self.threshold_of(&self.ranks.rank(fresh))
    }

    /// h of a contact of this rank.
    pub(super) fn threshold_of(&self, rank: &Rank) -> f64 {
        self.ages.value(|age| rank.ranks.value(|rank| self.ranks.rows[age][rank])) + rank.beyond
    }

    /// h of contacts whose thresholds at each tabulated age are given.
    #[inline(always)]
    pub(super) fn interpolated(&self, rows: &[Nodal]) -> Nodal {
        let mut sum = [0.0; NODES];
        for (weight, row) in self.ages.weighted(rows) {
            for i in 0..NODES {
                sum[i] += weight * row[i];
            }
        }
        sum
    }

    /// ∫ h dG_i and ∫ h² dG_i over the contacts with fresh thresholds above h_0.
    pub(super) fn moments_above(&self, fresh: f64) -> [f64; 2] {
        let RankTable { fresh: law, rows, means, .. } = self.ranks;
        let psi = self.ranks.psi(fresh);
        let stencil = stencil(psi.clamp(-FAR, FAR));
        let mean = |n: usize| self.ages.value(|age| stencil.value(|rank| means[age][rank][n]));
        let Some(end) = end(psi) else { return [0, 1].map(|n| mean(n) / (1.0 + psi.exp())) };
        let born = rows[0][end];
        let beyond = |from: f64| shifted(law.as_ref(), from, self.ages.value(|age| rows[age][end]) - born);
        let here = beyond(fresh);
        if psi > 0.0 {
            return here;
        }
        let last = beyond(born);
        std::array::from_fn(|n| law.survival(born) * mean(n) + (here[n] - last[n]))
    }

    /// The fresh threshold h_0 of a contact whose threshold is h.
    pub(super) fn fresh(&self, threshold: f64) -> f64 {
        self.found(threshold).0
    }

    /// The contact whose threshold is h.
    pub(super) fn contact_at(&self, threshold: f64) -> ContactAtThreshold {
        let (fresh, psi) = self.found(threshold);
        let ranks = stencil(psi);
        let drift = self.pace * self.ages.slope(|age| ranks.value(|rank| self.ranks.rows[age][rank]));
        let spread = if psi.abs() < FAR { self.spread_at(fresh, psi) } else { 1.0 };
        ContactAtThreshold { fresh, drift, spread }
    }

    /// h_0 of a contact whose threshold is h, and ψ (or the end of the table beyond which it lies).
    fn found(&self, threshold: f64) -> (f64, f64) {
        let at = |rank: usize| self.ages.value(|age| self.ranks.rows[age][rank]);
        let (low, high) = (at(0), at(RANKS - 1));
        if threshold <= low {
            return (self.ranks.rows[0][0] + threshold - low, -FAR);
        }
        if threshold >= high {
            return (self.ranks.rows[0][RANKS - 1] + threshold - high, FAR);
        }
        // Bisection for the tabulated rank just below, then inverse interpolation.
        let (mut below, mut above) = (0, RANKS - 1);
        while above - below > 1 {
            let middle = (below + above) / 2;
            *(if at(middle) <= threshold { &mut below } else { &mut above }) = middle;
        }
        let first = Stencil::at(below as f64, RANKS).first;
        let near: [f64; POINTS] = std::array::from_fn(|k| at(first + k));
        let excess = |place: f64| Stencil::from(first, place).value(|rank| near[rank - first]) - threshold;
        let place = brent_root(excess, below as f64, above as f64, 0.0).unwrap_or(below as f64);
        let psi = place * SPREAD - FAR;
        (self.ranks.born(psi), psi)
    }

    /// ∂h/∂h_0 at constant age.
    pub(super) fn spread(&self, fresh: f64) -> f64 {
        let psi = self.ranks.psi(fresh);
        if psi.abs() > FAR { 1.0 } else { self.spread_at(fresh, psi) }
    }

    /// ∂h/∂h_0 = ∂h/∂ψ p_i/[q(1 − q)], of contacts of one rank.
    fn spread_at(&self, fresh: f64, psi: f64) -> f64 {
        let slope = stencil(psi).slope(|rank| self.ages.value(|age| self.ranks.rows[age][rank]));
        slope / SPREAD * self.ranks.fresh.density(fresh) / contacts_at(psi)
    }

    /// ∂h/∂t.
    pub(super) fn drift(&self, fresh: f64) -> f64 {
        self.drift_of(&self.ranks.rank(fresh))
    }

    /// ∂h/∂t of a contact of this rank.
    pub(super) fn drift_of(&self, rank: &Rank) -> f64 {
        self.pace * self.ages.slope(|age| rank.ranks.value(|rank| self.ranks.rows[age][rank]))
    }
}

fn stencil(psi: f64) -> Stencil {
    Stencil::at((psi + FAR) / SPREAD, RANKS)
}

fn psi(rank: usize) -> f64 {
    SPREAD * rank as f64 - FAR
}

/// Contacts per ψ: q(1 − q).
fn contacts_at(psi: f64) -> f64 {
    1.0 / ((1.0 + psi.exp()) * (1.0 + (-psi).exp()))
}

/// The fraction of contacts between a tabulated rank and a threshold, given the thresholds of all ranks at one age.
fn contacts_between(row: &[f64], rank: usize, threshold: f64) -> f64 {
    let above = row.partition_point(|h| *h <= threshold);
    let between = |low: usize| low as f64 + (threshold - row[low]) / (row[low + 1] - row[low]);
    let place = above.checked_sub(1).map_or(0.0, |low| if above < RANKS { between(low) } else { low as f64 });
    let below = |place: f64| 1.0 / (1.0 + (FAR - SPREAD * place).exp());
    (below(place) - below(rank as f64)).abs()
}

/// The tabulated rank beyond which ψ lies, if it lies beyond one.
fn end(psi: f64) -> Option<usize> {
    (psi.abs() > FAR).then_some(if psi < 0.0 { 0 } else { RANKS - 1 })
}

/// ∫ (h_0 + shift)ⁿ dP(h_0) for n = 1 and 2 above a threshold.
fn shifted(law: &dyn Law, above: f64, shift: f64) -> [f64; 2] {
    let [whole, first, second] = [0, 1, 2].map(|order| law.upper_moment(order, above));
    [first + shift * whole, second + shift * (2.0 * first + shift * whole)]
}

/// The means of h and of h² over the contacts above each tabulated rank, for each age; the first row is that
/// of fresh contacts.
///
/// They are ∫_ψ^∞ hⁿ q(1 − q) dψ/(1 − q), which is as smooth in ψ as h. Beyond the tabulated ranks h changes
/// by as much as that of the last rank.
///
/// # Errors
/// Those of `ask`, which asks the monitor.
fn means_above(
    fresh: &dyn Law,
    rows: &[Vec<f64>],
    ask: &mut dyn FnMut() -> Result<()>,
) -> Result<Vec<Vec<[f64; 2]>>> {
    const TOP: usize = RANKS - 1;
    let points: Vec<Vec<(Stencil, f64)>> = (0..TOP).map(between).collect();
    let of = |row: &Vec<f64>| {
        let mut sums = shifted(fresh, rows[0][TOP], row[TOP] - rows[0][TOP]);
        let mut means = vec![[0.0; 2]; RANKS];
        // Summed from the highest rank down, so that the means of the few strongest contacts keep
        // their digits.
        for rank in (0..RANKS).rev() {
            for (stencil, weight) in points.get(rank).into_iter().flatten() {
                let threshold = stencil.value(|rank| row[rank]);
                (1..).zip(&mut sums).for_each(|(n, sum)| *sum += weight * threshold.powi(n));
            }
            means[rank] = sums.map(|sum| sum * (1.0 + psi(rank).exp()));
        }
        means
    };
    rows.iter().map(|row| ask().map(|()| of(row))).collect()
}

/// Gauss points between a tabulated rank and the next one, weighted by the contacts they represent.
fn between(rank: usize) -> Vec<(Stencil, f64)> {
    let point = |(t, w): (&f64, &f64)| {
        let place = rank as f64 + 0.5 * (1.0 + t);
        let psi = SPREAD * place - FAR;
        (Stencil::at(place, RANKS), 0.5 * SPREAD * w * contacts_at(psi))
    };
    RULE.nodes.iter().zip(&RULE.weights).map(point).collect()
}

/// The threshold of rank ψ.
fn quantile(law: &SharedLaw, psi: f64) -> f64 {
    let minor = 1.0 / (1.0 + psi.abs().exp());
    if psi < 0.0 { law.quantile(minor) } else { law.upper_quantile(minor) }
}

/// The thresholds of all ranks at all these ages, which must rise.
fn evolve_quantiles(
    maturing: &ThresholdFokkerPlanck,
    ages: &[f64],
    monitor: &mut dyn Monitor,
) -> Result<Vec<Vec<f64>>> {
    let (slope, kinks) = (maturing.slope(), maturing.kinks());
    let watch = Watch::new(monitor);
    let (slope, stops) = (|h: f64| slope.at(h), || watch.stops());
    let mut evolution = maturing.evolution((&slope, &kinks), maturing.tolerance(), &stops);
    let Some((&earliest, &oldest)) = ages.first().zip(ages.last()) else { return Ok(Vec::new()) };
    let mut step: Option<TimeStep> = None;
    let mut steps = 0.0;
    let mut at = |(row, age): (usize, &f64)| {
        watch.check()?;
        // A step passes many ages. Its polynomials in time are as accurate between its ends as there, but for the first step,
        // of which they are not controlled.
        while evolution.time < *age {
            // A step passes many ages, but the first ones, in which a jump of the density becomes smooth, pass none.
            let left = (ages.len() - row) as f64;
            watch.done(SHARE * (row as f64 / ages.len() as f64).max(steps / (steps + left)));
            let limit = if evolution.first { earliest } else { oldest };
            step = Some(evolution.advance(limit));
            watch.check()?;
            steps += 1.0;
        }
        let density = step.as_ref().map(|step| step.at(*age));
        Ok(quantiles_of(density.as_ref().unwrap_or(&evolution.density)))
    };
    ages.iter().enumerate().map(&mut at).collect()
}

/// The quantiles of a density: the positions below which the fractions of mass of the tabulated ranks lie.
fn quantiles_of(density: &Elements) -> Vec<f64> {
    let masses: Vec<f64> = (0..density.count()).map(|i| density.width(i) * density.series[i][0]).collect();
    let whole: f64 = masses.iter().sum();
    let place = |rank: usize| {
        let psi = psi(rank);
        // Counted from the nearer end, in which little is lost.
        let minor = whole / (1.0 + psi.abs().exp());
        let all = || 0..masses.len();
        let passed =
            if psi < 0.0 { found(all(), &masses, minor) } else { found(all().rev(), &masses, minor) };
        let Some((element, before)) = passed else { return density.edges[0] };
        let (middle, half) = density.element(element);
        let below = primitive(&density.series[element]);
        let wanted = if psi < 0.0 { minor - before } else { masses[element] - (minor - before) };
        let excess = |t: f64| half * (density.series[element][0] + series(&below, t)) - wanted;
        middle + half * brent_root(excess, -1.0, 1.0, 0.0).unwrap_or(0.0)
    };
    (0..RANKS).map(place).collect()
}

/// The element in which the cumulative mass passes `wanted`, and the mass before it.
fn found(mut elements: impl Iterator<Item = usize>, masses: &[f64], wanted: f64) -> Option<(usize, f64)> {
    let mut before = 0.0;
    elements.find_map(|i| {
        let passes = before + masses[i] >= wanted;
        let found = passes.then_some((i, before));
        before += masses[i];
        found
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Gaussian, Rectangular};

    #[test]
    fn between_gaussians_thresholds_are_those_of_the_closed_form() {
        let [fresh, mature] =
            [(0.8, 0.1), (1.0, 0.05)].map(|(m, s)| Arc::new(Gaussian::new(m, s).unwrap()) as SharedLaw);
        let time = 2.0;
        let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature, 0.05_f64.powi(2) / time);
        let ranks = RankTable::new(&fresh, &maturing, time, &mut ()).unwrap();
        for age in [0.0, 0.003, 0.1, 1.0, 5.0, 30.0, 1e4] {
            let (aged, left) = (ranks.at(age), (-age / time).exp());
            let (mean, std) = (1.0 - 0.2 * left, (0.0025 + 0.0075 * left * left).sqrt());
            for z in [-3.0, -1.0, 0.0, 0.5, 3.0, 5.0] {
                let (fresh, exact) = (0.8 + 0.1 * z, mean + std * z);
                let found = aged.threshold(fresh);
                // At 5σ ranks are 3e-7, of a law that is right to 1e-13.
                assert!((found - exact).abs() < 1e-9, "{age} {z} {:e}", found - exact);
                let drift = (0.2 * left - z * 0.0075 * left * left / std) / time;
                let drift = if age < 400.0 { drift } else { 0.0 };
                // Slopes lose what ages and ranks are apart: 1/25 in ln t, 1/100 in h.
                assert!((aged.drift(fresh) - drift).abs() < 3e-6, "{age} {z}");
                assert!((aged.spread(fresh) - std / 0.1).abs() < 1e-5, "{age} {z}");
                // Bisection to rounding.
                assert!((aged.fresh(found) - fresh).abs() < 1e-14);
            }
        }
    }

    /// Towards a Gaussian distribution thresholds are an Ornstein–Uhlenbeck process. The rectangular ones of c.v. 2e-4 have jumps,
    /// which diffuse over a narrow distribution at once.
    #[test]
    fn towards_a_gaussian_distribution_thresholds_between_jumps_are_those_of_the_ornstein_uhlenbeck_process()
    {
        let (low, high) = (0.8, 0.8005);
        let fresh: SharedLaw = Arc::new(Rectangular::new(low, high).unwrap());
        let mature: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
        let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature, 0.0025);
        let ranks = RankTable::new(&fresh, &maturing, 1.0, &mut ()).unwrap();
        // The estimate for the first ages, at which thresholds beside the jumps move like √t.
        assert!(ranks.error() < 1e-7, "{:e}", ranks.error());
        let normal = |u: f64| 0.5 * libm::erfc(-u * std::f64::consts::FRAC_1_SQRT_2);
        // ∫ of the distribution function of the standard normal distribution.
        let integral = |u: f64| u * normal(u) + (-0.5 * u * u).exp() / (2.0 * std::f64::consts::PI).sqrt();
        for age in [1e-11_f64, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1.0] {
            let [low, high] = [low, high].map(|h| 1.0 - (1.0 - h) * (-age).exp());
            let std = 0.05 * (-(-2.0 * age).exp_m1()).sqrt();
            for rank in [1e-6, 1e-4, 0.02, 0.3, 0.5, 0.9, 0.999] {
                let threshold = ranks.at(age).threshold(fresh.quantile(rank));
                let below = |mean: f64| integral((threshold - mean) / std);
                let found = std / (high - low) * (below(low) - below(high));
                // Rounding of thresholds over the width: 1e-16/5e-4, and of the difference of integrals, at a width of 0.01 of
                // the mature one.
                assert!((found - rank).abs() < 1e-9, "{age} {rank}: {:e}", found - rank);
            }
        }
    }

    /// Towards an exponential distribution of mean 1 thresholds diffuse with a constant drift above a reflecting end.
    #[test]
    fn towards_an_exponential_distribution_thresholds_are_those_of_reflected_brownian_motion() {
        let time = 2.0;
        let fresh: SharedLaw = Arc::new(Gaussian::new(0.5, 0.2).unwrap());
        let mature: SharedLaw = Arc::new(Exponential::new(1.0).unwrap());
        let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature, 1.0 / time);
        let ranks = RankTable::new(&fresh, &maturing, time, &mut ()).unwrap();
        let normal = |u: f64| 0.5 * libm::erfc(-u * std::f64::consts::FRAC_1_SQRT_2);
        // J. M. Harrison, Brownian Motion and Stochastic Flow Systems (1985): the fraction below h of those that began at h_0,
        // with the drift −D and the variance 2Dt.
        let below = |h: f64, born: f64, age: f64| {
            let (moved, width) = (age / time, (2.0 * age / time).sqrt());
            normal((h - born + moved) / width) - (-h).exp() * normal((-h - born + moved) / width)
        };
        for age in [0.05, 0.5, 3.0, 20.0] {
            for rank in [0.02, 0.3, 0.5, 0.8, 0.99] {
                let threshold = ranks.at(age).threshold(fresh.quantile(rank));
                let of = |born: f64| fresh.density(born) * below(threshold, born, age);
                // Sixteen points on each standard deviation, up to where 1e-13 of the fresh thresholds are left.
                let found: f64 =
                    (0..10).map(f64::from).map(|k| RULE.integrate(0.2 * k, 0.2 * (k + 1.0), of)).sum();
                // The table's own estimate, and rounding.
                assert!((found - rank).abs() < ranks.error() + 1e-12, "{age} {rank}: {:e}", found - rank);
            }
        }
    }
}
