"""From a TOML file and flags to a checked configuration, and from a configuration to TOML."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asperity.app.config.mistakes import Door, Names, Sections
from asperity.ask.files import read_tables
from asperity.ask.laws import KEYS_OF_LAWS, OF_LAWS
from asperity.ask.questions import QUESTIONS
from asperity.ask.run import RunConfig
from asperity.ask.section import KINDS, SectionError, kind_in
from asperity.ask.surface import MeasuredSurface
from asperity.base.words import tables_to_toml
from asperity.errors import InputError

COMMANDS = {"prediction": "predict"}
"""Commands that have another name than the section of their question."""


def read_config(path: str | Path | None, flags: Sections) -> RunConfig:
    """Read a configuration or the defaults, override it by flags, and check the whole; see `config_at`."""
    return config_at(Door(flags, None if path is None else Path(path)))


def config_from(
    tables: dict[str, Any], flags: Sections, path: Path | None, names: Names | None = None
) -> RunConfig:
    """Check the tables of a file of any question, overridden by flags; path and `names` are for mistakes."""
    return config_at(Door(flags, path, names or {}), tables, question_of(tables))


def config_at(door: Door, tables: dict[str, Any] | None = None, question: str = "") -> RunConfig:
    """Check what came through a door: its file, or these tables of it, overridden by its flags.

    The keys of a question other than a run stand in a section of its name. A relative path in the file is
    relative to it. `ConfigError` with one line for each mistake.
    """
    if tables is None:
        tables = {} if door.file is None else read_tables(door.file)
    merged, mistakes = _merged(tables, door.flags), list[InputError]()
    for name in ("sweep", *QUESTIONS):
        if name != question and merged.pop(name, None) is not None:
            what = "campaign" if name == "sweep" else f"question of {name}"
            said = f"makes this the file of a {what}, not of a {question or 'run'}"
            advice = f"asperity {COMMANDS.get(name, name)} FILE{' --out FOLDER' * (name == 'sweep')}"
            mistakes.append(InputError(name, said=said, advice=advice, path=(name,)))
    try:
        config = RunConfig.read(merged | ({question: merged.get(question, {})} if question else {}))
    except SectionError as error:
        mistakes += error.mistakes
    if mistakes:
        raise door.refused(mistakes)
    return config


def question_of(tables: Mapping[str, Any]) -> str:
    """The question whose section a file has; empty for a run."""
    return next((name for name in QUESTIONS if name in tables), "")


def file_surface(path: Path, flags: dict[str, object]) -> MeasuredSurface:
    """Check the preparation of a surface file; `ConfigError` with one line for each mistake."""
    try:
        return MeasuredSurface(path=str(path), **flags)
    except SectionError as error:
        raise Door({"surface": flags}).refused(error.mistakes) from None


def to_tables(config: RunConfig) -> dict[str, Any]:
    """Tables of which `RunConfig.read` makes a configuration that asks the same."""
    tables, unused = config.tables, dict(config.question.unused)
    if "times" in tables["aging"]:
        unused["aging"] = {"first", "last", "per_decade", *unused.get("aging", ())}
    for name, keys in unused.items():
        tables[name] = {key: value for key, value in tables.get(name, {}).items() if key not in keys}
    if config.carries is None:
        del tables["carried"]
    return {name: table for name, table in tables.items() if table or name == config.asked}


def to_toml(config: RunConfig) -> str:
    """Write a configuration as `config_at` reads it."""
    return tables_to_toml(to_tables(config))


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
        table = None if "" in kinds else merged.setdefault(section, {})
        if not isinstance(table, dict):
            continue
        before, chosen = tables.get(section), flags.get(section, {})
        if section == "surface" and "path" in chosen and "kind" not in chosen:
            table["kind"] = "file"
        table["kind"] = kind_in(section, table)
        both = (before if isinstance(before, dict) else table), table
        old, new = (getattr(kinds.get(str(kind_in(section, one))), "keys", {}) for one in both)
        for key in old.keys() - new.keys() - chosen.keys() if new else ():  # a flag replaced the kind
            table.pop(key, None)
        if "spacing" in new and "pixel_size" in table.keys() - new.keys() and "spacing" not in table:
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
