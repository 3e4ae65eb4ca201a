//! Cells to begin with: where a law's density is to be looked for, and how finely.

use crate::law::{Breakpoint, Law, Zone};
use crate::numerics::piecewise::{Piecewise, Resolution};

/// What a curve leaves out, of a total of 1 (or of the mean life, force, …).
pub(super) const RESOLUTION: f64 = 1e-14;

/// What some ten cells, each resolved to that, leave out together.
pub(super) const ROUNDING: f64 = 1e-13;

/// Survival and starting mass below this are left out.
pub(super) const NEGLIGIBLE: f64 = 1e-18;

/// How closely starts and what breaks are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    pub(super) resolution: Resolution,
    /// Survival and starting mass below this are left out.
    pub(super) negligible: f64,
}

/// Curves of a total of 1 (or of the mean life, force, …).
pub(super) const BULK: Detail = Detail { resolution: Resolution::Mean(RESOLUTION), negligible: NEGLIGIBLE };

impl Detail {
    /// Tails as well, each cell to 1e-13 of itself down to what is negligible.
    pub(super) const fn tails(negligible: f64) -> Self {
        Self { resolution: Resolution::Relative { fraction: 1e-13, negligible }, negligible }
    }

    /// Low tails as well, each cell to 1e-13 of all that lies below its end, down to what is negligible.
    pub(super) const fn low_tails(negligible: f64) -> Self {
        Self { resolution: Resolution::Cumulative { fraction: 1e-13, negligible }, negligible }
    }

    /// Where cells have to end: across its seams a density is not itself to 1e-13.
    pub(super) fn seams(self, law: &dyn Law) -> Vec<f64> {
        match self.resolution {
            Resolution::Mean(_) => Vec::new(),
            Resolution::Relative { .. } | Resolution::Cumulative { .. } => law.seams(),
        }
    }
}

/// Width of the cells to begin with, in units of a zone's resolution.
pub(super) const CELL: f64 = Zone::CELL;

/// Where a smooth curve begins or ends, breaks are told of this many derivatives, the value among them.
pub(crate) const ORDERS: usize = 4;

/// The top of a law's support where it has one, else where S falls to `left`.
pub(super) fn top(law: &dyn Law, left: f64) -> f64 {
    let end = law.upper_quantile(0.0);
    if end.is_finite() { end } else { law.upper_quantile(left) }
}

/// The least length on which a law's density varies.
pub(super) fn scale(law: &dyn Law) -> f64 {
    law.zones()
        .iter()
        .map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)))
        .fold(f64::INFINITY, f64::min)
}

/// Cell boundaries on [0, end] to begin with: the breaks, and cells as narrow as the zones that they lie in ask for.
pub(super) fn edges(zones: &[Zone], breakpoints: &[f64], end: f64) -> Vec<f64> {
    let mut stops: Vec<f64> =
        zones.iter().flat_map(|z| [z.low, z.high]).chain(breakpoints.iter().copied()).collect();
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

/// The density of a law.
pub(super) fn resolved(law: &dyn Law, detail: Detail) -> Piecewise {
    let breakpoints = with_atoms(law).into_iter().map(|b| b.position);
    let stops: Vec<f64> = breakpoints.chain(detail.seams(law)).collect();
    let end = top(law, detail.negligible);
    let edges = edges(&law.zones(), &stops, end);
    Piecewise::resolve(|x| law.density(x), &edges, end, detail.resolution)
}

/// Atoms of a law, and its breaks where they are more than nothing.
pub(super) fn with_atoms(law: &dyn Law) -> Vec<Breakpoint> {
    const NOTHING: f64 = 1e-40;
    let mean = law.mean();
    let breakpoints = law.breakpoints().into_iter().filter(|b| b.weight(mean) * mean > NOTHING);
    breakpoints.chain(law.atoms().into_iter().map(Breakpoint::from)).collect()
}

/// Thresholds that many share: the atoms of a law.
pub(crate) fn walls(law: &dyn Law) -> Vec<f64> {
    law.atoms().iter().map(|a| a.position).collect()
}
