"""Records of friction experiments: columns of a text file, and the motion of the load point in them."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import count, pairwise
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from asperity._arguments import number as _number, whole as _whole, word as _word, wrong
from asperity._columns import read as _read
from asperity._core import VelocityStep, _measured_pieces, read_velocity_step

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

# What the columns of laboratories are called, by what they are; the first that fits is taken.
NAMES = {
    "time": re.compile(r"^time\b", re.IGNORECASE),
    "displacement": re.compile(r"displ|slip|position|load.?point|^lp", re.IGNORECASE),
    # Not "normalised".
    "normal": re.compile(r"normal(?!i[sz])", re.IGNORECASE),
    "force": re.compile(r"friction|shear|force|^(mu|µ|μ)\b|torque", re.IGNORECASE),
}

# A column called t is a time where none is called so, unless it has another unit: T is a temperature, too.
SHORT = re.compile(r"^t\b", re.IGNORECASE)
DURATION = re.compile(r"^([mµμun]?s|sec|seconds?|min|minutes?|h|hr|hours?|d|days?)?$", re.IGNORECASE)

# Names of other roles that exclude a column: a normal displacement is neither that of the load point nor a
# normal load, and a shear displacement is no force.
EXCLUDED = {
    "displacement": ("time", "normal"),
    "normal": ("time", "displacement"),
    "force": ("time", "displacement", "normal"),
}

# A column with these words has no role by its name, although the rest of the name may say so.
OTHER = re.compile(r"rate(?![a-z])|veloc|speed|accel|strain", re.IGNORECASE)

# The unit of a rate, such as µm/s.
RATE = re.compile(r"/\s*(ms|s|sec|min|h|hr)\b|\bs(\^|\*\*)?[-−]1|s⁻¹", re.IGNORECASE)


class Motion(NamedTuple):
    """A part of a record in which the load point has one velocity, or rests.

    Of a record, record[motion] has its readings, and record[motion].plot() draws them.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> rows = [[t, 2.0 * min(t, 50), 0.5] for t in range(100)]
    >>> names = "time (s),displacement (mm),force (N)"
    >>> np.savetxt("record.csv", rows, delimiter=",", header=names, comments="")
    >>> [motion.kind for motion in asp.read_laboratory("record.csv").motions()]
    ['forward', 'hold']
    """

    kind: Literal["forward", "hold", "backward"]
    velocity: float
    """The velocity, displacement over time; near 0 in a hold."""
    error: float
    """Its standard error from the scatter about the line, which is taken as independent."""
    begin: float
    """The time at which it begins: where its line meets the one before."""
    start: int
    """The first reading."""
    stop: int
    """The reading after the last."""


@dataclass(frozen=True, repr=False)
class LaboratoryRecord:
    """A record of a friction experiment: readings in time.

    Attributes
    ----------
    columns : dict of str to ndarray
        All columns of the file by their names without units. Of columns with one name the first one has it,
        the others are called "Force 2", "Force 3" and so on.
    units : dict of str to str
        The units of columns that name one.
    roles : dict of str to str
        The names of the columns that are "time", "displacement", "force" and, if there is one, "normal".
    time, displacement, force : ndarray
        Time, load-point displacement, and force, stress or friction coefficient, each of shape (n,).
    normal : ndarray or None
        Normal load or stress, if the record has it.

    Examples
    --------
    >>> import asperity as asp
    >>> import numpy as np
    >>> rows = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.5], [2.0, 4.0, 0.5]]
    >>> names = "time (s),displacement (mm),force (N)"
    >>> np.savetxt("record.csv", rows, delimiter=",", header=names, comments="")
    >>> asp.read_laboratory("record.csv").force
    array([0. , 0.5, 0.5])
    """

    columns: "Mapping[str, NDArray[np.float64]]"
    units: "Mapping[str, str]" = field(default_factory=dict)
    roles: "Mapping[str, str]" = field(default_factory=dict)

    @property
    def time(self) -> "NDArray[np.float64]":
        """Time of each reading."""
        return self._column("time")

    @property
    def displacement(self) -> "NDArray[np.float64]":
        """Displacement of the load point."""
        return self._column("displacement")

    @property
    def force(self) -> "NDArray[np.float64]":
        """Force, shear stress or friction coefficient."""
        return self._column("force")

    @property
    def normal(self) -> "NDArray[np.float64] | None":
        """Normal load or stress; None if the record has none."""
        return self._column("normal") if "normal" in self.roles else None

    def _column(self, role: str) -> "NDArray[np.float64]":
        return self.columns[self.roles[role]]

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        lines = [f"<asperity.LaboratoryRecord: {len(self)} readings>"]
        for role, name in self.roles.items():
            values, unit = self.columns[name], self.units.get(name, "")
            span = f"{values.min():g} to {values.max():g} {unit}".rstrip() if len(values) else "no readings"
            lines.append(f"  {role:<12} {span}  ({name})")
        return "\n".join(lines)

    def __getitem__(self, part: "slice | Motion | NDArray[np.bool_]") -> "LaboratoryRecord":
        """The readings of a slice, of a motion, or where a mask is true."""
        place = slice(part.start, part.stop) if isinstance(part, Motion) else part
        return replace(self, columns={name: values[place] for name, values in self.columns.items()})

    def average(self, count: int) -> "LaboratoryRecord":
        """The means of successive readings, `count` at a time; a rest at the end is left out.

        Parameters
        ----------
        count : int
            The number of readings of a mean, 1 or more.

        Returns
        -------
        LaboratoryRecord
            The means.

        Raises
        ------
        ValueError
            For a count below 1, or above the number of readings.
        """
        if not 1 <= _whole("count", count) <= len(self):
            raise ValueError(f"count: expected a number of readings from 1 to {len(self)}, got {count}")
        whole = len(self) // count * count
        means = {
            name: values[:whole].reshape(-1, count).mean(axis=1) for name, values in self.columns.items()
        }
        return replace(self, columns=means)

    def motions(self, *, apart: float = 0.2, least: int = 8, still: float | None = None) -> list[Motion]:
        """The parts of constant velocity of the load point, in order: steps, holds, and motion backwards.

        Parameters
        ----------
        apart : float
            Neighbouring parts whose velocities differ by less than this fraction of the larger one are one.
        least : int
            Least number of readings of a part.
        still : float, optional
            The load point rests below this velocity; by default, a thousandth of the highest one.

        Returns
        -------
        list of Motion
            Kind, velocity with its standard error, and the range of readings.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For an apart that is not from 0 to 1, a least below 3, a record of fewer than twice as many
            readings, and times that do not rise.
        """
        apart, least = _number("apart", apart), _whole("least", least)
        pieces = _measured_pieces(self.time, self.displacement, apart, least)
        fastest = max(abs(piece[3]) for piece in pieces)
        limit = 1e-3 * fastest if still is None else _number("still", still)
        found: list[Motion] = []
        for start, stop, begin, velocity, error in pieces:
            kind: Literal["forward", "hold", "backward"]
            kind = "hold" if abs(velocity) <= limit else "forward" if velocity > 0.0 else "backward"
            motion = Motion(kind, velocity, error, begin, start, stop)
            if kind == "hold" and found and found[-1].kind == "hold":
                motion = _one_hold(found.pop(), motion)
            found.append(motion)
        return found

    def cycles(self, **options: Any) -> list["LaboratoryRecord"]:
        """The record cut where the load point, after a motion backwards, moves forwards again.

        Parameters
        ----------
        **options
            Those of motions().

        Returns
        -------
        list of LaboratoryRecord
            A record for each cycle.

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            As for motions().
        """
        motions = self.motions(**options)
        moving = [motion for motion in motions if motion.kind != "hold"]
        cuts = [
            after.start
            for before, after in pairwise(moving)
            if before.kind == "backward" and after.kind == "forward"
        ]
        return [self[start:stop] for start, stop in zip([0, *cuts], [*cuts, len(self)], strict=True)]

    def protocol(self, **options: Any) -> list[dict[str, float]]:
        """The motion as steps of a scenario, {"hold": …} or {"velocity": …, "duration": …}, for "protocol".

        Parameters
        ----------
        **options
            Those of motions().

        Returns
        -------
        list of dict
            The steps.

        Raises
        ------
        ValueError
            For motion backwards, which a protocol has not.
        """
        steps = []
        motions = self.motions(**options)
        ends = [*(motion.begin for motion in motions[1:]), float(self.time[-1])]
        for motion, end in zip(motions, ends, strict=True):
            duration = end - motion.begin
            if motion.kind == "backward":
                raise ValueError(
                    f"record: expected a load point that moves forwards, got {motion.velocity:g} from t = "
                    f"{motion.begin:g} on"
                )
            hold = motion.kind == "hold"
            steps.append({"hold": duration} if hold else {"velocity": motion.velocity, "duration": duration})
        return steps

    def velocity_step(
        self,
        number: int = 0,
        *,
        before: float | None = None,
        after: float | None = None,
        motions: list[Motion] | None = None,
        **options: Any,
    ) -> VelocityStep:
        """Reads the rate-and-state parameters of a velocity step.

        Parameters
        ----------
        number : int
            The step, counted from 0 among the changes from one velocity forwards to another.
        before, after : float, optional
            Displacements before and after the step that are used; by default, to the neighbouring changes.
        motions : list of Motion, optional
            Parts of constant velocity, if not those of motions().
        **options
            Those of read_velocity_step, such as average and trend.

        Returns
        -------
        VelocityStep

        Raises
        ------
        TypeError
            For an argument of another type, which the message names.
        ValueError
            For a number of no step, and for what read_velocity_step refuses, such as fewer than 8 readings
            after the step.
        """
        if motions is not None and not isinstance(motions, Iterable):
            raise wrong("motions", "a list of Motion", motions)
        parts = self.motions() if motions is None else list(motions)
        steps = [pair for pair in pairwise(parts) if all(part.kind == "forward" for part in pair)]
        if not steps:
            found = ", ".join(part.kind for part in parts) or "none"
            raise ValueError(f"motions: expected two forward motions, one after the other, got {found}")
        if not 0 <= _whole("number", number) < len(steps):
            raise ValueError(
                f"number: expected one of the {len(steps)} velocity steps, from 0 on, got {number}"
            )
        slow, fast = steps[number]
        part = self[slow.start : fast.stop]
        # The measured displacement has noise; that of a line through it rises.
        elapsed = part.time - fast.begin
        position = np.where(elapsed < 0.0, slow.velocity, fast.velocity) * elapsed
        # The reading nearest to the step may be on either side of it.
        near = np.abs(elapsed) > 0.5 * np.median(np.diff(part.time))
        if before is not None:
            near &= position >= -_number("before", before)
        if after is not None:
            near &= position <= _number("after", after)
        ratio = fast.velocity / slow.velocity
        return read_velocity_step(position[near], part.force[near], ratio, **options)

    def plot(self, ax: "Axes | None" = None, *, against: str = "displacement", **style: Any) -> "Axes":
        """Draws the force against the displacement of the load point, or against "time"; it needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        against : str
            "displacement", "time", or another role of a column.
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

        if against not in self.roles:
            raise ValueError(f"against: expected one of {', '.join(self.roles)}, got {against!r}")
        ax = _plot.axes_or_new(ax)
        ax.plot(self._column(against), self.force, **style)
        ax.set(xlabel=self._label(against), ylabel=self._label("force"))
        return ax

    def _label(self, role: str) -> str:
        name = self.roles[role]
        unit = self.units.get(name)
        return f"{name} ({unit})" if unit else name


def read_laboratory(
    path: "str | PathLike[str]",
    *,
    time: str | None = None,
    displacement: str | None = None,
    force: str | None = None,
    normal: str | None = None,
    skip: int = 0,
    decimal: str = ".",
    encoding: str = "utf-8",
) -> LaboratoryRecord:
    """Reads a record of a friction experiment from a text file with a heading.

    Parameters
    ----------
    path : str or path-like
        A file whose columns are separated by commas, semicolons, tabs or blanks. The first line that is no
        comment (#, %) names the columns, with units in brackets, "Displ (µm)", "shear stress [MPa]", or in a
        line of their own below.
    time, displacement, force, normal : str, optional
        Names of the columns, with or without unit; of several with the same one, the first. By default the
        first columns whose names say so: "time"; "displ", "slip", "position" or "load point", but not
        "normal"; "friction", "shear", "force" or "mu", but none of the others; "normal", but no displacement.
        No rates and strains are taken by default, and no column twice. A record need not have a normal load.
    skip : int
        Number of lines before the heading that are no part of the table, 0 or more.
    decimal : {".", ","}
        The decimal separator.
    encoding : str
        The encoding of the text, such as "latin-1" or "utf-16".

    Returns
    -------
    LaboratoryRecord

    Raises
    ------
    ValueError
        A file without heading or readings, or in another encoding, a column that is not there, a value that
        is no finite number, skip below 0, and another word as decimal or encoding.
    OSError
        A file that cannot be read.

    Examples
    --------
    >>> from pathlib import Path
    >>> import asperity as asp
    >>> text = "Time (s),Displ (µm),Shear stress [MPa]\\n0,0,0.5\\n1,2,0.6\\n2,4,0.7\\n"
    >>> _ = Path("record.csv").write_text(text, encoding="utf-8")
    >>> record = asp.read_laboratory("record.csv")
    >>> len(record), float(record.force[1]), record.units["Displ"]
    (3, 0.6, 'µm')
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path: expected a path, got {type(path).__name__}")
    skipped, point, coded = _whole("skip", skip), _word("decimal", decimal), _word("encoding", encoding)
    names, units, heading, values = _read(fspath(path), skip=skipped, decimal=point, encoding=coded)
    asked = {"time": time, "displacement": displacement, "normal": normal, "force": force}
    roles = {role: given(role, name, names, heading) for role, name in asked.items() if name is not None}
    for role in asked:
        if role not in roles and (place := named(role, names, units, set(roles.values()))) is not None:
            roles[role] = place
    missing = [role for role in ("time", "displacement", "force") if role not in roles]
    if missing:
        raise ValueError(
            f"{fspath(path)}: expected a column for {missing[0]} ({missing[0]}=...), got {', '.join(heading)}"
        )
    single = distinct(names)
    columns = dict(zip(single, values, strict=True))
    with_units = {name: unit for name, unit in zip(single, units, strict=True) if unit}
    order = ("time", "displacement", "force", "normal")
    ordered: dict[str, str] = {role: single[roles[role]] for role in order if role in roles}
    return LaboratoryRecord(columns, with_units, ordered)


def _one_hold(first: Motion, second: Motion) -> Motion:
    """Two holds that follow each other: slow drifts, or roundings, of different velocities."""
    readings = np.array([first.stop - first.start, second.stop - second.start])
    shares = readings / readings.sum()
    velocity = float(shares @ [first.velocity, second.velocity])
    error = float(np.hypot(*(shares * [first.error, second.error])))
    return Motion("hold", velocity, error, first.begin, first.start, second.stop)


def given(role: str, asked: str, names: tuple[str, ...], heading: list[str]) -> int:
    """The place of the column that is asked for, with or without unit."""
    for place, possible in enumerate(zip(names, heading, strict=True)):
        if asked in possible:
            return place
    raise ValueError(f"{role}: expected one of the columns {', '.join(heading)}, got {asked!r}")


def named(role: str, names: tuple[str, ...], units: tuple[str, ...], taken: set[int]) -> int | None:
    """The place of the first column whose name says that it has a role, and that has no other."""
    for place, (name, unit) in enumerate(zip(names, units, strict=True)):
        others = any(NAMES[other].search(name) for other in EXCLUDED.get(role, ()))
        rate = bool(OTHER.search(name) or RATE.search(unit))
        if NAMES[role].search(name) and not others and not rate and place not in taken:
            return place
    if role != "time":
        return None
    short = (SHORT.search(name) and DURATION.search(unit) for name, unit in zip(names, units, strict=True))
    return next((place for place, is_time in enumerate(short) if is_time and place not in taken), None)


def distinct(names: tuple[str, ...]) -> list[str]:
    """Names of which no two are equal: the second column "Force" is "Force 2"."""
    found: list[str] = []
    for name in names:
        # No name of another column is taken.
        numbered = (f"{name} {number}" for number in count(2))
        free = (other for other in numbered if other not in names and other not in found)
        found.append(next(free) if name in found else name)
    return found
