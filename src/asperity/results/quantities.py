"""What the variables of a history are called, and their units: of sites, of the user's own, or SI."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

from asperity.contact.state import Contact
from asperity.creep import PARAMETERS_OF_LAWS

SERIES: dict[str, tuple[str, str]] = {
    "area": ("real contact area", "sites"),
    "contact_fraction": ("real contact area over nominal area", "1"),
    "load": ("normal load, the sum of the contact forces", "force"),
    "separation": ("separation, the mean of u0", "length"),
    "approach": ("rigid approach of the bodies since the start", "length"),
    "energy": ("elastic energy", "energy"),
    "residual": ("largest force off contact over the residual scale", "1"),
    "residual_scale": (
        "mean contact force, or where the load has died out the smallest that the heights resolve",
        "force",
    ),
    "steps": ("time steps since the previous entry", "1"),
    "rejected": ("time steps repeated with a smaller length since the previous entry", "1"),
    "iterations": ("iterations of the contact solver since the previous entry", "1"),
}
"""Long name and dimension of the time series of every history."""

OF_CONTINUA: dict[str, tuple[str, str]] = {
    "separation": ("separation, the position of the body; without an apparatus, the mean of u", "length"),
    "contact_area": ("real contact area", "area"),
    "contact_area_corrected": ("real contact area less what counting sites adds at the rim", "area"),
    "mean_gap": ("mean gap", "length"),
    "mean_contact_pressure": ("load over real contact area", "pressure"),
    "largest_pressure": ("largest contact pressure", "pressure"),
}
"""The same of those that continua, whose sites have an area, have besides or call otherwise."""

OF_YIELDING: dict[str, tuple[str, str]] = {
    "yielding_area": ("number of sites in contact whose pressure is the hardness", "sites")
}
"""The same of those that solids with a hardness have besides."""

OF_SLIDING: dict[str, tuple[str, str]] = {
    "displacement": ("length that the rough surface has slid since the start", "place"),
    "velocity": ("sliding velocity", "place / time"),
}
"""The same of those that histories with sliding have besides."""

OF_FRICTION: dict[str, tuple[str, str]] = {
    "friction_force": ("friction force, shear strength times real contact area", "force"),
    "friction": ("friction coefficient, friction force over load", "1"),
}
"""The same of those that histories with a shear strength have besides."""

FIELDS: dict[str, tuple[str, str]] = {
    "u": ("height of the elastic surface", "length"),
    "u0": ("creeping shape of the elastic surface", "length"),
    "in_contact": ("whether the site is in contact", "1"),
}
FIELDS_OF_YIELDING: dict[str, tuple[str, str]] = {
    "permanent_indentation": ("by how much the rough surface is lower where it has yielded", "length")
}
FIELDS_OF_CONTINUA: dict[str, tuple[str, str]] = {"pressure": ("contact pressure", "pressure")}
OF_A_CONTACT: dict[str, tuple[str, str]] = {
    "anchors": ("creeping shape of the elastic surface, by branch", "length"),
    "force": ("contact force of a site", "force"),
    "gap": ("gap between the surfaces", "length"),
}
"""The same of the maps that a contact has besides, which histories do not keep."""

OF_MAPS: dict[str, tuple[str, str]] = {
    "patches": ("number of contact patches", "1"),
    "mean_patch_size": ("mean size of a patch", "sites"),
    "median_patch_size": ("median size of a patch", "sites"),
    "largest_patch_size": ("size of the largest patch", "sites"),
    "perimeter": ("length of the rim of all patches; on a line, their ends", "rim"),
    "mean_patch_aspect": ("aspect ratio of the patch of a site in contact, mean over the sites", "1"),
    "clustering": ("index of dispersion of contacts in boxes", "1"),
    "births": ("patches born since the map before", "1"),
    "deaths": ("patches that died since the map before", "1"),
    "merges": ("merges of patches since the map before", "1"),
    "splits": ("splits of patches since the map before", "1"),
    "gained_by_expansion": ("sites gained since the map before by patches with one predecessor", "sites"),
    "gained_by_coalescence": (
        "sites gained since the map before by patches with several predecessors",
        "sites",
    ),
    "gained_by_births": ("sites of patches born since the map before", "sites"),
    "lost_by_shrinkage": ("sites lost since the map before by patches with successors", "sites"),
    "lost_by_deaths": ("sites of patches that died since the map before", "sites"),
    "mean_contact_age": (
        "mean time for which the sites in contact have touched without interruption",
        "time",
    ),
    "contact_age": ("time for which sites in contact have touched without interruption", "time"),
    "contact_pressure": ("contact pressure of the sites in contact", "pressure"),
}
"""The same of what is known at the times of the fields; the last two at shares of the sites in contact."""

LEG = "leg of the history, from 0"
COORDINATES: dict[str, tuple[str, str]] = {
    "time": ("hold time", "time"),
    "field_time": ("hold time at which fields were kept", "time"),
    "leg": (LEG, "1"),
    "field_leg": ("leg of the history in which fields were kept, from 0", "1"),
    "field_shift_x": ("sites along the last axis by which heights had moved when fields were kept", "sites"),
    "field_shift_y": ("sites along the first axis by which heights had moved when fields were kept", "sites"),
    "branch": ("branch of the solid, from 0", "1"),
    "quantile": ("share of the sites in contact that have at most the value", "1"),
    "x": ("site index along the last axis", "place"),
    "y": ("site index along the first axis", "place"),
    "heights": ("height of the rigid rough surface", "length"),
}

_HEIGHT, _LENGTH, _STIFFNESS = "height unit", "length unit", "stiffness unit"
PARAMETERS: dict[str, tuple[str, str]] = {
    "shape": ("sites along each axis", "sites"),
    "size": ("sites along each axis", "sites"),
    "rms": ("rms height", "height unit"),
    "hurst": ("Hurst exponent", "1"),
    "roll_off": ("wavelength above which the spectrum is flat", _LENGTH),
    "cutoff": ("shortest wavelength", _LENGTH),
    "rms_height": ("rms height", _HEIGHT),
    "rms_slope": ("rms slope", "height unit / length unit"),
    "rms_curvature": ("rms mean curvature", "height unit / length unit^2"),
    "delta": ("roughness at the scale of the lattice", _HEIGHT),
    "path": ("surface file", ""),
    "undefined": ("what is done about undefined pixels", ""),
    "max_undefined": ("largest fraction of undefined pixels to fill", "1"),
    "tilt": ("what is removed from the heights", ""),
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
    "modulus": ("contact modulus", "pressure"),
    "young": ("Young's modulus", "pressure"),
    "poisson": ("Poisson's ratio", "1"),
    "thickness": ("thickness of the layer", "length"),
    "branch_shares": ("share of the modulus of each branch", "1"),
    "branch_times": ("relaxation time of each branch", "time"),
    "branches": ("share of the modulus and relaxation time of each branch", ""),
    "base_modulus": ("contact modulus of the base", "pressure"),
    "base_poisson": ("Poisson's ratio of the base", "1"),
    "base_branches": ("share of the modulus and relaxation time of each branch of the base", ""),
    "base_branch_shares": ("share of the modulus of each branch of the base", "1"),
    "base_branch_times": ("relaxation time of each branch of the base", "time"),
    "apparatus": ("stiffness of the apparatus", "stiffness"),
    "flow": ("mobility of creep, and the power of the wave number with which it goes", ""),
    "frictionless": ("whether the layer slides on its base", ""),
    "relaxation": ("table of the relaxation", ""),
    "load": SERIES["load"],
    "pressure": ("load over nominal area", "pressure"),
    "separation": SERIES["separation"],
    "hold": ("what is held constant", ""),
    "held_load": SERIES["load"],
    "held_separation": SERIES["separation"],
    "held_area": SERIES["area"],
    "first": ("first time to record", "time"),
    "last": ("last time to record", "time"),
    "times": ("times to record", "time"),
    "shear_strength": ("shear strength of the contacts", "pressure"),
    "rate_coefficient": ("relative growth of the shear strength for each factor e of velocity", "1"),
    "reference_velocity": ("velocity of that shear strength", "place / time"),
    "rtol": ("relative tolerance of the time steps", "1"),
    "seed": ("seed of the surface", "1"),
    "point": ("number of the point, from 0", "1"),
    "entry": ("number of the entry of the series, from 0", "1"),
}
"""Long name and dimension, or unit, of what a run or a campaign is told."""

IN_A_LEG = {
    "load": SERIES["load"],
    "separation": SERIES["separation"],
    "approach": SERIES["approach"],
    "pressure": ("load over nominal area", "pressure"),
    "duration": ("duration", "time"),
    "distance": ("distance", "place"),
    "velocity": OF_SLIDING["velocity"],
    "substeps": ("shifts from site to site", "1"),
    "every": ("shifts from record to record", "1"),
    "count": ("number of repetitions", "1"),
    "mobility": ("factor on the mobility of creep", "1"),
}
"""The same of what a leg of a history is told."""

Plain = str | float | int | list[str] | list[float] | list[int]

Units = Mapping[str, str]
"""Unit of each dimension."""

_SITES = {
    "length": "height unit",
    "force": "stiffness unit * height unit",
    "energy": "stiffness unit * height unit^2",
    "pressure": "stiffness unit * height unit / site",
    "stress": "stiffness unit * height unit",
    "velocity": "stiffness unit * height unit * R unit",
    "time": "1 / (stiffness unit * R unit)",
    "place": "lattice spacing",
    "place / time": "lattice spacing * stiffness unit * R unit",
}
_OWN = {
    "length": "length unit",
    "area": "length unit^2",
    "force": "force unit",
    "energy": "force unit * length unit",
    "pressure": "force unit / length unit^2",
    "stress": "force unit / length unit^2",
    "velocity": "length unit / time unit",
    "stiffness": "force unit / length unit",
    "time": "time unit",
    "place": "length unit",
    "place / time": "length unit / time unit",
}
_SI = {
    "length": "m",
    "area": "m^2",
    "force": "N",
    "energy": "J",
    "pressure": "Pa",
    "stress": "Pa",
    "velocity": "m/s",
    "stiffness": "N/m",
    "time": "s",
    "place": "m",
    "place / time": "m/s",
}
_SI_OF_A_LINE = {"area": "m", "force": "N/m", "energy": "J/m", "stiffness": "N/m^2"}
"""Of a profile, which stands for a surface of ridges: for each metre of their length."""


def units_of(contact: Contact) -> Units:
    """Units of a contact's numbers, by dimension; those of a solid defined on sites are the user's own."""
    units = (_SI if contact.si else _OWN) if contact.solid.in_lengths else _SITES
    if contact.lattice.dimension == 1:
        return units | {"rim": "1"} | (_SI_OF_A_LINE if units is _SI else {})
    return units | {"rim": units["place"]}


def series_of(contact: Contact, *, slides: bool = False) -> dict[str, tuple[str, str]]:
    """Time series that a history of this contact has: long names and dimensions."""
    series = SERIES | OF_CONTINUA if contact.solid.in_lengths else SERIES
    if contact.solid.yields:
        series = series | OF_YIELDING
    return series | OF_SLIDING if slides else series


def fields_of(contact: Contact) -> dict[str, tuple[str, str]]:
    """Fields that it keeps: long names and dimensions."""
    fields = FIELDS | FIELDS_OF_CONTINUA if contact.solid.in_lengths else FIELDS
    return fields | FIELDS_OF_YIELDING if contact.solid.yields else fields


def units_named(named: Mapping[str, str]) -> Units:
    """Units of dimensions, from those of series."""
    known = {
        name: dimension
        for name, (_, dimension) in (
            SERIES | OF_CONTINUA | OF_YIELDING | OF_SLIDING | OF_FRICTION | OF_MAPS | COORDINATES
        ).items()
    }
    found = {known[name]: unit for name, unit in named.items() if name in known}
    systems = (_SITES, _OWN, _SI, _SI | _SI_OF_A_LINE)
    alike = (one for one in systems if all(one.get(d) == found.get(d) for d in ("time", "force")))
    return next(alike, {}) | found


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
    ``branch_times``; what is empty or not given is left out.
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
            return {f"{one}_shares": [share for share, _ in value], f"{one}_times": [t for _, t in value]}
        return {name: json.dumps(value)}
    if isinstance(value, bool):
        return {name: int(value)}
    return {name: value if isinstance(value, str | float | int) else json.dumps(value)}


def units_of_parameters(names: Iterable[str], units: Units) -> str:
    """Say in which units attributes are: ``held_load N, modulus Pa``."""
    known = {name: PARAMETERS[name][1] for name in names if name in PARAMETERS}
    said = {name: units.get(dimension, dimension) for name, dimension in known.items()}
    return ", ".join(f"{name} {unit}" for name, unit in said.items() if unit not in ("", "1"))
