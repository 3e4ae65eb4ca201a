"""Small results of fits and of measured curves: named tuples."""

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from asperity._core import Series


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

    def __repr__(self) -> str:
        from asperity import _show

        return _show.machine(self)


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

    def __repr__(self) -> str:
        from asperity import _show

        return _show.machine(self)


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
    name: str = "value"
    """The number, such as thresholds.mean."""

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
        ax.set(xlabel=self.name.replace("_", " "), ylabel=r"rise of $-2\ln L$")
        return ax
