"""One description of the keys of a configuration, from which flags, forms and reference pages are made.

It is read from the models, so that a key that is added there has its flag, its field and its lines at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic.functional_validators import WrapValidator

from asperity.app.config.models import KINDS, LEGS, Aging, Contact, Friction, Output
from asperity.app.config.sections import InUnit

What = Literal[
    "number",
    "whole",
    "numbers",
    "wholes",
    "pair",
    "pairs",
    "choice",
    "choices",
    "switch",
    "text",
    "text or whole",
    "path",
    "legs",
]
"""What a key may be; ``whole`` is a whole number, a pair has two numbers."""

_PATHS = ("path", "relaxation")
"""Keys that name files."""


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key of a section.

    Attributes
    ----------
    name
        Its name in TOML.
    what
        What it may be.
    unit
        Unit in SI, if the number may be written with one; such a number is in SI under a continuum whose
        surface has a unit of length, and in the user's own units otherwise.
    choices
        The words that it may be.
    default
        What it is where it is not given; None if that follows from other keys, or is nothing.
    required
        Whether it must be given.
    least, most
        Bounds of the number, or of each of the numbers; None without one, and for pairs.
    above, below
        Whether the bound itself is excluded.
    description
        What it means, in a sentence.
    """

    name: str
    what: What
    unit: str = ""
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
        return self.what in ("numbers", "wholes", "choices", "pairs")


Keys = dict[str, Key]


def sections() -> dict[str, dict[str, Keys]]:
    """Keys of all sections, by section, kind ("" where a section has no kinds) and name.

    The first kind is the usual one. ``"protocol"`` has the kinds of legs.
    """
    known: dict[str, Mapping[str, type[BaseModel]]] = {
        **KINDS,
        "contact": {"": Contact},
        "aging": {"": Aging},
        "protocol": LEGS,
        "friction": {"": Friction},
        "output": {"": Output},
    }
    return {
        section: {kind: keys_of(model) for kind, model in kinds.items()} for section, kinds in known.items()
    }


def keys_of(model: type[BaseModel]) -> Keys:
    """Keys of one model, but for its kind."""
    return {name: _key(name, field) for name, field in model.model_fields.items() if name != "kind"}


def _key(name: str, field: FieldInfo) -> Key:
    kinds = list(_kinds(field.annotation))
    facts = [*field.metadata, *_facts(field.annotation)]
    choices = tuple(kind for kind in kinds if isinstance(kind, str))
    bounds: dict[str, Any] = {}
    for fact in facts if tuple not in kinds else ():
        if isinstance(fact, Ge | Gt):
            bounds |= {"least": fact.ge if isinstance(fact, Ge) else fact.gt, "above": isinstance(fact, Gt)}
        elif isinstance(fact, Le | Lt):
            bounds |= {"most": fact.le if isinstance(fact, Le) else fact.lt, "below": isinstance(fact, Lt)}
    units = [
        fact.func.unit for fact in facts if isinstance(fact, WrapValidator) and isinstance(fact.func, InUnit)
    ]
    return Key(
        name=name,
        what=_what(name, kinds, choices),
        unit=units[0] if units and tuple not in kinds else "",
        choices=choices,
        default=None if field.is_required() else field.default,
        required=field.is_required(),
        description=field.description or "",
        **bounds,
    )


def _what(name: str, kinds: list[object], choices: tuple[str, ...]) -> What:
    several = list in kinds
    if bool in kinds:
        return "switch"
    if choices:
        return "choices" if several else "choice"
    if tuple in kinds:
        return "pairs" if several else "pair"
    if float in kinds:
        return "numbers" if several else "number"
    if str in kinds:
        return "path" if name in _PATHS else "text or whole" if int in kinds else "text"
    if int in kinds:
        return "wholes" if several else "whole"
    return "legs"


def _kinds(annotation: Any) -> Iterator[object]:
    """All that a key may be: the types and the words in its annotation, and ``list`` where it may be one."""
    parts = get_args(annotation)
    if not parts:
        yield annotation
    elif hasattr(annotation, "__metadata__"):
        yield from _kinds(parts[0])
    else:
        if (origin := getattr(annotation, "__origin__", None)) in (list, tuple):
            yield origin
        for part in parts:
            yield from _kinds(part)


def _facts(annotation: Any) -> Iterator[object]:
    """What stands beside the types within an annotation: bounds, validators."""
    for fact in getattr(annotation, "__metadata__", ()):
        yield from fact.metadata if isinstance(fact, FieldInfo) else (fact,)
    for part in get_args(annotation):
        if not isinstance(part, FieldInfo | WrapValidator):
            yield from _facts(part)
