"""Keys as the doors show them: from each, its flag, its field in the form and its line of the reference."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from asperity.ask.run import FILES
from asperity.ask.section import KINDS, keys_of_maker
from asperity.ask.section import Keys as Parameters
from asperity.base.parameters import Parameter
from asperity.errors import LARGEST
from asperity.protocols import measured
from asperity.protocols.legs import KINDS as LEGS


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key of a section.

    `what` is number, whole (number), pair (of numbers), choice, switch, text, "text or whole", path or legs;
    of a list the plural of one of them, or lists of pairs.

    A number with a `unit` (of a pair: `units`) may be written with one. It is then in SI under a continuum
    whose surface has a unit of length, and in the user's own units otherwise. The `default` is None where it
    follows from other keys, or is nothing. `least` and `most` bound each number, but none of a pair; where
    `above` or `below` is true, the bound itself is excluded.
    """

    name: str
    what: str
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

_SEVERAL = {"legs": "legs", "text or whole": "texts"}


def sections(*, short: bool = False) -> dict[str, dict[str, Keys]]:
    """Keys of all sections, by section, kind ("" where a section has no kinds) and name.

    The first kind is the usual one. ``"protocol"`` has the kinds of legs. With `short`, without keys that
    are too long for a flag or a field of a form.
    """
    order = ("surface", "solid", "contact", "aging", "protocol", "friction", "carried", "output")
    return {section: kinds_of(section, short=short) for section in order}


def kinds_of(section: str, *, short: bool = False) -> dict[str, Keys]:
    """Keys of the kinds of a section, or of legs, by name; see `sections`."""
    legs = {kind: keys_of_maker(leg) for kind, leg in LEGS.items()}
    kinds = legs if section == "protocol" else {kind: one.keys for kind, one in KINDS[section].items()}
    return {
        kind: {name: key for name, key in keys_of(of).items() if not (short and key.what == "lists of pairs")}
        for kind, of in kinds.items()
    }


def keys_of(parameters: Parameters) -> Keys:
    """Keys of parameters, such as those of a section."""
    return {name: _key(name, parameter) for name, parameter in parameters.items()}


def _key(name: str, parameter: Parameter) -> Key:
    default, item = parameter.default, parameter.item
    one = parameter if parameter.words or item is None else item
    sort = _sort(name, one)
    bounds = _bounds(one, sort)
    if item is not None and not parameter.words:
        sort = "lists of pairs" if item.item is not None else _SEVERAL.get(sort, f"{sort}s")
    is_required = default is dataclasses.MISSING
    return Key(
        name=name,
        what=sort,
        unit=one.unit if sort.startswith("number") else "",
        units=tuple(part.unit for part in one.pair),
        choices=one.words,
        default=None if is_required else list(default) if isinstance(default, tuple) else default,
        required=is_required,
        least=bounds.get("above", bounds.get("least")),
        most=bounds.get("below", bounds.get("most")),
        above="above" in bounds,
        below="below" in bounds,
        description=parameter.quantity.help,
    )


def _sort(name: str, one: Parameter) -> str:
    """Type of one entry."""
    if one.words or one.pair:
        return "choice" if one.words else "pair"
    sorts = {
        float: "number",
        bool: "switch",
        int: "text or whole" if str in one.kinds else "whole",
        str: "path" if name in FILES.values() else "text",
    }
    return next((sort for kind, sort in sorts.items() if kind in one.kinds), "legs")


def _bounds(one: Parameter, sort: str) -> dict[str, float]:
    """Bounds of a number; a finite one has both."""
    bounds = one.bounds if sort in ("number", "whole") else {}
    if sort == "number" and "inf" not in one.kinds:
        bounds = ({} if "above" in bounds else {"least": -LARGEST}) | bounds
        bounds = ({} if "below" in bounds else {"most": LARGEST}) | bounds
    return bounds


HISTORY: Keys = keys_of(keys_of_maker(measured))
"""Keys of a measured history, in place of legs."""
