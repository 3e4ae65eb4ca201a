//! Steady sliding to begin with: cohorts of all ages, as one that ages leaves them behind.

use super::Transport;
use super::broken::Broken;
use super::cohort::Cohort;
use super::model::Tools;
use super::path::{Path, StepPart};
use std::sync::Arc;

use crate::Result;
use crate::contacts::{Contacts, Initial, Start, ThresholdEvolution};
use crate::law::Point;
use crate::monitor::{Monitor, Watch};

/// The share of contacts that breaks in a panel of ages, in units of the fourth root of the tolerance.
const DEATHS: f64 = 3.0;

/// By how much that may differ between the halves of a panel, times the share of the panel in a life, in tolerances.
const BEND: f64 = 12.0;

impl Transport {
    /// Contacts in steady sliding at a velocity v: born at the rate Γ_s = 1/(∫s da + τ), with s(a) what is left of them at
    /// the age a. Time and position are 0.
    ///
    /// # Errors
    /// Those of [`Transport::new`]; a velocity that is not above 0.
    pub fn steady(
        contacts: &Contacts,
        velocity: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        super::positive("velocity", velocity)?;
        contacts.check(&relaxed())?;
        let strength = super::strength(contacts, monitor)?;
        let mut sliding = |tolerance| Self::sliding(contacts, strength.clone(), velocity, tolerance, monitor);
        Ok(sliding(tolerance)?.beside(sliding(super::rough(tolerance))?))
    }

    fn sliding(
        contacts: &Contacts,
        strength: Option<ThresholdEvolution>,
        velocity: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut transport = Self::empty(contacts, strength, tolerance, monitor)?;
        let most = (DEATHS * tolerance.powf(0.25)).min(0.5);
        let bend = BEND * tolerance * contacts.thresholds.mean() / velocity;
        let mut walkers = transport.formed(&transport.seeds, monitor)?;
        let watch = Watch::new(monitor);
        let mut tools = Tools::new(&watch);
        let mut duration = transport.pace.longest(velocity);
        let held = |cohorts: &[Cohort]| cohorts.iter().map(Cohort::attached).sum::<f64>();
        while held(&walkers) > super::LEAST * tolerance {
            let path = Path::steady(velocity, duration);
            let mut after = walkers.clone();
            let mut go =
                |cohort: &mut Cohort, part| cohort.advance(&transport.model, &path, part, &mut tools).0;
            let mut both = |part| {
                let one = |cohort: &mut Cohort| watch.check().map(|()| go(cohort, part));
                after.iter_mut().map(one).sum::<Result<f64>>()
            };
            let (first, second) = (both(StepPart::First)?, both(StepPart::Second)?);
            let lost = (first + second).max(most / bend * duration * (first - second).abs());
            if lost > most && duration * velocity > SHORTEST * contacts.thresholds.mean() {
                duration *= 0.5;
                continue;
            }
            for walker in &walkers {
                watch.check()?;
                for (part, ends) in [(StepPart::Late, [0.0, 0.5]), (StepPart::Early, [0.5, 1.0])] {
                    let mut cohort = walker.clone();
                    go(&mut cohort, part);
                    let (from, to) = part.ends();
                    let at = to - from;
                    cohort.place.below += path.advance(ends[0], at);
                    cohort.place.above += path.advance(at, ends[1]);
                    cohort.mass *= 0.5 * duration;
                    transport.cohorts.push(cohort);
                }
            }
            watch.check()?;
            walkers = after;
            if lost < 0.5 * most {
                duration = (2.0 * duration).min(transport.pace.longest(velocity));
            }
        }
        let rate = 1.0 / (held(&transport.cohorts) + contacts.rules.delay);
        transport.cohorts.iter_mut().for_each(|cohort| cohort.mass *= rate);
        transport.broken = Broken::steadily(contacts.rules.delay, rate);
        transport.rate = rate;
        Ok(transport)
    }
}

/// No contacts to begin with are stretched.
pub(super) fn relaxed() -> Initial {
    let law = Point::new(0.0).expect("0 is a place");
    Initial { law: Arc::new(law), start: Start::Conditional }
}

/// Panels no shorter than that, in mean thresholds, are halved no further: where many break together, they do so in the shortest.
const SHORTEST: f64 = 1e-6;
