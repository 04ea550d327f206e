"""What the numbers of a run or a campaign are called that it is told, and how they become attributes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

from asperity.ask.questions import QUESTIONS
from asperity.ask.run import ORDER
from asperity.ask.section import KINDS as SECTIONS
from asperity.ask.section import keys_of_maker
from asperity.base.parameters import parameters_of
from asperity.creep import Eyring
from asperity.protocols.legs import KINDS
from asperity.results.quantities import Units, select
from asperity.solids import PARAMETERS_OF_LAWS

_RECORDED = {
    name: quantity.facts for name, quantity in select("series", of=("all", "sites", "sliding")).items()
}
_BRANCHES = {
    "branch_shares": ("share of the modulus of each branch", "1"),
    "branch_times": ("relaxation time of each branch", "time"),
}
_LAWS = {"creep": ("local law of creep", ""), "adhesion": ("law of adhesion", "")}
_OF_A_LAW = {"m/s": "velocity", "Pa": "stress", "m": "length", "J/m^2": "energy / area"}
PARAMETERS: dict[str, tuple[str, str]] = {
    **{
        name: own.recorded for question in QUESTIONS.values() for name, own in keys_of_maker(question).items()
    },
    **{
        name: parameter.recorded
        for home in ORDER
        for section in SECTIONS[home].values()
        for name, parameter in section.keys.items()
    },
    "edges": ("what lies beyond the edges", ""),
    **_LAWS,
    **{
        name: (f"{of_law.meaning} of the {_LAWS[name.partition('_')[0]][0]}", _OF_A_LAW.get(of_law.unit, "1"))
        for name, of_law in PARAMETERS_OF_LAWS.items()
    },
    **{
        name if name == "temperature" else f"creep_{name}": parameter.recorded
        for name, parameter in parameters_of(Eyring.activated).items()
    },
    **_BRANCHES,
    **{f"base_{name}": (f"{long_name} of the base", unit) for name, (long_name, unit) in _BRANCHES.items()},
    **{name: _RECORDED[name] for name in ("load", "separation")},
    **{f"held_{name}": _RECORDED[name] for name in ("load", "separation", "area")},
    "point": ("number of the point, from 0", "1"),
    "entry": ("number of the entry of the series, from 0", "1"),
}
"""Long name and dimension, or unit, of the parameters of a run or a campaign."""

IN_A_LEG = {
    name: parameter.recorded
    for kind in KINDS.values()
    for name, parameter in parameters_of(kind).items()
    if {int, float} & set(parameter.kinds)
} | {"distance": ("distance", "place"), "velocity": _RECORDED["velocity"]}
"""Long name and dimension of the numbers of a leg."""

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
            key: item for part, inner in value.items() for key, item in plain(f"{name}_{part}", inner).items()
        }
    if value is None or value in ("", [], ()):
        return {}
    if name == "flow" and isinstance(value, Sequence):
        return dict(zip(("flow_mobility", "flow_exponent"), value, strict=True))
    if isinstance(value, list | tuple):
        if not isinstance(value[0], list | tuple):
            return {name: list(value)}
        if all(len(pair) == 2 for pair in value):
            of_branches = tuple(f"{name.removesuffix('es')}_{part}" for part in ("shares", "times"))
            names = ("places_y", "places_x") if name == "places" else of_branches
            columns = zip(names, zip(*value, strict=True), strict=True)
            return {key: list(column) for key, column in columns}
        return {name: json.dumps(value)}
    if isinstance(value, bool):
        return {name: int(value)}
    return {name: value if isinstance(value, str | float | int) else json.dumps(value)}


def units_of_parameters(names: Iterable[str], units: Units) -> str:
    """Say in which units attributes are: ``held_load N, modulus Pa``."""
    dimensions = {name: PARAMETERS[name][1] for name in names if name in PARAMETERS}
    shown_units = {name: units.get(dimension, dimension) for name, dimension in dimensions.items()}
    return ", ".join(f"{name} {unit}" for name, unit in shown_units.items() if unit not in ("", "1"))
