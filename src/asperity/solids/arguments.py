"""Arguments of solids that several take: type, bounds, unit, and what each is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len

from asperity.base.parameters import Also, Quantity
from asperity.solids.branches import check_branches

POISSON = 0.35
"""Poisson's ratio of a half-space where none is given."""

_LARGEST = Le(1e30)
"""Products of stiffnesses and mobilities are taken in single precision, which ends at 3e38."""

_YOUNG = Quantity(
    "Young's modulus", "Pa", more=", unrelaxed, in place of the contact modulus; two for two bodies."
)
_POISSON = Quantity("Poisson's ratio", more="; two for two bodies.")
_SHARE = Quantity("share of the modulus")
_TIME = Quantity("relaxation time", "s")

Modulus = Annotated[
    float | str | None,
    *(Gt(0), _LARGEST),
    Quantity("contact modulus", "Pa", more=" E*, before anything relaxes."),
]
Young = Annotated[float | str | None, Gt(0), _LARGEST, _YOUNG]
YoungOfBodies = Annotated[float | str | Sequence[float | str] | None, Gt(0), _LARGEST, Len(1, 2), _YOUNG]
Poisson = Annotated[float, Gt(-1), Le(0.5), _POISSON]
PoissonOfBodies = Annotated[float | Sequence[float] | None, Gt(-1), Le(0.5), Len(1, 2), _POISSON]
Branch = tuple[Annotated[float, Gt(0), Le(1), _SHARE], Annotated[float | str, Gt(0), _LARGEST, _TIME]]
"""A share of the modulus, and the time in which it relaxes."""


def _at_most_all(name: str, branches: Sequence[tuple[float, float]]) -> object:
    del name
    check_branches(branches)
    return branches


Branches = Annotated[
    Sequence[Branch],
    Also(_at_most_all),
    Quantity("share of the modulus and relaxation time of each branch", more="; once for each branch."),
]
Thickness = Annotated[float | str, Gt(0), Quantity("thickness of the layer or the film", "m")]
Apparatus = Annotated[
    float | str | Literal["inf"] | None,
    Gt(0),
    Quantity(
        "stiffness of the apparatus",
        "N/m",
        more=", or inf; with it a separation can be held.",
    ),
]
Hardness = Annotated[
    float | str | None,
    Gt(0),
    Quantity(
        "pressure under which the rough surface yields",
        "Pa",
        more="; on the lattice of springs, force of a site.",
    ),
]
Permanent = Annotated[
    float,
    *(Ge(0), Le(0.99)),
    Quantity("share of the modulus that does not creep by the local law", more=". By default 0.", usual=None),
]
Flow = Annotated[
    tuple[
        Annotated[float, Gt(0), Quantity("mobility")],
        Annotated[float, Ge(-2), Le(4), Quantity("power of the wave number")],
    ]
    | None,
    Quantity(
        "mobility of creep, and its power of the wave number",
        more=" (-1 bulk flow, 0 dissolution, 1 and 2 diffusion in the volume and along the surface), in "
        "place of branches.",
    ),
]
Bonded = Annotated[
    bool,
    Quantity(
        "whether the layer slides on its base",
        key="frictionless",
        more=" without friction; else it is bonded to it.",
    ),
]
BaseModulus = Annotated[
    float | str, Gt(0), _LARGEST, Quantity("contact modulus of the base", "Pa", more=", unrelaxed.")
]
BasePoisson = Annotated[float, Gt(-1), Le(0.5), Quantity("Poisson's ratio of the base")]
BaseBranches = Annotated[
    Sequence[Branch],
    Also(_at_most_all),
    Quantity("share of the modulus and relaxation time of each branch of the base"),
]
K0 = Annotated[
    float,
    *(Ge(0), _LARGEST),
    Quantity("stiffness of the springs between neighbors", dimension="stiffness unit", usual=1.0),
]
K1 = Annotated[
    float,
    *(Ge(0), _LARGEST),
    Quantity("stiffness of the springs to the bulk", dimension="stiffness unit", usual=3.0),
]
Mobility = Annotated[
    float, *(Ge(0), _LARGEST), Quantity("mobility of creep that conserves the mean", dimension="R unit")
]
ViscousMobility = Annotated[
    float, *(Ge(0), _LARGEST), Quantity("mobility of viscous creep", dimension="R unit")
]
