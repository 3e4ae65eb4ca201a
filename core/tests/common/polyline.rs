//! Contacts of which nothing is known but a force along straight lines.
#![allow(dead_code)]

use asperity::Result;
use asperity::energy::ContactEnergies;
use asperity::monitor::Monitor;
use asperity::population::{Direction, Population, Response, SmoothInterval};
use asperity::rate_dependent::ContactsState;

/// Force at the start, and lengths and slopes of lines, the last of which has no end. What is stored is none of it.
#[derive(Debug, Clone)]
pub struct Polyline {
    pub force: f64,
    pub lines: Vec<(f64, f64)>,
    pub position: f64,
    pub work: f64,
}

impl Polyline {
    pub fn new(force: f64, lines: &[(f64, f64)]) -> Self {
        Self { force, lines: lines.to_vec(), position: 0.0, work: 0.0 }
    }
}

impl Population for Polyline {
    fn position(&self) -> f64 {
        self.position
    }

    fn smooth_interval(
        &mut self,
        _direction: Direction,
        _monitor: &mut dyn Monitor,
    ) -> Result<SmoothInterval> {
        Ok(SmoothInterval { length: self.lines[0].0, straight: true, breaks: false })
    }

    fn ahead(&self, by: f64) -> Response {
        let tangent = self.lines[0].1;
        Response { force: self.force + by * tangent, tangent }
    }

    fn advance(&mut self, by: f64) -> Result<()> {
        let force = self.ahead(by).force;
        self.work += 0.5 * by * (self.force + force);
        (self.force, self.position) = (force, self.position + by);
        self.lines[0].0 -= by;
        if self.lines[0].0 <= 1e-12 {
            self.lines.remove(0);
        }
        Ok(())
    }

    fn cross(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        Ok(())
    }

    fn reset(&mut self, _direction: Direction, _monitor: &mut dyn Monitor) -> Result<()> {
        Ok(())
    }

    fn hold(&mut self) -> Result<()> {
        Ok(())
    }

    fn release(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        Ok(())
    }

    fn mark(&mut self) {}

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        Ok(())
    }

    fn energies(&self) -> ContactEnergies {
        ContactEnergies { lost: self.work, ..ContactEnergies::default() }
    }

    fn copy(&self) -> Box<dyn Population> {
        Box::new(self.clone())
    }

    fn state(&self) -> ContactsState {
        unimplemented!("nobody keeps it")
    }

    fn restore(&mut self, _state: &ContactsState, _monitor: &mut dyn Monitor) -> Result<()> {
        unimplemented!("nobody keeps it")
    }
}
