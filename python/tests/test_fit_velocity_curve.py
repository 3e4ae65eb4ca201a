"""Fits to forces of steady sliding at several velocities."""

import re
from typing import Any

import asperity as asp
import numpy as np
import pytest
from asperity import _pictures
from scipy.optimize import curve_fit

VELOCITY = np.geomspace(0.05, 50.0, 12)
ERROR = np.where(np.arange(12) % 2 == 0, 0.3, 0.6)
NOISE = np.random.default_rng(4).normal(size=12)
# Contacts that break at 1 and are free for a time τ: F_k = N/[2(1 + vτ)].
CONTACTS = asp.Contacts(asp.Point(1.0), count=80, delay=0.4)
FREE = ("count", "delay", "offset")


def friction(velocity: object, count: float, delay: float, offset: float) -> np.ndarray:
    return 0.5 * count / (1.0 + np.asarray(velocity) * delay) + offset


FORCE = friction(VELOCITY, 100.0, 0.5, 3.0) + ERROR * NOISE
FOUND = asp.fit_velocity_curve(CONTACTS, VELOCITY, FORCE, free=FREE, error=ERROR)


def test_values_and_covariance_are_those_of_curve_fit_with_the_closed_form() -> None:
    values, covariance = curve_fit(
        friction, VELOCITY, FORCE, p0=(100.0, 0.5, 3.0), sigma=ERROR, absolute_sigma=True
    )
    assert FOUND.converged
    found = np.array([FOUND.params[name].value for name in FREE])
    errors = np.sqrt(np.diag(covariance))
    # The search ends within a thousandth of an error, over which the slopes change as little.
    np.testing.assert_allclose(found, values, atol=2e-3 * errors.min(), rtol=1e-3)
    np.testing.assert_allclose([FOUND.params[name].error for name in FREE], errors, rtol=3e-3)
    np.testing.assert_allclose(FOUND.covariance, covariance, rtol=1e-2)
    chi_squared = (((FORCE - friction(VELOCITY, *values)) / ERROR) ** 2).sum()
    np.testing.assert_allclose(FOUND.misfit.chi_squared, chi_squared, rtol=1e-5)
    assert FOUND.misfit.degrees_of_freedom == 9


def test_errors_of_unknown_size_are_those_of_curve_fit() -> None:
    found = asp.fit_velocity_curve(CONTACTS, VELOCITY, FORCE, free=FREE)
    values, covariance = curve_fit(friction, VELOCITY, FORCE, p0=(100.0, 0.5, 3.0))
    errors = np.sqrt(np.diag(covariance))
    # Both searches end near the minimum, where slopes change by less than this.
    np.testing.assert_allclose([found.params[name].error for name in FREE], errors, rtol=3e-3)
    residual = FORCE - friction(VELOCITY, *values)
    # The sum of squares is quadratic about its minimum: the square of a thousandth of an error.
    np.testing.assert_allclose(found.reading, np.sqrt((residual**2).sum() / 9), rtol=1e-5)
    assert found.misfit.probability is None
    # Student's t of nine degrees of freedom, about a logarithm.
    count = found.params["count"]
    np.testing.assert_allclose(
        np.log(count.interval[1] / count.value), 2.262157 * count.error / count.value, rtol=1e-3
    )
    # One number is hardly curved: the profile of the likelihood ends where Student's t does.
    low, high = found.interval_by_profile("count")
    np.testing.assert_allclose((low, high), count.interval, atol=0.3 * count.error)
    # There ν ln Σr² has risen by ν ln(1 + t²/ν), to a hundredth of the interval.
    rise = found.profile("count", [low, high]).rise
    np.testing.assert_allclose(rise, 9 * np.log1p(2.262157**2 / 9), rtol=0.02)
    likelihood, gradient = found.log_likelihood([found.params[name].value for name in FREE])
    assert likelihood == pytest.approx(-0.5 * found.misfit.deviance, rel=1e-9)
    # Nothing rises by a hundredth of its error at the maximum.
    np.testing.assert_allclose(gradient * [found.params[name].error for name in FREE], 0.0, atol=0.01)


def test_what_is_found_fits_together() -> None:
    assert FOUND.contacts == FOUND.model.contacts
    assert FOUND.contacts.count == FOUND.params["count"].value
    assert FOUND.contacts.delay == FOUND.params["delay"].value
    assert FOUND.offset == FOUND.params["offset"].value
    assert FOUND.fixed == {"stiffness": 1.0}
    assert FOUND.readings == 12
    curve = FOUND.curve
    np.testing.assert_array_equal(curve["reading_velocity"], VELOCITY)
    np.testing.assert_array_equal(curve["reading_friction"], FORCE)
    np.testing.assert_array_equal(curve["reading_friction_std"], ERROR)
    computed = asp.velocity_curve(FOUND.contacts, VELOCITY).kinetic_friction + FOUND.offset
    # The same solver; forces of a rate-dependent life are right to 1e-10.
    np.testing.assert_allclose(curve["reading_expected_friction"], computed, rtol=1e-9)
    residual = (FORCE - computed) / ERROR
    # 1e-9 of a force of 50 over an error of 0.3.
    np.testing.assert_allclose(curve["reading_friction_residual"], residual, atol=1e-6)
    assert curve["fit_velocity"].shape == curve["fit_friction_error"].shape == (33,)
    # The error of the fitted curve in the middle: gᵀVg with the derivatives of the closed form.
    v = curve["fit_velocity"][16]
    share = 0.5 / (1.0 + v * FOUND.contacts.delay)
    slopes = np.array([share, -2.0 * FOUND.contacts.count * v * share**2, 1.0])
    error = np.sqrt(slopes @ FOUND.covariance @ slopes)
    np.testing.assert_allclose(curve["fit_friction_error"][16], error, rtol=1e-3)


def test_the_background_of_contacts_is_fitted_and_found_in_them() -> None:
    contacts = asp.Contacts(asp.Point(1.0), count=80, delay=0.4, background_force=1.0)
    free = ("count", "delay", "background")
    found = asp.fit_velocity_curve(contacts, VELOCITY, FORCE, free=free, error=ERROR)
    background = found.params["background"]
    # Both searches end within a thousandth of an error.
    assert abs(background.value - FOUND.offset) < 1e-2 * background.error
    assert found.contacts.background_force == background.value
    known = asp.fit_velocity_curve(
        contacts, VELOCITY, FORCE, free=free, error=ERROR, prior={"background": (3.0, 1e-3)}
    )
    # Two standard deviations of the prior, which is far narrower than what the forces tell.
    assert abs(known.params["background"].value - 3.0) < 2e-3


def test_the_posterior_has_the_errors_of_the_estimates() -> None:
    drawn = FOUND.sample(draws=200, chains=2, seed=1)
    assert drawn.draws["delay"].shape == (2, 200)
    for name, one in FOUND.params.items():
        values = drawn.draws[name]
        # Four standard errors of a mean and of a standard deviation of 100 independent draws.
        assert abs(values.mean() - one.value) < 0.5 * one.error, name
        assert abs(values.std() / one.error - 1.0) < 0.4, name


def test_a_fit_is_printed() -> None:
    text = FOUND.summary()
    assert text.startswith("fit to 12 forces of steady sliding, ")
    assert re.search(r"count +\d+", text)
    assert repr(FOUND).startswith("<asperity.VelocityCurveEstimates>")
    assert "<table" in FOUND._repr_html_()


def test_a_fit_is_drawn() -> None:
    pytest.importorskip("matplotlib").use("agg")
    axes = FOUND.plot(color="k")
    assert axes.get_xscale() == "log"
    (line,) = (line for line in axes.get_lines() if line.get_label() == "fit")
    np.testing.assert_array_equal(line.get_ydata(), FOUND.curve["fit_friction"])
    assert line.get_color() == "k"
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["fit", "± 2 standard errors", "measured"]
    assert not _pictures.velocity_curve_fit(FOUND).get_title(loc="left")


def test_what_cannot_be_fitted_is_refused() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"velocity": [1.0, -1.0], "force": [1.0, 1.0]}, "velocity.1: expected a finite number above 0"),
        ({"force": [1.0]}, "force: expected 12 values, one for each velocity, got 1"),
        ({"error": [1.0]}, "error: expected 12 values, one for each velocity, got 1"),
        ({"free": ["velocity"]}, "free.0: expected one of count"),
        ({"free": []}, "free: expected at least one"),
        ({"error": ERROR, "reading": 0.1}, "reading: expected none beside"),
        ({"free": ["count", "stiffness"]}, "free: expected numbers that the curve determines"),
        ({"prior": {"stiffness": (1.0, 0.1)}}, "prior.stiffness"),
    ]
    for arguments, words in cases:
        given: dict[str, Any] = {"velocity": VELOCITY, "force": FORCE, "free": ["count"], **arguments}
        with pytest.raises(ValueError, match=re.escape(words)):
            asp.fit_velocity_curve(CONTACTS, **given)
