"""Parameter sweeps in Python, on this machine or on any executor, with the store of `asperity sweep`."""

import hashlib
import itertools
import math
import re
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity._arguments import flag, table, whole, wrong
from asperity._core import Description, _Sweep, _sweep_cases, scenario as scenario_of
from asperity._identity import identity

if TYPE_CHECKING:
    from os import PathLike
    from typing import Self, TypeAlias

    from xarray import Dataset

    _Scenario: TypeAlias = str | PathLike[str] | Mapping[str, Any]
    _Progress: TypeAlias = Callable[[float], object] | bool | None
    # A number of a case, with what its function has found or why it failed.
    _Found: TypeAlias = tuple[int, dict[str, float | str] | None, str | None]

# The least work that is sent to a worker at once, in seconds.
LEAST = 0.2
# The work that is aimed at, so that the cost of a batch is small beside it.
AIM = 0.5
# Batches that wait for a worker, for each that runs.
AHEAD = 2
# The number of workers of an executor that does not report it.
WORKERS = 8
# The largest number of cases, as in a scenario.
MOST = 10_000_000
# Names that the data set has for itself.
TAKEN = {"failure", "scenario"}


def sweep(
    scenario: "_Scenario | Description | Callable[..., Any]",
    over: Mapping[str, Any] | None = None,
    keep: Sequence[Any] | None = None,
    *,
    task: Mapping[str, Any] | None = None,
    executor: Executor | None = None,
    folder: "str | PathLike[str] | None" = None,
    threads: int | None = None,
    retry: bool = False,
    progress: "_Progress" = None,
) -> "Dataset":
    """Computes a scenario, a model or a function for all combinations of values.

    Parameters
    ----------
    scenario : str or PathLike or Mapping or Description or Callable
        A scenario as `run` takes it, with or without a table sweep; a model, of which `task` is computed; or
        a function, which is called with the names of `over` as keywords and returns a number, or numbers and
        texts by name.
    over : Mapping, optional
        Values by dotted key of the scenario, or by argument of the function: a list or an array, or for a
        scenario {"from": 0.1, "to": 10, "points": 21, "scale": "log"}. The last one runs fastest.
    keep : Sequence, optional
        What is kept of each case of a scenario: paths of the summary such as "static_friction.force", and
        variables on a common grid such as {"variable": "force", "at": [0.0, 0.5, 1.0]}.
    task : Mapping, optional
        Beside a model, the table of its task by name, such as {"pull": {"distance": 5.0}}; computed is the
        `asperity.scenario` of both.
    executor : concurrent.futures.Executor, optional
        What computes the cases: the executor of a Dask client (`client.get_executor()`), of mpi4py.futures,
        of loky or of the standard library. None for the threads of this process.
    folder : str or PathLike, optional
        The folder for the results. Cases are stored beside it as they come: the same call continues an
        interrupted sweep, also one of `asperity sweep`, and computes nothing that is there. A function is
        identified by its name, its code and that of what it wraps or encloses, by the values that it encloses
        or has as defaults or state, and by the global numbers, texts, arrays and descriptions that it reads.
        Global lists, dictionaries and other objects, and the code of what it calls, are not looked at.
    threads : int, optional
        Threads of this process, by default one per core for a scenario and one for a function; with an
        executor, those of each worker, by default one.
    retry : bool
        Whether cases in the folder that failed are computed again.
    progress : Callable or bool, optional
        As for `MasterEquation.pull`.

    Returns
    -------
    xarray.Dataset
        What was kept along the axes, which are coordinates. The axis of a key is named with _ for its dots. A
        case that failed is nan, with the reason in `failure`, and a warning.

    Raises
    ------
    ValueError
        For a scenario that is not valid at a corner of the axes, before anything is computed; for threads
        below 1, and for arguments of a function without values, with equal ones or of a name that is taken.
    TypeError
        For a function with a folder and values that cannot be pickled, by which it would be identified.
    FileExistsError
        For a folder that asperity did not make, or in which another sweep runs.
    MemoryError
        For curves of all cases that do not fit in memory; `asperity sweep` writes them to a file.

    Examples
    --------
    >>> import asperity as asp
    >>> scenario = {"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}, "pull": {"distance": 5.0}}
    >>> found = asp.sweep(
    ...     scenario,
    ...     {"contacts.thresholds.gaussian.std": [0.1, 0.2]},
    ...     ["kinetic_friction"],
    ... )
    >>> found.kinetic_friction.values.round(3)
    array([0.505, 0.52 ])
    """
    if isinstance(scenario, Description):
        if not task:
            raise ValueError('task: expected what is computed of a model, such as {"pull": {}}, got nothing')
        scenario = scenario_of(scenario, **task)  # type: ignore[arg-type]
    elif task is not None:
        raise TypeError(f"task: expected a model beside it, got {type(scenario).__name__}")
    threads, retry = None if threads is None else whole("threads", threads), flag("retry", retry)
    if threads is not None and threads < 1:
        raise ValueError(f"threads: expected 1 or more, got {threads}")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise wrong("executor", "an executor with the method submit", executor)
    if callable(scenario):
        if keep is not None:
            raise TypeError("keep: expected None beside a function, which returns what is kept")
        arguments = table("over", over or {}, "values by argument")
        return _told(_of_function(scenario, arguments, executor, folder, (threads, retry), progress))
    over = _in_order(scenario) if over is None else table("over", over, "values by dotted key")
    if keep is not None and (isinstance(keep, str) or not isinstance(keep, Iterable)):
        raise wrong("keep", "a list of what is kept", keep)
    with _Held(_Sweep.of_scenario(scenario, _table(over, keep), folder, retry)) as held:
        if executor is None:
            held.plan.compute(threads, progress=progress)
        else:
            _send(held, executor, threads or 1, progress)
        return _told(_dataset(held))


class _Held:
    """Holds a sweep of the core, and lets it go at the end.

    Its lock on the folder ends with it. The traceback of an error keeps the names of all functions that it
    went through, so that none of them may be that of the sweep: the same session could not continue it.
    """

    def __init__(self, plan: _Sweep) -> None:
        self._plans = [plan]

    @property
    def plan(self) -> _Sweep:
        """The sweep, to be used in place."""
        return self._plans[0]

    def __enter__(self) -> "Self":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._plans.clear()


def _send(held: _Held, executor: Executor, threads: int, progress: "_Progress") -> None:
    """Computes the cases of a scenario by an executor."""
    specification = held.plan.specification

    def submit(cases: list[int]) -> "Future[tuple[bytes, float]]":
        return executor.submit(_timed, specification, cases, threads)

    def add(found: bytes) -> None:
        held.plan.add(found)

    _collect(executor, held.plan.missing(), submit, add, _Shown(progress, held.plan.cases))


def _in_order(scenario: Any) -> Mapping[str, Any] | None:
    """The axes of a dictionary, in its order. The scenario checks what is no table of axes."""
    table = scenario.get("sweep") if isinstance(scenario, Mapping) else None
    over = table.get("over") if isinstance(table, Mapping) else None
    return over if isinstance(over, Mapping) else None


def _table(over: Mapping[str, Any] | None, keep: Sequence[Any] | None) -> dict[str, Any]:
    """The table sweep, as overrides of a scenario."""
    given: dict[str, Any] = {}
    if over is not None:
        # One after the other, in their order, instead of those that the scenario has.
        given["sweep.over"] = {}
        given |= {f'sweep.over."{key}"': values for key, values in over.items()}
    if keep is not None:
        given["sweep.keep"] = list(keep)
    return given


def _timed(specification: Any, cases: list[int], threads: int) -> tuple[bytes, float]:
    """What a worker does: the cases, and the time that they took."""
    begun = time.perf_counter()
    found = _sweep_cases(specification, cases, threads)
    return found, time.perf_counter() - begun


class _Shown:
    """The progress of a sweep whose cases come from an executor."""

    def __init__(self, wish: "_Progress", cases: int) -> None:
        if wish is True:
            from asperity._progress import bar

            wish = bar()
        self.call = wish if callable(wish) else None
        self.cases = cases

    def __call__(self, left: int) -> None:
        if self.call is not None:
            self.call(1.0 - left / self.cases)


def _collect(
    executor: Executor,
    missing: list[int],
    submit: Callable[[list[int]], "Future[tuple[Any, float]]"],
    add: Callable[[Any], None],
    shown: _Shown,
) -> None:
    """Sends batches of cases to the executor, and adds what comes back, in any order."""
    left, sent = len(missing), 0
    running: dict[Future[tuple[Any, float]], int] = {}
    # One case after the other at first, until it is known how long one takes.
    size = 1
    shown(left)
    try:
        while running or sent < len(missing):
            workers = _workers(executor)
            while sent < len(missing) and len(running) < AHEAD * workers:
                cases = missing[sent : sent + size]
                running[submit(cases)] = len(cases)
                sent += len(cases)
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                count = running.pop(future)
                found, seconds = future.result()
                add(found)
                left -= count
                each = max(seconds / count, 1e-6)
                # The last batches are shorter, so that all workers end together.
                fair = math.ceil((len(missing) - sent) / (AHEAD * workers))
                size = max(math.ceil(LEAST / each), min(math.ceil(AIM / each), fair))
            shown(left)
    except BaseException:
        for future in running:
            future.cancel()
        # What has come back meanwhile is kept.
        for future in running:
            if future.done() and not future.cancelled() and future.exception() is None:
                add(future.result()[0])
        raise


def _workers(executor: Executor) -> int:
    """The number of workers. Those of a Dask cluster come and go."""
    client = getattr(executor, "_client", None)
    if client is not None and callable(getattr(client, "nthreads", None)):
        return max(int(sum(client.nthreads().values())), 1)
    return int(getattr(executor, "_max_workers", None) or WORKERS)


def _dataset(held: _Held) -> "Dataset":
    try:
        from xarray import Dataset
    except ImportError as error:
        raise ImportError("sweep() needs xarray: pip install 'asperity[xarray]'") from error
    attributes, coordinates, variables = held.plan.finish()
    lengths = {name: len(values) for name, dimensions, values, _ in coordinates if dimensions == [name]}

    def shaped(found: Iterable[Any]) -> Iterator[tuple[str, Any]]:
        for name, dimensions, values, about in found:
            shape = [lengths[dimension] for dimension in dimensions]
            # Texts are objects, as xarray reads them from a file.
            array = np.asarray(values, dtype=object) if isinstance(values, list) else values
            yield name, (dimensions, array.reshape(shape), about)

    return Dataset(dict(shaped(variables)), dict(shaped(coordinates)), attributes)


def _told(found: "Dataset") -> "Dataset":
    """Warns of cases that failed."""
    if "failure" in found:
        reasons = found["failure"].values.ravel()
        failed = [reason for reason in reasons if reason]
        said = f"{len(failed)} of {len(reasons)} cases failed, the first with: {failed[0]}"
        warnings.warn(said, RuntimeWarning, stacklevel=3)
    return found


def _of_function(
    function: Callable[..., Any],
    over: Mapping[str, Any],
    executor: Executor | None,
    folder: "str | PathLike[str] | None",
    how: tuple[int | None, bool],
    progress: "_Progress",
) -> "Dataset":
    threads, retry = how
    axes = {name: _values(name, values) for name, values in over.items()}
    if not axes:
        raise ValueError("over: expected one argument of the function or more, got none")
    count = math.prod(len(values) for values in axes.values())
    if count > MOST:
        raise ValueError(f"over: expected {MOST} cases or fewer, got {count}")
    text = identity(function, axes) if folder is not None else ""
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    labels = [(name, _labels(values)) for name, values in axes.items()]
    with _Held(_Sweep.of_function(digest, text, labels, folder, retry)) as held:
        if executor is not None:
            _call(held, function, axes, executor, progress)
        else:
            with ThreadPoolExecutor(threads or 1) as pool:
                _call(held, function, axes, pool, progress)
        return _dataset(held)


def _call(
    held: _Held,
    function: Callable[..., Any],
    axes: Mapping[str, list[Any]],
    executor: Executor,
    progress: "_Progress",
) -> None:
    """Computes the cases of a function by an executor."""
    places = list(itertools.product(*(range(len(values)) for values in axes.values())))

    def arguments(case: int) -> dict[str, Any]:
        return {name: values[place] for (name, values), place in zip(axes.items(), places[case], strict=True)}

    def submit(cases: list[int]) -> "Future[tuple[list[_Found], float]]":
        return executor.submit(_called, function, [(case, arguments(case)) for case in cases])

    def add(found: list["_Found"]) -> None:
        for i, (case, values, failure) in enumerate(found):
            held.plan.add_case(case, values, failure, flush=i + 1 == len(found))

    _collect(executor, held.plan.missing(), submit, add, _Shown(progress, held.plan.cases))


def _called(
    function: Callable[..., Any], cases: list[tuple[int, dict[str, Any]]]
) -> tuple[list["_Found"], float]:
    """What a worker does with a function. A case that fails is a value."""
    begun = time.perf_counter()
    found: list[_Found] = []
    for case, arguments in cases:
        try:
            found.append((case, _named(function(**arguments), arguments), None))
        except Exception as error:
            found.append((case, None, f"{type(error).__name__}: {error}"))
    return found, time.perf_counter() - begun


def _named(value: Any, arguments: Mapping[str, Any]) -> dict[str, float | str]:
    """What a function has found, by name."""
    if not isinstance(value, Mapping):
        value = {"result" if "value" in arguments else "value": value}
    for name in value:
        if not _may_be_named(name) or name in arguments:
            raise ValueError(f"expected results with names of their own, got {name!r}")
    return {name: found if isinstance(found, str) else float(found) for name, found in value.items()}


def _may_be_named(name: object) -> bool:
    """Whether a variable of the data set, and of its file, may have a name."""
    return isinstance(name, str) and bool(re.fullmatch(r"[^\W\d][^/\x00]*", name)) and name not in TAKEN


def _values(name: str, values: Any) -> list[Any]:
    if not _may_be_named(name):
        raise ValueError(f"over: expected names that are not taken, as arguments have, got {name!r}")
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise wrong(f"over.{name}", "a list or an array of values", values)
    found = list(values)
    if not found:
        raise ValueError(f"over.{name}: expected one value or more, got an empty list")
    if any(isinstance(value, float | np.floating) and not math.isfinite(value) for value in found):
        raise ValueError(f"over.{name}: expected finite numbers, got nan or inf")
    # Different objects may have the same text.
    can_be_equal = all(isinstance(value, str | int | float | np.number) for value in found)
    if can_be_equal and len(set(found)) < len(found):
        raise ValueError(f"over.{name}: expected values that differ, got the same twice")
    return found


def _labels(values: list[Any]) -> list[float] | list[str]:
    """Numbers as they are, other objects as text, and whole numbers that a float is not."""
    if all(isinstance(value, int | float | np.number) and float(value) == value for value in values):
        return [float(value) for value in values]
    return [str(value) for value in values]
