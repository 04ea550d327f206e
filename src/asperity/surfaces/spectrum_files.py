"""A power spectrum from a table in a text file, by the names of its columns."""

from __future__ import annotations

import re
from pathlib import Path

from asperity.base import checks
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.sheets.columns import Columns, Role, named

_POWER = r"^c$|^c ?\(q\)|^c ?\^?[12] ?d|power|psd|spectr|spektr|leistungsdichte"


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
        There is no such table, its columns are not understood, or a column has a unit and `unit` is None.
    """
    power = 2 + checks.integer("dimension", dimension, least=1, most=2)
    wanted = (
        Role("wave number", f"1/{unit or 'm'}", r"^q$|^k$|wave.?(number|vector)|wellenzahl"),
        Role("power", f"{unit or 'm'}^{power}", _POWER),
    )
    columns = Columns(path, wanted)
    table, roles = columns.table, columns.roles
    if not any(table.names) and len(roles) == 2:
        roles = [role.name for role in wanted]
    others = [name for name in table.names if re.search(rf"(?i)^c ?\^?{3 - dimension} ?d", name)]
    if others or any(roles.count(role.name) != 1 for role in wanted):
        advice = f"a first line such as q_1/um,C{dimension}D_um^{power}"
        raise InputError(table.name, expected="columns of q and C", got=named(table), advice=advice)
    places = {role.name: roles.index(role.name) for role in wanted}
    try:
        in_table = [written for role, at in places.items() if (written := columns.unit(role, at))]
    except InputError as error:  # its advice to state units does not apply
        raise InputError(error.name, expected=error.expected, got=error.got) from None
    if in_table and unit is None:
        expected = f"the unit of the heights, as the table has {in_table[0]}"
        raise InputError("unit", expected=expected, got="none", cure={"unit": "um"})
    q, C = (columns.values(role, at) for role, at in places.items())
    return q, C
