//! The distribution of thresholds of contacts of every age, and its mean over contacts of several ages.

use std::sync::Arc;

use super::ThresholdFokkerPlanck;
use crate::Result;
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::{Elements, TimeStep};
use crate::numerics::legendre::{NODES, Nodal, RULE, integral, series};
use crate::numerics::piecewise::tail;

/// First panel of ages, in units of the time in which fresh thresholds change; if their density has jumps, these change at
/// once.
const SOON: f64 = 0.2;
const AT_ONCE: f64 = 1e-6;

/// p(h; a), the density of the thresholds of contacts of age a: the solution of [`ThresholdFokkerPlanck`] from P_ci.
///
/// It is a Legendre series in h on elements that all ages share, and the polynomial through 16 Gauss points in a on panels of
/// ages, of which each is twice as long as all before it.
#[derive(Debug)]
pub(crate) struct MaturingTable {
    maturing: ThresholdFokkerPlanck,
    /// Ends of the elements.
    edges: Arc<[f64]>,
    /// End of the first panel.
    first: f64,
    /// For each panel the densities at its Gauss points.
    panels: Vec<[DensityAtAge; NODES]>,
}

/// The density at one age, on the elements on which there is any.
#[derive(Debug)]
struct DensityAtAge {
    /// The first of them.
    first: usize,
    series: Vec<Nodal>,
}

/// The weight of each Gauss point of each panel in a mean over ages.
#[derive(Debug, Clone)]
pub(crate) struct AgeWeights(Vec<Nodal>);

/// A density of thresholds with its survival function.
#[derive(Debug, Clone)]
pub(crate) struct ThresholdDensity {
    edges: Arc<[f64]>,
    density: Vec<Nodal>,
    /// ∫ of the density from the lower end of each element, as a series on it.
    primitive: Vec<[f64; NODES + 1]>,
    /// Fraction above the lower end of each element.
    above: Vec<f64>,
    /// The last stretch at which rounding leaves digits of S, with −ln S and the hazard rate there.
    last: [f64; 3],
}

impl MaturingTable {
    /// The table of these thresholds.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn new(maturing: ThresholdFokkerPlanck, monitor: &mut dyn Monitor) -> Result<Self> {
        /// A truncation error in age above which the first panel is too long.
        const ENOUGH: f64 = 1e-11;
        let watch = Watch::new(monitor);
        let fresh = maturing.fresh_law();
        let narrower = fresh.std().min(maturing.mature_law().std());
        let own = narrower * narrower / maturing.diffusion;
        if !maturing.begins_with_jumps() {
            let table = Self::starting(&maturing, SOON * own, &watch)?;
            if table.truncation() <= ENOUGH {
                return Ok(table);
            }
        }
        // A mature distribution that is steep far from its bulk moves the ends of the fresh one at once.
        Self::starting(&maturing, AT_ONCE * own, &watch)
    }

    /// The table whose first panel ends at the age `first`.
    fn starting(maturing: &ThresholdFokkerPlanck, first: f64, watch: &Watch<'_>) -> Result<Self> {
        let columns = evolve(maturing, first, watch)?;
        let mut edges: Vec<f64> = columns.iter().flat_map(|density| density.edges.iter().copied()).collect();
        edges.sort_by(f64::total_cmp);
        let least = 1e-12 * (maturing.support.1 - maturing.support.0);
        edges.dedup_by(|b, a| *b - *a < least);
        let on = |density: &Elements| {
            watch.check()?;
            Ok(DensityAtAge::of(density.on(&edges)))
        };
        let all = columns.iter().map(on).collect::<Result<Vec<_>>>()?;
        let mut all = all.into_iter();
        let count = columns.len() / NODES;
        let panels = (0..count)
            .map(|_| std::array::from_fn(|_| all.next().expect("a column for each node")))
            .collect();
        Ok(Self { maturing: maturing.clone(), edges: edges.into(), first, panels })
    }

    /// The largest truncation error of the masses of elements as polynomials in age on the first panel.
    fn truncation(&self) -> f64 {
        let of = |i: usize| {
            let masses = self.panels[0].each_ref().map(|column| column.mean(i));
            (self.edges[i + 1] - self.edges[i]) * tail(&RULE.coefficients(&masses))
        };
        (0..self.edges.len() - 1).map(of).fold(0.0, f64::max)
    }

    /// The diffusion of the thresholds.
    pub(crate) fn maturing(&self) -> &ThresholdFokkerPlanck {
        &self.maturing
    }

    /// A time over which thresholds change smoothly from formation on.
    pub(crate) fn soon(&self) -> f64 {
        self.first
    }

    /// A mean over no ages yet.
    pub(crate) fn no_ages(&self) -> AgeWeights {
        AgeWeights(vec![[0.0; NODES]; self.panels.len()])
    }

    /// Adds contacts of an age to a mean.
    pub(crate) fn add(&self, age: f64, fraction: f64, weights: &mut AgeWeights) {
        let (panel, place) = self.place(age);
        let cardinals = RULE.cardinals(place);
        for (weight, cardinal) in weights.0[panel].iter_mut().zip(&cardinals) {
            *weight += fraction * cardinal;
        }
    }

    /// The panel of an age, and its place there in [−1, 1].
    fn place(&self, age: f64) -> (usize, f64) {
        let turns = age / self.first;
        if turns < 1.0 {
            return (0, 2.0 * turns - 1.0);
        }
        let panel = (turns.log2() as usize + 1).min(self.panels.len() - 1);
        let start = (panel as f64 - 1.0).exp2();
        (panel, (2.0 * (turns / start - 1.0) - 1.0).clamp(-1.0, 1.0))
    }

    /// The mean density over the ages of contacts.
    pub(crate) fn mean(&self, weights: &AgeWeights) -> ThresholdDensity {
        let mut density = vec![[0.0; NODES]; self.edges.len() - 1];
        for (panel, weights) in self.panels.iter().zip(&weights.0) {
            for (column, &weight) in panel.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                for (sum, series) in density[column.first..].iter_mut().zip(&column.series) {
                    for n in 0..NODES {
                        sum[n] += weight * series[n];
                    }
                }
            }
        }
        ThresholdDensity::new(self.edges.clone(), density)
    }
}

impl DensityAtAge {
    fn of(density: Elements) -> Self {
        /// Mass of an element that no result shows.
        const NEGLIGIBLE: f64 = 1e-18;
        let shown = |i: &usize| {
            let largest = density.series[*i].iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
            density.width(*i) * largest > NEGLIGIBLE
        };
        let first = (0..density.count()).find(shown).unwrap_or(0);
        let last = (0..density.count()).rfind(shown).unwrap_or(0);
        Self { first, series: density.series[first..=last].to_vec() }
    }

    /// The mean density on an element.
    fn mean(&self, i: usize) -> f64 {
        i.checked_sub(self.first).and_then(|i| self.series.get(i)).map_or(0.0, |series| series[0])
    }
}

impl ThresholdDensity {
    /// The density on elements, divided by its mass.
    fn new(edges: Arc<[f64]>, mut density: Vec<Nodal>) -> Self {
        let width = |i: usize| edges[i + 1] - edges[i];
        let mass: f64 = density.iter().enumerate().map(|(i, series)| width(i) * series[0]).sum();
        density.iter_mut().flatten().for_each(|c| *c /= mass);
        let primitive = density.iter().map(integral).collect();
        let mut above = vec![0.0; edges.len()];
        // Summed from the strongest, whose small number keeps its digits.
        for i in (0..density.len()).rev() {
            above[i] = above[i + 1] + width(i) * density[i][0];
        }
        let mut out = Self { edges, density, primitive, above, last: [f64::INFINITY, 0.0, 0.0] };
        out.last = out.end();
        out
    }

    /// The last stretch at which more contacts hold than rounding makes, with −ln S and the hazard rate there.
    fn end(&self) -> [f64; 3] {
        /// Fraction of contacts.
        const FEWEST: f64 = 1e-12;
        let i = self.above.iter().rposition(|&above| above > FEWEST).unwrap_or(0);
        let (mut low, mut high) = (self.edges[i], self.edges[i + 1]);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.survival(middle) > FEWEST { low = middle } else { high = middle }
        }
        let left = self.survival(low).max(FEWEST);
        [low, -left.ln(), (self.density_at(low) / left).max(0.0)]
    }

    fn element(&self, x: f64) -> Option<(usize, f64, f64)> {
        let i = self.edges.partition_point(|&edge| edge <= x);
        if i == 0 || i == self.edges.len() {
            return None;
        }
        let half = 0.5 * (self.edges[i] - self.edges[i - 1]);
        Some((i - 1, (x - self.edges[i - 1]) / half - 1.0, half))
    }

    /// P_c at a threshold.
    pub(crate) fn density_at(&self, x: f64) -> f64 {
        self.element(x).map_or(0.0, |(i, t, _)| series(&self.density[i], t))
    }

    /// Fraction of thresholds above a stretch.
    pub(crate) fn survival(&self, x: f64) -> f64 {
        match self.element(x) {
            Some((i, t, half)) => self.above[i] - half * series(&self.primitive[i], t),
            None if x < self.edges[0] => 1.0,
            None => 0.0,
        }
    }

    /// −ln S. Beyond all but 1e-12 of the thresholds, where S is lost in rounding, the hazard rate stays what it is there.
    pub(crate) fn cumulative_hazard(&self, x: f64) -> f64 {
        let [last, reached, rate] = self.last;
        if x > last { reached + rate * (x - last) } else { -self.survival(x).min(1.0).ln() }
    }

    /// The largest difference of S at ends of elements from a sum of other densities on the same elements.
    pub(crate) fn distance(&self, others: &[Self; 3], weights: [f64; 3]) -> f64 {
        let sum =
            |i: usize| others.iter().zip(weights).map(|(other, weight)| weight * other.above[i]).sum::<f64>();
        self.above.iter().enumerate().map(|(i, above)| (above - sum(i)).abs()).fold(0.0, f64::max)
    }

    /// The stretch below which fewer thresholds lie than this fraction: the lower end of an element.
    pub(crate) fn certain(&self, fraction: f64) -> f64 {
        let below = self.above.partition_point(|&above| 1.0 - above <= fraction);
        self.edges[below.saturating_sub(1)]
    }

    /// The same as elements.
    pub(crate) fn elements(&self) -> Elements {
        Elements { edges: self.edges.to_vec(), series: self.density.clone() }
    }
}

/// The densities at the Gauss points of all panels of ages, up to the age from which on nothing changes.
fn evolve(maturing: &ThresholdFokkerPlanck, first: f64, watch: &Watch<'_>) -> Result<Vec<Elements>> {
    /// Oldest age, in units of the time in which the mature width is diffused through.
    const OLDEST: f64 = 1e4;
    let (slope, kinks) = (maturing.slope(), maturing.kinks());
    let (slope, stops) = (|h: f64| slope.at(h), || watch.stops());
    let mut evolution = maturing.evolution((&slope, &kinks), maturing.tolerance(), &stops);
    let oldest = OLDEST * maturing.mature_law().std().powi(2) / maturing.diffusion;
    let (mut columns, mut step): (Vec<Elements>, Option<TimeStep>) = (Vec::new(), None);
    let (mut start, mut end) = (0.0, first);
    while start < oldest && !columns.last().is_some_and(|density| is_mature(density, maturing)) {
        for t in RULE.nodes {
            let age = start + 0.5 * (1.0 + t) * (end - start);
            while evolution.time < age {
                let limit = if evolution.first { age } else { 2.0 * end };
                step = Some(evolution.advance(limit));
                watch.check()?;
            }
            let step = step.as_ref().expect("an age above 0");
            columns.push(step.at(age));
        }
        (start, end) = (end, 2.0 * end);
        // Each of the panels, which double, takes about as long as another.
        watch.done((start / first).log2() / (oldest / first).log2());
    }
    Ok(columns)
}

/// Whether a density is that of P_cf.
fn is_mature(density: &Elements, maturing: &ThresholdFokkerPlanck) -> bool {
    /// Sum of the differences of the masses of elements.
    const SAME: f64 = 1e-11;
    let law = maturing.mature_law();
    let off = |i: usize| {
        let [low, high] = [density.edges[i], density.edges[i + 1]];
        (density.width(i) * density.series[i][0] - (law.cumulative(high) - law.cumulative(low))).abs()
    };
    (0..density.count()).map(off).sum::<f64>() < SAME
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Gaussian, Law, Rectangular, SharedLaw};

    fn gaussian(mean: f64, std: f64) -> SharedLaw {
        Arc::new(Gaussian::new(mean, std).unwrap())
    }

    #[test]
    fn thresholds_between_gaussians_are_gaussian_at_every_age() {
        let maturing = ThresholdFokkerPlanck::new(gaussian(0.8, 0.08), gaussian(1.0, 0.05), 0.0025);
        let table = MaturingTable::new(maturing, &mut ()).unwrap();
        // Ornstein and Uhlenbeck: mean and variance relax at the rates 1 and 2.
        for age in [0.0_f64, 1e-3, 0.1, 0.5, 1.3, 4.0, 30.0, 1e9] {
            let left = (-age).exp();
            let std = (0.05_f64.powi(2) + (0.08_f64.powi(2) - 0.05_f64.powi(2)) * left * left).sqrt();
            let exact = Gaussian::new(1.0 - 0.2 * left, std).unwrap();
            let mut weights = table.no_ages();
            table.add(age, 0.3, &mut weights);
            let density = table.mean(&weights);
            for k in 0..60 {
                let x = 0.4 + 0.015 * f64::from(k);
                let off = density.survival(x) - exact.survival(x);
                // The tolerance of elements and steps, some of each.
                assert!(off.abs() < 1e-11, "{age} {x}: {off:e}");
                let off = density.density_at(x) - exact.density(x);
                assert!(off.abs() < 1e-9, "{age} {x}: {off:e}");
            }
            // −ln S goes on where nothing is left of S.
            assert!(density.cumulative_hazard(1.9) > density.cumulative_hazard(1.7));
        }
        // Later panels serve to the end: ages of all kinds.
        assert!(table.panels.len() > 4);
    }

    /// Their edges lie so close together that rounding limits the accuracy of the density between them: steps in age grow all
    /// the same.
    #[test]
    fn narrow_thresholds_diffuse_as_a_point_mass_does() {
        let narrow: SharedLaw = Arc::new(Rectangular::new(0.9998, 1.0002).unwrap());
        let variance = narrow.std().powi(2);
        let maturing = ThresholdFokkerPlanck::new(narrow, gaussian(1.5, 0.2), 0.01);
        let table = MaturingTable::new(maturing, &mut ()).unwrap();
        for age in [0.1_f64, 1.0, 5.0] {
            // Ornstein and Uhlenbeck, at the rate D/s².
            let left = (-0.25 * age).exp();
            let std = (0.04 + (variance - 0.04) * left * left).sqrt();
            let exact = Gaussian::new(1.5 - 0.5 * left, std).unwrap();
            let mut weights = table.no_ages();
            table.add(age, 1.0, &mut weights);
            let density = table.mean(&weights);
            for k in 0..60 {
                let x = 0.8 + 0.02 * f64::from(k);
                let off = density.survival(x) - exact.survival(x);
                // The tolerance of elements and steps, 3e-11, some of each; a rectangle and a Gaussian of its width differ less.
                assert!(off.abs() < 1e-9, "{age} {x}: {off:e}");
            }
        }
    }
}
