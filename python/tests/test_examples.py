"""The examples print the same in Python and in Rust."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "python" / "examples").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_prints_what_its_counterpart_in_rust_prints(script: Path) -> None:
    # core/tests/examples.rs compares the kept output with that of Rust.
    expected = (ROOT / "core" / "examples" / f"{script.stem}.txt").read_text(encoding="utf-8")
    utf8 = os.environ | {"PYTHONUTF8": "1"}
    found = subprocess.run(
        [sys.executable, "-P", script], capture_output=True, encoding="utf-8", env=utf8, check=False
    )
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout == expected


def test_there_are_eight_examples() -> None:
    assert len(SCRIPTS) == 8
