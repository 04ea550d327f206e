"""Texts of the reproduction, and where things stand in the paper.

The texts are files, TOML, whose sentences are templates of Jinja. All are plain with the tags i, sub and sup
of HTML; `studies.typeset` makes a page of them. Symbols and phrases of several sentences are in
``templates/phrases.j2``.
"""

import functools
import re
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import jinja2

SECTIONS = {
    "Section 1": "Introduction",
    "Section 2": "The model",
    "Section 3": "Uncorrelated roughness",
    "Section 4": "Self-affine surfaces",
    "Section 5": "Analytical results",
    "Section 6": "Summary and discussion",
}
"""The sections in order, and what they are about."""

EQUATIONS = {
    "e": 1, "us": 2, "u0s": 3, "a": 4, "log": 5, "uq": 6, "u": 8, "v0": 9,
    "du0": 10, "vt": 11, "ndet": 16, "ndet2": 17, "dosrs": 20,
}  # fmt: skip
"""Labels of equations in the paper's source, and their numbers in print."""

_FIGURES = [f"Section {number}" for number in "233444456"]
_EQUATION = re.compile(r"\bEqs?\. \(\w+\)(?:(?:, | and |, and )\(\w+\))*")


@functools.cache
def sentences(file: str) -> dict[str, Any]:
    """Read a file of sentences, TOML, by its path in this package."""
    return tomllib.loads(files("asperity_research.paper").joinpath(file).read_text(encoding="utf-8"))


def spelled(sentence: str, facts: Mapping[str, object] | None = None) -> str:
    """Fill symbols, phrases and facts into a sentence; line breaks count as spaces, floats are as in %g."""
    return " ".join(_environment().from_string(sentence).render(facts or {}).split())


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("asperity_research.paper", "templates"),
        autoescape=False,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: f"{value:g}" if isinstance(value, float) else value,
    )
    environment.globals |= vars(environment.get_template("phrases.j2").module)
    return environment


def section_of(place: str) -> str:
    """Return the section, a key of `SECTIONS`, that "Sections 3 to 5" or "Fig. 8" begins in."""
    if sections := re.findall(r"\bSections? ([1-6])\b", place):
        return f"Section {sections[0]}"
    figure, *_ = re.findall(r"\bFig\. (\d)", place)
    return _FIGURES[int(figure) - 1]


def numbered(text: str) -> str:
    """Return a text in which equations go by their numbers in print: "Eqs. (uq), (u)" as "Eqs. (6), (8)"."""
    return _EQUATION.sub(
        lambda found: re.sub(r"\w+(?=\))", lambda label: str(EQUATIONS.get(label[0], label[0])), found[0]),
        text,
    )
