"""Contact spots of a rough surface, from the pressure of a contact solver, and contacts made of them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from asperity._arguments import flag, number, whole
from asperity._bridge import projected
from asperity._core import Contacts, Law, Point, Tabulated

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    _Array = NDArray[np.float64]

# Width of the cells of the density of thresholds, in kernels: 16 terms give it to rounding, tails included.
CELL = 0.4
# Logarithms of thresholds that differ by less are equal.
NARROW = 1e-6
# Rows of a table of stiffnesses: some ten for each kernel of a wide sample.
NODES = 100


class Dropped(NamedTuple):
    """Spots that are too small to be resolved by the grid.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> pressure = np.zeros((16, 16))
    >>> pressure[2:6, 2:6] = pressure[10, 10] = 1.0
    >>> asp.spots(pressure, 1.0, at_least=4).dropped.number
    1
    """

    number: int
    """Their number."""
    area: float
    """Their area together."""
    load: float
    """Their load together."""


@dataclass(frozen=True, repr=False)
class Spots:
    """The contact spots of a surface: connected pixels under pressure.

    Attributes
    ----------
    area : ndarray
        The area of each spot, shape (n,), in units of the pixel squared.
    load : ndarray
        The load of each spot, pressure times area, shape (n,).
    centre : ndarray
        The centre of pressure of each spot, Σ p x/Σ p of its pixels, shape (n, 2), along the first and the
        second axis of the map; the middle of the first pixel is at half a pixel. A spot across the edges of a
        periodic map is put together first. Where it goes around the map, so that it is connected with itself
        along an axis, it has no centre along this axis, and the coordinate is nan.
    dropped : Dropped
        What was left out.
    labels : ndarray
        A map of the spots: n + 1 in the pixels of spot n, 0 elsewhere and in spots left out.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> pressure = np.zeros((16, 16))
    >>> pressure[2:6, 2:6] = 1.0
    >>> found = asp.spots(pressure, 1.0)
    >>> found.area, found.load
    (array([16.]), array([16.]))
    """

    area: "_Array"
    load: "_Array"
    centre: "_Array"
    dropped: Dropped
    labels: "NDArray[np.int64]"

    def plot(self, ax: "Axes | None" = None, **style: Any) -> "Axes":
        """Plots a map of the spots in the colours of their loads; it needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        **style
            Arguments of the imshow() of the axes.

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

        return _plot.spots(self, ax, **style)

    def __len__(self) -> int:
        return len(self.area)

    def __repr__(self) -> str:
        return (
            f"<asperity.Spots: {len(self)} spots>\n"
            f"  area     {self.area.min():g} to {self.area.max():g}, together {self.area.sum():g}\n"
            f"  load     {self.load.min():g} to {self.load.max():g}, together {self.load.sum():g}\n"
            f"  dropped  {self.dropped.number} spots, area {self.dropped.area:g}, load {self.dropped.load:g}"
        )

    def contacts(
        self,
        E: float,  # noqa: N803
        nu: float,
        *,
        shear_strength: float | None = None,
        local_friction: float | None = None,
        stiffness: Literal["area", "equal"] | None = None,
        spots: Literal["new", "present"] = "new",
    ) -> Contacts:
        """The contacts of an elastic body against a rigid surface that touch in these spots.

        A spot of area A has the tangential stiffness of a circular one, k = 8Ga/(2 - ν) with the radius a =
        √(A/π) and G = E/2(1 + ν) (R. D. Mindlin, J. Appl. Mech. 16, 259, 1949). It breaks at the force
        shear_strength × A, or local_friction × its load.

        The density of the thresholds is smooth: the kernel density estimate of their logarithms, moved so
        that kinetic friction is half of the sum of the forces at which the spots break.

        Parameters
        ----------
        E, nu : float
            Young's modulus and Poisson's ratio of the body.
        shear_strength : float, optional
            The shear stress at which a spot breaks; or
        local_friction : float, optional
            the ratio of the force at which a spot breaks and its load.
        stiffness : {"area", "equal"}, optional
            "area": the stiffness grows as √A. With a shear strength, for which this is the default, the
            threshold grows with it, k = κ x_s. With a local friction spots of one threshold have different
            stiffnesses; contacts have their mean, a table of k(x_s), and the mean force depends on nothing
            else. "equal": all have the mean stiffness; the default with local_friction.
        spots : {"new", "present"}
            "new": the map shows the spots that are present in long sliding, and new ones are drawn from their
            distribution divided by the threshold, because a spot is present in proportion to its life.
            "present": the distribution of the map itself, for an Ensemble with disorder="quenched", in which
            each spot re-forms in its place.

        Returns
        -------
        Contacts
            As many as there are spots, with the load of all pixels as normal load.

        Raises
        ------
        ValueError
            For numbers that are not above 0 or a Poisson's ratio outside (-1, 0.5].
        TypeError
            For both a shear strength and a local friction, or neither.
        """
        if (shear_strength is None) == (local_friction is None):
            found = "neither" if shear_strength is None else "both"
            raise TypeError(f"shear_strength: expected either shear_strength or local_friction, got {found}")
        for name, value in (("E", E), ("shear_strength", shear_strength), ("local_friction", local_friction)):
            if value is not None and not (0.0 < number(name, value) < np.inf):
                raise ValueError(f"{name}: expected a number above 0, got {value}")
        if not -1.0 < number("nu", nu) <= 0.5:
            raise ValueError(f"nu: expected a Poisson's ratio above -1, at most 0.5, got {nu}")
        if spots not in ("new", "present"):
            raise ValueError(f'spots: expected "new" or "present", got {spots!r}')
        kind = stiffness or ("area" if local_friction is None else "equal")
        if kind not in ("area", "equal"):
            raise ValueError(f'stiffness: expected "area" or "equal", got {kind!r}')
        modulus = 4.0 * E / ((1.0 + nu) * (2.0 - nu) * np.sqrt(np.pi))
        stiff = modulus * np.sqrt(self.area)
        load = float(self.load.sum() + self.dropped.load)
        if local_friction is not None and kind == "area":
            sample = local_friction * self.load / stiff
            law = thresholds(sample, 1, spots)
            table = mean_stiffness(sample, stiff, law, spots)
            if table is None:
                return Contacts(law, count=len(self), stiffness=float(stiff.mean()), normal_load=load)
            return Contacts(law, count=len(self), stiffness_of_threshold=table, normal_load=load)
        if shear_strength is not None and kind == "area":
            # F_k = N κ⟨x³⟩/2⟨x⟩ over new spots, N κ⟨x²⟩/2 over present ones.
            law = thresholds(shear_strength * self.area / stiff, 2, spots)
            return Contacts(
                law,
                count=len(self),
                stiffness_per_threshold=modulus * modulus / shear_strength,
                normal_load=load,
            )
        broken = (
            self.area * shear_strength if shear_strength is not None else self.load * (local_friction or 0.0)
        )
        mean = float(stiff.mean())
        # F_k = N⟨k⟩⟨x²⟩/2⟨x⟩ over new spots, N⟨k⟩⟨x⟩/2 over present ones.
        law = thresholds(broken / mean, 1, spots)
        return Contacts(law, count=len(self), stiffness=mean, normal_load=load)


def silverman(logs: "_Array") -> float:
    """The bandwidth of a kernel density estimate by Silverman's rule, as for samples without a bandwidth."""
    spread = float(logs.std())
    quartiles = float(np.subtract(*np.quantile(logs, [0.75, 0.25]))) / 1.34
    width = min(spread, quartiles) if quartiles > 0.0 else spread
    return float(0.9 * width * len(logs) ** -0.2)


def mean_stiffness(sample: "_Array", stiff: "_Array", law: Law, spots: str) -> "tuple[_Array, _Array] | None":
    """The mean stiffness of spots of one threshold, a table against the threshold; None for equal thresholds.

    It is the kernel regression of E. A. Nadaraya (Theory Probab. Appl. 9, 141, 1964) and G. S. Watson with
    the kernels of the density, times a number near 1 by which kinetic friction is half of the sum of the
    forces at which the spots break.
    """
    logs = np.log(sample)
    if logs.std() < NARROW:
        return None
    bandwidth = silverman(logs)
    # Beyond the sample the stiffness stays that of its ends.
    nodes = np.linspace(logs.min(), logs.max(), NODES)
    kernels = np.exp(-0.5 * ((nodes[:, None] - logs) / bandwidth) ** 2)
    table = kernels @ stiff / kernels.sum(axis=1)
    threshold = np.exp(nodes)
    # F_k = N⟨k x²⟩/2⟨x⟩ over new spots, N⟨k x⟩/2 over present ones.
    power, length = (1, 1.0) if spots == "present" else (2, law.mean())
    carried = law.expect(lambda x: np.interp(x, threshold, table) * x**power) / length
    return threshold, table * float(np.mean(stiff * sample)) / carried


def thresholds(sample: "_Array", order: int, spots: str) -> Law:
    """A smooth distribution of the thresholds of present spots, or of new ones.

    The kernel density estimate is that of ln x, so that there is none at 0 and kernels are as wide as their
    threshold is large. That of present spots has the moment ⟨xⁿ⟩ of the sample, n being the order.
    """
    logs = np.log(sample)
    low, spread = float(logs.min()), float(logs.std())
    if spread < NARROW:
        return Point(float(sample.mean()))
    # Kernels are narrower than the sample, and end at nine bandwidths, so that none is cut at 0.
    offset = 10.0 * spread
    bandwidth = silverman(logs)
    estimate = Tabulated(samples=logs - low + offset, bandwidth=bandwidth)
    moment = estimate.expect(lambda y: np.exp(order * (y - offset + low)))
    shift = float(np.log(np.mean(sample**order) / moment)) / order - offset + low
    power = 1.0 if spots == "present" else 2.0

    def density(x: "_Array") -> "_Array":
        values: _Array = estimate.pdf(np.log(x) - shift)
        return values / x**power

    first, last = estimate.support()
    width = CELL * bandwidth / np.hypot(1.0, bandwidth / spread)
    edges = np.exp(np.linspace(first, last, int(np.ceil((last - first) / width)) + 1) + shift)
    return projected(density, edges)


def spots(pressure: "ArrayLike", pixel: float, *, periodic: bool = True, at_least: int = 4) -> Spots:
    """The contact spots of a map of pressure: pixels under pressure that share a side.

    Parameters
    ----------
    pressure : array_like
        The pressure in each pixel, shape (n, m), 0 where surfaces do not touch; from any contact solver.
    pixel : float
        The side of a pixel, a length.
    periodic : bool
        Whether the map continues beyond its edges, so that spots at opposite edges are one.
    at_least : int
        Spots of fewer pixels are left out, because the grid does not resolve them.

    Returns
    -------
    Spots
        Areas, loads and centres of spots, in the order of their first pixels.

    Raises
    ------
    ValueError
        For an array that is not of two dimensions, pressures that are negative or not finite, no contact,
        contact everywhere, no spot of enough pixels, a pixel that is not above 0, and areas or loads that are
        beyond the numbers of a computer.
    TypeError
        For pressures and a pixel that are no real numbers.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> x = np.arange(64) - 31.5
    >>> height = np.maximum(1 - (x[:, None] ** 2 + x**2) / 20**2, 0)
    >>> found = asp.spots(np.sqrt(height), pixel=0.1)
    >>> len(found), round(float(found.area[0]), 1)
    (1, 12.6)
    """
    from scipy import ndimage

    values = real(pressure)
    if np.ma.is_masked(pressure):
        raise ValueError("pressure: expected numbers none of which is masked (filled(0) makes them 0)")
    if values.ndim != 2 or values.size == 0:
        raise ValueError(f"pressure: expected a map of two dimensions, got the shape {values.shape}")
    if not np.all(np.isfinite(values)) or values.min() < 0.0:
        worst = values[~np.isfinite(values)]
        found = worst[0] if worst.size else values.min()
        raise ValueError(f"pressure: expected finite pressures of 0 or above, got {found}")
    pixel, periodic, at_least = (
        number("pixel", pixel),
        flag("periodic", periodic),
        whole("at_least", at_least),
    )
    if not 0.0 < pixel < np.inf:
        raise ValueError(f"pixel: expected a length above 0, got {pixel}")
    if at_least < 1:
        raise ValueError(f"at_least: expected a number of pixels above 0, got {at_least}")
    touching = values > 0.0
    if not touching.any() or touching.all():
        found = "no pixel" if not touching.any() else "all pixels"
        raise ValueError(f"pressure: expected contact in some pixels, got it in {found}")
    found_labels, count = ndimage.label(touching)
    labels: NDArray[np.int64] = found_labels.astype(np.int64)
    joint = joined(labels, count) if periodic else apart(count)
    parts, count = labels, len(joint.around)
    labels = joint.number[parts]
    index = np.arange(1, count + 1)
    pixels = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    loads: _Array = np.asarray(ndimage.sum_labels(values, labels, index), dtype=np.float64)
    areas, loads = scaled(pixels, loads, pixel)
    kept = pixels >= at_least
    if not kept.any():
        found = f"got {pixels.max()} at most"
        raise ValueError(f"at_least: expected a spot of {at_least} pixels or more, {found}")
    small = Dropped(int((~kept).sum()), float(areas[~kept].sum()), float(loads[~kept].sum()))
    renumbered = np.zeros(count + 1, dtype=np.int64)
    renumbered[1:][kept] = np.arange(1, kept.sum() + 1)
    labels = renumbered[labels]
    centre = centres(values, parts, joint)[kept] * pixel
    return Spots(areas[kept], loads[kept], centre, small, labels)


def real(pressure: "ArrayLike") -> "_Array":
    """The pressures as an array of real numbers."""
    try:
        found = np.asarray(pressure)
        # A complex number would lose its imaginary part with no more than a warning.
        if not np.iscomplexobj(found):
            return found.astype(np.float64, copy=False)
        what = f"{type(pressure).__name__} of dtype {found.dtype}"
    except (TypeError, ValueError):
        what = type(pressure).__name__
    raise TypeError(f"pressure: expected an array of numbers, got {what}")


def scaled(pixels: "NDArray[np.int64]", pressures: "_Array", pixel: float) -> "tuple[_Array, _Array]":
    """Areas and loads of spots, from their numbers of pixels and their sums of pressures."""
    # What is beyond the range of numbers is refused, and the pixel need not be the cause.
    with np.errstate(all="ignore"):
        square = np.float64(pixel) ** 2
        areas, loads = pixels * square, pressures * square
        within = np.isfinite([areas.sum(), loads.sum()]).all() and min(areas.min(), loads.min()) > 0.0
    if not within:
        found = f"{pixel:g} and pressures that add up to {pressures.sum():g}"
        raise ValueError(
            f"pixel: expected a length for which areas and loads are finite and above 0, got {found}"
        )
    return areas, loads


class Joined(NamedTuple):
    """Spots of a periodic map, made of the parts into which its edges cut them."""

    number: "NDArray[np.int64]"
    """The number of the spot of each part, in the order of their first pixels; 0 for the label 0."""
    shift: "NDArray[np.int64]"
    """By how many periods each part is moved along both axes, so that the parts of a spot are connected."""
    around: "NDArray[np.bool_]"
    """Whether each spot is connected with itself around the map, along both axes."""


def joined(labels: "NDArray[np.int64]", count: int) -> Joined:
    """Joins the labels of spots that touch at opposite edges."""
    parent = np.arange(count + 1)
    shift = np.zeros((count + 1, 2), dtype=np.int64)
    around = np.zeros((count + 1, 2), dtype=np.bool_)

    def root(label: int) -> "tuple[int, NDArray[np.int64]]":
        moved = shift[label].copy()
        while parent[label] != label:
            label = parent[label]
            moved += shift[label]
        return label, moved

    for axis, (one, other) in enumerate(((labels[0], labels[-1]), (labels[:, 0], labels[:, -1]))):
        # The same two parts touch in many pixels.
        pairs = np.unique(np.stack([one, other])[:, (one > 0) & (other > 0)], axis=1)
        for a, b in pairs.T:
            (first, moved), (second, there) = root(a), root(b)
            # The last pixel lies before the first one, a period back.
            difference = moved - there
            difference[axis] -= 1
            if first == second:
                around[first] |= difference != 0
                continue
            low, high = min(first, second), max(first, second)
            parent[high] = low
            shift[high] = difference if high == second else -difference
            around[low] |= around[high]
    found = [root(label) for label in range(count + 1)]
    roots = np.array([place for place, _ in found])
    own = roots == np.arange(count + 1)
    return Joined((np.cumsum(own) - 1)[roots], np.array([moved for _, moved in found]), around[own][1:])


def apart(count: int) -> Joined:
    """Spots that are no more than their parts."""
    return Joined(np.arange(count + 1), np.zeros((count + 1, 2), np.int64), np.zeros((count, 2), np.bool_))


def centres(values: "_Array", parts: "NDArray[np.int64]", joint: Joined) -> "_Array":
    """The centres of pressure of spots in pixels, from the loads and moments of their parts."""
    from scipy import ndimage

    index, numbers = np.arange(1, len(joint.number)), joint.number[1:] - 1
    loads = ndimage.sum_labels(values, parts, index)
    found = np.empty(joint.around.shape)
    for axis, length in enumerate(values.shape):
        place = (np.arange(length) + 0.5).reshape((-1, 1) if axis == 0 else (1, -1))
        moments = ndimage.sum_labels(values * place, parts, index) + length * joint.shift[1:, axis] * loads
        found[:, axis] = np.bincount(numbers, moments) / np.bincount(numbers, loads) % length
    # Where a spot goes around the map, its pixels have no order from a first to a last one.
    found[joint.around] = np.nan
    return found
