//! The implicit stage of coupled cells: the secant method for the friction of each cell, the elastic coupling taken as it is.

use crate::Result;
use crate::dynamics::{ImplicitStage, SlidingCell, StageSolver};
use crate::elastic::Coupling;
use crate::elastic::batch::largest;
use crate::monitor::{Cost, Monitor, Watch};
use crate::rate_dependent::RateDependentContacts;

/// Iterations of the secant method after which the step is taken to be too long.
const ROUNDS: u32 = 20;

/// Tolerance of the linear solver, relative to the largest residual: stiff springs make large forces of small advances.
const SOLVED: f64 = 1e-10;

/// Stiffness of the spring that keeps a cell in place, in units of the largest stiffness that the cell feels.
const HOLD: f64 = 1e9;

/// Solves the stages of cells that a coupling joins.
pub(super) struct CoupledCells<'a>(pub &'a mut dyn Coupling);

/// Largest lag of contacts behind their cell, in units of the accuracy of a stage: the force is then wrong by less than by the
/// corrections that are left out.
const LAG: f64 = 0.25;

/// Where a cell may be at the end of a stage.
#[derive(Debug)]
struct Guess {
    advance: f64,
    force: f64,
    /// dF/dX between the last two guesses.
    slope: f64,
    /// The contacts after the advance, if they have been moved.
    moved: Option<Box<dyn RateDependentContacts>>,
}

/// Correction of the guesses.
struct Correction {
    by: Vec<f64>,
    /// Whether a cell stays where it is, as it would move back otherwise.
    stands: Vec<bool>,
}

impl Guess {
    fn none(from: &SlidingCell, duration: f64) -> Self {
        Self { advance: 0.0, force: from.force, slope: from.slope_ahead(duration), moved: None }
    }

    /// Leaves the contacts where they were at the beginning of the stage, if the cell hardly moves; whether it does.
    fn lag(&mut self, from: &SlidingCell, advance: f64, most: f64) -> bool {
        let lags = from.known.may_lag && (from.lag.by + advance).abs() <= most;
        if lags {
            let (force, slope) = (from.force_at(advance), from.known.tangent);
            *self = Self { advance, force, slope, moved: None };
        }
        lags
    }

    /// Takes the force from contacts that have been moved.
    fn take(&mut self, (contacts, force): (Box<dyn RateDependentContacts>, f64), advance: f64) {
        if self.moved.is_some() {
            // Contacts move from the beginning of the stage each time: what they do depends on the
            // whole path, not on the last guess.
            self.slope = (force - self.force) / (advance - self.advance);
        }
        (self.advance, self.force, self.moved) = (advance, force, Some(contacts));
    }

    /// The cell at the end of the stage.
    fn end(self, stage: &ImplicitStage<'_>, j: usize, stands: bool) -> SlidingCell {
        let (from, advance, force) = (&stage.from[j], self.advance, self.force);
        let free = stage.rates[j].velocity(advance);
        let velocity = if stands { free.min(0.0) } else { free };
        match self.moved {
            Some(contacts) => from.advanced(contacts, advance, force, velocity, stage.accuracy),
            None => from.leaving_contacts(advance, stage.duration, velocity),
        }
    }
}

impl StageSolver for CoupledCells<'_> {
    /// The advances at whose end M Ẍ + η Ẋ = pulls − F. Cells that would go back stand, unless their contacts may turn.
    fn solve(&mut self, stage: &ImplicitStage<'_>, watch: &Watch<'_>) -> Result<Option<Vec<SlidingCell>>> {
        let mut guesses: Vec<Guess> =
            stage.from.iter().map(|from| Guess::none(from, stage.duration)).collect();
        let Correction { by, .. } = self.correct(stage, &guesses, watch)?;
        advance(stage, &mut guesses, &by, watch)?;
        for _ in 0..ROUNDS {
            watch.check()?;
            let Correction { by, stands } = self.correct(stage, &guesses, watch)?;
            // A secant method: contacts give their force after an advance, but no derivative of it
            // over a whole stage.
            if by.iter().all(|by| by.abs() <= stage.accuracy) {
                let end = |(j, guess): (usize, Guess)| {
                    watch.check_at(j)?;
                    Ok(guess.end(stage, j, stands[j]))
                };
                return guesses.into_iter().enumerate().map(end).collect::<Result<_>>().map(Some);
            }
            advance(stage, &mut guesses, &by, watch)?;
        }
        Ok(None)
    }

    fn coupling_forces(&mut self, cells: &[SlidingCell], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let positions: Vec<f64> = cells.iter().map(|cell| cell.position).collect();
        let mut forces = vec![0.0; positions.len()];
        self.0.forces(&positions, &mut forces, monitor)?;
        Ok(forces)
    }

    fn self_stiffness(&self, cell: usize) -> f64 {
        self.0.self_stiffness(cell)
    }
}

impl CoupledCells<'_> {
    /// Solves (springs + A) δ = right; whether the matrix is positive definite.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn respond(&mut self, springs: &[f64], right: &mut [f64], monitor: &mut dyn Monitor) -> Result<bool> {
        let goal = SOLVED * largest(right.len(), |j| right[j].abs());
        Ok(self.0.solve_variable(springs, right, goal, monitor)?.is_some())
    }

    /// The residual: forces that are not in balance at the guessed end of the stage.
    fn excess(
        &mut self,
        stage: &ImplicitStage<'_>,
        guesses: &[Guess],
        mut watch: &Watch<'_>,
    ) -> Result<Vec<f64>> {
        let positions: Vec<f64> =
            stage.from.iter().zip(guesses).map(|(from, guess)| from.position + guess.advance).collect();
        let mut excess = vec![0.0; positions.len()];
        self.0.forces(&positions, &mut excess, &mut watch)?;
        for (j, (excess, guess)) in excess.iter_mut().zip(guesses).enumerate() {
            *excess += stage.equation.connection(j, &stage.from[j]) * (stage.drive - positions[j]);
            *excess -= guess.force + stage.drag(j, guess.advance);
        }
        Ok(excess)
    }

    /// The correction by which the residual vanishes where slopes do not change.
    fn correct(
        &mut self,
        stage: &ImplicitStage<'_>,
        guesses: &[Guess],
        mut watch: &Watch<'_>,
    ) -> Result<Correction> {
        let (number, excess) = (guesses.len(), self.excess(stage, guesses, watch)?);
        let may_turn = |j: usize| stage.from[j].known.may_turn;
        let stand = |j: usize| !may_turn(j) && guesses[j].advance == 0.0 && excess[j] <= 0.0;
        let stands: Vec<bool> = (0..number).map(stand).collect();
        let held = |j: usize| stage.stiffness(j) + stage.from[j].known.tangent;
        // Active-set method for the condition that contacts move forward only: a cell at rest that is pushed
        // back is fixed by a very stiff spring, so that the system keeps its size and its symmetry.
        let spring = |j: usize| {
            if stands[j] {
                HOLD * (held(j) + self.0.self_stiffness(j))
            } else {
                stage.stiffness(j) + guesses[j].slope
            }
        };
        let springs: Vec<f64> = (0..number).map(spring).collect();
        // Where friction falls too fast for the matrix to be positive definite, the tangent of the contacts replaces the secant.
        let hold = |j: usize| if springs[j] > 0.0 { springs[j] } else { held(j) };
        let holding: Vec<f64> = (0..number).map(hold).collect();
        let right = |j: usize| if stands[j] { 0.0 } else { excess[j] };
        let mut by: Vec<f64> = (0..number).map(right).collect();
        if !self.respond(&springs, &mut by, &mut watch)? {
            by = (0..number).map(right).collect();
            self.respond(&holding, &mut by, &mut watch)?;
        }
        for (j, by) in by.iter_mut().enumerate().filter(|(j, _)| !may_turn(*j)) {
            *by = (guesses[j].advance + *by).max(0.0) - guesses[j].advance;
        }
        Ok(Correction { by, stands })
    }
}

/// Corrects all guesses, and moves contacts anew, from the beginning of the stage, in cells whose force is not known otherwise.
fn advance(stage: &ImplicitStage<'_>, guesses: &mut [Guess], by: &[f64], watch: &Watch<'_>) -> Result<()> {
    let mut going = Vec::new();
    for (j, guess) in guesses.iter_mut().enumerate() {
        let from = &stage.from[j];
        let advance = guess.advance + by[j];
        let known = guess.moved.is_some() && by[j].abs() <= stage.accuracy
            || guess.lag(from, advance, LAG * stage.accuracy);
        if !known {
            going.push((j, advance));
        }
    }
    watch.cost(Cost::Residuals, 1);
    let ahead = |(): &mut (), number: usize| {
        let (j, advance) = going[number];
        let contacts = stage.from[j].contacts_ahead(advance, stage.duration, watch)?;
        let force = contacts.force();
        Ok((contacts, force))
    };
    let ahead = watch.share(going.len(), || (), ahead)?;
    for (&(j, advance), ahead) in going.iter().zip(ahead) {
        guesses[j].take(ahead?, advance);
    }
    Ok(())
}
