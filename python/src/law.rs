//! Probability distributions, with the method names of scipy.stats.

use std::convert::Infallible;

use asperity::law::{self, SharedLaw, parametric_distributions};
use asperity::monitor::Monitor;
use asperity::random::{Purpose, Stream};
use asperity::scenario;
use numpy::IntoPyArray as _;
use numpy::ndarray::{ArrayD, IxDyn};
use pyo3::IntoPyObjectExt as _;
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::argument::{Argument, Expected, Optional as _, Real, Whole};
use crate::convert::{self, Domain, Import, Seed, Size, evaluate};
use crate::description::Description;
use crate::plain::Plain;
use crate::typed::argument_type;
use crate::watch::{beside, report, watched};
use crate::{error, typed, values};

/// Random numbers drawn between two checks for signals.
const PIECE: usize = 1 << 14;

/// A probability distribution on x ≥ 0: a density, and possibly point masses.
///
/// Methods have the names of scipy.stats. They take a number and return a float, or take anything that NumPy
/// converts to an array of numbers and return an array of the same shape. Lengths are in the unit of the
/// parameters. A distribution with weight below 0 is truncated at 0 and renormalised: its parameters are those
/// before truncation, its mean() and std() those after it. NaN raises ValueError; a value that is not a number
/// raises TypeError.
///
/// The arguments of a distribution are attributes, except for a mean and a standard deviation, whose names are those of
/// the methods mean() and std(); all are in parameters, and ``type(law)(**law.parameters)`` is an equal distribution.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> law = asp.Gaussian(1.0, 0.05)
/// >>> round(law.cdf(0.95), 4)
/// 0.1587
/// >>> law.ppf([0.25, 0.5]).round(4)
/// array([0.9663, 1.    ])
/// >>> round(asp.Lognormal(1.0, 0.2).std(), 4)
/// 0.2
/// >>> asp.Weibull(12.0, 1.0) == asp.Weibull(scale=1.0, shape=12.0)
/// True
/// >>> asp.Weibull(12.0, 1.0).shape, law.parameters
/// (12.0, {'mean': 1.0, 'std': 0.05})
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Law {
    built: SharedLaw,
}

/// Creates the base object for `law`, checked and built.
pub fn describe(law: scenario::Law) -> PyResult<PyClassInitializer<Law>> {
    let (law, built) = if is_long(&law) {
        let build = move |monitor: &mut dyn Monitor| (law.build_with(monitor), law);
        Python::attach(|py| beside(py, build)).map(|(built, law)| (law, built))?
    } else {
        let built = law.build();
        (law, built)
    };
    let built = built.map_err(error::core)?;
    Ok(Description::new(Plain::Law(law)).add_subclass(Law { built }))
}

/// Whether it takes some milliseconds to build a distribution, since it is given by many numbers.
fn is_long(law: &scenario::Law) -> bool {
    const MANY: usize = 1 << 12;
    match law {
        scenario::Law::Tabulated(table) => {
            [&table.samples, &table.stretch].into_iter().flatten().any(|numbers| numbers.len() > MANY)
        }
        scenario::Law::Series { boundaries, .. } => boundaries.len() > MANY,
        scenario::Law::Mixture(components) => {
            components.len() > MANY || components.iter().any(|component| is_long(&component.law))
        }
        scenario::Law::Renormalised { law, .. } => is_long(law),
        _ => false,
    }
}

#[pymethods]
impl Law {
    /// The point masses: positions and weights, each an array of shape (n,).
    #[getter]
    fn atoms<'py>(&self, py: Python<'py>) -> PyResult<typed::Atoms<'py>> {
        values::atoms(py, &self.built.atoms())
    }

    /// The density p(x) without point masses, per length; 0 for x < 0. Both ends of the support belong to it.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn pdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| {
            self.built.density(law::within_support(self.built.as_ref(), x))
        })
    }

    /// The cumulative distribution function P(ξ ≤ x), accurate to all digits also where it is small.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn cdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.cumulative(x))
    }

    /// The survival S(x) = P(ξ > x), accurate to all digits also where it is small.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn sf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.survival(x))
    }

    /// ln S(x), accurate also where S underflows; -inf where S is 0.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logsf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.ln_survival(x))
    }

    /// ln p(x), accurate also where p underflows; -inf where p is 0. Both ends of the support belong to it.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logpdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| {
            self.built.ln_density(law::within_support(self.built.as_ref(), x))
        })
    }

    /// ln P(ξ ≤ x), accurate also where P underflows; -inf where P is 0.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logcdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.ln_cumulative(x))
    }

    /// The hazard p(x)/S(x), per length: the fraction of contacts of stretch x that break per unit displacement
    /// (Braun and Peyrard 2008, the P(x) of Eq. 3); inf where S is 0.
    ///
    /// Parameters
    /// ----------
    /// x
    ///     Stretches: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If x is neither a number nor an array of numbers.
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn hazard<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.hazard(x))
    }

    /// The quantile: the smallest x with P(ξ ≤ x) ≥ q, for q from 0 to 1.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     Probabilities from 0 to 1: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If q is neither a number nor an array of numbers.
    #[pyo3(signature = (q: "float; ArrayLike") -> "float; _Array")]
    fn ppf<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("q", q, &Domain::PROBABILITIES, |q| self.built.quantile(q))
    }

    /// The upper quantile: the smallest x with S(x) ≤ q, for q from 0 to 1; accurate for tiny q, for which ppf(1 -
    /// q) is not.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     Probabilities from 0 to 1: a number or an array of any shape.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     A number for a number, an array of the same shape for an array.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If q is neither a number nor an array of numbers.
    #[pyo3(signature = (q: "float; ArrayLike") -> "float; _Array")]
    fn isf<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("q", q, &Domain::PROBABILITIES, |q| self.built.upper_quantile(q))
    }

    /// Independent random numbers: a float for size None, otherwise an array of shape (size,) or size.
    ///
    /// The seed is a whole number below 2^63, which always gives the same numbers, or a numpy.random.Generator,
    /// from which one such number is drawn. random_state is another name for it; without either, the numbers are
    /// different in each call.
    ///
    /// Parameters
    /// ----------
    /// size
    ///     How many, or the shape of an array; None for one number.
    /// seed
    ///     A whole number below 2^63, or a numpy.random.Generator; without one, draws differ from call to call.
    /// random_state
    ///     The same by the name that scipy.stats uses.
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
    ///     For a size below 0, and a seed that is not below 2^63.
    #[pyo3(signature = (size: "None; SupportsIndex | Sequence[SupportsIndex]" = None, random_state: "_Seed | None" = None, *, seed: "_Seed | None" = None) -> "float; _Array")]
    fn rvs<'py>(
        &self,
        py: Python<'py>,
        size: Option<Size>,
        random_state: Option<&Bound<'py, PyAny>>,
        seed: Option<Seed>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let seed = match (seed, random_state) {
            (Some(_), Some(_)) => {
                return Err(PyTypeError::new_err("seed: expected seed or random_state, got both"));
            }
            (Some(seed), None) => seed,
            (None, Some(state)) => Seed::named("random_state", state)?,
            (None, None) => Seed::of_the_system(py)?,
        };
        let shape = size.map(|size| size.0);
        let count = shape.iter().flatten().try_fold(1_usize, |count, &length| count.checked_mul(length));
        let mut draws = Vec::new();
        let count = count.filter(|&count| draws.try_reserve_exact(count).is_ok());
        let count = count.ok_or_else(|| PyMemoryError::new_err("size: more numbers than fit in memory"))?;
        let mut stream = Stream::new(seed.0, Purpose::Sample, 0);
        watched(None, py, |monitor| {
            while draws.len() < count {
                let done = draws.len();
                report(monitor, done, count)?;
                draws.resize(count.min(done + PIECE), 0.0);
                self.built.fill(&mut stream, &mut draws[done..]);
            }
            Ok(())
        })?;
        let Some(shape) = shape else { return draws[0].into_bound_py_any(py) };
        let array = ArrayD::from_shape_vec(IxDyn(&shape), draws);
        Ok(array.expect("as many numbers as the shape has").into_pyarray(py).into_any())
    }

    /// The mean after truncation at 0, a length.
    ///
    /// Returns
    /// -------
    /// float
    fn mean(&self) -> f64 {
        self.built.mean()
    }

    /// The standard deviation after truncation at 0, a length.
    ///
    /// Returns
    /// -------
    /// float
    fn std(&self) -> f64 {
        self.built.std()
    }

    /// The variance after truncation at 0, in units of length².
    ///
    /// Returns
    /// -------
    /// float
    fn var(&self) -> f64 {
        self.built.std().powi(2)
    }

    /// The median, the smallest x with P(ξ ≤ x) ≥ 1/2.
    ///
    /// Returns
    /// -------
    /// float
    fn median(&self) -> f64 {
        self.built.quantile(0.5)
    }

    /// The interval between the quantiles (1 - confidence)/2 and (1 + confidence)/2.
    ///
    /// Parameters
    /// ----------
    /// confidence
    ///     The probability of the interval, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// (float, float)
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a confidence that is not from 0 to 1.
    fn interval(&self, confidence: Real) -> PyResult<(f64, f64)> {
        let confidence = confidence.get("confidence")?;
        if !(0.0..=1.0).contains(&confidence) {
            return Err(error::invalid("confidence", "a number from 0 to 1", confidence));
        }
        let outside = 0.5 * (1.0 - confidence);
        Ok((self.built.quantile(outside), self.built.upper_quantile(outside)))
    }

    /// The mean "m", variance "v", skewness "s" and excess kurtosis "k" named by moments, in this order: a float for one,
    /// a tuple for several. Skewness and kurtosis of a point mass are nan.
    ///
    /// Parameters
    /// ----------
    /// moments
    ///     Letters of "mvsk".
    ///
    /// Returns
    /// -------
    /// float or tuple[float, ...]
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    #[pyo3(signature = (moments = Argument::text("mv")) -> "float | tuple[float, ...]", text_signature = "($self, moments='mv')")]
    fn stats<'py>(&self, py: Python<'py>, moments: Argument<String>) -> PyResult<Bound<'py, PyAny>> {
        let moments = moments.get("moments")?;
        if moments.is_empty() || moments.chars().any(|name| !"mvsk".contains(name)) {
            return Err(error::invalid("moments", "some of the letters of \"mvsk\"", moments));
        }
        let (mean, std) = (self.mean(), self.std());
        let standardised = |order| {
            let power = |x: f64| Ok::<_, Infallible>(((x - mean) / std).powi(order));
            let Ok(moment) = law::expectation(self.built.as_ref(), [0.0, f64::INFINITY], power);
            moment
        };
        let asked = "mvsk".chars().filter(|name| moments.contains(*name));
        let found: Vec<f64> = asked
            .map(|name| match name {
                'm' => mean,
                'v' => std * std,
                's' => standardised(3),
                _ => standardised(4) - 3.0,
            })
            .collect();
        if found.len() == 1 {
            found[0].into_bound_py_any(py)
        } else {
            Ok(PyTuple::new(py, found)?.into_any())
        }
    }

    /// The differential entropy -∫p ln p, in nats; -inf for a distribution with point masses.
    ///
    /// Returns
    /// -------
    /// float
    fn entropy(&self) -> f64 {
        law::entropy(self.built.as_ref())
    }

    /// The expectation of func(ξ), of ξ itself for None, over lb ≤ ξ ≤ ub, divided by P(lb ≤ ξ ≤ ub) if conditional.
    ///
    /// func is called with one float at a time, at the nodes of an adaptive Gauss quadrature; the relative error is 1e-13
    /// where it is smooth. At a jump of func, divide the range by lb and ub.
    ///
    /// Parameters
    /// ----------
    /// func
    ///     A function of a number, or None.
    /// lb, ub
    ///     The limits; the whole range by default.
    /// conditional
    ///     Whether to divide by the probability of the range.
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
    ///     For an ub below lb, and a limit that is nan.
    #[pyo3(signature = (func: "Callable[[float], SupportsFloat] | None" = None, *, lb: "_Number | None" = None, ub: "_Number | None" = None, conditional: "bool" = Argument::new(false)), text_signature = "($self, func=None, *, lb=None, ub=None, conditional=False)")]
    fn expect(
        &self,
        func: Option<&Bound<'_, PyAny>>,
        lb: Option<Real>,
        ub: Option<Real>,
        conditional: Argument<bool>,
    ) -> PyResult<f64> {
        if let Some(wrong) = func.filter(|func| !func.is_callable()) {
            return Err(error::wrong_type("func", "a function of x", wrong));
        }
        let lb = lb.get("lb")?;
        let ub = ub.get("ub")?;
        let conditional = conditional.get("conditional")?;
        let range = [lb.unwrap_or(0.0), ub.unwrap_or(f64::INFINITY)];
        if range[0] > range[1] || range.iter().any(|end| end.is_nan()) {
            return Err(error::invalid("ub", format!("a number not below lb, {}", range[0]), range[1]));
        }
        let value = |x: f64| match func {
            Some(func) => {
                func.py().check_signals()?;
                func.call1((x,))?.extract::<f64>()
            }
            None => Ok(x),
        };
        let whole = law::expectation(self.built.as_ref(), range, value)?;
        let Ok(mass) = law::expectation(self.built.as_ref(), range, |_| Ok::<_, Infallible>(1.0));
        Ok(if conditional { whole / mass } else { whole })
    }

    /// The distribution of this class under which the samples are most likely.
    ///
    /// Parameters
    /// ----------
    /// samples
    ///     Values of 0 or above, of any length. Gaussian, Gamma, Lognormal, Rectangular, Point, Exponential and
    ///     Weibull have parameters to fit; Gaussian is truncated at 0 here, too. scipy.stats returns the parameters
    ///     instead, among them loc and scale.
    ///
    /// Returns
    /// -------
    /// Law
    ///     One of this class.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For no samples, samples below 0, samples of 0 for Gamma, Lognormal and Weibull, and samples that are all
    ///     equal, but for Point, whose samples have to be, and Exponential.
    #[classmethod]
    #[pyo3(signature = (samples: "ArrayLike") -> "Self")]
    fn fit<'py>(cls: &Bound<'py, PyType>, samples: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = cls.py();
        let samples = convert::list("samples", samples)?;
        let found = most_likely(cls, samples).ok_or_else(|| {
            let name = cls.name().map_or_else(|_| String::new(), |name| name.to_string());
            PyTypeError::new_err(format!(
                "fit: expected a class with parameters, such as Gaussian, got {name}"
            ))
        })?;
        Plain::Law(found?).object(py)
    }

    /// The raw moment E[ξⁿ] after truncation at 0, n up to 29, in units of lengthⁿ.
    ///
    /// Parameters
    /// ----------
    /// order
    ///     The order n, a whole number.
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
    ///     For an order above 29.
    fn moment(&self, order: Whole) -> PyResult<f64> {
        let order = order.get("order")?;
        if order > 29 {
            return Err(error::invalid("order", "a whole number from 0 to 29", order));
        }
        Ok(self.built.upper_moment(order, -1.0))
    }

    /// Plots the density with its quantiles of 5, 50 and 95 %, point masses as stems; it needs matplotlib, whose styles it
    /// follows.
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
        slf.py().import("asperity._plot")?.call_method("law", (slf, ax), style)
    }

    /// The lowest and the highest value; the highest may be inf.
    ///
    /// Returns
    /// -------
    /// (float, float)
    fn support(&self) -> (f64, f64) {
        (self.built.quantile(0.0), self.built.quantile(1.0))
    }
}

/// A distribution as an argument: one of asperity, or an object that asperity.law converts to one.
pub struct AnyLaw(pub scenario::Law);

impl<'py> FromPyObject<'_, 'py> for AnyLaw {
    type Error = PyErr;

    argument_type!("_AnyLaw");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        static MADE: Import = Import::new("asperity._bridge", "law");
        if let Ok(law) = value.cast::<Law>() {
            return Ok(Self(plain(&law).clone()));
        }
        let made = MADE.get(value.py())?.call1((value,))?;
        Ok(Self(plain(made.cast::<Law>()?).clone()))
    }
}

/// The distribution itself.
pub fn built(law: AnyLaw) -> PyResult<SharedLaw> {
    Python::attach(|py| watched(None, py, |monitor| law.0.build_with(monitor)))
}

/// The plain values of a distribution.
pub fn plain<'a>(law: &'a Bound<'_, Law>) -> &'a scenario::Law {
    match law.as_super().get().plain() {
        Plain::Law(law) => law,
        _ => unreachable!("a law is described as a law"),
    }
}

/// κ_c = 1/max(x P_c(x)), the coupling at which contacts with this distribution of thresholds break in one
/// avalanche; 0 if some thresholds are identical.
///
/// For a slider of stiffness K over contacts of total stiffness N⟨k⟩ the coupling is κ = N⟨k⟩/(K + N⟨k⟩). For
/// narrow distributions it is critical when K is the critical stiffness.
///
/// Parameters
/// ----------
/// law
///     The distribution P_c of the thresholds.
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
///     For samples or a distribution of scipy.stats with values below 0, given as law.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.critical_coupling(asp.Gaussian(1.0, 0.1)), 4)
/// 0.2494
#[pyfunction]
pub fn critical_coupling(law: Argument<AnyLaw>) -> PyResult<f64> {
    let law = law.get("law")?;
    Ok(law::critical_coupling(built(law)?.as_ref()))
}

impl Expected for AnyLaw {
    fn expected() -> String {
        "a distribution of asperity, a frozen distribution of scipy.stats, or samples".into()
    }
}

impl Expected for Vec<(f64, AnyLaw)> {
    fn expected() -> String {
        "a list of pairs (weight, distribution)".into()
    }
}

/// The most likely members of parametric distributions, from their declarations.
macro_rules! most_likely_members {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $key:literal, $widths:expr, |$scale:ident, $width:ident| {
            $($(#[doc = $parameter_doc:literal])+ $parameter:ident: $value:expr,)+
        }
        refuses $refused:literal
        shows $example:literal
    )+) => {
        /// The member of a class under which samples are most likely; `None` for classes without parameters.
        fn most_likely(class: &Bound<'_, PyType>, samples: Vec<f64>) -> Option<PyResult<scenario::Law>> {
            let py = class.py();
            let name = class.name().ok()?;
            $(if name == stringify!($name) {
                let estimate =
                    move |monitor: &mut dyn Monitor| law::maximum_likelihood_with($key, &samples, monitor);
                let values = beside(py, estimate).and_then(|values| values.map_err(error::core));
                return Some(values.map(|values| {
                    let mut values = values.into_iter();
                    $(let $parameter = values.next().expect("a value for each parameter");)+
                    scenario::Law::$name { $($parameter),+ }
                }));
            })+
            None
        }
    };
}

parametric_distributions!(most_likely_members);
