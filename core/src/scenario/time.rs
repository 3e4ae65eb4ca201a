//! Checks of tasks with time-dependent contacts.

use super::{Model, PerCell, Scenario, Task, TaskStart, VelocityCurve};
use crate::contacts::{Ageing, Contacts};
use crate::{Error, Result};

impl Task<'_> {
    /// Checks that a task with time-dependent contacts has a velocity, and that all rules apply to it.
    pub(super) fn check_time(self, model: &Model) -> Result<()> {
        if let Task::VelocityCurve(curve) = self {
            temperatures(curve, &model.contacts)?;
        }
        if matches!(model.contacts.rules.ageing, Some(Ageing::MeanField { .. })) {
            self.shared_thresholds(model)?;
        }
        model.contacts.break_by_own_threshold().or_else(|refused| self.at_one_velocity(model, refused))?;
        if matches!(self, Task::Protocol(_) | Task::HoldCurve(_) | Task::Creep(_))
            && model.interface.is_none()
        {
            model.contacts.have_no_stiffness_table().map_err(Error::of_scenario)?;
        }
        let Some(rule) = model.contacts.rules.first() else { return Ok(()) };
        match self {
            Task::Pull(pull) => velocity(pull.velocity, rule),
            Task::Spectrum(task) => velocity(task.velocity, rule),
            Task::Stability(task) => velocities(&task.velocities, rule),
            Task::Fit(task) if task.velocity_curve.is_none() => velocity(task.velocity, rule),
            Task::Drive(drive) => velocity(drive.velocity, rule).and_then(|()| drive.forward().map(drop)),
            _ => Ok(()),
        }
        .map_err(|e| e.under(self.name()))
    }

    /// Refuses, with this error, tasks in which the velocity varies, or the response of sliding to such a variation is sought.
    fn at_one_velocity(self, model: &Model, refused: Error) -> Result<()> {
        match self {
            Task::Pull(pull) if pull.start != TaskStart::Steady => Ok(()),
            Task::VelocityCurve(curve) if !curve.stability => Ok(()),
            Task::Spectrum(_) | Task::Fit(_) if model.interface.is_none() => Ok(()),
            _ => Err(refused.of_scenario()),
        }
    }

    /// Refuses tasks that do not follow the distribution of thresholds that contacts share, and contacts for which it is not
    /// known.
    fn shared_thresholds(self, model: &Model) -> Result<()> {
        let key = "contacts.ageing.mean_field";
        // Whatever the thresholds and the seed are.
        if model.interface.as_ref().is_some_and(|interface| interface.contacts == PerCell::One) {
            let expected = "ageing by a rule for single contacts where they are coupled one by one";
            return Err(Error::invalid(key, expected, "a closure"));
        }
        if model.ensemble.is_some() {
            let expected = format!("no ensemble beside {key}, which has no rule for one contact");
            return Err(Error::invalid("ensemble", expected, "one"));
        }
        match self {
            Task::VelocityCurve(VelocityCurve { stability: true, .. }) => {
                let expected = format!("no stability of sliding with {key}");
                Err(Error::invalid("velocity_curve.stability", expected, true))
            }
            Task::VelocityCurve(_) => Ok(()),
            Task::Fit(fit) if fit.velocity_curve.is_some() => Ok(()),
            Task::Protocol(_) | Task::HoldCurve(_) => moving(&model.contacts),
            Task::Drive(_) if model.interface.is_some() => moving(&model.contacts),
            _ => {
                let expected = "a task in which contacts that share thresholds are followed: [[protocol]], [hold_curve], [drive] with [interface], or [velocity_curve]";
                Err(Error::invalid(key, expected, format!("[{}]", self.name())))
            }
        }
    }
}

/// Refuses contacts whose shared thresholds are not followed in time.
fn moving(contacts: &Contacts) -> Result<()> {
    contacts.have_equal_stiffness().map_err(Error::of_scenario)?;
    let Some(atom) = contacts.thresholds.atoms().into_iter().next() else { return Ok(()) };
    let expected = "a distribution without point masses beside contacts.ageing.mean_field in motion";
    Err(Error::invalid("contacts.thresholds", expected, format!("one at {}", atom.position)))
}

impl Scenario {
    /// Checks that a run can be stopped and resumed; `key` is the option that needs it.
    ///
    /// # Errors
    /// A scenario other than `[drive]` or `[[protocol]]` with `[interface]`.
    pub fn keeps_checkpoints(&self, key: &str) -> Result<()> {
        let found = match &self.interface {
            Some(_) if self.drive.is_some() || self.protocol.is_some() => return Ok(()),
            Some(_) => "one of another task, which has no checkpoints",
            None => "one without, which has no checkpoints",
        };
        Err(Error::invalid(key, "a scenario of [drive] or [[protocol]] with [interface]", found))
    }

    /// Warnings about valid values with unexpected consequences; `contacts` are those of this scenario.
    pub(super) fn warnings(&self, contacts: &Contacts) -> Vec<String> {
        let rules = &contacts.rules;
        let mature = rules.ageing.as_ref().and_then(Ageing::mature).map(|law| law.mean());
        let fresh = contacts.thresholds.mean();
        let mut warnings = Vec::new();
        if let Some(mature) = mature.filter(|mature| *mature < fresh) {
            warnings.push(format!(
                "contacts.ageing: the mature thresholds are weaker than those at formation, with the means {mature} and {fresh}: contacts weaken with age"
            ));
        }
        if rules.first().is_none() {
            if self.hold_curve.is_some() {
                warnings
                    .push("hold_curve: nothing in [contacts] depends on time: a hold changes nothing".into());
            }
            if self.creep.is_some() {
                warnings.push(
                    "creep: nothing in [contacts] depends on time: the slider stays where the force is carried, or fails at once"
                        .into(),
                );
            }
            if self.velocity_curve.is_some() {
                warnings.push("velocity_curve: nothing in [contacts] depends on time: friction is the same at all velocities".into());
            }
        }
        warnings.extend(self.without_effect(contacts));
        warnings
    }
}

fn velocity(given: Option<f64>, rule: &str) -> Result<()> {
    let missing = || {
        Error::invalid(
            "velocity",
            format!("a velocity above 0, since contacts.{rule} makes contacts time-dependent"),
            "none",
        )
    };
    given.map(drop).ok_or_else(missing)
}

fn velocities(given: &[f64], rule: &str) -> Result<()> {
    if given.is_empty() {
        let expected = format!("velocities above 0, since contacts.{rule} makes contacts time-dependent");
        return Err(Error::invalid("velocities", expected, "none"));
    }
    Ok(())
}

/// Refuses temperatures of a curve without `contacts.temperature`.
fn temperatures(curve: &VelocityCurve, contacts: &Contacts) -> Result<()> {
    if curve.temperatures.is_empty() || contacts.rules.temperature.is_some() {
        return Ok(());
    }
    let expected = "a table contacts.temperature, whose energy they take the place of";
    Err(Error::invalid("velocity_curve.temperatures", expected, "none"))
}
