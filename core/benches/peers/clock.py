"""Runs on demand: one line in, CPU seconds and a number out."""

import sys
import time


def answer(run, warm=True):
    """Runs once for nothing (compilation, caches) if it is to be warm, then once for every line on stdin."""
    if warm:
        run()
    print("ready", flush=True)
    for _ in sys.stdin:
        start = time.process_time()
        value = run()
        print(time.process_time() - start, value, flush=True)
