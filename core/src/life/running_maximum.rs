//! The running maximum of the fresh thresholds that a growing stretch has reached, while thresholds change
//! with age.

use crate::contacts::ThresholdEvolution;
use crate::numerics::roots::brent_root;

/// For contacts formed at stretch r and moved at velocity v: those with fresh thresholds up to y(u) = max_{u'
/// ≤ u} h_0(r + u'; u'/v) have broken, where h_0(x; t) is the fresh threshold of a contact whose threshold is
/// x at age t.
///
/// Where thresholds grow faster than the stretch, h_0 falls and nothing breaks until it has returned to its
/// maximum: a pause.
#[derive(Debug, Clone)]
pub(super) struct RunningMaximum {
    evolution: ThresholdEvolution,
    velocity: f64,
    start: f64,
    pauses: Vec<Pause>,
}

/// An interval without breaking.
#[derive(Debug, Clone, Copy)]
struct Pause {
    from: f64,
    to: f64,
    /// y.
    value: f64,
}

/// Factor between the advances at which y is evaluated.
const STEP: f64 = 1.2;

impl RunningMaximum {
    /// The running maximum for contacts formed at `start`, for fresh thresholds up to `highest`.
    pub(super) fn new(evolution: &ThresholdEvolution, velocity: f64, start: f64, highest: f64) -> Self {
        let mut record = Self { evolution: evolution.clone(), velocity, start, pauses: Vec::new() };
        if !evolution.is_constant() {
            record.pauses = record.pauses(highest);
        }
        record
    }

    /// y(u).
    pub(super) fn value(&self, advance: f64) -> f64 {
        self.pause(advance).map_or_else(|| self.fresh(advance), |pause| pause.value)
    }

    /// y and dy/du, which is 0 in a pause.
    pub(super) fn value_and_slope(&self, advance: f64) -> (f64, f64) {
        self.pause(advance).map_or_else(|| self.fresh_and_slope(advance), |pause| (pause.value, 0.0))
    }

    /// y and (∂h/∂t)/(v ∂h/∂h_0), the part of dy/du that ageing takes away; 0 in a pause.
    pub(super) fn value_and_loss(&self, advance: f64) -> (f64, f64) {
        if let Some(pause) = self.pause(advance) {
            return (pause.value, 0.0);
        }
        let contact = self.evolution.at(advance / self.velocity).contact_at(self.start + advance);
        (contact.fresh, contact.drift / (self.velocity * contact.spread))
    }

    /// The fresh thresholds between whose breaks there is a pause.
    pub(super) fn interruptions(&self) -> impl Iterator<Item = f64> + '_ {
        self.pauses.iter().filter(|pause| pause.from > 0.0).map(|pause| pause.value)
    }

    /// The advance at which a fresh threshold above the start is reached; `None` if that is beyond the range
    /// of numbers.
    pub(super) fn advance_to(&self, fresh: f64) -> Option<f64> {
        if self.evolution.is_constant() {
            return Some(fresh - self.start);
        }
        let mut high = fresh;
        while self.value(high) < fresh {
            high *= 2.0;
            if !high.is_finite() {
                return None;
            }
        }
        // In a pause y is constant, which leaves a root undefined: the search begins after the last
        // one below the threshold.
        let beyond = self.pauses.iter().filter(|pause| pause.value < fresh).map(|pause| pause.to);
        let low = beyond.fold(0.0, f64::max);
        // Rounding may put the end of a pause above the threshold.
        Some(brent_root(|u| self.value(u) - fresh, low, high, 0.0).unwrap_or(low))
    }

    /// Advances at which a pause begins or ends.
    pub(super) fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.pauses.iter().flat_map(|pause| [pause.from, pause.to])
    }

    fn pause(&self, advance: f64) -> Option<&Pause> {
        self.pauses.iter().find(|pause| advance >= pause.from && advance < pause.to)
    }

    /// h_0(r + u; u/v).
    fn fresh(&self, advance: f64) -> f64 {
        self.evolution.fresh(self.start + advance, advance / self.velocity)
    }

    /// h_0 and its derivative with respect to u.
    fn fresh_and_slope(&self, advance: f64) -> (f64, f64) {
        let value = self.evolution.at(advance / self.velocity).contact_at(self.start + advance);
        (value.fresh, (1.0 - value.drift / self.velocity) / value.spread)
    }

    fn pauses(&self, highest: f64) -> Vec<Pause> {
        let mut found = Vec::new();
        let mut before = 0.0;
        let slope = |advance: f64| self.fresh_and_slope(advance).1;
        let mut open = (slope(0.0) < 0.0).then_some((0.0, self.start));
        let mut at = (self.velocity * self.evolution.soon()).clamp(1e-12 * highest, highest);
        while at.is_finite() {
            let (here, pace) = self.fresh_and_slope(at);
            // A pause opens where h_0 starts to fall and closes where it exceeds its old maximum.
            match open {
                None if pace < 0.0 => {
                    let from = brent_root(slope, before, at, 0.0).unwrap_or(before);
                    open = Some((from, self.fresh(from)));
                }
                Some((from, value)) if here > value => {
                    let to = brent_root(|u| self.fresh(u) - value, before, at, 0.0).unwrap_or(at);
                    found.push(Pause { from, to, value });
                    open = None;
                }
                _ if here > highest => break,
                _ => {}
            }
            before = at;
            // Steps grow geometrically: ageing laws vary on the scale of the age itself, and pauses
            // may begin at any of many orders of magnitude.
            at *= STEP;
        }
        found
    }
}
