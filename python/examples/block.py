"""Stick-slip of a block that is pulled through a soft spring.

The same in Rust is core/examples/block.rs.
"""

import asperity as asp

equation = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))

# Slips are possible behind springs softer than the steepest fall of the force.
print(f"critical stiffness {equation.pull(20.0).critical_stiffness:.4f}")

# In a slip all contacts break, and the spring relaxes: the rule of the paper.
run = asp.Block(equation, stiffness=1.0, slip="reset").drive(8.0)
for slip in run.events:
    print(
        f"slip at X_T = {slip.drive:.5f}: from X = {slip.position_before:.5f} by {slip.slip:.5f}, "
        f"force drop {slip.drop:.5f}"
    )
