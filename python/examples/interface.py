"""An interface of sixteen cells, from event to event, with the state of every cell in between.

The same in Rust is core/examples/interface.rs.
"""

import asperity as asp

contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))

# Cells share a curve F(X) up to a scale of their lengths: the fifth is weak, the others rise along the chain.
scales = [0.8 if j == 4 else 1.0 + 0.01 * j for j in range(16)]
chain = asp.Interface(contacts, [16], connection=0.5, neighbours=0.3, disorder=scales).simulation()

# Each event is yielded after it has happened; the state is then the one just after it.
for event in chain.events(until=4.0):
    cells = f"{event.cells:.0f} cells from cell {event.epicentre:.0f}"
    print(f"X_T = {event.drive:.4f}: {cells}, force drop {event.drop:.4f}")
print(
    f"at X_T = {chain.drive:.1f} cell 0 is at {chain.positions[0]:.4f}, cell 15 at {chain.positions[15]:.4f}"
)
