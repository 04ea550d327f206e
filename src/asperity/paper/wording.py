"""Texts of the reproduction: its symbols, and its sentences, which stand in text files.

All are plain with the tags i, sub and sup of HTML; `asperity.paper.typeset` makes a page of them.
"""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import jinja2

LOAD = "<i>F</i><sub>N</sub>"
K0 = "<i>k</i><sub>0</sub>"
K1 = "<i>k</i><sub>1</sub>"
STIFFNESS_RATIO = f"{K1}/{K0}"
K_EFF = "<i>k</i><sub>eff</sub>"
REDUCED_TIME = f"{K0}<i>Rt</i>"
SITES = "<i>N</i><sub>0</sub>"
X1 = "<i>x</i><sub>1</sub>"
X2 = "<i>x</i><sub>2</sub>"
SYMBOLS = {name: value for name, value in vars().items() if name.isupper()}
"""All of them, by name, as the text files write them: ``{{LOAD}}``."""


@functools.cache
def sentences(file: str) -> dict[str, Any]:
    """Read a file of sentences, TOML, by its path in this package."""
    return tomllib.loads(files("asperity.paper").joinpath(file).read_text(encoding="utf-8"))


def spelled(sentence: str, facts: Mapping[str, object] | None = None) -> str:
    """Fill the symbols and facts into a sentence, a template of Jinja; line breaks count as spaces."""
    return " ".join(_environment().from_string(sentence).render(facts or {}).split())


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("asperity.paper", "templates"),
        autoescape=False,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: f"{value:g}" if isinstance(value, float) else value,
    )
    environment.globals |= SYMBOLS
    environment.globals |= vars(environment.get_template("phrases.j2").module)
    return environment
