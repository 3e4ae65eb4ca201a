"""Laws from frozen distributions of scipy.stats, and from samples."""

from typing import Any

import asperity as asp
import numpy as np
import pytest
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


def test_laws_and_samples() -> None:
    law = asp.Gamma(1.0, 0.2)
    assert asp.law(law) is law
    samples = [0.9, 1.1, 1.3]
    assert asp.law(samples) == asp.law(np.array(samples)) == asp.Tabulated(samples=samples)


def test_arguments_that_are_laws_may_be_what_law_takes() -> None:
    contacts = asp.Contacts(thresholds=stats.norm(1.0, 0.05), reforming=[0.1, 0.2])
    assert contacts == asp.Contacts(asp.Gaussian(1.0, 0.05), asp.Tabulated(samples=[0.1, 0.2]))


@pytest.mark.parametrize(
    ("wrong", "error", "text"),
    [
        (stats.norm, TypeError, "not frozen"),
        (stats.norm(0.1, 0.025), ValueError, "share 3.17e-05 below"),
        (stats.norm([1.0, 2.0], 0.1), ValueError, "arrays"),
        (stats.uniform(-0.5, 1.0), ValueError, "share 0.5 below"),
        (stats.poisson(3.0), ValueError, "poisson"),
        ("gaussian", TypeError, "got str"),
        (None, TypeError, "got NoneType"),
        ([], ValueError, "at least one sample"),
        ([1.0, -1.0], ValueError, "got -1"),
    ],
)
def test_other_things_are_refused(wrong: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        asp.law(wrong)
