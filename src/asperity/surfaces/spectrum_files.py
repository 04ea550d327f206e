"""A power spectrum from a table in a text file, by the names of its columns."""

from __future__ import annotations

from pathlib import Path

from asperity.base import checks, units
from asperity.base.columns import Columns, Role, finite, named
from asperity.errors import InputError
from asperity.lattice import Field

_ROLES = (
    Role("wave number", "", r"^q$|^k$|wave.?(number|vector)|wellenzahl"),
    Role("power", "", r"^c$|^c ?\(q\)|^c ?\^?[12] ?d|power|psd|spectr|spektr|leistungsdichte"),
)


def read_spectrum(path: Path | str, *, unit: str | None = None, dimension: int = 2) -> tuple[Field, Field]:
    """Read a power spectrum for `from_spectrum` from a table in a text file.

    The names of the columns say what they hold and in which unit: ``q (1/um)``, ``wave_number_1/m``,
    ``C [m^4]``, ``PSD (nm^2 um^2)``. Without names, the first of two columns is q. For the convention of C
    see `from_spectrum`.

    Parameters
    ----------
    path
        A text file with a line for each wave number.
    unit
        Unit of length to which columns with units are converted: q to 1/unit, C to unit^4 (of a profile
        unit^3). Columns without a unit are taken as they are.
    dimension
        Axes of the surface: 2, or 1 for a profile.

    Returns
    -------
    tuple of two ndarrays of float64, of shape (n,)
        q and C.

    Raises
    ------
    InputError
        There is no such table, its columns are not understood, or one has a unit and none is given here.
    """
    found = Columns(path, _ROLES)
    table, roles = found.table, found.roles
    if not any(table.names) and len(roles) == 2:
        roles = ["wave number", "power"]
    if any(roles.count(role) != 1 for role in ("wave number", "power")):
        advice = "a first line such as q_1/um,C_um^4"
        raise InputError(table.name, expected="columns of q and C", got=named(table), advice=advice)
    power = 2 + checks.integer("dimension", dimension, least=1, most=2)
    columns = []
    for role, kind in (("wave number", "1/{}"), ("power", f"{{}}^{power}")):
        at = roles.index(role)
        values, in_table = finite(table, at, role), found.unit(role, at)
        if in_table:
            target, spelled = kind.format(unit or "m"), units.spelled(in_table)
            factor = None if spelled is None else units.factor(spelled, target)
            if factor is None:
                name = f"column {table.names[at]!r} of {table.name}"
                raise InputError(name, expected=f"a unit like {target}", got=repr(in_table))
            if unit is None:
                expected = f"the unit of the heights, as the table has {in_table}"
                raise InputError("unit", expected=expected, got="none", advice="unit = 'um' (--unit um)")
            values = values * factor
        columns.append(values)
    return columns[0], columns[1]
