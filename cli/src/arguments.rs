//! What may be typed after `asperity`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity::scenario::{Figure, FigureFormat};
use asperity_runner::checkpoint::Every;
use asperity_runner::output::Only;
use asperity_runner::sweep::Part;
use asperity_runner::{duration, memory};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use super::threads;

/// Friction of many contacts that stretch, break and re-form: the master equation and the ensemble.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compute a scenario, write the results to a folder and print a summary
    Run(Run),
    /// Compute all cases of a scenario with [sweep], and gather what is kept of them in one file
    #[command(after_help = SWEEPS)]
    Sweep(Sweep),
    /// Change a scenario by hand in a browser, computed by this command at full speed; Ctrl-C ends it
    #[cfg(feature = "explore")]
    Explore(Explore),
    /// Read a scenario and say whether it is valid, without computing it
    Check(Scenario),
    /// Draw the pictures of a folder of results anew, from its result.nc
    Plot {
        /// The folder, as written by asperity run
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        #[command(flatten)]
        pictures: Pictures,
    },
    /// Print the JSON Schema of scenarios: every key, its meaning and its default
    Schema,
    /// Print a scenario that comes with asperity; without a name, list them
    Example {
        /// Name of the scenario, such as fig2
        name: Option<String>,
    },
    /// Print the licences of the crates that asperity contains
    Notices,
    /// Print a manual page, for a file asperity.1, or asperity-run.1, in a folder man1 of the MANPATH
    Man {
        /// The command, such as run; without one, the page of asperity itself
        command: Option<String>,
    },
    /// Print a completion script for a shell
    #[command(after_help = COMPLETIONS)]
    Completions {
        /// The shell
        shell: Shell,
    },
}

impl Command {
    /// What contradicts itself in the options, if anything does.
    pub fn contradiction(&self) -> Option<&'static str> {
        match self {
            Self::Run(run) => run.contradiction(),
            Self::Sweep(sweep) => sweep.pictures.contradiction(sweep.no_figures),
            Self::Plot { pictures, .. } => pictures.contradiction(false),
            _ => None,
        }
    }
}

/// How the parts of a sweep belong together.
const SWEEPS: &str = "Finished cases are stored beside DIR, in DIR.sweep-HASH. After an interruption, the same command with --resume
computes the missing ones. In parts, on one machine or several that share the folder:
  asperity sweep SCENARIO --part 1/3     and 2/3 and 3/3, in any order
  asperity sweep SCENARIO --gather       writes the results into DIR";

/// Where the completion scripts of the shells belong.
const COMPLETIONS: &str = "Save the script where the shell looks for it:
  bash        ~/.local/share/bash-completion/completions/asperity
  zsh         _asperity in a folder of $fpath
  fish        ~/.config/fish/completions/asperity.fish
  elvish      at the end of ~/.config/elvish/rc.elv
  powershell  at the end of $PROFILE";

#[derive(Debug, Args)]
pub struct Scenario {
    /// The scenario, a TOML file
    #[arg(value_name = "SCENARIO")]
    pub path: PathBuf,
    /// Replace a value, such as contacts.thresholds.gaussian.std=0.1; a distribution replaces the one in the file
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    pub scenario: Scenario,
    /// Folder for the results [default: out/<name of the scenario>]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads::parse)]
    pub threads: Option<usize>,
    /// Memory that the run may take (8GB, 7.5GiB, 16G); more is refused before any work [default: what the machine has free]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    pub memory: Option<u64>,
    /// Write checkpoints of the drive of an [interface], for --resume: after each number of events (2000) or time interval (10min)
    #[arg(long, value_name = "EVENTS|TIME")]
    pub checkpoint: Option<Every>,
    /// Stop after this time (90s, 10min, 1h30min, 23:50:00); the drive of an [interface] then writes a checkpoint
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub max_time: Option<Duration>,
    /// Continue from the last checkpoint of a stopped run; without one, start at the beginning
    #[arg(long)]
    pub resume: bool,
    #[command(flatten)]
    pub pictures: Pictures,
    /// Draw no pictures
    #[arg(long, conflicts_with = "figures")]
    pub no_figures: bool,
    /// Write only these files beside scenario.toml, separated by commas: nc, csv, json, figures [default: all]
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = ["nc", "csv", "json", "figures"])]
    pub only: Vec<String>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Sweep {
    #[command(flatten)]
    pub scenario: Scenario,
    /// Folder for the results [default: out/<name of the scenario>]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Compute one part of the cases, such as 2/8, and only store them; --gather collects the parts
    #[arg(long, value_name = "I/N", conflicts_with = "gather")]
    pub part: Option<Part>,
    /// Compute nothing: gather the stored cases of all parts and write the results
    #[arg(long)]
    pub gather: bool,
    /// Continue a stopped sweep with the cases that are not stored
    #[arg(long)]
    pub resume: bool,
    /// Compute cases again that failed, for example for want of memory, beside those that are not stored
    #[arg(long, conflicts_with = "gather")]
    pub retry: bool,
    /// Print the axes, the number of cases, what is kept and what is stored, and compute nothing
    #[arg(long)]
    pub explain: bool,
    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads::parse)]
    pub threads: Option<usize>,
    /// Memory that the sweep may take (8GB, 7.5GiB, 16G), shared by the cases side by side [default: what the machine has free]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    pub memory: Option<u64>,
    /// Stop after this time (90s, 10min, 1h30min, 23:50:00); what is finished is stored
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub max_time: Option<Duration>,
    #[command(flatten)]
    pub pictures: Pictures,
    /// Draw no pictures
    #[arg(long, conflicts_with = "figures")]
    pub no_figures: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(feature = "explore")]
#[derive(Debug, Args)]
pub struct Explore {
    /// The scenario that the page opens with, a TOML file [default: stick-slip]
    #[arg(value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// Port of this machine at which the page is [default: one that is free]
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Print the address of the page, and open no browser
    #[arg(long)]
    pub no_open: bool,
    /// Give up what takes longer than this (90s, 10min)
    #[arg(long, value_name = "TIME", value_parser = duration::parse, default_value = "5min")]
    pub max_time: Duration,
}

/// How pictures are drawn, instead of [figure] in the scenario.
#[derive(Debug, Args)]
pub struct Pictures {
    /// File formats of the pictures, separated by commas [default: svg]
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', value_parser = format())]
    pub figures: Option<Vec<FigureFormat>>,
    /// Width of a picture in mm, such as 86 for a column [default: 175]
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub figure_width: Option<f64>,
    /// Height in mm of a picture of one panel; others in proportion [default: 8/11 of the width]
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub figure_height: Option<f64>,
    /// Font size of the labels of axes in points [default: in proportion to the width, 11 at 175 mm]
    #[arg(long, value_name = "POINTS", value_parser = positive)]
    pub figure_font_size: Option<f64>,
    /// Dots per inch of PNG pictures, which are drawn then without --figures, too [default: 200]
    #[arg(long, value_name = "DPI", value_parser = positive)]
    pub figure_dpi: Option<f64>,
    /// Draw pictures in shades of grey
    #[arg(long)]
    pub figure_grey: bool,
    /// Leave out the title above pictures
    #[arg(long)]
    pub no_title: bool,
}

impl Pictures {
    /// How pictures are drawn; what is not asked for is as in the scenario.
    pub fn style(&self, scenario: &Figure) -> Figure {
        Figure {
            formats: self.formats(scenario),
            width: self.figure_width.or(scenario.width),
            height: self.figure_height.or(scenario.height),
            font_size: self.figure_font_size.or(scenario.font_size),
            title: scenario.title && !self.no_title,
            grey: scenario.grey || self.figure_grey,
            dpi: self.figure_dpi.unwrap_or(scenario.dpi),
        }
    }

    /// The formats: those of `--figures`, or those of the scenario and PNG where its dots are asked for.
    fn formats(&self, scenario: &Figure) -> Vec<FigureFormat> {
        let png = self.figure_dpi.map(|_| FigureFormat::Png);
        let with_png = || {
            let also = png.filter(|png| !scenario.formats.contains(png));
            scenario.formats.iter().copied().chain(also).collect()
        };
        self.figures.clone().unwrap_or_else(with_png)
    }

    /// Whether dots are asked for beside formats that have none.
    fn has_dots_without_png(&self) -> bool {
        let lacks_png = |formats: &Vec<FigureFormat>| !formats.contains(&FigureFormat::Png);
        self.figure_dpi.is_some() && self.figures.as_ref().is_some_and(lacks_png)
    }

    /// Whether an option says how pictures are drawn.
    fn are_asked_for(&self) -> bool {
        let numbers = [self.figure_width, self.figure_height, self.figure_font_size, self.figure_dpi];
        self.figures.is_some() || numbers.iter().any(Option::is_some) || self.figure_grey || self.no_title
    }

    /// What contradicts itself, if anything does; no picture is drawn if `none`.
    fn contradiction(&self, none: bool) -> Option<&'static str> {
        if none && self.are_asked_for() {
            Some("options of pictures beside --no-figures")
        } else {
            self.has_dots_without_png().then_some("--figure-dpi beside --figures without png")
        }
    }

    /// The same, with no picture at all if `none`.
    fn unless(&self, none: bool, scenario: &Figure) -> Figure {
        let style = self.style(scenario);
        if none { Figure { formats: Vec::new(), ..style } } else { style }
    }
}

/// A file format of pictures, by its name.
fn format() -> impl TypedValueParser<Value = FigureFormat> {
    let names = PossibleValuesParser::new(FigureFormat::ALL.map(FigureFormat::name));
    names.map(|name| {
        FigureFormat::ALL.into_iter().find(|format| format.name() == name).unwrap_or(FigureFormat::Svg)
    })
}

/// A finite number above 0.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) && value > 0.0 => Ok(value),
        Ok(f64::INFINITY) => Err("expected a finite number above 0".into()),
        _ => Err("expected a number above 0".into()),
    }
}

impl Run {
    /// How pictures are drawn.
    pub fn style(&self, scenario: &Figure) -> Figure {
        self.pictures.unless(self.no_figures || !self.writes("figures"), scenario)
    }

    /// What contradicts itself in the options, if anything does.
    fn contradiction(&self) -> Option<&'static str> {
        match self.writes("figures") {
            false if self.pictures.are_asked_for() => {
                Some("options of pictures beside --only without figures")
            }
            true if self.no_figures && !self.only.is_empty() => {
                Some("--no-figures beside --only with figures")
            }
            _ => self.pictures.contradiction(self.no_figures),
        }
    }

    /// Which files of results are written.
    pub fn files(&self) -> Only {
        Only { netcdf: self.writes("nc"), csv: self.writes("csv"), json: self.writes("json") }
    }

    /// Whether files of this kind are written.
    fn writes(&self, kind: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == kind)
    }

    /// Where the results go.
    pub fn directory(&self) -> PathBuf {
        self.scenario.directory(self.output.as_deref())
    }
}

impl Sweep {
    /// How pictures are written.
    pub fn style(&self, scenario: &Figure) -> Figure {
        self.pictures.unless(self.no_figures, scenario)
    }

    /// Where the results go.
    pub fn directory(&self) -> PathBuf {
        self.scenario.directory(self.output.as_deref())
    }
}

impl Scenario {
    /// Where its results go: the folder that is given, or one with its name.
    fn directory(&self, given: Option<&Path>) -> PathBuf {
        let named = || PathBuf::from("out").join(self.path.file_stem().unwrap_or("scenario".as_ref()));
        given.map_or_else(named, Path::to_owned)
    }
}
