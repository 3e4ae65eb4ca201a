"""Pictures of records by matplotlib: each kind is drawn from the variables that a record has."""

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Concatenate, NamedTuple, TypeAlias

import numpy as np

from asperity import _fit, _plot, _show
from asperity._plot import axes_or_new, axis, colorbar, errors, fit_ends, ink, muted
from asperity._smooth import along_logarithm

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from asperity._core import Record, SteadyEstimates, VelocityCurveEstimates

# Variances of a force below this, relative to the largest: a scatter of less than a thousandth of it.
CERTAIN = 1e-6

Draw: TypeAlias = Callable[Concatenate["Record", "Axes", ...], None]


class Kind(NamedTuple):
    """A kind of picture: what draws it, the variables that it needs, those with which there is none,
    and the least number of their values.
    """

    draw: Draw
    needed: tuple[str, ...]
    refused: tuple[str, ...] = ()
    least: int = 1


def kinds(record: "Record") -> tuple[str, ...]:
    """The pictures that a record has, the one of plot() first."""
    return tuple(
        name
        for name, kind in KINDS.items()
        if all(one in record and record[one].size >= kind.least for one in kind.needed)
        and not any(one in record for one in kind.refused)
    )


def draw(record: "Record", ax: "Axes | None" = None, kind: str | None = None, **style: Any) -> "Axes":
    """Draws a kind of picture, by default the first that the record has."""
    known = kinds(record)
    if kind is None and known:
        kind = known[0]
    if kind is None or kind not in known:
        expected = f"one of {', '.join(known)}" if known else "a record of a task"
        raise ValueError(f"plot.kind: expected {expected}, got {kind}")
    along = next((name for name in RESIDUALS.get(kind, ()) if name in record), None)
    if ax is None and along is not None and "compared_residual" in record:
        ax, below = _plot.new_panels(2)
        KINDS[kind].draw(record, ax, **style)
        residual(record, below, along)
        below.set_xlabel(ax.get_xlabel())
        ax.xaxis.label.set_visible(False)
        return ax
    ax = axes_or_new(ax)
    KINDS[kind].draw(record, ax, **style)
    return ax


def residual(record: "Record", ax: "Axes", along: str) -> None:
    """Measured less computed force against the variable of the measured points."""
    ax.axhline(0.0, color=muted(), linewidth=0.6)
    ax.plot(record[along], record["compared_residual"], ".", color=ink(), markersize=3)
    ax.set_ylabel(axis("", record.labels["compared_residual"].units, "residual"))


RESIDUALS: Mapping[str, tuple[str, ...]] = {
    "force": ("compared_position",),
    "compared": ("compared_position",),
    "velocity_curve": ("compared_velocity",),
    "hold_curve": ("compared_hold",),
}
"""Pictures with measured points and their variable; on new axes they have a panel of residuals."""


def named(record: "Record", ax: "Axes", x: tuple[str, str], y: tuple[str, str]) -> None:
    """Labels of the axes: variables with their symbols."""
    ax.set_xlabel(axis(x[1], record.labels[x[0]].units))
    ax.set_ylabel(axis(y[1], record.labels[y[0]].units))


def force(record: "Record", ax: "Axes", **style: Any) -> None:
    """F(X) with static and kinetic friction, the ensemble and the measured curve."""
    first = len(ax.lines)
    _plot.friction(record, ax, **style)
    color = ax.lines[first].get_color()
    with_others = False
    if "ensemble_force" in record:
        columns = (record[name] for name in ("position", "ensemble_force", "ensemble_error"))
        errors(ax, *(few(column, 201) for column in columns), markersize=2, label="ensemble")
        with_others = True
    elif "force_error" in record:
        low, high = (record["force"] + sign * record["force_error"] for sign in (-1, 1))
        band: dict[str, Any] = {"color": color, "alpha": 0.2, "linewidth": 0}
        ax.fill_between(record["position"], low, high, **band, label=_plot.once(ax, "± error", style))
    with_others = measured(record, ax, "compared_position") or with_others
    if "label" not in style:
        if with_others:
            ax.lines[first].set_label("master equation")
        _plot.legend_above(ax)


def measured(record: "Record", ax: "Axes", along: str, size: float = 4) -> bool:
    """The points of a measured curve against a variable, if the record has one; whether it has."""
    if along not in record:
        return False
    points = (record[along], record["compared_force"])
    ax.plot(*points, ".", color=ink(), markersize=size, zorder=1.5, label="measured")
    return True


def compared(record: "Record", ax: "Axes", **style: Any) -> None:
    """The force of a motion in time and the measured curve: F(X), or that of the spring against the drive."""
    if np.array_equal(record["drive"], record["position"]):
        return force(record, ax, **style)
    first = len(ax.lines)
    _plot.sliding(record, ax, **style)
    measured(record, ax, "compared_position")
    if "label" not in style:
        ax.lines[first].set_label("master equation")
        _plot.legend_above(ax)


def few(values: "NDArray[Any]", most: int) -> "NDArray[Any]":
    """At most as many values, at equal distances."""
    return values[:: max(1, math.ceil(len(values) / most))]


def sliding(record: "Record", ax: "Axes", **style: Any) -> None:
    """The force of the spring against the drive, that of the ensemble behind it."""
    first = len(ax.lines)
    _plot.sliding(record, ax, **style)
    if "ensemble_drive" in record:
        force = "ensemble_spring_force" if "ensemble_spring_force" in record else "ensemble_force"
        of_force = record.labels["drive"].quantity == "force"
        x, y = ("ensemble_position", "ensemble_drive") if of_force else ("ensemble_drive", force)
        dots: dict[str, Any] = {
            "linestyle": "none",
            "marker": ".",
            "markersize": 2,
            "color": ink(),
            "zorder": 2.5,
        }
        ax.plot(few(record[x], 401), few(record[y], 401), **dots, label="ensemble")
        if "label" not in style:
            ax.lines[first].set_label("master equation")
    if "ensemble_drive" in record or "label" not in style:
        _plot.legend_above(ax)


def motion(record: "Record", ax: "Axes", **style: Any) -> None:
    """The force against time, with that of the ensemble."""
    (line,) = ax.plot(record["time"], record["force"], **style)
    named(record, ax, ("time", "t"), ("force", "F"))
    if "ensemble_force" in record:
        columns = (record[name] for name in ("time", "ensemble_force", "ensemble_error"))
        errors(ax, *(few(column, 201) for column in columns), markersize=2, label="ensemble")
        if "label" not in style:
            line.set_label("master equation")
        _plot.legend_above(ax)


def velocity_curve(record: "Record", ax: "Axes", **style: Any) -> None:
    """F_k against the velocity, a curve for each temperature."""
    velocity, friction = record["velocity"], np.atleast_2d(record["kinetic_friction"])
    temperatures = record["temperature"] if "temperature" in record else [None] * len(friction)
    unit = record.labels["temperature"].units if "temperature" in record else ""
    several = any(name in record for name in ("ensemble_force", "compared_force")) or len(friction) > 1
    for row, (curve, temperature) in enumerate(zip(friction, temperatures, strict=True)):
        label = "master equation" if temperature is None else f"$T$ = {temperature:g}{unit_of(unit)}"
        drawn = along_logarithm(velocity, curve)
        (line,) = ax.plot(*drawn, **{"label": label if several else None, **style})
        color = line.get_color()
        for name in ("creep_friction", "viscous_friction"):
            if name in record:
                limit = np.atleast_2d(record[name])[row]
                near = np.where(np.abs(limit - curve) <= 0.3 * curve, limit, np.nan)
                ax.plot(velocity, near, ":", color=color, linewidth=0.9, zorder=1.5)
        if "ensemble_force" in record:
            sample = (np.atleast_2d(record[name])[row] for name in ("ensemble_force", "ensemble_error"))
            errors(ax, velocity, *sample, color=color, label=None if row else "ensemble")
    measured(record, ax, "compared_velocity", size=8)
    ax.set_xscale("log")
    named(record, ax, ("velocity", "v"), ("kinetic_friction", "F_k"))
    if several:
        ax.legend()


def unit_of(unit: str) -> str:
    return "" if unit in ("", "1") else f" {unit}"


def stability(record: "Record", ax: "Axes", **style: Any) -> None:
    """The critical stiffnesses against the velocity; those that are 0 or infinite are left out."""
    names = {"critical_stiffness": "first loading", "critical_stiffness_sliding": "steady sliding"}
    for name, label in names.items():
        if name in record:
            values = record[name].astype(float)
            values = np.where(np.isfinite(values) & (values > 0.0), values, np.nan)
            ax.plot(record["velocity"], values, **{"marker": ".", "label": label, **style})
    ax.set_xscale("log")
    named(record, ax, ("velocity", "v"), ("critical_stiffness", "K_c"))
    ax.legend()


def stick_slip(record: "Record", ax: "Axes", **style: Any) -> None:
    """Which springs and velocities make stick-slip, and where persistent stick-slip ends."""
    answers = record["stick_slip"]
    velocity, stiffness = np.meshgrid(record["velocity"], record["stiffness"], indexing="ij")
    names = {0: "no stick-slip", 1: "transient", 2: "persistent"}
    looks = {0: {"color": muted()}, 1: {}, 2: {}}
    for answer, label in names.items():
        here = answers == answer
        if here.any():
            dots: dict[str, Any] = {"linestyle": "none", "marker": "s", "label": label}
            ax.plot(velocity[here], stiffness[here], **{**dots, **looks[answer], **style})
    undecided = np.isnan(answers)
    if undecided.any():
        crosses: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": ink(), "label": "undecided"}
        ax.plot(velocity[undecided], stiffness[undecided], **{**crosses, **style})
    low, high = record["stiffness"].min() / 1.5, record["stiffness"].max() * 1.5
    lines = {
        "persistent_stiffness": ("end of persistent stick-slip", "-"),
        "critical_stiffness": ("$K_c$ of the first pull", "--"),
        "critical_stiffness_sliding": ("$K_c$ of steady sliding", ":"),
    }
    order = np.argsort(record["velocity"])
    for name, (label, dashes) in lines.items():
        values = np.where((record[name] > low) & (record[name] < high), record[name], np.nan)[order]
        if np.isfinite(values).any():
            ax.plot(record["velocity"][order], values, dashes, color=ink(), linewidth=0.9, label=label)
    if "ensemble_persistent_stiffness" in record:
        mean = record["ensemble_persistent_stiffness"]
        shown = (mean > low) & (mean < high)
        std = np.nan_to_num(record["ensemble_persistent_stiffness_std"])
        # On a logarithmic axis they end at its lower end.
        bars = np.array([np.minimum(std, np.maximum(mean - low, 0.0)), std])
        if shown.any():
            label = "end of persistence ± std, single contacts"
            x = record["velocity"][shown]
            ax.errorbar(
                x, mean[shown], bars[:, shown], linestyle="none", marker="o", color=ink(), label=label
            )
    ax.set_xscale("log")
    ax.set_yscale("log")
    named(record, ax, ("velocity", "v"), ("stiffness", "K"))
    _plot.legend_above(ax)


def stick_slip_scatter(record: "Record", ax: "Axes", **style: Any) -> None:
    """In which fraction of the simulations of single contacts a spring makes stick-slip, and where persistent
    stick-slip ends; at several velocities, in which fraction it persists at each.
    """
    order = np.argsort(record["stiffness"])
    rows = {
        name: record[f"ensemble_{name}"].reshape(-1, order.size)
        for name in ("none", "transient", "persistent")
    }
    if len(rows["persistent"]) > 1:
        symbols = zip(record["velocity"], rows["persistent"], strict=True)
        lines = [(f"v = {velocity:g}", row) for velocity, row in symbols]
    else:
        lines = [("no stick-slip" if name == "none" else name, row[0]) for name, row in rows.items()]
    for label, row in lines:
        ax.plot(record["stiffness"][order], row[order], **{"marker": ".", "label": label, **style})
    if len(rows["persistent"]) == 1:
        ends_of_persistence(record, ax)
    ax.set_xscale("log")
    ax.set_ylim(0.0, 1.08)
    ax.set_xlabel(axis("K", record.labels["stiffness"].units))
    ax.set_ylabel("fraction of the simulations")
    _plot.legend_above(ax)


def ends_of_persistence(record: "Record", ax: "Axes") -> None:
    """The stiffnesses at which persistent stick-slip ends, those of single contacts with their scatter."""
    first, last = record["stiffness"].min(), record["stiffness"].max()
    of_contacts, mean, std = (
        float(np.ravel(record[name])[0]) if name in record else math.nan
        for name in (
            "persistent_stiffness",
            "ensemble_persistent_stiffness",
            "ensemble_persistent_stiffness_std",
        )
    )
    if first < mean < last:
        bar = 0.0 if math.isnan(std) else std
        ax.axvline(mean, color=ink(), linewidth=0.9, label="end of persistence, single contacts")
        ax.axvspan(max(mean - bar, first), min(mean + bar, last), color=muted(), alpha=0.3, linewidth=0)
    if first < of_contacts < last:
        label = "end of persistence, $N \\to \\infty$"
        ax.axvline(of_contacts, linestyle="--", color=ink(), linewidth=0.9, label=label)


def hold_curve(record: "Record", ax: "Axes", **style: Any) -> None:
    """Static friction against the logarithm of the hold time, with the fitted growth."""
    hold = record["hold"]
    reported = getattr(record, "summary", {}).get("hold_curve", {})
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 5}
    (line,) = ax.plot(hold, record["static_friction"], **{**dots, "label": "master equation", **style})
    if "healing_per_decade" in reported:
        times = np.geomspace(hold[0], hold[-1], 201)
        beta, cutoff = reported["healing_per_decade"] / math.log(10), reported.get("healing_cutoff")
        grown = np.log(times) if cutoff is None else np.log1p(times / cutoff) - np.log1p(1 / cutoff)
        fitted = reported["at_one"] + beta * grown
        ax.plot(times, fitted, color=line.get_color(), linewidth=0.9, label="fitted growth")
    if "ensemble_force" in record:
        errors(ax, hold, record["ensemble_force"], record["ensemble_error"], label="ensemble")
    measured(record, ax, "compared_hold", size=8)
    ax.set_xscale("log")
    named(record, ax, ("hold", "t_{hold}"), ("static_friction", "F_s"))
    ax.legend()


def creep_curve(record: "Record", ax: "Axes", **style: Any) -> None:
    """The slip since loading in time, a curve for each force, with a cross at failure."""
    draw_creep(record, ax, record["creep_position"] - record["loaded_position"][:, None], **style)
    time, units = record.labels["creep_time"].units, record.labels["creep_position"].units
    ax.set(xlabel=axis("t", time), ylabel=axis("X - X_0", units))


def creep_rate(record: "Record", ax: "Axes", **style: Any) -> None:
    """The velocity in time, a curve for each force, with a cross at failure."""
    draw_creep(record, ax, record["creep_velocity"], **style)
    ax.set_yscale("log")
    named(record, ax, ("creep_time", "t"), ("creep_velocity", "v"))


def draw_creep(record: "Record", ax: "Axes", values: "NDArray[Any]", **style: Any) -> None:
    """Curves against the logarithm of time, from the first point after loading on."""
    fails = np.isfinite(record["failure_time"]) if "failure_time" in record else np.zeros(len(values), bool)
    for force, time, curve, fail in zip(
        record["imposed_force"], record["creep_time"], values, fails, strict=True
    ):
        shown = np.isfinite(time) & np.isfinite(curve) & (np.arange(len(time)) > 0)
        if shown.any():
            label = {"label": f"F = {force:g}"}
            (line,) = ax.plot(time[shown], curve[shown], **{**label, **style})
            if fail:
                ax.plot(time[shown][-1], curve[shown][-1], "x", color=line.get_color())
    ax.set_xscale("log")
    ax.legend()


def static_fatigue(record: "Record", ax: "Axes", **style: Any) -> None:
    """The time to failure against the force, on a logarithmic scale."""
    order = np.argsort(record["imposed_force"])
    force, time = record["imposed_force"][order], record["failure_time"][order]
    fails = time > 0.0
    ax.plot(force[fails], time[fails], **{"marker": "o", "markersize": 5, **style})
    ax.set_yscale("log")
    named(record, ax, ("imposed_force", "F"), ("failure_time", "t_f"))


def spectrum(record: "Record", ax: "Axes", **style: Any) -> None:
    """The spectrum of the force, with the periodogram of the ensemble."""
    names = ("ensemble_wave_number", "ensemble_spectrum")
    if all(name in record for name in names):
        dots: dict[str, Any] = {"marker": ".", "linestyle": "none", "markersize": 3, "color": muted()}
        within = record[names[0]] <= record["wave_number"][-1]
        ax.plot(record[names[0]][within], record[names[1]][within], **dots, label="ensemble")
    (line,) = ax.plot(record["wave_number"], record["spectrum"], **style)
    ax.set_yscale("log")
    fit_ends(ax, record["wave_number"])
    named(record, ax, ("wave_number", "q"), ("spectrum", "S"))
    if names[0] in record and "label" not in style:
        line.set_label("master equation")
        ax.legend()


def autocovariance(record: "Record", ax: "Axes", **style: Any) -> None:
    """The autocovariance of the force against the displacement."""
    ax.axhline(0.0, color=muted(), linewidth=0.6)
    ax.plot(record["displacement"], record["autocovariance"], **style)
    fit_ends(ax, record["displacement"])
    named(record, ax, ("displacement", "u"), ("autocovariance", "c"))


def thresholds(record: "Record", ax: "Axes", **style: Any) -> None:
    """The distribution of first breaks with those of the thresholds and of mean field."""
    drive, measured = record["drive"], record["measured_density"]
    felt = measured > 0.0
    curves = {"free_density": ("thresholds", "--"), "mean_field_density": ("mean field", "-")}
    for name, (label, dashes) in curves.items():
        if name in record:
            ax.plot(drive, record[name], **{"linestyle": dashes, "label": label, **style})
            felt = felt | (record[name] > 1e-3 * np.nanmax(record[name]))
    errors(ax, drive[felt], measured[felt], record["measured_error"][felt], label="first breaks")
    fit_ends(ax, drive[felt])
    ax.set_ylim(bottom=0.0)
    unit = record.labels["measured_density"].units
    ax.set_xlabel(axis("x", record.labels["drive"].units, "threshold, drive"))
    ax.set_ylabel(axis("", unit, "probability density"))
    ax.legend()


def measured_fit(record: "Record", ax: "Axes", **style: Any) -> None:
    """The readings with the fitted curve and two standard deviations of a reading."""
    names = (
        ("reading_position", "measured_force", "expected_force", "reading_std", "reading_curve")
        if "reading_position" in record
        else ("position", "force", "expected", "std", "curve")
    )
    place, measured, expected, scatter, number = names
    numbers = record[number] if number in record else np.zeros(len(record[place]))
    x, y, std = record[place], record[expected], record[scatter]
    for one in np.unique(numbers):
        of = numbers == one
        (line,) = ax.plot(x[of], y[of], **{"label": "fit" if one == numbers[0] else None, **style})
        low, high = y[of] - 2 * std[of], y[of] + 2 * std[of]
        band: dict[str, Any] = {"color": line.get_color(), "alpha": 0.2, "linewidth": 0}
        ax.fill_between(x[of], low, high, **band, label=_plot.SCATTER if one == numbers[0] else None)
    if measured in record:
        dots: dict[str, Any] = {"marker": ".", "linestyle": "none", "markersize": 3, "zorder": 1.5}
        ax.plot(x, record[measured], **dots, color=ink(), label="measured")
    named(record, ax, (place, "X"), (expected, "F"))
    _plot.legend_above(ax, doubts(record))


def doubts(record: "Record") -> list[str]:
    """What the summary of a result says of a fit that is not to be trusted."""
    fit = getattr(record, "summary", {}).get("fit")
    if fit is None:
        return []
    misfit = fit.get("misfit", {})
    known = (misfit.get(name) for name in ("probability", "whiteness"))
    unlikely = any(one is not None and one < _show.UNLIKELY for one in known)
    return _fit.doubts(fit["converged"], unlikely, what="record" if "fit_periodogram" in record else "curve")


def residuals(record: "Record", ax: "Axes", **style: Any) -> None:
    """The whitened residuals with the band of two standard deviations."""
    name, place = (
        ("whitened_residual", "reading_position")
        if "whitened_residual" in record
        else ("whitened", "position")
    )
    dots: dict[str, Any] = {"marker": ".", "linestyle": "none", "markersize": 3}
    (line,) = ax.plot(record[place], record[name], **{**dots, **style})
    ax.axhspan(-2, 2, color=line.get_color(), alpha=0.15, linewidth=0)
    ax.axhline(0.0, color=muted(), linewidth=0.6)
    ax.set_xlabel(axis("X", record.labels[place].units))
    ax.set_ylabel("whitened residual")


def fit_spectrum(record: "Record", ax: "Axes", **style: Any) -> None:
    """The averaged periodogram of a record with its expectation."""
    prefix = "fit_" if "fit_wave_number" in record else ""
    q = record[f"{prefix}wave_number"]
    measured = record[f"{prefix}periodogram"]
    expected = record["fit_expected_periodogram" if prefix else "expected"]
    # A periodogram scatters as much as its mean: averages over a tenth of a decade show the mean.
    bins = np.floor(10 * np.log10(q)).astype(int)
    each = [bins == number for number in np.unique(bins)]
    at, mean = (np.array([values[of].mean() for of in each]) for values in (q, measured))
    count = np.array([of.sum() for of in each])
    dots: dict[str, Any] = {
        "marker": ".",
        "linestyle": "none",
        "markersize": 2,
        "color": muted(),
        "zorder": 1,
    }
    ax.plot(q, measured, **dots, alpha=0.5, label="periodogram")
    errors(ax, at, mean, mean / np.sqrt(count), label="averages")
    ax.plot(q, expected, **{"label": "fit", "zorder": 3, **style})
    ax.set(xscale="log", yscale="log", ylim=(0.2 * np.min(expected), 20 * np.max(measured)))
    named(record, ax, (f"{prefix}wave_number", "q"), (f"{prefix}periodogram", "S"))
    ax.legend()
    _plot.remark(ax, doubts(record))


def fit_velocity_curve(record: "Record", ax: "Axes", **style: Any) -> None:
    """Measured forces of steady sliding with the fitted curve and twice its standard error."""
    velocity, friction, error = (record[f"fit_{name}"] for name in ("velocity", "friction", "friction_error"))
    (line,) = ax.plot(velocity, friction, **{"label": "fit", **style})
    band = (friction - 2 * error, friction + 2 * error)
    look: dict[str, Any] = {"color": line.get_color(), "alpha": 0.2, "linewidth": 0}
    ax.fill_between(velocity, *band, **look, label="± 2 standard errors")
    at, measured, std = (record[f"reading_{name}"] for name in ("velocity", "friction", "friction_std"))
    errors(ax, at, measured, std, label="measured")
    ax.set_xscale("log")
    named(record, ax, ("reading_velocity", "v"), ("reading_friction", "F_k"))
    ax.legend()
    _plot.remark(ax, doubts(record))


def steady_fit(fit: "SteadyEstimates", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The periodogram of a fit to steady sliding, and what is said of a fit that is not to be trusted."""
    ax = draw(fit.spectrum, ax, "periodogram", **style)
    _plot.remark(ax, _fit.remarks(fit, "record"))
    return ax


def velocity_curve_fit(fit: "VelocityCurveEstimates", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The fitted velocity curve, and what is said of a fit that is not to be trusted."""
    ax = draw(fit.curve, ax, "fit_velocity_curve", **style)
    _plot.remark(ax, _fit.remarks(fit))
    return ax


def free_form(record: "Record", ax: "Axes", **style: Any) -> None:
    """Thresholds of free form with the interval of 95 %."""
    x = record["free_form_threshold"]
    (line,) = ax.plot(x, record["free_form_density"], **style)
    band = (record["free_form_density_low"], record["free_form_density_high"])
    ax.fill_between(x, *band, color=line.get_color(), alpha=0.2, linewidth=0)
    # Where nothing is known the interval may go far beyond.
    ax.set_ylim(0.0, 2.0 * record["free_form_density"].max())
    named(record, ax, ("free_form_threshold", "x"), ("free_form_density", "P_c"))


def evolution(record: "Record", ax: "Axes", **style: Any) -> None:
    """Q(x; X) at the snapshots, one curve for each position, those of the ensemble as dots."""
    place, name = ("stretch", "stretch_density") if "stretch" in record else ("bin", "stretch_density")
    densities(
        ax,
        (record[place], record[name]),
        [f"$X$ = {position:g}" for position in record["snapshot"]],
        **style,
    )
    if "ensemble_stretch_density" in record:
        last = ax.lines[-len(record["snapshot"]) :]
        for line, counts in zip(last, record["ensemble_stretch_density"], strict=True):
            held = counts > 0.0
            dots: dict[str, Any] = {"marker": ".", "linestyle": "none", "markersize": 3}
            ax.plot(record["bin"][held], counts[held], **dots, color=line.get_color(), zorder=1.5)
    named(record, ax, (place, "x"), (name, "Q"))
    if "stretch_atom_stretch" in record:
        at, weights = record["stretch_atom_stretch"], record["stretch_atom_weight"]
        of = [int(np.argmin(np.abs(record["snapshot"] - x))) for x in record["stretch_atom_position"]]
        colors = _plot.shades(len(record["snapshot"]))
        _plot.masses(ax, [(at, weights, [colors[number] for number in of])])
    ax.legend()


def densities(
    ax: "Axes",
    curve: "tuple[NDArray[Any], NDArray[Any]]",
    labels: "Sequence[str]",
    **style: Any,
) -> None:
    """Curves in an order, with colours from dark to light of the map of the present style."""
    x, rows = curve
    shades = _plot.shades(len(labels))
    for row, label, shade in zip(np.atleast_2d(rows), labels, shades, strict=True):
        ax.plot(x, row, **{"color": shade, "label": label, **style})
    ax.set_ylim(bottom=0.0)


def distribution(record: "Record", ax: "Axes", **style: Any) -> None:
    """The stretches in steady sliding with the thresholds."""
    names = {"steady": "$Q_s$", "threshold": "$P_c$"}
    top, stems = 0.0, []
    for prefix, label in names.items():
        name = {"steady": "steady_stretch_density", "threshold": "threshold_density"}[prefix]
        (line,) = ax.plot(record["stretch"], record[name], **{"label": label, **style})
        top = max(top, float(np.nanmax(record[name], initial=0.0)))
        if f"{prefix}_atom_stretch" in record:
            at, weights = record[f"{prefix}_atom_stretch"], record[f"{prefix}_atom_weight"]
            stems.append((at, weights, line.get_color()))
    if "hazard" in record and (np.isfinite(record["hazard"]) & (record["hazard"] > 0.0)).any():
        ax.plot(record["stretch"], record["hazard"], **{"linestyle": "--", "label": "$P$", **style})
        ax.set_ylim(0.0, 1.1 * top)
    _plot.masses(ax, stems)
    named(record, ax, ("stretch", "x"), ("steady_stretch_density", ""))
    ax.set_ylabel(axis("", record.labels["steady_stretch_density"].units, "density, hazard"))
    ax.legend()


def covariance(record: "Record", ax: "Axes", **style: Any) -> None:
    """The correlation coefficient of the force at two positions."""
    values = record["covariance"]
    variance = np.diag(values)
    # Where the force hardly scatters, the map is blank.
    std = np.sqrt(np.where(variance > CERTAIN * variance.max(), variance, np.nan))
    correlation = values / np.outer(std, std)
    at = record["covariance_position"]
    map_style: dict[str, Any] = {"cmap": "RdBu_r", "vmin": -1.0, "vmax": 1.0, "shading": "nearest"}
    mesh = ax.pcolormesh(at, at, correlation, **{**map_style, **style})
    ax.set_aspect("equal")
    unit = record.labels["covariance_position"].units
    ax.set(xlabel=axis("X_1", unit), ylabel=axis("X_2", unit))
    colorbar(ax, mesh, "correlation coefficient")


def equilibrium(record: "Record", ax: "Axes", **style: Any) -> None:
    """The equilibria of the slider on first loading: stable ones solid, unstable ones dashed."""
    drive, force, stable = (record[f"branch_{name}"] for name in ("drive", "force", "stable"))
    (line,) = ax.plot(drive, np.where(stable, force, np.nan), **{"label": "stable", **style})
    unstable = np.where(stable, np.nan, force)
    ax.plot(drive, unstable, "--", color=line.get_color(), linewidth=0.9, label="unstable")
    named(record, ax, ("branch_drive", "X_T"), ("branch_force", "F"))
    ax.legend()


def potential(record: "Record", ax: "Axes", **style: Any) -> None:
    """The potential of the slider before, at and after its first slip."""
    rows = [f"$X_T$ = {drive:.4g}" for drive in record["potential_drive"]]
    for row, label in zip(record["potential"], rows, strict=True):
        ax.plot(record["branch_position"], row, **{"label": label, **style})
    named(record, ax, ("branch_position", "X"), ("potential", "V"))
    ax.legend()


def slip(record: "Record", ax: "Axes", **style: Any) -> None:
    """The forces during the first inertial slip."""
    for name, label in (("slip_force", "friction"), ("slip_spring_force", "spring")):
        ax.plot(record["slip_time"], record[name], **{"label": label, **style})
    fit_ends(ax, record["slip_time"])
    named(record, ax, ("slip_time", "t"), ("slip_force", "F"))
    ax.legend()


def sizes(record: "Record", ax: "Axes", **style: Any) -> None:
    """The numbers of events of an ensemble by the number of contacts that break."""
    dots: dict[str, Any] = {"marker": "o", "linestyle": "none", "markersize": 4}
    ax.plot(record["size"], record["size_events"], **{**dots, **style})
    ax.set(xscale="log", yscale="log", xlabel="contacts broken in an event", ylabel="events")


def magnitudes(record: "Record", ax: "Axes", **style: Any) -> None:
    """The probability density of the magnitudes of events, in five bins per decade, with the fitted law."""
    name = "event_size" if "event_size" in record else "event_moment"
    values = record[name][record[name] > 0.0].astype(float)
    whole = name == "event_size"
    bins = np.round(5 * np.log10(values)).astype(int)
    held, counts = np.unique(bins, return_counts=True)
    below, above = (10.0 ** ((held + side) / 5) for side in (-0.5, 0.5))
    width, middle = above - below, 10.0 ** (held / 5)
    if whole:
        # As many whole numbers as a bin has, at the geometric mean of those found.
        width = np.maximum(np.ceil(above) - np.ceil(below), 1.0)
        logarithms = np.bincount(bins - held[0], np.log(values))[held - held[0]]
        middle = np.exp(logarithms / counts)
    density = counts / (len(values) * width)
    errors(ax, middle, density, density / np.sqrt(counts), **style)
    law = getattr(record, "summary", {}).get("catalogue", {}).get("law")
    if law is not None:
        at = middle >= law["from"]
        beyond = middle[at]
        cut = law["cut_off"] if isinstance(law["cut_off"], float) else math.inf
        shape = beyond ** -law["exponent"]["value"] * np.exp(-beyond / cut)
        if at.any():
            scale = float(np.exp(np.average(np.log(density[at] / shape), weights=counts[at])))
            label = rf"$\tau$ = {law['exponent']['value']:.2f}"
            ax.plot(beyond, scale * shape, label=label)
            ax.legend()
    ax.set(xscale="log", yscale="log")
    symbol = ("", "breaks in an event") if name == "event_size" else ("", "moment")
    ax.set_xlabel(axis(symbol[0], record.labels[name].units, symbol[1]))
    ax.set_ylabel("probability density")


def main_shocks(record: "Record", ax: "Axes", **style: Any) -> None:
    """The rates of events after and before main shocks, over their mean rate, with the fitted Omori laws."""
    along = "shock_time" if "shock_time" in record else "shock_drive"
    found = getattr(record, "summary", {}).get("catalogue", {}).get("main_shocks", {})
    dots: dict[str, Any] = {"marker": "o", "linestyle": "none", "markersize": 4}
    for side, words in (("aftershock", "after main shocks"), ("foreshock", "before main shocks")):
        held = record[f"{side}_rate"] > 0.0
        at, rate = record[along][held], record[f"{side}_rate"][held]
        (line,) = ax.plot(at, rate, **{**dots, "label": words, **style})
        law = found.get(f"{side}_law")
        if law is not None and held.any():
            # Bins are equal on the logarithmic axis: they hold events in proportion to rate times time.
            shape, events = (at + law["delay"]) ** -law["exponent"]["value"], float(np.sum(rate * at))
            part = (1.0 - law["background"]) * events / float(np.sum(shape * at))
            even = law["background"] * events / float(np.sum(at))
            label = f"$p$ = {law['exponent']['value']:.2f}"
            ax.plot(at, part * shape + even, color=line.get_color(), label=label)
    ax.set(xscale="log", yscale="log", ylabel="rate of events / mean rate")
    ax.set_xlabel(axis("", record.labels[along].units, f"{along.removeprefix('shock_')} from the main shock"))
    ax.legend()


def slips(record: "Record", ax: "Axes", **style: Any) -> None:
    """Events against the drive."""
    name = "event_size" if "event_size" in record else "event_drop"
    (stems,) = ax.plot([], [], **style)
    ax.vlines(record["event_drive"], 0.0, record[name], color=stems.get_color(), linewidth=0.8)
    ax.set_ylim(bottom=0.0)
    words = "breaks" if name == "event_size" else "force drop"
    ax.set_xlabel(axis("X_T", record.labels["event_drive"].units))
    ax.set_ylabel(axis("", record.labels[name].units, words))


def stress_map(record: "Record", ax: "Axes", *, at: float | None = None, **style: Any) -> None:
    """The forces of the cells of a lattice at one of the drives of the maps, by default the last."""
    drives = record["map_drive"]
    number = len(drives) - 1 if at is None else int(np.argmin(np.abs(drives - at)))
    image = ax.imshow(
        record["cell_force"][number], **{"origin": "lower", "interpolation": "nearest", **style}
    )
    ax.set(xlabel="column", ylabel="row", title=f"$X_T$ = {drives[number]:.4g}")
    colorbar(ax, image, axis("", record.labels["cell_force"].units, "force of a cell"))


def space_time(record: "Record", ax: "Axes", **style: Any) -> None:
    """The forces of the cells of a chain along the drive."""
    drives, cells = record["map_drive"], record["cell"]
    # Two maps at one drive, before and after an event, would be a cell of no height.
    different = np.append(np.diff(drives) > 0.0, True)
    look: dict[str, Any] = {"shading": "nearest", "rasterized": True}
    mesh = ax.pcolormesh(cells, drives[different], record["cell_force"][different], **{**look, **style})
    ax.set(xlabel="cell", ylabel=axis("X_T", record.labels["map_drive"].units))
    colorbar(ax, mesh, axis("", record.labels["cell_force"].units, "force of a cell"))


def slip_rate(record: "Record", ax: "Axes", **style: Any) -> None:
    """The velocity of the cells of a chain, step by step of the computation, on a logarithmic scale."""
    from matplotlib.colors import LogNorm

    rates = record["slip_rate"]
    highest = rates.max()
    # Eight decades are more than colours can distinguish.
    lowest = max(rates[rates > 0.0].min(initial=highest), 1e-8 * highest)
    look: dict[str, Any] = {"shading": "nearest", "rasterized": True, "cmap": "inferno"}
    norm = LogNorm(lowest, highest) if lowest < highest else None
    shown = np.maximum(rates, lowest)
    mesh = ax.pcolormesh(record["cell"], record["slip_rate_step"], shown, norm=norm, **{**look, **style})
    ax.set(xlabel="cell", ylabel="step of the computation")
    colorbar(ax, mesh, axis("", record.labels["slip_rate"].units, "slip rate of a cell"))


KINDS: Mapping[str, Kind] = {
    "fit": Kind(measured_fit, ("reading_position", "expected_force")),
    "readings": Kind(measured_fit, ("position", "expected", "std")),
    "fit_spectrum": Kind(fit_spectrum, ("fit_wave_number", "fit_periodogram")),
    "periodogram": Kind(fit_spectrum, ("wave_number", "periodogram", "expected")),
    "fit_velocity_curve": Kind(fit_velocity_curve, ("reading_velocity", "fit_friction")),
    "velocity_curve": Kind(velocity_curve, ("velocity", "kinetic_friction")),
    "hold_curve": Kind(hold_curve, ("hold", "static_friction")),
    "creep_curve": Kind(creep_curve, ("imposed_force", "creep_position")),
    "creep_rate": Kind(creep_rate, ("imposed_force", "creep_velocity")),
    "static_fatigue": Kind(static_fatigue, ("imposed_force", "failure_time"), least=2),
    "spectrum": Kind(spectrum, ("wave_number", "spectrum")),
    "thresholds": Kind(thresholds, ("drive", "measured_density")),
    "motion": Kind(motion, ("time", "force"), ("event_drive",)),
    "trace": Kind(sliding, ("drive", "force")),
    "force": Kind(force, ("position", "force"), ("drive", "time", "expected")),
    "compared": Kind(compared, ("compared_position", "compared_force", "position", "force", "time")),
    "residuals": Kind(residuals, ("reading_position", "whitened_residual")),
    "whitened": Kind(residuals, ("position", "whitened")),
    "free_form": Kind(free_form, ("free_form_threshold", "free_form_density")),
    "evolution": Kind(evolution, ("snapshot", "stretch_density")),
    "distribution": Kind(distribution, ("stretch", "steady_stretch_density")),
    "covariance": Kind(covariance, ("covariance_position", "covariance")),
    "stick_slip": Kind(stick_slip, ("velocity", "stiffness", "stick_slip"), least=2),
    "stick_slip_scatter": Kind(stick_slip_scatter, ("stiffness", "ensemble_persistent"), least=2),
    "stability": Kind(stability, ("velocity", "critical_stiffness"), ("stick_slip",)),
    "autocovariance": Kind(autocovariance, ("displacement", "autocovariance")),
    "equilibrium": Kind(equilibrium, ("branch_drive", "branch_stable")),
    "potential": Kind(potential, ("branch_position", "potential")),
    "slip": Kind(slip, ("slip_time", "slip_force")),
    "sizes": Kind(sizes, ("size", "size_events"), least=3),
    "events": Kind(slips, ("event_drive", "event_drop")),
    "magnitudes": Kind(magnitudes, ("event_drive", "event_epicentre"), least=30),
    "main_shocks": Kind(main_shocks, ("aftershock_rate", "foreshock_rate")),
    "map": Kind(stress_map, ("map_drive", "row", "cell_force")),
    "space_time": Kind(space_time, ("map_drive", "cell", "cell_force")),
    "slip_rate": Kind(slip_rate, ("slip_rate_step", "cell", "slip_rate"), least=2),
}
