"""What the pictures of short scenarios cost beside their tasks: python pictures.py PROGRAM [SCENARIO…]

Times are CPU times of `asperity run`, with and without pictures, the least of several runs.
"""

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

SCENARIOS = Path(__file__).parents[2] / "scenarios"
SHORT = (
    "fig2",
    "identical",
    "compared",
    "commensurate",
    "stick-slip-reset",
    "imposed-force",
    "quenched",
    "smooth-sliding",
    "spectrum",
)
RUNS = 9


def children() -> float:
    """The CPU seconds that processes which have ended took."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def milliseconds(command: list[str]) -> float:
    """The CPU milliseconds of a command."""
    begun = children()
    subprocess.run(command, check=True)
    return 1e3 * (children() - begun)


def main() -> None:
    """Prints the milliseconds of each task and of its pictures."""
    program, *names = sys.argv[1:]
    head = ("task", "SVG", "/task", "SVG+PNG", "/task", "number")
    print(f"{'ms of CPU time':16}", *(f"{name:>8}" for name in head))
    with tempfile.TemporaryDirectory() as folder:
        for name in names or SHORT:
            results = Path(folder, name)
            run = [program, "run", str(SCENARIOS / f"{name}.toml"), "--quiet", "-o", str(results)]
            # In turn, so that other work on the machine slows all three.
            kinds = (["--no-figures"], ["--figures", "svg"], ["--figures", "svg,png"])
            times = [[milliseconds([*run, *options]) for options in kinds] for _ in range(RUNS)]
            task, svg, both = map(min, zip(*times, strict=True))
            number = len(list(results.glob("*.svg")))
            row = (task, svg - task, svg / task - 1.0, both - task, both / task - 1.0)
            print(f"{name:16}", *(f"{value:8.2f}" for value in row), f"{number:8}")


if __name__ == "__main__":
    main()
