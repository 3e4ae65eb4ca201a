"""The slips of a drive, or the events of an interface, as a table."""

from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex, overload

from asperity import _show

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Event(NamedTuple):
    """A slip: at a fixed drive; or, in time, while the slider is more than ten times as fast as the load
    point.
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
        _ROWS[names] = Event if set(names) <= set(Event._fields) else namedtuple("Event", names)
    make = _ROWS[names]
    return make if make is not Event else lambda *values: Event(**dict(zip(names, values, strict=True)))


class Events(Sequence[Event]):
    """The slips of a drive, in order: a table whose rows are Event, and whose columns are arrays.

    `len(events)` is their number, `events[0]` the first, `events["drop"]` an array of the drops, shape (n,).
    Columns have the names of the fields of an Event. Events of an interface have the columns of its
    `events.csv`, and rows with fields of these names.
    """

    def __init__(self, columns: "Mapping[str, NDArray[np.float64]]") -> None:
        self._columns = columns
        self._row = row(tuple(columns))

    def __len__(self) -> int:
        return len(self._columns["drive"])

    @overload
    def __getitem__(self, key: str) -> "NDArray[np.float64]": ...
    @overload
    def __getitem__(self, key: SupportsIndex) -> Event: ...
    @overload
    def __getitem__(self, key: slice) -> "Events": ...
    def __getitem__(self, key: "str | SupportsIndex | slice") -> "NDArray[np.float64] | Event | Events":
        if isinstance(key, str):
            return self._columns[key]
        if isinstance(key, slice):
            return Events({name: column[key] for name, column in self._columns.items()})
        event: Event = self._row(*(float(column[key]) for column in self._columns.values()))
        return event

    def __repr__(self) -> str:
        return _show.listed(f"<asperity.Events: {len(self)}>", self._rows())

    def _repr_html_(self) -> str:
        return _show.table(f"Events: {len(self)}", self._rows())

    def _rows(self) -> dict[str, str]:
        return {name: _show.numbers(column) for name, column in self._columns.items()}
