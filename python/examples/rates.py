"""Friction against velocity, of contacts that temperature breaks before their thresholds.

The same in Rust is core/examples/rates.rs.
"""

import asperity as asp

# The barrier is the elastic energy that a contact lacks to its threshold; T = 0.05 k⟨x_s⟩², attempt rate 1.
thresholds = asp.Gaussian(1.0, 0.1)
contacts = asp.Contacts(thresholds, temperature=asp.Temperature(energy=0.05, attempt_rate=1.0))

for exponent in [-4, -3, -2, -1, 0]:
    steady = asp.MasterEquation(contacts, velocity=10.0**exponent).steady_state()
    print(f"F_k(1e{exponent}) = {steady.kinetic_friction:.6f}")

# Fast sliding leaves temperature no time.
athermal = asp.MasterEquation(asp.Contacts(thresholds)).steady_state()
print(f"without temperature {athermal.kinetic_friction:.6f}")
