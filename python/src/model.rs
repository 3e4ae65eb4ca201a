//! The common part of all models: contacts and their initial state.

use asperity::block::{self, Loading, Slip};
use asperity::scenario::{self, TaskStart};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contacts::Contacts;
use crate::description::Description;
use crate::law::{AnyLaw, Law};
use crate::plain::{Interface, Plain};
use crate::simulated::Simulated;
use crate::simulated_in_time::ContactsInTime;
use crate::simulation::Simulation;
use crate::solver::{EquationSolver, Solver, TransportSolver, built};
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

/// Contacts and their initial state.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> isinstance(theory, asp.Model), theory.contacts.count
/// (True, 1.0)
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Model {
    solver: Solver,
}

impl Model {
    pub fn new(plain: Plain, solver: Solver) -> PyClassInitializer<Self> {
        Description::new(plain).add_subclass(Self { solver })
    }

    /// The model as the core has it.
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// The solver of a master equation.
    pub fn equation(&self) -> &EquationSolver {
        match &self.solver {
            Solver::MasterEquation(solver) => solver,
            _ => unreachable!("a master equation is solved as one"),
        }
    }

    /// The solver of a transport.
    pub fn transport(&self) -> &TransportSolver {
        match &self.solver {
            Solver::Transport(solver) => solver,
            _ => unreachable!("a transport is solved as one"),
        }
    }

    /// The contacts of an ensemble.
    pub fn ensemble(&self) -> &asperity::ensemble::Ensemble {
        match &self.solver {
            Solver::Ensemble(ensemble) => ensemble,
            _ => unreachable!("an ensemble is solved as one"),
        }
    }

    /// The contacts under a rigid slider, to be moved step by step, at a velocity in time.
    pub fn simulation(model: &Bound<'_, Self>, velocity: Option<f64>) -> PyResult<Simulation> {
        let solver = model.get().solver();
        let simulated = watched(None, model.py(), |monitor| {
            Ok(match velocity {
                Some(velocity) => {
                    let contacts = solver.in_time(monitor)?.0;
                    Box::new(ContactsInTime::new(contacts, velocity)?) as Box<dyn Simulated>
                }
                None => {
                    let rigid = block::Block::new(Loading::Rigid, Slip::Overdamped, None)?;
                    solver.simulated(&rigid, monitor)?
                }
            })
        })?;
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
