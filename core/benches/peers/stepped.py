"""The earthquake-like model contact by contact, stepped, in numba: Fig. 2 with 10 000 contacts to X = 20; prints F(5)."""

import numpy as np
from numba import njit

from clock import answer

CONTACTS = 10_000
DX = 1e-3
LAST = 20.0


@njit(fastmath=True)
def pull(rng, contacts, steps, dx):
    stretch = np.empty(contacts)
    threshold = np.empty(contacts)
    for i in range(contacts):
        stretch[i] = 0.1 + 0.025 * rng.standard_normal()
        threshold[i] = 1.0 + 0.05 * rng.standard_normal()
    force = np.empty(steps)
    for step in range(steps):
        total = 0.0
        for i in range(contacts):
            x = stretch[i] + dx
            if x >= threshold[i]:
                x = 0.0
                threshold[i] = 1.0 + 0.05 * rng.standard_normal()
            stretch[i] = x
            total += x
        force[step] = total / contacts
    return force


rng = np.random.Generator(np.random.PCG64(1))
answer(lambda: pull(rng, CONTACTS, round(LAST / DX), DX)[round(5.0 / DX) - 1])
