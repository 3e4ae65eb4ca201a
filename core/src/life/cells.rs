//! Initial cells of curves: where a distribution is not negligible, and on which scale it varies.

use crate::law::{Breakpoint, Law, Zone};
use crate::numerics::piecewise::{Piecewise, Resolution};

/// Tolerance of a curve of total 1 (or of the mean life, force, …).
pub(super) const RESOLUTION: f64 = 1e-14;

/// Error of some ten cells of that tolerance together.
pub(super) const ROUNDING: f64 = 1e-13;

/// Survival and starting mass below this are neglected.
pub(super) const NEGLIGIBLE: f64 = 1e-18;

/// Tolerances for starts and breaking densities.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    pub(super) resolution: Resolution,
    /// Survival and starting mass below this are neglected.
    pub(super) negligible: f64,
}

/// For curves of a total of 1 (or of the mean life, force, …).
pub(super) const BULK: Detail = Detail { resolution: Resolution::Mean(RESOLUTION), negligible: NEGLIGIBLE };

impl Detail {
    /// With tails: each cell has a relative accuracy of 1e-13 down to what is negligible.
    pub(super) const fn tails(negligible: f64) -> Self {
        Self { resolution: Resolution::Relative { fraction: 1e-13, negligible }, negligible }
    }

    /// With low tails: each cell is accurate to 1e-13 of the integral up to its end, down to what is
    /// negligible.
    pub(super) const fn low_tails(negligible: f64) -> Self {
        Self { resolution: Resolution::Cumulative { fraction: 1e-13, negligible }, negligible }
    }

    /// Where cells have to end: across a piece boundary a density is not smooth to 1e-13.
    pub(super) fn seams(self, law: &dyn Law) -> Vec<f64> {
        match self.resolution {
            Resolution::Mean(_) => Vec::new(),
            Resolution::Relative { .. } | Resolution::Cumulative { .. } => law.seams(),
        }
    }
}

/// Initial width of cells, in units of the resolution of a zone.
pub(super) const CELL: f64 = Zone::CELL;

/// Number of derivatives, the value included, whose jumps are kept where a smooth curve begins or ends.
pub(crate) const ORDERS: usize = 4;

/// The upper end of a support, or the quantile at which S falls to `left`.
pub(super) fn top(law: &dyn Law, left: f64) -> f64 {
    let end = law.upper_quantile(0.0);
    if end.is_finite() { end } else { law.upper_quantile(left) }
}

/// The smallest length on which a density varies.
pub(super) fn scale(law: &dyn Law) -> f64 {
    law.zones()
        .iter()
        .map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)))
        .fold(f64::INFINITY, f64::min)
}

/// Initial cell boundaries on [0, end]: the breakpoints, and cells as narrow as their zones require.
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

/// Point masses of a distribution, and those of its breakpoints that are not negligible.
pub(super) fn with_atoms(law: &dyn Law) -> Vec<Breakpoint> {
    const NOTHING: f64 = 1e-40;
    let mean = law.mean();
    let breakpoints = law.breakpoints().into_iter().filter(|b| b.weight(mean) * mean > NOTHING);
    breakpoints.chain(law.atoms().into_iter().map(Breakpoint::from)).collect()
}

/// Positions of the point masses of a distribution of thresholds.
pub(crate) fn threshold_atoms(law: &dyn Law) -> Vec<f64> {
    law.atoms().iter().map(|a| a.position).collect()
}
