"""The simulations behind the reproduction: a dozen campaigns, each an ordinary file of ``asperity sweep``.

Everywhere k0 = 1 and R = 1, unless they are what is varied: the other values follow by scaling. The paper
leaves some of its conditions unsaid (the loads, the stiffness ratios of its second and third figure, the
sizes of its fifth and sixth); those are chosen here to show what it describes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign

HURST = 0.5
"""Hurst exponent of the self-affine surfaces, where it is not varied."""

DELTA = 0.01
"""Width of their last random midpoints."""

SELF_AFFINE_RATIO = 10.0
"""k1/k0 on them, where it is not varied."""

MAP_BOXES = 8
"""Boxes along a side of a map in which contacts are counted."""

PEAK = 1e3
"""Height of the lone asperity; it only has to stay out of the reach of everything else."""


@dataclass(frozen=True)
class Effort:
    """How much is computed: surfaces in an ensemble, loads, and sides of lattices.

    Ensembles have a size of their own where growth is compared between loads (``aging_seeds``), where
    contacts are only pressed and relaxed, and where they are so light that few sites touch. ``aging_loads``
    are loads per site, over k0, on independent heights, whose lattices have the side ``side``; the other
    sides are of self-affine surfaces: pressed, aging, and mapped.
    """

    name: str
    seeds: int
    aging_seeds: int
    pressed_seeds: int
    light_seeds: int
    loads_per_decade: int
    aging_loads: tuple[float, ...]
    sizes: tuple[int, ...]
    aging_sizes: tuple[int, ...] = (128, 256)
    maps_size: int = 256
    side: int = 200


QUICK = Effort(
    "quick",
    seeds=6,
    aging_seeds=6,
    pressed_seeds=8,
    light_seeds=16,
    loads_per_decade=2,
    aging_loads=(3e-3, 1e-2, 3e-2, 1e-1, 3e-1),
    sizes=(128, 256),
)
FULL = Effort(
    "full",
    seeds=16,
    aging_seeds=64,
    pressed_seeds=32,
    light_seeds=256,
    loads_per_decade=4,
    aging_loads=(3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0),
    sizes=(128, 256, 512),
)


def studies(effort: Effort) -> tuple[Campaign, ...]:
    """Return all campaigns of the reproduction, whose seeds are the numbers of surfaces."""
    return (*_uncorrelated(effort), *_self_affine(effort), *_points())


def _campaign(
    name: str, purpose: str, *, heights: Mapping[str, Field] | None = None, **tables: Any
) -> Campaign:
    return Campaign(name, purpose, tables, heights or {})


def _uncorrelated(effort: Effort) -> tuple[Campaign, ...]:
    sites, small_sites = effort.side**2, (effort.side // 2) ** 2
    gaussian = {"kind": "gaussian", "shape": [effort.side] * 2}
    small: dict[str, Any] = {
        "surface": gaussian | {"shape": [effort.side // 2] * 2},
        "contact": {"load": small_sites * 0.02},
    }
    pressed = [sites * p for p in _decades(1e-3, 1e3, effort.loads_per_decade)]
    aging = [sites * p for p in effort.aging_loads]
    return (
        _campaign(
            "load",
            "Area against load, before creep and relaxed: independent Gaussian heights",
            surface=gaussian,
            aging=_ONLY_ENDS,
            sweep={"k1": [0.01, 0.1, 1.0, 10.0, 100.0], "load": pressed, "seeds": effort.pressed_seeds},
        ),
        _campaign(
            "aging",
            "Growth of the area at constant load: independent Gaussian heights",
            surface=gaussian,
            sweep={"k1": [1.0, 10.0], "load": aging, "seeds": effort.aging_seeds},
        ),
        _campaign(
            "exponential",
            "Growth of the area of few contacts: exponential heights, with and without viscous creep",
            surface=gaussian | {"kind": "exponential"},
            contact={"load": sites * 3e-3},
            aging={"last": 1e3},
            sweep={"k1": [1.0, 3.0], "R_viscous": [0.0, 1.0], "seeds": effort.light_seeds},
        ),
        _campaign(
            "mobility",
            "Growth of the area for several mobilities R",
            **small,
            sweep={"R": [0.01, 1.0, 100.0], "seeds": effort.seeds},
        ),
        _campaign(
            "separation",
            "The load under a rigid body that is held in place, with and without viscous creep",
            **small,
            aging={"hold": "separation"},
            sweep={"R_viscous": [0.0, 0.1, 1.0], "seeds": effort.seeds},
        ),
        _campaign(
            "no_lateral",
            "Creep without springs between neighbors",
            surface=gaussian | {"shape": [64, 64]},
            solid={"k0": 0.0, "k1": 1.0},
            aging={"last": 1e8},
            sweep={"load": [4.0, 40.0, 400.0], "seeds": effort.seeds},
        ),
        _campaign(
            "sketch",
            "A line contact, to be drawn",
            surface=gaussian | {"shape": [32]},
            solid={"k1": 1.0},
            contact={"load": 10.0},
            aging={"times": [1.0, 10.0, 100.0]},
            output={"maps_at": [0.0, 100.0]},
            sweep={"seeds": 1},
        ),
    )


def _self_affine(effort: Effort) -> tuple[Campaign, ...]:
    surface, stiff = {"kind": "self_affine", "hurst": HURST, "delta": DELTA}, {"k1": SELF_AFFINE_RATIO}
    mapped, loads = surface | {"size": effort.maps_size}, [5.0, 20.0, 80.0]
    sizes = {"size": list(effort.sizes), "load": _decades(1.0, 1e4, effort.loads_per_decade)}
    aging = {"size": list(effort.aging_sizes), "k1": [3.0, 10.0], "load": loads}
    return (
        _campaign(
            "self_affine_load",
            "Area against load, before creep and relaxed: self-affine surfaces of several sizes",
            surface=surface,
            solid=stiff,
            aging=_ONLY_ENDS,
            sweep=sizes | {"seeds": effort.pressed_seeds},
        ),
        _campaign(
            "self_affine_aging",
            "Growth of the area at constant load: self-affine surfaces of several sizes",
            surface=surface,
            sweep=aging | {"seeds": effort.aging_seeds},
        ),
        _campaign(
            "hurst",
            "Area against load, and its growth, for several Hurst exponents",
            surface={"kind": "self_affine", "size": effort.aging_sizes[0], "delta": DELTA},
            solid=stiff,
            sweep={"hurst": [0.3, 0.5, 0.8], "load": loads, "seeds": effort.seeds},
        ),
        _campaign(
            "maps",
            "Where a self-affine surface touches as the contact ages",
            surface=mapped,
            solid=stiff,
            contact={"load": 10.0},
            aging={"first": 1e-2, "last": 1e6, "per_decade": 1},
            output={"maps_at": [0.0, 1.0, 100.0, 1e4, 1e6]},
            sweep={"seeds": effort.seeds},
        ),
        _campaign(
            "load_maps",
            "Where a self-affine surface touches as the load grows",
            surface=mapped,
            solid=stiff,
            aging=_ONLY_ENDS,
            output={"maps_at": [0.0]},
            sweep={"load": [10.0, 100.0, 1000.0], "seeds": 1},
        ),
    )


def _points() -> tuple[Campaign, ...]:
    """One asperity: the engine beside the closed form of the compliance."""
    alone = {"kind": "file", "path": "asperity.npy", "tilt": "none", "periodic": "wrap"}
    pressed: dict[str, Any] = {"surface": alone, "contact": {"load": 1.0}}
    return (
        _campaign(
            "point",
            "Indentation of the plane by one asperity under constant load",
            **pressed,
            sweep={"k1": [1.0, 3.0, 10.0], "R_viscous": [0.0, 0.1, 1.0]},
            heights=_asperity(128, 128),
        ),
        _campaign(
            "line_point",
            "Indentation of the line by one asperity under constant load",
            **pressed,
            aging={"last": 1e9},
            sweep={"k1": [1.0, 10.0]},
            heights=_asperity(4096),
        ),
    )


def _asperity(*shape: int) -> dict[str, Field]:
    """A flat surface with one high site."""
    heights = np.zeros(shape)
    heights.flat[0] = PEAK
    return {"asperity.npy": heights}


_ONLY_ENDS = {"times": [0.0]}
"""No creep is followed: the instantaneous and the relaxed contact are enough."""


def _decades(first: float, last: float, per_decade: int) -> list[float]:
    """Values even in the logarithm, to three digits, so that the file can be read."""
    count = 1 + round(np.log10(last / first) * per_decade)
    return [float(f"{value:.3g}") for value in np.geomspace(first, last, count)]
