"""Laws as input files of other programs, and as formulas of rock mechanics."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from asperity.base import checks, units
from asperity.base.readable import written
from asperity.contact_law.laws import TANGENTIAL, check_law
from asperity.errors import InputError
from asperity.lattice import Field

Program = Literal["calculix", "moose"]
FILES: dict[Program, str] = {"calculix": "calculix.inp", "moose": "moose.i"}
"""File name by program."""

_MOST_ROWS = 200
"""Rows of a table of CalculiX 2.20."""

_APART = 1e-12
"""Relative distance that 13 digits tell; more need more than the 20 letters of a number in CalculiX."""

_GAPS = ("hydraulic_gap_y", "hydraulic_gap_x")
_OF_PRESSURE = ("stiffness", *TANGENTIAL, "conductance", "thermal_conductance", *_GAPS)


def law_for(
    program: Program,
    dataset: xr.Dataset,
    *,
    age: float | str | None = None,
    direction: Literal["loading", "unloading"] = "loading",
    millimeters: bool = False,
) -> str:
    """Write a law as text for another program.

    Parameters
    ----------
    program
        ``"calculix"``: surface interactions for CalculiX 2.20, a table of pressure and overclosure, and one
        of gap conductance. ``"moose"``: functions of type PiecewiseLinear.
    dataset
        What `asperity.law` returned.
    age
        Age, s or with a unit; needed if the law has several.
    direction
        Rising pressure, or falling from the largest.
    millimeters
        Write N, mm, s, MPa, and conductances in mW/(mm^2 K) and mS/mm^2, in place of SI.

    Returns
    -------
    str
        Tables begin at pressure 0: loading at first touch, unloading where the tangent at the lowest pressure
        reaches 0.

    Raises
    ------
    InputError
        The age or the direction is missing or not in the law, or CalculiX cannot read that many pressures.
    """
    checks.choice("program", program, get_args(Program))
    table = _one_age(dataset, age, direction)
    unit = 1e-3 if millimeters else 1.0
    # Heat of a current is in mW where potentials are in V and currents in mA.
    factors = {"Pa": unit**2, "m": 1 / unit, "Pa/m": unit**3, "W/m^2/K": unit, "S/m^2": unit}
    columns = {
        name: np.append(0.0, table[name].values * factors[str(table[name].attrs["units"])])
        for name in ("pressure", "approach", *_OF_PRESSURE)
        if name in table.variables
    }
    if direction == "unloading":
        columns["approach"][0] = columns["approach"][1] - columns["pressure"][1] / columns["stiffness"][1]
    if any((np.diff(columns[of]) <= _APART * columns[of][1:]).any() for of in ("pressure", "approach")):
        raise InputError("pressures", expected="rising approaches", got="closer ones", advice="fewer")
    head = f"asperity {dataset.attrs['asperity_version']}: law of a rough contact, {direction}, age "
    head += f"{written(float(table['time']), 's')}, in {'N, mm, s, MPa, mW, V, mA' if millimeters else 'SI'}"
    if direction == "unloading":
        head += ", below the lowest pressure along its tangent"
    prefix = "" if direction == "loading" else f"{direction}_"  # an input may include both files
    return (_calculix if program == "calculix" else _moose)(columns, head, prefix)


def _one_age(dataset: xr.Dataset, age: float | str | None, direction: str) -> xr.Dataset:
    """The law at one age and direction."""
    check_law(dataset)
    checks.choice("direction", direction, dataset["direction"].values.tolist())
    return dataset.sel(direction=direction).isel(time=place_of(age, dataset["time"].values))


def place_of(age: float | str | None, times: ArrayLike) -> int:
    """Place of an age among those of a law, s; None means the only one. `InputError` if there is none."""
    ages = np.asarray(times)
    wanted = ages if age is None else units.number("age", age, "s", least=0)
    near = np.flatnonzero(np.isclose(ages, wanted, rtol=1e-6, atol=0))
    if near.size != 1:
        expected = f"one of the ages of the law, {', '.join(written(value, 's') for value in ages.tolist())}"
        cure = {"age": written(float(ages[-1]), "s")}
        raise InputError("age", expected=expected, got="none" if age is None else age, cure=cure)
    return int(near[0])


def _calculix(columns: dict[str, Field], head: str, prefix: str) -> str:
    name, pressure, approach = f"{prefix.upper()}ROUGH", columns["pressure"], columns["approach"]
    if pressure.size > _MOST_ROWS:
        expected = f"at most {_MOST_ROWS - 1} pressures for CalculiX"
        raise InputError("pressures", expected=expected, got=pressure.size - 1, advice="fewer")
    lines = [
        f"** {head}",
        "** Pressure, overclosure: 0 where the surfaces of the meshes touch. To use it:",
        "**   *INCLUDE, INPUT=<this file>",
        f"**   *CONTACT PAIR, INTERACTION={name}, TYPE=NODE TO SURFACE",
        "**   <dependent surface>, <independent surface>",
        "** In surface-to-surface contact CalculiX 2.20 passes no pressure by a table.",
        f"*SURFACE INTERACTION, NAME={name}",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        *(f"{p:.13g}, {a:.13g}" for p, a in zip(pressure, approach, strict=True)),
    ]
    if "thermal_conductance" in columns:
        lines += [
            "** Conductance, pressure, temperature. For it CalculiX 2.20 takes the pressure of a linear law,",
            "** not of a table: use this where the load is known, with TYPE=SURFACE TO SURFACE.",
            f"*SURFACE INTERACTION, NAME={name}_HEAT",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            f"{pressure[-1] / approach[-1]:.13g}",
            "*GAP CONDUCTANCE",
            *(
                f"{h:.13g}, {p:.13g}, 0"
                for h, p in zip(columns["thermal_conductance"], pressure, strict=True)
            ),
        ]
    return "\n".join(lines) + "\n"


def _moose(columns: dict[str, Field], head: str, prefix: str) -> str:
    pressure, lines = columns["pressure"], [f"# {head}", "[Functions]"]
    tables = {f"{prefix}pressure_of_approach": (columns["approach"], pressure)}
    tables |= {
        f"{prefix}{name}_of_pressure": (pressure, columns[name]) for name in _OF_PRESSURE if name in columns
    }
    for name, axes in tables.items():
        first = int("hydraulic" in name)  # without pressure the gap is not 0
        x, y = (" ".join(f"{value:.13g}" for value in axis[first:]) for axis in axes)
        lines += [f"  [{name}]", "    type = PiecewiseLinear", f"    x = '{x}'", f"    y = '{y}'", "  []"]
    return "\n".join([*lines, "[]"]) + "\n"


def closure_fits(
    dataset: xr.Dataset,
    *,
    age: float | str | None = None,
    direction: Literal["loading", "unloading"] = "loading",
) -> pd.DataFrame:
    """Fit the formulas of joints in rock to a law, by least squares of the logarithm of the approach.

    Parameters
    ----------
    dataset, age, direction
        As for `law_for`.

    Returns
    -------
    pandas.DataFrame
        A row for the hyperbola of Barton and Bandis, a = p / (K + p / V), with K (Pa/m) and V (m), and one
        for the power law a = c (p / 1 MPa)^n, with c (m) and n; each with its rms and largest relative error.

    References
    ----------
    S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20, 249 (1983),
    DOI 10.1016/0148-9062(83)90595-8.
    """
    table = _one_age(dataset, age, direction)
    p, a = table["pressure"].values, table["approach"].values
    power = np.polyfit(np.log(p / 1e6), np.log(a), 1)

    def lack(logs: Field) -> Field:
        k, v = np.exp(logs)
        return np.asarray(np.log(p / (k + p / v) / a))

    k, v = np.exp(least_squares(lack, np.log([p[0] / a[0], 1.2 * a[-1]])).x)
    rows = []
    for name, first, second, formula in (
        ("Barton-Bandis", k, v, p / (k + p / v)),
        ("power", np.exp(power[1]), power[0], np.exp(np.polyval(power, np.log(p / 1e6)))),
    ):
        error = formula / a - 1
        rows.append((name, first, second, np.sqrt((error**2).mean()), np.abs(error).max()))
    return pd.DataFrame(rows, columns=["formula", "first", "second", "rms", "largest"]).set_index("formula")
