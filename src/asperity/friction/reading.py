"""Records of experiments from files: text tables of any laboratory, and binary ones of xlook."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.base import checks
from asperity.base import units as si
from asperity.base.checks import Floats
from asperity.base.words import number
from asperity.errors import InputError
from asperity.friction.normal_stress import changes
from asperity.friction.records import Record
from asperity.friction.xlook import is_xlook, read_xlook
from asperity.sheets.columns import TIME, Chosen, Columns, Role, Units, named
from asperity.sheets.tables import Table

ROLES = (
    Role(
        "",
        "",
        r"temp(?!s\b)|humid|feucht|\bstd|\berr|angle|winkel|thick|dicke|dilat|strain|change|anderung|delta|δ"
        r"|(^nor(m|mal)?\b|axial|verti[ck]al|normal|radial).*(disp|verschieb|piston|actuator|ram\b|position|veloc)"
        r"|deplac.*(axial|vertical|normal)|(load ?point|^lp|drive|motor|[ps].?wave)\b.*(vel|speed)"
        r"|confin|rotation|rpm|drehzahl|wear|verschlei|permeab|usure|loss|verlust",
    ),
    TIME,
    Role(
        "normal stress",
        "Pa",
        r"(norm?|normale?|eff|effective)\b.*(stress|pressure|contrainte)|normalspannung|contrainte.*normal"
        r"|^(sigma|σ) ?(n|eff|norm)?$|^(eff ?)?ns$",
    ),
    Role("normal force", "N", r"normal.*(force|load)|normalkraft|force normale|^(load|last|fn|f n|fz|f z)$"),
    Role(
        "shear stress",
        "Pa",
        r"(shr|shear).*stress|^vstress|(schub|scher)spannung|contrainte.*(cisail|tang)|^tau$|^τ$",
    ),
    Role(
        "shear force",
        "N",
        r"(shear|friction|tangential|lateral).*force|(reib|reibungs|tangential|quer|scher)kraft"
        r"|force.*(frottement|tangent)|^f ?[stx]$",
    ),
    Role("load point", "m", r"load ?point|lastpunkt|^lp\b|piston|actuator|\bram\b|^(displ?|vdcdt)$"),
    Role("velocity", "m/s", r"veloc|\bvel\b|speed|slip rate|geschwindigkeit|vitesse|^v$"),
    Role(
        "displacement",
        "m",
        r"\bdisp(l|lac\w*)?\b|slip|position|distance|weg\b|verschiebung|deplacement|glissement|^[xds]$"
        r"|^on ?board|^vobdcdt",
    ),
    Role("friction", "1", r"friction|^mu\b|^μ|^cof\b|coef|reib\w*(zahl|wert|koeff)|frottement"),
)
"""Quantities of the columns of a record."""
_EXAMPLES = (
    "time_s, load_point_um and friction, or time_s, displacement_um, shear_stress_MPa and normal_stress_MPa"
)
_ARGUMENTS = ("units", "strength_at_rest")
_MOTIONS = ("load point", "velocity", "displacement")
"""Motions: a velocity counts where there is no load point, and then alone."""


def read_record(
    path: Path | str,
    *,
    columns: Chosen | None = None,
    units: Units | None = None,
    strength_at_rest: bool = False,
    start: float | str | None = None,
    stop: float | str | None = None,
    calibration: Path | str | None = None,
) -> Record:
    """Read the record of an experiment from a table, and convert it to s, m and Pa.

    The names of the columns, or a row below them, state quantity and unit, in English, German or French:
    ``time_s``; ``load_point_um``, or the slip in ``displacement (mm)`` or ``velocity [um/s]``; and
    ``friction``, ``COF`` or ``Reibungszahl [-]``, or ``shear_stress_MPa`` and ``normal_stress_MPa``, or
    ``Fx [N]`` and ``Fz [N]``, whose ratio is friction. A velocity, the mean since the line before, is
    preferred to a displacement. Without units of time and displacement the record is without units, such as
    that of a simulation. For the form of the file see `asperity.fits.read_measurements`.

    Parameters
    ----------
    path
        A text file with a line for each time; or a binary file of xlook.
    columns, units
        Names or numbers, from 0, of the columns to read, by default all that are understood; units of columns
        in place of those of the table: ``{"slip": "um"}``.
    strength_at_rest
        As in `Record`.
    start, stop
        First and last time to read, in the unit of the file, or text with a unit: ``"3845 s"``.
    calibration
        For columns in bits: a text file with a line for each column, ``factor, unit, zero, name``, where zero
        (in bits) and name are optional; ``-`` for a column to leave alone.

    Raises
    ------
    InputError
        The columns are not understood, only some have units, the normal stress is not above 0, or the load
        point goes back.
    """
    table: Table | Path | str = path
    if is_xlook(Path(path)):
        table = read_xlook(Path(path), calibration)
    elif calibration is not None:
        raise InputError("calibration", expected="none, as a table states its units", got=str(calibration))
    columns_read = Columns(table, ROLES, columns, units)
    by_role, name = columns_read.by_role, columns_read.table.name
    ratios = [kind for kind in ("stress", "force") if {f"shear {kind}", f"normal {kind}"} <= set(by_role)]
    motions = [role for role in _MOTIONS if role in by_role]
    if "time" not in by_role or not motions or not ("friction" in by_role or ratios):
        expected = "columns of time, of load point, velocity or displacement, and of friction or stresses"
        known = [at for at, role in enumerate(columns_read.roles) if role]
        if not set(known) <= set(columns_read.chosen):
            got = f"those of {', '.join(by_role) or 'none'}"
            raise InputError("columns", expected=expected, got=got, cure={"columns": known})
        advice = f"a first line that names them with their units, such as {_EXAMPLES}"
        raise InputError(name, expected=expected, got=named(columns_read.table), advice=advice)
    motions = motions[:1] if motions[0] == "velocity" else [role for role in motions if role != "velocity"]
    # Of a ratio, or of times and displacements, each has a unit or none has.
    has_units = any(columns_read.unit(role) for role in ("time", *motions))
    time = columns_read.values("time", bare=not has_units)
    kept = _window(time, start, stop, columns_read.unit("time"))
    moved = {role: _onward(role, columns_read.values(role, bare=not has_units)[kept]) for role in motions}
    how: dict[str, Any] = {"strength_at_rest": strength_at_rest, "si": has_units, "source": name}
    parts = [f"{kind} {ratios[0]}" for kind in ("shear", "normal")] if "friction" not in by_role else []
    bare = not any(map(columns_read.unit, parts))
    for part in ("normal stress", "normal force"):
        if part in parts or (part in by_role and columns_read.unit(part)):
            values, unit = columns_read.values(part, bare=bare)[kept], columns_read.unit(part)
            how["normal"] = _changing(time[kept], values, part, unit, name, binary=isinstance(table, Table))
            how |= {part.replace(" ", "_"): float(values.mean())} if unit else {}
    numbers = [columns_read.values(part, bare=bare)[kept] for part in parts or ["friction"]]
    friction = numbers[0] / numbers[1] if parts else numbers[0]
    lengths = [columns_read.unit(role).partition("/")[0] for role in motions]
    how |= {"read": columns_read.read, "units": (columns_read.unit("time"), lengths[0])}
    try:
        return _made(time[kept], moved, friction, how)
    except InputError as error:
        raise error if error.name in _ARGUMENTS else error.about(f"{name}, {error.name}") from error


def _made(time: Floats, moved: dict[str, Floats], friction: Floats, how: dict[str, Any]) -> Record:
    if "velocity" in moved:
        return Record(time, moved["velocity"], friction, **how)
    if how["strength_at_rest"]:
        if "displacement" not in moved:
            got = "the load point of a machine, which slips at rest"
            raise InputError("strength_at_rest", expected="a velocity or displacement of slip", got=got)
        return Record.of_displacement(time, moved["displacement"], friction, **how)
    how |= {"load_point": moved.get("load point"), "slip": moved.get("displacement")}
    return Record.of_machine(time, friction, **how)


def _onward(role: str, values: Floats) -> Floats:
    """Displacements or velocities above 0 in the direction of sliding."""
    falls = values.max() <= 0 if role == "velocity" else values[-1] < values[0]
    return -values if falls else values


def _window(time: Floats, start: object, stop: object, unit: str) -> NDArray[np.bool_]:
    """Mask of the rows between two times."""
    factor = (si.factor(unit, "s") if unit else None) or 1.0
    ends = []
    for name, stated, default in (("start", start, -np.inf), ("stop", stop, np.inf)):
        value = number(stated) if isinstance(stated, str) else stated
        if isinstance(value, str) and not unit:
            raise InputError(name, expected="a plain number, as the record has no units", got=repr(value))
        if isinstance(value, str):
            ends.append(si.quantity(value, "s", name))
        else:
            ends.append(default if value is None else factor * checks.number(name, value))
    kept = (time >= ends[0]) & (time <= ends[1])
    if kept.sum() < 3 and not np.isinf(ends).all():
        first, last, *window = (f"{end / factor:.6g}" for end in (time.min(), time.max(), *ends))
        expected = f"a window of rows between {first} and {last} {unit}".strip()
        got = f"{' to '.join(window)} {unit}".strip()
        raise InputError("start", expected=expected, got=f"{got}, with {int(kept.sum())} rows")
    return np.asarray(kept)


def _changing(
    time: Floats, normal: Floats, quantity: str, unit: str, name: str, *, binary: bool
) -> Floats | None:
    """A normal stress or force over its mean, if it changes by more than its noise; it must be above 0."""
    if normal.min() <= 0:
        scale = 1.0 if not unit else si.factor(unit, "Pa" if "stress" in quantity else "N") or 1.0
        got = f"{normal.min() / scale:.4g} to {normal.max() / scale:.4g} {unit}".strip()
        zero = "a calibration with the zero of each column, in bits" if binary else "a column less its zero"
        advice = zero if normal.max() > 0 else "its negative, as what presses is above 0"
        raise InputError(name, expected=f"a {quantity} above 0", got=got, advice=advice)
    return normal / normal.mean() if changes(time, normal) else None
