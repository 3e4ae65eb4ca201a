"""Results are values, too: they are copied and go to other processes, with every bit of their numbers."""

import concurrent.futures
import copy
import multiprocessing
import pickle
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
import pytest

CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.05))
THEORY = asp.MasterEquation(CONTACTS, asp.Gaussian(0.1, 0.025))
ENSEMBLE = asp.Ensemble(CONTACTS, size=100)
PULL = THEORY.pull(3.0, 31)
SCENARIO = {
    "contacts": {"thresholds": asp.Gaussian(1.0, 0.05)},
    "block": {"stiffness": 1.0},
    "drive": {"distance": 5.0},
    "units": {"length": "µm"},
}
HOLDS = [1.0, 3.0, 10.0, 30.0, 100.0]
STEP = np.concatenate([np.linspace(-1.0, 0.0, 11), np.linspace(0.1, 4.0, 40)])
MEASURED = np.where(STEP < 0.0, 1.0, 1.0 + 0.02 * np.exp(-STEP)) + 1e-4 * np.sin(37.0 * STEP)

RECORDS: dict[str, Callable[[], asp.Record]] = {
    "result": lambda: asp.run(SCENARIO),
    "pull": lambda: PULL,
    "ensemble pull": lambda: ENSEMBLE.pull(3.0, 31, snapshots=[1.0]),
    "stick-slip": lambda: asp.Block(ENSEMBLE, 1.0, asp.Inertial(1.0)).drive(5.0),
    "motion": lambda: asp.Transport(CONTACTS.replace(delay=0.1)).follow([asp.Step(1.0, distance=2.0)]),
    "interface": lambda: asp.Interface(CONTACTS, [8], connection=0.5, neighbours=1.0).drive(3.0, maps=[1.0]),
}


def bits(values: Any) -> Any:
    array = np.asarray(values)
    return array.view(np.uint64) if array.dtype == np.float64 else array


def same(one: asp.Record, other: asp.Record) -> None:
    assert type(one) is type(other)
    assert list(one) == list(other)
    for name in one:
        np.testing.assert_array_equal(bits(one[name]), bits(other[name]), err_msg=name)
        assert not other[name].flags.writeable
    assert one.labels == other.labels
    assert repr(one) == repr(other)


@pytest.mark.parametrize("made", RECORDS.values(), ids=RECORDS)
@pytest.mark.parametrize(
    "copied",
    [lambda one: pickle.loads(pickle.dumps(one)), copy.copy, copy.deepcopy],
    ids=["pickle", "copy", "deepcopy"],
)
def test_records_are_copied_bit_for_bit(made: Callable[[], asp.Record], copied: Callable[[Any], Any]) -> None:
    record = made()
    same(record, copied(record))


def test_results_keep_their_summary() -> None:
    result = asp.run(SCENARIO)
    again = pickle.loads(pickle.dumps(result))
    assert (again.summary, again.scenario, again.title) == (result.summary, result.scenario, result.title)
    assert again.labels["position"].units == "µm"


def test_a_pull_is_solved_again_where_its_arrays_are_not_enough() -> None:
    again = pickle.loads(pickle.dumps(PULL))
    at = np.linspace(0.0, PULL.distance, 101)
    np.testing.assert_array_equal(bits(again.force_at(at)), bits(PULL.force_at(at)))
    np.testing.assert_array_equal(again.slope_at(at), PULL.slope_at(at))
    np.testing.assert_array_equal(again.force_std(10), PULL.force_std(10))
    assert again.equation == PULL.equation
    for name in ("static_friction", "kinetic_friction", "critical_stiffness", "accuracy", "distance"):
        assert getattr(again, name) == getattr(PULL, name)


def test_sliders_keep_their_numbers() -> None:
    run = asp.Block(asp.MasterEquation(CONTACTS), 1.0).drive(5.0)
    again = pickle.loads(pickle.dumps(run))
    for name in ("block", "regime", "reason", "period", "first_instability", "runaway", "energy"):
        assert getattr(again, name) == getattr(run, name)
    assert list(again.events) == list(run.events)


@pytest.mark.parametrize(
    ("made", "read"),
    [
        (THEORY.steady_state, lambda one: (one.kinetic_friction, one.breaking_rate, one.force_std(10))),
        (THEORY.relaxation, lambda one: (*one.roots, one.length, one.force(one.valid_from + 1.0))),
        (lambda: PULL.gradient("thresholds.mean"), lambda one: (one.parameter, one(1.0))),
        (
            lambda: PULL.friction_gradient("thresholds.mean"),
            lambda one: (one.static_friction, one.kinetic_friction, one.critical_stiffness),
        ),
        (
            lambda: asp.MasterEquation(CONTACTS).pull(2.0).threshold_response([0.9, 1.1]),
            lambda one: (*one.thresholds, *one(1.0)),
        ),
        (
            lambda: asp.read_velocity_step(STEP, MEASURED, 10.0, noise="white"),
            lambda one: (one.a, one.b, one.distance, one.noise, one(1.0)),
        ),
        (
            lambda: asp.read_healing(HOLDS, [1.0 + 0.01 * np.log1p(t) + 1e-4 * np.sin(t) for t in HOLDS]),
            lambda one: (one.per_decade, one.cutoff, one.residual, one(2.0), *one.hold, *one.force),
        ),
    ],
    ids=["steady", "relaxation", "gradient", "friction", "response", "step", "healing"],
)
def test_other_results_are_copied(made: Callable[[], Any], read: Callable[[Any], Any]) -> None:
    found = made()
    assert type(pickle.loads(pickle.dumps(found))) is type(found)
    assert read(pickle.loads(pickle.dumps(found))) == read(copy.deepcopy(found)) == read(found)


def test_events_are_copied() -> None:
    lattice = asp.Lattice(CONTACTS, [16, 16], neighbours=0.2, connection=0.2)
    for events in (asp.Block(THEORY, 1.0).drive(5.0).events, lattice.drive(3.0).events):
        assert events is not None
        again = pickle.loads(pickle.dumps(events))
        assert again.columns == events.columns
        assert list(again) == list(events)
        assert pickle.loads(pickle.dumps(events[0])) == events[0]


def pulled(std: float) -> asp.Pull:
    return asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, std))).pull(2.0, 21)


def test_a_pool_of_processes_returns_results() -> None:
    widths = [0.05, 0.1]
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
        for found, std in zip(pool.map(pulled, widths), widths, strict=True):
            same(found, pulled(std))


def test_joblib_returns_results() -> None:
    joblib = pytest.importorskip("joblib")
    for found in joblib.Parallel(n_jobs=2)(joblib.delayed(pulled)(std) for std in (0.05, 0.1)):
        assert found.force.shape == (21,)


def test_pickles_of_another_version_are_refused() -> None:
    restore, (version, *rest) = PULL.__reduce__()
    assert version == asp.__version__
    with pytest.raises(ValueError, match=f"written by asperity {version}, got one of asperity 0.0.9"):
        restore("0.0.9", *rest)


@pytest.mark.parametrize("made", RECORDS.values(), ids=RECORDS)
def test_damaged_pickles_are_refused(made: Callable[[], asp.Record]) -> None:
    restore, (version, kind, content, model) = made().__reduce__()
    # The length of the head, the head, a value, the checksum.
    for place in (0, 40, len(content) - 12, len(content) - 1):
        damaged = bytearray(content)
        damaged[place] ^= 1
        with pytest.raises(ValueError, match="pickle: expected the bytes that asperity wrote, got others"):
            restore(version, kind, bytes(damaged), model)
    for short in (b"", content[:3], content[: len(content) // 2]):
        with pytest.raises(ValueError, match="pickle: expected the bytes that asperity wrote"):
            restore(version, kind, short, model)
    with pytest.raises(ValueError, match='got a "Simulation"'):
        restore(version, "Simulation", content, model)
    if model is not None:
        with pytest.raises(ValueError, match="a result without its model"):
            restore(version, kind, content, None)
        with pytest.raises(ValueError, match="a result with another model"):
            restore(version, kind, content, asp.Point(1.0))


def test_the_kind_of_a_pickle_is_checked() -> None:
    # The bytes of a result under the name of another class.
    restore, (version, _, content, _) = asp.run(SCENARIO).__reduce__()
    for kind in ("StickSlip", "Healing", "Posterior", "VelocityStep"):
        with pytest.raises(ValueError, match="pickle: expected"):
            restore(version, kind, content, asp.Block(THEORY, 1.0))


def fitted() -> asp.Estimates:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), count=500, stiffness=0.002)
    at = np.linspace(0.05, 2.0, 40)
    force = asp.MasterEquation(contacts).pull(2.0).sample_paths(at, 1, size=500, seed=3)[0]
    free = ["thresholds.mean", "thresholds.std"]
    return asp.fit(contacts, at, force, free=free, reading=1e-4, laws=["gamma"], compliance=0.01)


def fitted_steadily() -> asp.SteadyEstimates:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=2000, stiffness=0.0005)
    force = asp.Ensemble(contacts, size=2000, seed=1).pull(40.0, 1601).force[400:]
    return asp.fit_steady(contacts, 0.025, force, free=["thresholds.mean"], reading=1e-5)


def fitted_to_velocities() -> asp.VelocityCurveEstimates:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), delay=0.5)
    return asp.fit_velocity_curve(
        contacts, [0.1, 1.0, 10.0], [0.488, 0.349, 0.092], free=["delay"], error=[0.002, 0.003, 0.002]
    )


@pytest.mark.parametrize("made", [fitted, fitted_steadily, fitted_to_velocities])
def test_fits_are_pickled_with_all_their_numbers(made: Callable[[], Any]) -> None:
    found = made()
    again = pickle.loads(pickle.dumps(found))
    assert type(again) is type(found)
    for name in (
        "params",
        "correlations",
        "converged",
        "solutions",
        "misfit",
        "reading",
        "model",
        "contacts",
    ):
        assert getattr(again, name) == getattr(found, name), name
    np.testing.assert_array_equal(bits(again.covariance), bits(found.covariance))
    assert repr(again) == repr(found)
    assert again.summary() == found.summary()
    assert copy.copy(found) is found
    assert copy.deepcopy(found) is found
    # What the search is needed for is found by the same search, made again.
    if not isinstance(found, asp.VelocityCurveEstimates):
        assert again.friction() == found.friction()
    name = next(iter(found.params))
    assert again.interval_by_profile(name) == found.interval_by_profile(name)
    # An object from a pickle travels further.
    assert pickle.loads(pickle.dumps(again)).params == found.params


def test_a_pickled_fit_has_its_readings_and_other_distributions() -> None:
    found = fitted()
    again = pickle.loads(pickle.dumps(found))
    same(found.readings, again.readings)
    same(found.pull, again.pull)
    assert list(again.laws) == ["gamma"]
    assert again.laws["gamma"].params == found.laws["gamma"].params
    at = [0.5, 1.0]
    np.testing.assert_array_equal(
        again.laws["gamma"].predict(at).force, found.laws["gamma"].predict(at).force
    )
    restore, (version, *rest) = found.__reduce__()
    with pytest.raises(ValueError, match=f"written by asperity {version}, got one of asperity 0.0.9"):
        restore("0.0.9", *rest)
    with pytest.raises(ValueError, match="a fit with other parts"):
        restore(version, *rest[:-1], (1, 2))
