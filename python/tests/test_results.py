"""Scenarios: what Python computes is what the command writes, bit for bit."""

import csv
import json
import os
import shlex
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest
from shipped import SMALLER

ROOT = Path(__file__).parents[2]
COMMAND = shlex.split(os.environ.get("ASPERITY", "cargo run --release --locked --quiet --"))
# Sweeps have tests of their own.
SCENARIOS = [path for path in sorted(ROOT.glob("scenarios/*.toml")) if not path.stem.startswith("sweep")]
# The slowest ones made smaller; `make results` runs them in full, but for a quarter of a million cells.
CHANGES: dict[str, dict[str, Any]] = {**SMALLER, "half-space-512": {"interface.cells": [64, 64]}}
DRIVES = [
    path
    for path in SCENARIOS
    if (path.stem.startswith("stick-slip") and path.stem != "stick-slip-ageing")
    or path.stem in ("hysteresis", "imposed-force", "smooth-sliding")
]
# Tables of the numbers of a task that are not called as the task.
TABLES = (
    "force.csv",
    "trace.csv",
    "static_fatigue.csv",
    "thresholds.csv",
    "fit_spectrum.csv",
    "fit_readings.csv",
)


def identical(one: asp.Result, other: asp.Result) -> None:
    assert list(one) == list(other)
    for name in one:
        # Bits, so that NaN is NaN.
        np.testing.assert_array_equal(one[name].view(np.uint64), other[name].view(np.uint64), err_msg=name)
    assert one.labels == other.labels
    assert one.scenario == other.scenario
    assert json.dumps(one.summary) == json.dumps(other.summary)


@pytest.fixture(scope="module", params=SCENARIOS, ids=lambda path: path.stem)
def written(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A scenario, and the folder that the command has written for it."""
    folder = tmp_path_factory.mktemp("results") / request.param.stem
    changes = CHANGES.get(request.param.stem, {})
    options = [part for key, value in changes.items() for part in ("--set", f"{key}={value}")]
    arguments = ["run", str(request.param), "--quiet", "-o", str(folder), *options]
    subprocess.run([*COMMAND, *arguments], check=True, cwd=ROOT)
    return request.param, folder


def test_python_computes_what_the_command_does(written: tuple[Path, Path], tmp_path: Path) -> None:
    scenario, folder = written
    computed = asp.run(scenario, CHANGES.get(scenario.stem, {}))
    identical(computed, asp.open_result(folder))
    computed.save(tmp_path / "saved")
    pictures = (".svg", ".png")
    saved, kept = (
        {path.name: path.read_bytes() for path in at.iterdir() if path.suffix not in pictures}
        for at in (tmp_path / "saved", folder)
    )
    # Python draws when asked to: of the lists of files, those of the command alone have pictures.
    listed = kept[".asperity"].decode().splitlines(keepends=True)
    kept[".asperity"] = "".join(line for line in listed if not line.rstrip().endswith(pictures)).encode()
    assert saved == kept


def test_models_compute_what_scenarios_do() -> None:
    result = asp.run(ROOT / "scenarios" / "fig2.toml")
    contacts, initial = asp.Contacts(asp.Gaussian(1.0, 0.05)), asp.Gaussian(0.1, 0.025)
    pull = asp.MasterEquation(contacts, initial).pull(20.0, 2001)
    np.testing.assert_array_equal(pull.force, result.force)
    np.testing.assert_array_equal(pull.breaking_rate, result["breaking_rate"])
    np.testing.assert_array_equal(pull.force_std(100_000), result["force_std"])
    assert pull.static_friction == result.static_friction
    assert pull.kinetic_friction == result.kinetic_friction
    assert pull.critical_stiffness == result.critical_stiffness
    assert pull.relaxation_length == result.relaxation_length
    at = pull.stretch_density(at=result["snapshot"], stretches=result["stretch"])
    np.testing.assert_array_equal(at.density, result["stretch_density"])
    ensemble = asp.Ensemble(contacts, initial, size=100_000, seed=1)
    sample = ensemble.pull(20.0, 2001, snapshots=result["snapshot"])
    np.testing.assert_array_equal(sample.force, result["ensemble_force"])
    np.testing.assert_array_equal(sample.force_error, result["ensemble_error"])
    np.testing.assert_array_equal(sample["stretch_density"], result["ensemble_stretch_density"])


def test_the_written_scenario_names_the_schema_that_is_around_it(tmp_path: Path) -> None:
    result = asp.run({"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}, "pull": {"points": 11}})
    (tmp_path / "asperity.schema.json").write_text("{}", encoding="utf-8")
    result.save(tmp_path / "results")
    text = (tmp_path / "results" / "scenario.toml").read_text(encoding="utf-8")
    line, _, rest = text.partition("\n")
    assert line == "#:schema ../asperity.schema.json"
    assert rest == result.scenario
    assert asp.open_result(tmp_path / "results").scenario == result.scenario


@pytest.mark.parametrize("written", DRIVES, ids=lambda path: path.stem, indirect=True)
def test_blocks_are_driven_as_by_the_command(written: tuple[Path, Path]) -> None:
    _, folder = written
    scenario = tomllib.loads((folder / "scenario.toml").read_text(encoding="utf-8"))
    contacts = asp.Contacts(asp.Gaussian(**scenario["contacts"]["thresholds"]["gaussian"]))
    models: dict[str, asp.Model] = {"": asp.MasterEquation(contacts)}
    if "ensemble" in scenario:
        models["ensemble_"] = asp.Ensemble(contacts, **scenario["ensemble"])
    for prefix, model in models.items():
        run = slider(model, scenario).drive(**without(scenario["drive"], "start"))
        same(run, folder / f"{prefix}trace.csv")
        same(run.events, folder / f"{prefix}events.csv")
        if run.sizes is not None and (folder / "sizes.csv").exists():
            same(run.sizes._asdict(), folder / "sizes.csv")
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        reported = summary["ensemble"] if prefix else summary
        assert (run.regime, run.reason, len(run.events)) == (
            reported["regime"],
            reported["reason"],
            reported["slips"],
        )
        for name in ("period", "mean_drop", "mean_slip", "scatter"):
            assert getattr(run, name) == reported.get(name)
        for name in ("first_instability", "runaway"):
            state = getattr(run, name)
            assert (state and state._asdict()) == reported.get(name)


def slider(model: asp.Model, scenario: dict[str, Any]) -> asp.Block:
    """The block of a scenario, its defaults filled in."""
    block = scenario.get("block", {"stiffness": None})
    if isinstance(block.get("slip"), dict):
        block["slip"] = asp.Inertial(**block["slip"]["inertial"])
    return asp.Block(model, **block)


def without(table: dict[str, Any], name: str) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key != name}


def same(columns: Any, path: Path) -> None:
    """The columns of a table, but for the numbers of its rows."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    for name, *values in zip(header, *rows, strict=True):
        if name != "event":
            np.testing.assert_array_equal([float(value) for value in values], columns[name], err_msg=name)


def test_tables_of_the_command_have_the_same_numbers(written: tuple[Path, Path]) -> None:
    _, folder = written
    task = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["task"]
    (table,) = [folder / name for name in (*TABLES, f"{task}.csv") if (folder / name).exists()]
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    result = asp.open_result(folder)
    shape = max((result[name].shape for name in rows[0]), key=len)
    for name in rows[0]:
        # Curves at several temperatures, or velocities, stand one below the other.
        first = name == "temperature" or (
            table.name == "stability.csv" and result.labels[name].dimensions == ("velocity",)
        )
        values = result[name][:, np.newaxis] if first else result[name]
        column = np.broadcast_to(values, shape).ravel()
        np.testing.assert_array_equal([float(row[name]) for row in rows], column, err_msg=name)


TEXT = """
title = "Rough contacts"
contacts.thresholds.gamma = { mean = 1.5, std = 0.3 }
pull = { distance = 6.0, points = 61 }
units.length = "µm"
"""
TABLE: dict[str, Any] = {
    "title": "Rough contacts",
    "contacts": {"thresholds": asp.Gamma(1.5, 0.3)},
    "pull": {"distance": 6.0, "points": 61},
    "units": {"length": "µm"},
}


def test_first_breaks_of_coupled_contacts() -> None:
    law = asp.Gaussian(1.0, 0.1)
    interface = {
        "cells": [50, 50],
        "contacts": "one",
        "connection": 0.9,
        "coupling": {"neighbours": {"stiffness": 0.025}},
    }
    result = asp.run(
        {"contacts": {"thresholds": law}, "interface": interface, "renormalisation": {"runs": 4}}
    )
    found, mean_field = result.summary["renormalisation"], asp.Renormalised(law, 0.1)
    assert found["coupling"] == pytest.approx(0.1, rel=1e-15)
    assert found["critical_coupling"] == asp.critical_coupling(law)
    assert found["mean_field"]["std"] == pytest.approx(mean_field.std(), rel=1e-15)
    assert mean_field.mean() < found["mean"]["value"] < law.mean()
    width = np.diff(result["drive"])[0]
    edges = result["drive"][0] + width * (np.arange(result["drive"].size + 1) - 0.5)
    # Differences of probabilities, rounded at 1e-16, over the width.
    np.testing.assert_allclose(
        result["mean_field_density"], np.diff(mean_field.cdf(edges)) / width, atol=1e-12
    )


def test_first_breaks_of_cells() -> None:
    interface = {
        "cells": [20],
        "connection": 9.0,
        "coupling": {"neighbours": {"stiffness": 0.5}},
        "disorder": {"std": 0.0, "seed": 3},
    }
    law = asp.Gaussian(1.0, 0.05)
    result = asp.run(
        {"contacts": {"thresholds": law}, "interface": interface, "renormalisation": {"runs": 2}}
    )
    found, mean_field = result.summary["renormalisation"], asp.Renormalised(law, 0.1)
    assert (found["cells"], found["runs"], result.summary["seed"]) == (20, 2, 3)
    # Cells that are alike are mean field, but for 1e-6 of the contacts, which are not waited for.
    assert found["mean"]["value"] == pytest.approx(mean_field.mean(), abs=1e-6)
    assert found["mean_field"]["distance"] < 1e-8


def test_scenarios_may_be_texts_or_dictionaries(tmp_path: Path) -> None:
    path = tmp_path / "rough.toml"
    path.write_text(TEXT, encoding="utf-8")
    result = asp.run(TEXT)
    for other in (TABLE, path, str(path)):
        identical(asp.run(other), result)
    assert result.title == "Rough contacts"
    assert result.labels["position"].units == "µm"
    array = np.array([0.9, 1.0, 1.1])
    table = TABLE | {"contacts": {"thresholds": {"tabulated": {"samples": array}}, "count": np.int64(3)}}
    assert asp.run(table).summary["contacts"] == 3.0


def test_values_can_be_overridden() -> None:
    wide = asp.run(TEXT, {"contacts.thresholds.gamma.std": 0.6, "pull.points": 31})
    assert wide.scenario == asp.run(TEXT.replace("0.3", "0.6").replace("61", "31")).scenario
    other = asp.run(TEXT, {"contacts.thresholds": asp.Weibull(3.0, 1.0), "title": "a = b"})
    assert "[contacts.thresholds.weibull]" in other.scenario
    assert other.title == "a = b"


def test_summaries_have_words_for_what_is_no_number() -> None:
    result = asp.run({"contacts": {"thresholds": asp.Point(1.0)}, "pull": {"distance": 0.5}})
    assert result.static_friction is None
    assert result.critical_stiffness == result.relaxation_length == np.inf
    assert result.summary["static_friction"] == "not reached"
    assert result.summary["critical_stiffness"] == "infinite"


@pytest.mark.parametrize(
    ("scenario", "overrides", "error", "text"),
    [
        ("nowhere.toml", None, FileNotFoundError, "nowhere.toml: cannot read"),
        ("a = ", None, ValueError, "expected valid TOML"),
        (TEXT.replace("gamma", "gama"), None, ValueError, r"got \"gama\" \(did you mean gamma\?\)"),
        (TEXT, {"pull.points": 1}, ValueError, "pull.points: expected 2 points or more"),
        (
            TEXT,
            {"pull.distance": float("nan")},
            ValueError,
            "pull.distance: expected a number above 0, got NaN",
        ),
        (TEXT, {"contacts.count": None}, TypeError, "contacts.count: expected a table, a list"),
        (TEXT, {3: 4}, TypeError, "keys that are texts"),
        ({"contacts": {3: 4}}, None, TypeError, "contacts: expected keys that are texts"),
        (
            {"contacts": asp.MasterEquation(asp.Contacts(asp.Point(1.0)))},
            None,
            TypeError,
            "a distribution, areas",
        ),
        ({"pull": {"points": 2**70}}, None, ValueError, "pull.points: expected a whole number below"),
        (3, None, TypeError, "scenario: expected a path"),
        ({}, None, ValueError, "contacts"),
    ],
)
def test_wrong_scenarios_are_refused(
    scenario: Any, overrides: Any, error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        asp.run(scenario, overrides)


@pytest.mark.parametrize("path", sorted(ROOT.glob("scenarios/invalid/*.toml")), ids=lambda path: path.stem)
def test_scenarios_that_must_fail_fail(path: Path) -> None:
    compute = asp.sweep if path.stem.startswith("sweep") else asp.run
    with pytest.raises(ValueError, match=r"expected .* got "):
        compute(path)


def test_folders_of_others_are_left_alone(tmp_path: Path) -> None:
    result = asp.run(TEXT)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("years of work", encoding="utf-8")
    with pytest.raises(FileExistsError, match="a folder that asperity did not make"):
        result.save(tmp_path / "mine")
    with pytest.raises(FileNotFoundError, match="cannot read"):
        asp.open_result(tmp_path / "mine")
    # An empty folder is taken.
    (tmp_path / "ours").mkdir()
    result.save(tmp_path / "ours")
    (tmp_path / "ours" / "summary.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ValueError, match=r"summary\.json: missing field"):
        asp.open_result(tmp_path / "ours")


def test_the_folder_of_a_sweep_is_no_result(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    over = {"contacts.thresholds.gamma.std": [0.2, 0.3]}
    asp.sweep(TEXT, over, ["kinetic_friction"], folder=tmp_path / "sweep")
    with pytest.raises(ValueError, match=r"folder: expected the folder of a run, got that of a sweep: "):
        asp.open_result(tmp_path / "sweep")


def test_results_open_in_xarray_as_they_are(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    result = asp.run(ROOT / "scenarios" / "fig2.toml")
    result.save(tmp_path / "fig2")
    ours = result.to_xarray()
    with xarray.open_dataset(tmp_path / "fig2" / "result.nc", engine="h5netcdf") as theirs:
        for name in result:
            xarray.testing.assert_equal(ours[name], theirs[name])
            assert ours[name].attrs["units"] == theirs[name].attrs["units"]
