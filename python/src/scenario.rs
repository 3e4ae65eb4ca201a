//! The scenario of a model and a task, as a dictionary.

use asperity::scenario::{self, Law, Task, TaskStart};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use toml::{Table, Value};

use crate::description::Description;
use crate::error::{invalid, wrong_type};
use crate::plain::{Interface, Plain, Slider, Solved};
use crate::{convert, tables, typed};

/// The scenario of a model and a task.
///
/// Parameters
/// ----------
/// model
///     Contacts, a MasterEquation, a Transport, an Ensemble, a Block, an Interface or a Lattice.
/// **task
///     The table of the task by its name, such as pull={"distance": 5.0}, and further tables. A pull and a drive
///     have the velocity of the model unless the table has its own; these and a protocol have its start.
///
/// Returns
/// -------
/// dict
///     What `run` and `sweep` take, and can be changed before.
///
/// Raises
/// ------
/// ValueError
///     For a model that starts in a state with which the task does not start.
/// TypeError
///     For what is no model.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> model = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)), asp.Gaussian(0.1, 0.025))
/// >>> scenario = asp.scenario(model, pull={"distance": 5.0})
/// >>> sorted(scenario)
/// ['contacts', 'initial', 'pull']
/// >>> round(asp.run(scenario).kinetic_friction, 6)
/// 0.505
#[pyfunction(name = "scenario")]
#[pyo3(signature = (model: "Contacts | Model | Block | Deformable", **task: "Any") -> "dict[str, Any]")]
pub fn scenario_of<'py>(
    model: &Bound<'py, PyAny>,
    task: Option<&Bound<'py, PyDict>>,
) -> PyResult<typed::Values<'py>> {
    let mut known = Known::default();
    let is_known = model.cast::<Description>().is_ok_and(|model| known.add(model.get().plain()));
    if !is_known {
        return Err(wrong_type("model", "contacts, a model, a block or an interface", model));
    }
    for (name, table) in task.into_iter().flatten() {
        let name: String = name.extract()?;
        let mut table = tables::toml(&name, &table)?;
        known.complete(&name, &mut table)?;
        known.tables.insert(name, table);
    }
    object(model.py(), &Value::Table(known.tables)).map(typed::Values)
}

/// What a model determines of a scenario.
#[derive(Default)]
struct Known {
    tables: Table,
    start: TaskStart,
    velocity: Option<f64>,
}

impl Known {
    /// Adds the tables of a description; false for one that is no model.
    fn add(&mut self, plain: &Plain) -> bool {
        match plain {
            Plain::Contacts(contacts) => self.table("contacts", contacts),
            Plain::MasterEquation(interface, solved) | Plain::Transport(interface, solved) => {
                self.interface(interface);
                self.solved(solved);
            }
            Plain::Ensemble(interface, own) => {
                self.interface(interface);
                self.table("ensemble", own);
            }
            Plain::Block(slider) => return self.block(slider),
            Plain::Surface(surface) => {
                self.interface(&surface.contacts);
                self.table("interface", &surface.own);
                surface.ensemble.iter().for_each(|own| self.table("ensemble", own));
            }
            _ => return false,
        }
        true
    }

    fn block(&mut self, slider: &Slider) -> bool {
        let Slider { model, stiffness, slip, slip_fraction } = slider;
        if let Some(stiffness) = *stiffness {
            let (slip, slip_fraction) = (*slip, *slip_fraction);
            self.table("block", &scenario::Block { stiffness, slip, slip_fraction });
        }
        self.add(model)
    }

    fn interface(&mut self, Interface { contacts, initial, start }: &Interface) {
        self.table("contacts", contacts);
        if *initial != Law::zero() {
            self.table("initial", initial);
        }
        self.start = *start;
    }

    fn solved(&mut self, Solved { own, velocity }: &Solved) {
        if *own != scenario::MasterEquation::default() {
            self.table("master_equation", own);
        }
        self.velocity = *velocity;
    }

    fn table(&mut self, name: &str, plain: &impl serde::Serialize) {
        let value = Value::try_from(plain).expect("a description is plain data");
        self.tables.insert(name.into(), value);
    }

    /// Adds velocity and start of the model to the table of a task.
    fn complete(&self, name: &str, table: &mut Value) -> PyResult<()> {
        if let ("pull" | "drive", Value::Table(table), Some(velocity)) = (name, &mut *table, self.velocity) {
            table.entry("velocity").or_insert(velocity.into());
        }
        if self.start == TaskStart::default() {
            return Ok(());
        }
        let start = convert::start(self.start);
        let first = match (name, table) {
            ("pull" | "drive", Value::Table(table)) => Some(table),
            ("protocol", Value::Array(steps)) => steps.first_mut().and_then(Value::as_table_mut),
            _ if !Task::NAMES.contains(&name) => return Ok(()),
            _ => None,
        };
        let expected = "\"conditional\", except for a pull, a drive and a protocol";
        let first = first.ok_or_else(|| invalid("start", expected, start))?;
        first.entry("start").or_insert(start.into());
        Ok(())
    }
}

/// A value of a scenario in Python.
fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::String(text) => text.into_bound_py_any(py),
        Value::Integer(number) => number.into_bound_py_any(py),
        Value::Float(number) => number.into_bound_py_any(py),
        Value::Boolean(flag) => flag.into_bound_py_any(py),
        Value::Datetime(time) => time.to_string().into_bound_py_any(py),
        Value::Array(items) => {
            let items = items.iter().map(|item| object(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items).map(Bound::into_any)
        }
        Value::Table(table) => {
            let entries = PyDict::new(py);
            for (name, value) in table {
                entries.set_item(name, object(py, value)?)?;
            }
            Ok(entries.into_any())
        }
    }
}
