//! Quenched thresholds: each contact keeps its own for ever, and they lose step.

use crate::law::SharedLaw;

/// Any P_c, thresholds kept for ever, R = Q_ini = δ: x = X mod ξ for a contact of threshold ξ.
///
/// F(X) = ∫P_c(ξ)(X mod ξ)dξ = X − Σ_{n≥1} M(X/n), M(x) = ∫_0^x ξP_c(ξ)dξ; and F_k = x̄/2.
/// Source: derived; the master equation describes annealed thresholds, these it does not.
#[derive(Debug, Clone)]
pub struct Quenched {
    /// P_c.
    pub thresholds: SharedLaw,
}

impl Quenched {
    /// F(X)/(N_c⟨k⟩), to about 1e-13 of X; after the break where contacts break together. Not a number beyond [`Self::reach`].
    #[must_use]
    pub fn force(&self, position: f64) -> f64 {
        if position > self.reach() {
            return f64::NAN;
        }
        let law = &self.thresholds;
        let mean = law.mean();
        let below = |x: f64| mean - law.upper_moment(1, x);
        // The first terms one by one, down to thresholds over which P_c no longer varies or vanishes.
        let terms = (position / (0.02 * law.zones().iter().map(|zone| zone.resolution).fold(mean, f64::min)))
            .ceil()
            .max(50.0);
        let mut force = position;
        for n in 1..=terms as u64 {
            let x = position / n as f64;
            if law.survival(x) == 1.0 {
                return force;
            }
            force -= below(x);
        }
        // The rest by the midpoint rule: ∫_N^∞ M(X/ν)dν = X[P(ξ ≤ c) − M(c)/c], c = X/N.
        let end = position / (terms + 0.5);
        let rest = position * ((1.0 - law.survival(end)) - below(end) / end);
        force - rest + end.powi(3) * law.density(end) / (24.0 * position)
    }

    /// The position up to which the sum stays short, a length.
    #[must_use]
    pub fn reach(&self) -> f64 {
        1e4 * self.thresholds.mean()
    }

    /// F_k/(N_c⟨k⟩) = x̄/2, to which F tends if P_c has no point masses.
    #[must_use]
    pub fn kinetic_friction(&self) -> f64 {
        0.5 * self.thresholds.mean()
    }

    /// X_d = x̄²/(√2 πσ): narrow Gaussian thresholds lose step as exp[−(X/X_d)²].
    #[must_use]
    pub fn dephasing_length(&self) -> f64 {
        let (mean, std) = (self.thresholds.mean(), self.thresholds.std());
        mean * mean / (std::f64::consts::SQRT_2 * std::f64::consts::PI * std)
    }
}
