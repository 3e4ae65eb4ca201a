//! A slider in motion over time-dependent contacts.

use super::moment::Moment;
use crate::Result;
use crate::block::EnergyBalance;
use crate::dynamics::{EquationOfMotion, OneCell, SliderMotion, SlidingCell};
use crate::history::LoadPointSegment;
use crate::monitor::Monitor;
use crate::rate_dependent::RateDependentContacts;

/// A slider in motion.
#[derive(Debug)]
pub(super) struct SlidingBlock {
    pub motion: SliderMotion,
    /// The motion of the load point, from the last stop or the last change of its velocity.
    pub segment: LoadPointSegment,
}

impl SlidingBlock {
    /// A slider in equilibrium with `contacts`: at rest, or in steady sliding at their velocity.
    pub fn balanced(
        equation: EquationOfMotion,
        contacts: &dyn RateDependentContacts,
        tolerance: f64,
    ) -> Self {
        let cell = SlidingCell::new(contacts.copy(), contacts.position());
        let drag = (equation.viscosity + cell.known.free.viscosity) * cell.velocity;
        let drive = cell.position + (cell.force + drag) / equation.connection;
        // Without a drive there is no velocity of which a slip would be ten times.
        let pulled = if cell.velocity > 0.0 { cell.velocity } else { f64::INFINITY };
        let segment = LoadPointSegment { time: 0.0, drive, velocity: cell.velocity, pulled };
        Self { motion: SliderMotion::new(equation, vec![cell], drive, tolerance), segment }
    }

    /// The cell that the slider is.
    pub fn cell(&self) -> &SlidingCell {
        &self.motion.cells[0]
    }

    /// The load point continues at a velocity; slips are ten times as fast as `pulled`.
    pub fn continue_at(&mut self, velocity: f64, pulled: f64) {
        self.motion.change_drive_velocity(velocity - self.segment.velocity);
        self.segment = LoadPointSegment { velocity, pulled, ..self.segment };
        self.begin_segment();
    }

    /// Counts the motion of the load point from here.
    pub fn begin_segment(&mut self) {
        (self.segment.time, self.segment.drive) = (self.motion.time, self.motion.drive);
    }

    /// Makes one step, at most until the time `end`.
    pub fn step(&mut self, end: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let left = end - self.motion.time;
        if self.motion.step(&mut OneCell, self.segment.velocity, left, monitor)? >= left {
            self.motion.time = end;
        }
        // From the beginning of the segment, so that rounding errors of steps do not add up.
        self.motion.drive = self.segment.at(self.motion.time);
        Ok(())
    }

    /// The present state.
    pub fn moment(&self) -> Moment {
        let SliderMotion { ref equation, ref energies, time, drive, .. } = self.motion;
        let (cell, stiffness) = (self.cell(), equation.connection);
        let (tangent, contact_energies) = (cell.contacts.tangent(), cell.contacts.energies());
        let attached = cell.force - cell.known.free.force;
        // After an arrest the slider is behind the position of its contacts, on their unloading line.
        let back = equation.unloaded(cell, drive);
        // The background force holds it there until the spring has gained 2B.
        let slides = back < 0.0 && back <= equation.excess(cell, drive) / equation.resistance_alone(cell);
        let velocity =
            if slides { stiffness * self.segment.velocity / (stiffness + tangent) } else { cell.velocity };
        let position = cell.position + back;
        let spring_force = stiffness * (drive - position) + equation.background;
        let energy = EnergyBalance {
            work: energies.work,
            spring: 0.5 * spring_force * spring_force / stiffness,
            elastic: contact_energies.elastic + back * (attached + 0.5 * tangent * back),
            kinetic: 0.5 * equation.mass * cell.velocity * cell.velocity,
            strengthening: contact_energies.strengthening,
            breaks: contact_energies.lost + energies.breaks,
            slip: energies.arrest,
            viscous: energies.viscous[0],
            background: energies.background + contact_energies.sliding,
            ..EnergyBalance::default()
        };
        let of_free = cell.known.free.viscosity * velocity;
        let force = cell.force + of_free + tangent * back + equation.background(cell, drive);
        let (free, broken) = (cell.contacts.free(), contact_energies.broken);
        Moment { time, drive, position, velocity, force, spring_force, free, broken, energy }
    }
}
