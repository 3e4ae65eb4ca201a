//! Steps on equal springs, for slides: while cells go far from step to step, to tell their springs apart does not pay.

use super::Interface;
use super::batch::change;
use crate::Result;

/// What a step costs besides its responses, in responses on equal springs: forces and slopes are asked for.
const BESIDES: usize = 1;

/// A step that leaves no more than this part of the excess force pays, however far it goes: it has found the balance, near
/// which telling springs apart leaves ever less.
const FOUND: f64 = 0.01;

/// Plain steps have come near a balance when they leave this part of the excess force.
const NEAR: f64 = 0.1;

/// The plain steps of a slide. Costs are counted in responses on equal springs.
pub(super) struct UniformStiffnessStep {
    /// Forces by which drive and slider pull at cells, while steps are plain.
    pulls: Vec<f64>,
    /// What the present row of steps may still cost, and might from its beginning.
    left: usize,
    row: usize,
    /// The largest excess force in it.
    most: f64,
    /// What a step costs.
    cost: usize,
    /// c of the present row.
    spring: f64,
    /// The excess force before the last step that told springs apart, whether that one went far enough to pay, and what it cost.
    weighed: Option<(f64, bool, usize)>,
}

impl UniformStiffnessStep {
    /// None yet.
    pub fn new() -> Self {
        let cost = 1 + BESIDES;
        Self { pulls: Vec::new(), left: 0, row: 0, most: 0.0, cost, spring: 0.0, weighed: None }
    }

    /// Whether the next step is to be one, from such an excess force, `precision` being what is rounding in it.
    ///
    /// Where a step that told springs apart did not pay, plain ones follow for as much as it cost, and for twice as much
    /// each time, until they come near a balance.
    pub fn is_next(&mut self, excess: f64, precision: f64) -> bool {
        if let Some((before, paid, taken)) = self.weighed.take() {
            self.row = if paid || excess <= FOUND * before { 0 } else { taken.max(2 * self.row) };
            (self.left, self.most) = (self.row, 0.0);
        }
        self.most = self.most.max(excess);
        if excess <= precision || excess < NEAR * self.most {
            self.left = 0;
        }
        if self.left == 0 {
            self.pulls = Vec::new();
        }
        self.left > 0
    }

    /// A step that told springs apart has taken so many responses, from such an excess force, and goes `gain` times as far
    /// as a plain one would have gone by springs c.
    pub fn weigh(&mut self, excess: f64, gain: f64, taken: usize, spring: f64) {
        let taken = taken + 2 * BESIDES;
        self.spring = spring;
        self.weighed = Some((excess, gain * self.cost as f64 >= taken as f64, taken));
    }

    fn pay(&mut self, responses: usize) {
        self.cost = responses + BESIDES;
        self.left = self.left.saturating_sub(self.cost);
    }
}

impl Interface {
    /// The largest force out of balance where the cells are, no advances being tried.
    pub(super) fn excess_after(&mut self, plain: &mut UniformStiffnessStep) -> Result<f64> {
        if plain.pulls.is_empty() {
            return self.excess_here();
        }
        self.excess.copy_from_slice(&plain.pulls);
        self.resist()
    }

    /// c = K_0 and the largest F_j' that a cell may still meet: held by such springs cells move so little that no excess
    /// changes its sign, and no balance is passed.
    pub(super) fn plain_spring(&self) -> f64 {
        self.cells.stiffest() + self.setting.connection
    }

    /// Tries to go on by δ with (c + A) δ = excess. The excess has just been asked for.
    pub(super) fn plain_step(&mut self, plain: &mut UniformStiffnessStep) -> Result<()> {
        if plain.pulls.is_empty() {
            plain.pulls = vec![0.0; self.len()];
            self.cells.residual(&self.by, &mut plain.pulls, &mut self.springs)?;
            let excess = &self.excess;
            change(&mut plain.pulls, |j, force| excess[j] - force);
        }
        loop {
            self.by.copy_from_slice(&self.excess);
            let taken = self.coupling.solve_uniform(plain.spring, &mut self.by);
            plain.pay(taken);
            if !self.cells.reach(&self.by)? {
                break;
            }
            // What is newly known may be stiffer.
            plain.spring = plain.spring.max(self.plain_spring());
        }
        // As A δ = excess − c δ, pulls need not be asked for.
        let (connection, by, excess) = (self.connections(), &self.by, &self.excess);
        let spring = plain.spring;
        change(&mut plain.pulls, |j, pull| pull - excess[j] + (spring - connection(j)) * by[j]);
        Ok(())
    }
}
