//! Interruption of a run: Ctrl-C, SIGTERM, SIGHUP, and the limit of `--max-time`.
//!
//! A run without checkpoints ends at once. A run with checkpoints is stopped by its monitor and writes one first; a signal that
//! comes while one is written leaves the one before. A run that writes its results completes them. A second signal ends any run
//! at once: results and checkpoints are moved into place as a whole, so that none is lost or incomplete.

use std::io::{IsTerminal as _, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use asperity_runner::duration;
use signal_hook::{consts, flag};

/// The exit code of an interrupted run.
pub const CODE: u8 = 130;

/// Time between two checks for signals and limits.
const CHECK: Duration = Duration::from_millis(20);
/// Signals within this time after the first one are ignored: some senders, such as `timeout`, send each signal twice.
const SECOND: Duration = Duration::from_millis(250);
/// Time after which a run that has not stopped prints the reason.
const PATIENCE: Duration = Duration::from_secs(1);

/// The reason why a run is interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// Ctrl-C, or a signal from elsewhere.
    Signal,
    /// The time limit.
    Time(Duration),
}

/// The reaction of a run to an interruption.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The run ends at once.
    Free,
    /// The run writes a checkpoint first.
    Keeping,
    /// The run completes its results.
    Writing,
}

/// The state of interruptions, shared with the run.
pub struct Interrupts(Arc<Shared>);

struct Shared {
    signalled: Arc<AtomicBool>,
    /// Whether the next signal ends the process.
    second: Arc<AtomicBool>,
    began: Instant,
    /// Time limit of the run; unknown until it computes.
    limit: OnceLock<Duration>,
    stage: Mutex<Stage>,
}

impl Interrupts {
    /// Starts to listen for signals.
    ///
    /// # Errors
    /// The system refuses a thread or a signal handler.
    pub fn listen() -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            signalled: Arc::default(),
            second: Arc::default(),
            began: Instant::now(),
            limit: OnceLock::new(),
            stage: Mutex::new(Stage::Free),
        });
        for signal in signals() {
            flag::register_conditional_shutdown(signal, CODE.into(), shared.second.clone())?;
            flag::register(signal, shared.signalled.clone())?;
        }
        let watched = shared.clone();
        thread::Builder::new().name("interrupts".into()).spawn(move || watched.watch())?;
        Ok(Self(shared))
    }

    /// Sets the time limit, counted from the start of listening.
    pub fn limit(&self, limit: Duration) {
        let _ = self.0.limit.set(limit);
    }

    /// The reason of the interruption, if there is one.
    pub fn reason(&self) -> Option<Reason> {
        self.0.reason()
    }

    /// Whether a signal has come; set where signals are received.
    pub fn signalled(&self) -> Arc<AtomicBool> {
        self.0.signalled.clone()
    }

    /// Runs a function that must not be interrupted.
    pub fn whole<T>(&self, work: impl FnOnce() -> T) -> T {
        let _stage = self.0.stage();
        work()
    }

    /// From now on the run itself checks for interruptions, writes its checkpoint if it has any, and reports why it was
    /// interrupted. If this has been reported already, the process ends here.
    pub fn take_over(&self) {
        *self.0.stage() = Stage::Keeping;
    }

    /// From now on the run completes its results, whatever the signals.
    pub fn finish(&self) {
        *self.0.stage() = Stage::Writing;
    }

    /// From now on the run completes its results, unless it was interrupted before.
    ///
    /// # Errors
    /// The run was interrupted before.
    pub fn write_results(&self) -> Result<(), Reason> {
        let mut stage = self.0.stage();
        let reason = self.reason().filter(|_| *stage != Stage::Writing);
        *stage = if reason.is_some() { Stage::Keeping } else { Stage::Writing };
        reason.map_or(Ok(()), Err)
    }
}

impl Shared {
    fn reason(&self) -> Option<Reason> {
        if self.signalled.load(Ordering::Relaxed) {
            return Some(Reason::Signal);
        }
        self.limit.get().filter(|limit| self.began.elapsed() >= **limit).copied().map(Reason::Time)
    }

    fn stage(&self) -> MutexGuard<'_, Stage> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self) {
        let reason = loop {
            if let Some(reason) = self.reason() {
                break reason;
            }
            thread::sleep(CHECK);
        };
        let since = Instant::now();
        let mut reported = false;
        loop {
            let stage = self.stage();
            if *stage == Stage::Free {
                end_at_once(reason);
            }
            let ends_later = *stage == Stage::Keeping || reason == Reason::Signal;
            drop(stage);
            if self.signalled.load(Ordering::Relaxed) && since.elapsed() >= SECOND {
                self.second.store(true, Ordering::Relaxed);
            }
            if !reported && ends_later && since.elapsed() >= PATIENCE {
                reported = true;
                say(
                    "stopping after the current file is written; a second Ctrl-C stops the run immediately\n",
                );
            }
            thread::sleep(CHECK);
        }
    }
}

/// Ends the process at once.
fn end_at_once(reason: Reason) -> ! {
    say(&message(reason, None));
    std::process::exit(CODE.into())
}

/// Prints to the standard error, in place of the progress bar if there is one.
fn say(words: &str) {
    let mut errors = std::io::stderr();
    let clear = if errors.is_terminal() { "\r\x1b[K" } else { "" };
    // If this cannot be written, the exit code still reports it.
    let _ = errors.write_all(format!("{clear}{words}").as_bytes());
}

/// The message of a run that was interrupted for this reason, with its checkpoint.
pub fn message(reason: Reason, checkpoint: Option<&Path>) -> String {
    let why = match reason {
        Reason::Signal => "interrupted".into(),
        Reason::Time(limit) => format!("stopped after {} (--max-time)", duration::words(limit)),
    };
    match checkpoint {
        None => format!("{why}: nothing was written\n"),
        Some(path) => format!("{why}: no results were written; --resume continues from {}\n", path.display()),
    }
}

/// The signals that interrupt a run.
fn signals() -> Vec<i32> {
    let mut signals = vec![consts::SIGINT, consts::SIGTERM];
    #[cfg(unix)]
    if !hangup_is_ignored() {
        signals.push(consts::SIGHUP);
    }
    signals
}

/// Whether the parent process has set SIGHUP to be ignored, as `nohup` does.
#[cfg(unix)]
#[allow(unsafe_code, reason = "no safe function asks what is done about a signal without changing it")]
fn hangup_is_ignored() -> bool {
    // SAFETY: all bytes 0 are a valid `sigaction`; without a new action the call only fills in the old one.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        libc::sigaction(libc::SIGHUP, std::ptr::null(), &raw mut action) == 0
            && action.sa_sigaction == libc::SIG_IGN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_why_and_what_is_left() {
        assert_eq!(message(Reason::Signal, None), "interrupted: nothing was written\n");
        let limit = Reason::Time(Duration::from_secs(5400));
        assert_eq!(
            message(limit, Some(Path::new("out/a.checkpoint.1"))),
            "stopped after 1 h 30 min (--max-time): no results were written; --resume continues from out/a.checkpoint.1\n"
        );
    }
}
