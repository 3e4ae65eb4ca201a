//! One step of all cells in time, of two stages ([`tr_bdf2`]). Between their ends contacts move at constant velocities.

use crate::Result;
use crate::elastic::Coupling;
use crate::elastic::batch::{largest, sum};
use crate::monitor::{Monitor, Watch};
use crate::numerics::tr_bdf2::{self, GAMMA, HISTORY, WEIGHTS};
use crate::rate_dependent::RateDependentContacts;

/// Equations of stages are solved to this share of the tolerance.
const NEAR: f64 = 0.01;

/// Rounds of the secant rule before a step is too long for it.
const ROUNDS: u32 = 20;

/// Forces that are left of those in excess when a way is found: stiff springs pull by much for a small way.
const SOLVED: f64 = 1e-10;

/// A spring that holds a cell which is not to move, in units of the stiffest that it feels.
const HOLD: f64 = 1e9;

/// What moves cells: η Ẋ_j = K_0j(X_T − X_j) − (AX)_j − F_j.
pub(super) struct Dynamics {
    pub coupling: Box<dyn Coupling>,
    /// K_0.
    pub connection: f64,
    /// Cells that are connected to the drive: those of a number below this.
    pub connected: usize,
    /// η.
    pub viscosity: f64,
    /// The length to which a step is right.
    pub tolerance: f64,
}

/// A cell and its contacts at one moment.
pub(super) struct State {
    pub contacts: Box<dyn RateDependentContacts>,
    /// X_j.
    pub position: f64,
    /// F_j.
    pub force: f64,
    /// Ẋ_j.
    pub velocity: f64,
    /// dF/dX on the last way, by which the next one is guessed.
    pub slope: f64,
}

/// A step, tried.
pub(super) struct Tried {
    pub end: Vec<State>,
    /// Where cells are between the stages, and their forces there.
    pub middle: Vec<(f64, f64)>,
    /// The estimate of its error, the largest of a cell, as a length.
    pub error: f64,
    /// Work of the drive.
    pub work: f64,
    /// Lost by viscous drag, ∫ηẊ² dt of each cell.
    pub viscous: Vec<f64>,
}

/// Motion of the drive at one velocity.
#[derive(Clone, Copy)]
pub(super) struct Pulled {
    /// X_T now.
    pub drive: f64,
    /// Its velocity.
    pub velocity: f64,
}

/// Where a cell may be at the end of a stage.
#[derive(Clone, Copy)]
struct Guess {
    advance: f64,
    force: f64,
    slope: f64,
}

/// How far cells are to go on from there.
struct Correction {
    by: Vec<f64>,
    /// Whether a cell is not to move, as it would go back.
    stands: Vec<bool>,
}

/// What the velocity at the end of a stage is of an advance δ: αδ + `carried`.
struct Rule<'a> {
    alpha: f64,
    carried: &'a [f64],
}

impl Pulled {
    /// X_T after a time.
    pub fn after(self, time: f64) -> f64 {
        self.drive + self.velocity * time
    }
}

impl State {
    pub fn of(contacts: Box<dyn RateDependentContacts>, position: f64) -> Self {
        let (force, slope) = (contacts.force(), contacts.tangent());
        Self { contacts, position, force, velocity: 0.0, slope }
    }

    /// The contacts after an advance in a time.
    fn ahead(
        &self,
        advance: f64,
        during: f64,
        mut watch: &Watch<'_>,
    ) -> Result<Box<dyn RateDependentContacts>> {
        let mut contacts = self.contacts.copy();
        contacts.step(advance, during, &mut watch)?;
        Ok(contacts)
    }

    /// The cell at the end of a stage; of an advance up to `near` nothing is learnt of the slope.
    fn end(&self, contacts: Box<dyn RateDependentContacts>, guess: Guess, velocity: f64, near: f64) -> Self {
        let Guess { advance, force, .. } = guess;
        let slope = if advance > near { (force - self.force) / advance } else { self.slope };
        Self { contacts, position: self.position + advance, force, velocity, slope }
    }
}

impl Guess {
    fn none(from: &State) -> Self {
        Self { advance: 0.0, force: from.force, slope: from.slope }
    }
}

impl Rule<'_> {
    fn velocity(&self, cell: usize, advance: f64) -> f64 {
        self.alpha * advance + self.carried[cell]
    }
}

impl Dynamics {
    /// K_0j.
    pub fn connection(&self, cell: usize) -> f64 {
        if cell < self.connected { self.connection } else { 0.0 }
    }

    /// Solves (springs + A) δ = right; whether the matrix is positive definite.
    pub fn respond(&mut self, springs: &[f64], right: &mut [f64]) -> bool {
        let goal = SOLVED * largest(right.len(), |j| right[j].abs());
        self.coupling.solve_variable(springs, right, goal).is_some()
    }

    /// Energy of the slider between cells.
    pub fn stored(&mut self, positions: &[f64]) -> f64 {
        let mut forces = vec![0.0; positions.len()];
        self.coupling.forces(positions, &mut forces);
        self.coupling.energy(positions, &forces)
    }

    /// Forces by which drive and slider pull at cells.
    pub fn pulls(&mut self, positions: &[f64], drive: f64) -> Vec<f64> {
        let mut pulls = vec![0.0; positions.len()];
        self.coupling.forces(positions, &mut pulls);
        for (j, pull) in pulls.iter_mut().enumerate() {
            *pull += self.connection(j) * (drive - positions[j]);
        }
        pulls
    }

    /// A step of a duration; `None` where its equations find no solution.
    pub fn attempt(
        &mut self,
        from: &[State],
        pulled: Pulled,
        duration: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Tried>> {
        let watch = &Watch::new(monitor);
        let (alpha, time) = (tr_bdf2::alpha(duration), GAMMA * duration);
        let carried: Vec<f64> = from.iter().map(|cell| -cell.velocity).collect();
        let rule = Rule { alpha, carried: &carried };
        let Some(middle) = self.stage(from, pulled.after(time), time, &rule, watch)? else { return Ok(None) };
        let way = |j: usize| middle[j].position - from[j].position;
        let carried: Vec<f64> = (0..from.len()).map(|j| -alpha * HISTORY * way(j)).collect();
        let (rule, rest) = (Rule { alpha, carried: &carried }, duration - time);
        let Some(mut end) = self.stage(&middle, pulled.after(duration), rest, &rule, watch)? else {
            return Ok(None);
        };
        let error = |j: usize| {
            let rates = [&from[j], &middle[j], &end[j]].map(|cell| cell.velocity);
            tr_bdf2::error(duration, rates).abs()
        };
        let error = (0..from.len()).map(error).fold(0.0, f64::max);
        end.iter_mut().for_each(|cell| cell.velocity = cell.velocity.max(0.0));
        let (work, viscous) = self.taken([from, &middle, &end], pulled, duration);
        let middle = middle.iter().map(|cell| (cell.position, cell.force)).collect();
        Ok(Some(Tried { end, middle, error, work, viscous }))
    }

    /// Work of the drive in a step through these states, and what each cell loses by viscous drag.
    fn taken(&self, states: [&[State]; 3], pulled: Pulled, duration: f64) -> (f64, Vec<f64>) {
        let (mut work, mut viscous) = (0.0, vec![0.0; states[0].len()]);
        for ((cells, time), weight) in states.into_iter().zip([0.0, GAMMA * duration, duration]).zip(WEIGHTS)
        {
            let drive = pulled.after(time);
            let pull = sum(self.connected, |j| self.connection * (drive - cells[j].position));
            work += weight * duration * pulled.velocity * pull;
            for (lost, cell) in viscous.iter_mut().zip(cells) {
                *lost += weight * duration * self.viscosity * cell.velocity * cell.velocity;
            }
        }
        (work, viscous)
    }

    /// The advances at whose end η Ẋ = pulls − F, by the secant rule for each cell and with the coupling as it is. Cells
    /// that would go back stand.
    fn stage(
        &mut self,
        from: &[State],
        drive: f64,
        during: f64,
        rule: &Rule<'_>,
        watch: &Watch<'_>,
    ) -> Result<Option<Vec<State>>> {
        let near = NEAR * self.tolerance;
        let mut guesses: Vec<Guess> = from.iter().map(Guess::none).collect();
        let Correction { by, .. } = self.correct(from, &guesses, drive, rule);
        let mut contacts = first(from, &mut guesses, &by, during, watch)?;
        for _ in 0..ROUNDS {
            watch.check()?;
            let Correction { by, stands } = self.correct(from, &guesses, drive, rule);
            if by.iter().all(|by| by.abs() <= near) {
                let end = |(j, contacts): (usize, Box<dyn RateDependentContacts>)| {
                    let free = rule.velocity(j, guesses[j].advance);
                    from[j].end(contacts, guesses[j], if stands[j] { free.min(0.0) } else { free }, near)
                };
                return Ok(Some(contacts.into_iter().enumerate().map(end).collect()));
            }
            again(from, &mut guesses, &mut contacts, &by, near, during, watch)?;
        }
        Ok(None)
    }

    /// Forces in excess where cells may be at the end of a stage.
    fn excess(&mut self, from: &[State], guesses: &[Guess], drive: f64, rule: &Rule<'_>) -> Vec<f64> {
        let positions: Vec<f64> =
            from.iter().zip(guesses).map(|(from, guess)| from.position + guess.advance).collect();
        let mut excess = self.pulls(&positions, drive);
        for (j, (excess, guess)) in excess.iter_mut().zip(guesses).enumerate() {
            *excess -= guess.force + self.viscosity * rule.velocity(j, guess.advance);
        }
        excess
    }

    /// How far cells are to go on, so that what is in excess vanishes where slopes stay as they are.
    fn correct(&mut self, from: &[State], guesses: &[Guess], drive: f64, rule: &Rule<'_>) -> Correction {
        let excess = self.excess(from, guesses, drive, rule);
        let stand = |(guess, excess): (&Guess, &f64)| guess.advance == 0.0 && *excess <= 0.0;
        let stands: Vec<bool> = guesses.iter().zip(&excess).map(stand).collect();
        let own = |j: usize| self.viscosity * rule.alpha + self.connection(j);
        let held = |j: usize| own(j) + from[j].contacts.tangent();
        let spring = |j: usize| {
            if stands[j] {
                HOLD * (held(j) + self.coupling.self_stiffness(j))
            } else {
                own(j) + guesses[j].slope
            }
        };
        let springs: Vec<f64> = (0..from.len()).map(spring).collect();
        // Where cells push too hard, they give way to what holds, stretched.
        let hold = |j: usize| if springs[j] > 0.0 { springs[j] } else { held(j) };
        let holding: Vec<f64> = (0..from.len()).map(hold).collect();
        let right = |j: usize| if stands[j] { 0.0 } else { excess[j] };
        let mut by: Vec<f64> = (0..from.len()).map(right).collect();
        if !self.respond(&springs, &mut by) {
            by = (0..from.len()).map(right).collect();
            self.respond(&holding, &mut by);
        }
        let forward = |(by, guess): (&f64, &Guess)| (guess.advance + by).max(0.0) - guess.advance;
        Correction { by: by.iter().zip(guesses).map(forward).collect(), stands }
    }
}

/// The contacts of all cells after the advances that are guessed first.
fn first(
    from: &[State],
    guesses: &mut [Guess],
    by: &[f64],
    during: f64,
    watch: &Watch<'_>,
) -> Result<Vec<Box<dyn RateDependentContacts>>> {
    let ahead = watch.share(from.len(), || (), |(), j| from[j].ahead(by[j], during, watch))?;
    let contacts: Vec<_> = ahead.into_iter().collect::<Result<_>>()?;
    for ((guess, &advance), contacts) in guesses.iter_mut().zip(by).zip(&contacts) {
        (guess.advance, guess.force) = (advance, contacts.force());
    }
    Ok(contacts)
}

/// The contacts of the cells that are to go on farther than `near`, once more, in one go from the beginning of the stage.
fn again(
    from: &[State],
    guesses: &mut [Guess],
    contacts: &mut [Box<dyn RateDependentContacts>],
    by: &[f64],
    near: f64,
    during: f64,
    watch: &Watch<'_>,
) -> Result<()> {
    let going: Vec<usize> = (0..by.len()).filter(|&j| by[j].abs() > near).collect();
    let ahead = |(): &mut (), number: usize| {
        let j = going[number];
        from[j].ahead(guesses[j].advance + by[j], during, watch)
    };
    let ahead = watch.share(going.len(), || (), ahead)?;
    for (&j, ahead) in going.iter().zip(ahead) {
        contacts[j] = ahead?;
        let (advance, force) = (guesses[j].advance + by[j], contacts[j].force());
        guesses[j] = Guess { advance, force, slope: (force - guesses[j].force) / by[j] };
    }
    Ok(())
}
