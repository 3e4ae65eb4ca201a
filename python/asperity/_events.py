"""The slips of a drive, or the events of an interface, as a table."""

from collections import namedtuple
from collections.abc import Callable, KeysView, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, overload

from asperity import _show
from asperity._arguments import table, word

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray
    from pandas import DataFrame


class Event(NamedTuple):
    """A slip: at a fixed drive; or, in time, while the slider is more than ten times as fast as the load
    point.

    Examples
    --------
    >>> import asperity as asp
    >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))
    >>> event = asp.Block(theory, 1.0).drive(5.0).events[0]
    >>> bool(event.drop > 0.0)
    True
    """

    drive: float
    """The drive, a length; or the imposed force."""
    position_before: float
    """The position X_1 at which the slider became unstable, a length."""
    position_after: float
    """The position of the next equilibrium, a length."""
    position_turn: float
    """The position X_2 at which an inertial slip first came to rest; otherwise the one after. A length."""
    force_before: float
    """The force F_1 before the slip."""
    force_after: float
    """The force after the slip."""
    drop: float
    """The force drop."""
    slip: float
    """The slip of the slider, a length."""
    broken_fraction: float
    """Breaks per contact, 1 in a reset; in other slips a contact that breaks twice counts twice."""
    dissipated_breaks: float
    """Energy dissipated in breaks."""
    dissipated_slip: float
    """Energy lost by the slider, by viscous damping or otherwise."""
    time: float | None = None
    """The time at which it begins; None without motion in time, as for the fields below."""
    duration: float | None = None
    """Its duration."""
    velocity: float | None = None
    """The highest velocity of the slider."""
    strengthening: float | None = None
    """Energy that ageing added by making stretched contacts stiffer."""


_ROWS: dict[tuple[str, ...], Callable[..., Any]] = {}


def row(names: tuple[str, ...]) -> Callable[..., Any]:
    """What makes a row of a table with these columns, in their order."""
    if names not in _ROWS:
        _ROWS[names] = partial(_of_slider, names) if set(names) <= set(Event._fields) else _kind(names)
    return _ROWS[names]


def _of_slider(names: tuple[str, ...], *values: Any) -> Event:
    return Event(**dict(zip(names, values, strict=True)))


def _kind(names: tuple[str, ...]) -> Any:
    """A class of rows with these fields, whose rows can be pickled."""
    make: Any = namedtuple
    fields = make("Event", names)

    def reduced(event: Any) -> tuple[Any, ...]:
        return _again, (event._fields, tuple(event))

    return type("Event", (fields,), {"__slots__": (), "__reduce__": reduced, "__module__": __name__})


def _again(names: tuple[str, ...], values: tuple[Any, ...]) -> Any:
    return row(names)(*values)


class Events(Sequence[Event]):
    """The slips of a drive, in order: a table whose rows are Event, and whose columns are arrays.

    `len(events)` is their number, `events[0]` the first, `events["drop"]` an array of the drops, shape (n,);
    `events.columns` are the names of the columns, those of the fields of an Event. A boolean mask or
    a list of numbers of rows selects events: `events[events["drop"] > 0.1]`. Events of an interface have the
    columns of its `events.csv`, and rows with fields of these names; numbers of cells are whole.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        The columns by their names, as results have them.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.05))
    >>> events = asp.Block(asp.MasterEquation(contacts), stiffness=1.0).drive(5.0).events
    >>> len(events), events.columns[:3]
    (2, ('drive', 'position_before', 'position_after'))
    >>> later = events[events["drive"] > 2.0]
    >>> later["drop"].round(3).tolist()
    [0.871]
    """

    def __init__(self, columns: "Mapping[str, NDArray[Any]]") -> None:
        self._columns: dict[str, NDArray[Any]] = dict(table("columns", columns, "arrays by name"))
        self._row = row(tuple(columns))

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._columns)

    def keys(self) -> "KeysView[str]":
        """The names of the columns, as of a mapping: `dict(events)` has the columns.

        Returns
        -------
        KeysView[str]
        """
        return self._columns.keys()

    def to_pandas(self) -> "DataFrame":
        """The table as a pandas.DataFrame with a row for each event; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            The columns, whole numbers as integers.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ImportError as error:
            raise ImportError("to_pandas() needs pandas: pip install pandas") from error
        return DataFrame(self._columns)

    def plot(
        self, ax: "Axes | None" = None, *, x: str = "drive", y: str | None = None, **style: Any
    ) -> "Axes":
        """Plots one column against another, an event as a dot; it needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to plot on; new ones by default.
        x, y : str
            Names of columns; by default the drop of the force, or for contacts coupled one by one the size,
            against the drive.
        **style
            Arguments of the plot() of the axes.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        KeyError
            If there is no such column.
        """
        from asperity import _plot

        if y is None:
            y = "size" if "size" in self._columns else "drop"
        return _plot.events(self, ax, word("x", x), word("y", y), **style)

    def __len__(self) -> int:
        return len(self._columns["drive"])

    @overload
    def __getitem__(self, key: str) -> "NDArray[Any]": ...
    @overload
    def __getitem__(self, key: "int | np.integer[Any]") -> Event: ...
    @overload
    def __getitem__(self, key: "slice | NDArray[Any] | list[int] | list[bool]") -> "Events": ...
    def __getitem__(self, key: Any) -> "NDArray[Any] | Event | Events":
        if isinstance(key, str):
            try:
                return self._columns[key]
            except KeyError:
                raise KeyError(f"expected one of {', '.join(self._columns)}, got {key}") from None
        if isinstance(key, slice | list) or getattr(key, "ndim", 0) == 1:
            rows = key if isinstance(key, slice) else chosen(key, len(self))
            return Events({name: column[rows] for name, column in self._columns.items()})
        event: Event = self._row(*(column[key].item() for column in self._columns.values()))
        return event

    def __reduce__(self) -> "tuple[type[Events], tuple[dict[str, NDArray[Any]]]]":
        return Events, (self._columns,)

    def __repr__(self) -> str:
        return _show.listed(f"<asperity.Events: {len(self)}>", self._rows())

    def _repr_html_(self) -> str:
        return _show.table(f"Events: {len(self)}", self._rows())

    def _rows(self) -> dict[str, str]:
        return {name: _show.numbers(column) for name, column in self._columns.items()}


def chosen(key: Any, count: int) -> "NDArray[Any]":
    """Numbers of rows, or a mask of as many values as there are rows."""
    import numpy as np

    rows = np.asarray(key)
    if rows.size == 0 and rows.dtype != np.bool_:
        return rows.astype(np.intp)
    if rows.dtype == np.bool_ and len(rows) != count:
        raise IndexError(f"expected a mask of {count} values, one for each event, got {len(rows)}")
    if rows.dtype != np.bool_ and not np.issubdtype(rows.dtype, np.integer):
        raise TypeError(f"expected a name, a number, a mask or numbers of events, got {rows.dtype}")
    return rows
