//! Time-dependent contacts: temperature and ageing.

use asperity::scenario;
use pyo3::prelude::*;

use crate::argument::{Argument, Real};
use crate::convert;
use crate::description::Description;
use crate::law::{AnyLaw, Law};
use crate::plain::Plain;
use crate::{error, typed};

/// A value that has to be a finite number above 0.
fn above_zero(key: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(error::invalid(key, "a finite number above 0", value))
}

/// Thermally activated breaking (Kramers): contacts below their thresholds break at the rate w = ω exp(−ΔE/T).
///
/// Parameters
/// ----------
/// energy
///     The temperature T in units of energy (force × length), above 0.
/// attempt_rate
///     The attempt rate ω, per time, above 0.
/// barrier
///     ΔE of a contact of stretch x below its threshold x_s, with E_0 = ½k x_s²: "elastic", ½k(x_s² − x²); "bell",
///     E_0(1 − x/x_s); "catastrophe", E_0(1 − x/x_s)^(3/2).
/// hazard
///     "joint", each contact breaks at the rate of its own threshold; "additive", all of one stretch break at the rate
///     of the average contact (O. M. Braun and M. Peyrard, 2010).
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For an energy or an attempt_rate that is not above 0, and another word as barrier or hazard.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> thermal = asp.Temperature(energy=0.05, attempt_rate=1.0)
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=thermal)
/// >>> friction = asp.velocity_curve(contacts, [1e-4, 1e-2]).kinetic_friction
/// >>> bool(friction[0] < friction[1])
/// True
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Temperature;

#[pymethods]
impl Temperature {
    #[new]
    #[pyo3(signature = (energy, attempt_rate, *, barrier: "Literal['elastic', 'bell', 'catastrophe']" = Argument::text("elastic"), hazard: "Literal['joint', 'additive']" = Argument::text("joint")), text_signature = "(energy, attempt_rate, *, barrier='elastic', hazard='joint')")]
    fn new(
        energy: Real,
        attempt_rate: Real,
        barrier: Argument<String>,
        hazard: Argument<String>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let (barrier, hazard) = (barrier.get("barrier")?, hazard.get("hazard")?);
        let energy = energy.get("energy")?;
        let attempt_rate = attempt_rate.get("attempt_rate")?;
        let barrier = convert::word("barrier", &barrier)?;
        let hazard = convert::word("hazard", &hazard)?;
        above_zero("energy", energy)?;
        above_zero("attempt_rate", attempt_rate)?;
        let plain = Plain::Temperature(scenario::Temperature {
            barrier,
            hazard,
            ..scenario::Temperature::new(energy, attempt_rate)
        });
        Ok(Description::new(plain).add_subclass(Self))
    }

    /// The temperature T, an energy.
    #[getter]
    fn energy(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).energy
    }

    /// The attempt rate ω, per time.
    #[getter]
    fn attempt_rate(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).attempt_rate
    }

    /// The barrier ΔE, "elastic", "bell" or "catastrophe".
    #[getter]
    fn barrier(slf: &Bound<'_, Self>) -> typed::BarrierWord {
        typed::BarrierWord(convert::barrier(Self::plain(slf).barrier))
    }

    /// The rate of thermal breaking, "joint" or "additive".
    #[getter]
    fn hazard(slf: &Bound<'_, Self>) -> typed::HazardWord {
        typed::HazardWord(convert::hazard(Self::plain(slf).hazard))
    }
}

impl Temperature {
    pub fn plain(temperature: &Bound<'_, Self>) -> scenario::Temperature {
        match temperature.as_super().get().plain() {
            Plain::Temperature(temperature) => *temperature,
            _ => unreachable!("a temperature is described as one"),
        }
    }
}

/// Ageing: thresholds that change with the age of a contact. Its models are Smoluchowski, FrozenRank,
/// Logarithmic and MeanField.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> isinstance(asp.Logarithmic(growth=0.1, time=1.0), asp.Ageing)
/// True
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Ageing;

impl Ageing {
    fn described(ageing: scenario::Ageing) -> PyClassInitializer<Self> {
        Description::new(Plain::Ageing(ageing)).add_subclass(Self)
    }

    /// The mature distribution, diffusion coefficient or time scale, and growth, of those rules that have them.
    fn parts(ageing: &Bound<'_, Self>) -> (Option<scenario::Law>, f64, f64) {
        match Self::plain(ageing) {
            scenario::Ageing::Smoluchowski { mature, diffusion: scale }
            | scenario::Ageing::MeanField { mature, diffusion: scale }
            | scenario::Ageing::FrozenRank { mature, time: scale } => (Some(mature), scale, f64::NAN),
            scenario::Ageing::Logarithmic { growth, time } => (None, time, growth),
            _ => unreachable!("a rule of ageing without a class"),
        }
    }

    /// The mature distribution of a rule that has one.
    fn mature<'py>(ageing: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        let (mature, ..) = Self::parts(ageing);
        Plain::Law(mature.expect("a rule with a mature distribution")).instance(ageing.py())
    }

    pub fn plain(ageing: &Bound<'_, Self>) -> scenario::Ageing {
        match ageing.as_super().get().plain() {
            Plain::Ageing(ageing) => ageing.clone(),
            _ => unreachable!("ageing is described as ageing"),
        }
    }
}

/// Thresholds diffuse independently in the potential U = −ln P_cf towards the mature distribution
/// (Fokker–Planck equation).
///
/// Parameters
/// ----------
/// mature
///     The distribution P_cf of the thresholds of contacts that never break.
/// diffusion
///     The diffusion coefficient D, stretch² per time, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a diffusion that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
///     mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
///     refused by the models.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> ageing = asp.Smoluchowski(asp.Gaussian(1.0, 0.05), diffusion=0.0025)
/// >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
/// >>> round(asp.velocity_curve(contacts, 1.0), 4)
/// 0.3847
#[pyclass(frozen, extends = Ageing, module = "asperity")]
pub struct Smoluchowski;

#[pymethods]
impl Smoluchowski {
    #[new]
    fn new(mature: Argument<AnyLaw>, diffusion: Real) -> PyResult<PyClassInitializer<Self>> {
        let mature = mature.get("mature")?;
        let diffusion = above_zero("diffusion", diffusion.get("diffusion")?)?;
        Ok(Ageing::described(scenario::Ageing::Smoluchowski { mature: mature.0, diffusion })
            .add_subclass(Self))
    }

    /// The distribution P_cf of mature thresholds.
    #[getter]
    fn mature<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Ageing::mature(slf.as_super())
    }

    /// The diffusion coefficient D, stretch² per time.
    #[getter]
    fn diffusion(slf: &Bound<'_, Self>) -> f64 {
        Ageing::parts(slf.as_super()).1
    }
}

/// The distribution of thresholds matures, and every contact keeps its rank (quantile) in it.
///
/// Parameters
/// ----------
/// mature
///     The mature distribution P_cf.
/// time
///     The time scale of maturing, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a time that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
///     mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
///     refused by the models.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> ageing = asp.FrozenRank(asp.Gaussian(1.0, 0.05), time=1.0)
/// >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
/// >>> round(asp.velocity_curve(contacts, 1.0), 6)
/// 0.386778
#[pyclass(frozen, extends = Ageing, module = "asperity")]
pub struct FrozenRank;

#[pymethods]
impl FrozenRank {
    #[new]
    fn new(mature: Argument<AnyLaw>, time: Real) -> PyResult<PyClassInitializer<Self>> {
        let mature = mature.get("mature")?;
        let time = above_zero("time", time.get("time")?)?;
        Ok(Ageing::described(scenario::Ageing::FrozenRank { mature: mature.0, time }).add_subclass(Self))
    }

    /// The distribution P_cf of mature thresholds.
    #[getter]
    fn mature<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Ageing::mature(slf.as_super())
    }

    /// The time scale of maturing.
    #[getter]
    fn time(slf: &Bound<'_, Self>) -> f64 {
        Ageing::parts(slf.as_super()).1
    }
}

/// Every threshold grows with the logarithm of the age t of the contact: h = h_0 [1 + growth ln(1 + t/time)].
///
/// Parameters
/// ----------
/// growth
///     The growth β, 0 or above.
/// time
///     The time τ_0, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a growth below 0, and a time that is not above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))
/// >>> asp.velocity_curve(contacts, [1e-2, 1.0]).kinetic_friction.round(6)
/// array([0.552766, 0.512211])
#[pyclass(frozen, extends = Ageing, module = "asperity")]
pub struct Logarithmic;

#[pymethods]
impl Logarithmic {
    #[new]
    fn new(growth: Real, time: Real) -> PyResult<PyClassInitializer<Self>> {
        let growth = growth.get("growth")?;
        if !(growth.is_finite() && growth >= 0.0) {
            return Err(error::invalid("growth", "a finite number, 0 or above", growth));
        }
        let time = above_zero("time", time.get("time")?)?;
        Ok(Ageing::described(scenario::Ageing::Logarithmic { growth, time }).add_subclass(Self))
    }

    /// The growth β.
    #[getter]
    fn growth(slf: &Bound<'_, Self>) -> f64 {
        Ageing::parts(slf.as_super()).2
    }

    /// The time τ_0.
    #[getter]
    fn time(slf: &Bound<'_, Self>) -> f64 {
        Ageing::parts(slf.as_super()).1
    }
}

/// One distribution of thresholds that all contacts share, from the mean-field equations for thresholds and
/// stretches. It is not a rule for a single contact.
///
/// Where the velocity varies, it is followed with the stretches of the contacts. It cannot be combined with
/// temperature or an ensemble.
///
/// Parameters
/// ----------
/// mature
///     The mature distribution P_cf.
/// diffusion
///     The diffusion coefficient D, stretch² per time, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a diffusion that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
///     mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
///     refused by the models.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> ageing = asp.MeanField(asp.Gaussian(1.0, 0.05), diffusion=0.0025)
/// >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
/// >>> round(asp.velocity_curve(contacts, 1.0), 6)
/// 0.370081
#[pyclass(frozen, extends = Ageing, module = "asperity")]
pub struct MeanField;

#[pymethods]
impl MeanField {
    #[new]
    fn new(mature: Argument<AnyLaw>, diffusion: Real) -> PyResult<PyClassInitializer<Self>> {
        let mature = mature.get("mature")?;
        let diffusion = above_zero("diffusion", diffusion.get("diffusion")?)?;
        Ok(Ageing::described(scenario::Ageing::MeanField { mature: mature.0, diffusion }).add_subclass(Self))
    }

    /// The distribution P_cf of mature thresholds.
    #[getter]
    fn mature<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Ageing::mature(slf.as_super())
    }

    /// The diffusion coefficient D, stretch² per time.
    #[getter]
    fn diffusion(slf: &Bound<'_, Self>) -> f64 {
        Ageing::parts(slf.as_super()).1
    }
}
