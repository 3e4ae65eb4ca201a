"""Small results: named tuples."""

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from asperity._core import Series


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


class Estimate(NamedTuple):
    """A number that was estimated from a measured curve.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> mean = fitted.params["thresholds.mean"]
    >>> mean.interval[0] < mean.value < mean.interval[1]
    True
    """

    value: float
    """Its most probable value."""
    error: float
    """Its standard error; 0 where it is at the end of its range."""
    interval: tuple[float, float]
    """Its 95 % interval, of a fit 1.96 standard errors to both sides of the value, or of its logarithm for
    numbers above 0 (Student's t for independent errors of unknown size); it ends at inf if the curve gives no
    upper limit.
    """
    limit: float | None = None
    """Where the curve only gives a limit: the value below which it is with 95 %; otherwise None."""


class Drift(NamedTuple):
    """An Ornstein-Uhlenbeck process: noise of covariance std² exp(-X/length) at the distance X.

    Examples
    --------
    >>> import asperity as asp
    >>> drift = asp.Drift(std=0.01, length=2.0)
    >>> drift.std
    0.01
    """

    std: float
    """Its standard deviation, a force."""
    length: float
    """Its correlation length, a length."""


class MeasuredNoise(NamedTuple):
    """The noise of a measured curve.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> x = np.linspace(-5.0, 10.0, 301)
    >>> force = 0.6 + np.where(x < 0.0, 0.0, 0.01 - 0.02 * (1.0 - np.exp(-x)))
    >>> noise = asp.read_velocity_step(x, force, 10.0).noise
    >>> noise.white < 1e-6
    True
    """

    white: float
    """The standard deviation of its white part, a force."""
    drift: list[Drift]
    """The rest: none, one or two processes, those of short correlation lengths first."""


class MachineStep(NamedTuple):
    """Rate-and-state friction behind the spring of a machine, fitted to a velocity step.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> x = np.linspace(-5.0, 10.0, 301)
    >>> force = 0.6 + np.where(x < 0.0, 0.0, 0.01 - 0.02 * (1.0 - np.exp(-x)))
    >>> fitted = asp.fit_velocity_step(x, force, 10.0, stiffness=5.0)
    >>> type(fitted).__name__
    'MachineStep'
    """

    residual: float
    """The root-mean-square residual of the fit, a force."""
    residual_relative: float
    """The residual relative to the difference between the largest and the smallest force."""
    a: float
    """The direct effect a, a force per ln(V/v_0)."""
    b: tuple[float, ...]
    """The evolution effects of the states, a force per ln(V/v_0), that of the shorter distance first."""
    distance: tuple[float, ...]
    """Their characteristic slip distances, a length."""
    before: float
    """The force F_0 before the step."""
    fitted: "NDArray[np.float64]"
    """The fitted force at the displacements, shape (n,)."""


class MachineHealing(NamedTuple):
    """Rate-and-state friction behind the spring of a machine, fitted to slide-hold-slide tests.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> hold = np.array([1.0, 10.0, 100.0, 1000.0])
    >>> fitted = asp.fit_healing(hold, 0.01 * np.log1p(hold), 0.0, velocity=1.0, stiffness=0.01, a=0.01)
    >>> type(fitted).__name__
    'MachineHealing'
    """

    residual: float
    """The root-mean-square residual of the fit, a force."""
    residual_relative: float
    """The residual relative to the difference between the largest and the smallest force, F_0 among them."""
    a: float
    """The direct effect a, a force per ln(V/v)."""
    b: float
    """The evolution effect b, a force per ln(V/v)."""
    distance: float
    """The characteristic slip distance D, a length."""
    before: float
    """The force F_0 of steady sliding."""
    fitted: "NDArray[np.float64]"
    """The fitted highest force after each hold, shape (n,)."""
    fitted_held: "NDArray[np.float64]"
    """The fitted force at the end of each hold, shape (n,)."""


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
        curves = [(self.position, row, None) for row in rows]
        return _plot.lines(curves, ("X", "V"), ax, **style)


class Correlation(NamedTuple):
    """The correlation of the errors of two estimates.

    Examples
    --------
    >>> import asperity as asp
    >>> found = asp.Correlation(between=("count", "stiffness"), coefficient=-0.98)
    >>> found.coefficient
    -0.98
    """

    between: tuple[str, str]
    """Their names."""
    coefficient: float
    """The coefficient, from -1 to 1."""


class Misfit(NamedTuple):
    """How well a fit describes a measured curve.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> fitted.misfit.degrees_of_freedom
    19
    """

    chi_squared: float
    """χ² = rᵀΣ⁻¹r of the residuals r, with Σ the covariance of their errors."""
    degrees_of_freedom: int
    """The number of readings less that of the numbers of the expected curve that they determine; of
    thresholds of free form the effective number.
    """
    probability: float | None
    """The probability of a larger χ²; None where the sizes of errors are estimated, so that χ² is no test."""
    whiteness: float
    """The probability of more autocorrelated whitened residuals, by the test of Ljung and Box."""
    deviance: float
    """-2 ln L at the estimates, priors included; sizes of errors are those of the restricted likelihood."""
    akaike: float
    """Akaike's criterion: -2 ln L plus twice the number of free numbers, those of errors included; of
    thresholds of free form the effective number, without their penalty in -2 ln L.
    """
    unlikely: bool
    """Whether one of the probabilities is below 0.001: the curve is then not of the kind that was fitted, and
    the errors of the estimates cannot be trusted.
    """


class WithError(NamedTuple):
    """A value with its standard error.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.WithError(value=1.0, error=0.1).error
    0.1
    """

    value: float
    """The value."""
    error: float
    """Its standard error; nan where the value has no derivative."""


class FrictionEstimates(NamedTuple):
    """Friction of fitted contacts, with the errors of the estimates propagated to it.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> round(fitted.friction().kinetic_friction.value, 1)
    520.0
    """

    static_friction: WithError | None
    """F_s, a force; None if it is not reached."""
    kinetic_friction: WithError
    """F_k, a force."""
    relaxation_length: WithError
    """X*, a length."""
    critical_stiffness: WithError
    """K_c, force per length."""


class FreeForm(NamedTuple):
    """Thresholds of free form, found by a fit: their density and distribution function with errors.

    Arrays have shape (n,).

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> found = fitted.free_form(kernels=12)
    >>> found.threshold.shape == found.density.shape
    True
    """

    thresholds: "Series"
    """The distribution."""
    mean: WithError
    """The mean threshold, a length."""
    std: WithError
    """The standard deviation of the thresholds, a length."""
    effective: float
    """The number of parameters of the shape beyond a Gaussian that the curve determines."""
    converged: bool
    """Whether the search has converged."""
    threshold: "NDArray[np.float64]"
    """Thresholds."""
    density: "NDArray[np.float64]"
    """P_c, per length."""
    low: "NDArray[np.float64]"
    """Lower ends of the intervals of 95 % of P_c."""
    high: "NDArray[np.float64]"
    """Their upper ends."""
    cumulative: "NDArray[np.float64]"
    """The distribution function."""
    cumulative_error: "NDArray[np.float64]"
    """Its standard error."""

    def __repr__(self) -> str:
        from asperity import _show

        shown = {
            name: f"{one.value:.5g} ± {one.error:.2g}"
            for name, one in (("mean", self.mean), ("std", self.std))
        }
        shown["effective"] = f"{self.effective:.1f} parameters beyond a Gaussian"
        if not self.converged:
            shown["converged"] = "False"
        shown["density"] = (
            f"at {len(self.threshold)} thresholds from {self.threshold[0]:.4g} to {self.threshold[-1]:.4g}"
        )
        return _show.listed("<asperity.FreeForm>", shown)

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the density with its interval of 95 %; it needs matplotlib.

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

        ax = _plot.lines([(self.threshold, self.density, None)], ("x", "P_c"), ax, **style)
        color = ax.lines[-1].get_color()
        ax.fill_between(self.threshold, self.low, self.high, color=color, alpha=0.2, linewidth=0)
        # Where nothing is known the interval may go far beyond.
        ax.set_ylim(0.0, 2.0 * self.density.max())
        return ax


class Prediction(NamedTuple):
    """Readings expected of fitted contacts: arrays of shape (n,).

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> fitted.predict([0.5, 1.0]).force.shape
    (2,)
    """

    force: "NDArray[np.float64]"
    """The expected force."""
    std: "NDArray[np.float64]"
    """The standard deviation of a reading about it: noise of contacts, independent error and drift."""
    error: "NDArray[np.float64]"
    """The standard error of the expected force, from the covariance of the estimates."""
    position: "NDArray[np.float64]"
    """The positions of the readings, a length."""

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the expected force with a band of two standard deviations of a reading; it needs matplotlib.

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

        return _plot.prediction(self, ax, **style)


class PosteriorNumber(NamedTuple):
    """A number by draws from its posterior.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> number = fitted.sample(draws=50, chains=2, seed=1).params["thresholds.mean"]
    >>> number.interval[0] < number.mean < number.interval[1]
    True
    """

    mean: float
    """The mean of the draws."""
    std: float
    """Their standard deviation."""
    median: float
    """Their median."""
    interval: tuple[float, float]
    """Their quantiles of 2.5 and 97.5 %."""
    r_hat: float
    """The rank-normalised r̂ of the halves of the chains: near 1 where they agree; above 1.01 more draws
    are needed.
    """
    ess: float
    """The effective number of independent draws; for intervals 400 or more are needed."""


class Profile(NamedTuple):
    """The profile of the likelihood of a number: arrays of shape (n,).

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> profile = fitted.profile("thresholds.mean")
    >>> profile.values.shape == profile.rise.shape
    True
    """

    values: "NDArray[np.float64]"
    """Values of the number."""
    rise: "NDArray[np.float64]"
    """By how much -2 ln L, lowest in all other free numbers, is above its minimum; 3.84 at the ends of the
    interval of 95 %. inf where there is no curve.
    """

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots the rise, with that at the ends of the interval of 95 %; it needs matplotlib.

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

        ax = _plot.lines([(self.values, self.rise, None)], ("", ""), ax, **style)
        ax.axhline(3.84, linestyle="--", linewidth=0.8, color=_plot.muted())
        ax.set(xlabel="value", ylabel=r"rise of $-2\ln L$")
        return ax
