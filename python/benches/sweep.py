"""CPU time of a sweep on a Dask cluster of two workers, beside that of a plain loop: python sweep.py [POINTS]

Each of the POINTS x POINTS cases (40 x 40 by default) of a map of stick-slip is computed by one thread.
"""

import sys
import time
from typing import Any

import asperity as asp
import psutil
from dask.distributed import Client, LocalCluster

SCENARIO = """
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
block = { stiffness = 1.0, slip = "arrest" }
drive.distance = 20.0
"""
KEEP = ["regime", "slips", "period"]


def seconds(process: psutil.Process) -> float:
    """CPU time of a process."""
    times = process.cpu_times()
    return float(times.user + times.system)


def main() -> None:
    points = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    axes = {
        "contacts.thresholds.gaussian.std": {"from": 0.05, "to": 0.3, "points": points},
        "block.stiffness": {"from": 0.2, "to": 5.0, "points": points, "scale": "log"},
    }
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    # The types of dask.distributed are incomplete.
    cluster: Any = LocalCluster(**options)  # type: ignore[no-untyped-call]
    client: Any = Client(cluster)  # type: ignore[no-untyped-call]
    with cluster, client:
        workers = [psutil.Process(pid) for pid in client.run(lambda: __import__("os").getpid()).values()]
        client.run(lambda: __import__("asperity") and None)
        before = sum(map(seconds, workers))
        begun = time.perf_counter()
        data = asp.sweep(SCENARIO, axes, KEEP, executor=client.get_executor())
        wall = time.perf_counter() - begun
        swept = sum(map(seconds, workers)) - before
    own = psutil.Process()
    before = seconds(own)
    for std in data.contacts_thresholds_gaussian_std.values.tolist():
        for stiffness in data.block_stiffness.values.tolist():
            asp.run(SCENARIO, {"contacts.thresholds.gaussian.std": std, "block.stiffness": stiffness})
    alone = seconds(own) - before
    print(f"{points * points} cases: CPU time {alone:.1f} s in a loop, {swept:.1f} s of two workers")
    print(f"{100.0 * (swept / alone - 1.0):+.1f} %")
    print(f"wall time of the cluster {wall:.1f} s")


if __name__ == "__main__":
    main()
