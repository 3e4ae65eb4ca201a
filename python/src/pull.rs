//! The result of a pull of the slider's base.

use std::sync::OnceLock;

use asperity::Error;
use asperity::master::{self, Covariance};
use asperity::monitor::{Monitor, Part};
use asperity::record;
use asperity::scenario::{self, Units};
use asperity::task;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::convert::{self, Domain, Seed, evaluate};
use crate::gradient::{FrictionGradient, Gradient, Source, ThresholdResponse};
use crate::model::Model;
use crate::pickle::{self, Reduced};
use crate::record::Record;
use crate::solver::{EquationSolver, Solver};
use crate::watch::{detached, watched};
use crate::{error, typed, values};

/// A pull: the slider's base is displaced from X = 0, by the master equation. Forces are total forces of all
/// N_c contacts.
///
/// Called with positions it is F(X): `pull(5.0)`, `pull([1.0, 2.0])`.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(distance=5.0, points=51)
/// >>> pull.force.shape, round(pull.kinetic_friction, 3)
/// ((51,), 0.505)
#[pyclass(frozen, extends = Record, module = "asperity")]
pub struct Pull {
    /// That of the master equation.
    equation: Py<Model>,
    distance: f64,
    /// A pull that was pickled is solved again once its record is not enough.
    pull: OnceLock<master::Pull>,
}

impl Pull {
    /// Computes a pull and returns its result.
    pub fn object(
        equation: Bound<'_, Model>,
        distance: f64,
        points: usize,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Self>> {
        let py = equation.py();
        let asked = scenario::Pull { distance, points, ..scenario::Pull::default() };
        asked.check().map_err(|e| error::core(e.under("pull")))?;
        let EquationSolver { equation: solver, tolerance, .. } = equation.get().equation();
        let (pull, record) = watched(progress, py, |monitor| {
            let pull = solver.pull_with(distance, *tolerance, monitor)?;
            let record = recorded(&pull, asked.positions(), monitor)?;
            Ok((pull, record))
        })?;
        let record = Record::new(py, record, Units::default())?;
        Py::new(py, record.add_subclass(Self::solved(equation, pull)))
    }

    /// A pull that was computed, with the default number of positions.
    pub fn computed(equation: Bound<'_, Model>, pull: master::Pull) -> PyResult<Py<Self>> {
        let py = equation.py();
        let asked = scenario::Pull { distance: pull.distance(), ..scenario::Pull::default() };
        let record = watched(None, py, |monitor| recorded(&pull, asked.positions(), monitor))?;
        let record = Record::new(py, record, Units::default())?;
        Py::new(py, record.add_subclass(Self::solved(equation, pull)))
    }

    fn solved(equation: Bound<'_, Model>, pull: master::Pull) -> Self {
        Self { equation: equation.unbind(), distance: pull.distance(), pull: OnceLock::from(pull) }
    }

    /// The pull of a pickle: its record, its distance and its equation.
    pub fn restored(py: Python<'_>, bytes: &[u8], model: Option<Bound<'_, PyAny>>) -> PyResult<Py<PyAny>> {
        let equation = pickle::of_model(model, |model: &Bound<'_, Model>| {
            matches!(model.get().solver(), Solver::MasterEquation(_))
        })?
        .unbind();
        let (distance, record) = Record::unpacked(py, bytes)?;
        let pull = Self { equation, distance, pull: OnceLock::new() };
        Ok(Py::new(py, record.add_subclass(pull))?.into_any())
    }

    /// The solution.
    fn solution(&self, py: Python<'_>) -> PyResult<&master::Pull> {
        if let Some(known) = self.pull.get() {
            return Ok(known);
        }
        let EquationSolver { equation, tolerance, .. } = self.equation.get().equation();
        let pull = watched(None, py, |monitor| equation.pull_with(self.distance, *tolerance, monitor))?;
        Ok(self.pull.get_or_init(|| pull))
    }

    fn positions(&self) -> Domain {
        Domain::positions(self.distance)
    }

    /// This pull, for what is computed on it.
    fn source(slf: &Bound<'_, Self>) -> Source {
        Source { pull: slf.as_super().clone().unbind(), distance: slf.get().distance }
    }

    fn covariance_at(
        &self,
        py: Python<'_>,
        at: &Bound<'_, PyAny>,
        size: Option<f64>,
    ) -> PyResult<Covariance> {
        let at = convert::list_within("at", at, &self.positions())?;
        let count = self.equation.get().equation().equation.contacts().count;
        let size = size.map_or(Ok(count), |size| convert::contacts("size", size))?;
        let pull = self.solution(py)?;
        watched(None, py, |monitor| pull.covariance_with(&at, size, monitor))
    }

    /// Evenly spaced positions, shape (m,), and sample paths there, shape (n, m).
    fn paths<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        size: f64,
        seed: Option<Seed>,
    ) -> PyResult<[Bound<'py, PyAny>; 2]> {
        /// As many as a figure shows.
        const POSITIONS: usize = 501;
        let missing = || Error::invalid("seed", "a seed for the sample paths", "none");
        let seed = seed.ok_or_else(missing).map_err(error::core)?;
        let asked =
            scenario::Pull { distance: self.distance, points: POSITIONS, ..scenario::Pull::default() };
        let (at, pull) = (asked.positions(), self.solution(py)?);
        let paths = watched(None, py, |monitor| {
            let part = &mut Part::new(monitor, 0.0, 0.5);
            let covariance = pull.covariance_with(&at, size, part)?;
            covariance.sample_paths_with(count, seed.0, &mut Part::new(monitor, 0.5, 0.5))
        })?;
        Ok([convert::array(py, &[POSITIONS], at)?, convert::array(py, &[count, POSITIONS], paths.concat())?])
    }
}

/// Force and breaking rate at positions.
fn recorded(
    pull: &master::Pull,
    positions: Vec<f64>,
    monitor: &mut dyn Monitor,
) -> asperity::Result<record::Record> {
    let mut record = record::Record::default();
    task::record_pull(pull, positions, None, &mut record, monitor)?;
    Ok(record)
}

#[pymethods]
impl Pull {
    /// The master equation that was solved.
    #[getter]
    fn equation<'py>(&self, py: Python<'py>) -> typed::MasterEquation<'py> {
        typed::MasterEquation(self.equation.bind(py).clone().into_any())
    }

    /// The fraction of contacts breaking per length at the positions, shape (points,), without simultaneous breaks.
    #[getter]
    fn breaking_rate<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::Array<'py>> {
        slf.get_item("breaking_rate").map(typed::Array)
    }

    /// Positions at which contacts break simultaneously, and the fractions that do, each of shape (n,).
    #[getter]
    fn breaking_atoms<'py>(&self, py: Python<'py>) -> PyResult<typed::Atoms<'py>> {
        values::atoms(py, self.solution(py)?.breaking_atoms())
    }

    /// The distance of the pull, a length.
    #[getter]
    fn distance(&self) -> f64 {
        self.distance
    }

    /// The static friction F_s, the highest force of the pull, with its position X_s; None if the force still rises
    /// at the end, or never decreases.
    #[getter]
    fn static_friction<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::StaticFriction<'py>>> {
        let pull = self.solution(py)?;
        let peak = detached(py, || pull.static_friction());
        peak.map(|peak| values::static_friction(py, peak.value, peak.position)).transpose()
    }

    /// The kinetic friction F_k, the force of steady sliding.
    #[getter]
    fn kinetic_friction(&self) -> f64 {
        self.equation.get().equation().equation.steady_state().kinetic_friction()
    }

    /// The critical stiffness K_c = max(0, -min F'), force per length: a softer slider sticks and slips. It is inf
    /// where the force jumps down, and 0 if the force decreases by no more than ten times the tolerance.
    #[getter]
    fn critical_stiffness(&self, py: Python<'_>) -> PyResult<f64> {
        let pull = self.solution(py)?;
        Ok(detached(py, || pull.critical_stiffness()))
    }

    /// The relaxation length X*, over which the initial state is forgotten; inf if it does not settle exponentially, nan if
    /// no root is found.
    #[getter]
    fn relaxation_length(&self, py: Python<'_>) -> PyResult<f64> {
        let relaxation =
            watched(None, py, |monitor| self.equation.get().equation().equation.relaxation_with(monitor))?;
        Ok(relaxation.length())
    }

    /// The estimated error of F/(N_c⟨k⟩), a length.
    #[getter]
    fn accuracy(&self, py: Python<'_>) -> PyResult<f64> {
        let pull = self.solution(py)?;
        Ok(detached(py, || pull.error_estimate()))
    }

    /// F(X), for positions from 0 to the distance.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions from 0 to the distance: a number or an array of any shape.
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
    ///     For a position below 0 or beyond the distance.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn force_at<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let pull = self.solution(position.py())?;
        evaluate("position", position, &self.positions(), |x| pull.force(x))
    }

    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn __call__<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.force_at(position)
    }

    /// dF/dX from the right, force per length, for positions from 0 to the distance.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions from 0 to the distance: a number or an array of any shape.
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
    ///     For a position below 0 or beyond the distance.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn slope_at<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let pull = self.solution(position.py())?;
        evaluate("position", position, &self.positions(), |x| pull.slope(x))
    }

    /// The fraction of contacts breaking per length, for positions from 0 to the distance.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions from 0 to the distance: a number or an array of any shape.
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
    ///     For a position below 0 or beyond the distance.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn breaking_rate_at<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let pull = self.solution(position.py())?;
        evaluate("position", position, &self.positions(), |x| pull.breaking_rate(x))
    }

    /// The standard deviation of the force of `size` random contacts, scaled to N_c.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     Positions from 0 to the distance, or None for those of `position`. Contacts under a rigid drive are
    ///     independent, so the result is exact.
    /// size
    ///     The number of contacts; None for the N_c of the contacts.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a size that is not above 0, and positions in at below 0 or beyond the distance.
    #[pyo3(signature = (size, at: "float; ArrayLike | None" = None) -> "float; _Array")]
    fn force_std<'py>(
        slf: &Bound<'py, Self>,
        size: Real,
        at: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let size = size.get("size")?;
        let size = convert::contacts("size", size)?;
        let at = at.cloned().map_or_else(|| slf.get_item("position"), Ok)?;
        let pull = slf.get().solution(slf.py())?;
        let std = watched(None, slf.py(), |monitor| pull.force_std_with(size, monitor))?;
        evaluate("at", &at, &slf.get().positions(), std)
    }

    /// The covariance of the force of `size` random contacts, scaled to N_c, at m positions from 0 to the distance.
    ///
    /// Contacts under a rigid drive are independent, so the result is exact: a symmetric array of shape (m, m), in
    /// units of force². Contacts with a delay, or whose stiffness depends on the threshold, are refused.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     A list of m positions.
    /// size
    ///     The number of contacts, or None for the N_c of the contacts.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For positions in at below 0 or beyond the distance, a size that is not above 0, and contacts that are
    ///     refused.
    #[pyo3(signature = (at: "ArrayLike", size = None))]
    fn covariance<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        size: Option<Real>,
    ) -> PyResult<typed::Array<'py>> {
        let size = size.get("size")?;
        let found = self.covariance_at(py, at, size)?;
        let (count, values) = (found.positions().len(), found.values().to_vec());
        convert::array(py, &[count, count], values).map(typed::Array)
    }

    /// Sample paths of the force of `size` random contacts, scaled to N_c, at m positions from 0 to the distance.
    ///
    /// The paths are those of a Gaussian process with the exact mean and covariance: an array of shape (n, m). They
    /// cost the same for any number of contacts. The force of few contacts is not Gaussian: use an Ensemble there.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     A list of m positions.
    /// count
    ///     The number n of paths.
    /// size
    ///     The number of contacts, or None for the N_c of the contacts.
    /// seed
    ///     A whole number below 2^63, which always gives the same paths, or a numpy.random.Generator, from which one
    ///     such number is drawn.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For positions in at below 0 or beyond the distance, a count below 0, a size that is not above 0, a seed
    ///     that is not below 2^63, and contacts with a delay, or whose stiffness depends on the threshold.
    #[pyo3(signature = (at: "ArrayLike", count, size = None, *, seed))]
    fn sample_paths<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        count: Whole,
        size: Option<Real>,
        seed: Seed,
    ) -> PyResult<typed::Array<'py>> {
        let size = size.get("size")?;
        let count: usize = count.get("count")?;
        let found = self.covariance_at(py, at, size)?;
        let paths = watched(None, py, |monitor| found.sample_paths_with(count, seed.0, monitor))?;
        convert::array(py, &[count, found.positions().len()], paths.concat()).map(typed::Array)
    }

    /// Plots F(X) with the static and the kinetic friction, and on request the scatter of the force of `size` random
    /// contacts. Returns the axes. It needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes to plot on; new ones if None. Other arguments are passed to its plot().
    /// kind
    ///     "force", the only one of `pictures`.
    /// size
    ///     The number of contacts for a band of one standard deviation to either side; None for no band, or with
    ///     `paths` for the N_c of the contacts.
    /// paths
    ///     The number of sample paths.
    /// seed
    ///     As for `sample_paths`; required with `paths`.
    /// **style
    ///     Arguments of the plot() of the curve.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(
        signature = (
            ax: "Axes | None" = None, *, kind: "str | None" = None, size = None, paths = Whole::new(0), seed = None,
            **style: "Any"
        ) -> "Axes",
        text_signature = "($self, ax=None, *, kind=None, size=None, paths=0, seed=None, **style)"
    )]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        kind: Option<Argument<String>>,
        size: Option<Real>,
        paths: Whole,
        seed: Option<Seed>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let kind = kind.get("kind")?;
        let kind = kind.as_deref();
        let size = size.get("size")?;
        let py = slf.py();
        if let Some(kind) = kind.filter(|&kind| kind != "force") {
            return Err(error::invalid("plot.kind", "force", kind));
        }
        let paths: usize = paths.get("paths")?;
        let asked = size.map(|size| convert::contacts("size", size)).transpose()?;
        let size = asked.unwrap_or_else(|| slf.get().equation.get().equation().equation.contacts().count);
        let paths = (paths > 0).then(|| slf.get().paths(py, paths, size, seed)).transpose()?;
        let scatter = match (&paths, asked) {
            (None, None) => None,
            _ => Some(Self::force_std(slf, Real::new(size), None)?),
        };
        py.import("asperity._plot")?.call_method("pull", (slf, ax, scatter, paths), style)
    }

    /// The parameters by which the force has a derivative, with their values.
    ///
    /// They are those of the distributions (`thresholds.mean`, `reforming.std`, `initial.max`, `ageing.mature.mean`),
    /// `count`, `stiffness` or `stiffness_per_threshold`, and those of time-dependent contacts: `temperature.energy`,
    /// `temperature.attempt_rate`, `ageing.growth`, `ageing.time`, `ageing.diffusion`, `delay` and `velocity`.
    ///
    /// Returns
    /// -------
    /// dict[str, float]
    #[pyo3(signature = () -> "dict[str, float]")]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for parameter in self.solution(py)?.parameters() {
            parameters.set_item(parameter.name.as_ref(), parameter.value)?;
        }
        Ok(parameters)
    }

    /// The derivative of the force by one of `parameters()`, as a function of the position.
    ///
    /// Parameters
    /// ----------
    /// parameter
    ///     `thresholds.mean`, `reforming.std`, `stiffness`, `temperature.energy`, and so on. The position of a point
    ///     mass has no derivative.
    ///
    /// Returns
    /// -------
    /// Gradient
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a parameter that is none of `parameters()`, and one by which the force has no derivative.
    fn gradient(slf: &Bound<'_, Self>, parameter: Argument<String>) -> PyResult<Gradient> {
        let parameter = parameter.get("parameter")?;
        let (py, pull) = (slf.py(), slf.get().solution(slf.py())?);
        let gradient = watched(None, py, |monitor| pull.gradient_with(&parameter, monitor))?;
        Ok(Gradient::new(gradient, parameter, Self::source(slf)))
    }

    /// The derivatives of the force by several of `parameters()`, at little more than half the cost of one after the
    /// other.
    ///
    /// Parameters
    /// ----------
    /// parameters
    ///     A list of names, as for `gradient`.
    ///
    /// Returns
    /// -------
    /// list[Gradient]
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a name that is none of `parameters()`, and one by which the force has no derivative.
    fn gradients(slf: &Bound<'_, Self>, parameters: Argument<Vec<String>>) -> PyResult<Vec<Gradient>> {
        let parameters = parameters.get("parameters")?;
        let (py, pull) = (slf.py(), slf.get().solution(slf.py())?);
        let names: Vec<&str> = parameters.iter().map(String::as_str).collect();
        let gradients = watched(None, py, |monitor| pull.gradients_with(&names, monitor))?;
        let named = gradients.into_iter().zip(parameters);
        Ok(named.map(|(gradient, parameter)| Gradient::new(gradient, parameter, Self::source(slf))).collect())
    }

    /// The derivatives of F_s, F_k, X* and K_c by one of `parameters()`, for the propagation of errors.
    ///
    /// Parameters
    /// ----------
    /// parameter
    ///     As in `gradient`.
    ///
    /// Returns
    /// -------
    /// FrictionGradient
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a parameter that is none of `parameters()`, and one by which friction has no derivative.
    fn friction_gradient(&self, py: Python<'_>, parameter: Argument<String>) -> PyResult<FrictionGradient> {
        let parameter = parameter.get("parameter")?;
        let pull = self.solution(py)?;
        let gradient = watched(None, py, |monitor| pull.friction_gradient_with(&parameter, monitor))?;
        Ok(FrictionGradient::new(gradient))
    }

    /// The derivatives of F_s, F_k, X* and K_c by several of `parameters()`, with one computation.
    ///
    /// Parameters
    /// ----------
    /// parameters
    ///     A list of names, as for `gradient`.
    ///
    /// Returns
    /// -------
    /// list[FrictionGradient]
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a name that is none of `parameters()`, and one by which friction has no derivative.
    fn friction_gradients(
        &self,
        py: Python<'_>,
        parameters: Argument<Vec<String>>,
    ) -> PyResult<Vec<FrictionGradient>> {
        let parameters = parameters.get("parameters")?;
        let names: Vec<&str> = parameters.iter().map(String::as_str).collect();
        let pull = self.solution(py)?;
        let gradients = watched(None, py, |monitor| pull.friction_gradients_with(&names, monitor))?;
        Ok(gradients.into_iter().map(FrictionGradient::new).collect())
    }

    /// The response of the force to the probability of single thresholds, as a function of the position.
    ///
    /// It is the derivative of F for thresholds drawn from (1 - ε) P_c + ε δ(x_s - ξ) by ε at 0. A change of P_c that
    /// keeps its total changes the force by the integral of the response times this change. Contacts with temperature,
    /// ageing or a delay, or whose stiffness depends on the threshold, are refused.
    ///
    /// Parameters
    /// ----------
    /// thresholds
    ///     A list of n thresholds, lengths of 0 or above.
    ///
    /// Returns
    /// -------
    /// ThresholdResponse
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For thresholds below 0, and contacts that are refused.
    #[pyo3(signature = (thresholds: "ArrayLike"))]
    fn threshold_response(
        slf: &Bound<'_, Self>,
        thresholds: &Bound<'_, PyAny>,
    ) -> PyResult<ThresholdResponse> {
        let thresholds = convert::list("thresholds", thresholds)?;
        let pull = slf.get().solution(slf.py())?;
        let response = watched(None, slf.py(), |monitor| pull.threshold_response_with(&thresholds, monitor))?;
        Ok(ThresholdResponse::new(response, Self::source(slf)))
    }

    /// The distribution Q(x; X) of stretches x, per length, at positions X from 0 to the distance.
    ///
    /// The result has `stretch` of shape (n,); `density` of shape (n,) or (m, n); and `atoms`, the point masses at
    /// the position, or a list of them for a list of positions.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     A position, or a list of m of them.
    /// stretches
    ///     A list of n stretches, or None for an automatic choice that resolves the distributions.
    ///
    /// Returns
    /// -------
    /// StretchDensity
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For positions in at below 0 or beyond the distance, and stretches below 0.
    #[pyo3(signature = (at: "ArrayLike", stretches: "ArrayLike | None" = None))]
    fn stretch_density<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        stretches: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<typed::StretchDensity<'py>> {
        let (positions, single) = convert::one_or_list("at", at, &self.positions())?;
        let stretches = self.equation.get().equation().stretches(stretches, &positions)?;
        let pull = self.solution(py)?;
        let mut found = Vec::with_capacity(positions.len());
        for &position in &positions {
            let at = |monitor: &mut dyn Monitor| pull.stretch_density_with(position, &stretches, monitor);
            found.push(watched(None, py, at)?);
        }
        match found.pop() {
            Some(only) if single => values::stretches(py, stretches, only),
            last => values::evolution(py, stretches, found.into_iter().chain(last).collect(), positions),
        }
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, Self { equation, distance, .. }) = (slf.py(), slf.get());
        let bytes = slf.as_super().get().packed(py, distance)?;
        pickle::reduced(py, "Pull", &bytes, Some(equation.bind(py).clone().into_any()))
    }
}
