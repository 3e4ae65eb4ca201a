//! Where contacts start, and how they break from there: ν and its products with the law of thresholds.

use crate::contacts::Contacts;
use crate::law::{Atom, Break, Law, SharedLaw, Zone};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// How closely starts and what breaks are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    pub(super) resolution: Resolution,
    /// Survival and starting mass below this are left out.
    negligible: f64,
}

/// Curves of a total of 1 (or of the mean life, force, …).
pub(super) const BULK: Detail = Detail { resolution: Resolution::Mean(1e-14), negligible: 1e-18 };

impl Detail {
    /// Tails as well, each cell to 1e-13 of itself down to what is negligible.
    pub(super) const fn tails(negligible: f64) -> Self {
        Self { resolution: Resolution::Relative { fraction: 1e-13, negligible }, negligible }
    }
}

/// Moments of the breaking stretches are kept up to the fourth.
pub(super) const MOMENTS: usize = 5;

/// ν: the law of starting stretches, over their survival where conditional.
pub(super) struct Births<'a> {
    pub(super) thresholds: &'a dyn Law,
    starts: &'a dyn Law,
    conditional: bool,
    detail: Detail,
    /// The highest start.
    pub(super) top: f64,
    pub(super) density: Piecewise,
    pub(super) atoms: Vec<Atom>,
    /// Breaks and atoms of P_c.
    hazards: Vec<Break>,
    /// Advances at which atoms of ν meet atoms of P_c: the threshold met, and the fraction that breaks there.
    pub(super) struck: Vec<(f64, Atom)>,
    /// Width of cells that resolve P_c, and the law of starts.
    fine: (f64, f64),
    /// Gauss points of the density, fine enough for P_c too: stretch and weight.
    points: Vec<(f64, f64)>,
    /// The density of P_c and its Gauss points, where it is the narrower of the two.
    narrow: Option<(Piecewise, Vec<(f64, f64)>)>,
}

impl<'a> Births<'a> {
    pub(super) fn new(
        contacts: &'a Contacts,
        starts: &'a SharedLaw,
        conditional: bool,
        detail: Detail,
    ) -> Self {
        let (thresholds, starts) = (contacts.thresholds.as_ref(), starts.as_ref());
        let all = top(starts, detail.negligible);
        let top = if conditional { all.min(contacts.highest_start()) } else { all };
        let over = |r: f64| if conditional { thresholds.survival(r) } else { 1.0 };
        let atoms =
            starts.atoms().into_iter().map(|a| Atom { weight: a.weight / over(a.position), ..a }).collect();
        let hazards = with_atoms(thresholds);
        let (density, struck, points, narrow) = (Piecewise::default(), Vec::new(), Vec::new(), None);
        let fine = (CELL * scale(thresholds), CELL * scale(starts));
        let mut births = Self {
            thresholds,
            starts,
            conditional,
            detail,
            top,
            density,
            atoms,
            hazards,
            struck,
            fine,
            points,
            narrow,
        };
        births.struck = births.struck();
        if !starts.zones().is_empty() {
            let breaks: Vec<f64> = births.start_breaks().iter().map(|b| b.position).collect();
            let edges = edges(&starts.zones(), &breaks, top);
            births.density =
                Piecewise::resolve(|r| starts.density(r) / over(r), &edges, top, detail.resolution);
            if births.fine.0 < births.fine.1 {
                births.narrow = Some(births.threshold_density());
            } else {
                births.points = heavy(&births.density, &breaks, births.fine.0, detail.negligible);
            }
        }
        births
    }

    fn threshold_density(&self) -> (Piecewise, Vec<(f64, f64)>) {
        let density = resolved(self.thresholds, self.detail);
        let breaks: Vec<f64> = self.hazards.iter().map(|b| b.position).collect();
        let points = heavy(&density, &breaks, self.fine.1, self.detail.negligible);
        (density, points)
    }

    fn over(&self, r: f64) -> f64 {
        if self.conditional { self.thresholds.survival(r) } else { 1.0 }
    }

    fn struck(&self) -> Vec<(f64, Atom)> {
        let meets = |r: &Atom, b: &Break| {
            let met = Atom { position: b.position, weight: r.weight * b.amplitude };
            (b.position > r.position).then_some((b.position - r.position, met))
        };
        let walls: Vec<_> = self.hazards.iter().filter(|b| b.is_atom()).collect();
        let mut struck: Vec<_> =
            self.atoms.iter().flat_map(|r| walls.iter().filter_map(move |b| meets(r, b))).collect();
        struck.sort_by(|a, b| a.0.total_cmp(&b.0));
        struck
    }

    /// Breaks and atoms of ν: those of the starts, and those that dividing by S adds where thresholds overlap.
    fn start_breaks(&self) -> Vec<Break> {
        let scaled = |b: Break| Break { amplitude: b.amplitude / self.over(b.position), ..b };
        let mut breaks: Vec<_> = with_atoms(self.starts).into_iter().map(scaled).collect();
        if self.conditional {
            breaks.extend(self.hazards.iter().filter_map(|b| {
                let survival = self.thresholds.survival(b.position);
                let amplitude = b.amplitude * self.starts.density(b.position) / (survival * survival);
                let met = Break { exponent: b.exponent + 1.0, amplitude, ..*b };
                (survival > 0.0 && amplitude != 0.0).then_some(met)
            }));
        }
        breaks
    }

    /// Where a break or atom of P_c meets one of ν.
    fn meetings(&self) -> Vec<Break> {
        let starts = self.start_breaks();
        let meets = |b: &Break, r: &Break| Break { position: b.position - r.position, ..b.convolve(*r) };
        self.hazards.iter().flat_map(|b| starts.iter().map(move |r| meets(b, r))).collect()
    }

    /// Breaks and atoms of the breaking density continued to u < 0, as positions of −u, rising.
    pub(super) fn breaks_before(&self) -> Vec<Break> {
        let before = |met: Break| Break { position: -met.position, ..met };
        let mut out: Vec<_> = self.meetings().into_iter().map(before).collect();
        out.retain(|met| met.position >= 0.0);
        out.sort_by(|a, b| a.position.total_cmp(&b.position));
        out
    }

    /// Breaks and atoms of the breaking density: where one of P_c meets one of ν, and at u = 0.
    pub(super) fn breaks(&self) -> Vec<Break> {
        let mut out = self.meetings();
        out.retain(|met| met.position > 0.0 || met.position == 0.0 && !met.is_atom());
        let [first, ..] = self.breaking(0.0);
        if first > 0.0 && first.is_finite() && !out.iter().any(|b| b.position == 0.0) {
            out.push(Break { position: 0.0, exponent: 0.0, amplitude: first });
        }
        let unbroken = if self.conditional { 1.0 } else { self.mean(|x| self.thresholds.survival(x), 0.0) };
        if 1.0 - unbroken > self.detail.negligible {
            out.push(Atom { position: 0.0, weight: 1.0 - unbroken }.into());
        }
        out.sort_by(|a, b| a.position.total_cmp(&b.position));
        out
    }

    /// The advance after which nothing is left, nor of the second moment.
    pub(super) fn end(&self) -> f64 {
        let left = self.over(self.top);
        let mut last = top(self.thresholds, self.detail.negligible * left);
        let whole = self.thresholds.upper_moment(2, -1.0);
        while self.thresholds.upper_moment(2, last) > 1e-16 * left * whole {
            last *= 1.25;
        }
        last - self.starts.quantile(0.0)
    }

    /// Cell boundaries of the life to begin with: as narrow as P_c asks for, or as the starts that blur it.
    pub(super) fn edges(&self, breaks: &[Break], end: f64) -> Vec<f64> {
        self.edges_where(breaks, end, |(low, high)| (low, high))
    }

    /// The same for the continuation to u < 0, on [0, top] of −u.
    pub(super) fn edges_before(&self, breaks: &[Break]) -> Vec<f64> {
        self.edges_where(breaks, self.top, |(low, high)| (-high, -low))
    }

    fn edges_where(&self, breaks: &[Break], end: f64, place: impl Fn((f64, f64)) -> (f64, f64)) -> Vec<f64> {
        let bottom = self.starts.quantile(0.0);
        let blur = if self.atoms.is_empty() { self.fine.1 / CELL } else { 0.0 };
        let placed = |z: Zone| {
            let (low, high) = place((z.low - self.top, z.high - bottom));
            Zone { low, high, resolution: z.resolution.max(blur) }
        };
        let zones: Vec<Zone> = self.thresholds.zones().into_iter().map(placed).collect();
        let breaks: Vec<f64> = breaks.iter().map(|b| b.position).collect();
        edges(&zones, &breaks, end)
    }

    /// ∫ν(r) weight(r + u) dr, atoms included, weight smooth where P_c is.
    pub(super) fn mean(&self, weight: impl Fn(f64) -> f64, u: f64) -> f64 {
        let together: f64 = self.atoms.iter().map(|a| a.weight * weight(a.position + u)).sum();
        let mut spread = 0.0;
        let points = if self.points.is_empty() { &self.density.points(self.fine.0) } else { &self.points };
        let walls = self.hazards.iter().map(|b| b.position - u);
        each_point(&self.density, points, walls, self.fine.0, |r, w| spread += w * weight(r + u));
        together + spread
    }

    /// Moments of the stretches at which contacts break at the advance u, their density part.
    pub(super) fn breaking(&self, u: f64) -> [f64; MOMENTS] {
        let mut sums = [0.0; MOMENTS];
        let mut add = |x: f64, weight: f64| {
            let mut power = weight;
            for sum in &mut sums {
                *sum += power;
                power *= x;
            }
        };
        let law = self.thresholds;
        self.atoms.iter().for_each(|a| add(a.position + u, a.weight * law.density(a.position + u)));
        let walls = self.hazards.iter().filter(|b| b.is_atom());
        walls.for_each(|b| add(b.position, b.amplitude * self.density.value(b.position - u)));
        match &self.narrow {
            Some((density, points)) => {
                let edges = self.density.boundaries.iter().take(1).chain(self.density.boundaries.last());
                let cuts =
                    edges.copied().chain(self.starts.breaks().into_iter().map(|b| b.position)).map(|r| r + u);
                each_point(density, points, cuts, self.fine.1, |x, w| add(x, w * self.density.value(x - u)));
            }
            None => {
                let cuts = self.hazards.iter().map(|b| b.position - u);
                each_point(&self.density, &self.points, cuts, self.fine.0, |r, w| {
                    add(r + u, w * law.density(r + u))
                });
            }
        }
        sums
    }
}

/// The density of a law.
pub(super) fn resolved(law: &dyn Law, detail: Detail) -> Piecewise {
    let breaks: Vec<f64> = with_atoms(law).iter().map(|b| b.position).collect();
    let end = top(law, detail.negligible);
    let edges = edges(&law.zones(), &breaks, end);
    Piecewise::resolve(|x| law.density(x), &edges, end, detail.resolution)
}

/// Visits Gauss points of a density with their weights: the given ones, or others where `cuts` fall among its cells.
fn each_point(
    density: &Piecewise,
    points: &[(f64, f64)],
    cuts: impl Iterator<Item = f64>,
    widest: f64,
    mut visit: impl FnMut(f64, f64),
) {
    let (Some(&low), Some(&high)) = (density.boundaries.first(), density.boundaries.last()) else { return };
    let mut cuts: Vec<f64> = cuts.filter(|&x| x > low && x < high).collect();
    if cuts.is_empty() {
        return points.iter().for_each(|&(x, weight)| visit(x, weight));
    }
    cuts.extend_from_slice(&density.boundaries);
    cuts.sort_by(f64::total_cmp);
    for pair in cuts.windows(2).filter(|pair| pair[1] > pair[0]) {
        let parts = ((pair[1] - pair[0]) / widest).ceil().max(1.0);
        let half = 0.5 * (pair[1] - pair[0]) / parts;
        for k in 0..parts as usize {
            let middle = pair[0] + (2 * k + 1) as f64 * half;
            for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let x = middle + half * t;
                visit(x, half * w * density.value(x));
            }
        }
    }
}

/// Gauss points of a density that carry more than is negligible: its cells taken two by two where `breaks` allow, since a
/// rule exact to degree 31 integrates what a series of degree 15 interpolates on half the width.
fn heavy(density: &Piecewise, breaks: &[f64], widest: f64, negligible: f64) -> Vec<(f64, f64)> {
    let edges = &density.boundaries;
    let mut panels = vec![0.0];
    let mut k = 0;
    while k + 1 < edges.len() {
        let even = |k: usize| {
            edges
                .get(k + 2)
                .is_some_and(|b| ((b - edges[k + 1]) / (edges[k + 1] - edges[k]) - 1.0).abs() < 1e-6)
        };
        let whole = !breaks.iter().any(|&b| (b - edges[k + 1]).abs() < 1e-9 * edges[k + 1]);
        k += if even(k) && whole { 2 } else { 1 };
        panels.push(edges[k]);
    }
    let mut points = Vec::new();
    for pair in panels.windows(2) {
        let parts = ((pair[1] - pair[0]) / (2.0 * widest)).ceil().max(1.0);
        let half = 0.5 * (pair[1] - pair[0]) / parts;
        for k in 0..parts as usize {
            let middle = pair[0] + (2 * k + 1) as f64 * half;
            points.extend(RULE.nodes.iter().zip(&RULE.weights).map(|(t, w)| {
                let x = middle + half * t;
                (x, half * w * density.value(x))
            }));
        }
    }
    points.retain(|point| point.1 > negligible);
    points
}

/// The top of a law's support where it has one, else where S falls to `left`.
fn top(law: &dyn Law, left: f64) -> f64 {
    let end = law.upper_quantile(0.0);
    if end.is_finite() { end } else { law.upper_quantile(left) }
}

/// The least length on which a law's density varies.
fn scale(law: &dyn Law) -> f64 {
    law.zones()
        .iter()
        .map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)))
        .fold(f64::INFINITY, f64::min)
}

/// Width of the cells to begin with, in units of a zone's resolution: a Gaussian is then left out to 1e-14.
const CELL: f64 = 1.4;

/// Cell boundaries on [0, end] to begin with: the breaks, and cells as narrow as the zones that they lie in ask for.
fn edges(zones: &[Zone], breaks: &[f64], end: f64) -> Vec<f64> {
    let mut stops: Vec<f64> =
        zones.iter().flat_map(|z| [z.low, z.high]).chain(breaks.iter().copied()).collect();
    stops.retain(|&u| u > 0.0 && u < end);
    stops.push(end);
    stops.sort_by(f64::total_cmp);
    let mut edges = vec![0.0];
    for stop in stops {
        let at = edges[edges.len() - 1];
        let over = zones.iter().filter(|z| z.low < stop && z.high > at);
        let Some(resolution) = over.map(|z| z.resolution).reduce(f64::min) else {
            // A long tail, if anything: it varies on the scale of its distance.
            edges.extend(
                std::iter::successors(Some(2.0 * at), |u| Some(2.0 * u))
                    .take_while(|&u| at > 0.0 && u < stop),
            );
            edges.push(stop);
            continue;
        };
        let count = ((stop - at) / (CELL * resolution) - 1e-9).ceil().max(1.0);
        let inner = (1..count as usize).map(|k| at + (stop - at) * k as f64 / count);
        edges.extend(inner.chain([stop]));
    }
    edges
}

/// Atoms of a law, and its breaks where they are more than nothing.
pub(super) fn with_atoms(law: &dyn Law) -> Vec<Break> {
    const NOTHING: f64 = 1e-40;
    let mean = law.mean();
    let breaks = law.breaks().into_iter().filter(|b| b.weight(mean) * mean > NOTHING);
    breaks.chain(law.atoms().into_iter().map(Break::from)).collect()
}
