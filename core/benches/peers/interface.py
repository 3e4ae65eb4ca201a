"""Cells under a periodic half-space that slip by reset, an FFT per generation; prints the mean force.

Side × side cells have the friction curve of Gaussian thresholds (1 ± 0.1), stretched by 1 ± 0.05 from cell to cell;
K_0 = 0.5, G*a = 3. The drive rises in equal steps. In every one of them all cells move together, by the response of a
slider whose contacts are as stiff as the steepest rise of the curve, until forces balance; cells that then go down a
slope steeper than K_0 re-form all their contacts. The arguments are the side, the first drive, which is reached from
rest in one step and not timed, the last drive, and the number of steps between them.
"""

import sys

import numpy as np

from clock import answer

CONNECTION, MODULUS, WIDTH, SCATTER = 0.5, 3.0, 0.1, 0.05
FINE = 1e-3
BALANCE = 1e-8

side, first, last, steps = int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])


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
slope = np.gradient(force, FINE)
steepest = slope.max()
scales = 1 + SCATTER * np.random.default_rng(1).standard_normal((side, side))
down = 2 * np.sin(np.pi * np.fft.fftfreq(side))
along = 2 * np.sin(np.pi * np.fft.rfftfreq(side))
stiffness = MODULUS * np.hypot(down[:, None], along)


def filtered(field, factor):
    return np.fft.irfft2(factor * np.fft.rfft2(field), s=field.shape)


class Interface:
    def __init__(self):
        self.positions = np.zeros((side, side))
        self.origins = np.zeros((side, side))
        self.generations = 0

    def place(self):
        """Where cells are on the table, and how far behind the entry."""
        at = (self.positions - self.origins) / (scales * FINE)
        entry = np.minimum(at.astype(np.int64), len(force) - 2)
        return entry, at - entry

    def friction(self):
        entry, rest = self.place()
        return scales * ((1 - rest) * force[entry] + rest * force[entry + 1])

    def drive(self, to):
        before = self.positions.copy()
        while True:
            excess = CONNECTION * (to - self.positions) - filtered(self.positions, stiffness) - self.friction()
            if np.abs(excess).max() < BALANCE:
                return
            self.positions += filtered(excess, 1 / (CONNECTION + steepest + stiffness))
            entry, _ = self.place()
            slips = (slope[entry] < -CONNECTION) & (self.positions - before > 1e-6)
            self.origins[slips] = self.positions[slips]
            self.generations += 1


def run():
    interface = Interface()
    interface.positions[:] = started.positions
    for drive in np.linspace(first, last, steps + 1)[1:]:
        interface.drive(drive)
    run.generations = interface.generations
    return interface.friction().mean()


started = Interface()
started.drive(first)
if __name__ == "__main__":
    answer(run)
