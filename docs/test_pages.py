"""What the pages show in Python is run: the blocks of a page in order, in one folder and one namespace.

`python` is a script, `pycon` a session whose output is compared. `toml` that begins with `# NAME` is kept
under that name, and `console` is run in bash; what it prints is compared by cli/tests/documents.rs, which
says more of such blocks.
"""

import doctest
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import asperity
import ipynb
import matplotlib.pyplot as plt
import nbclient
import nbformat
import pytest
import snowballstemmer

ROOT = Path(__file__).parents[1]
PYTHON = {"python", "pycon"}
FENCED = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> list[tuple[str, str, int]]:
    """The language, the text and the line of each block of code."""
    text = page.read_text(encoding="utf-8")
    return [(found[1], found[2], text.count("\n", 0, found.start()) + 1) for found in FENCED.finditer(text)]


PAGES = [
    page
    for page in sorted((ROOT / "docs").rglob("*.md"))
    if PYTHON & {language for language, *_ in blocks(page)}
]


def site() -> Path:
    """The folder of the site, which is built before these tests."""
    return ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "docs"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder but for the shipped scenarios, entered, with `asperity` on the path."""
    shutil.copytree(ROOT / "scenarios", tmp_path / "scenarios")
    program = tmp_path / "bin" / "asperity"
    program.parent.mkdir()
    manifest = ROOT / "Cargo.toml"
    program.write_text(
        f'#!/bin/sh\nexec cargo run --release --locked --quiet --manifest-path "{manifest}" -- "$@"\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent), prepend=os.pathsep)
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_python_of_a_page_runs(page: Path, folder: Path) -> None:
    names: dict[str, object] = {"__name__": "__main__"}
    for language, text, line in blocks(page):
        if language == "python":
            exec(compile("\n" * line + text, page, "exec"), names)
        elif language == "pycon":
            converse(text, names, page, line)
        elif language == "toml" and (name := re.match(r"# (\S+\.toml)\n", text)):
            (folder / name[1]).write_text(text, encoding="utf-8")
        elif language == "console":
            for command in re.findall(r"^\$ (.*)$", text, re.MULTILINE):
                subprocess.run(["bash", "-c", command], check=True)


def converse(text: str, names: dict[str, object], page: Path, line: int) -> None:
    """Compares what a session prints with what is shown."""
    session = doctest.DocTestParser().get_doctest(text, names, page.name, str(page), line)
    report: list[str] = []
    results = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(
        session, out=report.append, clear_globs=False
    )
    names.update(session.globs)
    assert results.attempted > 0
    assert results.failed == 0, "".join(report)


NOTEBOOKS = [page for page in sorted((ROOT / "docs" / "notebooks").glob("*.md")) if page.stem != "index"]


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_notebooks_for_download_have_the_cells_of_their_pages_and_run(
    page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = page.read_text(encoding="utf-8")
    made = ipynb.notebook(text)
    nbformat.validate(nbformat.from_dict(made))
    code = [cell["source"] for cell in made["cells"] if cell["cell_type"] == "code"]
    assert code == [body.strip("\n") for language, body, _ in blocks(page) if language == "{code-cell}"]
    assert "{code-cell}" not in str([cell["source"] for cell in made["cells"]])
    beside = folder / "docs" / "notebooks"
    beside.mkdir(parents=True)
    monkeypatch.chdir(beside)
    names: dict[str, object] = {"__name__": "__main__"}
    for number, source in enumerate(code):
        exec(compile(source, f"{page.stem}.ipynb, cell {number}", "exec"), names)
        # A notebook shows the figures of a cell and closes them.
        plt.close("all")


def test_the_site_offers_all_notebooks_and_jupyter_runs_one(folder: Path) -> None:
    """All of them are run cell by cell above; a kernel of Jupyter takes seconds to start."""
    offered = site() / "notebooks"
    for page in NOTEBOOKS:
        made = json.loads((offered / f"{page.stem}.ipynb").read_text(encoding="utf-8"))
        assert made == ipynb.notebook(page.read_text(encoding="utf-8")), page.stem
    run = nbformat.read(offered / "areas.ipynb", as_version=4)
    nbclient.NotebookClient(run, resources={"metadata": {"path": folder}}).execute()
    outputs = [cell.outputs for cell in run.cells if cell.cell_type == "code"]
    assert any(outputs)


# Words of the field in the glossary.
FIELD = """
    stress drop recurrence load point ageing slip law state variable direct effect nucleation precursors
    d_c asperity junction healing epicentre foreshocks afterslip aperiodicity
"""


def test_the_search_of_the_site_finds_the_words_of_the_field() -> None:
    """The index of the site that was built before these tests has the stems of words, each with its pages."""
    index = site() / "searchindex.js"
    found = json.loads(index.read_text(encoding="utf-8").removeprefix("Search.setIndex(").removesuffix(")"))
    page = found["docnames"].index("glossary")
    stem = snowballstemmer.stemmer("english").stemWord
    for word in FIELD.split():
        listed = [found[index].get(stem(word), []) for index in ("terms", "titleterms")]
        assert any(page in (pages if isinstance(pages, list) else [pages]) for pages in listed), word


def test_there_are_pages_in_python() -> None:
    assert len(PAGES) >= 7


def test_every_name_of_the_package_is_documented() -> None:
    page = (ROOT / "docs" / "api" / "python.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\.\. auto\w+:: asperity\.(\w+)$", page, re.MULTILINE)
    for base in re.findall(r"^\.\. subclasses:: asperity\.(\w+)$", page, re.MULTILINE):
        shown += [derived.__name__ for derived in getattr(asperity, base).__subclasses__()]
    assert sorted(shown) == sorted(set(asperity.__all__) - {"__version__"})
