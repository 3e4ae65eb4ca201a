//! The noise of steady sliding: autocovariance and spectrum of the force of a finite number of contacts.

use super::force_after_break::{ForceAfterBreak, WeightedLife};
use super::pull::at;
use super::spectrum::SpectralDensity;
use super::steady::SteadyState;
use super::tolerance::Tolerance;
use crate::monitor::{Monitor, Part, Watch};
use crate::numerics::piecewise::Piecewise;
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
    /// so that q²S tends to Γ_s J₂ for large q if the thresholds have no point masses. It is computed from closed
    /// transforms of the distribution of τ, or from the transform of c'; see docs/theory.md. The relative error is about
    /// 1e-13, or 1e-16/σ² if that is larger, with σ the coefficient of variation of τ; above q = 10²/⟨τ⟩ it can grow in
    /// proportion to q, to 1e-11 at 10⁴/⟨τ⟩.
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
        let spectrum = SpectralDensity::new(self, &mut Part::new(monitor, 0.0, 0.5))?;
        let scale = self.stiffness.powi(2) / size;
        let watch = Watch::new(monitor);
        let values = wave_numbers.iter().map(|&q| scale * watch.value(|| spectrum.at(q)));
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

    /// The limit of q² S(q) for large q, forces squared per length: the rate of breaks times the mean square of the force
    /// lost at one, (N_c⟨k⟩)² Γ_s J₂/size. Where contacts re-form at 0 it is 2F_k times the stiffness of one of `size`
    /// contacts.
    ///
    /// # Errors
    /// As [`SteadyState::autocovariance`].
    pub fn spectrum_tail(&self, size: f64) -> Result<f64> {
        self.spectrum_tail_with(size, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::spectrum_tail`]; stopped by the monitor.
    pub fn spectrum_tail_with(&self, size: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        self.has_noise(size)?;
        let reforming = &self.equation.contacts.reforming;
        let (start, squared_start) = (reforming.mean(), reforming.upper_moment(2, -1.0));
        let weighted = self.equation.weighted_by_stretch(&self.equation.reforming(), monitor)?;
        let product = weighted.map_or(0.0, |WeightedLife { mean_start, life }| mean_start * life.mean());
        let square = squared_start + 2.0 * product + self.life.mean_square();
        let lost = square + squared_start - 2.0 * start * (start + self.mean);
        Ok(self.stiffness.powi(2) / size * lost / self.mean)
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
