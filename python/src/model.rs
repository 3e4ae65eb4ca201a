//! What the models have in common: contacts, and how they start.

use asperity::scenario;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contacts::Contacts;
use crate::convert;
use crate::description::{Description, Interface, Plain};
use crate::law::{AnyLaw, given};

/// What a model is made of.
pub fn interface(
    contacts: &Bound<'_, Contacts>,
    initial: Option<AnyLaw>,
    start: &str,
) -> PyResult<Interface> {
    let initial = initial.map_or_else(scenario::Law::zero, |law| law.0);
    Ok(Interface {
        contacts: Contacts::plain(contacts).clone(),
        initial,
        start: convert::word("start", start)?,
    })
}

/// The arguments for [`interface`].
pub fn interface_arguments(interface: &Interface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Interface { contacts, initial, start } = interface;
    into.set_item("contacts", Plain::Contacts(contacts.clone()).object(into.py())?)?;
    if *initial != scenario::Law::zero() {
        into.set_item("initial", Plain::Law(initial.clone()).object(into.py())?)?;
    }
    given(into, "start", (*start != scenario::Start::default()).then(|| convert::start(*start)))
}

/// Contacts and how they start, to be pulled.
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Model;

impl Model {
    pub fn new(plain: Plain) -> PyClassInitializer<Self> {
        Description::new(plain).add_subclass(Self)
    }

    fn plain<'a>(model: &'a Bound<'_, Self>) -> &'a Interface {
        match model.as_super().get().plain() {
            Plain::MasterEquation(interface, _) | Plain::Ensemble(interface, _) => interface,
            _ => unreachable!("a model is described as a model"),
        }
    }
}

#[pymethods]
impl Model {
    /// The contacts.
    #[getter]
    fn contacts<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Plain::Contacts(Self::plain(slf).contacts.clone()).object(slf.py())
    }

    /// The law Q_ini of stretches at X = 0.
    #[getter]
    fn initial<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Plain::Law(Self::plain(slf).initial.clone()).object(slf.py())
    }

    /// "conditional" or "relaxed".
    #[getter]
    fn start(slf: &Bound<'_, Self>) -> &'static str {
        convert::start(Self::plain(slf).start)
    }
}
