//! Newton-like steps with one stiffness for all cells, used in a slide while the state is far from balance.
//!
//! With a stiffness c ≥ F_j' + K_0 of all cells the step δ = (c + A)⁻¹ r is one application of the preconditioner, while a
//! step with a stiffness for each cell takes several (the parallel-chord method: J. M. Ortega and W. C. Rheinboldt,
//! *Iterative Solution of Nonlinear Equations in Several Variables*, SIAM 2000, section 7.1,
//! doi:10.1137/1.9780898719468). It is shorter, but where slopes change a lot from step to step more of such steps are
//! cheaper. It passes no balance, as the monotone step does, since c is an upper bound of the slopes.

use super::batch::change;
use super::configuration::Configuration;
use super::residual::{InterfaceModel, Residual};
use crate::Result;
use crate::monitor::Monitor;

/// Cost of evaluating forces and slopes of the contacts, in applications of the preconditioner.
const EVALUATION: usize = 1;

/// A step with variable stiffness that leaves no more than this fraction of the residual is worth its cost, however far it
/// goes: it is near the balance, where such steps converge quadratically.
const CONVERGED: f64 = 0.01;

/// Steps with uniform stiffness end when they leave this fraction of the largest residual.
const NEAR: f64 = 0.1;

/// The choice between the two kinds of steps, by their cost. Costs are counted in applications of the preconditioner.
pub(super) struct UniformStiffnessStep {
    /// Forces of drive and slider, kept up to date during a row of such steps.
    pulls: Option<Vec<f64>>,
    /// Cost that the present row of steps may still have.
    left: usize,
    /// Cost that it might have from its beginning.
    row: usize,
    /// Largest residual in it.
    largest: f64,
    /// Cost of a step.
    cost: usize,
    /// c.
    stiffness: f64,
    /// The last step with variable stiffness.
    variable: Option<VariableStep>,
}

/// Cost and gain of a step with variable stiffness.
struct VariableStep {
    /// Largest residual before it.
    residual: f64,
    /// Whether it went farther than steps with uniform stiffness would have for the same cost.
    paid: bool,
    cost: usize,
}

impl UniformStiffnessStep {
    /// No step yet.
    pub fn new() -> Self {
        let cost = 1 + EVALUATION;
        Self { pulls: None, left: 0, row: 0, largest: 0.0, cost, stiffness: 0.0, variable: None }
    }

    /// Whether the next step, from such a largest residual with such a rounding error, should have a uniform stiffness.
    ///
    /// After a step with variable stiffness that was not worth its cost a row of steps with uniform stiffness follows for
    /// the same cost, and for twice as much each time, until they come near a balance.
    pub fn is_next(&mut self, residual: f64, rounding: f64) -> bool {
        if let Some(step) = self.variable.take() {
            let worth = step.paid || residual <= CONVERGED * step.residual;
            // A row costs at least as much as the step that did not pay: trying steps with variable
            // stiffness takes at most half of the time.
            self.row = if worth { 0 } else { step.cost.max(2 * self.row) };
            (self.left, self.largest) = (self.row, 0.0);
        }
        self.largest = self.largest.max(residual);
        if residual <= rounding || residual < NEAR * self.largest {
            self.left = 0;
        }
        if self.left == 0 {
            self.pulls = None;
        }
        self.left > 0
    }

    /// Records a step with variable stiffness that took so many applications of the preconditioner, from such a
    /// largest residual, and went `gain` times as far as one with uniform stiffness c would have.
    pub fn compare(&mut self, residual: f64, gain: f64, iterations: usize, stiffness: f64) {
        let cost = iterations + 2 * EVALUATION;
        self.stiffness = stiffness;
        self.variable = Some(VariableStep { residual, paid: gain * self.cost as f64 >= cost as f64, cost });
    }

    /// The residual where the cells are.
    pub fn residual(
        &self,
        model: &mut InterfaceModel,
        configuration: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<Residual> {
        match &self.pulls {
            Some(pulls) => model.residual_under(pulls.clone(), monitor),
            None => model.residual(configuration, monitor),
        }
    }

    /// δ = (c + A)⁻¹ r.
    pub fn step(
        &mut self,
        model: &mut InterfaceModel,
        residual: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        let mut pulls = self.pulls.take().unwrap_or_else(|| {
            let mut pulls = model.contact_forces();
            change(&mut pulls, |j, force| residual[j] + force);
            pulls
        });
        let by = loop {
            let mut by = residual.to_vec();
            let iterations = model.coupling.solve_uniform(self.stiffness, &mut by, monitor)?;
            self.cost = iterations + EVALUATION;
            self.left = self.left.saturating_sub(self.cost);
            if !model.cells.extend_curves(&by, monitor)? {
                break by;
            }
            // What has been tabulated just now may be steeper.
            self.stiffness = self.stiffness.max(model.uniform_stiffness());
        };
        // As A δ = r − c δ, the elastic forces need not be computed.
        let (springs, stiffness) = (&model.springs, self.stiffness);
        change(&mut pulls, |j, pull| pull - residual[j] + (stiffness - springs.of(j)) * by[j]);
        self.pulls = Some(pulls);
        Ok(by)
    }
}

impl InterfaceModel {
    /// c, the sum of the largest K_0j and the largest F_j' that a cell may still meet.
    pub fn uniform_stiffness(&self) -> f64 {
        self.cells.largest_tangent() + self.springs.largest()
    }
}
