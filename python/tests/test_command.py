"""The command that comes with the package: `python -m asperity`, and the script `asperity`."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import asperity as asp
import pytest

SCENARIO = """
[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.1 }

[pull]
distance = 5.0
points = 101
"""


def run(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-P", "-m", "asperity", *arguments]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=60)


def test_the_command_runs_a_scenario(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(SCENARIO, encoding="utf-8")
    done = run("run", "small.toml", "--figures", "svg", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "F_k = 0.505" in done.stdout
    result = asp.open_result(tmp_path / "out" / "small")
    assert result["force"].shape == (101,)
    assert (tmp_path / "out" / "small" / "force.svg").exists()


def test_version_help_and_errors_are_those_of_the_program(tmp_path: Path) -> None:
    assert run("--version", folder=tmp_path).stdout == f"asperity {asp.__version__}\n"
    assert "Usage: asperity" in run("--help", folder=tmp_path).stdout
    (tmp_path / "wrong.toml").write_text(SCENARIO.replace("5.0", "-5.0"), encoding="utf-8")
    wrong = run("check", "wrong.toml", folder=tmp_path)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert "pull.distance: expected a number above 0, got -5" in wrong.stderr
    unknown = run("rnu", folder=tmp_path)
    assert unknown.returncode == 2
    assert "unrecognized subcommand" in unknown.stderr


def threads(process: subprocess.Popen[str]) -> set[str]:
    """Names of the threads of a process."""
    return {path.read_text().strip() for path in Path(f"/proc/{process.pid}/task").glob("*/comm")}


@pytest.mark.skipif(sys.platform != "linux", reason="names of threads are read from /proc")
@pytest.mark.parametrize("before", [signal.SIG_DFL, signal.SIG_IGN])
def test_an_interrupt_ends_the_command_with_its_exit_code(tmp_path: Path, before: signal.Handlers) -> None:
    # A lattice of many cells takes minutes.
    example = run("example", "half-space-512", folder=tmp_path).stdout
    (tmp_path / "long.toml").write_text(example, encoding="utf-8")
    # Python handles interrupts if they have their default action, and does not if they are ignored, as in
    # background jobs.
    start = f"import signal, os, sys; signal.signal(2, {int(before)}); os.execv(sys.executable, sys.argv[1:])"
    command = [sys.executable, "-P", "-m", "asperity", "run", "long.toml", "--quiet"]
    line = [sys.executable, "-c", start, *command]
    process = subprocess.Popen(line, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    # The command names the thread that looks for signals.
    while process.poll() is None and "interrupts" not in threads(process):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert (process.returncode, errors) == (130, "interrupted: nothing was written\n")
    assert not (tmp_path / "out").exists()
