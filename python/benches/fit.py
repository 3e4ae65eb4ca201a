"""The page of what fits cost, beside curve_fit of SciPy over the same package: python fit.py > fits.md.

Both find mean and width of the thresholds, the number of contacts and an offset from the same first values,
with independent errors, in turns in one run. The fits with the noise of contacts free the stiffness in place
of the offset, since they find the number of contacts from the noise. The rows below have no counterpart.
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

REFORMING = asp.Gaussian(0.1, 0.03)
TRUE = asp.Contacts(asp.Gaussian(1.0, 0.12), REFORMING, count=2000.0)
GUESS = asp.Contacts(asp.Gaussian(0.9, 0.2), REFORMING, count=1500.0)
WHITE = ("thresholds.mean", "thresholds.std", "count", "offset")
NOISY = ("thresholds.mean", "thresholds.std", "count", "stiffness")
TURNS = 5
# Solutions of the master equation that a fit of four numbers with independent errors may take.
MOST = 12

HEAD = """\
<!-- Written by `make fits`: change python/benches/fit.py instead. -->
# Cost of fits

What fits from Python cost, in turns in one call of `make fits`: medians of five runs, or of one for the last
three rows, on the machine that made this page. The curves are those of 2000 single contacts to X = 6, and
four numbers are free. `scipy.optimize.curve_fit` fits the same numbers by the same solutions of the master
equation, with derivatives by differences. CPU time counts all threads, of two cores.

| fit | CPU, ms | elapsed, ms | solutions | mean threshold, 1 is right |
| --- | ---: | ---: | ---: | --- |"""

Curve = tuple[NDArray[np.float64], NDArray[np.float64]]


def simulated(points: int) -> Curve:
    """Positions up to X = 6 and the force of 2000 contacts, followed one by one."""
    pull = asp.Ensemble(TRUE, size=2000, seed=3).pull(6.0, points + 1)
    return np.asarray(pull.position[1:]), np.asarray(pull.force[1:])


class Found:
    """The mean threshold with its error, and the solutions that it took."""

    def __init__(self, mean: float, error: float, solutions: int | None = None) -> None:
        self.mean, self.error, self.solutions = mean, error, solutions

    def __str__(self) -> str:
        return f"{self.mean:.5f} ± {self.error:.5f}, off by {abs(self.mean - 1) / self.error:.1f} errors"


def by_curve_fit(curve: Curve) -> Found:
    """The mean threshold by `curve_fit`."""
    solutions = 0

    def expected(x: NDArray[np.float64], mean: float, std: float, count: float, offset: float) -> Any:
        nonlocal solutions
        solutions += 1
        contacts = asp.Contacts(asp.Gaussian(mean, std), REFORMING, count=count)
        return asp.MasterEquation(contacts).pull(6.0)(x) + offset

    values, covariance = curve_fit(expected, *curve, p0=(0.9, 0.2, 1500.0, 0.0))
    return Found(float(values[0]), float(np.sqrt(covariance[0, 0])), solutions)


def by_fit(curve: Curve, **options: Any) -> Found:
    """The mean threshold by `asperity.fit`."""
    fit = asp.fit(GUESS, *curve, **options)
    mean = fit.params["thresholds.mean"]
    return Found(mean.value, mean.error, fit.solutions)


def timed(run: Callable[[], Any]) -> tuple[float, float, Any]:
    """CPU and elapsed milliseconds, and the result."""
    cpu, wall = time.process_time(), time.perf_counter()
    result = run()
    return 1e3 * (time.process_time() - cpu), 1e3 * (time.perf_counter() - wall), result


def row(name: str, runs: list[tuple[float, float, Any]]) -> None:
    """A line of the table."""
    cpu, wall = (statistics.median(run[k] for run in runs) for k in (0, 1))
    found = runs[0][2]
    reported = isinstance(found, Found)
    solutions = found.solutions if reported and found.solutions else "–"
    print(f"| {name} | {cpu:.1f} | {wall:.1f} | {solutions} | {found if reported else '–'} |", flush=True)


def steady() -> Found:
    """The fit to 10 000 readings of steady sliding."""
    pull = asp.Ensemble(TRUE, size=2000, seed=3).pull(460.0, 11_501)
    found = asp.fit_steady(GUESS, 0.04, pull.force[1501:], free=NOISY, reading=0.0)
    mean = found.params["thresholds.mean"]
    return Found(mean.value, mean.error, found.solutions)


def main() -> None:
    few, some, many = (simulated(points) for points in (300, 600, 2000))
    runs = {
        "independent errors, 2000 readings": lambda: by_fit(many, free=WHITE, noise="white"),
        "the same by `scipy.optimize.curve_fit`": lambda: by_curve_fit(many),
        "noise of contacts, 600 readings": lambda: by_fit(some, free=NOISY),
        "noise of contacts, 2000 readings": lambda: by_fit(many, free=NOISY),
        "one solution, 2000 positions": lambda: asp.MasterEquation(TRUE).pull(6.0)(many[0]),
    }
    turns = [{name: timed(run) for name, run in runs.items()} for _ in range(TURNS)]
    print(HEAD)
    for name in runs:
        row(name, [turn[name] for turn in turns])
    solutions = turns[0]["independent errors, 2000 readings"][2].solutions
    assert solutions <= MOST, f"{solutions} solutions"
    estimates = asp.fit(GUESS, *few, free=NOISY)
    row("steady sliding, 10 000 readings (simulation included)", [timed(steady)])
    row("thresholds of free form with their strength, 300 readings", [timed(estimates.free_form)])
    row("4 × 1000 draws, 300 readings", [timed(lambda: estimates.sample(draws=1000, chains=4))])
    print("\nA test requires that the first of these takes no more than 12 solutions.")


if __name__ == "__main__":
    main()
