"""What is said of the project in files for others: citation, packages, workflows, containers."""

import importlib.util
import json
import re
import shutil
import tarfile
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
DATE = "2026-12-24"


def loaded(name: str) -> ModuleType:
    """A script of `.ci` as a module."""
    found = importlib.util.spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


metadata, packages = loaded("metadata"), loaded("packages")
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The files that have version, date or address, in a folder of their own."""
    for name in [*metadata.places(metadata.declared(ROOT)), "CHANGELOG.md"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def replace(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def test_all_files_agree_on_version_date_and_address() -> None:
    assert metadata.corrected(ROOT) == {}


def test_each_file_has_the_version_as_its_readers_read_it() -> None:
    assert json.loads((ROOT / "codemeta.json").read_text())["version"] == VERSION
    assert json.loads((ROOT / ".zenodo.json").read_text())["version"] == VERSION
    yaml = pytest.importorskip("yaml")
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == VERSION
    recipe = yaml.safe_load((ROOT / "packaging" / "conda" / "recipe.yaml").read_text())
    assert recipe["context"]["version"] == VERSION


@pytest.mark.parametrize(
    "name", ["CITATION.cff", "codemeta.json", ".zenodo.json", "packaging/conda/recipe.yaml"]
)
def test_a_file_with_another_version_is_found_and_corrected(copy: Path, name: str) -> None:
    before = (copy / name).read_text(encoding="utf-8")
    replace(copy / name, VERSION, "9.9.9")
    assert metadata.corrected(copy) == {copy / name: before}
    with pytest.raises(SystemExit, match=re.escape(name)):
        metadata.check(copy)


def test_the_owner_has_one_place(copy: Path) -> None:
    replace(copy / "Cargo.toml", "OWNER", "someone")
    metadata.write(copy)
    assert metadata.corrected(copy) == {}
    for name in metadata.places(metadata.declared(copy)):
        assert "OWNER" not in (copy / name).read_text(encoding="utf-8"), name


def test_a_release_dates_the_changes_and_every_citation(copy: Path) -> None:
    replace(copy / "Cargo.toml", "OWNER", "someone")
    metadata.release(copy, DATE)
    changes = (copy / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## [Unreleased]\n\n## [{VERSION}] - {DATE}\n" in changes
    assert f"date-released: {DATE}\n" in (copy / "CITATION.cff").read_text(encoding="utf-8")
    assert json.loads((copy / "codemeta.json").read_text())["datePublished"] == DATE
    notes = metadata.notes(copy, f"v{VERSION}")
    assert notes.startswith("### Added")
    assert "\n## " not in notes


@pytest.mark.parametrize(
    ("owner", "released", "tag", "expected"),
    [
        ("someone", True, "v9.9.9", "the tag is v9.9.9"),
        ("someone", False, f"v{VERSION}", "no section"),
        ("OWNER", True, f"v{VERSION}", "OWNER in Cargo.toml"),
    ],
)
def test_what_is_no_release_has_no_notes(
    copy: Path, owner: str, released: bool, tag: str, expected: str
) -> None:
    replace(copy / "Cargo.toml", "OWNER", owner)
    if released:
        metadata.release(copy, DATE)
    with pytest.raises(SystemExit, match=expected):
        metadata.notes(copy, tag)


def test_the_paper_cites_what_is_in_the_bibliography() -> None:
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    keys = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "docs" / "references.bib").read_text(), re.MULTILINE))
    cited = set(re.findall(r"@([a-z]+\d{4})", paper))
    assert len(cited) >= 8
    assert cited <= keys


def test_hooks_before_commits_use_the_ruff_of_the_tests() -> None:
    pinned = re.search(r"^ruff==(.*)$", (ROOT / "python" / "requirements.txt").read_text(), re.MULTILINE)
    assert pinned
    used = re.findall(r"ruff==([\d.]+)", (ROOT / ".pre-commit-config.yaml").read_text())
    assert set(used) == {pinned[1]}


def test_the_definition_of_the_container_is_that_of_the_page() -> None:
    definition = (ROOT / "packaging" / "asperity.def").read_text(encoding="utf-8")
    assert f"```text\n{definition}```" in (ROOT / "docs" / "how-to" / "cluster.md").read_text(
        encoding="utf-8"
    )


def test_shell_steps_of_workflows_are_targets_of_the_makefile() -> None:
    yaml = pytest.importorskip("yaml")
    targets = re.findall(r"^([a-z-]+)(?=[ a-z-]*:(?!=))", (ROOT / "Makefile").read_text(), re.MULTILINE)
    called = set()
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        for job in yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"].values():
            for step in job.get("steps", []):
                # The name of a variable's value may come from a command.
                run = re.sub(r"\$\([^)]*\)", "", step.get("run", ""))
                for arguments in re.findall(r"\bmake ([^\n]*)", run):
                    called |= set(re.findall(r"(?<!\S)[a-z][a-z-]*(?!\S)", arguments))
    assert {"test", "rust", "binary", "publish", "fuzz", "mutants", "bench"} <= called
    assert called <= set(targets)


def test_a_package_without_what_it_needs_is_refused(tmp_path: Path) -> None:
    files = {
        "README.md": "",
        "Cargo.toml": '[package]\nname = "asperity-cli"\ndescription = "the command"',
        "src/lib.rs": 'include_str!("../lost.txt"); include_str!("../README.md");',
        "scenarios/fig2.toml": "",
        "scenarios/other.toml": "",
    }
    for name, text in files.items():
        (tmp_path / "package" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "package" / name).write_text(text)
    with tarfile.open(tmp_path / "asperity-cli.crate", "w:gz") as archive:
        archive.add(tmp_path / "package", "package")
    found = [fault.partition(": ")[2] for fault in packages.faults(tmp_path / "asperity-cli.crate")]
    for fault in [
        "no LICENSE-MIT",
        "no THIRD-PARTY.txt",
        "no repository in Cargo.toml",
        "src/lib.rs includes ../lost.txt",
        "scenarios/fig3.toml is shipped or packaged, not both",
        "scenarios/other.toml is shipped or packaged, not both",
    ]:
        assert fault in found
    assert not [
        fault for fault in found if "README" in fault or "fig2.toml" in fault or "description" in fault
    ]
