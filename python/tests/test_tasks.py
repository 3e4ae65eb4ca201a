"""Tasks as functions: what a scenario computes, with the numbers as fields."""

import doctest
from typing import Any

import asperity
import numpy as np
import pytest
from asperity import _events, _task_results, _tasks

# What type checkers would refuse is tried.
asp: Any = asperity

AGEING = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.02, time=1.0))
WARM = asp.Contacts(asp.Gaussian(1.0, 0.05), temperature=asp.Temperature(0.02, 1.0))
COLD = asp.Contacts(asp.Gaussian(1.0, 0.05))


@pytest.mark.parametrize("module", [_tasks, _task_results, _events], ids=lambda module: module.__name__)
def test_examples_print_what_is_shown(module: Any) -> None:
    results = doctest.testmod(module)
    assert results.attempted > 0
    assert results.failed == 0


def test_a_velocity_curve_has_its_numbers() -> None:
    curve = asp.velocity_curve(WARM, span=(1e-4, 1e-1), points=4, ensemble={"size": 200, "seed": 3})
    # Each velocity of a list is a solution of its own.
    alone = np.array([asp.velocity_curve(WARM, float(velocity)) for velocity in curve.velocity])
    np.testing.assert_allclose(curve.kinetic_friction, alone, rtol=1e-9)
    assert curve.temperature is None
    assert curve.ensemble_force is not None
    assert curve.ensemble_force.shape == (4,)
    assert curve.limits[0].fast == pytest.approx(0.50125, rel=1e-6)
    several = asp.velocity_curve(WARM, span=(1e-2, 1e-1), points=2, temperatures=[0.02, 0.05])
    assert several.kinetic_friction.shape == (2, 2)
    assert [one.temperature for one in several.limits] == [0.02, 0.05]
    np.testing.assert_allclose(several.kinetic_friction[0], alone[2:], rtol=1e-9)


def test_a_curve_at_given_velocities_is_a_result() -> None:
    velocities = [1e-3, 2e-2, 0.1]
    curve = asp.velocity_curve(WARM, velocities, temperatures=[0.02, 0.05], ensemble={"size": 50})
    assert curve.velocity.tolist() == velocities
    assert curve.kinetic_friction.shape == curve.ensemble_force.shape == (2, 3)
    steady = [
        asp.Transport(WARM, start="steady", velocity=one).follow([asp.Step(one, distance=0.1)])
        for one in velocities
    ]
    # Steady sliding stays as it begins, to the default tolerance of a transport.
    np.testing.assert_allclose(curve.kinetic_friction[0], [one["force"][0] for one in steady], rtol=1e-4)
    # The background force is part of it, as of all results of scenarios.
    loaded = WARM.replace(background_force=1.0)
    assert asp.velocity_curve(loaded, [0.1]).kinetic_friction[0] == asp.velocity_curve(loaded, 0.1)
    assert asp.velocity_curve(loaded, 0.1) == pytest.approx(1.0 + curve.kinetic_friction[0, 2], rel=1e-12)
    assert curve.result.scenario.count("velocities = [0.001, 0.02, 0.1]") == 1


def test_stability_is_that_of_a_block() -> None:
    block = asp.Block(asp.Transport(AGEING), 0.05, asp.Damped(0.5))
    curve = asp.stability(AGEING, span=(0.1, 1.0), points=2, block=block)
    assert curve.growth_rate is not None
    for number, velocity in enumerate(curve.velocity):
        found = block.stability(float(velocity))
        # The same computation through another call.
        assert curve.critical_stiffness_sliding[number] == pytest.approx(found.critical_stiffness, rel=1e-9)
        assert curve.growth_rate[number] == pytest.approx(found.growth_rate, rel=1e-9)
    assert curve.unstable == np.count_nonzero(curve.growth_rate > 0.0)
    rigid = asp.stability(AGEING, [0.1, 1.0])
    assert rigid.growth_rate is None
    assert rigid.velocity.tolist() == [0.1, 1.0]


def test_measured_points_are_compared_where_they_were_measured() -> None:
    velocities = [0.05, 0.02, 0.05]
    forces = np.array([asp.velocity_curve(WARM, velocity) for velocity in velocities])
    curve = asp.velocity_curve(WARM, span=(1e-2, 1e-1), points=2, measured=(velocities, forces + 0.01))
    # Two solutions of the renewal equation, each to 1e-10.
    assert curve.residual == pytest.approx([0.01] * 3, abs=1e-9)
    assert curve.residual_rms == pytest.approx(0.01, abs=1e-9)
    assert asp.velocity_curve(WARM, span=(1e-2, 1e-1), points=2).residual_rms is None
    held = asp.hold_curve(AGEING, (1.0, 100.0), velocity=0.1, points=3)
    other = asp.hold_curve(
        AGEING, (2.0, 200.0), velocity=0.1, points=2, measured=(held.hold, held.static_friction - 0.02)
    )
    # Peaks are as accurate as the default tolerance of 1e-6 makes them.
    assert other.residual == pytest.approx([-0.02] * 3, abs=1e-4)
    assert other.residual_rms == pytest.approx(0.02, abs=1e-4)
    assert other.hold.tolist() == [2.0, 200.0]
    pytest.importorskip("matplotlib")
    for result, points in [(curve, velocities), (other, held.hold)]:
        axes: Any = result.plot()
        drawn = {line.get_label(): line for line in axes.lines}["measured"]
        assert np.array_equal(drawn.get_xdata(), points)
        _, below = axes.figure.axes
        assert np.array_equal(below.lines[-1].get_xydata(), np.c_[points, result.residual])
        assert below.get_xscale() == axes.get_xscale() == "log"


def test_healing_is_read_from_the_hold_curve() -> None:
    curve = asp.hold_curve(AGEING, (1.0, 1e4), velocity=0.1, points=9)
    # Another fit of the same points: with errors, by the profile of the likelihood.
    read = asp.read_healing(curve.hold, curve.static_friction)
    assert curve.healing.per_decade == pytest.approx(read.per_decade.value, rel=1e-6)
    assert asp.healing(AGEING, (1.0, 1e4), velocity=0.1, points=9) == curve.healing
    assert curve.kinetic_friction == pytest.approx(asp.velocity_curve(AGEING, 0.1), rel=1e-6)
    assert curve.healing.per_decade is not None
    assert curve.healing.relative == pytest.approx(curve.healing.per_decade / curve.kinetic_friction)


def test_creep_fails_later_under_smaller_forces() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.03, 1.0))
    found = asp.creep(contacts, [0.3, 0.6, 0.7, 0.9], duration=1e3, points=51)
    assert np.isnan(found.failure_time).tolist() == [True, False, False, False]
    assert found.failure_time[1] > 10.0 * found.failure_time[2] > 0.0
    assert found.failure_time[3] == 0.0
    # Ten times the accuracy that the documents state for the default tolerance.
    assert (found.failure_time_error[1:3] < 1e-3 * found.failure_time[1:3]).all()
    assert np.isnan(found.time[3]).all()
    assert (np.diff(found.time[:3], axis=1) > 0.0).all()
    np.testing.assert_array_equal(found.position[:3, -1], found.final_position[:3])
    np.testing.assert_array_equal(found.time[1:3, -1], found.failure_time[1:3])
    assert (found.velocity[1:3, 1:-1].min(axis=1) >= 0.99 * found.slowest_velocity[1:3]).all()
    # A force that is raised in a time far below that to failure changes it by that time at most.
    slow = asp.creep(contacts, 0.6, 1e3, loading_rate=6.0)
    assert slow.failure_time[0] == pytest.approx(
        found.failure_time[1], abs=0.1 + 1e-3 * found.failure_time[1]
    )


def test_creep_without_failure_has_no_time_to_failure() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.03, 1.0))
    held = asp.creep(contacts, 0.3, 10.0)
    assert np.isnan(held.failure_time).all()
    assert held.final_velocity[0] > 0.0
    with pytest.raises(ValueError, match=r"creep\.forces\.0: expected a number above 0"):
        asp.creep(contacts, -1.0, 10.0)


def test_first_breaks_are_those_of_a_scenario() -> None:
    lattice = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.1)), [20, 20], neighbours=0.025, connection=0.9)
    found = asp.renormalisation(lattice, runs=3, points=40)
    interface = {
        "cells": [20, 20],
        "contacts": "one",
        "connection": 0.9,
        "coupling": {"neighbours": {"stiffness": 0.025}},
    }
    scenario = {
        "contacts": {"thresholds": asp.Gaussian(1.0, 0.1)},
        "interface": interface,
        "renormalisation": {"runs": 3, "points": 40},
    }
    result = asp.run(scenario)
    np.testing.assert_array_equal(found.density, result["measured_density"])
    assert found.mean == result.summary["renormalisation"]["mean"]["value"]
    assert found.coupling == pytest.approx(0.1, rel=1e-15)
    assert found.of_mean_field is not None
    assert found.of_mean_field.distance < found.of_thresholds.distance


def test_a_curve_is_compared_with_what_it_was_made_of() -> None:
    theory = asp.MasterEquation(COLD)
    pull = theory.pull(3.0, 31)
    found = asp.compare(theory, pull.position, pull.force + 0.25, distance=3.0)
    assert found.points == 31
    # Of a constant difference, to the rounding of differences of order 1.
    assert found.residual == pytest.approx([0.25] * 31, rel=1e-12)
    assert found.residual_rms == pytest.approx(0.25, rel=1e-12)
    beyond = asp.compare(theory, [1.0, 4.0], [0.5, 0.5], distance=3.0)
    assert np.isnan(beyond.residual).tolist() == [False, True]
    sampled = asp.compare(asp.Ensemble(COLD, size=50), [1.0], [0.5], distance=2.0, points=11)
    assert "ensemble_force" in sampled.result
    plt = pytest.importorskip("matplotlib.pyplot")
    plt.switch_backend("agg")
    above = found.plot()
    _, below = above.figure.axes
    assert np.array_equal(below.lines[-1].get_xydata(), np.c_[pull.position, found.residual])
    assert (below.get_xlabel(), below.get_ylabel()) == ("$X$", "residual")
    legend = {text.get_text() for text in above.get_legend().get_texts()}
    assert legend == {"master equation", "measured", "$F_s$", "$F_k$"}
    # The legend is above the curve, and nothing is beyond the figure.
    above.figure.canvas.draw()
    assert above.get_legend().get_window_extent().y0 >= above.get_window_extent().y1
    assert above.get_legend().get_window_extent().y1 <= above.figure.bbox.y1
    # On given axes the force alone.
    figure, axes = plt.subplots()
    assert found.plot(axes) is axes
    assert figure.axes == [axes]
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda: asp.velocity_curve(WARM), TypeError, "either velocities or a span, got neither"),
        (lambda: asp.velocity_curve(WARM, 1.0, span=(1, 2)), TypeError, "got both"),
        (lambda: asp.velocity_curve(WARM, 1.0, temperatures=[0.1]), TypeError, "got one velocity"),
        (lambda: asp.velocity_curve(WARM, 1.0, measured=([1], [1])), TypeError, "got one velocity"),
        (
            lambda: asp.hold_curve(AGEING, (1.0, 2.0), 1.0, measured=([1.0, 2.0], [0.5])),
            ValueError,
            "compare.force: expected 2 forces, one for each hold",
        ),
        (
            lambda: asp.hold_curve(AGEING, (1.0, 2.0), 1.0, measured=[1.0]),
            TypeError,
            "measured: expected two lists, hold and force",
        ),
        (lambda: asp.velocity_curve(WARM, []), ValueError, "velocities: expected one velocity or more"),
        (
            lambda: asp.velocity_curve(WARM, [2.0, 1.0]),
            ValueError,
            r"velocities\.1: expected a velocity above",
        ),
        (lambda: asp.velocity_curve(WARM, span=3.0), TypeError, "span: expected the lowest and the highest"),
        (lambda: asp.velocity_curve(WARM, span=(0.0, 1.0)), ValueError, "velocity_curve.from: expected"),
        (lambda: asp.hold_curve(AGEING, (1.0, 2.0), -1.0), ValueError, "hold_curve.velocity: expected"),
        (lambda: asp.stability(AGEING, [0.1, 1.0], block=3), TypeError, "block: expected a Block, got int"),
        (
            lambda: asp.renormalisation(asp.Interface(COLD, [4], connection=1.0, neighbours=1.0)),
            ValueError,
            "interface.disorder",
        ),
        (lambda: asp.compare(asp.MasterEquation(COLD), [1.0], []), ValueError, "compare.force: expected 1"),
        (lambda: asp.compare(COLD, [1.0], [1.0]), TypeError, "model: expected a MasterEquation"),
        (
            lambda: asp.compare(asp.MasterEquation(COLD), [-1.0, 2500.0], [1.0, 1.0]),
            ValueError,
            r"position: expected one from 0 to 20, the distance of the pull, got those from -1 to 2500",
        ),
    ],
)
def test_wrong_arguments_are_refused(call: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        call()


def test_results_are_saved_and_shown(tmp_path: Any) -> None:
    curve = asp.velocity_curve(WARM, span=(1e-2, 1e-1), points=2)
    curve.save(tmp_path / "curve")
    np.testing.assert_array_equal(asp.open_result(tmp_path / "curve")["velocity"], curve.velocity)
    assert repr(curve).startswith("<asperity.VelocityCurve>")
    assert "<table" in curve._repr_html_()
    assert curve.summary["task"] == "velocity_curve"
    assert curve.pictures == ("velocity_curve",)
