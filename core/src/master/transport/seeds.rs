//! A law of stretches at which contacts start, as cells that each hold a share of them.

use super::panels::panels;
use crate::law::{Atom, Law};

/// Contacts that start together: a share at a stretch, spread evenly over a cell around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seed {
    pub(super) stretch: f64,
    pub(super) weight: f64,
    /// How far the cell reaches below the stretch …
    pub(super) below: f64,
    /// … and above it; both 0 for a point mass.
    pub(super) above: f64,
}

/// Shares below this are left to the others.
const NEGLIGIBLE: f64 = 1e-14;

/// The seeds of a law below `top`, in panels no wider than `widest`, each weighted by `held` at its stretch.
///
/// Cells of a panel end at the partial sums of the Gauss weights, between which the points lie (P. L. Chebyshev,
/// A. A. Markov and T. J. Stieltjes).
pub(super) fn seeds(law: &dyn Law, top: f64, widest: f64, held: impl Fn(f64) -> f64) -> Vec<Seed> {
    let lump = |a: Atom| Seed { stretch: a.position, weight: a.weight, below: 0.0, above: 0.0 };
    let mut seeds: Vec<Seed> = law.atoms().into_iter().map(lump).collect();
    for panel in panels(law, widest) {
        let mut edge = panel.low;
        for (stretch, width) in panel.points() {
            let (below, above) = (stretch - edge, edge + width - stretch);
            seeds.push(Seed { stretch, weight: width * law.density(stretch), below, above });
            edge += width;
        }
    }
    seeds.retain(|seed| seed.stretch < top && seed.weight > NEGLIGIBLE);
    let whole: f64 = seeds.iter().map(|seed| seed.weight).sum();
    seeds.iter_mut().for_each(|seed| seed.weight *= held(seed.stretch) / whole);
    seeds.retain(|seed| seed.weight > 0.0);
    seeds
}
