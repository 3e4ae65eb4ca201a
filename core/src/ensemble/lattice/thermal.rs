//! Thermal breaking of a contact whose stretch grows at a constant velocity below a constant threshold: its cumulative
//! hazard in closed form, and the stretch at which that reaches a value.

use std::sync::LazyLock;

use crate::contacts::{Barrier, Temperature};
use crate::numerics::incomplete::{cubic, dawson_by_table};

/// Thermal breaking of contacts of one stiffness.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThermalActivation {
    pub(super) temperature: Temperature,
    pub(super) stiffness: f64,
}

/// A contact of threshold h at the velocity v. Its cumulative hazard is
///
/// A(x) = (1/v) ∫^x w dξ = (ωs/v) G(x) e^{−ΔE(x)/T},
///
/// with s and G of the barrier ([`Barrier::integral_length`]) for x ≥ 0, and continued to x < 0 by the symmetry of w.
#[derive(Debug, Clone, Copy)]
pub(super) struct CumulativeHazard {
    barrier: Barrier,
    threshold: f64,
    /// E_0/T.
    whole: f64,
    /// s.
    length: f64,
    /// ωs/v.
    attempts: f64,
}

/// A contact that breaks nearer to its threshold than by this fraction breaks at it: cold contacts, but for rounding.
const ROUNDING: f64 = 1e-14;

/// Largest number of Newton steps; one or two are taken.
const MOST_STEPS: usize = 50;

/// Relative change after which a Newton step is the last: the method converges quadratically.
const CONVERGED: f64 = 1e-7;

impl ThermalActivation {
    /// w, the rate of breaking at rest.
    pub(super) fn rate(&self, stretch: f64, threshold: f64) -> f64 {
        self.temperature.rate(stretch, threshold, self.stiffness)
    }

    /// The cumulative hazard of a contact with this threshold.
    #[inline]
    pub(super) fn at(&self, threshold: f64, velocity: f64) -> CumulativeHazard {
        let Temperature { energy, attempt_rate, barrier, .. } = self.temperature;
        // For tiny thresholds it would round to 0.
        let whole = (0.5 * self.stiffness * threshold * threshold / energy).max(f64::MIN_POSITIVE);
        let length = barrier.integral_length(threshold, whole);
        CumulativeHazard { barrier, threshold, whole, length, attempts: attempt_rate * length / velocity }
    }
}

impl CumulativeHazard {
    /// A(x).
    #[inline]
    pub(super) fn value(&self, stretch: f64) -> f64 {
        if stretch < 0.0 { 2.0 * self.right(0.0) - self.right(-stretch) } else { self.right(stretch) }
    }

    /// A(x) for x ≥ 0.
    #[inline]
    fn right(&self, stretch: f64) -> f64 {
        let gain = self.barrier.integral_factor(stretch, self.threshold, self.length);
        self.attempts * gain * (-self.whole * self.barrier.height_at(stretch, self.threshold)).exp()
    }

    /// The x at which A(x) = `value`; infinite if that is not below the threshold, but for rounding.
    #[inline]
    pub(super) fn stretch(&self, value: f64) -> f64 {
        let least = if self.barrier == Barrier::Elastic { 0.0 } else { self.right(0.0) };
        if value < least || value < 0.0 {
            return -self.right_stretch(2.0 * least - value);
        }
        self.right_stretch(value)
    }

    /// The same for x ≥ 0, from ln(A v/ωs), which neither overflows nor underflows.
    #[inline]
    fn right_stretch(&self, value: f64) -> f64 {
        let Self { threshold, whole, length, attempts, .. } = *self;
        let level = (value / attempts).ln();
        let stretch = match self.barrier {
            Barrier::Elastic => length * inverse_of_dawson(level + whole),
            Barrier::Bell => threshold * (1.0 + level / whole),
            Barrier::Catastrophe => threshold - length * inverse_of_cubic(level),
        };
        if stretch < threshold * (1.0 - ROUNDING) { stretch.max(0.0) } else { f64::INFINITY }
    }
}

/// A function of which values and derivatives are known on an even grid, by cubic Hermite interpolation.
struct HermiteTable {
    from: f64,
    to: f64,
    /// Values, and derivatives times the step.
    nodes: Vec<[f64; 2]>,
}

/// Steps of a table per unit: it then is right to 1e-7, and one Newton step from there to rounding.
const STEPS: f64 = 16.0;

impl HermiteTable {
    /// Tabulates a function from its value and derivative.
    fn of(from: f64, to: f64, f: impl Fn(f64) -> [f64; 2]) -> Self {
        let node = |i: usize| {
            let [value, slope] = f((from + i as f64 / STEPS).min(to));
            [value, slope / STEPS]
        };
        let steps = ((to - from) * STEPS) as usize;
        Self { from, to: from + steps as f64 / STEPS, nodes: (0..=steps).map(node).collect() }
    }

    /// The function; `None` outside of the table.
    #[inline]
    fn value(&self, x: f64) -> Option<f64> {
        if !(x >= self.from && x < self.to) {
            return None;
        }
        let place = (x - self.from) * STEPS;
        let (i, t) = (place as usize, place.fract());
        let ([a, da], [b, db]) = (self.nodes[i], self.nodes[i + 1]);
        let (up, down) = (b - a - da, db - (b - a));
        Some(a + t * (da + t * (up + (t - 1.0) * (down - up))))
    }
}

/// ξ by ln ∫₀^ξ e^{s²} ds.
static DAWSON_INVERSE: LazyLock<HermiteTable> = LazyLock::new(|| {
    HermiteTable::of(-3.0, 60.0, |level| {
        let x = dawson_root(level, if level < 1.0 { level.exp().min(1.0) } else { far_dawson(level) });
        [x, dawson_by_table(x)]
    })
});

/// w by ln ∫_w^∞ e^{−s^{3/2}} ds.
static CUBIC_INVERSE: LazyLock<HermiteTable> = LazyLock::new(|| {
    let whole = cubic(0.0);
    HermiteTable::of(-60.0, whole.ln(), |level| {
        let w = cubic_root(level, if level < -1.0 { far_cubic(level) } else { whole - level.exp() });
        [w, -cubic(w.sqrt())]
    })
});

/// The ξ at which ln ∫₀^ξ e^{s²} ds = ξ² + ln D(ξ) is `level`.
#[inline]
fn inverse_of_dawson(level: f64) -> f64 {
    // The integral is ξ + ξ³/3 near 0, and e^{ξ²}/2ξ far out.
    let start = DAWSON_INVERSE.value(level).unwrap_or_else(|| {
        let near = level.exp();
        if level < 0.0 { near * (1.0 - near * near / 3.0) } else { far_dawson(level) }
    });
    dawson_root(level, start)
}

/// The same far out.
fn far_dawson(level: f64) -> f64 {
    (level + 0.5 * (4.0 * level).ln_1p()).sqrt()
}

/// The same by Newton's method from `x`.
#[inline]
fn dawson_root(level: f64, mut x: f64) -> f64 {
    for _ in 0..MOST_STEPS {
        let dawson = dawson_by_table(x);
        let step = dawson * (level - x * x - dawson.ln());
        x = (x + step).max(0.25 * x);
        if step.is_nan() || step.abs() <= CONVERGED * x {
            break;
        }
    }
    x
}

/// The w ≥ 0 at which ln ∫_w^∞ e^{−s^{3/2}} ds = ln g(√w) − w^{3/2} is `level`; below 0 if there is none.
#[inline]
fn inverse_of_cubic(level: f64) -> f64 {
    // The integral is g(0) − w near 0, and ⅔e^{−w^{3/2}}/√w far out.
    match CUBIC_INVERSE.value(level) {
        Some(start) => cubic_root(level, start),
        None if level < CUBIC_INVERSE.from => cubic_root(level, far_cubic(level)),
        None if level < cubic(0.0).ln() => cubic_root(level, cubic(0.0) - level.exp()),
        None => -1.0,
    }
}

/// The same far out.
fn far_cubic(level: f64) -> f64 {
    (-level - (1.5 * (-level).cbrt()).ln()).max(0.1).cbrt().powi(2)
}

/// The same by Newton's method from `w`; the logarithm is concave, so that all iterates but the first lie above the root.
#[inline]
fn cubic_root(level: f64, mut w: f64) -> f64 {
    for _ in 0..MOST_STEPS {
        let root = w.max(0.0).sqrt();
        let gain = cubic(root);
        let step = gain * (gain.ln() - w * root - level);
        w = (w + step).max(0.0);
        if step.is_nan() || step.abs() <= CONVERGED * w {
            break;
        }
    }
    w
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::RULE;

    fn breaking(barrier: Barrier, energy: f64) -> ThermalActivation {
        ThermalActivation {
            temperature: Temperature { barrier, ..Temperature::new(energy, 3.0) },
            stiffness: 2.0,
        }
    }

    /// Differences of the closed form are integrals of the rate, by a Gauss rule on cells that shrink towards the threshold,
    /// where the barrier of the catastrophe is a half power.
    #[test]
    fn hazards_are_integrals_of_the_rate() {
        for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
            for (energy, from, to) in
                [(0.05, 0.0, 1.2), (0.3, 0.2, 0.9), (0.003, 1.0, 1.19), (0.1, -0.7, 0.4)]
            {
                let (thermal, velocity) = (breaking(barrier, energy), 0.01);
                let hazard = thermal.at(1.2, velocity);
                let sum = |from: f64, to: f64| -> f64 {
                    let edge = |k: i32| to - (to - from) * 0.95_f64.powi(k);
                    let rate = |x: f64| thermal.rate(x, 1.2) / velocity;
                    (0..800).map(|k| RULE.integrate(edge(k), edge(k + 1), rate)).sum()
                };
                // The rate has a kink at 0.
                let (from, to): (f64, f64) = (from, to);
                let expected = sum(from.min(0.0), to.min(0.0)) + sum(from.max(0.0), to);
                let found = hazard.value(to) - hazard.value(from);
                // Rounding of exponents of up to 480.
                assert!(
                    (found / expected - 1.0).abs() < 1e-12,
                    "{barrier:?} {energy}: {found:e} {expected:e}"
                );
            }
        }
    }

    #[test]
    fn stretches_are_the_inverse_of_hazards() {
        for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
            for energy in [1e-4, 1e-3, 0.05, 1.0, 50.0] {
                for velocity in [1e-12, 1e-3, 1.0, 1e6] {
                    let hazard = breaking(barrier, energy).at(1.2, velocity);
                    for stretch in (-100..120).map(|k| 0.01 * f64::from(k)).chain([1e-9, 1.2 - 1e-9]) {
                        let value = hazard.value(stretch);
                        let found = hazard.stretch(value);
                        // The rounding of the value moves the stretch by that over the slope, which is w/v.
                        let slope = breaking(barrier, energy).rate(stretch, 1.2) / velocity;
                        let moved = 1e-15 * hazard.value(stretch.abs()).max(hazard.value(0.0)) / slope;
                        // Where A underflows there is nothing to invert.
                        if slope > 1e-290 {
                            let error = (found - stretch).abs();
                            assert!(
                                error < 1e-13 + 10.0 * moved,
                                "{barrier:?} {energy} {velocity} {stretch}: {found}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// Newton's method, from tables and beyond them.
    #[test]
    fn inverses_have_all_digits() {
        for k in -4000..8000 {
            let level = 0.01 * f64::from(k);
            let x = inverse_of_dawson(level);
            let dawson = crate::numerics::dawson::dawson(x);
            // The level is rounded, and ξ with it.
            let allowed = 1e-12 * x + 4.0 * f64::EPSILON * level.abs() * dawson;
            assert!((dawson * (level - x * x - dawson.ln())).abs() < allowed, "{level}");
            if k < -10 {
                let w = inverse_of_cubic(level);
                let gain = cubic(w.sqrt());
                let allowed = 1e-12 * (1e-3 + w) + 4.0 * f64::EPSILON * level.abs() * gain;
                assert!((gain * (gain.ln() - w * w.sqrt() - level)).abs() < allowed, "{level}");
            }
        }
        assert!(inverse_of_cubic(cubic(0.0).ln()) < 0.0);
    }

    /// A hazard that the contact survives up to its threshold.
    #[test]
    fn what_is_not_reached_is_infinite() {
        for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
            let hazard = breaking(barrier, 0.05).at(1.2, 1.0);
            assert_eq!(hazard.stretch(1.001 * hazard.value(1.2)), f64::INFINITY);
            assert!(hazard.stretch(0.999 * hazard.value(1.2)) < 1.2);
        }
    }
}
