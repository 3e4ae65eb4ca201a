"""The force from the first loading to steady sliding: the contacts of Fig. 2 of Braun and Peyrard (2008).

The same in Rust is core/examples/pull.rs.
"""

import asperity as asp

# Thresholds of mean 1 and standard deviation 0.05; contacts that break re-form without stretch.
contacts = asp.Contacts(asp.Gaussian(1.0, 0.05))
initial = asp.Gaussian(0.1, 0.025)

# Infinitely many contacts, by the master equation.
equation = asp.MasterEquation(contacts, initial)
pull = equation.pull(20.0)
for position in [0.5, 1.0, 2.0, 5.0, 20.0]:
    print(f"F({position:g}) = {pull(position):.6f}")
if peak := pull.static_friction:
    print(f"static friction {peak.force:.6f} at X = {peak.position:.6f}")
print(f"kinetic friction {pull.kinetic_friction:.6f}")
print(f"critical stiffness {pull.critical_stiffness:.4f}")

# A thousand contacts, one by one, with the standard error of their force.
sample = asp.Ensemble(contacts, initial, size=1000, seed=1).pull(5.0, points=2)
print(f"a thousand contacts: F(5) = {sample.force[-1]:.6f} ± {sample.force_error[-1]:.6f}")
