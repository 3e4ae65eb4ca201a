"""Version, date and address of the project, which stand in many files and come from two.

`Cargo.toml` has the version, the repository and the homepage; the date is that of the version's section in
`CHANGELOG.md`, and there is none before the release. `metadata.py check` compares the other files, and
`metadata.py write` writes them. `metadata.py release 2026-12-24` names the section of unreleased changes
after the version and writes the date. `metadata.py notes v0.1.0` prints that section for a release of
this tag, and fails where tag, version, section or address are not those of a release.
"""

import re
import sys
import tomllib
from pathlib import Path

UNRELEASED = "## [Unreleased]"
# What stands in the address until the project has one.
PLACEHOLDER = "OWNER"


def declared(root: Path) -> dict[str, str]:
    """Version, repository and homepage, and the date of the version if it is released."""
    package = tomllib.loads((root / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
    facts = {key: package[key] for key in ("version", "repository", "homepage", "rust-version")}
    heading = re.search(
        rf"^## \[{re.escape(facts['version'])}\] - (\d{{4}}-\d{{2}}-\d{{2}})$",
        (root / "CHANGELOG.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    return facts | ({"date": heading[1]} if heading else {})


def places(facts: dict[str, str]) -> dict[str, list[tuple[str, str]]]:
    """For each file the patterns of what it says, each with what it should say."""
    version, repository = facts["version"], facts["repository"]
    dated = f"\ndate-released: {facts['date']}" if "date" in facts else ""
    published = f',\n  "datePublished": "{facts["date"]}"' if "date" in facts else ""
    return {
        "Cargo.toml": [(r'(?<=", version = )"[^"]*"', f'"{version}"')],
        "pyproject.toml": [
            (r"(?<=^Homepage = ).*$", f'"{facts["homepage"]}"'),
            (r"(?<=^Documentation = ).*$", f'"{facts["homepage"]}"'),
            (r"(?<=^Repository = ).*$", f'"{repository}"'),
            (r"(?<=^Issues = ).*$", f'"{repository}/issues"'),
            (r"(?<=^Changelog = ).*$", f'"{repository}/blob/main/CHANGELOG.md"'),
        ],
        "CITATION.cff": [
            (r"^version: .*(\ndate-released: .*)?$", f"version: {version}{dated}"),
            (r"(?<=^repository-code: ).*$", repository),
            (r"(?<=^url: ).*$", facts["homepage"]),
        ],
        "codemeta.json": [
            (r'"version": "[^"]*"(,\n  "datePublished": "[^"]*")?', f'"version": "{version}"{published}'),
            (r'(?<="codeRepository": )"[^"]*"', f'"{repository}"'),
            (r'(?<="issueTracker": )"[^"]*"', f'"{repository}/issues"'),
            (r'(?<="url": )"[^"]*"', f'"{facts["homepage"]}"'),
        ],
        ".zenodo.json": [
            (r'(?<="version": )"[^"]*"', f'"{version}"'),
            (r'(?<="identifier": )"https[^"]*"', f'"{repository}"'),
        ],
        "packaging/conda/recipe.yaml": [
            (r'(?<=^  version: )".*"$', f'"{version}"'),
            (r"(?<=^  repository: )http.*$", repository),
            (r"(?<=^  homepage: )http.*$", facts["homepage"]),
        ],
        ".github/workflows/test.yml": [(r"(?<=^  MSRV: ).*$", f'"{facts["rust-version"]}"')],
    }


def corrected(root: Path) -> dict[Path, str]:
    """The files that say something else, with what they should say."""
    wrong = {}
    for name, rules in places(declared(root)).items():
        path = root / name
        before = after = path.read_text(encoding="utf-8")
        for pattern, value in rules:
            after, found = re.subn(pattern, lambda _, value=value: value, after, flags=re.MULTILINE)
            if not found:
                sys.exit(f"metadata: {name} has nothing like {pattern}")
        if after != before:
            wrong[path] = after
    return wrong


def check(root: Path) -> None:
    names = [str(path.relative_to(root)) for path in corrected(root)]
    if names:
        sys.exit(f"metadata: {', '.join(names)} disagree with Cargo.toml or CHANGELOG.md; run make metadata")
    print("metadata: version, date and address agree")


def write(root: Path) -> None:
    for path, text in corrected(root).items():
        path.write_text(text, encoding="utf-8")
        print(f"metadata: {path.relative_to(root)} written")


def release(root: Path, date: str) -> None:
    if not re.fullmatch(r"\d{4}-\d{2}-\d{2}", date):
        sys.exit(f"metadata: expected a date such as 2026-12-24, found {date}")
    path, version = root / "CHANGELOG.md", declared(root)["version"]
    text = path.read_text(encoding="utf-8")
    if UNRELEASED not in text or f"## [{version}]" in text:
        sys.exit(f"metadata: CHANGELOG.md has no unreleased changes, or {version} already")
    text = text.replace(UNRELEASED, f"{UNRELEASED}\n\n## [{version}] - {date}", 1)
    path.write_text(text, encoding="utf-8")
    write(root)


def notes(root: Path, tag: str) -> str:
    """The section of the changelog for a tag that may be released."""
    facts = declared(root)
    if tag != f"v{facts['version']}":
        sys.exit(f"metadata: the tag is {tag}, the version in Cargo.toml is {facts['version']}")
    if "date" not in facts:
        sys.exit(
            f"metadata: CHANGELOG.md has no section {facts['version']} with a date; run make release DATE=…"
        )
    if PLACEHOLDER in facts["repository"] + facts["homepage"]:
        sys.exit(f"metadata: {PLACEHOLDER} in Cargo.toml must be the owner of the repository")
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    section = text.split(f"## [{facts['version']}] - {facts['date']}\n", 1)[1]
    return section.split("\n## [", 1)[0].strip() + "\n"


def main(root: Path, arguments: list[str]) -> None:
    match arguments:
        case ["check"]:
            check(root)
        case ["write"]:
            write(root)
        case ["release", date]:
            release(root, date)
        case ["notes", tag]:
            print(notes(root, tag), end="")
        case _:
            sys.exit("usage: metadata.py check | write | release DATE | notes TAG")


if __name__ == "__main__":
    main(Path(__file__).resolve().parent.parent, sys.argv[1:])
