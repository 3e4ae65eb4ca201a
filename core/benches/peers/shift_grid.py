"""Eq. (2) of the paper on a NumPy grid, Fig. 2 to X = 20; prints F(5)."""

from math import erf, exp, pi, sqrt

import numpy as np

from clock import answer

DX = 1e-3
LAST = 20.0


def hazard(x, mean=1.0, std=0.05):
    z = (x - mean) / std
    survival = 0.5 * (1.0 - erf(z / sqrt(2.0)))
    return exp(-0.5 * z * z) / (sqrt(2.0 * pi) * std * survival) if survival > 0.0 else np.inf


def pull():
    x = np.arange(0.0, 1.5, DX)
    breaking = np.minimum([hazard(v) * DX for v in x], 1.0)
    q = np.exp(-0.5 * ((x - 0.1) / 0.025) ** 2)
    q /= q.sum()
    steps = round(LAST / DX)
    force = np.empty(steps)
    for step in range(steps):
        q[1:] = q[:-1]
        q[0] = 0.0
        broken = breaking * q
        q -= broken
        q[0] += broken.sum()
        force[step] = x @ q
    return force[round(5.0 / DX) - 1]


answer(pull)
