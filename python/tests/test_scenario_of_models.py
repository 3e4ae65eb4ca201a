"""The scenario of a model and a task: what it computes is what the methods of the model compute."""

import asperity as asp
import numpy as np
import pytest

CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.1), reforming=asp.Gaussian(0.1, 0.02))
AGEING = CONTACTS.replace(ageing=asp.Logarithmic(growth=0.1, time=1.0))


def test_a_pull_is_that_of_the_model_to_the_bit() -> None:
    model = asp.MasterEquation(CONTACTS, asp.Gaussian(0.1, 0.02), start="relaxed", tolerance=1e-9)
    scenario = asp.scenario(model, pull={"distance": 5.0, "points": 51})
    assert scenario["pull"]["start"] == "relaxed"
    assert scenario["master_equation"] == {"tolerance": 1e-9}
    np.testing.assert_array_equal(asp.run(scenario).force, model.pull(5.0, 51).force)


def test_velocity_and_start_are_those_of_the_model_unless_the_task_has_its_own() -> None:
    model = asp.Transport(AGEING, velocity=0.5, start="steady")
    assert asp.scenario(model, pull={})["pull"] == {"velocity": 0.5, "start": "steady"}
    assert asp.scenario(model, drive={"velocity": 2.0})["drive"] == {"velocity": 2.0, "start": "steady"}
    steps = [{"velocity": 1.0, "distance": 2.0}, {"hold": 3.0}]
    assert [step.get("start") for step in asp.scenario(model, protocol=steps)["protocol"]] == ["steady", None]
    assert "start" not in steps[0]


def test_blocks_and_interfaces() -> None:
    block = asp.Block(asp.MasterEquation(CONTACTS), stiffness=1.0, slip="arrest")
    drive = {"distance": 20.0, "points": 41}
    result = asp.run(asp.scenario(block, drive=drive))
    np.testing.assert_array_equal(result["force"], block.drive(20.0, 41)["force"])
    chain = asp.Interface(CONTACTS, [4], neighbours=1.0, connection=0.5, disorder=0.1, seed=3)
    result = asp.run(asp.scenario(chain, drive=drive))
    np.testing.assert_array_equal(result["force"], chain.drive(20.0, 41)["force"])
    lattice = asp.Lattice(CONTACTS, [8, 8], neighbours=0.025, connection=0.9, seed=3)
    result = asp.run(asp.scenario(lattice, drive=drive))
    np.testing.assert_array_equal(result["force"], lattice.drive(20.0, 41)["force"])
    sample = asp.Ensemble(CONTACTS, size=1000, seed=5)
    result = asp.run(asp.scenario(sample, pull={"distance": 3.0, "points": 31}))
    np.testing.assert_array_equal(result["ensemble_force"], sample.pull(3.0, 31).force)


def test_models_are_swept() -> None:
    pytest.importorskip("xarray")
    block = asp.Block(asp.MasterEquation(CONTACTS), stiffness=1.0, slip="arrest")
    task = {"drive": {"distance": 20.0}}
    data = asp.sweep(block, {"block.stiffness": [0.5, 8.0]}, ["slips"], task=task)
    expected = [block.replace(stiffness=k).drive(20.0)["event_drive"].size for k in (0.5, 8.0)]
    assert data.slips.values.tolist() == expected
    assert expected[0] > 0


def test_axes_of_a_dictionary_keep_their_order() -> None:
    pytest.importorskip("xarray")
    scenario = asp.scenario(CONTACTS, pull={"distance": 2.0})
    axes = {"pull.distance": [1.0, 2.0], "contacts.thresholds.gaussian.std": [0.1, 0.2]}
    data = asp.sweep(scenario | {"sweep": {"over": axes, "keep": ["kinetic_friction"]}})
    assert data.kinetic_friction.dims == ("pull_distance", "contacts_thresholds_gaussian_std")


def test_wrong_input() -> None:
    steady = asp.Transport(AGEING, velocity=0.5, start="steady")
    with pytest.raises(ValueError, match='start: expected "conditional", except for a pull'):
        asp.scenario(steady, velocity_curve={"from": 0.1, "to": 1.0})
    with pytest.raises(
        TypeError, match="model: expected contacts, a model, a block or an interface, got Gaussian"
    ):
        asp.scenario(asp.Gaussian(1.0, 0.1))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="task: expected a model beside it, got dict"):
        asp.sweep({}, {"a": [1]}, task={"pull": {}})
    with pytest.raises(TypeError, match="pull: expected a table, a list, a number or a text, got set"):
        asp.scenario(CONTACTS, pull={1, 2})
    for table in (3, {"over": 3}):
        with pytest.raises(ValueError, match="sweep"):
            asp.sweep(asp.scenario(CONTACTS, pull={}) | {"sweep": table})
