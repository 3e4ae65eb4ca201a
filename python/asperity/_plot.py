"""Figures by matplotlib."""

import math
import re
from collections.abc import Iterable
from textwrap import wrap
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

from asperity import _fit, _show

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from numpy.typing import NDArray

    from asperity._core import (
        Block,
        Contacts,
        Estimates,
        FrictionGradient,
        Gradient,
        Healing,
        Interface,
        Lattice,
        Law,
        Model,
        Posterior,
        Pull,
        Record,
        Relaxation,
        SteadyState,
        ThresholdResponse,
        VelocityStep,
    )
    from asperity._events import Events
    from asperity._fit_values import Prediction
    from asperity._spots import Spots
    from asperity._values import Atoms, StretchDensity


def friction(record: "Record", ax: "Axes", **style: Any) -> None:
    """F(X) with the static friction as a dot and the kinetic friction as a dashed line, if they are known."""
    line = curve(record, ax, {"position": "X", "force": "F"}, **style)
    peak = getattr(record, "static_friction", None)
    if peak is not None:
        dot: dict[str, Any] = {"color": line.get_color(), "markersize": 4, "label": once(ax, "$F_s$", style)}
        ax.plot(peak.position, peak.force, "o", **dot)
    level(record, ax, line, **style)


def sliding(record: "Record", ax: "Axes", **style: Any) -> None:
    """The force of the spring or the interface against the drive; an imposed force against the position."""
    force = "spring_force" if "spring_force" in record else "force"
    names = {"drive": "X_T", force: "F"}
    if record.labels["drive"].quantity == "force":
        names = {"position": "X", "drive": "F"}
    level(record, ax, curve(record, ax, names, **style), **style)


def level(record: "Record", ax: "Axes", line: "Line2D", **style: Any) -> None:
    """The kinetic friction as a dashed line, if it is one number."""
    steady = getattr(record, "kinetic_friction", None)
    if isinstance(steady, float) and math.isfinite(steady):
        dashes: dict[str, Any] = {"linestyle": "--", "linewidth": 0.8, "label": once(ax, "$F_k$", style)}
        ax.axhline(steady, color=line.get_color(), **dashes)


def once(ax: "Axes", label: str, style: "Mapping[str, Any]") -> str | None:
    """A label; none where something on the axes has it already, or where the curve has one that was given."""
    return None if "label" in style or label in ax.get_legend_handles_labels()[1] else label


def pull(
    pull: "Pull",
    ax: "Axes | None" = None,
    scatter: "NDArray[np.float64] | None" = None,
    paths: "Sequence[NDArray[np.float64]] | None" = None,
    **style: Any,
) -> "Axes":
    """F(X) with a band of its standard deviation, and sample paths, given as their positions and forces."""
    ax = axes_or_new(ax)
    first = len(ax.lines)
    friction(pull, ax, **style)
    color = ax.lines[first].get_color()
    if scatter is not None:
        low, high = pull.force - scatter, pull.force + scatter
        label = once(ax, "± std", style)
        ax.fill_between(pull.position, low, high, color=color, alpha=0.2, linewidth=0, label=label)
    if paths is not None:
        positions, forces = paths
        label = once(ax, "sample paths", style)
        lines = ax.plot(positions, forces.T, color=color, alpha=0.6, linewidth=0.6)
        for line in lines[:1]:
            line.set_label(label)
    if "label" not in style:
        legend_above(ax)
    return ax


def fit(fit: "Estimates", axes: "Sequence[Axes] | None" = None, **style: Any) -> "tuple[Axes, ...]":
    """The expected force with a band of two standard deviations, the readings, and the whitened residuals."""
    import numpy as np

    readings = fit.readings
    measured = "force" in readings
    panels = 2 if measured else 1
    axes = panels_or_new(axes, panels)
    position, reach = readings["position"], 2 * readings["std"]
    above = axes[0]
    numbers = readings["curve"] if "curve" in readings else 0 * position
    named = {"label": "fit" if measured else "expected", **style}
    label: str | None = SCATTER
    for number in sorted(set(numbers.tolist())):
        of = numbers == number
        finely, force = between(fit, int(number), position[of])
        (line,) = above.plot(finely, force, **named)
        color = line.get_color()
        named = {**named, "label": None, "color": color}
        band = np.interp(finely, position[of], reach[of])
        ends = (force - band, force + band)
        above.fill_between(finely, *ends, color=color, alpha=0.2, linewidth=0, label=label)
        label = None
    above.set_xlabel(axis("X", readings.labels["position"].units))
    above.set_ylabel(axis("F", readings.labels["expected"].units))
    if not measured:
        legend_above(above)
        return axes[:1]
    above.plot(position, readings["force"], ".", color=ink(), markersize=2, zorder=1.5, label="measured")
    legend_above(above, _fit.remarks(fit))
    below = axes[1]
    below.axhspan(-2, 2, color=color, alpha=0.2, linewidth=0)
    below.plot(position, readings["whitened"], ".", color=ink(), markersize=2)
    above.set_xlabel("")
    below.set_xlabel(axis("X", readings.labels["position"].units))
    # The panel is hardly higher than both words beside each other are long.
    below.set_ylabel("whitened\nresidual")
    return axes


SCATTER = "± 2 std of a reading"
"""The name of a band of two standard deviations of a reading."""


def remark(ax: "Axes", sentences: "Sequence[str]") -> None:
    """Sentences above axes."""
    if sentences:
        ax.set_title("\n".join(broken(ax, sentences)), loc="left", fontsize=small())


def broken(ax: "Axes", sentences: "Sequence[str]") -> list[str]:
    """Sentences in lines of small letters that are not longer than the axes are wide."""
    width = 72 * ax.get_window_extent().width / ax.figure.dpi
    # A letter is about half as wide as it is high.
    letters = max(20, int(width / (0.5 * small())))
    return [line for sentence in sentences for line in wrap(sentence, letters)]


def small() -> float:
    """The size of small letters in the present style."""
    return 0.83 * float(pyplot().rcParams["font.size"])


def between(
    fit: "Estimates", curve: int, position: "NDArray[np.float64]"
) -> "tuple[NDArray[np.float64], NDArray[np.float64]]":
    """The expected force at the readings and at 1001 positions: it may oscillate between readings."""
    import numpy as np

    finely = np.union1d(position, np.linspace(position[0], position[-1], 1001))
    return finely, fit.predict(finely, curve).force


PANEL, MARGIN, GAP = 2.0, (1.2, 1.0), 0.1
"""In inches: the size of a panel of pairs, the room at the left and below them, and the gaps between them."""


def corner(posterior: "Posterior") -> "NDArray[Any]":
    """Histograms of the numbers on the diagonal, and pairs of draws below it."""
    draws = {name: values.ravel() for name, values in posterior.draws.items()}
    figure, axes = squares(len(draws))
    for row, (below, heights) in enumerate(draws.items()):
        for column, (left, values) in enumerate(draws.items()):
            ax = axes[row, column]
            if column > row:
                ax.set_axis_off()
                continue
            ticks(ax.xaxis)
            if column == row:
                ax.hist(values, bins=30)
                ax.set_yticks([])
            else:
                ax.plot(values, heights, ".", markersize=1, alpha=0.4)
                pair(ax, axes[row, 0], below)
            if row == len(draws) - 1:
                ax.set_xlabel(left)
                ax.tick_params(axis="x", labelrotation=45, pad=2)
                for label in ax.get_xticklabels():
                    label.set(horizontalalignment="right", rotation_mode="anchor")
    figure.align_labels()
    return axes


def squares(count: int) -> "tuple[Figure, NDArray[Any]]":
    """Square panels in rows and columns, close to each other: only the outer ones have numbers and names."""
    width, height = (margin + count * (PANEL + GAP) for margin in MARGIN)
    edges = {"left": MARGIN[0] / width, "bottom": MARGIN[1] / height}
    far = {"right": 1 - GAP / width, "top": 1 - GAP / height}
    figure, axes = pyplot().subplots(
        count,
        count,
        sharex="col",
        squeeze=False,
        figsize=(width, height),
        layout="none",
        gridspec_kw={**edges, **far, "wspace": GAP / PANEL, "hspace": GAP / PANEL},
    )
    return figure, axes


def pair(ax: "Axes", first: "Axes", name: str) -> None:
    """The vertical axis of a panel of pairs is that of the first one of its row, with numbers and a name."""
    if ax is first:
        ticks(ax.yaxis)
        ax.set_ylabel(name)
    else:
        ax.sharey(first)
        ax.tick_params(axis="y", labelleft=False)


def ticks(axis: "Axis") -> None:
    """Few ticks, whose numbers have all digits: a part that stands apart would cover another panel."""
    from matplotlib.ticker import Formatter, MaxNLocator

    def tick_values(self: MaxNLocator, vmin: float, vmax: float) -> "Sequence[float]":
        """Away from the ends, where numbers would meet those of the next panel."""
        beside = 0.08 * (vmax - vmin)
        low, high = vmin + beside, vmax - beside
        return [place for place in MaxNLocator.tick_values(self, low, high) if low <= place <= high]

    inner: Any = type("Inner", (MaxNLocator,), {"tick_values": tick_values})
    locator = inner(nbins=4, steps=[1, 2, 5, 10])

    def text(value: float, _: object) -> str:
        places, size = locator(), max(map(abs, axis.get_view_interval()))
        return Formatter.fix_minus(shown(value, size, places[1] - places[0]))

    axis.set_major_locator(locator)
    axis.set_major_formatter(text)


def shown(value: float, size: float, step: float) -> str:
    """A number on an axis whose numbers are at most of this size, with the digits of a step."""
    # The step may be off by rounding.
    decimals = -math.floor(math.log10(step) + 1e-6)
    if 1e-4 <= size < 1e6:
        # Not -0.
        return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"
    return f"{value:.{max(decimals + math.floor(math.log10(size)), 0)}e}"


def curve(record: "Record", ax: "Axes", names: dict[str, str], **style: Any) -> "Line2D":
    """The second of two variables against the first, with names for the axes."""
    x, y = names
    (line,) = ax.plot(record[x], record[y], **style)
    ax.set_xlabel(axis(names[x], record.labels[x].units))
    ax.set_ylabel(axis(names[y], record.labels[y].units))
    return line


def velocity_step(step: "VelocityStep", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The measured force around a velocity step, with the fit before the step and from the peak on."""
    ax = axes_or_new(ax)
    position, fitted = step.position, step.fitted
    ax.plot(position, step.force, ".", markersize=3, color=muted(), label="measured, as fitted")
    after = position >= 0.0
    (line,) = ax.plot(position[~after], fitted[~after], **{"label": "fit", **style})
    ax.plot(position[after], fitted[after], **{**style, "label": None, "color": line.get_color()})
    if len(step.unused_position):
        unused: dict[str, Any] = {"markersize": 3, "color": ink(), "alpha": 0.7}
        ax.plot(step.unused_position, step.unused_force, "x", **unused, label="not fitted")
    edge: dict[str, Any] = {"linestyle": ":", "linewidth": 1.0, "color": ink()}
    ax.axvline(step.peak, **edge, label="$X_p$, where the fit starts")
    ax.set_xlabel("displacement since the step")
    ax.set_ylabel("$F$")
    ax.legend()
    remark(ax, _show.warned(step))
    return ax


def healing(healing: "Healing", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """Static friction against the logarithm of the hold time, with the fit at 200 hold times."""
    ax = axes_or_new(ax)
    ax.plot(healing.hold, healing.force, "o", color=ink(), markersize=4, label="measured")
    low, high = math.log10(min(healing.hold)), math.log10(max(healing.hold))
    times = [10 ** (low + (high - low) * i / 199) for i in range(200)]
    ax.plot(times, healing(times), **{"label": "fit", **style})
    ax.set_xscale("log")
    ax.set_xlabel(axis("t_{hold}", ""))
    ax.set_ylabel("$F_s$")
    ax.legend()
    remark(ax, _show.warned(healing))
    return ax


def steady_state(steady: "SteadyState", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The distribution of stretches in steady sliding."""
    return stretches(steady.stretch_density(), ax, **style)


def stretches(found: "StretchDensity | LawDensity", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """Densities of stretches, point masses as stems with their weights on the right."""
    ax = axes_or_new(ax)
    rows = found.density if found.density.ndim == 2 else found.density[None, :]
    several = len(rows) > 1
    atoms = found.atoms if isinstance(found.atoms, list) else [found.atoms]
    colors = shades(len(rows)) if several else [None]
    labels = labels_of("X", found.position, len(rows))
    stems = []
    for row, one, color, label in zip(rows, atoms, colors, labels, strict=True):
        own = style if color is None else {"color": color, **style}
        own = own if label is None else {"label": label, **own}
        line = outline(ax, found.stretch, row, **own)
        stems.append((one.position, one.weight, line.get_color()))
    ax.set_ylim(bottom=0.0)
    masses(ax, stems)
    ax.set(xlabel=axis("x", ""), ylabel=axis("Q", ""))
    few = 6
    if any(labels) and len(labels) <= few:
        ax.legend()
    elif any(labels):
        legend_above(ax)
    return ax


def labels_of(symbol: str, numbers: "NDArray[np.float64] | None", count: int) -> "list[str | None]":
    """Labels of curves, one for each number; none without numbers."""
    if numbers is None:
        return [None] * count
    return [f"${symbol}$ = {number:.6g}" for number in numbers]


def outline(
    ax: "Axes", stretch: "NDArray[np.float64]", density: "NDArray[np.float64]", **style: Any
) -> "Line2D":
    """A density as a line, which has no points where all is in point masses."""
    empty = not (density > 0.0).any()
    (line,) = ax.plot(stretch[:0] if empty else stretch, density[:0] if empty else density, **style)
    return line


class LawDensity(NamedTuple):
    """The density of a distribution as it is drawn, and its point masses."""

    stretch: "NDArray[np.float64]"
    density: "NDArray[np.float64]"
    atoms: "Atoms"
    position: None = None


def density(law: "Law") -> LawDensity:
    """The density between outer quantiles and some way beyond, undefined at a pole, and the point masses."""
    import numpy as np

    low, high = law.ppf(1e-3), law.isf(1e-3)
    beside = 0.1 * ((high - low) or high or 1.0)
    low, high = max(low - beside, 0.0), high + beside
    # A density may jump at its ends.
    jumps = [end for end in law.support() if low <= end <= high and math.isfinite(law.pdf(end))]
    edges = [x for end in jumps for x in (math.nextafter(end, 0.0), end, math.nextafter(end, math.inf))]
    within = law.ppf(np.linspace(0.005, 0.995, 397))
    x = np.unique(np.concatenate([np.linspace(low, high, 1001), within, edges]))
    values = law.pdf(x)
    return LawDensity(x, np.where(np.isfinite(values), values, np.nan), law.atoms)


def contacts(
    contacts: "Contacts", ax: "Axes | None" = None, initial: "Law | None" = None, **style: Any
) -> "Axes":
    """The distributions of thresholds, of re-formed contacts and of initial stretches."""
    if contacts.areas is not None:
        ax = law(contacts.areas.law, ax, **style)
        ax.set_xlabel("area of a contact")
        return ax
    ax = axes_or_new(ax)
    laws = {"thresholds": contacts.thresholds, "re-forming": contacts.reforming, "initial": initial}
    stems = []
    for name, one in laws.items():
        if one is not None:
            found = density(one)
            line = outline(ax, found.stretch, found.density, **{"label": name, **style})
            stems.append((one.atoms.position, one.atoms.weight, line.get_color()))
    ax.set_ylim(bottom=0.0)
    masses(ax, stems)
    ax.set(xlabel=axis("x", ""), ylabel="probability density")
    ax.legend()
    return ax


def model(model: "Model | Interface | Lattice", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The distributions of the contacts of a model, with that of their initial stretches."""
    return contacts(model.contacts, ax, model.initial, **style)


def block(block: "Block", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The equilibria of a slider on first loading."""
    return block.equilibrium().plot(ax, **style)


def law(law: "Law", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The density of a distribution, with dots at the quantiles of 5, 50 and 95 %."""
    import numpy as np

    found = density(law)
    ax = stretches(found, ax, **style)
    at = law.ppf([0.05, 0.5, 0.95])
    here = law.pdf(at)
    continuous = ~np.isin(at, law.atoms.position) & np.isfinite(here)
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4}
    ax.plot(at[continuous], here[continuous], **dots, color=ax.lines[-1].get_color())
    # At a pole it is drawn up to that at the quantile of 5 %.
    if not np.isfinite(found.density).all() and continuous.any():
        ax.set_ylim(top=1.1 * float(here[continuous].max()))
    ax.set(xlabel=axis("x", ""), ylabel=axis("p", "", "probability density"))
    return ax


def gradient(
    gradient: "Gradient", position: "NDArray[np.float64]", ax: "Axes | None" = None, **style: Any
) -> "Axes":
    """The derivative of the force by a parameter against the position."""
    ax = lines([(position, gradient(position), None)], ("X", "F"), ax, **style)
    ax.set_ylabel(f"derivative of $F$ by {gradient.parameter}")
    return ax


def friction_gradient(gradient: "FrictionGradient", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The derivatives of friction as bars; those that are not known or not finite have none."""
    ax = axes_or_new(ax)
    known = {
        "F_s": gradient.static_friction,
        "F_k": gradient.kinetic_friction,
        "X^*": gradient.relaxation_length,
        "K_c": gradient.critical_stiffness,
    }
    heights = [math.nan if value is None else value for value in known.values()]
    ax.bar(range(len(known)), heights, **{"width": 0.6, **style})
    ax.axhline(0.0, color=ink(), linewidth=0.6)
    ax.set_xticks(range(len(known)), [rf"$\partial {symbol}/\partial\theta$" for symbol in known])
    ax.set(xlabel="number of friction", ylabel="derivative by the parameter θ")
    return ax


def threshold_response(
    response: "ThresholdResponse", position: "NDArray[np.float64]", ax: "Axes | None" = None, **style: Any
) -> "Axes":
    """The response to the probability of some of the thresholds against the position."""
    import numpy as np

    ax = axes_or_new(ax)
    order = np.argsort(response.thresholds)
    shown = order[np.unique(np.linspace(0, len(order) - 1, 7).round().astype(int))]
    curves = response(position)
    for number, color in zip(shown, shades(len(shown)), strict=True):
        label = f"$x$ = {response.thresholds[number]:.4g}"
        ax.plot(position, curves[number], **{"label": label, "color": color, **style})
    ax.set(xlabel=axis("X", ""), ylabel="response of $F$ to a probability")
    legend_above(ax)
    return ax


def prediction(found: "Prediction", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The expected force with a band of two standard deviations of a reading."""
    ax = lines([(found.position, found.force, None)], ("X", "F"), ax, **{"label": "expected", **style})
    low, high = (found.force + sign * 2 * found.std for sign in (-1, 1))
    look: dict[str, Any] = {"color": ax.lines[-1].get_color(), "alpha": 0.2, "linewidth": 0}
    ax.fill_between(found.position, low, high, **look, label=once(ax, SCATTER, style))
    if "label" not in style:
        legend_above(ax)
    return ax


def colorbar(ax: "Axes", mesh: Any, label: str) -> None:
    """A colour bar beside a map and as tall."""
    figure: Any = ax.figure
    figure.colorbar(mesh, cax=ax.inset_axes((1.03, 0.0, 0.04, 1.0)), label=label)


def spots(spots: "Spots", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """A map of the spots, in the colours of their loads."""
    import numpy as np
    from matplotlib.colors import LogNorm

    ax = axes_or_new(ax)
    pixel = math.sqrt(float(spots.area.sum()) / np.count_nonzero(spots.labels))
    loads = np.concatenate([[np.nan], spots.load])[spots.labels]
    low, high = float(spots.load.min()), float(spots.load.max())
    rows, columns = (pixel * count for count in spots.labels.shape)
    look: dict[str, Any] = {
        "origin": "lower",
        "extent": (0.0, columns, 0.0, rows),
        "interpolation": "nearest",
    }
    # Over more than a decade, small spots would all look the same.
    norm = LogNorm(low, high) if 0.0 < 10.0 * low < high else None
    image = ax.imshow(loads, **{"norm": norm, **look, **style})
    ax.set(xlabel="second axis of the map", ylabel="first axis of the map")
    colorbar(ax, image, "load of a spot")
    return ax


def masses(ax: "Axes", stems: "Sequence[tuple[NDArray[Any], NDArray[Any], Any]]") -> None:
    """Point masses as stems, with their weights on the right: positions, weights and colours."""
    if not any(len(at) for at, _, _ in stems):
        return
    ends = ax.get_xlim()
    right = ax.twinx()
    for at, weights, color in stems:
        right.vlines(at, 0.0, weights, colors=color, linewidth=2)
    right.set(xlim=ends, ylim=(0.0, 1.05), ylabel="point masses, fraction")


def relaxation(relaxation: "Relaxation", ax: "Axes | None" = None, **style: Any) -> "Axes":
    """The roots of the characteristic equation in the complex plane."""
    ax = axes_or_new(ax)
    roots = relaxation.roots
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4}
    (line,) = ax.plot(roots.real, roots.imag, **{**dots, **style})
    ax.plot(roots.real, -roots.imag, **{**dots, "color": line.get_color()})
    ax.axhline(0.0, color=muted(), linewidth=0.6)
    ax.axvline(0.0, color=muted(), linewidth=0.6)
    ax.set(xlabel=r"$\mathrm{Re}\,s$", ylabel=r"$\mathrm{Im}\,s$")
    return ax


def lines(
    curves: "Sequence[tuple[NDArray[Any], NDArray[Any], str | None]]",
    names: "tuple[str, str]",
    ax: "Axes | None" = None,
    **style: Any,
) -> "Axes":
    """Curves with labels, and the symbols of the axes."""
    ax = axes_or_new(ax)
    for x, y, label in curves:
        ax.plot(x, y, **{"label": label, **style})
    ax.set(xlabel=axis(names[0], ""), ylabel=axis(names[1], ""))
    if any(label for _, _, label in curves):
        ax.legend()
    return ax


def events(events: "Events", ax: "Axes | None", x: str, y: str, **style: Any) -> "Axes":
    """A column of events against another."""
    ax = axes_or_new(ax)
    dots: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 4}
    ax.plot(events[x], events[y], **{**dots, **style})
    ax.set(xlabel=x.replace("_", " "), ylabel=y.replace("_", " "))
    return ax


def legend_above(ax: "Axes", sentences: "Sequence[str]" = ()) -> None:
    """A legend above the axes, where it hides nothing, below sentences; none where nothing has a name."""
    labels = ax.get_legend_handles_labels()[1]
    if not labels:
        return
    place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "alignment": "right"}
    place |= {"title": "\n".join(broken(ax, sentences)) or None, "title_fontsize": small()}
    ax.legend(**place, ncols=columns(ax, labels), frameon=False, borderaxespad=0.2)


def columns(ax: "Axes", labels: "Sequence[str]") -> int:
    """The number of columns, up to three, in which these labels of a legend are about as wide as the axes."""
    size = float(pyplot().rcParams["font.size"])
    # In units of the size of letters: 0.55 for a letter, 4.8 for a line and the space between columns.
    widths = [0.55 * len(re.sub(r"[${}_^\\]|mathrm", "", label)) + 4.8 for label in labels]
    most = 1.15 * 72 * ax.get_window_extent().width / ax.figure.dpi / size
    for count in (3, 2):
        rows = math.ceil(len(widths) / count)
        if sum(max(widths[first : first + rows]) for first in range(0, len(widths), rows)) <= most:
            return count
    return 1


def errors(ax: "Axes", x: Any, y: Any, error: Any, **style: Any) -> None:
    """Dots with error bars, in the ink of the present style."""
    import numpy as np

    look: dict[str, Any] = {"fmt": ".", "markersize": 4, "elinewidth": 0.8, "color": ink(), "zorder": 2.5}
    ax.errorbar(x, y, np.where(np.isfinite(error), error, 0.0), **{**look, **style})


def fit_ends(ax: "Axes", x: Any) -> None:
    """Ends the axis where the data end."""
    ax.set_xlim(float(x[0]), float(x[-1]))


def ink() -> str:
    """The colour of text in the present style: for what is measured."""
    color: str = pyplot().rcParams["text.color"]
    return color


def muted() -> str:
    """The colour of what stands behind, in the present style."""
    color: str = pyplot().rcParams["grid.color"]
    return color


def shades(count: int) -> "list[Any]":
    """Colours from the present map, in order, without its lightest end."""
    import numpy as np

    shown = pyplot().get_cmap()
    return [shown(share) for share in np.linspace(0.0, 0.85, count)]


def axes_or_new(ax: "Axes | None") -> "Axes":
    """The axes, or new ones."""
    if ax is None:
        return new_axes()
    if not are_axes(ax):
        raise TypeError(f"ax: expected axes of matplotlib, got {type(ax).__name__}")
    return ax


def panels_or_new(axes: "Sequence[Axes] | None", count: int) -> "tuple[Axes, ...]":
    """The axes, which are as many as this or more, or new ones."""
    if axes is None:
        return new_panels(count)
    given = tuple(axes) if isinstance(axes, Iterable) else ()
    if len(given) < count or not all(map(are_axes, given)):
        of = f" of {', '.join(type(ax).__name__ for ax in given)}" if given else ""
        raise TypeError(f"axes: expected {count} axes of matplotlib, got {type(axes).__name__}{of}")
    return given


def are_axes(ax: Any) -> bool:
    """Whether something plots as axes do."""
    return callable(getattr(ax, "plot", None))


def new_axes() -> "Axes":
    # A legend above the axes and a colour bar beside them need room.
    axes: Axes = pyplot().subplots(layout="constrained")[1]
    return axes


def new_panels(count: int) -> "tuple[Axes, ...]":
    """Axes below each other, the first three times as high as the others."""
    heights = [3, *(1 for _ in range(count - 1))]
    shared: dict[str, Any] = {"sharex": True, "squeeze": False, "layout": "constrained"}
    figure, panels = pyplot().subplots(count, height_ratios=heights, **shared)
    figure.align_ylabels(panels)
    return tuple(panels[:, 0])


def pyplot() -> ModuleType:
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install 'asperity[plot]'") from error
    return plt


def axis(symbol: str, units: str, words: str = "") -> str:
    """A label: words, a symbol of mathematics, and a unit."""
    name = f"{words} ${upright(symbol)}$".strip() if symbol else words
    return name if units in ("", "1") else f"{name} ({units})"


def upright(symbol: str) -> str:
    """Subscripts that are words are upright."""
    return re.sub(r"_\{(\w\w+)\}", r"_{\\mathrm{\1}}", symbol)
