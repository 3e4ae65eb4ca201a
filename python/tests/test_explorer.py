"""The explorer in a notebook: what the page asks, the kernel answers, and the next cell reads."""

import json
import re
from pathlib import Path
from typing import Any

import asperity as asp
import pytest

TEXT = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 } # narrow\npull.distance = 5.0\n"


@pytest.fixture
def explorer() -> asp.Explorer:
    pytest.importorskip("anywidget")
    return asp.Explorer(TEXT)


def asked(explorer: asp.Explorer, monkeypatch: pytest.MonkeyPatch, **request: Any) -> dict[str, Any]:
    """The answer to a request of the page, as the widget sends it."""
    sent: list[dict[str, Any]] = []
    widget = explorer._widget
    monkeypatch.setattr(widget, "send", sent.append)
    widget._handle_custom_msg({"view": "0.5", "number": 7, "request": request}, [])
    # It waits for the answer.
    _ = explorer.scenario
    *progress, message = sent
    assert all((reported["view"], reported["number"]) == ("0.5", 7) for reported in sent)
    fractions = [reported["progress"] for reported in progress]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    answer: dict[str, Any] = json.loads(message["answer"])
    return answer


def test_a_change_in_the_page_is_read_by_the_next_cell(
    explorer: asp.Explorer, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = explorer.result
    assert explorer.scenario == TEXT
    assert explorer.result is before
    change = {"key": "contacts.thresholds.gaussian.std", "value": "0.3"}
    answer = asked(explorer, monkeypatch, text=TEXT, changes=[change], parts=["force"], position=0.5)
    assert explorer.scenario == answer["text"] == TEXT.replace("0.1", "0.3")
    # The same solver to the same accuracy: F_k has no error of discretisation.
    assert answer["force"]["kinetic_friction"] == explorer.result.kinetic_friction
    assert explorer.result.kinetic_friction == asp.run(TEXT.replace("0.1", "0.3")).kinetic_friction
    assert explorer.result.kinetic_friction > before.kinetic_friction


def test_mistakes_are_answered_and_not_lost(explorer: asp.Explorer, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = TEXT.replace("0.1", "-0.1")
    answer = asked(explorer, monkeypatch, text=wrong, parts=["force"])
    assert answer["invalid"]["key"] == "contacts.thresholds.gaussian.std"
    assert explorer.scenario == wrong
    with pytest.raises(ValueError, match=r"-0\.1"):
        _ = explorer.result
    files = asked(explorer, monkeypatch, text="protocol_file = '/etc/passwd'\n" + TEXT.split("pull")[0])
    assert "no files are read here" in files["invalid"]["message"]


def test_an_invalid_request_leaves_the_scenario(
    explorer: asp.Explorer, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer = asked(
        explorer, monkeypatch, text=TEXT.replace("0.1", "0.3"), parts=["force"], position=float("nan")
    )
    assert answer["failures"][0].startswith("the request is invalid")
    assert explorer.scenario == TEXT


def test_long_work_is_given_up_for_a_newer_request(
    explorer: asp.Explorer, monkeypatch: pytest.MonkeyPatch
) -> None:
    cells = "coupling.neighbours = { stiffness = 4.0 }\nconnection = 0.5\ndisorder = { std = 0.05, seed = 1 }"
    long = TEXT.replace(
        "pull.distance = 5.0", f"[interface]\ncells = [2000]\n{cells}\n[drive]\ndistance = 9e4"
    )
    sent: list[dict[str, Any]] = []
    monkeypatch.setattr(explorer._widget, "send", sent.append)
    for number, (text, part) in enumerate([(long, "task"), (TEXT, "force")]):
        request = {"text": text, "parts": [part]}
        explorer._widget._handle_custom_msg({"view": "0.5", "number": number, "request": request}, [])
    assert explorer.scenario == TEXT
    assert [message["number"] for message in sent if "answer" in message] == [1]


def test_the_page_is_one_frame_with_a_strict_policy(explorer: asp.Explorer) -> None:
    page = explorer._widget.page
    (nonce,) = set(re.findall(r'nonce="(\w+)"', page))
    assert f"script-src 'nonce-{nonce}'" in page
    assert "connect-src" not in page
    # What the script of the widget replaces.
    assert page.count('"scenario":null') == 1
    assert '"engine":"notebook"' in page
    assert asp.Explorer(TEXT)._widget.page != page


def test_scenarios_are_those_of_run(tmp_path: Path) -> None:
    pytest.importorskip("anywidget")
    (tmp_path / "law.csv").write_text("stretch,density\n0.5,0\n1.0,2\n1.5,0\n", encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text("contacts.thresholds.tabulated.file = 'law.csv'\npull.distance = 3.0\n", encoding="utf-8")
    explorer = asp.Explorer(path)
    assert "law.csv" not in explorer.scenario
    assert explorer.result.kinetic_friction == asp.run(path).kinetic_friction
    contacts = {"thresholds": asp.Gaussian(1.0, 0.1)}
    assert asp.Explorer({"contacts": contacts, "pull": {"distance": 5.0}}).result.static_friction is not None
    with pytest.raises(ValueError, match="contacts"):
        asp.Explorer("pull.distance = 3.0")


def test_the_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "anywidget", None)
    with pytest.raises(ImportError, match=r"pip install 'asperity\[explorer\]'"):
        asp.Explorer(TEXT)
