//! How what a pull is computed from, the lives of the contacts, changes with a parameter.

use super::MasterEquation;
use super::parameters::Named;
use crate::Result;
use crate::contacts::{FreeTime, Start};
use crate::law::SurvivalDerivative;
use crate::life::{LawDerivatives, LifeDerivative, StartingContacts};
use crate::monitor::{Monitor, Part};

/// The derivatives of the lives and of N_c⟨k⟩ by a parameter θ.
#[derive(Debug, Clone, Default)]
pub(super) struct LifeChange {
    /// Of the life of the contacts at X = 0; `None` for 0.
    pub(super) first: Option<LifeDerivative>,
    /// Of the life of contacts that re-form, without what `wait` does.
    pub(super) reformed: Option<LifeDerivative>,
    /// ∂w/∂θ of the advance w for which contacts are free before they re-form, by which their life is shifted.
    pub(super) wait: f64,
    /// ∂ ln(N_c⟨k⟩)/∂θ.
    pub(super) scale: f64,
}

impl MasterEquation {
    /// The changes by several parameters: in closed form by those of the distributions of time-independent contacts of
    /// equal stiffness, all in one pass; else by differences of the lives.
    pub(super) fn life_changes(&self, names: &[&str], monitor: &mut dyn Monitor) -> Result<Vec<LifeChange>> {
        let named = names.iter().map(|name| self.named(name)).collect::<Result<Vec<_>>>()?;
        let by_laws = named.iter().map(|named| self.law_derivative(*named)).collect::<Result<Vec<_>>>()?;
        let closed = !self.contacts.rules.are_time_dependent() && self.contacts.stiffness.is_equal();
        if closed {
            let by_laws = by_laws.into_iter().flatten().collect();
            return self.closed_changes(&named, by_laws, monitor);
        }
        let share = 1.0 / names.len().max(1) as f64;
        let parts = named.iter().enumerate();
        parts
            .map(|(k, &named)| self.change(named, &mut Part::new(monitor, k as f64 * share, share)))
            .collect()
    }

    /// ∂S/∂θ of the distribution that a parameter belongs to, if it does.
    fn law_derivative(&self, named: Named<'_>) -> Result<Option<(&'static str, SurvivalDerivative)>> {
        let Named::OfLaw(owner, name) = named else { return Ok(None) };
        let mut all = self.description();
        let Some(law) = all.law(owner) else { return Ok(None) };
        law.survival_derivative(name)
            .map(|derivative| Some((owner, derivative)))
            .map_err(|error| error.under(owner))
    }

    /// The changes where lives have derivatives in closed form; `by_laws` are those of the distributions, in order.
    fn closed_changes(
        &self,
        named: &[Named<'_>],
        by_laws: Vec<(&str, SurvivalDerivative)>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<LifeChange>> {
        let [mut thresholds, mut reforming, mut initial] = [const { Vec::new() }; 3];
        for (owner, derivative) in by_laws {
            match owner {
                "thresholds" => thresholds.push(derivative),
                "reforming" => reforming.push(derivative),
                _ => initial.push(derivative),
            }
        }
        let starting = |starts, conditional, life| StartingContacts {
            contacts: &self.contacts,
            starts,
            conditional,
            life,
        };
        let conditional = self.initial.start == Start::Conditional;
        let mut first = starting(&self.initial.law, conditional, &self.first).derivatives(
            LawDerivatives { thresholds: &thresholds, starts: &initial },
            &mut Part::new(monitor, 0.0, 0.5),
        )?;
        let by_initial = first.split_off(thresholds.len());
        let alike = self.starts_reformed();
        let mut reformed = starting(&self.contacts.reforming, true, &self.reformed).derivatives(
            LawDerivatives { thresholds: if alike { &[] } else { &thresholds }, starts: &reforming },
            &mut Part::new(monitor, 0.5, 0.5),
        )?;
        let by_reforming = reformed.split_off(if alike { 0 } else { thresholds.len() });
        let reformed = if alike { first.clone() } else { reformed };
        let mut by_thresholds = first.into_iter().zip(reformed);
        let (mut by_initial, mut by_reforming) = (by_initial.into_iter(), by_reforming.into_iter());
        let change = |named: &Named<'_>| match named {
            Named::OfLaw("thresholds", _) => {
                let (first, reformed) = by_thresholds.next().unzip();
                LifeChange { first, reformed, ..LifeChange::default() }
            }
            Named::OfLaw("reforming", _) => {
                LifeChange { reformed: by_reforming.next(), ..LifeChange::default() }
            }
            Named::OfLaw(..) => LifeChange { first: by_initial.next(), ..LifeChange::default() },
            Named::Number(_) => {
                LifeChange { scale: 1.0 / self.description().value(*named), ..LifeChange::default() }
            }
        };
        Ok(named.iter().map(change).collect())
    }

    /// The change by one parameter, with differences of the lives if it changes them by more than a shift.
    fn change(&self, named: Named<'_>, monitor: &mut dyn Monitor) -> Result<LifeChange> {
        let (all, rules) = (self.description(), &self.contacts.rules);
        let reshapes = match named {
            Named::Number("count" | "delay") => false,
            // Barriers are proportional to the stiffness.
            // So are lengths of the force of free contacts.
            Named::Number("stiffness" | "stiffness_per_threshold") => {
                rules.temperature.is_some() || !rules.free_friction.is_none()
            }
            Named::Number("velocity") => {
                let friction = rules.free_friction.viscosity > 0.0;
                rules.temperature.is_some()
                    || rules.ageing.is_some()
                    || rules.delay.law().is_some()
                    || friction
            }
            _ => true,
        };
        let mut change = LifeChange::default();
        if reshapes {
            let [first, reformed] = self.life_differences(named, monitor)?.map(Some);
            change = LifeChange { first, reformed, ..change };
        }
        match named {
            Named::OfLaw("reforming" | "delay", _) => change.first = None,
            Named::OfLaw("initial", _) => change.reformed = None,
            Named::Number("count" | "stiffness" | "stiffness_per_threshold") => {
                change.scale = 1.0 / all.value(named);
            }
            // The advance for which contacts are free is v times the delay.
            Named::Number("delay") => change.wait = self.velocity.unwrap_or_default(),
            Named::Number("velocity") => {
                if let FreeTime::Fixed(time) = rules.delay {
                    change.wait = time;
                }
            }
            _ => {}
        }
        Ok(change)
    }
}
