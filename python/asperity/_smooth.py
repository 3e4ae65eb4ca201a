"""Smooth curves through computed points, as the figures of the command have them."""

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]


def along_logarithm(x: _Array, y: _Array, fine: int = 24) -> tuple[_Array, _Array]:
    """The curve through points with rising positive abscissae, monotone between them: piecewise cubic Hermite
    interpolation in the logarithm, with the slopes of F. N. Fritsch and J. Butland (1984)."""
    known = np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < 3:
        return x, y
    at = np.log(x)
    steps, chords = np.diff(at), np.diff(y) / np.diff(at)
    slopes = _slopes(steps, chords)
    t = np.arange(fine) / fine
    up, bend = t**2 * (3.0 - 2.0 * t), t * (1.0 - t)
    between = (
        y[:-1, None]
        + np.diff(y)[:, None] * up
        + steps[:, None] * bend * (slopes[:-1, None] * (1.0 - t) - slopes[1:, None] * t)
    )
    places = np.exp(at[:-1, None] + steps[:, None] * t)
    # The computed points themselves, without the rounding of a logarithm.
    places[:, 0] = x[:-1]
    return np.append(places, x[-1]), np.append(between, y[-1])


def _slopes(steps: _Array, chords: _Array) -> _Array:
    """0 at extrema, weighted harmonic means of the slopes of both sides elsewhere."""
    slopes = np.zeros(len(steps) + 1)
    same = chords[:-1] * chords[1:] > 0.0
    before, after = chords[:-1][same], chords[1:][same]
    left, right = (steps[:-1] + 2.0 * steps[1:])[same], (2.0 * steps[:-1] + steps[1:])[same]
    slopes[1:-1][same] = (left + right) / (right / before + left / after)
    slopes[0] = _end(steps[0], steps[1], chords[0], chords[1])
    slopes[-1] = _end(steps[-1], steps[-2], chords[-1], chords[-2])
    return slopes


def _end(step: float, next_step: float, chord: float, next_chord: float) -> float:
    """The slope of the parabola through three points at an end, unless it would overshoot."""
    slope = ((2.0 * step + next_step) * chord - step * next_chord) / (step + next_step)
    if slope * chord <= 0.0:
        return 0.0
    if chord * next_chord <= 0.0 and abs(slope) > 3.0 * abs(chord):
        return 3.0 * chord
    return slope
