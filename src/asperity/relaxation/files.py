"""Measured relaxation, creep or dynamic moduli from a table in a text file, by the names of its columns."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np

from asperity.base import checks
from asperity.base import units as si
from asperity.errors import InputError
from asperity.relaxation.data import Creep, Dynamic, Measured, Modulus, Relaxation
from asperity.sheets.columns import TIME, Chosen, Columns, Role, Units, check_one_series, named, normal

Kind = Literal["relaxation", "creep", "dynamic"]

_KINDS: dict[Kind, type[Measured]] = {"relaxation": Relaxation, "creep": Creep, "dynamic": Dynamic}
_ROLES = (
    Role(
        "",
        "",
        r"\btan\b|delta|δ|fa[ck]t|temp(?!s\b)|(?<!t)\*|[ck]omplex|err|std|(?<!plane )strain|dehnung|deform"
        r"|bulk|kompress|longitud|(relax|retard)\w* time|(relax|retard)\w*zeit|temps de r",
    ),
    Role("frequency", "rad/s", r"freq|omega|ω|^[fw]$|^nu$|angular|pulsation"),
    TIME,
    Role("loss", "Pa", r"loss|verlust|perte|''|double.?prime|imag|visc|visk|visq"),
    Role("storage", "Pa", r"storage|speicher|conservation|stockage|\b[eg] ?'|prime|real"),
    Role("compliance", "1/Pa", r"complian|creep|nachgieb|kriech|fluage|complaisance|^[jd]\b"),
    Role("force", "N", r"force|kraft"),
    Role("modulus", "Pa", r"modul|relax|young|elasti|^[eg]\b|^[eg] ?rel"),
)
_MODULI: dict[Modulus, str] = {
    "shear": r"shear|schub|scher|cisail",
    "contact": r"plane.strain|contact|kontakt|reduced|reduit",
    "young": r"young|elastizit|d'elast|tensile|tension|zug|traction|flexur|bending|biege",
}
"""Words that say which modulus it is."""
_LETTERS: dict[str, Modulus] = {"e": "young", "g": "shear"}


def read(
    path: Path | str,
    *,
    kind: Kind | None = None,
    columns: Chosen | None = None,
    units: Units | None = None,
    modulus: Modulus | None = None,
    noise: float = 0.05,
    ball_radius: float | str | None = None,
    ball_depth: float | str | None = None,
) -> Measured:
    """Read measured data from a table in a text file, and convert them to s and Pa.

    The names of the columns, or a row below them, state quantity and unit, in English, German or French:
    ``time_s``, ``E(t) [MPa]``, ``Zeit / min``, ``J [1/GPa]``, ``frequency_Hz``, ``omega_rad_s``,
    ``G' (kPa)``, ``log10(t/s)``. A frequency in 1/s counts cycles, unless its name (omega) says that it is
    angular. For the form of the file see `asperity.fits.read_measurements`.

    Parameters
    ----------
    path
        A text file with a line for each time or frequency.
    kind
        ``"relaxation"``, ``"creep"`` or ``"dynamic"``; by default from the names of the columns.
    columns
        Names or numbers, from 0, of the columns: time and modulus, time and compliance, or frequency,
        storage and loss modulus. By default those with such names, or the first ones if none has a name.
    units
        Units of columns by name or number, in place of those of the table: ``{"E": "MPa"}`` or ``"E=MPa"``.
    modulus
        The modulus, if no name states it: "young", Young's modulus E; "shear", the shear modulus G;
        "contact", E*. The data keep it without conversion.
    noise
        Largest relative change in the wrong direction that counts as noise.
    ball_radius, ball_depth
        Of a ball and its held depth, m, if the table has its force F(t) in place of a modulus: E* = 3
        F/(4 sqrt(R d^3)) (Hertz; E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960),
        doi:10.1115/1.3644020). Without them it is a relaxation up to a factor, `measured` as "force".

    Raises
    ------
    InputError
        There is no such table, its columns are not understood, one has no unit, a name states another
        modulus, a cell is no number, or the numbers are no relaxation: see the classes.
    """
    for name, value, choice in (("kind", kind, Kind), ("modulus", modulus, Modulus)):
        checks.choice(name, value, (None, *get_args(choice)))
    reading = Columns(path, _ROLES, columns, units)
    chosen, places = _chosen(reading, kind, ordered=columns is not None)
    is_force = chosen == "relaxation" and reading.roles[places[1]] == "force"
    meant = "force" if is_force else _modulus(reading, places[1:], modulus)
    per_force = _per_force(ball_radius, ball_depth, is_force, reading.table.name)
    which = "Young's " if meant == "young" else f"{meant} " if meant else ""
    names = {"storage": "storage modulus", "loss": "loss modulus"}
    check_one_series(reading.table, places[0])
    numbers: list[Any] = []
    for at, role in zip(places, _KINDS[chosen].names(), strict=True):
        called = role if at == places[0] else which + names.get(role, role)
        of = "force" if is_force and role == "modulus" else role
        numbers.append(reading.values(of, at, bare=False, called="force" if of == "force" else called))
    if per_force is not None:
        numbers[1], meant = per_force * numbers[1], "contact"
    source, rows = reading.read, np.diff(numbers[0], prepend=np.nan) != 0
    if not rows.all():
        starts = np.flatnonzero(rows)
        counts = np.diff(starts, append=rows.size)
        numbers = [np.add.reduceat(values, starts) / counts for values in numbers]
        source += f"; means of rows of equal {_KINDS[chosen].names()[0]}: {starts.size}"
    make = cast(Callable[..., Measured], _KINDS[chosen])
    try:
        return make(*numbers, noise=noise, measured=meant, source=source)
    except InputError as error:
        if error.name == "noise":
            raise
        raise error.about(f"{reading.table.name}, {error.name}") from error


def _chosen(columns: Columns, kind: Kind | None, *, ordered: bool) -> tuple[Kind, list[int]]:
    """The kind of the data, and the positions of its columns."""
    table, roles = columns.table, list(columns.roles)
    wanted = {name: of_class.names() for name, of_class in _KINDS.items() if kind in (None, name)}
    # Moduli against frequency, without more words: storage and loss.
    plain = [at for at, role in enumerate(roles) if role == "modulus"]
    if "frequency" in roles and "storage" not in roles and len(plain) == 2 - roles.count("loss"):
        for at, role in zip(plain, ("storage", "loss"), strict=False):
            roles[at] = role
    if ordered or (kind is not None and not any(table.names)):
        asked = tuple(roles[at] for at in columns.chosen)
        chosen = kind or next((name for name, order in wanted.items() if asked == order), None)
        if chosen is None:
            raise _unclear(columns, 'kind="relaxation", "creep" or "dynamic"')
        count = len(wanted[chosen])
        places = columns.chosen if ordered else columns.chosen[:count]
        if len(set(places)) != count or len(places) != count:
            expected = f"{count} different ones: {', '.join(wanted[chosen])}"
            raise InputError("columns", expected=expected, got=" ".join(map(str, places)))
        return chosen, places
    wanted |= {"relaxation": ("time", "force")} if "relaxation" in wanted and "modulus" not in roles else {}
    fitting = [name for name, order in wanted.items() if all(roles.count(role) == 1 for role in order)]
    if len(fitting) != 1:
        header = "omega_rad_s,storage_MPa,loss_MPa" if len(roles) == 3 else "time_s,E_MPa"
        choice = f'kind="relaxation" and columns="0 1", or {header} as their names'
        raise _unclear(columns, choice if any(table.names) else f"a first line such as {header}")
    return fitting[0], [roles.index(role) for role in wanted[fitting[0]]]


def _per_force(
    radius: float | str | None, depth: float | str | None, is_force: bool, table: str
) -> float | None:
    """Contact modulus over the force of a ball at a held depth; None if neither is given."""
    given = {"ball_radius": radius, "ball_depth": depth}
    lengths = [si.number(name, value, "m", above=0) for name, value in given.items() if value is not None]
    if lengths and not is_force:
        expected = "none, for only a force at a held depth needs it"
        raise InputError(
            next(name for name in given if given[name] is not None), expected=expected, got=table
        )
    if len(lengths) == 1:
        lacking = next(name for name in given if given[name] is None)
        raise InputError(
            lacking, expected="radius of the ball and its depth", got="none", cure={lacking: "1 um"}
        )
    return 0.75 / math.sqrt(lengths[0] * lengths[1] ** 3) if lengths else None


def _modulus(columns: Columns, places: list[int], asked: Modulus | None) -> Modulus | None:
    """The modulus in the names of columns; the argument overrides a letter, but no word."""
    names = [columns.table.names[at] for at in places]
    moduli = {which for which, words in _MODULI.items() for name in names if re.search(words, normal(name))}
    if asked:
        moduli.add(asked)
    elif not moduli:
        letters = (re.match(r"[eg]\b|[eg](?= ?rel)", normal(name)) for name in names)
        moduli = {_LETTERS[letter[0]] for letter in letters if letter}
    if len(moduli) > 1:
        expected = "the modulus that the names of columns say"
        got = f"{asked!r} of" if asked else f"{' and '.join(sorted(moduli))} in"
        raise InputError("modulus", expected=expected, got=f"{got} {', '.join(map(repr, names))}")
    return next(iter(moduli), None)


def _unclear(columns: Columns, advice: str) -> InputError:
    return InputError(
        columns.table.name,
        expected="columns of time and modulus, time and compliance, or frequency, storage and loss modulus",
        got=named(columns.table),
        advice=advice,
    )
