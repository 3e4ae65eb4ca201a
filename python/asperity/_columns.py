"""The columns of a text file: a heading with units, and numbers."""

import csv
import re
from io import StringIO
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# A name with its unit in brackets.
UNIT = re.compile(r"^(?P<name>.*?)[\s_]*[(\[](?P<unit>[^)\]]*)[)\]]$")

# The beginning of a number, or one that is not finite.
NUMBER = re.compile(r"^\s*[-+]?([.,]?\d|(nan|inf(inity)?)\s*$)", re.IGNORECASE)

# A number with a decimal comma.
COMMA = re.compile(r"^\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*$")


class Columns(NamedTuple):
    """Names, units ("" without one) and values of shape (columns, readings)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    heading: list[str]
    values: "NDArray[np.float64]"


def read(path: str, *, skip: int, decimal: str, encoding: str) -> Columns:
    """The columns of a file."""
    if decimal not in {".", ","}:
        raise ValueError(f"decimal: expected '.' or ',', got {decimal!r}")
    if skip < 0:
        raise ValueError(f"skip: expected a number of lines, 0 or above, got {skip}")
    numbered = enumerate(StringIO(text_of(path, encoding)), 1)
    kept = ((number, line) for number, line in numbered if number > skip)
    lines = [(number, line) for number, line in kept if line.strip() and line[0] not in "#%"]
    if len(lines) < 2:
        raise ValueError(f"{path}: expected a heading and readings, got {len(lines)} lines")
    rows = split([line for _, line in lines])
    heading, places = [cell.strip() for cell in rows[0]], [number for number, _ in lines[1:]]
    if all(is_number(cell) for cell in heading):
        raise ValueError(f"{path}: expected a heading that names the columns, got numbers")
    if len(heading) == 1:
        found = f"got {heading[0]!r}; skip leaves out lines before the heading"
        raise ValueError(f"{path}: line {lines[0][0]}: expected a heading of several columns, {found}")
    names, units = zip(*(parted(cell) for cell in heading), strict=True)
    # Some programs write units into a line of their own.
    if not any(units) and are_units(rows[1], len(heading)):
        units = tuple(cell.strip().strip("()[]") for cell in rows[1])
        rows, places = rows[1:], places[1:]
    if len(rows) < 2:
        raise ValueError(f"{path}: expected a heading and readings, got no readings")
    values = np.array(
        [
            numbers(row, len(heading), decimal, f"{path}: line {number}")
            for row, number in zip(rows[1:], places, strict=True)
        ]
    )
    return Columns(names, units, heading, values.T)


def text_of(path: str, encoding: str) -> str:
    """The text of a file, without a byte order mark."""
    try:
        with open(path, encoding="utf-8-sig" if encoding == "utf-8" else encoding) as file:
            return file.read()
    except LookupError:
        raise ValueError(f"encoding: expected one such as 'latin-1', got {encoding!r}") from None
    except UnicodeError as error:
        at = f"a byte that is none at {error.start}" if isinstance(error, UnicodeDecodeError) else str(error)
        other = "; encoding reads others, such as 'latin-1' or 'utf-16'"
        raise ValueError(f"{path}: expected text in {encoding.upper()}, got {at}{other}") from None


def split(lines: list[str]) -> list[list[str]]:
    """The cells of all lines, by the separator that the heading has."""
    for separator in ("\t", ";", ","):
        if separator in lines[0]:
            return list(csv.reader(lines, delimiter=separator))
    return [line.split() for line in lines]


def parted(heading: str) -> tuple[str, str]:
    """The name of a column and its unit, "" without one."""
    found = UNIT.match(heading)
    return (found["name"].strip(), found["unit"].strip()) if found else (heading, "")


def are_units(row: list[str], columns: int) -> bool:
    """Whether a line has as many cells as columns, words among them and no number."""
    return len(row) == columns and any(map(str.strip, row)) and not any(map(NUMBER.match, row))


def numbers(row: list[str], columns: int, decimal: str, where: str) -> list[float]:
    """The numbers of a line."""
    if len(row) != columns:
        raise ValueError(f"{where}: expected {columns} values, got {len(row)}")
    # A point beside a decimal comma could separate thousands, or be a decimal point.
    plain = row if decimal == "." else [cell.replace(".", "x").replace(",", ".") for cell in row]
    for cell, given in zip(plain, row, strict=True):
        if not is_number(cell):
            hint = '; decimal="," reads decimal commas' if COMMA.match(given) and decimal == "." else ""
            raise ValueError(f"{where}: expected a finite number, got {given.strip()!r}{hint}")
    return [float(cell) for cell in plain]


def is_number(cell: str) -> bool:
    """Whether a cell is a finite number."""
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False
