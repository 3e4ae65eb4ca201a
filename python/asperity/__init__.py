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
    Contacts,
    Description,
    Ensemble,
    EnsemblePull,
    Exponential,
    Gamma,
    Gaussian,
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
    SteadyState,
    Tabulated,
    Weibull,
    __version__,
    open_result,
    run,
)
from asperity._values import Atoms, Label, StaticFriction, StretchDensity

__all__ = [
    "Areas",
    "Atoms",
    "Contacts",
    "Description",
    "Ensemble",
    "EnsemblePull",
    "Exponential",
    "Gamma",
    "Gaussian",
    "Label",
    "Law",
    "Lognormal",
    "MasterEquation",
    "Mixture",
    "Model",
    "Point",
    "Pull",
    "Record",
    "Rectangular",
    "Relaxation",
    "Result",
    "StaticFriction",
    "SteadyState",
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
