//! Tasks: computations on a [`Model`], with their results as a few numbers and as labelled columns.
//!
//! A task is described in [`scenario`](crate::scenario). Each has a method `check` for its values, and a method `run`, which
//! checks them and returns an [`Output`]: the numbers of the task, the accuracy reached, and every array as a variable of a
//! [`Record`]. [`columns`] lists the variables of each task. No file is needed:
//!
//! ```
//! use std::sync::Arc;
//! use asperity::contacts::{Contacts, Initial};
//! use asperity::law::{Gaussian, Point};
//! use asperity::scenario::{Model, VelocityCurve};
//!
//! let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
//! let model = Model::new(contacts, Initial::default());
//! let curve = VelocityCurve::between(0.1, 10.0).run(&model)?;
//! // Without time-dependent rules friction is the same at all velocities: F_k = (1 + σ²)/2 for a narrow Gaussian.
//! let friction = curve.record.values("kinetic_friction").unwrap();
//! assert!(friction.iter().all(|force| (force - 0.505).abs() < 1e-9));
//! # Ok::<(), asperity::Error>(())
//! ```

mod accuracy;
mod background;
mod checkpoint;
mod coordinates;
mod creep;
mod distribution;
mod drive;
mod ensemble;
mod fit;
mod fit_numbers;
mod fit_steady;
mod fit_velocity_curve;
mod free_form;
mod grid;
mod hold_curve;
mod in_time;
pub mod interface;
mod interpolated;
mod linear_stability;
mod posterior;
mod protocol;
mod pull;
mod renormalisation;
mod settling;
pub mod sliding;
mod spectrum;
mod stability;
mod stick_slip;
mod stick_slip_scatter;
mod storage;
pub mod summary;
mod velocity_curve;

use serde::{Deserialize, Serialize};

use crate::law::Atom;
use crate::master::{Pull, Relaxation, SteadyState};
use crate::monitor::{Aside, Monitor, Rising};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{Compare, Contacts, Model, Scenario, Task};
use crate::{Error, Result};

pub use checkpoint::{Checkpoints, WriteState, write_cbor};
pub use coordinates::{COORDINATES, is_coordinate};
pub use drive::first_loading_distance;
pub use fit::KeyedEstimates;
pub use fit_velocity_curve::velocity_curve_of_fit;
pub use grid::Grid;
pub use in_time::finite_size_tolerance;
pub use interface::cells_in_time;
pub use interpolated::{coordinate, interpolated};
pub use linear_stability::{LinearStability, stability};
pub use posterior::record_posterior;
pub use pull::record_pull;
pub use stick_slip::{StickSlipStability, stick_slip_stability};
pub use stick_slip_scatter::{StickSlipScatter, stick_slip_scatter};
pub use storage::{ColumnStore, Storage};
use summary::{
    Comparison, Extended, FitSummary, Friction, FrictionCoefficients, Numbers, StaticFriction, Summary,
};

/// The results of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Output<N> {
    /// The numbers of the task.
    pub numbers: N,
    /// Estimated error of F/(N_c⟨k⟩), a length; `None` where all contacts are followed one by one.
    pub accuracy: Option<f64>,
    /// Warnings about valid but surprising input or results.
    pub warnings: Vec<String>,
    /// Number of contacts of the finite-size band and of the ensemble.
    pub sample: Option<f64>,
    /// Seed of the random numbers; `None` where none were drawn.
    pub seed: Option<u64>,
    /// All arrays.
    pub record: Record,
}

impl<N> Output<N> {
    /// An output without an accuracy.
    fn new(model: &Model, numbers: N, record: Record) -> Self {
        let seed = model.ensemble.as_ref().map(|ensemble| ensemble.seed);
        Self { numbers, accuracy: None, warnings: Vec::new(), sample: model.sample(), seed, record }
    }

    /// The output with its numbers converted to [`Numbers`].
    fn erased(self) -> Output<Numbers>
    where
        N: Into<Numbers>,
    {
        let Self { numbers, accuracy, warnings, sample, seed, record } = self;
        Output { numbers: numbers.into(), accuracy, warnings, sample, seed, record }
    }
}

/// Computes the task of `scenario`; returns its summary and all arrays. Front ends draw `fit.posterior`, see [`run_fit`].
///
/// # Errors
/// An invalid value, results too large for the memory, errors of the solvers, a stop by the monitor.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<(Summary, Record)> {
    run_with(scenario, Storage::default(), monitor)
}

/// As [`run`], resumed from the last checkpoint of `storage`, and storing new ones. What is put into its store of columns is
/// missing in the arrays.
///
/// # Errors
/// As [`run`]; a stop if something cannot be stored or read.
pub fn run_with(
    scenario: &Scenario,
    storage: Storage<'_>,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let model = &scenario.build_with(&mut Aside { fraction: 0.0, monitor })?;
    let output = compute(scenario, model, storage, &mut Rising::new(monitor)).map_err(Error::of_scenario)?;
    Ok(summarised(scenario, model, output))
}

/// Computes the `[fit]` of `scenario` as [`run`] does, and returns the estimates too: front ends draw `fit.posterior` from them.
///
/// # Errors
/// As [`run`]; a scenario with another task.
pub fn run_fit(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<(Summary, Record, KeyedEstimates)> {
    let model = &scenario.build_with(&mut Aside { fraction: 0.0, monitor })?;
    let Task::Fit(task) = scenario.task()? else {
        return Err(Error::invalid("fit", "a table [fit]", "another task"));
    };
    let (output, found) = fit::found(model, task, &mut Rising::new(monitor)).map_err(Error::of_scenario)?;
    let (summary, record) = summarised(scenario, model, output.erased());
    Ok((summary, record, found))
}

/// The summary and the arrays of an output.
fn summarised(scenario: &Scenario, model: &Model, output: Output<Numbers>) -> (Summary, Record) {
    let Output { numbers, accuracy, warnings, sample, seed, record } = output;
    let contacts = &scenario.contacts;
    let summary = Summary {
        title: scenario.title.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        units: scenario.units.clone(),
        accuracy,
        contacts: contacts.count,
        background_force: background_force(contacts, &numbers),
        normal_load: contacts.normal_load,
        sample,
        seed,
        disorder: scenario.ensemble.as_ref().map(|ensemble| ensemble.disorder),
        numbers,
        warnings: [model.warnings.clone(), warnings].concat(),
    };
    (summary, record)
}

/// The background force that the friction forces of a result contain. A fit that finds it has it among its numbers.
fn background_force(contacts: &Contacts, numbers: &Numbers) -> Option<f64> {
    let is_found =
        |fit: &FitSummary| fit.numbers.iter().any(|number| number.key.ends_with("background_force"));
    let force = contacts.background().ok().filter(|&force| force > 0.0);
    force.filter(|_| !numbers.fit().is_some_and(is_found))
}

/// The output of the task of `scenario`, which has built `model`.
fn compute(
    scenario: &Scenario,
    model: &Model,
    storage: Storage<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Output<Numbers>> {
    Ok(match scenario.task()? {
        Task::Pull(task) => pull::run(model, task, monitor)?.erased(),
        Task::Drive(task) => match &scenario.interface {
            Some(interface) => {
                interface::run(model, task, (interface, &scenario.units), storage, monitor)?.erased()
            }
            None => drive::run(model, task, monitor)?.erased(),
        },
        Task::Protocol(task) => match (&scenario.interface, &scenario.block) {
            (Some(interface), _) => {
                let described = (interface, &scenario.units);
                interface::run_protocol(model, task, described, storage, monitor)?.erased()
            }
            (None, Some(block)) => protocol::run_block(model, task, block, monitor)?.erased(),
            (None, None) => protocol::run(model, task, monitor)?.erased(),
        },
        Task::VelocityCurve(task) => velocity_curve::run(model, task, monitor)?.erased(),
        Task::HoldCurve(task) => hold_curve::run(model, task, monitor)?.erased(),
        Task::Creep(task) => creep::run(model, task, monitor)?.erased(),
        Task::Spectrum(task) => spectrum::run(model, task, monitor)?.erased(),
        Task::Stability(task) => stability::run(model, task, monitor)?.erased(),
        Task::Fit(task) => fit::run(model, task, monitor)?.erased(),
        Task::Renormalisation(task) => renormalisation::run(model, task, monitor)?.erased(),
    })
}

/// Defines the public `run` of each task, which checks first, and collects what tasks declare.
macro_rules! tasks {
    ($($task:ident: $module:ident => $numbers:ident;)*) => {
        $(impl crate::scenario::$task {
            /// Computes the task for `model`: see [`task`](crate::task).
            ///
            /// # Errors
            /// A value that is invalid or incompatible with the model; results too large for the memory; errors of the
            /// solvers.
            pub fn run(&self, model: &Model) -> Result<Output<summary::$numbers>> {
                self.run_with(model, &mut ())
            }

            /// The same with a monitor.
            ///
            /// # Errors
            /// As [`Self::run`]; stopped by the monitor.
            pub fn run_with(&self, model: &Model, monitor: &mut dyn Monitor) -> Result<Output<summary::$numbers>> {
                Task::$task(self).check_with(model, monitor)?;
                $module::run(model, self, &mut Rising::new(monitor)).map_err(Error::of_scenario)
            }
        })*

        /// The variables of each task, without values: what its [`Output`] may hold. The names of tasks are those of
        /// [`Numbers`]; contacts coupled one by one have an entry of their own.
        pub fn columns() -> Vec<(&'static str, Record)> {
            [$($module::columns()),*].concat()
        }

        /// The tables in CSV that tasks declare. Traces, events and point masses have tables of several kinds, which front
        /// ends make.
        pub fn tables() -> impl Iterator<Item = &'static CsvTable> {
            [$($module::TABLES),*].into_iter().flatten()
        }
    };
}

tasks! {
    Pull: pull => PullNumbers;
    Drive: drive => DriveNumbers;
    Protocol: protocol => ProtocolNumbers;
    VelocityCurve: velocity_curve => VelocityCurveNumbers;
    HoldCurve: hold_curve => HoldCurveNumbers;
    Creep: creep => CreepNumbers;
    Spectrum: spectrum => SpectrumNumbers;
    Stability: stability => StabilityNumbers;
    Fit: fit => FitNumbers;
    Renormalisation: renormalisation => RenormalisationNumbers;
}

/// Friction from a pull and from steady sliding.
fn friction(model: &Model, steady: &SteadyState, relaxation: &Relaxation, pull: &Pull) -> Friction {
    let background = model.background;
    let kinetic_friction = steady.kinetic_friction() + background;
    let peak = pull.static_friction().map(|peak| (peak.value + background, peak.position));
    let coefficients = |normal_load: f64| FrictionCoefficients {
        normal_load,
        at_rest: peak.map(|(force, _)| force / normal_load),
        kinetic: kinetic_friction / normal_load,
    };
    Friction {
        static_friction: peak.map_or(StaticFriction::NotReached, |(force, position)| {
            StaticFriction::Reached { force, position }
        }),
        kinetic_friction,
        relaxation_length: Extended(relaxation.length()),
        relaxation_length_paper: Extended(relaxation.paper_estimate()),
        critical_stiffness: Extended(pull.critical_stiffness()),
        friction_coefficients: model.normal_load.map(coefficients),
    }
}

const COMPARED_FORCE: Column =
    Column::new("compared_force", "measured force", Quantity::Force, &["compared"]);

/// NaN where no force is computed.
const RESIDUAL: Column =
    Column::new("compared_residual", "measured less computed force", Quantity::Force, &["compared"]);

const COMPARED: [Column; 3] = [
    Column::new("compared_position", "measured position", Quantity::Length, &["compared"]),
    COMPARED_FORCE,
    RESIDUAL,
];

/// Adds the measured curve to `record`, and compares it with the computed `force`, which is defined between the `ends`.
fn compare(curve: &Compare, ends: (f64, f64), force: impl Fn(f64) -> f64, record: &mut Record) -> Comparison {
    let computed = |&x: &f64| (ends.0..=ends.1).contains(&x).then(|| force(x));
    let computed: Vec<_> = curve.points().0.iter().map(computed).collect();
    compare_points(curve, COMPARED[0], &computed, record)
}

/// Adds the measured curve to `record`, against the column `along`, and compares it with the forces that are computed at its
/// points.
fn compare_points(
    curve: &Compare,
    along: Column,
    computed: &[Option<f64>],
    record: &mut Record,
) -> Comparison {
    let (places, forces) = curve.points();
    let residuals =
        forces.iter().zip(computed).map(|(force, computed)| computed.map(|computed| force - computed));
    let residuals: Vec<Option<f64>> = residuals.collect();
    let (points, squares) = residuals.iter().flatten().fold((0, 0.0), |(n, sum), r| (n + 1, sum + r * r));
    record.add(along, places.to_vec());
    record.add(COMPARED_FORCE, forces.to_vec());
    record.add(RESIDUAL, residuals.into_iter().map(|residual| residual.unwrap_or(f64::NAN)).collect());
    let residual_rms = (points > 0).then(|| (squares / points as f64).sqrt());
    Comparison { points, measured: places.len(), residual_rms }
}

/// Adds point masses: a column for each of their coordinates, and one for their weights. Adds nothing if there are none.
fn add_atoms<const N: usize>(
    record: &mut Record,
    (places, weight): ([Column; N], Column),
    masses: impl Iterator<Item = ([f64; N], f64)>,
) {
    let (at, weights): (Vec<[f64; N]>, Vec<f64>) = masses.unzip();
    if weights.is_empty() {
        return;
    }
    for (i, place) in places.into_iter().enumerate() {
        record.add(place, at.iter().map(|place| place[i]).collect());
    }
    record.add(weight, weights);
}

/// A point mass in the form of the argument of [`add_atoms`].
fn placed(atom: &Atom) -> ([f64; 1], f64) {
    ([atom.position], atom.weight)
}

/// Refuses, before any work, results of more numbers than fit in memory.
fn fits(key: &str, numbers: usize, what: impl FnOnce() -> String, monitor: &dyn Monitor) -> Result<()> {
    let (needed, allowed) = (numbers.saturating_mul(size_of::<f64>()) as u64, monitor.memory());
    if needed <= allowed {
        return Ok(());
    }
    Err(Error::TooLarge { key: key.into(), what: what(), needed, allowed })
}
