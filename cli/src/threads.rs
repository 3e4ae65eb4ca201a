//! On how many threads a run computes.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

use super::Failure;

/// Threads for each core, at most: more gain nothing, and each takes memory of its own.
const PER_CORE: usize = 8;
/// Where the number is taken from that `--threads` does not give.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// The number that `text` says.
///
/// # Errors
/// No number above 0, or more threads than are of use on this machine.
pub fn parse(text: &str) -> Result<usize, String> {
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let most = PER_CORE * cores;
    let number = text.parse().ok().filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| {
        let have = if cores == 1 { "core".to_owned() } else { format!("{cores} cores") };
        format!("expected a number from 1 to {most}, {PER_CORE} times the {have} cores of this machine")
    })
}

/// Computes on so many threads, or on as many as the environment says, or on one for each core.
///
/// # Errors
/// The environment says too many, or the system has not so many.
pub fn on<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let Some(threads) = threads else {
        // The number 0 is that of the cores.
        let asked = std::env::var(VARIABLE).ok().filter(|number| number.parse::<u64>().is_ok_and(|n| n > 0));
        let refused = |text: &String| parse(text).err().map(|expected| (text.clone(), expected));
        return match asked.as_ref().and_then(refused) {
            Some((found, expected)) => Err(Failure::Input(format!(
                "error: environment variable {VARIABLE}: {expected}, got {found}\n"
            ))),
            None => Ok(work()),
        };
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map(|pool| pool.install(work)).map_err(Failure::run)
}
