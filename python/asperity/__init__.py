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
    Ageing,
    Areas,
    Block,
    Contacts,
    Description,
    Ensemble,
    EnsemblePull,
    Exponential,
    FrozenRank,
    Gamma,
    Gaussian,
    Inertial,
    Law,
    Logarithmic,
    Lognormal,
    MasterEquation,
    MeanField,
    Mixture,
    Model,
    Point,
    Pull,
    Record,
    Rectangular,
    Relaxation,
    Result,
    Smoluchowski,
    SteadyState,
    Step,
    StickSlip,
    Tabulated,
    Temperature,
    Transport,
    Weibull,
    __version__,
    open_result,
    run,
    velocity_curve,
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
    "Ageing",
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
    "FrozenRank",
    "Gamma",
    "Gaussian",
    "Inertial",
    "Label",
    "Law",
    "Logarithmic",
    "Lognormal",
    "MasterEquation",
    "MeanField",
    "Mixture",
    "Model",
    "Point",
    "Potential",
    "Pull",
    "Record",
    "Rectangular",
    "Relaxation",
    "Result",
    "Sizes",
    "Smoluchowski",
    "State",
    "StaticFriction",
    "SteadyState",
    "Step",
    "StickSlip",
    "StretchDensity",
    "Tabulated",
    "Temperature",
    "Transport",
    "Weibull",
    "__version__",
    "exact",
    "law",
    "open_result",
    "run",
    "velocity_curve",
]

Mapping.register(Record)
