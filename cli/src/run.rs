//! `asperity run`: read, compute, draw, write, summarise.

use std::io::Write as _;

use asperity::scenario::Scenario;
use asperity_runner::checkpoint::Checkpoints;
use asperity_runner::{input, output, task};

use super::arguments::Run;
use super::progress::{self, Progress};
use super::{Failure, figure, print, summary};

pub fn run(arguments: &Run) -> Result<(), Failure> {
    progress::catch_interrupts();
    let input = input::read(&arguments.scenario.path, &arguments.scenario.overrides)?;
    let directory = arguments.directory();
    output::check(&directory).map_err(Failure::run)?;
    if !arguments.quiet {
        warn(&input.scenario);
    }
    let mut checkpoints = checkpoints(&input.scenario, arguments)?;
    let outcome = compute(&input, checkpoints.as_mut(), arguments)?;
    let figures = figure::draw(&outcome).map_err(Failure::run)?;
    if progress::interrupted() {
        return Err(Failure::Interrupted(checkpoints.and_then(|checkpoints| checkpoints.last())));
    }
    output::write(&directory, &outcome, &figures).map_err(Failure::run)?;
    checkpoints.map_or(Ok(()), Checkpoints::remove)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&outcome.summary).expect("a summary is plain data");
        return print(&format!("{json}\n"));
    }
    if arguments.quiet {
        return Ok(());
    }
    print(&format!("{}{:<22} {}\n", summary::readable(&outcome.summary), "results", directory.display()))
}

/// Says what makes sense but will surprise.
pub fn warn(scenario: &Scenario) {
    for warning in scenario.warnings() {
        say(&format!("warning: {warning}"));
    }
}

/// Tells on the standard error; where this cannot be written there is nobody to be told.
fn say(words: &str) {
    let _ = writeln!(std::io::stderr(), "{words}");
}

/// The checkpoints that are asked for.
fn checkpoints(scenario: &Scenario, arguments: &Run) -> Result<Option<Checkpoints>, Failure> {
    let Run { checkpoint: every, resume, quiet, .. } = *arguments;
    if every.is_none() && !resume {
        return Ok(None);
    }
    let option = if resume { "--resume" } else { "--checkpoint" };
    scenario.keeps_checkpoints(option).map_err(|error| Failure::Input(format!("error: {error}\n")))?;
    let directory = arguments.directory();
    if !resume {
        return Ok(Some(Checkpoints::begin(&directory, scenario, every)?));
    }
    let checkpoints = Checkpoints::resume(&directory, scenario, every)?;
    if !quiet {
        checkpoints.damaged().iter().for_each(|damaged| say(&format!("warning: {damaged}")));
        say(&match checkpoints.resumed() {
            Some((path, events)) => format!("going on from {}, after {events} events", path.display()),
            None => format!("no checkpoint beside {}: the run begins at its start", directory.display()),
        });
    }
    Ok(Some(checkpoints))
}

/// The outcome of the scenario, on as many threads as asked for.
fn compute(
    input: &input::Input,
    mut checkpoints: Option<&mut Checkpoints>,
    arguments: &Run,
) -> Result<output::Outcome, Failure> {
    let mut monitor = Progress::new(arguments.quiet);
    let mut compute = || task::run_with(&input.scenario, checkpoints.as_deref_mut(), &mut monitor);
    let outcome = match arguments.threads {
        None => compute(),
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build();
            pool.map_err(Failure::run)?.install(compute)
        }
    };
    outcome.map_err(|error| match error {
        asperity::Error::Stopped => stopped(checkpoints),
        asperity::Error::Invalid { .. } | asperity::Error::TooLarge { .. } => input.diagnose(&error).into(),
        other => Failure::run(other),
    })
}

/// Why a run was stopped.
fn stopped(checkpoints: Option<&mut Checkpoints>) -> Failure {
    let Some(checkpoints) = checkpoints else { return Failure::Interrupted(None) };
    checkpoints.failure().map_or_else(|| Failure::Interrupted(checkpoints.last()), Failure::from)
}
