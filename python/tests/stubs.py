"""The stubs of the compiled module, and the names that the package exports, as `python/src` declares them.

`maturin generate-stubs` reads names, signatures and types from the extension. This completes what it writes:
overloads, defaults that are no literals, and the layout. `make stubs` runs

    python python/tests/stubs.py GENERATED

which writes `_core.pyi`, the lists in `__init__.py` and that of tasks in `docs/api/python.md`; with --check
it compares them.
"""

import argparse
import ast
import copy
import inspect
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from asperity import _core, _events, _fit_values, _slider_values, _task_results, _tasks, _values, exact

PACKAGE = Path(__file__).parents[1] / "asperity"
STUBS, EXPORTS = PACKAGE / "_core.pyi", PACKAGE / "__init__.py"
PAGE = Path(__file__).parents[2] / "docs" / "api" / "python.md"

# Names in the types that `python/src` writes out; those that are not used are left out of the stubs.
HEADER = """
from collections.abc import Callable, ItemsView, Iterator, KeysView, Mapping, Sequence, ValuesView
from datetime import timedelta
from os import PathLike
from typing import Any, Literal, Self, SupportsFloat, SupportsIndex, TypeAlias, TypeVar, final, overload

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray
from scipy.stats import gaussian_kde
from scipy.stats.distributions import rv_frozen
from xarray import Dataset

from asperity._events import {events}
from asperity._fit_values import {fits}
from asperity._slider_values import {sliders}
from asperity._values import {values}

_T = TypeVar("_T")
_Array: TypeAlias = NDArray[np.float64]
_Number: TypeAlias = SupportsFloat | SupportsIndex
_AnyLaw: TypeAlias = Law | rv_frozen | gaussian_kde | NDArray[Any] | Sequence[float]
_Seed: TypeAlias = SupportsIndex | np.random.Generator | np.random.RandomState
_Progress: TypeAlias = Callable[[float], object] | bool | None
"""


def completed(generated: str) -> str:
    """The stubs, from those that maturin generates."""
    tree = ast.parse(generated)
    for owner, function in functions(tree):
        if ast.get_docstring(function) is not None:
            function.body = [ast.Expr(ast.Constant(...))]
        set_types(function)
        owned: Any = getattr(_core, owner.name) if owner else _core
        set_defaults(function, owned if function.name == "__new__" else getattr(owned, function.name))
    with_bodies: list[ast.Module | ast.ClassDef] = [tree, *classes(tree)]
    for node in with_bodies:
        node.body = [one for child in node.body for one in overloads(child)]
    for node in classes(tree):
        if not node.bases and issubclass(getattr(_core, node.name), Mapping):
            node.bases = [expression("Mapping[str, _Array]")]
    modules = {"values": _values, "sliders": _slider_values, "fits": _fit_values, "events": _events}
    header = HEADER.format(**{name: ", ".join(public(module)) for name, module in modules.items()})
    header_and_all = [*ast.parse(header).body, *tree.body[1:]]
    tree.body[1:] = sorted(header_and_all, key=lambda node: not isinstance(node, ast.Import | ast.ImportFrom))
    return documented(tree)


def expression(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def public(module: ModuleType) -> list[str]:
    """Public names that a module of the package defines."""
    return [
        name
        for name, thing in vars(module).items()
        if getattr(thing, "__module__", "") == module.__name__ and not name.startswith("_")
    ]


def classes(tree: ast.Module) -> list[ast.ClassDef]:
    return [node for node in tree.body if isinstance(node, ast.ClassDef)]


def functions(tree: ast.Module) -> Iterator[tuple[ast.ClassDef | None, ast.FunctionDef]]:
    """Functions and methods, each with its class."""
    for owner in [None, *classes(tree)]:
        for node in owner.body if owner else tree.body:
            if isinstance(node, ast.FunctionDef):
                yield owner, node


def arguments(function: ast.FunctionDef) -> list[ast.arg]:
    given = function.args
    others = [one for one in (given.vararg, given.kwarg) if one]
    return [*given.posonlyargs, *given.args, *given.kwonlyargs, *others]


def defaults(function: ast.FunctionDef) -> dict[str, ast.expr | None]:
    """The defaults of the arguments that may have one."""
    given = function.args
    positional = [*given.posonlyargs, *given.args]
    required = [None] * (len(positional) - len(given.defaults))
    values = [*required, *given.defaults, *given.kw_defaults]
    return dict(zip([one.arg for one in [*positional, *given.kwonlyargs]], values, strict=True))


def put_defaults(function: ast.FunctionDef, values: Mapping[str, ast.expr | None]) -> None:
    positional = [one.arg for one in [*function.args.posonlyargs, *function.args.args]]
    function.args.defaults = [value for name in positional if (value := values[name])]
    function.args.kw_defaults = [values[one.arg] for one in function.args.kwonlyargs]


def set_defaults(function: ast.FunctionDef, thing: Callable[..., object]) -> None:
    """Defaults that are no literals in Rust, from the signature at run time."""
    values = defaults(function)
    for name, value in values.items():
        if isinstance(value, ast.Constant) and value.value is ...:
            values[name] = ast.Constant(inspect.signature(thing).parameters[name].default)
    put_defaults(function, values)


def set_types(function: ast.FunctionDef) -> None:
    """Types written out in Rust become expressions; PyO3's own names of types become those of the package."""

    def typed(annotation: ast.expr | None) -> ast.expr | None:
        if annotation is None or is_alternatives(annotation):
            return annotation
        if any(
            isinstance(node, ast.Name) and node.id in ("Any", "Incomplete") for node in ast.walk(annotation)
        ):
            if function.name.startswith("__"):
                return expression("object")
            raise SystemExit(f"{function.name}: declare the types of arguments and result in python/src")
        text = ast.unparse(Unquoted().visit(annotation)).replace("SupportsGetItem[int, ", "Sequence[")
        return expression(text.replace("SupportsFloat | SupportsIndex", "_Number"))

    for argument in arguments(function):
        argument.annotation = typed(argument.annotation)
    function.returns = typed(function.returns)


class Unquoted(ast.NodeTransformer):
    """Expressions in place of texts."""

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return expression(node.value) if isinstance(node.value, str) else node


def is_alternatives(annotation: ast.expr | None) -> bool:
    """Whether a type lists two, separated by a semicolon."""
    return isinstance(annotation, ast.Constant) and ";" in str(annotation.value)


def overloads(node: ast.stmt) -> list[ast.stmt]:
    """Two overloads of a function with two alternatives of types; a default None stays where it fits."""
    if not isinstance(node, ast.FunctionDef) or not is_alternatives(node.returns):
        return [node]
    found: list[ast.stmt] = []
    for choice in range(2):

        def chosen(annotation: ast.expr | None, choice: int = choice) -> ast.expr | None:
            if annotation is None or not is_alternatives(annotation):
                return annotation
            return expression(ast.literal_eval(annotation).split("; ")[choice])

        one = copy.deepcopy(node)
        one.decorator_list.insert(0, expression("overload"))
        one.returns = chosen(one.returns)
        values = defaults(one)
        for argument in arguments(one):
            if is_alternatives(argument.annotation):
                argument.annotation = kind = chosen(argument.annotation)
                if kind and "None" not in ast.unparse(kind):
                    values[argument.arg] = None
        put_defaults(one, values)
        found.append(one)
    return found


def exporting(text: str) -> str:
    """The package, with the names of its tasks, and of the compiled module those not in `asperity.exact`."""
    elsewhere = imported(Path(exact.__file__).read_text(encoding="utf-8"))
    names = [name for name in _core.__all__ if name == "__version__" or not name.startswith("_")]
    for module, exported in (
        ("_core", [name for name in names if name not in elsewhere]),
        ("_task_results", public(_task_results)),
        ("_tasks", public(_tasks)),
    ):
        line = f"from asperity.{module} import ({', '.join(exported)})"
        text = re.sub(rf"from asperity\.{module} import \(.*?\)", line, text, flags=re.DOTALL)
    quoted = ", ".join(f'"{name}"' for name in imported(text) | aliases(text))
    return formatted(re.sub(r"__all__ = \[.*?\]", f"__all__ = [{quoted}]", text, flags=re.DOTALL), EXPORTS)


def listing(page: str) -> str:
    """The page of the package, with every function of a task and the classes of its result."""
    names: dict[str, str] = {}
    for name in public(_tasks):
        if inspect.isfunction(thing := getattr(_tasks, name)):
            names[name] = "autofunction"
            names |= dict.fromkeys(results(str(thing.__annotations__["return"])), "autoclass")
    lines = "".join(f".. {directive}:: asperity.{name}\n" for name, directive in names.items())
    return re.sub(r"(?<=\n## Tasks\n)(.*?\{eval-rst\}\n).*?(?=```)", rf"\1{lines}", page, flags=re.DOTALL)


def results(kind: str) -> Iterator[str]:
    """The classes of tasks in a type, each before those of its fields."""
    for name in re.findall(r"\w+", kind):
        if inspect.isclass(thing := vars(_task_results).get(name)) and name in public(_task_results):
            yield name
            for field in inspect.get_annotations(thing).values():
                yield from results(str(field))


def imported(text: str) -> set[str]:
    """Names that a module imports from the package."""
    nodes = [node for node in ast.parse(text).body if isinstance(node, ast.ImportFrom)]
    return {
        alias.name for node in nodes if (node.module or "").startswith("asperity") for alias in node.names
    }


def aliases(text: str) -> set[str]:
    """Second names of what a module imports: `Normal = Gaussian`."""
    targets = [node.targets[0] for node in ast.parse(text).body if isinstance(node, ast.Assign)]
    return {target.id for target in targets if isinstance(target, ast.Name)} - {"__all__"}


def documented(tree: ast.Module) -> str:
    """The stubs with the documentation of the module and of all that they declare."""
    document(tree, _core)
    return formatted(ast.unparse(tree), STUBS)


def document(node: ast.Module | ast.ClassDef | ast.FunctionDef, thing: object, depth: int = 0) -> None:
    """Replaces the documentation under a node, and under those in it; of overloads the first has it."""
    if ast.get_docstring(node) is not None:
        node.body = node.body[1:] or [ast.Expr(ast.Constant(...))]
    seen = set()
    for child in node.body:
        if isinstance(child, ast.ClassDef | ast.FunctionDef):
            if not child.name.startswith("_") and child.name not in seen:
                document(child, getattr(thing, child.name), depth + 1)
            seen.add(child.name)
    text = inspect.getdoc(thing)
    if text:
        indented = text.replace("\n", "\n" + "    " * depth).replace("\n" + "    " * depth + "\n", "\n\n")
        end = "\n" + "    " * depth if "\n" in text else ""
        node.body = [ast.Expr(ast.Constant(indented + end)), *node.body]
        if len(node.body) == 2 and isinstance(node, ast.FunctionDef):
            node.body = node.body[:1]


def formatted(text: str, path: Path) -> str:
    """As ruff lays it out, without imports that are not used."""
    for command in (["check", "--select=I,F401,RUF022", "--fix"], ["format"]):
        line = [sys.executable, "-m", "ruff", *command, "--quiet", "--stdin-filename", str(path), "-"]
        text = subprocess.run(line, input=text, capture_output=True, text=True, check=True).stdout
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("generated", type=Path, help="what maturin generate-stubs wrote")
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    given = parser.parse_args()
    made = {
        STUBS: completed(given.generated.read_text(encoding="utf-8")),
        EXPORTS: exporting(EXPORTS.read_text(encoding="utf-8")),
        PAGE: listing(PAGE.read_text(encoding="utf-8")),
    }
    for path, text in made.items():
        if not given.check:
            path.write_text(text, encoding="utf-8")
        elif path.read_text(encoding="utf-8") != text:
            raise SystemExit(f"{path}: not up to date: make stubs")


if __name__ == "__main__":
    main()
