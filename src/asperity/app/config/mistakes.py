"""Messages on mistakes in a configuration: place, expectation, value."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from asperity.app.config.models import KINDS, LEGS, SECTIONS
from asperity.base.words import MEANT, closest, has_decimal_comma, shortened
from asperity.errors import SHOWN_PROBLEMS

Sections = dict[str, dict[str, object]]

ORDER = [*KINDS, *SECTIONS]
"""All sections, in the order in which they are written and shown."""

_FLAGS = {
    ("surface", "kind"): "surface",
    ("surface", "path"): "file",
    ("surface", "places"): "place",
    ("solid", "kind"): "solid",
    ("solid", "branches"): "branch",
    ("solid", "base_branches"): "base-branch",
    ("solid", "per_decade"): "branches-per-decade",
    ("solid", "table_kind"): "kind",
    ("solid", "free_branches"): "branches",
}


_UNKNOWN = "no such key"


def models_of(section: str) -> Sequence[type[BaseModel]]:
    """Models of a section: one, or one of each kind."""
    return list(KINDS[section].values()) if section in KINDS else [SECTIONS[section]]


def flag_of(section: str, key: str) -> str:
    """Name of the flag that sets a key."""
    return "--" + _FLAGS.get((section, key), key).replace("_", "-")


def spelled(
    errors: Iterable[ErrorDetails], flags: Sections, path: Path | None, section: str = ""
) -> list[str]:
    """One line for each mistake of pydantic, unknown names first, with suggestions for those shown."""
    return [
        _line(detail, [section, *detail["loc"]] if section else [*detail["loc"]], flags, path)
        + (_suggestion(detail, section) if number < SHOWN_PROBLEMS else "")
        for number, detail in enumerate(sorted(errors, key=lambda one: one["type"] != "extra_forbidden"))
    ]


def _line(detail: ErrorDetails, place: list[Any], flags: Sections, path: Path | None) -> str:
    expected, home = _expectation(detail), str(place[0]) if place else ""
    kind = place.pop(1) if len(place) > 1 and place[1] in KINDS.get(home, {}) else ""
    if home == "protocol":
        return _of_leg(place, expected, flags, path)
    if len(place) < 2:
        if detail["type"].startswith("union_tag"):
            return f"{_named(home, 'kind', flags, path)}: {expected}"
        if detail["type"] == "extra_forbidden":
            return _where(path, _outside(home, detail["input"], path))
        if detail["type"] == "value_error":
            return _of_section(home, expected, flags, path) if home else _of_all(expected, flags, path)
        return _where(path, f"{home}: expected a section [{home}], got {_shown(detail['input'])}")
    key, keys = str(place[1]), flags.get(home, {})
    if detail["type"] == "missing" and "kind" in keys:
        file = "expected the file of the surface, got none; try --file PATH"
        return f"{flag_of(home, key)}: {file if key == 'path' else expected}"
    owners = [other for other, model in KINDS.get(home, {}).items() if key in model.model_fields]
    if (
        detail["type"] == "extra_forbidden"
        and owners
        and MEANT.get(key) not in KINDS[home][kind].model_fields
    ):
        expected = f"not a key of a {home} of kind {kind!r}, but of {' and '.join(map(repr, owners))}"
        expected += f"; try --{home} {owners[0]}" if key in keys else ""
    return f"{_named(home, key, flags, path)}: {expected}"


def _outside(name: str, content: object, path: Path | None) -> str:
    if name == "sweep":
        command = f"asperity sweep {shlex.quote(str(path or 'campaign.toml'))} --out FOLDER"
        return f"[sweep]: makes this the file of a campaign, not of a run; try {command}"
    if isinstance(content, dict):
        return f"[{name}]: no such section"
    homes = [
        section
        for section in (*SECTIONS, *KINDS)
        for model in models_of(section)
        if name in model.model_fields
    ]
    return f"{name}: stands outside any section{f'; it belongs below [{homes[0]}]' if homes else ''}"


def _suggestion(detail: ErrorDetails, section: str) -> str:
    place, got = [section, *detail["loc"]] if section else [*detail["loc"]], detail["input"]
    home, word, candidates = str(place[0]) if place else "", str(place[-1]) if place else "", list[str]()
    if detail["type"] != "extra_forbidden" or word == "sweep":
        return ""
    if len(place) == 1:
        candidates = [*ORDER, "sweep"] if isinstance(got, dict) else []
    elif home == "protocol":
        candidates = [name for name in LEGS[str(place[-2])].model_fields if name != "kind"]
    else:
        kinds = KINDS.get(home, {})
        model = kinds[str(place[1])] if kinds else SECTIONS[home]
        others = {name for one in kinds.values() for name in one.model_fields}
        meant, candidates = MEANT.get(word), [] if word in others else list(model.model_fields)
        if meant in model.model_fields or (candidates and meant in others):
            return f"; try {meant}"
    return _meant(word, candidates) or (f"; there are {', '.join(candidates)}" if candidates else "")


def _of_section(section: str, sentence: str, flags: Sections, path: Path | None) -> str:
    """One line for a mistake of a section, with flags for keys that came, or may come, as such.

    Keys are before a colon, or marked; advice has arguments of the library.
    """
    keys = flags.get(section, {})

    def named(match: re.Match[str]) -> str:
        key, values = next(filter(None, match.groups())), match[0].partition("=")[2].strip("[]")
        key = "table_kind" if key == "kind" else key
        if key in keys or (keys and path is None):
            flag = flag_of(section, key)
            return f"{flag} {values.replace(',', '')}" if "=" in match[0] else flag
        return match[0].replace("=", " = ") if "=" in match[0] else key

    head, mark, advice = re.sub(r"^(\w+)(?=: )|`(\w+)`", named, sentence).partition("; try ")
    sentence = head + mark + re.sub(r"(?<![\"\w])(\w+)=(?=\S)(\[[\d., ]+\])?", named, advice)
    return sentence if sentence.startswith("--") else _where(path, f"[{section}] {sentence}")


def _of_all(sentence: str, flags: Sections, path: Path | None) -> str:
    """One line for a mistake of the whole configuration, with flags of keys and legs that came as such."""
    place, mark, rest = sentence.partition(": ")
    if "protocol" in flags and (leg := place.removeprefix("protocol")) != place:
        return f"--leg {leg}{mark}{rest}"
    if match := re.fullmatch(r"\[(\w+)\] (\w+)", place):
        return f"{_named(match[1], match[2], flags, path)}{mark}{rest}"
    return _where(path, sentence)


def _of_leg(place: list[Any], expected: str, flags: Sections, path: Path | None) -> str:
    """One line for a mistake in a leg of the protocol; legs count from 0."""
    named = "protocol"
    for before, part in pairwise(place):
        if isinstance(part, int):
            named += f"[{part}]"
        elif not isinstance(before, int):  # after a number stands the kind of leg, which is no key
            named += f" {part}"
    if "protocol" in flags:
        named = named.rpartition(" ")[2] if expected == _UNKNOWN else named.removeprefix("protocol")
        return f"--leg {named}: {expected}"
    return _where(path, f"{named}: {expected}")


def _expectation(detail: ErrorDetails) -> str:
    context = detail.get("ctx", {})
    kind, got = detail["type"], detail["input"]
    if kind == "missing":
        return "expected a value, got none"
    if kind == "extra_forbidden":
        return _UNKNOWN
    if detail["loc"][:1] == ("protocol",) and kind in ("list_type", "model_attributes_type"):
        return 'expected a list of legs; try [[protocol]] with kind = "hold" and duration = 10.0'
    if kind == "value_error":
        return str(context["error"])
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        got = got.get("kind") if isinstance(got, dict) else got
        kinds = list({**KINDS, "protocol": LEGS}[str(detail["loc"][0])])
        return f"expected one of {', '.join(map(repr, kinds))}, got {_shown(got)}{_meant(got, kinds)}"
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
    elif (kind, detail["loc"][:2]) == ("float_type", ("surface", "spectral")) and (
        length := re.fullmatch(r"(.*?) *([munp]?m)", str(got))
    ):
        line += f"; try {length[1]}, and unit = {length[2]!r} for all lengths (--unit {length[2]})"
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
    if key in flags.get(section, {}):
        return flag_of(section, key)
    return _where(path, f"[{section}] {key}")


def _where(path: Path | None, text: str) -> str:
    return text if path is None else f"{path}: {text}"


def _meant(word: object, names: Iterable[str]) -> str:
    meant = closest(word, names) if isinstance(word, str) else None
    return f"; did you mean {meant!r}?" if meant else ""
