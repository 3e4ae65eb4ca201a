//! Thermal breaking of contacts with a constant threshold, in closed form.

use crate::contacts::Barrier;
use crate::numerics::exponential::exp;
use crate::numerics::incomplete::{cubics, dawsons_by_table};
use crate::numerics::legendre::{NODES, Nodal};

/// Contacts with one threshold h that formed at one stretch r.
///
/// ∫_r^x e^{−ΔE(ξ)/T} dξ = s [G(x) e^{−ΔE(x)/T} − G(r) e^{−ΔE(r)/T}], with s and G of the barrier ([`Barrier::integral_length`]).
#[derive(Debug)]
pub(super) struct ConstantThreshold {
    barrier: Barrier,
    threshold: f64,
    /// E_0/T.
    whole: f64,
    start: f64,
    /// ΔE(r)/T.
    pub(super) begun: f64,
    /// s.
    pub(super) length: f64,
    /// G(r) e^{−ΔE(r)/T}.
    before: f64,
}

/// Sixteen groups of such contacts that formed at any one stretch.
#[derive(Debug)]
pub(super) struct ConstantThresholds {
    barrier: Barrier,
    pub(super) thresholds: Nodal,
    /// E_0/T.
    wholes: Nodal,
    /// s.
    lengths: Nodal,
}

/// If the exponents differ by less, the closed form would cancel, and a Gauss rule is used.
const ALIKE: f64 = 1.0 / 32.0;

/// The Gauss rule of six points: its error is below rounding there.
const FEW: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170_36),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];

impl ConstantThreshold {
    /// Contacts with the barrier E_0 = `whole` × T at zero stretch.
    pub(super) fn new(barrier: Barrier, threshold: f64, whole: f64, start: f64) -> Self {
        let (whole, length) = lengths(barrier, threshold, whole);
        let begun = whole * barrier.height_at(start, threshold);
        let mut constant = Self { barrier, threshold, whole, start, begun, length, before: 0.0 };
        constant.before = constant.gain(start) * (-begun).exp();
        constant
    }

    /// ∫_r^x e^{−ΔE/T} dξ after an advance, which may be back, and e^{−ΔE(x)/T}.
    #[inline]
    pub(super) fn at(&self, advance: f64) -> (f64, f64) {
        let stretch = self.start + advance;
        let exponent = self.whole * self.barrier.height_at(stretch, self.threshold);
        let now = (-exponent).exp();
        if (self.begun - exponent).abs() < ALIKE && self.before > 0.0 {
            return (short(self.barrier, (self.threshold, self.whole), stretch, advance), now);
        }
        (self.length * (self.gain(stretch) * now - self.before), now)
    }

    /// e^{−ΔE(x)/T} after an advance.
    #[inline]
    pub(super) fn rate(&self, advance: f64) -> f64 {
        (-self.whole * self.barrier.height_at(self.start + advance, self.threshold)).exp()
    }

    /// ∫_r^x e^{−ΔE/T} dξ after sixteen advances.
    #[inline(always)]
    pub(super) fn integrals(&self, advances: &Nodal) -> Nodal {
        let stretches = advances.map(|advance| self.start + advance);
        let [thresholds, wholes, lengths] =
            [self.threshold, self.whole, self.length].map(|value| [value; NODES]);
        let exponents = exponents(self.barrier, &wholes, &thresholds, &stretches);
        let mut out = gains(self.barrier, &lengths, &thresholds, &stretches);
        for i in 0..NODES {
            out[i] = self.length * (out[i] * exp(-exponents[i]) - self.before);
        }
        for i in 0..NODES {
            if (self.begun - exponents[i]).abs() < ALIKE {
                out[i] = short(self.barrier, (self.threshold, self.whole), stretches[i], advances[i]);
            }
        }
        out
    }

    /// e^{−ΔE(x)/T} after sixteen advances.
    #[inline(always)]
    pub(super) fn rates(&self, advances: &Nodal) -> Nodal {
        let stretches = advances.map(|advance| self.start + advance);
        let (thresholds, wholes) = ([self.threshold; NODES], [self.whole; NODES]);
        exponents(self.barrier, &wholes, &thresholds, &stretches).map(|exponent| exp(-exponent))
    }

    /// The largest −∂(ΔE/T)/∂x up to a stretch.
    pub(super) fn steepest(&self, stretch: f64) -> f64 {
        self.whole / self.threshold * self.barrier.steepest(stretch / self.threshold)
    }

    /// G.
    #[inline]
    fn gain(&self, stretch: f64) -> f64 {
        self.barrier.integral_factor(stretch, self.threshold, self.length)
    }
}

impl ConstantThresholds {
    /// Contacts with these thresholds, and the barriers E_0 = `wholes` × T at zero stretch.
    pub(super) fn new(barrier: Barrier, thresholds: Nodal, wholes: Nodal) -> Self {
        let both: [_; NODES] = std::array::from_fn(|i| lengths(barrier, thresholds[i], wholes[i]));
        Self { barrier, thresholds, wholes: both.map(|both| both.0), lengths: both.map(|both| both.1) }
    }

    /// ∫_r^x e^{−ΔE/T} dξ after an advance from r = `start`, and e^{−ΔE(x)/T}.
    #[inline(always)]
    pub(super) fn at(&self, start: f64, advance: f64) -> [Nodal; 2] {
        let stretch = start + advance;
        let (mut exponents, mut rates, mut gains) = ([[0.0; NODES]; 2], [[0.0; NODES]; 2], [[0.0; NODES]; 2]);
        for (end, x) in [start, stretch].into_iter().enumerate() {
            let stretches = [x; NODES];
            exponents[end] = self::exponents(self.barrier, &self.wholes, &self.thresholds, &stretches);
            gains[end] = self::gains(self.barrier, &self.lengths, &self.thresholds, &stretches);
            for i in 0..NODES {
                rates[end][i] = exp(-exponents[end][i]);
                gains[end][i] *= rates[end][i];
            }
        }
        let mut sums = self.lengths;
        for i in 0..NODES {
            sums[i] *= gains[1][i] - gains[0][i];
        }
        for i in 0..NODES {
            if exponents[0][i] - exponents[1][i] < ALIKE {
                sums[i] = short(self.barrier, (self.thresholds[i], self.wholes[i]), stretch, advance);
            }
        }
        [sums, rates[1]]
    }
}

/// ΔE/T of sixteen contacts of these E_0/T.
#[inline(always)]
fn exponents(barrier: Barrier, wholes: &Nodal, thresholds: &Nodal, stretches: &Nodal) -> Nodal {
    let (thresholds, stretches, mut out) = (*thresholds, *stretches, *wholes);
    let missing = |i: usize| ((thresholds[i] - stretches[i]) / thresholds[i]).max(0.0);
    match barrier {
        Barrier::Elastic => {
            for i in 0..NODES {
                out[i] *= missing(i) * (1.0 + stretches[i] / thresholds[i]);
            }
        }
        Barrier::Bell => (0..NODES).for_each(|i| out[i] *= missing(i)),
        Barrier::Catastrophe => {
            for i in 0..NODES {
                let missing = missing(i);
                out[i] *= missing * missing.sqrt();
            }
        }
    }
    out
}

/// G of sixteen contacts of these s.
#[inline(always)]
fn gains(barrier: Barrier, lengths: &Nodal, thresholds: &Nodal, stretches: &Nodal) -> Nodal {
    let mut places = [1.0; NODES];
    match barrier {
        Barrier::Elastic => {
            (0..NODES).for_each(|i| places[i] = stretches[i] / lengths[i]);
            dawsons_by_table(&places)
        }
        Barrier::Bell => places,
        Barrier::Catastrophe => {
            for i in 0..NODES {
                places[i] = ((thresholds[i] - stretches[i]).max(0.0) / lengths[i]).sqrt();
            }
            cubics(&places)
        }
    }
}

/// E_0/T, and s.
fn lengths(barrier: Barrier, threshold: f64, whole: f64) -> (f64, f64) {
    // For tiny thresholds it would round to 0.
    let whole = whole.max(f64::MIN_POSITIVE);
    (whole, barrier.integral_length(threshold, whole))
}

/// The integral by a Gauss rule in q = √(1 − ξ/h), in which every barrier is smooth.
fn short(barrier: Barrier, (threshold, whole): (f64, f64), stretch: f64, advance: f64) -> f64 {
    let left = (1.0 - stretch / threshold).max(0.0);
    // √(1 − r/h) from the advance, which for short advances is more accurate than the difference of
    // stretches.
    let (near, far) = (left.sqrt(), (left + advance / threshold).sqrt());
    let half = 0.5 * advance / (threshold * (near + far).max(f64::MIN_POSITIVE));
    let term = |(t, weight): (f64, f64)| {
        let q = near + half * (1.0 + t);
        weight * q * (-whole * barrier.height(1.0 - q * q)).exp()
    };
    2.0 * threshold * half * FEW.into_iter().map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::RULE;

    #[test]
    fn closed_forms_are_the_integrals() {
        for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
            for (whole, start, advance) in
                [(10.0, 0.0, 0.9), (10.0, 0.3, 1e-3), (400.0, 0.2, 0.7), (0.5, 0.0, 0.8), (3.0, 0.5, 0.5)]
            {
                let threshold = 1.0;
                let constant = ConstantThreshold::new(barrier, threshold, whole, start);
                let (sum, now) = constant.at(advance);
                let rate = |x: f64| (-whole * barrier.height(x / threshold)).exp();
                // Cells that shrink towards the threshold, where the catastrophe's barrier is not smooth.
                let edge = |k: i32| start + advance * (1.0 - 0.95_f64.powi(k));
                let cells: f64 = (0..800).map(|k| RULE.integrate(edge(k), edge(k + 1), rate)).sum();
                // Rounding of exponents of up to 400.
                assert!(
                    (sum / cells - 1.0).abs() < 2e-13,
                    "{barrier:?} {whole} {start}: {}",
                    sum / cells - 1.0
                );
                assert!((now / rate(start + advance) - 1.0).abs() < 2e-13);
                let sixteen = ConstantThresholds::new(barrier, [threshold; NODES], [whole; NODES]);
                let [sums, all_now] = sixteen.at(start, advance);
                // Two ways to compute exponentials.
                assert!(sums.iter().all(|other| (other / sum - 1.0).abs() < 1e-13), "{sums:?} {sum}");
                assert!(all_now.iter().all(|other| (other / now - 1.0).abs() < 1e-14));
            }
        }
    }
}
