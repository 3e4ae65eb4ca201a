//! Draws from the posterior of a fit by the No-U-turn sampler.
//!
//! The sampler is that of nuts-rs (Hoffman and Gelman, *J. Mach. Learn. Res.* **15**, 1593 (2014)), in the standardised coordinates
//! of [`Standardised`]. Each chain has its own stream of random numbers, so that draws depend on the seed and on nothing else.

mod convergence;
mod density;

use std::ops::ControlFlow;
use std::rc::Rc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use asperity::fit::Standardised;
use asperity::monitor::Monitor;
use asperity::random::{Purpose, Stream};
use asperity::scenario::FitPosterior;
use asperity::task::summary::{Extended, PosteriorNumber, PosteriorSummary};
use asperity::{Error, Result};
use nuts_rs::{Chain, CpuMath, DiagNutsSettings, Settings};
use serde::{Deserialize, Serialize};

pub use convergence::{effective_size, r_hat};
use density::{Density, Evaluations};

/// Draws of each chain before those that are kept: step size and scales are found from them.
const TUNING: usize = 300;
/// Half the width of the range of first points, in standard errors.
const START: f64 = 2.0;
/// Probabilities of the quantiles that are reported.
const QUANTILES: [f64; 3] = [0.025, 0.5, 0.975];
/// Interval between two calls of the monitor.
const PERIOD: Duration = Duration::from_millis(20);

/// Draws from the posterior of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Posterior {
    /// The names of the numbers; those that are known only by a limit keep their estimates and are not among them.
    pub names: Vec<String>,
    /// How the draws were made.
    pub sampling: FitPosterior,
    /// For each number its value in each draw, one chain after the other.
    pub values: Vec<Vec<f64>>,
    /// The logarithm of the posterior density in the varied coordinates, without its constant, at each draw.
    pub log_density: Vec<f64>,
    /// Whether the path to each draw diverged: where the density bends too much for the steps of the sampler.
    pub diverging: Vec<bool>,
    /// Evaluations of the density for each draw.
    pub steps: Vec<u64>,
}

impl Posterior {
    /// Number of draws whose paths diverged.
    pub fn divergences(&self) -> usize {
        self.diverging.iter().filter(|&&diverging| diverging).count()
    }

    /// Means, quantiles and the agreement of the chains; `key` gives the name to show for that of a number.
    pub fn summary(&self, key: impl Fn(&str) -> String) -> PosteriorSummary {
        let FitPosterior { draws, chains, .. } = self.sampling;
        let number = |(name, values): (&String, &Vec<f64>)| {
            let (mean, std) = moments(values);
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            PosteriorNumber {
                key: key(name),
                mean,
                std,
                quantiles: QUANTILES.map(|p| quantile(&sorted, p)),
                r_hat: Extended(r_hat(values, chains)),
                effective_size: Extended(effective_size(values, chains)),
            }
        };
        let numbers = self.names.iter().zip(&self.values).map(number).collect();
        PosteriorSummary { chains, draws, divergences: self.divergences(), numbers }
    }
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// The quantile of probability `p` of sorted values, linear between them.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Draws from the posterior `target` of a fit, with as many chains at a time as there are threads.
///
/// # Errors
/// Fewer than 4 draws, no chain; errors of the solver; stopped by the monitor.
pub fn sample(
    target: &Standardised<'_>,
    sampling: FitPosterior,
    monitor: &mut dyn Monitor,
) -> Result<Posterior> {
    sampling.check()?;
    let made = on_threads(target, sampling, monitor)?;
    let all = |of: &dyn Fn(&Drawn) -> f64| made.iter().flatten().map(of).collect::<Vec<f64>>();
    let names: Vec<String> = target.names().into_iter().map(str::to_owned).collect();
    Ok(Posterior {
        sampling,
        values: (0..names.len()).map(|k| all(&|drawn| drawn.values[k])).collect(),
        log_density: all(&|drawn| drawn.log_density),
        diverging: made.iter().flatten().map(|drawn| drawn.diverging).collect(),
        steps: made.iter().flatten().map(|drawn| drawn.steps).collect(),
        names,
    })
}

/// One draw.
#[derive(Debug)]
struct Drawn {
    values: Vec<f64>,
    log_density: f64,
    diverging: bool,
    steps: u64,
}

/// What all threads know of the work.
#[derive(Debug, Default)]
struct Shared {
    stopped: AtomicBool,
    drawn: AtomicUsize,
    taken: AtomicUsize,
}

/// Forwards a stop of the calling thread.
impl Monitor for &Shared {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The draws of all chains. The monitor is called on this thread only, the chains run on others.
fn on_threads(
    target: &Standardised<'_>,
    sampling: FitPosterior,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Vec<Drawn>>> {
    let chains = sampling.chains;
    let workers = rayon::current_num_threads().min(chains);
    let made: Vec<OnceLock<Result<Vec<Drawn>>>> = (0..chains).map(|_| OnceLock::new()).collect();
    let shared = Shared::default();
    // Parallel loops of a chain run on its share of the threads: those of the caller's pool may be none of this process.
    let share = rayon::current_num_threads() / workers;
    let work = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(share).use_current_thread().build();
        let _pool = pool.expect("a pool with the thread that asks for it");
        loop {
            let number = shared.taken.fetch_add(1, Ordering::Relaxed);
            let Some(place) = made.get(number) else { break };
            let draws = chain(target, (sampling, number), &shared);
            if draws.is_err() {
                shared.stopped.store(true, Ordering::Relaxed);
            }
            place.get_or_init(|| draws);
        }
    };
    let all = (chains * (TUNING + sampling.draws)) as f64;
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        while !threads.iter().all(std::thread::ScopedJoinHandle::is_finished) {
            let fraction = shared.drawn.load(Ordering::Relaxed) as f64 / all;
            if monitor.progress(fraction).is_break() {
                shared.stopped.store(true, Ordering::Relaxed);
            }
            std::thread::sleep(PERIOD);
        }
    });
    let results: Vec<_> = made.into_iter().filter_map(OnceLock::into_inner).collect();
    // An error of one chain stops the others; it is the one to report.
    let failure =
        results.iter().filter_map(|chain| chain.as_ref().err()).find(|error| **error != Error::Stopped);
    failure.map_or(Ok(()), |error| Err(error.clone()))?;
    results.into_iter().collect()
}

/// The draws of chain `number`.
///
/// # Errors
/// Errors of the solver; stopped.
fn chain(
    target: &Standardised<'_>,
    (sampling, number): (FitPosterior, usize),
    shared: &Shared,
) -> Result<Vec<Drawn>> {
    let mut stream = Stream::new(sampling.seed, Purpose::Posterior, number as u64);
    let start = start(target, &mut stream, shared)?;
    let settings = DiagNutsSettings {
        num_tune: TUNING as u64,
        num_draws: sampling.draws as u64,
        ..DiagNutsSettings::default()
    };
    let evaluations = Rc::new(Evaluations::default());
    let density = Density { target, shared, evaluations: Rc::clone(&evaluations) };
    let failed = |text: String| evaluations.failure.take().unwrap_or_else(|| unexpected(text));
    let chain = settings.new_chain(number as u64, CpuMath::new(density), &mut stream);
    let mut chain = chain.map_err(|error| failed(error.to_string()))?;
    chain.set_position(&start).map_err(|error| failed(error.to_string()))?;
    let mut drawn = Vec::with_capacity(sampling.draws);
    for draw in 0..TUNING + sampling.draws {
        let (z, reported) = chain.draw().map_err(|error| failed(error.to_string()))?;
        let log_density = evaluations.at(&z);
        if draw >= TUNING {
            let values = target.values(&z);
            drawn.push(Drawn {
                values,
                log_density,
                diverging: reported.diverging,
                steps: reported.num_steps,
            });
        }
        shared.drawn.fetch_add(1, Ordering::Relaxed);
    }
    Ok(drawn)
}

/// A point with a density, within [`START`] standard errors of the estimates.
///
/// # Errors
/// Errors of the solver; stopped.
fn start(target: &Standardised<'_>, stream: &mut Stream, mut shared: &Shared) -> Result<Vec<f64>> {
    /// Times that the range is halved, before the estimates themselves are taken.
    const HALVED: i32 = 8;
    let count = target.names().len();
    for halved in 0..HALVED {
        let width = START * 0.5_f64.powi(halved);
        let z: Vec<f64> = (0..count).map(|_| width * (2.0 * stream.uniform() - 1.0)).collect();
        if target.log_density(&z, &mut shared)?.0.is_finite() {
            return Ok(z);
        }
    }
    Ok(vec![0.0; count])
}

/// A refusal of the sampler that is none of the density.
fn unexpected(text: String) -> Error {
    Error::invalid("posterior", "a density with a slope at the estimates", text)
}
