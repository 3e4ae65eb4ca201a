//! Limits on the memory of results and interfaces.

use crate::{Error, Result};

/// Largest memory of results, in bytes.
const ALLOWED: f64 = 4.0 * GIBIBYTE;
/// More memory than any machine has, in bytes; a run compares with the free memory.
const ANYWHERE: f64 = 16384.0 * GIBIBYTE;
const GIBIBYTE: f64 = 1024.0 * 1024.0 * 1024.0;

/// Memory of an output position, and of what is computed there.
pub(super) const BYTES_PER_POINT: f64 = 360.0;

/// Refuses a number of points that does not fit in memory.
pub(super) fn check(key: &str, number: usize, bytes_each: f64) -> Result<()> {
    within(ALLOWED, key, number, bytes_each)
}

/// Refuses a number of points or cells that fits on no machine.
pub(super) fn check_anywhere(key: &str, number: usize, bytes_each: f64) -> Result<()> {
    within(ANYWHERE, key, number, bytes_each)
}

fn within(allowed: f64, key: &str, number: usize, bytes_each: f64) -> Result<()> {
    let needed = number as f64 * bytes_each;
    if needed <= allowed {
        return Ok(());
    }
    let most = (allowed / bytes_each).floor();
    let expected = format!("at most {most}, which take {} of memory", amount(allowed));
    Err(Error::invalid(key, expected, format!("{number}, which would need {}", amount(needed))))
}

/// An amount of memory in GiB or TiB.
fn amount(bytes: f64) -> String {
    let gibibytes = bytes / GIBIBYTE;
    if gibibytes < 1024.0 { format!("{gibibytes:.1} GiB") } else { format!("{:.1} TiB", gibibytes / 1024.0) }
}
