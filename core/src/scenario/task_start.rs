//! The start of a task: how its contacts begin, and which tasks begin in steady sliding.

use super::interface::no_steady_ensemble;
use super::{Disorder, Drive, Model, PerCell, Protocol, Pull, Task, TaskStart};
use crate::contacts::Contacts;
use crate::{Error, Result};

impl Task<'_> {
    /// The contacts at its start.
    pub(super) fn start(self) -> TaskStart {
        match self {
            Self::Pull(pull) => pull.start,
            Self::Drive(drive) => drive.start,
            Self::Protocol(protocol) => protocol.start(),
            Self::Fit(fit) => fit.start.into(),
            _ => TaskStart::Conditional,
        }
    }

    /// The velocity of the steady sliding in which contacts are at its start, if it begins with it and follows them in time.
    pub(super) fn steady_velocity(self, contacts: &Contacts) -> Option<f64> {
        if self.start() != TaskStart::Steady {
            return None;
        }
        match self {
            Self::Protocol(Protocol(steps)) => steps.first().and_then(|step| step.velocity),
            Self::Drive(drive) => drive.velocity.filter(|_| contacts.rules.are_time_dependent()),
            _ => None,
        }
    }

    /// Refuses what does not begin in steady sliding.
    pub(super) fn check_start(self, model: &Model) -> Result<()> {
        if self.start() != TaskStart::Steady {
            return Ok(());
        }
        if let Some(ensemble) = &model.ensemble
            && ensemble.disorder == Disorder::Quenched
        {
            let expected = "annealed beside start = \"steady\": contacts that keep their thresholds slide steadily in another way";
            return Err(Error::invalid("ensemble.disorder", expected, "quenched"));
        }
        let timed = model.contacts.rules.are_time_dependent();
        let refused = |expected: &str| {
            let key = format!("{}.start", self.name());
            Err(Error::invalid(key, expected, "steady"))
        };
        match self {
            Self::Pull(_) if timed => refused(
                "conditional or relaxed for time-dependent contacts: pulled on at the velocity of steady sliding they stay at F_k ([[protocol]] has other velocities)",
            ),
            Self::Pull(Pull { derivatives: true, .. }) => refused(
                "conditional or relaxed beside pull.derivatives, which leave initial stretches as they are",
            ),
            Self::Drive(Drive { force_to: Some(_), .. }) => {
                refused("conditional or relaxed beside drive.force_to, a force that begins at 0")
            }
            Self::Drive(_) if model.interface.as_ref().is_some_and(|own| own.contacts == PerCell::One) => {
                refused(
                    "conditional or relaxed for contacts coupled one by one, whose steady sliding is another one",
                )
            }
            _ if timed
                && model.ensemble.is_some()
                && (model.block.is_some() || model.interface.is_some()) =>
            {
                Err(no_steady_ensemble())
            }
            _ => Ok(()),
        }
    }
}
