//! `asperity sweep`: plan, compute what is not stored yet, gather, draw, write, summarise.

use std::fmt::Write as _;
use std::path::Path;

use asperity_runner::output::{self, Written};
use asperity_runner::sweep::{
    AxisReport, Dataset, Error, Gathered, KeptReport, Part, Plan, Report, Store, Values,
};
use asperity_runner::{input, memory, sweep};

use super::arguments::Sweep;
use super::figure::{self, digits};
use super::interrupt::{Interrupts, Reason};
use super::progress::Progress;
use super::{Failure, print, run, threads};

pub fn sweep(arguments: &Sweep) -> Result<(), Failure> {
    let interrupts = Interrupts::listen().map_err(Failure::run)?;
    let input = input::read(&arguments.scenario.path, &arguments.scenario.overrides)?;
    let style = arguments.style(&input.scenario.figure);
    run::checked(&style)?;
    let plan = Plan::new(&input)?;
    let directory = arguments.directory();
    let mut store = Store::new(&directory, plan.identity());
    if arguments.explain {
        return print(&explained(&plan, &mut store)?);
    }
    interrupts.whole(|| output::check(&directory)).map_err(Failure::run)?;
    if !arguments.quiet {
        run::warn(&input);
    }
    let part = arguments.part.unwrap_or(Part::ALL);
    let memory = run::allowed(arguments.memory)?;
    let _lock = store.lock(arguments.part.map(|part| part.to_string()).as_deref())?;
    if !arguments.gather {
        arguments.max_time.into_iter().for_each(|limit| interrupts.limit(limit));
        compute(&plan, part, &mut store, (arguments, memory), &interrupts)?;
    }
    if arguments.part.is_some() && !arguments.gather {
        return computed(part, &mut store, arguments);
    }
    let dataset = gathered(&plan, &mut store, (arguments, memory))?;
    let figures = figure::of_sweep(&dataset, &style).map_err(Failure::run)?;
    interrupts.write_results().map_err(|reason| Failure::Interrupted(reason, None))?;
    let written = sweep::write(&directory, &dataset, &figures)?;
    if !arguments.quiet {
        run::report(&written.renamed);
    }
    summarise(&dataset, &directory, &written, arguments)
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::run(error)
    }
}

/// Computes the cases of a part that are not stored.
fn compute(
    plan: &Plan,
    part: Part,
    store: &mut Store,
    (arguments, memory): (&Sweep, Option<u64>),
    interrupts: &Interrupts,
) -> Result<(), Failure> {
    let there = store.there(!arguments.retry)?;
    tell_of_store(store, arguments);
    let all = (0..plan.count()).filter(|&case| part.has(case)).count();
    let missing: Vec<usize> = (0..plan.count()).filter(|&case| part.has(case) && !there[case]).collect();
    let stored = there.iter().filter(|there| **there).count();
    if stored > 0 && !arguments.resume && !arguments.retry && arguments.part.is_none() {
        let path = store.folder().to_owned();
        return Err(Error::Unfinished { path, stored, all }.into());
    }
    if arguments.part.is_some() {
        store.note_parts(part.of)?;
    }
    interrupts.take_over();
    let mut monitor = Progress::new(arguments.quiet, memory, interrupts);
    let before = all - missing.len();
    let work = || sweep::run(plan, &missing, before, store, &mut monitor);
    match threads::on(arguments.threads, work)? {
        Err(Error::Stopped(asperity::Error::Stopped)) => {
            let reason = interrupts.reason().unwrap_or(Reason::Signal);
            Err(Failure::Interrupted(reason, Some(store.folder().to_owned())))
        }
        other => Ok(other?),
    }
}

/// Says which stored files are not used.
fn tell_of_store(store: &Store, arguments: &Sweep) {
    if arguments.quiet {
        return;
    }
    for (path, what) in store.damaged() {
        run::say(&format!("warning: {}: {what}; its cases are computed again", path.display()));
    }
    for (path, what) in store.others() {
        run::say(&format!("warning: {} is not used: it holds {what}", path.display()));
    }
}

/// What is said after a part.
fn computed(part: Part, store: &mut Store, arguments: &Sweep) -> Result<(), Failure> {
    if arguments.quiet {
        return Ok(());
    }
    let there = store.there(true)?;
    let stored = there.iter().filter(|there| **there).count();
    let text = format!(
        "{:<22} {stored} of {} cases, in {}\n",
        format!("part {}/{}", part.index, part.of),
        there.len(),
        store.folder().display()
    );
    let next = if stored == there.len() { "--gather writes the results\n" } else { "" };
    print(&(text + next))
}

/// All cases, or the error that names those that are missing.
fn gathered(
    plan: &Plan,
    store: &mut Store,
    (arguments, memory): (&Sweep, Option<u64>),
) -> Result<Dataset, Failure> {
    if arguments.gather {
        let there = store.there(true)?;
        tell_of_store(store, arguments);
        if there.contains(&false) {
            return Err(store.missing(&there)?.into());
        }
    }
    store.finish()?;
    let in_memory = memory.unwrap_or_else(memory::available) / run::SHARE;
    let gathered = store.gathered(&plan.places(), in_memory)?;
    if gathered.there.contains(&false) {
        return Err(store.missing(&gathered.there)?.into());
    }
    Ok(Dataset::of_plan(plan, gathered))
}

/// What would be computed.
fn explained(plan: &Plan, store: &mut Store) -> Result<String, Failure> {
    let there = store.there(true)?;
    let stored = there.iter().filter(|there| **there).count();
    // What there will be, without values.
    let dataset = Dataset::of_plan(plan, Gathered::new(0, &plan.places()));
    let axes: Vec<AxisReport> = dataset.axes.iter().map(AxisReport::new).collect();
    let mut text = heading(&dataset.title, (plan.count(), 0), &axes);
    for kept in &dataset.variables {
        let unit = if kept.units.is_empty() { String::new() } else { format!(" ({})", kept.units) };
        let _ = writeln!(text, "{:<22} {}{unit}", "keep", said(&kept.name, &kept.long_name));
    }
    let curves = plan.bytes_of_curves();
    if curves > 0 {
        let _ = writeln!(text, "{:<22} {} in sweep.nc", "curves", memory::words(curves));
    }
    let _ = writeln!(
        text,
        "{:<22} {stored} of {} cases, in {}",
        "stored",
        plan.count(),
        store.folder().display()
    );
    text += "The corners are valid. Nothing was computed.\n";
    Ok(text)
}

fn said(name: &str, meaning: &str) -> String {
    if meaning.is_empty() { name.to_owned() } else { format!("{name}: {meaning}") }
}

/// Title, cases and axes.
fn heading(title: &str, (cases, failed): (usize, usize), axes: &[AxisReport]) -> String {
    let mut text = if title.is_empty() { String::new() } else { format!("{title}\n\n") };
    let failed = if failed == 0 { String::new() } else { format!(", {failed} of them failed") };
    let _ = writeln!(text, "{:<22} {cases}{failed}", "cases");
    for axis in axes {
        let range = axis
            .range
            .map_or(String::new(), |[low, high]| format!(" from {} to {}", digits(low), digits(high)));
        let _ = writeln!(text, "{:<22} {}: {} values{range}", "axis", axis.keys.join(", "), axis.values);
    }
    text
}

/// Prints the summary in the requested form.
fn summarise(
    dataset: &Dataset,
    directory: &Path,
    written: &Written,
    arguments: &Sweep,
) -> Result<(), Failure> {
    let report = Report::new(dataset).map_err(Failure::run)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&report).expect("a report is plain data");
        print(&format!("{json}\n"))?;
        return some_is_found(&report);
    }
    if arguments.quiet {
        return some_is_found(&report);
    }
    let mut text = heading(&report.title, (report.cases, report.failed), &report.axes);
    // Estimated errors are in the files.
    let kept = || report.kept.iter().filter(|kept| !["failure", "accuracy"].contains(&kept.name.as_str()));
    let width = kept().fold(22, |widest, kept| widest.max(kept.name.chars().count()));
    for kept in kept() {
        let _ = writeln!(text, "{:<width$} {}", kept.name, found(kept));
    }
    if let Some(Values::Texts(reasons)) = dataset.get("failure").map(|variable| &variable.values)
        && let Some(first) = reasons.iter().find(|reason| !reason.is_empty())
    {
        let _ = writeln!(text, "{:<22} {first}", "first failure");
    }
    text += &run::files(directory, written);
    let _ = writeln!(text, "  {:<20} {}.sweep-* (may be removed)", "stored cases", directory.display());
    print(&text)?;
    some_is_found(&report)
}

/// The exit status tells of a sweep in which every case failed.
fn some_is_found(report: &Report) -> Result<(), Failure> {
    if report.failed < report.cases {
        Ok(())
    } else {
        Err(Failure::run(format!("all {} cases failed", report.cases)))
    }
}

/// The range of the numbers, or how often there is each word.
fn found(kept: &KeptReport) -> String {
    const MOST: usize = 6;
    let unit =
        if kept.units.is_empty() || kept.units == "1" { String::new() } else { format!(" {}", kept.units) };
    if !kept.words.is_empty() {
        let each = |(word, count): &(String, usize)| format!("{word} ({count})");
        let some: Vec<_> = kept.words.iter().take(MOST).map(each).collect();
        let rest = if kept.words.len() > MOST { ", …" } else { "" };
        return some.join(", ") + rest;
    }
    match kept.range {
        None => "in no case".to_owned(),
        Some([low, high]) if low == high => format!("{}{unit}", digits(low)),
        Some([low, high]) => format!("{} to {}{unit}", digits(low), digits(high)),
    }
}
