"""The automaton of Olami, Feder and Christensen in numba: 128 × 128 sites, open edges, to X = 2; prints the mean force.

For every avalanche the lattice is looked through for the largest force; what it sets off topples from two lists, one
generation after the other. The argument is α.
"""

import sys

import numpy as np
from numba import njit

from clock import answer

SIDE = 128
LAST = 2.0


@njit(fastmath=True)
def drive(force, share, last):
    side = force.shape[0] - 2
    front = np.empty((2, side * side + 1), np.int64)
    let_go = np.empty(side * side + 1)
    flat = force.reshape(-1)
    pitch = side + 2
    driven = 0.0
    while True:
        largest = 0.0
        for row in range(1, side + 1):
            for column in range(1, side + 1):
                if force[row, column] > largest:
                    largest = force[row, column]
                    place = row * pitch + column
        missing = 1.0 - largest
        if driven + missing > last:
            break
        driven += missing
        for row in range(1, side + 1):
            for column in range(1, side + 1):
                force[row, column] += missing
        now, count = 0, 1
        front[now, 0] = place
        while count > 0:
            for i in range(count):
                let_go[i] = flat[front[now, i]]
                flat[front[now, i]] = 0.0
            following = 0
            for i in range(count):
                gain = share * let_go[i]
                for step in (-1, 1, -pitch, pitch):
                    near = front[now, i] + step
                    column = near % pitch
                    if near < pitch or near >= pitch * (side + 1) or column == 0 or column == side + 1:
                        continue
                    before = flat[near]
                    flat[near] = before + gain
                    if before < 1.0 and before + gain >= 1.0:
                        front[1 - now, following] = near
                        following += 1
            now, count = 1 - now, following
    return force[1:-1, 1:-1].mean() + last - driven


share = float(sys.argv[1])


def run():
    force = np.zeros((SIDE + 2, SIDE + 2))
    force[1:-1, 1:-1] = np.random.default_rng(1).random((SIDE, SIDE))
    return drive(force, share, LAST)


answer(run)
