"""Forked processes compute what their parent does, also after it has computed."""

import multiprocessing
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection

import asperity as asp
import numpy as np
import pytest
from numpy.typing import NDArray

pytestmark = [
    pytest.mark.skipif(
        "fork" not in multiprocessing.get_all_start_methods(), reason="this system has no fork"
    ),
    # Newer versions of Python warn of forks where there are threads.
    pytest.mark.filterwarnings("ignore:.*multi-threaded:DeprecationWarning"),
]

# Long enough for a loaded machine; a child that waits for lost threads never ends.
PATIENCE = 60.0

Numbers = NDArray[np.float64]


def force() -> Numbers:
    return asp.Ensemble(asp.Contacts(asp.Gaussian(1.0, 0.1)), size=20_000).pull(3.0, 31).force


def in_a_thread() -> Numbers:
    found: list[Numbers] = []
    thread = threading.Thread(target=lambda: found.append(force()))
    thread.start()
    thread.join()
    return found[0]


def interface() -> Numbers:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
    slider = asp.Interface(contacts, [32, 32], connection=0.5, half_space=(1.0, 1.0), disorder=0.1)
    return slider.drive(1.5, 11)["force"]


def sampled() -> Numbers:
    """Draws from a posterior, whose chains run on threads of their own."""
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.02, time=1.0))
    velocity = np.logspace(-3.0, 1.0, 9)
    force = 1.01 * asp.velocity_curve(contacts, velocity).kinetic_friction
    found = asp.fit_velocity_curve(contacts, velocity, force, free=["count"], reading=0.01)
    return found.sample(draws=20, chains=2, seed=1).draws["count"]


def forked(work: Callable[[], Numbers]) -> Numbers:
    """What `work` finds in a forked process."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)

    def child(end: Connection) -> None:
        end.send(work())

    process = context.Process(target=child, args=(there,))
    process.start()
    try:
        assert here.poll(PATIENCE), "the child does not end"
        found: Numbers = here.recv()
    finally:
        process.kill()
        process.join()
    return found


@pytest.mark.parametrize("work", [force, in_a_thread, interface, sampled])
def test_a_fork_computes_the_same(work: Callable[[], Numbers]) -> None:
    assert np.array_equal(forked(work), work())


def test_a_fork_of_a_fork_computes_the_same() -> None:
    def twice() -> Numbers:
        force()
        return forked(force)

    assert np.array_equal(forked(twice), force())
