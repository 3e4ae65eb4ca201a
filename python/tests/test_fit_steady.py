"""Fits to records of the force in steady sliding that the ensemble makes contact by contact."""

import re

import asperity as asp
import numpy as np
import pytest
from asperity import _pictures
from numpy.typing import NDArray

REFORMING = asp.Gaussian(0.1, 0.03)
TRUE = asp.Contacts(asp.Gaussian(1.0, 0.12), REFORMING, count=2000.0)
GUESS = asp.Contacts(asp.Gaussian(0.9, 0.2), REFORMING, count=1500.0)
NAMES = ("thresholds.mean", "thresholds.std", "count", "stiffness")
SPACING = 0.1
# The readings from X = 60 on: the transient falls by e over 2.4.
RECORD: NDArray[np.float64] = asp.Ensemble(TRUE, size=2000, seed=3).pull(360.0, 3601).force[600:]
FOUND = asp.fit_steady(GUESS, SPACING, RECORD, free=NAMES, reading=0.0)


def test_the_numbers_of_a_simulated_record_are_found() -> None:
    assert FOUND.converged
    assert FOUND.readings == len(RECORD)
    assert list(FOUND.params) == list(NAMES)
    for name, value in zip(NAMES, (1.0, 0.12, 2000.0, 1.0), strict=True):
        one = FOUND.params[name]
        # Four standard errors: a false alarm in 16000 records.
        assert abs(one.value - value) < 4 * one.error, name
        assert one.interval[0] < one.value < one.interval[1]
    assert FOUND.params["count"].error < 0.1 * 2000
    assert not FOUND.misfit.unlikely
    assert (FOUND.reading, FOUND.offset) == (0.0, 0.0)
    assert FOUND.fixed == {"reforming.mean": 0.1, "reforming.std": 0.03}


def test_what_is_found_fits_together() -> None:
    assert FOUND.contacts == FOUND.model.contacts
    assert FOUND.contacts.count == FOUND.params["count"].value
    assert FOUND.contacts.reforming == REFORMING
    errors = np.sqrt(np.diag(FOUND.covariance))
    np.testing.assert_allclose(errors, [one.error for one in FOUND.params.values()], rtol=1e-12)
    # The mean of the record is the only datum of the kinetic friction.
    friction = FOUND.friction().kinetic_friction
    assert friction.error is not None
    assert abs(friction.value - RECORD.mean()) < 0.05 * friction.error
    low, high = FOUND.interval_by_profile("thresholds.mean")
    mean = FOUND.params["thresholds.mean"]
    np.testing.assert_allclose((low, high), mean.interval, atol=0.2 * mean.error)
    # −2 ln L has risen by 1.96² where the interval ends, to a hundredth of it.
    values, rise, name = FOUND.profile("thresholds.mean", [low, mean.value, high])
    assert name == "thresholds.mean"
    np.testing.assert_array_equal(values, [low, mean.value, high])
    np.testing.assert_allclose(rise, [3.84, 0.0, 3.84], atol=0.08)
    likelihood, gradient = FOUND.log_likelihood([one.value for one in FOUND.params.values()])
    assert likelihood == pytest.approx(-0.5 * FOUND.misfit.deviance, rel=1e-9)
    # Nothing rises by a hundredth of its error at the maximum.
    np.testing.assert_allclose(gradient * errors, 0.0, atol=0.01)


def test_the_posterior_of_a_long_record_has_the_errors_of_the_estimates() -> None:
    found = asp.fit_steady(TRUE, SPACING, RECORD, free=("count", "stiffness"), reading=0.0)
    drawn = found.sample(draws=200, chains=2, seed=1)
    assert drawn.draws["count"].shape == (2, 200)
    for name, one in found.params.items():
        values = drawn.draws[name]
        # Four standard errors of a mean and of a standard deviation of 100 independent draws, and what a
        # logarithm bends over an error of some per cent.
        assert abs(values.mean() - one.value) < 0.5 * one.error, name
        assert abs(values.std() / one.error - 1.0) < 0.4, name


def test_the_periodogram_is_that_of_numpy() -> None:
    spectrum = FOUND.spectrum
    n = len(RECORD)
    modes = np.fft.rfft(RECORD - RECORD.mean())[1:]
    # Both are Fourier transforms of a thousand readings or more, of which a large mean is subtracted.
    np.testing.assert_allclose(
        spectrum["periodogram"], SPACING / n * np.abs(modes) ** 2, rtol=1e-8, atol=1e-9
    )
    np.testing.assert_allclose(
        spectrum["wave_number"], 2 * np.pi * np.fft.rfftfreq(n, SPACING)[1:], rtol=1e-12
    )
    # The expectation by the sum over all pairs of readings, at some wave numbers.
    covariance = FOUND.model.steady_state().autocovariance(SPACING * np.arange(n), size=FOUND.contacts.count)
    lags = np.arange(n)
    for k in (0, 10, 400, n // 2 - 1):
        phase = np.cos(2 * np.pi * (k + 1) * lags / n)
        terms = (1 - lags / n) * covariance * phase
        expected = SPACING * (2 * terms.sum() - terms[0])
        np.testing.assert_allclose(spectrum["expected"][k], expected, rtol=1e-4)


def test_a_fit_is_reported_as_a_table_and_plotted() -> None:
    text = FOUND.summary()
    assert text.startswith(f"fit to {len(RECORD)} readings in steady sliding")
    assert all(name in text for name in NAMES)
    assert repr(FOUND).startswith("<asperity.SteadyEstimates>")
    assert "<table" in FOUND._repr_html_()
    pytest.importorskip("matplotlib").use("agg")
    axes = FOUND.plot()
    assert (axes.get_xscale(), axes.get_yscale(), len(axes.lines)) == ("log", "log", 3)
    wrong = asp.fit_steady(GUESS, SPACING, RECORD - 500.0, free=["thresholds.std"], reading=0.0)
    assert wrong.misfit.unlikely
    titles = [_pictures.steady_fit(fit).get_title(loc="left") for fit in (FOUND, wrong)]
    assert not titles[0]
    assert titles[1].split("\n") == wrong.summary().split("\n")[-2:]
    assert titles[1].endswith("The record is not of this kind: do not trust the errors.")


def test_what_a_record_does_not_determine_is_refused() -> None:
    with pytest.raises(ValueError, match="the same record if these change together") as refused:
        asp.fit_steady(GUESS, SPACING, RECORD, free=["count", "stiffness", "offset"], reading=0.0)
    assert all(name in str(refused.value) for name in ("count", "stiffness", "offset"))
    known = asp.fit_steady(
        GUESS,
        SPACING,
        RECORD,
        free=["count", "stiffness", "offset"],
        prior={"stiffness": (1.0, 0.01)},
        reading=0.0,
    )
    assert known.converged


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"free": []}, "free: expected at least one key"),
        ({"free": ["initial.max"]}, "free.0: expected one of thresholds.mean"),
        ({"spacing": 0.0}, "spacing"),
        ({"force": RECORD[:20]}, "force: expected 64 readings or more"),
        ({"force": [float("nan")] * 100}, "force"),
        ({"reading": -1.0}, "reading"),
        ({"prior": {"offset": (0.0, 1.0)}}, "prior.offset"),
    ],
)
def test_wrong_arguments_are_named(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"spacing": SPACING, "force": RECORD, "free": NAMES, **change}
    with pytest.raises(ValueError, match=re.escape(message)):
        asp.fit_steady(GUESS, **arguments)  # type: ignore[arg-type]
