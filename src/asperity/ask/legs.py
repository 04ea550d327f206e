"""Legs of a history from tables: ``{"kind": "ramp", "duration": "5 s", "load": 400.0}``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from asperity.ask.section import SectionError, keys_of_maker, read_keys
from asperity.base.checks import choice, shown
from asperity.errors import InputError
from asperity.protocols import Leg, MeasuredHistory, measured
from asperity.protocols.legs import KINDS

Place = tuple[str | int, ...]

_LEGS = "legs"


def read_legs(tables: object, path: Place = ("protocol",)) -> tuple[Leg, ...]:
    """Legs of a list of tables, or of a file; `SectionError` with every mistake, and its place."""
    if isinstance(tables, tuple) and all(isinstance(leg, Leg) for leg in tables):
        return tables
    if isinstance(tables, dict) and tables.keys() & keys_of_maker(measured).keys():
        history: MeasuredHistory = _made(measured, tables, path)
        return history
    if not isinstance(tables, list | tuple):
        advice = (
            '[[protocol]] with kind = "hold" and duration = 10.0, or [protocol] with file = "history.csv"'
        )
        raise SectionError([InputError("protocol", said="expected a list of legs", advice=advice, path=path)])
    legs: list[Leg] = []
    mistakes = [one for number, leg in enumerate(tables) for one in _read(leg, (*path, number), legs)]
    if mistakes:
        raise SectionError(mistakes)
    return tuple(legs)


def _made(make: Callable[..., Any], table: dict[str, Any], path: Place) -> Any:
    """What a function makes of a table; `SectionError` with every mistake."""
    keys = keys_of_maker(make)
    read = read_keys(keys, table, path)
    try:
        return make(**{key: read[key] for key in table})
    except InputError as error:
        raise SectionError([error.about(error.name, *path, *[error.name] * (error.name in keys))]) from None


def _read(table: Any, path: Place, legs: list[Leg]) -> Iterator[InputError]:
    """Append a leg, or yield its mistakes."""
    try:
        kind = choice("kind", table.get("kind") if isinstance(table, dict) else table, tuple(KINDS))
        values = {key: value for key, value in table.items() if key != "kind"}
        if _LEGS in keys_of_maker(KINDS[kind]):
            if not values.get(_LEGS):
                raise InputError(_LEGS, expected="at least 1 in the list", got=shown(values.get(_LEGS)))
            values[_LEGS] = list(read_legs(values[_LEGS], (*path, _LEGS)))
        legs.append(_made(KINDS[kind], values, path))
    except SectionError as error:
        yield from error.mistakes
    except InputError as error:
        yield error.about(error.name, *path, *[error.name] * (error.name != "kind"))
