//! The noise of steady sliding: autocovariance and spectrum of the force of a finite number of contacts.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

use super::force_after_break::{ForceAfterBreak, WeightedLife};
use super::pull::at;
use super::steady::SteadyState;
use super::tolerance::Tolerance;
use crate::law::SharedLaw;
use crate::life::Life;
use crate::monitor::{Monitor, Part, Watch};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;
use crate::{Error, Result};

impl SteadyState {
    /// The autocovariance c(u) = Cov(F(X), F(X + u)) of the force of `size` contacts in steady sliding, scaled to
    /// N_c, at these advances u ≥ 0: forces squared.
    ///
    /// Per contact and unit stiffness c(0) is the variance and c'(u) = Γ_s\[ξ̄F_R(u) − F_rR(u)\] − F_k, with F_R
    /// and F_rR as in [`super::Pull::covariance`] and ξ̄ = r̄ + 1/Γ_s the mean stretch at a break. Where contacts
    /// re-form at 0, c' = F_R − F_k: the slope of the autocovariance is the first loading curve.
    ///
    /// # Errors
    /// A size that is not above 0, an advance below 0; contacts with a delay, with k = κ x_s or
    /// `ageing.mean_field`.
    pub fn autocovariance(&self, advances: &[f64], size: f64) -> Result<Vec<f64>> {
        self.autocovariance_with(advances, size, Tolerance::default(), &mut ())
    }

    /// The same to a tolerance, of the force, with a monitor.
    ///
    /// # Errors
    /// As [`Self::autocovariance`]; stopped by the monitor; a required tolerance that is not reached.
    pub fn autocovariance_with(
        &self,
        advances: &[f64],
        size: f64,
        tolerance: impl Into<Tolerance>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        let tolerance = tolerance.into();
        tolerance.check()?;
        self.has_noise(size)?;
        if let Some(u) = advances.iter().find(|u| !(u.is_finite() && **u >= 0.0)) {
            return Err(Error::invalid("advances", "finite lengths, 0 or above", u));
        }
        let end = advances.iter().copied().fold(self.mean, f64::max);
        let after = ForceAfterBreak::new(&self.equation, None, (end, tolerance), monitor)?;
        let (rate, friction) = (1.0 / self.mean, self.life.force().curve().integral() / self.mean);
        let start = self.equation.contacts.reforming.mean();
        // Both forces tend to constants; what is left of them is integrated.
        let reformed = without(after.curve(), friction).integrated_from_end(0.0, &[]);
        let weighted = after.weighted_curve();
        let weighted = weighted.map(|curve| without(curve, start * friction).integrated_from_end(0.0, &[]));
        let up_to = |curve: &Piecewise, u: f64| at(curve, 0.0) - at(curve, u);
        let value = |&u: &f64| {
            let biased = weighted.as_ref().map_or(0.0, |curve| up_to(curve, u));
            self.variance() + (1.0 + rate * start) * up_to(&reformed, u) - rate * biased
        };
        let scale = self.stiffness.powi(2) / size;
        Ok(advances.iter().map(|u| scale * value(u)).collect())
    }

    /// The spectrum S(q) = ∫c(u) e^{iqu} du over all u of the force of `size` contacts in steady sliding, scaled to
    /// N_c, at these wave numbers q ≥ 0 (radians per length): forces squared times a length.
    ///
    /// Per contact and unit stiffness, with τ = ξ − r the advance from one break to the next,
    ///
    /// S(q) = Γ_s/q² \[J₂ + 2 Re(γ + αβ/(1 − ĝ))\], ĝ = E e^{iqτ}, α = E\[(r − ξ̄)e^{iqτ}\], β = E\[(r̄ −
    /// ξ)e^{iqτ}\], γ = E\[(r − ξ̄)(r̄ − ξ)e^{iqτ}\], J₂ = ⟨ξ²⟩ + ⟨r²⟩ − 2r̄ξ̄,
    ///
    /// so that q²S tends to Γ_s J₂ for large q if the thresholds have no point masses. For small q, where these
    /// terms cancel, S is computed from the transform of c', which has no singularity; see docs/theory.md. The
    /// relative error is about 1e-13/σ² at small q, σ the coefficient of variation of the advance between breaks, and
    /// grows as q² for contacts that re-form at spread stretches (1e-7 at q = 10³ over the mean advance).
    ///
    /// # Errors
    /// As [`SteadyState::autocovariance`]; contacts that break and re-form at point masses only, whose spectrum
    /// contains lines.
    pub fn spectrum(&self, wave_numbers: &[f64], size: f64) -> Result<Vec<f64>> {
        self.spectrum_with(wave_numbers, size, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::spectrum`]; stopped by the monitor.
    pub fn spectrum_with(
        &self,
        wave_numbers: &[f64],
        size: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        self.has_noise(size)?;
        if let Some(q) = wave_numbers.iter().find(|q| !(q.is_finite() && **q >= 0.0)) {
            return Err(Error::invalid("wave_numbers", "finite numbers, 0 or above", q));
        }
        if self.life.breaking().atoms().map(|atom| atom.weight).sum::<f64>() > 1.0 - 1e-12 {
            let expected = "thresholds or re-forming stretches with a density: contacts that stay in phase have a spectrum with lines";
            return Err(Error::invalid("thresholds", expected, "point masses"));
        }
        let transforms = SlidingTransforms::new(self, &mut Part::new(monitor, 0.0, 0.5))?;
        let scale = self.stiffness.powi(2) / size;
        let watch = Watch::new(monitor);
        let values = wave_numbers.iter().map(|&q| scale * watch.value(|| transforms.spectrum(q)));
        let values = values.collect();
        watch.check()?;
        Ok(values)
    }

    /// S(0), the integral of the autocovariance over all u: the noise of the force averaged over an advance much
    /// longer than the relaxation length is √(S(0)/advance). For contacts that re-form at 0 it is
    /// (N_c⟨k⟩)²/size \[m₄/4m₁ − m₂m₃/2m₁² + m₂³/4m₁³\], m_n the moments of the advance between breaks.
    ///
    /// # Errors
    /// As [`SteadyState::spectrum`].
    pub fn noise_at_zero(&self, size: f64) -> Result<f64> {
        self.spectrum(&[0.0], size).map(|values| values[0])
    }

    fn has_noise(&self, size: f64) -> Result<()> {
        if !(size > 0.0 && size.is_finite()) {
            return Err(Error::invalid("size", "a finite number above 0", size));
        }
        self.equation.has_transients()?;
        self.equation.contacts.renew_completely()
    }
}

/// A curve minus a constant.
fn without(curve: &Piecewise, constant: f64) -> Piecewise {
    let mut out = curve.clone();
    out.coefficients.iter_mut().for_each(|cell| cell[0] -= constant);
    out
}

/// The curves whose Laplace transforms make the spectrum.
///
/// With hats for transforms, S the survival and m the carried force, d = m − F_k S has no mean, so that d̂(s) = s
/// D̂(s) with D(u) = ∫₀^u d, and F̂_R − F_k/s = D̂/Ŝ has no pole at 0. With S_b and m_b the curves of contacts
/// counted by their initial stretch (per r̄), the transform of c' is
///
/// ĉ' = (D̂/Ŝ)(1 + Γ_s r̄ s Ŝ_b) − Γ_s r̄ (m̂_b − F_k Ŝ_b),
///
/// and S(q) = 2 Re {\[ĉ'(s) − ĉ'(0)\]/s} at s = −iq. Each transform T̂ minus its value at 0 is −s Ŵ, with W(u) =
/// ∫_u^∞ T: nothing is divided by s.
struct SlidingTransforms {
    survival: Falling,
    /// D.
    excess: Falling,
    friction: f64,
    weighted: Option<StretchWeighted>,
    /// Of contacts that re-form at 0.
    advances: Option<AdvanceBetweenBreaks>,
}

/// The advances τ between breaks of contacts that re-form at 0, for which S(q) = Γ_s/q² \[⟨τ²⟩ + 2⟨τ⟩ Re
/// E\[τe^{iqτ}\]/(1 − ĝ)\].
struct AdvanceBetweenBreaks {
    /// The distribution of τ, where its transform is closed; else the breaking density.
    law: std::result::Result<SharedLaw, Kernel>,
    mean: f64,
    square: f64,
    std: f64,
}

impl AdvanceBetweenBreaks {
    fn of(steady: &SteadyState) -> Option<Self> {
        let contacts = &steady.equation.contacts;
        if contacts.reforming.upper_quantile(0.0) > 0.0 {
            return None;
        }
        let closed = !contacts.rules.are_time_dependent() && contacts.thresholds.laplace_is_closed();
        let law = if closed { Ok(contacts.thresholds.clone()) } else { Err(steady.life.breaking().clone()) };
        let (mean, square) = (steady.mean, steady.life.mean_square());
        Some(Self { law, mean, square, std: (square - mean * mean).max(0.0).sqrt() })
    }

    /// Whether no more than two digits cancel: S is then at least (qσ)²/4 of its terms.
    fn is_safe_at(&self, q: f64) -> bool {
        q * self.std > 0.2
    }

    fn spectrum(&self, q: f64) -> f64 {
        let s = Complex64::new(0.0, -q);
        let (transform, slope) = match &self.law {
            // The derivative by Cauchy's formula with four points around s: truncation is of the order of the
            // fourth power of the distance, rounding is divided by the distance. Wide distributions have
            // singularities at about mean/variance.
            Ok(law) => {
                let radius = 1e-3 * (1.0 / self.mean).min(self.mean / (self.std * self.std));
                let around = (0..4).map(|k| Complex64::from_polar(radius, f64::from(k) * FRAC_PI_2));
                (law.laplace(s), around.map(|h| law.laplace(s + h) / h).sum::<Complex64>() / 4.0)
            }
            Err(breaking) => breaking.transform(s),
        };
        (self.square - 2.0 * self.mean * (slope / (1.0 - transform)).re) / (self.mean * q * q)
    }
}

/// A curve and its integral from u to the end.
struct Falling {
    curve: Piecewise,
    rest: Piecewise,
    /// The integral over all u.
    whole: f64,
}

/// Contacts counted by their initial stretch.
struct StretchWeighted {
    /// Γ_s r̄.
    rate: f64,
    survival: Falling,
    force: Falling,
}

impl Falling {
    fn new(curve: Piecewise) -> Self {
        let (rest, whole) = (curve.integrated_from_end(0.0, &[]), curve.integral());
        Self { curve, rest, whole }
    }
}

impl SlidingTransforms {
    fn new(steady: &SteadyState, monitor: &mut dyn Monitor) -> Result<Self> {
        let curve = |of: &Kernel| of.curve().clone();
        let (survival, force) = (curve(steady.life.survival()), curve(steady.life.force()));
        let friction = force.integral() / steady.mean;
        let excess = force.plus(-friction, &survival).integrated_from_end(0.0, &[]).scaled(-1.0);
        let equation = &steady.equation;
        let weighted = equation.weighted_by_stretch(&equation.reforming(), monitor)?;
        let weighted = weighted.map(|WeightedLife { mean_start, life }| {
            let of = |curves: fn(&Life) -> &Kernel| Falling::new(curve(curves(&life)));
            StretchWeighted {
                rate: mean_start / steady.mean,
                survival: of(Life::survival),
                force: of(Life::force),
            }
        });
        let (survival, excess) = (Falling::new(survival), Falling::new(excess));
        Ok(Self { survival, excess, friction, weighted, advances: AdvanceBetweenBreaks::of(steady) })
    }

    fn spectrum(&self, q: f64) -> f64 {
        match &self.advances {
            Some(advances) if advances.is_safe_at(q) => advances.spectrum(q),
            _ => self.without_cancellation(q),
        }
    }

    fn without_cancellation(&self, q: f64) -> f64 {
        let s = Complex64::new(0.0, -q);
        let transform = |curve: &Piecewise| curve.transform(s).0;
        let survival = transform(&self.survival.curve);
        let changes = transform(&self.excess.rest) * self.survival.whole
            - self.excess.whole * transform(&self.survival.rest);
        let mut sum = -changes / (survival * self.survival.whole);
        if let Some(weighted) = &self.weighted {
            let ratio = transform(&self.excess.curve) / survival;
            let later = transform(&weighted.force.rest) - self.friction * transform(&weighted.survival.rest);
            sum += weighted.rate * (transform(&weighted.survival.curve) * ratio + later);
        }
        2.0 * sum.re
    }
}
