"""The same model from break to break in numba: contacts to X = 100, F at 2001 positions; prints F(5).

Every stretch grows with X; each break takes its stretch away at the next position, and one running sum
over positions, at the end, gives the force. No standard errors. The arguments are the draws, `twister` for numba's
np.random or `pcg64` for its Generator, and the number of contacts.
"""

import sys

import numpy as np
from numba import njit

from clock import answer

CONTACTS = int(sys.argv[2])
STEP = 0.05
LAST = 100.0

if sys.argv[1] == "twister":
    normal = njit(lambda rng: np.random.standard_normal())
else:
    normal = njit(lambda rng: rng.standard_normal())


@njit(fastmath=True)
def pull(rng, contacts, last, step):
    points = round(last / step) + 1
    lost = np.zeros(points)
    start = 0.0
    for _ in range(contacts):
        x = 0.1 + 0.025 * normal(rng)
        start += x
        threshold = 1.0 + 0.05 * normal(rng)
        position = threshold - x
        while position <= last:
            lost[int(np.ceil(position / step))] += threshold
            threshold = 1.0 + 0.05 * normal(rng)
            position += threshold
    force = np.empty(points)
    gone = 0.0
    for i in range(points):
        gone += lost[i]
        force[i] = i * step + (start - gone) / contacts
    return force


rng = np.random.Generator(np.random.PCG64(1))
answer(lambda: pull(rng, CONTACTS, LAST, STEP)[round(5.0 / STEP)])
