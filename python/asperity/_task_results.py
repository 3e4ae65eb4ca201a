"""Results of tasks, with their numbers as fields."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from asperity import _pictures, _show

if TYPE_CHECKING:
    from pathlib import Path
    from typing import TypeAlias

    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray
    from xarray import Dataset

    from asperity._core import Result

    _Array: TypeAlias = NDArray[np.float64]


class VelocityLimits(NamedTuple):
    """The limits of a curve of kinetic friction against velocity.

    Examples
    --------
    >>> import asperity as asp
    >>> heat = asp.Temperature(0.05, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=heat)
    >>> limits = asp.velocity_curve(contacts, span=(0.1, 1.0), points=3).limits[0]
    >>> round(limits.fast, 3)
    0.505
    """

    temperature: float | None
    """The temperature of the curve, an energy; None where there is one curve."""
    fast: float
    """F_k for v → ∞."""
    slow: float | None
    """F_k for v → 0; None where there is no plateau."""
    viscosity: float | None
    """F_k/v for v → 0; None for contacts without temperature."""


class HealingLaw(NamedTuple):
    """The growth of static friction with the logarithm of the hold time: F_s = F_s(0) + β ln(1 + t/t_c).

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.05, time=1.0))
    >>> law = asp.hold_curve(contacts, span=(1.0, 1e3), velocity=0.1, points=7).healing
    >>> bool(law.per_decade > 0.0)
    True
    """

    per_decade: float | None
    """β ln 10, the growth per factor of ten in hold time, a force; None where it is not logarithmic."""
    relative: float | None
    """That growth divided by the kinetic friction."""
    cutoff: float | None
    """The cutoff time t_c; None where all holds are much longer."""
    at_one: float | None
    """The fitted static friction after a hold of 1, a force."""
    residual_relative: float | None
    """The root-mean-square residual of the fit, relative to the range of static friction."""


class DistributionDistance(NamedTuple):
    """A distribution compared with that of the first breaks.

    Examples
    --------
    >>> import asperity as asp
    >>> chain = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.2)), [8], neighbours=0.1, connection=0.1)
    >>> found = asp.renormalisation(chain, runs=4).of_thresholds
    >>> bool(found.distance > 0.0)
    True
    """

    mean: float
    """Its mean, a length."""
    std: float
    """Its standard deviation, a length."""
    distance: float
    """Its Kolmogorov–Smirnov distance from the distribution of first breaks."""


@dataclass(frozen=True)
class TaskResult:
    """The result of a task, with its numbers as fields.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.05, 1.0))
    >>> isinstance(asp.velocity_curve(contacts, span=(0.1, 1.0), points=3), asp.TaskResult)
    True
    """

    result: "Result"
    """All variables and the summary, as `asperity.run` returns them."""

    @property
    def summary(self) -> dict[str, Any]:
        """The summary, as in `summary.json`."""
        return self.result.summary

    @property
    def warnings(self) -> list[str]:
        """Warnings about valid but surprising input or results."""
        found: list[str] = self.result.summary.get("warnings", [])
        return found

    @property
    def pictures(self) -> tuple[str, ...]:
        """The kinds of pictures that plot() draws; the first is its default."""
        return self.result.pictures

    def plot(self, ax: "Axes | None" = None, *, kind: str | None = None, **style: Any) -> "Axes":
        """Plots the result as Result.plot does.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default, with the residuals of measured points on axes below.
        kind : str, optional
            One of `pictures`.
        **style
            Arguments of the plot() of the axes.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """
        return _pictures.draw(self.result, ax, kind, **style)

    def to_xarray(self) -> "Dataset":
        """The variables as an xarray.Dataset.

        Returns
        -------
        xarray.Dataset
            As Result.to_xarray.
        """
        return self.result.to_xarray()

    def save(self, folder: "str | Path") -> None:
        """Writes the folder that `asperity run` would write, without figures.

        Parameters
        ----------
        folder : str or Path
            The folder; open_result reads it.

        Raises
        ------
        FileExistsError
            If there is a folder that asperity did not make.
        OSError
            For errors of the system.
        """
        self.result.save(folder)

    def __repr__(self) -> str:
        rows = _show.rows(self.result)
        return _show.listed(f"<asperity.{type(self).__name__}>", rows)

    def _repr_html_(self) -> str:
        return _show.table(type(self).__name__, _show.rows(self.result))


@dataclass(frozen=True, repr=False)
class VelocityCurve(TaskResult):
    """Kinetic friction against velocity, as velocity_curve returns it.

    Examples
    --------
    >>> import asperity as asp
    >>> heat = asp.Temperature(0.05, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=heat)
    >>> curve = asp.velocity_curve(contacts, span=(0.1, 1.0), points=3)
    >>> curve.velocity.shape, curve.kinetic_friction.shape
    ((3,), (3,))
    """

    velocity: "_Array"
    """The velocities, shape (n,)."""
    kinetic_friction: "_Array"
    """F_k, a force, shape (n,), or (temperatures, n)."""
    temperature: "_Array | None"
    """The temperatures, an energy, shape (temperatures,); None where there is one curve."""
    limits: tuple[VelocityLimits, ...]
    """The limits of each curve."""
    ensemble_force: "_Array | None"
    """F_k of the ensemble, shape of `kinetic_friction`; None without one."""
    ensemble_error: "_Array | None"
    """Its standard error."""
    residual: "_Array | None"
    """Measured minus computed force, shape (measured,); None if none was measured."""
    residual_rms: float | None
    """The root mean square of measured minus computed force; None if none was measured."""


@dataclass(frozen=True, repr=False)
class StabilityCurve(TaskResult):
    """Stability of steady sliding against velocity.

    Examples
    --------
    >>> import asperity as asp
    >>> heat = asp.Temperature(0.05, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=heat)
    >>> asp.stability(contacts, span=(0.1, 1.0), points=2).velocity
    array([0.1, 1. ])
    """

    velocity: "_Array"
    """The velocities, shape (n,)."""
    kinetic_friction: "_Array"
    """F_k, a force, shape (n,)."""
    critical_stiffness: "_Array"
    """-min F' of a pull at each velocity from the initial state, force per length, shape (n,)."""
    critical_stiffness_sliding: "_Array"
    """Stiffness above which steady sliding is stable, shape (n,): 0 where it always is, inf where never."""
    growth_rate: "_Array | None"
    """Growth rate of deviations from steady sliding of the block, per time, shape (n,); None without one."""
    growth_frequency: "_Array | None"
    """The angular frequency at which they grow, per time, shape (n,); None without a block."""
    unstable: int | None
    """The number of velocities at which steady sliding of the block is unstable; None without a block."""


@dataclass(frozen=True, repr=False)
class HoldCurve(TaskResult):
    """Static friction against hold time in slide–hold–slide tests.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.05, time=1.0))
    >>> curve = asp.hold_curve(contacts, span=(1.0, 1e3), velocity=0.1, points=4)
    >>> curve.hold.shape, curve.static_friction.shape
    ((4,), (4,))
    """

    hold: "_Array"
    """The hold times, shape (n,)."""
    static_friction: "_Array"
    """The highest force after each hold, shape (n,)."""
    peak_position: "_Array"
    """The displacement from the hold to that force, a length, shape (n,)."""
    held_force: "_Array"
    """The force at the end of each hold, shape (n,)."""
    velocity: float
    """The velocity before and after the holds."""
    kinetic_friction: float
    """F_k at that velocity."""
    healing: HealingLaw
    """The growth with the logarithm of the hold time."""
    ensemble_force: "_Array | None"
    """The force of the ensemble at the peaks, shape (n,); None without one."""
    ensemble_error: "_Array | None"
    """Its standard error."""
    residual: "_Array | None"
    """Measured minus computed static friction, shape (measured,); None if none was measured."""
    residual_rms: float | None
    """The root mean square of measured minus computed static friction; None if none was measured."""


@dataclass(frozen=True, repr=False)
class CreepCurves(TaskResult):
    """Slip under constant forces, and the time to failure.

    Examples
    --------
    >>> import asperity as asp
    >>> heat = asp.Temperature(0.05, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=heat)
    >>> asp.creep(contacts, forces=[0.6], duration=1e3).force
    array([0.6])
    """

    force: "_Array"
    """The forces, shape (n,)."""
    failure_time: "_Array"
    """Times to failure, shape (n,): 0 if the slider fails at once, nan if it does not in the duration."""
    failure_time_error: "_Array"
    """Their estimated errors, shape (n,)."""
    loaded_position: "_Array"
    """The positions at the end of loading, a length, shape (n,)."""
    final_position: "_Array"
    """The positions at failure or at the end, a length, shape (n,)."""
    final_velocity: "_Array"
    """The velocities at the end, shape (n,); nan where the slider fails."""
    slowest_velocity: "_Array"
    """The lowest velocities after loading, those of secondary creep where failure follows, shape (n,)."""
    slowest_time: "_Array"
    """The times of the lowest velocities, shape (n,)."""
    time: "_Array"
    """Times of the creep curves, shape (n, points), evenly spaced in slip; nan where loading fails."""
    position: "_Array"
    """The positions at these times, a length, shape (n, points)."""
    velocity: "_Array"
    """The velocities at these times, shape (n, points); inf at failure."""


@dataclass(frozen=True, repr=False)
class FirstBreaks(TaskResult):
    """The distribution of the drives at which coupled contacts break for the first time.

    Examples
    --------
    >>> import asperity as asp
    >>> chain = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.2)), [8], neighbours=0.1, connection=0.1)
    >>> found = asp.renormalisation(chain, runs=4)
    >>> bool(found.of_thresholds.distance > 0.0)
    True
    """

    drive: "_Array"
    """Middles of n equal intervals of the drive, a length, shape (n,)."""
    density: "_Array"
    """The probability density of first breaks, per length, shape (n,)."""
    error: "_Array"
    """Its standard error, shape (n,)."""
    thresholds: "_Array"
    """The density of the thresholds, which is that of first breaks without coupling, shape (n,)."""
    mean_field: "_Array | None"
    """Density of thresholds renormalised in mean field, shape (n,); None from the critical coupling on."""
    coupling: float
    """κ, the fraction of its stretch that a breaking contact passes on."""
    critical_coupling: float
    """κ_c of the thresholds."""
    mean: float
    """The mean drive of first breaks, a length."""
    mean_error: float
    """Its standard error."""
    std: float
    """The standard deviation of the drives of first breaks, a length."""
    std_error: float
    """Its standard error."""
    of_thresholds: DistributionDistance
    """The distribution of the thresholds compared with that of first breaks."""
    of_mean_field: DistributionDistance | None
    """The mean-field distribution compared with it; None from the critical coupling on."""


@dataclass(frozen=True, repr=False)
class Comparison(TaskResult):
    """A measured curve of force compared with a computed pull.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> measured = [0.5, 1.0, 1.5]
    >>> compared = asp.compare(theory, measured, theory.pull(3.0)(measured))
    >>> bool(compared.residual_rms < 1e-9)
    True
    """

    position: "_Array"
    """The measured positions, a length, shape (n,)."""
    force: "_Array"
    """The measured forces, shape (n,)."""
    points: int
    """The number of measured points within the pull."""
    residual: "_Array"
    """Measured minus computed force, shape (n,); nan where the pull computes none."""
    residual_rms: float | None
    """The root mean square of measured minus computed force at these points; None if there are none."""
