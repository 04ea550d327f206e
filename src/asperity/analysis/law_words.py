"""A law in the words of other programs, and the formulas in which rock mechanics writes one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import xarray as xr
from scipy.optimize import curve_fit

from asperity.analysis.contact_law import TITLE
from asperity.analysis.scan import written
from asperity.base import checks, units
from asperity.errors import InputError
from asperity.lattice import Field

Program = Literal["calculix", "moose"]
FILES: dict[Program, str] = {"calculix": "calculix.inp", "moose": "moose.i"}
"""Programs, and names of their files."""

_MOST_ROWS = 200
"""Rows of a table of CalculiX 2.20."""

_MPA = 1e6


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
        Which of its ages, s or with a unit; needed where there are several.
    direction
        Whether the law is that of a rising pressure, or of one that falls from the largest.
    millimeters
        Write N, mm, s, MPa in place of SI.

    Returns
    -------
    str
        Tables begin at pressure 0, at first touch; when unloading, where the tangent ends.

    Raises
    ------
    InputError
        There are several ages and none was named, the law has no such age or direction, or it has more
        pressures than the program takes.
    """
    checks.choice("program", program, get_args(Program))
    table = _one_age(dataset, age, direction)
    length = 1e-3 if millimeters else 1.0
    factors = {"Pa": length**2, "m": 1 / length, "Pa/m": length**3, "W/m^2/K": length, "S/m^2": length**2}
    columns = {
        name: np.append(0.0, table[name].values) * factors[str(table[name].attrs["units"])]
        for name in ("pressure", "approach", *_OF_PRESSURE)
        if name in table
    }
    pressure, approach, slope = (float(table[name][0]) for name in ("pressure", "approach", "stiffness"))
    if direction == "unloading":
        columns["approach"][0] = (approach - pressure / slope) / length
    system = "N, mm, s, MPa" if millimeters else "SI"
    head = f"asperity {dataset.attrs['asperity_version']}: law of a rough contact, {direction}, "
    head += f"age {written(float(table['time']), 's')}, in {system}"
    return (_calculix if program == "calculix" else _moose)(columns, head)


_OF_PRESSURE = ("stiffness", "tangential_stiffness", "conductance", "thermal_conductance", "hydraulic_gap")


def _one_age(dataset: xr.Dataset, age: float | str | None, direction: str) -> xr.Dataset:
    """The part of a law of one age and direction."""
    checks.instance("dataset", dataset, xr.Dataset, "asperity.law(solid, scan, pressures=...)")
    if dataset.attrs.get("title") != TITLE:
        got = f"one with the title {dataset.attrs.get('title')!r}"
        raise InputError("dataset", expected="a law", got=got, advice="asperity.law")
    checks.choice("direction", direction, dataset["direction"].values.tolist())
    times = dataset["time"].values
    found = None if age is None else units.number("age", age, "s", least=0)
    near = np.flatnonzero(np.isclose(times, times[0] if found is None else found, rtol=1e-6, atol=0))
    if near.size != 1 or (found is None and times.size > 1):
        expected = f"one of the ages of the law, {', '.join(written(one, 's') for one in times.tolist())}"
        got = "none" if found is None else written(found, "s")
        raise InputError("age", expected=expected, got=got, advice=f'age="{written(float(times[-1]), "s")}"')
    return dataset.sel(direction=direction).isel(time=int(near[0]))


def _calculix(columns: dict[str, Field], head: str) -> str:
    pressure, approach = columns["pressure"], columns["approach"]
    if pressure.size > _MOST_ROWS:
        expected = f"at most {_MOST_ROWS - 1} pressures for CalculiX"
        raise InputError("pressures", expected=expected, got=pressure.size - 1, advice="fewer")
    lines = [
        f"** {head}",
        "** Pressure against overclosure. CalculiX 2.20 reads this table in *CONTACT PAIR of",
        "** TYPE=NODE TO SURFACE alone: in surface-to-surface contact it passes no pressure.",
        "*SURFACE INTERACTION, NAME=ROUGH",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        *(f"{p:.10g}, {a:.10g}" for p, a in zip(pressure, approach, strict=True)),
    ]
    if "thermal_conductance" in columns:
        lines += [
            "** Gap conductance, pressure, temperature. CalculiX 2.20 knows the pressure of a line and not",
            "** of a table: use this interaction for heat, in TYPE=SURFACE TO SURFACE, under a known load.",
            "*SURFACE INTERACTION, NAME=ROUGH_HEAT",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            f"{pressure[-1] / approach[-1]:.10g}",
            "*GAP CONDUCTANCE",
            *(
                f"{h:.10g}, {p:.10g}, 0"
                for h, p in zip(columns["thermal_conductance"], pressure, strict=True)
            ),
        ]
    return "\n".join(lines) + "\n"


def _moose(columns: dict[str, Field], head: str) -> str:
    def function(name: str, x: Field, y: Field) -> list[str]:
        rows = (" ".join(f"{one:.10g}" for one in axis) for axis in (x, y))
        given = [f"    {axis} = '{row}'" for axis, row in zip("xy", rows, strict=True)]
        return [f"  [{name}]", "    type = PiecewiseLinear", *given, "  []"]

    pressure = columns["pressure"]
    lines = [f"# {head}", "[Functions]", *function("pressure_of_approach", columns["approach"], pressure)]
    for name in _OF_PRESSURE:
        if name in columns:  # a gap is no 0 where nothing presses
            start = 1 if name == "hydraulic_gap" else 0
            lines += function(f"{name}_of_pressure", pressure[start:], columns[name][start:])
    return "\n".join([*lines, "[]"]) + "\n"


@dataclass(frozen=True)
class ClosureFit:
    """A formula for the approach a under a pressure p, and by how much it misses the table.

    Attributes
    ----------
    name, formula
        What it is.
    parameters
        Numbers and units by their symbols.
    rms, largest
        Relative error of the approach.
    """

    name: str
    formula: str
    parameters: dict[str, tuple[float, str]]
    rms: float
    largest: float

    def __str__(self) -> str:
        numbers = ", ".join(f"{name} = {written(*one)}" for name, one in self.parameters.items())
        errors = f"{100 * self.rms:.2g} % rms, {100 * self.largest:.2g} % at most"
        return f"{self.formula}, {numbers}; errs by {errors}"


_FORMULAS: dict[str, tuple[str, Callable[..., Field], tuple[str, str]]] = {
    "Barton-Bandis": ("a = p / (K + p / V)", lambda p, k, v: p / (k + p / v), ("K Pa/m", "V m")),
    "power": ("a = c (p / 1 MPa)^n", lambda p, c, n: c * (p / _MPA) ** n, ("c m", "n 1")),
}


def closure_fits(
    dataset: xr.Dataset,
    *,
    age: float | str | None = None,
    direction: Literal["loading", "unloading"] = "loading",
) -> tuple[ClosureFit, ...]:
    """Fit the formulas of joints in rock to a law, each by least squares of the relative error.

    The hyperbola of Barton and Bandis, with the initial stiffness K and the largest closure V, and a power.

    Parameters
    ----------
    dataset, age, direction
        As for `law_for`.

    References
    ----------
    S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20, 249 (1983),
    DOI 10.1016/0148-9062(83)90595-8.
    """
    table = _one_age(dataset, age, direction)
    p, a = table["pressure"].values, table["approach"].values
    begin = {"Barton-Bandis": (p[0] / a[0], 1.2 * a[-1]), "power": (a[-1] * (_MPA / p[-1]) ** 0.5, 0.5)}
    found = []
    for name, (formula, of, symbols) in _FORMULAS.items():

        def logarithm(p: Field, *logs: float, of: Callable[..., Field] = of) -> Field:
            return np.log(of(p, *np.exp(logs)))

        best, _ = curve_fit(logarithm, p, np.log(a), p0=np.log(begin[name]))
        error = of(p, *np.exp(best)) / a - 1
        named = (one.split(" ") for one in symbols)
        numbers = {s: (float(x), unit) for (s, unit), x in zip(named, np.exp(best), strict=True)}
        found.append(ClosureFit(name, formula, numbers, float(np.sqrt((error**2).mean())), abs(error).max()))
    return tuple(found)
