"""Measured relaxation, creep or dynamic moduli from a table in a text file, by the names of its columns."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from asperity.base import units
from asperity.base.checks import Floats, shown
from asperity.base.columns import Roles, finite, named, position
from asperity.base.tables import Table, read_table
from asperity.errors import InputError, Remark
from asperity.relaxation.data import Creep, Dynamic, Measured, Relaxation

Kind = Literal["relaxation", "creep", "dynamic"]

_KINDS: dict[Kind, type[Measured]] = {"relaxation": Relaxation, "creep": Creep, "dynamic": Dynamic}
_UNITS: dict[str, tuple[str, ...]] = {
    "time": ("s",),
    "modulus": ("Pa",),
    "compliance": ("1/Pa",),
    "frequency": ("Hz", "rad/s"),
    "storage": ("Pa",),
    "loss": ("Pa",),
}
# Of a name without its unit, in small letters; the first that matches.
_PATTERNS = (
    ("", r"^(log|lg|ln)\b|tan|delta|δ|factor|temp|\*|complex|err|std|strain|force"),
    ("frequency", r"freq|omega|ω|^[fw]$|^nu$|angular"),
    ("time", r"\btime\b|^t$"),
    ("loss", r"loss|''|″|\"|double.?prime|imag|viscous"),
    ("storage", r"storage|'|′|prime|real|elastic"),
    ("compliance", r"complian|creep|^[jd]\b"),
    ("modulus", r"modul|relax|young|^[eg]\b"),
)
_ROLES = Roles(_PATTERNS, _UNITS)
_EXAMPLES = "time_s and E_MPa, time_s and J_1/GPa, or omega_rad_s, storage_MPa and loss_MPa"


def read(
    path: Path | str,
    *,
    kind: Kind | None = None,
    columns: Sequence[int | str] | None = None,
    noise: float = 0.05,
) -> Measured:
    """Read measured data from a table in a text file, and convert them to s and Pa.

    The names of the columns say what they hold and in which unit: ``time_s``, ``t/s``, ``E(t) [MPa]``,
    ``modulus (GPa)``, ``J [1/GPa]``, ``frequency_Hz``, ``omega_rad_s``, ``G' (kPa)``. A column without a unit
    is taken to be in s, Pa, 1/Pa, or rad/s (Hz where its name says frequency), with a remark. For the form of
    the file see `asperity.fits.read_measurements`.

    Parameters
    ----------
    path
        A text file with a line for each time or frequency.
    kind
        ``"relaxation"``, ``"creep"`` or ``"dynamic"``; None where the columns' names say it.
    columns
        Names or numbers, from 0, of the columns: time and modulus, time and compliance, or frequency,
        storage and loss modulus. By default those that are named so, or the first, where none has a name.
    noise
        Largest relative change in the wrong direction that is taken for noise.

    Returns
    -------
    Relaxation, Creep or Dynamic

    Raises
    ------
    InputError
        There is no such table, its columns are not understood, a cell is no number, or the numbers are no
        relaxation: see the classes.
    """
    if kind is not None and kind not in _KINDS:
        raise InputError("kind", expected=" or ".join(map(repr, _KINDS)), got=shown(kind))
    table = read_table(Path(path))
    found = [_ROLES.of(name) for name in table.names]
    chosen, positions = _chosen(table, [role for role, _ in found], kind, columns)
    of_class: Callable[..., Measured] = _KINDS[chosen]
    roles = _KINDS[chosen].names()
    given = [_in_si(table, at, role, found[at][1]) for at, role in zip(positions, roles, strict=True)]
    try:
        return of_class(*given, noise=noise)
    except InputError as error:
        if error.name == "noise":
            raise
        raise error.about(f"{table.name}, {error.name}") from error


def _chosen(
    table: Table, roles: list[str], kind: Kind | None, columns: Sequence[int | str] | None
) -> tuple[Kind, list[int]]:
    """The kind of the data, and the positions of its columns."""
    wanted = {one: of_class.names() for one, of_class in _KINDS.items()}
    if columns is not None:
        if isinstance(columns, str):
            raise InputError("columns", expected="a list of names or numbers", got=shown(columns))
        positions = [position(table, column) for column in columns]
        asked = tuple(roles[at] for at in positions)
        chosen = kind or next((one for one, names in wanted.items() if asked == names), None)
        if chosen is None:
            raise _unclear(table, 'kind="relaxation", "creep" or "dynamic"')
        if len(set(positions)) != (count := len(wanted[chosen])) or len(positions) != count:
            expected = f"{count} different ones: {', '.join(wanted[chosen])}"
            raise InputError("columns", expected=expected, got=shown(list(columns)))
        return chosen, positions
    if kind is not None and not any(table.names):
        if len(table.names) < (count := len(wanted[kind])):
            expected = f"{count} columns: {', '.join(wanted[kind])}"
            raise InputError(table.name, expected=expected, got=f"{len(table.names)} columns")
        return kind, list(range(count))
    # Two moduli against frequency, without more words: storage and loss.
    plain = [at for at, role in enumerate(roles) if role == "modulus"]
    if "frequency" in roles and len(plain) == 2 and not {"storage", "loss"} & set(roles):
        roles = list(roles)
        roles[plain[0]], roles[plain[1]] = "storage", "loss"
    fitting = [
        one
        for one, names in wanted.items()
        if kind in (None, one) and all(roles.count(role) == 1 for role in names)
    ]
    if len(fitting) != 1:
        if not any(table.names):
            first = {2: "time_s,E_MPa", 3: "omega_rad_s,storage_MPa,loss_MPa"}
            example = first.get(len(table.names), _EXAMPLES)
            raise _unclear(table, f"a first line that names them with their units, such as {example}")
        what = "kind=..., " if len(fitting) > 1 else ""
        raise _unclear(table, f"{what}columns=[...] to choose, or names such as {_EXAMPLES}")
    return fitting[0], [roles.index(role) for role in wanted[fitting[0]]]


def _unclear(table: Table, advice: str) -> InputError:
    return InputError(
        table.name,
        expected="columns of time and modulus, time and compliance, or frequency, storage and loss modulus",
        got=named(table),
        advice=advice,
    )


def _in_si(table: Table, position: int, role: str, unit: str | None) -> Floats:
    """Convert a column; frequencies to rad/s."""
    name = table.names[position]
    values = finite(table, position, role)
    target = _UNITS[role][0]
    if unit is None or (unit and not _ROLES.fits(role, unit)):
        example = {"time": "h", "frequency": "Hz", "compliance": "1/GPa"}.get(role, "MPa")
        kind = f"a unit of {'modulus' if target == 'Pa' else role}, such as {example}"
        raise InputError(f"column {name!r} of {table.name}", expected=kind, got=repr(name))
    if role == "frequency":
        angular = re.search("omega|ω|angular|^w", name.lower()) is not None
        target = ("rad/s" if angular else "Hz") if not unit else "rad/s" if "rad" in unit else "Hz"
        if unit in ("1/s", "s^-1"):
            target = "rad/s"
    if not unit:
        text = f"{table.name}: no unit beside {name!r}, taken as {target}" if name else ""
        text = text or f"{table.name}: column {position} has no name, taken as {role} in {target}"
        warnings.warn(Remark(text), stacklevel=3)
    scale = units.factor(unit or target, target)
    assert scale is not None  # checked above
    return values * scale * (2 * math.pi if target == "Hz" else 1)
