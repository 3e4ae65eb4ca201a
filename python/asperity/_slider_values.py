"""Small results of sliders and interfaces: named tuples."""

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


class State(NamedTuple):
    """An equilibrium state of a slider.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> state = asp.Block(theory, 0.3).drive(5.0).first_instability
    >>> type(state).__name__
    'State'
    """

    drive: float
    """The load-point displacement X_T, a length; or the imposed force."""
    position: float
    """The position X of the base, a length."""
    force: float
    """The friction force F."""


class Energy(NamedTuple):
    """The energy balance of a drive; each term is computed on its own. Energies are forces times lengths.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> energy = asp.Block(theory, 0.3).drive(5.0).energy
    >>> abs(energy.imbalance) < 1e-6 * energy.work
    True
    """

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
    background: float
    """Energy dissipated by the background force, ∫B|dX|."""
    imbalance: float
    """Work plus strengthening minus all other terms: 0 except for rounding and the error of the forces."""


class InterfaceEnergy(NamedTuple):
    """Where the work of the drive of an interface went; each part is computed on its own.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> simulation = asp.Interface(contacts, [4], connection=0.3, neighbours=2.0).simulation()
    >>> _ = simulation.advance(5.0)
    >>> abs(simulation.energy.imbalance) < 1e-5 * simulation.energy.work
    True
    """

    work: float
    """The work of the drive."""
    connection: float
    """The change of the energy of the springs to the drive, ½ΣK_0(X_T - X_j)²."""
    coupling: float
    """The change of the elastic energy of the slider, ½XᵀAX."""
    elastic: float
    """The change of the elastic energy of the contacts, Σ½kx²."""
    kinetic: float
    """The change of the kinetic energy of cells with a mass, Σ½MẊ²."""
    strengthening: float
    """What ageing brought that makes stretched contacts stiffer, ∫Σ½x²dk: beside the work, not of it."""
    breaks: float
    """Lost in breaks."""
    slip: float
    """Lost by the slider: in slips, or by viscous drag."""
    imbalance: float
    """Work and strengthening less all the others: 0 but for rounding and the accuracy of the forces."""


class Stability(NamedTuple):
    """Linear stability of steady sliding at one velocity.

    Examples
    --------
    >>> import asperity as asp
    >>> heat = asp.Temperature(0.05, 1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=heat)
    >>> block = asp.Block(asp.Transport(contacts), 1.0, asp.Damped(1.0))
    >>> bool(block.stability(velocity=0.1).critical_stiffness >= 0.0)
    True
    """

    critical_stiffness: float
    """K_c(v; M, γ), above which steady sliding is stable; 0 where it always is, inf where it never is."""
    frequency: float
    """Angular frequency of the oscillation that sets in there, per time; 0: no instability; inf: a jump."""
    growth_rate: float
    """Growth rate of the fastest growing deviation at the stiffness of the block, per time; 0: stable."""
    growth_frequency: float
    """Its angular frequency, per time."""


class SimulatedStickSlip(NamedTuple):
    """What a slider does over single contacts, in simulations with different contacts.

    Standard deviations are those of one simulation about the mean of all.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> block = asp.Block(theory, 0.5, "arrest", slip_fraction=0.3)
    >>> found = block.stick_slip(resolution=0.1, size=100, simulations=3).ensemble
    >>> found.persistent
    3
    """

    simulations: int
    """The number of simulations."""
    none: int
    """The number of simulations without slips behind the spring of the block."""
    transient: int
    """The number of those with slips that end."""
    persistent: int
    """The number of those with slips that do not end."""
    undecided: int
    """The number of those that did not decide within the longest drive."""
    mean_drop: float | None
    """The mean force drop of a slip, over the simulations in which stick-slip persists; None if in none."""
    drop_std: float | None
    """The standard deviation of that drop over these simulations; None if there are fewer than two."""
    period_scatter: float | None
    """The relative standard deviation of the period within a simulation, mean over these simulations."""
    persistent_stiffness: float
    """The largest stiffness at which stick-slip was found to persist, mean over all simulations; inf if it
    persisted at all that were tried, in one of them or more."""
    persistent_stiffness_std: float | None
    """Its standard deviation over the simulations; None for one simulation, or if the mean is infinite."""


class StickSlipStability(NamedTuple):
    """Whether a slider sticks and slips, and behind which springs it does.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.05, time=1.0))
    >>> block = asp.Block(asp.Transport(contacts), 100.0, asp.Damped(1.0))
    >>> block.stick_slip(velocity=1.0).stick_slip
    'none'
    """

    stick_slip: Literal["none", "transient", "persistent", "undecided"]
    """Stick-slip behind the spring of the block."""
    reason: str
    """The reason for that answer, in words."""
    persistent_stiffness: float
    """The largest stiffness at which stick-slip was found to persist; 0 if at none."""
    persistent_stiffness_above: float
    """The smallest stiffness above it at which it was found not to persist; inf if it always persisted."""
    critical_stiffness: float
    """Critical stiffness -min F' of the first pull, below which it ends with a slip."""
    critical_stiffness_sliding: float
    """Critical stiffness of steady sliding, below which small deviations grow; 0 where they never do."""
    mean_drop: float | None
    """The mean force drop of a slip; None unless stick-slip persists."""
    ensemble: SimulatedStickSlip | None
    """The same over single contacts; None without simulations."""


class Sizes(NamedTuple):
    """The number of events of an ensemble by size: ten bins per decade, empty bins left out.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> sizes = asp.Block(asp.Ensemble(contacts, size=100), 1.0).drive(5.0).sizes
    >>> type(sizes).__name__
    'Sizes'
    """

    contacts: "NDArray[np.float64]"
    """The mean number of contacts broken in an event of the bin, shape (n,)."""
    events: "NDArray[np.float64]"
    """The number of events, shape (n,)."""
    slip: "NDArray[np.float64]"
    """The mean slip in such an event, shape (n,), a length."""
    drop: "NDArray[np.float64]"
    """The mean force drop, shape (n,)."""

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the numbers of events by size, on logarithmic axes; it needs matplotlib.

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

        dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4}
        curve = (self.contacts, self.events, None)
        ax = _plot.lines([curve], ("", ""), ax, **{**dots, **style})
        ax.set(xscale="log", yscale="log", xlabel="contacts broken in an event", ylabel="events")
        return ax


class Course(NamedTuple):
    """The time course of an inertial slip: arrays of shape (n,).

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
    >>> slip = asp.Block(theory, 1.0, asp.Inertial(1.0)).drive(5.0).slip_course
    >>> bool(slip.velocity.max() > 0.0)
    True
    """

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

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the forces against time; it needs matplotlib.

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

        curves = [(self.time, self.force, "friction"), (self.time, self.spring_force, "spring")]
        return _plot.lines(curves, ("t", "F"), ax, **style)


class Equilibria(NamedTuple):
    """Equilibria of a slider: arrays of shape (n,), in order of increasing position.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> curve = asp.Block(theory, 0.3).equilibrium(3.0, 31)
    >>> curve.position.shape
    (31,)
    """

    drive: "NDArray[np.float64]"
    """The load-point displacement X_T, a length."""
    position: "NDArray[np.float64]"
    """The position X of the base, a length."""
    force: "NDArray[np.float64]"
    """The friction force F."""
    stable: "NDArray[np.bool_]"
    """Whether the equilibrium is stable."""

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the force against the drive, unstable equilibria dashed; it needs matplotlib.

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
        import numpy as np

        from asperity import _plot

        held = np.where(self.stable, self.force, np.nan)
        ax = _plot.lines([(self.drive, held, "stable")], ("X_T", "F"), ax, **style)
        color = ax.lines[-1].get_color()
        loose = np.where(self.stable, np.nan, self.force)
        ax.plot(self.drive, loose, "--", color=color, linewidth=0.9, label="unstable")
        ax.legend()
        return ax


class Potential(NamedTuple):
    """The potential energy of a slider and its contacts at one drive or several.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> potential = asp.Block(theory, 0.3).potential(1.0, 3.0, 31)
    >>> potential.position.shape
    (31,)
    """

    position: "NDArray[np.float64]"
    """Positions X, shape (n,), a length."""
    energy: "NDArray[np.float64]"
    """The potential V(X_T, X): shape (n,), or (m, n) for a list of m drives."""
    drive: "NDArray[np.float64] | None" = None
    """The drives X_T of a list, shape (m,), a length; None for one potential."""

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the potential, one curve for each drive; it needs matplotlib.

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

        rows = self.energy if self.energy.ndim == 2 else self.energy[None, :]
        labels = _plot.labels_of("X_T", self.drive, len(rows))
        curves = [(self.position, row, label) for row, label in zip(rows, labels, strict=True)]
        return _plot.lines(curves, ("X", "V"), ax, **style)
