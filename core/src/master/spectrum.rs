//! The spectrum of the force in steady sliding, from transforms of the curves of a life.

use num_complex::Complex64;

use super::force_after_break::WeightedLife;
use super::steady::SteadyState;
use crate::Result;
use crate::law::SharedLaw;
use crate::life::Life;
use crate::monitor::Monitor;
use crate::numerics::fourier::FourierTransforms;
use crate::numerics::piecewise::Piecewise;

/// Wave numbers below this, in units of Γ_s, are small: there the forms are equally accurate.
const SMALL: f64 = 4.0;

/// The spectrum per contact and unit stiffness.
///
/// With hats for Laplace transforms in u, S the survival, m the carried force, and S_b and m_b those of contacts
/// counted by their initial stretch (per r̄), let d = m − F_k S, which has no mean, and d_b = m_b − F_k S_b. With the
/// transforms at s = −iq, D(u) = ∫₀^u d and d̂ = s D̂,
///
/// ĉ' = (D̂/Ŝ)(1 + Γ_s r̄ s Ŝ_b) − Γ_s r̄ d̂_b, S(q) = 2 Re {\[ĉ'(s) − ĉ'(0)\]/s} = 2 Re \[ĉ'(s)/s\],
///
/// since ĉ'(0) is real. The second form keeps its digits at large q, where all its terms fall as 1/q², but divides
/// rounding by q². At small q the first form is used, with transforms of W(u) = ∫_u^∞ T: T̂ minus its value at 0 is
/// −s Ŵ, so that nothing is divided by s.
pub(super) struct SpectralDensity {
    /// S and d.
    curves: FourierTransforms<2>,
    /// ∫_u^∞ of S and of D.
    remainders: FourierTransforms<2>,
    /// ∫S, the mean advance between breaks, and ∫D.
    mean: f64,
    excess: f64,
    weighted: Option<WeightedSpectrum>,
    /// Of contacts that re-form at 0.
    advances: Option<AdvanceBetweenBreaks>,
}

/// Contacts counted by their initial stretch.
struct WeightedSpectrum {
    /// Γ_s r̄.
    rate: f64,
    /// S_b and d_b.
    curves: FourierTransforms<2>,
    /// ∫_u^∞ of both.
    remainders: FourierTransforms<2>,
    /// ∫S_b.
    mean: f64,
}

impl SpectralDensity {
    pub(super) fn new(steady: &SteadyState, monitor: &mut dyn Monitor) -> Result<Self> {
        let friction = steady.life.force().curve().integral() / steady.mean;
        let both = |life: &Life| {
            let survival = life.survival().curve();
            (survival.clone(), life.force().curve().plus(-friction, survival))
        };
        let (survival, difference) = both(&steady.life);
        let excess = remainder(&difference).scaled(-1.0);
        let equation = &steady.equation;
        let weighted = equation.weighted_by_stretch(&equation.reforming(), monitor)?;
        let weighted = weighted.map(|WeightedLife { mean_start, life }| {
            let (survival, difference) = both(&life);
            WeightedSpectrum {
                rate: mean_start / steady.mean,
                curves: FourierTransforms::new([&survival, &difference]),
                remainders: FourierTransforms::new([&remainder(&survival), &remainder(&difference)]),
                mean: survival.integral(),
            }
        });
        Ok(Self {
            curves: FourierTransforms::new([&survival, &difference]),
            remainders: FourierTransforms::new([&remainder(&survival), &remainder(&excess)]),
            mean: survival.integral(),
            excess: excess.integral(),
            weighted,
            advances: AdvanceBetweenBreaks::of(steady),
        })
    }

    /// S(q).
    pub(super) fn at(&self, q: f64) -> f64 {
        if q * self.mean < SMALL {
            return self.at_small(q);
        }
        match &self.advances {
            Some(advances) => advances.spectrum(q),
            None => self.at_large(q),
        }
    }

    /// 2 Re \[ĉ'(s)/s\].
    fn at_large(&self, q: f64) -> f64 {
        let s = Complex64::new(0.0, -q);
        let [survival, difference] = self.curves.at(q);
        let ratio = difference / (s * survival);
        let slope = match &self.weighted {
            None => ratio,
            Some(weighted) => {
                let [survival, difference] = weighted.curves.at(q);
                ratio + weighted.rate * (ratio * s * survival - difference)
            }
        };
        2.0 * (slope / s).re
    }

    /// 2 Re {\[ĉ'(s) − ĉ'(0)\]/s}.
    fn at_small(&self, q: f64) -> f64 {
        let s = Complex64::new(0.0, -q);
        let [after, after_excess] = self.remainders.at(q);
        let survival = self.mean - s * after;
        let mut sum = (self.excess * after - self.mean * after_excess) / (survival * self.mean);
        if let Some(weighted) = &self.weighted {
            let ratio = (self.excess - s * after_excess) / survival;
            let [after, after_difference] = weighted.remainders.at(q);
            sum += weighted.rate * ((weighted.mean - s * after) * ratio + after_difference);
        }
        2.0 * sum.re
    }
}

/// The integral of a curve from u to its end.
fn remainder(curve: &Piecewise) -> Piecewise {
    curve.integrated_from_end(0.0, &[])
}

/// The advances τ between breaks of contacts that re-form at 0 and whose thresholds have a closed transform ĝ:
/// S(q) = Γ_s/q² \[⟨τ²⟩ + 2⟨τ⟩ Re E\[τe^{iqτ}\]/(1 − ĝ)\].
struct AdvanceBetweenBreaks {
    law: SharedLaw,
    mean: f64,
    square: f64,
}

impl AdvanceBetweenBreaks {
    fn of(steady: &SteadyState) -> Option<Self> {
        let contacts = &steady.equation.contacts;
        let starts_at_zero = contacts.reforming.upper_quantile(0.0) == 0.0;
        let law = contacts.thresholds.clone();
        let closed = starts_at_zero && !contacts.rules.are_time_dependent() && law.laplace_is_closed();
        closed.then(|| Self { mean: law.mean(), square: law.upper_moment(2, -1.0), law })
    }

    fn spectrum(&self, q: f64) -> f64 {
        let [transform, derivative] = self.law.laplace_with_derivative(Complex64::new(0.0, -q));
        (self.square - 2.0 * self.mean * (derivative / (1.0 - transform)).re) / (self.mean * q * q)
    }
}
