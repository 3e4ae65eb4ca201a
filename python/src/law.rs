//! Probability distributions, with the method names of scipy.stats.

use std::convert::Infallible;

use asperity::Error;
use asperity::law::{self, SharedLaw, parametric_distributions};
use asperity::random::{Purpose, Stream};
use asperity::scenario::{self, Component, Tabulated as Table};
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::IntoPyObjectExt as _;
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::convert::{self, Domain, Import, Seed, Size, Whole, evaluate};
use crate::description::{Description, Plain};
use crate::typed::argument_type;
use crate::watch::{report, watched};
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
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Law {
    built: SharedLaw,
}

/// Creates the base object for `law`, checked and built.
fn describe(law: scenario::Law) -> PyResult<PyClassInitializer<Law>> {
    let built = law.build().map_err(error::core)?;
    Ok(Description::new(Plain::Law(law)).add_subclass(Law { built }))
}

#[pymethods]
impl Law {
    /// The point masses: positions and weights, each an array of shape (n,).
    #[getter]
    fn atoms<'py>(&self, py: Python<'py>) -> PyResult<typed::Atoms<'py>> {
        values::atoms(py, &self.built.atoms())
    }

    /// The density p(x) without point masses, per length; 0 for x < 0.
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
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn pdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.density(x))
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
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logsf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| self.built.ln_survival(x))
    }

    /// ln p(x), accurate also where p underflows; -inf where p is 0.
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
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logpdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| law::ln_density(self.built.as_ref(), x))
    }

    /// ln P(ξ ≤ x); -inf where P is 0.
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
    #[pyo3(signature = (x: "float; ArrayLike") -> "float; _Array")]
    fn logcdf<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("x", x, &Domain::NUMBERS, |x| {
            let below = self.built.cumulative(x);
            if below < 0.5 { below.ln() } else { (-self.built.survival(x)).ln_1p() }
        })
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
    #[pyo3(signature = (size: "None; SupportsIndex | Sequence[SupportsIndex]" = None, random_state: "_Seed | None" = None, *, seed: "_Seed | None" = None) -> "float; _Array")]
    fn rvs<'py>(
        &self,
        py: Python<'py>,
        size: Option<Size>,
        random_state: Option<Seed>,
        seed: Option<Seed>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let seed = match (seed, random_state) {
            (Some(_), Some(_)) => {
                return Err(PyTypeError::new_err("expected seed or random_state, got both"));
            }
            (Some(seed), None) | (None, Some(seed)) => seed,
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
    fn interval(&self, confidence: f64) -> PyResult<(f64, f64)> {
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
    #[pyo3(signature = (moments = "mv") -> "float | tuple[float, ...]")]
    fn stats<'py>(&self, py: Python<'py>, moments: &str) -> PyResult<Bound<'py, PyAny>> {
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
    #[pyo3(signature = (func: "Callable[[float], SupportsFloat] | None" = None, *, lb: "_Number | None" = None, ub: "_Number | None" = None, conditional: "bool" = false))]
    fn expect(
        &self,
        func: Option<&Bound<'_, PyAny>>,
        lb: Option<f64>,
        ub: Option<f64>,
        conditional: bool,
    ) -> PyResult<f64> {
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
    #[classmethod]
    #[pyo3(signature = (samples: "ArrayLike") -> "Self")]
    fn fit<'py>(cls: &Bound<'py, PyType>, samples: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = cls.py();
        let samples = convert::list("samples", samples)?;
        let found = most_likely(cls, &samples).ok_or_else(|| {
            let name = cls.name().map_or_else(|_| String::new(), |name| name.to_string());
            PyTypeError::new_err(format!(
                "fit: expected a class with parameters, such as Gaussian, got {name}"
            ))
        })?;
        Plain::Law(found.map_err(error::core)?).object(py)
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
    fn moment(&self, order: Whole) -> PyResult<f64> {
        let order = order.get("order")?;
        if order > 29 {
            return Err(error::invalid("order", "a whole number from 0 to 29", order));
        }
        Ok(self.built.upper_moment(order, -1.0))
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
            return Ok(Self(plain(&law)));
        }
        let made = MADE.get(value.py())?.call1((value,))?;
        Ok(Self(plain(made.cast::<Law>()?)))
    }
}

/// The distribution itself.
pub fn built(law: AnyLaw) -> PyResult<SharedLaw> {
    law.0.build().map_err(error::core)
}

fn plain(law: &Bound<'_, Law>) -> scenario::Law {
    match law.as_super().get().plain() {
        Plain::Law(law) => law.clone(),
        _ => unreachable!("a law is described as a law"),
    }
}

/// Classes of distributions, each created from its own arguments.
macro_rules! classes {
    ($($(#[doc = $doc:expr])+ $name:ident($($signature:tt)*) { $($argument:ident: $kind:ty),* } => $plain:expr;)+) => {$(
        $(#[doc = $doc])+
        #[pyclass(frozen, extends = Law, module = "asperity")]
        pub struct $name;

        #[pymethods]
        impl $name {
            #[new]
            #[pyo3(signature = ($($signature)*))]
            fn new($($argument: $kind),*) -> PyResult<PyClassInitializer<Self>> {
                Ok(describe($plain)?.add_subclass(Self))
            }
        }
    )+};
}

/// The classes of parametric distributions, from their declarations.
macro_rules! parametric_classes {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $key:literal, $widths:expr, |$scale:ident, $width:ident| {
            $($(#[doc = $parameter_doc:literal])+ $parameter:ident: $value:expr,)+
        }
    )+) => {
        classes! {$(
            $(#[doc = $doc])+
            #[doc = "\nParameters\n----------"]
            $(#[doc = concat!(stringify!($parameter), "\n   ", $($parameter_doc),+)])+
            $name($($parameter),+) { $($parameter: f64),+ } => scenario::Law::$name { $($parameter),+ };
        )+}

        /// The class of a distribution.
        pub fn class<'py>(law: &scenario::Law, py: Python<'py>) -> Bound<'py, PyType> {
            match law {
                $(scenario::Law::$name { .. } => py.get_type::<$name>(),)+
                scenario::Law::Tabulated(_) => py.get_type::<Tabulated>(),
                scenario::Law::Series { .. } => py.get_type::<Series>(),
                scenario::Law::Mixture(_) => py.get_type::<Mixture>(),
                scenario::Law::Renormalised { .. } => py.get_type::<Renormalised>(),
                _ => unreachable!("a distribution without a class"),
            }
        }

        /// The member of the class under which samples are most likely; `None` for classes without parameters.
        fn most_likely(class: &Bound<'_, PyType>, samples: &[f64]) -> Option<asperity::Result<scenario::Law>> {
            let py = class.py();
            $(if class.is(&py.get_type::<$name>()) {
                return Some(law::maximum_likelihood($key, samples).map(|values| {
                    let mut values = values.into_iter();
                    $(let $parameter = values.next().expect("a value for each parameter");)+
                    scenario::Law::$name { $($parameter),+ }
                }));
            })+
            None
        }

        /// Sets a parameter of a description, by its name in the distribution that is built from it.
        pub fn set_parameter(law: &mut scenario::Law, name: &str, to: f64) {
            match law {
                $(scenario::Law::$name { $($parameter),+ } => match name {
                    $(stringify!($parameter) => *$parameter = to,)+
                    _ => unreachable!("a parameter without a place"),
                },)+
                scenario::Law::Mixture(components) => set_of_component(components, name, to),
                scenario::Law::Renormalised { coupling, .. } if name == "coupling" => *coupling = to,
                scenario::Law::Renormalised { law, .. } => {
                    set_parameter(law, name.trim_start_matches("law."), to);
                }
                _ => unreachable!("a distribution without parameters"),
            }
        }

        /// The arguments of its class that create a distribution.
        pub fn arguments(law: &scenario::Law, into: &Bound<'_, PyDict>) -> PyResult<()> {
            match law {
                $(scenario::Law::$name { $($parameter),+ } => {
                    $(into.set_item(stringify!($parameter), $parameter)?;)+
                    Ok(())
                })+
                scenario::Law::Tabulated(Table { stretch, density, samples, bandwidth, exact, .. }) => {
                    let columns = [("stretch", stretch), ("density", density), ("samples", samples)];
                    columns.into_iter().try_for_each(|(name, values)| given(into, name, values.as_ref()))?;
                    given(into, "bandwidth", *bandwidth)?;
                    given(into, "exact", exact.then_some(true))
                }
                scenario::Law::Series { boundaries, coefficients, cut } => {
                    into.set_item("boundaries", boundaries)?;
                    into.set_item("coefficients", coefficients)?;
                    given(into, "cut", (*cut > 0.0).then_some(*cut))
                }
                scenario::Law::Mixture(components) => {
                    let component =
                        |part: &Component| Ok((part.weight, Plain::Law(part.law.clone()).object(into.py())?));
                    into.set_item("components", components.iter().map(component).collect::<PyResult<Vec<_>>>()?)
                }
                scenario::Law::Renormalised { law, coupling } => {
                    into.set_item("law", Plain::Law((**law).clone()).object(into.py())?)?;
                    into.set_item("coupling", coupling)
                }
                _ => unreachable!("a distribution without a class"),
            }
        }
    };
}

parametric_distributions!(parametric_classes);

/// Sets a parameter of a component of a mixture, `1.mean`, or its weight, `1.weight`.
fn set_of_component(components: &mut [Component], name: &str, to: f64) {
    let (place, inner) = name.split_once('.').expect("the place of a component, and its parameter");
    let component = &mut components[place.parse::<usize>().expect("the place of a component")];
    match inner {
        "weight" => component.weight = to,
        _ => set_parameter(&mut component.law, inner, to),
    }
}

classes! {
    /// A measured distribution: a density given at increasing stretches, or a sample.
    ///
    /// Parameters
    /// ----------
    /// stretch, density
    ///     Lists of equal length; the density is linear between them, 0 outside, and normalised.
    /// samples
    ///     A list of equally likely values, of any length; the distribution is their kernel density estimate, with
    ///     their mean and standard deviation.
    /// bandwidth
    ///     Of the kernels, a length; by default that of Silverman's rule, 0.9 min(s, IQR/1.34) n^(-1/5).
    /// exact
    ///     Quantiles that are linear between the samples (as in numpy.quantile) instead of a kernel density estimate.
    ///     Each sample is then a jump of the density, and more than twenty take the master equation minutes. Give
    ///     either stretch and density, or samples.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Tabulated(stretch=[0.9, 1.1], density=[1.0, 1.0])
    /// >>> round(law.pdf(1.0), 6)
    /// 5.0
    Tabulated(*, stretch: "ArrayLike | None" = None, density: "ArrayLike | None" = None, samples: "ArrayLike | None" = None, bandwidth: "_Number | None" = None, exact: "bool" = false) {
        stretch: Option<Bound<'_, PyAny>>, density: Option<Bound<'_, PyAny>>, samples: Option<Bound<'_, PyAny>>,
        bandwidth: Option<f64>, exact: bool
    } => table(stretch, density, samples, bandwidth, exact)?;
    /// A density that is a polynomial in each of several cells, given as Legendre series and normalised.
    ///
    /// asperity.law makes a Series from any distribution of scipy.stats.
    ///
    /// Parameters
    /// ----------
    /// boundaries
    ///     The boundaries of the cells, in increasing order from 0 or above.
    /// coefficients
    ///     For each cell a list of up to 16 coefficients c_n, c_0 first, of the density Σ c_n P_n(t), with t from -1
    ///     to 1 across the cell.
    /// cut
    ///     The probability of an infinite tail that was truncated at the last boundary; quantities that depend on
    ///     this tail, such as the relaxation length, are then nan.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Series([0.0, 2.0], [[0.5]])
    /// >>> round(law.cdf(0.5), 6)
    /// 0.25
    Series(boundaries: "ArrayLike", coefficients: "Sequence[ArrayLike]", *, cut = 0.0) {
        boundaries: Bound<'_, PyAny>, coefficients: Vec<Bound<'_, PyAny>>, cut: f64
    } => series(&boundaries, &coefficients, cut)?;
    /// A mixture of distributions.
    ///
    /// Parameters
    /// ----------
    /// components
    ///     A list of pairs (weight, distribution), with weights above 0 that sum to 1.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Mixture([(0.5, asp.Point(1.0)), (0.5, asp.Gaussian(2.0, 0.1))])
    /// >>> round(law.mean(), 6)
    /// 1.5
    Mixture(components) { components: Vec<(f64, AnyLaw)> } => scenario::Law::Mixture(
        components.into_iter().map(|(weight, law)| Component { weight, law: law.0 }).collect(),
    );
    /// The distribution of thresholds, renormalised in mean field: every break stretches all other contacts, so
    /// that contacts break at lower drives. Its mean is lower and it is narrower than law.
    ///
    /// Parameters
    /// ----------
    /// law
    ///     The distribution P_c of the thresholds, without point masses above 0.
    /// coupling
    ///     κ, the fraction of its stretch that a breaking contact transfers to all others together, from 0 to below
    ///     critical_coupling(law).
    ///     Contacts start at stretch 0. When the unbroken contacts have the stretch x, breaks have contributed κ∫ξ
    ///     P_c(ξ)dξ to it, and the drive X = x - κ∫ξ P_c(ξ)dξ, so that P_eff(X) = P_c(x)/(1 - κ x P_c(x)).
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Renormalised(asp.Gaussian(1.0, 0.1), coupling=0.1)
    /// >>> round(law.std(), 4)
    /// 0.0721
    Renormalised(law, coupling) { law: AnyLaw, coupling: f64 } => scenario::Law::Renormalised {
        law: Box::new(law.0), coupling,
    };
}

fn table(
    stretch: Option<Bound<'_, PyAny>>,
    density: Option<Bound<'_, PyAny>>,
    samples: Option<Bound<'_, PyAny>>,
    bandwidth: Option<f64>,
    exact: bool,
) -> PyResult<scenario::Law> {
    let column = |key, values: Option<Bound<'_, PyAny>>| values.map(|v| convert::list(key, &v)).transpose();
    Ok(scenario::Law::Tabulated(Table {
        file: None,
        samples: column("tabulated.samples", samples)?,
        stretch: column("tabulated.stretch", stretch)?,
        density: column("tabulated.density", density)?,
        bandwidth,
        exact,
    }))
}

fn series(
    boundaries: &Bound<'_, PyAny>,
    coefficients: &[Bound<'_, PyAny>],
    cut: f64,
) -> PyResult<scenario::Law> {
    let cell = |(cell, given): (usize, _)| convert::list(&format!("series.coefficients.{cell}"), given);
    let coefficients = coefficients.iter().enumerate().map(cell).collect::<PyResult<_>>()?;
    Ok(scenario::Law::Series {
        boundaries: convert::list("series.boundaries", boundaries)?,
        coefficients,
        cut,
    })
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
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> round(asp.critical_coupling(asp.Gaussian(1.0, 0.1)), 4)
/// 0.2494
#[pyfunction]
pub fn critical_coupling(law: AnyLaw) -> PyResult<f64> {
    Ok(law::critical_coupling(built(law)?.as_ref()))
}

/// The distribution of a density that is called with arrays of points, accurate to rounding.
#[pyfunction(name = "_resolve")]
#[pyo3(signature = (density: "Callable[[_Array], ArrayLike]", boundaries: "Sequence[float]"))]
pub fn resolve<'py>(density: &Bound<'py, PyAny>, boundaries: Vec<f64>) -> PyResult<Bound<'py, Series>> {
    let py = density.py();
    let mut raised = None;
    let values = |points: &[f64]| {
        let values = density.call1((PyArray1::from_slice(py, points),));
        values.and_then(|values| convert::list("density", &values)).map_err(|error| {
            raised = Some(error);
            Error::Stopped
        })
    };
    let resolved = law::Series::resolve(values, &boundaries, 1e-14);
    let (law, _) = resolved.map_err(|error| raised.unwrap_or_else(|| error::core(error)))?;
    let plain = scenario::Law::Series {
        boundaries: law.boundaries().to_vec(),
        coefficients: law.coefficients().iter().map(|cell| cell.to_vec()).collect(),
        cut: law.cut(),
    };
    Bound::new(py, describe(plain)?.add_subclass(Series))
}

/// Sets an argument, unless it is omitted.
pub fn given<'py, T: IntoPyObject<'py>>(
    into: &Bound<'py, PyDict>,
    name: &str,
    value: Option<T>,
) -> PyResult<()> {
    value.map_or(Ok(()), |value| into.set_item(name, value))
}
