//! Which newborn thresholds a growing stretch has met, while thresholds change with age.

use crate::contacts::ThresholdEvolution;
use crate::numerics::roots::brent_root;

/// The newborn thresholds met by contacts formed at a stretch r and moved at the velocity v: those up to
/// y(u) = max_{u' ≤ u} h_0(r + u'; u'/v), where h_0(x; t) is the newborn threshold of a contact whose threshold is x at
/// the age t.
///
/// Where thresholds grow faster than the stretch, h_0 falls and nothing is met, until it is back where it was: a lull.
#[derive(Debug, Clone)]
pub(super) struct RunningMaximum {
    strength: ThresholdEvolution,
    velocity: f64,
    start: f64,
    lulls: Vec<Lull>,
}

#[derive(Debug, Clone, Copy)]
struct Lull {
    from: f64,
    to: f64,
    /// y.
    met: f64,
}

/// Advances at which y is looked at grow by this factor.
const STEP: f64 = 1.2;

impl RunningMaximum {
    /// The record of contacts formed at `start`; newborn thresholds above `highest` are of no interest.
    pub(super) fn new(strength: &ThresholdEvolution, velocity: f64, start: f64, highest: f64) -> Self {
        let mut record = Self { strength: strength.clone(), velocity, start, lulls: Vec::new() };
        if !strength.is_constant() {
            record.lulls = record.lulls(highest);
        }
        record
    }

    /// y(u).
    pub(super) fn met(&self, advance: f64) -> f64 {
        self.lull(advance).map_or_else(|| self.newborn(advance), |lull| lull.met)
    }

    /// y and dy/du, which is 0 in a lull.
    pub(super) fn reach(&self, advance: f64) -> (f64, f64) {
        self.lull(advance).map_or_else(|| self.meeting_at(advance), |lull| (lull.met, 0.0))
    }

    /// The advance at which a newborn threshold above the start is met; `None` where that is beyond all measure.
    pub(super) fn meeting(&self, newborn: f64) -> Option<f64> {
        if self.strength.is_constant() {
            return Some(newborn - self.start);
        }
        let mut high = newborn;
        while self.met(high) < newborn {
            high *= 2.0;
            if !high.is_finite() {
                return None;
            }
        }
        let beyond = self.lulls.iter().filter(|lull| lull.met < newborn).map(|lull| lull.to);
        let low = beyond.fold(0.0, f64::max);
        brent_root(|u| self.met(u) - newborn, low, high, 0.0)
    }

    /// Advances at which a lull begins or ends.
    pub(super) fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.lulls.iter().flat_map(|lull| [lull.from, lull.to])
    }

    fn lull(&self, advance: f64) -> Option<&Lull> {
        self.lulls.iter().find(|lull| advance >= lull.from && advance < lull.to)
    }

    /// h_0(r + u; u/v).
    fn newborn(&self, advance: f64) -> f64 {
        self.strength.newborn(self.start + advance, advance / self.velocity)
    }

    /// h_0 and its slope, with u.
    fn meeting_at(&self, advance: f64) -> (f64, f64) {
        let met = self.strength.at(advance / self.velocity).contact_at(self.start + advance);
        (met.newborn, (1.0 - met.drift / self.velocity) / met.spread)
    }

    fn lulls(&self, highest: f64) -> Vec<Lull> {
        let mut found = Vec::new();
        let mut before = 0.0;
        let slope = |advance: f64| self.meeting_at(advance).1;
        let mut open = (slope(0.0) < 0.0).then_some((0.0, self.start));
        let mut at = (self.velocity * self.strength.soon()).clamp(1e-12 * highest, highest);
        while at.is_finite() {
            let (here, pace) = self.meeting_at(at);
            match open {
                None if pace < 0.0 => {
                    let from = brent_root(slope, before, at, 0.0).unwrap_or(before);
                    open = Some((from, self.newborn(from)));
                }
                Some((from, met)) if here > met => {
                    let to = brent_root(|u| self.newborn(u) - met, before, at, 0.0).unwrap_or(at);
                    found.push(Lull { from, to, met });
                    open = None;
                }
                _ if here > highest => break,
                _ => {}
            }
            before = at;
            at *= STEP;
        }
        found
    }
}
