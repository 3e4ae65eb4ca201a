//! The classes of distributions, each created from its own arguments, which are its attributes.

use asperity::Error;
use asperity::law::{self, parametric_distributions};
use asperity::scenario::{self, Component, Tabulated as Table};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real};
use crate::convert;
use crate::error;
use crate::law::{AnyLaw, Law, describe, plain};
use crate::plain::Plain;

/// Classes of distributions, each created from its own arguments, with its attributes.
macro_rules! classes {
    ($($(#[doc = $doc:expr])+
        $name:ident($($signature:tt)*) $(as $text:literal)? { $($argument:ident: $kind:ty),* } => $plain:expr,
        { $($attributes:tt)* })+
    ) => {$(
        $(#[doc = $doc])+
        #[pyclass(frozen, extends = Law, module = "asperity")]
        pub struct $name;

        #[pymethods]
        impl $name {
            #[new]
            #[pyo3(signature = ($($signature)*) $(, text_signature = $text)?)]
            fn new($($argument: $kind),*) -> PyResult<PyClassInitializer<Self>> {
                Ok(describe($plain)?.add_subclass(Self))
            }

            $($attributes)*
        }
    )+};
}

/// The class of a parametric distribution: its parameters are attributes, except for those with the name of a method.
macro_rules! with_attributes {
    ($name:ident { $($class:tt)+ } $attributes:tt) => {
        classes! { $($class)+ $attributes }
    };
    ($name:ident $class:tt $attributes:tt mean $doc:tt $($rest:tt)*) => {
        with_attributes! { $name $class $attributes $($rest)* }
    };
    ($name:ident $class:tt $attributes:tt std $doc:tt $($rest:tt)*) => {
        with_attributes! { $name $class $attributes $($rest)* }
    };
    ($name:ident $class:tt { $($attributes:tt)* } $parameter:ident { $($doc:tt)+ } $($rest:tt)*) => {
        with_attributes! { $name $class {
            $($attributes)*

            $($doc)+
            #[getter]
            fn $parameter(slf: &Bound<'_, Self>) -> f64 {
                match plain(slf.as_super()) {
                    scenario::Law::$name { $parameter, .. } => *$parameter,
                    _ => unreachable!("a distribution of another class"),
                }
            }
        } $($rest)* }
    };
}

/// The classes of parametric distributions, from their declarations.
macro_rules! parametric_classes {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $key:literal, $widths:expr, |$scale:ident, $width:ident| {
            $($(#[doc = $parameter_doc:literal])+ $parameter:ident: $value:expr,)+
        }
        refuses $refused:literal
        shows $example:literal
    )+) => {
        $(with_attributes! {
            $name {
                $(#[doc = $doc])+
                #[doc = "\nParameters\n----------"]
                $(#[doc = concat!(stringify!($parameter), "\n   ", $($parameter_doc),+)])+
                #[doc = concat!(
                    "\nRaises\n------\nTypeError\n    For an argument of another type, which the message names.\nValueError\n    For ",
                    $refused
                )]
                #[doc = concat!("\nExamples\n--------\n>>> import asperity as asp\n", $example)]
                $name($($parameter),+) { $($parameter: Real),+ } => scenario::Law::$name {
                    $($parameter: $parameter.get(stringify!($parameter))?),+
                },
            } {} $($parameter { $(#[doc = $parameter_doc])+ })+
        })+

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
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For neither or both of stretch with density and samples, lists of different lengths, fewer than two rows,
    ///     no samples, numbers below 0, stretches that do not rise, a density that is 0 everywhere, a bandwidth that
    ///     is not above 0 or beside exact, and bandwidth or exact without samples.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Tabulated(stretch=[0.9, 1.1], density=[1.0, 1.0])
    /// >>> round(law.pdf(1.0), 6)
    /// 5.0
    Tabulated(*, stretch: "ArrayLike | None" = None, density: "ArrayLike | None" = None, samples: "ArrayLike | None" = None, bandwidth: "_Number | None" = None, exact: "bool" = Argument::new(false))
        as "(*, stretch=None, density=None, samples=None, bandwidth=None, exact=False)"
    {
        stretch: Option<Bound<'_, PyAny>>, density: Option<Bound<'_, PyAny>>, samples: Option<Bound<'_, PyAny>>,
        bandwidth: Option<Real>, exact: Argument<bool>
    } => table(stretch, density, samples, bandwidth.get("bandwidth")?, exact.get("exact")?)?, {
        /// The stretches at which the density is given; None for samples.
        #[getter]
        fn stretch(slf: &Bound<'_, Self>) -> Option<Vec<f64>> {
            table_of(slf).stretch.clone()
        }

        /// The density there, as it was given; None for samples.
        #[getter]
        fn density(slf: &Bound<'_, Self>) -> Option<Vec<f64>> {
            table_of(slf).density.clone()
        }

        /// The samples; None for a density.
        #[getter]
        fn samples(slf: &Bound<'_, Self>) -> Option<Vec<f64>> {
            table_of(slf).samples.clone()
        }

        /// The bandwidth that was given, a length; None for that of Silverman's rule.
        #[getter]
        fn bandwidth(slf: &Bound<'_, Self>) -> Option<f64> {
            table_of(slf).bandwidth
        }

        /// Whether quantiles are linear between the samples.
        #[getter]
        fn exact(slf: &Bound<'_, Self>) -> bool {
            table_of(slf).exact
        }
    }
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
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For fewer than two boundaries, boundaries below 0 or that do not rise, another number of lists of
    ///     coefficients than of cells, none or more than 16 in a cell, a density that is below 0 somewhere or 0
    ///     everywhere, and a cut below 0 or above 1e-9.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Series([0.0, 2.0], [[0.5]])
    /// >>> round(law.cdf(0.5), 6)
    /// 0.25
    Series(boundaries: "ArrayLike", coefficients: "Sequence[ArrayLike]", *, cut = Real::new(0.0))
        as "(boundaries, coefficients, *, cut=0.0)"
    {
        boundaries: Bound<'_, PyAny>, coefficients: Bound<'_, PyAny>, cut: Real
    } => series(&boundaries, &coefficients, cut.get("cut")?)?, {
        /// The boundaries of the cells.
        #[getter]
        fn boundaries(slf: &Bound<'_, Self>) -> Vec<f64> {
            series_of(slf).0.to_vec()
        }

        /// The coefficients of each cell, as they were given.
        #[getter]
        fn coefficients(slf: &Bound<'_, Self>) -> Vec<Vec<f64>> {
            series_of(slf).1.to_vec()
        }

        /// The probability of the tail that was truncated.
        #[getter]
        fn cut(slf: &Bound<'_, Self>) -> f64 {
            series_of(slf).2
        }
    }
    /// A mixture of distributions.
    ///
    /// Parameters
    /// ----------
    /// components
    ///     A list of pairs (weight, distribution), with weights above 0 that sum to 1.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For no components, a weight that is not above 0, and weights that do not sum to 1.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Mixture([(0.5, asp.Point(1.0)), (0.5, asp.Gaussian(2.0, 0.1))])
    /// >>> round(law.mean(), 6)
    /// 1.5
    Mixture(components) { components: Argument<Vec<(f64, AnyLaw)>> } => scenario::Law::Mixture(
        components.get("components")?.into_iter().map(|(weight, law)| Component { weight, law: law.0 }).collect(),
    ), {
        /// The pairs of weights and distributions.
        #[getter]
        fn components<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<(f64, Bound<'py, Law>)>> {
            match plain(slf.as_super()) {
                scenario::Law::Mixture(components) => pairs(components, slf.py()),
                _ => unreachable!("a distribution of another class"),
            }
        }
    }
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
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For thresholds of law that are all 0 or have point masses above 0, and a coupling below 0, or not below
    ///     critical_coupling(law).
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> law = asp.Renormalised(asp.Gaussian(1.0, 0.1), coupling=0.1)
    /// >>> round(law.std(), 4)
    /// 0.0721
    Renormalised(law, coupling) { law: Argument<AnyLaw>, coupling: Real } => scenario::Law::Renormalised {
        law: Box::new(law.get("law")?.0), coupling: coupling.get("coupling")?,
    }, {
        /// The distribution before the renormalisation.
        #[getter]
        fn law<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
            Plain::Law(renormalised_of(slf).0.clone()).instance(slf.py())
        }

        /// κ, the fraction of its stretch that a breaking contact transfers.
        #[getter]
        fn coupling(slf: &Bound<'_, Self>) -> f64 {
            renormalised_of(slf).1
        }
    }
}

fn table_of<'a>(law: &'a Bound<'_, Tabulated>) -> &'a Table {
    match plain(law.as_super()) {
        scenario::Law::Tabulated(table) => table,
        _ => unreachable!("a distribution of another class"),
    }
}

/// Boundaries, coefficients and what was cut.
fn series_of<'a>(law: &'a Bound<'_, Series>) -> (&'a [f64], &'a [Vec<f64>], f64) {
    match plain(law.as_super()) {
        scenario::Law::Series { boundaries, coefficients, cut } => (boundaries, coefficients, *cut),
        _ => unreachable!("a distribution of another class"),
    }
}

fn renormalised_of<'a>(law: &'a Bound<'_, Renormalised>) -> (&'a scenario::Law, f64) {
    match plain(law.as_super()) {
        scenario::Law::Renormalised { law, coupling } => (law, *coupling),
        _ => unreachable!("a distribution of another class"),
    }
}

/// The pairs of weights and distributions of a mixture.
fn pairs<'py>(components: &[Component], py: Python<'py>) -> PyResult<Vec<(f64, Bound<'py, Law>)>> {
    let pair = |part: &Component| Ok((part.weight, Plain::Law(part.law.clone()).instance(py)?));
    components.iter().map(pair).collect()
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
    coefficients: &Bound<'_, PyAny>,
    cut: f64,
) -> PyResult<scenario::Law> {
    let cells: Vec<Bound<'_, PyAny>> = coefficients
        .extract()
        .map_err(|_| error::wrong_type("coefficients", "a list of lists of numbers", coefficients))?;
    let cell = |(cell, given): (usize, _)| convert::list(&format!("series.coefficients.{cell}"), given);
    let coefficients = cells.iter().enumerate().map(cell).collect::<PyResult<_>>()?;
    Ok(scenario::Law::Series {
        boundaries: convert::list("series.boundaries", boundaries)?,
        coefficients,
        cut,
    })
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
