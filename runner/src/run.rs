//! Computation of a scenario, from its text to its outcome.

use asperity::monitor::{Monitor, Part};
use asperity::record::Record;
use asperity::scenario::{FitPosterior, Scenario};
use asperity::task::Storage;
use asperity::task::summary::{FitNumbers, Numbers, Summary};
use asperity::{Result, task};

use crate::output::Outcome;
use crate::{input, posterior};

/// Computes `scenario`.
///
/// # Errors
/// An invalid value, results too large for the memory, a stop by the monitor.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Outcome> {
    run_with(scenario, Storage::default(), monitor)
}

/// As [`run`], resumed from the last checkpoint of `storage`, and storing new ones. What is put into its store of columns is not
/// in the record of the outcome.
///
/// # Errors
/// As [`run`]; a stop if something cannot be stored or read ([`Checkpoints::failure`](crate::checkpoint::Checkpoints::failure),
/// [`StoredColumns::failure`](crate::StoredColumns::failure)).
pub fn run_with(scenario: &Scenario, storage: Storage<'_>, monitor: &mut dyn Monitor) -> Result<Outcome> {
    scenario.is_one_case("asperity sweep, or sweep() in Python")?;
    let (summary, record) = match scenario.fit.as_ref().and_then(|fit| fit.posterior) {
        Some(sampling) => fit_and_sample(scenario, sampling, monitor)?,
        None => task::run_with(scenario, storage, monitor)?,
    };
    Ok(Outcome { scenario: input::to_text(scenario), summary, record })
}

/// A fit, and draws from its posterior.
fn fit_and_sample(
    scenario: &Scenario,
    sampling: FitPosterior,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    /// Share of the fit in the work.
    const FIT: f64 = 0.1;
    let (mut summary, mut record, found) = task::run_fit(scenario, &mut Part::new(monitor, 0.0, FIT))?;
    let monitor = &mut Part::new(monitor, FIT, 1.0 - FIT);
    let drawn = found.standardised().and_then(|target| posterior::sample(&target, sampling, monitor));
    let drawn = drawn.map_err(|error| error.under("fit"))?;
    let reported = drawn.summary(|name| found.key(name));
    summary.warnings.extend(reported.warnings().into_iter().map(|text| format!("fit.posterior: {text}")));
    summary.seed = Some(sampling.seed);
    if let Numbers::Fit(FitNumbers { fit }) = &mut summary.numbers {
        fit.posterior = Some(reported);
    }
    let diverging = drawn.diverging.iter().map(|&diverging| f64::from(u8::from(diverging))).collect();
    let steps = drawn.steps.iter().map(|&steps| steps as f64).collect();
    let draws = [drawn.log_density, diverging, steps];
    task::record_posterior(&mut record, sampling.chains, &drawn.values, draws);
    Ok((summary, record))
}
