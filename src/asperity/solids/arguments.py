"""Arguments of solids that several take: type, bounds, unit, and what each is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from annotated_types import Gt, Le

from asperity.base.parameters import Also, Quantity
from asperity.solids.branches import check_branches

POISSON = 0.35
"""Poisson's ratio of a half-space where none is given."""

LARGEST = Le(1e30)
"""Products of stiffnesses and mobilities are taken in single precision, which ends at 3e38."""

YOUNG = Quantity("Young's modulus, unrelaxed, in place of the contact modulus; one or two.", "Pa")
RATIO = Quantity("Poisson's ratio; two for two bodies.")

Modulus = Annotated[
    float | str | None,
    *(Gt(0), LARGEST),
    Quantity("contact modulus: E*, before anything relaxes.", "Pa"),
]
Young = Annotated[float | str | None, Gt(0), LARGEST, YOUNG]
Poisson = Annotated[float, Gt(-1), Le(0.5), RATIO]
Branch = tuple[
    Annotated[float, Gt(0), Le(1), Quantity("share of the modulus")],
    Annotated[float | str, Gt(0), LARGEST, Quantity("relaxation time", "s")],
]
"""A share of the modulus, and the time in which it relaxes."""


AT_MOST_ALL = Also(lambda _, branches: check_branches(branches))
"""Shares add up to 1 at most."""

Branches = Annotated[
    Sequence[Branch],
    AT_MOST_ALL,
    Quantity("share of the modulus and relaxation time of each branch; once for each branch."),
]
Thickness = Annotated[float | str, Gt(0), Quantity("thickness of the layer or the film", "m")]
Apparatus = Annotated[
    float | str | Literal["inf"] | None,
    Gt(0),
    Quantity("stiffness of the apparatus, or inf; with it a separation can be held.", "N/m", of_line="N/m^2"),
]
Hardness = Annotated[
    float | str | None,
    Gt(0),
    Quantity("pressure under which the rough surface yields; of springs, force of a site.", "Pa"),
]
