"""Runs on demand: one line in, CPU seconds and a number out."""

import sys
import time


def answer(run):
    """Runs once for nothing (compilation, caches), then once for every line on stdin."""
    run()
    print("ready", flush=True)
    for _ in sys.stdin:
        start = time.process_time()
        value = run()
        print(time.process_time() - start, value, flush=True)
