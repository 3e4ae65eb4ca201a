"""Shipped scenarios that take long, with changes that make them short; `make results` runs them in full."""

from typing import Any

SMALLER: dict[str, dict[str, Any]] = {
    "aftershocks": {"interface.cells": [32, 32], "contacts.count": 1024, "interface.main_shocks.size": 20},
    "creep": {"creep.forces": [0.65, 0.7], "creep.points": 21},
    "healing": {"hold_curve.points": 5, "ensemble.size": 100},
    "hold-chain": {"interface.cells": [5]},
    "laboratory": {"ensemble.size": 100},
    "renormalised": {"interface.cells": [30, 30], "renormalisation.runs": 2},
    "renormalised-cells": {"interface.cells": [8, 8], "renormalisation.runs": 2},
    "stability": {
        "stability.velocities": [1e-3, 1e-2],
        "stability.stiffnesses": [0.05, 1.0],
        "stability.resolution": 1.0,
    },
    "velocity-curve-ageing": {"velocity_curve.points": 3, "ensemble.size": 100},
    "velocity-curve-thermal": {"velocity_curve.points": 3, "ensemble.size": 100},
}
