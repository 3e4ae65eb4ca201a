//! Rate-and-state friction behind the spring of a machine, fitted to slide–hold–slide tests.

use asperity::rate_state::{HoldTests, MachineHealing};
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real};
use crate::convert;
use crate::machine_step::law_of;
use crate::watch::watched;
use crate::{typed, values};

/// Fits rate-and-state friction, solved with the spring of the machine, to slide-hold-slide tests, computed or measured.
///
/// The load point moves at v, rests for the time of the hold, and moves at v again. In the hold the slider creeps on and
/// unloads the spring; after it the force is highest where the slider has reached v. Both depend on the stiffness of the
/// machine and on v. b and D are found by least squares, by the method of Levenberg and Marquardt, and a too if it is not
/// given. The misfit is stated, and no errors: what a fit leaves of a computed curve is what the equation does not describe
/// (read_healing gives errors of the growth per decade, without a spring).
///
/// Parameters
/// ----------
/// hold
///     Hold times, a list of at least 4 numbers above 0.
/// force
///     The highest force after each hold.
/// before
///     The force F_0 of steady sliding before the holds; 0 if forces are differences from it.
/// velocity
///     The velocity v of the load point before and after the holds, above 0.
/// stiffness
///     The stiffness K of the machine, a force per length, above 0.
/// held
///     The force at the end of each hold, if it is known. It is needed without a: peaks alone do not determine a.
/// a
///     The direct effect a, if it is known, for example of a velocity step (fit_velocity_step), above 0.
/// law
///     "ageing", with d(theta)/dt = 1 - V theta/D, or "slip", with d(theta)/dt = -(V theta/D) ln(V theta/D).
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// MachineHealing
///
/// Raises
/// ------
/// ValueError
///     For fewer than 4 holds, holds, a velocity, a stiffness or a that are not above 0, another number of forces than of
///     holds, numbers that are not finite, another word as law, neither a nor held, and forces that do not differ from F_0
///     or for which the slider runs away in every fit. The misfit tells whether other forces are described.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> hold = np.array([1.0, 10.0, 100.0, 1000.0, 10000.0])
/// >>> force = 0.6 + 0.01 * np.log1p(hold / 2.0)
/// >>> found = asp.fit_healing(hold, force, 0.6, velocity=1.0, stiffness=0.01, a=0.008)
/// >>> round(found.b, 3)
/// 0.01
#[pyfunction]
#[pyo3(signature = (
    hold: "ArrayLike", force: "ArrayLike", before, velocity, stiffness, *, held: "ArrayLike | None" = None, a = None,
    law: "Literal['ageing', 'slip']" = Argument::text("ageing"), progress: "_Progress" = None
), text_signature = "(hold, force, before, velocity, stiffness, *, held=None, a=None, law='ageing', progress=None)")]
#[expect(clippy::too_many_arguments)]
pub fn fit_healing<'py>(
    py: Python<'py>,
    hold: &Bound<'py, PyAny>,
    force: &Bound<'py, PyAny>,
    before: Real,
    velocity: Real,
    stiffness: Real,
    held: Option<&Bound<'py, PyAny>>,
    a: Option<Real>,
    law: Argument<String>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<typed::MachineHealing<'py>> {
    let before = before.get("before")?;
    let velocity = velocity.get("velocity")?;
    let stiffness = stiffness.get("stiffness")?;
    let direct = a.get("a")?;
    let law = law_of(law)?;
    let (hold, force) = (convert::list("hold", hold)?, convert::list("force", force)?);
    let held = held.map(|held| convert::list("held", held)).transpose()?;
    let tests = HoldTests { hold: &hold, peak: &force, held: held.as_deref(), before, velocity, stiffness };
    let found = watched(progress, py, |monitor| MachineHealing::read(&tests, law, direct, monitor))?;
    values::machine_healing(py, &found, &hold)
}
