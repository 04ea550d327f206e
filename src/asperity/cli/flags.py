"""The flags of the commands, one for each key of the configuration.

A flag overrides its key; its help, default and choices are the key's. What was written becomes a number
where the key may be one, and is checked together with the configuration. The models load a library, so they
are imported only for a command that has such flags.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from cyclopts import Group, Parameter, Token

from asperity.words import number, numbers

if TYPE_CHECKING:
    from asperity.config.keys import Key, What


def _whole(_: object, tokens: Sequence[Token]) -> int:
    """Read a whole number; 1.5 is none, where the library would round."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {tokens[0].value}") from None


Switch = Annotated[bool, Parameter(negative=(), show_default=False)]
Quiet = Annotated[bool, Parameter(name=("--quiet", "-q"), negative=(), show_default=False)]
Open = Annotated[bool, Parameter(name="--open", negative=(), show_default=False)]
Out = Annotated[Path, Parameter(name=("--out", "-o"))]
Whole = Annotated[int, Parameter(converter=_whole)]
_METAVARS = {
    "number": "FLOAT",
    "whole": "INT",
    "choice": "CHOICE",
    "path": "PATH",
    "text": "TEXT",
    "text or whole": "TEXT",
    "shape": "N",
    "times": "T",
    "maps_at": "T",
    "crop": "N",
    "branches": "SHARE TIME",
    "base_branches": "SHARE TIME",
    "flow": "MOBILITY POWER",
}
"""What stands for the words of a flag in the help, by what its key is, or by its name."""


class Flags:
    """What was written for the keys of one section; None for a flag that was not given."""

    section: ClassVar[str]
    keys: ClassVar[dict[str, Any]]  # of Key; the library evaluates this line


def flags_for(section: str) -> type[Flags]:
    """Make the flags of a section.

    ``"preparation"`` stands for the keys that prepare a measured surface, ``"scan"`` for the same of a scan,
    ``"yielding"`` for those of a half-space that creeps by a law or has a hardness.
    """
    from asperity.config.mistakes import ORDER

    owner = {"preparation": "surface", "scan": "surface", "yielding": "solid"}.get(section, section)
    group = Group(owner.capitalize(), sort_key=1 + ORDER.index(owner))
    keys = {key.name: key for key in _keys(section)}
    fields = [(name, _annotation(owner, key), None) for name, key in keys.items()]
    facts = {"__module__": __name__, "section": owner, "keys": keys}
    made = dataclasses.make_dataclass(section, fields, bases=(Flags,), namespace=facts, kw_only=True)
    return Parameter(name="*", group=group)(made)


def given(*groups: Flags | None) -> dict[str, dict[str, object]]:
    """Gather the flags that were given, by section and key."""
    sections: dict[str, dict[str, object]] = {}
    for group in filter(None, groups):
        for key, written in vars(group).items():
            if written is not None:
                sections.setdefault(group.section, {})[key] = _read(written, group.keys[key].what)
    return sections


def _read(written: bool | str | list[str], what: What) -> object:
    """Turn words into numbers, where a key may be one; the check refuses the rest."""
    if isinstance(written, list):
        if what in ("pair", "pairs"):
            pairs = [
                [number(part) for part in re.split(r"[\s,]+", word.strip(), maxsplit=1)] for word in written
            ]
            return pairs if what == "pairs" else pairs[-1]
        if what == "choices":
            return [word for item in written for word in item.split()]
        return numbers(written, whole=what == "wholes")
    if isinstance(written, bool) or what in ("choice", "text", "path"):
        return written
    if what == "text or whole":
        return int(written) if written.isdecimal() else written
    return number(written)


def _keys(section: str) -> Iterator[Key]:
    """Keys of a section; of several kinds, each key with what is said of all."""
    from asperity.config.keys import Key, keys_of, sections
    from asperity.config.models import MeasuredSurface, Scan
    from asperity.config.solids import YIELDING, HalfSpace

    if section == "yielding":
        yield from (key for key in keys_of(HalfSpace).values() if key.name in YIELDING)
        return
    if section in ("preparation", "scan"):
        measured = keys_of(Scan if section == "scan" else MeasuredSurface)
        yield from (key for key in measured.values() if key.name != "path")
        return
    kinds = sections()[section]
    if "" in kinds:
        yield from kinds[""].values()
        return
    said = f"Kind of {section}."
    yield Key(name="kind", what="choice", choices=tuple(kinds), default=next(iter(kinds)), description=said)
    measured = kinds.pop("file", {})
    for name in dict.fromkeys(name for keys in kinds.values() for name in keys if name not in measured):
        owners = {kind: keys[name] for kind, keys in kinds.items() if name in keys}
        first = next(iter(owners.values()))
        text = f"{first.description} For {', '.join(owners)}."
        for kind, key in owners.items():
            if not key.required and key.default != first.default:
                text += f" By default {key.default:g} for {kind}."
        yield dataclasses.replace(first, description=text)
    if measured:
        yield measured["path"]


def _annotation(section: str, key: Key) -> object:
    """Annotation of one flag: a word, or a list of words, with its help."""
    from asperity.config.mistakes import flag_of

    text = key.description + (f" [choices: {', '.join(key.choices)}]" if key.choices else "")
    if key.what == "switch":
        help_only = Parameter(name=flag_of(section, key.name), help=text, negative=(), show_default=False)
        return Annotated[bool | None, help_only]
    if key.default not in (None, []):
        default = key.default if isinstance(key.default, list) else [key.default]
        words = [f"{one:g}" if isinstance(one, float) else str(one) for one in default]
        text += f" [default: {' '.join(words)}]"
    paired = key.what in ("pair", "pairs")  # two words in one argument, which may be given again
    parameter = Parameter(
        name=flag_of(section, key.name),
        help=text,
        metavar=_METAVARS.get(key.name) or _METAVARS[key.what.removesuffix("s")],
        negative=(),
        consume_multiple=key.several and not paired,
        show_default=False,
    )
    return Annotated[(list[str] if key.several or paired else str) | None, parameter]
