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
    for name in ("pdf", "cdf", "sf", "logsf", "logpdf", "logcdf"):
        ours, theirs = getattr(law, name)(x), getattr(reference, name)(x)
        np.testing.assert_allclose(ours, theirs, rtol=CLOSE, err_msg=name)
    np.testing.assert_allclose(law.hazard(x), reference.pdf(x) / reference.sf(x), rtol=CLOSE)


@every_pair
def test_quantiles_and_moments_are_those_of_scipy(law: asp.Law, reference: Any) -> None:
    np.testing.assert_allclose(law.ppf(LEVELS), reference.ppf(LEVELS), rtol=CLOSE)
    np.testing.assert_allclose(law.isf(LEVELS), reference.isf(LEVELS), rtol=CLOSE)
    np.testing.assert_allclose([law.mean(), law.std()], [reference.mean(), reference.std()], rtol=CLOSE)
    np.testing.assert_allclose(law.moment(3), reference.moment(3), rtol=CLOSE)
    # Twice the error of the quadrature.
    np.testing.assert_allclose(law.stats("mvsk"), reference.stats("mvsk"), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(law.stats("v"), reference.stats("v"), rtol=CLOSE)
    np.testing.assert_allclose(law.entropy(), reference.entropy(), rtol=1e-10)
    np.testing.assert_allclose([law.median(), law.var()], [reference.median(), reference.var()], rtol=CLOSE)
    np.testing.assert_allclose(law.interval(0.9), reference.interval(0.9), rtol=CLOSE)
    low, high = reference.interval(0.7)
    ours, theirs = (
        one.expect(lambda x: x * x, lb=low, ub=high, conditional=True) for one in (law, reference)
    )
    # scipy integrates to 1.5e-8.
    assert ours == pytest.approx(theirs, rel=1e-7)
    assert law.expect() == pytest.approx(law.mean(), rel=CLOSE)
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


def mixed(weights: list[float], parts: list[Any]) -> Any:
    """The logarithm of a weighted sum, with 40 digits."""
    return mpmath.log(
        mpmath.fsum(mpmath.mpf(w) * mpmath.exp(part) for w, part in zip(weights, parts, strict=True))
    )


@pytest.mark.parametrize("x", [1e-20, 1e-8, 0.01, 0.1, 0.5])
def test_logarithms_do_not_underflow_in_the_lower_tail(x: float) -> None:
    with mpmath.workdps(40):
        at, shape = mpmath.mpf(x), 1 / mpmath.mpf(0.03) ** 2
        spread = mpmath.log1p(mpmath.mpf(0.3) ** 2)
        z = (mpmath.log(at) + spread / 2) / mpmath.sqrt(spread)
        lognormal = -(z**2) / 2 - mpmath.log(at * mpmath.sqrt(2 * mpmath.pi * spread))
        weibull = mpmath.log(30) + 29 * mpmath.log(at) - at**30
        gamma = mpmath.log(shape) * shape + (shape - 1) * mpmath.log(at) - shape * at - mpmath.loggamma(shape)
        half = 1 / mpmath.mpf(0.02)
        width = mpmath.log(mpmath.mpf(0.02) * mpmath.sqrt(2 * mpmath.pi) * mpmath.ncdf(half))
        gaussian = -(((at - 1) * half) ** 2) / 2 - width
        expected = {
            asp.Gaussian(1.0, 0.02): gaussian,
            asp.Lognormal(1.0, 0.3): lognormal,
            asp.Weibull(30.0, 1.0): weibull,
            asp.Gamma(1.0, 0.03): gamma,
            asp.Mixture([(0.25, asp.Gaussian(1.0, 0.02)), (0.75, asp.Lognormal(1.0, 0.3))]): mixed(
                [0.25, 0.75], [gaussian, lognormal]
            ),
        }
        cumulative = {
            asp.Lognormal(1.0, 0.3): mpmath.log(mpmath.erfc(-z / mpmath.sqrt(2)) / 2),
            asp.Weibull(30.0, 1.0): mpmath.log(-mpmath.expm1(-(at**30))),
            asp.Gamma(1.0, 0.03): shape * mpmath.log(shape * at)
            - shape * at
            - mpmath.loggamma(shape + 1)
            + mpmath.log(mpmath.hyp1f1(1, shape + 1, shape * at)),
        }
    for law, value in expected.items():
        # Some roundings of terms that cancel to a tenth.
        assert law.logpdf(x) == pytest.approx(float(value), rel=1e-14, abs=1e-13)
    for law, value in cumulative.items():
        assert law.logcdf(x) == pytest.approx(float(value), rel=1e-14, abs=1e-13)


def test_both_ends_of_a_sample_are_possible_where_it_is_most_likely() -> None:
    sample = [0.6, 1.0, 1.4]
    law = asp.Rectangular.fit(sample)
    reference = stats.uniform(0.6, 1.4 - 0.6)
    x = [*sample, 0.59, 1.41]
    np.testing.assert_allclose(law.pdf(x), reference.pdf(x), rtol=CLOSE)
    np.testing.assert_allclose(law.logpdf(x), reference.logpdf(x), rtol=CLOSE)
    assert asp.Tabulated(samples=sample, exact=True).logpdf(1.4) == pytest.approx(np.log(1.25))


# Samplers, and the distribution functions of what they sample, not by asperity.
SAMPLERS: dict[str, tuple[asp.Law, Any]] = {name: (law, ref.cdf) for name, (law, ref) in PAIRS.items()} | {
    "cut": (asp.Gaussian(0.2, 0.5), stats.truncnorm(-0.4, np.inf, 0.2, 0.5).cdf),
    "table": (asp.Tabulated(stretch=[0.0, 1.0], density=[0.0, 2.0]), lambda x: np.clip(x, 0.0, 1.0) ** 2),
    "samples": (asp.Tabulated(samples=[3.0, 1.0, 2.0], exact=True), stats.uniform(1.0, 2.0).cdf),
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


def test_draws_have_the_arguments_of_scipy() -> None:
    law = asp.Gaussian(1.0, 0.05)
    np.testing.assert_array_equal(law.rvs(9, 3), law.rvs(size=9, seed=3))
    np.testing.assert_array_equal(law.rvs(9, random_state=3), law.rvs(9, seed=3))
    older = np.random.RandomState(5)
    assert law.rvs(random_state=older) != law.rvs(random_state=older)
    np.testing.assert_array_equal(
        law.rvs(9, random_state=np.random.RandomState(5)), law.rvs(9, random_state=np.random.RandomState(5))
    )
    # Two draws of the system's entropy agree by chance once in 10^19.
    assert law.rvs() != law.rvs()
    with pytest.raises(TypeError, match="seed or random_state, got both"):
        law.rvs(9, random_state=3, seed=3)


@pytest.mark.parametrize(
    "law",
    [
        asp.Gaussian(1.0, 0.1),
        asp.Gamma(1.0, 0.5),
        asp.Lognormal(1.0, 0.3),
        asp.Weibull(3.0, 1.0),
        asp.Exponential(2.0),
    ],
    ids=lambda law: type(law).__name__,
)
def test_fits_recover_the_parameters(law: asp.Law) -> None:
    found = type(law).fit(law.rvs(100_000, seed=2))
    assert type(found) is type(law)
    # Errors are of order n^(-1/2) = 0.003 of the widths.
    assert list(found.parameters.values()) == pytest.approx(list(law.parameters.values()), rel=0.02)


def test_a_gamma_fit_is_that_of_scipy() -> None:
    sample = asp.Gamma(1.0, 0.5).rvs(1000, seed=2)
    shape, _, scale = stats.gamma.fit(sample, floc=0.0)
    # scipy solves the same equation to 1e-8 or so.
    assert list(asp.Gamma.fit(sample).parameters.values()) == pytest.approx(
        [shape * scale, np.sqrt(shape) * scale], rel=1e-6
    )


def test_what_cannot_be_fitted_is_refused() -> None:
    with pytest.raises(TypeError, match="a class with parameters, such as Gaussian, got Mixture"):
        asp.Mixture.fit([1.0, 2.0])
    with pytest.raises(ValueError, match="samples: expected at least one"):
        asp.Gamma.fit([])
    with pytest.raises(ValueError, match="samples"):
        asp.Gamma.fit([1.0, -1.0])
    with pytest.raises(ValueError, match="values that differ"):
        asp.Gaussian.fit([1.0, 1.0])


def test_other_names_of_distributions() -> None:
    assert (asp.Normal, asp.Uniform, asp.Delta) == (asp.Gaussian, asp.Rectangular, asp.Point)


def test_expectations_pass_on_errors_and_refuse_bad_ranges() -> None:
    law = asp.Gaussian(1.0, 0.1)
    with pytest.raises(ZeroDivisionError):
        law.expect(lambda x: 1 / 0)
    with pytest.raises(ValueError, match="ub: expected a number not below lb"):
        law.expect(lb=2.0, ub=1.0)
    with pytest.raises(ValueError, match="confidence"):
        law.interval(1.5)
    with pytest.raises(ValueError, match="moments"):
        law.stats("x")
    assert asp.Point(1.0).entropy() == -np.inf


@pytest.mark.parametrize("count", [2, 10, 500, 20_000])
def test_samples_of_any_size_are_smooth_distributions(count: int) -> None:
    # Narrow enough that no kernel reaches 0.
    sample = asp.Gamma(1.0, 0.05).rvs(count, seed=1)
    law = asp.Tabulated(samples=sample)
    assert (law.mean(), law.std()) == pytest.approx((sample.mean(), sample.std()), rel=1e-11)
    pull = asp.MasterEquation(asp.Contacts(law)).pull(6.0)
    assert pull.kinetic_friction == pytest.approx(law.moment(2) / law.mean() / 2, rel=1e-10)


@pytest.mark.parametrize("samples", [[0.5, 1.0, 1.3, 2.0, 4.0], [0.044, 0.048]])
def test_samples_of_areas(samples: list[float]) -> None:
    """Thresholds grow as √A: lives need the digits of the estimate in its tails, slips its moments below."""
    law = asp.Tabulated(samples=samples)
    theory = asp.MasterEquation(asp.Contacts(areas=asp.Areas(law, modulus=2.0, strength=1.0)))
    above, below = law.expect(lambda area: area**1.5), law.expect(lambda area: area**0.5)
    # F_k = σ⟨A^(3/2)⟩/2⟨A^(1/2)⟩; the tolerance of the pull.
    assert theory.pull(3.0).kinetic_friction == pytest.approx(0.5 * above / below, rel=1e-9)
    assert asp.Block(theory, 0.02, "overdamped").drive(2.0).events is not None


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
