//! Snapshots of a lattice, to resume from.

use serde::{Deserialize, Serialize};

use super::avalanche::OngoingAvalanche;
use super::births::BirthRecord;
use super::clocks::ClocksState;
use super::{Lattice, Minima};
use crate::numerics::compensated::Compensated;
use crate::{Error, Result};

/// The state of a lattice. One with the same description continues from it bit for bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LatticeState {
    base: f64,
    drive: f64,
    stretch: Compensated,
    /// Where contacts break, along rows.
    ends: Vec<f64>,
    born: Vec<BirthRecord>,
    /// An avalanche that goes on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ongoing: Option<StoppedAvalanche>,
    /// The times of contacts that move at a velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clocks: Option<ClocksState>,
}

/// An avalanche within which a lattice was stopped.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct StoppedAvalanche {
    sums: OngoingAvalanche,
    /// The contacts of the generation that goes on, those of the next one so far, and those that have broken, along rows.
    front: Vec<usize>,
    following: Vec<usize>,
    scar: Vec<usize>,
    /// The stretch that each contact of this generation has released, as far as they have broken.
    released: Vec<f64>,
}

impl Lattice {
    /// The present state.
    pub fn state(&self) -> LatticeState {
        let ends = (0..self.size()).map(|number| self.ends[self.grid.place(number)]).collect();
        let numbers = |places: &[u32]| places.iter().map(|&place| self.grid.number(place as usize)).collect();
        let stopped = |sums| StoppedAvalanche {
            sums,
            front: numbers(&self.front),
            following: numbers(&self.following),
            scar: numbers(&self.scar),
            released: self.released.clone(),
        };
        LatticeState {
            base: self.base,
            drive: self.drive,
            stretch: self.stretch,
            ends,
            born: self.born.clone(),
            ongoing: self.ongoing.map(stopped),
            clocks: self.clocks.as_ref().map(|clocks| {
                clocks.state(|number| self.grid.place(number), |place| self.grid.number(place))
            }),
        }
    }

    /// Restores a state of a lattice with the same description; the list of contacts in the last avalanche is
    /// then empty, unless it goes on.
    ///
    /// # Errors
    /// A state with another number of contacts, or with another kind of thresholds; one of contacts that move at a velocity
    /// where these do not, and the other way round.
    pub fn restore(&mut self, state: LatticeState) -> Result<()> {
        let LatticeState { base, drive, stretch, ends, born, ongoing, clocks } = state;
        if (ends.len(), born.len()) != (self.size(), self.born.len()) {
            let expected =
                format!("{} contacts, {} of them with thresholds drawn", self.size(), self.born.len());
            let found = format!("{}, {} of them with thresholds drawn", ends.len(), born.len());
            return Err(Error::invalid("state", expected, found));
        }
        let in_time =
            |with: bool| if with { "contacts at a velocity" } else { "contacts without a velocity" };
        if clocks.is_some() != self.clocks.is_some() {
            return Err(Error::invalid("state", in_time(self.clocks.is_some()), in_time(clocks.is_some())));
        }
        if clocks.as_ref().is_some_and(|clocks| !clocks.fits(self.size())) {
            return Err(Error::invalid("state", format!("times of {} contacts", self.size()), "others"));
        }
        let known = |stopped: &StoppedAvalanche| {
            let StoppedAvalanche { sums, front, following, scar, released } = stopped;
            front.iter().chain(following).chain(scar).all(|&number| number < self.size())
                && sums.generation.distributed <= released.len()
                && released.len() <= front.len()
        };
        if !ongoing.as_ref().is_none_or(known) {
            let expected = format!("an avalanche of contacts below {}", self.size());
            return Err(Error::invalid("state", expected, "one of others"));
        }
        for (number, &end) in ends.iter().enumerate() {
            self.ends[self.grid.place(number)] = end;
        }
        (self.base, self.drive, self.stretch, self.born) = (base, drive, stretch, born);
        if let (Some(own), Some(clocks)) = (&mut self.clocks, clocks) {
            own.restore(clocks, |number| self.grid.place(number));
        }
        self.minima = Minima::new(self.keys());
        self.resume(ongoing);
        Ok(())
    }

    /// Continues within an avalanche, or between two.
    fn resume(&mut self, stopped: Option<StoppedAvalanche>) {
        self.scar.drain(..).for_each(|place| self.broken[place as usize] = false);
        [&mut self.front, &mut self.following].into_iter().for_each(Vec::clear);
        self.released.clear();
        self.ongoing = stopped.as_ref().map(|stopped| stopped.sums);
        let Some(StoppedAvalanche { front, following, scar, released, .. }) = stopped else { return };
        let place = |number: usize| self.grid.place(number) as u32;
        self.front.extend(front.into_iter().map(place));
        self.following.extend(following.into_iter().map(place));
        self.scar.extend(scar.into_iter().map(place));
        self.released = released;
        self.scar.iter().for_each(|&place| self.broken[place as usize] = true);
    }

    /// Moves the origin of the drive to the present one: otherwise stretches would lose digits as the drive
    /// grows.
    pub(super) fn rebase(&mut self) {
        if let Some(clocks) = &mut self.clocks {
            clocks.rebase(self.drive);
        }
        self.rebase_drive();
    }

    /// The same where the clocks have it already.
    pub(super) fn rebase_drive(&mut self) {
        self.base += self.drive;
        self.ends.iter_mut().for_each(|end| *end -= self.drive);
        self.drive = 0.0;
        self.minima = Minima::new(self.keys());
        self.stretch = self.sum();
    }

    /// The stretches of contacts, along rows.
    pub(super) fn stretches(&self) -> impl Iterator<Item = f64> {
        let stretch = |number| {
            let end = self.ends[self.grid.place(number)];
            self.births.threshold(&self.born, number) - (end - self.drive)
        };
        (0..self.size()).map(stretch)
    }

    /// The sum of all stretches, without the drive since `base`.
    pub(super) fn sum(&self) -> Compensated {
        let mut sum = Compensated::default();
        self.stretches().for_each(|stretch| sum.add(stretch - self.drive));
        sum
    }
}
