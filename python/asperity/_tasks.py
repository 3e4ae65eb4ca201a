"""Tasks as functions of descriptions.

Each is the task of a scenario, computed by what `asperity.run` uses.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast, overload

import numpy as np

from asperity._arguments import numbers, table
from asperity._core import Block, Ensemble, Interface, Lattice, MasterEquation, run
from asperity._task_results import (
    Comparison,
    CreepCurves,
    DistributionDistance,
    FirstBreaks,
    HealingLaw,
    HoldCurve,
    StabilityCurve,
    VelocityCurve,
    VelocityLimits,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    from numpy.typing import ArrayLike, NDArray

    from asperity._core import Contacts, Result

    _Array: TypeAlias = NDArray[np.float64]
    _Progress: TypeAlias = Callable[[float], object] | bool | None


def _array(result: "Result", name: str) -> "_Array | None":
    return result.get(name)


def _given(**tables: Any) -> dict[str, Any]:
    return {name: value for name, value in tables.items() if value is not None}


def _measured(along: str, points: "tuple[ArrayLike, ArrayLike] | None") -> dict[str, Any]:
    """The table of a measured curve: forces against velocities or hold times."""
    if points is None:
        return {}
    if not isinstance(points, tuple | list) or len(points) != 2:
        raise TypeError(f"measured: expected two lists, {along} and force, got {type(points).__name__}")
    place, force = (
        numbers(name, values).ravel() for name, values in zip((along, "force"), points, strict=True)
    )
    return {"compare": {along: place, "force": force}}


def _residual(result: "Result") -> float | None:
    """The distance of a measured curve, if there is one."""
    return cast("float | None", result.summary.get("compare", {}).get("residual_rms"))


def _sampled(ensemble: "Mapping[str, Any] | None") -> dict[str, Any]:
    return {} if ensemble is None else {"ensemble": dict(table("ensemble", ensemble, "its keys"))}


def _solved(tolerance: float | None) -> dict[str, Any]:
    return {} if tolerance is None else {"master_equation": {"tolerance": tolerance}}


def _between(span: "tuple[float, float]") -> dict[str, float]:
    try:
        low, high = span
    except (TypeError, ValueError):
        raise TypeError(f"span: expected the lowest and the highest value, got {span!r}") from None
    return {"from": low, "to": high}


def _along(velocities: "ArrayLike | None", span: "tuple[float, float] | None", points: int) -> dict[str, Any]:
    if (velocities is None) == (span is None):
        found = "neither" if span is None else "both"
        raise TypeError(f"velocities: expected either velocities or a span, got {found}")
    if span is None:
        return {"velocities": np.atleast_1d(np.asarray(velocities))}
    return {**_between(span), "points": points}


@overload
def velocity_curve(
    contacts: "Contacts",
    velocities: float,
    *,
    span: None = None,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> float: ...
@overload
def velocity_curve(
    contacts: "Contacts",
    velocities: "ArrayLike | None" = None,
    *,
    span: "tuple[float, float] | None" = None,
    points: int = 41,
    temperatures: "list[float] | None" = None,
    ensemble: "Mapping[str, Any] | None" = None,
    measured: "tuple[ArrayLike, ArrayLike] | None" = None,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> VelocityCurve: ...
def velocity_curve(
    contacts: "Contacts",
    velocities: "ArrayLike | None" = None,
    *,
    span: "tuple[float, float] | None" = None,
    points: int = 41,
    temperatures: "list[float] | None" = None,
    ensemble: "Mapping[str, Any] | None" = None,
    measured: "tuple[ArrayLike, ArrayLike] | None" = None,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> "float | VelocityCurve":
    """Kinetic friction F_k of contacts against velocity.

    Parameters
    ----------
    contacts : Contacts
        The contacts.
    velocities : float or array_like, optional
        Velocities above 0, in increasing order; or one velocity.
    span : (float, float), optional
        Instead of velocities, the lowest and the highest one.
    points : int
        The number of velocities of a span, evenly spaced in their logarithm, with both ends.
    temperatures : list of float, optional
        Temperatures, a curve for each, instead of that of the contacts.
    ensemble : mapping, optional
        `size`, `seed` and `disorder` of an ensemble beside the master equation.
    measured : (array_like, array_like), optional
        Measured velocities above 0 and forces, which are compared with F_k at these velocities; not with
        temperatures.
    tolerance : float, optional
        As for MasterEquation.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    float or VelocityCurve
        The force for one velocity, otherwise the curve with its limits; with the background force.

    Raises
    ------
    ValueError
        For velocities or temperatures that are not above 0, velocities or a span that do not rise, fewer
        than 2 points, measured forces beside temperatures or of another number than velocities, an ensemble
        without contacts, and a tolerance that is not from 1e-12 to 1e-2.
    TypeError
        For velocities and a span, or neither; for one velocity with temperatures, an ensemble or measured.

    Examples
    --------
    >>> import asperity as asp
    >>> warm = asp.Contacts(asp.Gaussian(1.0, 0.05), temperature=asp.Temperature(0.02, 1.0))
    >>> round(asp.velocity_curve(warm, 1e-2), 4)
    0.4876
    >>> asp.velocity_curve(warm, [1e-4, 1.0]).kinetic_friction.round(4).tolist()
    [0.4374, 0.501]
    >>> curve = asp.velocity_curve(warm, span=(1e-4, 1e-1), points=4)
    >>> curve.kinetic_friction.round(3).tolist()
    [0.437, 0.463, 0.488, 0.499]
    >>> round(curve.limits[0].fast, 5)
    0.50125
    """
    curve = _along(velocities, span, points)
    if velocities is not None and np.ndim(velocities) == 0:
        if any(other is not None for other in (temperatures, ensemble, measured)):
            raise TypeError(
                "velocities: expected a list beside temperatures, an ensemble or measured, got one velocity"
            )
        scenario = {"contacts": contacts, "velocity_curve": curve} | _solved(tolerance)
        return float(run(scenario, progress=progress)["kinetic_friction"][0])
    curve |= _given(temperatures=temperatures)
    scenario = {"contacts": contacts, "velocity_curve": curve} | _sampled(ensemble) | _solved(tolerance)
    result = run(scenario | _measured("velocity", measured), progress=progress)
    limits = [
        VelocityLimits(one.get("temperature"), one["fast"], one.get("slow"), one.get("viscosity"))
        for one in result.summary["limits"]
    ]
    return VelocityCurve(
        result,
        result["velocity"],
        result["kinetic_friction"],
        _array(result, "temperature"),
        tuple(limits),
        _array(result, "ensemble_force"),
        _array(result, "ensemble_error"),
        _array(result, "compared_residual"),
        _residual(result),
    )


def stability(
    contacts: "Contacts",
    velocities: "ArrayLike | None" = None,
    *,
    span: "tuple[float, float] | None" = None,
    points: int = 41,
    block: "Block | None" = None,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> StabilityCurve:
    """Critical stiffnesses of contacts against velocity, and the growth of deviations from steady sliding.

    Parameters
    ----------
    contacts : Contacts
        The contacts.
    velocities : array_like, optional
        Velocities above 0, in increasing order.
    span : (float, float), optional
        Instead of velocities, the lowest and the highest one.
    points : int
        The number of velocities of a span, evenly spaced in their logarithm, with both ends.
    block : Block, optional
        A block with Damped or Inertial slips: critical stiffnesses are those for its mass and damping,
        and the growth of deviations is that at its stiffness. Its model is not used.
    tolerance : float, optional
        As for MasterEquation.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    StabilityCurve
        The critical stiffnesses at the velocities.

    Raises
    ------
    ValueError
        For velocities that are not above 0, velocities or a span that do not rise, fewer than 2 points, a
        block whose slips are neither Damped nor Inertial over time-dependent contacts, and a tolerance that
        is not from 1e-12 to 1e-2.
    TypeError
        For velocities and a span, or neither, and for a block that is no Block.

    Examples
    --------
    >>> import asperity as asp
    >>> ageing = asp.Logarithmic(growth=0.1, time=1.0)
    >>> curve = asp.stability(asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=ageing), [0.1, 1.0])
    >>> curve.critical_stiffness_sliding.shape
    (2,)
    """
    curve = _along(velocities, span, points) | {"stability": True}
    scenario: dict[str, Any] = {"contacts": contacts, "velocity_curve": curve} | _solved(tolerance)
    if block is not None:
        if not isinstance(block, Block):
            raise TypeError(f"block: expected a Block, got {type(block).__name__}")
        scenario["block"] = {"stiffness": block.stiffness, "slip": block.slip}
    result = run(scenario, progress=progress)
    return StabilityCurve(
        result,
        result["velocity"],
        result["kinetic_friction"],
        result["critical_stiffness"],
        result["critical_stiffness_sliding"],
        _array(result, "growth_rate"),
        _array(result, "growth_frequency"),
        result.summary["stability"].get("unstable"),
    )


def hold_curve(
    contacts: "Contacts",
    span: "tuple[float, float]",
    velocity: float,
    *,
    points: int = 13,
    ensemble: "Mapping[str, Any] | None" = None,
    measured: "tuple[ArrayLike, ArrayLike] | None" = None,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> HoldCurve:
    """Static friction against hold time: slide–hold–slide tests of contacts under a rigid slider.

    The slider slides until sliding is steady, is held, and slides again until the force has peaked.

    Parameters
    ----------
    contacts : Contacts
        The contacts.
    span : (float, float)
        The shortest and the longest hold time, above 0.
    velocity : float
        The velocity before and after the holds, above 0.
    points : int
        The number of hold times, evenly spaced in their logarithm, with both ends.
    ensemble : mapping, optional
        `size`, `seed` and `disorder` of an ensemble of single contacts beside the master equation.
    measured : (array_like, array_like), optional
        Measured hold times above 0 and static frictions, as those of read_healing, which are compared with
        the computed ones at these times.
    tolerance : float, optional
        As for Transport.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    HoldCurve
        Static friction after the holds, and its growth.

    Raises
    ------
    ValueError
        For a span that does not rise from above 0, a velocity that is not above 0, fewer than 2 points,
        measured forces of another number than hold times, an ensemble without contacts, and a tolerance that
        is not from 1e-12 to 1e-2.

    Examples
    --------
    >>> import asperity as asp
    >>> ageing = asp.Logarithmic(growth=0.02, time=1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=ageing)
    >>> curve = asp.hold_curve(contacts, (10.0, 1e4), velocity=0.1, points=4)
    >>> curve.hold.round(6).tolist()
    [10.0, 100.0, 1000.0, 10000.0]
    >>> bool((curve.static_friction > curve.kinetic_friction).all())
    True
    >>> measured = ([30.0, 3000.0], [0.6, 0.7])
    >>> compared = asp.hold_curve(contacts, (10.0, 1e4), velocity=0.1, points=4, measured=measured)
    >>> round(compared.residual_rms, 3)
    0.036
    """
    holds = _between(span) | {"points": points, "velocity": velocity}
    scenario = {"contacts": contacts, "hold_curve": holds} | _sampled(ensemble) | _solved(tolerance)
    result = run(scenario | _measured("hold", measured), progress=progress)
    found = result.summary["hold_curve"]
    growth = HealingLaw(
        found.get("healing_per_decade"),
        found.get("healing_relative"),
        found.get("healing_cutoff"),
        found.get("at_one"),
        found.get("residual_relative"),
    )
    return HoldCurve(
        result,
        result["hold"],
        result["static_friction"],
        result["peak_position"],
        result["held_force"],
        found["velocity"],
        found["kinetic_friction"],
        growth,
        _array(result, "ensemble_force"),
        _array(result, "ensemble_error"),
        _array(result, "compared_residual"),
        _residual(result),
    )


def creep(
    contacts: "Contacts",
    forces: "ArrayLike",
    duration: float,
    *,
    loading_rate: float | None = None,
    points: int = 201,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> CreepCurves:
    """Slip in time under constant forces, up to the failure of the slider (static fatigue).

    The slider has no mass and no drag: the contacts, relaxed at first, carry the force at every time.
    It advances as contacts break, until an advance at once does not raise their force any more.

    Parameters
    ----------
    contacts : Contacts
        The contacts, with a temperature or another dependence on time.
    forces : array_like
        One constant force or several, above 0.
    duration : float
        The time after which a motion without failure ends, above 0.
    loading_rate : float, optional
        The rate at which a force is raised at the start, force per time; at once by default.
    points : int
        The number of points of each creep curve, evenly spaced in slip, with both ends.
    tolerance : float, optional
        As for Transport; 1e-5 by default.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    CreepCurves
        Creep curves and times to failure.

    Raises
    ------
    ValueError
        For no forces, a force, a duration or a loading_rate that is not above 0, fewer than 2 points, and a
        tolerance that is not from 1e-12 to 1e-2.

    Examples
    --------
    >>> import asperity as asp
    >>> warm = asp.Temperature(0.03, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=warm)
    >>> found = asp.creep(contacts, [0.6, 0.7], duration=1000.0)
    >>> found.failure_time.round().tolist()
    [350.0, 22.0]
    """
    task: dict[str, Any] = {
        "forces": np.atleast_1d(numbers("forces", forces)).tolist(),
        "duration": duration,
        "points": points,
    }
    if loading_rate is not None:
        task["loading_rate"] = loading_rate
    result = run({"contacts": contacts, "creep": task} | _solved(tolerance), progress=progress)
    force = result["imposed_force"]

    def known(name: str, shape: "tuple[int, ...]" = force.shape) -> "_Array":
        return result[name] if name in result else np.full(shape, np.nan)

    curve = (len(force), points)
    return CreepCurves(
        result,
        force,
        known("failure_time"),
        known("failure_time_error"),
        result["loaded_position"],
        result["final_position"],
        known("final_velocity"),
        known("slowest_velocity"),
        known("slowest_time"),
        known("creep_time", curve),
        known("creep_position", curve),
        known("creep_velocity", curve),
    )


def healing(
    contacts: "Contacts",
    span: "tuple[float, float]",
    velocity: float,
    *,
    points: int = 13,
    tolerance: float | None = None,
    progress: "_Progress" = None,
) -> HealingLaw:
    """The growth of static friction with the logarithm of the hold time, fitted to a hold curve.

    Parameters
    ----------
    contacts, span, velocity, points, tolerance, progress
        As for hold_curve; 4 holds or more.

    Returns
    -------
    HealingLaw
        The growth per decade and the cutoff time; read_healing finds them in measured holds, with errors.

    Raises
    ------
    ValueError
        As for hold_curve.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.02, time=1.0))
    >>> round(asp.healing(contacts, (10.0, 1e4), velocity=0.1, points=7).per_decade, 3)
    0.045
    """
    curve = hold_curve(contacts, span, velocity, points=points, tolerance=tolerance, progress=progress)
    return curve.healing


def renormalisation(
    interface: "Lattice | Interface", *, runs: int = 8, points: int = 120, progress: "_Progress" = None
) -> FirstBreaks:
    """The distribution of the drives at which coupled contacts break for the first time.

    Parameters
    ----------
    interface : Lattice or Interface
        Relaxed contacts coupled one by one, or in cells of different scales; successive seeds follow its own.
    runs : int
        The number of independent interfaces, each driven until every contact has broken (for cells, all but
        1e-6).
    points : int
        The number of equal intervals of the drive.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    FirstBreaks
        The densities, with means and standard deviations.

    Raises
    ------
    ValueError
        For fewer than 2 runs, points below 1, identical thresholds, stretched contacts, and cells
        without disorder.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> lattice = asp.Lattice(contacts, [40, 40], neighbours=0.025, connection=0.9)
    >>> found = asp.renormalisation(lattice, runs=4)
    >>> round(found.coupling, 6), found.mean < 1.0
    (0.1, True)
    """
    if not isinstance(interface, Lattice | Interface):
        raise TypeError(f"interface: expected a Lattice or an Interface, got {type(interface).__name__}")
    result = interface._first_breaks(runs, points, progress=progress)
    found = result.summary["renormalisation"]

    def compared(name: str) -> DistributionDistance | None:
        return DistributionDistance(**found[name]) if name in found else None

    of_thresholds = compared("thresholds")
    assert of_thresholds is not None
    return FirstBreaks(
        result,
        result["drive"],
        result["measured_density"],
        result["measured_error"],
        result["free_density"],
        _array(result, "mean_field_density"),
        found["coupling"],
        found["critical_coupling"],
        found["mean"]["value"],
        found["mean"]["error"],
        found["std"]["value"],
        found["std"]["error"],
        of_thresholds,
        compared("mean_field"),
    )


def compare(
    model: "MasterEquation | Ensemble",
    position: "ArrayLike",
    force: "ArrayLike",
    *,
    distance: float = 20.0,
    points: int = 2001,
    progress: "_Progress" = None,
) -> Comparison:
    """A measured curve of force beside the computed one.

    Parameters
    ----------
    model : MasterEquation or Ensemble
        The contacts, their initial state and their velocity. Of an ensemble, the master equation is compared
        too.
    position, force : array_like
        The measured positions and forces, of equal length.
    distance : float
        The displacement of the computed pull; points beyond it are not compared.
    points : int
        The number of positions of the computed pull.
    progress : callable or bool, optional
        As for MasterEquation.pull.

    Returns
    -------
    Comparison
        The root mean square of the difference, and the computed pull as `result`.

    Raises
    ------
    ValueError
        For no points, none within the distance of the pull, lists of different lengths or with numbers that
        are not finite, a distance that is not above 0, and fewer than 2 points.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
    >>> round(asp.compare(theory, [0.1, 0.2], [0.1, 0.3], distance=2.0).residual_rms, 6)
    0.070711
    """
    if not isinstance(model, MasterEquation | Ensemble):
        raise TypeError(f"model: expected a MasterEquation or an Ensemble, got {type(model).__name__}")
    place, measured = numbers("position", position).ravel(), numbers("force", force).ravel()
    pull: dict[str, Any] = {"distance": distance, "points": points, "start": model.start}
    scenario: dict[str, Any] = {"contacts": model.contacts, "initial": model.initial, "pull": pull}
    if isinstance(model, Ensemble):
        scenario["ensemble"] = {"size": model.size, "seed": model.seed, "disorder": model.disorder}
    else:
        pull |= _given(velocity=model.velocity)
        scenario |= _solved(model.tolerance)
    scenario["compare"] = {"position": place, "force": measured}
    result = run(scenario, progress=progress)
    found = result.summary["compare"]
    if not found["points"]:
        raise ValueError(
            f"position: expected one from 0 to {distance:.6g}, the distance of the pull, got those from "
            f"{place.min():.6g} to {place.max():.6g}"
        )
    residual = result["compared_residual"]
    return Comparison(result, place, measured, found["points"], residual, found.get("residual_rms"))
