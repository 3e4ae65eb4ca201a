"""Draws from a posterior, as text and for ArviZ."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from asperity import _show

if TYPE_CHECKING:
    from asperity._core import Posterior
    from asperity._fit_values import PosteriorNumber


def text(posterior: "Posterior") -> str:
    return "\n".join([_show.listed("<asperity.Posterior>", rows(posterior)), *posterior.warnings])


def html(posterior: "Posterior") -> str:
    remark = " ".join(posterior.warnings)
    return _show.table("Posterior", {**rows(posterior), **({"remark": remark} if remark else {})})


def summary(posterior: "Posterior") -> str:
    chains, draws = posterior.log_density.shape
    title = f"{chains} chains of {draws} draws from the posterior"
    return "\n".join([_show.listed(title, rows(posterior)), *posterior.warnings])


def rows(posterior: "Posterior") -> dict[str, str]:
    """A row for each number, and the divergences."""
    rows = {name: number(one) for name, one in posterior.params.items()}
    return {**rows, "divergences": str(posterior.divergences)}


def number(one: "PosteriorNumber") -> str:
    """Mean ± standard deviation, interval, r̂ and effective number of draws."""
    if not one.std > 0:
        return f"{one.mean:.6g} in all draws"
    mean, std, low, high = (_show.rounded(value, one.std) for value in (one.mean, one.std, *one.interval))
    return f"{mean} ± {std}, {low} to {high} (95 %), r̂ = {one.r_hat:.3f}, ESS {one.ess:.0f}"


def arviz(posterior: "Posterior") -> Any:
    """The groups `posterior` and `sample_stats`."""
    try:
        arviz = import_module("arviz")
    except ImportError as error:
        raise ImportError("to_arviz() needs arviz: pip install arviz") from error
    groups = {
        "posterior": posterior.draws,
        "sample_stats": {"lp": posterior.log_density, "diverging": posterior.diverging != 0},
    }
    # From version 1 on, one dict of groups; before, an argument for each.
    if int(arviz.__version__.split(".")[0]) >= 1:
        return arviz.from_dict(groups)
    return arviz.from_dict(**groups)
