"""The JSON Schema of scenarios, with a validator that editors use: it takes what the program takes."""

import json
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
from test_results import COMMAND

jsonschema = pytest.importorskip("jsonschema")

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def validator() -> Any:
    """The schema that the command prints."""
    printed = subprocess.run([*COMMAND, "schema"], cwd=ROOT, check=True, capture_output=True).stdout
    schema = json.loads(printed)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def scenarios(folder: Path) -> dict[str, dict[str, Any]]:
    """The scenarios of a folder that are TOML."""
    found = {}
    for path in sorted(folder.glob("*.toml")):
        try:
            found[path.name] = tomllib.loads(path.read_text(encoding="utf-8"))
        except (UnicodeDecodeError, tomllib.TOMLDecodeError):
            continue
    return found


def test_the_schema_of_the_command_takes_all_that_come_with_it(validator: Any) -> None:
    shipped = scenarios(ROOT / "scenarios")
    assert len(shipped) > 30
    for name, scenario in shipped.items():
        assert not [error.message for error in validator.iter_errors(scenario)], name


def test_the_schema_of_the_command_refuses_most_wrong_scenarios(validator: Any) -> None:
    """The others are wrong by the content of a file, by order or sums of numbers, or by a limit of memory."""
    wrong = scenarios(ROOT / "scenarios" / "invalid")
    refused = [name for name, scenario in wrong.items() if not validator.is_valid(scenario)]
    # As the page for editors says.
    assert len(refused) >= max(115, 0.6 * len(wrong)), sorted(set(wrong) - set(refused))


def test_a_mistake_has_one_message_in_the_schema_of_the_command(validator: Any) -> None:
    wrong = scenarios(ROOT / "scenarios" / "invalid")
    messages = {name: len(list(validator.iter_errors(scenario))) for name, scenario in wrong.items()}
    assert {name: count for name, count in messages.items() if count > 1} == {}


@pytest.mark.parametrize(
    ("path", "keys"),
    [
        (
            "contacts.thresholds.gaussian.std",
            {"contacts": {"thresholds": {"gaussian": {"mean": 1, "std": -1}}}},
        ),
        ("contacts.thresholds", {"contacts": {"thresholds": {"gausian": {"mean": 1, "std": 1}}}}),
        ("contacts.thresholds.gaussian", {"contacts": {"thresholds": {"gaussian": {"mean": 1, "sdt": 1}}}}),
        (
            "contacts",
            {
                "contacts": {
                    "stiffness": 1.0,
                    "areas": {"law": {"exponential": {"mean": 1}}, "modulus": 1, "strength": 1},
                }
            },
        ),
        ("contacts.delay.time", {"contacts": {"delay": {"time": -1}}, "pull": {"velocity": 1}}),
        ("pull.velocity", {"pull": {"velocity": 0}}),
        ("", {"drive": {"distance": 1}}),
        (
            "block.slip.damped.damping",
            {"pull": None, "drive": {}, "block": {"stiffness": 1, "slip": {"damped": {"damping": 0}}}},
        ),
        ("block.slip", {"pull": None, "drive": {}, "block": {"stiffness": 1, "slip": "sticky"}}),
        (
            "interface",
            {
                "interface": {
                    "cells": [8],
                    "contacts": "one",
                    "connection": 1,
                    "coupling": {"neighbours": {"stiffness": 1}},
                    "mass": 1,
                },
                "pull": None,
                "drive": {"velocity": 1},
            },
        ),
    ],
)
def test_messages_are_at_the_key_that_is_wrong(validator: Any, path: str, keys: dict[str, Any]) -> None:
    """This validator names the table of a key that must not be there, editors name the key."""
    scenario = {"contacts": {"thresholds": {"gaussian": {"mean": 1.0, "std": 0.1}}}, "pull": {}} | keys
    scenario = {key: value for key, value in scenario.items() if value is not None}
    if "thresholds" not in scenario["contacts"] and "areas" not in scenario["contacts"]:
        scenario["contacts"] |= {"thresholds": {"gaussian": {"mean": 1.0, "std": 0.1}}}
    assert [error.json_path for error in validator.iter_errors(scenario)] == [f"$.{path}".rstrip(".")]
