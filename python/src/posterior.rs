//! Draws from the posterior of a fit.

use asperity::fit::Standardised;
use asperity::monitor::Monitor;
use asperity::scenario::FitPosterior;
use asperity::task::summary::PosteriorSummary;
use asperity_runner::posterior;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::Whole;
use crate::convert::{Seed, array};
use crate::pickle::{self, Reduced, damaged};
use crate::watch::watched_on;
use crate::{typed, values};

/// Draws from the posterior of a fit by the No-U-turn sampler.
///
/// Printed, or by `summary()`, it is a table. Numbers of which the fit knows only a limit keep their estimates and are not
/// among those that are drawn.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
/// >>> x = [0.2 * i for i in range(20)]
/// >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
/// >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
/// >>> posterior = fitted.sample(draws=50, chains=2, seed=1)
/// >>> posterior.draws["thresholds.mean"].shape
/// (2, 50)
#[pyclass(frozen, module = "asperity")]
pub struct Posterior {
    drawn: posterior::Posterior,
    reported: PosteriorSummary,
}

impl Posterior {
    /// Draws with means, quantiles and the agreement of the chains.
    pub fn new(drawn: posterior::Posterior) -> Self {
        let reported = drawn.summary(str::to_owned);
        Self { drawn, reported }
    }

    /// Draws by the sampler from a posterior in standard coordinates.
    pub fn sample<'a>(
        py: Python<'_>,
        standardised: impl FnOnce() -> asperity::Result<Standardised<'a>> + Send,
        (draws, chains, seed): (Whole, Whole, Seed),
        (progress, threads): (Option<Bound<'_, PyAny>>, Option<Whole>),
    ) -> PyResult<Self> {
        let sampling =
            FitPosterior { draws: draws.get("draws")?, chains: chains.get("chains")?, seed: seed.0 };
        let sample = |monitor: &mut dyn Monitor| posterior::sample(&standardised()?, sampling, monitor);
        Ok(Self::new(watched_on(threads, progress, py, sample)?))
    }

    /// The draws of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let (drawn, _): (posterior::Posterior, _) = pickle::unpack(bytes)?;
        let FitPosterior { draws, chains, .. } = drawn.sampling;
        let whole = |length: usize| draws.checked_mul(chains) == Some(length);
        let lengths = drawn.values.iter().map(Vec::len).chain([drawn.log_density.len()]);
        let mut all = lengths.chain([drawn.diverging.len(), drawn.steps.len()]);
        if !all.all(whole) || drawn.names.len() != drawn.values.len() {
            return Err(damaged("draws of other numbers"));
        }
        Ok(Py::new(py, Self::new(drawn))?.into_any())
    }

    /// An array of shape (chains, draws).
    fn shaped<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let FitPosterior { draws, chains, .. } = self.drawn.sampling;
        array(py, &[chains, draws], values.to_vec())
    }
}

#[pymethods]
impl Posterior {
    /// The drawn numbers by name: each a PosteriorNumber.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<typed::PosteriorNumbers<'py>> {
        values::posterior(py, &self.reported)
    }

    /// The draws of each number by name: arrays of shape (chains, draws).
    #[getter]
    fn draws<'py>(&self, py: Python<'py>) -> PyResult<typed::Draws<'py>> {
        let draws = PyDict::new(py);
        for (name, values) in self.drawn.names.iter().zip(&self.drawn.values) {
            draws.set_item(name, self.shaped(py, values)?)?;
        }
        Ok(typed::Draws(draws.into_any()))
    }

    /// The logarithm of the posterior density at each draw, without its constant, shape (chains, draws).
    ///
    /// It is the density of the numbers, or of the logarithms of those above 0.
    #[getter]
    fn log_density<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        self.shaped(py, &self.drawn.log_density).map(typed::Array)
    }

    /// 1 where the path to a draw diverged, otherwise 0, shape (chains, draws).
    #[getter]
    fn diverging<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        let diverging: Vec<f64> = self.drawn.diverging.iter().map(|&one| f64::from(u8::from(one))).collect();
        self.shaped(py, &diverging).map(typed::Array)
    }

    /// The number of draws whose paths diverged, because the density bends too much: 0 where the draws can be trusted.
    #[getter]
    fn divergences(&self) -> usize {
        self.reported.divergences
    }

    /// Sentences about draws that are not to be trusted: divergences, chains that differ (r_hat above 1.01), too few
    /// independent draws (ess below 400).
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.reported.warnings()
    }

    /// The draws as ArviZ holds them, with the groups `posterior` and `sample_stats`. It needs arviz.
    ///
    /// Returns
    /// -------
    /// Any
    ///     A DataTree of xarray; before version 1 of ArviZ its InferenceData.
    #[pyo3(signature = () -> "Any")]
    fn to_arviz<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._posterior")?.call_method1("arviz", (slf,))
    }

    /// A table in plain English: means with standard deviations, intervals of 95 %, and how well the chains agree.
    ///
    /// Returns
    /// -------
    /// str
    fn summary(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._posterior")?.call_method1("summary", (slf,))?.extract()
    }

    /// Plots the draws: histograms of the numbers on the diagonal, pairs of them below it. Returns the axes, shape (n, n).
    /// It needs matplotlib.
    ///
    /// Returns
    /// -------
    /// NDArray[Any]
    #[pyo3(signature = () -> "NDArray[Any]")]
    fn plot<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method1("corner", (slf,))
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._posterior")?.call_method1("text", (slf,))?.extract()
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        pickle::reduced(py, "Posterior", &pickle::pack(&self.drawn, &[])?, None)
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._posterior")?.call_method1("html", (slf,))?.extract()
    }
}
