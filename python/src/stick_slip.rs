//! The result of a drive of a slider.

use asperity::energy::EnergyBalance;
use asperity::scenario::{self, Units};
use asperity::task::sliding;
use asperity::task::summary::Sliding;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert;
use crate::description::Description;
use crate::model::Model;
use crate::pickle::{self, Reduced};
use crate::plain::Plain;
use crate::record::Record;
use crate::watch::watched;
use crate::{error, typed, values};

/// The result of a drive of a slider: its trace, its slips, and the regime of sliding.
///
/// Its variables are those of the trace, `drive`, `position`, `force` and `spring_force`, at states of
/// equilibrium; those of the slips, `event_drive`, `event_drop`, …; for an inertial slip its time course,
/// `slip_time`, `slip_position`, …; for an ensemble the sizes of events, `size`, `size_events`, …. For motion
/// in time the trace also has `time`, `velocity` and `free` (the detached fraction of the contacts), and there
/// are no time course and no sizes.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
/// >>> run = asp.Block(theory, 1.0).drive(5.0)
/// >>> len(run.events) > 0
/// True
#[pyclass(frozen, extends = Record, module = "asperity")]
pub struct StickSlip {
    /// That of the block.
    block: Py<Description>,
    sliding: Sliding,
    energy: EnergyBalance,
}

impl StickSlip {
    /// Drives a block and returns the result.
    pub fn object(
        block: Bound<'_, Description>,
        model: &Bound<'_, Model>,
        asked: &scenario::Drive,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Self>> {
        let py = block.py();
        let solver = model.get().solver();
        let slider = asked.slider(table(&block).as_ref(), solver.size().is_some());
        let slider = slider.and_then(|slider| slider.with_background(Model::background(model)));
        let slider = slider.map_err(error::core)?;
        let run = watched(progress, py, |monitor| {
            let mut population = solver.population(monitor)?;
            let drive = asked.build(slider.start(population.as_mut())?);
            slider.pull_with(population.as_mut(), &drive, monitor)
        })?;
        let mut record = sliding::motion(&run);
        record.variables.extend(sliding::course(&run).variables);
        if let Some(size) = solver.size() {
            record.variables.extend(sliding::sizes(&run, size).variables);
        }
        let found = Self { block: block.unbind(), sliding: Sliding::new(&run), energy: run.energy };
        Py::new(py, Record::new(py, record, Units::default())?.add_subclass(found))
    }
}

impl StickSlip {
    /// Moves the load point of a block in time and returns the result.
    pub fn in_time(
        block: Bound<'_, Description>,
        model: &Bound<'_, Model>,
        protocol: &scenario::Protocol,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Self>> {
        let py = block.py();
        let solver = model.get().solver();
        let Some(table) = table(&block) else {
            let expected = "a finite stiffness in time (a rigid slider is moved by Transport.follow)";
            return Err(error::invalid("block.stiffness", expected, f64::INFINITY));
        };
        let background = Model::background(model);
        let run = watched(progress, py, |monitor| {
            let slider = table.in_time(solver.size().is_some())?.with_background(background)?;
            let (contacts, tolerance) = solver.in_time(monitor)?;
            slider.follow_with(contacts.as_ref(), &protocol.build()?, &protocol.times(), tolerance, monitor)
        })?;
        let found = Self { block: block.unbind(), sliding: Sliding::in_time(&run), energy: run.energy };
        let record = Record::new(py, sliding::motion_in_time(&run), Units::default())?;
        Py::new(py, record.add_subclass(found))
    }
}

impl StickSlip {
    /// The result of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8], model: Option<Bound<'_, PyAny>>) -> PyResult<Py<PyAny>> {
        let block = pickle::of_model(model, |model: &Bound<'_, Description>| {
            matches!(model.get().plain(), Plain::Block(_))
        })?
        .unbind();
        let ((sliding, energy), record) = Record::unpacked(py, bytes)?;
        Ok(Py::new(py, record.add_subclass(Self { block, sliding, energy }))?.into_any())
    }
}

/// The stiffness and the slips of a block as in a scenario; `None` for a rigid slider.
fn table(block: &Bound<'_, Description>) -> Option<scenario::Block> {
    match block.get().plain() {
        Plain::Block(slider) => slider.table(),
        _ => unreachable!("a block is described as a block"),
    }
}

/// A variable that the trace of motion in time has.
fn in_time<'py>(run: &Bound<'py, StickSlip>, name: &str) -> PyResult<Option<typed::Array<'py>>> {
    if !run.contains(name)? {
        return Ok(None);
    }
    run.get_item(name).map(|values| Some(typed::Array(values)))
}

#[pymethods]
impl StickSlip {
    /// The block that was driven.
    #[getter]
    fn block<'py>(&self, py: Python<'py>) -> typed::Block<'py> {
        typed::Block(self.block.bind(py).clone().into_any())
    }

    /// The drive along the trace, shape (n,): the load-point displacement X_T, a length; or the imposed force.
    #[getter]
    fn drive<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::Array<'py>> {
        slf.get_item("drive").map(typed::Array)
    }

    /// The times of the trace of motion in time, shape (n,); None without.
    #[getter]
    fn time<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Array<'py>>> {
        in_time(slf, "time")
    }

    /// The velocity of the slider along the trace of motion in time, shape (n,); None without.
    #[getter]
    fn velocity<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Array<'py>>> {
        in_time(slf, "velocity")
    }

    /// The spring force K(X_T - X) along the trace, shape (n,); it equals F in equilibrium.
    #[getter]
    fn spring_force<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::Array<'py>> {
        slf.get_item("spring_force").map(typed::Array)
    }

    /// The slips.
    #[getter]
    fn events<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::Events<'py>> {
        let columns = PyDict::new(slf.py());
        slf.as_super().get().events_into(&columns)?;
        values::events(slf.py(), columns)
    }

    /// The regime of sliding: "smooth" without slips; "transient" if slips have ceased; "persistent" if they
    /// continue with a steady period; "runaway" if the contacts could not carry the imposed force; "undecided" if
    /// the drive was too short. It refers to the drive since its last reversal.
    #[getter]
    fn regime(&self) -> typed::RegimeWord {
        typed::RegimeWord(convert::regime(self.sliding.regime))
    }

    /// The regime with its reason, in words.
    #[getter]
    fn reason(&self) -> &str {
        &self.sliding.reason
    }

    /// The mean increase of the drive from one slip to the next, a length; None, as for all such means, unless
    /// stick-slip is persistent.
    #[getter]
    fn period(&self) -> Option<f64> {
        self.sliding.period
    }

    /// The mean drop of the force in a slip.
    #[getter]
    fn mean_drop(&self) -> Option<f64> {
        self.sliding.mean_drop
    }

    /// The mean slip (displacement of the slider in a slip), a length.
    #[getter]
    fn mean_slip(&self) -> Option<f64> {
        self.sliding.mean_slip
    }

    /// The relative standard deviation of the period: the standard deviation of the increases of the drive from one
    /// slip to the next, divided by their mean.
    #[getter]
    fn scatter(&self) -> Option<f64> {
        self.sliding.scatter
    }

    /// The state at which the slider first became unstable; None if it never did.
    #[getter]
    fn first_instability<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::State<'py>>> {
        self.sliding.first_instability.map(|place| values::state(py, &place)).transpose()
    }

    /// The state from which the slider ran away under an imposed force; None if it did not.
    #[getter]
    fn runaway<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::State<'py>>> {
        self.sliding.runaway.map(|place| values::state(py, &place)).transpose()
    }

    /// The energy balance from the start of the drive to its end (for a runaway, to where it began).
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<typed::BlockEnergy<'py>> {
        values::energy(py, &self.energy)
    }

    /// The number of events of each size, including those too small for a slip; None for the master equation.
    #[getter]
    fn sizes<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Sizes<'py>>> {
        let names = ["size", "size_events", "size_slip", "size_drop"];
        columns(slf, names)?.map(|columns| values::sizes(slf.py(), columns)).transpose()
    }

    /// The time course of the first inertial slip; None if there was none.
    #[getter]
    fn slip_course<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Course<'py>>> {
        let names = ["slip_time", "slip_position", "slip_velocity", "slip_force", "slip_spring_force"];
        columns(slf, names)?.map(|columns| values::course(slf.py(), columns)).transpose()
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, Self { block, sliding, energy }) = (slf.py(), slf.get());
        let bytes = slf.as_super().get().packed(py, &(sliding, energy))?;
        pickle::reduced(py, "StickSlip", &bytes, Some(block.bind(py).clone().into_any()))
    }
}

/// Arrays by name, if the first of them is there.
fn columns<'py, const N: usize>(
    run: &Bound<'py, StickSlip>,
    names: [&str; N],
) -> PyResult<Option<[Bound<'py, PyAny>; N]>> {
    if !run.contains(names[0])? {
        return Ok(None);
    }
    let columns: Vec<_> = names.iter().map(|name| run.get_item(name)).collect::<PyResult<_>>()?;
    Ok(columns.try_into().ok())
}
