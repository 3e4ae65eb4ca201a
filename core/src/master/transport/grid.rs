//! A grid in fresh thresholds for thermal breaking: panels on which the rate falls by a few factors of e.
//!
//! The lower the temperature, the more panels there are, of which only some matter at a time. They are
//! therefore given by a formula: the panels of the distribution, each divided into parts of equal [`Folds`].

use super::panels::{LabelPanel, panels};
use crate::contacts::{Barrier, Contacts, Stiffness, Temperature};
use crate::law::Law;

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

impl Folds {
    fn new(contacts: &Contacts, temperature: &Temperature, tolerance: f64) -> Self {
        /// A barrier eight times as high, in T, lasts 10³⁵/ω.
        const DEEPEST: f64 = 10.0;
        /// Ten times the error of the force for the catastrophe barrier with panels of one e-fold and one
        /// octave.
        const CATASTROPHE: f64 = 1e-8;
        let (most, octaves, deepest) = match temperature.barrier {
            // Sixteen points integrate exp(−e^{−t}) over three e-folds to 1e-12.
            Barrier::Elastic | Barrier::Bell => (3.0, 1.0, f64::INFINITY),
            // A has a singularity |h − x|^{5/2} where the threshold is met, of which a panel misses the power 7/2 of its width.
            Barrier::Catastrophe => {
                let fraction = (tolerance / CATASTROPHE).powf(2.0 / 7.0).min(1.0);
                (fraction, fraction, DEEPEST)
            }
        };
        let power = match contacts.stiffness {
            Stiffness::Equal(_) => 2.0,
            Stiffness::PerThreshold(_) => 3.0,
        };
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
    pub(super) fn new(law: &dyn Law, contacts: &Contacts, temperature: &Temperature, tolerance: f64) -> Self {
        /// More parts of a panel than this would have equal ends.
        const FINEST: f64 = 1e15;
        let folds = Folds::new(contacts, temperature, tolerance);
        let mut first = 0;
        let piece = |whole: LabelPanel| {
            let (low, high) = (folds.at(whole.low), folds.at(whole.high));
            let count = ((high - low) / folds.most).ceil().clamp(1.0, FINEST);
            let piece = GridPiece { whole, low, step: (high - low) / count, first, count: count as u64 };
            first += piece.count;
            piece
        };
        let wholes = panels(law, f64::INFINITY).into_iter().flat_map(|whole| whole.graded(folds.octaves));
        Self { pieces: wholes.map(piece).collect(), folds }
    }

    /// Number of panels.
    pub(super) fn count(&self) -> u64 {
        self.pieces.last().map_or(0, |piece| piece.first + piece.count)
    }

    /// The panel of this index.
    pub(super) fn panel(&self, number: u64) -> LabelPanel {
        let piece = &self.pieces[self.pieces.partition_point(|piece| piece.first <= number) - 1];
        let part = number - piece.first;
        LabelPanel { low: self.edge(piece, part), high: self.edge(piece, part + 1) }
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
    use crate::law::{Lognormal, Point, Rectangular, SharedLaw};

    #[test]
    fn panels_follow_each_other_and_the_rate_falls_by_few_folds_on_each() {
        let laws: [SharedLaw; 2] =
            [Arc::new(Rectangular::new(0.0, 1.5).unwrap()), Arc::new(Lognormal::new(1.0, 1.0).unwrap())];
        for (law, barrier) in laws.iter().flat_map(|law| {
            [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe].map(|barrier| (law, barrier))
        }) {
            for stiffness in [Stiffness::Equal(2.0), Stiffness::PerThreshold(2.0)] {
                let contacts =
                    Contacts { stiffness, ..Contacts::new(law.clone(), Arc::new(Point::new(0.0).unwrap())) };
                let temperature = Temperature { energy: 1e-6, attempt_rate: 1.0, barrier };
                let grid = LabelGrid::new(law.as_ref(), &contacts, &temperature, 1e-6);
                let ln_rate = |x: f64, h: f64| -temperature.exponent(x, h, stiffness.of(h));
                for label in [1e-3, 0.01, 0.3, 1.2] {
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
                            assert!(fall < 1.1 * 3.0, "{barrier:?} {x} {panel:?}: {fall}");
                        }
                    }
                }
                assert_eq!(grid.above(1e9), grid.count());
            }
        }
    }
}
