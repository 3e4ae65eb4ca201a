//! The covariance of the force at two positions of a pull.

mod losses;
mod matrix;
mod sample_paths;

pub use matrix::Covariance;

use super::force_after_break::{ForceAfterBreak, WeightedLife};
use super::pull::{Pull, at};
use super::renewal::{RenewalSolution, unit_force};
use crate::monitor::{Monitor, Part, Watch, fits};
use crate::numerics::order::{largest, sort_by_number};
use crate::{Error, Result};
use losses::LossesAtBreaks;

/// The largest covariance, and the most sample paths, in bytes.
const ALLOWED: u64 = 2 << 30;

impl Pull {
    /// The covariance of the force of `size` contacts at these positions, scaled to N_c.
    ///
    /// Contacts are independent under a rigid drive. The force of one at X₁ is its initial stretch plus X₁ minus
    /// what it lost at its breaks, and after a break it starts anew, so that per contact and unit stiffness, for
    /// X₁ ≤ X₂,
    ///
    /// C = M₀(X₂) + X₁F(X₂) − ∫₀^{X₁} \[E_Γ(Y) F_R(X₂ − Y) − Γ(Y) F_rR(X₂ − Y)\] dY − F(X₁)F(X₂).
    ///
    /// M₀(X) = ∫Q_ini(y) y F_y(X) dy, F_y the force of contacts that start at y; F_R is that of contacts that
    /// have all just re-formed, F_rR(u) = ∫R(r) r F_r(u) dr; E_Γ = 1 + r̄Γ − F' is the rate of breaks times
    /// stretch. Positions may come in any order; at a position where many contacts break together, they have
    /// broken.
    ///
    /// # Errors
    /// Contacts with a delay or with k = κ x_s; a size that is not above 0; positions outside of the pull; more
    /// than 2 GB; a required tolerance that is not reached.
    pub fn covariance(&self, positions: &[f64], size: f64) -> Result<Covariance> {
        self.covariance_with(positions, size, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::covariance`]; stopped by the monitor.
    pub fn covariance_with(
        &self,
        positions: &[f64],
        size: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Covariance> {
        let count = positions.len();
        if !(size > 0.0 && size.is_finite()) {
            return Err(Error::invalid("size", "a finite number above 0", size));
        }
        let outside = |x: &&f64| !(0.0..=self.distance() * (1.0 + 1e-12)).contains(*x);
        if let Some(x) = positions.iter().find(outside) {
            return Err(Error::invalid("positions", format!("positions from 0 to {}", self.distance()), x));
        }
        fits(
            "positions",
            "covariances of all pairs of positions",
            (count as u64).saturating_mul(24 * count as u64),
            ALLOWED,
        )?;
        let mut order: Vec<usize> = (0..count).collect();
        sort_by_number(&mut order, |&i| positions[i]);
        let sorted: Vec<f64> = order.iter().map(|&i| positions[i].min(self.distance())).collect();
        let (triangle, error) = self.lower_triangle(&sorted, monitor)?;
        let scale = self.stiffness.powi(2) / size;
        let rising = matrix::symmetric(&triangle, scale);
        let values = if order.is_sorted() { rising } else { matrix::reordered(&rising, &order) };
        let mean = positions.iter().map(|&x| self.force(x)).collect();
        Ok(Covariance { positions: positions.to_vec(), mean, values, error: scale * error })
    }

    /// C of each rising position with those up to it, per contact and unit stiffness, and its estimated error.
    fn lower_triangle(&self, positions: &[f64], monitor: &mut dyn Monitor) -> Result<(Vec<Vec<f64>>, f64)> {
        let equation = &self.equation;
        equation.contacts.renew_completely()?;
        let last = positions.last().copied().unwrap_or(0.0);
        let end = last.max(self.renewal.reformed.mean());
        let steps = (end, self.tolerance);
        let known = equation.starts_reformed().then_some(&self.renewal);
        let after = ForceAfterBreak::new(equation, known, steps, &mut Part::new(monitor, 0.0, 0.3))?;
        let initial = equation.weighted_by_stretch(&equation.initial, &mut Part::new(monitor, 0.3, 0.1))?;
        let initial = match initial {
            None => None,
            Some(WeightedLife { mean_start, life }) => {
                let part = &mut Part::new(monitor, 0.4, 0.1);
                let solved = RenewalSolution::solve(&life, &equation.reformed, end, self.tolerance, part)?;
                Some((mean_start, solved))
            }
        };
        let square = self.square(&mut Part::new(monitor, 0.5, 0.1))?;
        let breaks = LossesAtBreaks::new(
            &self.renewal,
            &after,
            initial.as_ref().map_or(0.0, |(mean, _)| *mean),
            positions,
        );
        let starting = |x: f64| initial.as_ref().map_or(0.0, |(mean, solved)| mean * at(&solved.force, x));
        let mean: Vec<f64> = positions.iter().map(|&x| at(&self.renewal.force, x)).collect();
        let row = |cuts: &mut Vec<f64>, j: usize| {
            let (start, mut row) = (starting(positions[j]), breaks.lost(j, cuts));
            for (i, entry) in row.iter_mut().enumerate() {
                *entry = start + positions[i] * mean[j] - *entry - mean[i] * mean[j];
            }
            // Where all contacts share one stretch, rounding may be negative.
            row[j] = row[j].max(0.0);
            row
        };
        let triangle = Watch::new(&mut Part::new(monitor, 0.6, 0.4)).share(positions.len(), Vec::new, row)?;
        let apart = |(j, row): (usize, &Vec<f64>)| {
            let variance = at(square, positions[j]) - mean[j] * mean[j];
            row.last().map_or(0.0, |diagonal| (diagonal - variance).abs())
        };
        let apart = largest(triangle.iter().enumerate().map(apart));
        let solved =
            initial.map_or(0.0, |(_, solved)| solved.error).max(after.error()).max(self.renewal.error);
        let unit = unit_force(&self.renewal.reformed);
        Ok((triangle, apart + solved * unit * unit))
    }
}
