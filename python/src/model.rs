//! The common part of all models: contacts and their initial state.

use std::ffi::CString;

use asperity::block::{self, Loading, Slip};
use asperity::monitor::{Aside, Monitor};
use asperity::population::Population;
use asperity::rate_dependent::RateDependentContacts;
use asperity::scenario::{BuiltContacts, TaskStart};
use asperity::task;
use asperity::{Error, Result, ensemble, master, scenario};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contacts::Contacts;
use crate::description::{Description, Interface, Plain};
use crate::ensemble::Ensemble;
use crate::equation::MasterEquation;
use crate::law::{AnyLaw, Law, given};
use crate::simulated::{self, Simulated, SliderContacts};
use crate::simulated_in_time::{BlockInTime, ContactsInTime};
use crate::simulation::Simulation;
use crate::transport::Transport;
use crate::watch::watched;
use crate::{convert, error, typed};

/// The components of a model.
pub fn interface(
    contacts: &Bound<'_, Contacts>,
    initial: Option<AnyLaw>,
    start: &str,
) -> PyResult<Interface> {
    let start: scenario::Start = convert::word("start", start)?;
    Ok(starting(contacts, initial, start.into()))
}

/// The components of a model that may start in steady sliding.
pub fn steady_interface(
    contacts: &Bound<'_, Contacts>,
    initial: Option<AnyLaw>,
    start: &str,
) -> PyResult<Interface> {
    Ok(starting(contacts, initial, convert::word("start", start)?))
}

fn starting(contacts: &Bound<'_, Contacts>, initial: Option<AnyLaw>, start: TaskStart) -> Interface {
    let initial = initial.map_or_else(scenario::Law::zero, |law| law.0);
    Interface { contacts: Contacts::plain(contacts).clone(), initial, start }
}

/// The contacts, and their initial stretches.
///
/// # Errors
/// Those of [`scenario::build_contacts`]; steady sliding of time-dependent contacts, which stretches do not determine.
pub fn built(
    Interface { contacts, initial, start }: &Interface,
    monitor: &mut dyn Monitor,
) -> Result<(asperity::contacts::Contacts, asperity::contacts::Initial)> {
    let BuiltContacts { contacts, initial, left_out } =
        scenario::build_contacts(contacts, initial, *start, monitor)?;
    warn(left_out);
    if *start == TaskStart::Steady && contacts.rules.are_time_dependent() {
        let expected = "conditional or relaxed for time-dependent contacts (a Transport starts in steady sliding at a velocity)";
        return Err(Error::invalid("start", expected, "steady"));
    }
    Ok((contacts, initial))
}

/// Shows warnings, of stretches beyond the thresholds, which models leave out.
pub fn warn(warnings: Vec<String>) {
    for warning in warnings {
        Python::attach(|py| {
            let category = py.get_type::<PyUserWarning>();
            let text = CString::new(warning).unwrap_or_default();
            // Where warnings are errors, the model is made all the same: its numbers are right.
            if let Err(error) = PyErr::warn(py, &category, &text, 1) {
                error.write_unraisable(py, None);
            }
        });
    }
}

/// The arguments for [`interface`].
pub fn interface_arguments(interface: &Interface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Interface { contacts, initial, start } = interface;
    into.set_item("contacts", Plain::Contacts(contacts.clone()).object(into.py())?)?;
    if *initial != scenario::Law::zero() {
        into.set_item("initial", Plain::Law(initial.clone()).object(into.py())?)?;
    }
    given(into, "start", (*start != TaskStart::default()).then(|| convert::start(*start)))
}

/// Contacts and their initial state.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> isinstance(theory, asp.Model), theory.contacts.count
/// (True, 1.0)
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Model;

impl Model {
    pub fn new(plain: Plain) -> PyClassInitializer<Self> {
        Description::new(plain).add_subclass(Self)
    }

    /// The model as the core has it.
    pub fn solver<'a>(model: &'a Bound<'_, Self>) -> Solver<'a> {
        if let Ok(ensemble) = model.cast::<Ensemble>() {
            return Solver::Ensemble(&ensemble.get().ensemble);
        }
        if let Ok(transport) = model.cast::<Transport>() {
            return Solver::Transport(transport.get(), Transport::plain(transport).tolerance_of_a_block());
        }
        let equation = model.cast::<MasterEquation>().expect("the other models are none");
        Solver::MasterEquation(&equation.get().equation, MasterEquation::plain(equation).tolerance())
    }

    /// The contacts under a slider, to be driven step by step.
    pub fn simulated(model: &Bound<'_, Self>, slider: &block::Block) -> PyResult<Box<dyn Simulated>> {
        let solver = Self::solver(model);
        let contacts = match solver {
            Solver::Ensemble(ensemble) => SliderContacts::Followed(ensemble.size()),
            _ => match model.cast::<MasterEquation>() {
                Ok(own) => {
                    SliderContacts::Solved(Box::new(own.get().equation.clone()), own.get().initial.clone())
                }
                Err(_) => SliderContacts::Followed(0),
            },
        };
        watched(None, model.py(), |monitor| {
            simulated::slider(slider, solver.population(monitor)?, contacts, monitor)
        })
    }

    /// The contacts under a slider in time, to be driven step by step at a velocity.
    pub fn simulated_in_time(
        model: &Bound<'_, Self>,
        slider: &block::Block,
        velocity: f64,
    ) -> PyResult<Box<dyn Simulated>> {
        let solver = Self::solver(model);
        watched(None, model.py(), |monitor| {
            let (contacts, tolerance) = solver.in_time(monitor)?;
            let motion = slider.motion(contacts.as_ref(), tolerance)?;
            Ok(Box::new(BlockInTime::new(motion, velocity)?) as Box<dyn Simulated>)
        })
    }

    /// The contacts under a rigid slider, to be moved step by step, at a velocity in time.
    pub fn simulation(model: &Bound<'_, Self>, velocity: Option<f64>) -> PyResult<Simulation> {
        let simulated = match velocity {
            Some(velocity) => {
                let solver = Self::solver(model);
                watched(None, model.py(), |monitor| {
                    let contacts = solver.in_time(monitor)?.0;
                    Ok(Box::new(ContactsInTime::new(contacts, velocity)?) as Box<dyn Simulated>)
                })?
            }
            None => {
                let rigid = block::Block::new(Loading::Rigid, Slip::Overdamped, None);
                Self::simulated(model, &rigid.map_err(error::core)?)?
            }
        };
        Simulation::new(model.as_super(), (velocity, None), vec![1], simulated)
    }

    /// The model of a scenario with a block over these contacts, by the master equation, and their velocity if they have one.
    pub fn described(
        model: &Bound<'_, Self>,
        block: scenario::Block,
    ) -> PyResult<(scenario::Model, Option<f64>)> {
        let (interface, own, velocity) = match model.as_super().get().plain() {
            Plain::MasterEquation(interface, solved) => (interface, &solved.own, solved.velocity),
            Plain::Transport(interface, solved) => (interface, &solved.own, None),
            _ => {
                let expected = "a MasterEquation or a Transport";
                return Err(error::invalid("block.model", expected, "an Ensemble"));
            }
        };
        let (contacts, initial) = watched(None, model.py(), |monitor| built(interface, monitor))?;
        let described = scenario::Model {
            background: Self::background(model),
            block: Some(block),
            master_equation: own.clone(),
            ..scenario::Model::new(contacts, initial)
        };
        Ok((described, velocity))
    }

    /// The background force of the contacts.
    pub fn background(model: &Bound<'_, Self>) -> f64 {
        Self::plain(model).contacts.background().expect("contacts that were built have valid numbers")
    }

    fn plain<'a>(model: &'a Bound<'_, Self>) -> &'a Interface {
        match model.as_super().get().plain() {
            Plain::MasterEquation(interface, _)
            | Plain::Transport(interface, _)
            | Plain::Ensemble(interface, _) => interface,
            _ => unreachable!("a model is described as a model"),
        }
    }
}

/// A model of the core.
#[derive(Clone, Copy)]
pub enum Solver<'a> {
    /// The renewal equation, with its tolerance.
    MasterEquation(&'a master::MasterEquation, master::Tolerance),
    /// Transport, with the tolerance of a block over it.
    Transport(&'a Transport, f64),
    Ensemble(&'a ensemble::Ensemble),
}

impl<'a> Solver<'a> {
    pub fn contacts(self) -> &'a asperity::contacts::Contacts {
        match self {
            Self::MasterEquation(equation, _) => equation.contacts(),
            Self::Transport(transport, _) => &transport.contacts,
            Self::Ensemble(ensemble) => ensemble.contacts(),
        }
    }

    /// The number of contacts followed one by one, for an ensemble.
    pub fn size(self) -> Option<usize> {
        match self {
            Self::MasterEquation(..) | Self::Transport(..) => None,
            Self::Ensemble(ensemble) => Some(ensemble.size()),
        }
    }

    /// The contacts at X = 0, to be moved together.
    pub fn population(self, monitor: &mut dyn Monitor) -> Result<Box<dyn Population>> {
        Ok(match self {
            Self::MasterEquation(equation, tolerance) => {
                Box::new(equation.population_with(tolerance, &mut Aside { fraction: 0.0, monitor })?)
            }
            Self::Transport(..) => {
                let expected = "a MasterEquation or an Ensemble where no time passes (Block.follow moves a Transport, and so do Block.drive and Block.simulation at a velocity)";
                return Err(Error::invalid("block.model", expected, "a Transport"));
            }
            Self::Ensemble(ensemble) => {
                Box::new(ensemble.population_with(&mut Aside { fraction: 0.0, monitor })?)
            }
        })
    }
}

impl Solver<'_> {
    /// The contacts at t = 0, to be moved together in time, and the allowed error of a time step of a block over
    /// them, a length.
    pub fn in_time(self, monitor: &mut dyn Monitor) -> Result<(Box<dyn RateDependentContacts>, f64)> {
        let mean = self.contacts().thresholds.mean();
        match self {
            Self::Transport(transport, tolerance) => Ok((transport.transport.copy(), tolerance * mean)),
            Self::Ensemble(ensemble) => {
                let least = scenario::MasterEquation::default().tolerance_of_a_block();
                let tolerance = task::finite_size_tolerance(ensemble.size()).max(least);
                Ok((
                    Box::new(ensemble.in_time_with(&mut Aside { fraction: 0.0, monitor })?),
                    tolerance * mean,
                ))
            }
            Self::MasterEquation(..) => {
                let expected = "a Transport or an Ensemble where time passes";
                Err(Error::invalid("block.model", expected, "a MasterEquation"))
            }
        }
    }
}

#[pymethods]
impl Model {
    /// Plots the distributions of the contacts, as Contacts.plot, with that of their initial stretches.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the plot() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("model", (slf, ax), style)
    }

    /// The contacts.
    #[getter]
    fn contacts<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Contacts>> {
        Plain::Contacts(Self::plain(slf).contacts.clone()).instance(slf.py())
    }

    /// The distribution Q_ini of stretches at X = 0.
    #[getter]
    fn initial<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Plain::Law(Self::plain(slf).initial.clone()).instance(slf.py())
    }

    /// The kind of the initial state, "conditional", "relaxed" or "steady".
    #[getter]
    fn start(slf: &Bound<'_, Self>) -> typed::StartWord {
        typed::StartWord(convert::start(Self::plain(slf).start))
    }
}
