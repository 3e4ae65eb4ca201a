"""Laws from what else describes one: frozen distributions of scipy.stats, and samples."""

import sys
from math import erfc, exp, expm1, inf, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity._core import Exponential, Gamma, Gaussian, Law, Lognormal, Rectangular, Tabulated, Weibull

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.stats.distributions import rv_frozen

EPSILON = sys.float_info.epsilon


def law(x: "Law | rv_frozen | NDArray[np.float64] | Sequence[float]") -> Law:
    """The law that `x` describes: itself, a frozen distribution of scipy.stats, or samples.

    Of scipy.stats, norm, truncnorm, halfnorm, uniform, gamma, erlang, expon, weibull_min and lognorm become
    the law of asperity that has the same density, if there is one: cut at 0, if at all. A list of samples
    becomes Tabulated(samples=x).

    Raises ValueError for a distribution with values below 0 or none of these, TypeError for anything else,
    such as a distribution that is not frozen.
    """
    if isinstance(x, Law):
        return x
    if isinstance(x, (np.ndarray, list, tuple)):
        return Tabulated(samples=x)
    stats: Any = sys.modules.get("scipy.stats")
    if stats is not None and isinstance(x, stats.distributions.rv_frozen):
        return from_scipy(x)
    expected = "a law of asperity, a frozen distribution of scipy.stats, or samples"
    if stats is not None and isinstance(x, (stats.rv_continuous, stats.rv_discrete)):
        raise TypeError(f"law: expected {expected}, got scipy.stats.{x.name}, which is not frozen")
    raise TypeError(f"law: expected {expected}, got {type(x).__name__}")


def from_scipy(frozen: Any) -> Law:
    """The law of the same density as a frozen distribution."""
    name = frozen.dist.name
    try:
        shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
        shapes, loc, scale = [float(shape) for shape in shapes], float(loc), float(scale)
    except TypeError:
        raise ValueError(f"law: expected numbers as parameters, got arrays for {name}") from None
    found = counterpart(name, shapes, loc, scale)
    if found is not None:
        return found
    low, high = frozen.support()
    if low < 0.0:
        share = frozen.cdf(0.0)
        raise ValueError(
            f"law: expected a law on x >= 0, got {name} with a share {share:.3g} below (Gaussian cuts it)"
        )
    raise ValueError(f"law: expected a distribution that has a counterpart, got {name} from {low} to {high}")


def counterpart(name: str, shapes: list[float], loc: float, scale: float) -> Law | None:
    """The law of a family that scipy.stats calls `name`, or None."""
    match name, shapes:
        case "norm", [] if normal_below(loc, scale) < EPSILON:
            return Gaussian(loc, scale)
        case "truncnorm", [a, b] if b == inf and abs(loc + a * scale) < EPSILON * abs(loc) and loc >= 0.0:
            return Gaussian(loc, scale)
        case "halfnorm", [] if loc == 0.0:
            return Gaussian(0.0, scale)
        case "uniform", [] if loc >= 0.0:
            return Rectangular(loc, loc + scale)
        case (("gamma" | "erlang"), [a]) if loc == 0.0:
            return Gamma(a * scale, sqrt(a) * scale)
        case "expon", [] if loc == 0.0:
            return Exponential(scale)
        case "weibull_min", [c] if loc == 0.0:
            return Weibull(c, scale)
        case "lognorm", [s] if loc == 0.0:
            mean = scale * exp(0.5 * s * s)
            return Lognormal(mean, mean * sqrt(expm1(s * s)))
    return None


def normal_below(mean: float, std: float) -> float:
    """The share of a Gaussian below 0."""
    return 0.5 * erfc(mean / (std * sqrt(2.0)))
