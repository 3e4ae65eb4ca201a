//! What solves a model: the master equation, transport or an ensemble of the core.

use std::ffi::CString;

use asperity::contacts::Initial;
use asperity::monitor::{Aside, Monitor};
use asperity::population::Population;
use asperity::rate_dependent::RateDependentContacts;
use asperity::scenario::{BuiltContacts, TaskStart};
use asperity::task::{self, Grid};
use asperity::{Error, Result, block, ensemble, master, scenario};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::convert::{self, Domain};
use crate::plain::{Interface, Solved};
use crate::simulated::{self, Simulated, SliderContacts};
use crate::simulated_in_time::BlockInTime;

/// A model of the core.
pub enum Solver {
    MasterEquation(EquationSolver),
    Transport(Box<TransportSolver>),
    Ensemble(ensemble::Ensemble),
}

/// The renewal equation, with its initial state and its tolerance.
pub struct EquationSolver {
    pub equation: master::MasterEquation,
    pub initial: Initial,
    pub tolerance: master::Tolerance,
}

/// Transport at t = 0, its contacts, and the tolerance of a step of a block over it.
pub struct TransportSolver {
    pub transport: master::Transport,
    pub contacts: asperity::contacts::Contacts,
    step_of_a_block: f64,
}

impl EquationSolver {
    /// The master equation of contacts, at a velocity if they are time-dependent.
    pub fn new(interface: &Interface, solved: &Solved, monitor: &mut dyn Monitor) -> Result<Self> {
        let (contacts, initial) = built(interface, monitor)?;
        let equation = match solved.velocity {
            Some(velocity) => master::MasterEquation::at_with(contacts, &initial, velocity, monitor)?,
            None => master::MasterEquation::new_with(contacts, &initial, monitor)?,
        };
        Ok(Self { equation, initial, tolerance: solved.own.tolerance() })
    }

    /// The requested stretches, or by default ones that resolve the distributions at X = `positions`.
    pub fn stretches(&self, wanted: Option<&Bound<'_, PyAny>>, positions: &[f64]) -> PyResult<Vec<f64>> {
        const STRETCHES: Domain = Domain { low: 0.0, high: f64::MAX, what: "a stretch" };
        match wanted {
            Some(stretches) => convert::list_within("stretches", stretches, &STRETCHES),
            None => Ok(Grid::new(&self.equation, &self.initial, positions).stretches),
        }
    }
}

impl TransportSolver {
    /// The contacts at t = 0, in steady sliding if a start says so.
    pub fn new(
        Interface { contacts, initial, start }: &Interface,
        Solved { own, velocity }: &Solved,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let refused = |expected, found: &str| Err(Error::invalid("velocity", expected, found));
        let BuiltContacts { contacts, initial, left_out } =
            scenario::build_contacts(contacts, initial, *start, monitor)?;
        warn(left_out);
        let tolerance = own.tolerance_in_time(&contacts.rules);
        let transport = match (start, *velocity) {
            (TaskStart::Steady, Some(velocity)) => {
                master::Transport::steady_with(&contacts, velocity, tolerance, monitor)
            }
            (TaskStart::Steady, None) => {
                refused("a velocity beside start='steady', at which contacts slide", "none")
            }
            (_, Some(_)) => refused("no velocity but that of start='steady'", "one"),
            (_, None) => master::Transport::new_with(contacts.clone(), &initial, tolerance, monitor),
        }?;
        Ok(Self { transport, contacts, step_of_a_block: own.step_of_a_block() })
    }
}

/// The contacts, and their initial stretches.
///
/// # Errors
/// Those of [`scenario::build_contacts`]; steady sliding of time-dependent contacts, which stretches do not determine.
pub fn built(
    Interface { contacts, initial, start }: &Interface,
    monitor: &mut dyn Monitor,
) -> Result<(asperity::contacts::Contacts, Initial)> {
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

impl Solver {
    pub fn contacts(&self) -> &asperity::contacts::Contacts {
        match self {
            Self::MasterEquation(solver) => solver.equation.contacts(),
            Self::Transport(solver) => &solver.contacts,
            Self::Ensemble(ensemble) => ensemble.contacts(),
        }
    }

    /// The number of contacts followed one by one, for an ensemble.
    pub fn size(&self) -> Option<usize> {
        if let Self::Ensemble(ensemble) = self { Some(ensemble.size()) } else { None }
    }

    /// The contacts at X = 0, to be moved together.
    pub fn population(&self, monitor: &mut dyn Monitor) -> Result<Box<dyn Population>> {
        let aside = &mut Aside { fraction: 0.0, monitor };
        Ok(match self {
            Self::MasterEquation(solver) => {
                Box::new(solver.equation.population_with(solver.tolerance, aside)?)
            }
            Self::Transport(_) => {
                let expected = "a MasterEquation or an Ensemble where no time passes (Block.follow moves a Transport, and so do Block.drive and Block.simulation at a velocity)";
                return Err(Error::invalid("block.model", expected, "a Transport"));
            }
            Self::Ensemble(ensemble) => Box::new(ensemble.population_with(aside)?),
        })
    }

    /// The contacts at t = 0, to be moved together in time, and the allowed error of a time step of a block over
    /// them, a length.
    pub fn in_time(&self, monitor: &mut dyn Monitor) -> Result<(Box<dyn RateDependentContacts>, f64)> {
        let mean = self.contacts().thresholds.mean();
        match self {
            Self::Transport(solver) => Ok((solver.transport.copy(), solver.step_of_a_block * mean)),
            Self::Ensemble(ensemble) => {
                let least = scenario::MasterEquation::default().step_of_a_block();
                let tolerance = task::finite_size_tolerance(ensemble.size()).max(least);
                let contacts = ensemble.in_time_with(&mut Aside { fraction: 0.0, monitor })?;
                Ok((Box::new(contacts), tolerance * mean))
            }
            Self::MasterEquation(_) => {
                let expected = "a Transport or an Ensemble where time passes";
                Err(Error::invalid("block.model", expected, "a MasterEquation"))
            }
        }
    }

    /// The contacts under a slider, to be driven step by step.
    pub fn simulated(&self, slider: &block::Block, monitor: &mut dyn Monitor) -> Result<Box<dyn Simulated>> {
        let contacts = match self {
            Self::MasterEquation(solver) => {
                SliderContacts::Solved(Box::new(solver.equation.clone()), solver.initial.clone())
            }
            Self::Transport(_) | Self::Ensemble(_) => SliderContacts::Followed(self.size().unwrap_or(0)),
        };
        simulated::slider(slider, self.population(monitor)?, contacts, monitor)
    }

    /// The contacts under a slider in time, to be driven step by step at a velocity.
    pub fn simulated_in_time(
        &self,
        slider: &block::Block,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Box<dyn Simulated>> {
        let (contacts, tolerance) = self.in_time(monitor)?;
        let motion = slider.motion_with(contacts.as_ref(), tolerance)?;
        Ok(Box::new(BlockInTime::new(motion, velocity)?))
    }
}
