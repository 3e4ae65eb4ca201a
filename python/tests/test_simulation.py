"""Simulations: the drives of models step by step, looked at, kept, stopped and taken up on the way."""

import signal
import threading
import time
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
import pytest

CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.1), reforming=asp.Rectangular(0.0, 0.2))
AGEING = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.02, time=1.0))
SOON = 0.2


def interface(**changes: Any) -> asp.Interface:
    arguments: dict[str, Any] = {"neighbours": 0.5, "connection": 0.3, "disorder": 0.2, "slip": "overdamped"}
    return asp.Interface(CONTACTS, [6], **(arguments | changes))


INTERFACES = {
    "overdamped": interface(),
    "reset": interface(slip="reset"),
    "viscous": interface(viscosity=1.0),
    "followed": interface(size=30),
    "half-space": asp.Interface(
        CONTACTS, [4, 5], half_space=(1.0, 1.0), connection=0.3, disorder=0.2, edges="periodic"
    ),
    "lattice": asp.Lattice(CONTACTS, [8, 8], asp.Rectangular(0.0, 0.5), neighbours=0.2, connection=0.2),
}
AGED = asp.Interface(AGEING, [3], neighbours=1.0, connection=0.2, slip="overdamped", viscosity=0.1)
MANY = asp.Interface(CONTACTS, [8], neighbours=1.5, connection=0.3, slip="overdamped", size=7, quenched=True)
SOLVED, FOLLOWED = asp.MasterEquation(CONTACTS), asp.Ensemble(CONTACTS, size=2000)
BLOCKS = {
    "solved": asp.Block(SOLVED, 0.5, "overdamped"),
    "resets": asp.Block(SOLVED, 0.5),
    "followed": asp.Block(FOLLOWED, 0.5, "overdamped"),
    "inertial": asp.Block(FOLLOWED, 0.5, asp.Inertial(1.0)),
}
ALL: dict[str, Any] = (
    INTERFACES
    | {f"block, {name}": block for name, block in BLOCKS.items()}
    | {"master equation": SOLVED, "ensemble": asp.Ensemble(CONTACTS, size=50)}
)


def cases(models: dict[str, Any]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("model", models.values(), ids=models.keys())


def seen(simulation: asp.Simulation) -> list[bytes]:
    """What a simulation shows, bit by bit."""
    names = ["drive", "time", "force", "forces", "positions", "energy"]
    return [np.asarray(getattr(simulation, name)).tobytes() for name in names if hasattr(simulation, name)]


@cases(INTERFACES | BLOCKS)
def test_events_are_those_of_a_drive(model: Any) -> None:
    catalogue = model.drive(6.0, 2).events
    simulation = model.simulation()
    assert simulation.model == model
    assert simulation.drive == pytest.approx(0.0, abs=1e-12)
    events = []
    for event in simulation.events(until=6.0):
        assert simulation.drive == event.drive
        events.append(event)
    np.testing.assert_array_equal(events, list(catalogue))
    assert len(events) > 1
    assert simulation.drive == 6.0
    assert list(simulation.events(until=6.0)) == []


def test_cells_in_time_slip_as_in_a_drive() -> None:
    simulation = AGED.simulation(velocity=1e-2)
    catalogue = AGED.drive(8.0, 2, velocity=1e-2).events
    assert catalogue is not None
    np.testing.assert_array_equal(list(simulation.events(until=8.0)), list(catalogue))
    assert simulation.time == pytest.approx(800.0)
    state = simulation.state()
    simulation.advance(9.0)
    shown = seen(simulation)
    simulation.restore(state)
    simulation.advance(9.0)
    assert seen(simulation) == shown


def slow_block(contacts: asp.Transport | asp.Ensemble, slip: asp.Damped | asp.Inertial) -> asp.Block:
    return asp.Block(contacts, 0.3, slip)


IN_TIME = {
    "damped": slow_block(asp.Transport(AGEING), asp.Damped(0.01)),
    "inertial": slow_block(asp.Transport(AGEING), asp.Inertial(1e-3, 1e-3)),
    "followed": slow_block(asp.Ensemble(AGEING, size=300), asp.Damped(0.01)),
    "interface": AGED,
}


@cases({name: model for name, model in IN_TIME.items() if name != "interface"})
def test_a_block_in_time_slips_as_along_steps(model: asp.Block) -> None:
    simulation = model.simulation(velocity=0.1)
    events = list(simulation.events(until=4.0))
    simulation.hold(30.0)
    simulation.velocity = 0.5
    events += list(simulation.events(until=7.0))
    steps = [asp.Step(0.1, duration=40.0), asp.Step(0.0, duration=30.0), asp.Step(0.5, duration=6.0)]
    followed = model.follow(steps)
    expected = followed.events
    assert len(events) == len(expected) > 0
    # Points of the trace that `follow` asks for end steps, so that results agree within the tolerance of
    # steps, 1e-4 of the mean threshold, and for few contacts within the effect of one break.
    digits = 0.02 if model is IN_TIME["followed"] else 2e-3
    np.testing.assert_allclose([e.drop for e in events], expected["drop"], atol=digits)
    assert simulation.drive == 7.0
    assert simulation.time == pytest.approx(76.0, rel=1e-12)
    np.testing.assert_allclose(simulation.force, followed.force[-1], atol=digits)
    balance = simulation.energy
    assert isinstance(balance, asp.Energy)
    stored = balance.spring + balance.elastic + balance.kinetic - balance.strengthening
    lost = balance.breaks + balance.slip + balance.viscous
    # The energy balance closes to the error of steps.
    np.testing.assert_allclose(balance.work, stored + lost, atol=5e-3)


@cases({"cohorts": asp.Transport(AGEING), "one by one": asp.Ensemble(AGEING, size=300)})
def test_contacts_in_time_have_the_force_of_a_protocol(model: asp.Transport | asp.Ensemble) -> None:
    simulation = model.simulation(velocity=0.1)
    forces = []
    for stop in [0.5, 1.5]:
        assert list(simulation.events(until=stop)) == []
        forces.append(simulation.force)
    simulation.hold(20.0)
    assert simulation.velocities == [0.0]
    forces.append(simulation.force)
    simulation.velocity = 1.0
    state = simulation.state()
    for _ in range(2):
        simulation.restore(state)
        simulation.advance(2.0)
    forces.append(simulation.force)
    assert simulation.velocities == [1.0]
    # Stops are exact, although the contacts are moved by rounded steps.
    for stop in np.linspace(2.0, 2.1, 23)[1:]:
        simulation.advance(stop)
        simulation.advance(stop)
        assert simulation.drive == stop
    simulation.restore(state)
    simulation.advance(2.0)
    assert simulation.time == pytest.approx(35.5, rel=1e-12)
    steps = [asp.Step(0.1, distance=0.5, points=2), asp.Step(0.1, distance=1.0, points=2)]
    steps += [asp.Step(hold=20.0, points=2), asp.Step(1.0, distance=0.5, points=2)]
    followed = asp.Transport(AGEING).follow(steps)
    # The tolerance of cohorts; for 300 contacts four standard errors of the mean stretch, 0.6/√300.
    digits = 1e-5 if isinstance(model, asp.Transport) else 0.14
    np.testing.assert_allclose(forces, followed["force"][1:], atol=digits)
    with pytest.raises(AttributeError, match="energy: not computed"):
        _ = simulation.energy


@cases(IN_TIME)
def test_a_state_in_time_is_gone_on_from_bit_for_bit(model: Any) -> None:
    simulation, other = model.simulation(velocity=0.1), model.simulation(velocity=0.1)
    simulation.advance(2.5)
    simulation.hold(3.0)
    simulation.velocity = 0.2
    state = simulation.state()
    other.restore(state)
    assert other.velocity == 0.2
    for again in [simulation, other]:
        again.advance(4.0)
        again.hold(1.0)
    assert seen(simulation) == seen(other)
    np.testing.assert_array_equal(simulation.velocities, other.velocities)


@cases(IN_TIME)
def test_a_hold_takes_time_and_moves_no_load_point(model: Any) -> None:
    simulation = model.simulation(velocity=0.1)
    simulation.advance(0.5)
    force, begun = simulation.force, simulation.time
    reported: list[float] = []
    simulation.hold(20.0, progress=reported.append)
    assert simulation.drive == 0.5
    assert simulation.time == pytest.approx(begun + 20.0, rel=1e-12)
    assert reported[-1] == 1.0
    # No contact breaks, and the spring and the contacts stay in balance.
    np.testing.assert_allclose(simulation.force, force, atol=5e-3)
    assert np.all(simulation.velocities < 1e-2)
    for wrong in [-1.0, np.nan, np.inf]:
        with pytest.raises(ValueError, match="duration: expected a finite number, 0 or above"):
            simulation.hold(wrong)
        with pytest.raises(ValueError, match="velocity: expected a finite number above 0"):
            simulation.velocity = wrong
    with pytest.raises(ValueError, match="it moves forward only"):
        simulation.advance(0.1)
    assert simulation.drive == 0.5


def test_breaks_of_an_ensemble_are_those_of_a_pull() -> None:
    ensemble = asp.Ensemble(CONTACTS, size=200)
    pull = ensemble.pull(5.0, 2)
    simulation = ensemble.simulation()
    events = list(simulation.events(5.0))
    assert sum(round(200 * event.broken_fraction) for event in events) == pull.breaks
    assert simulation.force == pytest.approx(pull.force[-1], abs=1e-13)


def test_contacts_of_a_master_equation_are_those_of_a_pull() -> None:
    pull, simulation = SOLVED.pull(5.0), SOLVED.simulation()
    for drive in [0.5, 1.1, 3.0]:
        simulation.advance(drive)
        assert simulation.force == pytest.approx(pull(drive), abs=1e-13)
        found = simulation.stretch_density()
        expected = pull.stretch_density(drive, found.stretch)
        # A density has less digits than the force: cells of two solutions differ.
        np.testing.assert_allclose(found.density, expected.density, rtol=0, atol=1e-8)


@cases(BLOCKS | {"lattice": INTERFACES["lattice"], "ensemble": ALL["ensemble"]})
def test_two_parts_of_a_way_are_the_whole(model: Any) -> None:
    whole, parts = model.simulation(), model.simulation()
    whole.advance(4.0)
    for drive in np.linspace(0.0, 4.0, 23):
        parts.advance(drive)
        assert parts.drive == drive
    parts.advance(4.0)
    assert seen(parts) == seen(whole)


@pytest.mark.parametrize("name", ["overdamped", "reset", "viscous", "followed", "half-space"])
def test_two_parts_of_the_way_of_an_interface_are_the_whole(name: str) -> None:
    model = INTERFACES[name]
    whole, parts = model.simulation(), model.simulation()
    whole.advance(4.0)
    parts.advance(2.5)
    parts.advance(4.0)
    # Balance is lost within the tolerance of the drive, near folds at its square root.
    np.testing.assert_allclose(parts.positions, whole.positions, rtol=0, atol=1e-4)
    np.testing.assert_allclose(parts.forces, whole.forces, rtol=0, atol=1e-4)
    points = model.drive(4.0, 9)
    stops = model.simulation()
    for drive, force in zip(points["drive"], points.force, strict=True):
        stops.advance(drive)
        assert stops.force == force


@cases(ALL)
def test_a_state_is_gone_on_from_bit_for_bit(model: Any) -> None:
    simulation, other = model.simulation(), model.simulation()
    for stop, end in [(1.3, 2.9), (3.1, 4.0)]:
        simulation.advance(stop)
        state = simulation.state()
        assert isinstance(state, bytes)
        here = seen(simulation)
        events = list(simulation.events(end))
        there = seen(simulation)
        for again in [simulation, other]:
            again.restore(state)
            assert seen(again) == here
            np.testing.assert_array_equal(list(again.events(end)), events)
            assert seen(again) == there
            assert again.state() == simulation.state()


@cases(BLOCKS | {"master equation": SOLVED, "ensemble": ALL["ensemble"]})
def test_sliders_turn(model: Any) -> None:
    simulation = model.simulation()
    simulation.advance(3.0)
    simulation.advance(1.5)
    assert simulation.drive == 1.5
    state = simulation.state()
    shown = [seen(simulation)]
    simulation.advance(2.5)
    shown.append(seen(simulation))
    simulation.restore(state)
    assert seen(simulation) == shown[0]
    simulation.advance(2.5)
    assert seen(simulation) == shown[1]
    # Energies are sums over intervals of forces that are solved to 1e-10.
    assert simulation.energy.imbalance == pytest.approx(0.0, abs=1e-9)


def test_a_block_turns_as_in_a_drive() -> None:
    block = BLOCKS["followed"]
    simulation = block.simulation()
    events = [event for turn in [3.0, 1.0, 4.0] for event in simulation.events(turn)]
    np.testing.assert_array_equal(events, list(block.drive(turning_points=[3.0, 1.0, 4.0]).events))


@cases(ALL)
def test_stretches_add_up_to_one_and_carry_the_force(model: Any) -> None:
    simulation = model.simulation()
    simulation.advance(2.7)
    cells = simulation.forces.size if isinstance(model, asp.Interface) else 1
    fine = np.arange(-0.5, 2.0, 1e-4)
    for cell in range(cells):
        found = simulation.stretch_density(cell)
        assert not isinstance(found.atoms, list)
        if found.atoms.weight.size == 0 and np.ptp(np.diff(found.stretch)) < 1e-12:
            width, close = np.diff(found.stretch)[0], 1e-9
        else:
            found, width, close = simulation.stretch_density(cell, fine), 1e-4, 1e-3
        assert not isinstance(found.atoms, list)
        (x, q), (at, weight) = found[:2], found.atoms
        # Jumps of a density lie between two stretches.
        assert np.sum(q) * width + weight.sum() == pytest.approx(1.0, abs=close)
        force = simulation.forces.ravel()[cell] if cells > 1 else simulation.force
        # Contacts in a bin are half its width from its middle, or less.
        mean = np.sum(q * x) * width + np.sum(weight * at)
        assert mean == pytest.approx(force, abs=0.5 * width + 1e-3)


def test_few_contacts_are_atoms_at_stretches() -> None:
    simulation = asp.Ensemble(CONTACTS, size=40).simulation()
    simulation.advance(1.7)
    atoms = simulation.stretch_density(stretches=[0.5]).atoms
    assert not isinstance(atoms, list)
    assert np.sum(atoms.weight * atoms.position) == pytest.approx(simulation.force, abs=1e-12)
    binned = simulation.stretch_density(edges=[0.0, 0.5, 2.0])
    expected = [atoms.weight[atoms.position < 0.5].sum(), atoms.weight[atoms.position >= 0.5].sum()]
    np.testing.assert_allclose(binned.density * [0.5, 1.5], expected)


@pytest.mark.parametrize(
    ("refused", "error", "message"),
    [
        (lambda s: s.advance(0.5), ValueError, "drive: expected a finite drive, 1 or above"),
        (lambda s: s.events(0.5), ValueError, "until: expected a finite drive, 1 or above"),
        (lambda s: s.advance(np.inf), ValueError, "drive: expected a finite drive, 1 or above"),
        (lambda s: s.stretch_density(6), IndexError, "cell: expected a number below 6, got 6"),
        (lambda s: s.stretch_density(0, [0.1], edges=[0.0, 1.0]), ValueError, "stretches: expected either"),
        (lambda s: s.stretch_density(0, edges=[0.0, 1.0]), ValueError, "edges: expected None where contacts"),
        (lambda s: s.restore(b"nothing"), ValueError, "state: expected bytes that Simulation.state"),
        (
            lambda s: s.restore(BLOCKS["solved"].simulation().state()),
            ValueError,
            "state: expected that of a simulation of the same model, got that of another",
        ),
        (lambda s: s.restore(s.state()[:-9]), ValueError, "state: expected bytes that Simulation.state"),
    ],
)
def test_what_makes_no_sense_is_refused(
    refused: Callable[[asp.Simulation], object], error: type[Exception], message: str
) -> None:
    simulation = INTERFACES["overdamped"].simulation()
    simulation.advance(1.0)
    before = seen(simulation)
    with pytest.raises(error, match=message):
        refused(simulation)
    assert seen(simulation) == before


def test_what_a_model_has_not_is_refused() -> None:
    lattice = INTERFACES["lattice"].simulation()
    with pytest.raises(AttributeError, match="positions: contacts coupled one by one"):
        _ = lattice.positions
    with pytest.raises(AttributeError, match="energy: "):
        _ = lattice.energy
    for name in ["velocity", "velocities"]:
        with pytest.raises(AttributeError, match=f"{name}: no time passes in this model"):
            getattr(lattice, name)
    with pytest.raises(AttributeError, match="hold: no time passes in this model"):
        lattice.hold(1.0)
    with pytest.raises(IndexError, match="cell: expected a number below 1, got 1"):
        lattice.stretch_density(1)
    with pytest.raises(ValueError, match=r"drive\.velocity: expected a velocity above 0"):
        AGED.simulation()
    with pytest.raises(ValueError, match=r"block\.model: expected a MasterEquation or an Ensemble"):
        asp.Block(asp.Transport(AGEING), 1.0, asp.Damped(1.0)).simulation()
    with pytest.raises(ValueError, match=r"block\.model: expected a Transport or an Ensemble"):
        asp.Block(SOLVED, 1.0, asp.Damped(1.0)).simulation(velocity=1.0)
    with pytest.raises(ValueError, match="slip: expected damped or inertial"):
        asp.Block(asp.Transport(AGEING), 1.0, "arrest").simulation(velocity=1.0)
    forward = asp.MasterEquation(AGEING, velocity=1e-2).simulation()
    forward.advance(1.0)
    with pytest.raises(ValueError, match="drive: expected motion one way"):
        forward.advance(0.5)
    assert forward.drive == 1.0


def test_a_simulation_at_work_is_left_alone() -> None:
    simulation = INTERFACES["overdamped"].simulation()
    refused = []

    def look(fraction: float) -> None:
        with pytest.raises(RuntimeError, match="simulation: expected one that is not at work"):
            _ = simulation.drive
        refused.append(fraction)

    simulation.advance(4.0, progress=look)
    assert refused[-1] == 1.0 if refused else True


LONG = {
    "interface": asp.Interface(
        CONTACTS, [64, 64], connection=0.5, half_space=(1.0, 1.0), disorder=0.2, slip="overdamped"
    ),
    "lattice": asp.Lattice(
        CONTACTS, [128, 128], asp.Rectangular(0.0, 0.5), neighbours=0.249, connection=0.004
    ),
    "block": asp.Block(asp.Ensemble(CONTACTS, size=300_000), 0.3, "overdamped"),
    # Contacts that stay in phase over 50 000 mean thresholds.
    "inertial block": asp.Block(
        asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 1e-3))), 0.3, asp.Inertial(1.0)
    ),
    "ensemble": asp.Ensemble(CONTACTS, size=300_000),
}


def interrupted(work: Callable[[], object], after: float) -> float:
    """Seconds from a Ctrl-C to the end of the work."""
    sent: list[float] = []

    def send() -> None:
        sent.append(time.perf_counter())
        main = threading.main_thread().ident
        assert main is not None
        signal.pthread_kill(main, signal.SIGINT)

    timer = threading.Timer(after, send)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        signal.signal(signal.SIGINT, before)
    return time.perf_counter() - sent[0]


@cases(LONG)
def test_ctrl_c_leaves_a_simulation_that_goes_on(model: Any) -> None:
    simulation, whole = model.simulation(), model.simulation()
    # On a machine that does other things, the best of some.
    assert any(interrupted(lambda: simulation.advance(1e7), 0.3) < SOON for _ in range(5))
    assert 0.0 <= simulation.drive < 1e7
    state, here = simulation.state(), seen(simulation)
    end = simulation.drive + 1e-3
    simulation.advance(end)
    assert simulation.drive == end
    whole.restore(state)
    assert seen(whole) == here
    whole.advance(end)
    assert seen(whole) == seen(simulation)


def test_progress_is_reported() -> None:
    reported: list[float] = []
    model = INTERFACES["half-space"].replace(cells=[24, 24])
    model.simulation().advance(6.0, progress=reported.append)
    assert reported[-1] == 1.0
    assert reported == sorted(reported)


def test_events_of_one_slide_are_each_returned_once() -> None:
    events = MANY.drive(8.0, points=2).events
    assert events is not None
    drives = events["drive"]
    place = int(np.flatnonzero(np.diff(drives) == 0.0)[0])
    simulation = MANY.simulation()
    # A new iterator for each event goes on with the next one.
    first = [next(simulation.events(until=8.0)).drive for _ in range(place + 1)]
    np.testing.assert_array_equal(first, drives[: place + 1])
    state = simulation.state()
    rest = [event.drive for event in simulation.events(until=8.0)]
    np.testing.assert_array_equal(rest, drives[place + 1 :])
    simulation.restore(state)
    assert [event.drive for event in simulation.events(until=8.0)] == rest
    # What has happened before an advance is not returned after it.
    simulation.restore(state)
    simulation.advance(drives[place] + 1e-6)
    assert next(simulation.events(until=8.0)).drive == drives[place + 2]
