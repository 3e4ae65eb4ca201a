"""The command that comes with the package: `python -m asperity`, and the script `asperity`."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import asperity as asp

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


def test_an_interrupt_ends_the_command_with_its_exit_code(tmp_path: Path) -> None:
    # A lattice of many cells takes minutes.
    example = run("example", "half-space-512", folder=tmp_path).stdout
    (tmp_path / "long.toml").write_text(example, encoding="utf-8")
    line = [sys.executable, "-P", "-m", "asperity", "run", "long.toml", "--quiet"]
    process = subprocess.Popen(line, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    time.sleep(2.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert (process.returncode, errors) == (130, "interrupted: nothing was written\n")
    assert not (tmp_path / "out").exists()
