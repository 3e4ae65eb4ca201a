//! The implicit stage of a single cell.

use super::{ImplicitStage, SlidingCell, StageSolver};
use crate::Result;
use crate::monitor::Watch;

/// Iterations of the secant method after which the step is taken to be too long.
const ROUNDS: u32 = 12;

/// Solves the stage of a single cell by the secant method for the residual.
pub struct OneCell;

impl StageSolver for OneCell {
    /// The advance at whose end M Ẍ + γẊ + F = K(X_T − X). A cell whose advance would be below 0 comes to rest.
    fn solve(&mut self, stage: &ImplicitStage<'_>, watch: &Watch<'_>) -> Result<Option<Vec<SlidingCell>>> {
        let (from, rates, connection) = (&stage.from[0], &stage.rates[0], stage.equation.connection);
        let pull = connection * (stage.drive - from.position);
        let residual =
            |advance: f64, force: f64| stage.drag(0, advance) + force + connection * advance - pull;
        let own = stage.stiffness(0);
        // Where friction falls faster than all else rises, a secant leads away from the solution.
        let held = own + from.contacts.tangent();
        let mut slope = if own + from.slope > 0.0 { own + from.slope } else { held };
        let mut advance = (-residual(0.0, from.force) / slope).max(0.0);
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..ROUNDS {
            let contacts = from.contacts_ahead(advance, stage.duration, watch)?;
            let force = contacts.force();
            let off = residual(advance, force);
            if let Some((before, then)) = last {
                let secant = (off - then) / (advance - before);
                slope = if secant > 0.0 { secant } else { held };
            }
            let rests = advance == 0.0 && off >= 0.0;
            if rests || (off / slope).abs() <= stage.accuracy {
                let velocity = rates.velocity(advance);
                let velocity = if rests { velocity.min(0.0) } else { velocity };
                // A block is where its contacts are.
                let position = contacts.position();
                let end = from.advanced(contacts, advance, force, velocity, stage.accuracy);
                return Ok(Some(vec![SlidingCell { position, ..end }]));
            }
            last = Some((advance, off));
            advance = (advance - off / slope).max(0.0);
        }
        Ok(None)
    }
}
