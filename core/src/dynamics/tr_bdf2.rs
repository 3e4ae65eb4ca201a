//! One step of all cells by TR-BDF2 ([`crate::numerics::tr_bdf2`]). Contacts move at constant velocities in each of its two
//! stages.

use super::{Arrest, DriveMotion, EquationOfMotion, SliderMotion, SlidingCell};
use crate::Result;
use crate::monitor::{Monitor, Watch};
use crate::numerics::tr_bdf2::{GAMMA, StageRates, WEIGHTS, error};

/// A trial step.
pub struct TrBdf2Step {
    pub end: Vec<SlidingCell>,
    /// Largest estimated error of the position of a cell.
    pub error: f64,
    /// Work of the drive.
    pub work: f64,
    /// Energy dissipated by viscous drag, ∫ηẊ² dt of each cell.
    pub viscous: Vec<f64>,
}

/// An implicit stage of a step. The unknowns are the advances δ_j for which the equation of motion holds at its end.
pub struct ImplicitStage<'a> {
    pub equation: &'a EquationOfMotion,
    pub from: &'a [SlidingCell],
    /// Drive X_T at the end of the stage.
    pub drive: f64,
    pub duration: f64,
    /// Velocity and acceleration of each cell as functions of its advance.
    pub rates: Vec<StageRates>,
    /// Accuracy of the advances.
    pub accuracy: f64,
}

/// A solver for the advances of an implicit stage.
pub trait StageSolver {
    /// The cells at the end of the stage; `None` if no solution is found.
    ///
    /// # Errors
    /// Those of the contacts; stopped by the monitor.
    fn solve(&mut self, stage: &ImplicitStage<'_>, watch: &Watch<'_>) -> Result<Option<Vec<SlidingCell>>>;

    /// Forces −(AX)_j on the cells by their coupling; 0 for a single cell.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn coupling_forces(&mut self, cells: &[SlidingCell], _monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        Ok(vec![0.0; cells.len()])
    }

    /// Stiffness A_jj of the coupling against the displacement of one cell alone; 0 for a single cell.
    fn self_stiffness(&self, _cell: usize) -> f64 {
        0.0
    }
}

impl ImplicitStage<'_> {
    /// Inertia and drag M Ẍ + η Ẋ of a cell after an advance, without that of free contacts.
    pub fn drag(&self, cell: usize, advance: f64) -> f64 {
        let (rates, from) = (&self.rates[cell], &self.from[cell]);
        let velocity = rates.velocity(advance);
        self.equation.mass(from) * rates.acceleration(velocity)
            + from.area * self.equation.viscosity * velocity
    }

    /// Derivative of inertia, drag and spring force with respect to the advance.
    pub fn stiffness(&self, cell: usize) -> f64 {
        // In both stages the velocity is linear in the advance, v = αδ + const, and the
        // acceleration linear in the velocity with the same α: γ = 2 − √2 makes the two stages
        // alike (R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985)).
        let (alpha, from, equation) = (self.rates[cell].alpha, &self.from[cell], self.equation);
        (equation.mass(from) * alpha + equation.viscosity(from)) * alpha + equation.connection(cell, from)
    }
}

impl SliderMotion {
    /// A trial step; `None` if one of its stages has no solution.
    pub(super) fn attempt(
        &self,
        solver: &mut dyn StageSolver,
        drive: DriveMotion,
        duration: f64,
        watch: &Watch<'_>,
    ) -> Result<Option<TrBdf2Step>> {
        let (equation, from, accuracy) = (&self.equation, &self.cells, self.control.stage_accuracy());
        let (number, time) = (from.len(), GAMMA * duration);
        let start = self.accelerations(solver, drive.position, watch)?;
        // First stage: the trapezoidal rule to the fraction γ of the step. Second stage: the backward
        // difference formula of second order to its end.
        let trapezoidal = |j: usize| StageRates::trapezoidal(duration, from[j].velocity, start[j]);
        let rates = (0..number).map(trapezoidal).collect();
        let first =
            ImplicitStage { equation, from, drive: drive.after(time), duration: time, rates, accuracy };
        let Some(middle) = solver.solve(&first, watch)? else { return Ok(None) };
        let backward = |j: usize| {
            let velocities = [from[j].velocity, middle[j].velocity];
            StageRates::backward_difference(duration, middle[j].position - from[j].position, velocities)
        };
        let rates = (0..number).map(backward).collect();
        let (rest, position) = (duration - time, drive.after(duration));
        let second =
            ImplicitStage { equation, from: &middle, drive: position, duration: rest, rates, accuracy };
        let Some(mut end) = solver.solve(&second, watch)? else { return Ok(None) };
        let error_of = |j: usize| {
            let velocities = [&from[j], &middle[j], &end[j]].map(|cell| cell.velocity);
            let of_position = error(duration, velocities).abs();
            if equation.mass == 0.0 {
                return of_position;
            }
            // The acceleration of a cell that comes to rest jumps; `before_turning` limits the error of its velocity.
            if equation.arrest == Arrest::Stand && velocities[2] <= 0.0 && !from[j].known.may_turn {
                return of_position;
            }
            let [one, two] = [(&first, velocities[1]), (&second, velocities[2])]
                .map(|(stage, velocity)| stage.rates[j].acceleration(velocity));
            // An error of the velocity becomes an error of the position within about 1/ω = √(M/(K + A_jj + F')).
            let resistance = equation.resistance(j, &from[j], solver.self_stiffness(j));
            let time = (equation.mass(&from[j]) / resistance).sqrt();
            of_position.max(time * error(duration, [start[j], one, two]).abs())
        };
        let error = (0..number).map(error_of).fold(0.0, f64::max);
        if equation.arrest == Arrest::Stand && equation.mass == 0.0 {
            let standing = end.iter_mut().filter(|cell| !cell.known.may_turn);
            standing.for_each(|cell| cell.velocity = cell.velocity.max(0.0));
        }
        let (work, viscous) = work_and_drag(equation, [from, &middle, &end], drive, duration);
        Ok(Some(TrBdf2Step { end, error, work, viscous }))
    }

    /// Accelerations Ẍ_j of all cells.
    fn accelerations(
        &self,
        solver: &mut dyn StageSolver,
        drive: f64,
        mut watch: &Watch<'_>,
    ) -> Result<Vec<f64>> {
        let (equation, cells) = (&self.equation, &self.cells);
        if equation.mass == 0.0 {
            return Ok(vec![0.0; cells.len()]);
        }
        let coupling = solver.coupling_forces(cells, &mut watch)?;
        let of = |(j, cell): (usize, &SlidingCell)| equation.acceleration(j, cell, drive, coupling[j]);
        Ok(cells.iter().enumerate().map(of).collect())
    }
}

/// Work of the drive in a step, and dissipation of each cell by viscous drag, by the quadrature weights of the method.
fn work_and_drag(
    equation: &EquationOfMotion,
    states: [&[SlidingCell]; 3],
    drive: DriveMotion,
    duration: f64,
) -> (f64, Vec<f64>) {
    let (mut work, mut viscous) = (0.0, vec![0.0; states[0].len()]);
    for ((cells, time), weight) in states.into_iter().zip([0.0, GAMMA * duration, duration]).zip(WEIGHTS) {
        let position = drive.after(time);
        let pull = |cell: &SlidingCell| cell.area * equation.connection * (position - cell.position);
        // A quadrature through the three states that the method computes, exact to second degree:
        // as accurate as the motion itself.
        work +=
            weight * duration * drive.velocity * cells[..equation.connected].iter().map(pull).sum::<f64>();
        for (lost, cell) in viscous.iter_mut().zip(cells) {
            *lost += weight * duration * equation.viscosity(cell) * cell.velocity * cell.velocity;
        }
    }
    (work, viscous)
}
