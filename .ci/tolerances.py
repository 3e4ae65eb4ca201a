"""Every tolerance in a test has its reason beside it: a comment on its line, or above it in its function.

    python .ci/tolerances.py

A tolerance is a number below 0.1, a decimal or a power of ten, that is an upper bound: behind `<` or `<=`,
as the last argument of a function that compares, or as `abs`, `rel`, `atol`, `rtol` in Python. Two reasons
need no words: 1e-12 or less is rounding, and about one unit of the last digit of a number in the same line is
what that number is known to. Bounds by constants have their reason where the constant is.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Lines between a bound and its reason.
NEAR = 16
# Numbers of order 1 that agree to this differ by the rounding of some thousand operations (CONTRIBUTING.md).
ROUNDING = 1e-12
# What is larger is no tolerance but a limit between outcomes.
LARGEST = 0.1
PLACES = [
    "core/tests/**/*.rs",
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
PYTHON = re.compile(rf"<=?\s*{SMALL}|\b(?:abs|rel|atol|rtol)=\s*{SMALL}")


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


def bounds(code: str, pattern: re.Pattern[str]) -> list[float]:
    """The tolerances in a line."""
    last = [re.findall(SMALL, found)[-1] for found in pattern.findall(code)]
    return [value for value in (float(number.replace("_", "")) for number in last) if value < LARGEST]


def digits(code: str) -> list[float]:
    """The units of the last digits of the decimals in a line."""
    decimals = re.findall(r"(?<![\w.])\d+\.(\d[\d_]{2,})(?![\d_]*e)", code)
    return [10.0 ** -len(digits.replace("_", "")) for digits in decimals]


def is_plain(value: float, code: str) -> bool:
    """Whether only rounding is left below a bound, or it is the last digit of a number in its line."""
    return value <= ROUNDING or any(0.4 * unit < value < 1.1 * unit for unit in digits(code))


def bare(path: Path) -> list[str]:
    """The tolerances of a file without a reason."""
    found, python = [], path.suffix == ".py"
    numbered = test_lines(path)
    lines = [line for _, line in numbered]
    mark, pattern = ("#", PYTHON) if python else ("//", RUST)
    for at, (number, line) in enumerate(numbered):
        code = line.split(mark)[0]
        plain = all(is_plain(value, code) for value in bounds(code, pattern))
        if not plain and not has_reason(lines, at, mark):
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
