//! The number of threads of a run.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

use super::Failure;

/// Largest number of threads per core: more gain nothing, and each needs memory.
const PER_CORE: usize = 8;
/// The environment variable with the default of `--threads`.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Parses a number of threads.
///
/// # Errors
/// Text that is not a number above 0, or more threads than are useful on this machine.
pub fn parse(text: &str) -> Result<usize, String> {
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let most = PER_CORE * cores;
    let number = text.parse().ok().filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| {
        let have = if cores == 1 { "core".to_owned() } else { format!("{cores} cores") };
        format!("expected a number from 1 to {most}, {PER_CORE} times the {have} cores of this machine")
    })
}

/// Sets the number of threads: the given one, that of the environment, or one per core.
///
/// # Errors
/// Too many threads in the environment, or more than the system allows.
pub fn on<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let Some(threads) = threads else {
        // 0 selects the number of cores.
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
