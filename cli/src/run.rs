//! `asperity run`: read, compute, draw, write, summarise.

use std::io::Write as _;
use std::path::Path;

use asperity::scenario::{Figure, Scenario};
use asperity::task::summary::Summary;
use asperity::task::{self, Storage};
use asperity_runner::checkpoint::Checkpoints;
use asperity_runner::input::{self, Input};
use asperity_runner::output::{Attachment, Outcome, Renamed, Written};
use asperity_runner::{StoredColumns, memory, output, run_with};

use super::arguments::Run;
use super::interrupt::{Interrupts, Reason};
use super::progress::Progress;
use super::{Failure, drawing, figure, print, summary, threads};

/// Columns of results are kept in memory up to this fraction of it.
pub const SHARE: u64 = 8;
/// Pictures are drawn of what takes this fraction of the memory.
pub const SHOWN: u64 = 4;
/// Bytes of an interface that are worth a word.
const LARGE: u64 = 256 << 20;

pub fn run(arguments: &Run) -> Result<(), Failure> {
    let interrupts = Interrupts::listen().map_err(Failure::run)?;
    let input = input::read(&arguments.scenario.path, &arguments.scenario.overrides)?;
    let one = input.scenario.is_one_case("asperity sweep");
    one.map_err(|error| input.diagnose(&error))?;
    let style = arguments.style(&input.scenario.figure);
    checked(&style)?;
    let directory = arguments.directory();
    interrupts.whole(|| output::check(&directory)).map_err(Failure::run)?;
    if !arguments.quiet {
        warn(&input);
    }
    let mut checkpoints = checkpoints(&input.scenario, arguments, &interrupts)?;
    arguments.max_time.into_iter().for_each(|limit| interrupts.limit(limit));
    let memory = allowed(arguments.memory)?;
    if !arguments.quiet {
        estimate(&input.scenario, memory);
    }
    // Only interfaces have columns that grow; to ask the system takes as long as to read the scenario.
    let room = |_| memory.unwrap_or_else(memory::available) / SHARE;
    let in_memory = input.scenario.interface.as_ref().map_or(0, room);
    let mut stored = StoredColumns::beside(&directory, in_memory);
    let storage = (checkpoints.as_mut(), &mut stored);
    let mut outcome = compute(&input, storage, (arguments, memory), &interrupts)?;
    if checkpoints.is_some() {
        // The work is done, and no checkpoint has the end of the run.
        interrupts.finish();
    }
    let drawn =
        threads::on(arguments.threads, || draw(&mut outcome, (&stored, memory), (&style, arguments.quiet)))?;
    // Results that have been computed are written, whatever becomes of their pictures.
    let (figures, missing) = match drawn {
        Ok(figures) => (figures, None),
        Err(failure) => (Vec::new(), Some(failure)),
    };
    interrupts.write_results().map_err(|reason| Failure::Interrupted(reason, None))?;
    let results = (&outcome, Some(&stored));
    let written =
        output::write_only(&directory, results, &figures, arguments.files()).map_err(Failure::run)?;
    if !arguments.quiet {
        report(&written.renamed);
    }
    checkpoints.map_or(Ok(()), Checkpoints::remove)?;
    print_summary(&outcome.summary, &directory, &written, arguments)?;
    if let Some(failure) = missing {
        return Err(failure);
    }
    match outcome.summary.numbers.fit() {
        Some(fit) if !fit.converged => Err(Failure::run(format!(
            "the fit has not converged; its last values and its misfit are in {}",
            directory.display()
        ))),
        _ => Ok(()),
    }
}

/// Prints the summary in the requested form.
fn print_summary(
    summary: &Summary,
    directory: &Path,
    written: &Written,
    arguments: &Run,
) -> Result<(), Failure> {
    if arguments.json {
        let json = serde_json::to_string_pretty(summary).expect("a summary is plain data");
        return print(&format!("{json}\n"));
    }
    if arguments.quiet {
        return Ok(());
    }
    print(&format!("{}{}", summary::readable(summary), files(directory, written)))
}

/// The folder and what is in it, pictures without their formats.
pub fn files(directory: &Path, written: &Written) -> String {
    let mut text = format!("{:<22} {}\n", "results", directory.display());
    text += &format!("  {:<20} {}\n", "data", written.results.join(", "));
    if let Some(pictures) = drawn(&written.attached) {
        text += &format!("  {:<20} {pictures}\n", "pictures");
    }
    text
}

/// The names of pictures, each once, and their formats; `None` without pictures.
pub fn drawn(pictures: &[String]) -> Option<String> {
    let (mut names, mut formats): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for (name, format) in pictures.iter().filter_map(|picture| picture.rsplit_once('.')) {
        if !names.contains(&name) {
            names.push(name);
        }
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    (!names.is_empty()).then(|| format!("{} ({})", names.join(", "), formats.join(", ")))
}

/// Refuses pictures that cannot be drawn, before anything is computed.
pub fn checked(style: &Figure) -> Result<(), Failure> {
    figure::check(style).map_err(|expected| Failure::Input(format!("error: {expected}\n")))
}

/// Prints the warnings.
pub fn warn(input: &Input) {
    for warning in &input.warnings {
        say(&format!("warning: {warning}"));
    }
}

/// Reports files of the user that were renamed because results have their names.
pub fn report(renamed: &[Renamed]) {
    for file in renamed {
        let [from, to] = [&file.from, &file.to].map(|path| path.display());
        say(&format!("warning: {from} was not written by asperity, or was changed; it is kept as {to}"));
    }
}

/// Writes to the standard error. If that fails, there is no reader to inform.
pub fn say(words: &str) {
    let _ = writeln!(std::io::stderr(), "{words}");
}

/// The requested checkpoints. A run with a time limit keeps one if it can.
fn checkpoints(
    scenario: &Scenario,
    arguments: &Run,
    interrupts: &Interrupts,
) -> Result<Option<Checkpoints>, Failure> {
    let Run { checkpoint: every, resume, quiet, max_time, .. } = *arguments;
    let wanted = max_time.is_some() && scenario.keeps_checkpoints("--max-time").is_ok();
    if every.is_none() && !resume && !wanted {
        return Ok(None);
    }
    interrupts.take_over();
    let option = if resume { "--resume" } else { "--checkpoint" };
    scenario.keeps_checkpoints(option).map_err(|error| Failure::Input(format!("error: {error}\n")))?;
    let directory = arguments.directory();
    if !resume {
        let checkpoints = Checkpoints::begin(&directory, scenario, every)?;
        return Ok(Some(checkpoints.interrupted_by(interrupts.signalled())));
    }
    let checkpoints =
        Checkpoints::resume(&directory, scenario, every)?.interrupted_by(interrupts.signalled());
    if !quiet {
        checkpoints.damaged().iter().for_each(|damaged| say(&format!("warning: {damaged}")));
        say(&match checkpoints.resumed() {
            Some((path, events)) => format!("continuing from {}, after {events} events", path.display()),
            None => format!("no checkpoint for {}: the run starts at the beginning", directory.display()),
        });
    }
    Ok(Some(checkpoints))
}

/// Computes the scenario on the requested number of threads.
fn compute(
    input: &Input,
    (mut checkpoints, stored): (Option<&mut Checkpoints>, &mut StoredColumns),
    (arguments, memory): (&Run, Option<u64>),
    interrupts: &Interrupts,
) -> Result<Outcome, Failure> {
    let mut monitor = Progress::new(arguments.quiet, memory, interrupts);
    let computed = threads::on(arguments.threads, || {
        let checkpoints = checkpoints.as_deref_mut().map(|kept| kept as &mut dyn task::Checkpoints);
        run_with(&input.scenario, Storage { checkpoints, columns: Some(&mut *stored) }, &mut monitor)
    })?;
    computed.map_err(|error| match error {
        asperity::Error::Stopped => {
            stored.failure().map_or_else(|| stopped(checkpoints, interrupts), Failure::run)
        }
        asperity::Error::Invalid { .. } => input.diagnose(&error).into(),
        // The input is valid but too large.
        asperity::Error::TooLarge { .. } | asperity::Error::Accuracy { .. } => {
            Failure::Run(drawing::draw(*input.diagnose(&error)))
        }
        other => Failure::run(other),
    })
}

/// The memory that the run may take, if the command or the environment says.
pub fn allowed(given: Option<u64>) -> Result<Option<u64>, Failure> {
    let given = given.map_or_else(memory::in_environment, |given| Ok(Some(given)));
    given.map_err(|wrong| Failure::Input(format!("error: {wrong}\n")))
}

/// Says how much memory a large interface takes.
fn estimate(scenario: &Scenario, memory: Option<u64>) {
    let model = scenario.interface.as_ref().and_then(|_| scenario.build().ok());
    let needed = model.and_then(|model| model.memory_of_interface());
    let Some(needed) = needed.filter(|&needed| needed >= LARGE) else { return };
    let available = memory::words(memory.unwrap_or_else(memory::available));
    say(&format!("memory: up to {} for the interface, of {available} available", memory::words(needed)));
}

/// The pictures. Of columns that have outgrown the memory they show what takes a fraction of it.
fn draw(
    outcome: &mut Outcome,
    (stored, memory): (&StoredColumns, Option<u64>),
    (style, quiet): (&Figure, bool),
) -> Result<Vec<Attachment>, Failure> {
    if style.formats.is_empty() || stored.columns().is_empty() {
        return figure::draw(outcome, style).map_err(Failure::run);
    }
    let most = memory.unwrap_or_else(memory::available) / SHOWN;
    let record = output::drawn(&outcome.record, stored, most)
        .map_err(|error| Failure::run(format_args!("cannot read columns of the results: {error}")))?;
    let [shown, all] = [record.bytes(), outcome.record.bytes() + stored.bytes()];
    if shown < all && !quiet {
        let [shown, all] = [shown, all].map(memory::words);
        say(&format!("pictures show {shown} of {all}: of maps some, evenly spaced"));
    }
    let (scenario, summary) = (outcome.scenario.clone(), outcome.summary.clone());
    figure::draw(&mut Outcome { scenario, summary, record }, style).map_err(Failure::run)
}

/// The reason why a run was stopped.
fn stopped(checkpoints: Option<&mut Checkpoints>, interrupts: &Interrupts) -> Failure {
    interrupts.take_over();
    let reason = interrupts.reason().unwrap_or(Reason::Signal);
    let Some(checkpoints) = checkpoints else { return Failure::Interrupted(reason, None) };
    checkpoints.failure().map_or_else(|| Failure::Interrupted(reason, checkpoints.last()), Failure::from)
}
