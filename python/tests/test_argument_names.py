"""Messages name the argument: each argument of each public callable is handed something of a wrong type."""

import inspect
import re
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest

# Results are asked for their pictures, too.
matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")

GAUSSIAN = asp.Gaussian(1.0, 0.1)
CONTACTS = asp.Contacts(GAUSSIAN)
DELAYED = asp.Contacts(GAUSSIAN, delay=0.1)
HEATED = asp.Contacts(GAUSSIAN, temperature=asp.Temperature(0.05, 1.0))
THEORY = asp.MasterEquation(CONTACTS)
BLOCK = asp.Block(THEORY, 1.0, "overdamped")
INTERFACE = asp.Interface(CONTACTS, [4], connection=1.0, neighbours=2.0)
LATTICE = asp.Lattice(CONTACTS, [4], connection=1.0, neighbours=2.0)
STEPS = [asp.Step(1.0, distance=1.0, points=5)]
POSITIONS = np.linspace(0.0, 3.0, 31)
FORCES = THEORY.pull(3.0, 31).force
SLIDING = 0.5 + 0.01 * np.sin(np.linspace(0.0, 40.0, 200))
HOLDS = np.array([1.0, 10.0, 100.0, 1000.0])
TIMES = np.linspace(0.0, 20.0, 201)
STEPPED = np.linspace(-5.0, 10.0, 301)
BLOBS = np.kron(np.eye(3), np.pad(np.ones((6, 6)), 2))


def stepped(displacement: Any) -> Any:
    """The force of a velocity step at displacement 0."""
    after = 0.01 - 0.02 * (1.0 - np.exp(-np.maximum(displacement, 0.0)))
    return 0.6 + np.where(displacement >= 0.0, after, 0.0)


def recorded() -> str:
    """A file with two velocity steps."""
    place = 1.0 * np.minimum(TIMES, 10.0) + 3.0 * np.maximum(TIMES - 10.0, 0.0)
    rows = (f"{t},{x},{f}" for t, x, f in zip(TIMES, place, stepped(place - 10.0), strict=True))
    path = Path(tempfile.mkdtemp(), "record.csv")
    path.write_text("\n".join(["time (s),displacement (mm),force (N)", *rows]), encoding="utf-8")
    return str(path)


RECORDED = recorded()


def instances() -> dict[str, Any]:
    """One object of each class that users are handed or make, by the name of the class."""
    curve = asp.fit(CONTACTS, POSITIONS, FORCES, free=["thresholds.std"])
    pull = THEORY.pull(3.0, 31)
    found = [
        GAUSSIAN,
        CONTACTS,
        THEORY,
        asp.Ensemble(CONTACTS, size=20),
        asp.Transport(DELAYED),
        BLOCK,
        INTERFACE,
        LATTICE,
        pull,
        pull.gradient("thresholds.mean"),
        pull.threshold_response([0.9, 1.1]),
        asp.Ensemble(CONTACTS, size=20).pull(2.0, 11),
        THEORY.steady_state(),
        THEORY.relaxation(),
        BLOCK.drive(3.0, 31),
        BLOCK.drive(3.0, 31).events,
        BLOCK.equilibrium(3.0, 31),
        BLOCK.potential(1.0, 3.0, 31),
        curve,
        curve.predict([1.0, 2.0]),
        asp.fit_velocity_curve(DELAYED, [0.1, 1.0, 10.0], [0.5, 0.4, 0.1], free=["count"]),
        asp.read_velocity_step(STEPPED, stepped(STEPPED), 10.0),
        asp.read_healing(HOLDS, 0.6 + 0.01 * np.log(HOLDS)),
        asp.spots(BLOBS, 0.1),
        asp.read_laboratory(RECORDED),
        asp.run({"contacts": {"thresholds": GAUSSIAN}, "pull": {"points": 11}}),
        asp.velocity_curve(HEATED, span=(0.01, 1.0), points=3),
        asp.Transport(DELAYED).simulation(velocity=1.0),
        asp.Transport(DELAYED).follow(STEPS),
        pull.friction_gradient("thresholds.mean"),
    ]
    return {type(one).__name__: one for one in found}


OBJECTS = instances()

# What is right for an argument of this name, or of this name of one callable.
RIGHT: dict[str, Any] = {
    "FrozenRank.mature": GAUSSIAN,
    "MeanField.mature": GAUSSIAN,
    "Smoluchowski.mature": GAUSSIAN,
    "Temperature.energy": 1.0,
    "Lattice.neighbours": 1.0,
    "compare.position": POSITIONS,
    "compare.force": FORCES,
    "creep.contacts": HEATED,
    "creep.forces": [0.1],
    "fit.position": POSITIONS,
    "fit.force": FORCES,
    "fit_steady.spacing": 0.01,
    "fit_steady.force": SLIDING,
    "fit_velocity_curve.velocity": [0.1, 1.0, 10.0],
    "fit_velocity_curve.force": [0.5, 0.4, 0.3],
    "fit_healing.hold": HOLDS,
    "fit_healing.force": 0.01 * np.log1p(HOLDS),
    "fit_healing.before": 0.0,
    "fit_healing.velocity": 1.0,
    "fit_healing.stiffness": 0.01,
    "fit_velocity_step.displacement": STEPPED,
    "fit_velocity_step.force": stepped(STEPPED),
    "fit_velocity_step.ratio": 10.0,
    "read_velocity_step.position": STEPPED,
    "read_velocity_step.force": stepped(STEPPED),
    "read_velocity_step.ratio": 10.0,
    "hold_curve.contacts": HEATED,
    "healing.contacts": HEATED,
    "stability.contacts": HEATED,
    "velocity_curve.contacts": HEATED,
    "read_laboratory.path": RECORDED,
    "read_healing.hold": HOLDS,
    "read_healing.force": 0.6 + 0.01 * np.log(HOLDS),
    "renormalisation.interface": LATTICE,
    "run.scenario": {"contacts": {"thresholds": GAUSSIAN}, "pull": {"points": 11}},
    "sweep.scenario": {"contacts": {"thresholds": GAUSSIAN}, "pull": {"points": 11}},
    "spots.pressure": BLOBS,
    "spots.pixel": 0.1,
    "Interface.stretch_density.cell": 0,
    "Interface.stretch_density.at": 1.0,
    "Pull.force_std.size": 10,
    "Pull.sample_paths.at": [0.0, 1.0],
    "Pull.sample_paths.seed": 1,
    "ThresholdResponse.adjoint.position": [1.0, 2.0],
    "ThresholdResponse.adjoint.weights": [1.0, 1.0],
    "Estimates.predict.position": [1.0, 2.0],
    "Estimates.interval_by_profile.name": "thresholds.std",
    "VelocityCurveEstimates.interval_by_profile.name": "count",
    "Estimates.profile.name": "thresholds.std",
    "VelocityCurveEstimates.profile.name": "count",
    "Spots.contacts.E": 1.0,
    "Spots.contacts.nu": 0.3,
    "Simulation.restore.state": None,
    "ax": None,
    "at": 1.0,
    "boundaries": [0.0, 2.0],
    "cells": [4],
    "coefficients": [[0.5]],
    "components": [(1.0, GAUSSIAN)],
    "confidence": 0.9,
    "connection": 1.0,
    "contacts": CONTACTS,
    "count": 3,
    "damping": 1.0,
    "displacement": 0.5,
    "drive": 1.0,
    "duration": 1.0,
    "free": ["thresholds.std"],
    "growth": 0.1,
    "law": GAUSSIAN,
    "mass": 1.0,
    "max": 2.0,
    "mean": 1.0,
    "min": 0.5,
    "model": THEORY,
    "modulus": 1.0,
    "order": 1,
    "parameter": "thresholds.mean",
    "parameters": ["thresholds.mean"],
    "position": 1.0,
    "q": 0.5,
    "samples": [0.9, 1.0, 1.1],
    "scale": 1.0,
    "shape": 2.0,
    "span": (0.1, 10.0),
    "std": 0.1,
    "steps": STEPS,
    "stiffness": 1.0,
    "strength": 1.0,
    "thresholds": [0.9, 1.1],
    "time": 1.0,
    "until": 1.0,
    "velocity": 1.0,
    "wave_number": [0.1, 1.0],
    "weights": 1.0,
    "x": 1.0,
}


# Arguments without which others have no meaning, by callable.
ALSO: dict[str, dict[str, Any]] = {
    "Interface": {"neighbours": 2.0},
    "Interface.stretch_density": {"stretches": [0.1, 0.2]},
    "Spots.contacts": {"local_friction": 0.3},
    "fit_healing": {"a": 0.01},
    "sweep": {"over": {"contacts.thresholds.gaussian.std": [0.1]}, "keep": ["kinetic_friction"]},
    "stability": {"span": (0.1, 1.0), "points": 3},
    "velocity_curve": {"span": (0.1, 1.0), "points": 3},
}
# Without these, an argument of the same callable cannot be given.
INSTEAD = {
    ("Spots.contacts", "shear_strength"): "local_friction",
    ("stability", "velocities"): "span",
    ("velocity_curve", "velocities"): "span",
}

# Methods of a block over contacts that depend on time.
IN_TIME = {"Block.stability", "Block.stick_slip"}
# Arguments for which anything is right, and those of tuples and mappings of Python.
ANYTHING = {"default", "value", "start", "stop"}
VARIABLE = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)


def arguments(call: Callable[..., Any]) -> Iterator[str]:
    """The names of the arguments of a callable."""
    for name, argument in inspect.signature(call).parameters.items():
        if name != "self" and argument.kind not in VARIABLE:
            yield name


def callables() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Functions, classes that can be called, and methods of objects, each with its name."""
    for name in asp.__all__:
        one = getattr(asp, name)
        if inspect.isclass(one):
            if not (issubclass(one, tuple) or hasattr(one, "__dataclass_fields__")):
                yield name, one
        elif callable(one):
            yield name, one
    yield "Block.stability", asp.Block(asp.Transport(DELAYED), 1.0).stability
    yield "Block.stick_slip", asp.Block(asp.Transport(DELAYED), 1.0, "overdamped").stick_slip
    for name, one in OBJECTS.items():
        for method in dir(one):
            if (
                not method.startswith("_")
                and f"{name}.{method}" not in IN_TIME
                and inspect.isroutine(getattr(one, method, None))
            ):
                yield f"{name}.{method}", getattr(one, method)


def cases() -> Iterator[tuple[str, Callable[..., Any], str]]:
    for name, call in callables():
        for argument in arguments(call):
            yield f"{name}({argument})", call, argument


CASES = {name: (call, argument) for name, call, argument in cases() if argument not in ANYTHING}


def right(name: str, call: Callable[..., Any]) -> dict[str, Any]:
    """Arguments without which the callable cannot be called."""
    given = inspect.signature(call).parameters.items()
    needed = [
        one for one, it in given if it.default is it.empty and it.kind not in VARIABLE and one != "self"
    ]
    return {one: RIGHT.get(f"{name}.{one}", RIGHT.get(one)) for one in needed}


@pytest.mark.parametrize("name", CASES)
def test_messages_name_the_argument(name: str) -> None:
    call, argument = CASES[name]
    place = name.split("(")[0]
    given = right(place, call) | ALSO.get(place, {}) | {argument: object()}
    given.pop(INSTEAD.get((place, argument), ""), None)
    with pytest.raises((TypeError, ValueError)) as refused:
        handed(call, given)
    assert re.search(rf"\b{argument}\b", str(refused.value))


def handed(call: Callable[..., Any], given: dict[str, Any]) -> object:
    """The callable with these arguments, by position where it knows them so."""
    ordered = [one for one, it in inspect.signature(call).parameters.items() if it.kind is it.POSITIONAL_ONLY]
    return call(*(given.pop(one) for one in ordered if one in given), **given)


def test_objects_that_are_called_name_the_argument() -> None:
    # They show no signature.
    named = {name: "hold" if name == "Healing" else "position" for name in OBJECTS if callable(OBJECTS[name])}
    assert {"Pull", "Gradient", "ThresholdResponse", "Healing", "VelocityStep"} <= set(named)
    for name, argument in named.items():
        for wrong in (object(), "far", None):
            with pytest.raises(TypeError, match=rf"^{argument}\b"):
                OBJECTS[name](wrong)
