"""What the shipped scenarios and the notebooks of a source tree compute, bit by bit, against another tree.

python .ci/fingerprint.py record TREE FILE     runs everything in TREE, keeps all numbers in FILE, an .npz
python .ci/fingerprint.py compare FILE FILE    prints what differs, and by how much; exit status 1 if so

`make fingerprint BASE=COMMIT` does this for the working tree and a commit. Both are built and run on one
machine, since the last bits of a number depend on the processor and on the C library.
"""

import contextlib
import io
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

Numbers = dict[str, np.ndarray]

CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
# Of a summary and of the attributes of result.nc, what describes the program and not the result.
PROGRAM = {"version", "history"}


def of_folder(folder: Path) -> Iterator[tuple[str, object]]:
    """All numbers and texts in a folder of results, pictures left out."""
    import netCDF4

    for path in sorted(folder.iterdir()):
        if path.suffix == ".csv":
            yield path.name, path.read_text(encoding="utf-8")
        elif path.suffix == ".json":
            summary = json.loads(path.read_text(encoding="utf-8"))
            yield from (
                (f"{path.name}/{key}", json.dumps(value))
                for key, value in summary.items()
                if key not in PROGRAM
            )
        elif path.suffix == ".nc":
            with netCDF4.Dataset(path) as data:
                data.set_auto_mask(False)
                for name, variable in data.variables.items():
                    yield f"{path.name}/{name}", variable[...]
                    yield (
                        f"{path.name}/{name}/attributes",
                        json.dumps(variable.__dict__, default=str, sort_keys=True),
                    )


def of_scenarios(tree: Path) -> Iterator[tuple[str, object]]:
    """The results of all shipped scenarios."""
    build = ["cargo", "build", "--release", "--locked", "--quiet", "--package", "asperity-cli"]
    subprocess.run(build, cwd=tree, check=True)
    program = Path(os.environ.get("CARGO_TARGET_DIR", tree / "target")) / "release" / "asperity"
    for scenario in sorted((tree / "scenarios").glob("*.toml")):
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "results"
            swept = "\n[sweep" in scenario.read_text(encoding="utf-8")
            subprocess.run(
                [program, "sweep" if swept else "run", scenario, "--quiet", "-o", results], check=True
            )
            yield from ((f"{scenario.stem}/{name}", value) for name, value in of_folder(results))


def of_notebook(page: Path) -> Iterator[tuple[str, object]]:
    """What a notebook prints, and the numbers that it leaves under a name."""
    names: dict[str, object] = {"__name__": "__main__"}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for cell in CELL.findall(page.read_text(encoding="utf-8")):
            exec(compile(cell, page, "exec"), names)
            # As in a notebook, where a figure is shown below its cell.
            if pyplot := sys.modules.get("matplotlib.pyplot"):
                pyplot.close("all")
    yield "printed", printed.getvalue()
    kept = ((name, numbers(value)) for name, value in names.items())
    yield from ((name, value) for name, value in kept if value is not None)


def numbers(value: object) -> np.ndarray | None:
    """A number, or numbers, as an array; None of anything else."""
    if not isinstance(value, (bool, int, float, complex, np.number, np.ndarray, list, tuple)):
        return None
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        return None
    return array if array.dtype.kind in "biufc" else None


def of_notebooks(tree: Path) -> Iterator[tuple[str, object]]:
    """The numbers of all notebooks, by the package that is installed beside this Python."""
    os.environ["MPLBACKEND"] = "agg"
    for page in sorted((tree / "docs" / "notebooks").glob("*.md")):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(tree / "scenarios", Path(folder) / "scenarios")
            place = Path(folder) / "docs" / "notebooks"
            place.mkdir(parents=True)
            with contextlib.chdir(place):
                yield from ((f"notebooks/{page.stem}/{name}", value) for name, value in of_notebook(page))


def record(tree: Path) -> Numbers:
    """All numbers of a tree by name."""
    return {name: np.asarray(value) for of in (of_scenarios, of_notebooks) for name, value in of(tree)}


def difference(before: np.ndarray, after: np.ndarray) -> str | None:
    """How two arrays differ; None where all bits are the same."""
    if before.dtype.kind == after.dtype.kind == "U":
        return None if np.array_equal(before, after) else text_difference(str(before), str(after))
    if before.dtype != after.dtype or before.shape != after.shape:
        return f"{before.dtype} {before.shape} became {after.dtype} {after.shape}"
    if before.tobytes() == after.tobytes():
        return None
    if before.dtype.kind not in "fc":
        return "other numbers"
    missing = np.isnan(before) != np.isnan(after)
    if missing.any():
        return f"{missing.sum()} of {missing.size} are NaN in one of them"
    off, largest = np.nanmax(np.abs(after - before)), np.nanmax(np.abs(before))
    changed = np.count_nonzero(before.view(np.uint8) != after.view(np.uint8))
    return f"up to {off:.1e}, where the largest is {largest:.3e} ({changed} bytes)"


def text_difference(before: str, after: str) -> str:
    """The first line in which two texts differ."""
    lines = itertools.zip_longest(before.splitlines(), after.splitlines(), fillvalue="")
    first, now = next((pair for pair in lines if pair[0] != pair[1]), ("", ""))
    return f"{first!r} became {now!r}"


def compare(before: Numbers, after: Numbers) -> list[str]:
    """What differs, one line each."""
    lines = [f"{name}: only before" for name in before.keys() - after.keys()]
    lines += [f"{name}: only after" for name in after.keys() - before.keys()]
    both = before.keys() & after.keys()
    found = ((name, difference(before[name], after[name])) for name in both)
    return sorted(lines + [f"{name}: {how}" for name, how in found if how])


def load(file: str) -> Numbers:
    with np.load(file) as data:
        return dict(data)


def main() -> None:
    match sys.argv[1:]:
        case ["record", tree, file]:
            numbers = record(Path(tree).resolve())
            np.savez_compressed(file, **numbers)
            print(f"{len(numbers)} arrays and texts in {file}")
        case ["compare", one, other]:
            before, after = load(one), load(other)
            different = compare(before, after)
            print("\n".join(different))
            print(f"{len(different)} of {len(before)} differ")
            sys.exit(1 if different else 0)
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
