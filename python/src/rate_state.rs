//! Rate-and-state parameters of measured velocity steps and of slide–hold–slide tests.

use asperity::rate_state::{MeasuredHealing, MeasuredVelocityStep, StepReading};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::convert::{self, Domain, evaluate};
use crate::pickle::{self, Reduced};
use crate::watch::watched;
use crate::{typed, values};

/// The noise of a measured curve.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum NoiseWord {
    Drift,
    White,
}

/// A measured velocity step: its rate-and-state parameters, each an Estimate with its value, its standard error and its
/// 95 % interval. Made by read_velocity_step.
///
/// Called with positions relative to the step it is the fitted force.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> import numpy as np
/// >>> x = np.linspace(-5.0, 10.0, 301)
/// >>> force = 0.6 + np.where(x < 0.0, 0.0, 0.01 - 0.02 * (1.0 - np.exp(-x)))
/// >>> step = asp.read_velocity_step(x, force, 10.0)
/// >>> round(step.distance.value, 2)
/// 1.0
#[pyclass(frozen, module = "asperity")]
pub struct VelocityStep {
    read: MeasuredVelocityStep,
}

#[pymethods]
impl VelocityStep {
    /// The direct effect a for the position of the peak, a force per ln(v/v_0).
    #[getter]
    fn a<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.direct)
    }

    /// The evolution effect b for the position of the peak, a force per ln(v/v_0).
    #[getter]
    fn b<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.evolution)
    }

    /// a - b, the change of the steady force per ln(v/v_0). It does not depend on the position of the peak.
    #[getter]
    fn a_minus_b<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.steady)
    }

    /// The characteristic slip distance D_c, a length; the interval ends at inf if the curve gives no upper limit.
    #[getter]
    fn distance<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.distance)
    }

    /// The force F_0 before the step; its error is 0 if it was given.
    #[getter]
    fn before<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.before)
    }

    /// The slope of the force, a force per length; None without trend.
    #[getter]
    fn trend<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::Estimate<'py>>> {
        self.read.trend.map(|trend| values::estimate(py, trend)).transpose()
    }

    /// The position X_p relative to the step from which on the force relaxes, a length.
    #[getter]
    fn peak(&self) -> f64 {
        self.read.peak
    }

    /// v/v_0.
    #[getter]
    fn ratio(&self) -> f64 {
        self.read.ratio
    }

    /// The root-mean-square residual of the fit, a force.
    #[getter]
    fn residual(&self) -> f64 {
        self.read.residual
    }

    /// The noise that the errors follow from, estimated from the residuals.
    #[getter]
    fn noise<'py>(&self, py: Python<'py>) -> PyResult<typed::MeasuredNoise<'py>> {
        values::measured_noise(py, &self.read.noise)
    }

    /// The probability that white noise has correlations as large as those of the whitened residuals
    /// (Ljung-Box test); None if there are none. Where it is far below 0.01 the noise is not of this kind,
    /// and the errors are not reliable.
    #[getter]
    fn whiteness(&self) -> Option<f64> {
        self.read.whiteness
    }

    /// Sentences about numbers that are not to be trusted; empty if there is nothing to say.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.read.warnings()
    }

    /// The positions that were fitted, relative to the step, shape (n,), a length.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.read.position.clone()).map(typed::Array)
    }

    /// The measured forces there, shape (n,).
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.read.force.clone()).map(typed::Array)
    }

    /// The positions that were not fitted, shape (m,), a length: between the step and the peak, and before the step where
    /// the force there was given.
    #[getter]
    fn unused_position<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.read.unused_position.clone()).map(typed::Array)
    }

    /// The measured forces there, shape (m,).
    #[getter]
    fn unused_force<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.read.unused_force.clone()).map(typed::Array)
    }

    /// The fitted forces at the positions that were fitted, shape (n,).
    #[getter]
    fn fitted<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        let fitted = self.read.position.iter().map(|x| self.read.force_at(*x)).collect();
        convert::row(py, fitted).map(typed::Array)
    }

    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn __call__<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &Domain::NUMBERS, |x| self.read.force_at(x))
    }

    /// Plots the measured force as dots and the fit as a line. Returns the axes. It needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes to plot on; new ones if None. Other arguments are passed to the plot() of the fit.
    /// **style
    ///     Arguments of the plot() of the fit.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
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
        slf.py().import("asperity._plot")?.call_method("velocity_step", (slf, ax), style)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("velocity_step", (slf,))?.extract()
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        pickle::reduced(py, "VelocityStep", &pickle::pack(&self.read, &[])?, None)
    }
}

impl VelocityStep {
    /// The step of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let (read, _) = pickle::unpack(bytes)?;
        Ok(Py::new(py, Self { read })?.into_any())
    }
}

/// Reads the rate-and-state parameters of a measured velocity step.
///
/// F(X) = F_0 + ln(v/v_0) [a - b (1 - exp(-(X - X_p)/D_c))] from X_p on, and F_0 before the step, by generalised least
/// squares. The covariance of the noise, white noise plus drift, is estimated from the residuals by restricted
/// likelihood, and the errors contain the uncertainty of the correlation length of the drift. The stiffness of the
/// machine is not modelled: a and b hold for the position X_p of the peak.
///
/// Parameters
/// ----------
/// position
///     Rising positions relative to the step, a length; those below 0 give F_0.
/// force
///     The forces there.
/// ratio
///     v/v_0, above 0 and not 1.
/// before
///     F_0, if it is known; the points before the step are then not used.
/// peak
///     X_p; by default the extremum of the force after the step, averaged over five points, or where the force first
///     comes as near to its level in the last quarter as twice its scatter there, if no extremum stands out by six
///     times the scatter; the step itself if the force only rises. Points between the step and X_p are left out.
/// trend
///     Whether the force also has a constant slope.
/// noise
///     "drift" for white noise plus drift, "white" for white noise alone, whose errors are too small where there is
///     drift.
/// average
///     The number of successive points that are averaged first, needed where positions do not rise.
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// VelocityStep
///
/// Raises
/// ------
/// ValueError
///     For a ratio that is not above 0 or is 1, lists of different lengths or with numbers that are not finite,
///     positions that do not rise, fewer than 4 points before the step without before, or 8 from the peak on, a peak
///     below 0, another word as noise, an average of 0, and forces from which the parameters do not follow.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> position = np.concatenate([np.linspace(-1, 0, 11), np.linspace(0.1, 4, 40)])
/// >>> force = np.where(position < 0, 1, 1 + 0.02 * np.exp(-position)) + 1e-4 * np.sin(37 * position)
/// >>> found = asp.read_velocity_step(position, force, 10.0, noise='white')
/// >>> round(found.distance.value, 1)
/// 1.0
#[pyfunction]
#[pyo3(signature = (
    position: "ArrayLike", force: "ArrayLike", ratio, *, before = None, peak = None, trend = Argument::new(false),
    noise: "Literal['drift', 'white']" = Argument::text("drift"), average = Whole::new(1), progress: "_Progress" = None
), text_signature = "(position, force, ratio, *, before=None, peak=None, trend=False, noise='drift', average=1, progress=None)")]
#[expect(clippy::too_many_arguments)]
pub fn read_velocity_step(
    py: Python<'_>,
    position: &Bound<'_, PyAny>,
    force: &Bound<'_, PyAny>,
    ratio: Real,
    before: Option<Real>,
    peak: Option<Real>,
    trend: Argument<bool>,
    noise: Argument<String>,
    average: Whole,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<VelocityStep> {
    let ratio = ratio.get("ratio")?;
    let before = before.get("before")?;
    let peak = peak.get("peak")?;
    let trend = trend.get("trend")?;
    let noise = noise.get("noise")?;
    let (position, force) = (convert::list("position", position)?, convert::list("force", force)?);
    let drift = matches!(convert::word("noise", &noise)?, NoiseWord::Drift);
    let reading = StepReading { before, peak, trend, drift, average: average.get("average")? };
    let read = watched(progress, py, |monitor| {
        MeasuredVelocityStep::read(&position, &force, ratio, &reading, monitor)
    })?;
    Ok(VelocityStep { read })
}

/// Measured healing: its parameters, each an Estimate with its value, its standard error and its 95 % interval. Made by
/// read_healing.
///
/// Called with hold times it is the fitted static friction.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> import numpy as np
/// >>> hold = np.array([1.0, 10.0, 100.0, 1000.0])
/// >>> healing = asp.read_healing(hold, 0.6 + 0.01 * np.log1p(hold))
/// >>> round(float(healing(100.0)), 3)
/// 0.646
#[pyclass(frozen, module = "asperity")]
pub struct Healing {
    read: MeasuredHealing,
    hold: Vec<f64>,
    force: Vec<f64>,
}

#[pymethods]
impl Healing {
    /// The healing per factor of ten in hold time, β ln 10, a force.
    #[getter]
    fn per_decade<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.per_decade)
    }

    /// The cutoff time t_c; None if all holds are much longer. The interval ends at inf if the holds give no
    /// upper limit.
    #[getter]
    fn cutoff<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::Estimate<'py>>> {
        self.read.cutoff.map(|cutoff| values::estimate(py, cutoff)).transpose()
    }

    /// The static friction after a hold of 1, a force.
    #[getter]
    fn at_one<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimate<'py>> {
        values::estimate(py, self.read.at_one)
    }

    /// The root-mean-square residual of the fit, a force.
    #[getter]
    fn residual(&self) -> f64 {
        self.read.residual
    }

    /// Sentences about numbers that do not mean what they seem to; empty if there is nothing to say.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.read.warnings()
    }

    /// The hold times, shape (n,), a time.
    #[getter]
    fn hold<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.hold.clone()).map(typed::Array)
    }

    /// The static friction after them, shape (n,), a force.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.force.clone()).map(typed::Array)
    }

    /// The fitted static friction after them, shape (n,), a force.
    #[getter]
    fn fitted<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.hold.iter().map(|t| self.read.force_at(*t)).collect()).map(typed::Array)
    }

    #[pyo3(signature = (hold: "float; ArrayLike") -> "float; _Array")]
    fn __call__<'py>(&self, hold: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let times = Domain { low: 0.0, high: f64::MAX, what: "a hold time" };
        evaluate("hold", hold, &times, |t| self.read.force_at(t))
    }

    /// Plots static friction against the logarithm of the hold time: measured values as dots, the fit as a
    /// line. Returns the axes. It needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes to plot on; new ones if None. Other arguments are passed to the plot() of the fit.
    /// **style
    ///     Arguments of the plot() of the fit.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
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
        slf.py().import("asperity._plot")?.call_method("healing", (slf, ax), style)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("healing", (slf,))?.extract()
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let Self { read, hold, force } = self;
        pickle::reduced(py, "Healing", &pickle::pack(&(read, hold, force), &[])?, None)
    }
}

impl Healing {
    /// The healing of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let ((read, hold, force), _) = pickle::unpack(bytes)?;
        Ok(Py::new(py, Self { read, hold, force })?.into_any())
    }
}

/// Reads healing from measured slide-hold-slide tests: F_s(t) = F_s(0) + β ln(1 + t/t_c), by least squares.
///
/// The scatter of the forces is taken as independent and of the same size for all holds, and is estimated from the
/// residuals. With few holds Student's distribution makes the intervals wider.
///
/// Parameters
/// ----------
/// hold
///     Hold times, a list of at least 4 numbers above 0.
/// force
///     The static friction after each: the highest force, or its difference from steady sliding.
///
/// Returns
/// -------
/// Healing
///
/// Raises
/// ------
/// ValueError
///     For fewer than 4 holds or 3 different ones, holds that are not above 0, another number of forces than of holds,
///     forces that are not finite or all the same, and forces that grow in proportion to the hold time, or not beyond their
///     scatter.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> hold = np.array([1.0, 3.0, 10.0, 30.0, 100.0])
/// >>> force = 1 + 0.01 * np.log1p(hold) + 1e-4 * np.sin(hold)
/// >>> round(asp.read_healing(hold, force).per_decade.value, 3)
/// 0.023
#[pyfunction]
#[pyo3(signature = (hold: "ArrayLike", force: "ArrayLike"))]
pub fn read_healing(py: Python<'_>, hold: &Bound<'_, PyAny>, force: &Bound<'_, PyAny>) -> PyResult<Healing> {
    let (hold, force) = (convert::list("hold", hold)?, convert::list("force", force)?);
    let read = watched(None, py, |monitor| MeasuredHealing::read_with(&hold, &force, monitor))?;
    Ok(Healing { read, hold, force })
}
