"""Rate-and-state parameters of measured curves, against known ones and those of curve_fit of scipy."""

import math
import re
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import curve_fit

POSITION = np.arange(-60.0, 200.0)
A, B, DISTANCE, RATIO = 0.008, 0.012, 8.0, 10.0


def response(
    x: NDArray[np.float64], before: float, a: float, b: float, distance: float
) -> NDArray[np.float64]:
    after = a - b * (1 - np.exp(-np.maximum(x, 0.0) / distance))
    return np.asarray(before + math.log(RATIO) * np.where(x < 0.0, 0.0, after))


def measured(seed: int) -> NDArray[np.float64]:
    noise = np.random.default_rng(seed).normal(size=POSITION.size)
    return response(POSITION, 0.6, A, B, DISTANCE) + 4e-4 * noise


def test_white_noise_gives_the_numbers_of_scipy() -> None:
    force = measured(1)
    step = asp.read_velocity_step(POSITION, force, RATIO, peak=0.0, noise="white")
    values, covariance = curve_fit(response, POSITION, force, p0=(0.6, 0.01, 0.01, 5.0))
    found = [step.before, step.a, step.b, step.distance]
    # The tolerances of both searches are about 1e-8 of the sum of squares, 1e-4 of an error.
    for estimate, value, variance in zip(found, values, np.diag(covariance), strict=True):
        assert abs(estimate.value - value) < 1e-3 * estimate.error
        assert estimate.error == pytest.approx(math.sqrt(variance), rel=1e-3)
    np.testing.assert_allclose(step.fitted, response(step.position, *values), atol=1e-6)
    np.testing.assert_array_equal(step(step.position), step.fitted)
    assert step.residual == pytest.approx(np.sqrt(np.mean((force - step.fitted) ** 2)), rel=1e-9)
    assert step.noise.drift == []


def drifting(seed: int) -> NDArray[np.float64]:
    """A record with drift of standard deviation 5e-4 and correlation length 25 besides white noise."""
    rng = np.random.default_rng(1000 + seed)
    kept = math.exp(-1 / 25)
    drift = [5e-4 * rng.normal()]
    for _ in POSITION[1:]:
        drift.append(kept * drift[-1] + 5e-4 * math.sqrt(1 - kept**2) * rng.normal())
    return np.asarray(measured(seed) + np.array(drift))


def test_drift_is_found_and_widens_errors() -> None:
    widened = []
    for seed in range(8):
        force = drifting(seed)
        step = asp.read_velocity_step(POSITION, force, RATIO, peak=0.0)
        white = asp.read_velocity_step(POSITION, force, RATIO, peak=0.0, noise="white")
        widened.append(step.a_minus_b.error / white.a_minus_b.error)
        assert len(step.noise.drift) >= 1
        # The record is ten correlation lengths long, so that errors are themselves uncertain: six of them.
        for estimate, known in [(step.a, A), (step.b, B), (step.distance, DISTANCE), (step.a_minus_b, A - B)]:
            assert abs(estimate.value - known) < 6 * estimate.error
            low, high = estimate.interval
            assert low < estimate.value < high
        assert "a_minus_b" in repr(step)
    # The variance of a mean of this drift is 2 × 25 times that of white noise of the same size, and drift is
    # 0.6 of the variance: errors grow by about five. Single records may have little drift.
    assert np.mean(widened) > 2.5


def test_a_short_record_gives_no_upper_limit() -> None:
    short = POSITION[POSITION < 20.0]
    noise = np.random.default_rng(4).normal(size=short.size)
    force = response(short, 0.6, A, B, 1e3) + 4e-4 * noise
    step = asp.read_velocity_step(short, force, RATIO, peak=0.0)
    assert step.distance.interval[1] == math.inf


def test_options() -> None:
    force = measured(5) + 1e-5 * POSITION
    step = asp.read_velocity_step(POSITION, force, RATIO, peak=0.0, trend=True, average=2)
    assert step.trend is not None
    assert abs(step.trend.value - 1e-5) < 5 * step.trend.error
    assert step.position.size == POSITION.size // 2
    fixed = asp.read_velocity_step(POSITION, measured(5), RATIO, before=0.6)
    assert fixed.before[:3] == (0.6, 0.0, (0.6, 0.6))
    assert fixed.trend is None
    assert fixed.ratio == RATIO


def test_wrong_input() -> None:
    force = measured(6)
    with pytest.raises(ValueError, match="ratio: expected a finite number above 0 other than 1"):
        asp.read_velocity_step(POSITION, force, 1.0)
    with pytest.raises(ValueError, match=r"position\.1: expected positions that rise, one above"):
        asp.read_velocity_step(POSITION[::-1] * 0.0 - 1.0, force, RATIO)
    with pytest.raises(ValueError, match="noise"):
        asp.read_velocity_step(POSITION, force, RATIO, noise="pink")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="hold: expected at least 4 holds"):
        asp.read_healing([1.0, 2.0], [0.6, 0.7])


def test_healing_gives_the_numbers_of_scipy() -> None:
    hold = np.logspace(0.0, 4.0, 13)
    force = 0.6 + 0.008 * np.log1p(hold / 5.0) + 3e-4 * np.random.default_rng(7).normal(size=hold.size)
    healing = asp.read_healing(hold, force)

    def law(t: NDArray[np.float64], start: float, growth: float, cutoff: float) -> NDArray[np.float64]:
        return np.asarray(start + growth * np.log1p(t / cutoff))

    values, covariance = curve_fit(law, hold, force, p0=(0.6, 0.01, 3.0))
    assert healing.cutoff is not None
    # SciPy's search ends where steps change the sum of squares by 1e-8, which is 1e-4 of values.
    assert healing.cutoff.value == pytest.approx(values[2], rel=1e-4)
    assert healing.cutoff.error == pytest.approx(math.sqrt(covariance[2, 2]), rel=1e-3)
    assert healing.per_decade.value == pytest.approx(math.log(10) * values[1], rel=1e-4)
    assert healing.per_decade.error == pytest.approx(math.log(10) * math.sqrt(covariance[1, 1]), rel=1e-3)
    np.testing.assert_allclose(healing.fitted, law(hold, *values), atol=1e-6)
    np.testing.assert_array_equal(healing(hold), healing.fitted)
    assert "per_decade" in repr(healing)


def test_healing_shows_no_more_digits_than_numbers_have() -> None:
    hold = np.logspace(0.0, 3.0, 7)
    for force in (0.6 + 0.01 * np.log10(hold), -math.log(10.0) + 0.01 * np.log1p(hold)):
        digits = re.findall(r"[1-9][\d.]*", repr(asp.read_healing(hold, force)))
        # 15 digits, and a point.
        assert max(map(len, digits)) <= 16
    with pytest.raises(ValueError, match="got no growth beyond their scatter"):
        asp.read_healing(hold, np.random.default_rng(1).normal(size=7))


def test_plots() -> None:
    pytest.importorskip("matplotlib").use("agg")
    step = asp.read_velocity_step(POSITION, measured(8), RATIO)
    axes = step.plot(color="k")
    # dots, the fit before and after the step, readings that are not fitted, and the position of the peak
    assert len(axes.lines) == 4 + (len(step.unused_position) > 0)
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), step.force)
    drawn = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    assert np.all(np.asarray(drawn["$X_p$, where the fit starts"].get_xdata()) == step.peak)
    # All is fitted where the force relaxes from the step on.
    assert ("not fitted" in drawn) == (step.peak > 0.0)
    later = asp.read_velocity_step(POSITION, measured(8), RATIO, peak=5.0)
    between = (POSITION >= 0.0) & (POSITION < 5.0)
    np.testing.assert_array_equal(later.unused_position, POSITION[between])
    np.testing.assert_array_equal(later.unused_force, measured(8)[between])
    assert "not fitted" in later.plot().get_legend_handles_labels()[1]
    assert not axes.get_title(loc="left")
    # Noise that is not that of the fit.
    force = measured(8) + 1e-3 * np.sign(np.sin(3.0 * POSITION))
    doubtful = asp.read_velocity_step(POSITION, force, RATIO, peak=0.0, noise="white")
    assert repr(doubtful).endswith("\nErrors are not reliable: the noise is not of this kind.")
    title = doubtful.plot().get_title(loc="left")
    assert " ".join(title.split()) == "Errors are not reliable: the noise is not of this kind."
    # Readings before the step are not fitted where the force there is given.
    given = asp.read_velocity_step(POSITION, measured(8), RATIO, before=0.6, peak=0.0)
    np.testing.assert_array_equal(given.unused_position, POSITION[POSITION < 0.0])
    hold = [1.0, 10.0, 100.0, 1e3, 1e4]
    falling = asp.read_healing(hold, [0.66, 0.641, 0.622, 0.61, 0.6])
    assert falling.warnings == ["static friction falls with the hold time: this is no healing"]
    assert repr(falling).endswith("\nStatic friction falls with the hold time: this is no healing.")
    assert "no healing" in falling.plot().get_title(loc="left")
    axes = asp.read_healing(hold, [0.6, 0.61, 0.622, 0.641, 0.66]).plot()
    assert len(axes.lines) == 2
    assert not axes.get_title(loc="left")
    assert axes.get_xscale() == "log"


def test_a_step_behind_the_spring_of_a_machine() -> None:
    a, b, distance, ratio = 0.01, 0.015, 1.5, 10.0
    displacement = np.linspace(-1.0, 12.0, 261)
    # The slip law in closed form, of a machine so stiff that the slider follows the load point.
    fallen = b * (1.0 - np.exp(-np.maximum(displacement, 0.0) / distance))
    force = 0.6 + np.log(ratio) * np.where(displacement <= 0.0, 0.0, a - fallen)
    found = asp.fit_velocity_step(displacement, force, ratio, 50.0, law="slip")
    # The slider lags behind by F/K.
    assert (found.a, found.before) == pytest.approx((a, 0.6), rel=2e-3)
    assert (*found.b, *found.distance) == pytest.approx((b, distance), rel=2e-3)
    assert found.residual_relative < 0.02
    np.testing.assert_allclose(found.fitted[:20], 0.6, atol=1e-3)
    text = str(found)
    assert text.splitlines()[0] == "<asperity.MachineStep>"
    assert len(text.splitlines()) == 7
    assert re.search(rf"^  distance +{found.distance[0]:.5g}$", text, re.MULTILINE)
    assert f"{len(force)} forces" in text
    with pytest.raises(ValueError, match="states"):
        asp.fit_velocity_step(displacement, force, ratio, 50.0, states=3)
    with pytest.raises(ValueError, match="law"):
        asp.fit_velocity_step(displacement, force, ratio, 50.0, law="other")  # type: ignore[arg-type]


Slope = Callable[[float, NDArray[np.float64]], list[float]]


def slopes(load: float, a: float, b: float, distance: float, stiffness: float) -> Slope:
    """The rates of ln V and ln theta by the ageing law, behind a spring whose load point moves at `load`."""

    def slope(_time: float, y: NDArray[np.float64]) -> list[float]:
        speed, theta = np.exp(y)
        evolved = 1.0 / theta - speed / distance
        return [(stiffness * (load - speed) - b * evolved) / a, evolved]

    return slope


SOLVED: dict[str, Any] = {"method": "Radau", "rtol": 1e-9, "atol": 1e-11}


def held(
    hold: float, a: float, b: float, distance: float, velocity: float, stiffness: float
) -> tuple[float, float]:
    """The highest force after a hold and the force at its end, above that of steady sliding."""

    def as_fast(_time: float, y: NDArray[np.float64]) -> float:
        return float(y[0] - np.log(velocity))

    as_fast.terminal = True  # type: ignore[attr-defined]
    as_fast.direction = 1.0  # type: ignore[attr-defined]
    start = np.log([velocity, distance / velocity])
    rest = solve_ivp(slopes(0.0, a, b, distance, stiffness), (0.0, hold), start, **SOLVED).y[:, -1]
    moving = slopes(velocity, a, b, distance, stiffness)
    # The motion ends where the slider is as fast as the load point.
    again = solve_ivp(moving, (0.0, 1e4), rest, events=as_fast, **SOLVED).y[:, -1]
    peak, end = (a * (y[0] - start[0]) + b * (y[1] - start[1]) for y in (again, rest))
    return float(peak), float(end)


def test_healing_behind_the_spring_of_a_machine() -> None:
    a, b, distance, velocity, stiffness = 0.01, 0.013, 5.0, 10.0, 1e-3
    hold = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]
    peaks, ends = np.transpose([held(time, a, b, distance, velocity, stiffness) for time in hold])
    known = asp.fit_healing(hold, 0.6 + peaks, 0.6, velocity, stiffness, a=a)
    # Integrated to 1e-8 of a factor e of velocity and theta, times what a fit amplifies.
    assert (known.a, known.b, known.distance) == pytest.approx((a, b, distance), rel=1e-4)
    assert known.residual_relative < 1e-6
    np.testing.assert_allclose(known.fitted, 0.6 + peaks, atol=1e-8)
    np.testing.assert_allclose(known.fitted_held, 0.6 + ends, atol=1e-6)
    found = asp.fit_healing(hold, peaks, 0.0, velocity, stiffness, held=ends)
    assert (found.a, found.b, found.distance) == pytest.approx((a, b, distance), rel=1e-4)
    slip = asp.fit_healing(hold, peaks, 0.0, velocity, stiffness, held=ends, law="slip")
    assert slip.residual > 100.0 * found.residual
    assert str(found).startswith("<asperity.MachineHealing>\n  a ")
    assert len(str(found).splitlines()) == 7
    with pytest.raises(ValueError, match="a: expected a of a velocity step, or held"):
        asp.fit_healing(hold, peaks, 0.0, velocity, stiffness)
    with pytest.raises(ValueError, match="held: expected 7 forces, one for each hold"):
        asp.fit_healing(hold, peaks, 0.0, velocity, stiffness, held=ends[1:])
    with pytest.raises(ValueError, match="law"):
        asp.fit_healing(hold, peaks, 0.0, velocity, stiffness, a=a, law="other")  # type: ignore[arg-type]


def test_how_reading_errors_scatter_healing_behind_a_spring() -> None:
    a, b, distance, velocity, stiffness, error = 0.01, 0.013, 5.0, 10.0, 1e-3, 5e-4
    hold = [3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]
    peaks, ends = np.transpose([held(time, a, b, distance, velocity, stiffness) for time in hold])
    random = np.random.default_rng(1)

    def read() -> list[float]:
        forces, rest = peaks + random.normal(0.0, error, 6), ends + random.normal(0.0, error, 6)
        found = asp.fit_healing(hold, forces, 0.0, velocity, stiffness, held=rest)
        return [found.a, found.b, found.distance]

    scatter = np.log([read() for _ in range(20)]).std(axis=0)
    # What the page says. The standard deviation of 20 has an error of a sixth; three of them.
    assert np.abs(np.log(scatter / [0.07, 0.01, 0.3])).max() < 0.5


def test_a_compared_step_is_read_with_the_spring_of_its_machine() -> None:
    a, b, distance, stiffness = 0.01, 0.015, 0.8, 2.0
    x = np.linspace(0.0, 10.0, 201)
    start = np.log([0.1, distance / 0.1])
    # At the velocity 1 the displacement of the load point since the step is the time.
    found = solve_ivp(slopes(1.0, a, b, distance, stiffness), (0.0, 10.0), start, t_eval=x, **SOLVED)
    force = 0.6 + a * (found.y[0] - start[0]) + b * (found.y[1] - start[1])
    scenario: dict[str, Any] = {
        "contacts": {
            "thresholds": {"gaussian": {"mean": 1.0, "std": 0.25}},
            "ageing": {"logarithmic": {"growth": 0.04, "time": 1.0}},
        },
        "protocol": [
            {"velocity": 0.1, "distance": 5.0, "start": "steady"},
            {"velocity": 1.0, "distance": 10.0},
        ],
        "compare": {
            "position": [*np.linspace(0.0, 4.9, 50), *(5.0 + x)],
            "force": [*np.full(50, 0.6), *force],
        },
    }
    rigid = {**scenario, "compare": {**scenario["compare"], "stiffness": stiffness}}
    block = {**scenario, "block": {"stiffness": stiffness}}
    for result in (asp.run(rigid), asp.run(block)):
        read = result.summary["steps"][1]["measured_spring"]
        # Integrated to 1e-8 of a factor e of velocity and theta, times what a fit amplifies.
        assert read["residual_relative"] < 1e-6
        assert (read["a"], *read["b"], *read["distance"]) == pytest.approx((a, b, distance), rel=1e-4)
    assert "residual" in result.summary["steps"][1]["rate_state_spring"]
    with pytest.raises(ValueError, match=r"compare\.stiffness: expected none beside \[block\]"):
        asp.run({**rigid, "block": {"stiffness": stiffness}})
    pytest.importorskip("matplotlib").use("agg")
    axes = result.plot(kind="compared")
    np.testing.assert_array_equal(axes.lines[0].get_xdata(), result["drive"])
    np.testing.assert_array_equal(axes.lines[-1].get_ydata(), result["compared_force"])
    assert "X_\\mathrm{T}" in axes.get_xlabel() or "X_T" in axes.get_xlabel()


def test_numbers_that_do_not_mean_what_they_seem_to_have_a_warning() -> None:
    assert asp.read_velocity_step(POSITION, measured(8), RATIO, peak=0.0).warnings == []
    late = asp.read_velocity_step(POSITION, measured(8), RATIO, peak=15.0)
    (says,) = late.warnings
    assert says.startswith(f"X_p is {15.0 / late.distance.value:.1f} D_c after the step: a and b hold there")
    # The ratio of the velocities before and after the step turns the signs of a and b.
    (turned,) = asp.read_velocity_step(POSITION, measured(8), 1.0 / RATIO, peak=0.0).warnings
    assert turned.startswith("the direct effect a is negative")


def test_a_drift_longer_than_the_record_suggests_a_trend() -> None:
    position = np.linspace(-50.0, 150.0, 400)
    after = 0.01 - 0.015 * (1.0 - np.exp(-np.maximum(position, 0.0) / 6.0))
    noise = 5e-4 * np.random.default_rng(3).normal(size=400)
    force = 0.6 + np.log(10.0) * np.where(position < 0.0, 0.0, after) + noise
    for slope, trend, says in [(1e-4, False, True), (1e-4, True, False), (0.0, False, False)]:
        read = asp.read_velocity_step(position, force + slope * position, 10.0, trend=trend)
        assert ("drift is longer than the record: a fit with a trend may" in str(read)) == says
