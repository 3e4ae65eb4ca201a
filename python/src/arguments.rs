//! The objects of Python that are made from plain values: their classes and their arguments.

use asperity::contacts::FreeFriction;
use asperity::law::parametric_distributions;
use asperity::scenario::{
    self, CellLoading, CellSlip, Component, Disorder, Edges, Elasticity, PerCell, SlidingDirection, Slip,
    Tabulated,
};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};

use crate::convert;
use crate::plain::{Interface, Plain, Slider, Solved, Surface};

impl Plain {
    /// The object with this description.
    pub fn object<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("asperity._core")?.getattr(self.class())?.call((), Some(&self.arguments(py)?))
    }

    /// The object with this description, of a given class.
    pub fn instance<'py, T: pyo3::PyTypeInfo>(&self, py: Python<'py>) -> PyResult<Bound<'py, T>> {
        Ok(self.object(py)?.cast_into()?)
    }

    /// The name of the class.
    fn class(&self) -> &'static str {
        match self {
            Self::Law(law) => law_class(law),
            Self::Areas(_) => "Areas",
            Self::Contacts(_) => "Contacts",
            Self::Temperature(_) => "Temperature",
            Self::Ageing(ageing) => ageing_class(ageing),
            Self::Transport(..) => "Transport",
            Self::Step(_) => "Step",
            Self::MasterEquation(..) => "MasterEquation",
            Self::Ensemble(..) => "Ensemble",
            Self::Slip(Slip::Damped { .. }) => "Damped",
            Self::Slip(_) => "Inertial",
            Self::Block(_) => "Block",
            Self::Surface(surface) => match surface.own.contacts {
                PerCell::Many => "Interface",
                PerCell::One => "Lattice",
            },
        }
    }

    /// The arguments from which Python creates the same object, without those that have their default.
    pub fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arguments = PyDict::new(py);
        match self {
            Self::Law(law) => law_arguments(law, &arguments),
            Self::Areas(areas) => areas_arguments(areas, &arguments),
            Self::Contacts(contacts) => contacts_arguments(contacts, &arguments),
            Self::Temperature(temperature) => temperature_arguments(temperature, &arguments),
            Self::Ageing(ageing) => ageing_arguments(ageing, &arguments),
            Self::Transport(interface, own) => transport_arguments(interface, own, &arguments),
            Self::Step(step) => step_arguments(step, &arguments),
            Self::MasterEquation(interface, own) => master_equation_arguments(interface, own, &arguments),
            Self::Ensemble(interface, own) => ensemble_arguments(interface, own, &arguments),
            Self::Slip(slip) => slip_arguments(*slip, &arguments),
            Self::Block(slider) => block_arguments(slider, &arguments),
            Self::Surface(surface) => surface_arguments(surface, &arguments),
        }?;
        Ok(arguments)
    }
}

/// Classes and arguments of parametric distributions, from their declarations.
macro_rules! parametric_arguments {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $key:literal, $widths:expr, |$scale:ident, $width:ident| {
            $($(#[doc = $parameter_doc:literal])+ $parameter:ident: $value:expr,)+
        }
        refuses $refused:literal
        shows $example:literal
    )+) => {
        /// The class of a distribution.
        fn law_class(law: &scenario::Law) -> &'static str {
            match law {
                $(scenario::Law::$name { .. } => stringify!($name),)+
                scenario::Law::Tabulated(_) => "Tabulated",
                scenario::Law::Series { .. } => "Series",
                scenario::Law::Mixture(_) => "Mixture",
                scenario::Law::Renormalised { .. } => "Renormalised",
                _ => unreachable!("a distribution without a class"),
            }
        }

        /// The arguments of its class that create a distribution.
        fn law_arguments(law: &scenario::Law, into: &Bound<'_, PyDict>) -> PyResult<()> {
            match law {
                $(scenario::Law::$name { $($parameter),+ } => {
                    $(into.set_item(stringify!($parameter), $parameter)?;)+
                    Ok(())
                })+
                scenario::Law::Tabulated(Tabulated { stretch, density, samples, bandwidth, exact, .. }) => {
                    let columns = [("stretch", stretch), ("density", density), ("samples", samples)];
                    columns.into_iter().try_for_each(|(name, values)| given(into, name, values.as_ref()))?;
                    given(into, "bandwidth", *bandwidth)?;
                    given(into, "exact", exact.then_some(true))
                }
                scenario::Law::Series { boundaries, coefficients, cut } => {
                    into.set_item("boundaries", boundaries)?;
                    into.set_item("coefficients", coefficients)?;
                    given(into, "cut", (*cut > 0.0).then_some(*cut))
                }
                scenario::Law::Mixture(components) => {
                    let pair = |part: &Component| {
                        Ok((part.weight, Plain::Law(part.law.clone()).object(into.py())?))
                    };
                    into.set_item("components", components.iter().map(pair).collect::<PyResult<Vec<_>>>()?)
                }
                scenario::Law::Renormalised { law, coupling } => {
                    into.set_item("law", Plain::Law((**law).clone()).object(into.py())?)?;
                    into.set_item("coupling", coupling)
                }
                _ => unreachable!("a distribution without a class"),
            }
        }
    };
}

parametric_distributions!(parametric_arguments);

/// The class of a rule of ageing.
fn ageing_class(ageing: &scenario::Ageing) -> &'static str {
    match ageing {
        scenario::Ageing::Smoluchowski { .. } => "Smoluchowski",
        scenario::Ageing::FrozenRank { .. } => "FrozenRank",
        scenario::Ageing::Logarithmic { .. } => "Logarithmic",
        scenario::Ageing::MeanField { .. } => "MeanField",
        _ => unreachable!("a rule of ageing without a class"),
    }
}

/// The arguments that create an interface.
fn surface_arguments(surface: &Surface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Surface { contacts, own, ensemble } = surface;
    interface_arguments(contacts, into)?;
    into.set_item("cells", own.cells.clone())?;
    into.set_item("connection", own.connection)?;
    match own.coupling {
        Elasticity::Neighbours { stiffness } => into.set_item("neighbours", stiffness)?,
        Elasticity::HalfSpace { modulus, cell, poisson_ratio, sliding } => {
            into.set_item("half_space", (modulus, cell))?;
            given(into, "poisson_ratio", (poisson_ratio != 0.0).then_some(poisson_ratio))?;
            given(into, "sliding", (sliding == SlidingDirection::Rows).then_some("rows"))?;
        }
        _ => unreachable!("a coupling that no argument makes"),
    }
    given(into, "edges", (own.edges == Edges::Periodic).then_some("periodic"))?;
    given(into, "loading", (own.loading == CellLoading::Edge).then_some("edge"))?;
    given(into, "slip", (own.slip == Some(CellSlip::Overdamped)).then_some("overdamped"))?;
    given(into, "viscosity", own.viscosity)?;
    given(into, "mass", own.mass)?;
    let tolerance = own.drive_tolerance;
    given(into, "drive_tolerance", (tolerance != scenario::Interface::DRIVE_TOLERANCE).then_some(tolerance))?;
    if let Some(scales) = &own.disorder {
        given(into, "disorder", scales.std)?;
        given(into, "disorder", scales.scale.clone())?;
        given(into, "seed", scales.seed.filter(|&seed| seed != 1))?;
    }
    given(into, "areas", own.areas.clone())?;
    let Some(ensemble) = ensemble else { return Ok(()) };
    given(into, "seed", Some(ensemble.seed).filter(|&seed| seed != 1))?;
    let quenched = ensemble.disorder == Disorder::Quenched;
    if ensemble.size.is_some() {
        given(into, "size", ensemble.size)?;
        return given(into, "quenched", quenched.then_some(true));
    }
    given(into, "disorder", quenched.then(|| convert::disorder(ensemble.disorder)))
}

/// The arguments that make areas.
fn areas_arguments(areas: &scenario::Areas, into: &Bound<'_, PyDict>) -> PyResult<()> {
    into.set_item("law", Plain::Law(areas.law.clone()).object(into.py())?)?;
    into.set_item("modulus", areas.modulus)?;
    into.set_item("strength", areas.strength)
}

/// The arguments that make contacts.
fn contacts_arguments(contacts: &scenario::Contacts, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let py = into.py();
    let default = scenario::Contacts::default();
    let law = |law: &scenario::Law| Plain::Law(law.clone()).object(py);
    given(into, "thresholds", contacts.thresholds.as_ref().map(law).transpose()?)?;
    if contacts.reforming != default.reforming {
        into.set_item("reforming", law(&contacts.reforming)?)?;
    }
    let areas = contacts.areas.as_ref().map(|areas| Plain::Areas(areas.clone()).object(py));
    given(into, "areas", areas.transpose()?)?;
    given(into, "count", Some(contacts.count).filter(|&count| count != default.count))?;
    given(into, "stiffness", contacts.stiffness)?;
    given(into, "stiffness_per_threshold", contacts.stiffness_per_threshold)?;
    given(
        into,
        "stiffness_of_threshold",
        contacts.stiffness_of_threshold.as_ref().and_then(stiffness_columns),
    )?;
    given(into, "normal_load", contacts.normal_load)?;
    given(into, "background_force", contacts.background_force)?;
    given(into, "background_coefficient", contacts.background_coefficient)?;
    let temperature = contacts.temperature.map(|temperature| Plain::Temperature(temperature).object(py));
    given(into, "temperature", temperature.transpose()?)?;
    let ageing = contacts.ageing.as_ref().map(|ageing| Plain::Ageing(ageing.clone()).object(py));
    given(into, "ageing", ageing.transpose()?)?;
    let delay = contacts.delay.as_ref().map(|one| delay(one, py));
    given(into, "delay", delay.transpose()?)?;
    let FreeFriction { force, viscosity } = contacts.free_friction.unwrap_or_default();
    given(into, "free_friction", Some(force).filter(|&force| force != 0.0))?;
    given(into, "free_viscosity", Some(viscosity).filter(|&viscosity| viscosity != 0.0))
}

/// The columns of a table that is not in a file.
pub fn stiffness_columns(table: &scenario::StiffnessOfThreshold) -> Option<(Vec<f64>, Vec<f64>)> {
    table.threshold.clone().zip(table.stiffness.clone())
}

/// A delay as Python has it: a number, or a distribution.
pub fn delay<'py>(delay: &scenario::Delay, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
    match delay {
        scenario::Delay::Time(time) => Ok(PyFloat::new(py, *time).into_any()),
        scenario::Delay::Law(law) => Plain::Law(law.clone()).object(py),
    }
}

/// The arguments that create a temperature.
fn temperature_arguments(temperature: &scenario::Temperature, into: &Bound<'_, PyDict>) -> PyResult<()> {
    into.set_item("energy", temperature.energy)?;
    into.set_item("attempt_rate", temperature.attempt_rate)?;
    let other = temperature.barrier != scenario::Barrier::Elastic;
    given(into, "barrier", other.then(|| convert::barrier(temperature.barrier)))?;
    let additive = temperature.hazard != asperity::contacts::Hazard::Joint;
    given(into, "hazard", additive.then(|| convert::hazard(temperature.hazard)))
}

/// The arguments that create a model of ageing.
fn ageing_arguments(ageing: &scenario::Ageing, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let law = |law: &scenario::Law| Plain::Law(law.clone()).object(into.py());
    match ageing {
        scenario::Ageing::Smoluchowski { mature, diffusion }
        | scenario::Ageing::MeanField { mature, diffusion } => {
            into.set_item("mature", law(mature)?)?;
            into.set_item("diffusion", diffusion)
        }
        scenario::Ageing::FrozenRank { mature, time } => {
            into.set_item("mature", law(mature)?)?;
            into.set_item("time", time)
        }
        scenario::Ageing::Logarithmic { growth, time } => {
            into.set_item("growth", growth)?;
            into.set_item("time", time)
        }
        _ => unreachable!("a rule of ageing without a class"),
    }
}

/// The arguments that make such a slip rule.
fn slip_arguments(slip: Slip, into: &Bound<'_, PyDict>) -> PyResult<()> {
    match slip {
        Slip::Inertial { mass, damping } => {
            into.set_item("mass", mass)?;
            given(into, "damping", (damping != 0.0).then_some(damping))
        }
        Slip::Damped { damping } => into.set_item("damping", damping),
        _ => Ok(()),
    }
}

/// A slip rule as Python has it.
pub fn slip_rule(slip: Slip, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    match slip {
        Slip::Reset => "reset".into_bound_py_any(py),
        Slip::Overdamped => "overdamped".into_bound_py_any(py),
        Slip::Arrest => "arrest".into_bound_py_any(py),
        _ => Plain::Slip(slip).object(py),
    }
}

/// The arguments that make a block.
fn block_arguments(slider: &Slider, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let py = into.py();
    into.set_item("model", slider.model.object(py)?)?;
    into.set_item("stiffness", slider.stiffness)?;
    if slider.slip != Slip::default() {
        into.set_item("slip", slip_rule(slider.slip, py)?)?;
    }
    let fraction = slider.slip_fraction;
    given(into, "slip_fraction", (fraction != scenario::Block::SLIP_FRACTION).then_some(fraction))
}

/// The arguments that make a step.
fn step_arguments(step: &scenario::Step, into: &Bound<'_, PyDict>) -> PyResult<()> {
    given(into, "velocity", step.velocity)?;
    given(into, "distance", step.distance)?;
    given(into, "duration", step.duration)?;
    given(into, "hold", step.hold)?;
    given(into, "velocity_to", step.velocity_to)?;
    given(into, "points", (step.points != scenario::Step::default().points).then_some(step.points))?;
    given(into, "pieces", step.pieces)?;
    given(into, "relative_normal_load", step.relative_normal_load)
}

/// The arguments for [`interface`].
fn interface_arguments(interface: &Interface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Interface { contacts, initial, start } = interface;
    into.set_item("contacts", Plain::Contacts(contacts.clone()).object(into.py())?)?;
    if *initial != scenario::Law::zero() {
        into.set_item("initial", Plain::Law(initial.clone()).object(into.py())?)?;
    }
    given(into, "start", (*start != scenario::TaskStart::default()).then(|| convert::start(*start)))
}

/// The arguments of a master equation.
fn master_equation_arguments(
    interface: &Interface,
    Solved { own, velocity }: &Solved,
    into: &Bound<'_, PyDict>,
) -> PyResult<()> {
    interface_arguments(interface, into)?;
    given(into, "velocity", *velocity)?;
    given(into, "tolerance", own.tolerance)
}

/// The arguments of a transport.
fn transport_arguments(interface: &Interface, solved: &Solved, into: &Bound<'_, PyDict>) -> PyResult<()> {
    interface_arguments(interface, into)?;
    given(into, "velocity", solved.velocity)?;
    given(into, "tolerance", solved.own.tolerance)
}

/// The arguments of an ensemble.
fn ensemble_arguments(
    interface: &Interface,
    own: &scenario::Ensemble,
    into: &Bound<'_, PyDict>,
) -> PyResult<()> {
    interface_arguments(interface, into)?;
    into.set_item("size", own.size())?;
    into.set_item("seed", own.seed)?;
    let disorder = (own.disorder != Disorder::default()).then(|| convert::disorder(own.disorder));
    given(into, "disorder", disorder)
}

/// Sets an argument, unless it is omitted.
pub fn given<'py, T: IntoPyObject<'py>>(
    into: &Bound<'py, PyDict>,
    name: &str,
    value: Option<T>,
) -> PyResult<()> {
    value.map_or(Ok(()), |value| into.set_item(name, value))
}
