"""Python in the README, and in pages with figures: blocks run in order; `output` is what one prints.

Pages of the site, which show the command line and sessions as well, are run by docs/test_pages.py.
"""

import io
import re
import shutil
from contextlib import redirect_stdout
from pathlib import Path

ROOT = Path(__file__).parents[2]
# The document, the figure that a script of it draws, and its name in docs/figures.
FIGURES = [
    (ROOT / "README.md", "fig2.svg", "fig2-python.svg"),
    (ROOT / "docs" / "how-to" / "noise.md", "paths.svg", "noise-paths.svg"),
]
BLOCK = re.compile(r"^```(\w+)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def pages() -> list[Path]:
    """The documents at the root that show Python."""
    return [page for page in sorted(ROOT.glob("*.md")) if "\n```python\n" in page.read_text(encoding="utf-8")]


def run(page: Path) -> list[tuple[str, str]]:
    """Runs the blocks of a page in the working directory; gives what is printed and what is shown as such."""
    names: dict[str, object] = {}
    printed, compared = "", []
    for language, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language == "python":
            out = io.StringIO()
            with redirect_stdout(out):
                exec(compile(text, str(page), "exec"), names)
            printed = out.getvalue()
        elif language == "output":
            compared.append((printed, text))
    return compared


if __name__ == "__main__":
    # The same bytes every time.
    import matplotlib

    matplotlib.use("agg")
    matplotlib.rcParams["svg.hashsalt"] = "asperity"
    for page, drawn, kept in FIGURES:
        run(page)
        shutil.copy(drawn, ROOT / "docs" / "figures" / kept)
