"""Slowest relaxation roots where contacts re-form among the thresholds, in 30-digit arithmetic: relaxation_roots.csv.

    python make_relaxation.py        # needs mpmath; some minutes

phi(u) = integral of R(r) P_c(r+u)/S(r) dr over r, by Gauss points on panels, on nodes of u that serve every s; its
transform phi^(s) is a sum over them. For lognormal thresholds u turns into the lower half plane, which continues the
transform to Re s < 0. Roots of phi^(s) = 1 from Newton's method for ln phi^ on a grid of starts; the argument principle shows that
no root lies to the right of the slowest, up to the frequency 12 / mean. Parameters are doubles, taken exactly; R is
cut where S falls below 1e-9, as contacts cannot be placed above (their share is below 1e-12).
"""

import cmath
import csv
from math import pi
from pathlib import Path

from mpmath import mp, mpf, mpc, erfc, exp, expj, log, log1p, sqrt, gamma, gammainc, loggamma

mp.dps = 30
HERE = Path(__file__).parent
POINTS = 24


def upper(z):
    """P(Z > z) of a standard normal."""
    return erfc(z / sqrt(mpf(2))) / 2


class Gaussian:
    def __init__(self, mean, std):
        self.m, self.width = mpf(mean), mpf(std)
        self.above = upper(-self.m / self.width)
        self.reach = max(self.m - 15 * self.width, 0), self.m + 22 * self.width

    def density(self, x):
        return exp(-(((x - self.m) / self.width) ** 2) / 2) / (self.width * sqrt(2 * mp.pi) * self.above)

    def survival(self, x):
        return upper((x - self.m) / self.width) / self.above


class Gamma:
    def __init__(self, mean, std):
        mean, std = mpf(mean), mpf(std)
        self.k, self.t, self.width = (mean / std) ** 2, std**2 / mean, std
        self.reach = mpf(0), mean + 140 * std**2 / mean * 3

    def density(self, x):
        return exp((self.k - 1) * log(x / self.t) - x / self.t - loggamma(self.k)) / self.t

    def survival(self, x):
        return gammainc(self.k, x / self.t, mp.inf) / gamma(self.k)


class Weibull:
    def __init__(self, shape, scale):
        self.k, self.l = mpf(shape), mpf(scale)
        self.width = self.l / self.k
        self.reach = mpf(0), self.l * mpf(400) ** (1 / self.k)

    def density(self, x):
        return self.k / x * (x / self.l) ** self.k * self.survival(x)

    def survival(self, x):
        return exp(-((x / self.l) ** self.k))


class Lognormal:
    def __init__(self, mean, std):
        mean, std = mpf(mean), mpf(std)
        self.s = sqrt(log1p((std / mean) ** 2))
        self.m, self.width = mean / sqrt(1 + (std / mean) ** 2), std
        self.reach = mpf(0), mean + 60 * std

    def density(self, x):
        return exp(-((log(x / self.m) / self.s) ** 2) / 2) / (self.s * x * sqrt(2 * mp.pi))

    def survival(self, x):
        return upper(log(x / self.m) / self.s)


class Rectangular:
    def __init__(self, low, high):
        self.reach = mpf(low), mpf(high)
        self.width = (self.reach[1] - self.reach[0]) / 4

    def density(self, x):
        return 1 / (4 * self.width) if self.reach[0] <= x <= self.reach[1] else mpf(0)

    def survival(self, x):
        low, high = self.reach
        return min(max((high - x) / (high - low), mpf(0)), mpf(1))


LAWS = {"gaussian": Gaussian, "gamma": Gamma, "weibull": Weibull, "lognormal": Lognormal, "rectangular": Rectangular}

CASES = [
    (("gaussian", 1, 0.15), ("gaussian", 1.3, 0.05)),
    (("gaussian", 1, 0.05), ("gaussian", 0.9, 0.05)),
    (("gaussian", 1, 0.05), ("gaussian", 1, 0.04)),
    (("gaussian", 1, 0.05), ("gaussian", 1.2, 0.01)),
    (("gaussian", 1, 0.05), ("gaussian", 0.55, 0.1)),
    (("gaussian", 1, 0.1), ("rectangular", 0.7, 1.4)),
    (("weibull", 12.153, 1.0431), ("gaussian", 1.1, 0.03)),
    (("gamma", 1, 0.1), ("gaussian", 1.2, 0.03)),
    (("lognormal", 1, 0.1), ("gaussian", 0.7, 0.05)),
    (("rectangular", 0.8, 1.2), ("rectangular", 1.0, 1.15)),
    (("rectangular", 0.4, 1.6), ("rectangular", 0.0, 0.6)),
]


def legendre(n):
    """Gauss points and weights on [0, 1]."""
    rule = []
    for i in range(n):
        t = mp.cos(mp.pi * (mpf(i) + mpf(3) / 4) / (n + mpf(1) / 2))
        for _ in range(8):
            p, q = mpf(1), t
            for k in range(2, n + 1):
                p, q = q, ((2 * k - 1) * t * q - (k - 1) * p) / k
            slope = n * (t * q - p) / (t * t - 1)
            t -= q / slope
        rule.append(((1 + t) / 2, 1 / ((1 - t * t) * slope * slope)))
    return rule


RULE = legendre(POINTS)


def nodes(edges, width):
    """Gauss points on panels between the edges, none wider than `width`."""
    for a, b in zip(edges, edges[1:]):
        count = int(mp.ceil((b - a) / width))
        for k in range(count):
            for t, w in RULE:
                yield a + (b - a) * (k + t) / count, w * (b - a) / count


def life(thresholds, starts, widest=mpf(1)):
    """Nodes of u with weight times phi(u), on panels as wide as the thresholds' law asks for, or the mean of u."""
    low, high = starts.reach
    while thresholds.survival(high) < mpf("1e-9"):
        high -= starts.width / 50
    if isinstance(thresholds, Rectangular):
        high = starts.reach[1]
    bends = [x for x in thresholds.reach if low < x < high and isinstance(thresholds, Rectangular)]
    width = min(starts.width, thresholds.width) * mpf("1.2")
    births = [(r, w * starts.density(r) / thresholds.survival(r)) for r, w in nodes([low, *bends, high], width)]
    births = [(r, w) for r, w in births if w > mpf("1e-60")]
    if isinstance(thresholds, Rectangular):
        return rectangular_life(thresholds, births, (low, high))
    turn = expj(mpf("-0.5")) if isinstance(thresholds, Lognormal) else 1
    phi = []
    end = thresholds.reach[1] - low
    for u, w in nodes([mpf(0), end], min(thresholds.width, widest)):
        u *= turn
        phi.append((u, w * turn * sum(b * thresholds.density(r + u) for r, b in births)))
    mean = sum(w * u for u, w in phi).real
    return phi if widest < 2 * mean else life(thresholds, starts, mean)


def rectangular_life(thresholds, births, bounds):
    """P_c constant: nodes of u follow each start, from where thresholds begin to where they end."""
    low, high = thresholds.reach
    phi = []
    for r, b in births:
        first = max(low - r, mpf(0))
        phi += [(u, w * b / (high - low)) for u, w in nodes([first, high - r], (high - low) / 2)]
    return phi


def transform(phi, s):
    return sum(w * exp(-s * u) for u, w in phi)


def newton(phi, s, steps, widest):
    """A root of ln phi^ = 0, 2 pi i, ... from a start."""
    end = abs(phi[-1][0])
    for _ in range(steps):
        if abs(s) * end > 600:
            return None
        terms = [(u, w * cmath.exp(-s * u)) for u, w in phi]
        value = sum(t for _, t in terms)
        if value == 0:
            return None
        step = cmath.log(value) * value / sum(u * t for u, t in terms)
        s += step * min(1, widest / abs(step)) if step else 0
        if abs(step) < 1e-12 * abs(s):
            return s
    return None


def zeros_right_of(phi, left, mean):
    """Zeros of (1 - phi^(s))/s with Re s > left, 0 < Im s < 12/mean."""
    corners = [complex(*c) / mean for c in ((1, 1e-9), (1, 12), (left * mean, 12), (left * mean, 1e-9))]
    turned = 0.0
    for a, b in zip(corners, corners[1:]):
        steps = int(abs(b - a) * mean / 0.1) + 1
        path = [a + (b - a) * k / steps for k in range(steps + 1)]
        values = [(1 - sum(w * cmath.exp(-s * u) for u, w in phi)) / s for s in path]
        turned += sum(cmath.phase(y / x) for x, y in zip(values, values[1:]))
    return round(turned / (2 * pi))


def slowest(phi):
    mean = float(sum(w * u for u, w in phi).real)
    kind = complex if any(isinstance(w, mpc) for _, w in phi) else float
    rough = [(kind(u), kind(w)) for u, w in phi if abs(w) > mpf("1e-250")]
    found = []
    for re in (0.05, 0.3, 0.6, 1, 1.3, 1.6, 2, 2.5, 3, 4, 5, 7):
        for im in (0.5, 0.8, 1.1, 1.5, 2, 2.5, 3, 4, 5, 6.28, 8, 11):
            s = newton(rough, complex(-re, im) / mean, 60, 1 / mean)
            if s and s.imag * mean > 1e-3 and s.real < -1e-9:
                found.append(s)
    root = max(found, key=lambda s: s.real)
    assert zeros_right_of(rough, 0.98 * root.real, mean) == 0, "a root was missed"
    s = mpc(root)
    for _ in range(4):
        terms = [(u, w * exp(-s * u)) for u, w in phi]
        s += (sum(t for _, t in terms) - 1) / sum(u * t for u, t in terms)
    return s


def text(value):
    return mp.nstr(value, 18, strip_zeros=True, min_fixed=-3, max_fixed=3)


if __name__ == "__main__":
    with open(HERE / "relaxation_roots.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        names = [f"{law}{column}" for law in ("thresholds", "reforming") for column in ("", "_first", "_second")]
        writer.writerow(names + ["re", "im"])
        for thresholds, starts in CASES:
            laws = [LAWS[name](*pair) for name, *pair in (thresholds, starts)]
            root = slowest(life(*laws))
            print(thresholds, starts, text(root.real), text(root.imag), flush=True)
            writer.writerow([*thresholds, *starts, text(root.real), text(root.imag)])
