"""Small results: named tuples."""

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Atoms(NamedTuple):
    """Point masses, in order of increasing position."""

    position: "NDArray[np.float64]"
    """Their positions, shape (n,), a length."""
    weight: "NDArray[np.float64]"
    """Their weights, shape (n,)."""


class StaticFriction(NamedTuple):
    """Static friction: the highest force of a pull, and its position."""

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
    """Point masses: stretches that many contacts share, with the fractions of contacts; one for each position
    of a list.
    """


class Label(NamedTuple):
    """Dimensions, name and unit of a variable of a record."""

    dimensions: tuple[str, ...]
    """Names of its dimensions, slowest first."""
    long_name: str
    """Its descriptive name."""
    units: str
    """Its unit, "1" where there is none."""
    quantity: str
    """The quantity that it measures: "length", "force", "stiffness", "energy", "time", "velocity", …"""


class State(NamedTuple):
    """An equilibrium state of a slider."""

    drive: float
    """The load-point displacement X_T, a length; or the imposed force."""
    position: float
    """The position X of the base, a length."""
    force: float
    """The friction force F."""


class Energy(NamedTuple):
    """The energy balance of a drive; each term is computed on its own. Energies are forces times lengths."""

    work: float
    """The work of the drive."""
    spring: float
    """The change of the energy of the spring, ½K(X_T - X)²."""
    elastic: float
    """The change of the elastic energy of the contacts, Σ½kx²."""
    kinetic: float
    """The change of the kinetic energy ½MẊ² of the slider, for motion in time."""
    strengthening: float
    """Energy that ageing adds by making stretched contacts stiffer, ∫Σ½x²dk; it is not part of the work."""
    breaks: float
    """Energy dissipated in breaks."""
    slip: float
    """Energy lost by the slider in slips without inertia; in a reset, the energy released by the spring."""
    viscous: float
    """Energy dissipated by viscous damping."""
    imbalance: float
    """Work plus strengthening minus all other terms: 0 except for rounding and the error of the forces."""


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
    """Linear stability of steady sliding at one velocity."""

    critical_stiffness: float
    """K_c(v; M, γ), above which steady sliding is stable; 0 where it always is, inf where it never is."""
    frequency: float
    """Angular frequency of the oscillation that sets in there, per time; 0: no instability; inf: a jump."""
    growth_rate: float
    """Growth rate of the fastest growing deviation at the stiffness of the block, per time; 0: stable."""
    growth_frequency: float
    """Its angular frequency, per time."""


class Sizes(NamedTuple):
    """The number of events of an ensemble by size: ten bins per decade, empty bins left out."""

    contacts: "NDArray[np.float64]"
    """The number of contacts broken, in the middle of the bin, shape (n,)."""
    events: "NDArray[np.float64]"
    """The number of events, shape (n,)."""
    slip: "NDArray[np.float64]"
    """The mean slip in such an event, shape (n,), a length."""
    drop: "NDArray[np.float64]"
    """The mean force drop, shape (n,)."""


class Course(NamedTuple):
    """The time course of an inertial slip: arrays of shape (n,)."""

    time: "NDArray[np.float64]"
    """The time since the slider had covered a hundredth of its slip."""
    position: "NDArray[np.float64]"
    """The position X of the slider, a length."""
    velocity: "NDArray[np.float64]"
    """Its velocity."""
    force: "NDArray[np.float64]"
    """The friction force F."""
    spring_force: "NDArray[np.float64]"
    """The spring force K(X_T - X)."""


class Equilibria(NamedTuple):
    """Equilibria of a slider: arrays of shape (n,), in order of increasing position."""

    drive: "NDArray[np.float64]"
    """The load-point displacement X_T, a length."""
    position: "NDArray[np.float64]"
    """The position X of the base, a length."""
    force: "NDArray[np.float64]"
    """The friction force F."""
    stable: "NDArray[np.bool_]"
    """Whether the equilibrium is stable."""


class Potential(NamedTuple):
    """The potential energy of a slider and its contacts at one drive or several."""

    position: "NDArray[np.float64]"
    """Positions X, shape (n,), a length."""
    energy: "NDArray[np.float64]"
    """The potential V(X_T, X): shape (n,), or (m, n) for a list of m drives."""
