"""Texts of the reproduction, which stand in text files: TOML, whose sentences are templates of Jinja.

All are plain with the tags i, sub and sup of HTML; `studies.typeset` makes a page of them. Symbols
and phrases of several sentences are in ``templates/phrases.j2``.
"""

import functools
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import jinja2


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
