"""Every tolerance in a test has its reason beside it: a comment on its line or in the lines above.

    python .ci/tolerances.py

A tolerance is a number below 1 that is written as a decimal or a power of ten and is an upper bound: behind `<` or `<=`, the last
argument of a function that compares, or `abs`, `rel`, `atol`, `rtol` in Python. Bounds by constants have their reason where the
constant is. A comment counts for the lines below it up to an empty line, for `NEAR` lines at most; one above a function or a table
of cases counts for all of the first lines of it.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Lines between a bound and its reason.
NEAR = 16
# Numbers of order 1 that agree to this differ by rounding: some thousand operations, or sums of as many terms. CONTRIBUTING.md says so.
ROUNDING = 1e-12
PLACES = [
    "core/tests/*.rs",
    "core/src/**/*.rs",
    "runner/tests/*.rs",
    "runner/src/**/*.rs",
    "cli/tests/**/*.rs",
    "cli/src/**/*.rs",
    "engine/tests/*.rs",
    "python/tests/*.py",
]
SMALL = r"(?:\d[\d_]*(?:\.\d+)?e-\d+|0\.\d+)"
RUST = re.compile(
    rf"<=?\s*{SMALL}|\b(?:near|close|assert_close|assert_near|agree|agrees|holds|equal|same|within)\w*!?\(.*,\s*{SMALL}\)"
)
PYTHON = re.compile(rf"<=?\s*{SMALL}|\b(?:abs|rel|atol|rtol|tolerance)=\s*{SMALL}")


def test_lines(path: Path) -> list[tuple[int, str]]:
    """The lines of tests of a file, with their numbers; of code with tests at its end only these."""
    lines = list(enumerate(path.read_text(encoding="utf-8").splitlines(), start=1))
    if "src" not in path.relative_to(ROOT).parts:
        return lines
    begin = next((number for number, line in lines if line.strip() == "#[cfg(test)]"), None)
    return lines[begin:] if begin else []


def beginning(lines: list[str], at: int, python: bool) -> int:
    """The first line of the function around a line, with its attributes and documentation."""
    head = re.compile(r"\s*(?:def |class )" if python else r"\s*(?:pub(?:\([a-z]+\))? )?(?:const )?fn ")
    begin = next((k for k in range(at, -1, -1) if head.match(lines[k])), 0)
    attached = ("#", "@", "//")
    while begin > 0 and lines[begin - 1].strip().startswith(attached):
        begin -= 1
    return begin


def has_reason(lines: list[str], at: int, mark: str) -> bool:
    """Whether a comment is on the line, or above it in its function."""
    if mark in lines[at]:
        return True
    begin = beginning(lines, at, mark == "#")
    return any(line.strip().startswith(mark) for line in lines[max(begin, at - NEAR) : at])


def is_rounding(code: str) -> bool:
    """Whether the bounds of a line are such that only rounding is left."""
    return all(float(number.replace("_", "")) <= ROUNDING for number in re.findall(SMALL, code))


def bare(path: Path) -> list[str]:
    """The tolerances of a file without a reason."""
    found, python = [], path.suffix == ".py"
    numbered = test_lines(path)
    lines = [line for _, line in numbered]
    mark, bound = ("#", PYTHON) if python else ("//", RUST)
    for at, (number, line) in enumerate(numbered):
        bounds = "".join(bound.findall(line.split(mark)[0]))
        if bounds and not is_rounding(bounds) and not has_reason(lines, at, mark):
            found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    return found


def main() -> int:
    """Lists tolerances without a reason."""
    paths = sorted({path for place in PLACES for path in ROOT.glob(place)})
    found = [line for path in paths for line in bare(path)]
    print("\n".join(found) if found else "every tolerance has a reason beside it")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
