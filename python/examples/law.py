"""A distribution of thresholds of one's own, by its density alone.

The same in Rust is core/examples/law.rs.
"""

import asperity as asp
import numpy as np


def density(x):
    """The density, up to a factor: a parabola between stretches of 0.5 and 1.5."""
    return (x - 0.5) * (1.5 - x)


# Values on a grid suffice. The density is linear between them and normalised.
grid = 0.5 + np.arange(401) / 400
thresholds = asp.Tabulated(stretch=grid, density=density(grid))
print(f"mean {thresholds.mean():.6f}, standard deviation {thresholds.std():.6f}")

pull = asp.MasterEquation(asp.Contacts(thresholds)).pull(10.0)
if peak := pull.static_friction:
    print(f"static friction {peak.force:.6f} at X = {peak.position:.6f}")
# In closed form ⟨x²⟩/2⟨x⟩ = 21/40 for the parabola.
print(f"kinetic friction {pull.kinetic_friction:.5f}, closed form {0.525:.5f}")
