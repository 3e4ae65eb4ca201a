//! The parametric distributions, each declared once: its name, its parameters, and its members of a given width.
//!
//! The variants of `scenario::Law`, their keys and schema, the classes of Python and the
//! distributions that tests and the page of default accuracy take as examples are made of these declarations.

/// Invokes the macro `$make` with the declarations of all parametric distributions.
///
/// A declaration reads
///
/// ```text
/// /// What it is: shown for its key and for its class in Python.
/// Name = "key", [lowest, highest] width, |scale, width| {
///     /// What the parameter is: shown for its key and for its argument in Python.
///     parameter: value,
/// }
/// refuses "values of the parameters, as the documentation of Python says it"
/// shows "an example of its class in Python"
/// ```
///
/// where `Name::new` takes the parameters in this order. The width is the coefficient of variation before
/// truncation at 0, from the lowest to the highest that members of the family have. The values are those of
/// the member of this width whose mean is near `scale`.
#[doc(hidden)]
#[macro_export]
macro_rules! parametric_distributions {
    ($make:ident) => {
        $make! {
            /// The normal (Gaussian) distribution, truncated at 0.
            Gaussian = "gaussian", [0.0, f64::INFINITY], |scale, width| {
                /// Mean before truncation at 0, 0 or above.
                mean: scale,
                /// Standard deviation before truncation, above 0.
                std: scale * width,
            }
            refuses "a mean below 0, and a std that is not above 0. Lengths are from 1e-150 to 1e150, a std below the mean at least 1e-14 of it."
            shows ">>> round(asp.Gaussian(mean=1.0, std=0.1).cdf(1.0), 6)\n0.5"
            /// The gamma distribution.
            Gamma = "gamma", [0.0, f64::INFINITY], |scale, width| {
                /// Mean, above 0.
                mean: scale,
                /// Standard deviation, above 0.
                std: scale * width,
            }
            refuses "a mean or a std that is not above 0. Lengths are from 1e-150 to 1e150, a std from 1e-14 to 1e6 means."
            shows ">>> round(asp.Gamma(mean=1.0, std=0.5).var(), 6)\n0.25"
            /// The lognormal distribution: the logarithm of the variable is normal.
            Lognormal = "lognormal", [0.0, f64::INFINITY], |scale, width| {
                /// Mean of the variable itself, not of its logarithm, above 0.
                mean: scale,
                /// Standard deviation of the variable itself, above 0.
                std: scale * width,
            }
            refuses "a mean or a std that is not above 0. Lengths are from 1e-150 to 1e150, a std from 1e-14 to 1e6 means."
            shows ">>> round(asp.Lognormal(mean=1.0, std=0.5).mean(), 6)\n1.0"
            /// The uniform distribution on an interval.
            Rectangular = "rectangular", [0.0, 0.577_350_269_189_625_8], |scale, width| {
                /// Lower end, 0 or above.
                min: scale - scale * (3f64.sqrt() * width).min(1.0),
                /// Upper end, above the lower.
                max: scale + scale * (3f64.sqrt() * width).min(1.0),
            }
            refuses "a min below 0, and a max that is not above min. Lengths are from 1e-150 to 1e150."
            shows ">>> asp.Rectangular(min=0.5, max=1.5).pdf(1.0)\n1.0"
            /// A point mass (delta distribution): one value only.
            Point = "point", [0.0, 0.0], |scale, _width| {
                /// The single value, 0 or above.
                at: scale,
            }
            refuses "an at below 0. Lengths are from 1e-150 to 1e150."
            shows ">>> asp.Point(at=1.0).mean()\n1.0"
            /// The exponential distribution.
            Exponential = "exponential", [1.0, 1.0], |scale, _width| {
                /// Mean, above 0.
                mean: scale,
            }
            refuses "a mean that is not above 0. Lengths are from 1e-150 to 1e150."
            shows ">>> round(asp.Exponential(mean=2.0).median(), 6)\n1.386294"
            /// The Weibull distribution: survival exp(−(x/scale)^shape).
            Weibull = "weibull", [0.0, f64::INFINITY], |scale, width| {
                /// Shape k of e^{−(x/λ)^k}, above 0.
                shape: $crate::law::Weibull::shape_of_width(width),
                /// Scale λ, above 0.
                scale: scale,
            }
            refuses "a shape or a scale that is not above 0. Lengths are from 1e-150 to 1e150."
            shows ">>> round(asp.Weibull(shape=2.0, scale=1.0).sf(1.0), 6)\n0.367879"
        }
    };
}

#[doc(hidden)]
pub use parametric_distributions;
