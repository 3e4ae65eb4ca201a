//! The number of threads that a user may ask for.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// Largest number of threads per core: more gain nothing, and each needs memory.
const PER_CORE: usize = 8;

/// Checks a number of threads.
///
/// # Errors
/// What is expected of a number that is 0, or more than is useful on this machine.
pub fn check(number: usize) -> Result<usize, String> {
    let most = PER_CORE * available_parallelism().map_or(1, NonZeroUsize::get);
    if (1..=most).contains(&number) { Ok(number) } else { Err(expected()) }
}

/// What a number of threads must be.
pub fn expected() -> String {
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let have = if cores == 1 { "core".to_owned() } else { format!("{cores} cores") };
    format!("a number from 1 to {}, {PER_CORE} times the {have} of this machine", PER_CORE * cores)
}
