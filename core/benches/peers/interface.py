"""The next event of cells under a periodic half-space, FFTs in every step; prints the mean force after it.

Side × side cells have the friction curve of Gaussian thresholds (1 ± 0.1), stretched by 1 ± 0.05 from cell to cell;
K_0 = 0.5, G*a = 3. At a drive all cells move together, by the response of a slider whose contacts are as stiff as the
steepest rise of the curve, until forces balance: so no balance is passed. Where a cell goes far in a step of the drive
there was an event in it; the step is halved until the drive of the event is known to a tolerance. The arguments are the
side, the drive to start from, which is reached from rest and not timed, the first step, and the tolerance.
"""

import sys

import numpy as np

from clock import answer

CONNECTION, MODULUS, WIDTH, SCATTER = 0.5, 3.0, 0.1, 0.05
FINE = 1e-3
BALANCE = 1e-10
FAR = 0.1

side = int(sys.argv[1])
first, step, tolerance = (float(argument) for argument in sys.argv[2:])


def curve(end):
    """F(X) of contacts that begin relaxed and re-form at 0: births by the renewal equation, then what they carry."""
    x = FINE * np.arange(int(end / FINE) + 1)
    density = np.exp(-0.5 * ((x - 1) / WIDTH) ** 2) / (WIDTH * np.sqrt(2 * np.pi))
    survival = 1 - FINE * np.concatenate(([0], np.cumsum(0.5 * (density[1:] + density[:-1]))))
    births = density.copy()
    for i in range(1, len(x)):
        births[i] += FINE * np.dot(density[1 : i + 1], births[i - 1 :: -1])
    carried = x * survival
    return carried + FINE * np.convolve(carried, births)[: len(x)]


force = curve(6.0)
steepest = np.gradient(force, FINE).max()
scales = 1 + SCATTER * np.random.default_rng(1).standard_normal((side, side))
down = 2 * np.sin(np.pi * np.fft.fftfreq(side))
along = 2 * np.sin(np.pi * np.fft.rfftfreq(side))
stiffness = MODULUS * np.hypot(down[:, None], along)


def filtered(field, factor):
    return np.fft.irfft2(factor * np.fft.rfft2(field), s=field.shape)


def friction(positions):
    at = positions / (scales * FINE)
    entry = np.minimum(at.astype(np.int64), len(force) - 2)
    rest = at - entry
    return scales * ((1 - rest) * force[entry] + rest * force[entry + 1])


def balanced(positions, drive):
    """The next balance at a drive, from positions behind it."""
    while True:
        excess = CONNECTION * (drive - positions) - filtered(positions, stiffness) - friction(positions)
        if np.abs(excess).max() < BALANCE:
            return positions
        positions = positions + filtered(excess, 1 / (CONNECTION + steepest + stiffness))


def run():
    positions, drive, by = started, first, step
    while True:
        ahead = balanced(positions, drive + by)
        if (ahead - positions).max() < FAR:
            positions, drive = ahead, drive + by
        elif by <= tolerance:
            return friction(ahead).mean()
        else:
            by /= 2


started = balanced(np.zeros((side, side)), first)
if __name__ == "__main__":
    answer(run, warm=False)
