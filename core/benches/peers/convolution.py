"""Forces of a periodic half-space under square cells by NumPy's FFT, G*a = 1; prints the force on the first one."""

import sys

import numpy as np

from clock import answer

side = int(sys.argv[1])
down = 2 * np.sin(np.pi * np.fft.fftfreq(side))
along = 2 * np.sin(np.pi * np.fft.rfftfreq(side))
stiffness = np.hypot(down[:, None], along)
positions = np.sin(0.37 * np.arange(side * side)).reshape(side, side)


def run():
    forces = np.fft.irfft2(-stiffness * np.fft.rfft2(positions), s=positions.shape)
    return forces[0, 0]


answer(run)
