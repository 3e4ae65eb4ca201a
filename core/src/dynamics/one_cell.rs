//! The implicit stage of a single cell.
//!
//! The solver of coupled cells with one cell is no substitute. It solves linear systems by iterations and lets contacts lag behind
//! their cell within the accuracy of a stage, so that last digits would change. A block also needs what it does not have: the
//! viscosity of free contacts at the end of the stage, and a search for a balance without drag, which ends where a slip begins.

use super::{ImplicitStage, SlidingCell, StageSolver};
use crate::Result;
use crate::monitor::Watch;

/// Largest number of iterations of the secant method; without convergence the step is shortened.
const ROUNDS: u32 = 12;

/// Farthest a balance without drag is searched beyond twice the advance at the present velocity, in units of the mean stretch.
const FARTHEST: f64 = 0.5;

/// Solves the stage of a single cell by the secant method for the residual.
pub struct OneCell;

impl StageSolver for OneCell {
    /// The advance at whose end M Ẍ + γẊ + F = K(X_T − X). A cell whose advance would be below 0 comes to rest.
    fn solve(&mut self, stage: &ImplicitStage<'_>, watch: &Watch<'_>) -> Result<Option<Vec<SlidingCell>>> {
        let (from, rates, connection) = (&stage.from[0], &stage.rates[0], stage.equation.connection);
        let pull = connection * (stage.drive - from.position);
        let residual = |advance: f64, (force, viscosity): (f64, f64)| {
            let of_free = viscosity * rates.velocity(advance);
            stage.drag(0, advance) + of_free + force + connection * advance - pull
        };
        let own = stage.stiffness(0);
        // If friction decreases faster than the other forces increase, a secant leads away from the solution.
        let held = own + from.known.tangent;
        let ahead = own + from.slope_ahead(stage.duration);
        let mut slope = if ahead > 0.0 { ahead } else { held };
        let mut advance = (-residual(0.0, (from.force, from.known.free.viscosity)) / slope).max(0.0);
        // Without drag nothing keeps a soft spring from the next balance but one, so that the search begins where the velocity
        // leads, goes no faster than the tangent allows, and not much farther than contacts are stretched.
        let mut farthest = f64::INFINITY;
        if stage.equation.is_quasistatic() && from.velocity > 0.0 {
            advance = from.velocity * stage.duration;
            slope = held;
            farthest = 2.0 * advance + FARTHEST * from.force.abs() / from.contacts.tangent();
        }
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..ROUNDS {
            let contacts = from.contacts_ahead(advance, stage.duration, watch)?;
            let force = contacts.force();
            let remaining = residual(advance, (force, contacts.free_friction().viscosity));
            if let Some((before, then)) = last {
                let secant = (remaining - then) / (advance - before);
                // The tangent of the attached contacts is an upper bound of the slope, since breaks
                // only lower the force: a step with it is short, but never away from the solution.
                slope = if secant > 0.0 { secant } else { held };
            }
            let rests = advance == 0.0 && remaining >= 0.0;
            if rests || (remaining / slope).abs() <= stage.accuracy {
                let velocity = rates.velocity(advance);
                let velocity = if rests { velocity.min(0.0) } else { velocity };
                // A block has the position of its contacts, without the rounding of a second sum.
                let position = contacts.position();
                let end = from.advanced(contacts, advance, force, velocity, stage.accuracy);
                return Ok(Some(vec![SlidingCell { position, ..end }]));
            }
            last = Some((advance, remaining));
            advance = (advance - remaining / slope).max(0.0);
            if advance > farthest {
                return Ok(None);
            }
        }
        Ok(None)
    }
}
