"""The thresholds of contacts from a measured curve of force, with errors.

The same in Rust is core/examples/fit.rs.
"""

import asperity as asp

# In place of a measurement: two thousand contacts of thresholds 1 ± 0.12, one by one.
real = asp.Contacts(asp.Gaussian(1.0, 0.12), count=2000)
measured = asp.Ensemble(real, size=2000, seed=7).pull(4.0, points=101)

# From a first guess. The noise of the contacts is part of the errors.
guess = asp.Contacts(asp.Gaussian(0.9, 0.2), count=2000)
found = asp.fit(guess, measured.position[1:], measured.force[1:], free=["thresholds.mean", "thresholds.std"])
for name in ["thresholds.mean", "thresholds.std"]:
    number = found.params[name]
    print(f"{name} = {number.value:.4f} ± {number.error:.4f}")
