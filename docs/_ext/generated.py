"""Pages that are made of the code before anything else is built, and links that lead out of this folder."""

# ruff: noqa: ARG001 - Sphinx says what its handlers are given

import os
import re
from contextlib import suppress
from types import FunctionType
from typing import get_type_hints

import house
from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

import reference
from reference import DOCS

ROOT = DOCS.parent
COPIED = {
    ROOT / "CONTRIBUTING.md": "contributing.md",
    ROOT / "CHANGELOG.md": "changelog.md",
    ROOT / "benchmarks" / "README.md": "benchmarks.md",
    ROOT / "README.md": "../index.md",
}
"""Pages from outside of this folder, and what shows them in docs/reference."""

_NAMED = re.compile(r"\[[\w/]+\.md\]\(")
_SHARED = re.compile(r"^:(ivar|param) [^:]*:")
_KEPT = {}
_LINK = re.compile(r"(?<=\]\()(?!\w+:)([^)#\s]+)")


def relinked(text, source, target):
    """Links of the page `source`, written for `target`, which stands for it or is itself.

    Where a link shows the name of a file, the title of that page takes its place.
    """

    def written(match):
        path = (source.parent / match[1]).resolve()
        path = (DOCS / "reference" / COPIED[path]).resolve() if path in COPIED else path
        return os.path.relpath(path, target.parent)

    return _LINK.sub(written, _NAMED.sub("[](", text))


def write(app, config):
    """Write what has changed into docs/reference, so that what has not need not be built anew."""
    folder = DOCS / "reference"
    folder.mkdir(exist_ok=True)
    files = {**reference.pages(), "house.svg": house.drawing()}
    for source, name in COPIED.items():
        if "/" not in name:
            files[name] = relinked(source.read_text(encoding="utf-8"), source, folder / name)
    for name, text in files.items():
        path = folder / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.iterdir():
        if path.name not in files:
            path.unlink()


def read(app, name, content):
    """Let the links of a page lead to the copies of pages outside of this folder."""
    path = app.env.doc2path(name)
    if str(path).endswith(".md") and path.parent == DOCS:
        content[0] = relinked(content[0], path, path)


def without_arguments(app, what, name, thing, options, signature, returned):
    """A class that its readers do not make has no signature."""
    return ("", None) if signature and signature.startswith("(*_") else None


def plain(app, thing, bound):
    """Types of arguments without what else their annotations say: bounds, units, meanings."""
    with suppress(NameError):  # of what is imported for type checkers alone
        if isinstance(thing, FunctionType):
            thing.__annotations__ = get_type_hints(thing)


def keep(app, what, name, thing, options, lines):
    """Keep the docstring of an attribute: napoleon would take what stands before a colon for its type."""
    if what in ("attribute", "property", "data"):
        _KEPT[name] = lines.copy()


def restore(app, what, name, thing, options, lines):
    """Put it back, and keep names together that share a line: Sphinx would take all but one for a type."""
    lines[:] = [_SHARED.sub(_together, line) for line in _KEPT.pop(name, lines)]


def _together(match):
    return match[0].replace(", ", ",\u200b")


def attributes(app, doctree):
    """Call the attributes of a class what they are: Sphinx calls them variables."""
    for name in doctree.findall(nodes.field_name):
        if name.astext() == "Variables":
            name.children = [nodes.Text("Attributes")]


def formula(self, node):
    """Write a formula as MathML, which browsers draw by themselves, without a script from the network."""
    block = isinstance(node, nodes.math_block)
    text = tex2mathml(node.astext(), as_block=block)
    self.body.append(f'<div class="formula">{text}</div>' if block else text)
    raise nodes.SkipNode


def setup(app):
    """Tell Sphinx."""
    app.add_html_math_renderer("mathml", (formula, None), (formula, None))
    app.connect("config-inited", write)
    app.connect("source-read", read)
    app.connect("autodoc-process-signature", without_arguments)
    app.connect("autodoc-before-process-signature", plain)
    app.connect("autodoc-process-docstring", keep, priority=400)
    app.connect("autodoc-process-docstring", restore, priority=600)
    app.connect("doctree-read", attributes)
    return {"parallel_read_safe": True}
