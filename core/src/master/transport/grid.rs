//! A grid in fresh thresholds for thermal breaking: panels on which the rate falls by a few factors of e.
//!
//! The lower the temperature, the more panels there are, of which only some matter at a time. They are
//! therefore given by a formula: the panels of the distribution, each divided into parts of equal [`Folds`].

use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use super::panels::{LabelPanel, panels_within};
use crate::contacts::{Barrier, Contacts, Label, NodalLabels, Rank, Temperature, ThresholdEvolution};
use crate::law::{Law, SharedLaw};
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal, RULE, gauss_points, series_at};
use crate::numerics::logarithm::ln;

/// A measure u(h) of thresholds: between two of them ln w falls by at most as much as u grows.
///
/// For the elastic and the Bell barrier u = E_0/T. For the catastrophe barrier ln w = −E_0/T (1 − x/h)^{3/2}
/// is less steep close to 0: u = E_0/T up to L, and L + (3/2) L^{1/3} [(E_0/T)^{2/3} − L^{2/3}] beyond, which
/// is exact for ln w > −L and right to a factor of 2 for ln w > −8L.
#[derive(Debug, Clone, Copy)]
struct Folds {
    /// E_0/T at h = 1.
    unit: f64,
    /// E_0 ∝ h^power.
    power: f64,
    /// L.
    deepest: f64,
    /// The largest change of u on a panel, and the largest number of octaves of the threshold.
    most: f64,
    octaves: f64,
}

/// The panels of a distribution at a temperature.
#[derive(Debug)]
pub(super) struct LabelGrid {
    pieces: Vec<GridPiece>,
    folds: Folds,
    law: SharedLaw,
    evolution: ThresholdEvolution,
    /// A place for each panel if there are few, and those in use if there are many: computing one takes as long as many steps
    /// of a cohort.
    near: Vec<OnceLock<GridPanel>>,
    far: RwLock<HashMap<u64, Arc<GridPanel>>>,
}

/// A panel with what all cohorts need of it.
#[derive(Debug)]
pub(super) struct GridPanel {
    pub(super) whole: LabelPanel,
    /// The fresh thresholds at its Gauss points.
    pub(super) labels: NodalLabels,
    /// The fraction of fresh contacts at each.
    pub(super) weights: Nodal,
    /// Legendre coefficients of the density of fresh contacts, on the panel as [−1, 1].
    density: Nodal,
    /// ∫ P_ci dh_0 above it, point masses included.
    pub(super) survival: f64,
    /// The same with h_0 as a factor, once it has been asked for.
    moment: OnceLock<f64>,
    /// [`Self::LOWEST`], [`Self::MIDDLE`] and [`Self::HIGHEST`], with their ranks.
    marks: [(f64, Option<Rank>); 3],
}

/// A panel that is kept for good, or as long as it is used.
pub(super) enum KeptPanel<'a> {
    Near(&'a GridPanel),
    Far(Arc<GridPanel>),
}

impl Deref for KeptPanel<'_> {
    type Target = GridPanel;

    #[inline]
    fn deref(&self) -> &GridPanel {
        match self {
            Self::Near(panel) => panel,
            Self::Far(panel) => panel,
        }
    }
}

impl GridPanel {
    /// The first Gauss point, one in the middle, and the upper end.
    pub(super) const LOWEST: usize = 0;
    pub(super) const MIDDLE: usize = 1;
    pub(super) const HIGHEST: usize = 2;

    fn new(whole: LabelPanel, law: &dyn Law, evolution: &ThresholdEvolution, tabulated: bool) -> Self {
        let (points, weights) = whole.nodes();
        let marks = [points[0], points[NODES / 2], whole.high].map(|h| (h, evolution.rank(h)));
        let half = 0.5 * (whole.high - whole.low);
        let density = points.map(|h| law.density(h));
        Self {
            whole,
            labels: evolution.labels(points, tabulated),
            weights: std::array::from_fn(|i| weights[i] * density[i]),
            density: RULE.coefficients(&density.map(|density| half * density)),
            survival: law.survival(whole.high),
            moment: OnceLock::new(),
            marks,
        }
    }

    /// ∫ P_ci h_0 dh_0 above it.
    pub(super) fn moment(&self, law: &dyn Law) -> f64 {
        *self.moment.get_or_init(|| law.upper_moment(1, self.whole.high))
    }

    /// One of its labels.
    pub(super) fn label(&self, mark: usize) -> Label<'_> {
        let (fresh, rank) = &self.marks[mark];
        Label { fresh: *fresh, rank: rank.as_ref() }
    }

    /// Thresholds in the panel above `met`, weighted by their fraction of fresh contacts, and e^{−A} there from A at the Gauss
    /// points.
    ///
    /// ln A is a polynomial in the threshold to rounding, e^{−A} only where A is small: for contacts that have just formed.
    #[inline(always)]
    pub(super) fn above(&self, met: f64, exponents: &Nodal) -> SurvivorsAbove {
        /// For A this small, e^{−A} is a polynomial to rounding.
        const SMALL: f64 = 1e-6;
        /// ln A must be finite: contacts far below the stretch have broken, and those far above hardly any.
        const MOST: f64 = 1e300;
        const LEAST: f64 = 1e-300;
        let (exponents, LabelPanel { low, high }) = (*exponents, self.whole);
        let from = (2.0 * met - low - high) / (high - low);
        let points = gauss_points(0.5 * (1.0 + from), 0.5 * (1.0 - from));
        let logarithmic = exponents.iter().any(|a| *a > SMALL) && exponents.iter().all(|a| *a > 0.0);
        let mut values = [0.0; NODES];
        if logarithmic {
            for i in 0..NODES {
                values[i] = ln(exponents[i].clamp(LEAST, MOST));
            }
        } else {
            for i in 0..NODES {
                values[i] = exp(-exponents[i]);
            }
        }
        let mut left = series_at(&RULE.coefficients(&values), &points);
        if logarithmic {
            for i in 0..NODES {
                left[i] = exp(-exp(left[i]));
            }
        }
        let mut weights = series_at(&self.density, &points);
        for i in 0..NODES {
            weights[i] *= 0.5 * (1.0 - from) * RULE.weights[i];
        }
        SurvivorsAbove { points, weights, left }
    }
}

/// Contacts of a panel above the largest threshold met.
pub(super) struct SurvivorsAbove {
    /// Gauss points, in [−1, 1] on the whole panel.
    pub(super) points: Nodal,
    pub(super) weights: Nodal,
    pub(super) left: Nodal,
}

/// A panel of the distribution, divided into parts.
#[derive(Debug)]
struct GridPiece {
    whole: LabelPanel,
    /// u at its lower end, and its increase per part.
    low: f64,
    step: f64,
    /// Index of its first part among all parts.
    first: u64,
    count: u64,
}

/// Panels that have a place: 3 MB; that are kept: 40 MB at most; and of which the thresholds at all ages are: 30 MB.
const MOST_NEAR: u64 = 1 << 12;
const MOST_KEPT: usize = 1 << 14;
const MOST_TABULATED: u64 = 1 << 9;

impl Folds {
    fn new(contacts: &Contacts, temperature: &Temperature, tolerance: f64) -> Self {
        /// A barrier eight times as high, in T, lasts 10³⁵/ω.
        const DEEPEST: f64 = 10.0;
        /// Ten times the error of the force for the catastrophe barrier with panels of one e-fold and one
        /// octave.
        const CATASTROPHE: f64 = 1e-8;
        /// Sixteen points integrate exp(−e^{−t}) over six e-folds to a tenth of this tolerance: to 9e-8. Over three
        /// e-folds they do to 6e-14, over four to 5e-11, over five to 4e-9, over eight to 5e-6: at most as the power 14 of
        /// the width.
        const SIX: f64 = 1e-6;
        let smooth = 6.0 * (tolerance / SIX).powf(1.0 / 14.0);
        let (most, octaves, deepest) = match temperature.barrier {
            Barrier::Elastic | Barrier::Bell => (smooth, 1.0, f64::INFINITY),
            // A has a singularity |h − x|^{5/2} where the threshold is met, of which a panel misses the power 7/2 of its width.
            Barrier::Catastrophe => {
                let fraction = (tolerance / CATASTROPHE).powf(2.0 / 7.0);
                // ln w falls by up to twice as much as u grows.
                (fraction.min(0.5 * smooth), fraction.min(1.0), DEEPEST)
            }
        };
        let power = if contacts.stiffness.is_equal() { 2.0 } else { 3.0 };
        Self { unit: 0.5 * contacts.stiffness.of(1.0) / temperature.energy, power, deepest, most, octaves }
    }

    /// u(h).
    fn at(&self, threshold: f64) -> f64 {
        let whole = self.unit * threshold.powf(self.power);
        if whole <= self.deepest {
            return whole;
        }
        let root = self.deepest.cbrt();
        root.mul_add(1.5 * (whole.cbrt().powi(2) - root * root), self.deepest)
    }

    /// h(u).
    fn threshold(&self, folds: f64) -> f64 {
        let whole = if folds <= self.deepest {
            folds
        } else {
            let root = self.deepest.cbrt();
            ((folds - self.deepest) / (1.5 * root) + root * root).powf(1.5)
        };
        (whole / self.unit).powf(1.0 / self.power)
    }
}

impl LabelGrid {
    pub(super) fn new(
        contacts: &Contacts,
        temperature: &Temperature,
        evolution: ThresholdEvolution,
        tolerance: f64,
    ) -> Self {
        /// More parts of a panel than this would have equal ends.
        const FINEST: f64 = 1e15;
        /// Mass beyond the last panel, in tolerances.
        const BEYOND: f64 = 1e-4;
        let law = contacts.thresholds.clone();
        let folds = Folds::new(contacts, temperature, tolerance);
        let mut first = 0;
        let piece = |whole: LabelPanel| {
            let (low, high) = (folds.at(whole.low), folds.at(whole.high));
            let count = ((high - low) / folds.most).ceil().clamp(1.0, FINEST);
            let piece = GridPiece { whole, low, step: (high - low) / count, first, count: count as u64 };
            first += piece.count;
            piece
        };
        let wholes = panels_within(law.as_ref(), f64::INFINITY, BEYOND * tolerance);
        let pieces: Vec<_> =
            wholes.into_iter().flat_map(|whole| whole.graded(folds.octaves)).map(piece).collect();
        let near =
            if first <= MOST_NEAR { (0..first).map(|_| OnceLock::new()).collect() } else { Vec::new() };
        Self { pieces, folds, law, evolution, near, far: RwLock::default() }
    }

    /// The largest change of ln w on a panel, up to a factor of 2.
    pub(super) fn folds(&self) -> f64 {
        self.folds.most
    }

    /// Number of panels with what cohorts need of them.
    #[cfg(test)]
    pub(super) fn known(&self) -> usize {
        let near = self.near.iter().filter(|place| place.get().is_some()).count();
        near + self.far.read().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Number of panels.
    pub(super) fn count(&self) -> u64 {
        self.pieces.last().map_or(0, |piece| piece.first + piece.count)
    }

    /// The panel of this index, with what cohorts need of it.
    pub(super) fn kept(&self, number: u64) -> KeptPanel<'_> {
        if let Some(place) = self.near.get(number as usize) {
            return KeptPanel::Near(place.get_or_init(|| self.made(number)));
        }
        if let Some(known) = self.far.read().unwrap_or_else(PoisonError::into_inner).get(&number) {
            return KeptPanel::Far(known.clone());
        }
        let panel = Arc::new(self.made(number));
        // Two threads may compute the same panel; both results are equal, so that it does not matter which is kept.
        let mut known = self.far.write().unwrap_or_else(PoisonError::into_inner);
        // Cohorts leave panels behind: once they are many, most have been passed, and the present ones are asked for several times
        // in each step of each cohort.
        if known.len() >= MOST_KEPT {
            known.clear();
        }
        known.insert(number, panel.clone());
        KeptPanel::Far(panel)
    }

    fn made(&self, number: u64) -> GridPanel {
        // Thresholds at all ages take 60 kB a panel.
        let tabulated = self.count() <= MOST_TABULATED;
        GridPanel::new(self.panel(number), self.law.as_ref(), &self.evolution, tabulated)
    }

    /// The panel of this index.
    pub(super) fn panel(&self, number: u64) -> LabelPanel {
        let piece = &self.pieces[self.pieces.partition_point(|piece| piece.first <= number) - 1];
        let part = number - piece.first;
        LabelPanel { low: self.edge(piece, part), high: self.edge(piece, part + 1) }
    }

    /// The same, beginning the search at a panel that does not lie above it.
    pub(super) fn above_from(&self, first: u64, label: f64) -> u64 {
        /// More panels than in a step at once are found faster by a formula.
        const FEW: u64 = 4;
        let ahead =
            (first..(first + FEW).min(self.count())).find(|&number| self.kept(number).whole.high > label);
        ahead.unwrap_or_else(|| self.above(label))
    }

    /// The index of the first panel that extends above a threshold.
    pub(super) fn above(&self, label: f64) -> u64 {
        let Some(piece) = self.pieces.get(self.pieces.partition_point(|piece| piece.whole.high <= label))
        else {
            return self.count();
        };
        if label < piece.whole.low {
            return piece.first;
        }
        let mut part = (((self.folds.at(label) - piece.low) / piece.step) as u64).min(piece.count - 1);
        // Corrects for rounding.
        while part > 0 && self.edge(piece, part) > label {
            part -= 1;
        }
        while self.edge(piece, part + 1) <= label {
            part += 1;
        }
        piece.first + part
    }

    fn edge(&self, piece: &GridPiece, part: u64) -> f64 {
        if part == 0 {
            piece.whole.low
        } else if part == piece.count {
            piece.whole.high
        } else {
            let edge = self.folds.threshold(piece.low + part as f64 * piece.step);
            edge.clamp(piece.whole.low, piece.whole.high)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::Stiffness;
    use crate::law::{Lognormal, Point, Rectangular, SharedLaw};

    #[test]
    fn panels_follow_each_other_and_the_rate_falls_by_few_folds_on_each() {
        let laws: [SharedLaw; 2] =
            [Arc::new(Rectangular::new(0.0, 1.5).unwrap()), Arc::new(Lognormal::new(1.0, 1.0).unwrap())];
        for (law, barrier) in laws.iter().flat_map(|law| {
            [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe].map(|barrier| (law, barrier))
        }) {
            for stiffness in [Stiffness::Equal(2.0), Stiffness::PerThreshold(2.0)] {
                let contacts = Contacts {
                    stiffness: stiffness.clone(),
                    ..Contacts::new(law.clone(), Arc::new(Point::new(0.0).unwrap()))
                };
                let temperature = Temperature { barrier, ..Temperature::new(1e-6, 1.0) };
                let evolution = ThresholdEvolution::of(&contacts).unwrap();
                let grid = LabelGrid::new(&contacts, &temperature, evolution, 1e-6);
                let ln_rate = |x: f64, h: f64| -temperature.exponent(x, h, stiffness.of(h));
                // The lognormal distribution has 1e-10, of which no tolerance of 1e-6 takes notice, below 3.5e-3.
                let first = grid.panel(0).low;
                assert!(first < 3.6e-3);
                for label in [1e-3, 0.01, 0.3, 1.2].into_iter().filter(|&label| label > first) {
                    let number = grid.above(label);
                    let panel = grid.panel(number);
                    assert!(panel.low <= label && label < panel.high, "{label}: {panel:?}");
                    assert_eq!(grid.panel(number + 1).low, panel.high);
                    // At stretches at which these contacts break.
                    for part in 0..100 {
                        let x = panel.low * f64::from(part) / 100.0;
                        if ln_rate(x, panel.high) > -80.0 {
                            let fall = ln_rate(x, panel.low) - ln_rate(x, panel.high);
                            // What sixteen points do for, and what u grows by more near its kink.
                            assert!(fall < 1.1 * 6.0, "{barrier:?} {x} {panel:?}: {fall}");
                        }
                    }
                }
                assert_eq!(grid.above(1e9), grid.count());
            }
        }
    }

    #[test]
    fn panels_in_use_are_kept_however_many_have_been_made() {
        let law: SharedLaw = Arc::new(Rectangular::new(0.0, 1.5).unwrap());
        let contacts = Contacts::new(law, Arc::new(Point::new(0.0).unwrap()));
        let evolution = ThresholdEvolution::of(&contacts).unwrap();
        let grid = LabelGrid::new(&contacts, &Temperature::new(1e-6, 1.0), evolution, 1e-6);
        let last = MOST_KEPT as u64 + 5;
        assert!(grid.count() > last);
        for number in 0..=last {
            let [first, again] = [(); 2].map(|()| grid.kept(number));
            assert!(std::ptr::eq::<GridPanel>(&*first, &*again), "{number}");
            assert!(grid.known() <= MOST_KEPT);
        }
    }
}
