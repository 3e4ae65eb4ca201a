"""The stubs say what Python shows; every name is exported and documented."""

import ast
import inspect

import asperity
import pytest

pytest.importorskip("ruff")
from stubs import EXPORTS, STUBS, documented, exporting


def test_stubs_are_up_to_date() -> None:
    text = STUBS.read_text(encoding="utf-8")
    assert documented(ast.parse(text)) == text, "make stubs"


def test_exports_are_up_to_date() -> None:
    text = EXPORTS.read_text(encoding="utf-8")
    assert exporting(text) == text, "make stubs"


def test_every_public_name_is_documented() -> None:
    for name in asperity.__all__:
        thing = getattr(asperity, name)
        assert name == "__version__" or inspect.getdoc(thing), name
        members = vars(thing) if inspect.isclass(thing) else {}
        for member, value in members.items():
            assert member.startswith("_") or inspect.getdoc(value), f"{name}.{member}"
