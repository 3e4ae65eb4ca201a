"""The classes of parametric distributions: those created from numbers alone."""

import inspect
from typing import Any

import asperity as asp

OTHERS = (asp.Tabulated, asp.Series, asp.Mixture, asp.Renormalised)
PARAMETRIC: list[Any] = [kind for kind in asp.Law.__subclasses__() if kind not in OTHERS]


def member(kind: Any, *numbers: Any) -> asp.Law:
    """The distribution with the first of these numbers as its parameters."""
    law: asp.Law = kind(*numbers[: len(inspect.signature(kind).parameters)])
    return law
