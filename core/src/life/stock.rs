//! Layers put together: what has broken is left out, and what has been outdone is forgotten.

use super::Life;
use super::athermal::of_layers;
use super::breaking::Breaking;
use super::cells::{BULK, NEGLIGIBLE, RESOLUTION, scale, walls};
use super::layer::{Layer, PointMass, SAME};
use crate::Result;
use crate::contacts::{Contacts, Stiffness};
use crate::law::Law;
use crate::monitor::{Monitor, Watch};
use crate::numerics::breakpoints::same_position;
use crate::numerics::piecewise::Piecewise;

/// Breaks of which cells that resolve P_c, with points closer than a 32nd of its scale, miss no more than this per mean
/// threshold are forgotten.
const FAINT: f64 = 1e-11;

/// The life of the contacts of some layers; what breaks stays broken.
///
/// # Errors
/// Stopped by the monitor.
pub(crate) fn life_of(contacts: &Contacts, layers: Vec<Layer>, monitor: &mut dyn Monitor) -> Result<Life> {
    let watch = Watch::new(monitor);
    let life = of_layers(contacts, layers, None, &watch);
    watch.check().map(|()| life)
}

/// What the contacts of some layers are together, per unit stiffness.
pub(crate) struct LayerSums {
    /// The fraction that is unbroken.
    pub(crate) unbroken: f64,
    pub(crate) stiffness: f64,
    /// As in a [`Life`].
    pub(crate) breaking_energy: f64,
}

impl LayerSums {
    pub(crate) fn of(layers: &[Layer], contacts: &Contacts) -> Self {
        let thresholds = contacts.thresholds.as_ref();
        let breaking: Vec<_> = layers.iter().map(|layer| Breaking::new(thresholds, layer, BULK)).collect();
        let sum = |moment: u32| breaking.iter().map(|b| b.weighted(0.0, 0, moment)).sum::<f64>();
        let unbroken = sum(0);
        let (stiffness, energy) = match contacts.stiffness {
            Stiffness::Equal(_) => (unbroken, sum(2)),
            Stiffness::PerThreshold(_) => (sum(1), sum(3)),
        };
        Self { unbroken, stiffness, breaking_energy: 0.5 * energy }
    }
}

/// Whether a point mass reaches a threshold that many share when the slider has gone on by `advance`.
pub(crate) fn strikes(layers: &[Layer], thresholds: &dyn Law, advance: f64) -> bool {
    let close = SAME * thresholds.mean();
    let struck = |layer: &Layer| {
        let breaking = Breaking::new(thresholds, layer, BULK);
        breaking.struck.iter().any(|(u, _)| (u - advance).abs() <= close)
    };
    !thresholds.atoms().is_empty() && layers.iter().any(struck)
}

/// The layers, without what is negligible; those with one and the same past, as far as it can still be felt, as one.
pub(crate) fn tidied(layers: Vec<Layer>, thresholds: &dyn Law) -> Vec<Layer> {
    let close = SAME * thresholds.mean();
    let (mut out, walls): (Vec<Layer>, _) = (Vec::new(), walls(thresholds));
    for mut layer in layers {
        layer.trim(thresholds, &walls);
        layer.forget();
        let spacing = scale(thresholds).min(thresholds.mean()) / 32.0;
        layer.breakpoints.retain(|b| b.weight(spacing) * thresholds.mean() > FAINT);
        if layer.range().is_none() {
            continue;
        }
        let alike = |other: &&mut Layer| {
            (other.ahead - layer.ahead).abs() <= close && (other.behind - layer.behind).abs() <= close
        };
        match out.iter_mut().find(alike) {
            Some(other) => other.merge(layer),
            None => out.push(layer),
        }
    }
    out
}

impl Layer {
    /// How far the slider may go on before a contact can break whose threshold is above `lowest`.
    pub(crate) fn way_ahead(&self, lowest: f64) -> f64 {
        let far = |(_, high): (f64, f64)| self.ahead.max(lowest - high).max(self.behind - 2.0 * high);
        self.range().map_or(f64::INFINITY, far)
    }

    /// Leaves out what is negligible at either end.
    fn trim(&mut self, thresholds: &dyn Law, walls: &[f64]) {
        let survival =
            |low: f64, high: f64| thresholds.survival(self.largest(self.lowest(0.0).clamp(low, high), 0.0));
        let kept = |cell: &usize| {
            let (middle, half) = self.density.cell(*cell);
            let most: f64 = self.density.coefficients[*cell].iter().map(|c| c.abs()).sum();
            2.0 * half * most * survival(middle - half, middle + half) > NEGLIGIBLE
        };
        let cells = 0..self.density.coefficients.len();
        let ends = cells.clone().find(kept).zip(cells.rev().find(kept));
        let density = ends.map_or_else(Piecewise::default, |(first, last)| Piecewise {
            boundaries: self.density.boundaries[first..=last + 1].to_vec(),
            coefficients: self.density.coefficients[first..=last].to_vec(),
        });
        let left = |l: &PointMass| l.weight * thresholds.survival(self.exceeded(l, 0.0, walls)) > NEGLIGIBLE;
        let lumps = self.lumps.iter().copied().filter(left).collect();
        let (low, high) = (density.start(), density.end());
        self.breakpoints.retain(|b| b.position >= low && b.position <= high);
        (self.density, self.lumps) = (density, lumps);
    }

    /// Forgets the side on which the slider was less far than on the other, for every contact.
    fn forget(&mut self) {
        let Some((low, high)) = self.range() else { return };
        if low >= self.lowest(0.0) {
            self.behind = 0.0;
        } else if high <= self.lowest(0.0) {
            self.ahead = 0.0;
        }
    }

    /// Adds contacts with the same past.
    fn merge(&mut self, other: Self) {
        self.density = self.density.added(&other.density, RESOLUTION);
        self.lumps.extend(other.lumps);
        self.lumps.sort_by(|a, b| a.position.total_cmp(&b.position));
        self.lumps.dedup_by(|b, a| {
            let same = same_position(a.position, b.position) && a.passed == b.passed;
            a.weight += if same { b.weight } else { 0.0 };
            same
        });
        self.breakpoints.extend(other.breakpoints);
        self.resolution = self.resolution.min(other.resolution);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::Rectangular;

    #[test]
    fn a_larger_swing_wipes_out_a_smaller_one() {
        let thresholds = Arc::new(Rectangular::new(0.9, 1.1).unwrap());
        let reforming = Arc::new(Rectangular::new(0.0, 0.2).unwrap());
        let contacts = Contacts::new(thresholds, reforming.clone());
        let law = contacts.thresholds.as_ref();
        let born = Layer::placed(&contacts, reforming.as_ref(), true, BULK);
        let back = born.advanced(0.5).mirrored().advanced(0.3).mirrored();
        let layers = tidied(vec![back.scaled(0.5), born.scaled(0.5)], law);
        assert_eq!(layers.len(), 2);
        let moved = |by: f64| tidied(layers.iter().map(|layer| layer.advanced(by)).collect(), law);
        assert_eq!((moved(0.2).len(), moved(0.4).len()), (2, 1));
        // Below all thresholds nothing breaks.
        assert!((LayerSums::of(&moved(0.2), &contacts).unbroken - 1.0).abs() < 1e-14);
        assert!((moved(0.2)[0].way_ahead(0.9) - 0.3).abs() < 1e-14);
    }
}
