"""Stick-slip over single contacts that age at a temperature, for `core/tests/block/stick_slip.rs`.

Contacts with thresholds h = h_0 [1 + 0.02 ln(1 + age)], h_0 from G(1, 0.2), break at the rate
exp[-(h² - x²)/2T], T = 0.02, and re-form unstretched at once. The slider moves by 0.1 dX/dt = K(vt - X) - F,
v = 1e-3. A step advances it by 5e-4 at most, implicitly in the forces of springs and contacts. With steps of
2e-3 periods are longer by 6 %, with steps of 5e-3 stick-slip has ceased.
"""

import math

import numpy as np

VELOCITY, DAMPING, TEMPERATURE, GROWTH, STD = 1e-3, 0.1, 0.02, 0.02, 0.2
NUMBER, ADVANCE, LONGEST = 20_000, 5e-4, 30.0
# Slips are ten times as fast as the drive. Smaller drops are noise.
FAST, DROP = 10.0 * VELOCITY, 0.015


def advance(stiffness: float, net: float, duration: float) -> float:
    """The advance in a step under a net force at its beginning."""
    net += stiffness * VELOCITY * duration
    return max(duration * net / (DAMPING + duration * (stiffness + 1.0)), 0.0)


def slips(stiffness: float, distance: float) -> list[tuple[float, float, float]]:
    """Drive, force and force drop of the slips."""
    random = np.random.default_rng(1)
    fresh = random.normal(1.0, STD, NUMBER)
    origin, born = np.zeros(NUMBER), np.zeros(NUMBER)
    position, time = 0.0, 0.0
    before, found = None, []
    while VELOCITY * time < distance:
        force = position - origin.mean()
        net = stiffness * (VELOCITY * time - position) - force
        low, duration = 0.0, LONGEST
        moved = advance(stiffness, net, duration)
        while moved > ADVANCE and duration - low > 1e-9 * duration:
            middle = 0.5 * (low + duration)
            if advance(stiffness, net, middle) > ADVANCE:
                duration = middle
            else:
                low = middle
        moved = advance(stiffness, net, duration)
        if before is None and moved > FAST * duration:
            before = (VELOCITY * time, force)
        elif before is not None and moved < FAST * duration:
            if before[1] - force > DROP:
                found.append((*before, before[1] - force))
            before = None
        position, time = position + moved, time + duration
        stretch = position - origin
        threshold = fresh * (1.0 + GROWTH * np.log1p(time - born))
        attempts = np.exp(-0.5 * (threshold**2 - stretch**2) / TEMPERATURE) * duration
        broken = np.flatnonzero((stretch >= threshold) | (random.random(NUMBER) < -np.expm1(-attempts)))
        origin[broken], born[broken] = position, time
        fresh[broken] = random.normal(1.0, STD, broken.size)
    return found


def main() -> None:
    """Prints the slips, and means over those after the first, with their standard errors."""
    for stiffness, distance in [(0.01, 140.0), (0.02, 80.0)]:
        found = slips(stiffness, distance)
        print(f"K = {stiffness}:", *(f"({x:.2f}, {f:.4f}, {d:.4f})" for x, f, d in found))
        if len(found) > 2:
            table = np.array(found[1:])
            periods, drops = np.diff(table[:, 0]), table[:, 2]
            for name, values in (("period", periods), ("drop", drops)):
                print(f"{name} {values.mean():.4f} ± {values.std(ddof=1) / math.sqrt(len(values)):.4f}")


if __name__ == "__main__":
    main()
