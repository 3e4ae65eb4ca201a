//! The master equation, and the quantities that need no pull.

use asperity::master::{self, Tolerance};
use asperity::monitor::Monitor;
use asperity::scenario;
use numpy::ToPyArray as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::convert::{self, Domain, evaluate, evaluate_all};
use crate::law::AnyLaw;
use crate::model::{Model, steady_interface};
use crate::pickle::{Reduced, again};
use crate::plain::{Interface, Plain, Solved};
use crate::pull::Pull;
use crate::simulation::Simulation;
use crate::solver::{EquationSolver, Solver};
use crate::watch::watched;
use crate::{error, typed, values};

/// The master equation of contacts and their initial state.
///
/// ∂Q/∂x + ∂Q/∂X + P(x) Q = R(x) ∫P(ξ) Q(ξ; X) dξ for the distribution Q(x; X) of stretches x, with the hazard
/// P of the thresholds and the distribution R of re-formed stretches (O. M. Braun and M. Peyrard, Phys. Rev.
/// Lett. 100, 125501 (2008), Eq. 5), solved as a renewal equation.
///
/// Parameters
/// ----------
/// contacts
///     The contacts.
/// initial
///     The distribution Q_ini of stretches at X = 0, by default all at 0.
/// start
///     "conditional" if contacts hold at X = 0, so that thresholds are above stretches; "relaxed" if stretches and
///     thresholds are independent, so that contacts above their threshold break at once; "steady" for
///     time-independent contacts that slide steadily, without initial. Derivatives leave the stretches as they are.
/// velocity
///     The velocity of the slider, above 0; required only for time-dependent contacts, which have age 0 at X = 0.
/// tolerance
///     Allowed error of the force per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; a larger error raises
///     RuntimeError. Without it the aim is 1e-10, and `Pull.accuracy` is the estimated error.
///
/// Raises
/// ------
/// ValueError
///     For stretches at which no contact survives, and for distributions too narrow to be distinguished from a point
///     mass.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> pull = theory.pull(distance=5.0)
/// >>> round(pull.static_friction.force, 6)
/// 0.796436
/// >>> round(pull.kinetic_friction, 6)
/// 0.505
#[pyclass(frozen, extends = Model, module = "asperity")]
pub struct MasterEquation;

#[pymethods]
impl MasterEquation {
    #[new]
    #[pyo3(signature = (contacts, initial = None, *, velocity = None, start: "Literal['conditional', 'relaxed', 'steady']" = Argument::text("conditional"), tolerance = None), text_signature = "(contacts, initial=None, *, velocity=None, start='conditional', tolerance=None)")]
    fn new(
        py: Python<'_>,
        contacts: Argument<Bound<'_, Contacts>>,
        initial: Option<Argument<AnyLaw>>,
        velocity: Option<Real>,
        start: Argument<String>,
        tolerance: Option<Real>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let initial = initial.get("initial")?;
        let contacts = &contacts.get("contacts")?;
        let velocity = velocity.get("velocity")?;
        let start = start.get("start")?;
        let tolerance = tolerance.get("tolerance")?;
        let interface = steady_interface(contacts, initial, &start)?;
        let solved = Solved { own: scenario::MasterEquation { tolerance }, velocity };
        let build = |monitor: &mut dyn Monitor| {
            solved.own.check().map_err(|e| e.under("master_equation"))?;
            EquationSolver::new(&interface, &solved, monitor)
        };
        let solver = watched(None, py, build)?;
        Ok(Self::described(solver, interface, solved))
    }

    /// The velocity of the slider, or None.
    #[getter]
    fn velocity(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::solved(slf).velocity
    }

    /// The allowed error of the force per contact and per ⟨k⟩ × mean threshold; None for the default aim of 1e-10.
    #[getter]
    fn tolerance(slf: &Bound<'_, Self>) -> Option<f64> {
        Self::solved(slf).own.tolerance
    }

    /// Its events are simultaneous breaks of many contacts.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation of the contacts under a rigid slider that advances step by step, at X = 0.
    fn simulation(slf: &Bound<'_, Self>) -> PyResult<Simulation> {
        Model::simulation(slf.as_super(), None)
    }

    /// Displaces the slider's base from X = 0 to distance.
    ///
    /// Parameters
    /// ----------
    /// distance
    ///     A length above 0.
    /// points
    ///     The number of positions of `position`, `force` and `breaking_rate`, evenly spaced, including both ends; 2
    ///     or more.
    /// progress
    ///     A function that is called from time to time with the completed fraction, or True for a progress bar (by
    ///     tqdm). Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// Pull
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a distance that is not above 0, fewer than 2 points, and more than fit in the memory of any machine.
    /// MemoryError
    ///     For too many point masses or samples.
    /// RuntimeError
    ///     If the tolerance is not reached.
    #[pyo3(
        signature = (distance = Real::new(20.0), points = Whole::new(2001), *, progress: "_Progress" = None),
        text_signature = "($self, distance=20.0, points=2001, *, progress=None)"
    )]
    fn pull(
        slf: Bound<'_, Self>,
        distance: Real,
        points: Whole,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Pull>> {
        let distance = distance.get("distance")?;
        Pull::object(slf.into_super(), distance, points.get("points")?, progress)
    }

    /// Steady sliding.
    ///
    /// Returns
    /// -------
    /// SteadyState
    fn steady_state(slf: Bound<'_, Self>) -> SteadyState {
        SteadyState {
            steady: Self::solver(&slf).equation.steady_state(),
            equation: slf.into_super().unbind(),
        }
    }

    /// The relaxation to steady sliding.
    ///
    /// Returns
    /// -------
    /// Relaxation
    fn relaxation(slf: &Bound<'_, Self>) -> PyResult<Relaxation> {
        let solver = &Self::solver(slf).equation;
        let relaxation = watched(None, slf.py(), |monitor| solver.relaxation_with(monitor))?;
        Ok(Relaxation { relaxation, equation: slf.as_super().clone().unbind() })
    }
}

impl MasterEquation {
    /// A solver as a model with its description.
    pub fn described(
        solver: EquationSolver,
        interface: Interface,
        solved: Solved,
    ) -> PyClassInitializer<Self> {
        let plain = Plain::MasterEquation(interface, solved);
        Model::new(plain, Solver::MasterEquation(solver)).add_subclass(Self)
    }

    /// The solver.
    pub fn solver<'a>(equation: &'a Bound<'_, Self>) -> &'a EquationSolver {
        equation.as_super().get().equation()
    }

    fn solved<'a>(equation: &'a Bound<'_, Self>) -> &'a Solved {
        match equation.as_super().as_super().get().plain() {
            Plain::MasterEquation(_, solved) => solved,
            _ => unreachable!("an equation is described as an equation"),
        }
    }
}

/// Steady sliding: the solution of the master equation that does not depend on X.
///
/// Q_s(x) = Γ_s S(x) ∫₀ˣ R/S and F_k = N_c⟨k⟩ ∫x Q_s dx. If contacts re-form at 0, F_k = N_c⟨k⟩⟨x_s²⟩/(2⟨x_s⟩)
/// (Braun and Peyrard 2008, Eqs. 11a and 11d).
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> steady = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).steady_state()
/// >>> round(steady.kinetic_friction, 3)
/// 0.505
#[pyclass(frozen, module = "asperity")]
pub struct SteadyState {
    steady: master::SteadyState,
    equation: Py<Model>,
}

#[pymethods]
impl SteadyState {
    /// The kinetic friction F_k, a force.
    #[getter]
    fn kinetic_friction(&self) -> f64 {
        self.steady.kinetic_friction()
    }

    /// The breaking rate Γ_s, the fraction of contacts that break per length.
    #[getter]
    fn breaking_rate(&self) -> f64 {
        self.steady.breaking_rate()
    }

    /// The standard deviation of the force of `size` random contacts, scaled to N_c.
    ///
    /// Parameters
    /// ----------
    /// size
    ///     The number of contacts; None for the N_c of the contacts.
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
    ///     For a size that is not above 0.
    fn force_std(&self, size: Real) -> PyResult<f64> {
        let size = size.get("size")?;
        Ok(self.steady.force_std(convert::contacts("size", size)?))
    }

    /// The autocovariance c(u) = Cov(F(X), F(X + u)) of the force of `size` random contacts in steady sliding, scaled
    /// to N_c, at displacements u ≥ 0: force².
    ///
    /// Parameters
    /// ----------
    /// size
    ///     The number of contacts, or None for the N_c of the contacts. If contacts re-form at 0, the slope of c(u),
    ///     per contact, is the first loading curve less the kinetic friction. Contacts with a delay, or whose
    ///     stiffness depends on the threshold, are refused.
    /// displacement
    ///     Displacements u, 0 or above: a number or an array of any shape.
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
    ///     For a displacement below 0, a size that is not above 0, and contacts that are refused.
    #[pyo3(signature = (displacement: "float; ArrayLike", size = None) -> "float; _Array")]
    fn autocovariance<'py>(
        &self,
        displacement: &Bound<'py, PyAny>,
        size: Option<Real>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let size = size.get("size")?;
        const DISPLACEMENTS: Domain = Domain { low: 0.0, high: f64::MAX, what: "a displacement" };
        let size = self.size(size)?;
        evaluate_all("displacement", displacement, &DISPLACEMENTS, |u, monitor| {
            self.steady.autocovariance_with(u, size, Tolerance::default(), monitor)
        })
    }

    /// The spectrum S(q) = ∫c(u) exp(iqu) du over all u of the force of `size` random contacts in steady sliding, scaled
    /// to N_c, at wave numbers q ≥ 0, in radians per length: force² times length.
    ///
    /// Parameters
    /// ----------
    /// size
    ///     The number of contacts, or None for the N_c of the contacts. If contacts re-form at 0, q² S(q)/(2F_k)
    ///     tends to the stiffness of one contact, N_c⟨k⟩/size, for large q. Identical contacts that re-form at one
    ///     stretch are refused: their spectrum consists of lines.
    /// wave_number
    ///     Wave numbers q, 0 or above: a number or an array of any shape.
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
    ///     For a wave_number below 0, a size that is not above 0, and contacts that are refused.
    #[pyo3(signature = (wave_number: "float; ArrayLike", size = None) -> "float; _Array")]
    fn spectrum<'py>(
        &self,
        wave_number: &Bound<'py, PyAny>,
        size: Option<Real>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let size = size.get("size")?;
        const WAVE_NUMBERS: Domain = Domain { low: 0.0, high: f64::MAX, what: "a wave number" };
        let size = self.size(size)?;
        evaluate_all("wave_number", wave_number, &WAVE_NUMBERS, |q, monitor| {
            self.steady.spectrum_with(q, size, monitor)
        })
    }

    /// The distribution Q_s of stretches, per length.
    ///
    /// Parameters
    /// ----------
    /// stretches
    ///     A list of n stretches, or None for an automatic choice that resolves it. The result has `stretch` and
    ///     `density` of shape (n,), and `atoms`.
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
    ///     For stretches below 0.
    #[pyo3(signature = (stretches: "ArrayLike | None" = None))]
    fn stretch_density<'py>(
        &self,
        py: Python<'py>,
        stretches: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<typed::StretchDensity<'py>> {
        let stretches = self.equation.get().equation().stretches(stretches, &[])?;
        let found = watched(None, py, |monitor| self.steady.stretch_density_with(&stretches, monitor))?;
        values::stretches(py, stretches, found)
    }

    /// Plots the distribution of stretches, point masses as stems; it needs matplotlib, whose styles it follows.
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
        slf.py().import("asperity._plot")?.call_method("steady_state", (slf, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        again(self.equation.bind(py), "steady_state", PyTuple::empty(py))
    }

    fn __repr__(&self) -> String {
        format!("<steady sliding: F_k = {}>", self.steady.kinetic_friction())
    }
}

impl SteadyState {
    /// The number of contacts that a force is the sum of.
    fn size(&self, size: Option<f64>) -> PyResult<f64> {
        let count = self.equation.get().equation().equation.contacts().count;
        size.map_or(Ok(count), |size| convert::contacts("size", size))
    }
}

/// The relaxation spectrum: F(X) = F_k + N_c⟨k⟩ Σ_j c_j exp(s_j X), where s_j ≠ 0 are the roots of φ̂(s) = 1 and φ̂ is
/// the Laplace transform of the breaking density of re-formed contacts.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> relaxation = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).relaxation()
/// >>> bool(relaxation.length > 0.0)
/// True
#[pyclass(frozen, module = "asperity")]
pub struct Relaxation {
    relaxation: master::Relaxation,
    equation: Py<Model>,
}

#[pymethods]
impl Relaxation {
    /// The roots s_j with Im s_j > 0, slowest first: a complex array of shape (n,), per length.
    #[getter]
    fn roots<'py>(&self, py: Python<'py>) -> typed::ComplexArray<'py> {
        typed::ComplexArray(self.relaxation.roots().to_pyarray(py).into_any())
    }

    /// The relaxation length X* = -1/Re s_1, over which the initial state is forgotten; inf if the force never
    /// settles, nan if no root is found.
    #[getter]
    fn length(&self) -> f64 {
        self.relaxation.length()
    }

    /// The estimate x̄²/σ of Braun and Peyrard (2008), a length; inf for identical thresholds. For time-dependent
    /// contacts, x̄ and σ are the mean and the standard deviation of the displacement between successive formations
    /// of a contact in steady sliding.
    #[getter]
    fn paper_estimate(&self) -> f64 {
        self.relaxation.paper_estimate()
    }

    /// The position from which on the neglected terms of `force` are below 1e-12 of N_c⟨k⟩ × the mean life; inf if
    /// the expansion does not hold.
    #[getter]
    fn valid_from(&self) -> f64 {
        self.relaxation.valid_from()
    }

    /// F(X) from the expansion, a force, for positions from `valid_from` on.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     Positions from `valid_from` on: a number or an array of any shape.
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
    ///     For a position below `valid_from`, and contacts for which the expansion holds nowhere.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn force<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let valid = self.relaxation.valid_from();
        if valid.is_infinite() {
            return Err(error::invalid(
                "position",
                "an expansion that holds somewhere",
                "none for these contacts",
            ));
        }
        let domain = Domain { low: valid, high: f64::MAX, what: "a position" };
        evaluate("position", position, &domain, |x| self.relaxation.force(x))
    }

    /// Plots the roots in the complex plane; it needs matplotlib, whose styles it follows.
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
        slf.py().import("asperity._plot")?.call_method("relaxation", (slf, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        again(self.equation.bind(py), "relaxation", PyTuple::empty(py))
    }

    fn __repr__(&self) -> String {
        let (length, estimate) = (self.relaxation.length(), self.relaxation.paper_estimate());
        format!("<relaxation: X* = {length} (the paper's estimate {estimate})>")
    }
}
