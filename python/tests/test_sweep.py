"""Parameter sweeps: the values of single runs along axes, on any executor, and nothing computed twice."""

import functools
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
from asperity import _sweep
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


def stopping(fraction: float) -> None:
    """The progress of a sweep that is interrupted."""
    raise KeyboardInterrupt


class Gone(ThreadPoolExecutor):
    """An executor whose machine is gone."""

    def submit(self, call: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        raise OSError("the machine is gone")


@pytest.mark.parametrize("executor", [None, Gone])
def test_a_sweep_is_continued_while_its_error_is_kept(tmp_path: Path, executor: Any) -> None:
    """A session keeps its last error, with all that its functions name."""
    expected = swept()
    folder = tmp_path / "results"
    with pytest.raises((KeyboardInterrupt, OSError)) as kept:
        swept(executor=executor and executor(1), folder=folder, progress=stopping)
    assert swept(folder=folder).identical(expected)
    del kept


@pytest.mark.parametrize("executor", [None, Gone])
def test_a_sweep_of_a_function_is_continued_while_its_error_is_kept(tmp_path: Path, executor: Any) -> None:
    pytest.importorskip("xarray")
    folder = tmp_path / "results"
    over = {"x": [4.0, 9.0]}

    def root(x: float) -> float:
        return math.sqrt(x)

    with pytest.raises((KeyboardInterrupt, OSError)) as kept:
        asp.sweep(root, over, executor=executor and executor(1), folder=folder, progress=stopping)
    assert asp.sweep(root, over, folder=folder)["value"].values.tolist() == [2.0, 3.0]
    del kept


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
    with pytest.warns(RuntimeWarning, match="2 of 6 cases failed, the first with: ValueError: backwards"):
        data = asp.sweep(found, over, folder=tmp_path / "mine")
    assert data.force.dims == ("contacts", "distance")
    assert float(data.force[1, 1]) == asp.MasterEquation(contacts[1]).pull(3.0).force[-1]
    assert data.kind.values.tolist() == [["near", "far", ""]] * 2
    assert np.isnan(data.force.values[:, 2]).all()
    assert data.failure.values[0].tolist() == ["", "", "ValueError: backwards"]
    assert len(CALLS) == 6
    with pytest.warns(RuntimeWarning, match="2 of 6 cases failed"):
        again = asp.sweep(found, over, folder=tmp_path / "mine")
    assert len(CALLS) == 6
    assert again.identical(data)
    assert asp.sweep(lambda x: 2.0 * x, {"x": np.array([1.0, 2.0])})["value"].values.tolist() == [2.0, 4.0]


# What a case reads that may not be there yet.
THERE: list[float] = []


@pytest.mark.parametrize("within_one_call", [False, True])
def test_failed_cases_are_computed_again(tmp_path: Path, within_one_call: bool) -> None:
    pytest.importorskip("xarray")
    folder = None if within_one_call else tmp_path / "results"
    THERE.clear()

    def root(x: float) -> dict[str, float]:
        if x not in THERE:
            raise OSError("not there yet")
        return {"root": math.sqrt(x)}

    over = {"x": [1.0, 4.0, 9.0]}
    THERE[:] = [1.0]
    with pytest.warns(RuntimeWarning, match="2 of 3 cases failed, the first with: OSError: not there yet"):
        asp.sweep(root, over, folder=folder)
    THERE[:] = [4.0]
    with pytest.warns(RuntimeWarning, match=f"{2 if within_one_call else 1} of 3 cases failed"):
        found = asp.sweep(root, over, folder=folder, retry=True)
    expected = [np.nan, 2.0, np.nan] if within_one_call else [1.0, 2.0, np.nan]
    np.testing.assert_array_equal(found["root"].values, expected)
    THERE[:] = [1.0, 4.0, 9.0]
    found = asp.sweep(root, over, folder=folder, retry=True)
    assert found["root"].values.tolist() == [1.0, 2.0, 3.0]
    assert "failure" not in found


@pytest.mark.parametrize(
    ("over", "kind", "message"),
    [
        ({"x": {"from": 0.1, "to": 1.0, "points": 4}}, TypeError, r"over\.x: expected a list .* got dict"),
        ({"x": "abc"}, TypeError, r"over\.x: expected a list or an array of values, got str"),
        ({"x": 1.0}, TypeError, r"over\.x: expected a list or an array of values, got float"),
        ({"x": np.array([np.nan], dtype=np.float32)}, ValueError, r"over\.x: expected finite numbers"),
        ({"x": [1, 2.0, 1.0]}, ValueError, r"over\.x: expected values that differ, got the same twice"),
        ({"failure": [1.0]}, ValueError, "over: expected names that are not taken, .* got 'failure'"),
        ({"a/b": [1.0]}, ValueError, "over: expected names that are not taken, .* got 'a/b'"),
        ([1.0], TypeError, "over: expected a mapping of values by argument, got list"),
    ],
)
def test_wrong_arguments_of_functions_are_refused(over: Any, kind: type[Exception], message: str) -> None:
    pytest.importorskip("xarray")
    with pytest.raises(kind, match=message):
        asp.sweep(lambda **_: 1.0, over)
    with pytest.raises(ValueError, match="threads: expected 1 or more, got 0"):
        asp.sweep(lambda x: x, {"x": [1.0]}, threads=0)


def test_more_threads_than_a_machine_has_cores_for_are_refused() -> None:
    pytest.importorskip("xarray")
    scenario = {"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}, "pull": {"points": 11}}
    with pytest.raises(ValueError, match="threads: expected a number from 1 to"):
        asp.sweep(
            scenario,
            over={"contacts.thresholds.gaussian.std": [0.1]},
            keep=["kinetic_friction"],
            threads=10**6,
        )


@pytest.mark.parametrize("name", ["x", "failure", "a/b", "", 1])
def test_a_result_with_a_name_that_is_taken_is_a_failure(tmp_path: Path, name: Any) -> None:
    pytest.importorskip("xarray")
    with pytest.warns(RuntimeWarning, match=f"1 of 2 cases failed, .* names of their own, got {name!r}"):
        found = asp.sweep(lambda x: {name if x > 1.0 else "y": x}, {"x": [1.0, 2.0]}, folder=tmp_path / "out")
    np.testing.assert_array_equal(found["y"].values, [1.0, np.nan])


def test_a_model_needs_a_task() -> None:
    model = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
    with pytest.raises(ValueError, match=r"task: expected what is computed of a model, .* got nothing"):
        asp.sweep(model, {"contacts.count": [1.0, 2.0]}, ["kinetic_friction"])


def test_objects_of_one_text_are_different_values() -> None:
    pytest.importorskip("xarray")

    class Box:
        def __init__(self, size: float) -> None:
            self.size = size

        def __str__(self) -> str:
            return "box"

    found = asp.sweep(lambda box: box.size, {"box": [Box(1.0), Box(2.0)]})
    assert found["value"].values.tolist() == [1.0, 2.0]


def test_an_argument_may_be_called_value_and_a_large_whole_number_is_a_word() -> None:
    pytest.importorskip("xarray")
    found = asp.sweep(lambda value: value**2, {"value": [1.0, 3.0]})
    assert found["result"].values.tolist() == [1.0, 9.0]
    large = asp.sweep(lambda seed: seed % 10, {"seed": [2**53, 2**53 + 1]})
    assert large["seed"].values.tolist() == [str(2**53), str(2**53 + 1)]


class Client:
    """A cluster that tells how many threads each worker has, as that of Dask does."""

    def __init__(self) -> None:
        self.workers = 20

    def nthreads(self) -> dict[str, int]:
        return {f"worker {number}": 2 for number in range(self.workers)}


def test_all_workers_of_a_cluster_have_work() -> None:
    executor: Any = Executor()
    executor._client = Client()
    assert _sweep._workers(executor) == 40
    executor._client.workers = 0
    assert _sweep._workers(executor) == 1
    assert _sweep._workers(ThreadPoolExecutor(3)) == 3
    assert _sweep._workers(Executor()) == _sweep.WORKERS


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


def wrapping(function: Callable[..., float]) -> Callable[..., float]:
    @functools.wraps(function)
    def called(*args: Any, **kwargs: Any) -> float:
        return function(*args, **kwargs)

    return called


def made(text: str, wrapper: Callable[..., Any] = lambda function: function, **names: Any) -> Any:
    """A function f of the text of a script, whose global names are these."""
    space = {"__name__": "script", "math": math, **names}
    exec(text, space)
    return wrapper(space["f"])


class Multiple:
    """A function with a factor of its objects, one of its class, and a number of calls."""

    shared = 1.0

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def __call__(self, x: float) -> float:
        return self.factor * self.shared * x


READING = "def f(x): return float((lambda: k * x)())"
DIFFERENT: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "lru_cache": (
        lambda: made("def f(x): return x + 1.0", functools.lru_cache),
        lambda: made("def f(x): return x + 2.0", functools.lru_cache),
    ),
    "wraps": (
        lambda: made("def f(x): return x + 1.0", wrapping),
        lambda: made("def f(x): return x + 2.0", wrapping),
    ),
    "function of partial": (
        lambda: made("def f(x, k): return k * x", lambda f: functools.partial(f, k=2.0)),
        lambda: made("def f(x, k): return k - x", lambda f: functools.partial(f, k=2.0)),
    ),
    "argument of partial": (
        lambda: made("def f(x, k): return k * x", lambda f: functools.partial(f, k=2.0)),
        lambda: made("def f(x, k): return k * x", lambda f: functools.partial(f, k=3.0)),
    ),
    "state of an object": (lambda: Multiple(2.0), lambda: Multiple(3.0)),
    "class of an object": (
        lambda: type("Multiple", (Multiple,), {"shared": 2.0})(2.0),
        lambda: type("Multiple", (Multiple,), {"shared": 3.0})(2.0),
    ),
    "number": (lambda: made(READING, k=2), lambda: made(READING, k=3)),
    "number alone": (lambda: made("f = lambda x: k", k=2), lambda: made("f = lambda x: k", k=3)),
    "array": (
        lambda: made("def f(x): return float(k[1] * x)", k=np.array([1.0, 2.0])),
        lambda: made("def f(x): return float(k[1] * x)", k=np.array([1.0, 3.0])),
    ),
    "model": (
        lambda: made("def f(x): return k.thresholds.mean() * x", k=asp.Contacts(asp.Gaussian(1.0, 0.1))),
        lambda: made("def f(x): return k.thresholds.mean() * x", k=asp.Contacts(asp.Gaussian(2.0, 0.1))),
    ),
    "called function": (
        lambda: made("def f(x): return k(x)", k=math.sin),
        lambda: made("def f(x): return k(x)", k=math.cos),
    ),
    "global of what is wrapped": (
        lambda: made(READING, functools.lru_cache, k=2),
        lambda: made(READING, functools.lru_cache, k=3),
    ),
}


@pytest.mark.parametrize("name", DIFFERENT)
def test_a_function_is_known_by_what_it_wraps_and_reads(tmp_path: Path, name: str) -> None:
    pytest.importorskip("xarray")
    one, other = DIFFERENT[name]
    x = [0.5, 1.0]
    for function in (one(), other()):
        found = asp.sweep(function, {"x": x}, folder=tmp_path / "results")
        assert found["value"].values.tolist() == [function(x=value) for value in x]
    # One that is made anew is the same.
    found = asp.sweep(one(), {"x": x}, executor=Unused(), folder=tmp_path / "results")
    assert found["value"].values.tolist() == [one()(x=value) for value in x]


def test_what_a_function_writes_does_not_identify_it(tmp_path: Path) -> None:
    """So that a session continues the sweep of a function that counts its calls."""
    pytest.importorskip("xarray")
    text = "def f(x):\n    global calls\n    calls += 1\n    log.append(x)\n    known[x] = x\n    return x\n"
    function = made(text, calls=0, log=[], known={})
    asp.sweep(function, {"x": [1.0, 2.0]}, folder=tmp_path / "results")
    assert function.__globals__["log"] == [1.0, 2.0]
    asp.sweep(function, {"x": [1.0, 2.0]}, executor=Unused(), folder=tmp_path / "results")


def test_a_function_that_encloses_itself_is_known(tmp_path: Path) -> None:
    pytest.importorskip("xarray")

    def factorial(x: float) -> float:
        return 1.0 if x < 1.0 else x * factorial(x - 1.0)

    data = asp.sweep(factorial, {"x": [3.0, 4.0]}, folder=tmp_path / "results")
    again = asp.sweep(factorial, {"x": [3.0, 4.0]}, executor=Unused(), folder=tmp_path / "results")
    assert data["value"].values.tolist() == again["value"].values.tolist() == [6.0, 24.0]


def test_a_function_that_cannot_be_identified_is_refused_with_a_folder(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    lock = threading.Lock()

    def locked(x: float) -> float:
        with lock:
            return x

    function = Multiple(2.0)
    function.lock = lock  # type: ignore[attr-defined]
    for one in (locked, function, functools.partial(locked)):
        with pytest.raises(TypeError, match=r"scenario: expected values that can be pickled.*, got lock"):
            asp.sweep(one, {"x": [1.0]}, folder=tmp_path / "results")
        assert not list(tmp_path.iterdir())
        assert asp.sweep(one, {"x": [1.0]})["value"].values[0] == one(1.0)
    with pytest.raises(TypeError, match=r"over\.x: expected values that can be pickled.*, got lock"):
        asp.sweep(lambda x: 1.0, {"x": [lock]}, folder=tmp_path / "results")
    # One that is only a global name is left out.
    function = made("def f(x):\n with k: return x", k=lock)
    assert asp.sweep(function, {"x": [1.0]}, folder=tmp_path / "results")["value"].values[0] == 1.0


# The ends of functions f that count their calls, and what is swept.
CALLED = {
    "set": "max([x], key=lambda value: value if 'a' in {'a', 'b', 'c'} else 0.0)\nfunction = f\n",
    "partial": "x\nfunction = functools.partial(f, more=2.0)\n",
    "lru_cache": "x\nfunction = functools.lru_cache(f)\n",
    "object": "x\nclass C:\n    def __call__(self, x):\n        return f(x)\nfunction = C()\n",
    "globals": "x\nlaw = asp.Gamma(1.0, 0.1)\nfunction = lambda x: f(x) * law.mean() * len(words)\n",
}


@pytest.mark.parametrize("name", CALLED)
def test_the_same_function_is_the_same_in_another_process(tmp_path: Path, name: str) -> None:
    pytest.importorskip("xarray")
    text = (
        "import asperity as asp, functools\n"
        "called, words = 0, {'a', 'b', 'c'}\n"
        "def f(x, more=1.0):\n"
        "    global called\n"
        "    called += 1\n"
        f"    return {CALLED[name]}"
        "asp.sweep(function, {'x': [1.0, 2.0]}, folder='results')\n"
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
