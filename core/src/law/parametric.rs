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
            /// The gamma distribution.
            Gamma = "gamma", [0.0, f64::INFINITY], |scale, width| {
                /// Mean, above 0.
                mean: scale,
                /// Standard deviation, above 0.
                std: scale * width,
            }
            /// The lognormal distribution: the logarithm of the variable is normal.
            Lognormal = "lognormal", [0.0, f64::INFINITY], |scale, width| {
                /// Mean of the variable itself, not of its logarithm, above 0.
                mean: scale,
                /// Standard deviation of the variable itself, above 0.
                std: scale * width,
            }
            /// The uniform distribution on an interval.
            Rectangular = "rectangular", [0.0, 0.577_350_269_189_625_8], |scale, width| {
                /// Lower end, 0 or above.
                min: scale - scale * (3f64.sqrt() * width).min(1.0),
                /// Upper end, above the lower.
                max: scale + scale * (3f64.sqrt() * width).min(1.0),
            }
            /// A point mass (delta distribution): one value only.
            Point = "point", [0.0, 0.0], |scale, _width| {
                /// The single value, 0 or above.
                at: scale,
            }
            /// The exponential distribution.
            Exponential = "exponential", [1.0, 1.0], |scale, _width| {
                /// Mean, above 0.
                mean: scale,
            }
            /// The Weibull distribution: survival exp(−(x/scale)^shape).
            Weibull = "weibull", [0.0, f64::INFINITY], |scale, width| {
                /// Shape k of e^{−(x/λ)^k}, above 0.
                shape: $crate::law::Weibull::shape_of_width(width),
                /// Scale λ, above 0.
                scale: scale,
            }
        }
    };
}

#[doc(hidden)]
pub use parametric_distributions;
