//! Panels on which a 16-point Gauss rule integrates a distribution to rounding.

use super::{Law, Zone};

/// Number of factors e over which tails are resolved: down to 1e-20.
const FOLDS: u32 = 46;

/// Panel boundaries by rising x: breakpoints, point masses, piece boundaries, the points at which either tail
/// has fallen by another factor e, and cells of the zones. No two neighbours above 0 differ by more than a
/// factor of 2.
pub(super) fn panel_boundaries(law: &dyn Law) -> Vec<f64> {
    let tails = (0..FOLDS).map(|j| 0.5 * (-f64::from(j)).exp());
    let mut boundaries: Vec<f64> =
        tails.flat_map(|tail| [law.quantile(tail), law.upper_quantile(tail)]).collect();
    boundaries.extend(law.breakpoints().into_iter().map(|b| b.position));
    boundaries.extend(law.atoms().into_iter().map(|atom| atom.position));
    boundaries.extend(law.seams());
    boundaries.extend(law.zones().into_iter().flat_map(cells));
    boundaries.sort_by(f64::total_cmp);
    boundaries.dedup();
    let mut panels: Vec<f64> = Vec::with_capacity(boundaries.len());
    for boundary in boundaries {
        // Densities may vary as a power of x.
        while panels.last().is_some_and(|&last| last > 0.0 && boundary > 2.0 * last) {
            panels.push(2.0 * panels[panels.len() - 1]);
        }
        panels.push(boundary);
    }
    panels
}

/// Boundaries of cells of a zone that 16 terms resolve.
fn cells(zone: Zone) -> impl Iterator<Item = f64> {
    let count = ((zone.high - zone.low) / (Zone::CELL * zone.resolution)).ceil().max(1.0);
    (0..=count as usize).map(move |k| zone.low + (zone.high - zone.low) * (k as f64 / count))
}
