"""What a fit has found, as text."""

import math
from typing import TYPE_CHECKING

from asperity import _show

if TYPE_CHECKING:
    from asperity._core import Estimates, SteadyEstimates, VelocityCurveEstimates
    from asperity._fit_values import Estimate


def text(fit: "Estimates") -> str:
    return "\n".join([_show.listed("<asperity.Estimates>", {**rows(fit), **compared(fit)}), *remarks(fit)])


def html(fit: "Estimates") -> str:
    remark = " ".join(remarks(fit))
    reported = {"remark": remark} if remark else {}
    return _show.table("Estimates", {**rows(fit), **compared(fit), **reported})


def summary(fit: "Estimates") -> str:
    return "\n".join([_show.listed(title(fit), {**rows(fit), **compared(fit)}), *remarks(fit)])


def title(fit: "Estimates") -> str:
    count = len(fit.readings["position"])
    if fit.misfit is None:
        return f"errors that a measurement at {count} positions would have"
    return f"fit to {count} readings, {fit.solutions} solutions of the master equation"


def steady_text(fit: "SteadyEstimates") -> str:
    return "\n".join([_show.listed("<asperity.SteadyEstimates>", rows(fit)), *remarks(fit, "record")])


def steady_html(fit: "SteadyEstimates") -> str:
    remark = " ".join(remarks(fit, "record"))
    return _show.table("SteadyEstimates", {**rows(fit), **({"remark": remark} if remark else {})})


def steady_summary(fit: "SteadyEstimates") -> str:
    title = (
        f"fit to {fit.readings} readings in steady sliding, {fit.solutions} solutions of the master equation"
    )
    return "\n".join([_show.listed(title, rows(fit)), *remarks(fit, "record")])


def velocity_curve_text(fit: "VelocityCurveEstimates") -> str:
    return "\n".join([_show.listed("<asperity.VelocityCurveEstimates>", rows(fit)), *remarks(fit)])


def velocity_curve_html(fit: "VelocityCurveEstimates") -> str:
    remark = " ".join(remarks(fit))
    return _show.table("VelocityCurveEstimates", {**rows(fit), **({"remark": remark} if remark else {})})


def velocity_curve_summary(fit: "VelocityCurveEstimates") -> str:
    title = f"fit to {fit.readings} forces of steady sliding, {fit.solutions} curves computed"
    return "\n".join([_show.listed(title, rows(fit)), *remarks(fit)])


def rows(fit: "Estimates | SteadyEstimates | VelocityCurveEstimates") -> dict[str, str]:
    """Estimates, fixed numbers, large correlations, and how well the readings are described."""
    rows = {name: estimate(one) for name, one in fit.params.items()}
    rows |= {name: f"{value:.6g} (fixed)" for name, value in fit.fixed.items()}
    for one in fit.correlations:
        rows[f"correlation of {' and '.join(one.between)}"] = f"{one.coefficient:.2f}"
    if fit.misfit is not None:
        misfit = fit.misfit
        of = (
            "sizes of errors are estimated" if misfit.probability is None else f"p = {misfit.probability:.2g}"
        )
        rows["chi-squared"] = (
            f"{misfit.chi_squared:.1f} for {misfit.degrees_of_freedom} degrees of freedom, {of}"
        )
        rows["whiteness of the residuals"] = f"p = {misfit.whiteness:.2g}"
    return rows


def compared(fit: "Estimates") -> dict[str, str]:
    """The differences of Akaike's criterion between distributions of thresholds."""
    known = {"the fitted thresholds": fit, **fit.laws} if fit.laws else {}
    criteria = {name: one.misfit.akaike for name, one in known.items() if one.misfit is not None}
    return {f"ΔAIC of {name}": f"{value - min(criteria.values()):.1f}" for name, value in criteria.items()}


def remarks(fit: "Estimates | SteadyEstimates | VelocityCurveEstimates", what: str = "curve") -> list[str]:
    """Sentences about a fit that is not to be trusted."""
    unlikely = fit.misfit is not None and fit.misfit.unlikely
    return doubts(fit.converged, unlikely, sparse=getattr(fit, "sparse", False), what=what)


def doubts(converged: bool, unlikely: bool, *, sparse: bool = False, what: str = "curve") -> list[str]:
    """Sentences about a search that has not converged, residuals that are unlikely, and sparse readings."""
    found = []
    if not converged:
        found.append("The search did not converge: these are its last values.")
    if unlikely:
        found.append(f"The {what} is not of this kind: do not trust the errors.")
    if sparse:
        found.append(
            "The readings are sparse: contacts of longer or shorter lives may have the same forces there."
        )
    return found


def estimate(one: "Estimate") -> str:
    """Value ± error and interval, or the limit."""
    if one.limit is not None:
        return f"below {one.limit:.3g} (95 %)" if math.isfinite(one.limit) else "not determined"
    if one.error == 0:
        return f"{one.value:.6g}, at the end of its range"
    if not math.isfinite(one.error):
        return f"{one.value:.6g} ± {one.error}"
    ends = (one.value, one.error, *one.interval)
    value, error, low, high = (_show.rounded(end, one.error) for end in ends)
    return f"{value} ± {error}, {low} to {high} (95 %)"
