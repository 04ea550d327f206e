"""How long a campaign will take, and how much it will write: a rough answer before it starts.

The time of a run depends on its lattice, load, stiffness and surface in ways that no simple formula knows.
So it is measured. Where the campaign has finished runs, they say it. Elsewhere runs at a few points of the
plan, evenly spread, are tried, with the same load per site, on lattices as large as the time for trials
allows, at most the run's own. At the first of these points a small lattice is tried too: both times say how
the time grows with the sites. All other points take the mean of the nearest, along the axes of the plan.
"""

from __future__ import annotations

import math
import tempfile
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from asperity.app.campaign.plan import Plan, Run
from asperity.app.campaign.store import QUANTITIES, Store
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.models import SelfAffine
from asperity.app.config.solids import Continuum
from asperity.app.runs import Progress, execute, recorded_times
from asperity.base import checks
from asperity.errors import AsperityError
from asperity.patches import QUANTILES
from asperity.results.quantities import OF_MAPS
from asperity.surfaces import Surface
from asperity.surfaces.prepare import is_length

_PATIENCE = 3.0
"""Seconds of computing after which no further trial run is begun."""

_POINTS = 8
"""Points of a plan that are tried, if time allows."""

_WARM, _SMALL, _LARGE = 16**2, 32**2, 512**2
"""Sites of the trial run that is not timed (it may compile), of the small ones, and of the largest."""

_GROWTH, _UNTRIED = 0.85, 2 / 3
"""Power of the sites with which the time beyond a fixed part grows, up to `_LARGE` (then it is proportional);
and that of the whole time, where only the small lattice is tried. Measured on histories of 16 x 16 to
1024 x 1024 sites; a straight line in the sites took up to 2.5 times too much.
"""

_READ = 100
"""Finished runs that are read."""

_BLOCK, _PLANNED = 4096, 600
"""Bytes that files and folders are rounded up to on disk, and those of a run in the plan."""

_START, _BESIDE = 4.0, 0.025
"""Seconds to start the workers, and beside the computing of a run; see ``docs/campaigns.md``."""

Point = tuple[int, ...]


@dataclass(frozen=True)
class Estimate:
    """What a campaign has still to do.

    Attributes
    ----------
    runs
        Runs to do.
    seconds
        Time they take one after the other.
    bytes
        Space they take.
    basis
        What the time was judged by.
    """

    runs: int
    seconds: float
    bytes: int
    basis: str

    def wall(self, workers: int) -> float:
        """Seconds until all are done, the start of the workers included."""
        return _START + self.seconds / min(workers, self.runs) if self.runs else 0.0


@dataclass(frozen=True)
class _Cost:
    """Seconds of a run with its parameters: some, and some that grow with the sites."""

    fixed: float
    rate: float

    def at(self, sites: int) -> float:
        """Seconds on a lattice of so many sites."""
        return self.fixed + self.rate * _work(sites)


def _work(sites: float) -> float:
    return float(min(sites, _LARGE) ** _GROWTH * max(1.0, sites / _LARGE))


def estimate(plan: Plan, directory: str | Path) -> Estimate:
    """Judge what is left of a campaign.

    Parameters
    ----------
    plan
        From `read_plan`.
    directory
        Its folder, which need not exist; finished runs there tell how long such runs take.

    Raises
    ------
    AsperityError
        A surface file cannot be read.

    Notes
    -----
    Takes some seconds of trial runs, in this process. Expect it to be off by up to a factor of two, on the
    machine that it was asked on.
    """
    checks.instance("plan", plan, Plan, 'asperity.campaign.read_plan("campaign.toml")')
    store = Store(Path(directory))
    done = store.done()
    todo = {run.identity: run for run in plan.runs if run.identity not in done}
    if not todo:
        return Estimate(0, 0.0, 0, "nothing is left")
    counts: dict[Point, int] = {}
    configs: dict[Point, RunConfig] = {}
    for run in todo.values():
        counts[run.point] = counts.get(run.point, 0) + 1
        configs[run.point] = run.config
    sites = {point: math.prod(_shape(config)) for point, config in configs.items()}
    known = _finished(store, [run for run in plan.runs if run.identity in done])
    tried = dict(_tried({point: config for point, config in configs.items() if point not in known}))
    costs = _nearest(plan, known | tried, list(counts))
    computing = sum(
        count * cost.at(sites[point]) for (point, count), cost in zip(counts.items(), costs, strict=True)
    )
    space = sum(count * _bytes(configs[point]) for point, count in counts.items())
    basis = [f"finished runs at {_points(len(known))}"] * bool(known)
    basis += [f"trial runs at {_points(len(tried))}"] * bool(tried)
    return Estimate(len(todo), computing + _BESIDE * len(todo), space, " and ".join(basis))


def _points(count: int) -> str:
    return "1 point" if count == 1 else f"{count} points"


def _finished(store: Store, runs: Sequence[Run]) -> dict[Point, _Cost]:
    """What finished runs cost: at each point the median of some of them."""
    rates: dict[Point, list[float]] = {}
    for run in runs[:: 1 + len(runs) // _READ]:
        scalars = store.read(run).scalars
        rates.setdefault(run.point, []).append(scalars["seconds"] / _work(scalars["sites"]))
    return {point: _Cost(0.0, float(np.median(some))) for point, some in rates.items()}


def _nearest(plan: Plan, known: Mapping[Point, _Cost], wanted: Sequence[Point]) -> Iterator[_Cost]:
    """The cost at each point: that of the nearest known ones, each axis taken as of length 1."""
    lengths = np.array([max(1, len(axis.values) - 1) for axis in plan.axes])
    places = np.array(list(known), dtype=np.float64) / lengths
    costs = np.array([(cost.fixed, cost.rate) for cost in known.values()])
    for point in wanted:
        distance = np.abs(places - np.array(point) / lengths).sum(axis=1)
        yield _Cost(*costs[distance <= distance.min() + 1e-9].mean(axis=0).tolist())


def _tried(configs: Mapping[Point, RunConfig]) -> Iterator[tuple[Point, _Cost]]:
    """Try runs at a few points, as many as the time allows, and at least one."""
    points = list(configs)
    begin = clock.process_time()
    most, shape = 0, _Cost(0.0, 1.0)
    chosen = _spread(len(points))
    for number in chosen:
        config = configs[points[number]]
        if most == 0:
            _seconds(config, _WARM)
            most, shape = _line(config, _PATIENCE / min(2 * len(chosen), 6))
            yield points[number], shape
        elif clock.process_time() - begin < _PATIENCE:
            sites, seconds = _seconds(config, most)
            level = seconds / shape.at(sites)
            yield points[number], _Cost(level * shape.fixed, level * shape.rate)


def _spread(count: int) -> list[int]:
    """Some numbers below ``count``, if there are any: the middle, then the middles of what is left."""
    order = [(int(f"{i:08b}"[::-1], 2) / 256 + 0.5) % 1 for i in range(256)]
    return list(dict.fromkeys(int(part * count) for part in order))[:_POINTS] if count else []


def _line(config: RunConfig, allowed: float) -> tuple[int, _Cost]:
    """Sites of a trial that takes about as long as is allowed; how the time goes with the sites."""
    whole = math.prod(_shape(config))
    sites, seconds = _seconds(config, min(_SMALL, whole))
    affordable = sites * (allowed / seconds) ** 2  # the fixed part is most of it
    most = math.prod(_lattice(config, min(_LARGE, whole, int(max(affordable, sites)))))
    if most > sites:
        larger, longer = _seconds(config, most)
    else:
        larger, longer = whole, seconds * (whole / sites) ** _UNTRIED
    rate = max(0.0, longer - seconds) / max(1.0, _work(larger) - _work(sites))
    return most, _Cost(max(0.0, longer - rate * _work(larger)), rate)


def _seconds(config: RunConfig, most: int) -> tuple[int, float]:
    """Sites and computing time of a run on at most so many sites, with the same load per site."""
    with tempfile.TemporaryDirectory() as folder:
        small, sites = _shrunk(config, most, Path(folder))
        begin = clock.process_time()
        with suppress(AsperityError):  # it would fail in the campaign too, after as long a time
            execute(small, Progress())
        return sites, clock.process_time() - begin


def _shrunk(config: RunConfig, most: int, folder: Path) -> tuple[RunConfig, int]:
    """The same run on a smaller lattice, without maps; and its sites."""
    chosen, contact = config.surface, config.contact
    shape = _lattice(config, most)
    if isinstance(chosen, SelfAffine):
        chosen = chosen.model_copy(update={"size": shape[0]})
    elif not isinstance(chosen, MeasuredSurface):
        chosen = chosen.model_copy(update={"shape": shape})
    elif shape != _shape(config):
        chosen = _part(chosen, shape, folder)
    sites = math.prod(shape)
    if contact.load is not None:
        load = contact.load * sites / math.prod(_shape(config))
        contact = contact.model_copy(update={"load": load})
    output = config.output.model_copy(update={"maps_at": []})
    return config.model_copy(update={"surface": chosen, "contact": contact, "output": output}), sites


def _lattice(config: RunConfig, most: int) -> list[int]:
    """The lattice of a run, its longest axis halved until there are few enough sites."""
    shape = _shape(config)
    if math.prod(shape) <= most:
        return shape
    halved = _halved(shape, most)
    if isinstance(config.surface, SelfAffine):
        return [min(halved)] * 2
    # A part of a measured surface is mirrored.
    return [n + n % 2 for n in halved] if isinstance(config.surface, MeasuredSurface) else halved


def _halved(shape: Sequence[int], most: int) -> list[int]:
    halved = list(shape)
    while math.prod(halved) > most:
        halved[halved.index(max(halved))] //= 2
    return halved


def _bytes(config: RunConfig) -> int:
    """Space of a run on disk. Numbers hardly compress, but for what is true or false."""
    times, maps = 1 + len(recorded_times(config)), len(config.output.maps_at or ())
    axes, sites = len(_shape(config)), math.prod(_shape(config))
    arrays = [(8 * len(QUANTITIES) * times, 2)]
    if maps:
        fields = 2
        if isinstance(config.solid, Continuum):
            fields = 2 + max(1, len(config.solid.maxwell))
        arrays += [(8 * maps, 1), *[(8 * sites * maps, axes + 1)] * fields, (sites * maps // 8, axes + 1)]
        columns = len(OF_MAPS) + 2 * (len(QUANTILES) - 1)
        arrays += [(8 * columns * maps, 2), *[(8 * sites, axes)] * 2, (sites // 8, axes)]
    # An array is a description, and a file so many folders deep.
    blocks = 2 + sum(2 + depth + math.ceil(size / _BLOCK) for size, depth in arrays)
    return blocks * _BLOCK + _PLANNED


def _shape(config: RunConfig) -> list[int]:
    """The lattice of a run."""
    chosen = config.surface
    return list(_measured(chosen)[0] if isinstance(chosen, MeasuredSurface) else chosen.lattice)


def _part(chosen: MeasuredSurface, shape: Sequence[int], folder: Path) -> MeasuredSurface:
    """A part of a measured surface of this shape; where edges do not reflect, its mirror images make it."""
    _, corner = _measured(chosen)
    reflects = corner.edges == "reflecting"
    part = corner.heights[tuple(slice(n if reflects else n // 2) for n in shape)]
    units: dict[str, object] = {"pixel_size": corner.pixel_size and list(corner.pixel_size)}
    if corner.unit == "m":
        units |= {"file_unit": "m", "length_unit": corner.length_unit}
    path = folder / "part.npy"
    np.save(path, part)
    periodic = "reflect" if reflects else "mirror"
    return MeasuredSurface.model_validate({"path": str(path), "tilt": "none", "periodic": periodic, **units})


def _measured(chosen: MeasuredSurface) -> tuple[tuple[int, ...], Surface]:
    """The lattice of a measured surface, and a corner of it: in meters where it has units."""
    return _measured_once(chosen.model_dump_json(exclude_none=True))


@lru_cache(maxsize=8)
def _measured_once(chosen: str) -> tuple[tuple[int, ...], Surface]:
    surface = MeasuredSurface.model_validate_json(chosen).build()
    heights, spacing, unit = surface.heights, surface.pixel_size, None
    if is_length(surface.unit) and surface.has_lengths and spacing and surface.length_unit:
        (heights, spacing), unit = surface.in_meters(), "m"
    corner = heights[tuple(map(slice, _halved(heights.shape, _LARGE)))]
    return heights.shape, Surface(corner, unit or "1", spacing, unit, edges=surface.edges)
