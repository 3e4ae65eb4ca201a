"""The site made of the pages in this folder, as `make docs` builds it.

The pages are plain Markdown, to be read anywhere: equations are ```math blocks whose \\tag is their name,
`[(name)](…)` refers to one, and works are cited by a link to them. `as_site` makes numbered equations and
citations of these.
"""

import logging
import re
import sys
import tomllib
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from pybtex.database import parse_file

sys.path.insert(0, str(Path(__file__).parent))
import ipynb

root = Path(__file__).parents[1]
package = tomllib.loads((root / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]

project = "asperity"
author = package["authors"][0]
version = release = package["version"]
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinxcontrib.bibtex"]
nitpicky = True
default_role = "code"

autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_member_order = "bysource"
autodoc_typehints = "none"
toc_object_entries_show_parents = "hide"

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True
logging.getLogger("traitlets").setLevel(logging.WARNING)

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "unsrtalpha"
bibtex_tooltips = False

html_theme = "furo"
html_title = f"asperity {version}"
html_copy_source = False
html_show_copyright = False
# MathJax comes with the site, so that it can be read without a network.
mathjax = Path(next(iter(find_spec("sphinx-mathjax-offline").submodule_search_locations)))
html_static_path = ["site.css", str(mathjax / "static" / "mathjax" / "tex-svg.js")]
html_css_files = ["site.css"]
mathjax_path = "tex-svg.js"
mathjax3_config = {"options": {"enableMenu": False}}


def works() -> dict[str, str]:
    """The keys of the bibliography by the links that stand for them in the pages."""
    entries = parse_file(Path(__file__).parent / bibtex_bibfiles[0]).entries
    links = {key: dict(entry.fields) for key, entry in entries.items()}
    return {f.get("url") or f"https://doi.org/{f['doi']}": key for key, f in links.items()}


def as_site(text: str, keys: dict[str, str]) -> str:
    """Names of equations become their labels, links to works are followed by citations of them."""
    text = re.sub(
        r"^```math\n(.*?)\n\\tag\{([^}]*)\}\n```", r"```{math}\n:label: \2\n\1\n```", text, flags=re.M | re.S
    )
    text = re.sub(r"\[\(([^()\]]*)\)\]\([^)]*\)", r"{eq}`\1`", text)
    return re.sub(r"\]\((https?://(?:[^()]|\([^()]*\))*)\)", lambda link: cited(link, keys), text)


def cited(link: re.Match, keys: dict[str, str]) -> str:
    return f"{link[0]} {{cite:p}}`{keys[link[1]]}`" if link[1] in keys else link[0]


def with_sections(_, __, ___, ____, _____, lines):
    """Makes the sections of numpydoc headings with lists: `name : type` above what it is, indented."""
    sections = re.split(r"^(\w+)\n-{3,}\n", "\n".join(lines), flags=re.M)
    made = [sections[0]]
    for name, body in zip(sections[1::2], sections[2::2], strict=True):
        if name != "Examples":
            entries = re.findall(r"^(\S.*)(?:\n|$)((?:[ ]+\S.*(?:\n|$))*)", body, flags=re.M)
            body = "\n".join(f"* {named(entry)}{explained(what)}" for entry, what in entries)
        made.append(f"**{name}**\n\n{body}")
    lines[:] = "\n\n".join(made).splitlines()


def explained(what: str) -> str:
    """What an entry says after its name, if anything."""
    return f": {' '.join(what.split())}" if what.strip() else ""


def named(entry: str) -> str:
    """The names of an entry in bold, and its type, whose stars are no markup."""
    names, _, kind = entry.replace("*", r"\*").partition(" : ")
    return f"**{names}** ({kind})" if kind else f"**{names}**"


def downloadable(name: str, text: str) -> str:
    """Adds the link to its notebook below the title of a page of notebooks."""
    folder, _, page = name.rpartition("/")
    if folder != "notebooks" or page == "index":
        return text
    link = f'<a href="{page}.ipynb" download>This page as a Jupyter notebook</a>'
    return re.sub(r"^(# .*)$", rf"\1\n\n{link}", text, count=1, flags=re.M)


def with_explorer(name: str, text: str, site: Path) -> str:
    """Adds the link to the explorer below the titles of its page and the first one, if the site has it."""
    if name not in ("index", "how-to/explorer") or not (site / "explorer" / "index.html").is_file():
        return text
    above = "../" * name.count("/")
    link = f'<a href="{above}explorer/index.html">Open the explorer</a>'
    return re.sub(r"^(# .*)$", rf"\1\n\n{link}", text, count=1, flags=re.M)


def write_notebooks(app, failure):
    if failure is None and app.builder.format == "html":
        ipynb.written(Path(app.srcdir) / "notebooks", Path(app.outdir) / "notebooks")


def subclasses(line: re.Match) -> str:
    """Documents the classes that derive from the one named by `.. subclasses:: asperity.Name`."""
    base = getattr(import_module("asperity"), line[1])
    return "\n".join(f".. autoclass:: asperity.{derived.__name__}" for derived in base.__subclasses__())


def setup(app):
    keys = works()

    def read(_, name, source):
        text = downloadable(name, as_site(source[0], keys))
        text = with_explorer(name, text, Path(app.outdir))
        source[0] = re.sub(r"^\.\. subclasses:: asperity\.(\w+)$", subclasses, text, flags=re.M)

    app.connect("source-read", read)
    app.connect("build-finished", write_notebooks)
    app.connect("autodoc-process-docstring", with_sections)
