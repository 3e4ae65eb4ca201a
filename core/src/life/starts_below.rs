//! Contacts that start below a threshold: those whose life changes with the probability of that threshold.

use std::sync::Arc;

use super::cells::{BULK, CELL, NEGLIGIBLE, scale, threshold_atoms, top, with_atoms};
use super::derivative::{Integrands, LawDerivatives, LifeDerivative, StartingContacts, resolved};
use super::layer::Layer;
use super::start_quadrature::StartQuadrature;
use crate::Result;
use crate::contacts::Contacts;
use crate::law::{Breakpoint, Point, SharedLaw};
use crate::monitor::Monitor;
use crate::numerics::legendre::NODES;

impl StartingContacts<'_> {
    /// ∫_{r<ξ} ν(r) h(r, u) dr and ∫_{r<ξ} ν(r) (r + u) h(r, u) dr with h = S(r + u)/S(r) and ν = R/S: survival and force
    /// of contacts with thresholds above r that start below ξ, each counted 1/S(r) times.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn renormalised_below(
        &self,
        threshold: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<LifeDerivative> {
        let law = self.contacts.thresholds.as_ref();
        let layer = Layer::placed(self.contacts, self.starts.as_ref(), true, BULK);
        let hazards = with_atoms(law);
        let mut ends = if layer.is_pointed() { Vec::new() } else { self.ends(&layer, &hazards) };
        ends.retain(|&r| r < threshold);
        if layer.density.end() > threshold && !ends.is_empty() {
            ends.push(threshold);
        }
        let weight = |r: f64, out: &mut [f64]| {
            let survival = law.survival(r);
            out[0] = if survival > 0.0 { layer.density.value(r) / survival } else { 0.0 };
        };
        let quadrature = StartQuadrature::new(&ends, CELL * scale(law), 1, weight);
        let highest = ends.last().map_or(0.0, |end| end + self.life.survival().curve().end());
        let table = Integrands::new(law, LawDerivatives { thresholds: &[], starts: &[] }, highest);
        let atoms = threshold_atoms(law);
        let values = |u: f64| {
            let mut sums = vec![0.0; 2];
            let at = |b: &Breakpoint| b.position - u;
            let cuts: Vec<f64> = hazards.iter().map(at).collect();
            let steep: Vec<f64> = hazards.iter().filter(|b| b.is_steep()).map(at).collect();
            quadrature.each(&cuts, &steep, |points, near_steep| {
                let y = points.r.map(|r| r + u);
                let values = if near_steep { table.values(&y, NODES) } else { table.tabulated(&y) };
                for j in 0..NODES {
                    let survivors = points.weights[0][j] * values[0][j];
                    sums[0] += survivors;
                    sums[1] += y[j] * survivors;
                }
            });
            for mass in layer.point_masses.iter().filter(|mass| mass.position < threshold) {
                let y = layer.exceeded(mass, u, &atoms);
                let survivors = mass.weight / law.survival(mass.position) * law.survival(y);
                sums[0] += survivors;
                sums[1] += (mass.position + u) * survivors;
            }
            sums
        };
        resolved(self.life, values, monitor).map(|mut one| one.swap_remove(0))
    }
}

impl Layer {
    /// The contacts that start at stretches drawn from `starts`: ν = R/S with `conditional`, ν = R otherwise, also above
    /// all thresholds.
    pub(crate) fn starting(contacts: &Contacts, starts: &SharedLaw, conditional: bool) -> Result<Self> {
        if conditional {
            return Ok(Self::placed(contacts, starts.as_ref(), true, BULK));
        }
        let above = 2.0 * top(starts.as_ref(), NEGLIGIBLE).max(f64::MIN_POSITIVE);
        let unlimited = Contacts { thresholds: Arc::new(Point::new(above)?), ..contacts.clone() };
        Ok(Self::placed(&unlimited, starts.as_ref(), false, BULK))
    }

    /// ∫_{r<ξ} ν(r) f(r) dr for a function that is a polynomial between `cuts`.
    pub(crate) fn sum_within(&self, threshold: f64, f: impl Fn(f64) -> f64, cuts: &[f64]) -> f64 {
        self.sum_below(threshold.next_down(), f, cuts)
    }
}
