//! The description of a computation in plain values, as written in a scenario file, and the objects it builds.
//!
//! One file per table. A description holds values, never paths: whoever reads files replaces
//! `file` keys by the values read before building ([`Scenario::tables`], [`Compare`]).
//! Errors carry the full path of the key (`contacts.thresholds.gaussian.std`).
//!
//! ```
//! use asperity::scenario::Scenario;
//!
//! let text = r#"{
//!     "contacts": { "thresholds": { "gaussian": { "mean": 1.0, "std": 0.1 } } },
//!     "pull": { "distance": 5.0, "points": 11 }
//! }"#;
//! let scenario: Scenario = serde_json::from_str(text).expect("keys of a scenario");
//! let (_, record) = asperity::task::run(&scenario, &mut ())?;
//! assert_eq!(record.values("force").map(<[f64]>::len), Some(11));
//! # Ok::<(), asperity::Error>(())
//! ```

/// Hands all tasks to the macro `$list`: what the task does, in one sentence, the name of its table, and its type. All lists of
/// tasks are made of this one.
macro_rules! each_task {
    ($list:ident) => {
        $list! {
            /// `[pull]` displaces the base of the slider.
            pull: Pull,
            /// `[drive]` displaces its top, the load point, or imposes a force.
            drive: Drive,
            /// `[[protocol]]` moves the base, or the load point of a `[block]` or of an `[interface]`, in time.
            protocol: Protocol,
            /// `[velocity_curve]` computes kinetic friction against velocity.
            velocity_curve: VelocityCurve,
            /// `[hold_curve]` computes static friction against hold time.
            hold_curve: HoldCurve,
            /// `[creep]` computes slip in time under constant forces, and the times to failure.
            creep: Creep,
            /// `[spectrum]` computes the noise of the force in steady sliding.
            spectrum: Spectrum,
            /// `[stability]` reports whether the slider of a `[block]` sticks and slips.
            stability: Stability,
            /// `[fit]` finds numbers of the contacts, with their errors, from measured forces.
            fit: Fit,
            /// `[renormalisation]` measures the drives at which the contacts of an `[interface]` first break.
            renormalisation: Renormalisation,
        }
    };
}

mod block;
mod compare;
mod contacts;
mod creep;
mod drive;
mod ensemble;
mod figure;
mod fit;
mod fit_curve;
mod fit_steady;
mod fit_velocity_curve;
mod hold_curve;
mod interface;
mod keys;
mod law;
mod logarithmic;
mod master_equation;
mod model;
mod numbers;
mod posterior;
mod protocol;
mod pull;
mod renormalisation;
mod rules;
mod size;
mod spectrum;
mod stability;
mod start;
mod sweep;
mod sweep_axis;
mod sweep_kept;
mod task;
mod task_start;
mod time;
mod units;
mod velocity_curve;
mod without_effect;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::block::Slip;
pub use crate::contacts::Start;
pub use crate::contacts::{Barrier, Temperature};
pub use crate::elastic::coupling::{Elasticity, SlidingDirection};
pub use crate::elastic::{CellLoading, CellSlip};
pub use crate::ensemble::Disorder;
pub use crate::shape::Edges;
pub use block::Block;
pub use compare::Compare;
pub use contacts::{Areas, Contacts, StiffnessOfThreshold};
pub use creep::Creep;
pub use drive::Drive;
pub use ensemble::Ensemble;
pub use figure::{Figure, FigureFormat};
pub(crate) use fit::FitKeys;
pub use fit::{Fit, FitDrift, FitNoise, FitThresholds, threshold_family};
pub use fit_curve::{FitCompliance, FitCurve, FitSource};
pub use fit_steady::FitSteady;
pub use fit_velocity_curve::FitVelocityCurve;
pub use hold_curve::HoldCurve;
pub use interface::{CellStart, Interface, MainShocks, PerCell, Scales};
pub use law::{Component, Law, ParametricFamily, Tabulated};
pub use master_equation::MasterEquation;
pub use model::Model;
pub use posterior::FitPosterior;
pub use protocol::{Protocol, Step};
pub use pull::Pull;
pub use renormalisation::Renormalisation;
pub use rules::{Ageing, Delay};
pub use spectrum::Spectrum;
pub use stability::Stability;
pub use start::TaskStart;
pub use sweep::{Sweep, SweepDimension};
pub use sweep_axis::{SweepAxes, SweepAxis, SweepRange, SweepScale, SweepTable, SweepValue};
pub use sweep_kept::{SweepCurve, SweepKept};
pub use task::Task;
pub use units::Units;
pub use velocity_curve::VelocityCurve;

use crate::error::not_negative;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A scenario: contacts, their initial state, and the task to compute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = task::exactly_one()))]
pub struct Scenario {
    /// Heading of the summary and the figures.
    #[serde(default)]
    pub title: String,
    /// The contacts of the interface.
    pub contacts: Contacts,
    /// Distribution Q_ini of the stretches at X = 0. Where these contacts hold (`"conditional"`), stretches beyond the thresholds
    /// are left out as those of `contacts.reforming` are.
    #[serde(default = "Law::zero")]
    pub initial: Law,
    /// A task: the base of the slider is moved from X = 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pull: Option<Pull>,
    /// A task: the top of the slider is moved from X_T = 0, or a force is imposed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<Drive>,
    /// A motion in time: steps `[[protocol]]`, one after the other, each with `velocity` and `distance`, with `velocity` and
    /// `duration`, or with `hold`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol: Option<Protocol>,
    /// CSV with columns `duration,velocity` or `duration,velocity,points`, a step in each row, instead of `protocol`; its
    /// path is relative to the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol_file: Option<String>,
    /// A task: kinetic friction against the velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_curve: Option<VelocityCurve>,
    /// A task: static friction against the time for which the slider has been held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_curve: Option<HoldCurve>,
    /// A task: slip in time under a constant force, and the time to failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creep: Option<Creep>,
    /// A task: the noise of the force in steady sliding.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<Spectrum>,
    /// A task: whether the slider of `[block]` sticks and slips.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// A task: numbers of the contacts from a measured curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fit>,
    /// A task: the distribution of the drives at which coupled contacts break for the first time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub renormalisation: Option<Renormalisation>,
    /// The slider between its top, which is driven, and its base; without this table it is rigid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<Block>,
    /// Cells of a slider that deforms; without this table all contacts move together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<Interface>,
    /// How the master equation is solved.
    #[serde(default)]
    pub master_equation: MasterEquation,
    /// A simulation of single contacts for the same task; without this table there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<Ensemble>,
    /// Labels of units on axes and in files.
    #[serde(default, skip_serializing_if = "Units::is_dimensionless")]
    pub units: Units,
    /// A measured curve to compare with F(X).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Compare>,
    /// Values of keys for all combinations of which the task is computed, by `asperity sweep`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
    /// How pictures are drawn.
    #[serde(default, skip_serializing_if = "Figure::is_default")]
    pub figure: Figure,
}

impl Scenario {
    /// A scenario of these contacts, relaxed at first, without a task.
    pub fn new(contacts: Contacts) -> Self {
        Self {
            title: String::new(),
            contacts,
            initial: Law::zero(),
            pull: None,
            drive: None,
            protocol: None,
            protocol_file: None,
            velocity_curve: None,
            hold_curve: None,
            creep: None,
            spectrum: None,
            stability: None,
            fit: None,
            renormalisation: None,
            block: None,
            interface: None,
            master_equation: MasterEquation::default(),
            ensemble: None,
            units: Units::default(),
            compare: None,
            sweep: None,
            figure: Figure::default(),
        }
    }

    /// Checks every value and builds the model of which the task is computed.
    ///
    /// # Errors
    /// The first invalid value, or a task that does not fit in memory.
    pub fn build(&self) -> Result<Model> {
        self.build_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::build`]; stopped by the monitor.
    pub fn build_with(&self, monitor: &mut dyn Monitor) -> Result<Model> {
        self.check_sweep()?;
        let task = self.task()?;
        self.figure.check().map_err(|e| e.under("figure"))?;
        let BuiltContacts { contacts, initial, left_out } =
            build_contacts(&self.contacts, &self.initial, task.start(), monitor)?;
        let model = Model {
            warnings: [left_out, self.warnings(&contacts)].concat(),
            steady: task.steady_velocity(&contacts),
            contacts,
            initial,
            normal_load: self.contacts.normal_load,
            background: self.contacts.background().map_err(|e| e.under("contacts"))?,
            background_of_load: self.contacts.background_coefficient.is_some(),
            block: self.block.clone(),
            interface: self.interface.clone(),
            master_equation: self.master_equation.clone(),
            ensemble: self.ensemble.clone(),
            compare: self.compare.clone(),
            keys: self.clone().numbers().into_iter().map(|number| (number.key, number.name)).collect(),
        };
        task.check_with(&model, monitor).map_err(|error| self.keyed(error))?;
        Ok(model)
    }

    /// `error` with the key that is in the scenario: stiffnesses per threshold may come from areas.
    fn keyed(&self, error: Error) -> Error {
        match error {
            Error::Invalid { key, expected, found }
                if key == "contacts.stiffness_per_threshold" && self.contacts.areas.is_some() =>
            {
                Error::invalid("contacts.areas", expected, format!("areas, from which follows {found}"))
            }
            error => error,
        }
    }

    /// Every `tabulated` distribution with the path of its key, so that a reader of files can fill it in.
    pub fn tables(&mut self) -> Vec<(String, &mut Tabulated)> {
        let mut tables = Vec::new();
        let contacts = &mut self.contacts;
        if let Some(law) = &mut contacts.thresholds {
            law.tables("contacts.thresholds", &mut tables);
        }
        if let Some(areas) = &mut contacts.areas {
            areas.law.tables("contacts.areas.law", &mut tables);
        }
        contacts.reforming.tables("contacts.reforming", &mut tables);
        if let Some(ageing) = &mut contacts.ageing {
            ageing.tables("contacts.ageing", &mut tables);
        }
        if let Some(delay) = &mut contacts.delay {
            delay.tables("contacts.delay", &mut tables);
        }
        self.initial.tables("initial", &mut tables);
        tables
    }
}

/// Contacts and their initial state, as a scenario describes them.
#[derive(Debug, Clone)]
pub struct BuiltContacts {
    /// The contacts.
    pub contacts: crate::contacts::Contacts,
    /// Their stretches at X = 0.
    pub initial: crate::contacts::Initial,
    /// A sentence for each distribution of which a part is left out, with its key.
    pub left_out: Vec<String>,
}

/// The contacts that `contacts` describes, and their initial state; stretches beyond the thresholds are left out
/// ([`crate::contacts::Contacts::truncated`]).
///
/// # Errors
/// The first invalid value, with its full path; stopped by the monitor.
pub fn build_contacts(
    contacts: &Contacts,
    initial: &Law,
    start: TaskStart,
    monitor: &mut dyn Monitor,
) -> Result<BuiltContacts> {
    let contacts = contacts.build_with(monitor).map_err(|e| e.under("contacts"))?;
    let initial = start.build(&contacts, initial, monitor).map_err(|e| e.under("initial"))?;
    // In steady sliding, and where contacts may break at once, nothing is left out of the initial ones.
    let held = match start {
        TaskStart::Conditional => initial.clone(),
        TaskStart::Relaxed | TaskStart::Steady => crate::contacts::Initial::default(),
    };
    let left_out = contacts.left_out(&held).into_iter().map(sentence).collect();
    let (contacts, initial) = contacts.truncated(&initial);
    contacts.check(&initial).map_err(Error::of_scenario)?;
    Ok(BuiltContacts { contacts, initial, left_out })
}

/// What is left out: the argument that gives the distribution, the share, and the stretch from which on.
fn sentence((argument, share, highest): (&str, f64, f64)) -> String {
    let key = keys::key_of(argument).unwrap_or_else(|| argument.into());
    format!(
        "{key}: a fraction of {share:.3e} is left out, stretches from {highest:.6} on, where fewer than one contact in 1e9 holds"
    )
}

/// `value` if it is finite and above 0.
fn positive(key: &str, value: f64) -> Result<f64> {
    let expected = if value > 0.0 { "a finite number above 0" } else { "a number above 0" };
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(Error::invalid(key, expected, value)) }
}

/// Checks that exactly one of the alternatives for `key` is given.
fn exactly_one(key: &str, expected: &str, given: &[(&str, bool)]) -> Result<()> {
    let present: Vec<_> = given.iter().filter(|g| g.1).map(|g| g.0).collect();
    match present[..] {
        [_] => Ok(()),
        [] => Err(Error::invalid(key, expected, "none of them")),
        _ => Err(Error::invalid(key, expected, present.join(" and "))),
    }
}

#[cfg(test)]
mod tests;
