"""One description of the keys of a configuration, from which flags, forms and reference pages are made.

It is read from the models, so a new key has its flag, its field and its lines.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast

from pydantic import BaseModel

from asperity.app.config.models import FILES, KINDS, LEGS, SECTIONS, RunConfig

What = Literal[
    "number",
    "whole",
    "numbers",
    "wholes",
    "pair",
    "pairs",
    "lists of pairs",
    "choice",
    "choices",
    "switch",
    "text",
    "texts",
    "text or whole",
    "path",
    "legs",
]
"""Types of keys; ``whole`` is a whole number, a pair has two numbers."""


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key of a section.

    A number with a `unit` (of a pair: `units`) may be written with one. It is then in SI under a continuum
    whose surface has a unit of length, and in the user's own units otherwise. The `default` is None where it
    follows from other keys, or is nothing. `least` and `most` bound each number, but none of a pair; where
    `above` or `below` is true, the bound itself is excluded.
    """

    name: str
    what: What
    unit: str = ""
    units: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()
    default: Any = None
    required: bool = False
    least: float | None = None
    most: float | None = None
    above: bool = False
    below: bool = False
    description: str = ""

    @property
    def several(self) -> bool:
        """Whether it is a list."""
        return self.what in ("numbers", "wholes", "texts", "choices", "pairs")


Keys = dict[str, Key]


def sections(*, short: bool = False) -> dict[str, dict[str, Keys]]:
    """Keys of all sections, by section, kind ("" where a section has no kinds) and name.

    The first kind is the usual one. ``"protocol"`` has the kinds of legs. With `short`, without keys that
    are too long for a flag or a field of a form.
    """
    kinds: dict[str, Mapping[str, type[BaseModel]]] = {**KINDS, "protocol": LEGS}
    return {
        section: {
            kind: {
                name: key
                for name, key in keys_of(model).items()
                if not (short and key.what == "lists of pairs")
            }
            for kind, model in (kinds.get(section) or {"": SECTIONS[section]}).items()
        }
        for section in RunConfig.model_fields
    }


@functools.cache  # a command asks often, and a schema takes milliseconds
def keys_of(model: type[BaseModel]) -> Keys:
    """Keys of one model, but for its kind."""
    schema = model.model_json_schema()
    schema = schema["$defs"][model.__name__] | schema if "$ref" in schema else schema
    needed = schema.get("required", [])
    return {
        name: _key(name, facts, required=name in needed)
        for name, facts in schema["properties"].items()
        if name != "kind"
    }


def _key(name: str, facts: dict[str, Any], *, required: bool) -> Key:
    kinds = [kind for kind in facts.get("anyOf", [facts]) if kind.get("type") != "null"]
    several = "items" in kinds[0]
    schema = kinds[0]["items"] if several else kinds[0]
    choices = tuple(schema.get("enum", [schema["const"]] if "const" in schema else []))
    plain = {"number": "number", "integer": "whole", "boolean": "switch", "string": "text"}
    sort = "choice" if choices else plain.get(schema.get("type"), "legs")
    if "prefixItems" in schema:
        sort = "pair"
    elif "items" in schema:
        sort = "lists of pairs"
    elif len(kinds) > 1:
        sort = "text or whole"
    elif sort == "text" and name in FILES.values():
        sort = "path"
    return Key(
        name=name,
        what=cast(What, f"{sort}s" if several and sort not in ("legs", "lists of pairs") else sort),
        unit=schema.get("unit", ""),
        units=tuple(part.get("unit", "") for part in schema.get("prefixItems", ())),
        choices=choices,
        default=facts.get("default"),
        required=required,
        least=schema.get("exclusiveMinimum", schema.get("minimum")),
        most=schema.get("exclusiveMaximum", schema.get("maximum")),
        above="exclusiveMinimum" in schema,
        below="exclusiveMaximum" in schema,
        description=facts.get("description", ""),
    )
