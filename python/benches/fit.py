"""Fits of four numbers of contacts to a simulated curve, beside curve_fit of SciPy over the same package.

python fit.py. Both find mean and width of the thresholds, the number of contacts and an offset from the same
first values, with independent errors, in turns in one run. Times are CPU times. The mean that each finds is
printed with its error, and how many of its errors it is off. The fit with the noise of contacts frees the
stiffness in place of the offset, since it finds the number of contacts from the noise. The last rows have no
counterpart.
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


def simulated(points: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions up to X = 6 and the force of 2000 contacts, followed one by one."""
    pull = asp.Ensemble(TRUE, size=2000, seed=3).pull(6.0, points + 1)
    return np.asarray(pull.position[1:]), np.asarray(pull.force[1:])


def by_curve_fit(position: NDArray[np.float64], force: NDArray[np.float64]) -> tuple[float, float]:
    """The mean threshold and its error by `curve_fit`."""

    def expected(x: NDArray[np.float64], mean: float, std: float, count: float, offset: float) -> Any:
        contacts = asp.Contacts(asp.Gaussian(mean, std), REFORMING, count=count)
        return asp.MasterEquation(contacts).pull(6.0)(x) + offset

    values, covariance = curve_fit(expected, position, force, p0=(0.9, 0.2, 1500.0, 0.0))
    return float(values[0]), float(np.sqrt(covariance[0, 0]))


def by_fit(position: NDArray[np.float64], force: NDArray[np.float64], **options: Any) -> tuple[float, float]:
    """The mean threshold and its error by `asperity.fit`."""
    mean = asp.fit(GUESS, position, force, **options).params["thresholds.mean"]
    return mean.value, mean.error


def timed(run: Callable[[], Any]) -> tuple[float, Any]:
    """CPU milliseconds and the result."""
    begun = time.process_time()
    result = run()
    return 1e3 * (time.process_time() - begun), result


def steady() -> float:
    """The error of the mean threshold from 10 001 readings of steady sliding."""
    pull = asp.Ensemble(TRUE, size=2000, seed=3).pull(460.0, 11_501)
    found = asp.fit_steady(GUESS, 0.04, pull.force[1500:], free=NOISY, reading=0.0)
    return found.params["thresholds.mean"].error


def main() -> None:
    position, force = simulated(2000)
    runs = {
        "asperity.fit, independent errors": lambda: by_fit(position, force, free=WHITE, noise="white"),
        "scipy.optimize.curve_fit": lambda: by_curve_fit(position, force),
        "asperity.fit, noise of contacts": lambda: by_fit(position, force, free=NOISY),
    }
    turns = [{name: timed(run) for name, run in runs.items()} for _ in range(TURNS)]
    print("2000 readings, four numbers: CPU milliseconds, mean threshold (1 is right)")
    for name in runs:
        value, error = turns[0][name][1]
        cost = statistics.median(turn[name][0] for turn in turns)
        print(f"  {name:<34} {cost:9.1f}   {value:.5f} ± {error:.5f}, off by {abs(value - 1) / error:.1f}")
    solution = statistics.median(
        timed(lambda: asp.MasterEquation(TRUE).pull(6.0)(position))[0] for _ in range(20)
    )
    print(f"  {'one solution':<34} {solution:9.1f}")
    position, force = simulated(600)
    print("others: CPU milliseconds")
    print(
        f"  600 readings, noise of contacts    {timed(lambda: by_fit(position, force, free=NOISY))[0]:9.1f}"
    )
    position, force = simulated(300)
    estimates = asp.fit(GUESS, position, force, free=NOISY)
    print(f"  300 readings, free form            {timed(estimates.free_form)[0]:9.1f}")
    print(f"  10 001 readings of steady sliding  {timed(steady)[0]:9.1f}")
    drawn = timed(lambda: estimates.sample(draws=1000, chains=4))[0]
    print(f"  300 readings, 4 × 1000 draws       {drawn:9.1f}")


if __name__ == "__main__":
    main()
