"""What a call from Python costs, beside what Rust computes in it: python overhead.py

A call of a function that takes some nanoseconds in Rust is all overhead. Times are CPU times, the least of
many repeats; those of imports are of processes of their own, after NumPy.
"""

import statistics
import subprocess
import sys
import time
import timeit

import asperity as asp
import numpy as np

CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.05))
LAW = asp.Gaussian(1.0, 0.05)
THEORY = asp.MasterEquation(CONTACTS, asp.Gaussian(0.1, 0.025))
PULL = THEORY.pull(distance=20.0, points=2001)
FIVE = np.linspace(0.0, 2.0, 5)

CALLS = {
    "law.pdf(1.0)": lambda: LAW.pdf(1.0),
    "law.pdf of 5 numbers": lambda: LAW.pdf(FIVE),
    "Gaussian(1.0, 0.05)": lambda: asp.Gaussian(1.0, 0.05),
    "Contacts(law)": lambda: asp.Contacts(LAW),
    "pull(5.0)": lambda: PULL(5.0),
    "pull.force": lambda: PULL.force,
    "pull.kinetic_friction": lambda: PULL.kinetic_friction,
}


def least(call: object) -> float:
    """The least seconds that a call takes."""
    timer = timeit.Timer("call()", globals={"call": call}, timer=time.process_time)
    number, _ = timer.autorange()
    return min(timer.repeat(20, number)) / number


IMPORT = "import numpy, time; t = time.process_time(); import asperity; print(time.process_time() - t)"


def importing() -> float:
    """Seconds that an import takes in a process that has NumPy."""
    line = [sys.executable, "-P", "-c", IMPORT]
    return float(subprocess.run(line, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    nothing = least(lambda: None)
    print("microseconds a call, less that of an empty one (wanted < 5)")
    for name, call in CALLS.items():
        print(f"  {name:<24} {1e6 * (least(call) - nothing):8.3f}")
    print("milliseconds (wanted < 2)")
    print(f"  Fig. 2, 2001 points      {1e3 * least(lambda: THEORY.pull(20.0, 2001)):8.3f}")
    print("milliseconds, median of ten (wanted < 50)")
    print(f"  import, beyond NumPy's   {1e3 * statistics.median(importing() for _ in range(10)):8.3f}")


if __name__ == "__main__":
    main()
