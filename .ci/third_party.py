"""The notices of the crates that asperity is made of.

`third_party.py check` is what `make test` runs, `third_party.py write` writes THIRD-PARTY.txt anew.
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOTICES = ROOT / "THIRD-PARTY.txt"
# What the wheel and the command are made of where they are built; other systems add crates of the same
# licences.
PLATFORM = "x86_64-unknown-linux-gnu"
# Of the licences that a crate offers, the first of these is taken.
PREFERRED = ["MIT", "Apache-2.0"]
FILES = re.compile(r"^(LICEN[CS]E|COPYING|UNLICENSE|NOTICE)", re.IGNORECASE)
RULE = "=" * 100


def metadata() -> dict:
    """All packages, and how they depend on each other."""
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", PLATFORM]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)


def packages(found: dict, kinds: tuple) -> list:
    """The packages that the workspace needs by dependencies of these kinds (None: normal), not its own."""
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}
    own = set(found["workspace_members"])
    reached, ahead = set(own), list(own)
    while ahead:
        for needed in nodes[ahead.pop()]["deps"]:
            wanted = any(dependency["kind"] in kinds for dependency in needed["dep_kinds"])
            if wanted and needed["pkg"] not in reached:
                reached.add(needed["pkg"])
                ahead.append(needed["pkg"])
    chosen = [package for package in found["packages"] if package["id"] in reached - own]
    return sorted(chosen, key=lambda package: (package["name"], package["version"]))


def choices(expression: str) -> list:
    """The ways to satisfy an SPDX expression, each a set of licences that apply together."""
    tokens = re.findall(r"\(|\)|[^\s()]+", expression.replace("/", " OR "))

    def either() -> list:
        ways = together()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            ways = ways + together()
        return ways

    def together() -> list:
        ways = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            more = one()
            ways = [a | b for a in ways for b in more]
        return ways

    def one() -> list:
        if tokens[0] == "(":
            tokens.pop(0)
            ways = either()
            tokens.pop(0)
            return ways
        name = tokens.pop(0)
        if tokens and tokens[0] == "WITH":
            tokens.pop(0)
            name = f"{name} WITH {tokens.pop(0)}"
        return [frozenset([name])]

    return either()


def texts(package: dict) -> list:
    """The texts of the licence that is taken, as the crate comes with them."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(path for path in folder.iterdir() if path.is_file() and FILES.match(path.name))
    for licence in PREFERRED:
        if {licence} in choices(package["license"]):
            word = licence.split("-")[0]
            chosen = [path for path in files if word.lower() in path.name.lower()]
            files = chosen or [path for path in files if "-" not in path.name] or files
            break
    # Fonts within a crate have licences of their own.
    files = files + sorted(folder.glob("assets/**/LICENSE*"))
    reported = [path.read_text(encoding="utf-8", errors="replace") for path in files]
    authors = ", ".join(package["authors"]) or f"the authors of {package['name']}"
    absent = f"{package['license']}; copyright {authors}; the crate comes without the text of its licence."
    return [
        re.sub(r"[ \t]+$", "", text.strip("\n\r "), flags=re.MULTILINE).replace("\r\n", "\n")
        for text in reported
    ] or [absent]


def notices(found: dict) -> str:
    """Every text once, under the crates that it belongs to."""
    crates = defaultdict(list)
    for package in packages(found, (None,)):
        for text in texts(package):
            crates[text].append(f"{package['name']} {package['version']} ({package['license']})")
    head = (
        "asperity is made of the crates below, besides its own. Each stands under one of its licences, whose "
        "text\nfollows the names. Written by .ci/third_party.py; `asperity notices` prints it.\n"
    )
    parts = [f"{RULE}\n{chr(10).join(names)}\n\n{text}\n" for text, names in crates.items()]
    return "\n".join([head, *sorted(parts)])


def main() -> int:
    found = metadata()
    if sys.argv[1:] == ["write"]:
        NOTICES.write_text(notices(found), encoding="utf-8")
        return 0
    if NOTICES.is_file() and NOTICES.read_text(encoding="utf-8") == notices(found):
        return 0
    print("THIRD-PARTY.txt is not that of these crates: make notices")
    return 1


if __name__ == "__main__":
    sys.exit(main())
