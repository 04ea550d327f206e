"""From a TOML file and flags to a checked configuration, and from a configuration to TOML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from asperity.app.config.keys import QUESTIONS
from asperity.app.config.mistakes import Door, Names, Sections
from asperity.ask.files import read_tables
from asperity.ask.laws import KEYS_OF_LAWS, OF_LAWS
from asperity.ask.question import Question
from asperity.ask.run import RunConfig
from asperity.ask.section import KINDS, Section, SectionError, read_keys, unknown_key
from asperity.ask.surface import MeasuredSurface
from asperity.base.checks import shown
from asperity.base.words import tables_to_toml
from asperity.errors import InputError

_OF_OTHERS = {
    "sweep": ("campaign", "asperity sweep FILE --out FOLDER"),
    "prediction": ("prediction", "asperity predict FILE"),
    "law": ("law", "asperity law FILE"),
    "sliding": ("steady slide", "asperity sliding FILE"),
}
"""Sections that no run has: of what they are, and the command for it."""


def read_config(path: str | Path | None, flags: Sections) -> RunConfig:
    """Read a configuration or the defaults, override it by flags, and check the whole; see `config_at`."""
    return config_at(Door(flags, None if path is None else Path(path)))


def config_from(
    tables: dict[str, Any], flags: Sections, path: Path | None, names: Names | None = None
) -> RunConfig:
    """Check the tables of a file, overridden by flags; path and `names` of keys are for mistakes."""
    return config_at(Door(flags, path, names or {}), tables)


def config_at(door: Door, tables: dict[str, Any] | None = None) -> RunConfig:
    """Check what came through a door: its file, or these tables of it, overridden by its flags.

    A relative path in the file is relative to it. `ConfigError` with one line for each mistake.
    """
    return _read(door, tables, "")[0]


def asked_at(door: Door, question: str) -> tuple[RunConfig, dict[str, Any]]:
    """Check what a question is asked through a door: a configuration, and its own keys that are given.

    These stand in a section of its name. `ConfigError` as above.
    """
    return _read(door, None, question)


def _read(door: Door, tables: dict[str, Any] | None, question: str) -> tuple[RunConfig, dict[str, Any]]:
    if tables is None:
        tables = {} if door.file is None else read_tables(door.file)
    merged, mistakes, own = _merged(tables, door.flags), list[InputError](), dict[str, Any]()
    for name, (what, advice) in _OF_OTHERS.items():
        if name != question and merged.pop(name, None) is not None:
            said = f"makes this the file of a {what}, not of a run"
            mistakes.append(InputError(name, said=said, advice=advice, path=(name,)))
    with _gathered(mistakes):
        own = _own(question, merged.pop(question, {}))
    with _gathered(mistakes):
        config = RunConfig.read(merged)
    if mistakes:
        raise door.refused(mistakes)
    return config, own


def _own(question: str, table: object) -> dict[str, Any]:
    """Values of the keys of a question that no section has; `SectionError` with every mistake."""
    if not isinstance(table, dict):
        expected = f"a section [{question}]"
        raise SectionError([InputError(question, expected=expected, got=shown(table), path=(question,))])
    asked = QUESTIONS.get(question, Question)
    keys = {name: key for name, key in asked.own().items() if name not in asked.placed}
    read = read_keys(keys, table, (question,), unknown=lambda key: unknown_key(key, keys, (question, key)))
    return {name: read[name] for name in table}


@contextmanager
def _gathered(mistakes: list[InputError]) -> Iterator[None]:
    try:
        yield
    except SectionError as error:
        mistakes += error.mistakes


def file_surface(path: Path, flags: dict[str, object]) -> MeasuredSurface:
    """Check the preparation of a surface file; `ConfigError` with one line for each mistake."""
    try:
        return MeasuredSurface(path=str(path), **flags)
    except SectionError as error:
        raise Door({"surface": flags}).refused(error.mistakes) from None


def to_tables(config: RunConfig) -> dict[str, Any]:
    """Tables of which `from_tables` makes the same configuration, without draws."""
    tables = config.tables
    if "times" in tables["aging"]:
        for rival in ("first", "last", "per_decade"):
            tables["aging"].pop(rival, None)
    for name in ("contact", "friction"):
        if not tables[name]:
            del tables[name]
    if config.carries is None:
        del tables["carried"]
    return tables


def from_tables(tables: dict[str, Any]) -> RunConfig:
    """Make a configuration of the tables of `to_tables`."""
    return RunConfig.read(tables)


def to_toml(config: RunConfig, **questions: Mapping[str, Any]) -> str:
    """Write a configuration as `read_config` reads it, or with the keys of questions as `asked_at` does."""
    return tables_to_toml(to_tables(config) | questions)


def _merged(tables: dict[str, Any], flags: Sections) -> dict[str, Any]:
    merged = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    for section, keys in flags.items():
        if section == "protocol":
            of_file = merged.get(section)
            merged[section] = keys.get("legs") or {**(of_file if isinstance(of_file, dict) else {}), **keys}
            continue
        table = merged.setdefault(section, {})
        if not isinstance(table, dict):  # a mistake of the file; it is reported
            continue
        for key, value in keys.items():
            for rival in _rivals(section, key, value) - keys.keys():
                table.pop(rival, None)
        table.update(keys)
    for section, kinds in KINDS.items():
        if "" in kinds:
            continue
        table = merged.setdefault(section, {})
        if not isinstance(table, dict):
            continue
        chosen = flags.get(section, {})
        if section == "surface" and "path" in chosen and "kind" not in chosen:
            table["kind"] = "file"
        usual = "file" if section == "surface" and "path" in table else next(iter(kinds))
        table.setdefault("kind", usual)
        _drop_foreign(kinds, table, tables.get(section), chosen)
        of_kind = getattr(kinds.get(str(table["kind"])), "keys", {})
        if "spacing" in of_kind and "pixel_size" in table.keys() - of_kind.keys() and "spacing" not in table:
            table["spacing"] = table.pop("pixel_size")
    return merged


def _rivals(section: str, key: str, value: object) -> set[str]:
    """Alternatives of a key, and keys that mean nothing beside it."""
    if section == "solid" and key in KEYS_OF_LAWS:
        return OF_LAWS[key].difference(*KEYS_OF_LAWS[key].get(str(value), []))
    groups = next((kind.ways for kind in KINDS.get(section, {}).values()), ())
    ways = next((ways for ways in groups if any(key in way for way in ways)), ())
    of_data = {"data_first", "data_last"} if {"branches"} in ways else set()  # other branches, other data
    return {rival for way in ways if key not in way for rival in way} | of_data


def _drop_foreign(
    kinds: Mapping[str, type[Section]], table: dict[str, Any], before: object, chosen: dict[str, object]
) -> None:
    """Drop the keys of the file for its kind, if a flag replaces that."""
    model = kinds.get(table["kind"]) if isinstance(table["kind"], str) else None
    old = before.get("kind", next(iter(kinds))) if isinstance(before, dict) else table["kind"]
    if model is None or old == table["kind"] or old not in kinds:
        return
    for key in set(kinds[old].keys) - set(model.keys) - set(chosen):
        table.pop(key, None)
