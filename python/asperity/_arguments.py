"""Arguments that name themselves where they are of a wrong type."""

from collections.abc import Mapping
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def wrong(name: str, expected: str, value: object) -> TypeError:
    """The error for an argument of a wrong type."""
    return TypeError(f"{name}: expected {expected}, got {type(value).__name__}")


def number(name: str, value: Any) -> float:
    """A number; texts, and True and False, are none."""
    try:
        if isinstance(value, str | bytes | bool | np.bool_):
            raise TypeError
        return float(value)
    except OverflowError:
        raise ValueError(f"{name}: expected a number in range, got one beyond it") from None
    except (TypeError, ValueError):
        raise wrong(name, "a number", value) from None


def whole(name: str, value: Any) -> int:
    """A whole number."""
    try:
        return index(value)
    except TypeError:
        raise wrong(name, "a whole number", value) from None


def numbers(name: str, value: Any) -> "NDArray[np.float64]":
    """An array of numbers."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise wrong(name, "numbers", value) from None


def flag(name: str, value: Any) -> bool:
    """True or False."""
    if not isinstance(value, bool | np.bool_):
        raise wrong(name, "True or False", value)
    return bool(value)


def word(name: str, value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise wrong(name, "text", value)
    return value


def table(name: str, value: Any, of: str) -> "Mapping[str, Any]":
    """A mapping of what is said."""
    if not isinstance(value, Mapping):
        raise wrong(name, f"a mapping of {of}", value)
    return value
