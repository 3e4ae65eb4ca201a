//! The plain values of distributions, contacts, models and sliders, as in a scenario.

use asperity::scenario::{self, Areas, Contacts, Drive, Law, Renormalisation, Scenario, Slip, TaskStart};
use serde::{Deserialize, Serialize};
use toml::Value;

/// The plain values of a description, as in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plain {
    Law(Law),
    Areas(Areas),
    Contacts(Contacts),
    Temperature(scenario::Temperature),
    Ageing(scenario::Ageing),
    MasterEquation(Interface, Solved),
    Transport(Interface, Solved),
    Step(scenario::Step),
    Ensemble(Interface, scenario::Ensemble),
    Slip(Slip),
    Block(Slider),
    Surface(Box<Surface>),
}

/// Contacts and their initial state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    pub contacts: Contacts,
    pub initial: Law,
    pub start: TaskStart,
}

/// The settings of a master equation: tolerance and, for time-dependent contacts or steady sliding, velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solved {
    pub own: scenario::MasterEquation,
    pub velocity: Option<f64>,
}

/// A slider, and the model of the contacts under it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slider {
    pub model: Box<Plain>,
    /// `None` for a rigid slider.
    pub stiffness: Option<f64>,
    pub slip: Slip,
    pub slip_fraction: f64,
}

impl Slider {
    /// The stiffness and the slips as in a scenario; `None` for a rigid slider.
    pub fn table(&self) -> Option<scenario::Block> {
        let Self { stiffness, slip, slip_fraction, .. } = *self;
        stiffness.map(|stiffness| scenario::Block { stiffness, slip, slip_fraction })
    }
}

impl Plain {
    /// The values as a part of a scenario; `None` if it has no place there.
    pub fn toml(&self) -> Option<Value> {
        let value = match self {
            Self::Law(law) => Value::try_from(law),
            Self::Areas(areas) => Value::try_from(areas),
            Self::Contacts(contacts) => Value::try_from(contacts),
            Self::Slip(slip) => Value::try_from(slip),
            Self::Temperature(temperature) => Value::try_from(temperature),
            Self::Ageing(ageing) => Value::try_from(ageing),
            Self::Step(step) => Value::try_from(step),
            Self::MasterEquation(..)
            | Self::Transport(..)
            | Self::Ensemble(..)
            | Self::Block(_)
            | Self::Surface(_) => return None,
        };
        value.ok()
    }
}

/// A deformable interface, and the initial state of its contacts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    pub contacts: Interface,
    pub own: scenario::Interface,
    pub ensemble: Option<scenario::Ensemble>,
}

impl Surface {
    /// The scenario of a drive.
    pub fn scenario(&self, drive: Drive) -> Scenario {
        let Interface { contacts, initial, start } = self.contacts.clone();
        Scenario {
            initial,
            drive: Some(Drive { start, ..drive }),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }

    /// The scenario of first breaks.
    pub fn first_breaks(&self, asked: Renormalisation) -> Scenario {
        let Interface { contacts, initial, .. } = self.contacts.clone();
        Scenario {
            initial,
            renormalisation: Some(asked),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }
}
