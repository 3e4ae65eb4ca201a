//! Contacts, and the distributions of areas from which they follow.

use asperity::contacts::FreeFriction;
use asperity::monitor::Monitor;
use asperity::scenario;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{Argument, Expected, Optional as _, Real};
use crate::arguments::{self, stiffness_columns};
use crate::convert;
use crate::description::Description;
use crate::law::{AnyLaw, Law};
use crate::plain::Plain;
use crate::rules::{Ageing, Temperature};
use crate::typed::{argument_type, result_type};
use crate::watch::watched;

/// Contacts described by their areas A: a contact has the stiffness k = modulus √A and breaks at the force
/// strength × A.
///
/// Its threshold is thus x_s = (strength/modulus) √A, and k = κ x_s with κ = modulus²/strength.
///
/// Parameters
/// ----------
/// law
///     The distribution of areas, in units of length².
/// modulus
///     Stiffness divided by the square root of the area, force per length² (ρc² in Braun and Peyrard 2008), above 0.
/// strength
///     Force per area at which a contact breaks, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a modulus or a strength that is not above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> areas = asp.Areas(asp.Exponential(1.0), modulus=2.0, strength=1.0)
/// >>> contacts = asp.Contacts(areas=areas)
/// >>> contacts.areas.modulus
/// 2.0
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Areas;

#[pymethods]
impl Areas {
    #[new]
    fn new(law: Argument<AnyLaw>, modulus: Real, strength: Real) -> PyResult<PyClassInitializer<Self>> {
        let law = law.get("law")?;
        let modulus = modulus.get("modulus")?;
        let strength = strength.get("strength")?;
        let areas = scenario::Areas { law: law.0, modulus, strength };
        let build = |monitor: &mut dyn Monitor| areas.build_with(monitor).map_err(|e| e.under("areas"));
        Python::attach(|py| watched(None, py, build))?;
        Ok(Description::new(Plain::Areas(areas)).add_subclass(Self))
    }

    /// The distribution of areas, in units of length².
    #[getter]
    fn law<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Plain::Law(Self::plain(slf).law.clone()).instance(slf.py())
    }

    /// The stiffness divided by the square root of the area, force per length².
    #[getter]
    fn modulus(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).modulus
    }

    /// The force per area at which a contact breaks.
    #[getter]
    fn strength(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).strength
    }
}

impl Areas {
    fn plain<'a>(areas: &'a Bound<'_, Self>) -> &'a scenario::Areas {
        match areas.as_super().get().plain() {
            Plain::Areas(areas) => areas,
            _ => unreachable!("areas are described as areas"),
        }
    }
}

/// The contacts of an interface: when they break, how stiff they are, how they re-form.
///
/// Contacts with temperature, ageing or delay are time-dependent: their friction depends on the velocity, which
/// must be given.
///
/// Distributions may be those of asperity, frozen ones of scipy.stats, or samples: see asperity.law.
///
/// Parameters
/// ----------
/// thresholds
///     The distribution P_c of the stretches at which contacts break.
/// areas
///     Areas, from which thresholds and stiffnesses follow, instead of thresholds.
/// reforming
///     The distribution R of the stretches at which they re-form, by default all at 0. Models leave out stretches
///     beyond the thresholds, at most half of them, and warn of the share.
/// count
///     The number N_c of contacts, above 0; with 1, forces are per contact.
/// stiffness
///     The stiffness ⟨k⟩ of a contact, force per length, 1 by default.
/// stiffness_per_threshold
///     The κ of stiffnesses k = κ x_s that are proportional to the threshold, instead of stiffness.
/// stiffness_of_threshold
///     A pair of lists, thresholds x_s and the stiffness k of a contact with each of them: k(x_s) is linear between
///     them and constant beyond, instead of stiffness. For contacts without temperature, ageing and delay.
/// normal_load
///     The normal load, a force; with it, results of scenarios have friction coefficients.
/// background_force
///     A friction force B in addition to that of the contacts, against the motion, 0 or above. Forces of a Block and
///     of results of scenarios contain it, those of a MasterEquation, a Transport and an Ensemble do not.
/// background_coefficient
///     The μ_b of B = μ_b normal_load, instead of background_force.
/// temperature
///     Thermally activated breaking below the thresholds.
/// ageing
///     Change of the thresholds with the age of a contact; thresholds is then the distribution of fresh contacts.
/// delay
///     Time for which a broken contact is detached before it re-forms, 0 by default: a number, or a distribution of times.
///     Re-forming at a rate is Exponential(1/rate).
/// free_friction
///     Friction force of a detached contact, which slides, 0 by default.
/// free_viscosity
///     What its friction force gains per velocity, 0 by default.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For both or neither of thresholds and areas; more than one of stiffness, stiffness_per_threshold and
///     stiffness_of_threshold, or one beside areas; both of background_force and background_coefficient, or the latter
///     without normal_load; a count, a stiffness or a normal_load that is not above 0; and a background_force, a
///     background_coefficient or a delay below 0. Rules that do not go together are refused by the models.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), count=1000, stiffness=2.0)
/// >>> contacts.stiffness
/// 2.0
/// >>> contacts.replace(count=10).count
/// 10.0
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Contacts;

#[pymethods]
impl Contacts {
    #[new]
    #[pyo3(signature = (
        thresholds = None, reforming = None, *, areas = None, count = Real::new(1.0), stiffness = None,
        stiffness_per_threshold = None, stiffness_of_threshold: "tuple[ArrayLike, ArrayLike] | None" = None,
        normal_load = None, background_force = None, background_coefficient = None, temperature = None, ageing = None,
        delay = None, free_friction = Real::new(0.0), free_viscosity = Real::new(0.0)), text_signature = "(thresholds=None, reforming=None, *, areas=None, count=1.0, stiffness=None, stiffness_per_threshold=None, stiffness_of_threshold=None, normal_load=None, background_force=None, background_coefficient=None, temperature=None, ageing=None, delay=None, free_friction=0.0, free_viscosity=0.0)")]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        thresholds: Option<Argument<AnyLaw>>,
        reforming: Option<Argument<AnyLaw>>,
        areas: Option<Argument<Bound<'_, Areas>>>,
        count: Real,
        stiffness: Option<Real>,
        stiffness_per_threshold: Option<Real>,
        stiffness_of_threshold: Option<Argument<(Bound<'_, PyAny>, Bound<'_, PyAny>)>>,
        normal_load: Option<Real>,
        background_force: Option<Real>,
        background_coefficient: Option<Real>,
        temperature: Option<Argument<Bound<'_, Temperature>>>,
        ageing: Option<Argument<Bound<'_, Ageing>>>,
        delay: Option<Argument<AnyDelay>>,
        free_friction: Real,
        free_viscosity: Real,
    ) -> PyResult<PyClassInitializer<Self>> {
        let thresholds = thresholds.get("thresholds")?;
        let reforming = reforming.get("reforming")?;
        let delay = delay.get("delay")?;
        let areas = areas.get("areas")?;
        let areas = areas.as_ref();
        let count = count.get("count")?;
        let temperature = temperature.get("temperature")?;
        let temperature = temperature.as_ref();
        let ageing = ageing.get("ageing")?;
        let ageing = ageing.as_ref();
        let free_friction = free_friction.get("free_friction")?;
        let free_viscosity = free_viscosity.get("free_viscosity")?;
        let stiffness = stiffness.get("stiffness")?;
        let stiffness_per_threshold = stiffness_per_threshold.get("stiffness_per_threshold")?;
        let stiffness_of_threshold = stiffness_of_threshold.get("stiffness_of_threshold")?;
        let normal_load = normal_load.get("normal_load")?;
        let background_force = background_force.get("background_force")?;
        let background_coefficient = background_coefficient.get("background_coefficient")?;
        let friction = FreeFriction { force: free_friction, viscosity: free_viscosity };
        let contacts = scenario::Contacts {
            count,
            stiffness,
            stiffness_per_threshold,
            stiffness_of_threshold: stiffness_of_threshold.map(stiffness_table).transpose()?,
            normal_load,
            background_force,
            background_coefficient,
            thresholds: thresholds.map(|law| law.0),
            areas: areas.map(|areas| Areas::plain(areas).clone()),
            reforming: reforming.map_or_else(scenario::Law::zero, |law| law.0),
            temperature: temperature.map(Temperature::plain),
            ageing: ageing.map(Ageing::plain),
            delay: delay.map(|delay| delay.0).filter(|delay| *delay != scenario::Delay::Time(0.0)),
            free_friction: Some(friction).filter(|friction| !friction.is_none()),
        };
        let build = |monitor: &mut dyn Monitor| contacts.build_with(monitor).map_err(|e| e.under("contacts"));
        Python::attach(|py| watched(None, py, build))?;
        Ok(Description::new(Plain::Contacts(contacts)).add_subclass(Self))
    }

    /// The distribution P_c of the stretches at which contacts break; None for contacts described by their areas.
    #[getter]
    fn thresholds<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Law>>> {
        let law = Self::plain(slf).thresholds.clone();
        law.map(|law| Plain::Law(law).instance(slf.py())).transpose()
    }

    /// The distribution R of the stretches at which contacts re-form.
    #[getter]
    fn reforming<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Plain::Law(Self::plain(slf).reforming.clone()).instance(slf.py())
    }

    /// The areas from which thresholds and stiffnesses follow, or None.
    #[getter]
    fn areas<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Areas>>> {
        let areas = Self::plain(slf).areas.clone();
        areas.map(|areas| Plain::Areas(areas).instance(slf.py())).transpose()
    }

    /// The temperature of thermally activated breaking, or None.
    #[getter]
    fn temperature<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Temperature>>> {
        let temperature = Self::plain(slf).temperature;
        temperature.map(|temperature| Plain::Temperature(temperature).instance(slf.py())).transpose()
    }

    /// The model of ageing, or None.
    #[getter]
    fn ageing<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Ageing>>> {
        let ageing = Self::plain(slf).ageing.clone();
        ageing.map(|ageing| Plain::Ageing(ageing).instance(slf.py())).transpose()
    }

    /// The time for which a broken contact is detached before it re-forms, or the distribution of these times.
    #[getter]
    fn delay(slf: &Bound<'_, Self>) -> PyResult<PlainDelay> {
        let delay = Self::plain(slf).delay.as_ref().unwrap_or(&scenario::Delay::Time(0.0));
        arguments::delay(delay, slf.py()).map(|delay| PlainDelay(delay.unbind()))
    }

    /// The friction force of a detached contact.
    #[getter]
    fn free_friction(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).free_friction.unwrap_or_default().force
    }

    /// What the friction force of a detached contact gains per velocity.
    #[getter]
    fn free_viscosity(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).free_friction.unwrap_or_default().viscosity
    }

    /// The number N_c of contacts.
    #[getter]
    fn count(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).count
    }

    /// The stiffness ⟨k⟩ of a contact, force per length; None where it depends on the threshold.
    #[getter]
    fn stiffness(slf: &Bound<'_, Self>) -> Option<f64> {
        let own = Self::plain(slf);
        let different = own.areas.is_some()
            || own.stiffness_per_threshold.is_some()
            || own.stiffness_of_threshold.is_some();
        own.stiffness.or((!different).then_some(1.0))
    }

    /// The κ of stiffnesses k = κ x_s, force per length²; None where stiffness does not depend on the threshold, and for
    /// contacts described by their areas.
    #[getter]
    fn stiffness_per_threshold(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).stiffness_per_threshold
    }

    /// Thresholds x_s and the stiffness k of a contact with each of them, or None.
    #[getter]
    fn stiffness_of_threshold(slf: &Bound<'_, Self>) -> Option<(Vec<f64>, Vec<f64>)> {
        Self::plain(slf).stiffness_of_threshold.as_ref().and_then(stiffness_columns)
    }

    /// The normal load, a force, or None.
    #[getter]
    fn normal_load(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).normal_load
    }

    /// The background force B, a force, or None.
    #[getter]
    fn background_force(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).background_force
    }

    /// The background force divided by the normal load, or None.
    #[getter]
    fn background_coefficient(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::plain(slf).background_coefficient
    }

    /// Plots the distributions of the thresholds and of the stretches at which contacts re-form, or that of the areas;
    /// point masses are stems. It needs matplotlib, whose styles it follows.
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
        slf.py().import("asperity._plot")?.call_method("contacts", (slf, ax), style)
    }
}

impl Contacts {
    pub fn plain<'a>(contacts: &'a Bound<'_, Self>) -> &'a scenario::Contacts {
        match contacts.as_super().get().plain() {
            Plain::Contacts(contacts) => contacts,
            _ => unreachable!("contacts are described as contacts"),
        }
    }
}

fn stiffness_table(
    (threshold, stiffness): (Bound<'_, PyAny>, Bound<'_, PyAny>),
) -> PyResult<scenario::StiffnessOfThreshold> {
    let column = |name: &str, values| {
        convert::list(&format!("contacts.stiffness_of_threshold.{name}"), &values).map(Some)
    };
    Ok(scenario::StiffnessOfThreshold {
        file: None,
        threshold: column("threshold", threshold)?,
        stiffness: column("stiffness", stiffness)?,
    })
}

/// A delay as an argument: a time, or a distribution of times.
pub struct AnyDelay(scenario::Delay);

impl<'py> FromPyObject<'_, 'py> for AnyDelay {
    type Error = PyErr;

    argument_type!("_Number | _AnyLaw");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.extract::<f64>() {
            Ok(time) => Ok(Self(scenario::Delay::Time(time))),
            Err(_) => value.extract::<AnyLaw>().map(|law| Self(scenario::Delay::Law(law.0))),
        }
    }
}

/// A delay as a result: a number, or a distribution.
struct PlainDelay(Py<PyAny>);

impl<'py> IntoPyObject<'py> for PlainDelay {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    result_type!("float | Law");

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.0.into_bound(py))
    }
}

impl Expected for AnyDelay {
    fn expected() -> String {
        "a time or a distribution of times".into()
    }
}
