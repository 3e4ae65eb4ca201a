"""Laws: against scipy.stats where it is right to rounding, against 40-digit arithmetic where it is not."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import asperity as asp
import mpmath
import numpy as np
import pytest
from scipy import stats

TABLES = Path(__file__).parents[2] / "core" / "tests" / "tables"

GAMMA = stats.gamma(a=1.5**2 / 0.4**2, scale=0.4**2 / 1.5)
SIGMA = np.sqrt(np.log1p(0.3**2))

# Laws without mass below 0, and what scipy.stats calls them.
PAIRS: dict[str, tuple[asp.Law, Any]] = {
    "gaussian": (asp.Gaussian(1.0, 0.05), stats.norm(1.0, 0.05)),
    "gamma": (asp.Gamma(1.5, 0.4), GAMMA),
    "lognormal": (asp.Lognormal(1.0, 0.3), stats.lognorm(s=SIGMA, scale=np.exp(-0.5 * SIGMA**2))),
    "rectangular": (asp.Rectangular(0.75, 1.25), stats.uniform(0.75, 0.5)),
    "exponential": (asp.Exponential(0.7), stats.expon(scale=0.7)),
    "weibull": (asp.Weibull(12.0, 1.5), stats.weibull_min(12.0, scale=1.5)),
}
# scipy.stats is right to some 1e-13 where P(ξ ≤ x) and S are neither tiny.
LEVELS = np.array([1e-3, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999])
CLOSE = 1e-12

every_pair = pytest.mark.parametrize(("law", "reference"), PAIRS.values(), ids=PAIRS.keys())


@every_pair
def test_functions_are_those_of_scipy(law: asp.Law, reference: Any) -> None:
    x = reference.ppf(LEVELS)
    for name in ("pdf", "cdf", "sf", "logsf"):
        ours, theirs = getattr(law, name)(x), getattr(reference, name)(x)
        np.testing.assert_allclose(ours, theirs, rtol=CLOSE, err_msg=name)
    np.testing.assert_allclose(law.hazard(x), reference.pdf(x) / reference.sf(x), rtol=CLOSE)


@every_pair
def test_quantiles_and_moments_are_those_of_scipy(law: asp.Law, reference: Any) -> None:
    np.testing.assert_allclose(law.ppf(LEVELS), reference.ppf(LEVELS), rtol=CLOSE)
    np.testing.assert_allclose(law.isf(LEVELS), reference.isf(LEVELS), rtol=CLOSE)
    np.testing.assert_allclose([law.mean(), law.std()], [reference.mean(), reference.std()], rtol=CLOSE)
    np.testing.assert_allclose(law.moment(3), reference.moment(3), rtol=CLOSE)
    low, high = reference.support()
    assert law.support() == pytest.approx((max(low, 0.0), high), rel=CLOSE)


@pytest.mark.parametrize(("mean", "std"), [(1.0, 0.3), (0.2, 0.5), (0.0, 2.0)])
def test_a_gaussian_cut_at_0_is_the_conditional_one(mean: float, std: float) -> None:
    law, parent = asp.Gaussian(mean, std), stats.norm(mean, std)
    kept = parent.sf(0.0)
    x = law.ppf(LEVELS)
    np.testing.assert_allclose(law.pdf(x), parent.pdf(x) / kept, rtol=CLOSE)
    np.testing.assert_allclose(law.sf(x), parent.sf(x) / kept, rtol=CLOSE)
    # Near 0 the difference cancels two of the digits.
    np.testing.assert_allclose(law.cdf(x), (parent.cdf(x) - parent.cdf(0.0)) / kept, rtol=100 * CLOSE)
    np.testing.assert_allclose(law.hazard(x), parent.pdf(x) / parent.sf(x), rtol=CLOSE)


def rows(name: str) -> Iterator[tuple[asp.Law, dict[str, float]]]:
    """Laws, and values in 40-digit arithmetic; what is not given is NaN."""
    kinds = {"gaussian": asp.Gaussian, "gamma": asp.Gamma, "weibull": asp.Weibull, "lognormal": asp.Lognormal}
    with open(TABLES / name, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            kind, first, second = kinds[row.pop("law")], row.pop("first"), row.pop("second")
            yield kind(float(first), float(second)), {key: float(x or "nan") for key, x in row.items()}


def test_tails_are_those_of_40_digits() -> None:
    for law, row in rows("law_points.csv"):
        x, minus_ln = row["x"], row["minus_ln_survival"]
        # exp(-L) magnifies the rounding of L; ln S and the hazard are free of it.
        exponential = 1e-14 + 1e-15 * minus_ln
        assert law.pdf(x) == pytest.approx(row["density"], rel=exponential, abs=0.0)
        assert law.sf(x) == pytest.approx(row["survival"], rel=exponential, abs=0.0)
        assert -law.logsf(x) == pytest.approx(minus_ln, rel=1e-14, abs=0.0)
        assert law.hazard(x) == pytest.approx(row["hazard"], rel=1e-14, abs=0.0)


def test_quantiles_of_tails_are_those_of_40_digits() -> None:
    for law, row in rows("law_quantiles.csv"):
        assert law.isf(row["q"]) == pytest.approx(row["upper"], rel=6e-15)
        if not np.isnan(row["lower"]):
            assert law.ppf(row["q"]) == pytest.approx(row["lower"], rel=2e-15)


def test_the_lower_tail_keeps_its_digits() -> None:
    with mpmath.workdps(40):
        normal = [mpmath.ncdf((mpmath.mpf(x) - 1) / mpmath.mpf(0.05)) for x in (0.3, 0.5, 0.8)]
        shape, scale = mpmath.mpf(1.5) ** 2 / mpmath.mpf(0.4) ** 2, mpmath.mpf(0.4) ** 2 / mpmath.mpf(1.5)
        gamma = [mpmath.gammainc(shape, 0, mpmath.mpf(x) / scale, regularized=True) for x in (0.01, 0.2, 0.6)]
        weibull = [-mpmath.expm1(-((mpmath.mpf(x) / mpmath.mpf(1.5)) ** 12)) for x in (0.1, 0.5, 1.0)]
    # P is magnified from the exponent of the density, 100 at most.
    close = 2e-13
    np.testing.assert_allclose(
        asp.Gaussian(1.0, 0.05).cdf([0.3, 0.5, 0.8]), np.array(normal, float), rtol=close
    )
    np.testing.assert_allclose(asp.Gamma(1.5, 0.4).cdf([0.01, 0.2, 0.6]), np.array(gamma, float), rtol=close)
    np.testing.assert_allclose(
        asp.Weibull(12.0, 1.5).cdf([0.1, 0.5, 1.0]), np.array(weibull, float), rtol=close
    )


# Samplers, and the distribution functions of what they sample, not by asperity.
SAMPLERS: dict[str, tuple[asp.Law, Any]] = {name: (law, ref.cdf) for name, (law, ref) in PAIRS.items()} | {
    "cut": (asp.Gaussian(0.2, 0.5), stats.truncnorm(-0.4, np.inf, 0.2, 0.5).cdf),
    "table": (asp.Tabulated(stretch=[0.0, 1.0], density=[0.0, 2.0]), lambda x: np.clip(x, 0.0, 1.0) ** 2),
    "samples": (asp.Tabulated(samples=[3.0, 1.0, 2.0]), stats.uniform(1.0, 2.0).cdf),
    "mixture": (
        asp.Mixture([(0.25, asp.Rectangular(0.0, 1.0)), (0.75, asp.Exponential(2.0))]),
        lambda x: 0.25 * stats.uniform.cdf(x) + 0.75 * stats.expon.cdf(x, scale=2.0),
    ),
}


@pytest.mark.parametrize(("law", "cdf"), SAMPLERS.values(), ids=SAMPLERS.keys())
def test_draws_follow_the_law(law: asp.Law, cdf: Any) -> None:
    """By Kolmogorov and Smirnov, at a false-alarm rate of 1e-6 for each law."""
    assert stats.kstest(law.rvs(50_000, seed=7), cdf).pvalue > 1e-6


def test_draws_are_those_of_their_seed() -> None:
    law = asp.Gaussian(1.0, 0.05)
    draws = law.rvs(1000, seed=3)
    np.testing.assert_array_equal(law.rvs(100, seed=3), draws[:100])
    np.testing.assert_array_equal(law.rvs((10, 100), seed=3), draws.reshape(10, 100))
    assert law.rvs(seed=3) == draws[0]
    assert not np.array_equal(law.rvs(1000, seed=4), draws)
    seed = int(np.random.default_rng(5).integers(2**63))
    np.testing.assert_array_equal(law.rvs(9, seed=np.random.default_rng(5)), law.rvs(9, seed=seed))


@pytest.mark.parametrize("x", [1.0, 1, np.float64(1.0), np.float32(1.0), np.int64(1), np.array(1.0)])
def test_a_number_gives_a_float(x: Any) -> None:
    value = asp.Gaussian(1.0, 0.05).cdf(x)
    assert type(value) is float
    # The mass below 0 that is cut off cannot be seen in a double.
    assert value == 0.5


GRID = np.linspace(0.5, 1.5, 24)


@pytest.mark.parametrize(
    "x",
    [
        GRID,
        GRID.reshape(2, 3, 4),
        np.asfortranarray(GRID.reshape(4, 6)),
        GRID[::-2],
        GRID.astype(">f8"),
        GRID.astype("f4"),
        list(GRID),
        [[1, 2], [3, 4]],
        np.array([], dtype=float),
        np.zeros((0, 3)),
    ],
    ids=lambda x: str(np.shape(x)),
)
def test_an_array_gives_an_array_of_its_shape(x: Any) -> None:
    law = asp.Gaussian(1.0, 0.2)
    values = law.pdf(x)
    array = np.asarray(x, dtype=float)
    assert values.shape == array.shape
    assert values.dtype == np.float64
    np.testing.assert_array_equal(values.ravel(), [law.pdf(float(one)) for one in array.ravel()])


def test_renormalised_thresholds_break_as_the_drive_says() -> None:
    law, coupling = asp.Gaussian(1.0, 0.1), 0.2
    renormalised = asp.Renormalised(law, coupling)
    # Contacts in the order of their thresholds, each stretching all others by its share.
    thresholds = np.sort(law.rvs(1_000_000, seed=1))
    drives = thresholds - coupling * np.cumsum(thresholds) / thresholds.size
    # 4 standard errors of the mean of free contacts; of the rest as much.
    assert renormalised.mean() == pytest.approx(drives.mean(), abs=4e-4)
    assert renormalised.std() == pytest.approx(drives.std(), abs=4e-4)
    assert asp.critical_coupling(law) == pytest.approx(0.2494, abs=5e-5)
    assert asp.critical_coupling(asp.Point(1.0)) == 0.0


def test_point_masses() -> None:
    law = asp.Mixture([(0.25, asp.Point(0.7)), (0.75, asp.Rectangular(0.0, 1.0))])
    np.testing.assert_array_equal(law.atoms.position, [0.7])
    np.testing.assert_array_equal(law.atoms.weight, [0.25])
    assert law.cdf(0.7) - law.cdf(np.nextafter(0.7, 0.0)) == pytest.approx(0.25, abs=1e-15)
    assert asp.Gaussian(1.0, 0.05).atoms.position.size == 0
