"""Derivatives of the survival function of the gamma distribution by mean and standard deviation, times the latter, by
central differences in 60-digit arithmetic: python make_gamma_derivatives.py > gamma_derivatives.csv"""

import mpmath as mp

mp.mp.dps = 60
STEP = mp.mpf(10) ** -12


def survival(mean, std, x):
    return mp.gammainc((mean / std) ** 2, x * mean / std**2, mp.inf, regularized=True)


def derivative(f):
    return (8 * (f(STEP) - f(-STEP)) - (f(2 * STEP) - f(-2 * STEP))) / (12 * STEP)


print("mean,std,x,by_mean,by_std")
for mean, std in [(1, 5), (1, 1.6), (1, 1), (1, 0.5), (2, 0.4), (1, 0.225), (1, 0.2), (1, 0.05), (1, 0.01)]:
    places = {mean + z * std for z in (-3, -2, -1, -0.25, 0, 0.5, 1, 2, 4, 7)} | {0.001 * mean, 0.1 * mean, 0.4 * mean}
    for x in sorted(x for x in places if x > 0):
        m, s, at = mp.mpf(mean), mp.mpf(std), mp.mpf(x)
        by_mean = derivative(lambda t: survival(m + t * s, s, at))
        by_std = derivative(lambda t: survival(m, s * (1 + t), at))
        print(f"{mean},{std},{x!r},{mp.nstr(by_mean, 18)},{mp.nstr(by_std, 18)}")
