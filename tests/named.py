"""What pages and docstrings name, and whether the source has it.

A word within code is looked up among all names and words of the source, docstrings and comments aside. Of a
dotted name each part must belong to the part before: a module, a class, or an object that is called like
its class; an importable name is looked up as Python does.
"""

import ast
import importlib.util
import pkgutil
import re
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from asperity.app.config.keys import sections

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "asperity"
RESEARCH = ROOT / "research" / "src" / "asperity_research"
FOLDERS = (ROOT, SOURCE, SOURCE / "app", ROOT / "benchmarks", ROOT / "research", RESEARCH)
ELSEWHERE = {
    *(
        "_paper",
        "LOCKED",
        "make",
        "test",
        "source",
        "taskset",
        "toctree",
        "docs",
        "Unreleased",
        "PSD",
        "kPa",
        "zcat",
        "Reibungszahl",
        "False",
        "ssh",
    ),
    *(
        "MALLOC_TRIM_THRESHOLD_",
        "__pycache__",
        "array_api_strict",
        "asperity.commands",
        "asperity.scans",
        "--no-nanny",
    ),
    *("NAME", "COLUMN", "ID", "NIGHTLY_WHEELS"),
}
"""Words of other programs, of texts that are quoted, groups of entry points, and what stands for any name."""

LIBRARIES = {
    "asp",
    "asperity",
    "asperity_research",
    "dataclasses",
    "math",
    "matplotlib",
    "numpy",
    "scipy",
    "xarray",
}
"""Whose dotted names Python is to find."""

LOCAL = {"P", "plt", "pyplot", "figure", "rough", "aged", "found", "areas", "c"}
"""Names of variables that pages and docstrings introduce."""

COMPOSED = r"_(mean|count|history|paper|s|m|m2|N|Pa|Hz|deg)$|^(final|relaxed|surface|fit_q)_"
"""Parts that the source adds to names of quantities."""

FILE = r"[\w.{}-]+\.(cff|csv|gif|html|i\b|inp|json|md|mi|mp4|nc|npy|npz|opd|png|py|toml|txt|xlook|yaml|zarr)"


LOOSE = (
    r"(?<![\w/.-])(--[a-z][\w-]+|[A-Z]{3}[A-Z0-9]*_[A-Z0-9_]+|(?:[\w-]+/)+[\w-]+\.(?:py|md|toml|csv))(?!\w)"
)
"""Flags, constants and files that stand in a text without being marked as code."""


def docstrings(tree):
    """Expressions that are nothing but text: docstrings, of attributes too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(getattr(node.value, "value", None), str):
            yield node.value


def in_pages(page):
    """Code within the sentences of a page, and what is code although not marked."""
    text = re.sub(r"^```.*\n(?:.*\n)*?```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    marked = re.findall(r"`([^`\n]+)`", text)
    return dict.fromkeys(marked + re.findall(LOOSE, re.sub(r"`[^`\n]+`|\]\([^)]*\)|https?:\S+", "", text)))


def in_docstrings(file):
    """Code within the docstrings of a module."""
    for text in docstrings(ast.parse(file.read_text(encoding="utf-8"))):
        formulas = re.sub(r":math:`[^`]*`", "", text.value)
        marked = r"``([^`]+)``|(?<!`)`([^`]+)`"
        for code, name in re.findall(marked, formulas):
            yield " ".join((code or name).split())
        yield from re.findall(LOOSE, re.sub(rf"{marked}|https?:\S+", "", formulas))


class Source:
    """All words of the source, the members of each module and class, and the bases of each class."""

    def __init__(self):
        self.words, self.members, self.bases = set(ELSEWHERE | LOCAL), {}, {}
        self.flags = set()
        for folder in (SOURCE, RESEARCH, ROOT / "benchmarks"):
            for file in sorted(folder.rglob("*.py")):
                self.read(file)
        for file in (*ROOT.glob("tests/**/*.py"), *ROOT.glob("*.toml"), ROOT / "docs" / "conf.py"):
            if file != Path(__file__) and file.name != "test_docs.py":
                self.words.update(re.findall(r"\w+", file.read_text(encoding="utf-8")))

    def read(self, file):
        text = file.read_text(encoding="utf-8")
        tree = ast.parse(text)
        said = set(map(id, docstrings(tree)))
        name = file.parent.name if file.stem == "__init__" else file.stem
        self.words.add(name)
        self.own(name, tree.body)
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                self.own(node.name, node.body)
                bases = (ast.unparse(base).partition("[")[0].rpartition(".")[2] for base in node.bases)
                self.bases.setdefault(node.name, set()).update(bases)
                self.members[node.name] |= {
                    part.attr
                    for part in ast.walk(node)
                    if isinstance(part, ast.Attribute) and ast.unparse(part.value) == "self"
                }
            if isinstance(node, ast.Constant):
                if isinstance(node.value, str) and id(node) not in said:
                    self.words.update(re.findall(r"\w+", node.value))
                    self.flags.update(re.findall(r"--[a-z][\w-]*", node.value))
            else:
                found = (getattr(node, field, None) for field in ("id", "attr", "arg", "name"))
                self.words.update(word for name in found if name for word in str(name).split("."))

    def own(self, owner, body):
        """What a module or a class defines; a module's classes' members count as its own."""
        mine = self.members.setdefault(owner, set())
        for node in body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                mine.add(node.name)
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                mine.update(part.id for part in ast.walk(node) if isinstance(part, ast.Name))
            elif isinstance(node, ast.ImportFrom):
                mine.update(alias.asname or alias.name for alias in node.names)
            elif isinstance(node, ast.If):
                self.own(owner, node.body)

    def belongs(self, name, owner):
        """Whether a module, a class, or an object that is called like it has a name."""
        classes = [one for one in self.members if owner in (one, one.lower(), _snake(one))]
        if owner.islower():  # a variable may be called like a module whose class it is of
            classes += [one for own in classes for one in self.members[own] if one in self.members]
        inside = any(
            name in self.members[one] or any(self.belongs(name, base) for base in self.bases.get(one, ()))
            for one in classes
        )
        keys = {key for kind in sections().get(owner, {}).values() for key in kind}
        return inside or name in keys or hasattr(np.ndarray, name) or hasattr(xr.Dataset, name)

    def knows(self, word):
        """Whether a word is one of the source, or is composed of such as the source composes them."""
        rest = re.sub(COMPOSED, "", word)
        parts = rest.split("_") if rest != word else [word]
        return word in self.words or rest in self.words or self.words.issuperset(parts)

    def unknown(self, code, place):
        """What is named in a piece of code of a page or a docstring and is not there."""
        bare = re.sub(rf"\"[^\"]*\"|'[^']*'|{FILE}|[\w.]*/[\w./]+", "", code)
        if "\\" in code or code.startswith(("pip ", "source ")):
            return
        for flag in re.findall(r"(?<![\w-])--[a-z][\w-]*", code):
            if flag not in self.flags | ELSEWHERE and not self.knows(flag[2:].replace("-", "_")):
                yield flag
        if re.fullmatch(rf"(?:[\w.-]+/)+({FILE}|[\w-]*)|{FILE}", code.partition("::")[0]):
            yield from self.missing_file(code.partition("::")[0], place)
            return
        for name in re.findall(r"(?<![\w.)\]}$-])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", bare):
            first, *others = name.split(".")
            if others and (first in LIBRARIES or resolves(f"asperity.{name}")):
                if not resolves(name if first in LIBRARIES else f"asperity.{name}"):
                    yield name
                continue
            parts = [first, *others]
            yield from (f"{part} of {name}" for part in parts if len(part) > 2 and not self.knows(part))
            for owner, member in zip(parts, others, strict=False):
                aside = owner in ELSEWHERE | LOCAL or member in ELSEWHERE
                if not (aside or self.belongs(member, owner)):
                    yield f"{member} of {owner}"

    def missing_file(self, path, place):
        if "/" in path:
            folders = (*FOLDERS, place.parent, place.parent.parent)
            ours = any((folder / path.partition("/")[0]).is_dir() for folder in folders)
            if ours and not any((folder / path).exists() for folder in folders):
                yield path
        elif path.endswith(".py"):
            if not any(ROOT.glob(f"[!.]*/**/{path}")):
                yield path
        elif path.endswith((".mi", ".opd")):  # a surface of somebody else
            return
        elif not self.knows(path.partition(".")[0]) and not (ROOT / path).exists():
            yield path


def _snake(name):
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


@cache
def resolves(name):
    """Whether Python finds a dotted name; what only research adds is looked up where it is."""
    name = re.sub(r"^asp\b", "asperity", name)
    research = re.match(r"asperity\.(challenge|experiments|studies)\b|asperity_research\.", name)
    if research and importlib.util.find_spec("asperity_research"):
        name = re.sub(r"^asperity\.", "asperity_research.", name)
    try:
        pkgutil.resolve_name(name)
    except (ImportError, AttributeError):
        return bool(research) or name in ELSEWHERE
    return True
