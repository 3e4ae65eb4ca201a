"""Reference values of the spectrum of the force in steady sliding in 60-digit arithmetic: spectrum.csv.

Thresholds and re-forming stretches are Gaussian, the latter below all thresholds. Then both are independent, and S(q)
per contact and unit stiffness follows from the expectations over one life in the documentation of SteadyState::spectrum.
Run with mpmath: python make_spectrum.py
"""

from pathlib import Path

from mpmath import exp, mp, mpf, nstr

mp.dps = 60
CASES = [(1.0, 0.1, 0.0, 0.0), (1.0, 0.01, 0.0, 0.0), (1.0, 0.08, 0.15, 0.02), (1.0, 0.02, 0.1, 0.005)]
WAVE_NUMBERS = [0.01, 0.3, 1.0, 3.99, 4.01, 6.0, 6.28, 9.0, 20.0, 100.0, 1000.0, 10000.0]


def gaussian(mean, std):
    """E e^{iqx}, E x e^{iqx}, <x>, <x^2>."""

    def transform(q):
        return exp(1j * q * mean - (q * std) ** 2 / 2)

    return transform, lambda q: (mean + 1j * q * std**2) * transform(q), mean, mean**2 + std**2


def spectrum(thresholds, reforming, q):
    (t, tx, x, x2), (r, rr, start, start2) = thresholds, reforming
    g, gr, gx, grx = t(q) * r(-q), t(q) * rr(-q), tx(q) * r(-q), tx(q) * rr(-q)
    alpha, beta = gr - x * g, start * g - gx
    gamma = start * gr - grx - x * start * g + x * gx
    jumps = x2 + start2 - 2 * start * x
    return (jumps + 2 * (gamma + alpha * beta / (1 - g)).real) / (q * q * (x - start))


def main():
    lines = ["mean,std,reforming_mean,reforming_std,wave_number,spectrum"]
    for case in CASES:
        mean, std, start, spread = map(mpf, case)
        for q in WAVE_NUMBERS:
            value = spectrum(gaussian(mean, std), gaussian(start, spread), mpf(q))
            lines.append(",".join([*map(str, case), str(q), nstr(value, 20)]))
    Path(__file__).with_name("spectrum.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
