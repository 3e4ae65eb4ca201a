"""Pictures by matplotlib."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from asperity._core import Record


def force(record: "Record", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """Draws the force along the pull or the drive, with the kinetic friction and on a pull the static one."""
    if ax is None:
        ax = new_axes()
    name, along = ("drive", "X_T") if "drive" in record else ("position", "X")
    (line,) = ax.plot(record[name], record.force, **style)
    peak = getattr(record, "static_friction", None)
    if peak is not None and name == "position":
        ax.plot(peak.position, peak.force, "o", color=line.get_color())
    steady = getattr(record, "kinetic_friction", None)
    if steady is not None:
        ax.axhline(steady, linestyle="--", linewidth=0.8, color=line.get_color())
    ax.set_xlabel(axis(along, record.labels[name].units))
    ax.set_ylabel(axis("F", record.labels["force"].units))
    return ax


def new_axes() -> "Axes":
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install 'asperity[plot]'") from error
    return plt.subplots()[1]


def axis(name: str, units: str) -> str:
    return name if units == "1" else f"{name} ({units})"
