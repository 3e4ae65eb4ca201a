//! Rate-and-state friction behind the spring of a machine, fitted to a velocity step.

use asperity::rate_state::{MachineStep, StateLaw};
use pyo3::prelude::*;
use serde::Deserialize;

use crate::argument::{Argument, Real, Whole};
use crate::convert;
use crate::watch::watched;
use crate::{typed, values};

/// The law of the state variables.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum LawWord {
    Ageing,
    Slip,
}

/// The law of the state variables, by its word.
pub fn law_of(law: Argument<String>) -> PyResult<StateLaw> {
    Ok(match convert::word("law", &law.get("law")?)? {
        LawWord::Ageing => StateLaw::Ageing,
        LawWord::Slip => StateLaw::Slip,
    })
}

/// Fits rate-and-state friction, solved with the spring of the machine, to any curve of a velocity step, computed or
/// measured.
///
/// The load point moves at v_0 up to the displacement 0, and at v from there on. F = F_0 + a ln(V/v_0) + the sum of
/// b_i ln(v_0 theta_i/D_i) over one or two state variables, and dF/dX_T = K (1 - V/v) with the velocity V of the slider.
/// Least squares by the method of Levenberg and Marquardt. The misfit is stated, and no errors: what a fit leaves of a
/// computed curve is what the equation does not describe (read_velocity_step gives errors, without a spring).
///
/// Parameters
/// ----------
/// displacement
///     Rising displacements of the load point relative to the step, a length; those below 0 give F_0.
/// force
///     The forces there.
/// ratio
///     v/v_0, above 0 and not 1.
/// stiffness
///     The stiffness K of the machine, a force per length, above 0.
/// law
///     "ageing", with d(theta)/dt = 1 - V theta/D, or "slip", with d(theta)/dt = -(V theta/D) ln(V theta/D).
/// states
///     The number of state variables, 1 or 2.
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// MachineStep
///
/// Raises
/// ------
/// ValueError
///     For a ratio or a stiffness that is not above 0, a ratio of 1, another word as law, states other than 1 or 2,
///     lists of different lengths or with numbers that are not finite, displacements that do not rise, fewer than 8
///     points after the step, and a force that is constant, or for which the slider runs away in every fit. The misfit
///     tells whether another force is described.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> displacement = np.concatenate([np.linspace(-1, 0, 11), np.linspace(0.02, 5, 250)])
/// >>> force = np.where(displacement < 0, 1.0, 1.0 + 0.02 - 0.03 * (1.0 - np.exp(-displacement)))
/// >>> found = asp.fit_velocity_step(displacement, force, np.e, stiffness=10.0, law='slip')
/// >>> bool(found.a > 0.01 and found.b[0] > found.a)
/// True
#[pyfunction]
#[pyo3(signature = (
    displacement: "ArrayLike", force: "ArrayLike", ratio, stiffness, *, law: "Literal['ageing', 'slip']" = Argument::text("ageing"),
    states = Whole::new(1), progress: "_Progress" = None
), text_signature = "(displacement, force, ratio, stiffness, *, law='ageing', states=1, progress=None)")]
#[expect(clippy::too_many_arguments)]
pub fn fit_velocity_step<'py>(
    py: Python<'py>,
    displacement: &Bound<'py, PyAny>,
    force: &Bound<'py, PyAny>,
    ratio: Real,
    stiffness: Real,
    law: Argument<String>,
    states: Whole,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<typed::MachineStep<'py>> {
    let ratio = ratio.get("ratio")?;
    let stiffness = stiffness.get("stiffness")?;
    let law = law_of(law)?;
    let displacement = convert::list("displacement", displacement)?;
    let force = convert::list("force", force)?;
    let states = states.get("states")?;
    let found = watched(progress, py, |monitor| {
        MachineStep::read(&displacement, &force, ratio, stiffness, (law, states), monitor)
    })?;
    let fitted = found.forces(&displacement);
    values::machine_step(py, &found, fitted)
}
