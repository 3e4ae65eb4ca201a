"""Three cells, each connected to both others: a ring, in which each is the neighbour of both others.

core/examples/coupling.rs computes the same with an elastic coupling of its own, for any number of cells.
"""

import asperity as asp

contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
ring = asp.Interface(
    contacts, [3], connection=0.5, neighbours=0.1, edges="periodic", disorder=[0.9, 1.0, 1.1]
)
simulation = ring.simulation()
for event in simulation.events(until=4.0):
    print(f"X_T = {event.drive:.4f}: {event.cells:.0f} of 3 cells, force drop {event.drop:.4f}")
print(f"force {simulation.force:.4f} at X_T = {simulation.drive:.1f}")
