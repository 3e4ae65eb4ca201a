"""The pictures of the README and of the pages that scenarios draw.

    python .ci/figures.py check FOLDER
    python .ci/figures.py write FOLDER

FOLDER has the results of every shipped scenario, each in a folder of its name. `check` compares the
pictures in docs/figures with those there, `write` copies them.
"""

import re
import shutil
import sys
from pathlib import Path

KEPT = Path(__file__).parents[1] / "docs" / "figures"

# For each scenario how the names of its pictures begin in docs/figures, and which they are.
FIGURES = {
    "fig2": ("fig2", ["force", "evolution"]),
    "stick-slip-overdamped": ("stick-slip", ["stick_slip", "equilibrium"]),
    "velocity-curve-thermal": ("thermal", ["velocity_curve"]),
    "velocity-curve-delay": ("delay", ["velocity_curve"]),
    "velocity-curve-ageing": ("ageing", ["velocity_curve"]),
    "slow-slip": ("slow", ["stick_slip"]),
    "precursors-edge": ("precursors", ["space_time"]),
    "unequal-cells": ("unequal", ["space_time"]),
    "healing": ("healing", ["hold_curve"]),
    "creep": ("creep", ["creep_rate", "static_fatigue"]),
    "velocity-step": ("step", ["velocity_step"]),
    "stick-slip-ageing": ("aged", ["stick_slip"]),
    "spectrum": ("noise", ["spectrum"]),
    "stability": ("map", ["stability"]),
    "stability-contacts": ("simulations", ["stick_slip_scatter"]),
    "sweep-stability": ("regimes", ["regime"]),
    "sweep-critical-stiffness": ("critical", ["critical_stiffness_sliding"]),
}

# Last digits of transcendental functions differ between processors, and a tenth of a dot is not seen.
DOT = 0.1


def words(text: str) -> list[str]:
    """Numbers, and what stands between them."""
    return re.findall(r"[0-9.\-]+|[^0-9.\-]+", text)


def near(one: str, other: str) -> bool:
    if one == other:
        return True
    try:
        return abs(float(one) - float(other)) <= DOT
    except ValueError:
        return False


def alike(one: Path, other: Path) -> bool:
    """Whether two drawings are the same but for parts of a dot."""
    first, second = (words(path.read_text(encoding="utf-8")) for path in (one, other))
    return len(first) == len(second) and all(map(near, first, second))


def main() -> int:
    command, folder = sys.argv[1], Path(sys.argv[2])
    pairs = [
        (folder / scenario / f"{name}.svg", KEPT / f"{short}-{name}.svg")
        for scenario, (short, names) in FIGURES.items()
        for name in names
    ]
    if command == "write":
        for drawn, kept in pairs:
            shutil.copy(drawn, kept)
        return 0
    old = [kept.name for drawn, kept in pairs if not alike(drawn, kept)]
    for name in old:
        print(f"docs/figures/{name} is out of date: make figures", file=sys.stderr)
    print(f"{len(pairs)} pictures of the pages compared")
    return int(bool(old))


if __name__ == "__main__":
    sys.exit(main())
