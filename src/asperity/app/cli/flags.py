"""The flags of the commands, one for each key of the configuration.

A flag overrides its key; its help, default and choices are the key's. What was written becomes a number
where the key may be one, and is checked together with the configuration. The models load a library, so they
are imported only for a command that has such flags.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from cyclopts import Group, Parameter, Token

from asperity.base.words import number, numbers
from asperity.errors import InputError

if TYPE_CHECKING:
    from asperity.app.config.keys import Key


def _whole(_: object, tokens: Sequence[Token]) -> int:
    """Read a whole number; 1.5 is none, where the library would round."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {tokens[0].value}") from None


Switch = Annotated[bool, Parameter(negative=(), show_default=False)]
_QUIET = Parameter(help="Print neither progress nor summary.", negative=(), show_default=False)
Quiet = Annotated[bool, _QUIET, Parameter(name=("--quiet", "-q"))]
Open = Annotated[bool, Parameter(name="--open", negative=(), show_default=False)]
Out = Annotated[Path, Parameter(name=("--out", "-o"))]
Folder = Annotated[Out, Parameter(help="Folder of the results; it must not exist yet.")]
Whole = Annotated[int, Parameter(converter=_whole)]
Columns = Annotated[list[str] | None, Parameter(negative=(), consume_multiple=True)]
_UNITS = Parameter(name=("--unit", "--units"), negative=(), consume_multiple=True, metavar="COLUMN=UNIT")
Units = Annotated[list[str] | None, _UNITS]
_METAVARS = {
    **{"number": "FLOAT", "pair": "FIRST SECOND", "whole": "INT", "text or whole": "TEXT", "file": "PATH"},
    **{"shape": "N", "crop": "N", "times": "T", "maps_at": "T", "places": "Y X", "flow": "MOBILITY POWER"},
    **{"branches": "SHARE TIME", "base_branches": "SHARE TIME", "columns": "COLUMN", "units": "COLUMN=UNIT"},
}
"""Placeholders of values in the help, by the type of a key or by its name."""


class Flags:
    """Texts of the flags of keys of the configuration; None for absent flags."""

    keys: ClassVar[dict[str, tuple[str, Any]]]  # section and Key of each; the library evaluates this line


@functools.cache
def flags_for(*sections: str) -> type[Flags]:
    """Make the flags of sections; those of ``"preparation"`` prepare a measured surface."""
    from asperity.ask.questions import QUESTIONS

    keys = {f"{section}_{key.name}": (section, key) for one in sections for section, key in keys_for(one)}
    # Of a run, a number may be without a unit.
    quantity = "QUANTITY" if QUESTIONS.keys() & {*sections} else "FLOAT"
    of_heights = any(key.name == "unit" for _, key in keys.values())
    fields = [(name, _annotation(*key, quantity, alias=not of_heights), None) for name, key in keys.items()]
    facts = {"__module__": __name__, "keys": keys}
    flags = dataclasses.make_dataclass("flags", fields, bases=(Flags,), namespace=facts, kw_only=True)
    return Parameter(name="*")(flags)


def given(
    flags: Flags | None,
    *,
    surface: Path | None = None,
    leg: Sequence[str] | None = None,
    figures: Sequence[str] | None = None,
    units: bool = False,
) -> dict[str, dict[str, object]]:
    """Gather flags by section and key, with those of commands; with `units`, quantities need theirs."""
    from asperity.app.config.legs import legs_from_words
    from asperity.app.config.mistakes import flag_of

    sections: dict[str, dict[str, object]] = {}
    for name, (section, key) in flags.keys.items() if flags is not None else ():
        if (written := getattr(flags, name)) is not None:
            value = _read(written, key.what)
            if units:
                check_unit(flag_of(section, key.name), value, *(key.units or (key.unit,)))
            sections.setdefault(section, {})[key.name] = value
    kind = str(sections.get("surface", {}).get("kind", ""))
    if surface is None and Path(kind).suffix:  # --surface scan.opd, as of commands that take files only
        sections["surface"]["kind"], surface = "file", Path(kind)
    if surface is not None:
        sections.setdefault("surface", {})["path"] = str(surface)
    if figures is not None:
        sections["output"] = {"figures": figures}
    if leg:
        if "protocol" in sections:
            raise InputError("--history", expected="none beside --leg", got="both")
        legs = legs_from_words(leg)
        sections["protocol"] = {"legs": legs}
        for each in legs if units else ():
            _check_leg(each)
    return sections


def _check_leg(leg: Mapping[str, Any]) -> None:
    """Refuse a leg with a number that has no unit, where it is of a quantity that has one."""
    from asperity.base.parameters import parameters_of
    from asperity.protocols.legs import KINDS

    for inner in leg.get("legs", ()):
        _check_leg(inner)
    for name, parameter in parameters_of(KINDS[leg["kind"]]).items() if leg["kind"] in KINDS else ():
        check_unit(f"--leg {leg['kind']}: {name}", leg.get(name), parameter.unit)


def file_of_run(material: Path | None, flags: dict[str, dict[str, object]]) -> Path | None:
    """The file of a run, if the material is one; else flags must name a scan, and a table becomes a key."""
    if material is not None and material.suffix == ".toml":
        return material
    if "path" not in flags.get("surface", {}):
        raise InputError("--surface", expected="the file of a scan", got="none", advice="--surface scan.opd")
    solid = flags.setdefault("solid", {})
    solid |= {} if material is None else {"relaxation": str(material)}
    solid.setdefault("kind", "half_space")
    return None


@contextmanager
def naming(**names: str) -> Iterator[None]:
    """Give arguments of the library other names in errors: those of the command, or of columns of a file."""
    from asperity.app.config.mistakes import Door

    with Door({}, names={("", name): shown for name, shown in names.items()}).answering():
        yield


def check_unit(flag: str, value: object, *units: str) -> None:
    """Refuse a number alone, or in a list, or in a pair in a list, that has a unit and came without.

    Only 0 needs no unit, other than of temperature.
    """
    from asperity.base.units import usual_unit

    for one in value if isinstance(value, list) else [value]:
        parts = list(zip(one if isinstance(one, list) else [one], units, strict=False))
        if any(unit and isinstance(part, float | int) and (part or unit == "K") for part, unit in parts):
            words = (f"{part} {usual_unit(unit) if unit else ''}".strip() for part, unit in parts)
            advice, got = f'"{" ".join(words)}"', " ".join(str(part) for part, _ in parts)
            raise InputError(flag, expected="a number with its unit", got=got, advice=advice)


def unit_of(flag: str, chosen: str | None, stated: str) -> str:
    """The unit that a flag or a table states; `InputError` if they differ."""
    from asperity.base.units import spelled

    if chosen and stated and spelled(chosen) != spelled(stated):
        advice = f"no {flag}, or --units for a header that is wrong"
        raise InputError(flag, expected=f"{stated}, as the table says", got=chosen, advice=advice)
    return chosen or stated


def _paired(written: Iterable[str]) -> list[str]:
    """Pairs, each typed as one word or as two."""
    words = map(str.strip, written)
    return [word if re.search(r"[\s,]", word) else f"{word} {next(words, '')}".strip() for word in words]


def _read(written: bool | str | list[str], sort: str) -> object:
    """Turn words into numbers, where a key may be one; the check refuses the rest."""
    if isinstance(written, list):
        if sort in ("pair", "pairs"):
            split = (re.split(r"[\s,]+", word.strip(), maxsplit=1) for word in _paired(written))
            pairs = [[number(part) for part in parts] for parts in split]
            return pairs if sort == "pairs" else pairs[-1]
        if sort == "choices":
            return listed(written)
        if sort == "texts":
            return written
        return numbers(written, whole=sort == "wholes")
    if isinstance(written, bool) or sort in ("choice", "text", "path"):
        return written
    if sort == "text or whole":
        return int(written) if written.isdecimal() else written
    return number(written)


def listed(written: Iterable[str]) -> list[str]:
    """Words separated by blanks or commas."""
    return " ".join(written).replace(",", " ").split()


def keys_for(section: str) -> Iterator[tuple[str, Key]]:
    """Yield the name of a section with each of its keys; a key of several kinds lists these kinds."""
    from asperity.app.config.keys import HISTORY, Key, keys_of, kinds_of
    from asperity.ask.questions import QUESTIONS
    from asperity.ask.section import keys_of_maker
    from asperity.ask.surface import MeasuredSurface

    if section in QUESTIONS:
        asked = QUESTIONS[section]
        own = keys_of(keys_of_maker(asked))
        yield from ((asked.placed.get(name, section), key) for name, key in own.items())
        yield from _of_a_prediction() if section == "prediction" else ()
        return
    if section == "preparation":
        yield from (("surface", key) for key in keys_of(MeasuredSurface.keys).values() if key.name != "path")
        return
    kinds = {"": HISTORY} if section == "protocol" else kinds_of(section, short=True)
    if "" in kinds:
        yield from ((section, key) for key in kinds[""].values())
        return
    help_text = f"Kind of {section}."
    usual = next(iter(kinds))
    yield section, Key(name="kind", what="choice", choices=tuple(kinds), default=usual, description=help_text)
    measured = kinds.pop("file", {})
    for name in dict.fromkeys(name for keys in kinds.values() for name in keys if name not in measured):
        owners = {kind: keys[name] for kind, keys in kinds.items() if name in keys}
        first = next((key for key in owners.values() if key.several), next(iter(owners.values())))
        text = f"{first.description} For {', '.join(owners)}."
        for kind, key in owners.items():
            if not key.required and key.default != first.default:
                text += f" By default {key.default:g} for {kind}."
        yield section, dataclasses.replace(first, description=text)
    if measured:
        yield section, measured["path"]


def _of_a_prediction() -> Iterator[tuple[str, Key]]:
    """Keys of sections that a prediction takes: of a scan, a half-space, and what else there is."""
    from asperity.app.config.keys import keys_of
    from asperity.ask.laws import OF_LAWS
    from asperity.ask.questions import QUESTIONS
    from asperity.ask.run import ORDER
    from asperity.ask.section import KINDS
    from asperity.ask.solid import OF_TABLES, HalfSpace
    from asperity.ask.surface import MeasuredSurface

    of_solid = {*OF_LAWS["creep"], *OF_TABLES.values(), "table_modulus"}
    of_solid |= {"young", "poisson", "branches", "creep", "permanent", "hardness"}
    models = {name: KINDS[name].get("", HalfSpace) for name in ORDER} | {"surface": MeasuredSurface}
    left_out = {"surface": {"path", "unit"}, "solid": HalfSpace.keys.keys() - of_solid}
    for section, model in models.items():
        for name, key in keys_of(model.keys).items():
            if name not in left_out.get(section, ()) and QUESTIONS["prediction"].uses(section, name):
                named = "modulus" if name == "table_modulus" else name  # no number of a modulus is asked for
                yield section, dataclasses.replace(key, name=named)


def _annotation(section: str, key: Key, quantity: str, *, alias: bool) -> object:
    from asperity.app.config.mistakes import flag_of
    from asperity.ask.run import ORDER

    place = 1 + ORDER.index(section) if section in ORDER else 0
    name, group = flag_of(section, key.name), Group(section.capitalize(), sort_key=place)
    text = key.description + (f" [choices: {', '.join(key.choices)}]" if key.choices else "")
    if key.default not in (None, []) and key.what != "switch":
        default = key.default if isinstance(key.default, list) else [key.default]
        words = (f"{one:g}" if isinstance(one, float) else str(one) for one in default)
        text += f" [default: {' '.join(words)}]"
    one = key.what.removesuffix("s")
    paired = one == "pair"  # two words in one argument, which may be given again
    parameter = Parameter(
        name=("--unit", name) if name == "--units" and alias else name,
        group=group,
        help=text,
        metavar=_METAVARS.get(key.name) or (quantity if key.unit else _METAVARS.get(one, one.upper())),
        negative=(),
        consume_multiple=key.several,
        show_default=False,
        show_choices=False,
        # as in -40degC; a list would take the flags behind it for more of it
        allow_leading_hyphen=bool(key.unit) and not key.several and (key.unit == "K" or (key.least or 0) < 0),
    )
    if key.what == "switch":
        return Annotated[bool | None, parameter]
    annotation: Any = Literal[key.choices] if key.what == "choice" and quantity == "QUANTITY" else str
    return Annotated[(list[str] if key.several or paired else annotation) | None, parameter]
