"""How mistakes in a configuration are named: where they stand, what was expected, what came."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from asperity.config.models import SURFACES, Aging, Contact, Output, Solid

Sections = dict[str, dict[str, object]]

SECTIONS: dict[str, type[BaseModel]] = {
    "solid": Solid,
    "contact": Contact,
    "aging": Aging,
    "output": Output,
}


def flag_of(section: str, key: str) -> str:
    """Name of the flag that sets a key."""
    names = {("surface", "kind"): "surface", ("surface", "path"): "file"}
    return "--" + names.get((section, key), key).replace("_", "-")


def unknown_names(merged: dict[str, Any], flags: Sections, path: Path | None) -> list[str]:
    """Find sections and keys that do not exist, and suggest those that do."""
    problems = []
    for section, table in merged.items():
        if section != "surface" and section not in SECTIONS:
            problems.append(_where(path, _no_section(section, table)))
        elif not isinstance(table, dict):
            problems.append(_where(path, f"{section}: expected a section [{section}], got {table!r}"))
        else:
            problems += _unknown_keys(section, table, flags, path)
    return problems


def _no_section(name: str, content: object) -> str:
    """Say what is wrong with a name at the top of the file."""
    if isinstance(content, dict):
        return f"[{name}]: no such section{_suggestion(name, ['surface', *SECTIONS])}"
    homes = [section for section, model in SECTIONS.items() if name in model.model_fields]
    if any(name in model.model_fields for model in SURFACES.values()):
        homes.append("surface")
    where = f"; it belongs below [{homes[0]}]" if homes else ""
    return f"{name}: stands outside any section{where}"


def _unknown_keys(section: str, table: dict[str, Any], flags: Sections, path: Path | None) -> list[str]:
    kind = table.get("kind")
    model = SECTIONS.get(section)
    if section == "surface":
        model = SURFACES.get(kind) if isinstance(kind, str) else None
    if model is None:  # the kind itself is the mistake
        return []
    known = list(model.model_fields)
    problems = []
    for key in table:
        if key in known:
            continue
        owners = [
            name for name, other in SURFACES.items() if section == "surface" and key in other.model_fields
        ]
        if owners:
            reason = f"not a key of a surface of kind {kind!r}, but of {' and '.join(map(repr, owners))}"
            if key in flags.get(section, {}):
                reason += f"; try --surface {owners[0]}"
        else:
            reason = f"no such key{_suggestion(key, known)}"
        problems.append(_named(section, key, flags, path) + f": {reason}")
    return problems


def is_unknown(detail: ErrorDetails) -> bool:
    """Whether `unknown_names` has reported this already."""
    return detail["type"] in ("extra_forbidden", "model_type", "model_attributes_type")


def spelled(detail: ErrorDetails, flags: Sections, path: Path | None, section: str = "") -> str:
    """One line for one mistake that pydantic found."""
    place = [section, *detail["loc"]] if section else list(detail["loc"])
    if len(place) > 2 and place[0] == "surface" and place[1] in SURFACES:
        del place[1]
    expected = _expectation(detail)
    if not place:
        return _where(path, expected)
    if len(place) == 1:
        if detail["type"].startswith("union_tag"):
            place.append("kind")
        else:
            return _where(path, f"[{place[0]}] {expected}")
    return f"{_named(str(place[0]), str(place[1]), flags, path)}: {expected}"


def _expectation(detail: ErrorDetails) -> str:
    """What was expected and what came, in the words that the rest of the package uses."""
    context = detail.get("ctx", {})
    kind, got = detail["type"], detail["input"]
    if kind == "missing":
        return "expected a value, got none"
    if kind == "value_error":
        return str(context["error"])
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        got = got.get("kind") if isinstance(got, dict) else got
        return (
            f"expected one of {', '.join(map(repr, SURFACES))}, got {got!r}{_suggestion(got, list(SURFACES))}"
        )
    expected = {
        "greater_than": f"a number above {context.get('gt')}",
        "greater_than_equal": f"a number of at least {context.get('ge')}",
        "less_than": f"a number below {context.get('lt')}",
        "less_than_equal": f"a number of at most {context.get('le')}",
        "finite_number": "a finite number",
        "float_type": "a number",
        "int_type": "a whole number",
        "string_type": "text in quotes",
        "list_type": "a list",
        "too_short": f"at least {context.get('min_length')} in the list",
        "too_long": f"at most {context.get('max_length')} in the list",
        "literal_error": f"one of {context.get('expected')}",
    }.get(kind, detail["msg"])
    return f"expected {expected}, got {got!r}"


def _named(section: str, key: str, flags: Sections, path: Path | None) -> str:
    """Name a key as the user wrote it: a flag, or a key of a file's section."""
    if key in flags.get(section, {}):
        return flag_of(section, key)
    return _where(path, f"[{section}] {key}")


def _where(path: Path | None, text: str) -> str:
    return text if path is None else f"{path}: {text}"


def _suggestion(word: object, known: list[str]) -> str:
    folded = {name.casefold(): name for name in known}
    close = get_close_matches(str(word).casefold(), folded, n=1)
    return f"; did you mean {folded[close[0]]!r}?" if close else f"; there are {', '.join(known)}"
