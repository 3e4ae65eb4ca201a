"""The stubs say what Python shows; every name is exported, documented and on the page of the package."""

import ast
import inspect
import re
from pathlib import Path

import asperity
import pytest

pytest.importorskip("ruff")
from stubs import EXPORTS, STUBS, documented, exporting

PAGE = Path(__file__).parents[2] / "docs" / "api" / "python.md"


def test_stubs_are_up_to_date() -> None:
    text = STUBS.read_text(encoding="utf-8")
    assert documented(ast.parse(text)) == text, "make stubs"


def test_exports_are_up_to_date() -> None:
    text = EXPORTS.read_text(encoding="utf-8")
    assert exporting(text) == text, "make stubs"


def test_page_has_every_public_name_once() -> None:
    directives = re.findall(
        r"^\.\. auto(?:class|function):: asperity\.(\w+)$", PAGE.read_text(encoding="utf-8"), re.M
    )
    assert sorted(directives) == sorted(set(asperity.__all__) - {"__version__", "exact"})


def test_every_public_name_is_documented() -> None:
    for name in asperity.__all__:
        thing = getattr(asperity, name)
        assert name == "__version__" or inspect.getdoc(thing), name
        members = vars(thing) if inspect.isclass(thing) else {}
        for member, value in members.items():
            assert member.startswith("_") or inspect.getdoc(value), f"{name}.{member}"
