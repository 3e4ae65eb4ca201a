//! The task of a scenario: one of the tables that are tasks.

use super::{
    Creep, Drive, Fit, HoldCurve, Protocol, Pull, Renormalisation, Scenario, Spectrum, Stability,
    VelocityCurve,
};
use crate::{Error, Result};

/// The task of a scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Task<'a> {
    /// `[pull]`: the base of the slider is moved.
    Pull(&'a Pull),
    /// `[drive]`: the top of the slider is moved, or a force is imposed.
    Drive(&'a Drive),
    /// `[[protocol]]`: the slider is moved in time, step by step.
    Protocol(&'a Protocol),
    /// `[velocity_curve]`: kinetic friction against velocity.
    VelocityCurve(&'a VelocityCurve),
    /// `[hold_curve]`: static friction against hold time.
    HoldCurve(&'a HoldCurve),
    /// `[creep]`: slip under a constant force, and the time to failure.
    Creep(&'a Creep),
    /// `[spectrum]`: the noise of steady sliding.
    Spectrum(&'a Spectrum),
    /// `[stability]`: whether a slider sticks and slips.
    Stability(&'a Stability),
    /// `[fit]`: numbers of the contacts from a measured curve.
    Fit(&'a Fit),
    /// `[renormalisation]`: the distribution of first breaks of coupled contacts.
    Renormalisation(&'a Renormalisation),
}

/// The tables that are tasks, for messages.
const TASKS: &str = "a task: one of the tables [pull], [drive], [[protocol]], [velocity_curve], [hold_curve], [creep], [spectrum], [stability], [fit] and [renormalisation]";

impl Scenario {
    /// The one task that the scenario has.
    ///
    /// # Errors
    /// No task, or more than one.
    pub fn task(&self) -> Result<Task<'_>> {
        let tasks = [
            self.pull.as_ref().map(Task::Pull),
            self.drive.as_ref().map(Task::Drive),
            self.protocol.as_ref().map(Task::Protocol),
            self.velocity_curve.as_ref().map(Task::VelocityCurve),
            self.hold_curve.as_ref().map(Task::HoldCurve),
            self.creep.as_ref().map(Task::Creep),
            self.spectrum.as_ref().map(Task::Spectrum),
            self.stability.as_ref().map(Task::Stability),
            self.fit.as_ref().map(Task::Fit),
            self.renormalisation.as_ref().map(Task::Renormalisation),
        ];
        let mut given = tasks.into_iter().flatten();
        let Some(task) = given.next() else {
            return Err(match &self.protocol_file {
                Some(file) => {
                    Error::invalid("protocol_file", "the steps that a file holds", format!("{file}, unread"))
                }
                None => Error::invalid("pull", TASKS, "none"),
            });
        };
        if let Some(second) = given.next() {
            let found = format!("{} beside {}", second.name(), task.name());
            return Err(Error::invalid(second.name(), "only one task", found));
        }
        match &self.protocol_file {
            Some(_) => {
                let found = format!("protocol_file beside {}", task.name());
                Err(Error::invalid("protocol_file", "only one task", found))
            }
            None => Ok(task),
        }
    }
}

impl Task<'_> {
    /// The name of its table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pull(_) => "pull",
            Self::Drive(_) => "drive",
            Self::Protocol(_) => "protocol",
            Self::VelocityCurve(_) => "velocity_curve",
            Self::HoldCurve(_) => "hold_curve",
            Self::Creep(_) => "creep",
            Self::Spectrum(_) => "spectrum",
            Self::Stability(_) => "stability",
            Self::Fit(_) => "fit",
            Self::Renormalisation(_) => "renormalisation",
        }
    }

    pub(super) fn check_values(self) -> Result<()> {
        match self {
            Self::Pull(pull) => pull.check(),
            Self::Drive(drive) => drive.check(),
            Self::Protocol(protocol) => protocol.check(),
            Self::VelocityCurve(curve) => curve.check(),
            Self::HoldCurve(curve) => curve.check(),
            Self::Creep(task) => task.check(),
            Self::Spectrum(task) => task.check(),
            Self::Stability(task) => task.check(),
            Self::Fit(task) => task.check(),
            Self::Renormalisation(task) => task.check(),
        }
        .map_err(|e| e.under(self.name()))
    }
}
