"""What `help` shows has the sections of numpydoc that apply, and its examples do what they show."""

import ast
import dataclasses
import doctest
import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import asperity as asp
import pytest

SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)


def public(module: ModuleType) -> Iterator[tuple[str, Any]]:
    for name in module.__all__:
        thing = getattr(module, name)
        if callable(thing):
            yield f"{module.__name__}.{name}", thing


NAMES = dict([*public(asp), *public(asp.exact)])


def members() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Public functions, classes and their methods."""
    for name, thing in NAMES.items():
        yield name, thing
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            if not member.startswith("_") and callable(value):
                yield f"{name}.{member}", getattr(thing, member)


CALLED = dict(members())


def sections(thing: object) -> dict[str, str]:
    """The sections of a docstring by their names."""
    parts = SECTION.split(inspect.getdoc(thing) or "")
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def described(thing: object) -> set[str]:
    """The arguments that a docstring describes."""
    entries = re.findall(r"^(\S[^:\n]*)", sections(thing).get("Parameters", ""), re.MULTILINE)
    return {name.strip().lstrip("*") for entry in entries for name in entry.split(",")}


def arguments(thing: Callable[..., Any]) -> set[str]:
    """Arguments but for those of every plot, and of classes that only results are made of."""
    if dataclasses.is_dataclass(thing) or (inspect.isclass(thing) and issubclass(thing, tuple)):
        return set()
    try:
        return set(inspect.signature(thing).parameters) - {"self", "args", "kwargs"}
    except ValueError:
        return set()


@pytest.mark.parametrize("name", CALLED)
def test_every_argument_is_described(name: str) -> None:
    assert arguments(CALLED[name]) <= described(CALLED[name])


@pytest.mark.parametrize("name", CALLED)
def test_sections_are_those_of_numpydoc(name: str) -> None:
    known = ["Parameters", "Returns", "Yields", "Attributes", "Raises", "Notes", "Examples"]
    found = list(sections(CALLED[name]))
    assert found == [section for section in known if section in found]


def returned(function: ast.FunctionDef) -> str | None:
    """The type of what a function returns."""
    return None if function.returns is None else ast.unparse(function.returns)


def returning() -> Iterator[str]:
    """Functions and methods that return something, as the stubs and the modules in Python say."""
    for path in sorted(Path(asp.__file__).parent.glob("_*.py*")):
        if path.suffix not in (".py", ".pyi"):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        owners: list[tuple[str, Any]] = [("", tree)]
        owners += [(f"{node.name}.", node) for node in tree.body if isinstance(node, ast.ClassDef)]
        for owner, node in owners:
            for function in node.body:
                if isinstance(function, ast.FunctionDef) and returned(function) not in (None, "None"):
                    yield f"asperity.{owner}{function.name}"


@pytest.mark.parametrize("name", sorted(set(returning()) & set(CALLED)))
def test_what_returns_something_says_what(name: str) -> None:
    found = sections(CALLED[name])
    assert "Returns" in found or "Yields" in found


@pytest.mark.parametrize("name", CALLED)
def test_what_takes_arguments_says_what_it_raises(name: str) -> None:
    assert "Raises" in sections(CALLED[name]) or not arguments(CALLED[name])


@pytest.mark.parametrize("name", CALLED)
def test_what_is_raised_names_its_condition(name: str) -> None:
    raises = sections(CALLED[name]).get("Raises", "").lower()
    assert not re.search(r"invalid (values?|arguments?|input|options?)", raises)


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_has_examples(name: str) -> None:
    assert ">>>" in sections(NAMES[name]).get("Examples", "")


@pytest.mark.parametrize("name", [name for name, thing in CALLED.items() if ">>>" in (thing.__doc__ or "")])
def test_examples_do_what_they_show(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    text = inspect.getdoc(CALLED[name]) or ""
    if "xarray" in text or "plot(" in text:
        pytest.importorskip("matplotlib")
        pytest.importorskip("xarray")
    if "Explorer(" in text:
        pytest.importorskip("anywidget")
    session = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    report: list[str] = []
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    results = doctest.DocTestRunner(optionflags=flags).run(session, out=report.append)
    assert results.attempted > 0
    assert results.failed == 0, "".join(report)
