//! The implicit stage of coupled cells: the secant method for the friction of each cell, the elastic coupling taken as it is.

use crate::Result;
use crate::dynamics::{ImplicitStage, SlidingCell, StageSolver};
use crate::elastic::Coupling;
use crate::elastic::batch::largest;
use crate::monitor::Watch;
use crate::rate_dependent::RateDependentContacts;

/// Iterations of the secant method after which the step is taken to be too long.
const ROUNDS: u32 = 20;

/// Tolerance of the linear solver, relative to the largest residual: stiff springs make large forces of small advances.
const SOLVED: f64 = 1e-10;

/// Stiffness of the spring that keeps a cell in place, in units of the largest stiffness that the cell feels.
const HOLD: f64 = 1e9;

/// Solves the stages of cells that a coupling joins.
pub(super) struct CoupledCells<'a>(pub &'a mut dyn Coupling);

/// Where a cell may be at the end of a stage.
#[derive(Clone, Copy)]
struct Guess {
    advance: f64,
    force: f64,
    /// dF/dX between the last two guesses.
    slope: f64,
}

/// Correction of the guesses.
struct Correction {
    by: Vec<f64>,
    /// Whether a cell stays where it is, as it would move back otherwise.
    stands: Vec<bool>,
}

impl Guess {
    fn none(from: &SlidingCell) -> Self {
        Self { advance: 0.0, force: from.force, slope: from.slope }
    }
}

impl StageSolver for CoupledCells<'_> {
    /// The advances at whose end η Ẋ = pulls − F. Cells that would go back stand.
    fn solve(&mut self, stage: &ImplicitStage<'_>, watch: &Watch<'_>) -> Result<Option<Vec<SlidingCell>>> {
        let mut guesses: Vec<Guess> = stage.from.iter().map(Guess::none).collect();
        let Correction { by, .. } = self.correct(stage, &guesses);
        let mut contacts = first(stage, &mut guesses, &by, watch)?;
        for _ in 0..ROUNDS {
            watch.check()?;
            let Correction { by, stands } = self.correct(stage, &guesses);
            // A secant method: contacts give their force after an advance, but no derivative of it
            // over a whole stage.
            if by.iter().all(|by| by.abs() <= stage.accuracy) {
                let end = |(j, contacts): (usize, Box<dyn RateDependentContacts>)| {
                    let Guess { advance, force, .. } = guesses[j];
                    let free = stage.rates[j].velocity(advance);
                    let velocity = if stands[j] { free.min(0.0) } else { free };
                    stage.from[j].advanced(contacts, advance, force, velocity, stage.accuracy)
                };
                return Ok(Some(contacts.into_iter().enumerate().map(end).collect()));
            }
            again(stage, &mut guesses, &mut contacts, &by, watch)?;
        }
        Ok(None)
    }
}

impl CoupledCells<'_> {
    /// Solves (springs + A) δ = right; whether the matrix is positive definite.
    pub fn respond(&mut self, springs: &[f64], right: &mut [f64]) -> bool {
        let goal = SOLVED * largest(right.len(), |j| right[j].abs());
        self.0.solve_variable(springs, right, goal).is_some()
    }

    /// The residual: forces that are not in balance at the guessed end of the stage.
    fn excess(&mut self, stage: &ImplicitStage<'_>, guesses: &[Guess]) -> Vec<f64> {
        let positions: Vec<f64> =
            stage.from.iter().zip(guesses).map(|(from, guess)| from.position + guess.advance).collect();
        let mut excess = vec![0.0; positions.len()];
        self.0.forces(&positions, &mut excess);
        for (j, (excess, guess)) in excess.iter_mut().zip(guesses).enumerate() {
            *excess += stage.equation.connection(j) * (stage.drive - positions[j]);
            *excess -= guess.force + stage.drag(j, guess.advance);
        }
        excess
    }

    /// The correction by which the residual vanishes where slopes do not change.
    fn correct(&mut self, stage: &ImplicitStage<'_>, guesses: &[Guess]) -> Correction {
        let (number, excess) = (guesses.len(), self.excess(stage, guesses));
        let stand = |(guess, excess): (&Guess, &f64)| guess.advance == 0.0 && *excess <= 0.0;
        let stands: Vec<bool> = guesses.iter().zip(&excess).map(stand).collect();
        let held = |j: usize| stage.stiffness(j) + stage.from[j].contacts.tangent();
        // Active-set method for the condition that cells move forward only: a cell at rest that is pushed
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
        if !self.respond(&springs, &mut by) {
            by = (0..number).map(right).collect();
            self.respond(&holding, &mut by);
        }
        let forward = |(by, guess): (&f64, &Guess)| (guess.advance + by).max(0.0) - guess.advance;
        Correction { by: by.iter().zip(guesses).map(forward).collect(), stands }
    }
}

/// The contacts of all cells after the first guess of advances.
fn first(
    stage: &ImplicitStage<'_>,
    guesses: &mut [Guess],
    by: &[f64],
    watch: &Watch<'_>,
) -> Result<Vec<Box<dyn RateDependentContacts>>> {
    let ahead = |(): &mut (), j: usize| stage.from[j].contacts_ahead(by[j], stage.duration, watch);
    let contacts: Vec<_> = watch.share(by.len(), || (), ahead)?.into_iter().collect::<Result<_>>()?;
    for ((guess, &advance), contacts) in guesses.iter_mut().zip(by).zip(&contacts) {
        (guess.advance, guess.force) = (advance, contacts.force());
    }
    Ok(contacts)
}

/// Moves contacts anew, from the beginning of the stage, in cells whose correction exceeds its accuracy.
fn again(
    stage: &ImplicitStage<'_>,
    guesses: &mut [Guess],
    contacts: &mut [Box<dyn RateDependentContacts>],
    by: &[f64],
    watch: &Watch<'_>,
) -> Result<()> {
    let going: Vec<usize> = (0..by.len()).filter(|&j| by[j].abs() > stage.accuracy).collect();
    let ahead = |(): &mut (), number: usize| {
        let j = going[number];
        stage.from[j].contacts_ahead(guesses[j].advance + by[j], stage.duration, watch)
    };
    let ahead = watch.share(going.len(), || (), ahead)?;
    for (&j, ahead) in going.iter().zip(ahead) {
        contacts[j] = ahead?;
        let (advance, force) = (guesses[j].advance + by[j], contacts[j].force());
        // Contacts move from the beginning of the stage each time: what they do depends on the
        // whole path, not on the last guess.
        guesses[j] = Guess { advance, force, slope: (force - guesses[j].force) / by[j] };
    }
    Ok(())
}
