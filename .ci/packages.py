"""What is published has all that it needs: the crates in a folder of `cargo package`, and beside them the
source distribution of the Python package.

They are not compiled. Each must have its readme, licences and metadata, every file that its code includes,
and fit the limits of the registry; the command has every scenario that is shipped,
and no other.
"""

import re
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent
NEEDED = ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml", "Cargo.lock"]
METADATA = [
    "description",
    "license",
    "repository",
    "homepage",
    "documentation",
    "keywords",
    "categories",
    "readme",
]
# The largest package and the most keywords that crates.io takes.
LARGEST, KEYWORDS = 10 * 1024 * 1024, 5
# What the source distribution has all files of.
SOURCES = ["core/src", "runner/src", "engine/src", "cli/src", "cli/build.rs", "python/src", "python/asperity"]
# Documents whose code is run as tests in the repository are not included where the crate is used.
INCLUDED = re.compile(r'(?<!#\[doc = )include_(?:str|bytes)!\("([^"]*)"\)')


def tracked(*folders: str) -> list[str]:
    """The files in these folders that git has."""
    listed = ["git", "ls-files", *folders]
    return subprocess.run(listed, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout.split()


def contents(package: Path) -> dict[str, bytes]:
    """The files of a package by their paths in it."""
    with tarfile.open(package) as files:
        read = {
            member.name.partition("/")[2]: files.extractfile(member) for member in files if member.isfile()
        }
        return {name: file.read() for name, file in read.items() if file}


def missing_includes(files: dict[str, bytes]) -> list[str]:
    """The files that code includes by a path and that are not in the package."""
    missing = []
    for name, text in files.items():
        for path in INCLUDED.findall(text.decode()) if name.endswith(".rs") else []:
            parts: list[str] = []
            for part in (PurePosixPath(name).parent / path).parts:
                parts = parts[:-1] if part == ".." and parts else [*parts, part]
            if "/".join(parts) not in files:
                missing.append(f"{name} includes {path}")
    return missing


def missing_scenarios(files: dict[str, bytes]) -> list[str]:
    """How the scenarios of the command, which its build script lists, differ from those that are shipped."""
    shipped = {name for name in tracked("scenarios") if not name.startswith("scenarios/invalid/")}
    found = {name for name in files if name.startswith("scenarios/")}
    return [f"{name} is shipped or packaged, not both" for name in sorted(shipped ^ found)]


def faults(package: Path) -> list[str]:
    files = contents(package)
    metadata = tomllib.loads(files["Cargo.toml"].decode())["package"]
    found = [f"no {name}" for name in NEEDED if name not in files]
    found += [f"no {key} in Cargo.toml" for key in METADATA if not metadata.get(key)]
    found += [f"more than {KEYWORDS} keywords"] * (len(metadata.get("keywords", [])) > KEYWORDS)
    found += ["larger than 10 MiB"] * (package.stat().st_size > LARGEST)
    found += missing_includes(files)
    if metadata["name"] == "asperity-cli":
        found += [f"no {name}" for name in ("THIRD-PARTY.txt",) if name not in files]
        found += missing_scenarios(files)
    return [f"{package.name}: {fault}" for fault in found]


def source_faults(distribution: Path) -> list[str]:
    """What the source distribution of the Python package lacks of what its crates are made of."""
    files = contents(distribution)
    members = tomllib.loads(files["Cargo.toml"].decode())["workspace"]["members"]
    manifests = [f"{member}/Cargo.toml" for member in members]
    found = [f"no {name}" for name in [*NEEDED, *manifests] if name not in files]
    found += [f"no {name}" for name in tracked(*SOURCES) if name not in files]
    found += missing_includes(files)
    return [f"{distribution.name}: {fault}" for fault in found]


def main(folder: Path) -> None:
    package = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
    version = package["version"]
    names = ("asperity", "asperity-runner", "asperity-engine", "asperity-cli")
    packages = [folder / f"{name}-{version}.crate" for name in names]
    found = [fault for package in packages for fault in faults(package)]
    found += source_faults(folder / f"asperity-{version}.tar.gz")
    if found:
        sys.exit("\n".join(found))
    sizes = ", ".join(f"{package.name} {package.stat().st_size / 1e6:.2f} MB" for package in packages)
    print(f"packages: {sizes}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
