"""Small results: named tuples."""

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Atoms(NamedTuple):
    """Point masses, by rising position."""

    position: "NDArray[np.float64]"
    """Where they are, shape (n,), a length."""
    weight: "NDArray[np.float64]"
    """Their weights, shape (n,)."""


class StaticFriction(NamedTuple):
    """The highest force of a pull, and where it is."""

    force: float
    """F_s, a force."""
    position: float
    """X_s, a length."""


class StretchDensity(NamedTuple):
    """A distribution of stretches, or several."""

    stretch: "NDArray[np.float64]"
    """Stretches x, shape (n,), a length."""
    density: "NDArray[np.float64]"
    """The density there, per length: shape (n,), or (m, n) at a list of m positions."""
    atoms: Atoms | list[Atoms]
    """Stretches at which contacts are together, and fractions of them; one for each position of a list."""


class Label(NamedTuple):
    """What a variable of a record is."""

    dimensions: tuple[str, ...]
    """Names of its dimensions, slowest first."""
    long_name: str
    """Its name for people."""
    units: str
    """Its unit, "1" where there is none."""
