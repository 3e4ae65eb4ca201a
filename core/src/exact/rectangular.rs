//! Rectangular thresholds: sums of B-splines.

use super::extrema::{highest, steepest_fall};
use super::{ClosedForm, not_negative, positive};
use crate::{Error, Result};

/// P_c = 1/(b−a) on `[a, b]`, 0 ≤ a < b; R = Q_ini = δ.
///
/// With w = b − a the n-fold convolution is the density f_n of n uniform numbers (Irwin–Hall), shifted:
/// p_n(x) = f_n((x − na)/w)/w. As E[ξ; S_n ≤ X] = (1/n)∫_0^X u p_n(u) du for each of the n thresholds in
/// the sum S_n,
///
/// F = X − Σ_n E[S_n; S_n ≤ X]/n, F' = 1 − X Σ_n p_n(X)/n.
///
/// f_n is evaluated by the B-spline recurrence (C. de Boor, *A Practical Guide to Splines*, 1978), a sum
/// of positive terms: the textbook alternating sum loses all digits near n = 30. Cost ∝ (X/x̄)³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangular {
    /// a ≥ 0, the lowest threshold.
    pub min: f64,
    /// b > a, the highest threshold.
    pub max: f64,
}

impl Rectangular {
    fn mean(&self) -> f64 {
        0.5 * (self.min + self.max)
    }

    fn width(&self) -> f64 {
        self.max - self.min
    }

    /// The period of stick-slip behind a spring of stiffness K > 0, per N_c⟨k⟩, for a slider whose contacts all re-form relaxed in a slip:
    /// the load-point displacement from slip to slip, X_u + F(X_u)/K.
    ///
    /// For b ≤ 2a no contact breaks twice before the slider becomes unstable, and F = [X(b − X) + (X − a)²/2]/w for X in `[a, b]`
    /// falls with the slope (w − X)/w. This is −K at X_u = w(1 + K), or falls below it at once, at X_u = a. `None` for b > 2a, and
    /// for K ≥ K_c = a/w, where sliding is stable.
    #[must_use]
    pub fn stick_slip_period(&self, stiffness: f64) -> Option<f64> {
        let Self { min, max } = *self;
        let width = self.width();
        if max > 2.0 * min || !(stiffness > 0.0 && stiffness < min / width) {
            return None;
        }
        let unstable = (width * (1.0 + stiffness)).max(min);
        let force = (unstable * (max - unstable) + 0.5 * (unstable - min).powi(2)) / width;
        Some(unstable + force / stiffness)
    }

    /// n and (X − na)/w of the breaks n = 1, 2, … that can have happened at X; none before the slider moves, for a = 0 too.
    fn breaks(&self, position: f64) -> impl Iterator<Item = (usize, f64)> {
        let Self { min, .. } = *self;
        let width = self.width();
        (1..)
            .map(move |n| (n, (position - n as f64 * min) / width))
            .take_while(move |&(_, t)| t >= 0.0 && position > 0.0)
    }

    /// Ends of supports of the first convolutions, where F' jumps or bends, with points between them.
    fn grid(&self) -> Vec<f64> {
        let end = 2.0 * self.max;
        let between = (0..=400).map(|i| end * f64::from(i) / 400.0);
        let knots = (0..=2u32).flat_map(|n| (0..=n).map(move |k| (n, k)));
        let knots = knots.map(|(n, k)| f64::from(n) * self.min + f64::from(k) * self.width());
        let mut grid: Vec<f64> = between.chain(knots).chain([3.0 * self.min]).filter(|&x| x <= end).collect();
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        grid
    }
}

impl ClosedForm for Rectangular {
    fn check(&self) -> Result<()> {
        not_negative("min", self.min)?;
        positive("max", self.max)?;
        if self.max > self.min {
            return Ok(());
        }
        Err(Error::invalid("max", format!("a number above min = {}", self.min), self.max))
    }

    fn reach(&self) -> f64 {
        300.0 * self.mean()
    }

    fn force(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let mut force = position;
        for (n, t) in self.breaks(position) {
            let (below, path) = irwin_hall_integrals(n, t);
            // E[S; S ≤ X] = X P(S ≤ X) − ∫P(S ≤ ·), both in units of w from na.
            let lost = (position * below - self.width() * path) / n as f64;
            force -= lost;
            if lost < 1e-18 * position {
                break;
            }
        }
        force
    }

    fn slope(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let mut sum = 0.0;
        for (n, t) in self.breaks(position) {
            let term = irwin_hall_density(n, t) / n as f64;
            sum += term;
            // Past its mode the density of S_n at X falls with n.
            if n as f64 * self.mean() > position && term < 1e-18 * sum {
                break;
            }
        }
        1.0 - position * sum / self.width()
    }

    fn kinetic_friction(&self) -> f64 {
        let (mean, half) = (self.mean(), 0.5 * self.width());
        0.5 * mean * (1.0 + half * half / (3.0 * mean * mean))
    }

    fn static_friction(&self) -> Option<(f64, f64)> {
        highest(|x| self.force(x), |x| self.slope(x), &self.grid())
    }

    fn critical_stiffness(&self) -> f64 {
        steepest_fall(|x| self.slope(x), &self.grid())
    }
}

/// The density of the sum of n numbers uniform on `[0, 1)` at t − j, for j = 0, 1, … as long as t − j ≥ 0.
///
/// f_1 = 1 on `[0, 1)`; f_n(t) = [t f_{n−1}(t) + (n − t) f_{n−1}(t − 1)]/(n − 1).
fn irwin_hall(n: usize, t: f64) -> Vec<f64> {
    let whole = t.floor();
    let mut density = vec![0.0; whole as usize + 1];
    // The only place t − j in [0, 1).
    if let Some(last) = density.last_mut() {
        *last = 1.0;
    }
    // In place, with t − j falling: each entry needs its own old value and that of the next one
    // only.
    for order in 2..=n {
        for j in 0..density.len() {
            let t = t - j as f64;
            let previous = density.get(j + 1).copied().unwrap_or(0.0);
            density[j] = (t * density[j] + (order as f64 - t) * previous) / (order - 1) as f64;
        }
    }
    density
}

fn irwin_hall_density(n: usize, t: f64) -> f64 {
    if t >= n as f64 { 0.0 } else { irwin_hall(n, t)[0] }
}

/// P(U_1 + … + U_n ≤ t) and its integral over `[0, t]`, for t ≥ 0.
///
/// Both are sums of B-splines of the next orders: ∫_0^t f_n = Σ_j f_{n+1}(t − j).
fn irwin_hall_integrals(n: usize, t: f64) -> (f64, f64) {
    if t >= n as f64 {
        return (1.0, t - 0.5 * n as f64);
    }
    let below = irwin_hall(n + 1, t).iter().sum();
    // Summing over j twice counts the term j of the next order j + 1 times.
    let path = irwin_hall(n + 2, t).iter().enumerate().map(|(j, f)| (j + 1) as f64 * f).sum();
    (below, path)
}
