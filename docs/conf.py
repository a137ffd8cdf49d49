"""Settings of Sphinx for `cargo xtask book`, which makes a book of all pages of the repository."""

import re
from pathlib import Path

project = html_title = "Staya"
extensions = ["myst_parser"]
html_theme = "furo"
html_show_copyright = False
root_doc = "README"
include_patterns = ["**.md"]
exclude_patterns = [".*", "**/.*", "target", "**/target", "out", "**/templates"]
# As deep as the headings that links name.
myst_heading_anchors = 4
smartquotes = False


def prepare(app, page, source):
    """Adapts the text of a page, which is written for GitHub."""
    folder = Path(app.srcdir, page).parent

    def link(match):
        readme = match[1].rstrip("/") + "/README.md"
        return f"]({readme})" if (folder / readme).is_file() else match[0]

    text = re.sub(r"\]\(([^()#:]+)\)", link, source[0])
    # Attributes of tests are not part of a language's name.
    source[0] = re.sub(r"^```(\w+),.*$", r"```\1", text, flags=re.M)
    if page == root_doc:
        source[0] += navigation(app)


def navigation(app):
    """Lists the pages in the order of the table in docs/README.md, then all others."""
    table = Path(app.srcdir, "docs/README.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| \[[^]]+\]\((.+?)\.md\)", table, re.M)
    first = ["docs/README", *(name[3:] if name.startswith("../") else "docs/" + name for name in named)]
    others = sorted(app.env.found_docs - {root_doc, *first})
    lists = {"Documentation": first, "Other pages": others}
    return "".join(f"\n\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"
                   for caption, pages in lists.items())


def setup(app):
    app.connect("source-read", prepare)
