"""Eq. (2) of the paper on a grid, a loop in numba, Fig. 2 to X = 20; prints F(5)."""

from math import erf, exp, pi, sqrt

import numpy as np
from numba import njit

from clock import answer

DX = 1e-3
LAST = 20.0


def hazard(x, mean=1.0, std=0.05):
    z = (x - mean) / std
    survival = 0.5 * (1.0 - erf(z / sqrt(2.0)))
    return exp(-0.5 * z * z) / (sqrt(2.0 * pi) * std * survival) if survival > 0.0 else np.inf


@njit(fastmath=True)
def pull(q, breaking, steps, dx):
    force = np.empty(steps)
    for step in range(steps):
        broken, total = 0.0, 0.0
        for i in range(q.size - 1, 0, -1):
            part = breaking[i] * q[i - 1]
            q[i] = q[i - 1] - part
            broken += part
            total += i * q[i]
        q[0] = broken
        force[step] = total * dx
    return force


stretch = np.arange(0.0, 1.5, DX)
breaking = np.minimum([hazard(x) * DX for x in stretch], 1.0)
initial = np.exp(-0.5 * ((stretch - 0.1) / 0.025) ** 2)
initial /= initial.sum()
answer(lambda: pull(initial.copy(), breaking, round(LAST / DX), DX)[round(5.0 / DX) - 1])
