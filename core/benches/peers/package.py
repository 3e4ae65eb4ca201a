"""The Python package of asperity, Fig. 2 to X = 20 at 2001 points; prints F(5)."""

import asperity as asp

from clock import answer


def pull():
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.05))
    theory = asp.MasterEquation(contacts, asp.Gaussian(0.1, 0.025))
    return theory.pull(distance=20.0, points=2001).force[500]


answer(pull)
