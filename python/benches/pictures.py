"""What the pictures of short scenarios cost beside their tasks: python pictures.py PROGRAM

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


def least(command: list[str]) -> float:
    """The least CPU milliseconds of a command."""
    times = []
    for _ in range(RUNS):
        begun = children()
        subprocess.run(command, check=True)
        times.append(1e3 * (children() - begun))
    return min(times)


def main() -> None:
    """Prints the milliseconds of each task and of its pictures."""
    program = sys.argv[1]
    print(f"{'ms of CPU time':16} {'task':>6} {'SVG':>6} {'SVG and PNG':>12} {'number':>7}")
    with tempfile.TemporaryDirectory() as folder:
        for name in SHORT:
            results = Path(folder, name)
            run = [program, "run", str(SCENARIOS / f"{name}.toml"), "--quiet", "-o", str(results)]
            task, svg, both = (
                least([*run, *options])
                for options in (["--no-figures"], ["--figures", "svg"], ["--figures", "svg,png"])
            )
            number = len(list(results.glob("*.svg")))
            print(f"{name:16} {task:6.1f} {svg - task:6.1f} {both - task:12.1f} {number:7}")


if __name__ == "__main__":
    main()
