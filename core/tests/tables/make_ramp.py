"""Forces along a ramp of the velocity, for `runner/tests/time.rs`.

Contacts with thresholds G(1.2, 0.25) that age towards G(0.8, 0.1) keeping their rank z, with stiffnesses
proportional to the threshold, free for a time between 0.5 and 2 after a break, and then with friction. The
slider is at X = 0.05 t + 0.0475 t². A contact has survived if its z exceeds all (x - m)/s that it has met,
where m and s are mean and standard deviation of the thresholds of its age: the force of those that formed
together is a closed form. Sums over what forms in each step are of second order, and extrapolated.
"""

import math

import numpy as np

COUNT, STIFFNESS, FRICTION = 5.0, 1.4, 0.2
FRESH, MATURE, TIME = (1.2, 0.25), (0.8, 0.1), 4.0
SHORTEST, LONGEST = 0.5, 2.0
START, END = 0.1, 10.0

erfc = np.vectorize(math.erfc, otypes=[float])


def above(z: np.ndarray | float) -> np.ndarray:
    """The share of ranks above z."""
    return 0.5 * erfc(np.asarray(z) / math.sqrt(2.0))


def thresholds(age: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation at an age."""
    past = np.exp(-age / TIME)
    variance = MATURE[1] ** 2 + (FRESH[1] ** 2 - MATURE[1] ** 2) * past**2
    return MATURE[0] + (FRESH[0] - MATURE[0]) * past, np.sqrt(variance)


def forces(steps: int) -> np.ndarray:
    """The force at each step."""
    time = np.linspace(0.0, END, steps + 1)
    position = 0.05 * time + 0.0475 * time**2
    middle = 0.5 * (time[1:] + time[:-1])
    # The first ones, and those that form in each step.
    born = np.concatenate([[0.0], middle])
    origin = np.concatenate([[-START], 0.05 * middle + 0.0475 * middle**2])
    lowest = np.full(steps + 1, -FRESH[0] / FRESH[1])
    lowest[0] = (START - FRESH[0]) / FRESH[1]
    mass = np.zeros(steps + 1)
    mass[0] = 1.0
    whole, reached = above(lowest), lowest.copy()
    broken, integral = np.zeros(steps + 1), np.zeros(steps + 1)
    step = END / steps

    def reformed(until: float) -> float:
        ends = np.interp([until - SHORTEST, until - LONGEST], time, integral)
        return float(ends[0] - ends[1]) / (LONGEST - SHORTEST)

    force = np.zeros(steps + 1)
    for i in range(steps + 1):
        own = slice(0, i + 1)
        if i > 0:
            mass[i] = reformed(time[i]) - reformed(time[i - 1])
        mean, std = thresholds(time[i] - born[own])
        stretch = position[i] - origin[own]
        reached[own] = np.maximum(reached[own], (stretch - mean) / std)
        left = above(reached[own])
        broken[i] = np.sum(mass[own] * (1.0 - left / whole[own]))
        if i > 0:
            integral[i] = integral[i - 1] + 0.5 * step * (broken[i] + broken[i - 1])
        density = np.exp(-0.5 * reached[own] ** 2) / math.sqrt(2.0 * math.pi)
        carried = STIFFNESS * stretch * (mean * left + std * density) / whole[own]
        force[i] = COUNT * (np.sum(mass[own] * carried) + FRICTION * (broken[i] - reformed(time[i])))
    return force


if __name__ == "__main__":
    for at in (1.5, 3.0, 4.0, 6.0, 8.0):
        coarse, fine = (forces(steps)[round(at / END * steps)] for steps in (2000, 4000))
        print(f"t = {at}: F = {(4.0 * fine - coarse) / 3.0:.6f}, changed by {abs(fine - coarse) / 3.0:.0e}")
