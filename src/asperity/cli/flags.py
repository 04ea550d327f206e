"""The flags of the commands, made of the configuration's models: one flag for each key.

A flag overrides its key; its help, default and choices are the key's. What was written becomes a number
where the key may be one, and is checked together with the configuration. The models load a library, so they
are imported only for a command that has such flags.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

from cyclopts import Group, Parameter, Token

from asperity.words import number, numbers

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


def _whole(_: object, tokens: Sequence[Token]) -> int:
    """Read a whole number; 1.5 is none, where the library would round."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {tokens[0].value}") from None


Switch = Annotated[bool, Parameter(negative=(), show_default=False)]
Quiet = Annotated[bool, Parameter(name=("--quiet", "-q"), negative=(), show_default=False)]
Out = Annotated[Path, Parameter(name=("--out", "-o"))]
Whole = Annotated[int, Parameter(converter=_whole)]
_METAVARS = {
    "path": "PATH",
    "shape": "N",
    "times": "T",
    "maps_at": "T",
    "crop": "N",
    "branches": "SHARE TIME",
    "base_branches": "SHARE TIME",
    "flow": "MOBILITY POWER",
    "relaxation": "PATH",
}


class Flags:
    """What was written for the keys of one section; None for a flag that was not given."""

    section: ClassVar[str]
    fields: ClassVar[dict[str, Any]]


def flags_for(section: str) -> type[Flags]:
    """Make the flags of a section.

    ``"preparation"`` stands for the keys that prepare a measured surface, ``"scan"`` for the same of a scan.
    """
    from asperity.config.mistakes import ORDER

    owner = "surface" if section in ("preparation", "scan") else section
    group = Group(owner.capitalize(), sort_key=1 + ORDER.index(owner))
    known = list(_keys(section))
    fields = [(key, _annotation(owner, key, field, text), None) for key, field, text in known]
    facts = {"__module__": __name__, "section": owner, "fields": {key: field for key, field, _ in known}}
    made = dataclasses.make_dataclass(section, fields, bases=(Flags,), namespace=facts, kw_only=True)
    return Parameter(name="*", group=group)(made)


def given(*groups: Flags | None) -> dict[str, dict[str, object]]:
    """Gather the flags that were given, by section and key."""
    sections: dict[str, dict[str, object]] = {}
    for group in filter(None, groups):
        for key, written in vars(group).items():
            if written is not None:
                kinds = set(_kinds(group.fields[key].annotation))
                sections.setdefault(group.section, {})[key] = _read(written, kinds)
    return sections


def _read(written: bool | str | list[str], kinds: set[object]) -> object:
    """Turn words into numbers, where a key's kinds of values allow one; the check refuses the rest."""
    if isinstance(written, bool):
        return written
    if tuple in kinds:
        pairs = [[number(part) for part in re.split(r"[\s,]+", word.strip(), maxsplit=1)] for word in written]
        return pairs if list in kinds else pairs[-1]
    if float not in kinds and int not in kinds:
        return [word for item in written for word in item.split()] if isinstance(written, list) else written
    if isinstance(written, list):
        return numbers(written, whole=float not in kinds)
    return (
        int(written) if str in kinds and written.isdecimal() else written if str in kinds else number(written)
    )


def _keys(section: str) -> Iterator[tuple[str, FieldInfo, str]]:
    """Keys of a section, and their help."""
    from asperity.config.mistakes import models_of
    from asperity.config.models import KINDS, MeasuredSurface, Scan

    if section not in KINDS:
        measured = {"preparation": MeasuredSurface, "scan": Scan}
        (model,) = [measured[section]] if section in measured else models_of(section)
        for key, field in model.model_fields.items():
            if key not in ("kind", "path"):
                yield key, field, field.description or ""
        return
    kinds = KINDS[section]
    usual = next(iter(kinds.values())).model_fields["kind"]
    yield "kind", usual, f"Kind of {section}. [choices: {', '.join(kinds)}]"
    made = {kind: model for kind, model in kinds.items() if model is not MeasuredSurface}
    for key in dict.fromkeys(key for model in made.values() for key in model.model_fields if key != "kind"):
        if section == "surface" and key in MeasuredSurface.model_fields:
            continue
        owners = [kind for kind, model in made.items() if key in model.model_fields]
        field = made[owners[0]].model_fields[key]
        fields = {kind: made[kind].model_fields[key] for kind in owners}
        others = {
            kind: one.default
            for kind, one in fields.items()
            if not one.is_required() and one.default != field.default
        }
        differs = "".join(f" By default {default:g} for {kind}." for kind, default in others.items())
        yield key, field, f"{field.description} For {', '.join(owners)}.{differs}"
    if section == "surface":
        path = MeasuredSurface.model_fields["path"]
        yield "path", path, path.description or ""


def _annotation(section: str, key: str, field: FieldInfo, text: str) -> object:
    """Annotation of one flag: a word, or a list of words, with its help."""
    from asperity.config.mistakes import flag_of

    kinds = list(_kinds(field.annotation))
    choices = [kind for kind in kinds if isinstance(kind, str)]
    if choices and key != "kind":
        text += f" [choices: {', '.join(choices)}]"
    if bool in kinds:
        help_only = Parameter(name=flag_of(section, key), help=text, negative=(), show_default=False)
        return Annotated[bool | None, help_only]
    if not field.is_required() and field.default not in (None, []):
        default = field.default if isinstance(field.default, list) else [field.default]
        words = [f"{one:g}" if isinstance(one, float) else str(one) for one in default]
        text += f" [default: {' '.join(words)}]"
    name = "CHOICE" if choices else "FLOAT" if float in kinds else "INT" if str not in kinds else "TEXT"
    paired = tuple in kinds  # two words in one argument, which may be given again
    several = list in kinds or paired
    parameter = Parameter(
        name=flag_of(section, key),
        help=text,
        metavar=_METAVARS.get(key, name),
        negative=(),
        consume_multiple=several and not paired,
        show_default=False,
    )
    return Annotated[(list[str] if several else str) | None, parameter]


def _kinds(annotation: Any) -> Iterator[object]:
    """All that a key may be: the types and the words in its annotation, and ``list`` where it may be one."""
    parts = get_args(annotation)
    if not parts:
        yield annotation
    elif annotation.__class__.__name__ == "_AnnotatedAlias":
        yield from _kinds(parts[0])
    else:
        if (origin := getattr(annotation, "__origin__", None)) in (list, tuple):
            yield origin
        for part in parts:
            yield from _kinds(part)
