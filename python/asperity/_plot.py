"""Figures by matplotlib."""

import math
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from numpy.typing import NDArray

    from asperity._core import Estimates, Healing, Posterior, Pull, Record, SteadyEstimates, VelocityStep


def draw(record: "Record", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """Plots the force along the pull or the drive, with the kinetic friction, if it is known."""
    if ax is None:
        ax = new_axes()
    line = sliding(record, ax, **style) if "drive" in record else force(record, ax, **style)
    steady = getattr(record, "kinetic_friction", None)
    if steady is not None and math.isfinite(steady):
        ax.axhline(steady, linestyle="--", linewidth=0.8, color=line.get_color())
    return ax


def pull(
    pull: "Pull",
    ax: "Axes | None" = None,
    scatter: "NDArray[np.float64] | None" = None,
    paths: "Sequence[NDArray[np.float64]] | None" = None,
    **style: Any,
) -> "Axes":
    """F(X) with a band of its standard deviation, and sample paths, given as their positions and forces."""
    if ax is None:
        ax = new_axes()
    first = len(ax.lines)
    draw(pull, ax, **style)
    color = ax.lines[first].get_color()
    if scatter is not None:
        low, high = pull.force - scatter, pull.force + scatter
        ax.fill_between(pull.position, low, high, color=color, alpha=0.2, linewidth=0)
    if paths is not None:
        positions, forces = paths
        ax.plot(positions, forces.T, color=color, alpha=0.6, linewidth=0.6)
    return ax


def fit(fit: "Estimates", axes: "Sequence[Axes] | None" = None, **style: Any) -> "tuple[Axes, ...]":
    """The expected force with a band of two standard deviations, the readings, and the whitened residuals."""
    readings = fit.readings
    measured = "force" in readings
    axes = tuple(axes) if axes is not None else new_panels(2 if measured else 1)
    position, expected, reach = readings["position"], readings["expected"], 2 * readings["std"]
    above = axes[0]
    numbers = readings["curve"] if "curve" in readings else 0 * position
    for number in sorted(set(numbers.tolist())):
        of = numbers == number
        (line,) = above.plot(position[of], expected[of], **style)
        style = {**style, "color": line.get_color()}
        above.fill_between(
            position[of],
            (expected - reach)[of],
            (expected + reach)[of],
            color=line.get_color(),
            alpha=0.2,
            linewidth=0,
        )
    above.set_xlabel(axis("position", readings.labels["position"].units))
    above.set_ylabel(axis("force", readings.labels["expected"].units))
    if not measured:
        return axes[:1]
    above.plot(position, readings["force"], "k.", markersize=2)
    below = axes[1]
    below.axhspan(-2, 2, color=line.get_color(), alpha=0.2, linewidth=0)
    below.plot(position, readings["whitened"], "k.", markersize=2)
    above.set_xlabel("")
    below.set_xlabel(axis("position", readings.labels["position"].units))
    below.set_ylabel("whitened residual")
    return axes


def fit_spectrum(fit: "SteadyEstimates", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The periodogram of a record with its expectation, on logarithmic axes."""
    if ax is None:
        ax = new_axes()
    spectrum = fit.spectrum
    ax.loglog(spectrum["wave_number"], spectrum["periodogram"], "k.", markersize=1)
    curve(spectrum, ax, {"wave_number": "q", "expected": "S"}, **style)
    return ax


def corner(posterior: "Posterior") -> "NDArray[Any]":
    """Histograms of the numbers on the diagonal, and pairs of draws below it."""
    draws = {name: values.ravel() for name, values in posterior.draws.items()}
    count = len(draws)
    size = 2.2 * max(count, 2)
    axes: NDArray[Any] = pyplot().subplots(count, count, sharex="col", squeeze=False, figsize=(size, size))[1]
    for row, (below, heights) in enumerate(draws.items()):
        for column, (left, values) in enumerate(draws.items()):
            ax = axes[row, column]
            if column > row:
                ax.set_axis_off()
                continue
            if column == row:
                ax.hist(values, bins=30, color="tab:blue")
                ax.set_yticks([])
            else:
                ax.plot(values, heights, ".", markersize=1, color="tab:blue", alpha=0.4)
                if column == 0:
                    ax.set_ylabel(below)
            if row == count - 1:
                ax.set_xlabel(left)
    return axes


def force(record: "Record", ax: "Axes", **style: Any) -> "Line2D":
    """F(X), with its maximum as a dot, if it is known."""
    line = curve(record, ax, {"position": "X", "force": "F"}, **style)
    peak = getattr(record, "static_friction", None)
    if peak is not None:
        ax.plot(peak.position, peak.force, "o", color=line.get_color())
    return line


def sliding(record: "Record", ax: "Axes", **style: Any) -> "Line2D":
    """The force of the spring or the interface against the drive; an imposed force against the position."""
    if record.labels["drive"].quantity == "force":
        return curve(record, ax, {"position": "X", "drive": "F"}, **style)
    force = "spring_force" if "spring_force" in record else "force"
    return curve(record, ax, {"drive": "$X_T$", force: "F"}, **style)


def curve(record: "Record", ax: "Axes", names: dict[str, str], **style: Any) -> "Line2D":
    """The second of two variables against the first, with names for the axes."""
    x, y = names
    (line,) = ax.plot(record[x], record[y], **style)
    ax.set_xlabel(axis(names[x], record.labels[x].units))
    ax.set_ylabel(axis(names[y], record.labels[y].units))
    return line


def velocity_step(step: "VelocityStep", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The measured force around a velocity step, with the fit before the step and from the peak on."""
    if ax is None:
        ax = new_axes()
    position, fitted = step.position, step.fitted
    ax.plot(position, step.force, ".", markersize=3, color="0.6")
    style = {"color": "tab:red", **style}
    after = position >= 0.0
    for part in (~after, after):
        ax.plot(position[part], fitted[part], **style)
    ax.set_xlabel("Displacement since the step")
    ax.set_ylabel("F")
    return ax


def healing(healing: "Healing", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """Static friction against the logarithm of the hold time, with the fit at 200 hold times."""
    if ax is None:
        ax = new_axes()
    ax.plot(healing.hold, healing.force, "o", color="0.4")
    low, high = math.log10(min(healing.hold)), math.log10(max(healing.hold))
    times = [10 ** (low + (high - low) * i / 199) for i in range(200)]
    ax.plot(times, healing(times), **{"color": "tab:red", **style})
    ax.set_xscale("log")
    ax.set_xlabel("Hold time")
    ax.set_ylabel("$F_s$")
    return ax


def new_axes() -> "Axes":
    axes: Axes = pyplot().subplots()[1]
    return axes


def new_panels(count: int) -> "tuple[Axes, ...]":
    """Axes below each other, the first three times as high as the others."""
    heights = [3, *(1 for _ in range(count - 1))]
    panels = pyplot().subplots(count, sharex=True, squeeze=False, height_ratios=heights)[1]
    return tuple(panels[:, 0])


def pyplot() -> ModuleType:
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install 'asperity[plot]'") from error
    return plt


def axis(name: str, units: str) -> str:
    return name if units == "1" else f"{name} ({units})"
