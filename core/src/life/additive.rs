//! Contacts that break at their threshold, or thermally at the rate of the average contact of their stretch.

use std::sync::Arc;

use super::breaking_model::{BlurredEdge, BreakingModel, Cohort, Passing, SurvivalMoments};
use super::cells::{NEGLIGIBLE, with_atoms};
use super::thermal_hazard::blur;
use super::timed::resolution;
use crate::contacts::{AveragedRate, Contacts, Temperature};
use crate::law::{Breakpoint, SharedLaw};
use crate::monitor::Watch;

/// Contacts of the additive hazard P(x) + r_T(x)/v (O. M. Braun and M. Peyrard, Phys. Rev. E 82, 036117 (2010)).
///
/// Of those formed at r the fraction S(x) e^{−A(x)} survives at x = r + u, with A(x) = (1/v) ∫_r^x r_T. Thermal breaking takes
/// contacts of all thresholds alike, so that the survivors have the thresholds of P_c above x.
#[derive(Debug, Clone)]
pub(super) struct AdditiveHazard {
    law: SharedLaw,
    /// Breakpoints and point masses of P_c.
    hazards: Arc<[Breakpoint]>,
    rate: Arc<AveragedRate>,
    velocity: f64,
    /// The length over which temperature blurs the breaking of contacts.
    blur: f64,
    resolution: f64,
}

/// The contacts formed at one stretch.
#[derive(Debug)]
struct AdditiveCohort {
    of: AdditiveHazard,
    start: f64,
}

impl AdditiveHazard {
    /// Contacts that move at `velocity`. Invalid if the monitor asks to stop.
    pub(super) fn new(
        contacts: &Contacts,
        temperature: Temperature,
        velocity: f64,
        watch: &Watch<'_>,
    ) -> Self {
        let law = contacts.thresholds.clone();
        let hazards = with_atoms(law.as_ref());
        Self {
            rate: Arc::new(AveragedRate::new(contacts, temperature, watch)),
            blur: blur(contacts, &temperature),
            resolution: resolution(contacts, &hazards),
            hazards: hazards.into(),
            law,
            velocity,
        }
    }

    /// e^{−A}.
    fn left(&self, start: f64, advance: f64) -> f64 {
        (-self.rate.integral(start, advance) / self.velocity).exp()
    }
}

impl BreakingModel for AdditiveHazard {
    fn cohort(&self, start: f64, _watch: &Watch<'_>) -> Arc<dyn Cohort> {
        Arc::new(AdditiveCohort { of: self.clone(), start })
    }

    fn making_fraction(&self) -> f64 {
        0.0
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn tells_of_edges(&self) -> bool {
        true
    }

    fn passing(&self, advance: f64) -> Vec<Passing> {
        let pass = |hazard: &Breakpoint| {
            let start = hazard.position - advance;
            let broken = if hazard.is_atom() { hazard.amplitude } else { 0.0 };
            (start >= 0.0 && start < hazard.position).then(|| Passing {
                start,
                weight: broken * self.left(start, advance),
                speed: 1.0,
            })
        };
        self.hazards.iter().filter_map(pass).collect()
    }
}

impl Cohort for AdditiveCohort {
    fn survival_moments(&self, advance: f64, _watch: &Watch<'_>) -> SurvivalMoments {
        let AdditiveHazard { law, rate, velocity, .. } = &self.of;
        let stretch = self.start + advance;
        let left = self.of.left(self.start, advance);
        let unbroken = [0, 1, 2].map(|order| left * law.upper_moment(order, stretch));
        let (met, thermal) = (left * law.density(stretch), rate.at(stretch) / velocity);
        let breaking = [met + thermal * unbroken[0], met * stretch + thermal * unbroken[1]];
        SurvivalMoments { unbroken, breaking }
    }

    fn breakpoints(&self, _watch: &Watch<'_>) -> Vec<Breakpoint> {
        let meet = |hazard: &Breakpoint| {
            let advance = hazard.position - self.start;
            let amplitude = hazard.amplitude * self.of.left(self.start, advance);
            Breakpoint { position: advance, amplitude, ..*hazard }
        };
        // Where contacts start, only breakpoints that jumps of derivatives do not describe.
        let shows = |b: &&Breakpoint| b.position > self.start || b.position == self.start && b.is_steep();
        let rare = |b: &Breakpoint| b.is_atom() && b.amplitude <= NEGLIGIBLE;
        let all = self.of.hazards.iter().filter(shows).map(meet);
        all.filter(|b| b.amplitude != 0.0 && !rare(b)).collect()
    }

    fn blurred_edges(&self) -> Vec<BlurredEdge> {
        let met = self.of.hazards.iter().map(|hazard| hazard.position - self.start);
        met.filter(|&advance| advance > 0.0)
            .map(|advance| BlurredEdge { advance, width: self.of.blur })
            .collect()
    }
}
