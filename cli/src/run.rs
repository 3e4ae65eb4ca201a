//! `asperity run`: read, compute, draw, write, summarise.
use super::Failure;
use super::arguments::Run;
use super::progress::{self, Progress};
pub fn run(arguments: &Run) -> Result<(), Failure> {
    progress::catch_interrupts();
    let input = asperity_runner::input::read(&arguments.scenario.path, &arguments.scenario.overrides)?;
    let _ = (
        Progress::new(arguments.quiet),
        arguments.directory(),
        arguments.json,
        arguments.threads,
        progress::interrupted(),
    );
    super::print(&asperity_runner::input::to_text(&input.scenario))
}
