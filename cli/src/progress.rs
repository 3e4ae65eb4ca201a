//! Watching a run: a bar where someone is looking, and Ctrl-C.

use std::io::IsTerminal as _;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use indicatif::{ProgressBar, ProgressStyle};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C ask the computation to stop instead of ending the program at once.
pub fn catch_interrupts() {
    // It fails only where a handler is already set, and the program sets no other.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Whether Ctrl-C was pressed.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Shows a bar once a run has taken a second, if the standard error is a terminal.
pub struct Progress {
    started: Instant,
    shown: bool,
    bar: Option<ProgressBar>,
    /// How many events there were, where they are counted.
    counted: String,
}

const STEPS: u64 = 1000;

impl Progress {
    /// A watcher, from now on.
    pub fn new(quiet: bool) -> Self {
        Self {
            started: Instant::now(),
            shown: !quiet && std::io::stderr().is_terminal(),
            bar: None,
            counted: String::new(),
        }
    }

    fn draw(&mut self, fraction: f64) {
        if !self.shown || self.started.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{bar:40} {percent:>3} % after {elapsed}{msg}")
                .expect("it is valid");
            ProgressBar::new(STEPS).with_style(style).with_elapsed(self.started.elapsed())
        });
        bar.set_message(self.counted.clone());
        bar.set_position((fraction * STEPS as f64) as u64);
    }
}

impl Monitor for Progress {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.draw(fraction);
        if interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn events(&mut self, events: u64, drive: f64) {
        if self.shown {
            self.counted = format!(", {events} events, drive {drive:.6}");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
