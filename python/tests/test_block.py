"""A slider block over its contacts: numbers of the theory, limits, energy balance, records of a drive."""

import math
from collections.abc import Sequence
from pathlib import Path

import asperity as asp
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
THEORY = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
SOFT = asp.Block(THEORY, stiffness=1.0)
# That of the force, in units of the thresholds.
TOLERANCE = 1e-10


@pytest.fixture(scope="module")
def run() -> asp.StickSlip:
    return SOFT.drive(30)


def test_the_period_of_the_paper(run: asp.StickSlip) -> None:
    assert (run.regime, len(run.events)) == ("persistent", 18)
    assert run.period == pytest.approx(1.666198355430, abs=TOLERANCE)
    assert run.mean_drop == pytest.approx(0.7736105511280, abs=TOLERANCE)
    assert run.mean_slip == pytest.approx(run.mean_drop, abs=TOLERANCE)
    assert run.scatter == pytest.approx(0.0, abs=TOLERANCE)
    first = run.first_instability
    assert first is not None
    assert first == pytest.approx((1.666198355430, 0.8925878043021, 0.7736105511280), abs=TOLERANCE)
    assert (run.runaway, run.sizes, run.slip_course) == (None, None, None)
    assert run.reason == "persistent stick-slip: 18 slips, steady period"
    assert run.block == SOFT


def test_slips_that_end() -> None:
    narrow = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
    run = asp.Block(narrow, 1.0, "overdamped").drive(40)
    assert (run.regime, len(run.events), run.period) == ("transient", 15, None)
    assert run.events[0].position_after == pytest.approx(1.395379607689, abs=TOLERANCE)
    assert asp.Block(THEORY, 1.0, "overdamped").drive(20).events[0].dissipated_slip == pytest.approx(
        0.07085, abs=5e-6
    )


def test_whether_it_sticks_and_slips() -> None:
    found = asp.Block(THEORY, 1.0, "overdamped").stick_slip()
    # Contacts that re-form as they break lose their common phase.
    assert (found.stick_slip, found.persistent_stiffness) == ("transient", 0.0)
    assert found.reason == "transient stick-slip: 3 slips, then smooth sliding"
    # The tolerance of the pull, over the curvature of its minimum.
    assert found.critical_stiffness == pytest.approx(3.009222675584, abs=1e-6)
    assert found.critical_stiffness_sliding == 0.0
    soft = SOFT.stick_slip(resolution=0.1)
    assert soft.stick_slip == "persistent"
    # With "reset" every slip is like the first, below the critical stiffness: the two ends enclose it.
    assert soft.persistent_stiffness < 3.009222675584 <= soft.persistent_stiffness_above + 1e-6
    assert soft.persistent_stiffness_above <= 1.1 * soft.persistent_stiffness
    ageing = asp.Transport(asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(0.02, 1.0)))
    with pytest.raises(ValueError, match="velocity"):
        asp.Block(ageing, 1.0, asp.Damped(0.1)).stick_slip()
    with pytest.raises(ValueError, match=r"block\.slip"):
        asp.Block(ageing, 1.0, "overdamped").stick_slip(1e-3)
    with pytest.raises(ValueError, match=r"block\.stiffness"):
        asp.Block(THEORY, None).stick_slip()
    with pytest.raises(ValueError, match=r"block\.model"):
        asp.Block(asp.Ensemble(asp.Contacts(asp.Gaussian(1.0, 0.1)), size=100), 1.0).stick_slip()


def test_whether_single_contacts_stick_and_slip() -> None:
    block = asp.Block(THEORY, 0.5, "arrest", slip_fraction=0.3)
    alone = block.stick_slip(resolution=0.2)
    found = block.stick_slip(resolution=0.2, size=200, simulations=3, seed=7)
    assert alone.ensemble is None
    # The answer for infinitely many contacts is the same beside simulations.
    assert found._replace(ensemble=None) == alone
    single = found.ensemble
    assert single is not None
    assert (single.simulations, single.persistent, single.undecided) == (3, 3, 0)
    assert single.mean_drop is not None
    assert alone.mean_drop is not None
    # The drive at a slip has a scatter and a bias of order N^(-2/3) = 0.03.
    assert single.mean_drop == pytest.approx(alone.mean_drop, abs=0.03)
    assert block.stick_slip(resolution=0.2, size=200, simulations=3, seed=7) == found
    assert block.stick_slip(resolution=0.2, size=200, simulations=3, seed=8) != found
    with pytest.raises(ValueError, match="size"):
        block.stick_slip(size=0)
    with pytest.raises(ValueError, match="simulations"):
        block.stick_slip(size=10, simulations=0)
    with pytest.raises(ValueError, match=r"simulations: expected none without a size, .*, got 2"):
        block.stick_slip(simulations=2)


def test_a_map_of_single_contacts_has_a_picture() -> None:
    pytest.importorskip("matplotlib")
    result = asp.run(
        {
            "contacts": {"thresholds": {"gaussian": {"mean": 1.0, "std": 0.1}}},
            "block": {"stiffness": 1.0, "slip": "arrest", "slip_fraction": 0.3},
            "stability": {"stiffnesses": [20.0, 0.5], "resolution": 1.0, "simulations": 2},
            "ensemble": {"size": 100},
        }
    )
    axes = result.plot()
    drawn = {line.get_label(): np.asarray(line.get_ydata()).tolist() for line in axes.lines}
    # In order of the stiffness: always persistent far below K_c = 3, never far above.
    assert drawn["persistent"] == [1.0, 0.0]
    assert drawn["no stick-slip"] == [0.0, 1.0]


def test_slips_by_inertia() -> None:
    run = asp.Block(THEORY, 1.0, asp.Inertial(mass=2.0)).drive(2.0)
    # Where areas are equal; the integration in time is that accurate.
    assert run.events[0].position_turn == pytest.approx(1.599378752724, abs=1e-7)
    course = run.slip_course
    assert course is not None
    assert course.position[-1] == run.events[0].position_turn
    # The distance gone is the integral of the velocity, by the trapezoidal rule.
    way = np.sum(0.5 * (course.velocity[1:] + course.velocity[:-1]) * np.diff(course.time))
    assert course.position[-1] - course.position[0] == pytest.approx(way, abs=1e-4)
    np.testing.assert_allclose(course.spring_force, run.events[0].drive - course.position, atol=1e-12)
    assert run.energy.viscous == 0.0
    assert asp.Block(THEORY, 1.0, asp.Inertial(2.0, 0.5)).drive(2.0).energy.viscous > 0.0


def test_a_background_force_shifts_forces() -> None:
    loaded = asp.Contacts(asp.Gaussian(1.0, 0.1), normal_load=10.0, background_coefficient=0.5)
    assert (loaded.background_coefficient, loaded.background_force) == (0.5, None)
    block = asp.Block(asp.MasterEquation(loaded), stiffness=1.0)
    bare, run = SOFT.drive(6.0), block.drive(6.0)
    np.testing.assert_array_equal(run.position, bare.position)
    np.testing.assert_allclose(run.force, bare.force + 5.0, atol=TOLERANCE)
    np.testing.assert_allclose(run.events["drop"], bare.events["drop"], atol=TOLERANCE)
    # Energies are sums over some hundred intervals of forces that are solved to 1e-10.
    assert run.energy.background == pytest.approx(5.0 * (run.position[-1] - run.position[0]), abs=1e-9)
    assert run.energy.imbalance == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(block.equilibrium().force, SOFT.equilibrium().force + 5.0, atol=TOLERANCE)


def test_a_background_force_holds_after_an_overshoot() -> None:
    loaded = asp.Contacts(asp.Gaussian(1.0, 0.1), background_force=5.0)
    slip = asp.Block(asp.MasterEquation(loaded), 1.0, asp.Inertial(mass=2.0)).drive(2.0).events[0]
    assert slip.position_after == slip.position_turn


def test_the_slider_is_in_balance(run: asp.StickSlip) -> None:
    np.testing.assert_allclose(run.spring_force, run.drive - run.position, atol=1e-12)
    np.testing.assert_allclose(run.force, run.spring_force, atol=1e-12)
    before = run.position < run.events[0].position_before
    np.testing.assert_allclose(run.force[before], THEORY.pull(2.0)(run.position[before]), atol=TOLERANCE)


def test_a_rigid_slider_is_pulled_at_its_bottom() -> None:
    pull = THEORY.pull(10.0, 101)
    run = asp.Block(THEORY, math.inf).drive(10.0, 101)
    assert (run.regime, len(run.events)) == ("smooth", 0)
    np.testing.assert_array_equal(run.drive, run.position)
    np.testing.assert_allclose(run.force, pull(run.position), atol=TOLERANCE)
    ensemble = asp.Ensemble(THEORY.contacts, size=10_000)
    sample = asp.Block(ensemble, None).drive(10.0, 101)
    # The same contacts, summed otherwise.
    np.testing.assert_allclose(sample.force, ensemble.pull(10.0, 101).force, atol=1e-9)


def test_an_imposed_force_creeps_up_to_static_friction() -> None:
    run = asp.Block(THEORY, math.inf).drive(force_to=1.0)
    assert (run.regime, run.labels["drive"].quantity) == ("runaway", "force")
    assert run.runaway is not None
    assert run.runaway.force == pytest.approx(0.7964360150770, abs=TOLERANCE)
    # The force is flat there.
    assert run.runaway.position == pytest.approx(0.8441642907576, abs=1e-7)
    below = asp.Block(THEORY, None).drive(force_to=0.5)
    assert (below.runaway, below.force[-1]) == (None, pytest.approx(0.5, abs=TOLERANCE))


def test_a_drive_that_turns() -> None:
    run = asp.Block(THEORY, math.inf).drive(turning_points=[3.0, -1.0, 3.0])
    assert (run.drive.max(), run.drive.min(), run.drive[-1]) == (3.0, -1.0, 3.0)
    # Energies are sums over some hundred intervals of forces that are solved to 1e-10.
    assert abs(run.energy.imbalance) < 1e-9
    # All but what the contacts hold in the end has gone round the loop.
    assert run.energy.breaks == pytest.approx(run.energy.work - run.energy.elastic, abs=1e-9)


@pytest.mark.parametrize("slip", ["reset", "overdamped", "arrest", asp.Inertial(1.0, 0.2)], ids=str)
def test_books_are_balanced(slip: "asp.Inertial") -> None:
    energy = (run := asp.Block(THEORY, 0.6, slip).drive(12.0)).energy
    # Those of a motion in time are closed to 1e-7.
    accuracy = 1e-7 if isinstance(slip, asp.Inertial) else 1e-9
    assert abs(energy.imbalance) < accuracy
    assert energy.imbalance == pytest.approx(energy.work - sum(energy[1:-1]), abs=1e-12)
    # The work again, from the trace, by the trapezoidal rule: where balance is lost the force goes as a root.
    work = np.sum(0.5 * (run.spring_force[1:] + run.spring_force[:-1]) * np.diff(run.drive))
    assert energy.work == pytest.approx(work, abs=len(run.events) * (12.0 / 2000) ** 1.5)
    assert run.events["dissipated_slip"].sum() == pytest.approx(energy.slip + energy.viscous, abs=1e-9)
    assert run.events["dissipated_breaks"].sum() < energy.breaks


def test_equilibria() -> None:
    drive, position, force, stable = SOFT.equilibrium(distance=2.0, points=501)
    assert drive.shape == position.shape == force.shape == stable.shape == (501,)
    np.testing.assert_allclose(force, THEORY.pull(2.0)(position), atol=TOLERANCE)
    np.testing.assert_allclose(drive, position + force, atol=1e-12)
    # A balance is stable where the drive rises with the position; within a step of its turns, who knows.
    rises = np.diff(drive) > 0.0
    turns = np.flatnonzero(np.diff(rises))
    clear = np.setdiff1d(np.arange(500), [turns, turns + 1])
    np.testing.assert_array_equal(stable[clear], rises[clear])
    assert position[~stable].min() == pytest.approx(0.8925878043021, abs=2.0 / 500)
    assert SOFT.equilibrium().position[-1] == pytest.approx(5.0)
    assert np.all(asp.Block(THEORY, 4.0).equilibrium().stable)
    np.testing.assert_array_equal(*asp.Block(THEORY, None).equilibrium(1.0)[:2])


def test_the_potential_pushes_towards_balance() -> None:
    position, energy, drive = SOFT.potential(drive=[1.0, 1.666198355430], distance=2.0)
    assert energy.shape == (2, position.size)
    assert drive is not None
    assert drive.tolist() == [1.0, 1.666198355430]
    assert SOFT.potential(1.0, 2.0).drive is None
    np.testing.assert_array_equal(energy[0], SOFT.potential(1.0, 2.0).energy)
    # -V' = K(X_T - X) - F, by differences: V'' is at most 10.
    push = -(energy[0, 2:] - energy[0, :-2]) / (position[2:] - position[:-2])
    np.testing.assert_allclose(push, 1.0 - position[1:-1] - THEORY.pull(2.0)(position[1:-1]), atol=1e-4)
    # Before the first slip it is a valley in which the slider lies.
    lowest = position[np.argmin(energy[0])]
    assert lowest + THEORY.pull(2.0)(lowest) == pytest.approx(1.0, abs=2e-3)


def test_events_are_rows_and_columns(run: asp.StickSlip) -> None:
    events = run.events
    assert isinstance(events, Sequence)
    assert len(list(events)) == len(events) == 18
    first, last = events[0], events[-1]
    assert isinstance(first, asp.Event)
    assert first.drop == first.force_before - first.force_after
    assert [event.drive for event in events] == list(events["drive"])
    assert events["drop"] is run["event_drop"]
    assert (events[1:][-1], len(events[5:7])) == (last, 2)
    with pytest.raises(IndexError):
        events[18]
    with pytest.raises(KeyError, match="force"):
        events["force"]
    columns = {name.removeprefix("event_") for name in run if name.startswith("event_")}
    assert columns == set(asp.Event._fields) - set(asp.Event._field_defaults)
    assert (first.time, first.strengthening) == (None, None)


def test_a_drive_without_slips() -> None:
    run = asp.Block(THEORY, 4.0).drive(20.0)
    assert (run.regime, run.first_instability) == ("smooth", None)
    assert (len(run.events), list(run.events), run["event_drop"].shape) == (0, [], (0,))
    assert "Events: 0" in repr(run.events)


def test_avalanches() -> None:
    run = asp.Block(asp.Ensemble(THEORY.contacts, size=20_000), 1.0, "overdamped").drive(10.0)
    sizes = run.sizes
    assert sizes is not None
    assert np.all(np.diff(sizes.contacts) > 0.0)
    assert sizes.events.sum() > len(run.events) > 0
    # A spring of stiffness 1 loses as much force as the slider moves.
    np.testing.assert_allclose(sizes.drop, sizes.slip, atol=1e-9)
    assert np.all(run.events["broken_fraction"] > 0.05)
    few = asp.Block(asp.Ensemble(THEORY.contacts, size=20_000), 1.0, "overdamped", slip_fraction=0.9)
    assert np.all(few.drive(10.0).events["broken_fraction"] > 0.9)


def test_progress_of_a_drive_is_reported() -> None:
    heard: list[float] = []
    asp.Block(asp.Ensemble(THEORY.contacts, size=500_000), 1.0, "overdamped").drive(10, progress=heard.append)
    assert len(heard) > 1
    assert heard == sorted(heard)
    assert heard[-1] == 1.0


def test_drives_are_shown(run: asp.StickSlip) -> None:
    assert "persistent stick-slip: 18 slips" in repr(run)
    assert "<caption>StickSlip</caption>" in run._repr_html_()
    assert "0.773611 0.773611 0.773611 ... " in repr(run.events)
    assert "<caption>Events: 18</caption>" in run.events._repr_html_()
    assert "transient stick-slip: 3 slips" in repr(
        asp.run(SCENARIO | {"block": {"stiffness": 1.0, "slip": "overdamped"}})
    )


SCENARIO = {
    "contacts": {"thresholds": asp.Gaussian(1.0, 0.1)},
    "block": {"stiffness": 1.0, "slip": asp.Inertial(1.0, 0.2)},
    "drive": {"distance": 15.0},
}


def test_scenarios_of_drives() -> None:
    result, run = asp.run(SCENARIO), asp.Block(THEORY, 1.0, asp.Inertial(1.0, 0.2)).drive(15.0)
    for name in run:
        np.testing.assert_array_equal(result[name], run[name])
    assert result.labels["event_drop"] == run.labels["event_drop"]


def test_labelled_drives(run: asp.StickSlip) -> None:
    pytest.importorskip("xarray")
    data = run.to_xarray()
    assert data["force"].dims == ("point",)
    assert data["event_drop"].dims == ("event",)
    course = asp.Block(THEORY, 1.0, asp.Inertial(1.0)).drive(2.0).to_xarray()["slip_velocity"]
    assert "slip_time" in course.coords


def test_pictures_of_drives(run: asp.StickSlip) -> None:
    pytest.importorskip("matplotlib")
    creep = asp.Block(THEORY, None).drive(force_to=1.0)
    for shown, names, x, y in (
        (run, ("$X_T$", "$F$"), run.drive, run.spring_force),
        (creep, ("$X$", "$F$"), creep.position, creep.drive),
    ):
        axes = shown.plot()
        (line,) = axes.lines
        np.testing.assert_array_equal(line.get_xydata(), np.column_stack([x, y]))
        assert (axes.get_xlabel(), axes.get_ylabel()) == names
    result = asp.run(SCENARIO)
    curve, steady = (np.array(line.get_xydata()) for line in result.plot().lines)
    np.testing.assert_array_equal(curve, np.column_stack([result["drive"], result["spring_force"]]))
    assert steady[0, 1] == result.kinetic_friction
