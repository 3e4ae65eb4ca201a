//! Places along a law between which 16 Gauss points follow it.

use super::{Law, Zone};

/// Folds by e that tails are followed over: down to 1e-20.
const FOLDS: u32 = 46;

/// Places by rising x: where the law is not smooth, where either tail has fallen by e, cells of its zones; no two
/// neighbours above 0 a factor of more than 2 apart.
pub(super) fn places(law: &dyn Law) -> Vec<f64> {
    let tails = (0..FOLDS).map(|j| 0.5 * (-f64::from(j)).exp());
    let mut ends: Vec<f64> = tails.flat_map(|tail| [law.quantile(tail), law.upper_quantile(tail)]).collect();
    ends.extend(law.breakpoints().into_iter().map(|b| b.position));
    ends.extend(law.atoms().into_iter().map(|atom| atom.position));
    ends.extend(law.seams());
    ends.extend(law.zones().into_iter().flat_map(cells));
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let mut places: Vec<f64> = Vec::with_capacity(ends.len());
    for end in ends {
        while places.last().is_some_and(|&last| last > 0.0 && end > 2.0 * last) {
            places.push(2.0 * places[places.len() - 1]);
        }
        places.push(end);
    }
    places
}

/// The boundaries of cells of a zone that 16 terms resolve.
fn cells(zone: Zone) -> impl Iterator<Item = f64> {
    let count = ((zone.high - zone.low) / (Zone::CELL * zone.resolution)).ceil().max(1.0);
    (0..=count as usize).map(move |k| zone.low + (zone.high - zone.low) * (k as f64 / count))
}
