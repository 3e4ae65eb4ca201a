"""Results as labelled arrays of xarray, as xarray opens them from `result.nc`."""

from typing import TYPE_CHECKING, Any

import numpy as np

from asperity import _show

if TYPE_CHECKING:
    from xarray import Dataset

    from asperity._core import Record

# The types of quantities that are no real numbers, as in the file.
TYPES = {"count": np.int64, "flag": np.bool_}
FLAGS = {"flag_values": np.array([0, 1], np.int8), "flag_meanings": "false true"}


def dataset(record: "Record") -> "Dataset":
    """The variables of a record with their labels, its coordinates, and the attributes of the whole."""
    try:
        from xarray import Dataset
    except ImportError as error:
        raise ImportError("to_xarray() needs xarray: pip install 'asperity[xarray]'") from error
    known = set(record._coordinates())
    variables: dict[str, object] = {}
    coordinates: dict[str, object] = {}
    for name, label in record.labels.items():
        attributes: dict[str, Any] = {"long_name": label.long_name, "units": label.units}
        attributes["quantity"] = label.quantity
        if label.quantity == "flag":
            attributes |= FLAGS
        values: Any = record[name].astype(TYPES.get(label.quantity, np.float64), copy=False)
        (coordinates if name in known else variables)[name] = (label.dimensions, values, attributes)
    scenario = getattr(record, "scenario", None)
    if scenario is not None:
        variables["scenario"] = ((), scenario, {"long_name": "scenario, TOML"})
    return Dataset(variables, coordinates, of_whole(record))


def of_whole(record: "Record") -> dict[str, Any]:
    """The attributes of the whole: of a result its summary, of another record the numbers that it has."""
    found: dict[str, Any] = dict(record._attributes())
    if hasattr(record, "summary"):
        return found
    for name in _show.NUMBERS:
        value = getattr(record, name, None)
        if isinstance(value, tuple):
            found |= {f"{name}_force": value[0], f"{name}_position": value[1]}
        elif value is not None:
            found[name] = value
    return found
