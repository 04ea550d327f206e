"""The remaining runs of a campaign, and the memory and disk that they need."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from asperity.aging.memory import bytes_a_site
from asperity.app.campaign.plan import Plan
from asperity.app.campaign.store import Store
from asperity.app.config import RunConfig
from asperity.app.runs import recorded_times
from asperity.base import checks
from asperity.patches import QUANTILES
from asperity.results.quantities import select
from asperity.solids import Solid

_QUANTITIES = 20
"""About how many numbers an entry of an answer has."""

_BLOCK = 4096
"""Bytes that files and folders are rounded up to on disk."""


@dataclass(frozen=True)
class Estimate:
    """The remaining work of a campaign.

    Attributes
    ----------
    runs
        Runs to do.
    memory
        Bytes of memory that the largest of them needs for its arrays; each worker does one run at a time.
    bytes
        Space on disk that they take.
    """

    runs: int
    memory: int
    bytes: int


def estimate(plan: Plan, directory: str | Path) -> Estimate:
    """Count the remaining runs of a campaign; only measured surfaces are read.

    Parameters
    ----------
    plan
        From `read_plan`.
    directory
        Its folder, which need not exist.

    Raises
    ------
    AsperityError
        A surface file cannot be read.
    """
    checks.instance("plan", plan, Plan, 'asperity.campaign.read_plan("campaign.toml")')
    done = Store(directory).done()
    todo = {name: run for name, run in plan.distinct.items() if name not in done}
    points = {run.point: run.config for run in todo.values()}
    measured: dict[str, tuple[int, ...]] = {}
    space: dict[tuple[int, ...], int] = {}
    memory = 0
    for point, config in points.items():
        name, free = repr(config.surface), config.surface.edges == "free"
        shape = config.surface.lattice or measured.get(name) or config.surface.build().shape
        measured[name], maps = shape, len(config.output.maps_at or ())
        solid = config.solid.build()
        memory = max(memory, math.prod(shape) * bytes_a_site(solid, shape, maps, free=free))
        space[point] = _space(config, solid, shape)
    return Estimate(len(todo), memory, sum(space[run.point] for run in todo.values()))


def _space(config: RunConfig, solid: Solid, shape: Sequence[int]) -> int:
    """Bytes of a run on disk. Numbers hardly compress, but for what is true or false."""
    maps, sites = len(config.output.maps_at or ()), math.prod(shape)
    arrays = [8 * _QUANTITIES * (1 + len(recorded_times(config)))]
    if maps:
        fields = 2 + max(1, len(solid.branches))
        arrays += [8 * maps * len(select("map")), 16 * maps * len(QUANTILES), 8 * maps]
        arrays += [8 * sites, 8 * sites, sites // 8]
        arrays += [8 * sites * maps] * fields + [sites * maps // 8]
    # An array is a description, and a file some folders deep.
    return _BLOCK * (2 + sum(5 + math.ceil(size / _BLOCK) for size in arrays))
