//! Gauss points of a density of starts, between given bounds and cuts.

use crate::numerics::gauss;
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;

/// A density on panels on which Gauss points integrate it times a smooth function.
pub(super) struct Panels<'a> {
    density: &'a Piecewise,
    panels: Vec<StartPanel>,
}

/// A panel with its Gauss points: position and weight × density.
struct StartPanel {
    low: f64,
    high: f64,
    points: Vec<(f64, f64)>,
    /// The panels that it was merged from, if any.
    parts: Vec<StartPanel>,
}

/// The domain of an integral between `low` and `high`. The integrand is smooth between `cuts`, except for
/// powers of the distance to the positions in `steep`.
pub(super) struct Domain {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) cuts: Vec<f64>,
    pub(super) steep: Vec<f64>,
}

impl<'a> Panels<'a> {
    /// The cells, divided into panels no wider than `widest`, without points whose weight is below
    /// `negligible`.
    pub(super) fn new(density: &'a Piecewise, widest: f64, negligible: f64) -> Self {
        let panels = density.boundaries.windows(2).flat_map(|cell| {
            let parts = ((cell[1] - cell[0]) / widest).ceil().max(1.0);
            let at = |part: usize| cell[0] + (cell[1] - cell[0]) * part as f64 / parts;
            let ends = (0..parts as usize).map(move |part| (at(part), at(part + 1)));
            ends.map(|(low, high)| StartPanel::new(density, (low, high), negligible)).collect::<Vec<_>>()
        });
        Self { density, panels: panels.collect() }
    }

    /// The ends of each panel.
    pub(super) fn ranges(&self) -> impl Iterator<Item = [f64; 2]> {
        self.panels.iter().map(|panel| [panel.low, panel.high])
    }

    /// Visits the Gauss points in a domain, with their weight × density.
    pub(super) fn each(&self, mut domain: Domain, mut visit: impl FnMut(f64, f64)) {
        let (low, high) = (domain.low, domain.high);
        domain.cuts.extend([low, high]);
        domain.cuts.sort_by(f64::total_cmp);
        let first = self.panels.partition_point(|panel| panel.high <= low);
        for panel in self.panels[first..].iter().take_while(|panel| panel.low < high) {
            self.within(panel, &domain, &mut visit);
        }
    }

    /// Visits all points of all panels, and of those they were merged from.
    pub(super) fn all(&self, mut visit: impl FnMut(f64)) {
        let parts = self.panels.iter().flat_map(|panel| &panel.parts);
        self.panels.iter().chain(parts).flat_map(|panel| &panel.points).for_each(|point| visit(point.0));
    }

    /// Merges neighbouring panels. Each merged panel has the fewest points that integrate functions varying
    /// on the `length` between two positions to `error`: a Gauss rule for the density itself. Panels are
    /// split again where they are cut.
    pub(super) fn merged(self, length: impl Fn(f64, f64) -> f64, error: f64) -> Self {
        /// Largest width of merged panels, in lengths.
        const WIDEST: f64 = 3.0;
        let mut panels = Vec::new();
        let mut rest = self.panels.into_iter().peekable();
        while let Some(first) = rest.next() {
            let low = first.low;
            let mut parts = vec![first];
            let is_near = |next: &StartPanel| next.high - low <= WIDEST * length(low, next.high);
            parts.extend(std::iter::from_fn(|| rest.next_if(is_near)));
            let high = parts[parts.len() - 1].high;
            let points: Vec<_> = parts.iter().flat_map(|part| part.points.iter().copied()).collect();
            // Each point of a merged panel costs a cohort, which may be a solution of a partial
            // differential equation: the fewest points for the error are worth an optimal rule.
            let rule = gauss::fewest(&points, length(low, high), error);
            if rule.len() < points.len() {
                panels.push(StartPanel { low, high, points: rule, parts });
            } else {
                panels.extend(parts);
            }
        }
        Self { panels, ..self }
    }

    /// Visits the Gauss points of a panel in a domain.
    fn within(&self, panel: &StartPanel, domain: &Domain, visit: &mut dyn FnMut(f64, f64)) {
        let from = domain.cuts.partition_point(|&x| x <= panel.low);
        let inside = &domain.cuts[from..domain.cuts.partition_point(|&x| x < panel.high).max(from)];
        if inside.is_empty() && !near(&domain.steep, panel.low, panel.high) {
            return panel.points.iter().for_each(|&(x, weight)| visit(x, weight));
        }
        if !panel.parts.is_empty() {
            let parts = panel.parts.iter().filter(|part| part.high > domain.low && part.low < domain.high);
            return parts.for_each(|part| self.within(part, domain, visit));
        }
        let (mut start, least) = (panel.low, 1e-16 * (panel.high - panel.low));
        for &stop in inside.iter().chain([&panel.high]) {
            if start >= domain.low && stop <= domain.high {
                self.part((start, stop), least, &domain.steep, visit);
            }
            start = stop;
        }
    }

    /// Gauss points on part of a panel, bisected down to the width `least` while it is wider than its
    /// distance to a steep position.
    fn part(&self, (low, high): (f64, f64), least: f64, steep: &[f64], visit: &mut dyn FnMut(f64, f64)) {
        let middle = 0.5 * (low + high);
        if high - low > least && low < middle && middle < high && near(steep, low, high) {
            self.part((low, middle), least, steep, visit);
            return self.part((middle, high), least, steep, visit);
        }
        legendre(low, high).for_each(|(x, weight)| visit(x, weight * self.density.value(x)));
    }
}

impl StartPanel {
    fn new(density: &Piecewise, (low, high): (f64, f64), negligible: f64) -> Self {
        let points = legendre(low, high).map(|(x, weight)| (x, weight * density.value(x)));
        let points = points.filter(|point| point.1.abs() > negligible).collect();
        Self { low, high, points, parts: Vec::new() }
    }
}

/// Whether one of the positions is closer to [low, high] than its width.
pub(super) fn near(places: &[f64], low: f64, high: f64) -> bool {
    places.iter().any(|x| (low - x).max(x - high) < 0.99 * (high - low))
}

/// Gauss–Legendre points and weights on [low, high].
pub(super) fn legendre(low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    RULE.nodes.iter().zip(&RULE.weights).map(move |(t, w)| (middle + half * t, half * w))
}
