//! Arrest: the end of the motion of a cell whose contacts would pull it back.

use super::{DriveMotion, EquationOfMotion, MotionStepControl, SliderMotion, SlidingCell, StageSolver};
use crate::Result;
use crate::monitor::Monitor;

/// Fraction of the tolerance by which the pull may be short of the friction without a move back.
const SLACK: f64 = 1e-3;

/// Rule for a cell whose contacts would pull it back, and cannot be moved backward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrest {
    /// A cell stays at its position, where its kinetic energy is 0, unless its contacts may turn.
    Stand,
    /// A single cell that stops at X_2 moves back, without inertia, to the equilibrium on the straight unloading line of its
    /// contacts, X = X_2 + [K(X_T − X_2) − F(X_2)]/(K + F'). It moves on when the spring has brought it back to X_2. Until
    /// then the contacts age in their state at X_2. A background force B holds it: it moves back only as far as the net force
    /// exceeds B, and then stays until the spring has gained 2B. The constant friction force of free
    /// contacts is added to B; in motion forward it is part of F.
    Unload,
}

impl EquationOfMotion {
    /// Net force K(X_T − X) − F of a cell that slides forward, without drag and inertia.
    pub fn excess(&self, cell: &SlidingCell, drive: f64) -> f64 {
        self.connection * (drive - cell.position) - cell.force
    }

    /// Stiffness K_0j + A_jj + F' of spring, coupling and contacts against the displacement of cell j alone.
    pub fn resistance(&self, j: usize, cell: &SlidingCell, coupling: f64) -> f64 {
        self.connection(j, cell) + coupling + cell.known.tangent
    }

    /// Stiffness K + F' of spring and contacts of a single cell.
    pub fn resistance_alone(&self, cell: &SlidingCell) -> f64 {
        self.resistance(0, cell, 0.0)
    }

    /// Displacement X − X_2 ≤ 0 of a cell at rest on its unloading line; 0 if it is not unloaded.
    ///
    /// Without a background force it is that of the balance. With one, the cell stays where it is, `back`, as long as the net
    /// force there is between −2B and 0.
    pub fn unloaded(&self, cell: &SlidingCell, drive: f64) -> f64 {
        let excess = self.excess(cell, drive);
        if !(cell.velocity == 0.0 && excess < 0.0) {
            return 0.0;
        }
        let resistance = self.resistance_alone(cell);
        // Below, B resists the motion forward; above, the motion back.
        let highest = ((excess + 2.0 * self.holding(cell)) / resistance).min(0.0);
        cell.back.clamp(excess / resistance, highest)
    }

    /// Background force on a cell: B in forward motion; at rest what is left of the pull by the contacts, with what the friction
    /// of free contacts is less than in motion forward.
    pub fn background(&self, cell: &SlidingCell, drive: f64) -> f64 {
        let excess = self.excess(cell, drive);
        if cell.velocity > 0.0 || excess >= 0.0 {
            return self.background;
        }
        let left = excess - self.resistance_alone(cell) * self.unloaded(cell, drive);
        let lowest = -self.background - 2.0 * cell.known.free.force;
        (self.background + left).clamp(lowest, self.background)
    }

    /// The largest force that holds a cell at rest besides its attached contacts.
    fn holding(&self, cell: &SlidingCell) -> f64 {
        self.background + cell.known.free.force
    }

    /// Distance within which forces of this stiffness stop a cell that goes back.
    fn stopping_distance(&self, resistance: f64, cell: &SlidingCell) -> f64 {
        let viscosity = cell.area * self.viscosity;
        -cell.velocity * (viscosity + (self.mass(cell) * resistance).sqrt()) / resistance
    }

    /// Work of the drive on a cell at rest, by the trapezoidal rule, what the background force dissipates, and a correction
    /// of the energy dissipated in breaks. The contacts break at the stretches of X_2, but the cell is at a distance b from
    /// X_2, which changes the energy by b ΔF + ½b² ΔF'.
    fn at_rest(&self, states: [&SlidingCell; 2], drive: DriveMotion, duration: f64) -> (f64, f64, f64) {
        let [before, after] = states;
        let drives = [drive.position, drive.after(duration)];
        let [from, to] = [0, 1].map(|i| self.unloaded(states[i], drives[i]));
        let pull =
            |i: usize, back: f64| self.connection * (drives[i] - states[i].position - back) + self.background;
        let attached = |cell: &SlidingCell| cell.force - cell.known.free.force;
        let force = attached(after) - attached(before);
        let tangent = after.contacts.tangent() - before.contacts.tangent();
        let work = drive.velocity * duration * 0.5 * (pull(0, from) + pull(1, to));
        let background = 0.5 * (self.holding(before) + self.holding(after)) * (to - from).abs();
        (work, background, -0.5 * ((from + to) * force + 0.5 * (from * from + to * to) * tangent))
    }
}

impl SliderMotion {
    /// Whether the contacts of a cell that unloads would pull it back.
    fn is_pulled_back(&self) -> bool {
        if self.equation.arrest == Arrest::Stand {
            return false;
        }
        let cell = &self.cells[0];
        let slack = SLACK * self.control.tolerance * self.equation.resistance_alone(cell);
        self.equation.excess(cell, self.drive) < -slack
    }

    /// Whether the cell is at rest on its unloading line, behind X_2.
    pub(super) fn is_held(&self) -> bool {
        self.cells[0].velocity == 0.0 && self.is_pulled_back()
    }

    /// Whether the cell still moves, but its contacts already exceed the force of the spring.
    pub fn is_stopping(&self) -> bool {
        self.cells[0].velocity > 0.0 && self.is_pulled_back()
    }

    /// The factor by which a step must be shortened that ends with a backward velocity too large for the tolerance. The factor
    /// comes from the zero of the velocity, taken as linear in time.
    pub(super) fn before_turning(&self, end: &[SlidingCell], solver: &dyn StageSolver) -> Option<f64> {
        let equation = &self.equation;
        // Cells that stand without a mass stop wherever the forces are in balance.
        if equation.arrest == Arrest::Stand && equation.mass == 0.0 {
            return None;
        }
        let shorter = |(j, cell): (usize, &SlidingCell)| {
            let (before, after) = (self.cells[j].velocity, cell.velocity);
            if after >= 0.0 || cell.known.may_turn {
                return None;
            }
            let resistance = equation.resistance(j, cell, solver.self_stiffness(j));
            let back = equation.stopping_distance(resistance, cell);
            (back > self.control.tolerance)
                .then(|| (before / (before - after)).clamp(MotionStepControl::SHRINK, 0.9))
        };
        end.iter().enumerate().filter_map(shorter).reduce(f64::min)
    }

    /// Cells with a mass that have come to rest stand.
    fn stand(&mut self) {
        for cell in &mut self.cells {
            if cell.velocity < 0.0 && !cell.known.may_turn {
                self.energies.arrest += self.equation.kinetic(cell);
                cell.velocity = 0.0;
            }
        }
    }

    /// Moves a cell that has come to rest back to the equilibrium behind X_2. The excess energy is dissipated.
    pub(super) fn arrest(&mut self, drive: f64) {
        if self.equation.arrest == Arrest::Stand {
            return self.stand();
        }
        if self.cells[0].velocity > 0.0 {
            return;
        }
        self.cells[0].velocity = 0.0;
        let holding = self.equation.holding(&self.cells[0]);
        let excess = (self.equation.excess(&self.cells[0], drive) + 2.0 * holding).min(0.0);
        // The net force, without the background force, falls linearly to 0 along the unloading line: its work is half of
        // force × distance.
        self.energies.arrest += 0.5 * excess * excess / self.equation.resistance_alone(&self.cells[0]);
        self.cells[0].back = self.equation.unloaded(&self.cells[0], drive);
        self.energies.background -= holding * self.cells[0].back;
    }

    /// Rests behind X_2 until the spring pulls again, at most for the time `left`. Returns the duration.
    pub(super) fn rest(&mut self, drive: DriveMotion, left: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        let (equation, cell, tolerance) = (self.equation, &self.cells[0], self.control.tolerance);
        let short = -equation.excess(cell, drive.position);
        let resistance = equation.resistance_alone(cell);
        let behind = short / resistance;
        // Limits the error of the energies by the trapezoidal rule, which is of second order in the displacement.
        let most = (tolerance * behind).sqrt();
        // The spring needs the time short/rate to reach the friction again, longer if contacts
        // strengthen meanwhile.
        let rate = equation.connection * drive.velocity;
        // What the spring gains before a cell that the background force holds moves.
        let held = (short + resistance * equation.unloaded(cell, drive.position)).max(0.0);
        let mut duration = (short.min(held.max(most * resistance)) / rate).min(left);
        loop {
            let mut contacts = cell.contacts.copy();
            contacts.step(0.0, duration, monitor)?;
            let force = contacts.force();
            let mut rested =
                SlidingCell { back: cell.back, ..cell.advanced(contacts, 0.0, force, cell.velocity, 0.0) };
            let position = drive.after(duration);
            rested.back = equation.unloaded(&rested, position);
            if !self.control.is_too_short(duration, left) {
                let excess = equation.excess(&rested, position);
                let moved = (rested.back - equation.unloaded(cell, drive.position)).abs();
                // Too long if the spring exceeds the contacts at its end, or if the cell has moved too far on
                // the unloading line.
                let shorter = if excess > tolerance * equation.resistance_alone(&rested) {
                    Some(short / (short + excess))
                } else {
                    (moved > 2.0 * most).then(|| most / moved)
                };
                if let Some(factor) = shorter {
                    duration *= factor.max(MotionStepControl::SHRINK);
                    continue;
                }
            }
            let (work, background, breaks) = equation.at_rest([cell, &rested], drive, duration);
            self.energies.work += work;
            self.energies.background += background;
            self.energies.breaks += breaks;
            self.cells[0] = rested;
            self.cells[0].settle();
            return Ok(duration);
        }
    }
}
