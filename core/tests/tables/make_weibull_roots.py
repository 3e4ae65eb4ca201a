"""Slowest relaxation roots of Weibull thresholds of scale 1, alone and in mixtures: weibull_roots.csv.

    python make_weibull_roots.py        # needs mpmath; some minutes

In 25-digit arithmetic. Contacts re-form at 0, or uniformly up to `reforming`. A share `weight` of the thresholds is
Weibull, the others are exponential of mean `first`, or Gaussian of location `first` and scale `second`, cut at 0.
For shapes near 1 the transform grows without bound on the negative real axis, by stretches far in the tail of the
thresholds: Gauss points on panels that grow from 0 and have length 1/4 from there to where exp(-x^shape) is 1e-250.
The root is the zero of phi^ - 1 from the secant method. For contacts that re-form at 0 the argument principle shows
that none lies to the right of it, up to the frequency 20.
"""

import cmath
import csv
from math import pi
from pathlib import Path

from mpmath import erfc, exp, findroot, fsum, mp, mpc, mpf, nstr, sqrt
from mpmath.calculus.quadrature import GaussLegendre

mp.dps = 25
HERE = Path(__file__).parent
RULE = GaussLegendre(mp).calc_nodes(3, 90)

# Shape, end of the stretches of re-formed contacts, weight, the other thresholds, and a point near the root.
ALONE = (1, "", 0, 0)
CASES = [
    (1.1, 0, *ALONE, -1.58 + 0.3j),
    (1.15, 0, *ALONE, -1.81 + 0.5j),
    (1.2, 0, *ALONE, -2.01 + 0.71j),
    (1.2, 0.5, *ALONE, -2.01 + 0.7j),
    (1.3, 0, *ALONE, -2.33 + 1.18j),
    (1.5, 0, *ALONE, -2.7 + 2.13j),
    (2, 0, *ALONE, -2.71 + 3.98j),
    (2.5, 0, *ALONE, -2.31 + 5.06j),
    (5, 0, *ALONE, -0.92 + 6.43j),
    (1.2, 0, 0.5, "exponential", 0.25, 0, -1.99 + 0.75j),
    (1.2, 0, 0.5, "gaussian", 1, 0.3, -1.83 + 0.66j),
    (1.1, 0, 0.3, "exponential", 0.3, 0, -1.58 + 0.33j),
]


def transform(name, first, second, s):
    """The Laplace transform of the other thresholds, in closed form."""
    if name == "exponential":
        return 1 / (1 + first * s)
    above = erfc(-first / second / sqrt(mpf(2)))
    return exp(s * (s * second**2 / 2 - first)) * erfc((s * second - first / second) / sqrt(mpf(2))) / above


def nodes(edges):
    """Gauss points on panels between the edges."""
    for a, b in zip(edges, edges[1:]):
        for t, w in RULE:
            yield (a + b) / 2 + (b - a) / 2 * t, (b - a) / 2 * w


def growing(end):
    return [mpf(0)] + [end * mpf(2) ** k for k in range(-40, 1)]


class Breaking:
    """phi^(s), the transform of the breaking density."""

    def __init__(self, shape, reforming, weight, other, first, second):
        self.shape, self.reforming = mpf(shape), mpf(reforming)
        self.weight, self.other = mpf(weight), (other, mpf(first), mpf(second))
        end = int(mpf(576) ** (1 / self.shape)) + 2
        self.thresholds = [
            (x, w * self.density(x))
            for x, w in nodes(growing(mpf(1) / 4) + [mpf(k) / 4 for k in range(2, 4 * end)])
        ]

    def density(self, x):
        return self.shape * x ** (self.shape - 1) * exp(-(x**self.shape))

    def __call__(self, s):
        whole = fsum(w * exp(-s * x) for x, w in self.thresholds)
        if self.weight < 1:
            return self.weight * whole + (1 - self.weight) * transform(*self.other, s)
        if self.reforming == 0:
            return whole
        # Starts r hold with exp(-r^shape): what breaks beyond r, divided by it, on average over r.
        below, last, total = mpf(0), mpf(0), mpf(0)
        for r, w in sorted(nodes(growing(self.reforming))):
            panels = growing(r) if last == 0 else [last, r]
            below += fsum(v * self.density(x) * exp(-s * x) for x, v in nodes(panels))
            total += w * exp(s * r + r**self.shape) * (whole - below)
            last = r
        return total / self.reforming

    def zeros_right_of(self, left):
        """Zeros of (1 - phi^(s))/s with Re s > left, 0 < Im s < 20, for contacts that re-form at 0."""
        points = [(float(x), float(w)) for x, w in self.thresholds if w > mpf("1e-300")]
        corners = [1 + 1e-6j, 1 + 20j, complex(left, 20), complex(left, 1e-6)]
        turned = 0.0
        for a, b in zip(corners, corners[1:]):
            steps = int(abs(b - a) / 0.02) + 1
            path = [a + (b - a) * k / steps for k in range(steps + 1)]
            values = [
                (1 - float(self.weight) * sum(w * cmath.exp(-s * x) for x, w in points)) / s for s in path
            ]
            if self.weight < 1:
                others = [complex(transform(*self.other, mpc(s))) for s in path]
                values = [v - float(1 - self.weight) * o / s for v, o, s in zip(values, others, path)]
            turned += sum(cmath.phase(y / x) for x, y in zip(values, values[1:]))
        return round(turned / (2 * pi))


if __name__ == "__main__":
    with open(HERE / "weibull_roots.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["shape", "reforming", "weight", "other", "first", "second", "re", "im"])
        for *case, guess in CASES:
            breaking = Breaking(*case)
            starts = mpc(guess), mpc(guess) + mpf("0.001")
            root = findroot(lambda s: breaking(s) - 1, starts, solver="secant", tol=1e-18, maxsteps=12)
            if breaking.reforming == 0:
                assert breaking.zeros_right_of(0.98 * float(root.real)) == 0, "a root was missed"
            digits = [nstr(part, 17) for part in (root.real, root.imag)]
            print(*case, *digits, flush=True)
            writer.writerow([*case, *digits])
