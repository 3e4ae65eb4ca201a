"""A velocity step and a hold, of contacts that age: the slider is moved through a history of velocities.

The same in Rust is core/examples/protocol.rs.
"""

import asperity as asp
import numpy as np

contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))

# Slow until sliding is steady, ten times as fast, a hold, and fast again; points every half unit of time, one
# at each end of the hold.
motion = [
    asp.Step(0.1, duration=100.0, points=2),
    asp.Step(1.0, duration=10.0, points=21),
    asp.Step(hold=1000.0, points=2),
    asp.Step(1.0, duration=10.0, points=21),
]
trace = asp.Transport(contacts).follow(motion)
for time in [100.0, 100.5, 110.0, 1110.0, 1110.5, 1111.0, 1120.0]:
    print(f"t = {time:6.1f}: F = {trace.force[np.searchsorted(trace['time'], time)]:.4f}")
