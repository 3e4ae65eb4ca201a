//! Progress of a run: a bar at a terminal, lines in a log.

use std::io::{IsTerminal as _, Write as _};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use asperity_runner::{duration, memory};
use indicatif::{ProgressBar, ProgressStyle};

use super::interrupt::Interrupts;

/// Shows the progress of a run, and stops it on request.
pub struct Progress<'a> {
    interrupts: &'a Interrupts,
    began: Instant,
    /// None before the first report.
    marks: Option<Marks>,
    view: View,
    /// Number of events, if they are counted.
    counted: String,
    /// Bytes that the run may take; those that are free if none is given.
    memory: Option<u64>,
}

/// The form in which progress is shown.
enum View {
    Nowhere,
    /// A bar at a terminal, after one second.
    Bar(Option<ProgressBar>),
    /// Lines in a log, the next one at this time.
    Log(Duration),
}

const STEPS: u64 = 1000;
/// Time of the first line in a log, and the shortest time between two lines.
const LINE: Duration = Duration::from_secs(10);
/// The longest time between two lines.
const LONGEST: Duration = Duration::from_secs(600);

impl<'a> Progress<'a> {
    /// A monitor that starts now.
    pub fn new(quiet: bool, memory: Option<u64>, interrupts: &'a Interrupts) -> Self {
        let view = match (quiet, std::io::stderr().is_terminal()) {
            (true, _) => View::Nowhere,
            (false, true) => View::Bar(None),
            (false, false) => View::Log(LINE),
        };
        Self { interrupts, began: Instant::now(), marks: None, view, counted: String::new(), memory }
    }

    fn show(&mut self, fraction: f64) {
        let elapsed = self.began.elapsed();
        let marks = self.marks.get_or_insert_with(|| Marks::new((elapsed, fraction)));
        marks.pass((elapsed, fraction));
        let marks = *marks;
        let left = || marks.left((elapsed, fraction));
        match &mut self.view {
            View::Bar(bar) if elapsed >= Duration::from_secs(1) => {
                let bar = bar.get_or_insert_with(|| new_bar(elapsed));
                bar.set_message(format!("{}{}", left(), self.counted));
                bar.set_position((fraction * STEPS as f64) as u64);
            }
            View::Log(next) if elapsed >= *next => {
                *next = next_line(elapsed);
                let line = line(elapsed, fraction, &left(), &self.counted);
                // If this cannot be written, nobody reads it.
                let _ = std::io::stderr().write_all(line.as_bytes());
            }
            _ => {}
        }
    }
}

fn new_bar(elapsed: Duration) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} % after {elapsed}{msg}").expect("it is valid");
    ProgressBar::new(STEPS).with_style(style).with_elapsed(elapsed)
}

/// The time of the line after the one at `elapsed`: a quarter of that time later, within bounds.
fn next_line(elapsed: Duration) -> Duration {
    elapsed + (elapsed / 4).clamp(LINE, LONGEST)
}

/// A line of a log.
fn line(elapsed: Duration, fraction: f64, left: &str, counted: &str) -> String {
    format!("{:.1} % after {}{left}{counted}\n", 100.0 * fraction, duration::words(elapsed))
}

/// A time and the fraction done then.
type Mark = (Duration, f64);

/// Marks from which the speed is measured: parts of a run differ in it.
#[derive(Clone, Copy)]
struct Marks {
    /// The first report. A resumed run does not begin at 0.
    first: Mark,
    /// A mark within the first half of the time.
    earlier: Mark,
    /// The next such mark.
    later: Mark,
}

impl Marks {
    fn new(first: Mark) -> Self {
        Self { first, earlier: first, later: first }
    }

    /// Each mark is at twice the time of the one before.
    fn pass(&mut self, now: Mark) {
        if now.0 - self.first.0 >= 2 * (self.later.0 - self.first.0) {
            (self.earlier, self.later) = (self.later, now);
        }
    }

    /// The remaining time, as text, at the speed of the last half of the time or more; of all of it if that is too little.
    fn left(&self, now: Mark) -> String {
        let recent = left(self.earlier, now);
        if recent.is_empty() { left(self.first, now) } else { recent }
    }
}

/// The remaining time, as text, at the mean speed since `first`. Empty if too little of the work is done for an estimate.
fn left(first: Mark, (elapsed, fraction): Mark) -> String {
    /// Smallest fraction of the run for an estimate.
    const LEAST: f64 = 1e-3;
    let (time, done) = ((elapsed - first.0).as_secs_f64(), fraction - first.1);
    if done < LEAST {
        return String::new();
    }
    let left = Duration::try_from_secs_f64(time * (1.0 - fraction) / done);
    let whole = |left: Duration| Duration::from_secs(left.as_secs_f64().round() as u64);
    left.map_or(String::new(), |left| format!(", about {} left", duration::words(whole(left))))
}

impl Monitor for Progress<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.show(fraction);
        if self.interrupts.reason().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(memory::available)
    }

    fn events(&mut self, events: u64, drive: f64) {
        if !matches!(self.view, View::Nowhere) {
            self.counted = format!(", {events} events, drive {drive:.6}");
        }
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        if let View::Bar(Some(bar)) = &self.view {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_has_a_line_after_ten_seconds_and_few_in_a_long_run() {
        let mut times = vec![LINE];
        while times.last().unwrap().as_secs() < 24 * 3600 {
            times.push(next_line(*times.last().unwrap()));
        }
        assert_eq!(times[1].as_secs(), 20);
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] >= LINE && pair[1] - pair[0] <= LONGEST));
        assert!(times.len() < 200, "{} lines in a day", times.len());
    }

    #[test]
    fn the_time_left_counts_what_was_done_since_the_run_was_taken_up() {
        let seconds = Duration::from_secs;
        let shown = |first, elapsed, fraction| line(elapsed, fraction, &left(first, (elapsed, fraction)), "");
        // Half of the way in a minute leaves a minute; from 0.4 on, a tenth in a minute leaves five.
        assert_eq!(shown((seconds(0), 0.0), seconds(60), 0.5), "50.0 % after 1 min, about 1 min left\n");
        assert_eq!(shown((seconds(0), 0.4), seconds(60), 0.5), "50.0 % after 1 min, about 5 min left\n");
        assert_eq!(shown((seconds(60), 0.5), seconds(60), 0.5), "50.0 % after 1 min\n");
        // A millionth in a minute would leave two years.
        assert_eq!(shown((seconds(0), 0.0), seconds(60), 1e-6), "0.0 % after 1 min\n");
        assert_eq!(
            shown((seconds(0), 0.0), seconds(60), 0.002),
            "0.2 % after 1 min, about 8 h 19 min left\n"
        );
    }

    #[test]
    fn the_time_left_follows_the_speed_of_the_last_half() {
        let seconds = Duration::from_secs;
        // A table that counts half takes a minute, and the rest 39 minutes, of which three are over.
        let done = |second: u64| (second.min(60) as f64 / 120.0) + second.saturating_sub(60) as f64 / 4680.0;
        let mut marks = Marks::new((seconds(0), 0.0));
        (1..=240).for_each(|second| marks.pass((seconds(second), done(second))));
        // The speed is that since the mark at 64 s, after the table; that of the whole run would leave three and a half.
        assert_eq!(marks.left((seconds(240), done(240))), ", about 36 min left");
    }
}
