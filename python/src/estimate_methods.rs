//! What the estimates of every fit have in common, as methods of their classes in Python.

/// Of a class with the `reported` numbers of a fit, whose method `found` is the end of the search.
macro_rules! methods_of_estimates {
    ($class:ident) => {
        #[pyo3::pymethods]
        impl $class {
            /// The covariance of the estimates in the order of `params`, shape (n, n).
            #[getter]
            fn covariance<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
                convert::square(py, self.reported.covariance.clone()).map(typed::Array)
            }

            /// The correlations above 0.5, without sign, between the errors of two estimates: a list of Correlation.
            #[getter]
            fn correlations<'py>(&self, py: Python<'py>) -> PyResult<typed::Correlations<'py>> {
                values::correlations(py, self.reported.correlations.clone())
            }

            /// Whether the search has converged; otherwise the estimates are its last values.
            #[getter]
            fn converged(&self) -> bool {
                self.reported.converged
            }

            /// The profile of the likelihood of a free number: by how much -2 ln L, lowest in all other free numbers, is above
            /// its minimum. L is that of interval_by_profile.
            ///
            /// Parameters
            /// ----------
            /// name
            ///     A name of `params`.
            /// values
            ///     A list of values, or None for 13 from three standard errors below the estimate to three above it; of the
            ///     logarithm for numbers above 0 but a compliance.
            /// progress
            ///     As for MasterEquation.pull.
            ///
            /// Returns
            /// -------
            /// Profile
            ///
            /// Raises
            /// ------
            /// TypeError
            ///     For an argument of another type, which the message names.
            /// ValueError
            ///     For a name that is none of `params`, values that are nan, and a planned measurement.
            #[pyo3(signature = (name, values: "ArrayLike | None" = None, *, progress: "_Progress" = None))]
            fn profile<'py>(
                &self,
                py: Python<'py>,
                name: Argument<String>,
                values: Option<&Bound<'py, PyAny>>,
                progress: Option<Bound<'py, PyAny>>,
            ) -> PyResult<typed::Profile<'py>> {
                let name = name.get("name")?;
                /// As many as show whether a profile is a parabola.
                const VALUES: usize = 13;
                let found = self.found(py)?;
                let values = match values {
                    Some(values) => convert::list_within("values", values, &convert::Domain::NUMBERS)?,
                    None => found.profile_values(&name, VALUES).map_err($crate::error::core)?,
                };
                let rise = watched(progress, py, |monitor| {
                    let share = 1.0 / values.len() as f64;
                    let one = |(i, &value): (usize, &f64)| {
                        let part = &mut asperity::monitor::Part::new(monitor, i as f64 * share, share);
                        found.profile(&name, value, part)
                    };
                    values.iter().enumerate().map(one).collect()
                })?;
                values::profile(py, &name, values, rise)
            }

            /// The interval of 95 % of a free number by the profile of the likelihood: where -2 ln L, lowest in all other free
            /// numbers, has risen by 3.84. For independent errors of unknown size the rise is nu ln(1 + t²/nu), with Student's t
            /// of nu = n - p degrees of freedom for n readings and p free numbers.
            ///
            /// Where a fit to curves of force has free sizes of errors, L is the restricted likelihood, but for thresholds of
            /// free form. Its likelihood takes the noise of the contacts as normal: errors of count and stiffness also count the
            /// kurtosis of the whitened residuals, and may be larger. The likelihood of a record in steady sliding is the
            /// debiased one of Whittle.
            ///
            /// Parameters
            /// ----------
            /// name
            ///     A name of `params`.
            /// progress
            ///     As for MasterEquation.pull.
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
            ///     For a name that is none of `params`, and for a planned measurement.
            #[pyo3(signature = (name, *, progress: "_Progress" = None))]
            fn interval_by_profile(
                &self,
                py: Python<'_>,
                name: Argument<String>,
                progress: Option<Bound<'_, PyAny>>,
            ) -> PyResult<(f64, f64)> {
                let name = name.get("name")?;
                let found = self.found(py)?;
                let [low, high] = watched(progress, py, |monitor| found.interval_by_profile(&name, monitor))?;
                Ok((low, high))
            }

            /// ln L at values of the free numbers, and its gradient, for samplers and other searches.
            ///
            /// Parameters
            /// ----------
            /// values
            ///     A list of n numbers in the order of `params`.
            ///
            /// Returns
            /// -------
            /// (float, numpy.ndarray)
            ///     ln L, with the logarithm of the priors, and an array of shape (n,); -inf and nan where the likelihood is 0.
            ///     The covariance of the noise of contacts on a curve of force is that of the estimates, scaled by N_c⟨k⟩².
            ///     With independent errors whose size is estimated, ln L is the highest for any size.
            ///
            /// Raises
            /// ------
            /// TypeError
            ///     For an argument of another type, which the message names.
            /// ValueError
            ///     For another number of values than of `params`, and for a planned measurement.
            #[pyo3(signature = (values: "ArrayLike"))]
            fn log_likelihood<'py>(
                &self,
                py: Python<'py>,
                values: &Bound<'py, PyAny>,
            ) -> PyResult<(f64, typed::Array<'py>)> {
                let values = convert::list("values", values)?;
                let found = self.found(py)?;
                let (value, gradient) = watched(None, py, |monitor| found.log_likelihood(&values, monitor))?;
                Ok((value, typed::Array(convert::row(py, gradient)?)))
            }

            /// Draws from the posterior by the No-U-turn sampler (NUTS), where errors from the information are not enough.
            ///
            /// The likelihood is that of log_likelihood. The priors are those of the fit; without one the prior of a number is
            /// flat, or flat in the logarithm of one above 0 that is no compliance. Each chain makes 300 draws before, which are
            /// left out.
            ///
            /// Parameters
            /// ----------
            /// draws
            ///     The number of draws of each chain, 4 or more.
            /// chains
            ///     Their number, 1 or more; as many are made at a time as there are threads.
            /// seed
            ///     A whole number below 2^63, which always gives the same draws, on any number of threads, or a
            ///     numpy.random.Generator, from which one is drawn.
            /// progress
            ///     As for MasterEquation.pull.
            /// threads
            ///     The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default
            ///     those of the process, one per core or RAYON_NUM_THREADS.
            ///
            /// Returns
            /// -------
            /// Posterior
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     For a planned measurement, and if no number is known to better than a limit.
            #[pyo3(
                signature = (draws = Whole::new(1000), chains = Whole::new(4), seed = Seed(1), *, progress: "_Progress" = None, threads = None),
                text_signature = "(self, draws=1000, chains=4, seed=1, *, progress=None, threads=None)"
            )]
            fn sample(
                &self,
                py: Python<'_>,
                draws: Whole,
                chains: Whole,
                seed: Seed,
                progress: Option<Bound<'_, PyAny>>,
                threads: Option<Whole>,
            ) -> PyResult<Posterior> {
                let found = self.found(py)?;
                Posterior::sample(py, || found.standardised(), (draws, chains, seed), (progress, threads))
            }

            fn __copy__(slf: Py<Self>) -> Py<Self> {
                slf
            }

            fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
                slf
            }
        }
    };
}
pub(crate) use methods_of_estimates;
