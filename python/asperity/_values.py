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
    quantity: str
    """What it measures: "length", "force", "stiffness", "energy", "time", "velocity", …"""


class State(NamedTuple):
    """A state of a slider in balance."""

    drive: float
    """The position X_T of the top, a length; or the imposed force."""
    position: float
    """The position X of the bottom, a length."""
    force: float
    """The friction force F."""


class Energy(NamedTuple):
    """Where the work of a drive went; each part is computed on its own. Energies are forces times lengths."""

    work: float
    """The work of the drive."""
    spring: float
    """The change of the energy of the spring, ½K(X_T - X)²."""
    elastic: float
    """The change of the elastic energy of the contacts, Σ½kx²."""
    kinetic: float
    """The change of the energy ½MẊ² of the slider, where it is followed in time."""
    strengthening: float
    """What ageing brought that makes stretched contacts stiffer, ∫Σ½x²dk: beside the work, not of it."""
    breaks: float
    """Lost in breaks."""
    slip: float
    """Lost by the slider in slips, where it has no inertia; in a reset, what the spring releases."""
    viscous: float
    """Lost by viscous damping."""
    imbalance: float
    """Work and strengthening less all the others: 0 but for rounding and the accuracy of the forces."""


class InterfaceEnergy(NamedTuple):
    """Where the work of the drive of an interface went; each part is computed on its own."""

    work: float
    """The work of the drive."""
    connection: float
    """The change of the energy of the springs to the drive, ½ΣK_0(X_T - X_j)²."""
    coupling: float
    """The change of the elastic energy of the slider, ½XᵀAX."""
    elastic: float
    """The change of the elastic energy of the contacts, Σ½kx²."""
    strengthening: float
    """What ageing brought that makes stretched contacts stiffer, ∫Σ½x²dk: beside the work, not of it."""
    breaks: float
    """Lost in breaks."""
    slip: float
    """Lost by the slider: in slips, or by viscous drag."""
    imbalance: float
    """Work and strengthening less all the others: 0 but for rounding and the accuracy of the forces."""


class Stability(NamedTuple):
    """What linear stability says of steady sliding at one velocity."""

    critical_stiffness: float
    """K_c(v; M, γ), above which steady sliding is stable; 0 where it always is, inf where it never is."""
    frequency: float
    """Angular frequency of the oscillation that sets in there, per time; 0: none does; inf: a jump."""
    growth_rate: float
    """Rate at which the fastest deviation grows behind the spring of the block, per time; 0: it is stable."""
    growth_frequency: float
    """Its angular frequency, per time."""


class Sizes(NamedTuple):
    """How many events of an ensemble there were of each size: ten bins to a factor of ten, none empty."""

    contacts: "NDArray[np.float64]"
    """The number of contacts broken, in the middle of the bin, shape (n,)."""
    events: "NDArray[np.float64]"
    """The number of events, shape (n,)."""
    slip: "NDArray[np.float64]"
    """The mean way of the slider in such an event, shape (n,), a length."""
    drop: "NDArray[np.float64]"
    """The mean drop of the force, shape (n,)."""


class Course(NamedTuple):
    """The time course of an inertial slip: arrays of shape (n,)."""

    time: "NDArray[np.float64]"
    """The time since the slider had gone a hundredth of its way."""
    position: "NDArray[np.float64]"
    """The position X of the slider, a length."""
    velocity: "NDArray[np.float64]"
    """Its velocity."""
    force: "NDArray[np.float64]"
    """The friction force F."""
    spring_force: "NDArray[np.float64]"
    """The force K(X_T - X) of the spring."""


class Equilibria(NamedTuple):
    """Where a slider is in balance: arrays of shape (n,), by rising position."""

    drive: "NDArray[np.float64]"
    """The drive X_T at which it is, a length."""
    position: "NDArray[np.float64]"
    """The position X of its bottom, a length."""
    force: "NDArray[np.float64]"
    """The friction force F."""
    stable: "NDArray[np.bool_]"
    """Whether it stays there when it is pushed."""


class Potential(NamedTuple):
    """The potential of a slider and its contacts at one drive or several."""

    position: "NDArray[np.float64]"
    """Positions X, shape (n,), a length."""
    energy: "NDArray[np.float64]"
    """The potential V(X_T, X): shape (n,), or (m, n) for a list of m drives."""
