"""Pages of docs/notebooks as Jupyter notebooks, which the site offers for download."""

import json
import re
from pathlib import Path

CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```\n?", re.MULTILINE | re.DOTALL)
EQUATION = re.compile(r"^```math\n(.*?)\n```$", re.MULTILINE | re.DOTALL)


def notebook(page: str) -> dict:
    """A page in MyST Markdown as the content of a notebook, without outputs."""
    text = re.sub(r"\A---\n.*?\n---\n", "", page, flags=re.DOTALL)
    parts = CELL.split(text)
    cells = []
    for index, part in enumerate(parts):
        source = part.strip("\n")
        if source:
            cells.append(code(source) if index % 2 else prose(source))
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}


def code(source: str) -> dict:
    return {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": [], "source": source}


def prose(source: str) -> dict:
    """Text, whose equations Jupyter shows between dollars."""
    return {"cell_type": "markdown", "metadata": {}, "source": EQUATION.sub(r"$$\n\1\n$$", source)}


def written(pages: Path, folder: Path) -> None:
    """Writes the notebooks of a folder of pages."""
    folder.mkdir(parents=True, exist_ok=True)
    for page in sorted(pages.glob("*.md")):
        if page.stem != "index":
            content = notebook(page.read_text(encoding="utf-8"))
            text = json.dumps(content, ensure_ascii=False, indent=1)
            (folder / f"{page.stem}.ipynb").write_text(text + "\n", encoding="utf-8")
