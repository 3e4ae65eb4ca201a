"""The number of threads of one computation: results do not depend on it, and wrong numbers are refused."""

import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path

import asperity as asp
import numpy as np
import pytest

ROUGH = asp.Contacts(asp.Gaussian(1.0, 0.1))
INTERFACE = asp.Interface(
    ROUGH, [16, 16], connection=0.5, half_space=(1.0, 1.0), disorder=0.2, slip="overdamped", edges="periodic"
)
POSITION = np.linspace(0.02, 2.0, 100)
FIT = asp.fit(ROUGH, POSITION, np.sin(POSITION), free=["count", "thresholds.mean"], noise="white")
SCENARIO = Path(__file__).parents[2] / "scenarios" / "fig2.toml"

WORK: dict[str, Callable[[int | None], bytes]] = {
    "pull": lambda threads: asp.Ensemble(ROUGH, size=20_000).pull(3.0, 301, threads=threads).force.tobytes(),
    "drive": lambda threads: INTERFACE.drive(3.0, 11, threads=threads)["force"].tobytes(),
    "sample": lambda threads: FIT.sample(20, 2, threads=threads).draws["count"].tobytes(),
    "run": lambda threads: asp.run(SCENARIO, threads=threads)["ensemble_force"].tobytes(),
}


@pytest.mark.parametrize("work", WORK.values(), ids=WORK.keys())
def test_results_do_not_depend_on_threads(work: Callable[[int | None], bytes]) -> None:
    assert work(1) == work(2) == work(None)


@pytest.mark.parametrize("work", WORK.values(), ids=WORK.keys())
def test_wrong_numbers_are_refused(work: Callable[[int | None], bytes]) -> None:
    most = 8 * len(os.sched_getaffinity(0))
    for wrong in [0, most + 1, 10**30]:
        with pytest.raises(ValueError, match="threads: expected"):
            work(wrong)
    with pytest.raises(TypeError):
        work("two")  # type: ignore[arg-type]


def test_progress_is_reported_and_errors_of_the_listener_stop_the_work() -> None:
    heard: list[float] = []
    asp.Ensemble(ROUGH, size=200_000).pull(20.0, progress=heard.append, threads=2)
    assert heard[-1] == 1.0
    assert heard == sorted(heard)

    def refuse(_: float) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        asp.Ensemble(ROUGH, size=10**8).pull(20.0, progress=refuse, threads=1)


def test_ctrl_c_stops_work_on_other_threads() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            asp.Ensemble(ROUGH, size=10**9).pull(100.0, threads=2)
    finally:
        signal.signal(signal.SIGINT, before)


def test_the_environment_limits_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASPERITY_MEMORY", "1MB")
    with pytest.raises(MemoryError, match="1000000 allowed"):
        asp.Ensemble(ROUGH, size=1000).pull(3.0, 1_000_001)
    monkeypatch.setenv("ASPERITY_MEMORY", "much")
    with pytest.raises(ValueError, match="ASPERITY_MEMORY: expected an amount of memory"):
        asp.Ensemble(ROUGH, size=1000).pull(3.0)
