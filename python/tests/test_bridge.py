"""Laws from frozen distributions of scipy.stats, and from samples."""

from typing import Any

import asperity as asp
import numpy as np
import pytest
from asperity._bridge import series
from scipy import stats

KNOWN: dict[str, tuple[Any, type[asp.Law]]] = {
    "norm": (stats.norm(1.0, 0.05), asp.Gaussian),
    "norm by keywords": (stats.norm(scale=0.1, loc=2.0), asp.Gaussian),
    "truncnorm": (stats.truncnorm(-1.0 / 0.5, np.inf, loc=1.0, scale=0.5), asp.Gaussian),
    "halfnorm": (stats.halfnorm(scale=0.5), asp.Gaussian),
    "uniform": (stats.uniform(0.5, 1.0), asp.Rectangular),
    "gamma": (stats.gamma(4.0, scale=0.25), asp.Gamma),
    "erlang": (stats.erlang(3, scale=0.5), asp.Gamma),
    "expon": (stats.expon(scale=0.7), asp.Exponential),
    "weibull_min": (stats.weibull_min(3.0, scale=1.2), asp.Weibull),
    "lognorm": (stats.lognorm(0.3, scale=1.1), asp.Lognormal),
}


@pytest.mark.parametrize(("frozen", "kind"), KNOWN.values(), ids=KNOWN.keys())
def test_known_families_are_the_same_law(frozen: Any, kind: type[asp.Law]) -> None:
    law = asp.law(frozen)
    assert type(law) is kind
    x = frozen.ppf([0.01, 0.1, 0.5, 0.9, 0.99])
    # Parameters are converted to mean and std, which a density magnifies by some tens.
    np.testing.assert_allclose(law.pdf(x), frozen.pdf(x), rtol=1e-12)
    np.testing.assert_allclose(law.sf(x), frozen.sf(x), rtol=1e-12)


# Smooth, with kinks and jumps, infinite at 0, ended by a root, with heavy tails, with several peaks.
OTHERS: dict[str, Any] = {
    "burr12": stats.burr12(10.0, 4.0),
    "invgauss": stats.invgauss(0.1, scale=10.0),
    "triang": stats.triang(0.3, loc=0.5),
    "truncnorm": stats.truncnorm(-2.0, 2.0, loc=1.0, scale=0.1),
    "truncnorm of a mean below 0": stats.truncnorm(0.5, np.inf, loc=-0.25, scale=0.5),
    "beta": stats.beta(2.5, 3.5),
    "fisk": stats.fisk(20.0),
    "pareto": stats.pareto(5.0),
    "rv_histogram": stats.rv_histogram(np.histogram([0.9, 1.0, 1.05, 1.1, 1.3], bins=4))(),
    "moved weibull_min": stats.weibull_min(3.0, loc=0.3),
    "chi2": stats.chi2(3.0),
    "maxwell": stats.maxwell(),
    "trapezoid": stats.trapezoid(0.3, 0.6),
    "genextreme": stats.genextreme(0.2, loc=3.0, scale=0.3),
    "skewnorm": stats.skewnorm(4.0, loc=1.0, scale=0.1),
}
# The oldest scipy has no distributions of this kind.
if hasattr(stats, "Mixture"):
    OTHERS["Mixture"] = stats.Mixture(
        [stats.Normal(mu=1.0, sigma=0.02), stats.Normal(mu=2.0, sigma=0.1)], weights=[0.3, 0.7]
    )


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS.keys())
def test_any_other_distribution_is_a_series(other: Any) -> None:
    law = asp.law(other)
    assert type(law) is asp.Series
    x = law.ppf(np.linspace(0.01, 0.99, 99))
    # Distribution functions of scipy.stats are right to 1e-13 or so, its densities to some roundings of x.
    np.testing.assert_allclose(law.cdf(x), other.cdf(x), rtol=1e-11)
    np.testing.assert_allclose(law.pdf(x), other.pdf(x), rtol=1e-9, atol=1e-12)
    # At a false-alarm rate of 1e-6.
    assert stats.kstest(law.rvs(20_000, seed=7), other.cdf).pvalue > 1e-6
    theory = asp.MasterEquation(asp.Contacts(law))
    pull = theory.pull(10.0 * law.mean(), 1001)
    assert theory.steady_state().kinetic_friction == pytest.approx(
        law.moment(2) / (2.0 * law.mean()), rel=1e-12
    )
    assert pull.accuracy < 1e-10


@pytest.mark.parametrize("name", ["norm", "gamma", "weibull_min", "lognorm", "uniform"])
def test_a_series_does_as_its_law_does(name: str) -> None:
    frozen = KNOWN[name][0]
    law, made = asp.law(frozen), series(frozen, name)
    assert type(made) is asp.Series
    own, other = (asp.MasterEquation(asp.Contacts(x), tolerance=1e-11) for x in (law, made))
    ratio = other.steady_state().kinetic_friction / own.steady_state().kinetic_friction
    assert ratio == pytest.approx(1.0, rel=1e-12)
    force, reference = (theory.pull(20.0, 2001).force for theory in (other, own))
    # Both are solved to 1e-11.
    np.testing.assert_allclose(force, reference, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize(
    "frozen",
    [stats.arcsine(), stats.gamma(0.5, loc=1.0, scale=0.1), stats.dgamma(0.5, loc=2.0, scale=0.02)],
    ids=["upper end", "lower end", "inside"],
)
def test_what_is_near_a_pole_becomes_a_point(frozen: Any) -> None:
    law = asp.law(frozen)
    assert isinstance(law, asp.Mixture)
    x = frozen.ppf(np.linspace(0.02, 0.98, 97))
    with np.errstate(divide="ignore"):
        away = x[frozen.pdf(x) < 100.0]
        moments = frozen.moment(2), frozen.mean()
    # What scipy's own functions are accurate to beside the ends of a range.
    np.testing.assert_allclose(law.cdf(away), frozen.cdf(away), rtol=1e-11)
    theory = asp.MasterEquation(asp.Contacts(law))
    sliding = moments[0] / (2.0 * moments[1])
    # What is near the pole, 1e-3 of the law, keeps its mean but for a millionth of its width.
    assert theory.steady_state().kinetic_friction == pytest.approx(sliding, rel=1e-11)


def test_the_force_of_contacts_with_thresholds_near_a_pole() -> None:
    # Until a contact breaks for the second time, at X = 2, F = X - ∫ξ P_c(ξ) dξ over what has broken.
    frozen = stats.gamma(0.5, loc=1.0, scale=0.1)
    theory = asp.MasterEquation(asp.Contacts(asp.law(frozen)), tolerance=1e-8)
    pull = theory.pull(1.9, 20)
    broken = [frozen.expect(lambda x: x, lb=1.0, ub=X) if X > 1.0 else 0.0 for X in pull.position]
    np.testing.assert_allclose(pull.force, pull.position - broken, rtol=0.0, atol=1e-8)


def test_a_law_whose_tail_was_cut_off_claims_nothing_of_it() -> None:
    relaxation = asp.MasterEquation(asp.Contacts(asp.law(stats.fisk(4.0)))).relaxation()
    assert np.isnan(relaxation.length)


class Strange:
    """A distribution whose pdf goes wrong somehow."""

    def __init__(self, pdf: Any, cdf: Any = stats.uniform.cdf) -> None:
        self.pdf, self.cdf = pdf, cdf

    def support(self) -> tuple[float, float]:
        return 0.0, 1.0


@pytest.mark.parametrize(
    ("pdf", "error", "text"),
    [
        (lambda x: np.full_like(x, -1.0), ValueError, "density: expected a finite density of 0 or above"),
        (lambda x: x[:3], ValueError, "one for each point, got 3"),
        (lambda x: 2.0 * x, ValueError, "a pdf and a cdf that agree, got Strange, where they are 0.25 apart"),
        (lambda x: 1.0 + 0.1 * np.sin(1e9 * x), RuntimeError, "the density as a series"),
        (lambda x: x.dense, AttributeError, "no attribute 'dense'"),
        (lambda _: "dense", TypeError, "density"),
    ],
)
def test_a_pdf_that_goes_wrong_says_how(pdf: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        asp.law(Strange(pdf))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "frozen", [stats.poisson(3.0), stats.binom(10, 0.5), stats.geom(0.3), stats.randint(1, 5)]
)
def test_discrete_distributions_become_points(frozen: Any) -> None:
    law = asp.law(frozen)
    assert isinstance(law, asp.Mixture)
    # What is left out is 2e-16 of the law, and some roundings of sums are added.
    assert np.allclose(law.cdf(np.arange(20.0)), frozen.cdf(np.arange(20.0)), rtol=0, atol=1e-14)
    assert law.mean() == pytest.approx(frozen.mean(), rel=1e-12)


def test_laws_and_samples() -> None:
    law = asp.Gamma(1.0, 0.2)
    assert asp.law(law) is law
    samples = [0.9, 1.1, 1.3]
    assert asp.law(samples) == asp.law(np.array(samples)) == asp.Tabulated(samples=samples)


@pytest.mark.parametrize("weights", [None, np.linspace(1.0, 2.0, 200)])
def test_a_kernel_density_estimate_of_scipy(weights: Any) -> None:
    estimate = stats.gaussian_kde(asp.Gamma(1.0, 0.2).rvs(200, seed=1), weights=weights)
    law = asp.law(estimate)
    x = np.linspace(0.01, 3.0, 200)
    # Truncation of the series, relative to the highest density, 2.
    np.testing.assert_allclose(law.pdf(x), estimate(x), rtol=0, atol=1e-12)
    assert law.atoms.position.size == 0
    near = stats.gaussian_kde([0.1, 0.5, 0.9])
    kept = 1.0 - near.integrate_box_1d(-np.inf, 0.0)
    np.testing.assert_allclose(asp.law(near).pdf(x), near(x) / kept, rtol=1e-8)
    with pytest.raises(ValueError, match="one variable, got one of 2"):
        asp.law(stats.gaussian_kde(np.random.default_rng(1).random((2, 9))))


def test_arguments_that_are_laws_may_be_what_law_takes() -> None:
    contacts = asp.Contacts(thresholds=stats.norm(1.0, 0.05), reforming=[0.1, 0.2])
    assert contacts == asp.Contacts(asp.Gaussian(1.0, 0.05), asp.Tabulated(samples=[0.1, 0.2]))


@pytest.mark.parametrize(
    ("wrong", "error", "text"),
    [
        (stats.norm, TypeError, "not frozen"),
        (stats.norm(0.1, 0.025), ValueError, r"fraction 3.17e-05 below \(Gaussian cuts it\)"),
        (stats.halfcauchy(), ValueError, "second moment finite"),
        (stats.norm([1.0, 2.0], 0.1), ValueError, "arrays"),
        (stats.uniform(-0.5, 1.0), ValueError, "fraction 0.5 below"),
        (stats.poisson(1e6), ValueError, "at most 1000 values"),
        (stats.randint(-1, 3), ValueError, "randint, which begins at -1"),
        ("gaussian", TypeError, "got str"),
        (None, TypeError, "got NoneType"),
        ([], ValueError, "at least one sample"),
        ([1.0, -1.0], ValueError, "got -1"),
    ],
)
def test_other_things_are_refused(wrong: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        asp.law(wrong)
