"""Ctrl-C stops long computations soon, and other threads run meanwhile."""

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import asperity as asp
import numpy as np
import pytest

SCENARIO = Path(__file__).parents[2] / "scenarios" / "fig2.toml"
GAUSSIAN = asp.Contacts(asp.Gaussian(1.0, 0.05))
# Contacts that stay in phase over 50 000 mean thresholds: no steady sliding lets work end early.
NARROW = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 1e-3)))
EVEN = asp.Contacts(asp.Exponential(1.0))
SAMPLES = asp.Tabulated(samples=asp.Gaussian(1.0, 0.05).rvs(40, seed=1), exact=True)
AGEING = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.Smoluchowski(asp.Gaussian(1.0, 0.05), 0.0025))
RANKS = asp.Contacts(asp.Gamma(1.0, 2.0), ageing=asp.FrozenRank(asp.Gamma(1.5, 0.3), 1.0))
ROUGH = asp.Contacts(asp.Gaussian(1.0, 0.1))
INTERFACE = asp.Interface(
    ROUGH, [64, 64], connection=0.5, half_space=(1.0, 1.0), disorder=0.2, slip="overdamped", edges="periodic"
)
REBOUND = asp.Interface(ROUGH, [64, 64], connection=0.5, neighbours=1.0, disorder=0.2, viscosity=1.0)
LATTICE = asp.Lattice(ROUGH, [256, 256], asp.Rectangular(0.0, 0.5), neighbours=0.249, connection=0.004)
LAW = asp.Gamma(1.0, 0.5)
PULL = asp.MasterEquation(GAUSSIAN).pull(2.0)
MANY = np.linspace(0.0, 2.0, 2 * 10**7)
STEPS = list(1.0 + np.arange(200_000.0).reshape(-1, 1) % 7.0)
POSITION = np.linspace(0.02, 2.0, 100)
FIT = asp.fit(ROUGH, POSITION, np.sin(POSITION), free=["count", "thresholds.mean"], noise="white")
SOON = 0.2
# The drive takes a hundredth of what a contact lets go, so that an avalanche has millions of breaks.
AVALANCHE = asp.Lattice(ROUGH, [512, 512], neighbours=0.2475, connection=0.01, edges="periodic")

LONG: dict[str, Callable[[], object]] = {
    "annealed": lambda: asp.Ensemble(GAUSSIAN, size=10**9).pull(100.0),
    "quenched": lambda: asp.Ensemble(GAUSSIAN, size=10**9, disorder="quenched").pull(100.0),
    "far": lambda: asp.Ensemble(GAUSSIAN, size=10**6).pull(1e6),
    "many positions": lambda: asp.Ensemble(GAUSSIAN, size=10**9).pull(100.0, 10_000_001),
    "gamma": lambda: asp.Ensemble(asp.Contacts(asp.Gamma(1.0, 0.5)), size=10**9).pull(100.0),
    "master equation": lambda: NARROW.pull(1e6, 100_001),
    "samples": lambda: asp.MasterEquation(asp.Contacts(SAMPLES)).pull(20.0),
    "block": lambda: asp.Block(NARROW, 1.0, "overdamped").drive(1e7),
    "inertial block": lambda: asp.Block(NARROW, 1.0, asp.Inertial(1.0)).drive(1e7),
    "avalanches": lambda: asp.Block(asp.Ensemble(GAUSSIAN, size=10**6), 1.0, "arrest").drive(1e7),
    "drawing": lambda: asp.Block(asp.Ensemble(GAUSSIAN, size=10**7), 1.0).drive(1e7),
    "resets": lambda: asp.Block(asp.Ensemble(GAUSSIAN, size=2 * 10**6), 0.1).drive(1e7),
    "imposed force": lambda: asp.Block(asp.Ensemble(EVEN, size=10**6), None).drive(force_to=0.999),
    "diffusion": lambda: asp.Transport(AGEING, tolerance=1e-7).follow([asp.Step(1.0, distance=100.0)]),
    "ranks": lambda: asp.Transport(RANKS),
    "single contacts in time": lambda: asp.Ensemble(AGEING, size=10**8).follow(
        [asp.Step(0.1, distance=10.0)]
    ),
    "interface": lambda: INTERFACE.drive(1e7),
    "slides": lambda: REBOUND.drive(1e7),
    "lattice": lambda: LATTICE.drive(1e7, catalogue_from=1e6),
    "law of many": lambda: LAW.pdf(MANY),
    "force at many": lambda: PULL(MANY),
    "table": lambda: asp.Tabulated(samples=MANY, exact=True),
    "kernel density": lambda: asp.Tabulated(samples=MANY),
    "series": lambda: asp.Series(np.arange(200_001.0), STEPS),
    "most likely": lambda: asp.Weibull.fit(MANY[1:]),
    "draws": lambda: LAW.rvs(2 * 10**8, seed=1),
    "fit": lambda: asp.fit(
        AGEING, POSITION, np.sin(POSITION), free=["ageing.diffusion"], velocity=0.1, noise="white"
    ),
    "profile": lambda: FIT.profile("count", np.linspace(0.9, 1.1, 10**4)),
    "avalanche": lambda: AVALANCHE.drive(1.0, catalogue_from=1e6),
    "scenario": lambda: asp.run(SCENARIO, {"ensemble.size": 10**9}),
}


def delay(work: Callable[[], object]) -> float:
    """Seconds from a Ctrl-C after a third of a second to the end of the work."""
    sent: list[float] = []

    def send() -> None:
        sent.append(time.perf_counter())
        main = threading.main_thread().ident
        assert main is not None
        signal.pthread_kill(main, signal.SIGINT)

    timer = threading.Timer(0.3, send)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    return time.perf_counter() - sent[0]


@pytest.fixture
def listening() -> Iterator[None]:
    """Python listens to Ctrl-C, also where it was started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("listening")
@pytest.mark.parametrize("work", LONG.values(), ids=LONG.keys())
def test_ctrl_c_stops_soon(work: Callable[[], object]) -> None:
    # On a machine that does other things, the best of some.
    assert any(delay(work) < SOON for _ in range(5))


@pytest.mark.usefixtures("listening")
def test_a_checkpoint_that_is_being_written_is_given_up_for_the_one_before(tmp_path: Path) -> None:
    scenario = {
        "contacts": {"thresholds": asp.Gaussian(1.0, 0.1), "count": 1 << 18},
        "initial": {"rectangular": {"min": 0.0, "max": 0.5}},
        "interface": {
            "cells": [512, 512],
            "contacts": "one",
            "coupling": {"neighbours": {"stiffness": 0.2}},
            "connection": 0.2,
            "catalogue_from": 1e4,
        },
        "drive": {"distance": 1e4, "points": 11},
    }

    def stop(done: float) -> None:
        # Before the first step there is nothing to go on from.
        if done > 0.0:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        asp.run(scenario, folder=tmp_path / "out", checkpoint="1h", progress=stop)
    before = tmp_path / "out.checkpoint.0"
    kept = before.read_bytes()
    # The next one goes to a pipe, which holds a small part of it: the signal comes while it is written.
    pipe = tmp_path / f"out.checkpoint.{os.getpid()}.partial"
    os.mkfifo(pipe)
    rest: list[int] = []

    def read() -> None:
        main = threading.main_thread().ident
        assert main is not None
        with pipe.open("rb") as file:
            file.read(1)
            signal.pthread_kill(main, signal.SIGINT)
            time.sleep(0.5)
            rest.append(len(file.read()))

    reader = threading.Thread(target=read)
    reader.start()
    with pytest.raises(KeyboardInterrupt):
        asp.run(scenario, folder=tmp_path / "out", checkpoint=1, resume=True)
    reader.join()
    assert rest[0] < len(kept) / 2
    assert before.read_bytes() == kept
    assert not pipe.exists()


def test_other_threads_run_meanwhile() -> None:
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    asp.Ensemble(GAUSSIAN, size=10**6).pull(20.0, 11)
    done.set()
    thread.join()
    assert counted > 3
