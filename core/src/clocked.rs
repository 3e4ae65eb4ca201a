//! Contacts that know time and move together, seen from outside: what a block needs to know of them.
//!
//! Where a [`crate::population::Population`] has no time of its own, here every move takes its time, and time passes at
//! rest, too.

use crate::Result;

/// Contacts that move together in time.
///
/// Forces are totals, in the unit of stiffness × length; positions X are lengths.
pub trait Clocked: Send {
    /// Position X of the slider's bottom.
    fn position(&self) -> f64;

    /// Time t.
    fn time(&self) -> f64;

    /// Force F.
    fn force(&self) -> f64;

    /// dF/dX if the slider moved at once: what holds, stretched.
    fn tangent(&self) -> f64;

    /// Elastic energy Σ ½k x² of the contacts.
    fn elastic_energy(&self) -> f64;

    /// Breaks so far, per contact.
    fn broken(&self) -> f64;

    /// The fraction of contacts that is free.
    fn free(&self) -> f64;

    /// Moves by `by`, 0 or above, at one velocity in the time `during`, above 0.
    ///
    /// # Errors
    /// Accuracy not reached.
    fn step(&mut self, by: f64, during: f64) -> Result<()>;

    /// A copy in the present state, to come back to.
    fn copy(&self) -> Box<dyn Clocked>;
}
