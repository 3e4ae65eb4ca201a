"""What results are as tables and as labelled arrays, and what they say of themselves."""

import inspect
import math
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest
from test_descriptions import ALL

ROOT = Path(__file__).parents[2]
CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.05))
LATTICE = asp.Lattice(CONTACTS, [16, 16], neighbours=0.2, connection=0.2)
RULES = [
    asp.Temperature(0.1, 1.0, barrier="bell"),
    asp.Smoluchowski(asp.Gaussian(1.0, 0.1), 0.5),
    asp.FrozenRank(asp.Gaussian(1.0, 0.1), 0.5),
    asp.Logarithmic(0.1, 0.5),
    asp.MeanField(asp.Gaussian(1.0, 0.1), 0.5),
    asp.Step(1.0, duration=2.0, velocity_to=3.0, points=11, pieces=7),
    asp.Step(hold=2.0),
    asp.Step(1.0, distance=2.0, relative_normal_load=0.5),
    LATTICE,
    asp.Interface(CONTACTS, [8], connection=0.5, neighbours=1.0, disorder=0.1, seed=3),
    asp.Interface(
        CONTACTS, [4, 4], connection=0.5, half_space=(1.0, 2.0), edges="periodic", size=10, slip="overdamped"
    ),
    asp.Interface(CONTACTS, [3], connection=0.5, neighbours=1.0, disorder=[0.9, 1.0, 1.1]),
    asp.Transport(CONTACTS, tolerance=1e-4),
]
DESCRIPTIONS = [one for one in [*ALL, *RULES] if not isinstance(one, asp.Law)]


@pytest.mark.parametrize("description", DESCRIPTIONS, ids=lambda one: type(one).__name__)
def test_every_argument_is_an_attribute(description: asp.Description) -> None:
    given = description.parameters
    for name, parameter in inspect.signature(type(description)).parameters.items():
        value = getattr(description, name)
        if name in given:
            # A rigid block is described without a stiffness, and has an infinite one.
            expected = math.inf if given[name] is None else given[name]
            assert np.array_equal(value, expected) or value == expected, name
        elif not isinstance(parameter.default, int | float | str):
            assert value is None or isinstance(value, float | int | str | asp.Law), name
        else:
            assert value == parameter.default, name


def test_the_stiffness_of_contacts_is_reported() -> None:
    assert (CONTACTS.stiffness, CONTACTS.stiffness_per_threshold) == (1.0, None)
    proportional = asp.Contacts(asp.Gaussian(1.0, 0.05), stiffness_per_threshold=2.0)
    assert (proportional.stiffness, proportional.stiffness_per_threshold) == (None, 2.0)
    table = (np.array([0.5, 1.5]), [1.0, 3.0])
    tabulated = asp.Contacts(asp.Gaussian(1.0, 0.05), stiffness_of_threshold=table)
    assert tabulated.stiffness is None
    assert tabulated.stiffness_of_threshold == ([0.5, 1.5], [1.0, 3.0])
    with pytest.raises(ValueError, match=r"stiffness_of_threshold\.threshold: expected thresholds that rise"):
        asp.Contacts(asp.Gaussian(1.0, 0.05), stiffness_of_threshold=([1.0, 1.0], [1.0, 2.0]))
    warm = tabulated.replace(temperature=asp.Temperature(energy=0.01, attempt_rate=1.0))
    with pytest.raises(ValueError, match="no table beside temperature"):
        asp.MasterEquation(warm, velocity=1.0)


def test_events_are_a_table() -> None:
    events = LATTICE.drive(3.0).events
    assert events is not None
    assert tuple(events.keys()) == events.columns
    assert events["epicentre"].dtype == np.int64
    large = events[events["size"] > 10]
    assert len(large) == np.count_nonzero(events["size"] > 10) > 0
    assert min(large["size"]) > 10
    np.testing.assert_array_equal(events[[2, 0]]["drive"], events["drive"][[2, 0]])
    np.testing.assert_array_equal(events[np.array([1, -1])]["drive"], events["drive"][[1, -1]])
    assert len(events[[]]) == 0
    assert list(events[1:3]) == [events[1], events[2]]
    assert isinstance(events[0].epicentre, int)  # type: ignore[attr-defined]
    assert events[-1].drive == events["drive"][-1]


@pytest.mark.parametrize(
    ("key", "error", "text"),
    [
        ("velocity", KeyError, "expected one of drive, .* got velocity"),
        ([True, False], IndexError, "expected a mask of .* values, one for each event, got 2"),
        (np.array([0.5]), TypeError, "expected a name, a number, a mask or numbers of events, got float64"),
        ([10**6], IndexError, "out of bounds"),
        (10**6, IndexError, "out of bounds"),
    ],
)
def test_wrong_keys_of_events_are_refused(key: Any, error: type[Exception], text: str) -> None:
    events = LATTICE.drive(3.0).events
    assert events is not None
    with pytest.raises(error, match=text):
        events[key]


def test_events_go_to_pandas() -> None:
    pytest.importorskip("pandas")
    events = LATTICE.drive(3.0).events
    assert events is not None
    table = events.to_pandas()
    assert tuple(table.columns) == events.columns
    assert len(table) == len(events)
    assert table["cells"].dtype == np.int64
    np.testing.assert_array_equal(table["drop"].to_numpy(), events["drop"])


def test_events_without_pandas_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    events = LATTICE.drive(3.0).events
    assert events is not None
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        events.to_pandas()


def fast(name: str, **overrides: Any) -> asp.Result:
    return asp.run(ROOT / "scenarios" / f"{name}.toml", overrides)


XARRAY: dict[str, dict[str, Any]] = {
    "fig2": {"ensemble.size": 100},
    "identical": {},
    "compared": {},
    "spectrum": {"ensemble.size": 100},
    "velocity-step": {},
    "stick-slip-inertial": {},
    "hysteresis": {"ensemble.size": 100},
    "stick-slip-ageing": {},
    "front-chain": {},
    "ofc": {},
    "aftershocks": {"drive.distance": 11.0},
    "fit-cycles": {},
    "fit-steady": {},
    "fit-velocity-curve": {},
    "creep": {"creep.forces": [0.4, 0.65], "creep.duration": 1e3, "creep.points": 21},
    "healing": {"hold_curve.points": 5, "ensemble.size": 100},
    "renormalised": {"interface.cells": [30, 30], "renormalisation.runs": 2},
    "velocity-curve-thermal": {"velocity_curve.points": 3, "ensemble.size": 100},
}


@pytest.mark.parametrize("name", XARRAY)
def test_labelled_arrays_are_those_of_the_file(name: str, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    result = fast(name, **XARRAY[name])
    result.save(tmp_path / name)
    ours = result.to_xarray()
    xarray.testing.assert_identical(asp.open_result(tmp_path / name).to_xarray(), ours)
    for engine in ("netcdf4", "h5netcdf"):
        with xarray.open_dataset(tmp_path / name / "result.nc", engine=engine) as theirs:
            # Names, dimensions, values, coordinates and all attributes.
            xarray.testing.assert_identical(theirs, ours)
            assert {
                key: values.dtype.kind for key, values in theirs.variables.items() if key != "scenario"
            } == {key: values.dtype.kind for key, values in ours.variables.items() if key != "scenario"}


def test_coordinates_whole_numbers_and_flags(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    data = fast("ofc").to_xarray()
    assert {"drive", "event_drive", "map_drive", "row", "column"} <= set(data.coords)
    assert "drive" in data["force"].coords
    assert data["event_epicentre"].dtype == data["row"].dtype == np.int64
    slider = fast("stick-slip-reset").to_xarray()
    assert slider["branch_stable"].dtype == np.bool_
    assert {"drive", "event_drive", "branch_position"} <= set(slider.coords)
    assert {"time", "drive"} <= set(fast("velocity-step").to_xarray()["force"].coords)


def test_attributes_have_the_numbers_of_the_summary() -> None:
    pytest.importorskip("xarray")
    result = fast("stick-slip-reset")
    attributes = result.to_xarray().attrs
    summary = result.summary
    assert attributes["Conventions"].startswith("CF-")
    assert (attributes["title"], attributes["version"]) == (result.title, asp.__version__)
    for name in ("kinetic_friction", "regime", "slips", "period", "relaxation_length_paper"):
        assert attributes[name] == summary[name]
    assert attributes["static_friction_force"] == summary["static_friction"]["force"]
    identical = fast("identical")
    assert identical.summary["relaxation_length"] == "infinite"
    assert identical.to_xarray().attrs["relaxation_length"] == math.inf
    assert fast("fig2", **{"ensemble.size": 10}).to_xarray().attrs["seed"] == 1


def test_numbers_are_arrays_where_the_task_has_many() -> None:
    curve = fast("velocity-curve-thermal", **XARRAY["velocity-curve-thermal"])
    np.testing.assert_array_equal(curve.kinetic_friction, curve["kinetic_friction"])
    assert curve.static_friction is None
    assert math.isnan(float(np.asarray(curve.relaxation_length)))
    held = fast("healing", **XARRAY["healing"])
    np.testing.assert_array_equal(held.static_friction, held["static_friction"])
    assert held.kinetic_friction == held.summary["hold_curve"]["kinetic_friction"]
    assert fast("spectrum").kinetic_friction == fast("spectrum").summary["noise"]["kinetic_friction"]
    found = fast("fit")
    assert found.kinetic_friction == found.summary["fit"]["friction"]["kinetic_friction"]["value"]


def test_a_result_says_what_its_task_has() -> None:
    curve = repr(fast("velocity-curve-thermal", **XARRAY["velocity-curve-thermal"]))
    assert "nan" not in curve
    assert "static_friction" not in curve
    assert "relaxation_length" not in curve
    assert "healing_per_decade" in repr(fast("healing", **XARRAY["healing"]))
    assert "regime" in repr(fast("stick-slip-reset"))
    found = repr(fast("fit"))
    assert "contacts.thresholds.gaussian.mean" in found
    assert "covariance" not in found
    for name in XARRAY:
        assert "nan" not in repr(fast(name, **XARRAY[name])).split()


def test_the_package_lists_its_public_names() -> None:
    assert dir(asp) == sorted(asp.__all__)
