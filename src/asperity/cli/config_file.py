"""From a TOML file and flags to a checked configuration, and from a configuration to TOML."""

from __future__ import annotations

import json
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from asperity.cli.config import SURFACES, Aging, Contact, MeasuredSurface, Output, RunConfig, Solid
from asperity.cli.flags import flag_of
from asperity.errors import ConfigError

Sections = dict[str, dict[str, object]]

_SECTIONS: dict[str, type[BaseModel]] = {
    "solid": Solid,
    "contact": Contact,
    "aging": Aging,
    "output": Output,
}
# A flag replaces the keys that say the same thing in another way.
_RIVALS = {
    ("contact", "load"): ("separation",),
    ("contact", "separation"): ("load",),
    ("aging", "times"): ("first", "last", "per_decade"),
    ("aging", "first"): ("times",),
    ("aging", "last"): ("times",),
    ("aging", "per_decade"): ("times",),
}


def read_config(path: Path | None, flags: Sections) -> RunConfig:
    """Read a configuration, lay the flags over it, and check the whole.

    Parameters
    ----------
    path
        TOML file, or None for the defaults. A relative path of a surface in it is relative to it.
    flags
        Values by section and key.

    Raises
    ------
    ConfigError
        With one line for each mistake.
    """
    tables = {} if path is None else _tables(path)
    merged = _merged(tables, flags)
    problems = _unknown(merged, flags, path)
    try:
        config = RunConfig.model_validate(merged)
    except ValidationError as error:
        problems += [_spelled(detail, flags, path) for detail in error.errors() if not _is_unknown(detail)]
        raise ConfigError(problems) from None
    if problems:
        raise ConfigError(problems)
    return config


def file_surface(path: Path, flags: dict[str, object]) -> MeasuredSurface:
    """Check how a surface file shall be prepared.

    Raises
    ------
    ConfigError
        With one line for each mistake.
    """
    given = {"path": str(path), **flags}
    try:
        return MeasuredSurface.model_validate(given)
    except ValidationError as error:
        raise ConfigError(
            [_spelled(detail, {"surface": given}, None, section="surface") for detail in error.errors()]
        ) from None


def to_toml(config: RunConfig) -> str:
    """Write a configuration so that `read_config` reads the very same one."""
    lines = []
    for section, keys in config.model_dump(exclude_none=True).items():
        if "times" in keys:
            keys = {key: value for key, value in keys.items() if key not in ("first", "last", "per_decade")}
        lines += [f"[{section}]", *(f"{key} = {_toml_value(value)}" for key, value in keys.items()), ""]
    return "\n".join(lines)


def _tables(path: Path) -> dict[str, Any]:
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ConfigError([f"{path}: not a TOML file: {error}"]) from None
    except UnicodeDecodeError:
        raise ConfigError([f"{path}: not a TOML file: not text in UTF-8"]) from None
    except OSError as error:
        raise ConfigError([f"{path}: {error.strerror}"]) from None
    surface = tables.get("surface")
    if isinstance(surface, dict) and isinstance(surface.get("path"), str):
        surface["path"] = str(path.parent / surface["path"])
    return tables


def _merged(tables: dict[str, Any], flags: Sections) -> dict[str, Any]:
    merged = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    for section, keys in flags.items():
        table = merged.setdefault(section, {})
        if not isinstance(table, dict):  # a mistake of the file; it is reported
            continue
        for key in keys:
            for rival in _RIVALS.get((section, key), ()):
                if rival not in keys:
                    table.pop(rival, None)
        table.update(keys)
    surface = merged.setdefault("surface", {})
    if isinstance(surface, dict):
        chosen = flags.get("surface", {})
        if "path" in chosen and "kind" not in chosen:
            surface["kind"] = "file"
        surface.setdefault("kind", "file" if "path" in surface else "gaussian")
        _drop_foreign(surface, tables.get("surface"), chosen)
    return merged


def _drop_foreign(surface: dict[str, Any], before: object, chosen: dict[str, object]) -> None:
    """Where a flag replaces the file's kind of surface, the file's keys for the old kind go with it."""
    model = SURFACES.get(surface["kind"]) if isinstance(surface["kind"], str) else None
    old = before.get("kind", "gaussian") if isinstance(before, dict) else surface["kind"]
    if model is None or old == surface["kind"] or old not in SURFACES:
        return
    for key in set(SURFACES[old].model_fields) - set(model.model_fields) - set(chosen):
        surface.pop(key, None)


def _unknown(merged: dict[str, Any], flags: Sections, path: Path | None) -> list[str]:
    """Find sections and keys that do not exist, and suggest those that do."""
    problems = []
    for section, table in merged.items():
        if section != "surface" and section not in _SECTIONS:
            problems.append(_where(path, _no_section(section, table)))
        elif not isinstance(table, dict):
            problems.append(_where(path, f"{section}: expected a section [{section}], got {table!r}"))
        else:
            problems += _unknown_keys(section, table, flags, path)
    return problems


def _no_section(name: str, content: object) -> str:
    """Say what is wrong with a name at the top of the file."""
    if isinstance(content, dict):
        return f"[{name}]: no such section{_suggestion(name, ['surface', *_SECTIONS])}"
    homes = [section for section, model in _SECTIONS.items() if name in model.model_fields]
    if any(name in model.model_fields for model in SURFACES.values()):
        homes.append("surface")
    where = f"; it belongs below [{homes[0]}]" if homes else ""
    return f"{name}: stands outside any section{where}"


def _unknown_keys(section: str, table: dict[str, Any], flags: Sections, path: Path | None) -> list[str]:
    kind = table.get("kind")
    model = _SECTIONS.get(section)
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


def _is_unknown(detail: ErrorDetails) -> bool:
    """Whether `_unknown` has reported this already."""
    return detail["type"] in ("extra_forbidden", "model_type", "model_attributes_type")


def _spelled(detail: ErrorDetails, flags: Sections, path: Path | None, section: str = "") -> str:
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


def _toml_value(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_toml_value, value))}]"
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for DEL, which TOML wants escaped.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)
