"""Distributions of asperity from frozen distributions of scipy.stats and from samples."""

import sys
from itertools import pairwise
from math import erfc, exp, expm1, inf, log2, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity._core import (
    Exponential,
    Gamma,
    Gaussian,
    Law,
    Lognormal,
    Mixture,
    Point,
    Rectangular,
    Series,
    Tabulated,
    Weibull,
    _resolve,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray
    from scipy.stats import gaussian_kde
    from scipy.stats.distributions import rv_frozen

EPSILON = sys.float_info.epsilon

# At the start a cell contains at most this fraction of a distribution, so that no peak is missed.
SHARE = 0.125

# The halves of a cell have equal masses where a density is finite, and nearly so where it jumps; at a pole
# that a Series cannot represent, one of them has more than this fraction.
UNEVEN = 0.55

# Bisection towards a pole ends at this relative distance; the mass nearer to it becomes a point, unless it is
# below FAINT.
NEAR = 1e-6
FAINT = 1e-8

# The kernels of a kernel density estimate vanish at this many bandwidths. A Series of this many terms
# represents them to rounding, in tails too, in cells of half a bandwidth, of which there may be MOST_CELLS.
REACH = 9.0
TERMS = 16
MOST_CELLS = 20_000

# Largest number of values of a discrete distribution.
MOST = 1000

# Tolerance for the agreement of a distribution function and its density.
AGREE = 1e-6


class Peak(NamedTuple):
    """The mass near a pole of a density, on one side of it."""

    low: float
    high: float
    mass: float
    mean: float


def law(x: "Law | rv_frozen | gaussian_kde | NDArray[np.float64] | Sequence[float]") -> Law:
    """The distribution that `x` describes: itself, a distribution of scipy.stats, or samples.

    The distributions norm, truncnorm, halfnorm, uniform, gamma, erlang, expon, weibull_min and lognorm
    of scipy.stats become the distribution of asperity with the same density, if there is one (truncated
    at 0, if at all). Any other distribution on x >= 0 becomes a Series, accurate to rounding of its
    pdf; so does any object with the methods pdf, cdf and support, such as stats.Mixture and
    stats.rv_histogram. If the pdf is infinite at an x above 0, the part within 1e-6 x of that point
    becomes a Point with the same mass and mean, in a Mixture with the Series. A discrete distribution
    becomes a Mixture of Points. A gaussian_kde becomes a Series, truncated at 0. A list of samples becomes
    Tabulated(samples=x).

    Parameters
    ----------
    x : Law, scipy.stats distribution, gaussian_kde or array_like
        What describes the distribution.

    Returns
    -------
    Law
        The distribution.

    Raises
    ------
    ValueError
        For a distribution with values below 0 or a variance that is not finite.
    RuntimeError
        For a pdf that cannot be resolved.
    TypeError
        For anything else, such as a distribution that is not frozen.

    Examples
    --------
    >>> import asperity as asp
    >>> from scipy import stats
    >>> asp.law(stats.gamma(4.0, scale=0.25))
    Gamma(mean=1.0, std=0.5)
    >>> round(asp.law([0.8, 0.9, 1.0, 1.1, 1.2]).mean(), 6)
    1.0
    """
    if isinstance(x, Law):
        return x
    if isinstance(x, (np.ndarray, list, tuple)):
        return Tabulated(samples=x)
    stats: Any = sys.modules.get("scipy.stats")
    if stats is not None and isinstance(x, stats.distributions.rv_frozen):
        return from_scipy(x)
    if stats is not None and isinstance(x, stats.gaussian_kde):
        return kernels(x)
    expected = "a distribution of asperity, a frozen distribution of scipy.stats, or samples"
    if stats is not None and isinstance(x, (stats.rv_continuous, stats.rv_discrete)):
        if isinstance(x, stats.rv_histogram):
            return series(x, "rv_histogram")
        raise TypeError(f"x: expected {expected}, got scipy.stats.{x.name}, which is not frozen")
    if all(callable(getattr(x, method, None)) for method in ("pdf", "cdf", "support")):
        return series(x, type(x).__name__)
    raise TypeError(f"x: expected {expected}, got {type(x).__name__}")


def from_scipy(frozen: Any) -> Law:
    """The distribution of asperity with the same density as a frozen distribution."""
    name = frozen.dist.name or type(frozen.dist).__name__
    try:
        shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
        shapes, loc, scale = [float(shape) for shape in shapes], float(loc), float(scale)
    except TypeError:
        raise ValueError(f"law: expected numbers as parameters, got arrays for {name}") from None
    found = counterpart(name, shapes, loc, scale)
    if found is not None:
        return found
    return series(frozen, name) if hasattr(frozen, "pdf") else points(frozen, name)


def series(distribution: Any, name: str) -> Law:
    """The distribution of a density; its distribution function locates the mass."""
    with np.errstate(all="ignore"):
        low, high = (float(end) for end in distribution.support())
        share = float(distribution.cdf(0.0)) if low < 0.0 else 0.0
        if not share < EPSILON:
            hint = " (Gaussian cuts it)" if name == "norm" else ""
            raise ValueError(
                f"law: expected a distribution on x >= 0, got {name} with a fraction {share:.3g} below{hint}"
            )
        edges = bulk(distribution, max(low, 0.0), high)
        peaks = poles(distribution, edges)
        found = mixed(distribution, edges if edges[-1] == high else [*edges, inf], peaks)
        apart = float(np.max(np.abs(found.cdf(edges) - distribution.cdf(np.array(edges)))))
    if not apart < AGREE:
        raise ValueError(
            f"law: expected a pdf and a cdf that agree, got {name}, where they are {apart:.3g} apart"
        )
    return found


def kernels(estimate: "gaussian_kde") -> Series:
    """The Series of a kernel density estimate, in cells as wide as its kernels at most, from 0 on."""
    if estimate.d != 1:
        raise ValueError(f"law: expected a gaussian_kde of one variable, got one of {estimate.d}")
    width = float(np.sqrt(estimate.covariance[0, 0]))
    centres = np.unique(estimate.dataset[0])
    low, high = max(float(centres[0]) - REACH * width, 0.0), float(centres[-1]) + REACH * width
    if not low < high:
        raise ValueError("law: expected a gaussian_kde with values above 0")
    count = int(np.ceil(2.0 * (high - low) / width))
    if count > MOST_CELLS:
        raise ValueError(
            f"law: expected a gaussian_kde of at most {MOST_CELLS // 2} bandwidths, got {count // 2}"
        )
    return projected(estimate, np.linspace(low, high, count + 1))


def projected(
    density: "Callable[[NDArray[np.float64]], NDArray[np.float64]]", edges: "NDArray[np.float64]"
) -> Series:
    """The Series of a density that a polynomial represents to rounding in each cell."""
    nodes, weights = np.polynomial.legendre.leggauss(TERMS)
    points = 0.5 * (edges[:-1] + edges[1:])[:, None] + 0.5 * np.diff(edges)[:, None] * nodes
    values = density(points.ravel()).reshape(points.shape)
    order = np.arange(TERMS)
    projection = weights * np.polynomial.legendre.legvander(nodes, TERMS - 1).T * (order[:, None] + 0.5)
    return Series(edges, list(values @ projection.T))


def poles(distribution: Any, edges: list[float]) -> list[Peak]:
    """The masses near the poles of a density: each cell is bisected towards the half with more mass.

    Where p ~ |x - pole|^(e - 1) the near half has 2^-e of the mass, and the mean is at e / (1 + e) of the
    distance from the pole.
    """
    found = []
    for low, high in pairwise(edges):
        below, above = (float(distribution.cdf(end)) for end in (low, high))
        share, fixed = 0.5, low
        while low > 0.0 and high - low > NEAR * high:
            middle = 0.5 * (low + high)
            here = float(distribution.cdf(middle))
            mass, rising = above - below, above - here > here - below
            low, below, high, above = (middle, here, high, above) if rising else (low, below, middle, here)
            share, fixed = (above - below) / mass if mass > 0.0 else 0.5, high if rising else low
        if above - below > FAINT and share > UNEVEN:
            power = -log2(share)
            mean = fixed + (low + high - 2.0 * fixed) * power / (1.0 + power)
            found.append(Peak(low, high, above - below, mean))
    return found


def mixed(distribution: Any, edges: list[float], peaks: list[Peak]) -> Law:
    """The Series of a density, with a Point for each of its peaks."""
    if not peaks:
        return _resolve(distribution.pdf, edges)

    def between(x: "NDArray[np.float64]") -> "NDArray[np.float64]":
        within = [(peak.low < x) & (x < peak.high) for peak in peaks]
        return np.where(np.any(within, axis=0), 0.0, distribution.pdf(x))

    ends = {end for peak in peaks for end in (peak.low, peak.high)}
    rest = _resolve(between, sorted({*edges, *ends}))
    parts = [(peak.mass, Point(peak.mean)) for peak in peaks]
    return Mixture([(1.0 - sum(mass for mass, _ in parts), rest), *parts])


def points(distribution: Any, name: str) -> Mixture:
    """The distribution of a probability mass function: points, except a negligible fraction."""
    low, high = (float(end) for end in distribution.support())
    if low < 0.0:
        raise ValueError(f"law: expected a distribution on x >= 0, got {name}, which begins at {low:g}")
    last = min(high, float(distribution.isf(EPSILON)))
    if not last - low < MOST:
        raise ValueError(
            f"law: expected at most {MOST} values of a discrete distribution, got {last - low + 1:g}"
        )
    values = np.arange(low, last + 1.0)
    weights = distribution.pmf(values)
    felt = weights > EPSILON
    weights = weights[felt] / weights[felt].sum()
    return Mixture([(float(w), Point(float(x))) for w, x in zip(weights, values[felt], strict=True)])


def bulk(distribution: Any, low: float, high: float) -> list[float]:
    """Edges of cells from `low` up to `high`, or to where an infinite tail begins."""
    if high < inf:
        end = high
    else:
        octaves = low + np.ldexp(1.0, np.arange(-100, 100))
        beyond = distribution.cdf(octaves) >= 1.0 - SHARE
        if not beyond.any():
            raise ValueError(
                f"law: expected a cdf that rises to 1, got {distribution.cdf(octaves[-1])} at {octaves[-1]}"
            )
        end = float(octaves[beyond.argmax()])
    edges = np.array([low, end])
    while True:
        wide = np.diff(distribution.cdf(edges)) > SHARE
        middles = 0.5 * (edges[:-1] + edges[1:])[wide]
        halved = np.unique(np.concatenate([edges, middles]))
        if len(halved) == len(edges):
            return [float(edge) for edge in edges]
        edges = halved


def counterpart(name: str, shapes: list[float], loc: float, scale: float) -> Law | None:
    """The distribution of asperity for the family that scipy.stats calls `name`, or None."""
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
    """The probability of a Gaussian distribution below 0."""
    return 0.5 * erfc(mean / (std * sqrt(2.0)))
