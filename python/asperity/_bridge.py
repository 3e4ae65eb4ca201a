"""Laws from what else a law may be given as."""

from asperity._core import Law


def law(x: object) -> Law:
    raise TypeError(x)
