//! Gauss points of a density, between given bounds and cuts.

use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;

/// A density in parts on which Gauss points resolve it, and what it is to be multiplied by.
pub(super) struct Panels<'a> {
    density: &'a Piecewise,
    panels: Vec<Panel>,
}

/// A part, with its Gauss points: place and weight × density.
struct Panel {
    low: f64,
    high: f64,
    points: Vec<(f64, f64)>,
}

/// Where an integral is taken: between `low` and `high`, smooth between `cuts`, but for powers of the distance to those
/// places that are `steep`.
pub(super) struct Domain {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) cuts: Vec<f64>,
    pub(super) steep: Vec<f64>,
}

impl<'a> Panels<'a> {
    /// The cells, cut into panels no wider than `widest`, without points that carry less than is `negligible`.
    pub(super) fn new(density: &'a Piecewise, widest: f64, negligible: f64) -> Self {
        let panels = density.boundaries.windows(2).flat_map(|cell| {
            let parts = ((cell[1] - cell[0]) / widest).ceil().max(1.0);
            let at = |part: usize| cell[0] + (cell[1] - cell[0]) * part as f64 / parts;
            let ends = (0..parts as usize).map(move |part| (at(part), at(part + 1)));
            ends.map(|(low, high)| Panel::new(density, (low, high), negligible)).collect::<Vec<_>>()
        });
        Self { density, panels: panels.collect() }
    }

    /// Visits Gauss points in a domain, with their weights × density.
    pub(super) fn each(&self, mut domain: Domain, mut visit: impl FnMut(f64, f64)) {
        let (low, high) = (domain.low, domain.high);
        domain.cuts.extend([low, high]);
        domain.cuts.sort_by(f64::total_cmp);
        let first = self.panels.partition_point(|panel| panel.high <= low);
        for panel in self.panels[first..].iter().take_while(|panel| panel.low < high) {
            let from = domain.cuts.partition_point(|&x| x <= panel.low);
            let inside = &domain.cuts[from..domain.cuts.partition_point(|&x| x < panel.high).max(from)];
            if inside.is_empty() && !near(&domain.steep, panel.low, panel.high) {
                panel.points.iter().for_each(|&(x, weight)| visit(x, weight));
                continue;
            }
            let (mut start, least) = (panel.low, 1e-16 * (panel.high - panel.low));
            for &stop in inside.iter().chain([&panel.high]) {
                if start >= low && stop <= high {
                    self.part((start, stop), least, &domain.steep, &mut visit);
                }
                start = stop;
            }
        }
    }

    /// Gauss points on part of a panel, halved down to the width `least` as long as it is wider than its distance to what
    /// is steep.
    fn part(&self, (low, high): (f64, f64), least: f64, steep: &[f64], visit: &mut impl FnMut(f64, f64)) {
        let middle = 0.5 * (low + high);
        if high - low > least && low < middle && middle < high && near(steep, low, high) {
            self.part((low, middle), least, steep, visit);
            return self.part((middle, high), least, steep, visit);
        }
        gauss(low, high).for_each(|(x, weight)| visit(x, weight * self.density.value(x)));
    }
}

impl Panel {
    fn new(density: &Piecewise, (low, high): (f64, f64), negligible: f64) -> Self {
        let points = gauss(low, high).map(|(x, weight)| (x, weight * density.value(x)));
        Self { low, high, points: points.filter(|point| point.1.abs() > negligible).collect() }
    }
}

/// Whether one of the places is nearer to [low, high] than that is wide.
fn near(places: &[f64], low: f64, high: f64) -> bool {
    places.iter().any(|x| (low - x).max(x - high) < 0.99 * (high - low))
}

/// Gauss points and weights on [low, high].
fn gauss(low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    RULE.nodes.iter().zip(&RULE.weights).map(move |(t, w)| (middle + half * t, half * w))
}
