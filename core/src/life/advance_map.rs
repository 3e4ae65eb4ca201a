//! The map of advances that follows the points at which the life of contacts is not smooth.

use super::Life;
use crate::numerics::breakpoints::Breakpoint;

/// A continuous map from the advances of one life to those of another one of nearly the same contacts.
///
/// It takes the points at which the one is not smooth to those of the other, is linear between them and a shift after the
/// last. In coordinates that move with these points, survival and force are smooth functions of a parameter of the contacts; at
/// fixed advances they are not where such a point passes.
#[derive(Debug, Clone, Default)]
pub(crate) struct AdvanceMap {
    points: Vec<(f64, f64)>,
}

/// Points nearer to each other than this fraction of the longest life are one.
const ONE: f64 = 1e-9;

impl AdvanceMap {
    /// The maps from a life to those with a larger and a smaller value of a parameter; `None` where their points do not
    /// correspond, or come so near to each other that an interval between them would be distorted.
    pub(crate) fn between(life: &Life, varied: [&Life; 2]) -> Option<[Self; 2]> {
        /// Largest departure from motion in proportion to the parameter, as a fraction of the motion: points that pass each
        /// other are sorted again, so that each seems to turn back.
        const BENT: f64 = 0.1;
        /// Motion that is rounding, as a fraction of the mean life.
        const STILL: f64 = 1e-8;
        let from = points(life, FAINT);
        let [above, below] = varied.map(|life| points(life, FAINT));
        if above.len() != from.len() || below.len() != from.len() {
            return None;
        }
        let straight = |((from, above), below): ((&f64, &f64), &f64)| {
            let bend = (above + below - 2.0 * from).abs();
            bend <= BENT * (above - below).abs() + STILL * life.mean()
        };
        if !from.iter().zip(&above).zip(&below).all(straight) {
            return None;
        }
        let of = |to: &[f64]| {
            let pairs = from.iter().copied().zip(to.iter().copied());
            Self { points: std::iter::once((0.0, 0.0)).chain(pairs).collect() }
        };
        let maps = [of(&above), of(&below)];
        /// Largest relative stretching of an interval.
        const STRETCHED: f64 = 0.3;
        maps.iter().all(|map| map.stretching() <= STRETCHED).then_some(maps)
    }

    /// The advance of the other life.
    pub(crate) fn at(&self, advance: f64) -> f64 {
        let next = self.points.partition_point(|point| point.0 <= advance);
        let Some(&(from, to)) = next.checked_sub(1).and_then(|last| self.points.get(last)) else {
            return advance;
        };
        let slope = self.points.get(next).map_or(1.0, |next| (next.1 - to) / (next.0 - from));
        to + (advance - from) * slope
    }

    /// The largest relative change of the length of an interval.
    pub(crate) fn stretching(&self) -> f64 {
        let change = |ends: &[(f64, f64)]| ((ends[1].1 - ends[0].1) / (ends[1].0 - ends[0].0) - 1.0).abs();
        self.points.windows(2).map(change).fold(0.0, f64::max)
    }
}

/// Breakpoints that no result shows, relative to survival.
pub(crate) const FAINT: f64 = 1e-11;

/// The advances above 0 at which survival or force are not smooth, in order, but for what is as `faint`.
pub(crate) fn points(life: &Life, faint: f64) -> Vec<f64> {
    let mean = life.mean();
    let shows = |b: &&Breakpoint, size: f64| b.position > 0.0 && b.weight(mean) > faint * size;
    let force = life.force().curve().integral() / mean;
    let of_survival = life.survival().breakpoints().iter().filter(|b| shows(b, 1.0));
    let of_force = life.kinks_of_stiffness();
    let of_force = of_force.iter().filter(|b| shows(b, force));
    let mut out: Vec<f64> = of_survival.chain(of_force).map(|b| b.position).collect();
    out.sort_by(f64::total_cmp);
    let least = ONE * life.survival().curve().end();
    out.dedup_by(|next, kept| *next - *kept <= least);
    out.retain(|&position| position > least);
    out
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::Contacts;
    use crate::law::{Mixture, Point, Rectangular, SharedLaw};
    use crate::life::athermal;

    fn life(thresholds: SharedLaw) -> Life {
        let zero: SharedLaw = Arc::new(Point::new(0.0).unwrap());
        athermal(&Contacts::new(thresholds, zero.clone()), &zero, true, &mut ()).unwrap()
    }

    fn rectangular(min: f64, max: f64) -> SharedLaw {
        Arc::new(Rectangular::new(min, max).unwrap())
    }

    #[test]
    fn edges_are_taken_to_edges() {
        let [base, above, below] = [1.5, 1.53, 1.47].map(|max| life(rectangular(0.5, max)));
        let [map, _] = AdvanceMap::between(&base, [&above, &below]).unwrap();
        for (from, to) in [(0.0, 0.0), (0.25, 0.25), (0.5, 0.5), (1.0, 1.015), (1.5, 1.53), (2.0, 2.03)] {
            // Rounding.
            assert!((map.at(from) - to).abs() < 1e-14, "{from}: {}", map.at(from));
        }
        assert!((map.stretching() - 0.03).abs() < 1e-13);
    }

    #[test]
    fn edges_that_pass_each_other_have_no_map() {
        let with = |max: f64| {
            let parts = vec![(0.5, rectangular(0.5, max)), (0.5, rectangular(0.6, 1.0))];
            life(Arc::new(Mixture::new(parts).unwrap()))
        };
        for max in [1.0, 1.005] {
            let [base, above, below] = [max, max + 0.02, max - 0.02].map(with);
            assert!(AdvanceMap::between(&base, [&above, &below]).is_none());
        }
        let [base, above, below] = [0.8, 0.82, 0.78].map(with);
        assert!(AdvanceMap::between(&base, [&above, &below]).is_some());
    }
}
