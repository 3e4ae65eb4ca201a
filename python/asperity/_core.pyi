"""The compiled part of asperity."""

from collections.abc import Callable, ItemsView, Iterator, KeysView, Mapping, Sequence, ValuesView
from datetime import timedelta
from os import PathLike
from pathlib import Path
from typing import (
    Any,
    Final,
    Literal,
    Self,
    SupportsFloat,
    SupportsIndex,
    TypeAlias,
    TypeVar,
    final,
    overload,
)

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray
from scipy.stats import gaussian_kde
from scipy.stats.distributions import rv_frozen
from typing_extensions import disjoint_base
from xarray import Dataset

from asperity._events import Event, Events
from asperity._fit_values import (
    Correlation,
    Estimate,
    FreeForm,
    FrictionEstimates,
    MachineHealing,
    MachineStep,
    MeasuredNoise,
    Misfit,
    PosteriorNumber,
    Prediction,
    Profile,
)
from asperity._slider_values import (
    Course,
    Energy,
    Equilibria,
    InterfaceEnergy,
    Potential,
    Sizes,
    Stability,
    State,
    StickSlipStability,
)
from asperity._values import Atoms, Label, StaticFriction, StretchDensity

_T = TypeVar("_T")
_Array: TypeAlias = NDArray[np.float64]
_Number: TypeAlias = SupportsFloat | SupportsIndex
_AnyLaw: TypeAlias = Law | rv_frozen | gaussian_kde | NDArray[Any] | Sequence[float]
_Seed: TypeAlias = SupportsIndex | np.random.Generator | np.random.RandomState
_Progress: TypeAlias = Callable[[float], object] | bool | None
__all__ = [
    "Ageing",
    "Areas",
    "Block",
    "ClosedForm",
    "Contacts",
    "Damped",
    "Deformable",
    "Description",
    "Ensemble",
    "EnsemblePull",
    "Estimates",
    "ExactErlang",
    "ExactGamma",
    "ExactGaussian",
    "ExactIdentical",
    "ExactQuenched",
    "ExactRectangular",
    "Exponential",
    "FrictionGradient",
    "FrozenRank",
    "Gamma",
    "Gaussian",
    "Gradient",
    "Healing",
    "Inertial",
    "Interface",
    "Lattice",
    "Law",
    "Logarithmic",
    "Lognormal",
    "MasterEquation",
    "MeanField",
    "Mixture",
    "Model",
    "Point",
    "Posterior",
    "Pull",
    "Record",
    "Rectangular",
    "Relaxation",
    "Renormalised",
    "Result",
    "Series",
    "Simulation",
    "Smoluchowski",
    "SteadyEstimates",
    "SteadyState",
    "Step",
    "StickSlip",
    "Tabulated",
    "Temperature",
    "ThresholdResponse",
    "Transport",
    "VelocityCurveEstimates",
    "VelocityStep",
    "Weibull",
    "_Engine",
    "_Sweep",
    "__version__",
    "_command",
    "_complete_text",
    "_explorer_page",
    "_measured_pieces",
    "_resolve",
    "_restore",
    "_restore_fit",
    "_restore_result",
    "_sweep_cases",
    "critical_coupling",
    "fit",
    "fit_healing",
    "fit_steady",
    "fit_velocity_curve",
    "fit_velocity_step",
    "kinetic_friction",
    "kinetic_friction_per_threshold",
    "open_result",
    "read_healing",
    "read_velocity_step",
    "run",
    "scenario",
    "steady_variance",
    "steady_variance_per_threshold",
]
__version__: Final[str]

class Ageing(Description):
    """Ageing: thresholds that change with the age of a contact. Its models are Smoluchowski, FrozenRank,
    Logarithmic and MeanField.

    Examples
    --------
    >>> import asperity as asp
    >>> isinstance(asp.Logarithmic(growth=0.1, time=1.0), asp.Ageing)
    True
    """

    ...

@final
class Areas(Description):
    """Contacts described by their areas A: a contact has the stiffness k = modulus √A and breaks at the force
    strength × A.

    Its threshold is thus x_s = (strength/modulus) √A, and k = κ x_s with κ = modulus²/strength.

    Parameters
    ----------
    law
        The distribution of areas, in units of length².
    modulus
        Stiffness divided by the square root of the area, force per length² (ρc² in Braun and Peyrard 2008), above 0.
    strength
        Force per area at which a contact breaks, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a modulus or a strength that is not above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> areas = asp.Areas(asp.Exponential(1.0), modulus=2.0, strength=1.0)
    >>> contacts = asp.Contacts(areas=areas)
    >>> contacts.areas.modulus
    2.0
    """

    def __new__(cls, /, law: _AnyLaw, modulus: _Number, strength: _Number) -> Areas: ...
    @property
    def law(self, /) -> Law:
        """The distribution of areas, in units of length²."""

    @property
    def modulus(self, /) -> float:
        """The stiffness divided by the square root of the area, force per length²."""

    @property
    def strength(self, /) -> float:
        """The force per area at which a contact breaks."""

@final
class Block(Description):
    """A slider block: its top (the load point, at X_T) is driven, its base (at X) is held by contacts, and its
    shear stiffness K connects them.

    K(X_T - X) = F(X). Where F decreases more steeply than the spring force, F' < -K, the slider becomes
    unstable and slips at fixed X_T (Braun and Peyrard 2008).

    Contacts with a background force B add it to F, against the motion; forces contain it. X_T is counted from
    where the spring carries B, K(X_T - X) + B = F + B as long as the base slides forward. A slider that would move
    back stays at rest until its spring has lost 2B.

    Parameters
    ----------
    model
        The contacts: a MasterEquation or an Ensemble, or, for motion in time, a Transport or an Ensemble.
    stiffness
        The stiffness K, force per length, above 0; None or inf for a rigid slider, which is always stable.
    slip
        The slip rule: "reset" if all contacts break and re-form, and the spring is relaxed; "overdamped" if the
        slider moves to the next equilibrium while contacts break and re-form; "arrest" if contacts that break stay
        detached until it has stopped; Damped for motion against a viscous damping; Inertial for motion with mass.
    slip_fraction
        An event is a slip if more than this fraction of the contacts of an ensemble break at one drive, above 0, up
        to 1.

    Raises
    ------
    ValueError
        For a stiffness that is not above 0, a slip that is none of these words, a slip_fraction that is not above 0
        and up to 1, and, with Inertial, a damping above 1000 √(MK), with which a slip would take too long to follow.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> run = asp.Block(theory, stiffness=1.0).drive(distance=3.0)
    >>> run.regime
    'undecided'
    >>> round(run.first_instability.force, 6)
    0.773611
    """

    def __new__(
        cls,
        /,
        model: Model,
        stiffness: _Number | None,
        slip: Literal["reset", "overdamped", "arrest"] | Damped | Inertial = "reset",
        *,
        slip_fraction: _Number = 0.05,
    ) -> Block: ...
    def drive(
        self,
        /,
        distance: _Number | None = None,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        turning_points: ArrayLike | None = None,
        force_to: _Number | None = None,
        progress: _Progress = None,
    ) -> StickSlip:
        """Moves the load point of the slider from X_T = 0, or imposes a force, and computes the motion of its base.

        Parameters
        ----------
        distance
            The load-point displacement, a length above 0; 20 by default.
        turning_points
            Instead, successive positions X_T of the load point, for driving back and forth.
        force_to
            Instead, an imposed force, above 0, up to which a slider of infinite stiffness is pulled, whatever its
            position.
        points
            The number of points of the trace, evenly spaced along the drive, including both ends; 2 or more; turning
            points, and points before and after every slip, are added.
        velocity
            The velocity of the load point, above 0, for motion in time as by follow; required over a Transport, and
            over time-dependent contacts.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        StickSlip

        Raises
        ------
        ValueError
            For a distance, a velocity or an imposed force that is not above 0, more than one of distance,
            turning_points and force_to, turning points that do not turn, fewer than 2 points, an imposed force with a
            finite stiffness, no velocity for a Transport, and a velocity for a MasterEquation.
        MemoryError
            For results that do not fit or too many point masses.
        RuntimeError
            If the tolerance is not reached.
        """

    def equilibrium(self, /, distance: _Number | None = None, points: SupportsIndex = 2001) -> Equilibria:
        """The equilibria X_T(X) = X + F(X)/K of the first loading, without slips: drive, position, force, and whether
        the slider is stable there, F' + K > 0.

        Parameters
        ----------
        distance
            The displacement of the base, a length above 0; by default 5 mean thresholds.
        points
            The number of positions, evenly spaced, including both ends; 2 or more; where the force jumps, both sides
            are added.

        Returns
        -------
        Equilibria

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a distance that is not above 0, fewer than 2 points, and a Transport.
        """

    def follow(self, /, steps: Sequence[Step], *, progress: _Progress = None) -> StickSlip:
        """Moves the load point of the slider from equilibrium at t = 0 through the steps, one after the other, and
        integrates the motion of its base: MẌ = K(X_T - X) - F - γẊ.

        The slip rule is Damped or Inertial, because something must limit the slip velocity, or the default: without mass
        and damping the spring is in balance at every time, K(X_T - X) = F, and a slip is an error. A slip is the
        interval in which the base is more than ten times as fast as the load point; over an ensemble it also breaks
        more than the fraction slip_fraction of the contacts.

        Parameters
        ----------
        steps
            A list of Step.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        StickSlip

        Raises
        ------
        ValueError
            For no steps, another slip rule, a slip without damping and mass, a rigid slider, or a MasterEquation,
            which has one velocity.
        """

    @property
    def model(self, /) -> MasterEquation | Transport | Ensemble:
        """The model of the contacts."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the equilibria of the first loading, as the plot() of equilibrium(); it needs matplotlib, whose styles it
        follows.

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

    def potential(
        self, /, drive: ArrayLike, distance: _Number | None = None, points: SupportsIndex = 2001
    ) -> Potential:
        """The potential V(X_T, X) = ½K(X_T - X)² + ∫F dX of the first loading; at its minima the slider is in stable
        equilibrium.

        The result has `position` of shape (n,), `energy` of shape (n,) or (m, n), and the drives of a list as `drive`.

        Parameters
        ----------
        drive
            A drive X_T, or a list of m of them.
        distance, points
            As for equilibrium.

        Returns
        -------
        Potential

        Raises
        ------
        ValueError
            For a rigid slider, which has no potential.
        """

    def simulation(self, /, *, velocity: _Number | None = None) -> Simulation:
        """Parameters
        ----------
        velocity
            The velocity of the load point, above 0, for motion in time; required over a Transport, and over an
            Ensemble of time-dependent contacts.

        Returns
        -------
        Simulation
            A simulation that advances step by step, at X_T = 0, or in equilibrium with the contacts of a Transport.

        Raises
        ------
        ValueError
            For a Transport without a velocity, a MasterEquation with one, and for a slip rule that has no meaning in
            time; for time-dependent contacts without a velocity unless the MasterEquation has one.
        """

    @property
    def slip(self, /) -> Literal["reset", "overdamped", "arrest"] | Damped | Inertial:
        """The slip rule: "reset", "overdamped", "arrest", Damped or Inertial."""

    @property
    def slip_fraction(self, /) -> float:
        """An event is a slip if more than this fraction of the contacts of an ensemble break at one drive."""

    def stability(self, /, velocity: _Number, *, progress: _Progress = None) -> Stability:
        """Linear stability of steady sliding at a velocity, with the stiffness, mass and damping of this slider, from
        the dynamic stiffness of the contacts of its Transport.

        Parameters
        ----------
        velocity
            The velocity of the load point, above 0.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        Stability
            A Stability of `critical_stiffness`, above which steady sliding is stable, the `frequency` of the
            oscillation that sets in there, and the `growth_rate` and `growth_frequency` of the fastest growing
            deviation, 0 where sliding is stable. The critical stiffness is accurate to 1e-8 of the stiffness of all
            contacts with temperature or ageing by age, to 1e-4 with both, and to 1e-3, or that of itself where it is
            larger, for thresholds that diffuse.

        Raises
        ------
        ValueError
            For a rigid slider, for the slip rules "reset", "overdamped" and "arrest", for a model that is not a
            Transport, and for a velocity that is not above 0.
        """

    def stick_slip(
        self,
        /,
        velocity: _Number | None = None,
        *,
        resolution: _Number = 0.02,
        size: SupportsIndex | None = None,
        simulations: SupportsIndex | None = None,
        seed: _Seed = 1,
        progress: _Progress = None,
    ) -> StickSlipStability:
        """Whether this slider sticks and slips when its load point is moved on at a constant velocity, and behind which
        springs it does.

        The slider is moved until its motion decides, first behind its own spring, then behind others: the stiffness at
        which persistent stick-slip ends is bisected, down to 1e-3 of the stiffness of all contacts. With a size, this is
        repeated over that many single contacts, in several simulations with different contacts, in which an event is a slip
        if it breaks more than the slip_fraction of the block.

        Parameters
        ----------
        velocity
            The velocity of the load point, above 0; required for time-dependent contacts, unless the model is a
            MasterEquation at a velocity; without effect for others.
        resolution
            The ratio of the two stiffnesses that enclose that end is at most 1 + resolution.
        size
            The number of single contacts of a simulation, 1 or more; None: no simulations.
        simulations
            The number of simulations, 1 or more, by default 10; only with a size.
        seed
            The seed of the random numbers.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        StickSlipStability
            A StickSlipStability of `stick_slip` ("none", "transient", "persistent" or "undecided") with its `reason`,
            `persistent_stiffness` and `persistent_stiffness_above`, between which persistent stick-slip ends, and the
            critical stiffnesses of the first pull and of steady sliding; with a size, its `ensemble` is a
            SimulatedStickSlip.

        Raises
        ------
        ValueError
            For a rigid slider, an Ensemble, a Transport that starts in steady sliding, no contacts, no simulations, a
            number of them without a size, and for a slip rule that has no meaning in time, or a slip without mass and
            damping, where contacts are time-dependent.
        """

    @property
    def stiffness(self, /) -> float:
        """The shear stiffness K, force per length; inf for a rigid slider."""

@disjoint_base
class ClosedForm:
    """A friction curve F(X) in closed form, per total stiffness: F/(N_c⟨k⟩), the mean stretch, a length.

    All contacts start and re-form at stretch 0, unless the class says otherwise. Positions X are lengths from 0
    up to where the sums would become long. For every density p of thresholds with n-fold convolutions p_n,
    F'(X) = 1 - X Σ p_n(X)/n. Each closed form is the sum of this series for one family, and none shares code
    with the solvers.

    Examples
    --------
    >>> import asperity as asp
    >>> isinstance(asp.exact.Identical(1.0), asp.exact.ClosedForm)
    True
    """

    @property
    def critical_stiffness(self, /) -> float:
        """K_c/(N_c⟨k⟩) = max(0, -min F'), a number; inf where F jumps down."""

    @overload
    def force(self, /, position: float) -> float:
        """F(X)/(N_c⟨k⟩), a length; where contacts break simultaneously, after the break.

        Parameters
        ----------
        position
            Positions X, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0, or beyond 1e5 mean thresholds of Gaussian and Gamma or 300 of Rectangular.
        """

    @overload
    def force(self, /, position: ArrayLike) -> _Array: ...
    @property
    def kinetic_friction(self, /) -> float:
        """F_k/(N_c⟨k⟩), the force of steady sliding, a length."""

    @overload
    def slope(self, /, position: float) -> float:
        """F'(X)/(N_c⟨k⟩) from the right, a number.

        Parameters
        ----------
        position
            Positions X, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0, or beyond 1e5 mean thresholds of Gaussian and Gamma or 300 of Rectangular.
        """

    @overload
    def slope(self, /, position: ArrayLike) -> _Array: ...
    @property
    def static_friction(self, /) -> StaticFriction | None:
        """The maximum F_s/(N_c⟨k⟩) with its position X_s, both lengths; None if F only rises."""

@final
class Contacts(Description):
    """The contacts of an interface: when they break, how stiff they are, how they re-form.

    Contacts with temperature, ageing or delay are time-dependent: their friction depends on the velocity, which
    must be given.

    Distributions may be those of asperity, frozen ones of scipy.stats, or samples: see asperity.law.

    Parameters
    ----------
    thresholds
        The distribution P_c of the stretches at which contacts break.
    areas
        Areas, from which thresholds and stiffnesses follow, instead of thresholds.
    reforming
        The distribution R of the stretches at which they re-form, by default all at 0. Models leave out stretches
        beyond the thresholds, at most half of them, and warn of the share.
    count
        The number N_c of contacts, above 0; with 1, forces are per contact.
    stiffness
        The stiffness ⟨k⟩ of a contact, force per length, 1 by default.
    stiffness_per_threshold
        The κ of stiffnesses k = κ x_s that are proportional to the threshold, instead of stiffness.
    stiffness_of_threshold
        A pair of lists, thresholds x_s and the stiffness k of a contact with each of them: k(x_s) is linear between
        them and constant beyond, instead of stiffness. For contacts without temperature, ageing and delay.
    normal_load
        The normal load, a force; with it, results of scenarios have friction coefficients.
    background_force
        A friction force B in addition to that of the contacts, against the motion, 0 or above. Forces of a Block and
        of results of scenarios contain it, those of a MasterEquation, a Transport and an Ensemble do not.
    background_coefficient
        The μ_b of B = μ_b normal_load, instead of background_force.
    temperature
        Thermally activated breaking below the thresholds.
    ageing
        Change of the thresholds with the age of a contact; thresholds is then the distribution of fresh contacts.
    delay
        Time for which a broken contact is detached before it re-forms, 0 by default: a number, or a distribution of times.
        Re-forming at a rate is Exponential(1/rate).
    free_friction
        Friction force of a detached contact, which slides, 0 by default.
    free_viscosity
        What its friction force gains per velocity, 0 by default.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For both or neither of thresholds and areas; more than one of stiffness, stiffness_per_threshold and
        stiffness_of_threshold, or one beside areas; both of background_force and background_coefficient, or the latter
        without normal_load; a count, a stiffness or a normal_load that is not above 0; and a background_force, a
        background_coefficient or a delay below 0. Rules that do not go together are refused by the models.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), count=1000, stiffness=2.0)
    >>> contacts.stiffness
    2.0
    >>> contacts.replace(count=10).count
    10.0
    """

    def __new__(
        cls,
        /,
        thresholds: _AnyLaw | None = None,
        reforming: _AnyLaw | None = None,
        *,
        areas: Areas | None = None,
        count: _Number = 1.0,
        stiffness: _Number | None = None,
        stiffness_per_threshold: _Number | None = None,
        stiffness_of_threshold: tuple[ArrayLike, ArrayLike] | None = None,
        normal_load: _Number | None = None,
        background_force: _Number | None = None,
        background_coefficient: _Number | None = None,
        temperature: Temperature | None = None,
        ageing: Ageing | None = None,
        delay: _Number | _AnyLaw | None = None,
        free_friction: _Number = 0.0,
        free_viscosity: _Number = 0.0,
    ) -> Contacts: ...
    @property
    def ageing(self, /) -> Ageing | None:
        """The model of ageing, or None."""

    @property
    def areas(self, /) -> Areas | None:
        """The areas from which thresholds and stiffnesses follow, or None."""

    @property
    def background_coefficient(self, /) -> float | None:
        """The background force divided by the normal load, or None."""

    @property
    def background_force(self, /) -> float | None:
        """The background force B, a force, or None."""

    @property
    def count(self, /) -> float:
        """The number N_c of contacts."""

    @property
    def delay(self, /) -> float | Law:
        """The time for which a broken contact is detached before it re-forms, or the distribution of these times."""

    @property
    def free_friction(self, /) -> float:
        """The friction force of a detached contact."""

    @property
    def free_viscosity(self, /) -> float:
        """What the friction force of a detached contact gains per velocity."""

    @property
    def normal_load(self, /) -> float | None:
        """The normal load, a force, or None."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the distributions of the thresholds and of the stretches at which contacts re-form, or that of the areas;
        point masses are stems. It needs matplotlib, whose styles it follows.

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

    @property
    def reforming(self, /) -> Law:
        """The distribution R of the stretches at which contacts re-form."""

    @property
    def stiffness(self, /) -> float | None:
        """The stiffness ⟨k⟩ of a contact, force per length; None where it depends on the threshold."""

    @property
    def stiffness_of_threshold(self, /) -> tuple[list[float], list[float]] | None:
        """Thresholds x_s and the stiffness k of a contact with each of them, or None."""

    @property
    def stiffness_per_threshold(self, /) -> float | None:
        """The κ of stiffnesses k = κ x_s, force per length²; None where stiffness does not depend on the threshold, and for
        contacts described by their areas.
        """

    @property
    def temperature(self, /) -> Temperature | None:
        """The temperature of thermally activated breaking, or None."""

    @property
    def thresholds(self, /) -> Law | None:
        """The distribution P_c of the stretches at which contacts break; None for contacts described by their areas."""

@final
class Damped(Description):
    """The slip of a slider without mass against a viscous damping, γẊ = K(X_T - X) - F.

    Over time-independent contacts, at fixed X_T, it ends where "overdamped" does.

    Parameters
    ----------
    damping
        The viscous damping γ, force per velocity, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a damping that is not above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> asp.Block(theory, 1.0, asp.Damped(0.1)).slip
    Damped(damping=0.1)
    """

    def __new__(cls, /, damping: _Number) -> Damped: ...
    @property
    def damping(self, /) -> float:
        """The viscous damping γ, force per velocity."""

class Deformable(Description):
    """What the kinds of interfaces have in common: a drive of their load point.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> chain = asp.Interface(contacts, [4], connection=1.0, neighbours=2.0)
    >>> isinstance(chain, asp.Deformable)
    True
    """

    def _first_breaks(
        self, /, runs: SupportsIndex, points: SupportsIndex, *, progress: _Progress = None
    ) -> Result: ...
    @property
    def cells(self, /) -> list[int]:
        """The length of a chain, or rows and columns of a lattice."""

    @property
    def connection(self, /) -> float:
        """K_0, the stiffness of the spring between a cell, or a contact, and the drive."""

    @property
    def contacts(self, /) -> Contacts:
        """The contacts."""

    def drive(
        self,
        /,
        distance: _Number = 20.0,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        tolerance: _Number | None = None,
        maps: ArrayLike | None = None,
        catalogue_from: _Number = 0.0,
        slip_rates: SupportsIndex | None = None,
        main_shocks: tuple[int, float] | tuple[int, float, int] | None = None,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> Result:
        """Drives the interface over distance, from event to event. X_T begins where the springs to the drive are in balance
        with the contacts: at 0 for relaxed ones, and for time-dependent ones with start="steady" in steady sliding at
        velocity.

        Parameters
        ----------
        distance
            The displacement of the drive, above 0.
        points
            The number of points of the trace, including both ends.
        velocity
            The velocity of the drive, above 0; required for time-dependent contacts and for cells with a mass.
        tolerance
            The allowed error of the force of a cell per mean threshold and per stiffness, 1e-10 by default. Cells
            that move in time have none by default, and errors of 1e-4 mean thresholds in a step; with a tolerance,
            steps are shorter, and the error is estimated by a second motion.
        maps
            A list of drives, in increasing order, at which the state of every cell is stored; for a chain it is also
            stored at every point.
        catalogue_from
            Events are recorded from this drive on.
        slip_rates
            The largest number of steps in time at which the velocity of every cell is stored, as `slip_rate` of shape
            (steps, cells) at `slip_rate_time`; None for none. Steps are short in events.
        main_shocks
            The size and the window of main shocks of a Lattice, around which foreshocks and aftershocks are counted: the
            smallest number of breaks, and the length of the window on each side in mean intervals between events; as the third
            number the largest distance of epicentres in cells. None for no statistics.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.
        threads
            The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
            the process, one per core or RAYON_NUM_THREADS.

        Returns
        -------
        Result
            The Result of the equivalent scenario: its `events` are the catalogue, and its `summary["catalogue"]`
            describes the distributions of their sizes and intervals. run computes the same scenarios and can write
            checkpoints.

        Raises
        ------
        ValueError
            For a distance or a velocity that is not above 0, no velocity for time-dependent contacts or cells with a
            mass, main_shocks of an Interface, fewer than 2 points, a tolerance that is not from 1e-12 to 1e-2, maps that do not rise or lie beyond
            the distance, a catalogue_from below 0, fewer than 2 slip_rates, or some for cells that do not move in
            time, a number of threads out of its range, and more results than fit in memory.
        """

    @property
    def edges(self, /) -> Literal["open", "periodic"]:
        """The edges, "open" or "periodic"."""

    def follow(
        self,
        /,
        steps: Sequence[Step],
        *,
        tolerance: _Number | None = None,
        catalogue_from: _Number = 0.0,
        slip_rates: SupportsIndex | None = None,
        main_shocks: tuple[int, float] | tuple[int, float, int] | None = None,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> Result:
        """Moves the load point from balance at t = 0 through the steps, one after the other: velocity steps and holds of an
        interface over time-dependent contacts.

        Parameters
        ----------
        steps
            A list of Step. With start="steady" all cells slide steadily at the velocity of the first one.
        tolerance, catalogue_from, slip_rates, main_shocks, progress, threads
            As for drive.

        Returns
        -------
        Result
            The Result of the equivalent scenario, with the state of every cell of a chain at every point of the
            trace, and of a lattice where steps begin and end.

        Raises
        ------
        ValueError
            For no steps, for time-independent contacts, and for more results than fit in memory.
        """

    @property
    def initial(self, /) -> Law:
        """The distribution Q_ini of the stretches of all contacts at X_T = 0."""

    @property
    def neighbours(self, /) -> float | None:
        """K_int, the stiffness of the spring between two neighbours; None on a half-space."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the distributions of the contacts, as Contacts.plot, with that of their initial stretches.

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

    @property
    def seed(self, /) -> int:
        """The seed of the random numbers."""

    def simulation(
        self, /, *, velocity: _Number | None = None, tolerance: _Number | None = None
    ) -> Simulation:
        """Parameters
        ----------
        velocity, tolerance
            As for drive, but the error is not estimated.

        Returns
        -------
        Simulation
            A simulation that advances step by step, at X_T = 0; with start="steady", in balance at the velocity.

        Raises
        ------
        ValueError
            For a velocity that is not above 0, none for time-dependent contacts or cells with a mass, and a tolerance
            that is not from 1e-12 to 1e-2.
        """

    @property
    def start(self, /) -> Literal["conditional", "relaxed", "steady"]:
        """The kind of the initial state, "conditional", "relaxed" or "steady"."""

@disjoint_base
class Description:
    """A description in plain values: immutable, comparable and hashable by its values, and printed as the Python
    code that creates it.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.Contacts(asp.Gaussian(1.0, 0.1)) == asp.Contacts(asp.Gaussian(1.0, 0.1))
    True
    >>> asp.Gaussian(1.0, 0.1)
    Gaussian(mean=1.0, std=0.1)
    """

    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self, /) -> int: ...
    def __reduce__(self, /) -> tuple[Any, tuple[str, str]]: ...
    def __replace__(self, /, **changes: Any) -> Self: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def parameters(self, /) -> dict[str, Any]:
        """The arguments that create an equal object, by name, without those that have their default."""

    def replace(self, /, **changes: Any) -> Self:
        """A copy with some of the arguments replaced.

        Parameters
        ----------
        **changes
            New values of arguments by their names.

        Returns
        -------
        Description
            One of the same class.

        Raises
        ------
        ValueError
            Or TypeError as the class itself does.
        """

@final
class Ensemble(Model):
    """Random contacts followed one by one (Monte Carlo): the earthquake-like model.

    Parameters
    ----------
    contacts, initial, start
        As for MasterEquation.
    size
        The number of simulated contacts; forces are scaled to the count of the contacts.
    seed
        A whole number below 2^63, which always gives the same numbers, on any number of threads, or a
        numpy.random.Generator, from which one such number is drawn.
    disorder
        "annealed" if a contact that re-forms gets a new threshold, as in the master equation; "quenched" if it keeps
        its own.

    Raises
    ------
    ValueError
        For distributions that leave no possible stretch for a contact.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> pull = asp.Ensemble(contacts, size=1000, seed=1).pull(distance=5.0, points=11)
    >>> pull.force.shape
    (11,)
    >>> bool(abs(pull.force[1] - 0.5) < 1e-3)
    True
    """

    def __new__(
        cls,
        /,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        size: SupportsIndex = 100000,
        seed: _Seed = 1,
        disorder: Literal["annealed", "quenched"] = "annealed",
        start: Literal["conditional", "relaxed", "steady"] = "conditional",
    ) -> Ensemble: ...
    @property
    def disorder(self, /) -> Literal["annealed", "quenched"]:
        """The kind of disorder, "annealed" or "quenched"."""

    def follow(self, /, steps: Sequence[Step], *, progress: _Progress = None) -> Record:
        """Follows the contacts from t = 0 through the steps, one after the other.

        Parameters
        ----------
        steps
            A list of Step.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        Record
            A Record of variables of shape (n,), with n output points of all steps (steps share the point where they
            meet): `time`, `position`, `force`, its standard error `force_error`, and `free`, the detached fraction:
            contacts that are broken and have not yet re-formed. Where relative_normal_load varies also that variable, as
            for Transport.follow.

        Raises
        ------
        ValueError
            For no steps, a relative_normal_load of the first step that is not 1, and for ageing by MeanField, which is not a rule for a single contact.
        """

    def pull(
        self,
        /,
        distance: _Number = 20.0,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        snapshots: ArrayLike | None = None,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> EnsemblePull:
        """Displaces the slider's base from X = 0 to distance, from break to break.

        Parameters
        ----------
        distance, points, progress
            As for MasterEquation.pull.
        velocity
            The velocity of the slider, above 0; required only for time-dependent contacts.
        snapshots
            A list of m positions, in increasing order, at which the stretches are counted.
        edges
            A list of edges of the n bins of these counts, in increasing order; by default bins of equal width up to
            where hardly any contact holds. Ctrl-C interrupts the computation.
        threads
            The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
            the process, one per core or RAYON_NUM_THREADS.

        Returns
        -------
        EnsemblePull

        Raises
        ------
        ValueError
            For a distance or a velocity that is not above 0, no velocity for time-dependent contacts, fewer than 2
            points, snapshots that do not rise or lie beyond the distance, edges below 0 or that do not rise, and a
            number of threads out of its range.
        MemoryError
            For results that do not fit.
        """

    @property
    def seed(self, /) -> int:
        """The seed of the random numbers."""

    def simulation(self, /, *, velocity: _Number | None = None) -> Simulation:
        """Its events are the breaks of contacts; in time it has none.

        Parameters
        ----------
        velocity
            The velocity of the slider in time, above 0; required for time-dependent contacts.

        Returns
        -------
        Simulation
            A simulation of the contacts under a rigid slider that advances step by step, at X = 0.

        Raises
        ------
        ValueError
            For time-dependent contacts without a velocity.
        """

    @property
    def size(self, /) -> int:
        """The number of simulated contacts."""

@final
class EnsemblePull(Record):
    """A pull of an ensemble: the friction force with its standard error, and counts of the stretches.

    Its variables are `position`, `force` and `force_error`; with snapshots also `snapshot` of shape (m,),
    `edge` of shape (n + 1,), the middles `bin` of the bins, of shape (n,), and `stretch_density` of shape (m,
    n), per length.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.Ensemble(asp.Contacts(asp.Gaussian(1.0, 0.1)), size=100, seed=1).pull(3.0, 31)
    >>> pull.force.shape, pull.force_error.shape
    ((31,), (31,))
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def breaks(self, /) -> int:
        """The number of breaks up to the end, including those of a relaxed start at X = 0."""

    @property
    def ensemble(self, /) -> Ensemble:
        """The ensemble that was pulled."""

    @property
    def force_error(self, /) -> _Array:
        """The standard error of the force, shape (points,), from the variance between contacts; nan for one contact."""

@final
class Estimates:
    """What a fit has found: values of the free numbers with their errors, and how well they describe the curve.

    Printed, or by `summary()`, it is a table. `readings` has the measured curve as the fit describes it.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> round(fitted.params["thresholds.mean"].value, 3)
    1.0
    """

    def __copy__(self, /) -> Estimates: ...
    def __deepcopy__(self, /, _memo: object) -> Estimates: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def contacts(self, /) -> Contacts:
        """The contacts of the estimated numbers; of the first curve where curves differ."""

    @property
    def converged(self, /) -> bool:
        """Whether the search has converged; otherwise the estimates are its last values."""

    @property
    def correlations(self, /) -> list[Correlation]:
        """The correlations above 0.5, without sign, between the errors of two estimates: a list of Correlation."""

    @property
    def covariance(self, /) -> _Array:
        """The covariance of the estimates in the order of `params`, shape (n, n)."""

    @property
    def fixed(self, /) -> dict[str, float]:
        """The numbers that were not free: those of the contacts, and those of the machine that are not 0."""

    def free_form(self, /, kernels: SupportsIndex = 36, *, progress: _Progress = None) -> FreeForm:
        """The thresholds of free form that fit the curve: a density without a name, as smooth as the curve allows.

        The logarithm of the density is a sum of Gaussian kernels over eight standard deviations of the fitted thresholds to
        either side of their mean. Third differences of its coefficients are held small, by as much as is most probable, so
        that what the curve does not determine is continued like a Gaussian. The other free numbers are found again.

        Parameters
        ----------
        kernels
            Their number, 12 or more.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        FreeForm

        Raises
        ------
        ValueError
            If no number of the thresholds was free, and for a planned measurement.
        """

    def friction(self, /) -> FrictionEstimates:
        """F_s, F_k, X* and K_c of the estimated contacts, each with its standard error.

        Returns
        -------
        FrictionEstimates
        """

    def interval_by_profile(self, /, name: str, *, progress: _Progress = None) -> tuple[float, float]:
        """The interval of 95 % of a free number by the profile of the likelihood: where -2 ln L, lowest in all other free
        numbers, has risen by 3.84. For independent errors of unknown size the rise is nu ln(1 + t²/nu), with Student's t
        of nu = n - p degrees of freedom for n readings and p free numbers.

        Where a fit to curves of force has free sizes of errors, L is the restricted likelihood, but for thresholds of
        free form. Its likelihood takes the noise of the contacts as normal: errors of count and stiffness also count the
        kurtosis of the whitened residuals, and may be larger. The likelihood of a record in steady sliding is the
        debiased one of Whittle.

        Parameters
        ----------
        name
            A name of `params`.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        (float, float)

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, and for a planned measurement.
        """

    @property
    def laws(self, /) -> dict[str, Estimates]:
        """The same fit with other distributions of thresholds, by their names: a dict of Estimates. Misfit.akaike compares them:
        a distribution is hardly the one that made the curve where it is more than 10 above the lowest.
        """

    def log_likelihood(self, /, values: ArrayLike) -> tuple[float, _Array]:
        """ln L at values of the free numbers, and its gradient, for samplers and other searches.

        Parameters
        ----------
        values
            A list of n numbers in the order of `params`.

        Returns
        -------
        (float, numpy.ndarray)
            ln L, with the logarithm of the priors, and an array of shape (n,); -inf and nan where the likelihood is 0.
            The covariance of the noise of contacts on a curve of force is that of the estimates, scaled by N_c⟨k⟩².
            With independent errors whose size is estimated, ln L is the highest for any size.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For another number of values than of `params`, and for a planned measurement.
        """

    @property
    def misfit(self, /) -> Misfit | None:
        """How well the curve is described, a Misfit; None for a planned measurement."""

    @property
    def model(self, /) -> MasterEquation:
        """The master equation of the estimated numbers."""

    @property
    def params(self, /) -> dict[str, Estimate]:
        """The free numbers by name, and after them the sizes of errors that were estimated: each an Estimate."""

    def plot(self, /, axes: Sequence[Axes] | None = None, **style: Any) -> tuple[Axes, ...]:
        """Plots the readings with the expected force and a band of two standard deviations of a reading to either side, and
        below them the whitened residuals. Returns the axes. It needs matplotlib.

        Parameters
        ----------
        axes
            Two axes to plot on, one below the other; new ones if None. Other arguments are passed to the plot() of
            the expected force. A planned measurement is plotted on the first of them only.
        **style
            Arguments of the plot() of the expected force.

        Returns
        -------
        (matplotlib.axes.Axes, ...)

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    def predict(self, /, position: ArrayLike, curve: SupportsIndex = 0) -> Prediction:
        """The readings that are expected at positions, as they are measured, with their scatter and their errors.

        Parameters
        ----------
        position
            A list of positions in any order, within the range of the measured ones or beyond it.
        curve
            The number of the curve.

        Returns
        -------
        Prediction

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a position that is not finite or before which the machine slips, and a curve that does not exist.
        """

    def profile(
        self, /, name: str, values: ArrayLike | None = None, *, progress: _Progress = None
    ) -> Profile:
        """The profile of the likelihood of a free number: by how much -2 ln L, lowest in all other free numbers, is above
        its minimum. L is that of interval_by_profile.

        Parameters
        ----------
        name
            A name of `params`.
        values
            A list of values, or None for 13 from three standard errors below the estimate to three above it; of the
            logarithm for numbers above 0 but a compliance.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        Profile

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, values that are nan, and a planned measurement.
        """

    @property
    def pull(self, /) -> Pull:
        """The pull of the estimated contacts, up to the last reading; of the first curve where curves differ."""

    @property
    def reading(self, /) -> float:
        """The standard deviation of the independent error of a reading, given or estimated, a force."""

    @property
    def readings(self, /) -> Record:
        """The readings as the fit describes them, a Record of arrays of shape (n,).

        `position` and `force` are the measured ones, after averaging; `slider_position` is X; `expected` is the expected
        force and `std` the standard deviation of a reading about it; `residual` is the measured minus the expected
        force, and `whitened` the whitened residuals, which are independent and of variance 1 if the description
        holds. A planned measurement has no `force`, `residual` and `whitened`. Several curves follow one another; `curve` is
        the number of the curve then.
        """

    def sample(
        self,
        /,
        draws: SupportsIndex = 1000,
        chains: SupportsIndex = 4,
        seed: _Seed = 1,
        *,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> Posterior:
        """Draws from the posterior by the No-U-turn sampler (NUTS), where errors from the information are not enough.

        The likelihood is that of log_likelihood. The priors are those of the fit; without one the prior of a number is
        flat, or flat in the logarithm of one above 0 that is no compliance. Each chain makes 300 draws before, which are
        left out.

        Parameters
        ----------
        draws
            The number of draws of each chain, 4 or more.
        chains
            Their number, 1 or more; as many are made at a time as there are threads.
        seed
            A whole number below 2^63, which always gives the same draws, on any number of threads, or a
            numpy.random.Generator, from which one is drawn.
        progress
            As for MasterEquation.pull.
        threads
            The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default
            those of the process, one per core or RAYON_NUM_THREADS.

        Returns
        -------
        Posterior

        Raises
        ------
        ValueError
            For a planned measurement, and if no number is known to better than a limit.
        """

    @property
    def solutions(self, /) -> int:
        """The number of solutions of the master equation that the search took."""

    @property
    def sparse(self, /) -> bool:
        """Whether the readings are farther apart than a third of the mean life of the fitted contacts. Contacts whose lives are
        longer or shorter by a factor may then have the same forces there, and the search may have found them.
        """

    def summary(self, /) -> str:
        """A table in plain English: values with errors and intervals, correlations, and how well the curve is described.

        Returns
        -------
        str
        """

@final
class ExactErlang(ClosedForm):
    """Erlang thresholds: sums of `shape` exponentially distributed lengths, each of mean 1/rate. shape 1 is the
    exponential distribution.

    Parameters
    ----------
    shape
        A whole number, 1 or above.
    rate
        Per length, above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> curve = asp.exact.Erlang(shape=4, rate=4.0)
    >>> round(curve.kinetic_friction, 3)
    0.625
    """

    def __new__(cls, /, shape: SupportsIndex, rate: _Number) -> ExactErlang: ...
    def __repr__(self, /) -> str: ...
    @property
    def relaxation_length(self, /) -> float:
        """X*, a length: 1/[λ(1 - cos 2π/m)], but 1/λ for shapes m up to 4."""

@final
class ExactGamma(ClosedForm):
    """Thresholds of a gamma distribution of any shape: F = X - mean Σ P(n k + 1, X/θ), n = 1, 2, …, with the shape
    k = (mean/std)², the scale θ = std²/mean and the regularised incomplete gamma function P.

    Parameters
    ----------
    mean, std
        Mean and standard deviation, above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> curve = asp.exact.Gamma(mean=1.0, std=0.5)
    >>> round(curve.kinetic_friction, 3)
    0.625
    """

    def __new__(cls, /, mean: _Number, std: _Number) -> ExactGamma: ...
    def __repr__(self, /) -> str: ...

@final
class ExactGaussian(ClosedForm):
    """Gaussian thresholds, and a Gaussian distribution of initial stretches: Fig. 2 of Braun and Peyrard (2008).

    The distributions are not truncated at 0, unlike those of the solvers.

    Parameters
    ----------
    mean, std
        Of the thresholds, above 0.
    initial_mean, initial_std
        Of the stretches at X = 0, 0 or above.

    Examples
    --------
    >>> import asperity as asp
    >>> curve = asp.exact.Gaussian(mean=1.0, std=0.1)
    >>> round(curve.kinetic_friction, 3)
    0.505
    """

    def __new__(
        cls, /, mean: _Number, std: _Number, initial_mean: _Number = 0.0, initial_std: _Number = 0.0
    ) -> ExactGaussian: ...
    def __repr__(self, /) -> str: ...
    @property
    def relaxation_length(self, /) -> float:
        """X* = -1/Re s_1, a length."""

    def relaxation_root(self, /, j: SupportsIndex) -> complex:
        """The root s_j, j ≥ 1, of the relaxation spectrum, complex, per length: s_j = [x̄ - √(x̄² - 4πijσ²)]/σ².

        Parameters
        ----------
        j
            The number of the root, 1 or above.

        Returns
        -------
        complex

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a j below 1.
        """

    @overload
    def variance(self, /, position: float) -> float:
        """The variance of the stretch of one contact at X, a length²: the force of N_c independent contacts has the
        standard deviation N_c⟨k⟩√(variance/N_c).

        Parameters
        ----------
        position
            Positions X, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0 or beyond 1e5 mean thresholds.
        """

    @overload
    def variance(self, /, position: ArrayLike) -> _Array: ...

@final
class ExactIdentical(ClosedForm):
    """Identical thresholds: every stretch is (y + X) mod threshold for ever, with the initial stretch y, and there
    is no relaxation.

    Parameters
    ----------
    threshold
        A length above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.exact.Identical(1.0).force(0.75)
    0.75
    """

    def __new__(cls, /, threshold: _Number) -> ExactIdentical: ...
    def __repr__(self, /) -> str: ...

@final
class ExactQuenched:
    """Quenched thresholds of any distribution: each contact keeps its own for ever.

    F(X)/(N_c⟨k⟩) = ∫P_c(ξ)(X mod ξ)dξ. The master equation describes annealed thresholds, so it does not apply.

    Examples
    --------
    >>> import asperity as asp
    >>> curve = asp.exact.Quenched(asp.Gaussian(1.0, 0.1))
    >>> round(curve.kinetic_friction, 3)
    0.5
    """

    def __new__(cls, /, thresholds: _AnyLaw) -> ExactQuenched: ...
    @property
    def dephasing_length(self, /) -> float:
        """X_d = x̄²/(√2 πσ), a length: narrow Gaussian thresholds get out of step as exp[-(X/X_d)²]."""

    @overload
    def force(self, /, position: float) -> float:
        """F(X)/(N_c⟨k⟩), a length; where contacts break simultaneously, after the break.

        Parameters
        ----------
        position
            Positions X, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0 or beyond 1e4 mean thresholds.
        """

    @overload
    def force(self, /, position: ArrayLike) -> _Array: ...
    @property
    def kinetic_friction(self, /) -> float:
        """F_k/(N_c⟨k⟩), a length: half the mean threshold."""

@final
class ExactRectangular(ClosedForm):
    """Thresholds uniformly distributed from min, 0 or above, to max, above min.

    Examples
    --------
    >>> import asperity as asp
    >>> curve = asp.exact.Rectangular(min=0.5, max=1.5)
    >>> round(curve.force(0.4), 3)
    0.4
    """

    def __new__(cls, /, min: _Number, max: _Number) -> ExactRectangular: ...
    def __repr__(self, /) -> str: ...
    def stick_slip_period(self, /, stiffness: _Number) -> float | None:
        """The period of stick-slip behind a spring, with slip="reset": X_u + F(X_u)/K, where the slope of F falls to -K at
        X_u = (max - min)(1 + K), or below it at once, at X_u = min.

        Parameters
        ----------
        stiffness
            K, per total stiffness of the contacts, above 0.

        Returns
        -------
        float or None
            The load-point displacement from slip to slip, a length; None where sliding is stable, for
            K >= min/(max - min), and for max > 2 min.

        Raises
        ------
        ValueError
            For a stiffness that is not above 0.

        Examples
        --------
        >>> import asperity as asp
        >>> round(asp.exact.Rectangular(0.7, 1.3).stick_slip_period(0.5), 6)
        2.166667
        """

@final
class Exponential(Law):
    """The exponential distribution.

    Parameters
    ----------
    mean
        Mean, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a mean that is not above 0. Lengths are from 1e-150 to 1e150.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.Exponential(mean=2.0).median(), 6)
    1.386294
    """

    def __new__(cls, /, mean: _Number) -> Exponential: ...

@final
class FrictionGradient:
    """The derivatives of static and kinetic friction, relaxation length and critical stiffness by a parameter.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> change = pull.friction_gradient("thresholds.mean")
    >>> round(change.kinetic_friction, 3)
    0.495
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @property
    def critical_stiffness(self, /) -> float:
        """∂K_c/∂θ, force per length and unit of the parameter; nan if K_c is not finite, 0 if it is 0."""

    @property
    def kinetic_friction(self, /) -> float:
        """∂F_k/∂θ, force per unit of the parameter."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the derivatives as bars, each in units of its own; it needs matplotlib, whose styles it follows.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        **style
            Arguments of the bar() of the axes.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    @property
    def relaxation_length(self, /) -> float:
        """∂X*/∂θ, length per unit of the parameter; nan if X* is not finite."""

    @property
    def static_friction(self, /) -> float | None:
        """∂F_s/∂θ, force per unit of the parameter; None if the static friction is not reached."""

@final
class FrozenRank(Ageing):
    """The distribution of thresholds matures, and every contact keeps its rank (quantile) in it.

    Parameters
    ----------
    mature
        The mature distribution P_cf.
    time
        The time scale of maturing, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a time that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
        mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
        refused by the models.

    Examples
    --------
    >>> import asperity as asp
    >>> ageing = asp.FrozenRank(asp.Gaussian(1.0, 0.05), time=1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
    >>> round(asp.velocity_curve(contacts, 1.0), 6)
    0.386778
    """

    def __new__(cls, /, mature: _AnyLaw, time: _Number) -> FrozenRank: ...
    @property
    def mature(self, /) -> Law:
        """The distribution P_cf of mature thresholds."""

    @property
    def time(self, /) -> float:
        """The time scale of maturing."""

@final
class Gamma(Law):
    """The gamma distribution.

    Parameters
    ----------
    mean
        Mean, above 0.
    std
        Standard deviation, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a mean or a std that is not above 0. Lengths are from 1e-150 to 1e150, a std from 1e-14 to 1e6 means.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.Gamma(mean=1.0, std=0.5).var(), 6)
    0.25
    """

    def __new__(cls, /, mean: _Number, std: _Number) -> Gamma: ...

@final
class Gaussian(Law):
    """The normal (Gaussian) distribution, truncated at 0.

    Parameters
    ----------
    mean
        Mean before truncation at 0, 0 or above.
    std
        Standard deviation before truncation, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a mean below 0, and a std that is not above 0. Lengths are from 1e-150 to 1e150, a std below the mean at least 1e-14 of it.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.Gaussian(mean=1.0, std=0.1).cdf(1.0), 6)
    0.5
    """

    def __new__(cls, /, mean: _Number, std: _Number) -> Gaussian: ...

@final
class Gradient:
    """The derivative of the force on a pull by a parameter, called with positions: `gradient(5.0)`.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> gradient = pull.gradient("thresholds.mean")
    >>> gradient.parameter
    'thresholds.mean'
    >>> gradient([0.5, 1.0]).shape
    (2,)
    """

    @overload
    def __call__(self, /, position: float) -> float: ...
    @overload
    def __call__(self, /, position: ArrayLike) -> _Array: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @property
    def parameter(self, /) -> str:
        """The parameter, such as `thresholds.mean`."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the derivative at the positions of the pull; it needs matplotlib, whose styles it follows.

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

@final
class Healing:
    """Measured healing: its parameters, each an Estimate with its value, its standard error and its 95 % interval. Made by
    read_healing.

    Called with hold times it is the fitted static friction.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> hold = np.array([1.0, 10.0, 100.0, 1000.0])
    >>> healing = asp.read_healing(hold, 0.6 + 0.01 * np.log1p(hold))
    >>> round(float(healing(100.0)), 3)
    0.646
    """

    @overload
    def __call__(self, /, hold: float) -> float: ...
    @overload
    def __call__(self, /, hold: ArrayLike) -> _Array: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @property
    def at_one(self, /) -> Estimate:
        """The static friction after a hold of 1, a force."""

    @property
    def cutoff(self, /) -> Estimate | None:
        """The cutoff time t_c; None if all holds are much longer. The interval ends at inf if the holds give no
        upper limit.
        """

    @property
    def fitted(self, /) -> _Array:
        """The fitted static friction after them, shape (n,), a force."""

    @property
    def force(self, /) -> _Array:
        """The static friction after them, shape (n,), a force."""

    @property
    def hold(self, /) -> _Array:
        """The hold times, shape (n,), a time."""

    @property
    def per_decade(self, /) -> Estimate:
        """The healing per factor of ten in hold time, β ln 10, a force."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots static friction against the logarithm of the hold time: measured values as dots, the fit as a
        line. Returns the axes. It needs matplotlib.

        Parameters
        ----------
        ax
            Axes to plot on; new ones if None. Other arguments are passed to the plot() of the fit.
        **style
            Arguments of the plot() of the fit.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    @property
    def residual(self, /) -> float:
        """The root-mean-square residual of the fit, a force."""

    @property
    def warnings(self, /) -> list[str]:
        """Sentences about numbers that do not mean what they seem to; empty if there is nothing to say."""

@final
class Inertial(Description):
    """The slip of a slider with mass, MẌ = K(X_T - X) - F - γẊ, from the loss of stability to the first arrest.

    X_T is fixed during the slip. The remaining oscillation is then damped out, and the slider comes to rest in
    equilibrium.

    Parameters
    ----------
    mass
        The mass M, above 0.
    damping
        The viscous damping γ, force per velocity, 0 or above.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a mass that is not above 0, and a damping below 0.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> asp.Block(theory, 1.0, asp.Inertial(1.0)).slip
    Inertial(mass=1.0)
    """

    def __new__(cls, /, mass: _Number, damping: _Number = 0.0) -> Inertial: ...
    @property
    def damping(self, /) -> float:
        """The viscous damping γ, force per velocity."""

    @property
    def mass(self, /) -> float:
        """The mass M."""

@final
class Interface(Deformable):
    """A deformable slider (Burridge–Knopoff, or on a half-space): elastically coupled cells of contacts, each
    connected to the drive by a spring. The contacts of a cell move together.

    Parameters
    ----------
    contacts
        The contacts of a cell.
    cells
        The length of a chain, such as [1000], or rows and columns, such as [512, 512].
    initial, start
        As for MasterEquation; start="steady" holds for time-dependent contacts too, at the velocity of the drive,
        unless they have a size.
    connection
        K_0, the stiffness of the spring between a cell and the drive.
    neighbours
        K_int, the stiffness of the spring between two neighbours.
    half_space
        The shear modulus of a half-space and the side of a cell, instead of neighbours.
    poisson_ratio
        Poisson's ratio ν of the half-space, from -0.9 to 0.48; 0 where its modulus is an effective one.
    sliding
        The direction of sliding on a half-space, along which one with ν > 0 is stiffer: along the "columns", from row to
        row and along a chain, or along the "rows".
    edges
        "open" or "periodic".
    loading
        "uniform", or "edge" if the drive pulls only the first cell or row.
    slip
        The slip rule: "reset" (the default), by which all contacts of an unstable cell break and re-form, or
        "overdamped"; None for cells with a mass.
    viscosity
        The drag on a moving cell, force per velocity; with it events have durations. Time-dependent contacts require
        it, with slip="overdamped", or a mass: η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j; a cell then slips while it
        is more than ten times as fast as the drive.
    mass
        The mass M of a cell. Cells then follow M d²X_j/dt² + η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j at the
        velocity of the drive, and disturbances travel as waves. Athermal contacts are loaded and unloaded; a cell over
        time-dependent contacts that would go back stands.
    disorder
        The standard deviation of the scale factors of cells, which multiply all lengths of their contacts and are
        drawn from a Gaussian distribution of mean 1 with the seed; or a list of the scale factors.
    seed
        The seed of these scale factors and of single contacts.
    areas
        The area of each cell, row by row, in any unit: only ratios to the mean area count. The numbers of contacts,
        connection, viscosity and mass are those of a cell of mean area, and proportional to the area; neighbours is
        not. None for cells of the same area, and on a half-space.
    drive_tolerance
        The accuracy of the drive at which equilibrium is lost, in mean thresholds; not used for time-dependent
        contacts.
    size
        None for cells of many contacts, which follow the master equation; or the number of contacts in each cell of
        mean area, which are drawn with the seed and followed one by one, with slip="overdamped".
    quenched
        Whether these keep their thresholds.

    Raises
    ------
    ValueError
        For both or neither of neighbours and half_space, poisson_ratio or sliding beside neighbours; a connection,
        neighbours, half_space, viscosity, mass or drive_tolerance that is not above 0, and a poisson_ratio that is not
        from -0.9 to 0.48; a disorder below 0, or another number of scale factors than of cells; another number of
        areas than of cells, an area that is not above 0 or that is less than 1e-4 of another one, and areas beside
        half_space; a slip beside a mass,
        and none of viscosity, with slip="overdamped", and mass for time-dependent contacts; slip="reset" with a size,
        a size of 0, and quenched without a size; another word as edges, loading, slip, sliding or start; and cells
        that are not one or two numbers of 1 or more.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    >>> chain = asp.Interface(contacts, [16], connection=0.5, neighbours=1.0)
    >>> len(chain.drive(distance=3.0).events) > 0
    True
    """

    def __new__(
        cls,
        /,
        contacts: Contacts,
        cells: Sequence[SupportsIndex],
        initial: _AnyLaw | None = None,
        *,
        connection: _Number,
        neighbours: _Number | None = None,
        half_space: tuple[_Number, _Number] | None = None,
        poisson_ratio: _Number = 0.0,
        sliding: Literal["columns", "rows"] = "columns",
        edges: Literal["open", "periodic"] = "open",
        loading: Literal["uniform", "edge"] = "uniform",
        slip: Literal["reset", "overdamped"] | None = None,
        viscosity: _Number | None = None,
        mass: _Number | None = None,
        disorder: _Number | ArrayLike | None = None,
        areas: ArrayLike | None = None,
        seed: _Seed = 1,
        drive_tolerance: _Number = 1e-06,
        size: SupportsIndex | None = None,
        quenched: bool = False,
        start: Literal["conditional", "relaxed", "steady"] = "conditional",
    ) -> Interface: ...
    @property
    def areas(self, /) -> _Array | None:
        """The areas of the cells as they were given, shape (n,), or None."""

    @property
    def disorder(self, /) -> float | _Array | None:
        """The standard deviation of the scale factors of cells, or these, shape (n,); None if there are none."""

    @property
    def drive_tolerance(self, /) -> float:
        """The accuracy of the drive at which equilibrium is lost, in mean thresholds."""

    @property
    def half_space(self, /) -> tuple[float, float] | None:
        """The shear modulus of a half-space and the side of a cell, or None."""

    @property
    def loading(self, /) -> Literal["uniform", "edge"]:
        """The loading, "uniform" or "edge"."""

    @property
    def mass(self, /) -> float | None:
        """The mass of a cell, or None."""

    @property
    def poisson_ratio(self, /) -> float:
        """Poisson's ratio ν of a half-space; 0 if it has none."""

    @property
    def quenched(self, /) -> bool:
        """Whether these keep their thresholds."""

    @property
    def size(self, /) -> int | None:
        """The number of contacts in each cell where they are followed one by one, or None."""

    @property
    def sliding(self, /) -> Literal["columns", "rows"]:
        """The direction of sliding, "columns" or "rows", which counts on a half-space."""

    @property
    def slip(self, /) -> Literal["reset", "overdamped"] | None:
        """The slip rule, "reset" or "overdamped"; None for cells with a mass."""

    def stretch_density(
        self,
        /,
        cell: SupportsIndex,
        stretches: ArrayLike | None = None,
        *,
        at: _Number,
        velocity: _Number | None = None,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
    ) -> StretchDensity:
        """The distribution of the stretches of the contacts of a cell, per length, after the interface has been driven
        from X_T = 0.

        The result has `stretch` and `density` of shape (n,), and `atoms`, the point masses. Detached contacts are
        not counted. Without bins each of the few contacts of a cell with a size is an atom.

        Parameters
        ----------
        cell
            Its number, counted row by row.
        stretches
            A list of n stretches.
        at
            The drive, 0 or above.
        velocity
            The velocity of the drive, for time-dependent contacts.
        edges
            Instead of stretches, edges of n bins, n + 1 increasing numbers; only for time-dependent contacts and for
            cells with a size. The density is then the mean in each bin, and `stretch` its middle.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        StretchDensity

        Raises
        ------
        ValueError
            For a cell that does not exist, neither or both of stretches and edges, fewer than two edges or edges that
            do not rise, edges for contacts that follow the master equation without time dependence, a drive at below
            0, and a velocity that is not above 0, or none where time passes.
        """

    @property
    def viscosity(self, /) -> float | None:
        """The drag on a moving cell, force per velocity, or None."""

    @property
    def wave_speed(self, /) -> float | None:
        """The speed of long waves between neighbours, sqrt(K_int/M), in cells per time; None without a mass and on a
        half-space.
        """

@final
class Lattice(Deformable):
    """Contacts coupled one by one, which re-form after the slip event: the cellular automaton of Olami, Feder and
    Christensen, for any distribution of thresholds. Time-dependent contacts, with a temperature, with ageing frozen_rank or
    logarithmic, or with both, are driven at a velocity, by kinetic Monte Carlo.

    Parameters
    ----------
    contacts
        The distributions of the contacts; their count is the total number that all cells represent.
    cells
        The length of a chain, or rows and columns.
    initial, start
        As for Ensemble.
    neighbours
        The stiffness of the spring between two neighbours.
    connection
        The stiffness of the spring to the drive. A neighbour gains the fraction neighbours/(z neighbours +
        connection) of the force that a breaking contact releases, with z = 4, or 2 on a chain.
    edges
        "open" or "periodic".
    seed, disorder
        As for Ensemble.

    Raises
    ------
    ValueError
        For cells that are not one or two numbers of 1 or more, neighbours or a connection below 0, a connection of 0
        where neighbours is 0, another word as edges, disorder or start, a seed that is not below 2^63, a delay, and
        thresholds that diffuse.

    Examples
    --------
    >>> import asperity as asp
    >>> lattice = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.1)), [16, 16], neighbours=0.2, connection=0.2)
    >>> len(lattice.drive(distance=3.0).events) > 0
    True
    >>> warm = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.02, 1.0))
    >>> lattice = asp.Lattice(warm, [16, 16], neighbours=0.2, connection=0.2)
    >>> events = lattice.drive(distance=3.0, velocity=0.01).events
    >>> bool((events["time"] > 0).all())
    True
    """

    def __new__(
        cls,
        /,
        contacts: Contacts,
        cells: Sequence[SupportsIndex],
        initial: _AnyLaw | None = None,
        *,
        neighbours: _Number,
        connection: _Number,
        edges: Literal["open", "periodic"] = "open",
        seed: _Seed = 1,
        disorder: Literal["annealed", "quenched"] = "annealed",
        start: Literal["conditional", "relaxed"] = "conditional",
    ) -> Lattice: ...
    @property
    def disorder(self, /) -> Literal["annealed", "quenched"]:
        """The kind of disorder, "annealed" or "quenched"."""

@disjoint_base
class Law(Description):
    """A probability distribution on x ≥ 0: a density, and possibly point masses.

    Methods have the names of scipy.stats. They take a number and return a float, or take anything that NumPy
    converts to an array of numbers and return an array of the same shape. Lengths are in the unit of the
    parameters. A distribution with weight below 0 is truncated at 0 and renormalised: its parameters are those
    before truncation, its mean() and std() those after it. NaN raises ValueError; a value that is not a number
    raises TypeError.

    The arguments of a distribution are attributes, except for a mean and a standard deviation, whose names are those of
    the methods mean() and std(); all are in parameters, and ``type(law)(**law.parameters)`` is an equal distribution.

    Examples
    --------
    >>> import asperity as asp
    >>> law = asp.Gaussian(1.0, 0.05)
    >>> round(law.cdf(0.95), 4)
    0.1587
    >>> law.ppf([0.25, 0.5]).round(4)
    array([0.9663, 1.    ])
    >>> round(asp.Lognormal(1.0, 0.2).std(), 4)
    0.2
    >>> asp.Weibull(12.0, 1.0) == asp.Weibull(scale=1.0, shape=12.0)
    True
    >>> asp.Weibull(12.0, 1.0).shape, law.parameters
    (12.0, {'mean': 1.0, 'std': 0.05})
    """

    @property
    def atoms(self, /) -> Atoms:
        """The point masses: positions and weights, each an array of shape (n,)."""

    @overload
    def cdf(self, /, x: float) -> float:
        """The cumulative distribution function P(ξ ≤ x), accurate to all digits also where it is small.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def cdf(self, /, x: ArrayLike) -> _Array: ...
    def entropy(self, /) -> float:
        """The differential entropy -∫p ln p, in nats; -inf for a distribution with point masses.

        Returns
        -------
        float
        """

    def expect(
        self,
        /,
        func: Callable[[float], SupportsFloat] | None = None,
        *,
        lb: _Number | None = None,
        ub: _Number | None = None,
        conditional: bool = False,
    ) -> float:
        """The expectation of func(ξ), of ξ itself for None, over lb ≤ ξ ≤ ub, divided by P(lb ≤ ξ ≤ ub) if conditional.

        func is called with one float at a time, at the nodes of an adaptive Gauss quadrature; the relative error is 1e-13
        where it is smooth. At a jump of func, divide the range by lb and ub.

        Parameters
        ----------
        func
            A function of a number, or None.
        lb, ub
            The limits; the whole range by default.
        conditional
            Whether to divide by the probability of the range.

        Returns
        -------
        float

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For an ub below lb, and a limit that is nan.
        """

    @classmethod
    def fit(cls, /, samples: ArrayLike) -> Self:
        """The distribution of this class under which the samples are most likely.

        Parameters
        ----------
        samples
            Values of 0 or above, of any length. Gaussian, Gamma, Lognormal, Rectangular, Point, Exponential and
            Weibull have parameters to fit; Gaussian is truncated at 0 here, too. scipy.stats returns the parameters
            instead, among them loc and scale.

        Returns
        -------
        Law
            One of this class.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For no samples, samples below 0, samples of 0 for Gamma, Lognormal and Weibull, and samples that are all
            equal, but for Point, whose samples have to be, and Exponential.
        """

    @overload
    def hazard(self, /, x: float) -> float:
        """The hazard p(x)/S(x), per length: the fraction of contacts of stretch x that break per unit displacement
        (Braun and Peyrard 2008, the P(x) of Eq. 3); inf where S is 0.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def hazard(self, /, x: ArrayLike) -> _Array: ...
    def interval(self, /, confidence: _Number) -> tuple[float, float]:
        """The interval between the quantiles (1 - confidence)/2 and (1 + confidence)/2.

        Parameters
        ----------
        confidence
            The probability of the interval, from 0 to 1.

        Returns
        -------
        (float, float)

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a confidence that is not from 0 to 1.
        """

    @overload
    def isf(self, /, q: float) -> float:
        """The upper quantile: the smallest x with S(x) ≤ q, for q from 0 to 1; accurate for tiny q, for which ppf(1 -
        q) is not.

        Parameters
        ----------
        q
            Probabilities from 0 to 1: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If q is neither a number nor an array of numbers.
        """

    @overload
    def isf(self, /, q: ArrayLike) -> _Array: ...
    @overload
    def logcdf(self, /, x: float) -> float:
        """ln P(ξ ≤ x), accurate also where P underflows; -inf where P is 0.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def logcdf(self, /, x: ArrayLike) -> _Array: ...
    @overload
    def logpdf(self, /, x: float) -> float:
        """ln p(x), accurate also where p underflows; -inf where p is 0. Both ends of the support belong to it.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def logpdf(self, /, x: ArrayLike) -> _Array: ...
    @overload
    def logsf(self, /, x: float) -> float:
        """ln S(x), accurate also where S underflows; -inf where S is 0.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def logsf(self, /, x: ArrayLike) -> _Array: ...
    def mean(self, /) -> float:
        """The mean after truncation at 0, a length.

        Returns
        -------
        float
        """

    def median(self, /) -> float:
        """The median, the smallest x with P(ξ ≤ x) ≥ 1/2.

        Returns
        -------
        float
        """

    def moment(self, /, order: SupportsIndex) -> float:
        """The raw moment E[ξⁿ] after truncation at 0, n up to 29, in units of lengthⁿ.

        Parameters
        ----------
        order
            The order n, a whole number.

        Returns
        -------
        float

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For an order above 29.
        """

    @overload
    def pdf(self, /, x: float) -> float:
        """The density p(x) without point masses, per length; 0 for x < 0. Both ends of the support belong to it.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def pdf(self, /, x: ArrayLike) -> _Array: ...
    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the density with its quantiles of 5, 50 and 95 %, point masses as stems; it needs matplotlib, whose styles it
        follows.

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

    @overload
    def ppf(self, /, q: float) -> float:
        """The quantile: the smallest x with P(ξ ≤ x) ≥ q, for q from 0 to 1.

        Parameters
        ----------
        q
            Probabilities from 0 to 1: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If q is neither a number nor an array of numbers.
        """

    @overload
    def ppf(self, /, q: ArrayLike) -> _Array: ...
    @overload
    def rvs(
        self, /, size: None = None, random_state: _Seed | None = None, *, seed: _Seed | None = None
    ) -> float:
        """Independent random numbers: a float for size None, otherwise an array of shape (size,) or size.

        The seed is a whole number below 2^63, which always gives the same numbers, or a numpy.random.Generator,
        from which one such number is drawn. random_state is another name for it; without either, the numbers are
        different in each call.

        Parameters
        ----------
        size
            How many, or the shape of an array; None for one number.
        seed
            A whole number below 2^63, or a numpy.random.Generator; without one, draws differ from call to call.
        random_state
            The same by the name that scipy.stats uses.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a size below 0, and a seed that is not below 2^63.
        """

    @overload
    def rvs(
        self,
        /,
        size: SupportsIndex | Sequence[SupportsIndex],
        random_state: _Seed | None = None,
        *,
        seed: _Seed | None = None,
    ) -> _Array: ...
    @overload
    def sf(self, /, x: float) -> float:
        """The survival S(x) = P(ξ > x), accurate to all digits also where it is small.

        Parameters
        ----------
        x
            Stretches: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If x is neither a number nor an array of numbers.
        """

    @overload
    def sf(self, /, x: ArrayLike) -> _Array: ...
    def stats(self, /, moments: str = "mv") -> float | tuple[float, ...]:
        """The mean "m", variance "v", skewness "s" and excess kurtosis "k" named by moments, in this order: a float for one,
        a tuple for several. Skewness and kurtosis of a point mass are nan.

        Parameters
        ----------
        moments
            Letters of "mvsk".

        Returns
        -------
        float or tuple[float, ...]

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        """

    def std(self, /) -> float:
        """The standard deviation after truncation at 0, a length.

        Returns
        -------
        float
        """

    def support(self, /) -> tuple[float, float]:
        """The lowest and the highest value; the highest may be inf.

        Returns
        -------
        (float, float)
        """

    def var(self, /) -> float:
        """The variance after truncation at 0, in units of length².

        Returns
        -------
        float
        """

@final
class Logarithmic(Ageing):
    """Every threshold grows with the logarithm of the age t of the contact: h = h_0 [1 + growth ln(1 + t/time)].

    Parameters
    ----------
    growth
        The growth β, 0 or above.
    time
        The time τ_0, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a growth below 0, and a time that is not above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))
    >>> asp.velocity_curve(contacts, [1e-2, 1.0]).kinetic_friction.round(6)
    array([0.552766, 0.512211])
    """

    def __new__(cls, /, growth: _Number, time: _Number) -> Logarithmic: ...
    @property
    def growth(self, /) -> float:
        """The growth β."""

    @property
    def time(self, /) -> float:
        """The time τ_0."""

@final
class Lognormal(Law):
    """The lognormal distribution: the logarithm of the variable is normal.

    Parameters
    ----------
    mean
        Mean of the variable itself, not of its logarithm, above 0.
    std
        Standard deviation of the variable itself, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a mean or a std that is not above 0. Lengths are from 1e-150 to 1e150, a std from 1e-14 to 1e6 means.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.Lognormal(mean=1.0, std=0.5).mean(), 6)
    1.0
    """

    def __new__(cls, /, mean: _Number, std: _Number) -> Lognormal: ...

@final
class MasterEquation(Model):
    """The master equation of contacts and their initial state.

    ∂Q/∂x + ∂Q/∂X + P(x) Q = R(x) ∫P(ξ) Q(ξ; X) dξ for the distribution Q(x; X) of stretches x, with the hazard
    P of the thresholds and the distribution R of re-formed stretches (O. M. Braun and M. Peyrard, Phys. Rev.
    Lett. 100, 125501 (2008), Eq. 5), solved as a renewal equation.

    Parameters
    ----------
    contacts
        The contacts.
    initial
        The distribution Q_ini of stretches at X = 0, by default all at 0.
    start
        "conditional" if contacts hold at X = 0, so that thresholds are above stretches; "relaxed" if stretches and
        thresholds are independent, so that contacts above their threshold break at once; "steady" for
        time-independent contacts that slide steadily, without initial. Derivatives leave the stretches as they are.
    velocity
        The velocity of the slider, above 0; required only for time-dependent contacts, which have age 0 at X = 0.
    tolerance
        Allowed error of the force per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; a larger error raises
        RuntimeError. Without it the aim is 1e-10, and `Pull.accuracy` is the estimated error.

    Raises
    ------
    ValueError
        For stretches at which no contact survives, and for distributions too narrow to be distinguished from a point
        mass.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> pull = theory.pull(distance=5.0)
    >>> round(pull.static_friction.force, 6)
    0.796436
    >>> round(pull.kinetic_friction, 6)
    0.505
    """

    def __new__(
        cls,
        /,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        velocity: _Number | None = None,
        start: Literal["conditional", "relaxed", "steady"] = "conditional",
        tolerance: _Number | None = None,
    ) -> MasterEquation: ...
    def pull(
        self, /, distance: _Number = 20.0, points: SupportsIndex = 2001, *, progress: _Progress = None
    ) -> Pull:
        """Displaces the slider's base from X = 0 to distance.

        Parameters
        ----------
        distance
            A length above 0.
        points
            The number of positions of `position`, `force` and `breaking_rate`, evenly spaced, including both ends; 2
            or more.
        progress
            A function that is called from time to time with the completed fraction, or True for a progress bar (by
            tqdm). Ctrl-C interrupts the computation.

        Returns
        -------
        Pull

        Raises
        ------
        ValueError
            For a distance that is not above 0, fewer than 2 points, and more than fit in the memory of any machine.
        MemoryError
            For too many point masses or samples.
        RuntimeError
            If the tolerance is not reached.
        """

    def relaxation(self, /) -> Relaxation:
        """The relaxation to steady sliding.

        Returns
        -------
        Relaxation
        """

    def simulation(self, /) -> Simulation:
        """Its events are simultaneous breaks of many contacts.

        Returns
        -------
        Simulation
            A simulation of the contacts under a rigid slider that advances step by step, at X = 0.
        """

    def steady_state(self, /) -> SteadyState:
        """Steady sliding.

        Returns
        -------
        SteadyState
        """

    @property
    def tolerance(self, /) -> float | None:
        """The allowed error of the force per contact and per ⟨k⟩ × mean threshold; None for the default aim of 1e-10."""

    @property
    def velocity(self, /) -> float | None:
        """The velocity of the slider, or None."""

@final
class MeanField(Ageing):
    """One distribution of thresholds that all contacts share, from the mean-field equations for thresholds and
    stretches. It is not a rule for a single contact.

    Where the velocity varies, it is followed with the stretches of the contacts. It cannot be combined with
    temperature or an ensemble.

    Parameters
    ----------
    mature
        The mature distribution P_cf.
    diffusion
        The diffusion coefficient D, stretch² per time, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a diffusion that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
        mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
        refused by the models.

    Examples
    --------
    >>> import asperity as asp
    >>> ageing = asp.MeanField(asp.Gaussian(1.0, 0.05), diffusion=0.0025)
    >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
    >>> round(asp.velocity_curve(contacts, 1.0), 6)
    0.370081
    """

    def __new__(cls, /, mature: _AnyLaw, diffusion: _Number) -> MeanField: ...
    @property
    def diffusion(self, /) -> float:
        """The diffusion coefficient D, stretch² per time."""

    @property
    def mature(self, /) -> Law:
        """The distribution P_cf of mature thresholds."""

@final
class Mixture(Law):
    """A mixture of distributions.

    Parameters
    ----------
    components
        A list of pairs (weight, distribution), with weights above 0 that sum to 1.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For no components, a weight that is not above 0, and weights that do not sum to 1.

    Examples
    --------
    >>> import asperity as asp
    >>> law = asp.Mixture([(0.5, asp.Point(1.0)), (0.5, asp.Gaussian(2.0, 0.1))])
    >>> round(law.mean(), 6)
    1.5
    """

    def __new__(cls, /, components: Sequence[tuple[_Number, _AnyLaw]]) -> Mixture: ...
    @property
    def components(self, /) -> list[tuple[float, Law]]:
        """The pairs of weights and distributions."""

@disjoint_base
class Model(Description):
    """Contacts and their initial state.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> isinstance(theory, asp.Model), theory.contacts.count
    (True, 1.0)
    """

    @property
    def contacts(self, /) -> Contacts:
        """The contacts."""

    @property
    def initial(self, /) -> Law:
        """The distribution Q_ini of stretches at X = 0."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the distributions of the contacts, as Contacts.plot, with that of their initial stretches.

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

    @property
    def start(self, /) -> Literal["conditional", "relaxed", "steady"]:
        """The kind of the initial state, "conditional", "relaxed" or "steady"."""

@final
class Point(Law):
    """A point mass (delta distribution): one value only.

    Parameters
    ----------
    at
        The single value, 0 or above.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For an at below 0. Lengths are from 1e-150 to 1e150.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.Point(at=1.0).mean()
    1.0
    """

    def __new__(cls, /, at: _Number) -> Point: ...
    @property
    def at(self, /) -> float:
        """The single value, 0 or above."""

@final
class Posterior:
    """Draws from the posterior of a fit by the No-U-turn sampler.

    Printed, or by `summary()`, it is a table. Numbers of which the fit knows only a limit keep their estimates and are not
    among those that are drawn.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
    >>> x = [0.2 * i for i in range(20)]
    >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
    >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
    >>> posterior = fitted.sample(draws=50, chains=2, seed=1)
    >>> posterior.draws["thresholds.mean"].shape
    (2, 50)
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def divergences(self, /) -> int:
        """The number of draws whose paths diverged, because the density bends too much: 0 where the draws can be trusted."""

    @property
    def diverging(self, /) -> _Array:
        """1 where the path to a draw diverged, otherwise 0, shape (chains, draws)."""

    @property
    def draws(self, /) -> dict[str, _Array]:
        """The draws of each number by name: arrays of shape (chains, draws)."""

    @property
    def log_density(self, /) -> _Array:
        """The logarithm of the posterior density at each draw, without its constant, shape (chains, draws).

        It is the density of the numbers, or of the logarithms of those above 0.
        """

    @property
    def params(self, /) -> dict[str, PosteriorNumber]:
        """The drawn numbers by name: each a PosteriorNumber."""

    def plot(self, /) -> NDArray[Any]:
        """Plots the draws: histograms of the numbers on the diagonal, pairs of them below it. Returns the axes, shape (n, n).
        It needs matplotlib.

        Returns
        -------
        NDArray[Any]
        """

    def summary(self, /) -> str:
        """A table in plain English: means with standard deviations, intervals of 95 %, and how well the chains agree.

        Returns
        -------
        str
        """

    def to_arviz(self, /) -> Any:
        """The draws as ArviZ holds them, with the groups `posterior` and `sample_stats`. It needs arviz.

        Returns
        -------
        Any
            A DataTree of xarray; before version 1 of ArviZ its InferenceData.
        """

    @property
    def warnings(self, /) -> list[str]:
        """Sentences about draws that are not to be trusted: divergences, chains that differ (r_hat above 1.01), too few
        independent draws (ess below 400).
        """

@final
class Pull(Record):
    """A pull: the slider's base is displaced from X = 0, by the master equation. Forces are total forces of all
    N_c contacts.

    Called with positions it is F(X): `pull(5.0)`, `pull([1.0, 2.0])`.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(distance=5.0, points=51)
    >>> pull.force.shape, round(pull.kinetic_friction, 3)
    ((51,), 0.505)
    """

    @overload
    def __call__(self, /, position: float) -> float: ...
    @overload
    def __call__(self, /, position: ArrayLike) -> _Array: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def accuracy(self, /) -> float:
        """The estimated error of F/(N_c⟨k⟩), a length."""

    @property
    def breaking_atoms(self, /) -> Atoms:
        """Positions at which contacts break simultaneously, and the fractions that do, each of shape (n,)."""

    @property
    def breaking_rate(self, /) -> _Array:
        """The fraction of contacts breaking per length at the positions, shape (points,), without simultaneous breaks."""

    @overload
    def breaking_rate_at(self, /, position: float) -> float:
        """The fraction of contacts breaking per length, for positions from 0 to the distance.

        Parameters
        ----------
        position
            Positions from 0 to the distance: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0 or beyond the distance.
        """

    @overload
    def breaking_rate_at(self, /, position: ArrayLike) -> _Array: ...
    def covariance(self, /, at: ArrayLike, size: _Number | None = None) -> _Array:
        """The covariance of the force of `size` random contacts, scaled to N_c, at m positions from 0 to the distance.

        Contacts under a rigid drive are independent, so the result is exact: a symmetric array of shape (m, m), in
        units of force². Contacts with a delay, or whose stiffness depends on the threshold, are refused.

        Parameters
        ----------
        at
            A list of m positions.
        size
            The number of contacts, or None for the N_c of the contacts.

        Returns
        -------
        numpy.ndarray

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For positions in at below 0 or beyond the distance, a size that is not above 0, and contacts that are
            refused.
        """

    @property
    def critical_stiffness(self, /) -> float:
        """The critical stiffness K_c = max(0, -min F'), force per length: a softer slider sticks and slips. It is inf
        where the force jumps down, and 0 if the force decreases by no more than ten times the tolerance.
        """

    @property
    def distance(self, /) -> float:
        """The distance of the pull, a length."""

    @property
    def equation(self, /) -> MasterEquation:
        """The master equation that was solved."""

    @overload
    def force_at(self, /, position: float) -> float:
        """F(X), for positions from 0 to the distance.

        Parameters
        ----------
        position
            Positions from 0 to the distance: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0 or beyond the distance.
        """

    @overload
    def force_at(self, /, position: ArrayLike) -> _Array: ...
    @overload
    def force_std(self, /, size: _Number, at: float) -> float:
        """The standard deviation of the force of `size` random contacts, scaled to N_c.

        Parameters
        ----------
        at
            Positions from 0 to the distance, or None for those of `position`. Contacts under a rigid drive are
            independent, so the result is exact.
        size
            The number of contacts; None for the N_c of the contacts.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a size that is not above 0, and positions in at below 0 or beyond the distance.
        """

    @overload
    def force_std(self, /, size: _Number, at: ArrayLike | None = None) -> _Array: ...
    def friction_gradient(self, /, parameter: str) -> FrictionGradient:
        """The derivatives of F_s, F_k, X* and K_c by one of `parameters()`, for the propagation of errors.

        Parameters
        ----------
        parameter
            As in `gradient`.

        Returns
        -------
        FrictionGradient

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a parameter that is none of `parameters()`, and one by which friction has no derivative.
        """

    def friction_gradients(self, /, parameters: Sequence[str]) -> list[FrictionGradient]:
        """The derivatives of F_s, F_k, X* and K_c by several of `parameters()`, with one computation.

        Parameters
        ----------
        parameters
            A list of names, as for `gradient`.

        Returns
        -------
        list[FrictionGradient]

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `parameters()`, and one by which friction has no derivative.
        """

    def gradient(self, /, parameter: str) -> Gradient:
        """The derivative of the force by one of `parameters()`, as a function of the position.

        Parameters
        ----------
        parameter
            `thresholds.mean`, `reforming.std`, `stiffness`, `temperature.energy`, and so on. The position of a point
            mass has no derivative.

        Returns
        -------
        Gradient

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a parameter that is none of `parameters()`, and one by which the force has no derivative.
        """

    def gradients(self, /, parameters: Sequence[str]) -> list[Gradient]:
        """The derivatives of the force by several of `parameters()`, at little more than half the cost of one after the
        other.

        Parameters
        ----------
        parameters
            A list of names, as for `gradient`.

        Returns
        -------
        list[Gradient]

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `parameters()`, and one by which the force has no derivative.
        """

    @property
    def kinetic_friction(self, /) -> float:
        """The kinetic friction F_k, the force of steady sliding."""

    def parameters(self, /) -> dict[str, float]:
        """The parameters by which the force has a derivative, with their values.

        They are those of the distributions (`thresholds.mean`, `reforming.std`, `initial.max`, `ageing.mature.mean`),
        `count`, `stiffness` or `stiffness_per_threshold`, and those of time-dependent contacts: `temperature.energy`,
        `temperature.attempt_rate`, `ageing.growth`, `ageing.time`, `ageing.diffusion`, `delay` and `velocity`.

        Returns
        -------
        dict[str, float]
        """

    def plot(
        self,
        /,
        ax: Axes | None = None,
        *,
        kind: str | None = None,
        size: _Number | None = None,
        paths: SupportsIndex = 0,
        seed: _Seed | None = None,
        **style: Any,
    ) -> Axes:
        """Plots F(X) with the static and the kinetic friction, and on request the scatter of the force of `size` random
        contacts. Returns the axes. It needs matplotlib.

        Parameters
        ----------
        ax
            Axes to plot on; new ones if None. Other arguments are passed to its plot().
        kind
            "force", the only one of `pictures`.
        size
            The number of contacts for a band of one standard deviation to either side; None for no band, or with
            `paths` for the N_c of the contacts.
        paths
            The number of sample paths.
        seed
            As for `sample_paths`; required with `paths`.
        **style
            Arguments of the plot() of the curve.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    @property
    def relaxation_length(self, /) -> float:
        """The relaxation length X*, over which the initial state is forgotten; inf if it does not settle exponentially, nan if
        no root is found.
        """

    def sample_paths(
        self, /, at: ArrayLike, count: SupportsIndex, size: _Number | None = None, *, seed: _Seed
    ) -> _Array:
        """Sample paths of the force of `size` random contacts, scaled to N_c, at m positions from 0 to the distance.

        The paths are those of a Gaussian process with the exact mean and covariance: an array of shape (n, m). They
        cost the same for any number of contacts. The force of few contacts is not Gaussian: use an Ensemble there.

        Parameters
        ----------
        at
            A list of m positions.
        count
            The number n of paths.
        size
            The number of contacts, or None for the N_c of the contacts.
        seed
            A whole number below 2^63, which always gives the same paths, or a numpy.random.Generator, from which one
            such number is drawn.

        Returns
        -------
        numpy.ndarray

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For positions in at below 0 or beyond the distance, a count below 0, a size that is not above 0, a seed
            that is not below 2^63, and contacts with a delay, or whose stiffness depends on the threshold.
        """

    @overload
    def slope_at(self, /, position: float) -> float:
        """dF/dX from the right, force per length, for positions from 0 to the distance.

        Parameters
        ----------
        position
            Positions from 0 to the distance: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below 0 or beyond the distance.
        """

    @overload
    def slope_at(self, /, position: ArrayLike) -> _Array: ...
    @property
    def static_friction(self, /) -> StaticFriction | None:
        """The static friction F_s, the highest force of the pull, with its position X_s; None if the force still rises
        at the end, or never decreases.
        """

    def stretch_density(self, /, at: ArrayLike, stretches: ArrayLike | None = None) -> StretchDensity:
        """The distribution Q(x; X) of stretches x, per length, at positions X from 0 to the distance.

        The result has `stretch` of shape (n,); `density` of shape (n,) or (m, n); and `atoms`, the point masses at
        the position, or a list of them for a list of positions.

        Parameters
        ----------
        at
            A position, or a list of m of them.
        stretches
            A list of n stretches, or None for an automatic choice that resolves the distributions.

        Returns
        -------
        StretchDensity

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For positions in at below 0 or beyond the distance, and stretches below 0.
        """

    def threshold_response(self, /, thresholds: ArrayLike) -> ThresholdResponse:
        """The response of the force to the probability of single thresholds, as a function of the position.

        It is the derivative of F for thresholds drawn from (1 - ε) P_c + ε δ(x_s - ξ) by ε at 0. A change of P_c that
        keeps its total changes the force by the integral of the response times this change. Contacts with temperature,
        ageing or a delay, or whose stiffness depends on the threshold, are refused.

        Parameters
        ----------
        thresholds
            A list of n thresholds, lengths of 0 or above.

        Returns
        -------
        ThresholdResponse

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For thresholds below 0, and contacts that are refused.
        """

@disjoint_base
class Record(Mapping[str, _Array]):
    """Results: a mapping from the names of variables to read-only arrays.

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0, 31)
    >>> isinstance(pull, asp.Record), pull["force"].shape
    (True, (31,))
    """

    def __contains__(self, name: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> _Array: ...
    def __iter__(self, /) -> Iterator[str]: ...
    def __len__(self, /) -> int: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def _attributes(self, /) -> dict[str, Any]: ...
    def _coordinates(self, /) -> list[str]: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def force(self, /) -> _Array:
        """The friction force F at the positions, shape (n,): the total force of all N_c contacts; where contacts break
        simultaneously, after the break.
        """

    @overload
    def get(self, key: str, default: None = None, /) -> _Array | None:
        """The array called key, or default.

        Parameters
        ----------
        key
            The name of a variable.
        default
            What to return if there is none.

        Returns
        -------
        numpy.ndarray or None or numpy.ndarray or _T

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        """

    @overload
    def get(self, key: str, default: _Array | _T, /) -> _Array | _T: ...
    def items(self, /) -> ItemsView[str, _Array]:
        """Names and arrays of the variables.

        Returns
        -------
        ItemsView[str, numpy.ndarray]
        """

    def keys(self, /) -> KeysView[str]:
        """The names of the variables.

        Returns
        -------
        KeysView[str]
        """

    @property
    def labels(self, /) -> dict[str, Label]:
        """Dimensions, descriptive name and unit of each variable."""

    @property
    def pictures(self, /) -> tuple[str, ...]:
        """The kinds of pictures that plot() draws of this result; the first is its default."""

    def plot(self, /, ax: Axes | None = None, *, kind: str | None = None, **style: Any) -> Axes:
        """Plots the result; it needs matplotlib, whose styles it follows.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        kind : str, optional
            One of `pictures`; by default the first: the force of a pull or a drive, the friction of a velocity curve or a
            hold curve, the spectrum, the fit, the thresholds of a renormalisation.
        **style
            Arguments of the plot() of the axes for the curve, or of pcolormesh or imshow for a map. A "map" also takes
            `at`, the drive whose map is shown, by default the last.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ValueError
            For a kind that the result does not have.
        ImportError
            If matplotlib is not installed.
        """

    @property
    def position(self, /) -> _Array:
        """Positions X of the slider's base: an array of shape (n,), a length."""

    def to_xarray(self, /) -> Dataset:
        """An xarray.Dataset with named dimensions, long names and units. It needs xarray.

        Returns
        -------
        xarray.Dataset
        """

    def values(self, /) -> ValuesView[_Array]:
        """The arrays of the variables.

        Returns
        -------
        ValuesView[numpy.ndarray]
        """

@final
class Rectangular(Law):
    """The uniform distribution on an interval.

    Parameters
    ----------
    min
        Lower end, 0 or above.
    max
        Upper end, above the lower.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a min below 0, and a max that is not above min. Lengths are from 1e-150 to 1e150.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.Rectangular(min=0.5, max=1.5).pdf(1.0)
    1.0
    """

    def __new__(cls, /, min: _Number, max: _Number) -> Rectangular: ...
    @property
    def max(self, /) -> float:
        """Upper end, above the lower."""

    @property
    def min(self, /) -> float:
        """Lower end, 0 or above."""

@final
class Relaxation:
    """The relaxation spectrum: F(X) = F_k + N_c⟨k⟩ Σ_j c_j exp(s_j X), where s_j ≠ 0 are the roots of φ̂(s) = 1 and φ̂ is
    the Laplace transform of the breaking density of re-formed contacts.

    Examples
    --------
    >>> import asperity as asp
    >>> relaxation = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).relaxation()
    >>> bool(relaxation.length > 0.0)
    True
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @overload
    def force(self, /, position: float) -> float:
        """F(X) from the expansion, a force, for positions from `valid_from` on.

        Parameters
        ----------
        position
            Positions from `valid_from` on: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            If position is neither a number nor an array of numbers.
        ValueError
            For a position below `valid_from`, and contacts for which the expansion holds nowhere.
        """

    @overload
    def force(self, /, position: ArrayLike) -> _Array: ...
    @property
    def length(self, /) -> float:
        """The relaxation length X* = -1/Re s_1, over which the initial state is forgotten; inf if the force never
        settles, nan if no root is found.
        """

    @property
    def paper_estimate(self, /) -> float:
        """The estimate x̄²/σ of Braun and Peyrard (2008), a length; inf for identical thresholds. For time-dependent
        contacts, x̄ and σ are the mean and the standard deviation of the displacement between successive formations
        of a contact in steady sliding.
        """

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the roots in the complex plane; it needs matplotlib, whose styles it follows.

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

    @property
    def roots(self, /) -> NDArray[np.complex128]:
        """The roots s_j with Im s_j > 0, slowest first: a complex array of shape (n,), per length."""

    @property
    def valid_from(self, /) -> float:
        """The position from which on the neglected terms of `force` are below 1e-12 of N_c⟨k⟩ × the mean life; inf if
        the expansion does not hold.
        """

@final
class Renormalised(Law):
    """The distribution of thresholds, renormalised in mean field: every break stretches all other contacts, so
    that contacts break at lower drives. Its mean is lower and it is narrower than law.

    Parameters
    ----------
    law
        The distribution P_c of the thresholds, without point masses above 0.
    coupling
        κ, the fraction of its stretch that a breaking contact transfers to all others together, from 0 to below
        critical_coupling(law).
        Contacts start at stretch 0. When the unbroken contacts have the stretch x, breaks have contributed κ∫ξ
        P_c(ξ)dξ to it, and the drive X = x - κ∫ξ P_c(ξ)dξ, so that P_eff(X) = P_c(x)/(1 - κ x P_c(x)).

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For thresholds of law that are all 0 or have point masses above 0, and a coupling below 0, or not below
        critical_coupling(law).

    Examples
    --------
    >>> import asperity as asp
    >>> law = asp.Renormalised(asp.Gaussian(1.0, 0.1), coupling=0.1)
    >>> round(law.std(), 4)
    0.0721
    """

    def __new__(cls, /, law: _AnyLaw, coupling: _Number) -> Renormalised: ...
    @property
    def coupling(self, /) -> float:
        """κ, the fraction of its stretch that a breaking contact transfers."""

    @property
    def law(self, /) -> Law:
        """The distribution before the renormalisation."""

@final
class Result(Record):
    """The result of a scenario: a mapping from the names of variables to arrays, with the summary.

    The variables are those of `result.nc`: `position`, `force`, `breaking_rate`, `stretch_density`, …

    Examples
    --------
    >>> import asperity as asp
    >>> result = asp.run({"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}, "pull": {"points": 11}})
    >>> result["force"].shape, round(result.kinetic_friction, 3)
    ((11,), 0.505)
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def _attributes(self, /) -> dict[str, Any]: ...
    @property
    def critical_stiffness(self, /) -> float | _Array:
        """The critical stiffness K_c, force per length; inf where the force jumps down; an array where the task has many
        velocities; nan for tasks without it.
        """

    @property
    def events(self, /) -> Events | None:
        """The events of a slider or an interface; None if the task has no events."""

    @property
    def kinetic_friction(self, /) -> float | _Array:
        """The kinetic friction F_k, the force of steady sliding; an array where the task has many velocities, of a protocol that
        of each step, nan in holds and ramps; nan for tasks without it.
        """

    @property
    def relaxation_length(self, /) -> float | _Array:
        """The relaxation length X*; inf if the force does not settle exponentially, nan if no root is found, and for tasks without it."""

    def save(self, /, folder: str | PathLike[str]) -> None:
        """Writes the folder that `asperity run` would write, without figures; open_result reads it.

        Parameters
        ----------
        folder
            The folder, which asperity made if it exists.

        Raises
        ------
        FileExistsError
            If there is a folder that asperity did not make.
        OSError
            For errors of the system.
        """

    @property
    def scenario(self, /) -> str:
        """The scenario, TOML, with all defaults filled in."""

    @property
    def static_friction(self, /) -> StaticFriction | _Array | None:
        """The static friction F_s with its position X_s; the array of F_s for a hold curve, shape (holds,); None if the force still
        rises at the end, or never decreases, and for tasks without it.
        """

    @property
    def summary(self, /) -> dict[str, Any]:
        """The summary: static and kinetic friction, relaxation length, …, as in `summary.json`."""

    @property
    def title(self, /) -> str:
        """The title of the scenario."""

@final
class Series(Law):
    """A density that is a polynomial in each of several cells, given as Legendre series and normalised.

    asperity.law makes a Series from any distribution of scipy.stats.

    Parameters
    ----------
    boundaries
        The boundaries of the cells, in increasing order from 0 or above.
    coefficients
        For each cell a list of up to 16 coefficients c_n, c_0 first, of the density Σ c_n P_n(t), with t from -1
        to 1 across the cell.
    cut
        The probability of an infinite tail that was truncated at the last boundary; quantities that depend on
        this tail, such as the relaxation length, are then nan.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For fewer than two boundaries, boundaries below 0 or that do not rise, another number of lists of
        coefficients than of cells, none or more than 16 in a cell, a density that is below 0 somewhere or 0
        everywhere, and a cut below 0 or above 1e-9.

    Examples
    --------
    >>> import asperity as asp
    >>> law = asp.Series([0.0, 2.0], [[0.5]])
    >>> round(law.cdf(0.5), 6)
    0.25
    """

    def __new__(
        cls, /, boundaries: ArrayLike, coefficients: Sequence[ArrayLike], *, cut: _Number = 0.0
    ) -> Series: ...
    @property
    def boundaries(self, /) -> list[float]:
        """The boundaries of the cells."""

    @property
    def coefficients(self, /) -> list[list[float]]:
        """The coefficients of each cell, as they were given."""

    @property
    def cut(self, /) -> float:
        """The probability of the tail that was truncated."""

@final
class Simulation:
    """A simulation that advances step by step, from event to event, with its state readable in between.

    simulation() of an Interface, a Lattice, a Block, a MasterEquation, a Transport or an Ensemble returns one. Its events are
    those of `drive` of the same model, bit for bit; those of a block in time are the same within the tolerance.

    Over time-dependent contacts models move in time: their load point has a `velocity`, and `hold` lets it rest.

    Ctrl-C interrupts long computations; the simulation then has the state after the last event, and can continue. Using a
    simulation while another thread advances it raises RuntimeError.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    >>> simulation = asp.Block(theory, 0.3).simulation()
    >>> _ = simulation.advance(1.0)
    >>> simulation.drive
    1.0
    """

    def __repr__(self, /) -> str: ...
    def advance(self, /, drive: _Number, *, progress: _Progress = None) -> None:
        """Advances to a displacement of the load point, through all events in between.

        Parameters
        ----------
        drive
            An absolute displacement, not a step; larger than the present one, or, for sliders that can turn back,
            also smaller. Stops do not change later results of a slider or a lattice. For an interface every stop is
            an equilibrium that is computed: stops may change the last digits of later results, and the drives of
            events within drive_tolerance. A stop of a block in time changes later results within its tolerance.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Raises
        ------
        ValueError
            For a displacement to which an interface would have to move backwards.
        """

    @property
    def drive(self, /) -> float:
        """The load-point displacement X_T, a length; without a spring, the displacement of the slider."""

    @property
    def energy(self, /) -> Energy | InterfaceEnergy:
        """The energy balance from X_T = 0: an InterfaceEnergy for an Interface, otherwise an Energy. A Lattice has none."""

    def events(self, /, until: _Number) -> Iterator[Event]:
        """Advances to the displacement `until` and yields each event after it has happened: an iterator.

        Events are those of `drive` of the same model (slips of a block or an interface, avalanches of a lattice, simultaneous
        breaks under a rigid slider), with the same fields: `drive`, `drop`, …. Between two events the state is the one just
        after the first of them; it can be read, saved, or advanced. Clusters of cells that slip in one slide of an interface
        are events at the same drive: the state is then that after the slide. The iterator ends at the displacement; a new
        one goes on with the next event.

        Parameters
        ----------
        until
            An absolute displacement of the load point, not a step; larger than the present one, or, for sliders that
            can turn back, also smaller.

        Returns
        -------
        Iterator[Event]

        Raises
        ------
        ValueError
            For a displacement to which an interface would have to move backwards.
        """

    @property
    def force(self, /) -> float:
        """The friction force of all cells and contacts."""

    @property
    def forces(self, /) -> _Array:
        """The force of each cell, or of each contact of a Lattice: shape (n,) or (rows, columns); (1,) for a slider."""

    def hold(self, /, duration: _Number, *, progress: _Progress = None) -> None:
        """Holds the load point for a duration, through all events in it. Contacts age while it rests.

        Parameters
        ----------
        duration
            A time, 0 or above.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation; `time` shows how much of it is done.

        Raises
        ------
        AttributeError
            For models without time.
        ValueError
            For a duration that is not a finite number, 0 or above.

        Examples
        --------
        >>> import asperity as asp
        >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.1, time=1.0))
        >>> sim = asp.Block(asp.Transport(contacts), 5.0, asp.Damped(0.01)).simulation(velocity=0.1)
        >>> sim.advance(4.0)
        >>> sim.hold(100.0)
        >>> round(sim.time), sim.drive
        (140, 4.0)
        """

    @property
    def model(self, /) -> Deformable | Block | Model:
        """The model of the simulation: an Interface, Lattice, Block, MasterEquation, Transport or Ensemble."""

    @property
    def positions(self, /) -> _Array:
        """The position X_j of each cell, a length: shape (n,) or (rows, columns); (1,) for a slider. A Lattice has none."""

    def restore(self, /, state: bytes) -> None:
        """Restores a state of this simulation, or of another one of the same model; it continues from there bit for bit.

        Parameters
        ----------
        state
            What `state` gave.

        Raises
        ------
        ValueError
            For the state of another model, or of another version of asperity.
        """

    def state(self, /) -> bytes:
        """The whole state of the simulation, as bytes for `restore` in the same version of asperity.

        Returns
        -------
        bytes
        """

    def stretch_density(
        self,
        /,
        cell: SupportsIndex = 0,
        stretches: ArrayLike | None = None,
        *,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
    ) -> StretchDensity:
        """The density Q(x) of the stretches of the contacts of a cell, per length.

        The result has `stretch` and `density` of shape (n,), and `atoms`, stretches that many contacts share. Detached
        contacts are not counted.

        Parameters
        ----------
        cell
            The number of a cell of an Interface, counted along rows; 0 for a slider, and for a Lattice, whose
            contacts are counted all together.
        stretches
            A list of n stretches at which the density is given, for contacts that follow the master equation.
        edges
            N + 1 rising edges of bins in which contacts are counted that are simulated one by one, or in time; at
            given stretches each of them is an atom. Without stretches and edges, a suitable grid is chosen.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        StretchDensity

        Raises
        ------
        IndexError
            If there is no such cell.
        ValueError
            For stretches and edges together, fewer than two edges or edges that do not rise, and edges for contacts
            that follow the master equation without time dependence.
        """

    @property
    def time(self, /) -> float:
        """The time; 0 for models without time."""

    @property
    def velocities(self, /) -> _Array:
        """The velocity of each cell: shape (n,) or (rows, columns); (1,) for a block. Models without time have none."""

    @property
    def velocity(self, /) -> float:
        """The velocity of the load point, above 0, with which `advance` and `events` continue; it may be changed at any time.
        Models without time have none.
        """

    @velocity.setter
    def velocity(self, /, velocity: _Number) -> None: ...

@final
class Smoluchowski(Ageing):
    """Thresholds diffuse independently in the potential U = −ln P_cf towards the mature distribution
    (Fokker–Planck equation).

    Parameters
    ----------
    mature
        The distribution P_cf of the thresholds of contacts that never break.
    diffusion
        The diffusion coefficient D, stretch² per time, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a diffusion that is not above 0, and samples or a distribution of scipy.stats with values below 0, given as
        mature. A mature distribution with point masses or gaps, or that leaves out thresholds of fresh contacts, is
        refused by the models.

    Examples
    --------
    >>> import asperity as asp
    >>> ageing = asp.Smoluchowski(asp.Gaussian(1.0, 0.05), diffusion=0.0025)
    >>> contacts = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=ageing)
    >>> round(asp.velocity_curve(contacts, 1.0), 4)
    0.3847
    """

    def __new__(cls, /, mature: _AnyLaw, diffusion: _Number) -> Smoluchowski: ...
    @property
    def diffusion(self, /) -> float:
        """The diffusion coefficient D, stretch² per time."""

    @property
    def mature(self, /) -> Law:
        """The distribution P_cf of mature thresholds."""

@final
class SteadyEstimates:
    """What a fit to a record of steady sliding has found: values of the free numbers with their errors, and how well they
    describe the record.

    Printed, or by `summary()`, it is a table. `spectrum` has the periodogram of the record with its expectation.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=2000, stiffness=0.0005)
    >>> force = asp.Ensemble(contacts, size=2000, seed=1).pull(60.0, 2401).force[400:]
    >>> found = asp.fit_steady(contacts, 0.025, force, free=["thresholds.mean"], reading=1e-5)
    >>> bool(abs(found.params["thresholds.mean"].value - 1.0) < 0.05)
    True
    """

    def __copy__(self, /) -> SteadyEstimates: ...
    def __deepcopy__(self, /, _memo: object) -> SteadyEstimates: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def contacts(self, /) -> Contacts:
        """The contacts of the estimated numbers."""

    @property
    def converged(self, /) -> bool:
        """Whether the search has converged; otherwise the estimates are its last values."""

    @property
    def correlations(self, /) -> list[Correlation]:
        """The correlations above 0.5, without sign, between the errors of two estimates: a list of Correlation."""

    @property
    def covariance(self, /) -> _Array:
        """The covariance of the estimates in the order of `params`, shape (n, n)."""

    @property
    def fixed(self, /) -> dict[str, float]:
        """The numbers that were not free: those of the contacts, and the offset if it is not 0."""

    def friction(self, /) -> FrictionEstimates:
        """F_s, F_k, X* and K_c of the estimated contacts, each with its standard error. F_s and K_c are those of a pull from
        the initial stretches, of which the record contains nothing.

        Returns
        -------
        FrictionEstimates
        """

    def interval_by_profile(self, /, name: str, *, progress: _Progress = None) -> tuple[float, float]:
        """The interval of 95 % of a free number by the profile of the likelihood: where -2 ln L, lowest in all other free
        numbers, has risen by 3.84. For independent errors of unknown size the rise is nu ln(1 + t²/nu), with Student's t
        of nu = n - p degrees of freedom for n readings and p free numbers.

        Where a fit to curves of force has free sizes of errors, L is the restricted likelihood, but for thresholds of
        free form. Its likelihood takes the noise of the contacts as normal: errors of count and stiffness also count the
        kurtosis of the whitened residuals, and may be larger. The likelihood of a record in steady sliding is the
        debiased one of Whittle.

        Parameters
        ----------
        name
            A name of `params`.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        (float, float)

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, and for a planned measurement.
        """

    def log_likelihood(self, /, values: ArrayLike) -> tuple[float, _Array]:
        """ln L at values of the free numbers, and its gradient, for samplers and other searches.

        Parameters
        ----------
        values
            A list of n numbers in the order of `params`.

        Returns
        -------
        (float, numpy.ndarray)
            ln L, with the logarithm of the priors, and an array of shape (n,); -inf and nan where the likelihood is 0.
            The covariance of the noise of contacts on a curve of force is that of the estimates, scaled by N_c⟨k⟩².
            With independent errors whose size is estimated, ln L is the highest for any size.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For another number of values than of `params`, and for a planned measurement.
        """

    @property
    def misfit(self, /) -> Misfit:
        """How well the record is described, a Misfit: of its Fourier components, each divided by its expected size."""

    @property
    def model(self, /) -> MasterEquation:
        """The master equation of the estimated numbers."""

    @property
    def offset(self, /) -> float:
        """The reading of the force where there is none, given or estimated, a force."""

    @property
    def params(self, /) -> dict[str, Estimate]:
        """The free numbers by name, and after them "reading" if it was estimated: each an Estimate."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the periodogram as dots and its expectation as a line, on logarithmic axes. Returns the axes. It needs
        matplotlib.

        Parameters
        ----------
        ax
            Axes to plot on; new ones if None. Other arguments are passed to the plot() of the expectation.
        **style
            Arguments of the plot() of the expectation.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    def profile(
        self, /, name: str, values: ArrayLike | None = None, *, progress: _Progress = None
    ) -> Profile:
        """The profile of the likelihood of a free number: by how much -2 ln L, lowest in all other free numbers, is above
        its minimum. L is that of interval_by_profile.

        Parameters
        ----------
        name
            A name of `params`.
        values
            A list of values, or None for 13 from three standard errors below the estimate to three above it; of the
            logarithm for numbers above 0 but a compliance.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        Profile

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, values that are nan, and a planned measurement.
        """

    @property
    def reading(self, /) -> float:
        """The standard deviation of the independent error of a reading, given or estimated, a force."""

    @property
    def readings(self, /) -> int:
        """The number of readings of the record."""

    def sample(
        self,
        /,
        draws: SupportsIndex = 1000,
        chains: SupportsIndex = 4,
        seed: _Seed = 1,
        *,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> Posterior:
        """Draws from the posterior by the No-U-turn sampler (NUTS), where errors from the information are not enough.

        The likelihood is that of log_likelihood. The priors are those of the fit; without one the prior of a number is
        flat, or flat in the logarithm of one above 0 that is no compliance. Each chain makes 300 draws before, which are
        left out.

        Parameters
        ----------
        draws
            The number of draws of each chain, 4 or more.
        chains
            Their number, 1 or more; as many are made at a time as there are threads.
        seed
            A whole number below 2^63, which always gives the same draws, on any number of threads, or a
            numpy.random.Generator, from which one is drawn.
        progress
            As for MasterEquation.pull.
        threads
            The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default
            those of the process, one per core or RAYON_NUM_THREADS.

        Returns
        -------
        Posterior

        Raises
        ------
        ValueError
            For a planned measurement, and if no number is known to better than a limit.
        """

    @property
    def solutions(self, /) -> int:
        """The number of solutions of the master equation that the search took, without those for derivatives."""

    @property
    def spectrum(self, /) -> Record:
        """The periodogram of the record of n readings, a Record of arrays of shape (n // 2,).

        `wave_number` is q = 2πk/(n spacing), k = 1, 2, ..., `periodogram` the squared modulus of the discrete Fourier
        transform times spacing/n, and `expected` its expectation by the estimated contacts, with aliasing, leakage and the
        error of a reading.
        """

    def summary(self, /) -> str:
        """A table in plain English: values with errors and intervals, correlations, and how well the record is described.

        Returns
        -------
        str
        """

@final
class SteadyState:
    """Steady sliding: the solution of the master equation that does not depend on X.

    Q_s(x) = Γ_s S(x) ∫₀ˣ R/S and F_k = N_c⟨k⟩ ∫x Q_s dx. If contacts re-form at 0, F_k = N_c⟨k⟩⟨x_s²⟩/(2⟨x_s⟩)
    (Braun and Peyrard 2008, Eqs. 11a and 11d).

    Examples
    --------
    >>> import asperity as asp
    >>> steady = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).steady_state()
    >>> round(steady.kinetic_friction, 3)
    0.505
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @overload
    def autocovariance(self, /, displacement: float, size: _Number | None = None) -> float:
        """The autocovariance c(u) = Cov(F(X), F(X + u)) of the force of `size` random contacts in steady sliding, scaled
        to N_c, at displacements u ≥ 0: force².

        Parameters
        ----------
        size
            The number of contacts, or None for the N_c of the contacts. If contacts re-form at 0, the slope of c(u),
            per contact, is the first loading curve less the kinetic friction. Contacts with a delay, or whose
            stiffness depends on the threshold, are refused.
        displacement
            Displacements u, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a displacement below 0, a size that is not above 0, and contacts that are refused.
        """

    @overload
    def autocovariance(self, /, displacement: ArrayLike, size: _Number | None = None) -> _Array: ...
    @property
    def breaking_rate(self, /) -> float:
        """The breaking rate Γ_s, the fraction of contacts that break per length."""

    def force_std(self, /, size: _Number) -> float:
        """The standard deviation of the force of `size` random contacts, scaled to N_c.

        Parameters
        ----------
        size
            The number of contacts; None for the N_c of the contacts.

        Returns
        -------
        float

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a size that is not above 0.
        """

    @property
    def kinetic_friction(self, /) -> float:
        """The kinetic friction F_k, a force."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the distribution of stretches, point masses as stems; it needs matplotlib, whose styles it follows.

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

    @overload
    def spectrum(self, /, wave_number: float, size: _Number | None = None) -> float:
        """The spectrum S(q) = ∫c(u) exp(iqu) du over all u of the force of `size` random contacts in steady sliding, scaled
        to N_c, at wave numbers q ≥ 0, in radians per length: force² times length.

        Parameters
        ----------
        size
            The number of contacts, or None for the N_c of the contacts. If contacts re-form at 0, q² S(q)/(2F_k)
            tends to the stiffness of one contact, N_c⟨k⟩/size, for large q. Identical contacts that re-form at one
            stretch are refused: their spectrum consists of lines.
        wave_number
            Wave numbers q, 0 or above: a number or an array of any shape.

        Returns
        -------
        float or numpy.ndarray
            A number for a number, an array of the same shape for an array.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a wave_number below 0, a size that is not above 0, and contacts that are refused.
        """

    @overload
    def spectrum(self, /, wave_number: ArrayLike, size: _Number | None = None) -> _Array: ...
    def stretch_density(self, /, stretches: ArrayLike | None = None) -> StretchDensity:
        """The distribution Q_s of stretches, per length.

        Parameters
        ----------
        stretches
            A list of n stretches, or None for an automatic choice that resolves it. The result has `stretch` and
            `density` of shape (n,), and `atoms`.

        Returns
        -------
        StretchDensity

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For stretches below 0.
        """

@final
class Step(Description):
    """A step of a motion in time: motion at a velocity over a distance or for a duration, a ramp, or a hold.

    Parameters
    ----------
    velocity
        A length per time; above 0 over a distance, 0 or above for a duration.
    distance
        The displacement in the step.
    duration
        The time that the step takes.
    hold
        A time at rest, instead of all others.
    velocity_to
        The velocity at the end of a ramp that begins at velocity and takes a duration.
    points
        The number of points of the trace in the step, evenly spaced in time, on a ramp where it is at such times, including both
        ends; 2 or more.
    pieces
        The number of intervals of constant velocity that approximate a ramp, 64 by default.
    relative_normal_load
        The normal load in the step relative to that at the start of the first one, above 0; it changes at the beginning
        of the step, and the number of contacts with it. In a first step only 1.

    Raises
    ------
    ValueError
        For none or more than one of hold, distance and duration; a velocity beside hold, or none without; a distance,
        a duration or a hold that is not above 0; a velocity or a velocity_to below 0, or a velocity of 0 over a
        distance; velocity_to without a duration; pieces without velocity_to, or not from 1 to 65536; fewer than 2
        points; and a relative_normal_load that is not above 0.

    Examples
    --------
    >>> import asperity as asp
    >>> asp.Step(1.0, distance=10.0)
    Step(velocity=1.0, distance=10.0)
    >>> asp.Step(hold=100.0).hold
    100.0
    """

    def __new__(
        cls,
        /,
        velocity: _Number | None = None,
        *,
        distance: _Number | None = None,
        duration: _Number | None = None,
        hold: _Number | None = None,
        velocity_to: _Number | None = None,
        points: SupportsIndex = 201,
        pieces: SupportsIndex | None = None,
        relative_normal_load: _Number | None = None,
    ) -> Step: ...
    @property
    def distance(self, /) -> float | None:
        """The displacement in the step, a length, or None."""

    @property
    def duration(self, /) -> float | None:
        """The time that a step at a velocity takes, or None."""

    @property
    def hold(self, /) -> float | None:
        """The time at rest, or None."""

    @property
    def pieces(self, /) -> int | None:
        """The number of intervals of constant velocity that approximate a ramp; None where it was not given."""

    @property
    def points(self, /) -> int:
        """The number of points of the trace in the step."""

    @property
    def relative_normal_load(self, /) -> float | None:
        """The normal load in the step relative to that at the start of the first one, or None where it was not given."""

    @property
    def velocity(self, /) -> float | None:
        """The velocity, at the beginning of a ramp, a length per time, or None."""

    @property
    def velocity_to(self, /) -> float | None:
        """The velocity at the end of a ramp, a length per time, or None."""

@final
class StickSlip(Record):
    """The result of a drive of a slider: its trace, its slips, and the regime of sliding.

    Its variables are those of the trace, `drive`, `position`, `force` and `spring_force`, at states of
    equilibrium; those of the slips, `event_drive`, `event_drop`, …; for an inertial slip its time course,
    `slip_time`, `slip_position`, …; for an ensemble the sizes of events, `size`, `size_events`, …. For motion
    in time the trace also has `time`, `velocity` and `free` (the detached fraction of the contacts), and there
    are no time course and no sizes.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
    >>> run = asp.Block(theory, 1.0).drive(5.0)
    >>> len(run.events) > 0
    True
    """

    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def block(self, /) -> Block:
        """The block that was driven."""

    @property
    def drive(self, /) -> _Array:
        """The drive along the trace, shape (n,): the load-point displacement X_T, a length; or the imposed force."""

    @property
    def energy(self, /) -> Energy:
        """The energy balance from the start of the drive to its end (for a runaway, to where it began)."""

    @property
    def events(self, /) -> Events:
        """The slips."""

    @property
    def first_instability(self, /) -> State | None:
        """The state at which the slider first became unstable; None if it never did."""

    @property
    def mean_drop(self, /) -> float | None:
        """The mean drop of the force in a slip."""

    @property
    def mean_slip(self, /) -> float | None:
        """The mean slip (displacement of the slider in a slip), a length."""

    @property
    def period(self, /) -> float | None:
        """The mean increase of the drive from one slip to the next, a length; None, as for all such means, unless
        stick-slip is persistent.
        """

    @property
    def reason(self, /) -> str:
        """The regime with its reason, in words."""

    @property
    def regime(self, /) -> Literal["smooth", "transient", "persistent", "runaway", "undecided"]:
        """The regime of sliding: "smooth" without slips; "transient" if slips have ceased; "persistent" if they
        continue with a steady period; "runaway" if the contacts could not carry the imposed force; "undecided" if
        the drive was too short. It refers to the drive since its last reversal.
        """

    @property
    def runaway(self, /) -> State | None:
        """The state from which the slider ran away under an imposed force; None if it did not."""

    @property
    def scatter(self, /) -> float | None:
        """The relative standard deviation of the period: the standard deviation of the increases of the drive from one
        slip to the next, divided by their mean.
        """

    @property
    def sizes(self, /) -> Sizes | None:
        """The number of events of each size, including those too small for a slip; None for the master equation."""

    @property
    def slip_course(self, /) -> Course | None:
        """The time course of the first inertial slip; None if there was none."""

    @property
    def spring_force(self, /) -> _Array:
        """The spring force K(X_T - X) along the trace, shape (n,); it equals F in equilibrium."""

    @property
    def time(self, /) -> _Array | None:
        """The times of the trace of motion in time, shape (n,); None without."""

    @property
    def velocity(self, /) -> _Array | None:
        """The velocity of the slider along the trace of motion in time, shape (n,); None without."""

@final
class Tabulated(Law):
    """A measured distribution: a density given at increasing stretches, or a sample.

    Parameters
    ----------
    stretch, density
        Lists of equal length; the density is linear between them, 0 outside, and normalised.
    samples
        A list of equally likely values, of any length; the distribution is their kernel density estimate, with
        their mean and standard deviation.
    bandwidth
        Of the kernels, a length; by default that of Silverman's rule, 0.9 min(s, IQR/1.34) n^(-1/5).
    exact
        Quantiles that are linear between the samples (as in numpy.quantile) instead of a kernel density estimate.
        Each sample is then a jump of the density, and more than twenty take the master equation minutes. Give
        either stretch and density, or samples.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For neither or both of stretch with density and samples, lists of different lengths, fewer than two rows,
        no samples, numbers below 0, stretches that do not rise, a density that is 0 everywhere, a bandwidth that
        is not above 0 or beside exact, and bandwidth or exact without samples.

    Examples
    --------
    >>> import asperity as asp
    >>> law = asp.Tabulated(stretch=[0.9, 1.1], density=[1.0, 1.0])
    >>> round(law.pdf(1.0), 6)
    5.0
    """

    def __new__(
        cls,
        /,
        *,
        stretch: ArrayLike | None = None,
        density: ArrayLike | None = None,
        samples: ArrayLike | None = None,
        bandwidth: _Number | None = None,
        exact: bool = False,
    ) -> Tabulated: ...
    @property
    def bandwidth(self, /) -> float | None:
        """The bandwidth that was given, a length; None for that of Silverman's rule."""

    @property
    def density(self, /) -> list[float] | None:
        """The density there, as it was given; None for samples."""

    @property
    def exact(self, /) -> bool:
        """Whether quantiles are linear between the samples."""

    @property
    def samples(self, /) -> list[float] | None:
        """The samples; None for a density."""

    @property
    def stretch(self, /) -> list[float] | None:
        """The stretches at which the density is given; None for samples."""

@final
class Temperature(Description):
    """Thermally activated breaking (Kramers): contacts below their thresholds break at the rate w = ω exp(−ΔE/T).

    Parameters
    ----------
    energy
        The temperature T in units of energy (force × length), above 0.
    attempt_rate
        The attempt rate ω, per time, above 0.
    barrier
        ΔE of a contact of stretch x below its threshold x_s, with E_0 = ½k x_s²: "elastic", ½k(x_s² − x²); "bell",
        E_0(1 − x/x_s); "catastrophe", E_0(1 − x/x_s)^(3/2).
    hazard
        "joint", each contact breaks at the rate of its own threshold; "additive", all of one stretch break at the rate
        of the average contact (O. M. Braun and M. Peyrard, 2010).

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For an energy or an attempt_rate that is not above 0, and another word as barrier or hazard.

    Examples
    --------
    >>> import asperity as asp
    >>> thermal = asp.Temperature(energy=0.05, attempt_rate=1.0)
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=thermal)
    >>> friction = asp.velocity_curve(contacts, [1e-4, 1e-2]).kinetic_friction
    >>> bool(friction[0] < friction[1])
    True
    """

    def __new__(
        cls,
        /,
        energy: _Number,
        attempt_rate: _Number,
        *,
        barrier: Literal["elastic", "bell", "catastrophe"] = "elastic",
        hazard: Literal["joint", "additive"] = "joint",
    ) -> Temperature: ...
    @property
    def attempt_rate(self, /) -> float:
        """The attempt rate ω, per time."""

    @property
    def barrier(self, /) -> Literal["elastic", "bell", "catastrophe"]:
        """The barrier ΔE, "elastic", "bell" or "catastrophe"."""

    @property
    def energy(self, /) -> float:
        """The temperature T, an energy."""

    @property
    def hazard(self, /) -> Literal["joint", "additive"]:
        """The rate of thermal breaking, "joint" or "additive"."""

@final
class ThresholdResponse:
    """The response of the force on a pull to the probability of n single thresholds, a force per unit of probability.

    Called with a position it is an array of shape (n,), with a list of m positions one of shape (n, m).

    Examples
    --------
    >>> import asperity as asp
    >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
    >>> response = pull.threshold_response([0.9, 1.1])
    >>> response(1.5).shape
    (2,)
    """

    def __call__(self, /, position: ArrayLike) -> _Array: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def adjoint(self, /, position: ArrayLike, weights: ArrayLike) -> _Array:
        """The derivatives of a scalar by the probability of each threshold, shape (n,).

        Parameters
        ----------
        position
            A list of m positions from 0 to the distance of the pull.
        weights
            The derivatives of the scalar by the forces at these positions.

        Returns
        -------
        numpy.ndarray

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a position below 0 or beyond the distance, and another number of weights than of positions.
        """

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the response to some of the thresholds, seven at most, at the positions of the pull; it needs matplotlib, whose
        styles it follows.

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

    @property
    def thresholds(self, /) -> _Array:
        """The thresholds, shape (n,)."""

@final
class Transport(Model):
    """The master equation at a varying velocity: cohorts of contacts that formed together are followed in time.

    Parameters
    ----------
    contacts, initial, start
        As for MasterEquation; the contacts have age 0 at t = 0, or, with start="steady", which all contacts may have,
        the ages of steady sliding at velocity, without initial.
    velocity
        The velocity of that steady sliding, above 0.
    tolerance
        Allowed error of the force per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; by default 1e-6, and
        1e-4 for ageing by Smoluchowski.

    Raises
    ------
    ValueError
        For another word as start, no velocity, one that is not above 0 or initial stretches with start="steady", a
        velocity without, a tolerance that is not from 1e-12 to 1e-2, and ageing by MeanField of thresholds with point
        masses, or with stiffnesses that depend on them.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))
    >>> motion = asp.Transport(contacts).follow([asp.Step(1.0, distance=2.0), asp.Step(hold=10.0)])
    >>> bool(motion['time'][-1] == 12.0)
    True
    """

    def __new__(
        cls,
        /,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        start: Literal["conditional", "relaxed", "steady"] = "conditional",
        velocity: _Number | None = None,
        tolerance: _Number | None = None,
    ) -> Transport: ...
    def follow(self, /, steps: Sequence[Step], *, progress: _Progress = None) -> Record:
        """Follows the contacts from t = 0 through the steps, one after the other.

        Parameters
        ----------
        steps
            A list of Step.
        progress
            As for MasterEquation.pull. Ctrl-C interrupts the computation.

        Returns
        -------
        Record
            A Record of variables of shape (n,), with n output points of all steps (steps share the point where they
            meet): `time`, `position`, `velocity` (from the right), `force`, `breaking_frequency` (the fraction of
            contacts that break per time), `free` (the detached fraction: contacts that are broken and have not yet
            re-formed) and `force_error` (an upper estimate of the largest error of the force, the same at all
            points). Where relative_normal_load varies also that variable; at a time at
            which it steps there are two points, before and after the step.

        Raises
        ------
        ValueError
            For no steps, a relative_normal_load of the first step that is not 1, and another one than 1 with ageing by
            MeanField.
        RuntimeError
            If that error is larger than a given tolerance.
        """

    def simulation(self, /, *, velocity: _Number) -> Simulation:
        """The contacts under a rigid slider, to be moved step by step; `energy` is not computed, and there are no events.

        Parameters
        ----------
        velocity
            The velocity of the slider, above 0, which may be changed later.

        Returns
        -------
        Simulation
            A simulation that advances step by step, at X = 0.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a velocity that is not above 0.
        """

    @property
    def tolerance(self, /) -> float | None:
        """The allowed error of the force per contact and per ⟨k⟩ × mean threshold; None for the default."""

    @property
    def velocity(self, /) -> float | None:
        """The velocity of the steady sliding in which the contacts start, or None."""

@final
class VelocityCurveEstimates:
    """What a fit to forces of steady sliding at several velocities has found: values of the free numbers with their errors, and
    how well they describe the forces.

    Printed, or by `summary()`, it is a table. `curve` has the readings and the fitted curve with its error.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), delay=0.5)
    >>> velocity, force = [0.1, 1.0, 10.0], [0.488, 0.349, 0.092]
    >>> found = asp.fit_velocity_curve(contacts, velocity, force, free=["delay"], reading=0.002)
    >>> bool(abs(found.params["delay"].value - 0.47) < 0.02)
    True
    """

    def __copy__(self, /) -> VelocityCurveEstimates: ...
    def __deepcopy__(self, /, _memo: object) -> VelocityCurveEstimates: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def contacts(self, /) -> Contacts:
        """The contacts of the estimated numbers."""

    @property
    def converged(self, /) -> bool:
        """Whether the search has converged; otherwise the estimates are its last values."""

    @property
    def correlations(self, /) -> list[Correlation]:
        """The correlations above 0.5, without sign, between the errors of two estimates: a list of Correlation."""

    @property
    def covariance(self, /) -> _Array:
        """The covariance of the estimates in the order of `params`, shape (n, n)."""

    @property
    def curve(self, /) -> Record:
        """The readings and the fitted curve, a Record.

        `reading_velocity`, `reading_friction`, `reading_expected_friction`, `reading_friction_std` and
        `reading_friction_residual` are of shape (n,): velocities, measured and expected forces, the standard deviations of the
        measured ones, and the residuals divided by them. `fit_velocity`, `fit_friction` and `fit_friction_error` are of shape
        (33,): velocities at equal ratios, the expected force with background and offset, and its standard error, which
        follows from the covariance of the estimates.
        """

    @property
    def fixed(self, /) -> dict[str, float]:
        """The numbers that were not free: those of the contacts, and background and offset if they are not 0."""

    def interval_by_profile(self, /, name: str, *, progress: _Progress = None) -> tuple[float, float]:
        """The interval of 95 % of a free number by the profile of the likelihood: where -2 ln L, lowest in all other free
        numbers, has risen by 3.84. For independent errors of unknown size the rise is nu ln(1 + t²/nu), with Student's t
        of nu = n - p degrees of freedom for n readings and p free numbers.

        Where a fit to curves of force has free sizes of errors, L is the restricted likelihood, but for thresholds of
        free form. Its likelihood takes the noise of the contacts as normal: errors of count and stiffness also count the
        kurtosis of the whitened residuals, and may be larger. The likelihood of a record in steady sliding is the
        debiased one of Whittle.

        Parameters
        ----------
        name
            A name of `params`.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        (float, float)

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, and for a planned measurement.
        """

    def log_likelihood(self, /, values: ArrayLike) -> tuple[float, _Array]:
        """ln L at values of the free numbers, and its gradient, for samplers and other searches.

        Parameters
        ----------
        values
            A list of n numbers in the order of `params`.

        Returns
        -------
        (float, numpy.ndarray)
            ln L, with the logarithm of the priors, and an array of shape (n,); -inf and nan where the likelihood is 0.
            The covariance of the noise of contacts on a curve of force is that of the estimates, scaled by N_c⟨k⟩².
            With independent errors whose size is estimated, ln L is the highest for any size.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For another number of values than of `params`, and for a planned measurement.
        """

    @property
    def misfit(self, /) -> Misfit:
        """How well the forces are described, a Misfit. The test of whiteness is that of residuals in the order of velocities."""

    @property
    def model(self, /) -> MasterEquation:
        """The master equation of the estimated numbers, at the lowest velocity."""

    @property
    def offset(self, /) -> float:
        """The reading of the force where there is none, given or estimated, a force."""

    @property
    def params(self, /) -> dict[str, Estimate]:
        """The free numbers by name: each an Estimate."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the measured forces with their errors and the fitted curve with twice its standard error, against the logarithm
        of the velocity. Returns the axes. It needs matplotlib.

        Parameters
        ----------
        ax
            Axes to plot on; new ones if None.
        **style
            Arguments of the plot() of the fitted curve.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    def profile(
        self, /, name: str, values: ArrayLike | None = None, *, progress: _Progress = None
    ) -> Profile:
        """The profile of the likelihood of a free number: by how much -2 ln L, lowest in all other free numbers, is above
        its minimum. L is that of interval_by_profile.

        Parameters
        ----------
        name
            A name of `params`.
        values
            A list of values, or None for 13 from three standard errors below the estimate to three above it; of the
            logarithm for numbers above 0 but a compliance.
        progress
            As for MasterEquation.pull.

        Returns
        -------
        Profile

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a name that is none of `params`, values that are nan, and a planned measurement.
        """

    @property
    def reading(self, /) -> float:
        """The standard deviation of a reading, given or estimated, a force; the root mean square of errors that differ."""

    @property
    def readings(self, /) -> int:
        """The number of measured forces."""

    def sample(
        self,
        /,
        draws: SupportsIndex = 1000,
        chains: SupportsIndex = 4,
        seed: _Seed = 1,
        *,
        progress: _Progress = None,
        threads: SupportsIndex | None = None,
    ) -> Posterior:
        """Draws from the posterior by the No-U-turn sampler (NUTS), where errors from the information are not enough.

        The likelihood is that of log_likelihood. The priors are those of the fit; without one the prior of a number is
        flat, or flat in the logarithm of one above 0 that is no compliance. Each chain makes 300 draws before, which are
        left out.

        Parameters
        ----------
        draws
            The number of draws of each chain, 4 or more.
        chains
            Their number, 1 or more; as many are made at a time as there are threads.
        seed
            A whole number below 2^63, which always gives the same draws, on any number of threads, or a
            numpy.random.Generator, from which one is drawn.
        progress
            As for MasterEquation.pull.
        threads
            The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default
            those of the process, one per core or RAYON_NUM_THREADS.

        Returns
        -------
        Posterior

        Raises
        ------
        ValueError
            For a planned measurement, and if no number is known to better than a limit.
        """

    @property
    def solutions(self, /) -> int:
        """The number of curves that the search computed, without those for derivatives."""

    def summary(self, /) -> str:
        """A table in plain English: values with errors and intervals, correlations, and how well the forces are described.

        Returns
        -------
        str
        """

@final
class VelocityStep:
    """A measured velocity step: its rate-and-state parameters, each an Estimate with its value, its standard error and its
    95 % interval. Made by read_velocity_step.

    Called with positions relative to the step it is the fitted force.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> x = np.linspace(-5.0, 10.0, 301)
    >>> force = 0.6 + np.where(x < 0.0, 0.0, 0.01 - 0.02 * (1.0 - np.exp(-x)))
    >>> step = asp.read_velocity_step(x, force, 10.0)
    >>> round(step.distance.value, 2)
    1.0
    """

    @overload
    def __call__(self, /, position: float) -> float: ...
    @overload
    def __call__(self, /, position: ArrayLike) -> _Array: ...
    def __reduce__(self, /) -> tuple[Any, tuple[Any, ...]]: ...
    def __repr__(self, /) -> str: ...
    @property
    def a(self, /) -> Estimate:
        """The direct effect a for the position of the peak, a force per ln(v/v_0)."""

    @property
    def a_minus_b(self, /) -> Estimate:
        """a - b, the change of the steady force per ln(v/v_0). It does not depend on the position of the peak."""

    @property
    def b(self, /) -> Estimate:
        """The evolution effect b for the position of the peak, a force per ln(v/v_0)."""

    @property
    def before(self, /) -> Estimate:
        """The force F_0 before the step; its error is 0 if it was given."""

    @property
    def distance(self, /) -> Estimate:
        """The characteristic slip distance D_c, a length; the interval ends at inf if the curve gives no upper limit."""

    @property
    def fitted(self, /) -> _Array:
        """The fitted forces at the positions that were fitted, shape (n,)."""

    @property
    def force(self, /) -> _Array:
        """The measured forces there, shape (n,)."""

    @property
    def noise(self, /) -> MeasuredNoise:
        """The noise that the errors follow from, estimated from the residuals."""

    @property
    def peak(self, /) -> float:
        """The position X_p relative to the step from which on the force relaxes, a length."""

    def plot(self, /, ax: Axes | None = None, **style: Any) -> Axes:
        """Plots the measured force as dots and the fit as a line. Returns the axes. It needs matplotlib.

        Parameters
        ----------
        ax
            Axes to plot on; new ones if None. Other arguments are passed to the plot() of the fit.
        **style
            Arguments of the plot() of the fit.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """

    @property
    def position(self, /) -> _Array:
        """The positions that were fitted, relative to the step, shape (n,), a length."""

    @property
    def ratio(self, /) -> float:
        """v/v_0."""

    @property
    def residual(self, /) -> float:
        """The root-mean-square residual of the fit, a force."""

    @property
    def trend(self, /) -> Estimate | None:
        """The slope of the force, a force per length; None without trend."""

    @property
    def unused_force(self, /) -> _Array:
        """The measured forces there, shape (m,)."""

    @property
    def unused_position(self, /) -> _Array:
        """The positions that were not fitted, shape (m,), a length: between the step and the peak, and before the step where
        the force there was given.
        """

    @property
    def warnings(self, /) -> list[str]:
        """Sentences about numbers that are not to be trusted; empty if there is nothing to say."""

    @property
    def whiteness(self, /) -> float | None:
        """The probability that white noise has correlations as large as those of the whitened residuals
        (Ljung-Box test); None if there are none. Where it is far below 0.01 the noise is not of this kind,
        and the errors are not reliable.
        """

@final
class Weibull(Law):
    """The Weibull distribution: survival exp(−(x/scale)^shape).

    Parameters
    ----------
    shape
        Shape k of e^{−(x/λ)^k}, above 0.
    scale
        Scale λ, above 0.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For a shape or a scale that is not above 0. Lengths are from 1e-150 to 1e150.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.Weibull(shape=2.0, scale=1.0).sf(1.0), 6)
    0.367879
    """

    def __new__(cls, /, shape: _Number, scale: _Number) -> Weibull: ...
    @property
    def scale(self, /) -> float:
        """Scale λ, above 0."""

    @property
    def shape(self, /) -> float:
        """Shape k of e^{−(x/λ)^k}, above 0."""

@final
class _Engine:
    """
    Answers requests of the page, texts of JSON both. It keeps what the last one has solved.
    """

    def __new__(cls, /) -> _Engine: ...
    def answer(self, /, request: str, progress: _Progress = None) -> str: ...

@final
class _Sweep:
    """
    A sweep of `asperity.sweep`: its cases, and those that are there.
    """

    def add(self, /, cases: bytes) -> None: ...
    def add_case(
        self,
        /,
        number: SupportsIndex,
        found: Mapping[str, float | str] | None,
        failure: str | None,
        *,
        flush: bool,
    ) -> None: ...
    @property
    def cases(self, /) -> int: ...
    def compute(self, /, threads: SupportsIndex | None, *, progress: _Progress = None) -> None: ...
    def finish(self, /) -> tuple[dict[str, Any], list[Any], list[Any]]: ...
    def flush(self, /) -> None: ...
    def missing(self, /) -> list[int]: ...
    @staticmethod
    def of_function(
        hash: str,
        text: str,
        axes: Sequence[tuple[str, Sequence[float] | Sequence[str]]],
        folder: str | PathLike[str] | None,
        retry: bool,
    ) -> _Sweep: ...
    @staticmethod
    def of_scenario(
        scenario: str | PathLike[str] | Mapping[str, Any],
        overrides: Mapping[str, Any] | None,
        folder: str | PathLike[str] | None,
        retry: bool,
    ) -> _Sweep: ...
    @property
    def specification(self, /) -> tuple[str, str, Path, list[str]] | None: ...

def _command(arguments: Sequence[str]) -> int: ...
def _complete_text(scenario: str | PathLike[str] | Mapping[str, Any]) -> str: ...
def _explorer_page(nonce: str) -> str: ...
def _measured_pieces(
    time: ArrayLike, position: ArrayLike, apart: _Number, least: SupportsIndex
) -> list[tuple[int, int, float, float, float]]: ...
def _resolve(density: Callable[[_Array], ArrayLike], boundaries: Sequence[float]) -> Series: ...
def _restore(version: str, description: str) -> Description: ...
def _restore_fit(
    version: str,
    function: str,
    named: dict[str, object],
    law: str | None,
    content: bytes,
    parts: tuple[Any, ...],
) -> object: ...
def _restore_result(version: str, kind: str, content: bytes, model: object = None) -> object: ...
def _sweep_cases(
    specification: tuple[str, str, str | PathLike[str], Sequence[str]],
    cases: Sequence[SupportsIndex],
    threads: SupportsIndex,
) -> bytes: ...
def critical_coupling(law: _AnyLaw) -> float:
    """κ_c = 1/max(x P_c(x)), the coupling at which contacts with this distribution of thresholds break in one
    avalanche; 0 if some thresholds are identical.

    For a slider of stiffness K over contacts of total stiffness N⟨k⟩ the coupling is κ = N⟨k⟩/(K + N⟨k⟩). For
    narrow distributions it is critical when K is the critical stiffness.

    Parameters
    ----------
    law
        The distribution P_c of the thresholds.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For samples or a distribution of scipy.stats with values below 0, given as law.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.critical_coupling(asp.Gaussian(1.0, 0.1)), 4)
    0.2494
    """

def fit(
    contacts: Contacts,
    position: ArrayLike,
    force: ArrayLike | None,
    *,
    free: Sequence[str],
    initial: _AnyLaw | None = None,
    start: Literal["conditional", "relaxed"] = "conditional",
    velocity: _Number | None = None,
    noise: Literal["contacts", "white"] = "contacts",
    reading: _Number | None = None,
    position_error: _Number | None = None,
    drift: _Number | None = None,
    compliance: _Number | Literal["free"] = 0.0,
    offset: _Number = 0.0,
    trend: _Number = 0.0,
    origin: _Number = 0.0,
    prior: Mapping[str, tuple[float, float]] | None = None,
    average: SupportsIndex = 1,
    laws: Sequence[str] = (),
    progress: _Progress = None,
) -> Estimates:
    """Fits numbers of contacts, and of the machine, to one or more measured curves of force.

    A reading of the force at the position y is F(X) + B + offset + trend y + an error, where y = origin + X + compliance
    (F(X) + B), F(X) is the force of the contacts on a pull, and B their background force. The most probable values are
    found by Fisher scoring, and their errors follow from the expected information; sizes of errors are those of the highest
    restricted likelihood.

    Parameters
    ----------
    contacts, initial, velocity
        As for MasterEquation; their free numbers are first values.
    start
        "conditional" or "relaxed", as for MasterEquation; the pull of a fit does not begin in steady sliding.
    position
        Positions y of the n readings, rising: of the slider, or of the drive if compliance is not 0. A list of such
        lists for several curves, whose noise is that of different contacts.
    force
        The n measured forces, or a list of such lists; or None for a planned measurement, for which the result has
        the errors that the free numbers would have, at their first values.
    free
        The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "reforming.std",
        "count" and "stiffness", and "background", "compliance", "offset", "trend" and "origin". Each is common to all
        curves; a name after "curve.0.", "curve.1.", ... is that of a number of one curve, such as "curve.1.offset".
    noise
        "contacts" if errors contain the noise of the N_c contacts, whose covariance is known: count is then their
        number, not 1 for forces per contact; "white" if they are independent. With "white", count and stiffness
        cannot both be free.
    reading
        The standard deviation of the independent error of a reading, after averaging; estimated if None.
    position_error
        The standard deviation of the independent error of a position, a length, with noise "white": the error of a force
        is then larger by it times the slope of the curve. Exact positions if None.
    drift
        The longest correlation length of a slow drift of the force, below a quarter of the range of positions; its
        size and its length are then estimated. No drift if None.
    compliance
        Displacement of the drive against the slider per force, of slider and machine together; "free" if it is to be
        found, from a first value that follows from the steepest slope of the curve.
    offset
        The reading of the force where there is none.
    trend
        The change of that reading per length.
    origin
        The reading of the position at X = 0.
    prior
        For some of the free numbers what is known beforehand, {name: (value, error)}: a normal distribution, of the
        logarithm for numbers above 0 but a compliance.
    average
        The number of neighbouring readings to replace by their mean; with noise "contacts" or a drift at most 4000
        may remain.
    laws
        Names of distributions of thresholds, such as "gamma" and "lognormal", for each of which the same fit is made
        with all its numbers free instead of those of contacts.thresholds: Estimates.laws.
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    Estimates

    Raises
    ------
    ValueError
        For an unknown or repeated name in free, none in it, a prior of a number that is not free or whose error is not
        above 0, an unknown name in laws, a first value that is not above 0 where it has to be, lists of different
        lengths or with numbers that are not finite, positions that do not rise, fewer readings than free numbers and
        two, a constant force, forces of the other sign, positions in another unit than lengths of the contacts, an
        average of 0, a reading, a position_error or a drift that is not above 0, a drift of a quarter of the range of positions or more, a position_error with the noise of contacts,
        another word as noise, and numbers that the curve does not determine. A search that does not converge is no
        error: see Estimates.converged.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), count=1000, stiffness=0.001)
    >>> position = np.linspace(0.05, 3.0, 60)
    >>> force = asp.MasterEquation(contacts).pull(3.0).sample_paths(position, 1, size=1000, seed=1)[0]
    >>> found = asp.fit(contacts, position, force, free=['thresholds.mean', 'thresholds.std'], reading=1e-4)
    >>> found.converged
    True
    >>> bool(abs(found.params['thresholds.mean'].value - 1.0) < 4 * found.params['thresholds.mean'].error)
    True
    """

def fit_healing(
    hold: ArrayLike,
    force: ArrayLike,
    before: _Number,
    velocity: _Number,
    stiffness: _Number,
    *,
    held: ArrayLike | None = None,
    a: _Number | None = None,
    law: Literal["ageing", "slip"] = "ageing",
    progress: _Progress = None,
) -> MachineHealing:
    """Fits rate-and-state friction, solved with the spring of the machine, to slide-hold-slide tests, computed or measured.

    The load point moves at v, rests for the time of the hold, and moves at v again. In the hold the slider creeps on and
    unloads the spring; after it the force is highest where the slider has reached v. Both depend on the stiffness of the
    machine and on v. b and D are found by least squares, by the method of Levenberg and Marquardt, and a too if it is not
    given. The misfit is stated, and no errors: what a fit leaves of a computed curve is what the equation does not describe
    (read_healing gives errors of the growth per decade, without a spring).

    Parameters
    ----------
    hold
        Hold times, a list of at least 4 numbers above 0.
    force
        The highest force after each hold.
    before
        The force F_0 of steady sliding before the holds; 0 if forces are differences from it.
    velocity
        The velocity v of the load point before and after the holds, above 0.
    stiffness
        The stiffness K of the machine, a force per length, above 0.
    held
        The force at the end of each hold, if it is known. It is needed without a: peaks alone do not determine a.
    a
        The direct effect a, if it is known, for example of a velocity step (fit_velocity_step), above 0.
    law
        "ageing", with d(theta)/dt = 1 - V theta/D, or "slip", with d(theta)/dt = -(V theta/D) ln(V theta/D).
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    MachineHealing

    Raises
    ------
    ValueError
        For fewer than 4 holds, holds, a velocity, a stiffness or a that are not above 0, another number of forces than of
        holds, numbers that are not finite, another word as law, neither a nor held, and forces that do not differ from F_0
        or for which the slider runs away in every fit. The misfit tells whether other forces are described.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> hold = np.array([1.0, 10.0, 100.0, 1000.0, 10000.0])
    >>> force = 0.6 + 0.01 * np.log1p(hold / 2.0)
    >>> found = asp.fit_healing(hold, force, 0.6, velocity=1.0, stiffness=0.01, a=0.008)
    >>> round(found.b, 3)
    0.01
    """

def fit_steady(
    contacts: Contacts,
    spacing: _Number,
    force: ArrayLike,
    *,
    free: Sequence[str],
    initial: _AnyLaw | None = None,
    start: Literal["conditional", "relaxed"] = "conditional",
    velocity: _Number | None = None,
    reading: _Number | None = None,
    offset: _Number = 0.0,
    prior: Mapping[str, tuple[float, float]] | None = None,
    progress: _Progress = None,
) -> SteadyEstimates:
    """Fits numbers of contacts to a record of the force in steady sliding: to its mean and to its noise.

    The force of the N_c contacts is a stationary process with the mean F_k and a known autocovariance, to which
    independent errors of readings are added. The likelihood is the debiased one of Whittle: the components of the
    discrete Fourier transform count as independent, with their exact variances, aliasing and leakage included.

    Parameters
    ----------
    contacts, velocity
        As for MasterEquation; their free numbers are first values.
    spacing
        The displacement of the slider from one reading to the next, above 0.
    force
        The n measured forces, 16 or more for each free number; none of them before sliding is steady.
    free
        The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "reforming.std",
        "count" and "stiffness", but not of initial stretches, of which steady sliding is independent; and "offset".
        Thresholds and re-forming stretches cannot all be shifted together with count and stiffness free; with
        "offset", count and stiffness cannot both be free, unless one has a prior.
    initial, start
        As for MasterEquation; only the static friction and the critical stiffness of the result depend on them.
    reading
        The standard deviation of the independent error of a reading; estimated if None.
    offset
        The reading of the force where there is none.
    prior
        As for fit.
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    SteadyEstimates

    Raises
    ------
    ValueError
        For a spacing that is not above 0, an unknown or repeated name in free, none in it, a prior of a number that is
        not free or whose error is not above 0, fewer than 16 forces for each free number, forces that are not finite
        or do not scatter, a reading below 0, contacts with a background force or whose spectrum has lines, and numbers
        that the record does not determine. A search that does not converge is no error: see SteadyEstimates.converged.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=2000, stiffness=0.0005)
    >>> pull = asp.Ensemble(contacts, size=2000, seed=1).pull(60.0, 2401)
    >>> force = pull.force[400:]
    >>> found = asp.fit_steady(contacts, 0.025, force, free=['thresholds.mean'], reading=1e-5)
    >>> bool(abs(found.params['thresholds.mean'].value - 1.0) < 0.05)
    True
    """

def fit_velocity_curve(
    contacts: Contacts,
    velocity: ArrayLike,
    force: ArrayLike,
    *,
    free: Sequence[str],
    error: ArrayLike | None = None,
    reading: _Number | None = None,
    offset: _Number = 0.0,
    prior: Mapping[str, tuple[float, float]] | None = None,
    progress: _Progress = None,
) -> VelocityCurveEstimates:
    """Fits numbers of contacts to forces of steady sliding at several velocities.

    The readings are F_k(v) + B + offset + errors, with the kinetic friction F_k of the stationary renewal process at the
    velocity v, and the background force B of the contacts. Errors are independent and normal: each of its own standard
    deviation (error), or all of one size, which is given (reading) or estimated. The most probable values are found by the
    method of Levenberg and Marquardt with derivatives by central differences. If all times of the contacts are free, the
    search begins also with those multiplied by one factor, from 1e-4 to 1e4, that are most like the curve.

    Parameters
    ----------
    contacts
        As for MasterEquation; their free numbers are first values.
    velocity
        The n velocities, above 0, in any order; a velocity may occur several times.
    force
        The n measured forces, each the mean over a distance of steady sliding.
    free
        The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "count", "ageing.growth",
        "temperature.energy" and "delay", but not of initial stretches nor the velocity; "background" and "offset". The
        curve does not determine both count and stiffness unless the contacts have a temperature, nor both background and
        offset.
    error
        The n standard deviations of the errors of the forces, above 0.
    reading
        The standard deviation of every force, instead of error; estimated if both are None.
    offset
        The reading of the force where there is none.
    prior
        As for fit.
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    VelocityCurveEstimates

    Raises
    ------
    ValueError
        For velocities or errors that are not above 0, forces that are not finite, lists of different lengths, an unknown or
        repeated name in free, none in it, a prior of a number that is not free or whose error is not above 0, fewer forces
        than free numbers, or no more where the size of errors is estimated, error beside reading, and numbers that the curve
        does not determine. A search that does not converge is no error: see VelocityCurveEstimates.converged.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.1, time=3.0))
    >>> velocity, force = [0.01, 0.1, 1.0, 10.0], [0.7515, 0.6460, 0.5497, 0.5227]
    >>> free = ["ageing.growth", "ageing.time"]
    >>> found = asp.fit_velocity_curve(contacts, velocity, force, free=free, reading=0.002)
    >>> bool(found.converged and not found.misfit.unlikely)
    True
    """

def fit_velocity_step(
    displacement: ArrayLike,
    force: ArrayLike,
    ratio: _Number,
    stiffness: _Number,
    *,
    law: Literal["ageing", "slip"] = "ageing",
    states: SupportsIndex = 1,
    progress: _Progress = None,
) -> MachineStep:
    """Fits rate-and-state friction, solved with the spring of the machine, to any curve of a velocity step, computed or
    measured.

    The load point moves at v_0 up to the displacement 0, and at v from there on. F = F_0 + a ln(V/v_0) + the sum of
    b_i ln(v_0 theta_i/D_i) over one or two state variables, and dF/dX_T = K (1 - V/v) with the velocity V of the slider.
    Least squares by the method of Levenberg and Marquardt. The misfit is stated, and no errors: what a fit leaves of a
    computed curve is what the equation does not describe (read_velocity_step gives errors, without a spring).

    Parameters
    ----------
    displacement
        Rising displacements of the load point relative to the step, a length; those below 0 give F_0.
    force
        The forces there.
    ratio
        v/v_0, above 0 and not 1.
    stiffness
        The stiffness K of the machine, a force per length, above 0.
    law
        "ageing", with d(theta)/dt = 1 - V theta/D, or "slip", with d(theta)/dt = -(V theta/D) ln(V theta/D).
    states
        The number of state variables, 1 or 2.
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    MachineStep

    Raises
    ------
    ValueError
        For a ratio or a stiffness that is not above 0, a ratio of 1, another word as law, states other than 1 or 2,
        lists of different lengths or with numbers that are not finite, displacements that do not rise, fewer than 8
        points after the step, and a force that is constant, or for which the slider runs away in every fit. The misfit
        tells whether another force is described.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> displacement = np.concatenate([np.linspace(-1, 0, 11), np.linspace(0.02, 5, 250)])
    >>> force = np.where(displacement < 0, 1.0, 1.0 + 0.02 - 0.03 * (1.0 - np.exp(-displacement)))
    >>> found = asp.fit_velocity_step(displacement, force, np.e, stiffness=10.0, law='slip')
    >>> bool(found.a > 0.01 and found.b[0] > found.a)
    True
    """

def kinetic_friction(thresholds: _AnyLaw, reforming: _AnyLaw | None = None) -> float:
    """F_k/(N_c⟨k⟩) = (⟨x_s²⟩ - ⟨r²⟩)/[2(⟨x_s⟩ - ⟨r⟩)], a length, if contacts re-form below all thresholds.

    Parameters
    ----------
    thresholds
        Their distribution P_c.
    reforming
        The distribution R of the stretches at which contacts re-form.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For reforming stretches that are not below all thresholds, and samples or a distribution of scipy.stats with
        values below 0.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.exact.kinetic_friction(asp.Rectangular(0.8, 1.2), asp.Rectangular(0.0, 0.2)), 12)
    0.555555555556
    """

def kinetic_friction_per_threshold(thresholds: _AnyLaw) -> float:
    """F_k/(N_c κ) = ⟨x_s³⟩/(2⟨x_s⟩), a length², for stiffnesses k = κ x_s, if contacts re-form at 0.

    Parameters
    ----------
    thresholds
        Their distribution P_c.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For samples or a distribution of scipy.stats with values below 0, given as thresholds.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.exact.kinetic_friction_per_threshold(asp.Point(1.0)), 12)
    0.5
    """

def open_result(folder: str | PathLike[str]) -> Result:
    """Reads the folder that `asperity run` or Result.save wrote.

    Parameters
    ----------
    folder
        The folder.

    Returns
    -------
    Result

    Raises
    ------
    OSError
        For a file that cannot be read.
    ValueError
        For one that asperity did not write, and for the folder of a sweep.

    Examples
    --------
    >>> import tempfile
    >>> import asperity as asp
    >>> scenario = {'contacts': {'thresholds': asp.Gaussian(1.0, 0.1)}, 'pull': {}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = asp.run(scenario, folder=folder + '/results')
    ...     again = asp.open_result(folder + '/results')
    >>> round(again.kinetic_friction, 6)
    0.505
    """

def read_healing(hold: ArrayLike, force: ArrayLike) -> Healing:
    """Reads healing from measured slide-hold-slide tests: F_s(t) = F_s(0) + β ln(1 + t/t_c), by least squares.

    The scatter of the forces is taken as independent and of the same size for all holds, and is estimated from the
    residuals. With few holds Student's distribution makes the intervals wider.

    Parameters
    ----------
    hold
        Hold times, a list of at least 4 numbers above 0.
    force
        The static friction after each: the highest force, or its difference from steady sliding.

    Returns
    -------
    Healing

    Raises
    ------
    ValueError
        For fewer than 4 holds or 3 different ones, holds that are not above 0, another number of forces than of holds,
        forces that are not finite or all the same, and forces that grow in proportion to the hold time, or not beyond their
        scatter.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> hold = np.array([1.0, 3.0, 10.0, 30.0, 100.0])
    >>> force = 1 + 0.01 * np.log1p(hold) + 1e-4 * np.sin(hold)
    >>> round(asp.read_healing(hold, force).per_decade.value, 3)
    0.023
    """

def read_velocity_step(
    position: ArrayLike,
    force: ArrayLike,
    ratio: _Number,
    *,
    before: _Number | None = None,
    peak: _Number | None = None,
    trend: bool = False,
    noise: Literal["drift", "white"] = "drift",
    average: SupportsIndex = 1,
    progress: _Progress = None,
) -> VelocityStep:
    """Reads the rate-and-state parameters of a measured velocity step.

    F(X) = F_0 + ln(v/v_0) [a - b (1 - exp(-(X - X_p)/D_c))] from X_p on, and F_0 before the step, by generalised least
    squares. The covariance of the noise, white noise plus drift, is estimated from the residuals by restricted
    likelihood, and the errors contain the uncertainty of the correlation length of the drift. The stiffness of the
    machine is not modelled: a and b hold for the position X_p of the peak.

    Parameters
    ----------
    position
        Rising positions relative to the step, a length; those below 0 give F_0.
    force
        The forces there.
    ratio
        v/v_0, above 0 and not 1.
    before
        F_0, if it is known; the points before the step are then not used.
    peak
        X_p; by default the extremum of the force after the step, averaged over five points, or where the force first
        comes as near to its level in the last quarter as twice its scatter there, if no extremum stands out by six
        times the scatter; the step itself if the force only rises. Points between the step and X_p are left out.
    trend
        Whether the force also has a constant slope.
    noise
        "drift" for white noise plus drift, "white" for white noise alone, whose errors are too small where there is
        drift.
    average
        The number of successive points that are averaged first, needed where positions do not rise.
    progress
        As for MasterEquation.pull. Ctrl-C interrupts the computation.

    Returns
    -------
    VelocityStep

    Raises
    ------
    ValueError
        For a ratio that is not above 0 or is 1, lists of different lengths or with numbers that are not finite,
        positions that do not rise, fewer than 4 points before the step without before, or 8 from the peak on, a peak
        below 0, another word as noise, an average of 0, and forces from which the parameters do not follow.

    Examples
    --------
    >>> import numpy as np
    >>> import asperity as asp
    >>> position = np.concatenate([np.linspace(-1, 0, 11), np.linspace(0.1, 4, 40)])
    >>> force = np.where(position < 0, 1, 1 + 0.02 * np.exp(-position)) + 1e-4 * np.sin(37 * position)
    >>> found = asp.read_velocity_step(position, force, 10.0, noise='white')
    >>> round(found.distance.value, 1)
    1.0
    """

def run(
    scenario: str | PathLike[str] | Mapping[str, Any],
    overrides: Mapping[str, Any] | None = None,
    *,
    progress: _Progress = None,
    folder: str | PathLike[str] | None = None,
    checkpoint: SupportsIndex | timedelta | str | None = None,
    resume: bool = False,
    threads: SupportsIndex | None = None,
) -> Result:
    """Computes a scenario.

    Parameters
    ----------
    scenario
        The path of a file; or the text of a scenario, recognised by an equals sign; or a dictionary of the same keys,
        in which distributions and contacts may be objects.
    overrides
        Values by dotted key, such as {"contacts.thresholds.gaussian.std": 0.1}; a distribution replaces the one in
        the scenario.
    progress
        As for MasterEquation.pull.
    folder
        Folder for the results, as for Result.save.
    checkpoint
        With a folder, checkpoints of the drive of an interface are written next to it: after each number of events,
        or after each time interval, a datetime.timedelta or a text such as "10min". They are removed once the results
        are written.
    resume
        Whether to continue from the last checkpoint; without one, the run starts at the beginning.
    threads
        The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
        the process, one per core or RAYON_NUM_THREADS.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        For an invalid scenario, with the key, what was expected and what was found, and for a checkpoint of another
        scenario.
    OSError
        For a file that cannot be read.
    FileExistsError
        For a checkpoint of a run that was not finished or is still running.
    MemoryError
        For results that do not fit.

    Examples
    --------
    >>> import asperity as asp
    >>> scenario = {'contacts': {'thresholds': asp.Gaussian(1.0, 0.1)}, 'pull': {'distance': 5.0}}
    >>> result = asp.run(scenario, {'pull.points': 501})
    >>> round(result.kinetic_friction, 6)
    0.505
    >>> result['force'].shape
    (501,)
    """

def scenario(model: Contacts | Model | Block | Deformable, **task: Any) -> dict[str, Any]:
    """The scenario of a model and a task.

    Parameters
    ----------
    model
        Contacts, a MasterEquation, a Transport, an Ensemble, a Block, an Interface or a Lattice.
    **task
        The table of the task by its name, such as pull={"distance": 5.0}, and further tables. A pull and a drive
        have the velocity of the model unless the table has its own; these and a protocol have its start.

    Returns
    -------
    dict
        What `run` and `sweep` take, and can be changed before.

    Raises
    ------
    ValueError
        For a model that starts in a state with which the task does not start.
    TypeError
        For what is no model.

    Examples
    --------
    >>> import asperity as asp
    >>> model = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)), asp.Gaussian(0.1, 0.025))
    >>> scenario = asp.scenario(model, pull={"distance": 5.0})
    >>> sorted(scenario)
    ['contacts', 'initial', 'pull']
    >>> round(asp.run(scenario).kinetic_friction, 6)
    0.505
    """

def steady_variance(thresholds: _AnyLaw) -> float:
    """N Var(F/(N_c⟨k⟩)) = ⟨x_s³⟩/(3⟨x_s⟩) - F_k², a length², in steady sliding if contacts re-form at 0.

    Parameters
    ----------
    thresholds
        Their distribution P_c.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For samples or a distribution of scipy.stats with values below 0, given as thresholds.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.exact.steady_variance(asp.Point(1.0)), 12)
    0.083333333333
    """

def steady_variance_per_threshold(thresholds: _AnyLaw) -> float:
    """The same for stiffnesses k = κ x_s: N Var(F/(N_c κ)) = ⟨x_s⁵⟩/(3⟨x_s⟩) - F_k², a length⁴.

    Parameters
    ----------
    thresholds
        Their distribution P_c.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.
    ValueError
        For samples or a distribution of scipy.stats with values below 0, given as thresholds.

    Examples
    --------
    >>> import asperity as asp
    >>> round(asp.exact.steady_variance_per_threshold(asp.Point(1.0)), 12)
    0.083333333333
    """
