//! All that changes as the contacts of a master equation are moved, to be kept and taken up again.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::MasterPopulation;
use crate::Result;
use crate::life::{Layer, Life, life_of};
use crate::master::loading::LoadingBranch;
use crate::monitor::Monitor;
use crate::population::Direction;
use crate::rate_dependent::ContactsState;

/// Contacts at the beginning of a loading branch.
#[derive(Serialize, Deserialize)]
enum Beginning {
    /// Those at X = 0.
    Start,
    /// All have just re-formed.
    Fresh,
    /// Any others, seen along the branch.
    Layers(Vec<Layer>),
}

/// What contacts have come to: how the loading branch begins, how far it is solved, which decides on the solution, and
/// where the slider is on it. The branch is solved again when it is taken up.
#[derive(Serialize, Deserialize)]
struct MasterPopulationState {
    beginning: Beginning,
    held: bool,
    end: f64,
    direction: Direction,
    origin: f64,
    furthest: f64,
    cell: usize,
    behind: f64,
    /// Whether the way back has been looked at.
    back: bool,
    moved: Direction,
    looked: Direction,
    holding: bool,
    free: f64,
    lost: f64,
    broken: f64,
    inherited: f64,
    worst: f64,
}

impl MasterPopulation {
    /// What the contacts have come to.
    pub(super) fn kept(&self) -> ContactsState {
        let first = self.branch.first();
        let beginning = if Arc::ptr_eq(first, &self.start) {
            Beginning::Start
        } else if Arc::ptr_eq(first, &self.interface.reformed) {
            Beginning::Fresh
        } else {
            Beginning::Layers(first.layers().to_vec())
        };
        ContactsState::of(&MasterPopulationState {
            beginning,
            held: self.branch.is_held(),
            end: self.branch.end(),
            direction: self.direction,
            origin: self.origin,
            furthest: self.furthest,
            cell: self.cell,
            behind: self.behind,
            back: self.back.is_some(),
            moved: self.moved,
            looked: self.looked,
            holding: self.holding,
            free: self.free,
            lost: self.lost,
            broken: self.broken,
            inherited: self.inherited,
            worst: self.worst,
        })
    }

    /// Goes to what other contacts of the same description have come to.
    pub(super) fn take_up(&mut self, state: &ContactsState, monitor: &mut dyn Monitor) -> Result<()> {
        let kept: MasterPopulationState = state.read()?;
        let first: Arc<Life> = match kept.beginning {
            Beginning::Start => self.start.clone(),
            Beginning::Fresh => self.interface.reformed.clone(),
            Beginning::Layers(layers) => Arc::new(life_of(&self.interface.contacts, layers, monitor)?),
        };
        let branch = if kept.held {
            LoadingBranch::held(first)
        } else {
            let tolerance = self.interface.tolerance;
            LoadingBranch::renewed(first, &self.interface.reformed, kept.end, tolerance, monitor)?
        };
        self.branch = Arc::new(branch);
        (self.direction, self.origin) = (kept.direction, kept.origin);
        (self.furthest, self.cell, self.behind) = (kept.furthest, kept.cell, kept.behind);
        (self.moved, self.looked, self.holding) = (kept.moved, kept.looked, kept.holding);
        (self.free, self.lost, self.broken) = (kept.free, kept.lost, kept.broken);
        (self.inherited, self.worst) = (kept.inherited, kept.worst);
        (self.back, self.marked) = (None, None);
        if kept.back {
            self.unloading_branch(monitor)?;
        }
        Ok(())
    }
}
