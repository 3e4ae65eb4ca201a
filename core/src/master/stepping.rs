//! The paper's own time stepping of the master equation, Eq. (2): for comparison and teaching.

use crate::law::Law;

/// How the terms of Eq. (2) are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// ΔQ₋ = min(P ΔX, 1) of the *shifted* Q, nodes at iΔX: stable, first order.
    Shifted,
    /// ΔQ₋ = P ΔX of the Q *before* the shift, as printed: unstable in the tail, where P ΔX > 1.
    Literal,
    /// The shifted Q survives with the ratio S(x + ΔX)/S(x), cell centres at (i + ½)ΔX: second order.
    SurvivalRatio,
    /// First-order upwind differences of the equation on cells `ΔX`, with half of it as the step of X.
    Upwind,
}

/// Q on a grid of stretches, advanced step by step; R = δ at 0.
///
/// Q(x; X + ΔX) = Q(x − ΔX; X) − ΔQ₋ + ΔQ₊, ΔQ₋ = P(x) ΔX Q, ΔQ₊ = R(x) ∫ΔQ₋.
#[derive(Debug, Clone)]
pub struct Stepping {
    variant: Variant,
    step: f64,
    position: f64,
    /// Fraction of contacts in each cell.
    fractions: Vec<f64>,
    /// Fraction of a cell that breaks in a step.
    breaking: Vec<f64>,
}

impl Stepping {
    /// Contacts with the given thresholds, at stretches drawn from `initial`, on a grid of spacing `step` (a length)
    /// that reaches to where S < 1e-16.
    pub fn new(thresholds: &dyn Law, initial: &dyn Law, step: f64, variant: Variant) -> Self {
        let cells = (thresholds.upper_quantile(1e-16) / step).ceil() as usize + 2;
        let centred = matches!(variant, Variant::SurvivalRatio | Variant::Upwind);
        let offset = if centred { 0.5 } else { 0.0 };
        let edge = |i: usize| (i as f64 + offset - 0.5) * step;
        let mut fractions: Vec<f64> =
            (0..cells).map(|i| initial.survival(edge(i)) - initial.survival(edge(i + 1))).collect();
        fractions[0] += 1.0 - initial.survival(edge(0));
        let breaking = (0..cells).map(|i| Self::fraction_broken(thresholds, i, step, variant)).collect();
        Self { variant, step, position: 0.0, fractions, breaking }
    }

    /// The fraction of the contacts that arrive in cell i (or are in it) that breaks in a step.
    fn fraction_broken(law: &dyn Law, i: usize, step: f64, variant: Variant) -> f64 {
        let node = i as f64 * step;
        match variant {
            Variant::Shifted => (law.hazard(node) * step).min(1.0),
            Variant::Literal => law.hazard(node) * step,
            Variant::SurvivalRatio if i == 0 => 0.0,
            Variant::SurvivalRatio => {
                let (before, after) = (node - 0.5 * step, node + 0.5 * step);
                if law.survival(after) == 0.0 {
                    return 1.0;
                }
                -(law.ln_survival(after) - law.ln_survival(before)).exp_m1()
            }
            Variant::Upwind => (law.hazard(node + 0.5 * step) * 0.5 * step).min(1.0),
        }
    }

    /// The slider's position X.
    pub fn position(&self) -> f64 {
        self.position
    }

    /// The fraction of contacts in each cell of stretches.
    pub fn fractions(&self) -> &[f64] {
        &self.fractions
    }

    /// The mean stretch F/(N_c⟨k⟩).
    pub fn force(&self) -> f64 {
        let centred = matches!(self.variant, Variant::SurvivalRatio | Variant::Upwind);
        let offset = if centred { 0.5 } else { 0.0 };
        self.fractions.iter().enumerate().map(|(i, q)| (i as f64 + offset) * self.step * q).sum()
    }

    /// Advances the slider by ΔX.
    pub fn advance(&mut self) {
        match self.variant {
            Variant::Shifted | Variant::SurvivalRatio => {
                self.shift();
                self.break_now();
            }
            Variant::Literal => self.break_before_shift(),
            Variant::Upwind => (0..2).for_each(|_| self.upwind_half()),
        }
        self.position += self.step;
    }

    fn shift(&mut self) {
        let last = self.fractions.len() - 1;
        // What leaves the grid re-forms at 0, which conserves the number of contacts.
        let lost = self.fractions[last];
        self.fractions.copy_within(..last, 1);
        self.fractions[0] = lost;
    }

    fn break_now(&mut self) {
        let mut broken = 0.0;
        for (q, p) in self.fractions.iter_mut().zip(&self.breaking).skip(1) {
            let part = p * *q;
            *q -= part;
            broken += part;
        }
        self.fractions[0] += broken;
    }

    fn break_before_shift(&mut self) {
        let broken: Vec<f64> = self.fractions.iter().zip(&self.breaking).map(|(q, p)| p * q).collect();
        self.shift();
        for (q, part) in self.fractions.iter_mut().zip(&broken) {
            *q -= part;
        }
        self.fractions[0] += broken.iter().sum::<f64>();
    }

    fn upwind_half(&mut self) {
        let mut inflow = 0.0;
        let mut broken = 0.0;
        for (q, p) in self.fractions.iter_mut().zip(&self.breaking) {
            // Courant number ½.
            let outflow = 0.5 * *q;
            let part = p * *q;
            *q += inflow - outflow - part;
            inflow = outflow;
            broken += part;
        }
        self.fractions[0] += broken + inflow;
    }
}
