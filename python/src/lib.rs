//! The Python package of asperity: what the core and the runner do, in the words of Python and NumPy.
//!
//! Nothing is computed here. What is documented here is what Python shows.

mod contacts;
mod convert;
mod description;
mod ensemble;
mod equation;
mod error;
mod law;
mod pull;
mod record;
mod result;
mod values;
mod watch;

/// The compiled part of asperity.
#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use crate::contacts::{Areas, Contacts};
    #[pymodule_export]
    use crate::description::{Description, restore};
    #[pymodule_export]
    use crate::ensemble::{Ensemble, EnsemblePull};
    #[pymodule_export]
    use crate::equation::{MasterEquation, Relaxation, SteadyState};
    #[pymodule_export]
    use crate::law::{
        Exponential, Gamma, Gaussian, Law, Lognormal, Mixture, Point, Rectangular, Tabulated, Weibull,
    };
    #[pymodule_export]
    use crate::pull::Pull;
    #[pymodule_export]
    use crate::record::Record;
    #[pymodule_export]
    use crate::result::{Result, open_result, run};

    #[pymodule_export]
    #[expect(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
