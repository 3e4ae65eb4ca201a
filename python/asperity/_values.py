"""Small results of contacts and pulls: named tuples."""

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


class Atoms(NamedTuple):
    """Point masses, in order of increasing position.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Point(1.0))
    >>> atoms = asp.MasterEquation(contacts).pull(distance=1.5).breaking_atoms
    >>> atoms.position, atoms.weight
    (array([1.]), array([1.]))
    """

    position: "NDArray[np.float64]"
    """Their positions, shape (n,), a length."""
    weight: "NDArray[np.float64]"
    """Their weights, shape (n,)."""


class StaticFriction(NamedTuple):
    """Static friction: the highest force of a pull, and its position.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> round(pull.static_friction.force, 3)
    0.796
    """

    force: float
    """F_s, a force."""
    position: float
    """X_s, a length."""


class StretchDensity(NamedTuple):
    """A distribution of stretches, or several.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> at_start = pull.stretch_density(0.0)
    >>> at_start.atoms.position, at_start.atoms.weight
    (array([0.]), array([1.]))
    """

    stretch: "NDArray[np.float64]"
    """Stretches x, shape (n,), a length."""
    density: "NDArray[np.float64]"
    """The density there, per length: shape (n,), or (m, n) at a list of m positions."""
    atoms: Atoms | list[Atoms]
    """Point masses: stretches that many contacts share, with the fractions of contacts; one for each position
    of a list.
    """
    position: "NDArray[np.float64] | None" = None
    """The positions X of a list, shape (m,), a length; None for one distribution."""

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the density, one curve for each position, point masses as stems; it needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        **style
            Arguments of the plot() of the axes.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """
        from asperity import _plot

        return _plot.stretches(self, ax, **style)


class Label(NamedTuple):
    """Dimensions, name and unit of a variable of a record.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> pull.labels["force"].quantity
    'force'
    """

    dimensions: tuple[str, ...]
    """Names of its dimensions, slowest first."""
    long_name: str
    """Its descriptive name."""
    units: str
    """Its unit, "1" where there is none."""
    quantity: str
    """The quantity that it measures: "length", "force", "stiffness", "energy", "time", "velocity", …"""
