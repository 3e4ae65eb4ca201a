"""Parameter sweeps: the values of single runs along axes, on any executor, and nothing computed twice."""

import math
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest
from test_results import COMMAND, ROOT

TEXT = """
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
pull = { distance = 3.0, points = 31 }
"""
OVER = {
    "contacts.thresholds.gaussian.std": [0.2, 0.1],
    "contacts.count": {"from": 1.0, "to": 100.0, "points": 3, "scale": "log"},
}
KEEP = ["static_friction.force", "kinetic_friction", {"variable": "force", "at": [0.0, 0.55, 1.0, 9.0]}]


def swept(**more: Any) -> Any:
    pytest.importorskip("xarray")
    return asp.sweep(TEXT, OVER, KEEP, **more)


def test_cases_are_single_runs() -> None:
    data = swept()
    assert dict(data.sizes) == {"contacts_thresholds_gaussian_std": 2, "contacts_count": 3, "position": 4}
    for std in (0.1, 0.2):
        for count in (1.0, 10.0, 100.0):
            one = asp.run(TEXT, {"contacts.thresholds.gaussian.std": std, "contacts.count": count})
            case = data.sel(contacts_thresholds_gaussian_std=std, contacts_count=count)
            assert float(case.static_friction_force) == one.summary["static_friction"]["force"]
            assert float(case.kinetic_friction) == one.kinetic_friction
            assert float(case.accuracy) == one.summary["accuracy"]
            # Points at 0 and 1, the mean of two, and one beyond the pull.
            force = [one["force"][0], 0.5 * (one["force"][5] + one["force"][6]), one["force"][10]]
            # 0.55 lies half-way between two points up to rounding.
            np.testing.assert_allclose(case.force[:3], force, rtol=1e-14)
            assert np.isnan(case.force[3])
    assert data.kinetic_friction.attrs["units"] == "1"
    assert data.attrs["version"] == asp.__version__


# Newer versions of Python warn of forks where there are threads.
@pytest.mark.filterwarnings("ignore:.*multi-threaded:DeprecationWarning")
@pytest.mark.parametrize("executor", [ThreadPoolExecutor, ProcessPoolExecutor, "loky"])
def test_executors_find_the_same(executor: Any) -> None:
    if executor == "loky":
        executor = pytest.importorskip("loky").ProcessPoolExecutor
    expected = swept()
    with executor(2) as pool:
        assert swept(executor=pool).identical(expected)
    assert swept(threads=1).identical(expected)


def test_a_folder_is_that_of_the_command(tmp_path: Path) -> None:
    """What one of the two has stored, the other one does not compute."""
    expected = swept()
    keep = '["static_friction.force", "kinetic_friction", { variable = "force", at = [0.0, 0.55, 1.0, 9.0] }]'
    over = (
        '"contacts.thresholds.gaussian.std" = [0.2, 0.1]\n'
        '"contacts.count" = { from = 1.0, to = 100.0, points = 3, scale = "log" }\n'
    )
    file = tmp_path / "swept.toml"
    file.write_text(f"{TEXT}[sweep]\nkeep = {keep}\n[sweep.over]\n{over}", encoding="utf-8")
    results = tmp_path / "results"
    command = [*COMMAND, "sweep", str(file), "-o", str(results), "--quiet"]
    subprocess.run([*command, "--part", "1/2"], check=True, cwd=ROOT)
    (store,) = tmp_path.glob("results.sweep-*")
    before = {path.name for path in store.glob("*.cases")}

    class Counting(ThreadPoolExecutor):
        cases = 0

        def submit(self, call: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            self.cases += len(args[1])
            return super().submit(call, *args, **kwargs)

    with Counting(1) as pool:
        data = asp.sweep(file, executor=pool, folder=results)
        assert pool.cases == 3
        assert asp.sweep(file, executor=pool, folder=results).identical(data)
        assert pool.cases == 3
    assert before
    assert data.drop_attrs().identical(expected.drop_attrs())
    written = (results / "sweep.nc").read_bytes()
    subprocess.run([*command, "--resume", "--no-figures"], check=True, cwd=ROOT)
    assert (results / "sweep.nc").read_bytes() == written
    subprocess.run([*COMMAND, "plot", str(results), "--figures", "svg"], check=True, cwd=ROOT)
    assert (results / "kinetic_friction.svg").stat().st_size > 1000


def test_an_interrupted_sweep_is_continued(tmp_path: Path) -> None:
    class Failing(ThreadPoolExecutor):
        sent = 0

        def submit(self, call: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            self.sent += 1
            if self.sent > 1:
                raise OSError("the machine is gone")
            return super().submit(call, *args, **kwargs)

    expected = swept()
    folder = tmp_path / "results"

    def last() -> None:
        with Failing(1) as pool:
            pool.sent = 0
            swept(executor=pool, folder=folder)

    with pytest.raises(OSError, match="the machine is gone"):
        last()
    assert swept(folder=folder).identical(expected)


# How often a function was called; what a function encloses would be part of what identifies it.
CALLS: list[float] = []


def test_functions_are_swept(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    CALLS.clear()

    def found(contacts: asp.Contacts, distance: float) -> dict[str, float | str]:
        CALLS.append(distance)
        if distance < 0.0:
            raise ValueError("backwards")
        force = asp.MasterEquation(contacts).pull(distance).force[-1]
        return {"force": float(force), "kind": "far" if distance > 1.0 else "near"}

    contacts = [asp.Contacts(asp.Gaussian(1.0, std)) for std in (0.1, 0.2)]
    over = {"contacts": contacts, "distance": [0.5, 3.0, -1.0]}
    data = asp.sweep(found, over, folder=tmp_path / "mine")
    assert data.force.dims == ("contacts", "distance")
    assert float(data.force[1, 1]) == asp.MasterEquation(contacts[1]).pull(3.0).force[-1]
    assert data.kind.values.tolist() == [["near", "far", ""]] * 2
    assert np.isnan(data.force.values[:, 2]).all()
    assert data.failure.values[0].tolist() == ["", "", "ValueError: backwards"]
    assert len(CALLS) == 6
    again = asp.sweep(found, over, folder=tmp_path / "mine")
    assert len(CALLS) == 6
    assert again.identical(data)
    assert asp.sweep(lambda x: 2.0 * x, {"x": np.array([1.0, 2.0])})["value"].values.tolist() == [2.0, 4.0]


def test_replicas_have_seeds_of_their_own() -> None:
    pytest.importorskip("xarray")
    text = TEXT + "ensemble = { size = 100, seed = 5 }\nsweep.repeat = 3\n"
    at = {"variable": "ensemble_force", "at": [1.0]}
    data = asp.sweep(text, keep=[at])
    for replica in range(3):
        one = asp.run(TEXT, {"ensemble.size": 100, "ensemble.seed": 5 + replica})
        assert float(data.ensemble_force.sel(repeat=replica)[0]) == one["ensemble_force"][10]


@pytest.mark.parametrize(
    ("over", "keep", "text"),
    [
        ({"contacts.cuont": [1.0]}, ["kinetic_friction"], r"contacts\.cuont: expected .* got \"cuont\""),
        ({"contacts.count": []}, ["kinetic_friction"], "expected one value or more, got an empty list"),
        ({"contacts.count": [np.nan]}, ["kinetic_friction"], "expected a finite number, got NaN"),
        ({"title": ["a"]}, ["kinetic_friction"], "expected a key that the results depend on"),
        ({"contacts.count": [1.0, -1.0]}, ["kinetic_friction"], r"expected .* got -1"),
        ({"contacts.count": [1.0]}, ["nothing"], r'keep\.0: expected one of .* got "nothing"'),
        (
            {
                key: {"from": 1.0, "to": 2.0, "points": 1000}
                for key in ("contacts.count", "contacts.stiffness", "pull.distance")
            },
            ["kinetic_friction"],
            "got 1e9 cases",
        ),
    ],
)
def test_wrong_sweeps_are_refused(tmp_path: Path, over: Any, keep: Any, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        asp.sweep(TEXT, over, keep, folder=tmp_path / "results")
    assert not list(tmp_path.iterdir())


def test_curves_beyond_the_memory_are_refused(tmp_path: Path) -> None:
    over = {"contacts.count": {"from": 1.0, "to": 2.0, "points": 1_000_000}}
    # 8 TB.
    keep = [{"variable": "force", "at": {"from": 0.0, "to": 3.0, "points": 1_000_000}}]
    with pytest.raises(MemoryError, match="asperity sweep writes them to a file"):
        asp.sweep(TEXT, over, keep, folder=tmp_path / "results")
    assert not list(tmp_path.iterdir())


def test_a_sweep_is_no_run() -> None:
    with pytest.raises(ValueError, match=r"sweep: expected .*sweep\(\) in Python"):
        asp.run(TEXT, {"sweep.over": {"contacts.count": [1.0]}, "sweep.keep": ["kinetic_friction"]})


# Cases of some ms, and a second of work in all.
MAP = {
    "contacts.thresholds.gaussian.std": {"from": 0.05, "to": 0.4, "points": 15},
    "contacts.count": {"from": 1.0, "to": 10.0, "points": 16},
}


# Dask and what it uses warn of what they do themselves.
@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_finds_the_same_though_a_worker_is_killed(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    distributed = pytest.importorskip("distributed")
    text = TEXT + "ensemble.size = 20000\n"
    keep: list[Any] = ["kinetic_friction", {"variable": "ensemble_force", "at": [1.0, 2.0]}]
    expected = asp.sweep(text, MAP, keep)
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    begun = threading.Event()
    with (
        distributed.LocalCluster(**options, local_directory=str(tmp_path)) as cluster,
        distributed.Client(cluster) as client,
    ):
        victim = next(iter(client.run(os.getpid).values()))

        def kill() -> None:
            # After the first cases are back, in the middle of the others.
            begun.wait(60.0)
            time.sleep(0.3)
            os.kill(victim, 9)

        killer = threading.Thread(target=kill)
        killer.start()
        data = asp.sweep(
            text,
            MAP,
            keep,
            executor=client.get_executor(),
            folder=tmp_path / "results",
            progress=lambda _: begun.set(),
        )
        killer.join()
    assert data.identical(expected)


@pytest.mark.skipif(sys.platform == "win32", reason="no wheel holds the MPI library of Windows")
def test_the_script_of_the_page_finds_the_same_with_mpi(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("mpi4py")
    page = (ROOT / "docs/how-to/cluster.md").read_text(encoding="utf-8")
    (script,) = (block for block in page.split("```") if "MPIPoolExecutor" in block)
    (tmp_path / "sweep.py").write_text(script.removeprefix("text\n"), encoding="utf-8")
    keep = 'keep = ["kinetic_friction", { variable = "force", at = [0.55, 1.0] }]'
    over = 'over = { "contacts.count" = [1.0, 10.0], "contacts.thresholds.gaussian.std" = [0.1, 0.2, 0.3] }'
    (tmp_path / "map.toml").write_text(f"{TEXT}[sweep]\n{keep}\n{over}\n", encoding="utf-8")
    expected = asp.sweep(tmp_path / "map.toml")
    # One process sends cases, and two compute them.
    start = [str(Path(sys.executable).with_name("mpiexec")), "-n", "3", sys.executable]
    subprocess.run([*start, "-m", "mpi4py.futures", "sweep.py"], check=True, cwd=tmp_path, timeout=120)
    # The folder holds all of the cases: nothing is computed again.
    pool = Unused()
    assert asp.sweep(tmp_path / "map.toml", executor=pool, folder=tmp_path / "map").identical(expected)


class Unused(Executor):
    """An executor to which nothing may be sent."""

    def submit(self, call: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        raise AssertionError("a case is computed again")


def test_functions_that_differ_in_anything_are_not_taken_for_each_other(tmp_path: Path) -> None:
    pytest.importorskip("xarray")

    def scaled(factor: float) -> Callable[..., float]:
        return lambda x: factor * x

    class Scale:
        def __init__(self, factor: float) -> None:
            self.factor = factor

        def apply(self, x: float) -> float:
            return self.factor * x

    # The instructions of each pair are the same, and so are the names.
    pairs: list[tuple[Callable[..., float], Callable[..., float]]] = [
        (lambda x: math.sin(x), lambda x: math.cos(x)),
        (scaled(2.0), scaled(3.0)),
        (lambda x, factor=2.0: factor * x, lambda x, factor=3.0: factor * x),
        (Scale(2.0).apply, Scale(3.0).apply),
    ]
    for pair in pairs:
        for function in pair:
            found = asp.sweep(function, {"x": [0.5, 1.0]}, folder=tmp_path / "results")
            assert found["value"].values.tolist() == [function(0.5), function(1.0)]


def test_the_same_function_is_the_same_in_another_process(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    text = (
        "import asperity as asp, sys\n"
        "called = 0\n"
        "def f(x):\n"
        "    global called\n"
        "    called += 1\n"
        "    return max([x], key=lambda value: value if 'a' in {'a', 'b', 'c'} else 0.0)\n"
        "asp.sweep(f, {'x': [1.0, 2.0]}, folder='results')\n"
        "print(called)\n"
    )
    script = tmp_path / "script.py"
    script.write_text(text, encoding="utf-8")
    calls = [
        subprocess.run(
            [sys.executable, "-P", str(script)],
            check=True,
            cwd=tmp_path,
            env={**os.environ, "PYTHONHASHSEED": seed},
            stdout=subprocess.PIPE,
            text=True,
        ).stdout.strip()
        for seed in ("1", "2")
    ]
    assert calls == ["2", "0"]
