//! Makes `docs/validation/accuracy.md`: how accurate results are by default, and what they cost, for each family of
//! distributions by its width and for each rule in time.
//!
//! `cargo run --release --package asperity-cli --example accuracy` computes everything and writes the page; its test computes what
//! is quick.

mod cases;

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use asperity::monitor::Monitor;
use asperity_runner::{input, run};
use cpu_time::ProcessTime;

use cases::{RULES, UNIT, VARIATIONS, families};

/// The most units that an entry may take: one that takes more has no place in the page.
const MOST: f64 = 20_000.0;
/// Runs of the unit, of which the cost is the median.
const REPEATS: usize = 9;

const HEAD: &str = "\
<!-- Written by `make accuracy`: change cli/examples/accuracy instead. -->
# Default accuracy and cost

Each entry is for a pull over five mean thresholds without `master_equation.tolerance`. The first number is the estimated
error of $F/(N_c\\langle k\\rangle \\bar x)$ (`accuracy` in `summary.json`), rounded up to a power of ten. The second is the cost,
in units of a pull with Gaussian thresholds of coefficient of variation 0.05, measured in the same run. Costs have at most two
significant digits and depend on the machine; accuracies do not. No pull is refused, and none takes more than 20 000 units:
`make accuracy` fails otherwise.
";

/// What came of a scenario.
struct Entry {
    /// The estimated error, per mean threshold.
    accuracy: f64,
    seconds: f64,
}

/// Stops what takes too long.
struct Deadline {
    begun: ProcessTime,
    seconds: f64,
}

impl Monitor for Deadline {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        if self.begun.elapsed().as_secs_f64() > self.seconds {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/validation/accuracy.md")
}

/// Runs the contacts and the task of a text in TOML.
fn entry(text: &str, seconds: f64) -> Result<Entry, String> {
    let input = input::parse(text, "accuracy", Path::new(""), &[]).map_err(|error| error.to_string())?;
    let mut deadline = Deadline { begun: ProcessTime::now(), seconds };
    let outcome = run(&input.scenario, &mut deadline).map_err(|error| error.to_string())?;
    let seconds = deadline.begun.elapsed().as_secs_f64();
    let accuracy = outcome.summary.accuracy.ok_or("a pull reports its accuracy")?;
    Ok(Entry { accuracy, seconds })
}

/// The seconds of one unit, once everything is in memory.
fn unit() -> f64 {
    let mut seconds: Vec<_> =
        (0..REPEATS).map(|_| entry(UNIT, f64::INFINITY).expect("the unit runs").seconds).collect();
    seconds.sort_by(f64::total_cmp);
    seconds[REPEATS / 2]
}

/// An error rounded up to a power of ten.
fn accuracy(error: f64) -> String {
    let decade = error.max(1e-16).log10().ceil();
    format!("1e{decade}")
}

/// A cost in two digits.
fn cost(units: f64) -> String {
    let two: f64 = format!("{units:.1e}").parse().unwrap_or(units);
    format!("{two}")
}

/// Cells of tables, and entries that there are none of.
struct Maker {
    unit: f64,
    missing: Vec<String>,
}

impl Maker {
    fn cell(&mut self, name: &str, text: Option<String>) -> String {
        let Some(text) = text else { return "–".into() };
        match entry(&text, MOST * self.unit) {
            Ok(Entry { accuracy: error, seconds }) => {
                format!("{}, {}", accuracy(error), cost(seconds / self.unit))
            }
            Err(reason) => {
                self.missing.push(format!("{name}: {reason}"));
                "none".into()
            }
        }
    }
}

fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn head(columns: &[String]) -> String {
    let rule: Vec<_> = columns.iter().map(|_| "---".to_owned()).collect();
    row(columns) + &row(&rule)
}

fn distributions(maker: &mut Maker) -> String {
    let mut text = "\n## Distributions of thresholds\n\nBy the coefficient of variation: accuracy, cost. A dash: no \
                    member of the family has this width. For the Gaussian it is that before truncation at 0.\n\n"
        .to_owned();
    text += &head(
        &["distribution".to_owned()]
            .into_iter()
            .chain(VARIATIONS.map(|cv| format!("{cv:e}")))
            .collect::<Vec<_>>(),
    );
    for family in families() {
        let cells = VARIATIONS.map(|cv| {
            let begun = std::time::Instant::now();
            let cell = maker.cell(&format!("{} {cv:e}", family.name), family.pull(cv));
            eprintln!("{} {cv:e}: {cell} ({:.1} s)", family.name, Duration::as_secs_f64(&begun.elapsed()));
            cell
        });
        text += &row(&[family.name.to_owned()].into_iter().chain(cells).collect::<Vec<_>>());
    }
    text
}

fn rules(maker: &mut Maker) -> String {
    let mut text =
        "\n## Time-dependent contacts\n\nAt a velocity, in mean thresholds per time 1: accuracy, cost.\n\n"
            .to_owned();
    text += &head(&["rule", "contacts", "1e-6", "1e-2", "1", "100"].map(str::to_owned));
    for rule in RULES {
        let cells = cases::VELOCITIES.map(|velocity| {
            let cell = maker.cell(&format!("{} {velocity:e}", rule.name), Some(rule.pull(velocity)));
            eprintln!("{} {velocity:e}: {cell}", rule.name);
            cell
        });
        text +=
            &row(&[rule.name.to_owned(), rule.words.to_owned()].into_iter().chain(cells).collect::<Vec<_>>());
    }
    text
}

fn main() -> ExitCode {
    let mut maker = Maker { unit: unit(), missing: Vec::new() };
    let mut text = HEAD.to_owned();
    text += &distributions(&mut maker);
    text += &rules(&mut maker);
    let mut said = String::new();
    maker
        .missing
        .iter()
        .for_each(|missing| writeln!(said, "no entry: {missing}").expect("a string takes all"));
    eprint!("{said}");
    match std::fs::write(page(), text) {
        Ok(()) if maker.missing.is_empty() => ExitCode::SUCCESS,
        Ok(()) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{}: {error}", page().display());
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Families whose pulls take seconds.
    const SLOW: [&str; 3] = ["tabulated", "areas", "renormalised"];

    /// What is quick: name and error.
    fn quick() -> Vec<(&'static str, f64)> {
        let error = |name: &str, text: &str| match entry(text, f64::INFINITY) {
            Ok(entry) => entry.accuracy,
            Err(reason) => panic!("{name}: {reason}"),
        };
        let widths = || VARIATIONS.into_iter().filter(|cv| (0.02..0.4).contains(cv));
        let mut found = Vec::new();
        for family in families().iter().filter(|family| !SLOW.contains(&family.name)) {
            let pulls = widths().filter_map(|cv| family.pull(cv));
            found.extend(pulls.map(|pull| (family.name, error(family.name, &pull))));
        }
        let rules = RULES.iter().filter(|rule| rule.quick);
        found.extend(rules.map(|rule| (rule.name, error(rule.name, &rule.pull(1.0)))));
        assert!(found.len() > 15, "{}", found.len());
        found
    }

    #[test]
    fn what_is_quick_reaches_the_aim() {
        for (name, error) in quick() {
            // What is aimed at where nothing is said, of F per contact and mean threshold.
            assert!(error <= 1e-10, "{name}: {error:e}");
        }
    }

    #[test]
    fn errors_are_rounded_up_and_costs_to_two_digits() {
        assert_eq!([1e-17, 3e-12, 1e-11, 1.1e-5].map(accuracy), ["1e-16", "1e-11", "1e-11", "1e-4"]);
        assert_eq!([0.123, 1.0, 17.6, 1234.0].map(cost), ["0.12", "1", "18", "1200"]);
    }
}
