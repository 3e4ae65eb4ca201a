//! The velocity at which a slip begins and ends.

/// Velocity of a cell above which it slips, in units of the velocity of the drive.
pub const SLIP_VELOCITY: f64 = 10.0;

/// The fraction of a step at which a quantity passes `value`, linear in time from `before` to `after`.
pub fn crossing(before: f64, after: f64, value: f64) -> f64 {
    ((value - before) / (after - before)).clamp(0.0, 1.0)
}
