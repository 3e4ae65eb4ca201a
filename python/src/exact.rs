//! Closed forms.

use asperity::exact::{self, ClosedForm as _};
use asperity::law::SharedLaw;
use asperity::scenario;
use pyo3::prelude::*;
use pyo3::types::PyComplex;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::convert::{Domain, evaluate};
use crate::law::{AnyLaw, built};
use crate::{error, typed};

/// A friction curve F(X) in closed form, per total stiffness: F/(N_c⟨k⟩), the mean stretch, a length.
///
/// All contacts start and re-form at stretch 0, unless the class says otherwise. Positions X are lengths from 0
/// up to where the sums would become long. For every density p of thresholds with n-fold convolutions p_n,
/// F'(X) = 1 - X Σ p_n(X)/n. Each closed form is the sum of this series for one family, and none shares code
/// with the solvers.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> isinstance(asp.exact.Identical(1.0), asp.exact.ClosedForm)
/// True
#[pyclass(frozen, subclass, module = "asperity.exact")]
pub struct ClosedForm {
    form: Box<dyn exact::ClosedForm + Send + Sync>,
}

/// The start of an object for `form`, checked.
fn checked<F: exact::ClosedForm + Copy + Send + Sync + 'static>(
    form: F,
) -> PyResult<PyClassInitializer<ClosedForm>> {
    form.check().map_err(error::core)?;
    Ok(ClosedForm { form: Box::new(form) }.into())
}

#[pymethods]
impl ClosedForm {
    /// F(X)/(N_c⟨k⟩), a length; where contacts break simultaneously, after the break.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions X, 0 or above: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If position is neither a number nor an array of numbers.
    /// ValueError
    ///     For a position below 0, or beyond 1e5 mean thresholds of Gaussian and Gamma or 300 of Rectangular.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn force<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &Domain::positions(self.form.reach()), |x| self.form.force(x))
    }

    /// F'(X)/(N_c⟨k⟩) from the right, a number.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions X, 0 or above: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If position is neither a number nor an array of numbers.
    /// ValueError
    ///     For a position below 0, or beyond 1e5 mean thresholds of Gaussian and Gamma or 300 of Rectangular.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn slope<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &Domain::positions(self.form.reach()), |x| self.form.slope(x))
    }

    /// F_k/(N_c⟨k⟩), the force of steady sliding, a length.
    #[getter]
    fn kinetic_friction(&self) -> f64 {
        self.form.kinetic_friction()
    }

    /// The maximum F_s/(N_c⟨k⟩) with its position X_s, both lengths; None if F only rises.
    #[getter]
    fn static_friction<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::StaticFriction<'py>>> {
        let peak = self.form.static_friction();
        peak.map(|(position, force)| crate::values::static_friction(py, force, position)).transpose()
    }

    /// K_c/(N_c⟨k⟩) = max(0, -min F'), a number; inf where F jumps down.
    #[getter]
    fn critical_stiffness(&self) -> f64 {
        self.form.critical_stiffness()
    }
}

/// Gaussian thresholds, and a Gaussian distribution of initial stretches: Fig. 2 of Braun and Peyrard (2008).
///
/// The distributions are not truncated at 0, unlike those of the solvers.
///
/// Parameters
/// ----------
/// mean, std
///     Of the thresholds, above 0.
/// initial_mean, initial_std
///     Of the stretches at X = 0, 0 or above.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> curve = asp.exact.Gaussian(mean=1.0, std=0.1)
/// >>> round(curve.kinetic_friction, 3)
/// 0.505
#[pyclass(frozen, extends = ClosedForm, name = "ExactGaussian", module = "asperity.exact")]
pub struct Gaussian(exact::Gaussian);

#[pymethods]
impl Gaussian {
    #[new]
    #[pyo3(signature = (mean, std, initial_mean = 0.0, initial_std = 0.0))]
    fn new(mean: Real, std: Real, initial_mean: f64, initial_std: f64) -> PyResult<PyClassInitializer<Self>> {
        let mean = mean.get("mean")?;
        let std = std.get("std")?;
        let form = exact::Gaussian { mean, std, initial_mean, initial_std };
        Ok(checked(form)?.add_subclass(Self(form)))
    }

    /// The variance of the stretch of one contact at X, a length²: the force of N_c independent contacts has the
    /// standard deviation N_c⟨k⟩√(variance/N_c).
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions X, 0 or above: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If position is neither a number nor an array of numbers.
    /// ValueError
    ///     For a position below 0 or beyond 1e5 mean thresholds.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn variance<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &Domain::positions(self.0.reach()), |x| self.0.variance(x))
    }

    /// The root s_j, j ≥ 1, of the relaxation spectrum, complex, per length: s_j = [x̄ - √(x̄² - 4πijσ²)]/σ².
    ///
    /// Parameters
    /// ----------
    /// j
    ///     The number of the root, 1 or above.
    ///
    /// Returns
    /// -------
    /// complex
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a j below 1.
    fn relaxation_root<'py>(&self, py: Python<'py>, j: Whole) -> PyResult<Bound<'py, PyComplex>> {
        let j = j.get("j")?;
        if j == 0 {
            return Err(error::invalid("j", "a whole number, 1 or above", j));
        }
        let root = self.0.relaxation_root(j);
        Ok(PyComplex::from_doubles(py, root.re, root.im))
    }

    /// X* = -1/Re s_1, a length.
    #[getter]
    fn relaxation_length(&self) -> f64 {
        self.0.relaxation_length()
    }

    fn __repr__(&self) -> String {
        let exact::Gaussian { mean, std, initial_mean, initial_std } = self.0;
        format!(
            "Gaussian(mean={mean:?}, std={std:?}, initial_mean={initial_mean:?}, initial_std={initial_std:?})"
        )
    }
}

/// Thresholds uniformly distributed from min, 0 or above, to max, above min.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> curve = asp.exact.Rectangular(min=0.5, max=1.5)
/// >>> round(curve.force(0.4), 3)
/// 0.4
#[pyclass(frozen, extends = ClosedForm, name = "ExactRectangular", module = "asperity.exact")]
pub struct Rectangular(exact::Rectangular);

#[pymethods]
impl Rectangular {
    #[new]
    fn new(min: Real, max: Real) -> PyResult<PyClassInitializer<Self>> {
        let min = min.get("min")?;
        let max = max.get("max")?;
        let form = exact::Rectangular { min, max };
        Ok(checked(form)?.add_subclass(Self(form)))
    }

    /// The period of stick-slip behind a spring, with slip="reset": X_u + F(X_u)/K, where the slope of F falls to -K at
    /// X_u = (max - min)(1 + K), or below it at once, at X_u = min.
    ///
    /// Parameters
    /// ----------
    /// stiffness
    ///     K, per total stiffness of the contacts, above 0.
    ///
    /// Returns
    /// -------
    /// float or None
    ///     The load-point displacement from slip to slip, a length; None where sliding is stable, for
    ///     K >= min/(max - min), and for max > 2 min.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a stiffness that is not above 0.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> round(asp.exact.Rectangular(0.7, 1.3).stick_slip_period(0.5), 6)
    /// 2.166667
    fn stick_slip_period(&self, stiffness: Real) -> PyResult<Option<f64>> {
        let stiffness = stiffness.get("stiffness")?;
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(error::invalid("stiffness", "a number above 0", stiffness));
        }
        Ok(self.0.stick_slip_period(stiffness))
    }

    fn __repr__(&self) -> String {
        format!("Rectangular(min={:?}, max={:?})", self.0.min, self.0.max)
    }
}

/// Thresholds of a gamma distribution of any shape: F = X - mean Σ P(n k + 1, X/θ), n = 1, 2, …, with the shape
/// k = (mean/std)², the scale θ = std²/mean and the regularised incomplete gamma function P.
///
/// Parameters
/// ----------
/// mean, std
///     Mean and standard deviation, above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> curve = asp.exact.Gamma(mean=1.0, std=0.5)
/// >>> round(curve.kinetic_friction, 3)
/// 0.625
#[pyclass(frozen, extends = ClosedForm, name = "ExactGamma", module = "asperity.exact")]
pub struct Gamma(exact::Gamma);

#[pymethods]
impl Gamma {
    #[new]
    fn new(mean: Real, std: Real) -> PyResult<PyClassInitializer<Self>> {
        let mean = mean.get("mean")?;
        let std = std.get("std")?;
        let form = exact::Gamma { mean, std };
        Ok(checked(form)?.add_subclass(Self(form)))
    }

    fn __repr__(&self) -> String {
        format!("Gamma(mean={:?}, std={:?})", self.0.mean, self.0.std)
    }
}

/// Erlang thresholds: sums of `shape` exponentially distributed lengths, each of mean 1/rate. shape 1 is the
/// exponential distribution.
///
/// Parameters
/// ----------
/// shape
///     A whole number, 1 or above.
/// rate
///     Per length, above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> curve = asp.exact.Erlang(shape=4, rate=4.0)
/// >>> round(curve.kinetic_friction, 3)
/// 0.625
#[pyclass(frozen, extends = ClosedForm, name = "ExactErlang", module = "asperity.exact")]
pub struct Erlang(exact::Erlang);

#[pymethods]
impl Erlang {
    #[new]
    fn new(shape: Whole, rate: Real) -> PyResult<PyClassInitializer<Self>> {
        let rate = rate.get("rate")?;
        let form = exact::Erlang { shape: shape.get("shape")?, rate };
        Ok(checked(form)?.add_subclass(Self(form)))
    }

    /// X*, a length: 1/[λ(1 - cos 2π/m)], but 1/λ for shapes m up to 4.
    #[getter]
    fn relaxation_length(&self) -> f64 {
        self.0.relaxation_length()
    }

    fn __repr__(&self) -> String {
        format!("Erlang(shape={}, rate={:?})", self.0.shape, self.0.rate)
    }
}

/// Identical thresholds: every stretch is (y + X) mod threshold for ever, with the initial stretch y, and there
/// is no relaxation.
///
/// Parameters
/// ----------
/// threshold
///     A length above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> asp.exact.Identical(1.0).force(0.75)
/// 0.75
#[pyclass(frozen, extends = ClosedForm, name = "ExactIdentical", module = "asperity.exact")]
pub struct Identical(exact::Identical);

#[pymethods]
impl Identical {
    #[new]
    fn new(threshold: Real) -> PyResult<PyClassInitializer<Self>> {
        let threshold = threshold.get("threshold")?;
        let form = exact::Identical { threshold };
        Ok(checked(form)?.add_subclass(Self(form)))
    }

    fn __repr__(&self) -> String {
        format!("Identical(threshold={:?})", self.0.threshold)
    }
}

/// Quenched thresholds of any distribution: each contact keeps its own for ever.
///
/// F(X)/(N_c⟨k⟩) = ∫P_c(ξ)(X mod ξ)dξ. The master equation describes annealed thresholds, so it does not apply.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> curve = asp.exact.Quenched(asp.Gaussian(1.0, 0.1))
/// >>> round(curve.kinetic_friction, 3)
/// 0.5
#[pyclass(frozen, name = "ExactQuenched", module = "asperity.exact")]
pub struct Quenched(exact::Quenched);

#[pymethods]
impl Quenched {
    #[new]
    fn new(thresholds: Argument<AnyLaw>) -> PyResult<Self> {
        let thresholds = thresholds.get("thresholds")?;
        Ok(Self(exact::Quenched { thresholds: built(thresholds)? }))
    }

    /// F(X)/(N_c⟨k⟩), a length; where contacts break simultaneously, after the break.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions X, 0 or above: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If position is neither a number nor an array of numbers.
    /// ValueError
    ///     For a position below 0 or beyond 1e4 mean thresholds.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn force<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &Domain::positions(self.0.reach()), |x| self.0.force(x))
    }

    /// F_k/(N_c⟨k⟩), a length: half the mean threshold.
    #[getter]
    fn kinetic_friction(&self) -> f64 {
        self.0.kinetic_friction()
    }

    /// X_d = x̄²/(√2 πσ), a length: narrow Gaussian thresholds get out of step as exp[-(X/X_d)²].
    #[getter]
    fn dephasing_length(&self) -> f64 {
        self.0.dephasing_length()
    }
}

/// A fraction of contacts that is too small to change any digit of a moment.
const NEGLIGIBLE: f64 = 1e-18;

/// Distributions of thresholds and of re-formed stretches.
fn laws(thresholds: AnyLaw, reforming: Option<AnyLaw>) -> PyResult<(SharedLaw, SharedLaw)> {
    let reforming = reforming.unwrap_or(AnyLaw(scenario::Law::zero()));
    Ok((built(thresholds)?, built(reforming)?))
}

/// F_k/(N_c⟨k⟩) = (⟨x_s²⟩ - ⟨r²⟩)/[2(⟨x_s⟩ - ⟨r⟩)], a length, if contacts re-form below all thresholds.
///
/// Parameters
/// ----------
/// thresholds
///     Their distribution P_c.
/// reforming
///     The distribution R of the stretches at which contacts re-form.
///
/// Returns
/// -------
/// float
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For reforming stretches that are not below all thresholds, and samples or a distribution of scipy.stats with
///     values below 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.exact.kinetic_friction(asp.Rectangular(0.8, 1.2), asp.Rectangular(0.0, 0.2)), 12)
/// 0.555555555556
#[pyfunction]
#[pyo3(signature = (thresholds, reforming = None))]
pub fn kinetic_friction(thresholds: Argument<AnyLaw>, reforming: Option<Argument<AnyLaw>>) -> PyResult<f64> {
    let thresholds = thresholds.get("thresholds")?;
    let reforming = reforming.get("reforming")?;
    let (thresholds, reforming) = laws(thresholds, reforming)?;
    let highest = reforming.upper_quantile(NEGLIGIBLE);
    if thresholds.cumulative(highest) > NEGLIGIBLE || thresholds.mean() <= highest {
        return Err(error::invalid(
            "reforming",
            "stretches below all thresholds",
            format!("some at {highest}"),
        ));
    }
    Ok(exact::kinetic_friction(thresholds.as_ref(), reforming.as_ref()))
}

/// F_k/(N_c κ) = ⟨x_s³⟩/(2⟨x_s⟩), a length², for stiffnesses k = κ x_s, if contacts re-form at 0.
///
/// Parameters
/// ----------
/// thresholds
///     Their distribution P_c.
///
/// Returns
/// -------
/// float
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For samples or a distribution of scipy.stats with values below 0, given as thresholds.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.exact.kinetic_friction_per_threshold(asp.Point(1.0)), 12)
/// 0.5
#[pyfunction]
pub fn kinetic_friction_per_threshold(thresholds: Argument<AnyLaw>) -> PyResult<f64> {
    let thresholds = thresholds.get("thresholds")?;
    Ok(exact::kinetic_friction_per_threshold(built(thresholds)?.as_ref()))
}

/// N Var(F/(N_c⟨k⟩)) = ⟨x_s³⟩/(3⟨x_s⟩) - F_k², a length², in steady sliding if contacts re-form at 0.
///
/// Parameters
/// ----------
/// thresholds
///     Their distribution P_c.
///
/// Returns
/// -------
/// float
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For samples or a distribution of scipy.stats with values below 0, given as thresholds.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.exact.steady_variance(asp.Point(1.0)), 12)
/// 0.083333333333
#[pyfunction]
pub fn steady_variance(thresholds: Argument<AnyLaw>) -> PyResult<f64> {
    let thresholds = thresholds.get("thresholds")?;
    Ok(exact::steady_variance(built(thresholds)?.as_ref()))
}

/// The same for stiffnesses k = κ x_s: N Var(F/(N_c κ)) = ⟨x_s⁵⟩/(3⟨x_s⟩) - F_k², a length⁴.
///
/// Parameters
/// ----------
/// thresholds
///     Their distribution P_c.
///
/// Returns
/// -------
/// float
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For samples or a distribution of scipy.stats with values below 0, given as thresholds.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.exact.steady_variance_per_threshold(asp.Point(1.0)), 12)
/// 0.083333333333
#[pyfunction]
pub fn steady_variance_per_threshold(thresholds: Argument<AnyLaw>) -> PyResult<f64> {
    let thresholds = thresholds.get("thresholds")?;
    Ok(exact::steady_variance_per_threshold(built(thresholds)?.as_ref()))
}

/// Gives classes their names in `asperity.exact`, `Gaussian` for `ExactGaussian`: in the module that holds all classes, distributions
/// have these names.
pub fn name_classes(py: Python<'_>) -> PyResult<()> {
    let families = [py.get_type::<Gaussian>(), py.get_type::<Rectangular>(), py.get_type::<Erlang>()];
    let others = [py.get_type::<Gamma>(), py.get_type::<Identical>(), py.get_type::<Quenched>()];
    for class in families.iter().chain(&others) {
        let name = class.name()?.to_string();
        let name = name.trim_start_matches("Exact");
        class.setattr("__name__", name)?;
        class.setattr("__qualname__", name)?;
    }
    Ok(())
}
