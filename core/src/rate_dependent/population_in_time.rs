//! Athermal contacts, which have no time of their own, moved in time.

use super::{ContactsState, RateDependentContacts, StretchInterval};
use crate::Result;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::population::{Direction, Population};

/// A [`Population`] as contacts that move in time, forward and backward: F depends on the path alone.
#[derive(Debug)]
pub struct PopulationInTime {
    population: Box<dyn Population>,
    /// Stiffness of all contacts, attached as they all are.
    stiffness: f64,
    time: f64,
}

impl PopulationInTime {
    /// The contacts of a population that are all attached, with the sum of their stiffnesses, at t = 0.
    pub fn new(population: Box<dyn Population>, stiffness: f64) -> Self {
        Self { population, stiffness, time: 0.0 }
    }
}

impl RateDependentContacts for PopulationInTime {
    fn position(&self) -> f64 {
        self.population.position()
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn force(&self) -> f64 {
        self.population.ahead(0.0).force
    }

    fn tangent(&self) -> f64 {
        self.stiffness
    }

    fn energies(&self) -> ContactEnergies {
        self.population.energies()
    }

    fn free(&self) -> f64 {
        0.0
    }

    fn is_constant_at_rest(&self) -> bool {
        true
    }

    fn may_turn(&self) -> bool {
        true
    }

    /// None of a distribution, which is not kept as intervals.
    fn stretches(&self) -> Vec<StretchInterval> {
        let stretches = self.population.stretches().unwrap_or_default();
        let fraction = 1.0 / stretches.len() as f64;
        stretches.into_iter().map(|x| StretchInterval { low: x, high: x, fraction }).collect()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let direction = if by < 0.0 { Direction::Backward } else { Direction::Forward };
        let mut left = by.abs();
        while left > 0.0 {
            let interval = self.population.smooth_interval(direction, monitor)?;
            let part = left.min(interval.length);
            self.population.advance(direction.sign() * part)?;
            left -= part;
            if interval.breaks && left > 0.0 {
                self.population.cross(monitor)?;
            }
        }
        self.time += during;
        Ok(())
    }

    /// A copy: forces that depend on the displacement only have no error of their own steps.
    fn rough(&self) -> Option<Box<dyn RateDependentContacts>> {
        Some(self.copy())
    }

    fn copy(&self) -> Box<dyn RateDependentContacts> {
        Box::new(Self { population: self.population.copy(), ..*self })
    }

    fn state(&self) -> ContactsState {
        ContactsState::of(&(self.population.state(), self.time))
    }

    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        let (population, time): (ContactsState, f64) = state.read()?;
        self.population.restore(&population, &mut ())?;
        self.time = time;
        Ok(())
    }
}
