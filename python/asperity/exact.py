"""Closed forms: friction curves, steady states and variances without a numerical solution.

Forces are per total stiffness, F/(N_c⟨k⟩): the mean stretch of the contacts, in the unit of the thresholds.
"""

from asperity._core import (
    ClosedForm,
    ExactErlang as Erlang,
    ExactGamma as Gamma,
    ExactGaussian as Gaussian,
    ExactIdentical as Identical,
    ExactQuenched as Quenched,
    ExactRectangular as Rectangular,
    kinetic_friction,
    kinetic_friction_per_threshold,
    steady_variance,
    steady_variance_per_threshold,
)

__all__ = [
    "ClosedForm",
    "Erlang",
    "Gamma",
    "Gaussian",
    "Identical",
    "Quenched",
    "Rectangular",
    "kinetic_friction",
    "kinetic_friction_per_threshold",
    "steady_variance",
    "steady_variance_per_threshold",
]
