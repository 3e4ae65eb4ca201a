//! The Python package of asperity: the core and the runner, with the names of Python and NumPy. Nothing is
//! computed here. The documentation here is what Python shows.

mod argument;
mod arguments;
mod block;
mod command;
mod contacts;
mod convert;
mod deformable;
mod description;
mod distributions;
mod ensemble;
mod equation;
mod error;
mod estimate_methods;
mod estimates;
mod exact;
mod explorer;
mod fit;
mod fit_steady;
mod fit_velocity_curve;
mod fitted_model;
mod found;
mod gradient;
mod history;
mod interface;
mod lattice;
mod law;
mod machine_healing;
mod machine_step;
mod measured;
mod model;
mod pickle;
mod plain;
mod posterior;
mod pull;
mod rate_state;
mod record;
mod restore;
mod result;
mod rules;
mod scenario;
mod simulated;
mod simulated_in_time;
mod simulation;
mod solver;
mod stick_slip;
mod stretches;

mod sweep;
mod tables;
mod threads;
mod transport;
mod typed;
mod values;
mod watch;

/// The compiled part of asperity.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::block::{Block, Damped, Inertial};
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::contacts::{Areas, Contacts};
    #[pymodule_export]
    use crate::deformable::Deformable;
    #[pymodule_export]
    use crate::description::{Description, restore};
    #[pymodule_export]
    use crate::distributions::{
        Exponential, Gamma, Gaussian, Lognormal, Mixture, Point, Rectangular, Renormalised, Series,
        Tabulated, Weibull, resolve,
    };
    #[pymodule_export]
    use crate::ensemble::{Ensemble, EnsemblePull};
    #[pymodule_export]
    use crate::equation::{MasterEquation, Relaxation, SteadyState};
    #[pymodule_export]
    use crate::estimates::Estimates;
    #[pymodule_export]
    use crate::exact::{
        ClosedForm, Erlang as ExactErlang, Gamma as ExactGamma, Gaussian as ExactGaussian, Identical,
        Quenched, Rectangular as ExactRectangular, kinetic_friction, kinetic_friction_per_threshold,
        steady_variance, steady_variance_per_threshold,
    };
    #[pymodule_export]
    use crate::explorer::{Engine, complete_text, explorer_page};
    #[pymodule_export]
    use crate::fit::fit;
    #[pymodule_export]
    use crate::fit_steady::{SteadyEstimates, fit_steady};
    #[pymodule_export]
    use crate::fit_velocity_curve::{VelocityCurveEstimates, fit_velocity_curve};
    #[pymodule_export]
    use crate::gradient::{FrictionGradient, Gradient, ThresholdResponse};
    #[pymodule_export]
    use crate::history::pieces;
    #[pymodule_export]
    use crate::interface::Interface;
    #[pymodule_export]
    use crate::lattice::Lattice;
    #[pymodule_export]
    use crate::law::{Law, critical_coupling};
    #[pymodule_export]
    use crate::machine_healing::fit_healing;
    #[pymodule_export]
    use crate::machine_step::fit_velocity_step;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::posterior::Posterior;
    #[pymodule_export]
    use crate::pull::Pull;
    #[pymodule_export]
    use crate::rate_state::{Healing, VelocityStep, read_healing, read_velocity_step};
    #[pymodule_export]
    use crate::record::Record;
    #[pymodule_export]
    use crate::restore::{restore_fit, restore_result};
    #[pymodule_export]
    use crate::result::{Result, open_result, run};
    #[pymodule_export]
    use crate::rules::{Ageing, FrozenRank, Logarithmic, MeanField, Smoluchowski, Temperature};
    #[pymodule_export]
    use crate::scenario::scenario_of;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::stick_slip::StickSlip;
    #[pymodule_export]
    use crate::sweep::{Sweep, cases};
    #[pymodule_export]
    use crate::transport::{Step, Transport};

    #[pymodule_export]
    #[expect(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn name_classes(py: Python<'_>) -> PyResult<()> {
        crate::exact::name_classes(py)
    }
}
