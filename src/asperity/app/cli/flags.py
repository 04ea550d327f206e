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

from asperity.base.words import has_decimal_comma, has_unit, number, numbers
from asperity.errors import InputError

if TYPE_CHECKING:
    from asperity.app.config.keys import Key, What


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
OF_TABLES = {"columns": "--columns", "units": "--unit"}
"""Flags on how to read a table, by the names of arguments."""
_METAVARS = {
    "number": "FLOAT",
    "pair": "FIRST SECOND",
    "whole": "INT",
    "choice": "CHOICE",
    "path": "PATH",
    "text": "TEXT",
    "text or whole": "TEXT",
    "shape": "N",
    "times": "T",
    "maps_at": "T",
    "crop": "N",
    "places": "Y X",
    "branches": "SHARE TIME",
    "base_branches": "SHARE TIME",
    "flow": "MOBILITY POWER",
    "columns": "COLUMN",
    "units": "COLUMN=UNIT",
}
"""Placeholders of values in the help, by the type of a key or by its name."""


class Flags:
    """Texts of the flags of keys of the configuration; None for absent flags."""

    keys: ClassVar[dict[str, tuple[str, Any]]]  # section and Key of each; the library evaluates this line


@functools.cache
def flags_for(*sections: str) -> type[Flags]:
    """Make the flags of sections; those of ``"preparation"`` prepare a measured surface."""
    keys = {f"{section}_{key.name}": (section, key) for one in sections for section, key in keys_for(one)}
    quantity = "QUANTITY" if "prediction" in sections else "FLOAT"  # which may be without a unit in a run
    fields = [(name, _annotation(*key, quantity), None) for name, key in keys.items()]
    facts = {"__module__": __name__, "keys": keys}
    flags = dataclasses.make_dataclass("flags", fields, bases=(Flags,), namespace=facts, kw_only=True)
    return Parameter(name="*")(flags)


def given(
    flags: Flags | None, *, surface: Path | None = None, leg: Sequence[str] | None = None, units: bool = False
) -> dict[str, dict[str, object]]:
    """Gather flags by section and key, with --surface and --leg; with `units`, quantities need theirs."""
    from asperity.app.config.legs import legs_from_words
    from asperity.app.config.mistakes import flag_of

    sections: dict[str, dict[str, object]] = {}
    for name, (section, key) in flags.keys.items() if flags is not None else ():
        if (written := getattr(flags, name)) is not None:
            flag = flag_of(section, key.name)
            if units and key.unit:
                check_unit(flag, written, key.unit, help_text=key.description)
            if key.what in ("pair", "pairs"):
                written = _paired(written)
            for pair in written if units and any(key.units) else ():
                _check_pair(flag, pair, key)
            sections.setdefault(section, {})[key.name] = _read(written, key.what)
    kind = str(sections.get("surface", {}).get("kind", ""))
    if surface is None and Path(kind).suffix:  # --surface scan.opd, as of commands that take files only
        sections["surface"]["kind"], surface = "file", Path(kind)
    if surface is not None:
        sections.setdefault("surface", {})["path"] = str(surface)
    if leg:
        legs = legs_from_words(leg)
        sections["protocol"] = {"legs": legs}
        for each in legs if units else ():
            _check_leg(each)
    return sections


def _check_leg(leg: Mapping[str, Any]) -> None:
    """Refuse a leg with a number that has no unit, where it is of a quantity that has one."""
    from asperity.base.parameters import parameters_of
    from asperity.protocols import KINDS, in_words

    for inner in leg.get("legs", ()):
        _check_leg(inner)
    parameters = parameters_of(KINDS[leg["kind"]]) if leg["kind"] in KINDS else {}
    bare = [name for name in leg if name in parameters and isinstance(leg[name] or "", int | float)]
    plain = {name: unit for name in bare if (unit := parameters[name].quantity.unit)}
    for name in plain:
        typed = in_words([{**leg, **{key: f"{leg[key]:g}{unit}" for key, unit in plain.items()}}])
        place, expected = f"--leg {leg['kind']}: {name}", "a number with its unit"
        raise InputError(place, expected=expected, got=leg[name], advice=f'--leg "{typed}"')


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


def flag(name: str) -> str:
    """The flag of an argument of this name."""
    return f"--{name.replace('_', '-')}"


@contextmanager
def in_flags(flags: Mapping[str, str]) -> Iterator[None]:
    """Replace names of arguments by their flags in errors and their advice."""

    def named(match: re.Match[str]) -> str:
        return f"{flags[match[1]]} " if match[1] else match[0]

    try:
        yield
    except InputError as error:
        # What stands in parentheses is Python.
        advice = re.sub(rf"\(.*\)|\b({'|'.join(map(re.escape, flags))})=(?=\S)", named, error.advice)
        name = flags.get(error.name, error.name)
        raise InputError(name, expected=error.expected, got=error.got, advice=advice) from error


def check_unit(flag: str, written: str | list[str], unit: str, *, help_text: str = "") -> None:
    """Refuse numbers alone, or among others; the advice has the unit of the help's example, if it has one.

    Only 0 needs no unit, other than of temperature.
    """
    usual = re.search(r"such as \W?[\d.]+ *([a-zA-Z][\w^/ ]*)", help_text)
    words = [written] if isinstance(written, str) else []
    for word in written if isinstance(written, list) else []:
        words += [word] if has_unit(word) or has_decimal_comma(word) else re.split(r"[\s,]+", word)
    for one in words:
        if isinstance(plain := number(one), float | int) and (plain != 0 or unit == "K"):
            advice = f'{flag} "{one} {usual[1] if usual else unit}"'
            raise InputError(flag, expected="a number with its unit", got=one, advice=advice)


def _paired(written: Iterable[str]) -> list[str]:
    """Pairs, each typed as one word or as two."""
    words = map(str.strip, written)
    return [word if re.search(r"[\s,]", word) else f"{word} {next(words, '')}".strip() for word in words]


def _check_pair(flag: str, pair: str, key: Key) -> None:
    words = re.split(r"[\s,]+", pair.strip())
    if all(isinstance(number(word), float | int) for word in words):
        names = _METAVARS.get(key.name, _METAVARS["pair"]).lower().split()
        expected = " and ".join(f"a {name}" for name in names)
        examples = [*words, *("0.3", "10")[len(words) :]]
        advice = " ".join(f"{word}{unit}" for word, unit in zip(examples, key.units, strict=False))
        raise InputError(flag, expected=f"{expected} with its unit", got=pair, advice=f'{flag} "{advice}"')


def _read(written: bool | str | list[str], sort: What) -> object:
    """Turn words into numbers, where a key may be one; the check refuses the rest."""
    if isinstance(written, list):
        if sort in ("pair", "pairs"):
            split = (re.split(r"[\s,]+", word.strip(), maxsplit=1) for word in written)
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
    from asperity.app.config.keys import Key, keys_of, sections
    from asperity.app.config.surfaces import MeasuredSurface

    if section == "prediction":
        yield from _of_a_prediction()
        return
    if section == "preparation":
        yield from (("surface", key) for key in keys_of(MeasuredSurface).values() if key.name != "path")
        return
    kinds = sections(short=True)[section]
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
    """Keys of a prediction: of a scan, a half-space, and what else there is."""
    from asperity.app.config.creep import FORMULAS, OF_LAWS
    from asperity.app.config.keys import keys_of
    from asperity.app.config.mistakes import flag_of
    from asperity.app.config.models import Aging, Carried, Contact, Friction, Output
    from asperity.app.config.solids import OF_TABLES, HalfSpace
    from asperity.app.config.surfaces import MeasuredSurface
    from asperity.solids.arguments import POISSON

    words = {
        "--young": "Unrelaxed Young's modulus, such as 3GPa, in place of a table; two for two bodies.",
        "--poisson": "Poisson's ratio, which does not relax; without a table, two numbers for two bodies. "
        f"[default: {POISSON}]",
        "--creep": f"Local law of creep: {FORMULAS['creep']}; s is the pressure.",
        "--hardness": "Pressure under which the rough surface yields, such as 0.5GPa.",
        "--pressure": "Load over nominal area, such as 1MPa.",
        "--load": "Normal load, such as 10N, in place of the pressure.",
        "--shear-strength": "Shear strength of the contacts, such as 50MPa: gives friction.",
        "--pixel": "Pixel of an instrument through which the contact is seen, such as 0.2um.",
        "--blur": "Full width at half maximum of its point spread function, such as 0.3um.",
        "--threshold": "Fraction of contact above which such a pixel counts as contact. [default: 0.5]",
    }
    of_solid = {*OF_LAWS["creep"], *OF_TABLES.values()}
    of_solid |= {"young", "poisson", "branches", "creep", "permanent", "hardness"}
    for section, model, names in (
        ("surface", MeasuredSurface, set(MeasuredSurface.model_fields) - {"path", "unit"}),
        ("solid", HalfSpace, of_solid),
        ("contact", Contact, {"load", "pressure"}),
        ("aging", Aging, {"first", "last", "per_decade"}),
        ("friction", Friction, {"shear_strength"}),
        ("carried", Carried, set(Carried.model_fields)),
        ("output", Output, {"figures", "measured", "pixel", "blur", "threshold"}),
    ):
        for name, key in keys_of(model).items():
            if name in names:
                named = "modulus" if name == "table_modulus" else name  # no number of a modulus is asked for
                help_text = words.get(flag_of(section, name), key.description)
                yield section, dataclasses.replace(key, name=named, description=help_text)


def _annotation(section: str, key: Key, quantity: str) -> object:
    from asperity.app.config.mistakes import ORDER, flag_of

    name, group = flag_of(section, key.name), Group(section.capitalize(), sort_key=1 + ORDER.index(section))
    text = key.description + (f" [choices: {', '.join(key.choices)}]" if key.choices else "")
    if key.what == "switch":
        switch = Parameter(name=name, group=group, help=text, negative=(), show_default=False)
        return Annotated[bool | None, switch]
    if key.default not in (None, []):
        default = key.default if isinstance(key.default, list) else [key.default]
        words = [
            f"{annotation:g}" if isinstance(annotation, float) else str(annotation) for annotation in default
        ]
        text += f" [default: {' '.join(words)}]"
    paired = key.what in ("pair", "pairs")  # two words in one argument, which may be given again
    parameter = Parameter(
        name=("--unit", name) if key.name == "units" and quantity == "QUANTITY" else name,
        group=group,
        help=text,
        metavar=_METAVARS.get(key.name) or (quantity if key.unit else _METAVARS[key.what.removesuffix("s")]),
        negative=(),
        consume_multiple=key.several,
        show_default=False,
        show_choices=False,
        # as in -40degC; a list would take the flags behind it for more of it
        allow_leading_hyphen=bool(key.unit) and not key.several and (key.unit == "K" or (key.least or 0) < 0),
    )
    annotation: Any = Literal[key.choices] if key.what == "choice" and quantity == "QUANTITY" else str
    return Annotated[(list[str] if key.several or paired else annotation) | None, parameter]
