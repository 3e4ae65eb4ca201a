//! Simplification of layers: negligible parts are dropped, and layers with the same history are merged.

use super::Life;
use super::athermal::of_layers;
use super::breaking::Breaking;
use super::cells::{BULK, NEGLIGIBLE, RESOLUTION, scale, threshold_atoms};
use super::layer::{Layer, PointMass, SAME};
use crate::Result;
use crate::contacts::Contacts;
use crate::law::Law;
use crate::monitor::{Monitor, Watch};
use crate::numerics::breakpoints::same_position;
use crate::numerics::order::sort_by_number;
use crate::numerics::piecewise::Piecewise;

/// Breakpoints are dropped if their effect on cells that resolve P_c is below this, per mean threshold.
const FAINT: f64 = 1e-11;

/// The life of the contacts of some layers; broken contacts do not re-form.
///
/// # Errors
/// Stopped by the monitor.
pub(crate) fn life_of(contacts: &Contacts, layers: Vec<Layer>, monitor: &mut dyn Monitor) -> Result<Life> {
    let watch = Watch::new(monitor);
    let life = of_layers(contacts, layers, None, &watch);
    watch.check().map(|()| life)
}

/// Sums over the contacts of some layers, per unit stiffness.
pub(crate) struct LayerSums {
    /// The fraction of unbroken contacts.
    pub(crate) unbroken: f64,
    pub(crate) stiffness: f64,
    /// As in a [`Life`].
    pub(crate) breaking_energy: f64,
}

impl LayerSums {
    pub(crate) fn of(layers: &[Layer], contacts: &Contacts) -> Self {
        let thresholds = contacts.thresholds.as_ref();
        let breaking: Vec<_> = layers
            .iter()
            .map(|layer| Breaking::new(thresholds, layer, BULK).carrying(&contacts.stiffness))
            .collect();
        let sum =
            |of: [u32; 2]| breaking.iter().map(|b| b.carried(0.0, 0, &contacts.stiffness, of)).sum::<f64>();
        Self { unbroken: sum([0, 0]), stiffness: sum([1, 0]), breaking_energy: 0.5 * sum([1, 2]) }
    }
}

/// Whether a point mass reaches a threshold atom when the slider has advanced by `advance`.
pub(crate) fn reaches_threshold_atom(layers: &[Layer], thresholds: &dyn Law, advance: f64) -> bool {
    let close = SAME * thresholds.mean();
    let simultaneous = |layer: &Layer| {
        let breaking = Breaking::new(thresholds, layer, BULK);
        breaking.simultaneous.iter().any(|(u, _)| (u - advance).abs() <= close)
    };
    !thresholds.atoms().is_empty() && layers.iter().any(simultaneous)
}

/// The layers without what is negligible, those with the same history merged.
pub(crate) fn simplified(layers: Vec<Layer>, thresholds: &dyn Law) -> Vec<Layer> {
    let close = SAME * thresholds.mean();
    let (mut out, threshold_atoms): (Vec<Layer>, _) = (Vec::new(), threshold_atoms(thresholds));
    for mut layer in layers {
        layer.trim(thresholds, &threshold_atoms);
        layer.drop_inactive_side();
        let spacing = scale(thresholds).min(thresholds.mean()) / 32.0;
        layer.breakpoints.retain(|b| b.weight(spacing) * thresholds.mean() > FAINT);
        if layer.range().is_none() {
            continue;
        }
        let alike = |other: &&mut Layer| {
            (other.ahead - layer.ahead).abs() <= close && (other.behind - layer.behind).abs() <= close
        };
        match out.iter_mut().find(alike) {
            // Contacts with the same largest stretch as a function of x have the same survival:
            // their densities add, and turns of the drive do not pile up layers.
            Some(other) => other.merge(layer),
            None => out.push(layer),
        }
    }
    out
}

impl Layer {
    /// How far the slider can advance before a contact with a threshold above `lowest` can break.
    pub(crate) fn distance_to_break(&self, lowest: f64) -> f64 {
        let far = |(_, high): (f64, f64)| self.ahead.max(lowest - high).max(self.behind - 2.0 * high);
        self.range().map_or(f64::INFINITY, far)
    }

    /// Drops what is negligible at either end.
    fn trim(&mut self, thresholds: &dyn Law, threshold_atoms: &[f64]) {
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
        let left = |l: &PointMass| {
            l.weight * thresholds.survival(self.exceeded(l, 0.0, threshold_atoms)) > NEGLIGIBLE
        };
        let point_masses = self.point_masses.iter().copied().filter(left).collect();
        let (low, high) = (density.start(), density.end());
        self.breakpoints.retain(|b| b.position >= low && b.position <= high);
        (self.density, self.point_masses) = (density, point_masses);
    }

    /// Drops `ahead` or `behind` if it determines the largest stretch of no contact.
    fn drop_inactive_side(&mut self) {
        let Some((low, high)) = self.range() else { return };
        if low >= self.lowest(0.0) {
            self.behind = 0.0;
        } else if high <= self.lowest(0.0) {
            self.ahead = 0.0;
        }
    }

    /// Adds contacts with the same history.
    fn merge(&mut self, other: Self) {
        self.density = self.density.added(&other.density, RESOLUTION);
        self.point_masses.extend(other.point_masses);
        sort_by_number(&mut self.point_masses, |item| item.position);
        self.point_masses.dedup_by(|b, a| {
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
        let layers = simplified(vec![back.scaled(0.5), born.scaled(0.5)], law);
        assert_eq!(layers.len(), 2);
        let moved = |by: f64| simplified(layers.iter().map(|layer| layer.advanced(by)).collect(), law);
        assert_eq!((moved(0.2).len(), moved(0.4).len()), (2, 1));
        // Below all thresholds nothing breaks.
        assert!((LayerSums::of(&moved(0.2), &contacts).unbroken - 1.0).abs() < 1e-14);
        assert!((moved(0.2)[0].distance_to_break(0.9) - 0.3).abs() < 1e-14);
    }
}
