"""Opens a result folder as users do: python open_with_xarray.py DIR...

With xarray, by either of its engines, result.nc holds the variables of docs/variables.md and the numbers of the table of the task, units, long names, the
scenario, the version and the seed of summary.json.
"""

import csv
import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr


# Tables of tasks that are not called as the task.
TABLES = (
    "force.csv",
    "trace.csv",
    "static_fatigue.csv",
    "fit_spectrum.csv",
    "fit_readings.csv",
    "thresholds.csv",
)


# How the sections of docs/variables.md begin, of tasks that summaries do not call as scenarios do.
HEADINGS = {
    "drive": ["`[drive]`\n", "`[[protocol]]`\n", "`[[protocol]] with [block]"],
    "interface_drive": ["`[drive] with [interface]", "`[drive] or [[protocol]] with [interface]"],
    "protocol": ["`[[protocol]]`\n"],
    "block_protocol": ["`[[protocol]] with [block]"],
}


def variables(task: str) -> set[tuple[str, str]]:
    """The variables of a task with their long names, as the page of variables has them."""
    page = (Path(__file__).parents[2] / "docs" / "variables.md").read_text(encoding="utf-8")
    headings = HEADINGS.get(task, [f"`[{task}]`"])
    sections = [part for part in page.split("\n## ") if part.startswith(tuple(headings))]
    assert len(sections) >= len(headings)
    lines = (line for section in sections for line in section.splitlines() if line.startswith("| `"))
    rows = (line.strip("| ").split(" | ") for line in lines)
    return {(name.strip("`"), meaning) for name, _, _, meaning in rows}


def check(folder: Path, engine: str) -> None:
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    (table,) = [name for name in (*TABLES, f"{summary['task']}.csv") if (folder / name).exists()]
    with open(folder / table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    with xr.open_dataset(folder / "result.nc", engine=engine) as data:
        # Curves at several temperatures, or velocities, stand one below the other.
        whole = max((xr.zeros_like(data[name]) for name in rows[0]), key=lambda values: values.ndim)
        dimensions = whole.dims
        assert len(dimensions) == 1 or dimensions[0] in ("temperature", "velocity"), dimensions
        for name in rows[0]:
            column = np.array([float(row[name]) for row in rows])
            values = (whole + data[name]).transpose(*dimensions).values.ravel()
            assert np.array_equal(values, column, equal_nan=True), name
        declared = variables(summary["task"])
        for name, variable in data.variables.items():
            assert variable.attrs["long_name"], name
            assert name == "scenario" or (name, variable.attrs["long_name"]) in declared, name
            if name != "scenario":
                kind = {"count": np.int64, "flag": np.bool_}.get(variable.attrs["quantity"], np.float64)
                assert variable.dtype == kind, name
                assert variable.attrs["units"], name
        assert data.attrs["version"] == summary["version"]
        assert data.attrs["title"] == summary["title"]
        assert data.attrs.get("seed") == summary["seed"]
        assert data["scenario"].item() == (folder / "scenario.toml").read_text(encoding="utf-8")
        if "snapshot" in data:
            assert data["stretch_density"].dims == ("snapshot", "stretch")
            shares = data["stretch_density"].fillna(0.0).integrate("stretch").values
            if "stretch_atom_weight" in data:
                for position, weight in zip(data["stretch_atom_position"], data["stretch_atom_weight"]):
                    shares = shares + np.where(data["snapshot"].values == position.item(), weight.item(), 0.0)
            assert np.allclose(shares, 1.0, atol=2e-3), shares


def check_sweep(folder: Path, engine: str) -> None:
    """The same of a sweep: sweep.nc has the cases of sweep.csv along its axes."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with open(folder / "sweep.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    with xr.open_dataset(folder / "sweep.nc", engine=engine) as data:
        axes = [axis["keys"][0].replace(".", "_") for axis in summary["axes"]]
        for name in rows[0]:
            _, values = xr.broadcast(data[kept_name(summary)], data[name])
            values = values.transpose(*axes).values.ravel()
            if values.dtype.kind in "OUT":
                assert list(values) == [row[name] for row in rows], name
            else:
                column = np.array([float(row[name]) for row in rows])
                assert np.array_equal(values, column, equal_nan=True), name
            assert data[name].attrs["long_name"], name
        assert data.attrs["version"] == summary["version"]
        assert data.attrs["cases"] == len(rows) == summary["cases"]
        assert data["scenario"].item() == (folder / "scenario.toml").read_text(encoding="utf-8")


def kept_name(summary: dict) -> str:
    """A variable along all axes."""
    return summary["kept"][0]["name"]


def main() -> None:
    folders = [Path(name) for name in sys.argv[1:]]
    if not folders:
        sys.exit("usage: python open_with_xarray.py DIR...")
    # Beside a sweep are its stored cases.
    for folder in (folder for folder in folders if (folder / "summary.json").exists()):
        for engine in ("netcdf4", "h5netcdf"):
            (check_sweep if (folder / "sweep.nc").exists() else check)(folder, engine)
        print(f"{folder}: reads the same with netcdf4 and h5netcdf")


if __name__ == "__main__":
    main()
