"""The memory that a run needs, as measured."""

from __future__ import annotations

import math
from collections.abc import Sequence

from asperity.lattice import Lattice
from asperity.solids import Solid

_SPRINGS, _OTHERS, _BRANCH, _MAP, _MAPPED_BRANCH = 225, 360, 115, 56, 16
"""Bytes a site that a run needs by cycles and by transforms, that each branch of the latter adds after the
first, that each map adds, and each branch in it after the first.

Measured on 1024 x 1024 sites, on 512 x 512 with k0 = 0 and on lines of 262,144, with one map and with six;
for branches on half-spaces of 512 x 512 with one, three and six of them, held and unloaded: at most 390, 590
and 990 with two maps.
"""

_LOCAL, _SHARED = 400, 720
"""The same by local creep on a half-space, and where a share of that is permanent.

Measured: 431 and 704 with one map of 512 x 512 sites, 760 with a hardness, 778 with six maps.
"""

_HELD, _HELD_BRANCH = 340, 85
"""The same of a separable solid under a load that stays, and what each branch adds; of a map, 8 for each.

Measured on 512 x 512 sites with six maps: 418 with one branch, 1323 with eight.
"""


def bytes_a_site(solid: Solid, shape: Sequence[int], maps: int, *, free: bool, held: bool = False) -> int:
    """Bytes of memory a site that a run needs; a load that is held asks less of a separable solid."""
    # Sites on which a contact is computed, for each site of the surface.
    embedding = Lattice(tuple(shape), edges="free").embedding.shape if free else shape
    embedded = math.prod(embedding) / math.prod(shape)
    springs, branches = solid.springs, len(solid.branches)
    if held and solid.separable:
        return round((_HELD + branches * _HELD_BRANCH) * embedded) + 8 * branches * maps
    more = max(branches - 1, 0)
    cycles = len(shape) == 2 and min(shape) >= 4 and springs is not None and springs.k0 > 0
    needed = _SPRINGS if cycles else _OTHERS + _BRANCH * more
    if springs is None and solid.creep is not None:
        needed = _SHARED if solid.permanent_share > 0 else _LOCAL
    return round(needed * embedded) + maps * (_MAP + _MAPPED_BRANCH * more)
