"""How descriptions and results are printed."""

import math
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from asperity._core import Healing, Record, VelocityStep
    from asperity._fit_values import Estimate, MachineHealing, MachineStep

MOST = 1000
"""Items of a list that are printed, as many as NumPy prints."""


UNLIKELY = 1e-3
"""The probability below which residuals are not those of the assumed noise."""


def text(name: str, arguments: Mapping[str, object]) -> str:
    """The Python code that creates a description, except for lists too long to print."""
    return f"{name}({', '.join(f'{key}={item(value)}' for key, value in arguments.items())})"


def item(value: object) -> str:
    if isinstance(value, list) and len(value) > MOST:
        return f"[{', '.join(map(repr, value[:3]))}, ..., {', '.join(map(repr, value[-3:]))}]"
    return repr(value)


def html(name: str, arguments: Mapping[str, object]) -> str:
    return table(name, {key: brief(value) for key, value in arguments.items()})


def brief(value: object) -> str:
    if isinstance(value, list) and len(value) > 6:
        return f"{len(value)} items from {value[0]!r} to {value[-1]!r}"
    return repr(value)


def table(caption: str, rows: Mapping[str, str]) -> str:
    left = 'style="text-align:left"'
    cells = (f"<th {left}>{escape(key)}</th><td {left}>{escape(value)}</td>" for key, value in rows.items())
    body = "".join(f"<tr>{cell}</tr>" for cell in cells)
    return f"<table><caption>{escape(caption)}</caption>{body}</table>"


def record(record: "Record") -> str:
    return listed(f"<asperity.{type(record).__name__}>", rows(record))


def listed(caption: str, rows: Mapping[str, str]) -> str:
    width = max(map(len, rows))
    return "\n".join([caption, *(f"  {key:<{width}} {value}" for key, value in rows.items())])


def numbers(values: "NDArray[np.float64]") -> str:
    """The first and the last values."""
    texts = [f"{value:.6g}" for value in values]
    return " ".join([*texts[:3], "...", *texts[-3:]] if len(texts) > 7 else texts)


def record_html(record: "Record") -> str:
    return table(type(record).__name__, rows(record))


def rows(record: "Record") -> dict[str, str]:
    """What is known of the task, and the variables with their shapes."""
    summary = getattr(record, "summary", None)
    rows = numbers_of(record) if summary is None else reported(summary)
    for name, label in record.labels.items():
        sizes = zip(label.dimensions, record[name].shape, strict=True)
        shape = ", ".join(f"{dimension}: {length}" for dimension, length in sizes)
        rows[name] = f"({shape}) {label.long_name} [{label.units}]"
    return rows


NUMBERS = (
    "static_friction",
    "kinetic_friction",
    "relaxation_length",
    "critical_stiffness",
    "breaks",
    "regime",
    "reason",
    "period",
    "mean_drop",
    "mean_slip",
)
"""Numbers and words that records without a summary may have."""


def numbers_of(record: "Record") -> dict[str, str]:
    """Those of the numbers that a record has."""
    rows = {}
    for name in NUMBERS:
        value = getattr(record, name, math.nan)
        if value is None and name == "static_friction":
            rows[name] = "not reached"
        elif value is not None and not is_nan(value):
            rows[name] = number(value)
    return rows


def is_nan(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


APART = ("title", "version", "units", "warnings", "numbers")
"""Entries of a summary that are not shown as they are."""


def reported(summary: Mapping[str, Any]) -> dict[str, str]:
    """The entries of a summary, without lists; those of its tables after the name of the table."""
    rows = {"title": summary["title"]} if summary["title"] else {}
    for name, entry in summary.items():
        if isinstance(entry, dict) and set(entry) == {"force", "position"}:
            rows[name] = number((entry["force"], entry["position"]))
        elif isinstance(entry, dict) and name not in APART:
            found = {key: value for key, value in entry.items() if simple(value)}
            rows |= {f"{name}.{key}": number(value) for key, value in found.items()}
            for one in entry.get("numbers", []):
                rows[one["key"]] = f"{one['value']:.6g} ± {one['error'] or 0.0:.2g}"
        elif name not in APART and simple(entry):
            rows[name] = number(entry)
    for place, warning in enumerate(summary.get("warnings", [])):
        rows[f"warning {place + 1}"] = warning
    return rows


def simple(value: object) -> bool:
    return value is not None and not isinstance(value, dict | list)


def velocity_step(step: "VelocityStep") -> str:
    noise = step.noise
    drift = (f", drift {one.std:.3g} over {one.length:.3g}" for one in noise.drift)
    rows = {name: getattr(step, name) for name in ("a", "b", "a_minus_b", "distance", "before", "trend")}
    shown = {name: estimate(value) for name, value in rows.items() if value is not None}
    rest = {"peak": f"{step.peak:.6g}", "residual": f"{step.residual:.3g}"}
    noises = {"noise": f"white {noise.white:.3g}{''.join(drift)}"}
    if step.whiteness is not None:
        noises["whiteness"] = f"p = {step.whiteness:.2g}"
    return "\n".join([listed("<asperity.VelocityStep>", {**shown, **rest, **noises}), *warned(step)])


def warned(found: "VelocityStep | Healing") -> list[str]:
    """The warnings of what was read, as sentences."""
    return [f"{warning[:1].upper()}{warning[1:]}." for warning in found.warnings]


def healing(healing: "Healing") -> str:
    rows = {name: getattr(healing, name) for name in ("per_decade", "cutoff", "at_one")}
    shown = {name: estimate(value) for name, value in rows.items() if value is not None}
    text = listed("<asperity.Healing>", {**shown, "residual": f"{healing.residual:.3g}"})
    return "\n".join([text, *warned(healing)])


def machine(found: "MachineStep | MachineHealing") -> str:
    """The numbers of a fit behind the spring of a machine, without its curve."""
    several = {
        name: (value,) if isinstance(value, float) else value
        for name, value in (("a", found.a), ("b", found.b), ("distance", found.distance))
    }
    shown = {name: ", ".join(f"{value:.5g}" for value in values) for name, values in several.items()}
    residual = f"{found.residual:.3g}, {found.residual_relative:.2g} of the range of the forces"
    rest = {"before": f"{found.before:.6g}", "residual": residual, "fitted": f"{len(found.fitted)} forces"}
    return listed(f"<asperity.{type(found).__name__}>", {**shown, **rest})


def estimate(found: "Estimate") -> str:
    """Value and error, with two digits of the error, and the interval."""
    ends = (found.value, found.error, *found.interval)
    value, error, low, high = (rounded(one, found.error) for one in ends)
    return f"{value} ± {error} (95 %: {low} to {high})"


DIGITS = 15
"""The decimal digits that every double has."""

LARGE = 1e7
"""Numbers from here on are written with an exponent."""


def rounded(value: float, error: float) -> str:
    """A number to the second digit of its error, or to six digits where the error is 0 or unknown."""
    if not (math.isfinite(value) and 0 < error < math.inf):
        return f"{value:.6g}"
    places = 1 - math.floor(math.log10(error))
    if abs(value) >= LARGE:
        decimals = max(1, places + math.floor(math.log10(abs(value))))
        return f"{value:.{decimals if decimals < DIGITS else 5}e}"
    if 0 <= places <= 6:
        return f"{value:.{places}f}"
    digits = max(2, places + 1 + math.floor(math.log10(abs(value)))) if value else 2
    return f"{value:.{min(digits, DIGITS)}g}" if places > 0 else f"{round(value, places):.0f}"


def number(value: object) -> str:
    if isinstance(value, tuple):
        force, position = value
        return f"{force:.6g} at {position:.6g}"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
