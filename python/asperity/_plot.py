"""Figures by matplotlib."""

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from numpy.typing import NDArray

    from asperity._core import Pull, Record


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


def new_axes() -> "Axes":
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install 'asperity[plot]'") from error
    return plt.subplots()[1]


def axis(name: str, units: str) -> str:
    return name if units == "1" else f"{name} ({units})"
