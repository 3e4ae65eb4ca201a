//! The life of time-dependent contacts, at constant velocity.

use std::sync::Arc;

use super::Life;
use super::additive::AdditiveHazard;
use super::athermal::athermal_within;
use super::breaking_model::BreakingModel;
use super::cohorts::of_cohorts;
use super::smoluchowski::FokkerPlanckLife;
use super::thermal_hazard::blur;
use super::timed::Timed;
use super::waits::Waits;
use crate::Result;
use crate::contacts::{Ageing, Barrier, Closure, Contacts, FreeTime, Temperature, ThresholdFokkerPlanck};
use crate::law::SharedLaw;
use crate::monitor::{Monitor, Watch};

/// The life, at velocity v, of contacts that start at stretches drawn from `starts` at age 0, with
/// `conditional` as in [`super::athermal`]; with `delayed`, of contacts that have just broken and are free
/// for the time τ before they start.
///
/// Contacts and starts are assumed to have passed [`Contacts::check`].
///
/// # Errors
/// Ageing that has no life at a velocity; thermal breaking of contacts whose fresh thresholds have edges and
/// hardly diffuse; stopped by the monitor.
pub fn moving(
    contacts: &Contacts,
    starts: &SharedLaw,
    conditional: bool,
    velocity: f64,
    delayed: bool,
    monitor: &mut dyn Monitor,
) -> Result<Life> {
    let watch = Watch::new(monitor);
    let rules = &contacts.rules;
    // Thermal breaking that is lost in rounding is left out: fast sliding has the athermal life,
    // which is cheaper and exact.
    let thermal = rules.temperature.is_some_and(|temperature| is_felt(&temperature, contacts, velocity));
    let additive = rules.temperature.filter(Temperature::is_additive);
    let life = match (&rules.ageing, ThresholdFokkerPlanck::of(contacts)) {
        (Some(Ageing::Smoluchowski { .. }), Some(maturing)) => {
            let temperature = rules.temperature.filter(|_| thermal);
            let diffusing = Arc::new(FokkerPlanckLife::new(contacts, maturing, temperature, velocity));
            of_cohorts(contacts, diffusing, starts.as_ref(), conditional, &watch)?
        }
        (Some(Ageing::MeanField { .. }), Some(maturing)) => {
            let closure = Closure { maturing: &maturing, reforming: &contacts.reforming, velocity };
            let thresholds = closure.law(&mut &watch)?;
            athermal_within(&Contacts { thresholds, ..contacts.clone() }, starts, conditional, &watch)
        }
        (None, _) if !thermal => athermal_within(contacts, starts, conditional, &watch),
        _ => {
            let model: Arc<dyn BreakingModel> = match additive {
                Some(temperature) => Arc::new(AdditiveHazard::new(contacts, temperature, velocity, &watch)),
                None => Arc::new(Timed::new(contacts, velocity, thermal, &watch)?),
            };
            of_cohorts(contacts, model, starts.as_ref(), conditional, &watch)?
        }
    };
    watch.check()?;
    if !delayed {
        return Ok(life);
    }
    let unit = contacts.stiffness.unit();
    let friction = rules.free_friction.at(velocity) / unit;
    let delayed = match &rules.delay {
        FreeTime::Fixed(time) => life.delayed(velocity * time, friction),
        FreeTime::Distributed(law) => life.after(Waits::new(law, velocity), friction, &watch),
    };
    watch.check().map(|()| delayed)
}

/// Whether temperature breaks contacts further below their thresholds than rounding.
///
/// They break about δ ln(ωδ/v) below, or with that probability within δ = T/(k x̄); where the barrier vanishes as the power 3/2 of
/// the distance, within x̄ (2δ/x̄)^{2/3}.
fn is_felt(temperature: &Temperature, contacts: &Contacts, velocity: f64) -> bool {
    const ROUNDING: f64 = 1e-13;
    let (mean, blur) = (contacts.thresholds.mean(), blur(contacts, temperature));
    let near = match temperature.barrier {
        Barrier::Elastic | Barrier::Bell => blur,
        Barrier::Catastrophe => mean * (2.0 * blur / mean).powf(2.0 / 3.0),
    };
    near * (temperature.attempt_rate * near / velocity).ln_1p() > ROUNDING * mean
}
