"""The compiled part of asperity."""

from collections.abc import Callable, ItemsView, Iterator, KeysView, Mapping, Sequence
from datetime import timedelta
from os import PathLike
from typing import Any, Literal, Self, SupportsFloat, SupportsIndex, TypeAlias, final, overload

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray
from scipy.stats.distributions import rv_frozen
from typing_extensions import disjoint_base
from xarray import Dataset

from asperity._events import Event, Events
from asperity._values import (
    Atoms,
    Course,
    Energy,
    Equilibria,
    InterfaceEnergy,
    Label,
    Potential,
    Sizes,
    Stability,
    State,
    StaticFriction,
    StretchDensity,
)

__version__: str
_Array: TypeAlias = NDArray[np.float64]
_Number: TypeAlias = SupportsFloat | SupportsIndex
_AnyLaw: TypeAlias = Law | rv_frozen | NDArray[Any] | Sequence[float]
_Seed: TypeAlias = SupportsIndex | np.random.Generator
_Progress: TypeAlias = Callable[[float], object] | bool | None

@disjoint_base
class Description:
    """A description in plain values: immutable, equal to those of equal values, printed as the Python that makes it anew."""

    @property
    def parameters(self) -> dict[str, Any]:
        """The arguments that make it anew, by name; those that have their default are left out."""

    def replace(self, **changes: Any) -> Self:
        """A copy with some of the arguments replaced.

        Raises ValueError or TypeError as the class itself does.
        """

    def __replace__(self, **changes: Any) -> Self: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def _repr_html_(self) -> str: ...
    def __reduce__(self) -> tuple[Any, tuple[str, str]]: ...

@disjoint_base
class Law(Description):
    """A probability law on x ≥ 0: a density, and perhaps point masses.

    Methods have the names they have in scipy.stats. They take a number and return a float, or take anything that NumPy
    makes an array of numbers of, and return an array of the same shape. Lengths are in the unit of the parameters.
    A law that would have mass below 0 is cut there and renormalised: its parameters are those before the cut, its
    mean() and std() those after it. NaN is refused with ValueError, what is not a number with TypeError.
    """

    @property
    def atoms(self) -> Atoms:
        """The point masses: positions and weights, each an array of shape (n,)."""

    @overload
    def pdf(self, x: float) -> float:
        """The density p(x) without point masses, per length; 0 for x < 0."""

    @overload
    def pdf(self, x: ArrayLike) -> _Array: ...
    @overload
    def cdf(self, x: float) -> float:
        """P(ξ ≤ x), with all its digits where it is small."""

    @overload
    def cdf(self, x: ArrayLike) -> _Array: ...
    @overload
    def sf(self, x: float) -> float:
        """The survival S(x) = P(ξ > x), with all its digits where it is small."""

    @overload
    def sf(self, x: ArrayLike) -> _Array: ...
    @overload
    def logsf(self, x: float) -> float:
        """ln S(x), right where S itself is too small for a number; -inf where it is 0."""

    @overload
    def logsf(self, x: ArrayLike) -> _Array: ...
    @overload
    def hazard(self, x: float) -> float:
        """The hazard p(x)/S(x), per length: of contacts of stretch x, the share that breaks per length of advance
        (Braun and Peyrard 2008, the P(x) of Eq. 3); inf where S is 0.
        """

    @overload
    def hazard(self, x: ArrayLike) -> _Array: ...
    @overload
    def ppf(self, q: float) -> float:
        """The quantile: the smallest x with P(ξ ≤ x) ≥ q, for q from 0 to 1."""

    @overload
    def ppf(self, q: ArrayLike) -> _Array: ...
    @overload
    def isf(self, q: float) -> float:
        """The upper quantile: the smallest x with S(x) ≤ q, for q from 0 to 1; right for tiny q, where ppf(1 - q) is not."""

    @overload
    def isf(self, q: ArrayLike) -> _Array: ...
    @overload
    def rvs(self, size: None = None, *, seed: _Seed) -> float:
        """Independent draws: a float for size None, an array of shape (size,) or size otherwise.

        The seed is a whole number below 2^63, for which the numbers are always the same, or a numpy.random.Generator,
        from which one such number is drawn.
        """

    @overload
    def rvs(self, size: SupportsIndex | Sequence[SupportsIndex], *, seed: _Seed) -> _Array: ...
    def mean(self) -> float:
        """The mean of the law after the cut at 0, a length."""

    def std(self) -> float:
        """The standard deviation of the law after the cut at 0, a length."""

    def moment(self, order: SupportsIndex) -> float:
        """The raw moment E[ξⁿ] of the law after the cut at 0, n up to 29, in units of lengthⁿ."""

    def support(self) -> tuple[float, float]:
        """The lowest and the highest value; the highest may be inf."""

@final
class Gaussian(Law):
    """The bell curve, cut at 0.

    mean: the mean before the cut, 0 or above. std: the standard deviation before the cut, above 0.
    """

    def __new__(cls, mean: _Number, std: _Number) -> Self: ...

@final
class Gamma(Law):
    """The gamma law of the given mean and standard deviation, both above 0."""

    def __new__(cls, mean: _Number, std: _Number) -> Self: ...

@final
class Lognormal(Law):
    """A law whose logarithm is Gaussian, of the given mean and standard deviation (its own), both above 0."""

    def __new__(cls, mean: _Number, std: _Number) -> Self: ...

@final
class Rectangular(Law):
    """The same density everywhere from min, 0 or above, to max, above min."""

    def __new__(cls, min: _Number, max: _Number) -> Self: ...

@final
class Point(Law):
    """One value only, 0 or above."""

    def __new__(cls, at: _Number) -> Self: ...

@final
class Exponential(Law):
    """The exponential law of the given mean, above 0."""

    def __new__(cls, mean: _Number) -> Self: ...

@final
class Weibull(Law):
    """The Weibull law: survival exp(-(x/scale)**shape), both above 0."""

    def __new__(cls, shape: _Number, scale: _Number) -> Self: ...

@final
class Tabulated(Law):
    """A measured law: a density given at rising stretches, or samples.

    stretch, density: lists of equal length, the density linear between them, 0 outside, and normalised.
    samples: a list of values, each as likely; the quantiles are linear between them (numpy.quantile's).
    Either the two or the one are to be given.
    """

    def __new__(
        cls,
        *,
        stretch: ArrayLike | None = None,
        density: ArrayLike | None = None,
        samples: ArrayLike | None = None,
    ) -> Self: ...

@final
class Series(Law):
    """A density that is a polynomial on each of some cells, as Legendre series, normalised.

    boundaries: those of the cells, rising from 0 or above. coefficients: for each cell a list of up to 16, c_0 first, of
    the density Σ c_n P_n(t), t from -1 to 1 across the cell. cut: the share of a tail without end that was cut off at
    the last boundary; what hangs on it, such as the relaxation length, is then not told.

    asperity.law makes one of any distribution of scipy.stats.
    """

    def __new__(
        cls, boundaries: ArrayLike, coefficients: Sequence[ArrayLike], *, cut: _Number = 0.0
    ) -> Self: ...

@final
class Mixture(Law):
    """A weighted sum of laws: a list of pairs (weight, law), weights above 0 that sum to 1."""

    def __new__(cls, components: Sequence[tuple[_Number, _AnyLaw]]) -> Self: ...

@final
class Renormalised(Law):
    """Thresholds as the drive sees them where every break stretches all other contacts, relaxed at first: of lower mean
    and narrower than law, that of the thresholds, which must have no point mass above 0.

    coupling: κ, the share of its stretch that a contact that breaks passes on to all others together, from 0 to below
    critical_coupling(law). All that has broken by the time that the unbroken are stretched by x has passed on
    κ∫ξ P_c(ξ)dξ, so that the drive has stretched them by X = x - κ∫ξ P_c(ξ)dξ, and P_eff(X) = P_c(x)/(1 - κ x P_c(x)).
    """

    def __new__(cls, law: _AnyLaw, coupling: _Number) -> Self: ...

def critical_coupling(law: _AnyLaw) -> float:
    """κ_c = 1/max(x P_c(x)), the coupling at which contacts with thresholds of this law break in one avalanche; 0 where some
    are identical.

    For a slider of stiffness K over contacts of total stiffness N⟨k⟩ the coupling is κ = N⟨k⟩/(K + N⟨k⟩), and critical
    where K is the critical stiffness, for narrow laws.
    """

@final
class Areas(Description):
    """Contacts described by their areas A: of stiffness k = modulus √A, they break at the force strength × A.

    So a contact breaks at the stretch x_s = (strength/modulus) √A, and k = κ x_s with κ = modulus²/strength.

    law: the law of areas, in units of length². modulus: stiffness per root of area, force per length² (ρc² in Braun and
    Peyrard 2008), above 0. strength: force per area at which a contact breaks, above 0.
    """

    def __new__(cls, law: _AnyLaw, modulus: _Number, strength: _Number) -> Self: ...
    @property
    def law(self) -> Law:
        """The law of areas, in units of length²."""

    @property
    def modulus(self) -> float:
        """The stiffness per root of area, force per length²."""

    @property
    def strength(self) -> float:
        """The force per area at which a contact breaks."""

@final
class Temperature(Description):
    """Heat: contacts below their thresholds break at the rate w = ω exp(−ΔE/T).

    energy: the temperature T in units of energy (force × length), above 0. attempt_rate: ω, per time, above 0.
    barrier: ΔE of a contact of stretch x below its threshold x_s, with E_0 = ½k x_s²: "elastic", ½k(x_s² − x²); "bell",
    E_0(1 − x/x_s); "catastrophe", E_0(1 − x/x_s)^(3/2).

    Values are checked when contacts are made of it.
    """

    def __new__(
        cls,
        energy: _Number,
        attempt_rate: _Number,
        *,
        barrier: Literal["elastic", "bell", "catastrophe"] = "elastic",
    ) -> Self: ...

class Ageing(Description):
    """Ageing: thresholds that change with the time a contact has held; Smoluchowski, FrozenRank, Logarithmic or MeanField."""

    ...

@final
class Smoluchowski(Ageing):
    """Thresholds diffuse in the potential U = −ln P_cf towards the mature law, each for itself.

    mature: the law P_cf of thresholds that never break. diffusion: D, stretch² per time, above 0.
    """

    def __new__(cls, mature: _AnyLaw, diffusion: _Number) -> Self: ...

@final
class MeanField(Ageing):
    """The law of thresholds in steady sliding, by the closed equations for it and the stretches: no rule for one contact.

    mature: the law P_cf. diffusion: D, stretch² per time, above 0. Not with temperature, an ensemble, or a velocity that
    varies.
    """

    def __new__(cls, mature: _AnyLaw, diffusion: _Number) -> Self: ...

@final
class FrozenRank(Ageing):
    """The law of thresholds matures, and every contact keeps its quantile in it.

    mature: the law P_cf. time: the time in which it matures, above 0.
    """

    def __new__(cls, mature: _AnyLaw, time: _Number) -> Self: ...

@final
class Logarithmic(Ageing):
    """Every threshold grows by the same fraction for each factor in age t: h = h_0 [1 + growth ln(1 + t/time)].

    growth: β, 0 or above. time: τ_0, above 0.
    """

    def __new__(cls, growth: _Number, time: _Number) -> Self: ...

@final
class Contacts(Description):
    """The contacts of an interface: when they break, how stiff they are, how they re-form.

    thresholds: the law P_c of stretches at which contacts break; or areas, from which thresholds and stiffnesses follow.
    reforming: the law R of stretches at which they re-form, all at 0 by default.
    count: the number N_c of contacts, above 0; 1 gives forces per contact.
    stiffness: the stiffness ⟨k⟩ of a contact, force per length, 1 by default; or stiffness_per_threshold, the κ of
    stiffnesses k = κ x_s that grow with the threshold.
    normal_load: the weight carried, a force; with it, results of scenarios have friction coefficients.
    temperature: heat that breaks contacts below their thresholds. ageing: how thresholds change with the age of a contact,
    thresholds being the law of the newborn. delay: how long a broken contact is free before it re-forms, 0 by default.
    Contacts with any of these are time-dependent: what is asked of them needs a velocity.

    Laws may be those of asperity, frozen ones of scipy.stats, or samples: see asperity.law.
    """

    def __new__(
        cls,
        thresholds: _AnyLaw | None = None,
        reforming: _AnyLaw | None = None,
        *,
        areas: Areas | None = None,
        count: _Number = 1.0,
        stiffness: _Number | None = None,
        stiffness_per_threshold: _Number | None = None,
        normal_load: _Number | None = None,
        temperature: Temperature | None = None,
        ageing: Ageing | None = None,
        delay: _Number = 0.0,
    ) -> Self: ...
    @property
    def thresholds(self) -> Law | None:
        """The law P_c of stretches at which contacts break; None for contacts described by their areas."""

    @property
    def reforming(self) -> Law:
        """The law R of stretches at which contacts re-form."""

    @property
    def areas(self) -> Areas | None:
        """The areas from which thresholds and stiffnesses follow, if they do."""

    @property
    def temperature(self) -> Temperature | None:
        """The heat that breaks contacts below their thresholds, if there is any."""

    @property
    def ageing(self) -> Ageing | None:
        """How thresholds change with the age of a contact, if they do."""

    @property
    def delay(self) -> float:
        """How long a broken contact is free before it re-forms."""

    @property
    def count(self) -> float:
        """The number N_c of contacts."""

    @property
    def normal_load(self) -> float | None:
        """The weight carried, a force, if it is known."""

class Model(Description):
    """Contacts and how they start, to be pulled."""

    @property
    def contacts(self) -> Contacts:
        """The contacts."""

    @property
    def initial(self) -> Law:
        """The law Q_ini of stretches at X = 0."""

    @property
    def start(self) -> Literal["conditional", "relaxed"]:
        """ "conditional" or "relaxed"."""

@final
class MasterEquation(Model):
    """The master equation of contacts and their start.

    ∂Q/∂x + ∂Q/∂X + P(x) Q = R(x) ∫P(ξ) Q(ξ; X) dξ for the density Q(x; X) of stretches x, with the hazard P of the
    thresholds and the law R of re-formed stretches (O. M. Braun and M. Peyrard, Phys. Rev. Lett. 100, 125501 (2008),
    Eq. 5), solved in renewal form.

    contacts: the contacts. initial: the law Q_ini of stretches at X = 0, all at 0 by default.
    start: "conditional" where contacts hold at X = 0, so that thresholds lie above stretches; "relaxed" where stretches
    and thresholds are independent, so that what is above its threshold breaks at once.
    velocity: the velocity of the slider, above 0; needed only where contacts are time-dependent, which at X = 0 have age 0.
    tolerance: error allowed in the force per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; a larger error raises
    RuntimeError. Without it the aim is 1e-10, and `Pull.accuracy` tells what is reached.

    Raises ValueError for stretches at which no contact survives, and for laws too narrow to be told from a point.
    """

    def __new__(
        cls,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        velocity: _Number | None = None,
        start: Literal["conditional", "relaxed"] = "conditional",
        tolerance: _Number | None = None,
    ) -> Self: ...
    @property
    def velocity(self) -> float | None:
        """The velocity of the slider, if it has one."""

    @property
    def tolerance(self) -> float | None:
        """Error allowed in the force per contact and per ⟨k⟩ × mean threshold; None where 1e-10 is aimed at."""

    def simulation(self) -> Simulation:
        """Begins a simulation of the contacts under a rigid slider that is moved step by step, at X = 0.

        Its events are the breaks of many contacts together.
        """

    def pull(
        self, distance: _Number = 20.0, points: SupportsIndex = 2001, *, progress: _Progress = None
    ) -> Pull:
        """Pulls the slider's bottom from X = 0 to distance.

        distance: a length above 0. points: the number of positions of `position`, `force` and `breaking_rate`, evenly
        spaced, both ends included; 2 or more. progress: a function that is called with the fraction done now and then,
        or True for a bar (by tqdm). Ctrl-C stops it.

        Raises ValueError for values that make no sense, MemoryError for too many point masses or samples, RuntimeError where
        the tolerance is not reached.
        """

    def steady_state(self) -> SteadyState:
        """Steady sliding."""

    def relaxation(self) -> Relaxation:
        """The relaxation to steady sliding."""

@final
class Ensemble(Model):
    """Contacts drawn at random and followed one by one: the earthquake-like model.

    contacts, initial, start: as for MasterEquation. size: the number of contacts followed; forces are scaled to the
    count of the contacts. seed: a whole number below 2^63, for which the numbers are always the same, on any number of
    threads, or a numpy.random.Generator, from which one such number is drawn. disorder: "annealed" where a contact that
    re-forms gets a new threshold, as the master equation has it; "quenched" where it keeps its own.

    Raises ValueError for laws that leave a contact nowhere to be.
    """

    def __new__(
        cls,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        size: SupportsIndex = 100000,
        seed: _Seed = 1,
        disorder: Literal["annealed", "quenched"] = "annealed",
        start: Literal["conditional", "relaxed"] = "conditional",
    ) -> Self: ...
    @property
    def size(self) -> int:
        """The number of contacts followed."""

    @property
    def seed(self) -> int:
        """The seed of the random numbers."""

    @property
    def disorder(self) -> Literal["annealed", "quenched"]:
        """ "annealed" or "quenched"."""

    def simulation(self) -> Simulation:
        """Begins a simulation of the contacts under a rigid slider that is moved step by step, at X = 0.

        Its events are the breaks of contacts.
        """

    def pull(
        self,
        distance: _Number = 20.0,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        snapshots: ArrayLike | None = None,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
    ) -> EnsemblePull:
        """Pulls the slider's bottom from X = 0 to distance, from break to break.

        distance, points, progress: as for MasterEquation.pull. velocity: the velocity of the slider, above 0; needed only
        where contacts are time-dependent. snapshots: a list of m positions, rising, at which the
        stretches are counted. edges: a list of edges of the n bins to count them in, rising; by default even bins up to
        where hardly any contact holds. Ctrl-C stops it.

        Raises ValueError for values that make no sense, MemoryError for results that do not fit.
        """

    def follow(self, steps: Sequence[Step], *, progress: _Progress = None) -> Record:
        """Follows the contacts from t = 0 through steps one after the other.

        steps: a list of Step. progress: as for MasterEquation.pull. Ctrl-C stops it.

        Returns a Record of variables of shape (n,), n being the points of all steps, shared where steps meet: `time`,
        `position`, `force`, its standard error `force_error`, and `free`, the fraction that is broken and has not yet
        re-formed.

        Raises ValueError for no steps, and for ageing by MeanField, which is no rule for one contact.
        """

@final
class Damped(Description):
    """The slip of a slider without mass against a viscous damping, γẊ = K(X_T - X) - F.

    Over contacts without time, at fixed X_T, it ends where "overdamped" does.

    damping: the viscous damping γ, force per velocity, above 0.
    """

    def __new__(cls, damping: _Number) -> Self: ...
    @property
    def damping(self) -> float:
        """The viscous damping γ, force per velocity."""

@final
class Inertial(Description):
    """The slip of a slider by its inertia, MẌ = K(X_T - X) - F - γẊ, from the loss of balance to the first arrest.

    X_T is held meanwhile; what is left of the swing then dies, and the slider comes to rest in balance.

    mass: the mass M, above 0. damping: the viscous damping γ, force per velocity, 0 or above.
    """

    def __new__(cls, mass: _Number, damping: _Number = 0.0) -> Self: ...
    @property
    def mass(self) -> float:
        """The mass M."""

    @property
    def damping(self) -> float:
        """The viscous damping γ, force per velocity."""

@final
class Block(Description):
    """A slider block: its top is driven, its bottom is held by contacts, and its shear stiffness K joins them.

    K(X_T - X) = F(X). Where F falls more steeply than the force of the spring, F' < -K, the slider loses its balance and
    slips at fixed X_T (Braun and Peyrard 2008).

    model: the contacts, a MasterEquation or an Ensemble, or, to be moved in time, a Transport or an Ensemble. stiffness: the stiffness K, force per length, above 0; None or
    inf for a rigid slider, which never loses its balance. slip: what happens in a slip:
    "reset" where all contacts break and re-form, and the spring is relaxed; "overdamped" where the slider moves to the
    next balance, contacts breaking and re-forming on the way; "arrest" where contacts that break stay free until it has
    stopped; Damped where it moves against a viscous damping; Inertial where it moves by its mass. slip_fraction: the
    share of the contacts of an ensemble that must break at one drive for an event to count as a slip, above 0, up to 1.

    Raises ValueError for values that make no sense, a damping with which a slip would take forever among them.
    """

    def __new__(
        cls,
        model: Model,
        stiffness: _Number | None,
        slip: Literal["reset", "overdamped", "arrest"] | Damped | Inertial = "reset",
        *,
        slip_fraction: _Number = 0.05,
    ) -> Self: ...
    @property
    def model(self) -> MasterEquation | Transport | Ensemble:
        """The model of the contacts."""

    @property
    def stiffness(self) -> float:
        """The shear stiffness K, force per length; inf for a rigid slider."""

    @property
    def slip(self) -> Literal["reset", "overdamped", "arrest"] | Damped | Inertial:
        """The slip rule: "reset", "overdamped", "arrest", Damped or Inertial."""

    @property
    def slip_fraction(self) -> float:
        """The share of the contacts of an ensemble that must break at one drive for an event to count as a slip."""

    def stability(self, velocity: _Number, *, progress: _Progress = None) -> Stability:
        """Whether steady sliding at a velocity is stable for small deviations, with the stiffness, mass and damping of this
        slider: by the linear response of the contacts of its Transport to a small step.

        velocity: the velocity of the top, above 0. progress: as for MasterEquation.pull. Ctrl-C stops it.

        Returns a Stability of `critical_stiffness`, above which steady sliding is stable, the `frequency` of the oscillation
        that sets in there, and the `growth_rate` and `growth_frequency` of the deviation that grows fastest, 0 where it is
        stable. The critical stiffness is right to some 1e-3 of the stiffness of all contacts.

        Raises ValueError for a rigid slider, one that slips by a word, contacts that are no Transport, and a velocity that is
        not above 0.
        """

    def simulation(self) -> Simulation:
        """Begins a simulation that is driven step by step, at X_T = 0.

        Raises ValueError for a Transport and for contacts that are time-dependent, unless the MasterEquation has a velocity.
        """

    def drive(
        self,
        distance: _Number | None = None,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        turning_points: ArrayLike | None = None,
        force_to: _Number | None = None,
        progress: _Progress = None,
    ) -> StickSlip:
        """Moves the top of the slider from X_T = 0, or imposes a force, and follows its bottom.

        distance: how far it is moved, a length above 0; 20 if nothing else is said. turning_points: positions X_T to
        which it is moved one after the other, back and forth, instead. force_to: the force, above 0, up to which a slider
        of infinite stiffness is pulled whatever its position, instead. points: the number of points of the trace, evenly
        spaced along the drive, both ends included; 2 or more; turning points, and points before and after every slip,
        come on top. velocity: the velocity of the top, above 0, with which the slider is moved in time as by follow; needed
        over a Transport, and over time-dependent contacts. progress: as for MasterEquation.pull. Ctrl-C stops it.

        Raises ValueError for values that make no sense, MemoryError for results that do not fit or too many point masses,
        RuntimeError where the tolerance is not reached.
        """

    def follow(self, steps: Sequence[Step], *, progress: _Progress = None) -> StickSlip:
        """Moves the top of the slider from balance at t = 0 through steps one after the other, and follows its bottom in time:
        MẌ = K(X_T - X) - F - γẊ.

        The slip must be Damped or Inertial, as something must limit how fast a slip is. A slip is where the bottom is ten times
        as fast as the top, and over an ensemble breaks the share slip_fraction of the contacts.

        steps: a list of Step. progress: as for MasterEquation.pull. Ctrl-C stops it.

        Raises ValueError for no steps, another slip, a rigid slider, or a MasterEquation, which has one velocity.
        """

    def equilibrium(self, distance: _Number | None = None, points: SupportsIndex = 2001) -> Equilibria:
        """The equilibria X_T(X) = X + F(X)/K of the first loading, before anything slips: drive, position, force, and whether
        the slider is stable there, F' + K > 0.

        distance: how far the bottom is moved, a length above 0; by default 5 mean thresholds. points: the number of
        positions, evenly spaced, both ends included; 2 or more; where the force jumps, its two sides come on top.
        """

    def potential(
        self, drive: ArrayLike, distance: _Number | None = None, points: SupportsIndex = 2001
    ) -> Potential:
        """The potential V(X_T, X) = ½K(X_T - X)² + ∫F dX of the first loading; where it is least, the slider is in balance.

        drive: a drive X_T, or a list of m of them. distance, points: as for equilibrium. The result has `position` of shape
        (n,) and `energy` of shape (n,) or (m, n).

        Raises ValueError for a rigid slider, which has none.
        """

@disjoint_base
class Record(Mapping[str, _Array]):
    """Results: a mapping from the names of variables to arrays, which cannot be changed."""

    def __getitem__(self, name: str, /) -> _Array: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...
    def keys(self) -> KeysView[str]:
        """The names of the variables."""

    def items(self) -> ItemsView[str, _Array]:
        """Names and arrays of the variables."""

    @property
    def position(self) -> _Array:
        """Positions X of the slider's bottom: an array of shape (n,), a length."""

    @property
    def force(self) -> _Array:
        """The friction force F at the positions, shape (n,): that of all N_c contacts; where contacts break together, after
        the break.
        """

    @property
    def labels(self) -> dict[str, Label]:
        """Dimensions, name for people and unit of each variable."""

    def to_xarray(self) -> Dataset:
        """An xarray.Dataset with named dimensions, long names and units. It needs xarray."""

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the force along the pull or the drive (of an imposed force, that against the position), the kinetic friction,
        and on a pull the static one, where they are known. Returns the axes. It needs matplotlib.

        ax: axes to draw on; new ones if None. Other arguments go to its plot().
        """

    def _repr_html_(self) -> str: ...

@final
class Pull(Record):
    """A pull of the slider's bottom from X = 0, solved by the master equation. Forces are those of all N_c contacts.

    Called with positions it is F(X): `pull(5.0)`, `pull([1.0, 2.0])`.
    """

    @property
    def equation(self) -> MasterEquation:
        """The master equation that was solved."""

    @property
    def breaking_rate(self) -> _Array:
        """The fraction of contacts breaking per length at the positions, shape (points,), without those that break
        together.
        """

    @property
    def breaking_atoms(self) -> Atoms:
        """Positions at which contacts break together, and the fractions of them that do, each of shape (n,)."""

    @property
    def distance(self) -> float:
        """The distance of the pull, a length."""

    @property
    def static_friction(self) -> StaticFriction | None:
        """The static friction F_s, the highest force of the pull, with its position X_s; None where the force still rises
        at the end, or never falls.
        """

    @property
    def kinetic_friction(self) -> float:
        """The kinetic friction F_k, the force of steady sliding."""

    @property
    def critical_stiffness(self) -> float:
        """The critical stiffness K_c = max(0, -min F'), force per length: a softer slider sticks and slips; inf where the
        force jumps down, 0 where it falls by no more than ten times the tolerance leaves open.
        """

    @property
    def relaxation_length(self) -> float:
        """The relaxation length X*, over which the start is forgotten; inf where the force never settles, nan where
        no root is found.
        """

    @property
    def accuracy(self) -> float:
        """The estimated error of F/(N_c⟨k⟩), a length."""

    @overload
    def __call__(self, position: float) -> float: ...
    @overload
    def __call__(self, position: ArrayLike) -> _Array: ...
    @overload
    def force_at(self, position: float) -> float:
        """F(X), for positions from 0 to the distance."""

    @overload
    def force_at(self, position: ArrayLike) -> _Array: ...
    @overload
    def slope_at(self, position: float) -> float:
        """dF/dX from the right, force per length, for positions from 0 to the distance."""

    @overload
    def slope_at(self, position: ArrayLike) -> _Array: ...
    @overload
    def breaking_rate_at(self, position: float) -> float:
        """The fraction of contacts breaking per length, for positions from 0 to the distance."""

    @overload
    def breaking_rate_at(self, position: ArrayLike) -> _Array: ...
    @overload
    def force_std(self, size: _Number, at: float) -> float:
        """The standard deviation of the force carried by `size` contacts drawn at random and scaled to N_c.

        at: positions from 0 to the distance, or None for those of `position`. Contacts under a rigid drive are
        independent, so that it is exact.
        """

    @overload
    def force_std(self, size: _Number, at: ArrayLike | None = None) -> _Array: ...
    def stretch_density(self, at: ArrayLike, stretches: ArrayLike | None = None) -> StretchDensity:
        """The density Q(x; X) of stretches x, per length, at positions X from 0 to the distance.

        at: a position, or a list of m of them. stretches: a list of n stretches, or None for ones close enough to show
        the densities. The result has `stretch` of shape (n,); `density` of shape (n,) or (m, n); and `atoms`, where
        contacts are together, at the position or for each of the list.
        """

@final
class EnsemblePull(Record):
    """A pull of an ensemble: the friction force with its standard error, and the stretches counted on the way.

    Its variables are `position`, `force` and `force_error`; with snapshots also `snapshot` of shape (m,), `edge` of
    shape (n + 1,), their middles `bin` of shape (n,), and `stretch_density` of shape (m, n), per length.
    """

    @property
    def ensemble(self) -> Ensemble:
        """The ensemble that was pulled."""

    @property
    def force_error(self) -> _Array:
        """The standard error of the force, shape (points,), from the scatter of single contacts; nan for one contact."""

    @property
    def breaks(self) -> int:
        """The number of breaks up to the end, those of a relaxed start included."""

@final
class StickSlip(Record):
    """A drive of a slider: its trace, its slips, and what kind of sliding they make.

    Its variables are those of the trace, `drive`, `position`, `force` and `spring_force`, all states of balance; those of
    the slips, `event_drive`, `event_drop`, …; for an inertial slip its course, `slip_time`, `slip_position`, …; for an
    ensemble the sizes of events, `size`, `size_events`, …. In time the trace has `time`, `velocity` and `free` (the fraction of
    contacts that are free), too, and no course and no sizes.
    """

    @property
    def block(self) -> Block:
        """The block that was driven."""

    @property
    def drive(self) -> _Array:
        """The drive along the trace, shape (n,): the position X_T of the top, a length; or the imposed force."""

    @property
    def spring_force(self) -> _Array:
        """The force K(X_T - X) of the spring along the trace, shape (n,): F, where the slider is in balance."""

    @property
    def events(self) -> Events:
        """The slips."""

    @property
    def regime(self) -> Literal["smooth", "transient", "persistent", "runaway", "undecided"]:
        """ "smooth" without slips; "transient" where slips have ceased; "persistent" where they go on alike; "runaway" where
        the contacts could not carry the imposed force; "undecided" where the drive was too short to tell. It is that of the
        drive since it last turned.
        """

    @property
    def reason(self) -> str:
        """The regime with its reason, in words."""

    @property
    def period(self) -> float | None:
        """The mean advance of the drive from slip to slip, a length; None unless slips go on alike, as for all such means."""

    @property
    def mean_drop(self) -> float | None:
        """The mean drop of the force in a slip."""

    @property
    def mean_slip(self) -> float | None:
        """The mean way of the slider in a slip, a length."""

    @property
    def scatter(self) -> float | None:
        """The scatter of the period: the standard deviation of the advances from slip to slip over their mean."""

    @property
    def first_instability(self) -> State | None:
        """Where balance was first lost; None where it never was."""

    @property
    def runaway(self) -> State | None:
        """From where the slider ran away under an imposed force; None where it did not."""

    @property
    def energy(self) -> Energy:
        """Where the work of the drive went, from its start to its end (of a runaway, to where it began)."""

    @property
    def sizes(self) -> Sizes | None:
        """How many events of each size there were, those too small for a slip among them; None for the master equation."""

    @property
    def slip_course(self) -> Course | None:
        """The time course of the first inertial slip; None where there was none."""

@final
class SteadyState:
    """Steady sliding: the solution of the master equation that does not depend on X.

    Q_s(x) = Γ_s S(x) ∫₀ˣ R/S and F_k = N_c⟨k⟩ ∫x Q_s dx; where contacts re-form at 0, F_k = N_c⟨k⟩⟨x_s²⟩/(2⟨x_s⟩)
    (Braun and Peyrard 2008, Eqs. 11a and 11d).
    """

    @property
    def kinetic_friction(self) -> float:
        """The kinetic friction F_k, a force."""

    @property
    def breaking_rate(self) -> float:
        """The breaking rate Γ_s, the fraction of contacts that break per length."""

    def force_std(self, size: _Number) -> float:
        """The standard deviation of the force carried by `size` contacts drawn at random and scaled to N_c."""

    def stretch_density(self, stretches: ArrayLike | None = None) -> StretchDensity:
        """The density Q_s of stretches, per length.

        stretches: a list of n stretches, or None for ones close enough to show it. The result has `stretch` and
        `density` of shape (n,), and `atoms`.
        """

@final
class Relaxation:
    """The relaxation spectrum: F(X) = F_k + Σ_j c_j exp(s_j X), with s_j the roots ≠ 0 of φ̂(s) = 1, φ̂ the Laplace
    transform of the breaking density of re-formed contacts.
    """

    @property
    def roots(self) -> NDArray[np.complex128]:
        """The roots s_j with Im s_j > 0, slowest first: a complex array of shape (n,), per length."""

    @property
    def length(self) -> float:
        """The relaxation length X* = -1/Re s_1, over which the start is forgotten; inf where the force never settles, nan
        where no root is found.
        """

    @property
    def paper_estimate(self) -> float:
        """The estimate x̄²/σ of Braun and Peyrard (2008), a length; inf for identical thresholds. Of time-dependent contacts, x̄
        and σ are those of the ways from birth to rebirth in steady sliding.
        """

    @property
    def valid_from(self) -> float:
        """The position from which the terms left out of `force` are below 1e-12 of N_c⟨k⟩ × the mean life; inf where the
        expansion does not hold.
        """

    @overload
    def force(self, position: float) -> float:
        """F(X) from the expansion, a force, for positions from `valid_from` on."""

    @overload
    def force(self, position: ArrayLike) -> _Array: ...

@final
class Result(Record):
    """What a scenario gives: a mapping from the names of variables to arrays, and the numbers people quote.

    The variables are those of `result.nc`: `position`, `force`, `breaking_rate`, `stretch_density`, …
    """

    @property
    def scenario(self) -> str:
        """The scenario, TOML, with all defaults filled in."""

    @property
    def summary(self) -> dict[str, Any]:
        """The numbers people quote, as in `summary.json`."""

    @property
    def title(self) -> str:
        """The title of the scenario."""

    @property
    def static_friction(self) -> StaticFriction | None:
        """The static friction F_s with its position X_s; None where the force still rises at the end, or never falls."""

    @property
    def kinetic_friction(self) -> float:
        """The kinetic friction F_k, the force of steady sliding; nan where the task has no one velocity."""

    @property
    def critical_stiffness(self) -> float:
        """The critical stiffness K_c, force per length; inf where the force jumps down."""

    @property
    def relaxation_length(self) -> float:
        """The relaxation length X*; inf where the force never settles, nan where no root is found."""

    @property
    def events(self) -> Events | None:
        """The events of a slider or an interface; None where the task has none."""

    def save(self, folder: str | PathLike[str]) -> None:
        """Writes the folder that `asperity run` would write, but for its pictures; open_result reads it.

        Raises FileExistsError where a folder is in the way that asperity did not make, OSError where the system refuses.
        """

class Deformable(Description):
    """What the kinds of interfaces have in common: a drive that moves their top."""

    def drive(
        self,
        distance: _Number = 20.0,
        points: SupportsIndex = 2001,
        *,
        velocity: _Number | None = None,
        tolerance: _Number | None = None,
        maps: ArrayLike | None = None,
        catalogue_from: _Number = 0.0,
        progress: _Progress = None,
    ) -> Result:
        """Drives the interface from X_T = 0 to distance, from event to event.

        points: the number of points of the trace, both ends included. velocity: that of the drive, above 0; needed where
        contacts are time-dependent. tolerance: the error allowed in the force of a cell per mean threshold and per stiffness, 1e-10 if
        nothing else is said; where contacts are time-dependent also in a step of a cell, per mean threshold, 1e-4. maps: a list of drives, rising, at which every cell
        is shown; of a chain it is at every point. catalogue_from: the drive from which on events are recorded. progress:
        as for MasterEquation.pull. Ctrl-C stops it.

        Returns the Result of the scenario that this is: its `events` are the catalogue, its `summary["catalogue"]` says
        how large events are and how long one waits for them. run takes such scenarios, too, and can keep checkpoints.

        Raises ValueError for values that make no sense, or for more than fits in a result file.
        """

    def simulation(self, *, velocity: _Number | None = None, tolerance: _Number | None = None) -> Simulation:
        """Begins a simulation that is driven step by step, at X_T = 0.

        velocity, tolerance: as for drive.

        Raises ValueError for values that make no sense.
        """

    @property
    def contacts(self) -> Contacts:
        """The contacts."""

    @property
    def cells(self) -> list[int]:
        """The length of a chain, or rows and columns of a lattice."""

@final
class Interface(Deformable):
    """Cells of contacts that move together, on a slider that deforms, each connected to the drive by a spring.

    contacts: those of a cell. cells: the length of a chain, such as [1000], or rows and columns, such as [512, 512].
    initial, start: as for MasterEquation. connection: K_0, the stiffness of the spring between a cell and the drive.
    neighbours: K_int, the stiffness of the spring between two neighbours; or half_space: the modulus G* of a half-space
    and the side of a cell. edges: "open" or "periodic". loading: "uniform", or "edge" where the drive pulls the first cell
    or row alone. slip: "reset", where all contacts of an unstable cell break and re-form, or "overdamped". viscosity: the
    drag of a moving cell, force per velocity; with it events take time. Time-dependent contacts need it, with
    slip="overdamped": η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j, and a cell slips while it is ten times as fast as the
    drive. disorder: the standard deviation of the scales of
    cells, which multiply all lengths of their contacts, drawn from a Gaussian of mean 1 with the seed; or a list of them.
    drive_tolerance: how closely the drive at which balance is lost is found, in mean thresholds, without time. size: None where contacts
    are so many that they follow the master equation; or the number of contacts in each cell, drawn with the seed and
    followed one by one, with slip="overdamped". quenched: whether these keep their thresholds.

    Raises ValueError for values that make no sense.
    """

    def __new__(
        cls,
        contacts: Contacts,
        cells: Sequence[int],
        initial: _AnyLaw | None = None,
        *,
        connection: _Number,
        neighbours: _Number | None = None,
        half_space: tuple[_Number, _Number] | None = None,
        edges: Literal["open", "periodic"] = "open",
        loading: Literal["uniform", "edge"] = "uniform",
        slip: Literal["reset", "overdamped"] = "reset",
        viscosity: _Number | None = None,
        disorder: _Number | ArrayLike | None = None,
        seed: _Seed = 1,
        drive_tolerance: _Number = 1e-06,
        size: SupportsIndex | None = None,
        quenched: bool = False,
        start: Literal["conditional", "relaxed"] = "conditional",
    ) -> Self: ...
    def stretch_density(
        self,
        cell: SupportsIndex,
        stretches: ArrayLike | None = None,
        *,
        at: _Number,
        velocity: _Number | None = None,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
    ) -> StretchDensity:
        """The density of stretches of the contacts of a cell, per length, once the interface has been driven from X_T = 0.

        cell: its number, along rows. stretches: a list of n stretches. at: the drive, 0 or above. progress: as for
        MasterEquation.pull. The result has `stretch` and `density` of shape (n,), and `atoms`, the stretches at which contacts
        are together.

        Where contacts are time-dependent, velocity is that of the drive. There, and where cells have a size, there may be edges of n
        bins instead of stretches, n + 1 numbers that rise: the density is the mean in each bin then, and `stretch` its middle.
        Contacts that are free are not counted. Without bins each of the few contacts of a cell with a size is an atom.

        Raises ValueError for a number of no cell, and for values that make no sense.
        """

@final
class Lattice(Deformable):
    """Contacts coupled one by one, which re-form when the slide is over: the automaton of Olami, Feder and Christensen for
    any law of thresholds.

    contacts: their laws, and the number that they stand for all together. cells: the length of a chain, or rows and
    columns. initial, start: as for Ensemble. neighbours, connection: the stiffness of the spring between two neighbours and
    of that to the drive; a neighbour gains the share neighbours/(z neighbours + connection) of what a breaking contact lets
    go, z being 4, or 2 on a chain. edges: "open" or "periodic". seed, disorder: as for Ensemble.

    Raises ValueError for values that make no sense.
    """

    def __new__(
        cls,
        contacts: Contacts,
        cells: Sequence[int],
        initial: _AnyLaw | None = None,
        *,
        neighbours: _Number,
        connection: _Number,
        edges: Literal["open", "periodic"] = "open",
        seed: _Seed = 1,
        disorder: Literal["annealed", "quenched"] = "annealed",
        start: Literal["conditional", "relaxed"] = "conditional",
    ) -> Self: ...

@final
class Simulation:
    """A model on its way: it is driven step by step, from event to event, and can be looked at in between.

    simulation() of an Interface, a Lattice, a Block, a MasterEquation or an Ensemble begins one, at X_T = 0. Its run is that
    of the drive of the same model, event by event and bit for bit.

    Ctrl-C stops what takes long; the simulation is then where it was after the last event, and can go on. A simulation that
    is at work in another thread raises RuntimeError.
    """

    @property
    def model(self) -> Deformable | Block | Model:
        """The Interface, Lattice, Block, MasterEquation or Ensemble that is simulated."""

    @property
    def drive(self) -> float:
        """The drive X_T, a length: the displacement of the load point; without a spring that of the slider itself."""

    @property
    def time(self) -> float:
        """The time; 0 where none passes."""

    @property
    def force(self) -> float:
        """The friction force, that of all cells and contacts."""

    @property
    def forces(self) -> _Array:
        """The force of each cell, or of each contact of a Lattice: shape (n,), or (rows, columns); of a slider (1,)."""

    @property
    def positions(self) -> _Array:
        """The position X_j of each cell, lengths: shape (n,), or (rows, columns); of a slider (1,). A Lattice has none."""

    @property
    def energy(self) -> Energy | InterfaceEnergy:
        """Where the work of the drive went, from X_T = 0 to here: an InterfaceEnergy of an Interface, else an Energy. A Lattice
        has none.
        """

    def events(self, until: _Number) -> Iterator[Event]:
        """Drives on to until, a displacement of the load point, and hands out each event as it happens: an iterator.

        Events are those of the drive of the same model, slips of a block and an interface, avalanches of a lattice, breaks of
        contacts together under a rigid slider, with the same parts: `drive`, `drop`, …. Between two events the simulation
        stands after the first of them, and can be looked at, kept, or driven elsewhere. The iterator ends at the drive.

        until: an absolute drive, not a step; ahead of the present one, or, where a slider turns, behind it.

        Raises ValueError for a drive that an interface would have to move back to.
        """

    def advance(self, drive: _Number, *, progress: _Progress = None) -> None:
        """Drives on to a displacement of the load point, through all events on the way.

        drive: an absolute drive, not a step; ahead of the present one, or, where a slider turns, behind it. Stops on the way
        of a slider leave no trace; an interface comes to them in balance, so that stops may change last digits of what
        follows, as points of a trace do, and where balance is lost within the drive_tolerance.
        progress: as for MasterEquation.pull. Ctrl-C stops it.

        Raises ValueError for a drive that an interface would have to move back to.
        """

    def stretch_density(
        self,
        cell: SupportsIndex = 0,
        stretches: ArrayLike | None = None,
        *,
        edges: ArrayLike | None = None,
        progress: _Progress = None,
    ) -> StretchDensity:
        """The density Q(x) of the stretches of the contacts of a cell, per length.

        cell: the number of a cell of an Interface, along rows; 0 of a slider, and of a Lattice, whose contacts are counted all
        together. stretches: a list of n stretches at which contacts that follow the master equation are looked at.
        edges: n + 1 edges of bins, which rise, in which contacts that are followed one by one, or in time, are counted; at
        stretches each of them is an atom. Without both stretches or bins are chosen to show the density. progress: as for
        MasterEquation.pull.

        The result has `stretch` and `density` of shape (n,), and `atoms`, stretches that many contacts share. Contacts that
        are free are not counted.

        Raises IndexError for a number of no cell, ValueError for values that make no sense.
        """

    def state(self) -> bytes:
        """All that the simulation has come to, bytes for restore of the same version of asperity."""

    def restore(self, state: bytes) -> None:
        """Goes to a state of this simulation, or of another one of the same model: it goes on from there bit for bit.

        Raises ValueError for the state of another model, or of another version of asperity.
        """

@final
class Step(Description):
    """A step of a way in time: motion at a velocity over a distance or for a duration, a ramp, or a hold.

    velocity: a length per time; above 0 over a distance, 0 or above for a duration. velocity_to: the velocity at the end
    of a ramp that begins at velocity and takes a duration, made of so many pieces of constant velocity (64 by default).
    hold: a time at rest, instead of all others. points: the number of points of the trace in the step, evenly spaced in
    time, both ends included; 2 or more.

    Raises ValueError for values that make no sense, or not together.
    """

    def __new__(
        cls,
        velocity: _Number | None = None,
        *,
        distance: _Number | None = None,
        duration: _Number | None = None,
        hold: _Number | None = None,
        velocity_to: _Number | None = None,
        points: SupportsIndex = 201,
        pieces: SupportsIndex | None = None,
    ) -> Self: ...

@final
class Transport(Model):
    """The master equation of contacts under a slider whose velocity varies, contacts born together being followed in time.

    contacts, initial, start: as for MasterEquation; the contacts have age 0 at t = 0. tolerance: error allowed in the force
    per contact and per ⟨k⟩ × mean threshold, from 1e-12 to 1e-2; 1e-6 by default, 1e-4 for contacts that age by
    Smoluchowski.

    Raises ValueError for values that make no sense, and for ageing by MeanField, which is no rule for one contact.
    """

    def __new__(
        cls,
        contacts: Contacts,
        initial: _AnyLaw | None = None,
        *,
        start: Literal["conditional", "relaxed"] = "conditional",
        tolerance: _Number | None = None,
    ) -> Self: ...
    def follow(self, steps: Sequence[Step], *, progress: _Progress = None) -> Record:
        """Follows the contacts from t = 0 through steps one after the other.

        steps: a list of Step. progress: as for MasterEquation.pull. Ctrl-C stops it.

        Returns a Record of variables of shape (n,), n being the points of all steps, shared where steps meet: `time`,
        `position`, `velocity` (from the right), `force`, `breaking_frequency` (the fraction of contacts that breaks per
        time), `free` (the fraction that is broken and has not yet re-formed) and `force_error` (an estimate, on the safe side,
        of the largest error of the force, the same at all points).

        Raises ValueError for no steps, RuntimeError where that error is larger than a tolerance that was given.
        """

@overload
def velocity_curve(contacts: Contacts, velocities: float, *, progress: _Progress = None) -> float:
    """Kinetic friction F_k of contacts at velocities: an array for a list of them, a number for a number.

    velocities: numbers above 0, a length per time. Each is a computation of its own; Ctrl-C stops between two.

    Raises ValueError for a velocity that is not above 0.
    """

@overload
def velocity_curve(contacts: Contacts, velocities: ArrayLike, *, progress: _Progress = None) -> _Array: ...
def run(
    scenario: str | PathLike[str] | Mapping[str, Any],
    overrides: Mapping[str, Any] | None = None,
    *,
    progress: _Progress = None,
    folder: str | PathLike[str] | None = None,
    checkpoint: SupportsIndex | timedelta | str | None = None,
    resume: bool = False,
) -> Result:
    """Computes a scenario.

    scenario: the path of a file; or the text of one, told by an equals sign in it; or a dictionary of the same keys,
    in which laws and contacts may be objects.
    overrides: values by dotted key, such as {"contacts.thresholds.gaussian.std": 0.1}; a law replaces the law that is
    there. progress: as for MasterEquation.pull.
    folder: where to write the results, as Result.save does. Beside it the drive of an interface can keep what it has come
    to: checkpoint: every so many events, or every so often, a datetime.timedelta or a time such as "10min". resume: whether
    to go on from the last checkpoint, or to begin where there is none.
    The checkpoints are removed once the results are written.

    Raises ValueError for a scenario that makes no sense, with the key, what was expected and what came, and for a
    checkpoint of another scenario; OSError for a file that cannot be read, FileExistsError for a checkpoint of a run that
    was not finished or is still running; MemoryError for results that do not fit.
    """

def open_result(folder: str | PathLike[str]) -> Result:
    """Reads what `asperity run` or Result.save wrote.

    Raises OSError for a file that cannot be read, ValueError for one that is not what asperity writes.
    """

@disjoint_base
class ClosedForm:
    """A friction curve F(X) in closed form, per total stiffness: F/(N_c⟨k⟩), the mean stretch, a length.

    All contacts start and re-form relaxed, at stretch 0, unless the form says otherwise. Positions X are lengths from 0
    on, up to where sums would become long. For every density p of thresholds with n-fold convolutions p_n,
    F'(X) = 1 - X Σ p_n(X)/n; each form is the sum of this series for one family, and none shares code with the solvers.
    """

    @overload
    def force(self, position: float) -> float:
        """F(X)/(N_c⟨k⟩), a length; after the break where contacts break together."""

    @overload
    def force(self, position: ArrayLike) -> _Array: ...
    @overload
    def slope(self, position: float) -> float:
        """F'(X)/(N_c⟨k⟩) from the right, a number."""

    @overload
    def slope(self, position: ArrayLike) -> _Array: ...
    @property
    def kinetic_friction(self) -> float:
        """F_k/(N_c⟨k⟩), the force of steady sliding, a length."""

    @property
    def static_friction(self) -> StaticFriction | None:
        """The maximum F_s/(N_c⟨k⟩) with its position X_s, both lengths; None where F only rises."""

    @property
    def critical_stiffness(self) -> float:
        """K_c/(N_c⟨k⟩) = max(0, -min F'), a number; inf where F jumps down."""

@final
class ExactGaussian(ClosedForm):
    """Gaussian thresholds, and a Gaussian law of stretches at the start: Fig. 2 of Braun and Peyrard (2008).

    mean, std: of the thresholds, above 0. initial_mean, initial_std: of the stretches at X = 0, 0 or above. Masses below
    0 are kept, where the laws of the solvers are cut.
    """

    def __new__(
        cls, mean: _Number, std: _Number, initial_mean: _Number = 0.0, initial_std: _Number = 0.0
    ) -> Self: ...
    @overload
    def variance(self, position: float) -> float:
        """The variance of the stretch of one contact at X, a length²: the force of N_c independent contacts scatters by
        N_c⟨k⟩√(variance/N_c).
        """

    @overload
    def variance(self, position: ArrayLike) -> _Array: ...
    def relaxation_root(self, j: SupportsIndex) -> complex:
        """The root s_j, j ≥ 1, of the relaxation spectrum, complex, per length: s_j = [x̄ - √(x̄² - 4πijσ²)]/σ²."""

    @property
    def relaxation_length(self) -> float:
        """X* = -1/Re s_1, a length."""

@final
class ExactRectangular(ClosedForm):
    """Thresholds of the same density everywhere from min, 0 or above, to max, above min."""

    def __new__(cls, min: _Number, max: _Number) -> Self: ...

@final
class ExactErlang(ClosedForm):
    """Erlang thresholds: sums of `shape` exponential lengths, each of mean 1/rate. shape 1 is the exponential law.

    shape: a whole number, 1 or above. rate: per length, above 0.
    """

    def __new__(cls, shape: SupportsIndex, rate: _Number) -> Self: ...
    @property
    def relaxation_length(self) -> float:
        """X*, a length: 1/[λ(1 - cos 2π/m)], but 1/λ for shapes m up to 4."""

@final
class ExactIdentical(ClosedForm):
    """Identical thresholds: every stretch is (y + X) mod threshold for ever, and nothing relaxes.

    threshold: a length above 0.
    """

    def __new__(cls, threshold: _Number) -> Self: ...

@final
class ExactQuenched:
    """Quenched thresholds of any law: each contact keeps its own for ever.

    F(X)/(N_c⟨k⟩) = ∫P_c(ξ)(X mod ξ)dξ; the master equation, which is about annealed thresholds, does not describe them.
    """

    def __new__(cls, thresholds: _AnyLaw) -> Self: ...
    @overload
    def force(self, position: float) -> float:
        """F(X)/(N_c⟨k⟩), a length; after the break where contacts break together."""

    @overload
    def force(self, position: ArrayLike) -> _Array: ...
    @property
    def kinetic_friction(self) -> float:
        """F_k/(N_c⟨k⟩), a length: half the mean threshold."""

    @property
    def dephasing_length(self) -> float:
        """X_d = x̄²/(√2 πσ), a length: narrow Gaussian thresholds lose step as exp[-(X/X_d)²]."""

def kinetic_friction(thresholds: _AnyLaw, reforming: _AnyLaw | None = None) -> float:
    """F_k/(N_c⟨k⟩) = (⟨x_s²⟩ - ⟨r²⟩)/[2(⟨x_s⟩ - ⟨r⟩)], a length, where contacts re-form below all thresholds."""

def kinetic_friction_per_threshold(thresholds: _AnyLaw) -> float:
    """F_k/(N_c κ) = ⟨x_s³⟩/(2⟨x_s⟩), a length², for stiffnesses k = κ x_s, where contacts re-form at 0."""

def steady_variance(thresholds: _AnyLaw) -> float:
    """N Var(F/(N_c⟨k⟩)) = ⟨x_s³⟩/(3⟨x_s⟩) - F_k², a length², in steady sliding where contacts re-form at 0."""

def steady_variance_per_threshold(thresholds: _AnyLaw) -> float:
    """The same for stiffnesses k = κ x_s: N Var(F/(N_c κ)) = ⟨x_s⁵⟩/(3⟨x_s⟩) - F_k², a length⁴."""

def _restore(version: str, description: str) -> Description: ...
def _resolve(density: Callable[[_Array], ArrayLike], boundaries: Sequence[float]) -> Series: ...
