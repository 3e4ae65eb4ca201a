"""The command as an archive: `binary.py FOLDER TARGET OUTPUT` packs what FOLDER has for TARGET."""

import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BESIDE = ["README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"]
SCRIPTS = {"bash": "asperity.bash", "zsh": "_asperity", "fish": "asperity.fish", "powershell": "asperity.ps1"}


def main(folder: Path, target: str, output: Path) -> None:
    version = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"][
        "version"
    ]
    name = f"asperity-{version}-{target}"
    windows = "windows" in target
    program = folder / ("asperity.exe" if windows else "asperity")
    said = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
    if said.split() != ["asperity", version]:
        sys.exit(f"binary: expected asperity {version}, found {said.strip()}")
    with tempfile.TemporaryDirectory() as place:
        packed = Path(place, name)
        (packed / "completions").mkdir(parents=True)
        for path in [program, *(ROOT / name for name in BESIDE)]:
            shutil.copy(path, packed)
        for shell, script in SCRIPTS.items():
            text = subprocess.run([program, "completions", shell], check=True, capture_output=True).stdout
            (packed / "completions" / script).write_bytes(text)
        manual = subprocess.run([program, "man"], check=True, capture_output=True).stdout
        (packed / "asperity.1").write_bytes(manual)
        output.mkdir(parents=True, exist_ok=True)
        print(shutil.make_archive(str(output / name), "zip" if windows else "gztar", place, name))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
