//! The types of arguments and results in the stubs, where Rust's own types say less: objects of NumPy and of the Python part
//! of the package, and words.
//!
//! A type is Python code, of names that `python/tests/stubs.py` imports. PyO3 asks for it with the feature `stubs` only.

use std::convert::Infallible;

use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

/// Declares the type of an argument, in its `FromPyObject`.
macro_rules! argument_type {
    ($hint:literal) => {
        #[cfg(feature = "stubs")]
        const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
            pyo3::inspect::PyStaticExpr::Constant { value: pyo3::inspect::PyStaticConstant::Str($hint) };
    };
}

/// Declares the type of a result, in its `IntoPyObject`.
macro_rules! result_type {
    ($hint:literal) => {
        #[cfg(feature = "stubs")]
        const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr =
            pyo3::inspect::PyStaticExpr::Constant { value: pyo3::inspect::PyStaticConstant::Str($hint) };
    };
}

pub(crate) use {argument_type, result_type};

/// A tuple of words.
pub struct Words(pub Vec<String>);

impl<'py> IntoPyObject<'py> for Words {
    type Target = PyTuple;
    type Output = Bound<'py, PyTuple>;
    type Error = PyErr;

    result_type!("tuple[str, ...]");

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        PyTuple::new(py, self.0)
    }
}

/// Results that are objects of Python, each with its type.
macro_rules! objects {
    ($($name:ident: $hint:literal,)+) => {$(
        pub struct $name<'py>(pub Bound<'py, PyAny>);

        impl<'py> IntoPyObject<'py> for $name<'py> {
            type Target = PyAny;
            type Output = Bound<'py, PyAny>;
            type Error = Infallible;

            result_type!($hint);

            fn into_pyobject(self, _: Python<'py>) -> Result<Self::Output, Infallible> {
                Ok(self.0)
            }
        }
    )+};
}

/// Results that are one of a few words.
macro_rules! words {
    ($($name:ident: $hint:literal,)+) => {$(
        pub struct $name(pub &'static str);

        impl<'py> IntoPyObject<'py> for $name {
            type Target = PyString;
            type Output = Bound<'py, PyString>;
            type Error = Infallible;

            result_type!($hint);

            fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
                self.0.into_pyobject(py)
            }
        }
    )+};
}

objects! {
    Array: "_Array",
    ComplexArray: "NDArray[np.complex128]",
    Atoms: "Atoms",
    Estimate: "Estimate",
    MeasuredNoise: "MeasuredNoise",
    StretchDensity: "StretchDensity",
    StaticFriction: "StaticFriction",
    Estimates: "dict[str, Estimate]",
    Fixed: "dict[str, float]",
    Laws: "dict[str, Estimates]",
    Correlations: "list[Correlation]",
    Misfit: "Misfit",
    FreeForm: "FreeForm",
    FrictionEstimates: "FrictionEstimates",
    Prediction: "Prediction",
    Profile: "Profile",
    PosteriorNumbers: "dict[str, PosteriorNumber]",
    Draws: "dict[str, _Array]",
    MachineHealing: "MachineHealing",
    MachineStep: "MachineStep",
    Stability: "Stability",
    StickSlipStability: "StickSlipStability",
    State: "State",
    BlockEnergy: "Energy",
    InterfaceEnergy: "InterfaceEnergy",
    AnyEnergy: "Energy | InterfaceEnergy",
    Equilibria: "Equilibria",
    Potential: "Potential",
    Sizes: "Sizes",
    Course: "Course",
    Events: "Events",
    Labels: "dict[str, Label]",
    Values: "dict[str, Any]",
    Names: "Iterator[str]",
    SlipRule: "Literal['reset', 'overdamped', 'arrest'] | Damped | Inertial",
    MasterEquation: "MasterEquation",
    Block: "Block",
    BlockModel: "MasterEquation | Transport | Ensemble",
    SimulatedModel: "Deformable | Block | Model",
    Same: "Self",
    NumberOrArray: "float | _Array",
    StaticFrictionOrArray: "StaticFriction | _Array",
}

words! {
    StartWord: "Literal['conditional', 'relaxed', 'steady']",
    DisorderWord: "Literal['annealed', 'quenched']",
    BarrierWord: "Literal['elastic', 'bell', 'catastrophe']",
    HazardWord: "Literal['joint', 'additive']",
    EdgesWord: "Literal['open', 'periodic']",
    LoadingWord: "Literal['uniform', 'edge']",
    CellSlipWord: "Literal['reset', 'overdamped']",
    SlidingDirectionWord: "Literal['columns', 'rows']",
    RegimeWord: "Literal['smooth', 'transient', 'persistent', 'runaway', 'undecided']",
}
