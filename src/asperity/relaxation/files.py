"""Measured relaxation, creep or dynamic moduli from a table in a text file, by the names of its columns."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from asperity.base import checks
from asperity.base import units as si
from asperity.errors import InputError, Value
from asperity.relaxation.data import Creep, Dynamic, Measured, Modulus, Relaxation
from asperity.sheets.columns import TIME, Chosen, Columns, Role, Units, check_one_series, named, normal

Kind = Literal["relaxation", "creep", "dynamic"]

_KINDS: dict[Kind, type[Measured]] = {"relaxation": Relaxation, "creep": Creep, "dynamic": Dynamic}
_ROLES = (
    Role(
        "",
        "",
        r"\btan\b|tangent|delta|δ|fa[ck]t|temp(?!s\b)|(?<!t)\*|[ck]omplex|\||betrag|magnitud|angle|winkel"
        r"|absolut\w* ?mod|err|std|bulk|kompress|compressib|volum|longitud|constrain|o?edomet|odomet|e ?oed"
        r"|p.?wave|steifemodul|viscosit|viskosit"
        r"|(relax|retard)\w* time|(relax|retard)\w*zeit|temps de r",
    ),
    Role("frequency", "rad/s", r"freq|omega|ω|^[fw]$|^nu$|angular|pulsation"),
    TIME,
    Role("loss", "Pa", r"loss|verlust|perte|''|double.?prime|imag|visc|visk|visq"),
    Role("storage", "Pa", r"\bstor(age)?\b|speicher|conservation|stockage|\b[eg] ?'|prime|real"),
    Role("creep modulus", "Pa", r"(creep|kriech) ?modul|modul\w* (de |d'|en )?fluage"),
    Role("relative modulus", "1", r"(normali[sz]|relativ|normier)\w* .*modul|\b([eg]) ?/ ?\2 ?\(?[0i]"),
    Role(
        "compliance",
        "1/Pa",
        r"complian|nachgieb|complaisance|^[jd]\b|^(?!.*(strain|dehnung|deform)).*(creep|kriech|fluage)",
    ),
    Role(
        "modulus",
        "Pa",
        r"modul|young|^[eg]\b|^[eg] ?rel|plane strain"
        r"|^(?!.*(stress|spannung|contrainte|force|kraft)).*(relax|elasti)",
    ),
    Role("strain", "1", r"strain|dehnung|deform"),
    Role("stress", "Pa", r"stress|spannung|contrainte"),
    Role("force", "N", r"force|kraft|\bload"),
    Role("displacement", "m", r"displac|depth|indent|extension|verschieb|tiefe|\bweg\b|deplac|profond"),
)
_UP_TO_A_FACTOR: dict[str, Kind] = {
    "strain": "creep",
    "stress": "relaxation",
    "force": "relaxation",
    "relative modulus": "relaxation",
}
"""Columns against time that are a compliance or a modulus up to a factor, if they stand alone."""
_IN_PLACE: dict[str, Kind] = {**_UP_TO_A_FACTOR, "creep modulus": "creep"}
"""Those, and the inverse of a compliance."""
_MODULI: dict[Modulus, str] = {
    "shear": r"shear|schub|scher|cisail|gleit|torsion|coulomb|rigidit",
    "contact": r"plane.strain|contact|kontakt|reduced|reduit",
    "young": r"young|elastizit|d'elast|tensile|tension|zug|traction|flexur|bending|biege",
}
"""Words that say which modulus it is."""
_LETTERS: dict[str, Modulus] = {"e": "young", "g": "shear"}
_CONDITIONS = (
    (r"\bT\b|ϑ|(?i:temp(?!s\b))", 1.0, 0.0),
    (
        r"(?i)strain|dehnung|deform|verform|γ|gamma|ampl|auslenk|humid|feucht|\brh\b|moist|pressure|druck|stress"
        r"|spannung|load|stati[ck]|vorlast|material|polymer|compound|mischung|stoff",
        0.0,
        0.1,
    ),
)
"""Columns of conditions; by how much rows of one time or frequency may differ, absolutely and relatively."""


def read(
    path: Path | str,
    *,
    kind: Kind | None = None,
    columns: Chosen | None = None,
    units: Units | None = None,
    modulus: Modulus | None = None,
    stress: float | str | None = None,
    ball_radius: float | str | None = None,
    ball_depth: float | str | None = None,
    noise: float = 0.05,
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
    stress
        The constant stress of a table of strain against time, Pa or with a unit. Without it, such a table
        gives the compliance up to a factor only; likewise that of a force or a stress at a constant
        deformation the modulus. It is not `absolute` then.
    ball_radius, ball_depth
        Of a ball and its held depth, m, for a table of its force F(t): E* = 3 F/(4 sqrt(R d^3)) (Hertz; E. H.
        Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), doi:10.1115/1.3644020).
    noise
        Largest relative change in the wrong direction that counts as noise.

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
    meant = _modulus(reading, places[1:], modulus)
    which = "Young's " if meant == "young" else f"{meant} " if meant else ""
    names = {"storage": "storage modulus", "loss": "loss modulus"}
    check_one_series(reading.table, places[0])
    numbers: list[Any] = []
    stands = reading.roles[places[1]] if _IN_PLACE.get(reading.roles[places[1]]) == chosen else ""
    factored = stands if stands in _UP_TO_A_FACTOR else ""
    for at, role in zip(places, _KINDS[chosen].names(), strict=True):
        called = role if at == places[0] else stands or which + names.get(role, role)
        read_as = stands if stands and at != places[0] else role
        numbers.append(reading.values(read_as, at, bare=False, called=called))
    if stands == "creep modulus":
        with np.errstate(divide="ignore"):  # a compliance that is not finite is refused
            numbers[1] = 1 / numbers[1]
    if stress is not None:
        if factored != "strain":
            raise InputError("stress", expected="none beside a table that has no strain", got=stress)
        numbers[1] = numbers[1] / si.quantity(stress, "Pa", "stress")
    per_force = _per_force(ball_radius, ball_depth, factored)
    if per_force is not None:
        numbers[1], meant = per_force * numbers[1], "contact"
    source, rows = reading.read, np.diff(numbers[0], prepend=np.nan) != 0
    if not rows.all():
        _check_conditions(reading, places, rows)
        starts = np.flatnonzero(rows)
        counts = np.diff(starts, append=rows.size)
        numbers = [np.add.reduceat(values, starts) / counts for values in numbers]
        source += f"; means of rows of equal {_KINDS[chosen].names()[0]}: {starts.size}"
    make = cast(Callable[..., Measured], _KINDS[chosen])
    try:
        absolute = not factored or stress is not None or per_force is not None
        return make(*numbers, noise=noise, measured=meant, source=source, absolute=absolute)
    except InputError as error:
        if error.name == "noise":
            raise
        raise error.about(f"{reading.table.name}, {error.name}") from error


def _check_conditions(columns: Columns, places: list[int], new: NDArray[np.bool_]) -> None:
    """Refuse rows of one time or frequency at several temperatures or amplitudes: they have no mean."""
    table, starts = columns.table, np.flatnonzero(new)
    for at, name in enumerate(table.names):
        for words, absolute, relative in _CONDITIONS:
            if at in places or not re.search(words, columns.label(at)):
                continue
            values, cells = table.values[:, at], [table.cell(row, at) for row in range(len(table.lines))]
            if not np.isfinite(values).any():  # words
                values = np.unique(cells, return_inverse=True)[1].astype(np.float64)
            spread = np.maximum.reduceat(values, starts) - np.minimum.reduceat(values, starts)
            if spread.max() > max(absolute, relative * np.abs(values).max()):
                got = f"{cells[values.argmin()]} to {cells[values.argmax()]}"
                advice = "a file of the rows at one of them"
                raise InputError(table.name, expected=f"rows at one {name!r}", got=got, advice=advice)


def _chosen(columns: Columns, kind: Kind | None, *, ordered: bool) -> tuple[Kind, list[int]]:
    """The kind of the data, and the positions of its columns."""
    table, roles = columns.table, list(columns.roles)
    wanted = {name: of_class.names() for name, of_class in _KINDS.items() if kind in (None, name)}
    # Moduli against frequency, without more words: storage and loss.
    plain = [at for at, role in enumerate(roles) if role == "modulus"]
    unclear = "dynam|elasti" if len(plain) > 1 else "dynam"  # which may be the absolute value
    if any(re.search(unclear, normal(columns.label(at))) for at in plain):
        plain = []
    if "frequency" in roles and "storage" not in roles and len(plain) == 2 - roles.count("loss"):
        for at, role in zip(plain, ("storage", "loss"), strict=False):
            roles[at] = role
    if ordered or (kind is not None and not any(table.names)):
        asked = [roles[at] for at in columns.chosen]
        named_so = [name for name, order in wanted.items() if sorted(order) == sorted(asked)]
        chosen = kind or next(iter(named_so), None)
        if chosen is None:
            raise _unclear(columns, cure={"kind": "dynamic" if len(columns.chosen) == 3 else "relaxation"})
        count = len(wanted[chosen])
        places = columns.chosen if ordered else columns.chosen[:count]
        if named_so:  # their names say which is which
            places = [columns.chosen[asked.index(role)] for role in wanted[chosen]]
        if len(set(places)) != count or len(places) != count:
            expected = f"{count} different ones: {', '.join(wanted[chosen])}"
            raise InputError("columns", expected=expected, got=" ".join(map(str, places)))
        return chosen, places
    fitting = [name for name, order in wanted.items() if all(roles.count(role) == 1 for role in order)]
    if kind is None and "frequency" in roles:  # which a sweep changes, also in time
        fitting = [name for name in fitting if name == "dynamic"]
    loaded = [role for role in roles if role in (*_IN_PLACE, "displacement")]
    if not fitting and "frequency" not in roles and len(loaded) == 1 and loaded[0] in _IN_PLACE:
        of_kind = _KINDS[_IN_PLACE[loaded[0]]]
        roles[roles.index(loaded[0])] = of_kind.names()[1]
        fitting = [name for name, order in wanted.items() if all(roles.count(role) == 1 for role in order)]
    if len(fitting) > 1:
        raise _unclear(columns, cure={"kind": fitting[0]})
    if not fitting:
        is_dynamic = "frequency" in roles or len(roles) == 3
        header = "omega_rad_s,storage_MPa,loss_MPa" if is_dynamic else "time_s,E_MPa"
        if not any(table.names):
            raise _unclear(columns, f"a first line such as {header}")
        # What has another meaning is no modulus by choosing it.
        cure = {"kind": "relaxation", "columns": "0 1"} if columns.unknown in ([1], [0, 1]) else {}
        raise _unclear(columns, f"{header} as their names", {} if is_dynamic else cure)
    return fitting[0], [roles.index(role) for role in wanted[fitting[0]]]


def _per_force(radius: float | str | None, depth: float | str | None, column: str) -> float | None:
    """Contact modulus over the force of a ball at a held depth; None if neither is given."""
    given = {"ball_radius": radius, "ball_depth": depth}
    lengths = {name: si.quantity(one, "m", name) for name, one in given.items() if one is not None}
    for name in lengths if column != "force" else ():
        raise InputError(name, expected="none beside a table that has no force", got=given[name])
    for name in given.keys() - lengths.keys() if lengths else ():
        raise InputError(name, expected="radius and held depth of the ball", got="none", cure={name: "1 um"})
    return 0.75 / math.sqrt(lengths["ball_radius"] * lengths["ball_depth"] ** 3) if lengths else None


def _modulus(columns: Columns, places: list[int], asked: Modulus | None) -> Modulus | None:
    """The modulus in the names of columns; the argument overrides a letter, but no word."""
    names = [columns.table.names[at] for at in places]
    moduli = {which for which, words in _MODULI.items() for name in names if re.search(words, normal(name))}
    if asked:
        moduli.add(asked)
    elif not moduli:
        labels = " / ".join(normal(columns.label(at)) for at in places)
        moduli = {_LETTERS[letter] for letter in re.findall(r"\b[eg](?:\b|(?=rel))", labels)}
    if len(moduli) > 1:
        expected = "the modulus that the names of columns say"
        got = f"{asked!r} of" if asked else f"{' and '.join(sorted(moduli))} in"
        raise InputError("modulus", expected=expected, got=f"{got} {', '.join(map(repr, names))}")
    return next(iter(moduli), None)


def _unclear(columns: Columns, advice: str = "", cure: Mapping[str, Value] | None = None) -> InputError:
    expected = "columns of time and modulus, compliance, strain or force; or frequency and both moduli"
    got = named(columns.table)
    return InputError(columns.table.name, expected=expected, got=got, advice=advice, cure=cure)
