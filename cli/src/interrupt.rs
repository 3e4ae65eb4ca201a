//! What ends a run before its end: Ctrl-C, SIGTERM, SIGHUP, and the limit of `--max-time`.
//!
//! A run that has nothing to bring to the disk ends at once, wherever it is. One that keeps checkpoints is asked to stop,
//! and writes one first; one that writes its results goes on. A second signal ends any at once: results and checkpoints are
//! put in place whole, so that none is lost or left in half.

use std::io::{IsTerminal as _, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use asperity_runner::duration;
use signal_hook::{consts, flag};

/// The exit code of a run that was ended.
pub const CODE: u8 = 130;

/// Time between two looks at what has come.
const LOOK: Duration = Duration::from_millis(20);
/// A signal is a second one from this time after the first on: some senders, such as `timeout`, send each one twice.
const SECOND: Duration = Duration::from_millis(250);
/// A run that has not stopped after this time says why.
const PATIENCE: Duration = Duration::from_secs(1);

/// Why a run ends before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// Ctrl-C, or a signal from elsewhere.
    Signal,
    /// It has taken as long as it may.
    Time(Duration),
}

/// What a run does when it is to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Ends at once.
    Free,
    /// Writes a checkpoint first.
    Keeping,
    /// Writes its results, and is done.
    Writing,
}

/// What a run asks whether it is to end.
pub struct Interrupts(Arc<Shared>);

struct Shared {
    signalled: Arc<AtomicBool>,
    /// When the next signal ends the process by itself.
    second: Arc<AtomicBool>,
    began: Instant,
    /// How long the run may take; unknown until it computes.
    limit: OnceLock<Duration>,
    stage: Mutex<Stage>,
}

impl Interrupts {
    /// Listens from now on.
    ///
    /// # Errors
    /// The system has no thread for it, or refuses to be listened to.
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

    /// The run, which computes from here on, may take as long as `limit` since it was first listened.
    pub fn limit(&self, limit: Duration) {
        let _ = self.0.limit.set(limit);
    }

    /// Why the run is to end, if it is.
    pub fn asked(&self) -> Option<Reason> {
        self.0.asked()
    }

    /// Does what must not be left half done.
    pub fn whole<T>(&self, work: impl FnOnce() -> T) -> T {
        let _stage = self.0.stage();
        work()
    }

    /// From here on there are checkpoints to write: the run has to ask whether to end.
    pub fn keep_checkpoints(&self) {
        *self.0.stage() = Stage::Keeping;
    }

    /// From here on results are written, whatever has come or comes.
    pub fn finish(&self) {
        *self.0.stage() = Stage::Writing;
    }

    /// From here on results are written, whatever comes.
    ///
    /// # Errors
    /// Something has come.
    pub fn write_results(&self) -> Result<(), Reason> {
        let mut stage = self.0.stage();
        let asked = self.asked().filter(|_| *stage != Stage::Writing);
        *stage = if asked.is_some() { Stage::Keeping } else { Stage::Writing };
        asked.map_or(Ok(()), Err)
    }
}

impl Shared {
    fn asked(&self) -> Option<Reason> {
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
            if let Some(reason) = self.asked() {
                break reason;
            }
            thread::sleep(LOOK);
        };
        let since = Instant::now();
        let mut told = false;
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
            if !told && ends_later && since.elapsed() >= PATIENCE {
                told = true;
                say(
                    "stopping after the current file is written; a second Ctrl-C stops the run immediately\n",
                );
            }
            thread::sleep(LOOK);
        }
    }
}

/// Ends the process; nothing it has to do is left to do.
fn end_at_once(reason: Reason) -> ! {
    say(&message(reason, None));
    std::process::exit(CODE.into())
}

/// Tells on the standard error, in the place of a bar if there is one.
fn say(words: &str) {
    let mut errors = std::io::stderr();
    let clear = if errors.is_terminal() { "\r\x1b[K" } else { "" };
    // Where this cannot be written, the exit code still tells.
    let _ = errors.write_all(format!("{clear}{words}").as_bytes());
}

/// What is said of a run that ended for this reason, and of the checkpoint that it left.
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

/// The signals that end a run.
fn signals() -> Vec<i32> {
    let mut signals = vec![consts::SIGINT, consts::SIGTERM];
    #[cfg(unix)]
    if !hangup_is_ignored() {
        signals.push(consts::SIGHUP);
    }
    signals
}

/// Whether whoever started the program has told it to outlive the terminal, as `nohup` does.
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
