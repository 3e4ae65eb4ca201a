"""Writes the documentation that Python shows at run time into the stubs: python python/tests/stubs.py

Signatures in `_core.pyi` are written by hand; what stands under them comes from the compiled module.
"""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

from asperity import _core

STUBS = Path(__file__).parents[1] / "asperity" / "_core.pyi"


def documented(tree: ast.Module) -> str:
    """The stubs with the documentation of the module and of all that they declare."""
    document(tree, _core)
    return formatted(ast.unparse(tree))


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


def formatted(text: str) -> str:
    """As ruff lays it out."""
    for command in (["check", "--select=I", "--fix"], ["format"]):
        line = [sys.executable, "-m", "ruff", *command, "--quiet", "--stdin-filename", str(STUBS), "-"]
        text = subprocess.run(line, input=text, capture_output=True, text=True, check=True).stdout
    return text


if __name__ == "__main__":
    STUBS.write_text(documented(ast.parse(STUBS.read_text(encoding="utf-8"))), encoding="utf-8")
