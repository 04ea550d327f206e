"""What the numbers of a run or a campaign are called that it is told, and how they become attributes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

from asperity.base.parameters import parameters_of
from asperity.creep import PARAMETERS_OF_LAWS
from asperity.protocols import KINDS
from asperity.results.quantities import Units, select

_RECORDED = {
    name: (one.long_name, one.dimension)
    for name, one in select("series", of=("all", "sites", "sliding")).items()
}
_PRESSURE = ("load over nominal area", "pressure")
_HEIGHT, _LENGTH, _STIFFNESS = "height unit", "length unit", "stiffness unit"
_MODULUS = {
    "modulus": ("contact modulus", "pressure"),
    "poisson": ("Poisson's ratio", "1"),
    "branch_shares": ("share of the modulus of each branch", "1"),
    "branch_times": ("relaxation time of each branch", "time"),
    "branches": ("share of the modulus and relaxation time of each branch", ""),
}
PARAMETERS: dict[str, tuple[str, str]] = {
    **dict.fromkeys(("shape", "size"), ("sites along each axis", "sites")),
    **dict.fromkeys(("rms", "rms_height"), ("rms height", _HEIGHT)),
    "hurst": ("Hurst exponent", "1"),
    "roll_off": ("wavelength above which the spectrum is flat", _LENGTH),
    "cutoff": ("shortest wavelength", _LENGTH),
    "rms_slope": ("rms slope", "height unit / length unit"),
    "rms_curvature": ("rms mean curvature", "height unit / length unit^2"),
    "delta": ("roughness at the scale of the lattice", _HEIGHT),
    "edges": ("what lies beyond the edges", ""),
    "radius": ("radius of the asperity", "length"),
    "places": ("places y and x of the balls", "length"),
    "radii": ("radii of the balls", "length"),
    "heights": ("heights of the summits of the balls", "length"),
    "path": ("surface file", ""),
    "undefined": ("what is done about undefined pixels", ""),
    "max_undefined": ("largest fraction of undefined pixels to fill", "1"),
    "undefined_value": ("height that stands for an undefined pixel", _HEIGHT),
    "tilt": ("what is removed from the heights", ""),
    "lines": ("how the offsets of lines are levelled", ""),
    "periodic": ("how the surface is made periodic", ""),
    "unit": ("unit of the heights", ""),
    "channel": ("channel of the surface file", ""),
    "crop": ("part of the surface file", "pixels, or the unit of the part"),
    "longest": ("longest wavelength kept", _LENGTH),
    "shortest": ("shortest wavelength kept", _LENGTH),
    "k0": ("stiffness between neighbors", _STIFFNESS),
    "k1": ("stiffness to the bulk", _STIFFNESS),
    "R": ("mobility of conserving creep", "R unit"),
    "R_viscous": ("mobility of viscous creep", "R unit"),
    "creep": ("local law of creep", ""),
    **{
        name: (
            f"{what.meaning} of the local law of creep",
            {"m/s": "velocity", "Pa": "stress"}.get(what.unit, what.unit or "1"),
        )
        for name, what in PARAMETERS_OF_LAWS.items()
    },
    "creep_energy": ("energy of activation", "J"),
    "creep_volume": ("volume of activation", "m^3"),
    "creep_prefactor": ("velocity of creep at infinite temperature", "velocity"),
    "temperature": ("temperature", "K"),
    "permanent": ("share of the modulus that does not creep by the local law", "1"),
    "hardness": ("pressure under which the rough surface yields", "pressure"),
    "young": ("Young's modulus", "pressure"),
    "thickness": ("thickness of the layer", "length"),
    **_MODULUS,
    **{f"base_{name}": (f"{long_name} of the base", unit) for name, (long_name, unit) in _MODULUS.items()},
    "apparatus": ("stiffness of the apparatus", "stiffness"),
    "flow": ("mobility of creep, and the power of the wave number with which it goes", ""),
    "frictionless": ("whether the layer slides on its base", ""),
    "relaxation": ("table of the relaxation", ""),
    "pressure": _PRESSURE,
    **{name: _RECORDED[name] for name in ("load", "separation")},
    **{f"held_{name}": _RECORDED[name] for name in ("load", "separation", "area")},
    "hold": ("what is held constant", ""),
    "first": ("first time to record", "time"),
    "last": ("last time to record", "time"),
    "times": ("times to record", "time"),
    "shear_strength": ("shear strength of the contacts", "pressure"),
    "rate_coefficient": ("relative growth of the shear strength for each factor e of velocity", "1"),
    "reference_velocity": ("velocity of that shear strength", "place / time"),
    "stiffness": ("whether the stiffness is recorded", ""),
    "resistivity": ("electrical resistivity", "ohm m"),
    "conductivity": ("thermal conductivity", "W/m/K"),
    "shear": ("shear force", "force"),
    "friction_coefficient": ("coefficient of friction of the sites", "1"),
    "rtol": ("relative tolerance of the time steps", "1"),
    "seed": ("seed of the surface", "1"),
    "point": ("number of the point, from 0", "1"),
    "entry": ("number of the entry of the series, from 0", "1"),
}
"""Long name and dimension, or unit, of what a run or a campaign is told."""

_IN_UNITS = {"s": "time", "N": "force", "m": "length", "Pa": "pressure", "": "1"}
IN_A_LEG = {
    name: (parameter.quantity.meaning, _IN_UNITS.get(parameter.quantity.unit, parameter.quantity.unit))
    for kind in KINDS.values()
    for name, parameter in parameters_of(kind).items()
    if {int, float} & set(parameter.kinds)
} | {"distance": ("distance", "place"), "velocity": _RECORDED["velocity"]}
"""The same of what a leg of a history is told."""

Plain = str | float | int | list[str] | list[float] | list[int]


def attribute_of(name: str) -> str:
    """The attribute that holds a parameter: ``branch_times`` for ``branches.0.time``."""
    key, *way = name.split(".")
    if key in ("branches", "base_branches") and len(way) == 2:
        return f"{key.removesuffix('es')}_{'shares' if way[1] in ('share', '0') else 'times'}"
    return key


def of_parameter(name: str) -> tuple[str, str] | None:
    """Long name and dimension of a parameter, by its name or by the way to a number within it.

    Such as ``k1``, ``branches.0.time``, ``protocol.1.load``.
    """
    key, *way = name.split(".")
    if not way:
        return PARAMETERS.get(key)
    long_name, dimension = IN_A_LEG[way[-1]] if key == "protocol" else PARAMETERS[attribute_of(name)]
    return f"{long_name}{', leg' if key == 'protocol' else ','} {name}", dimension


def plain(name: str, value: object) -> dict[str, Plain]:
    """A parameter as attributes that need no parsing, and that every format can hold.

    A table becomes an attribute for each key, ``surface_rms``; pairs become two lists, ``branch_shares`` and
    ``branch_times``, ``places_y`` and ``places_x``; what is empty or not given is left out.
    """
    if isinstance(value, Mapping):
        return {
            key: one for part, inner in value.items() for key, one in plain(f"{name}_{part}", inner).items()
        }
    if value is None or value in ("", [], ()):
        return {}
    if name == "flow" and isinstance(value, Sequence):
        return dict(zip(("flow_mobility", "flow_exponent"), value, strict=True))
    if isinstance(value, list | tuple):
        if not isinstance(value[0], list | tuple):
            return {name: list(value)}
        if all(len(pair) == 2 for pair in value):
            one = name.removesuffix("es")
            names = ("places_y", "places_x") if name == "places" else (f"{one}_shares", f"{one}_times")
            return {
                which: list(column) for which, column in zip(names, zip(*value, strict=True), strict=True)
            }
        return {name: json.dumps(value)}
    if isinstance(value, bool):
        return {name: int(value)}
    return {name: value if isinstance(value, str | float | int) else json.dumps(value)}


def units_of_parameters(names: Iterable[str], units: Units) -> str:
    """Say in which units attributes are: ``held_load N, modulus Pa``."""
    known = {name: PARAMETERS[name][1] for name in names if name in PARAMETERS}
    said = {name: units.get(dimension, dimension) for name, dimension in known.items()}
    return ", ".join(f"{name} {unit}" for name, unit in said.items() if unit not in ("", "1"))
