//! `asperity run`: read, compute, draw, write, summarise.

use std::io::Write as _;

use asperity::scenario::Scenario;
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
    let outcome = compute(&input, arguments)?;
    let figures = figure::draw(&outcome).map_err(Failure::run)?;
    if progress::interrupted() {
        return Err(Failure::Interrupted);
    }
    output::write(&directory, &outcome, &figures).map_err(Failure::run)?;
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
        // Where this cannot be written there is nobody to be warned.
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
}

/// The outcome of the scenario, on as many threads as asked for.
fn compute(input: &input::Input, arguments: &Run) -> Result<output::Outcome, Failure> {
    let mut monitor = Progress::new(arguments.quiet);
    let mut compute = || task::run(&input.scenario, &mut monitor);
    let outcome = match arguments.threads {
        None => compute(),
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build();
            pool.map_err(Failure::run)?.install(compute)
        }
    };
    outcome.map_err(|error| match error {
        asperity::Error::Stopped => Failure::Interrupted,
        asperity::Error::Invalid { .. } | asperity::Error::TooLarge { .. } => input.diagnose(&error).into(),
        other => Failure::run(other),
    })
}
