//! Contacts under a slider whose velocity varies.

use asperity::history::LoadedHistory;
use asperity::monitor::Monitor;
use asperity::record::{self, Quantity};
use asperity::scenario::{self, Units};
use asperity::{ensemble, master};
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::description::Description;
use crate::error;
use crate::law::AnyLaw;
use crate::model::{Model, steady_interface};
use crate::plain::{Plain, Solved};
use crate::record::Record;
use crate::simulation::Simulation;
use crate::solver::{Solver, TransportSolver};
use crate::watch::watched;

/// A step of a motion in time: motion at a velocity over a distance or for a duration, a ramp, or a hold.
///
/// Parameters
/// ----------
/// velocity
///     A length per time; above 0 over a distance, 0 or above for a duration.
/// distance
///     The displacement in the step.
/// duration
///     The time that the step takes.
/// hold
///     A time at rest, instead of all others.
/// velocity_to
///     The velocity at the end of a ramp that begins at velocity and takes a duration.
/// points
///     The number of points of the trace in the step, evenly spaced in time, on a ramp where it is at such times, including both
///     ends; 2 or more.
/// pieces
///     The number of intervals of constant velocity that approximate a ramp, 64 by default.
/// relative_normal_load
///     The normal load in the step relative to that at the start of the first one, above 0; it changes at the beginning
///     of the step, and the number of contacts with it. In a first step only 1.
///
/// Raises
/// ------
/// ValueError
///     For none or more than one of hold, distance and duration; a velocity beside hold, or none without; a distance,
///     a duration or a hold that is not above 0; a velocity or a velocity_to below 0, or a velocity of 0 over a
///     distance; velocity_to without a duration; pieces without velocity_to, or not from 1 to 65536; fewer than 2
///     points; and a relative_normal_load that is not above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> asp.Step(1.0, distance=10.0)
/// Step(velocity=1.0, distance=10.0)
/// >>> asp.Step(hold=100.0).hold
/// 100.0
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Step;

#[pymethods]
impl Step {
    #[new]
    #[pyo3(
        signature = (
            velocity = None, *, distance = None, duration = None, hold = None, velocity_to = None,
            points = Whole::new(201), pieces = None, relative_normal_load = None
        ),
        text_signature = "(velocity=None, *, distance=None, duration=None, hold=None, velocity_to=None, points=201, pieces=None, relative_normal_load=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        velocity: Option<Real>,
        distance: Option<Real>,
        duration: Option<Real>,
        hold: Option<Real>,
        velocity_to: Option<Real>,
        points: Whole,
        pieces: Option<Whole>,
        relative_normal_load: Option<Real>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let velocity = velocity.get("velocity")?;
        let distance = distance.get("distance")?;
        let duration = duration.get("duration")?;
        let hold = hold.get("hold")?;
        let velocity_to = velocity_to.get("velocity_to")?;
        let points = points.get("points")?;
        let pieces = pieces.map(|pieces| pieces.get("pieces")).transpose()?;
        let relative_normal_load = relative_normal_load.get("relative_normal_load")?;
        let step = scenario::Step {
            velocity,
            velocity_to,
            distance,
            duration,
            hold,
            points,
            start: None,
            pieces,
            relative_normal_load,
        };
        step.check().map_err(|e| error::core(e.under("step")))?;
        Ok(Description::new(Plain::Step(step)).add_subclass(Self))
    }

    /// The velocity, at the beginning of a ramp, a length per time, or None.
    #[getter]
    fn velocity(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).velocity
    }

    /// The displacement in the step, a length, or None.
    #[getter]
    fn distance(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).distance
    }

    /// The time that a step at a velocity takes, or None.
    #[getter]
    fn duration(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).duration
    }

    /// The time at rest, or None.
    #[getter]
    fn hold(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).hold
    }

    /// The velocity at the end of a ramp, a length per time, or None.
    #[getter]
    fn velocity_to(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).velocity_to
    }

    /// The number of points of the trace in the step.
    #[getter]
    fn points(slf: &Bound<'_, Self>) -> usize {
        Self::plain(slf).points
    }

    /// The number of intervals of constant velocity that approximate a ramp; None where it was not given.
    #[getter]
    fn pieces(slf: &Bound<'_, Self>) -> Option<usize> {
        Self::plain(slf).pieces
    }

    /// The normal load in the step relative to that at the start of the first one, or None where it was not given.
    #[getter]
    fn relative_normal_load(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).relative_normal_load
    }
}

impl Step {
    fn plain(step: &Bound<'_, Self>) -> scenario::Step {
        match step.as_super().get().plain() {
            Plain::Step(step) => step.clone(),
            _ => unreachable!("a step is described as a step"),
        }
    }
}

/// Steps in the form of a scenario.
pub fn protocol(steps: Vec<Bound<'_, Step>>) -> PyResult<scenario::Protocol> {
    let protocol = scenario::Protocol(steps.iter().map(Step::plain).collect());
    protocol.check().map_err(|e| error::core(e.under("steps")))?;
    Ok(protocol)
}

/// Steps in the form for the solvers: the motion with its normal load, and the output times.
pub fn motion(steps: Vec<Bound<'_, Step>>) -> PyResult<(LoadedHistory, Vec<f64>)> {
    let protocol = protocol(steps)?;
    Ok((protocol.build_under_load().map_err(error::core)?, protocol.times()))
}

/// The master equation at a varying velocity: cohorts of contacts that formed together are followed in time.
///
/// Parameters
/// ----------
/// contacts, initial, start
///     As for MasterEquation; the contacts have age 0 at t = 0, or, with start="steady", which all contacts may have,
///     the ages of steady sliding at velocity, without initial.
/// velocity
///     The velocity of that steady sliding, above 0.
/// tolerance
///     Allowed error of the force per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; by default 1e-6, and
///     1e-4 for ageing by Smoluchowski.
///
/// Raises
/// ------
/// ValueError
///     For another word as start, no velocity, one that is not above 0 or initial stretches with start="steady", a
///     velocity without, a tolerance that is not from 1e-12 to 1e-2, and ageing by MeanField of thresholds with point
///     masses, or with stiffnesses that depend on them.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))
/// >>> motion = asp.Transport(contacts).follow([asp.Step(1.0, distance=2.0), asp.Step(hold=10.0)])
/// >>> bool(motion['time'][-1] == 12.0)
/// True
#[pyclass(frozen, extends = Model, module = "asperity")]
pub struct Transport;

#[pymethods]
impl Transport {
    #[new]
    #[pyo3(signature = (contacts, initial = None, *, start: "Literal['conditional', 'relaxed', 'steady']" = Argument::text("conditional"), velocity = None, tolerance = None), text_signature = "(contacts, initial=None, *, start='conditional', velocity=None, tolerance=None)")]
    fn new(
        py: Python<'_>,
        contacts: Argument<Bound<'_, Contacts>>,
        initial: Option<Argument<AnyLaw>>,
        start: Argument<String>,
        velocity: Option<Real>,
        tolerance: Option<Real>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let initial = initial.get("initial")?;
        let contacts = &contacts.get("contacts")?;
        let start = start.get("start")?;
        let velocity = velocity.get("velocity")?;
        let tolerance = tolerance.get("tolerance")?;
        let interface = steady_interface(contacts, initial, &start)?;
        let solved = Solved { own: scenario::MasterEquation { tolerance }, velocity };
        let build = |monitor: &mut dyn Monitor| {
            solved.own.check().map_err(|e| e.under("transport"))?;
            TransportSolver::new(&interface, &solved, monitor)
        };
        let solver = watched(None, py, build)?;
        let plain = Plain::Transport(interface, solved);
        Ok(Model::new(plain, Solver::Transport(Box::new(solver))).add_subclass(Self))
    }

    /// The velocity of the steady sliding in which the contacts start, or None.
    #[getter]
    fn velocity(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::solved(slf).velocity
    }

    /// The allowed error of the force per contact and per ⟨k⟩ × mean threshold; None for the default.
    #[getter]
    fn tolerance(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::solved(slf).own.tolerance
    }

    /// The contacts under a rigid slider, to be moved step by step; `energy` is not computed, and there are no events.
    ///
    /// Parameters
    /// ----------
    /// velocity
    ///     The velocity of the slider, above 0, which may be changed later.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation that advances step by step, at X = 0.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a velocity that is not above 0.
    #[pyo3(signature = (*, velocity))]
    fn simulation(slf: &Bound<'_, Self>, velocity: Real) -> PyResult<Simulation> {
        let velocity = velocity.get("velocity")?;
        Model::simulation(slf.as_super(), Some(velocity))
    }

    /// Follows the contacts from t = 0 through the steps, one after the other.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     A list of Step.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// Record
    ///     A Record of variables of shape (n,), with n output points of all steps (steps share the point where they
    ///     meet): `time`, `position`, `velocity` (from the right), `force`, `breaking_frequency` (the fraction of
    ///     contacts that break per time), `free` (the detached fraction: contacts that are broken and have not yet
    ///     re-formed) and `force_error` (an upper estimate of the largest error of the force, the same at all
    ///     points). Where relative_normal_load varies also that variable; at a time at
    ///     which it steps there are two points, before and after the step.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For no steps, a relative_normal_load of the first step that is not 1, and another one than 1 with ageing by
    ///     MeanField.
    /// RuntimeError
    ///     If that error is larger than a given tolerance.
    #[pyo3(signature = (steps, *, progress: "_Progress" = None))]
    fn follow(
        slf: &Bound<'_, Self>,
        steps: Argument<Vec<Bound<'_, Step>>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Record>> {
        let steps = steps.get("steps")?;
        let py = slf.py();
        let (motion, times) = motion(steps)?;
        let Plain::Transport(interface, solved) = slf.as_super().as_super().get().plain() else {
            unreachable!("a transport is described as a transport");
        };
        let made = slf.as_super().get().transport();
        let usual = solved.own.tolerance_in_time(&made.contacts.rules);
        let mut build = |tolerance: f64, monitor: &mut dyn Monitor| {
            if tolerance == usual {
                return Ok(made.transport.clone());
            }
            let own = scenario::MasterEquation { tolerance: Some(tolerance) };
            let finer = Solved { own, velocity: solved.velocity };
            TransportSolver::new(interface, &finer, monitor).map(|finer| finer.transport)
        };
        let required = solved.own.tolerance;
        let follow = |monitor: &mut dyn Monitor| {
            let (times, accuracy) = (times.as_slice(), (usual, required));
            if motion.steps().next().is_none() {
                let motion = (motion.history(), times);
                return master::Transport::follow_as_required(&mut build, motion, accuracy, monitor);
            }
            let build = |tolerance: f64, monitor: &mut dyn Monitor| {
                let fresh = master::Transport::fresh(&made.contacts, tolerance, monitor)?;
                Ok([build(tolerance, monitor)?, fresh])
            };
            master::Transport::follow_under_load_as_required(build, (&motion, times), accuracy, monitor)
        };
        let trace = watched(progress, py, follow)?;
        Py::new(py, Record::new(py, columns(trace), Units::default())?)
    }
}

impl Transport {
    fn solved<'a>(transport: &'a Bound<'_, Self>) -> &'a Solved {
        match transport.as_super().as_super().get().plain() {
            Plain::Transport(_, solved) => solved,
            _ => unreachable!("a transport is described as a transport"),
        }
    }
}

fn columns(trace: master::Trace) -> record::Record {
    let mut record = record::Record::default();
    let mut add = |name, words, quantity, values| record.push(name, words, quantity, &["point"], values);
    add("time", "time", Quantity::Time, trace.time);
    add("position", "position X of the slider's base", Quantity::Length, trace.position);
    add("velocity", "velocity of the slider", Quantity::Velocity, trace.velocity);
    add("force", "friction force", Quantity::Force, trace.force);
    let words = "fraction of contacts breaking per time";
    add("breaking_frequency", words, Quantity::PerTime, trace.breaking_rate);
    add("free", "fraction of contacts that are detached", Quantity::Number, trace.free);
    add_load(&mut record, trace.relative_normal_load);
    let error = vec![trace.error; record.values("time").map_or(0, <[f64]>::len)];
    record.push("force_error", "estimated error of the force", Quantity::Force, &["point"], error);
    record
}

/// The results of an ensemble in time as columns.
pub fn followed(trace: ensemble::EnsembleTrace) -> record::Record {
    let mut record = record::Record::default();
    let mut add = |name, words, quantity, values| record.push(name, words, quantity, &["point"], values);
    add("time", "time", Quantity::Time, trace.time);
    add("position", "position X of the slider's base", Quantity::Length, trace.position);
    add("force", "friction force", Quantity::Force, trace.force);
    add("force_error", "its standard error", Quantity::Force, trace.error);
    add("free", "fraction of contacts that are detached", Quantity::Number, trace.free);
    add_load(&mut record, trace.relative_normal_load);
    record
}

/// Adds the normal load relative to that at the start, if it varies.
fn add_load(record: &mut record::Record, loads: Vec<f64>) {
    if loads.iter().any(|load| *load != 1.0) {
        let words = "normal load relative to that at the start";
        record.push("relative_normal_load", words, Quantity::Number, &["point"], loads);
    }
}
