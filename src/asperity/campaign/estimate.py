"""How long a campaign will take, and how much it will write: a rough answer before it starts."""

from __future__ import annotations

import math
import time as clock
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from asperity.campaign.plan import Plan
from asperity.campaign.store import QUANTITIES, Store
from asperity.config import MeasuredSurface, RunConfig
from asperity.config.models import Gaussian, SelfAffine
from asperity.runs import Silent, execute, hold_times_of
from asperity.surfaces import read

_TRIAL = 64
"""Sites along each axis of the lattice on which a trial run is timed."""

_OVERHEAD = 16_384
"""Bytes on disk of a run without its arrays: metadata, and the rest of the last blocks."""

_START, _BESIDE = 4.0, 0.025
"""Seconds to start the workers, and beside the computing of a run; see ``docs/campaigns.md``."""


@dataclass(frozen=True)
class Estimate:
    """What a campaign has still to do.

    Attributes
    ----------
    runs
        Runs to do.
    seconds
        Time they take one after the other; divide by the workers.
    bytes
        Space they take.
    basis
        What the time was judged by.
    """

    runs: int
    seconds: float
    bytes: int
    basis: str


def estimate(plan: Plan, directory: str | Path) -> Estimate:
    """Judge what is left of a campaign.

    Parameters
    ----------
    plan
        From `read_plan`.
    directory
        Its folder, which need not exist; finished runs there tell how fast this machine is.

    Notes
    -----
    The time of a run is taken to grow like N log N with its sites N. It also depends on the load, the
    stiffness and the surface, which this does not know: expect it to be off by a factor of two.
    """
    store = Store(Path(directory))
    done = store.done()
    todo = {run.identity: run.config for run in plan.runs if run.identity not in done}
    if not todo:
        return Estimate(0, 0.0, 0, "nothing is left")
    sites = {name: _sites(config) for name, config in todo.items()}
    known = [store.read(run.identity).scalars for run in plan.runs if run.identity in done][:100]
    if known:
        rate = float(np.median([scalars["seconds"] / _work(scalars["sites"]) for scalars in known]))
        basis = f"{len(known)} finished runs"
    else:
        configs = list(todo.values())
        rate = (_trial(configs[0]) + _trial(configs[-1])) / 2 / _work(_TRIAL**2)
        basis = f"trial runs of {_TRIAL} x {_TRIAL} sites"
    space = sum(_bytes(config, sites[name]) for name, config in todo.items())
    computing = rate * sum(map(_work, sites.values()))
    return Estimate(len(todo), computing + _START + _BESIDE * len(todo), space, basis)


def _work(sites: float) -> float:
    return sites * math.log2(max(sites, 2.0))


def _trial(config: RunConfig) -> float:
    """Time a small run of the same solid and the same times."""
    small = config.model_copy(
        update={
            "surface": Gaussian(shape=[_TRIAL, _TRIAL]),
            "contact": type(config.contact)(),
            "output": config.output.model_copy(update={"maps_at": []}),
        }
    )
    begin = clock.perf_counter()
    execute(small, Silent())
    return clock.perf_counter() - begin


def _bytes(config: RunConfig, sites: int) -> int:
    times = 1 + len(hold_times_of(config.aging))
    return _OVERHEAD + 8 * len(QUANTITIES) * times + 17 * sites * len(config.output.maps_at or ())


def _sites(config: RunConfig) -> int:
    chosen = config.surface
    if isinstance(chosen, MeasuredSurface):
        return _measured_sites(chosen.path, chosen.periodic, chosen.channel, chosen.max_undefined)
    return chosen.size**2 if isinstance(chosen, SelfAffine) else math.prod(chosen.shape)


@lru_cache(maxsize=64)
def _measured_sites(path: str, periodic: str, channel: int | str | None, most_undefined: float) -> int:
    found = read(path, periodic="wrap", channel=channel, max_undefined=most_undefined).heights
    return found.size * (2**found.ndim if periodic == "mirror" else 1)
