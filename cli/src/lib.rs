//! The command line of asperity, for its program and for the Python package.

mod arguments;
mod drawing;
mod examples;
mod excerpt;
#[cfg(feature = "explore")]
mod explore;
mod figure;
mod interrupt;
mod progress;
mod run;
mod summary;
mod sweep;
mod threads;

use std::ffi::OsString;
use std::fmt;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use asperity_runner::{checkpoint, input, memory, output};
use clap::{CommandFactory as _, Parser as _};

use arguments::{Arguments, Command, Pictures};
use interrupt::Reason;

/// The reason why a command failed; each has its exit code.
enum Failure {
    /// The run failed: disk, memory.
    Run(String),
    /// Wrong input, as displayed text.
    Input(String),
    /// The run was stopped, and can be resumed from this checkpoint.
    Interrupted(Reason, Option<PathBuf>),
    /// The explorer has ended, as it always does, by a signal.
    #[cfg(feature = "explore")]
    Ended,
}

impl Failure {
    fn run(error: impl fmt::Display) -> Self {
        Self::Run(format!("error: {error}\n"))
    }
}

impl From<Box<input::Diagnostic>> for Failure {
    fn from(diagnostic: Box<input::Diagnostic>) -> Self {
        Self::Input(drawing::draw(*diagnostic))
    }
}

impl From<checkpoint::Error> for Failure {
    fn from(error: checkpoint::Error) -> Self {
        match error {
            checkpoint::Error::Another { .. } => Self::Input(format!("error: {error}\n")),
            other => Self::run(other),
        }
    }
}

/// Runs the command with its arguments, of which the first is the name of the program, and gives its exit code.
pub fn main_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let command = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments.command,
        Err(error) => {
            // If this cannot be printed, the exit code still reports it.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(1);
        }
    };
    let (message, code) = match execute(command) {
        Ok(()) => return 0,
        Err(Failure::Run(message)) => (message, 1),
        Err(Failure::Input(message)) => (message, 2),
        Err(Failure::Interrupted(reason, checkpoint)) => {
            (interrupt::message(reason, checkpoint.as_deref()), interrupt::CODE)
        }
        #[cfg(feature = "explore")]
        Err(Failure::Ended) => ("the explorer has ended\n".into(), interrupt::CODE),
    };
    // If even this cannot be written, the exit code still reports the failure.
    let _ = std::io::stderr().write_all(message.as_bytes());
    code
}

fn execute(command: Command) -> Result<(), Failure> {
    if let Some(what) = command.contradiction() {
        return Err(Failure::Input(format!("error: expected options that agree, got {what}\n")));
    }
    match command {
        Command::Run(run) => run::run(&run),
        Command::Sweep(sweep) => sweep::sweep(&sweep),
        #[cfg(feature = "explore")]
        Command::Explore(asked) => explore::explore(&asked),
        Command::Check(scenario) => check(&scenario),
        Command::Plot { folder, pictures } => plot(&folder, &pictures),
        Command::Schema => print(&format!("{}\n", input::editor_schema())),
        Command::Example { name: None } => print(&examples::list()),
        Command::Example { name: Some(name) } => match examples::find(&name) {
            Some(text) => print(&text),
            None => Err(Failure::Input(match examples::nearest(&name) {
                Some(nearest) => format!(
                    "error: there is no example {name}; did you mean {nearest}? (asperity example lists all)\n"
                ),
                None => format!("error: there is no example {name}; the examples are\n{}", examples::list()),
            })),
        },
        Command::Notices => print(include_str!(concat!(env!("ASPERITY_SHIPPED"), "/THIRD-PARTY.txt"))),
        Command::Man { command } => manual(command.as_deref()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "asperity", &mut script);
            print(&String::from_utf8_lossy(&script))
        }
    }
}

/// Reads a scenario, with the corners of its sweep if it has one.
fn check(scenario: &arguments::Scenario) -> Result<(), Failure> {
    let input = input::read(&scenario.path, &scenario.overrides)?;
    run::checked(&input.scenario.figure)?;
    let cases = match input.scenario.sweep {
        Some(_) => format!(", a sweep of {} cases", asperity_runner::sweep::Plan::new(&input)?.count()),
        None => String::new(),
    };
    run::warn(&input);
    print(&format!("{}: valid{cases}\n", scenario.path.display()))
}

/// Draws the pictures of a folder of results anew.
fn plot(folder: &Path, pictures: &Pictures) -> Result<(), Failure> {
    let drawn = if folder.join("sweep.nc").is_file() {
        let dataset = asperity_runner::sweep::read_drawn(folder).map_err(Failure::run)?;
        let style = pictures.style(&input::figure(&dataset.scenario));
        run::checked(&style)?;
        figure::of_sweep(&dataset, &style)
    } else {
        let most = run::allowed(None)?.unwrap_or_else(memory::available) / run::SHOWN;
        let mut outcome = output::read_drawn(folder, most).map_err(Failure::run)?;
        let style = pictures.style(&input::figure(&outcome.scenario));
        run::checked(&style)?;
        figure::draw(&mut outcome, &style)
    };
    let drawn = drawn.map_err(Failure::run)?;
    run::report(&output::attach(folder, &drawn).map_err(Failure::run)?);
    let names: Vec<String> = drawn.into_iter().map(|picture| picture.name).collect();
    let names = run::drawn(&names).unwrap_or_else(|| "none for these results".into());
    print(&format!("{:<22} {names}\n", "pictures"))
}

/// Prints the manual page of a command.
fn manual(command: Option<&str>) -> Result<(), Failure> {
    let mut program = Arguments::command();
    program.build();
    let described = match command {
        None => &program,
        Some(name) => program.find_subcommand(name).ok_or_else(|| {
            Failure::Input(format!("error: there is no command {name}; asperity --help lists all\n"))
        })?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(described.clone()).render(&mut page).map_err(Failure::run)?;
    print(&String::from_utf8_lossy(&page))
}

/// Writes to the standard output. A reader that closes it is no error.
fn print(text: &str) -> Result<(), Failure> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::run(format_args!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}
