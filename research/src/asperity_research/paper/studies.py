"""The simulations behind the reproduction: a dozen campaigns, each an ordinary file of ``asperity sweep``.

Everywhere k0 = 1 and R = 1, unless they are what is varied: the other values follow by scaling. The paper
leaves some of its conditions unsaid (the loads, the stiffness ratios of its second and third figure, the
sizes of its fifth and sixth); those are chosen here to show what it describes.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity_research.paper.wording import sentences
from asperity_research.studies.campaigns import Campaign

HURST = 0.5  # Hurst exponent of the self-affine surfaces, where it is not varied
DELTA = 0.01  # Width of their last random midpoints
SELF_AFFINE_RATIO = 10.0  # k1/k0 on them, where it is not varied
MAP_BOXES = 8  # Boxes along a side of a map in which contacts are counted
PEAK = 1e3  # Height of the lone asperity; it only has to stay out of the reach of everything else


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
    amounts = {f"${name}": value for name, value in _amounts(effort).items()}

    def filled(part: Any) -> Any:
        if isinstance(part, dict):
            return {key: filled(value) for key, value in part.items()}
        return [filled(value) for value in part] if isinstance(part, list) else amounts.get(part, part)

    campaigns = []
    for name, campaign in sentences("campaigns.toml").items():
        tables, heights = filled(campaign), {}
        purpose, alone = tables.pop("purpose"), tables.pop("asperity", None)
        if alone is not None:
            heights["asperity.npy"] = np.zeros(alone)
            heights["asperity.npy"].flat[0] = PEAK
        campaigns.append(Campaign(name, purpose, tables, heights))
    return tuple(campaigns)


def _amounts(effort: Effort) -> dict[str, object]:
    """What the campaigns of an effort name: its own numbers, loads, and what all have."""
    sites, half = effort.side**2, effort.side // 2
    amounts = {name: list(one) if isinstance(one, tuple) else one for name, one in vars(effort).items()}
    loads = {
        "pressed": [sites * p for p in _decades(1e-3, 1e3, effort.loads_per_decade)],
        "aging": [sites * p for p in effort.aging_loads],
        "few": sites * 3e-3,
        "half_load": half**2 * 0.02,
        "decades": _decades(1.0, 1e4, effort.loads_per_decade),
    }
    shared = {"HURST": HURST, "DELTA": DELTA, "SELF_AFFINE_RATIO": SELF_AFFINE_RATIO}
    return amounts | loads | shared | {"half_side": half, "aging_size": effort.aging_sizes[0]}


def _decades(first: float, last: float, per_decade: int) -> list[float]:
    """Values even in the logarithm, to three digits, so that the file can be read."""
    count = 1 + round(np.log10(last / first) * per_decade)
    return [float(f"{value:.3g}") for value in np.geomspace(first, last, count)]
