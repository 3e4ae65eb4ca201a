//! Gauss panels of a distribution, on which its density is smooth.

use crate::law::Law;
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// Width of a panel in units of the resolution of a zone: skewed distributions vary faster than that on their
/// steeper side.
const WIDTH: f64 = 1.0;

/// Width of a panel in a tail, in factors e of the stretch.
const TAIL: f64 = 0.25;

/// Mass beyond the last panel.
const BEYOND: f64 = 1e-17;

/// A panel without breakpoints of the density inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LabelPanel {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl LabelPanel {
    /// The panel divided so that no part spans more than `octaves` octaves: Gauss points then integrate any
    /// power.
    pub(super) fn graded(self, octaves: f64) -> impl Iterator<Item = Self> {
        let all = if self.low > 0.0 { (self.high / self.low).log2() } else { octaves };
        let count = (all / octaves).ceil().max(1.0);
        let edge = move |k: f64| if k == count { self.high } else { self.low * (all * k / count).exp2() };
        (0..count as u32).map(move |k| Self { low: edge(f64::from(k)), high: edge(f64::from(k) + 1.0) })
    }

    /// The panel in parts that end at the `cuts` inside it, which rise.
    pub(super) fn cut(self, cuts: &[f64]) -> Vec<Self> {
        let inside = cuts.iter().copied().filter(|cut| (self.low..self.high).contains(cut));
        let edges: Vec<f64> = std::iter::once(self.low).chain(inside).chain([self.high]).collect();
        let parts = edges.windows(2).filter(|ends| ends[0] < ends[1]);
        parts.map(|ends| Self { low: ends[0], high: ends[1] }).collect()
    }

    /// Gauss points with their weights.
    pub(super) fn points(self) -> impl Iterator<Item = (f64, f64)> {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 * (self.high - self.low));
        (0..NODES).map(move |i| (middle + half * RULE.nodes[i], half * RULE.weights[i]))
    }

    /// Gauss points and weights.
    pub(super) fn nodes(self) -> (Nodal, Nodal) {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 * (self.high - self.low));
        (RULE.nodes.map(|node| middle + half * node), RULE.weights.map(|weight| half * weight))
    }
}

/// The panels that contain the density of a distribution, none wider than `widest`.
pub(super) fn panels(law: &dyn Law, widest: f64) -> Vec<LabelPanel> {
    panels_within(law, widest, BEYOND)
}

/// The same up to the mass `beyond` at either end.
pub(super) fn panels_within(law: &dyn Law, widest: f64, beyond: f64) -> Vec<LabelPanel> {
    let beyond = beyond.max(BEYOND);
    let (bottom, top) = (law.quantile(beyond), law.upper_quantile(0.0).min(law.upper_quantile(beyond)));
    let zones = law.zones();
    let mut stops: Vec<f64> = zones.iter().flat_map(|zone| [zone.low, zone.high]).collect();
    stops.extend(law.breakpoints().iter().map(|b| b.position));
    stops.extend([bottom, top]);
    stops.retain(|&x| x >= (if beyond > BEYOND { bottom } else { 0.0 }) && x <= top);
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    let mut panels = Vec::new();
    for ends in stops.windows(2) {
        let (low, high) = (ends[0], ends[1]);
        let over: Vec<_> = zones.iter().filter(|zone| zone.low < high && zone.high > low).collect();
        let scale = over.iter().map(|zone| WIDTH * zone.resolution).fold(widest, f64::min);
        // Tails outside all zones fall like a power.
        let tail = low > 0.0 && over.is_empty();
        let folds = if tail { (high / low).ln() / TAIL } else { 1.0 };
        let count = ((high - low) / scale).max(folds).ceil().max(1.0);
        let edge = |k: f64| {
            if tail { low * (high / low).powf(k / count) } else { low + (high - low) * k / count }
        };
        let parts =
            (0..count as u32).map(|k| LabelPanel { low: edge(f64::from(k)), high: edge(f64::from(k) + 1.0) });
        let graded = parts.flat_map(|part| part.graded(1.0));
        panels.extend(graded.filter(|panel| panel.points().any(|(x, _)| law.density(x) > 0.0)));
    }
    panels
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Gamma, Gaussian, Lognormal, Rectangular, SharedLaw, Weibull};

    #[test]
    fn panels_hold_the_whole_law() {
        let laws: Vec<SharedLaw> = vec![
            Arc::new(Gaussian::new(1.0, 0.1).unwrap()),
            Arc::new(Lognormal::new(1.0, 0.5).unwrap()),
            Arc::new(Rectangular::new(0.75, 1.25).unwrap()),
            Arc::new(Exponential::new(1.0).unwrap()),
            Arc::new(Weibull::new(1.0, 4.0).unwrap()),
            Arc::new(Gamma::new(1.0, 0.3).unwrap()),
            Arc::new(Gamma::new(1.0, 1.5).unwrap()),
            Arc::new(Weibull::new(0.6, 1.0).unwrap()),
        ];
        for law in laws {
            let points = panels(law.as_ref(), f64::INFINITY).into_iter().flat_map(LabelPanel::points);
            let whole: f64 = points.map(|(x, weight)| weight * law.density(x)).sum();
            // What 16 points leave out of the tails.
            assert!((whole - 1.0).abs() < 1e-11, "{}: {whole}", law.name());
        }
    }
}
