"""Fits to curves of the ensemble and to computed ones, against other routes to the same numbers."""

import re
from collections.abc import Callable
from typing import Any, cast

import asperity as asp
import numpy as np
import pytest
from asperity import _show
from numpy.typing import NDArray
from scipy.optimize import curve_fit

REFORMING = asp.Gaussian(0.1, 0.03)
TRUE = asp.Contacts(asp.Gaussian(1.0, 0.12), REFORMING, count=2000.0)
GUESS = asp.Contacts(asp.Gaussian(0.9, 0.2), REFORMING, count=1500.0)
POSITION = np.linspace(0.03, 4.5, 150)
NAMES = ("thresholds.mean", "thresholds.std", "count", "stiffness")
SIMULATED: NDArray[np.float64] = asp.Ensemble(TRUE, size=2000, seed=3).pull(4.5, 151).force[1:]
FOUND = asp.fit(GUESS, POSITION, SIMULATED, free=NAMES)


def noisy(error: float, seed: int) -> NDArray[np.float64]:
    """The curve of infinitely many contacts with independent errors."""
    force = asp.MasterEquation(TRUE).pull(4.5)(POSITION)
    return force + error * np.random.default_rng(seed).standard_normal(len(POSITION))


def test_the_numbers_of_a_simulated_curve_are_found() -> None:
    assert FOUND.converged
    for name, value in zip(NAMES, (1.0, 0.12, 2000.0, 1.0), strict=True):
        one = FOUND.params[name]
        # Four standard errors: a false alarm in 16000 curves.
        assert abs(one.value - value) < 4 * one.error, name
        assert one.interval[0] < one.value < one.interval[1]
        assert one.limit is None
    # What 2000 contacts determine: the mean threshold to better than a percent, the number to about a tenth.
    assert FOUND.params["thresholds.mean"].error < 0.01
    assert 0.05 < FOUND.params["count"].error / 2000 < 0.2
    # The readings of the ensemble are exact.
    assert FOUND.params["reading"].limit is not None
    assert list(FOUND.params)[:4] == list(NAMES)
    assert FOUND.fixed == {"reforming.mean": 0.1, "reforming.std": 0.03}


def test_what_is_found_fits_together() -> None:
    assert FOUND.contacts == FOUND.model.contacts
    assert FOUND.contacts.count == FOUND.params["count"].value
    assert FOUND.contacts.thresholds is not None
    assert FOUND.contacts.thresholds.parameters["mean"] == FOUND.params["thresholds.mean"].value
    assert FOUND.contacts.reforming == REFORMING
    # The description makes the same curve, bit for bit.
    again = asp.MasterEquation(FOUND.contacts).pull(FOUND.pull.distance)
    np.testing.assert_array_equal(again.force, FOUND.pull.force)
    readings = FOUND.readings
    np.testing.assert_array_equal(readings["expected"], FOUND.pull(POSITION))
    np.testing.assert_array_equal(readings["residual"], SIMULATED - readings["expected"])
    np.testing.assert_array_equal(readings["slider_position"], POSITION)
    errors = np.sqrt(np.diag(FOUND.covariance))
    np.testing.assert_allclose(errors, [one.error for one in FOUND.params.values()], rtol=1e-12)
    (pair,) = [one for one in FOUND.correlations if set(one.between) == {"count", "stiffness"}]
    # Only the product follows from the curve.
    assert pair.coefficient < -0.9
    misfit = FOUND.misfit
    assert misfit is not None
    assert misfit.probability is None
    assert not misfit.unlikely
    # Count and stiffness change the curve alike.
    assert misfit.degrees_of_freedom == len(POSITION) - (len(NAMES) - 1)
    assert misfit.chi_squared == pytest.approx(np.sum(readings["whitened"] ** 2), rel=1e-12)


def test_a_prediction_has_the_noise_of_contacts_and_the_errors_of_the_estimates() -> None:
    order = np.array([100, 3, 40])
    force, std, error, _ = FOUND.predict(POSITION[order])
    # Another solution for the same contacts, over a shorter distance: the aim is 1e-10 of N⟨k⟩⟨x_s⟩.
    np.testing.assert_allclose(force, FOUND.readings["expected"][order], atol=2000 * 1e-9)
    noise = FOUND.pull.force_std(FOUND.contacts.count, POSITION[order])
    np.testing.assert_allclose(std, np.hypot(noise, FOUND.reading), rtol=1e-6)
    # The noise of the fit was computed before its last steps, which moved the estimates by less than a tenth
    # of an error.
    np.testing.assert_allclose(std, FOUND.readings["std"][order], rtol=0.02)
    # By central differences of the curve, of a thousandth of an error; the next order is below 1e-5.
    names = list(NAMES)
    slopes = []
    for name in names:
        step = 1e-3 * FOUND.params[name].error
        low, high = (curve(FOUND.contacts, name, sign * step)(POSITION[order]) for sign in (-1, 1))
        slopes.append((high - low) / (2 * step))
    jacobian = np.transpose(slopes)
    variance = np.einsum("ia,ab,ib->i", jacobian, FOUND.covariance[:4, :4], jacobian)
    np.testing.assert_allclose(error, np.sqrt(variance), rtol=1e-4)
    assert FOUND.predict([]).force.shape == (0,)
    # Beyond the last reading, too.
    assert FOUND.predict([6.0]).force[0] == pytest.approx(asp.MasterEquation(FOUND.contacts).pull(6.0)(6.0))


def curve(contacts: asp.Contacts, name: str, change: float) -> asp.Pull:
    """The curve of contacts with one number changed."""
    if name.startswith("thresholds."):
        law = contacts.thresholds
        assert law is not None
        key = name.removeprefix("thresholds.")
        contacts = contacts.replace(thresholds=law.replace(**{key: law.parameters[key] + change}))
    else:
        contacts = contacts.replace(**{name: contacts.parameters[name] + change})
    return asp.MasterEquation(contacts).pull(4.5)


def test_friction_has_the_errors_of_the_estimates() -> None:
    friction = FOUND.friction()
    steady = FOUND.model.steady_state().kinetic_friction
    assert friction.kinetic_friction.value == pytest.approx(steady, rel=1e-12)
    gradients = [FOUND.pull.friction_gradient(name) for name in NAMES]
    kinetic = np.array([gradient.kinetic_friction for gradient in gradients])
    error = np.sqrt(kinetic @ FOUND.covariance[:4, :4] @ kinetic)
    # The error of a difference quotient in the gradient of the fit.
    assert friction.kinetic_friction.error == pytest.approx(error, rel=1e-6)
    assert friction.static_friction is not None
    assert FOUND.pull.static_friction is not None
    assert friction.static_friction.value == FOUND.pull.static_friction.force
    true = asp.MasterEquation(TRUE)
    # Four standard errors.
    length = friction.relaxation_length
    assert abs(length.value - true.relaxation().length) < 4 * length.error
    stiffness = friction.critical_stiffness
    assert abs(stiffness.value - true.pull(4.5).critical_stiffness) < 4 * stiffness.error


@pytest.mark.parametrize("noise", ["contacts", "white"])
def test_the_gradient_of_the_likelihood_is_that_of_differences(noise: Any) -> None:
    names = NAMES if noise == "contacts" else NAMES[:3]
    fit = asp.fit(GUESS, POSITION, noisy(5.0, 1), free=names, noise=noise, prior={"count": (1900.0, 200.0)})
    values = np.array([one.value for one in fit.params.values()])
    errors = np.array([one.error for one in fit.params.values()])
    at = values + 0.5 * errors
    value, gradient = fit.log_likelihood(at)
    assert fit.misfit is not None
    assert fit.log_likelihood(values)[0] == pytest.approx(-0.5 * fit.misfit.deviance, rel=1e-12)
    assert value < fit.log_likelihood(values)[0]
    for k, error in enumerate(errors):
        step = np.zeros(len(at))
        step[k] = 1e-3 * error
        slope = (fit.log_likelihood(at + step)[0] - fit.log_likelihood(at - step)[0]) / (2 * step[k])
        # The step is a thousandth of an error, so that the next order is some 1e-6 of the gradient.
        assert slope * error == pytest.approx(gradient[k] * error, rel=1e-5, abs=1e-5), list(fit.params)[k]
    outside = fit.log_likelihood([-1.0, *values[1:]])
    assert outside[0] == -np.inf
    assert np.all(np.isnan(outside[1]))


def test_errors_of_positions_are_weights_of_least_squares() -> None:
    force = noisy(3.0, 4)
    guess = asp.Contacts(asp.Gaussian(0.95, 0.15), REFORMING, count=2000.0)
    found = asp.fit(
        guess,
        POSITION,
        force,
        free=["thresholds.mean", "thresholds.std"],
        noise="white",
        reading=3.0,
        position_error=0.006,
    )
    # The weights are those of the fitted curve, by its differences.
    pull = asp.MasterEquation(found.contacts).pull(5.0)
    slope = (pull(POSITION + 1e-4) - pull(POSITION - 1e-4)) / 2e-4
    sigma = np.hypot(3.0, 0.006 * slope)

    def curve(x: NDArray[np.float64], mean: float, std: float) -> NDArray[np.float64]:
        contacts = asp.Contacts(asp.Gaussian(mean, std), REFORMING, count=2000.0)
        return asp.MasterEquation(contacts).pull(4.5)(x)

    values, covariance = curve_fit(
        curve, POSITION, force, p0=(1.0, 0.12), sigma=sigma, absolute_sigma=True, epsfcn=1e-8
    )
    for name, value, variance in zip(found.params, values, np.diag(covariance), strict=True):
        one = found.params[name]
        # The weights are renewed until no estimate moves by a tenth of its error, which changes them by less.
        assert abs(one.value - value) < 0.02 * one.error, name
        assert one.error == pytest.approx(np.sqrt(variance), rel=0.01), name
    np.testing.assert_allclose(found.readings["std"], sigma, rtol=0.02)


def test_white_noise_is_least_squares() -> None:
    force = noisy(5.0, 2)
    fit = asp.fit(GUESS, POSITION, force, free=("thresholds.mean", "thresholds.std", "count"), noise="white")

    def expected(x: NDArray[np.float64], mean: float, std: float, count: float) -> Any:
        contacts = asp.Contacts(asp.Gaussian(mean, std), REFORMING, count=count)
        return asp.MasterEquation(contacts).pull(4.5)(x)

    values, covariance = curve_fit(
        expected, POSITION, force, p0=(0.9, 0.2, 1500.0), method="trf", x_scale=(1, 0.1, 1e3)
    )
    found = list(fit.params.values())
    errors = np.sqrt(np.diag(covariance))
    # The search ends within a thousandth of an error, SciPy's within its ftol of 1e-8 of the sum of squares.
    assert np.all(np.abs([one.value for one in found] - values) < 0.01 * errors)
    np.testing.assert_allclose([one.error for one in found], errors, rtol=0.01)
    assert fit.reading == pytest.approx(5.0, rel=0.25)
    assert fit.misfit is not None
    assert fit.misfit.whiteness > 1e-3


def test_the_profile_of_a_linear_number_is_a_parabola() -> None:
    force = noisy(5.0, 4)
    fit = asp.fit(TRUE, POSITION, force, free=("offset", "trend"), noise="white", reading=5.0)
    value, error, interval, _ = fit.params["offset"]
    # The profile is found to a small part of the error; 1.96 has three digits.
    assert fit.interval_by_profile("offset") == pytest.approx(interval, abs=0.02 * error)
    assert interval[1] - value == pytest.approx(1.96 * error, rel=1e-3)
    values, rise, name = fit.profile("offset")
    assert name == "offset"
    # Multiples of the printed error: rounding.
    np.testing.assert_allclose(values[[0, 6, -1]], [value - 3 * error, value, value + 3 * error], rtol=1e-9)
    # Searches end where −2 ln L is within 1e-6 of its minimum.
    np.testing.assert_allclose(rise, ((values - value) / error) ** 2, atol=1e-4)
    # A reading error that is known makes χ² a test.
    assert fit.misfit is not None
    assert fit.misfit.probability is not None
    assert fit.misfit.probability > 1e-3


def test_the_machine_is_fitted() -> None:
    pull = asp.MasterEquation(TRUE).pull(5.0, 2001)
    compliance = 0.3 / pull.critical_stiffness
    slider = np.linspace(0.03, 4.5, 150)
    position = slider + compliance * pull(slider) + 0.2
    force = pull(slider) + 30.0 + 4.0 * position
    force += 2.0 * np.random.default_rng(1).standard_normal(len(force))
    free = ("compliance", "offset", "trend", "origin", "thresholds.mean")
    start = 0.5 * compliance
    fit = asp.fit(TRUE, position, force, free=free, noise="white", compliance=start, origin=0.1)
    true = dict(compliance=compliance, offset=30.0, trend=4.0, origin=0.2, **{"thresholds.mean": 1.0})
    for name, value in true.items():
        assert abs(fit.params[name].value - value) < 4 * fit.params[name].error, name
    # Of the machine, nothing is fixed.
    assert set(fit.fixed) == {"thresholds.std", "reforming.mean", "reforming.std", "count", "stiffness"}
    # The errors of the fitted numbers move the slider by less.
    np.testing.assert_allclose(fit.readings["slider_position"], slider, atol=0.01)
    # The same numbers through another call: solutions to 1e-10.
    np.testing.assert_allclose(fit.predict(position).force, fit.readings["expected"], rtol=1e-9)


def test_a_planned_measurement_has_the_errors_that_measured_ones_scatter_by() -> None:
    free = ("thresholds.mean", "thresholds.std")
    plan = asp.fit(TRUE, POSITION, None, free=free, noise="white", reading=5.0)
    assert plan.misfit is None
    assert "force" not in plan.readings
    planned = [plan.params[name].error for name in free]
    found = []
    for seed in range(40):
        fit = asp.fit(TRUE, POSITION, noisy(5.0, seed), free=free, noise="white", reading=5.0)
        found.append([fit.params[name].value for name in free])
    # The relative error of a standard deviation of 40 values is 11 %; four of them.
    np.testing.assert_allclose(np.std(found, axis=0, ddof=1), planned, rtol=0.45)
    np.testing.assert_allclose(np.mean(found, axis=0), [1.0, 0.12], atol=4 * max(planned) / np.sqrt(40))


def test_a_drift_is_found_and_where_there_is_none_is_limited() -> None:
    """An Ornstein–Uhlenbeck process, by the Cholesky factor of its covariance."""
    free = ("thresholds.mean", "stiffness")
    covariance = 10.0**2 * np.exp(-np.abs(np.subtract.outer(POSITION, POSITION)) / 0.1)
    drift = np.linalg.cholesky(covariance) @ np.random.default_rng(6).standard_normal(len(POSITION))
    force = noisy(2.0, 7) + drift
    fit = asp.fit(TRUE, POSITION, force, free=free, noise="white", drift=1.0)
    # The likelihood of a normal distribution, at the true values. Both sums round to some 1e-13.
    residual = force - asp.MasterEquation(TRUE).pull(4.5)(POSITION)
    all_errors = covariance + 2.0**2 * np.eye(len(POSITION))
    squares = residual @ np.linalg.solve(all_errors, residual)
    deviance = squares + np.linalg.slogdet(all_errors)[1] + len(POSITION) * np.log(2 * np.pi)
    assert fit.log_likelihood([1.0, 1.0, 2.0, 10.0, 0.1])[0] == pytest.approx(-0.5 * deviance, rel=1e-10)
    true = {"thresholds.mean": 1.0, "stiffness": 1.0, "drift.amplitude": 10.0, "drift.length": 0.1}
    for name, value in true.items():
        one = fit.params[name]
        # Four standard errors of the logarithm.
        assert abs(np.log(one.value / value)) < 4 * one.error / one.value, name
    without = asp.fit(TRUE, POSITION, noisy(2.0, 7), free=free, noise="white", drift=1.0)
    assert "drift.amplitude" in without.params
    limit = without.params["drift.amplitude"].limit
    assert limit is None or limit < 4.0


def test_neighbouring_readings_are_averaged() -> None:
    position = np.linspace(0.03, 4.5, 601)
    force = asp.MasterEquation(TRUE).pull(4.5)(position)
    force += 8.0 * np.random.default_rng(5).standard_normal(601)
    free = ("thresholds.mean", "count")
    averaged = asp.fit(TRUE, position, force, free=free, noise="white", average=4)
    assert len(averaged.readings["position"]) == 151
    np.testing.assert_allclose(
        averaged.readings["position"][:150], position[:600].reshape(150, 4).mean(axis=1)
    )
    assert averaged.readings["force"][-1] == force[-1]
    # Independent errors: half as large, within 4/sqrt(2 × 150).
    assert averaged.reading == pytest.approx(4.0, rel=0.23)
    every = asp.fit(TRUE, position, force, free=free, noise="white")
    # The same data: the two estimates differ by what averaging loses, a small part of the error.
    for name in free:
        difference = averaged.params[name].value - every.params[name].value
        assert abs(difference) < 0.5 * every.params[name].error


def test_contacts_of_every_kind_are_described_by_what_is_found() -> None:
    """Their description gives the fitted curve, to rounding: areas follow from products."""
    mature = asp.Gaussian(1.0, 0.2)
    cases: list[tuple[asp.Contacts, dict[str, Any], tuple[str, ...]]] = [
        (
            asp.Contacts(asp.Mixture([(0.4, asp.Gaussian(0.6, 0.1)), (0.6, asp.Gamma(1.2, 0.2))])),
            {},
            ("thresholds.0.weight", "thresholds.1.mean"),
        ),
        (
            asp.Contacts(areas=asp.Areas(asp.Gamma(1.0, 0.3), 2.0, 1.5)),
            {},
            ("thresholds.factor", "thresholds.std", "stiffness_per_threshold"),
        ),
        (
            asp.Contacts(asp.Renormalised(asp.Gaussian(1.0, 0.2), 0.2)),
            {},
            ("thresholds.coupling", "thresholds.law.mean"),
        ),
        (
            asp.Contacts(asp.Gaussian(1.0, 0.2), asp.Gaussian(0.3, 0.05), stiffness_per_threshold=2.0),
            {"initial": asp.Gamma(0.2, 0.05)},
            ("initial.mean", "reforming.std", "stiffness_per_threshold"),
        ),
        (
            asp.Contacts(asp.Weibull(4.0, 1.0), temperature=asp.Temperature(0.05, 10.0), delay=0.05),
            {"velocity": 0.3},
            ("temperature.energy", "temperature.attempt_rate", "thresholds.scale"),
        ),
        (
            asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.FrozenRank(mature, 2.0)),
            {"velocity": 0.3},
            ("ageing.mature.mean", "ageing.time"),
        ),
        (
            asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.Logarithmic(0.05, 1.0)),
            {"velocity": 0.3},
            ("ageing.growth", "thresholds.mean"),
        ),
    ]
    position = np.linspace(0.05, 3.0, 60)
    for contacts, arguments, free in cases:
        first = asp.MasterEquation(contacts, **arguments).pull(3.0)
        changed = first(position) * (1 + 0.01 * np.sin(3 * position))
        fit = asp.fit(contacts, position, changed, free=free, noise="white", **arguments)
        assert [one.value for one in fit.params.values()] != [first.parameters()[name] for name in free]
        model = fit.model.replace()
        assert model == fit.model
        again = model.pull(3.0)
        for name in free:
            assert again.parameters()[name] == pytest.approx(fit.params[name].value, rel=1e-12), name
        # The same numbers through another call: solutions to 1e-10.
        np.testing.assert_allclose(again(position), fit.readings["expected"], rtol=1e-9)


def test_the_mean_of_a_distribution_of_delays_is_found() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.12), count=2000.0, delay=asp.Gaussian(0.1, 0.02))
    position = np.linspace(0.02, 4.0, 100)
    force = asp.MasterEquation(contacts, velocity=1.0).pull(4.0)(position)
    guess = contacts.replace(delay=asp.Gaussian(0.12, 0.02))
    found = asp.fit(guess, position, force, free=["delay.mean"], noise="white", velocity=1.0)
    # Errors of the solution, 1e-10 of the force, and of its derivatives.
    assert found.params["delay.mean"].value == pytest.approx(0.1, rel=1e-6)
    assert found.contacts.delay == asp.Gaussian(found.params["delay.mean"].value, 0.02)


def test_a_velocity_is_found() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.02, 1.0))
    force = asp.MasterEquation(contacts, velocity=0.1).pull(3.0)(POSITION[POSITION < 3])
    fit = asp.fit(contacts, POSITION[POSITION < 3], force, free=["velocity"], velocity=0.15, noise="white")
    # The curve has no errors but those of the solver.
    assert fit.params["velocity"].value == pytest.approx(0.1, rel=1e-4)
    assert fit.model.velocity == fit.params["velocity"].value


POSITIONS = list(POSITION)
WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "unknown": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["threshold.mean"]),
        r"free\.0: expected one of thresholds\.mean, .*compliance, .*, background, "
        r"got threshold\.mean \(did you mean thresholds\.mean\?\)$",
    ),
    "none": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=[]),
        "free: expected at least one key, got none",
    ),
    "twice": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count", "count"]),
        r"free\.1: expected each key once, got count",
    ),
    "count and stiffness": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count", "stiffness"], noise="white"),
        "free: expected one of count and stiffness: without the noise of contacts only their product",
    ),
    "noise": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=NAMES, noise="pink"),  # type: ignore[arg-type]
        "noise: expected contacts or white, got pink",
    ),
    "few": (
        lambda: asp.fit(GUESS, POSITION[:5], SIMULATED[:5], free=NAMES),
        "position: expected 6 readings or more for 4 free numbers, got 5",
    ),
    "many": (
        lambda: asp.fit(GUESS, np.linspace(0, 4, 4001), np.zeros(4001), free=NAMES),
        "position: expected at most 4000 readings with correlated errors: average neighbouring ones",
    ),
    "falling": (
        lambda: asp.fit(GUESS, [0.1, 0.2, 0.15, *POSITIONS[8:]], np.ones(len(POSITION) - 5), free=["count"]),
        r"position\.2: expected positions that rise, or the means of more readings where their sensor is "
        r"noisy: one above 0\.2, got 0\.15",
    ),
    "nan": (
        lambda: asp.fit(GUESS, POSITION, [*SIMULATED[:-1], np.nan], free=["count"]),
        r"force\.149: expected a finite number, got NaN",
    ),
    "lengths": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED[1:], free=["count"]),
        "force: expected 150 forces, one for each position, got 149",
    ),
    "no forces": (
        lambda: asp.fit(GUESS, POSITION, [], free=["count"]),
        "force: expected measured forces, or None",
    ),
    "drift": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count"], drift=2.0),
        r"drift: expected a length below 1\.117.*, a quarter of the range of positions, got 2",
    ),
    "fixed prior": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count"], prior={"stiffness": (1.0, 0.1)}),
        r"prior\.stiffness: expected priors of free numbers only, got a fixed one",
    ),
    "prior": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count"], prior={"count": (1.0, -0.1)}),
        r"prior\.count\.error: expected a finite number above 0, got -0\.1",
    ),
    "plan without errors": (
        lambda: asp.fit(GUESS, POSITION, None, free=["count"]),
        "reading: expected the standard deviation of a reading",
    ),
    "plan with a drift": (
        lambda: asp.fit(GUESS, POSITION, None, free=["count"], reading=1.0, drift=1.0),
        "drift: expected no drift for a measurement that is only planned",
    ),
    "average": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count"], average=0),
        "average: expected a number of readings above 0, got 0",
    ),
    "stiff machine": (
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["compliance"]),
        "compliance: expected a first value above 0",
    ),
    "velocity": (
        lambda: asp.fit(asp.Contacts(asp.Gaussian(1.0, 0.1), delay=0.1), POSITION, SIMULATED, free=["count"]),
        "velocity: expected",
    ),
    "name of a profile": (lambda: FOUND.profile("mean"), r"name: expected one of thresholds\.mean"),
    "value of a profile": (
        lambda: FOUND.profile("count", [0.0]),
        "values: expected a finite number above 0, got 0",
    ),
    "values": (
        lambda: FOUND.log_likelihood([1.0]),
        "values: expected 5 values, one for each free number, got 1",
    ),
    "position": (lambda: FOUND.predict([1.0, np.inf]), r"position\.1: expected a finite number, got inf"),
}


@pytest.mark.parametrize(("call", "message"), WRONG.values(), ids=WRONG.keys())
def test_wrong_input_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match="^" + message):
        call()


@pytest.mark.parametrize(
    ("prior", "message"),
    [
        ({"count": 1.0}, r"prior\.count: expected a pair of numbers \(value, error\), got float"),
        ({"count": (1.0, 2.0, 3.0)}, r"prior\.count: expected a pair of numbers .*, got tuple of 3 items"),
        ({"count": ("a", 2.0)}, r"prior\.count: expected a pair of numbers .*, got tuple"),
        ([1.0], r"prior: expected a dict of pairs \(value, error\) by name, got list"),
    ],
)
def test_a_prior_that_is_no_pair_is_named(prior: Any, message: str) -> None:
    with pytest.raises(TypeError, match=f"^{message}$"):
        asp.fit(GUESS, POSITION, SIMULATED, free=["count"], prior=prior)
    with pytest.raises(TypeError, match=f"^{message}$"):
        asp.fit_steady(GUESS, 0.01, SIMULATED, free=["count"], prior=prior)


@pytest.mark.parametrize("name", ["drift", "reading", "position_error", "compliance", "origin"])
def test_true_is_no_number(name: str) -> None:
    options: dict[str, Any] = {name: True}
    with pytest.raises(TypeError, match=f"^{name}: expected a number, got bool"):
        asp.fit(GUESS, POSITION, SIMULATED, free=["thresholds.mean"], **options)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1234.5678, 0.5, "1234.57"),
        (12345678.9, 0.5, "1.234567890e+07"),
        (4.3e20, 9.9e20, "4.3e+20"),
        # More digits than a double has are none.
        (4.32623988014486e118, 1.4e-5, "4.32624e+118"),
    ],
)
def test_large_numbers_have_an_exponent(value: float, error: float, text: str) -> None:
    assert _show.rounded(value, error) == text


def test_what_is_no_list_of_numbers_is_refused() -> None:
    wrong: list[Callable[[], object]] = [
        lambda: asp.fit(GUESS, POSITION, "no", free=["count"]),
        lambda: asp.fit(GUESS, 1.0, SIMULATED, free=["count"]),
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free="count"),
        lambda: asp.fit(GUESS, POSITION, SIMULATED, free=["count"], prior=[1.0]),  # type: ignore[arg-type]
    ]
    for call in wrong:
        with pytest.raises((TypeError, ValueError)):
            call()


def test_numbers_that_only_change_together_are_refused_by_name() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.05), asp.Gaussian(0.3, 0.03), count=50.0, stiffness=4.0)
    free = ["thresholds.mean", "offset", "reforming.mean", "initial.mean"]
    with pytest.raises(ValueError, match="the same curve if these change together") as refused:
        asp.fit(
            contacts, POSITION, None, free=free, initial=asp.Gaussian(0.3, 0.03), reading=0.001, noise="white"
        )
    # x → x + d for all stretches makes the force larger by N⟨k⟩d.
    reported = re.findall(r"(\S+) by ([-+0-9.]+)", str(refused.value))
    assert reported == list(zip(free, ["+1", "-200", "+1", "+1"], strict=True))


def test_the_summary_says_what_is_known_and_what_is_not() -> None:
    text = FOUND.summary()
    assert text.startswith("fit to 150 readings, ")
    assert re.search(
        r"^  thresholds\.mean +(0\.9|1\.0)\d* ± 0\.00\d+, \d\.\d+ to \d\.\d+ \(95 %\)$", text, re.M
    )
    assert re.search(r"^  reforming\.mean +0\.1 \(fixed\)$", text, re.M)
    assert re.search(r"^  reading +below \S+ \(95 %\)$", text, re.M)
    assert re.search(r"^  correlation of count and stiffness +-1\.00$", text, re.M)
    assert "trust" not in text
    assert "converge" not in text
    assert repr(FOUND).startswith("<asperity.Estimates>\n  thresholds.mean")
    assert "<table><caption>Estimates</caption>" in FOUND._repr_html_()
    plan = asp.fit(TRUE, POSITION, None, free=["count"], reading=1.0)
    assert plan.summary().startswith("errors that a measurement at 150 positions would have")


def test_a_curve_of_another_kind_is_reported() -> None:
    """Contacts of two kinds, fitted as one."""
    two = asp.Mixture([(0.5, asp.Gaussian(0.5, 0.05)), (0.5, asp.Gaussian(1.3, 0.1))])
    force = asp.MasterEquation(asp.Contacts(two, REFORMING, count=2000.0)).pull(4.5)(POSITION)
    force += np.random.default_rng(1).standard_normal(len(force))
    fit = asp.fit(GUESS, POSITION, force, free=NAMES[:3], noise="white")
    assert fit.misfit is not None
    assert fit.misfit.unlikely
    assert "The curve is not of this kind: do not trust the errors." in fit.summary()
    assert "do not trust the errors" in fit._repr_html_()


def test_curves_that_no_contacts_near_the_first_values_make_are_refused() -> None:
    for position, force, words in [
        (POSITION, np.ones(len(POSITION)), "force: expected forces that change, got 1 alone"),
        (POSITION, -SIMULATED, "force: expected forces above 0 on average"),
        (1e-6 * POSITION, SIMULATED, "position: expected positions beyond"),
    ]:
        with pytest.raises(ValueError, match=words):
            asp.fit(GUESS, position, force, free=NAMES[:3], noise="white")


def test_a_search_that_did_not_converge_is_reported() -> None:
    """A force that begins high and hardly changes, which no contacts show."""
    fit = asp.fit(GUESS, POSITION, np.linspace(1.0, 1.001, len(POSITION)), free=NAMES[:3], noise="white")
    reported = "The search did not converge: these are its last values." in fit.summary()
    assert reported != fit.converged
    assert fit.misfit is not None
    assert fit.misfit.unlikely


def test_a_plot_shows_readings_band_and_whitened_residuals() -> None:
    pytest.importorskip("matplotlib")
    above, below = FOUND.plot(color="k")
    expected, readings = (np.array(line.get_xydata()) for line in above.lines)
    at = np.searchsorted(expected[:, 0], POSITION)
    np.testing.assert_array_equal(expected[at], np.column_stack([POSITION, FOUND.readings["expected"]]))
    np.testing.assert_array_equal(readings, np.column_stack([POSITION, SIMULATED]))
    (band,) = above.collections
    edges = np.asarray(band.get_paths()[0].vertices)
    width = np.ptp(edges[edges[:, 0] == POSITION[70], 1])
    assert width == pytest.approx(4 * FOUND.readings["std"][70])
    (whitened,) = (np.array(line.get_xydata()) for line in below.lines)
    np.testing.assert_array_equal(whitened[:, 1], FOUND.readings["whitened"])
    plan = asp.fit(TRUE, POSITION, None, free=["count"], reading=1.0)
    assert len(plan.plot()) == 1
    assert names_of(above) == ["fit", "± 2 std of a reading", "measured"]
    assert not remark_of(above)
    for wrong, kind in [
        (3, "int"),
        ("xy", "str of str, str"),
        ([], "list"),
        ([above], f"list of {type(above).__name__}"),
    ]:
        with pytest.raises(TypeError, match=f"^axes: expected 2 axes of matplotlib, got {kind}$"):
            FOUND.plot(axes=cast("Any", wrong))
    assert FOUND.plot(axes=(above, below)) == (above, below)


def names_of(axes: Any) -> list[str]:
    """What the legend of axes names."""
    return [text.get_text() for text in axes.get_legend().get_texts()]


def remark_of(axes: Any) -> str:
    """The sentences above the legend of axes, without the ends of lines."""
    return " ".join(axes.get_legend().get_title().get_text().split())


def test_a_plot_says_what_the_summary_says_of_a_fit_that_is_not_to_be_trusted() -> None:
    pytest.importorskip("matplotlib").use("agg")
    import matplotlib.pyplot as plt

    shifted = asp.fit(GUESS, POSITION, SIMULATED + 300.0, free=NAMES[:2], noise="white")
    assert shifted.misfit is not None
    assert shifted.misfit.unlikely
    sentence = "The curve is not of this kind: do not trust the errors."
    assert sentence in shifted.summary()
    for wide in (6.4, 3.0):
        figure, axes = plt.subplots(2, figsize=(wide, 4.8), layout="constrained", height_ratios=[3, 1])
        above, below = shifted.plot(axes)
        assert sentence in remark_of(above)
        figure.canvas.draw()
        # Nothing is beyond the figure, nor does the name of the lower panel meet the upper one.
        named = cast("Any", above.get_legend()).get_window_extent()
        assert figure.bbox.x0 <= named.x0 < named.x1 <= figure.bbox.x1
        assert above.get_window_extent().y1 <= named.y0 < named.y1 <= figure.bbox.y1
        assert below.yaxis.label.get_window_extent().y1 <= above.get_window_extent().y0
        plt.close(figure)
    result = asp.run(
        {
            "contacts": {"thresholds": {"gaussian": {"mean": 1.0, "std": 0.12}}, "count": 2000.0},
            "fit": {
                "position": POSITION,
                "force": SIMULATED + 300.0,
                "free": ["contacts.stiffness"],
                "noise": "white",
            },
        }
    )
    assert sentence in remark_of(result.plot())


def test_progress_rises_to_one() -> None:
    reported: list[float] = []
    asp.fit(GUESS, POSITION, SIMULATED, free=NAMES, progress=reported.append)
    assert reported[-1] == 1.0
    assert reported == sorted(reported)
    FOUND.profile("count", [1800.0, 2200.0], progress=reported.append)
    assert reported[-1] == 1.0


def fit_of_two_curves() -> tuple[asp.Estimates, NDArray[np.float64], asp.Pull]:
    """A fit to two curves without noise, the second shifted by 40, with its positions and the pull."""
    longer = np.linspace(0.05, 6.0, 200)
    pull = asp.MasterEquation(TRUE).pull(6.0)
    found = asp.fit(
        GUESS,
        [POSITION, longer],
        [pull(POSITION), pull(longer) + 40.0],
        free=("thresholds.mean", "thresholds.std", "count", "curve.1.offset"),
        noise="white",
    )
    return found, longer, pull


def test_several_curves_share_their_numbers_but_for_those_of_one_curve() -> None:
    found, longer, pull = fit_of_two_curves()
    values = {name: one.value for name, one in found.params.items()}
    # There is no noise; errors of the solution and of its derivatives remain.
    truth = {"thresholds.mean": 1.0, "thresholds.std": 0.12, "count": 2000.0, "curve.1.offset": 40.0}
    assert values == pytest.approx(truth, rel=1e-6)
    assert found.contacts.count == values["count"]
    np.testing.assert_array_equal(found.readings["curve"], np.repeat([0, 1], [150, 200]))
    difference = found.predict([2.0], 1).force - found.predict([2.0]).force
    assert difference == pytest.approx(values["curve.1.offset"])
    with pytest.raises(ValueError, match=r"^curve: expected a number below 2"):
        found.predict([2.0], 2)
    with pytest.raises(ValueError, match=r"^force: expected the forces of 2 curves, got those of 1"):
        asp.fit(GUESS, [POSITION, longer], pull(POSITION), free=("count",))


def test_a_plot_shows_what_the_curve_does_between_readings() -> None:
    pytest.importorskip("matplotlib")
    # Readings as far apart as the contacts slide in one period of the force: they hardly see it.
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.03))
    position = np.arange(0.5, 15.0, 0.99)
    pull = asp.MasterEquation(contacts).pull(15.0)
    fit = asp.fit(contacts, position, pull(position), free=["stiffness"], noise="white", reading=1e-3)
    line = np.array(fit.plot()[0].lines[0].get_xydata())
    assert np.ptp(line[5:, 1]) > 2 * np.ptp(pull(position))
    # The force of the contacts whose numbers the readings give exactly.
    np.testing.assert_allclose(line[:, 1], pull(line[:, 0]), atol=1e-6)


def test_a_plot_shows_each_of_several_curves() -> None:
    pytest.importorskip("matplotlib")
    axes = fit_of_two_curves()[0].plot()
    assert len([line for line in axes[0].get_lines() if line.get_linestyle() == "-"]) == 2


def test_readings_open_with_xarray() -> None:
    pytest.importorskip("xarray")
    assert FOUND.readings.to_xarray()["std"].dims == ("reading",)


def test_distributions_of_thresholds_are_compared() -> None:
    found = asp.fit(GUESS, POSITION, SIMULATED, free=NAMES, laws=("exponential", "lognormal"))
    assert list(found.laws) == ["exponential", "lognormal"]
    assert isinstance(found.laws["lognormal"].contacts.thresholds, asp.Lognormal)
    own, exponential = found.misfit, found.laws["exponential"].misfit
    assert own is not None
    assert exponential is not None
    # 10 counts as decisive (Burnham and Anderson, 2002).
    assert exponential.akaike > own.akaike + 10
    assert "ΔAIC of exponential" in found.summary()
    with pytest.raises(ValueError, match=r"^laws\.0: expected one of gaussian, gamma"):
        asp.fit(GUESS, POSITION, SIMULATED, free=NAMES, laws=("gama",))


def test_an_unknown_compliance_is_found() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.3), REFORMING, count=2000.0)
    slider = np.linspace(0.03, 4.5, 150)
    force = asp.MasterEquation(contacts).pull(4.5)(slider)
    found = asp.fit(
        contacts.replace(count=1800.0),
        slider + 1e-4 * force,
        force,
        free=("thresholds.mean", "thresholds.std", "count"),
        noise="white",
        compliance="free",
    )
    # As without noise above.
    assert found.params["compliance"].value == pytest.approx(1e-4, rel=1e-5)
    with pytest.raises(ValueError, match=r"^compliance: expected a number or \"free\", got"):
        asp.fit(contacts, slider, force, free=("count",), compliance="fre")  # type: ignore[arg-type]


def test_thresholds_of_free_form_agree_with_those_that_made_the_curve() -> None:
    contacts = TRUE.replace(reforming=asp.Point(0.0))
    force = asp.Ensemble(contacts, size=2000, seed=7).pull(4.5, 151).force[1:]
    found = asp.fit(
        GUESS.replace(reforming=asp.Point(0.0)),
        POSITION,
        force,
        free=("thresholds.mean", "thresholds.std", "count"),
    )
    form = found.free_form()
    assert "parameters beyond a Gaussian" in repr(form)
    assert form.converged
    exact = TRUE.thresholds
    assert exact is not None
    # 2000 contacts know a distribution function to about 0.011.
    np.testing.assert_allclose(form.cumulative, exact.cdf(form.threshold), atol=0.02)
    np.testing.assert_allclose(form.density, form.thresholds.pdf(form.threshold), rtol=1e-9)
    assert np.all(form.low <= form.density)
    assert np.all(form.high >= form.density)
    assert abs(form.mean.value - 1.0) < 4 * form.mean.error
    with pytest.raises(ValueError, match=r"^kernels: expected 12 or more"):
        found.free_form(5)


def test_a_number_at_the_end_of_its_range_has_a_profile_up_to_its_limit() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.15), count=1000)
    positions = np.linspace(0.05, 5.0, 100)
    forces = asp.MasterEquation(contacts).pull(5.0).sample_paths(positions, 1, size=1000, seed=3)[0]
    found = asp.fit(contacts, positions, forces, free=["thresholds.mean", "thresholds.std"])
    reading = found.params["reading"]
    assert reading.interval[0] == 0.0
    # The same search for the limit, to rounding.
    assert found.interval_by_profile("reading") == pytest.approx(reading.interval, rel=1e-6)
    # A compliance that the forces do not show.
    found = asp.fit(
        contacts, positions, forces, free=["thresholds.mean", "compliance"], compliance=1e-7, reading=1.0
    )
    low, high = found.interval_by_profile("compliance")
    assert low == 0.0
    assert high == pytest.approx(found.params["compliance"].interval[1], rel=1e-6)
