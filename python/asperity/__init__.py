"""Friction at the mesoscale: many elastic contacts that stretch, break and re-form.

    contacts = asperity.Contacts(thresholds=asperity.Gaussian(1.0, 0.05))
    theory = asperity.MasterEquation(contacts, initial=asperity.Gaussian(0.1, 0.025))
    pull = theory.pull(distance=20, points=2001)
    pull.static_friction, pull.kinetic_friction, pull.force

Lengths, forces and densities are in whatever units the description is in: numbers are never converted.
"""

from collections.abc import Mapping

from asperity import exact
from asperity._bridge import law
from asperity._core import (
    Areas,
    Block,
    Contacts,
    Description,
    Ensemble,
    EnsemblePull,
    Exponential,
    Gamma,
    Gaussian,
    Inertial,
    Law,
    Lognormal,
    MasterEquation,
    Mixture,
    Model,
    Point,
    Pull,
    Record,
    Rectangular,
    Relaxation,
    Result,
    Series,
    SteadyState,
    StickSlip,
    Tabulated,
    Weibull,
    __version__,
    open_result,
    run,
)
from asperity._events import Event, Events
from asperity._values import (
    Atoms,
    Course,
    Energy,
    Equilibria,
    Label,
    Potential,
    Sizes,
    State,
    StaticFriction,
    StretchDensity,
)

__all__ = [
    "Areas",
    "Atoms",
    "Block",
    "Contacts",
    "Course",
    "Description",
    "Energy",
    "Ensemble",
    "EnsemblePull",
    "Equilibria",
    "Event",
    "Events",
    "Exponential",
    "Gamma",
    "Gaussian",
    "Inertial",
    "Label",
    "Law",
    "Lognormal",
    "MasterEquation",
    "Mixture",
    "Model",
    "Point",
    "Potential",
    "Pull",
    "Record",
    "Rectangular",
    "Relaxation",
    "Result",
    "Series",
    "Sizes",
    "State",
    "StaticFriction",
    "SteadyState",
    "StickSlip",
    "StretchDensity",
    "Tabulated",
    "Weibull",
    "__version__",
    "exact",
    "law",
    "open_result",
    "run",
]

Mapping.register(Record)
