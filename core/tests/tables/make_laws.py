"""Reference values of the laws in 40-digit arithmetic: law_points.csv, law_quantiles.csv, law_transforms.csv.

    python make_laws.py        # needs mpmath; a few minutes

Every law is here only a density and, where there is one, a textbook survival function; what has no closed
form is integrated. Parameters and abscissae are doubles, taken exactly. Columns of law_points.csv: density,
survival S, -ln S, hazard, and the moments of order 1 and 3 of the mass above x. law_quantiles.csv: the x with
S(x) = q, and the one with 1 - S(x) = q. law_transforms.csv: E[exp(-s x)], for a lognormal law and Re s < 0 its
analytic continuation, integrated along a rotated contour.
"""

import csv
from pathlib import Path

from mpmath import mp, mpf, mpc, quad, erfc, exp, log, log1p, sqrt, pi, gamma, loggamma, gammainc

mp.dps = 40
HERE = Path(__file__).parent


def upper(z):
    """P(Z > z) of a standard normal."""
    return erfc(z / sqrt(mpf(2))) / 2


class Gaussian:
    def __init__(self, mean, std):
        self.m, self.s = mpf(mean), mpf(std)
        self.above = upper(-self.m / self.s)
        self.width, self.centre = self.s, self.m

    def density(self, x):
        return exp(-(((x - self.m) / self.s) ** 2) / 2) / (self.s * sqrt(2 * pi) * self.above)

    def survival(self, x):
        return upper((x - self.m) / self.s) / self.above


class Gamma:
    def __init__(self, mean, std):
        mean, std = mpf(mean), mpf(std)
        self.k, self.t = (mean / std) ** 2, std**2 / mean
        self.width, self.centre = std, mean

    def density(self, x):
        return exp((self.k - 1) * log(x / self.t) - x / self.t - loggamma(self.k)) / self.t

    def survival(self, x):
        if self.k < 1000:
            return gammainc(self.k, x / self.t, mp.inf) / gamma(self.k)
        return above(self, x, 0)


class Weibull:
    def __init__(self, shape, scale):
        self.k, self.l = mpf(shape), mpf(scale)
        self.centre = self.l * gamma(1 + 1 / self.k)
        self.width = self.l * sqrt(gamma(1 + 2 / self.k) - gamma(1 + 1 / self.k) ** 2)

    def density(self, x):
        return self.k / x * (x / self.l) ** self.k * self.survival(x)

    def survival(self, x):
        return exp(-((x / self.l) ** self.k))


class Lognormal:
    def __init__(self, mean, std):
        mean, std = mpf(mean), mpf(std)
        self.s = sqrt(log1p((std / mean) ** 2))
        self.m = mean / sqrt(1 + (std / mean) ** 2)
        self.width, self.centre = std, mean

    def density(self, x):
        return exp(-((log(x / self.m) / self.s) ** 2) / 2) / (self.s * x * sqrt(2 * pi))

    def survival(self, x):
        return upper(log(x / self.m) / self.s)


def above(law, x, order):
    """Integral of t^order p(t) above x, over panels that follow the fall of p."""
    x = mpf(x)
    # Over p(x), because quad stops at an absolute accuracy.
    size = law.density(x)
    ratio = size / law.density(x + law.width / 1000)
    fall = law.width / 1000 / log(ratio) if ratio > 1 else law.width
    step = min(fall, max(law.width, x / 20))
    low, total = x, mpf(0)
    while True:
        high = low + step
        part = quad(lambda t: t**order * (law.density(t) / size), [low, high])
        total += part
        if part < total * mpf(10) ** -26:
            return total * size
        low, step = high, step * mpf("1.15")


LAWS = [
    ("gaussian", Gaussian, [(1, 0.05), (1, 0.1), (1, 0.3), (0, 1), (2.5, 0.7), (1, 1e-8)]),
    ("gamma", Gamma, [(1, 0.1), (1, 0.25), (1, 0.5), (1, 2), (2, 0.45), (1, 0.01), (1, 1e-6)]),
    ("weibull", Weibull, [(12.153, 1.0431), (2, 1), (0.5, 1), (1.7, 3), (150, 1)]),
    ("lognormal", Lognormal, [(1, 0.1), (1, 0.3), (1, 1), (2, 0.5), (1, 1e-6)]),
]


def solve(law, level, accuracy):
    """The x > 0 with S(x) = level."""
    low, high = max(law.centre - 12 * law.width, mpf(0)), law.centre + law.width
    while law.survival(high) > level:
        low, high = high, high + 2 * (high - low)
    while high - low > accuracy * min(high, law.width):
        middle = (low + high) / 2
        low, high = (middle, high) if law.survival(middle) > level else (low, middle)
    return high


def text(value):
    return mp.nstr(value, 20, strip_zeros=True, min_fixed=-3, max_fixed=3)


def points():
    for name, kind, sets in LAWS:
        for pair in sets:
            law = kind(*pair)
            for q in ("0.999999", "0.9", "0.3", "1e-3", "1e-10", "1e-50", "1e-150", "1e-299"):
                # Some double near the level.
                with mp.workdps(20):
                    x = float(solve(law, mpf(q), mpf("1e-2")))
                s = law.survival(mpf(x))
                p = law.density(mpf(x))
                row = [p, s, -log(s), p / s] + [above(law, x, n) for n in (1, 3)]
                yield [name, *pair, repr(x)] + [text(v) for v in row]


def quantiles():
    for name, kind, sets in LAWS:
        for pair in sets:
            law = kind(*pair)
            if name == "gamma" and law.k > 1000:
                continue
            for q in ("1e-300", "1e-100", "1e-20", "1e-6", "0.01", "0.3", "0.5", "0.9"):
                q = mpf(float(q))
                top = solve(law, q, mpf("1e-25"))
                bottom = text(solve(law, 1 - q, mpf("1e-25"))) if q > mpf(10) ** -18 else ""
                yield [name, *pair, repr(float(q)), text(top), bottom]


def transform(law, s, name):
    """E[exp(-s x)] by quadrature over ln(x/centre), turned into the half-plane where it converges."""
    turn = mpf(0)
    if s.imag != 0 and (name == "lognormal" or name != "gaussian" and law.k < 2):
        # Not the least angle, so that the choice of angle is tested too.
        turn = max(abs(mp.arg(s)) - pi / 2, 0) * mpf("1.1") + mpf("0.1")
        turn = -turn if s.imag > 0 else turn
    rotation = exp(mpc(0, turn))

    def integrand(u):
        x = law.centre * exp(u) * rotation
        return law.density(x) * x * exp(-s * x)

    narrow = law.width / law.centre
    low = -max(mpf(60) * narrow, mpf(1)) if narrow < 0.5 else -mpf(260)
    if name in ("weibull", "gamma"):
        low = -mpf(70) / law.k if name == "weibull" or law.k < 10 else low
    if name == "lognormal":
        low = -16 * law.s
    high = 16 * law.s if name == "lognormal" else mpf(1)
    while abs(integrand(high)) > mpf(10) ** -28 and name != "lognormal":
        high += mpf("0.2")
    panels = max(40, int((high - low) / min(narrow, mpf("0.2"))))
    return quad(integrand, mp.linspace(low, high, panels))


def transforms():
    places = [(0.001, 0), (1, 0), (5, 0), (60, 0), (0, 6.25), (0, 60), (20, 30), (-0.2, 6.25), (-1.5, 5.5), (-3, 25)]
    for name, kind, sets in LAWS:
        for pair in sets:
            law = kind(*pair)
            if law.width < 1e-3 or name == "gamma" and law.k > 1000:
                continue
            for re, im in places:
                if name == "gamma" and re * law.t <= -0.5:
                    continue
                mp.dps = 30
                value = gaussian_transform(law, mpc(re, im)) if name == "gaussian" else transform(law, mpc(re, im), name)
                mp.dps = 40
                yield [name, *pair, re, im, text(value.real), text(value.imag)]


def gaussian_transform(law, s):
    low, high = mpf(0), law.m + 16 * law.s + max(-s.real, 0) * law.s**2
    return quad(lambda x: law.density(x) * exp(-s * x), mp.linspace(low, high, 80))


def write(name, header, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


if __name__ == "__main__":
    law = ["law", "first", "second"]
    write("law_points.csv", law + "x density survival minus_ln_survival hazard moment1 moment3".split(), points())
    write("law_quantiles.csv", law + ["q", "upper", "lower"], quantiles())
    write("law_transforms.csv", law + ["re", "im", "value_re", "value_im"], transforms())
