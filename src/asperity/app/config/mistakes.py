"""How mistakes in a configuration are named: where they stand, what was expected, what came."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from asperity.app.config.models import KINDS, LEGS, SECTIONS
from asperity.app.config.solids import OF_TABLES
from asperity.base.words import MEANT, closest, has_decimal_comma, shortened
from asperity.errors import SHOWN_PROBLEMS

Sections = dict[str, dict[str, object]]

ORDER = [*KINDS, *SECTIONS]
"""All sections, in the order in which they are written and shown."""


def models_of(section: str) -> Sequence[type[BaseModel]]:
    """Models of a section: one, or one of each kind."""
    return list(KINDS[section].values()) if section in KINDS else [SECTIONS[section]]


def flag_of(section: str, key: str) -> str:
    """Name of the flag that sets a key."""
    names = {
        ("surface", "kind"): "surface",
        ("surface", "path"): "file",
        ("surface", "places"): "place",
        ("solid", "kind"): "solid",
        ("solid", "branches"): "branch",
        ("solid", "base_branches"): "base-branch",
        ("solid", "per_decade"): "branches-per-decade",
        ("solid", "table_kind"): "kind",
    }
    return "--" + names.get((section, key), key).replace("_", "-")


def unknown_names(merged: dict[str, Any], flags: Sections, path: Path | None) -> list[str]:
    """Find sections and keys that do not exist, and suggest those that do; in lines not shown nothing."""
    found = list(_unknown(merged, flags, path))
    told = [
        said + (_meant(word, known) or f"; there are {', '.join(known)}") if known else said
        for said, word, known in found[:SHOWN_PROBLEMS]
    ]
    return told + [said for said, _, _ in found[SHOWN_PROBLEMS:]]


Unknown = tuple[str, str, list[str]]
"""What is wrong with a name, the name, and those that may have been meant."""


def _unknown(merged: dict[str, Any], flags: Sections, path: Path | None) -> Iterator[Unknown]:
    for section, table in merged.items():
        if section == "protocol":
            yield from _unknown_in_legs(table, flags, path)
        elif section not in ORDER:
            yield _no_section(section, table, path)
        elif not isinstance(table, dict):
            yield _where(path, f"{section}: expected a section [{section}], got {_shown(table)}"), "", []
        else:
            yield from _unknown_keys(section, table, flags, path)


def _no_section(name: str, content: object, path: Path | None) -> Unknown:
    """Say what is wrong with a name at the top of the file."""
    if name == "sweep":
        command = f"asperity sweep {shlex.quote(str(path or 'campaign.toml'))} --out FOLDER"
        reason = f"makes this the file of a campaign, not of a run; try {command}"
        return _where(path, f"[sweep]: {reason}"), "", []
    if isinstance(content, dict):
        return _where(path, f"[{name}]: no such section"), name, [*ORDER, "sweep"]
    homes = [one for one in (*SECTIONS, *KINDS) for model in models_of(one) if name in model.model_fields]
    where = f"; it belongs below [{homes[0]}]" if homes else ""
    return _where(path, f"{name}: stands outside any section{where}"), "", []


def _unknown_keys(
    section: str, table: dict[str, Any], flags: Sections, path: Path | None
) -> Iterator[Unknown]:
    kind = table.get("kind")
    kinds: Mapping[str, type[BaseModel]] = KINDS.get(section, {})
    model = SECTIONS.get(section) or (kinds.get(kind) if isinstance(kind, str) else None)
    if model is None:  # the kind itself is the mistake
        return
    known = list(model.model_fields)
    for key in table:
        if key in known:
            continue
        named = _named(section, key, flags, path)
        owners = [name for name, other in kinds.items() if key in other.model_fields]
        meant = MEANT.get(key)
        if meant in known or (not owners and any(meant in other.model_fields for other in kinds.values())):
            yield f"{named}: no such key; try {meant}", key, []
        elif owners:
            reason = f"not a key of a {section} of kind {kind!r}, but of {' and '.join(map(repr, owners))}"
            if key in flags.get(section, {}):
                reason += f"; try --{section} {owners[0]}"
            yield f"{named}: {reason}", key, []
        else:
            yield f"{named}: no such key", key, known


def _unknown_in_legs(
    legs: object, flags: Sections, path: Path | None, where: str = "protocol"
) -> Iterator[Unknown]:
    """Find keys of legs that do not exist."""
    if not isinstance(legs, list) or not all(isinstance(leg, dict) for leg in legs):
        advice = '[[protocol]] with kind = "hold" and duration = 10.0'
        yield _where(path, f"{where}: expected a list of legs; try {advice}"), "", []
        return
    for number, leg in enumerate(legs):
        known = list(LEGS[str(leg.get("kind"))].model_fields) if str(leg.get("kind")) in LEGS else list(leg)
        here = f"{where}[{number}]"
        for key in leg:
            if key not in known:
                named = f"--leg {key}" if "protocol" in flags else _where(path, f"{here} {key}")
                yield f"{named}: no such key", key, [name for name in known if name != "kind"]
        if "legs" in leg and "legs" in known:
            yield from _unknown_in_legs(leg["legs"], flags, path, f"{here} legs")


def is_unknown(detail: ErrorDetails) -> bool:
    """Whether `unknown_names` has reported this already."""
    reported = ("extra_forbidden", "model_type", "model_attributes_type")
    return detail["type"] in reported or detail["loc"] == ("protocol",)


def spelled(detail: ErrorDetails, flags: Sections, path: Path | None, section: str = "") -> str:
    """One line for one mistake that pydantic found."""
    place = [section, *detail["loc"]] if section else list(detail["loc"])
    if len(place) > 1 and place[1] in KINDS.get(str(place[0]), {}):
        del place[1]
    expected = _expectation(detail)
    if place[:1] == ["protocol"]:
        return _spelled_leg(place, expected, flags, path)
    if detail["type"] == "missing" and place[-1] == "path" and "kind" in flags.get("surface", {}):
        return "--file: expected the file of the surface, got none; try --file PATH"
    if not place:
        return _where(path, expected)
    if len(place) == 1:
        if detail["type"].startswith("union_tag"):
            place.append("kind")
        else:
            return _of_section(str(place[0]), expected, flags, path)
    section, key = str(place[0]), str(place[1])
    if detail["type"] == "missing" and "kind" in flags.get(section, {}):
        return f"{flag_of(section, key)}: {expected}"
    return f"{_named(section, key, flags, path)}: {expected}"


def _of_section(section: str, said: str, flags: Sections, path: Path | None) -> str:
    """One line for a mistake of a section; keys that came, or may come, as flags are named so."""
    given = flags.get(section, {})

    def named(found: re.Match[str]) -> str:
        key = found[1] or found[2] or found[3]
        if key in given or (given and path is None):
            return flag_of(section, key) + (f" {found[4].replace(',', '')}" if found[4] else "")
        return found[0].strip("`")

    said = re.sub(r"^(\w+)(?=: )|`(\w+)`|(?<=; try )(\w+) = \[?([\d., ]+)\]?$", named, said)
    # Advice on how to read a table, which is in the words of Python.
    key_or_flag = (lambda key: f"--{key[1]} ") if path is None else (lambda key: f"{OF_TABLES[key[1]]} = ")
    said = re.sub(rf'\b({"|".join(OF_TABLES)})=(?=["\d])', key_or_flag, said)
    return said if said.startswith("--") else _where(path, f"[{section}] {said}")


def _spelled_leg(place: list[Any], expected: str, flags: Sections, path: Path | None) -> str:
    """One line for a mistake in a leg of the protocol; legs count from 0."""
    named = "protocol"
    for before, part in pairwise(place):
        if isinstance(part, int):
            named += f"[{part}]"
        elif not isinstance(before, int):  # after a number stands the kind of leg, which is no key
            named += f" {part}"
    if "protocol" in flags:
        return f"--leg {named.removeprefix('protocol')}: {expected}"
    return _where(path, f"{named}: {expected}")


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
        known: Mapping[str, type[BaseModel]] = LEGS
        if detail["loc"][:1] != ("protocol",):
            known = KINDS[str(detail["loc"][0])] if detail["loc"] else KINDS["surface"]
        kinds = ", ".join(map(repr, known))
        return f"expected one of {kinds}, got {_shown(got)}{_meant(got, known)}"
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
        "bool_type": "true or false",
        "too_short": f"at least {context.get('min_length')} in the list",
        "too_long": f"at most {context.get('max_length')} in the list",
        "literal_error": f"one of {context.get('expected')}",
    }.get(kind, detail["msg"])
    line = f"expected {expected}, got {_shown(got)}"
    if kind in ("float_type", "int_type") and has_decimal_comma(got):
        line += f"; try {str(got).replace(',', '.')}"
        if len(detail["loc"]) > 2 and "protocol" not in detail["loc"]:  # within a list
            line += f", or {str(got).replace(',', ' ')} for two values"
    elif kind == "literal_error" and isinstance(got, str):
        line += _meant(got, re.findall(r"'(\w+)'", str(context.get("expected"))))
    return line


def _shown(value: object) -> str:
    """Write a value as TOML does, as far as a line has room."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        return shortened(repr(value))
    except ValueError:  # Python refuses to write numbers of thousands of digits
        return "a number with too many digits"


def _named(section: str, key: str, flags: Sections, path: Path | None) -> str:
    """Name a key as the user wrote it: a flag, or a key of a file's section."""
    if key in flags.get(section, {}):
        return flag_of(section, key)
    return _where(path, f"[{section}] {key}")


def _where(path: Path | None, text: str) -> str:
    return text if path is None else f"{path}: {text}"


def _meant(word: object, known: Iterable[str]) -> str:
    meant = closest(word, known) if isinstance(word, str) else None
    return f"; did you mean {meant!r}?" if meant else ""
