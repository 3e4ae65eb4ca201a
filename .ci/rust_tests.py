"""Runs the test programs of `cargo test`, two at a time: one by one, a long test leaves a core idle.

    python .ci/rust_tests.py --package NAME ...

The arguments are those of `cargo test` for packages and profiles. Programs start in the order of the time
they took last, which is kept in the target folder; without that those of the command, which take longest,
start first. What a program prints is shown when it fails; the examples in the documentation follow.
"""

import json
import math
import os
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

WORKERS = 2
PRINTING = threading.Lock()
TIMES = Path(os.environ.get("CARGO_TARGET_DIR", "target")) / "test-times.json"


def programs(arguments: list[str]) -> list[tuple[str, Path, str]]:
    """Name, folder of the package, and path of each test program, which are compiled."""
    command = ["cargo", "test", *arguments, "--no-run", "--message-format", "json-render-diagnostics"]
    found = []
    for line in subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines():
        message = json.loads(line)
        if message["reason"] == "compiler-artifact" and message["profile"]["test"] and message["executable"]:
            folder = Path(message["manifest_path"]).parent
            found.append((f"{folder.name}/{message['target']['name']}", folder, message["executable"]))
    return found


def run(name: str, folder: Path, program: str) -> tuple[float, int]:
    """Runs a program as `cargo test` does; its seconds, and 1 if it failed."""
    environment = os.environ | {"CARGO_MANIFEST_DIR": str(folder)}
    begin = time.monotonic()
    done = subprocess.run(
        [program, "--quiet"],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    seconds = time.monotonic() - begin
    result = next((line for line in done.stdout.splitlines() if line.startswith("test result:")), "no result")
    with PRINTING:
        print(f"{seconds:7.1f} s  {name}: {result.removeprefix('test result: ')}", flush=True)
        if done.returncode:
            print(done.stdout, flush=True)
    return seconds, int(done.returncode != 0)


def main() -> int:
    """Compiles and runs; 1 if a program failed."""
    arguments = sys.argv[1:]
    took = json.loads(TIMES.read_text()) if TIMES.exists() else {}
    # Cargo compiles the command last.
    found = programs(arguments)[::-1]
    found.sort(key=lambda program: -took.get(program[0], math.inf))
    if not found:
        print("cargo test has built no test program", file=sys.stderr)
        return 1
    with ThreadPoolExecutor(WORKERS) as workers:
        results = list(workers.map(lambda program: run(*program), found))
    names = [name for name, _, _ in found]
    seconds = {name: seconds for name, (seconds, _) in zip(names, results, strict=True)}
    TIMES.write_text(json.dumps(took | seconds))
    failed = [name for name, (_, bad) in zip(names, results, strict=True) if bad]
    documentation = subprocess.run(["cargo", "test", *arguments, "--doc"]).returncode
    if failed:
        print("failed:", ", ".join(failed), file=sys.stderr)
    return int(bool(failed) or documentation != 0)


if __name__ == "__main__":
    sys.exit(main())
