"""The master equation by py-pde: upwind differences, compiled by its numba backend; Fig. 2 to X = 20; prints F(5)."""

from math import erf, exp, pi, sqrt

import numpy as np
from numba import njit
from pde import CartesianGrid, MemoryStorage, PDEBase, ScalarField

from clock import answer

DX = 1e-3
LAST = 20.0


def hazard(x, mean=1.0, std=0.05):
    z = (x - mean) / std
    survival = 0.5 * (1.0 - erf(z / sqrt(2.0)))
    return exp(-0.5 * z * z) / (sqrt(2.0 * pi) * std * survival) if survival > 0.0 else np.inf


class MasterEquation(PDEBase):
    """∂Q/∂X = −∂Q/∂x − P Q + δ(x) ∫P Q, explicit steps of half a cell."""

    def __init__(self, grid):
        super().__init__()
        self.breaking = np.minimum([hazard(x) for x in grid.axes_coords[0]], 1.0 / DX)

    def evolution_rate(self, state, t=0):
        return ScalarField(state.grid, self.make_evolution_rate(state, None)(state.data, t))

    def make_evolution_rate(self, state, backend):
        breaking = self.breaking

        @njit
        def rate(q, t):
            change = np.empty_like(q)
            broken = 0.0
            for i in range(q.size):
                part = breaking[i] * q[i]
                change[i] = (q[i - 1] - q[i]) / DX - part
                broken += part
            change[0] += broken
            return change

        return rate


grid = CartesianGrid([[0.0, 1.5]], round(1.5 / DX))
stretch = grid.axes_coords[0]
equation = MasterEquation(grid)
initial = np.exp(-0.5 * ((stretch - 0.1) / 0.025) ** 2)
state = ScalarField(grid, initial / (initial.sum() * DX))


def pull():
    kept = MemoryStorage()
    equation.solve(state, LAST, dt=0.5 * DX, backend="numba", tracker=kept.tracker(0.01))
    force = np.array(kept.data) @ stretch * DX
    return force[round(5.0 / 0.01)]


answer(pull)
