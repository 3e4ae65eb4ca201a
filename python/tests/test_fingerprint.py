"""The comparison of what two source trees compute, which releases rely on."""

import runpy
from pathlib import Path

import numpy as np

PROGRAM = runpy.run_path(str(Path(__file__).parents[2] / ".ci" / "fingerprint.py"))
compare, of_notebook = PROGRAM["compare"], PROGRAM["of_notebook"]


def test_one_bit_of_one_number_shows() -> None:
    before = {"force": np.array([1.0, 2.0, np.nan]), "count": np.array(3)}
    assert compare(before, dict(before)) == []
    after = {"force": np.array([1.0, np.nextafter(2.0, 3.0), np.nan]), "count": np.array(3)}
    assert compare(before, after) == ["force: up to 4.4e-16, where the largest is 2.000e+00 (1 bytes)"]
    assert compare(before, {**before, "count": np.array(4)}) == ["count: other numbers"]
    assert compare({"x": np.array([0.0])}, {"x": np.array([-0.0])}) != []


def test_what_is_missing_shows() -> None:
    before, after = {"force": np.array([1.0])}, {"slope": np.array([1.0])}
    assert compare(before, after) == ["force: only before", "slope: only after"]
    assert compare(before, {"force": np.array([1.0, 2.0])}) == ["force: float64 (1,) became float64 (2,)"]
    assert compare(before, {"force": np.array([np.nan])}) == ["force: 1 of 1 are NaN in one of them"]


def test_texts_are_compared_by_line() -> None:
    before, after = (np.asarray(text) for text in ("a\nb", "a\nc"))
    assert compare({"table": before}, {"table": after}) == ["table: 'b' became 'c'"]
    assert compare({"table": before}, {"table": np.asarray("a\nb\nd")}) == ["table: '' became 'd'"]


def test_a_notebook_is_what_it_prints_and_the_numbers_it_names(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    cells = ["x = [1.0, 2.0]\nprint(sum(x))", "y, z = object(), [[1], [2, 3]]"]
    fenced = "".join(f"```{{code-cell}}\n{cell}\n```\n\n" for cell in cells)
    page.write_text(fenced, encoding="utf-8")
    found = {name: np.asarray(value).tolist() for name, value in of_notebook(page)}
    assert found == {"printed": "3.0\n", "x": [1.0, 2.0]}
