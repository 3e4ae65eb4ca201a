"""What the documents show of Python is run, and prints and draws what they show."""

import re
import subprocess
from pathlib import Path

import pytest
from documents import FIGURES, ROOT, pages, run

matplotlib = pytest.importorskip("matplotlib")


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)
def test_blocks_print_what_is_shown(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for printed, shown in run(page):
        assert printed == shown


@pytest.mark.parametrize(("page", "drawn", "kept"), FIGURES, ids=lambda name: Path(name).name)
def test_a_document_draws_its_figure(
    page: Path, drawn: str, kept: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run(page)
    figure = (ROOT / "docs" / "figures" / kept).read_text(encoding="utf-8")
    assert looks_like(figure, (tmp_path / drawn).read_text(encoding="utf-8")), (
        f"{kept} is out of date: make figures"
    )


def test_scripts_for_clusters_can_be_read() -> None:
    """What needs a cluster is not run, but has no error of syntax."""
    text = (ROOT / "docs" / "how-to" / "cluster.md").read_text(encoding="utf-8")
    blocks: list[str] = re.findall(r"^```text\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    shell = [block for block in blocks if block.startswith("#!/bin/bash\n")]
    scripts = [block for block in blocks if block.startswith("#!/usr/bin/env python3\n")]
    assert len(shell) >= 3
    assert len(scripts) >= 2
    for block in shell:
        subprocess.run(["bash", "-n"], input=block, text=True, check=True)
    for block in scripts:
        compile(block, "cluster.md", "exec")


def looks_like(one: str, other: str) -> bool:
    """Whether the curves of two drawings are the same to a tenth of a dot."""
    paths = [re.findall(r' d="([^"]*)"', text) for text in (one, other)]
    numbers = [[float(number) for number in re.findall(r"-?\d+\.?\d*", " ".join(path))] for path in paths]
    return len(numbers[0]) == len(numbers[1]) > 1000 and all(
        abs(a - b) <= 0.1 for a, b in zip(*numbers, strict=True)
    )
