"""Results as labelled arrays of xarray."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset

    from asperity._core import Record


def dataset(record: "Record") -> "Dataset":
    """The variables of a record; a variable with the name of its only dimension is a coordinate."""
    try:
        from xarray import Dataset
    except ImportError as error:
        raise ImportError("to_xarray() needs xarray: pip install 'asperity[xarray]'") from error
    variables: dict[str, object] = {}
    coordinates: dict[str, object] = {}
    for name, label in record.labels.items():
        attributes = {"long_name": label.long_name, "units": label.units}
        where = coordinates if label.dimensions == (name,) else variables
        where[name] = (label.dimensions, record[name], attributes)
    return Dataset(variables, coordinates)
