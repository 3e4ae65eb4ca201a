//! The number of threads of a run.

use asperity_runner::threads;

use super::Failure;

/// The environment variable with the default of `--threads`.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Parses a number of threads.
///
/// # Errors
/// Text that is not a number above 0, or more threads than are useful on this machine.
pub fn parse(text: &str) -> Result<usize, String> {
    let number = text.parse().map_err(|_| threads::expected()).and_then(threads::check);
    number.map_err(|expected| format!("expected {expected}"))
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
