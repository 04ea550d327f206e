r"""The law of a rough contact as a table for other programs: what a pressure does, at each age.

It is that of the rough layer alone. Other programs compute how the bodies behind it deform, so what flat ones
would do is taken off: rough bodies differ from flat ones by the distance between the means of their surfaces.
With the heights h before anything yielded, and the surface u of the solid,

    approach  a = max h - <u>,        stiffness  dp/da = 1 / (A c),

where c is how far a unit of load at once lowers <u>, with the contacts as they are. On a half-space whose
edges are not free <u> is its position. A layer hangs on wave vector 0: its position is <u> less its even
compression p / K(0). With free edges, what all pressure displaces far away is not in <u> either. Where
nothing creeps or yields, the integral of p da is the elastic energy per area less p^2 / (2 K(0)).

The gap g bounds the flow between the surfaces (cubic law): fluid that cannot cross from channel to channel
conducts less, and fluid that crosses without loss more,

    < 1 / < g^-3 >_along >_across  <=  b^3  <=  1 / < 1 / < g^3 >_across >_along.

Between them b is that of an effective medium, < (g^3 - b^3) / (g^3 + b^3) > = 0 (D. A. G. Bruggeman, Ann.
Phys. 416, 636 (1935), DOI 10.1002/andp.19354160705).

Bands are those of another scan of this size, from tiles drawn anew with replacement: of
area and stiffness for each load that the tiles bear; of the gap less what follows from the pressure of the
tiles, by a straight line. The highest point of a scan varies as Gumbel's distribution that the highest points
of the tiles have.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from asperity.aging.frames import Frame
from asperity.aging.march import DEFAULT_RTOL
from asperity.analysis.bands import in_tiles
from asperity.analysis.scan import written
from asperity.base import checks, units
from asperity.base.version import __version__
from asperity.carried import Carried
from asperity.carried.response import unit_response
from asperity.contact import Contact, Load
from asperity.contact.instantaneous import pressed_anew
from asperity.errors import CheckpointError, InputError
from asperity.lattice import Field
from asperity.progress import Progress, listener
from asperity.results import Checkpoint
from asperity.results.dataset import attributes_of_solid
from asperity.results.store import whole_file
from asperity.simulate import age, pressed
from asperity.solids import Solid
from asperity.surfaces import Surface, read

TITLE = "Law of a rough contact"

OF_LAWS = {
    "approach": ("m", "approach of the rough layer alone, from first touch"),
    "stiffness": ("Pa/m", "normal stiffness per area, at once"),
    "tangential_stiffness": ("Pa/m", "tangential stiffness per area, before anything slips"),
    "conductance": ("S/m^2", "electrical conductance per area"),
    "thermal_conductance": ("W/m^2/K", "thermal conductance per area"),
    "contact_fraction": ("1", "real contact area over nominal area"),
    "mean_gap": ("m", "mean gap"),
    "hydraulic_gap": ("m", "hydraulic gap of an effective medium"),
    "hydraulic_gap_least": ("m", "lower bound of the hydraulic gap"),
    "hydraulic_gap_most": ("m", "upper bound of the hydraulic gap"),
    "largest_pressure": ("Pa", "largest contact pressure"),
}
"""Unit and meaning of the columns of a law, in their order; some have a band, ``_low`` and ``_high``."""

_CONDUCTANCES = {"resistance": "conductance", "thermal_resistance": "thermal_conductance"}

_DRAWS = 200
"""How often tiles are drawn."""

_WIDER = math.sqrt(16 / 15) * 2.131 / 1.960
"""Of sixteen values: the deviation of their mean that is known over that which drawing them gives."""

Row = dict[str, Any]


def law(
    solid: Solid,
    surface: str | Path | Surface,
    *,
    pressures: ArrayLike | Sequence[str],
    times: ArrayLike | Sequence[str] | None = None,
    per_decade: int = 10,
    carried: Carried | None = None,
    rtol: float = DEFAULT_RTOL,
    progress: Progress | Callable[[Frame], None] | bool | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
) -> xr.Dataset:
    """Tabulate what a rough contact does under each pressure, at each age: a law for other programs.

    Each pressure is put on at once, and held for all ages. The approach is that of the rough layer alone.

    Parameters
    ----------
    solid
        A half-space or a layer; of a relaxation table the ``solid`` of `asperity.relaxation.material`.
    surface
        The scan: a file for `asperity.surfaces.read`, or a `Surface` with units.
    pressures
        Load over nominal area, Pa or with units, rising. Two are the ends of a range, ``["0.1 MPa",
        "100 MPa"]``, with `per_decade` pressures in each decade; three or more are taken as they are.
    times
        Ages, s or with units, strictly increasing, >= 0; by default 0, where nothing creeps.
    carried
        What else to tabulate: ``poisson`` for the tangential stiffness, ``resistivity`` and ``conductivity``
        for the conductances; of half-spaces alone.
    rtol
        Tolerance of time steps; see `asperity.age`.
    progress
        True for a bar; or who is told how far it has come.
    checkpoint
        File in which to keep the pressures that are done. Remove it when the results are safe.

    Returns
    -------
    xarray.Dataset
        Over ``direction``, ``time`` (s) and ``pressure`` (Pa): approach, stiffness and others, with bands.
        Where something creeps or yields, ``direction`` has "unloading" beside "loading": from the largest
        pressure, at its age, at once.

    Raises
    ------
    InputError
        A number is wrong; all of the surface touches; or the solid is defined on sites.
    ConvergenceError
        A contact problem was not solved.
    """
    body = checks.instance("solid", solid, Solid, "asperity.solids.half_space(modulus='3 GPa')")
    if not body.in_lengths:
        expected, got = "a solid whose approach is a length", f"a {body.kind}, defined on sites"
        raise InputError("solid", expected=expected, got=got, advice="half_space(modulus='3 GPa')")
    if body.adhesion is not None:
        expected, advice = "a solid that does not stick, whose pressures begin at 0", "asperity.pull"
        raise InputError("solid", expected=expected, got="one with adhesion", advice=advice)
    for name in ("shear", "work_of_adhesion"):
        if (put := getattr(carried, name, None)) is not None:
            raise InputError(name, expected="none: a law is that of contacts pressed alone", got=put)
    steps = _pressures(pressures, checks.integer("per_decade", per_decade, least=1, most=1000))
    if steps[-1] >= body.hardness:
        expected, got = f"less than the hardness, {written(body.hardness, 'Pa')}", written(steps[-1], "Pa")
        raise InputError("pressures", expected=expected, got=got, advice="a lower last pressure")
    if times is None and body.branches:
        expected, advice = "the ages of a solid that creeps", "0 s, and when the law is needed"
        raise InputError("times", expected=expected, got="none", advice=advice)
    ages = checks.times("times", units.numbers("times", 0.0 if times is None else times, "s"))
    scan = read(surface) if isinstance(surface, str | Path) else surface
    scan = checks.instance("surface", scan, Surface, "Surface(heights, unit='um', pixel_size='1 um')").scan
    if scan.heights.ndim != 2:
        raise InputError("surface", expected="a scan of two axes", got="a profile", advice="a scan")
    heights, spacing = scan.in_meters()
    asked = body.kind, dict(body.parameters), steps.tolist(), ages.tolist(), carried, rtol, scan
    mark = hashlib.sha256(repr(asked).encode() + heights.tobytes()).hexdigest()
    path = Path(checkpoint.path if isinstance(checkpoint, Checkpoint) else checkpoint) if checkpoint else None
    rows = _kept(path, mark)
    done = {row["pressure"] for row in rows if row["direction"] == "loading"}
    layer = _Layer(heights, carried)
    with listener(progress) as listening:
        # The largest is first: it says whether all will touch, or yield.
        for left, step in reversed(list(enumerate(steps.tolist()))):
            if step in done:
                continue
            listening.stage(f"pressing with {written(step, 'Pa')}, {left} more to come")
            memory = left == steps.size - 1 and (body.branches or body.yields)
            rows += layer.held(scan, body, step, ages, steps[-2::-1].tolist() if memory else [], rtol)
            if path is not None:
                with whole_file(path) as part:
                    part.write_text(json.dumps({mark: rows}), encoding="utf-8")
    return _dataset(rows).assign_attrs(
        title=TITLE,
        asperity_version=__version__,
        **attributes_of_solid(body),
        edges=scan.edges,
        shape=json.dumps(scan.shape),
        spacing=json.dumps(spacing),
        surface=json.dumps(dict(scan.provenance)),
    )


def check_law(dataset: xr.Dataset) -> None:
    """Refuse what `law` did not make; `InputError`."""
    advice = "asperity.law(solid, scan, pressures=...)"
    if checks.instance("dataset", dataset, xr.Dataset, advice).attrs.get("title") != TITLE:
        raise InputError("dataset", expected="a law", got="another one", advice=advice)


def _pressures(given: Any, per_decade: int) -> Field:
    steps: Field = checks.line("pressures", units.numbers("pressures", given, "Pa"))
    if steps.size < 2 or not (np.diff(steps, prepend=0) > 0).all():
        expected, got = "two pressures or more above 0 that rise", checks.shown(given)
        raise InputError("pressures", expected=expected, got=got, advice="the lowest first")
    if steps.size > 2:
        return steps
    return np.geomspace(steps[0], steps[1], math.ceil(math.log10(steps[1] / steps[0]) * per_decade) + 1)


class _Layer:
    """A rough surface, of whose contacts it makes rows; the same tiles are drawn for all."""

    def __init__(self, rough: Field, carried: Carried | None) -> None:
        self.rough, self.carried = rough, carried
        highest, random = in_tiles(rough[np.newaxis], np.maximum)[0], np.random.default_rng(0)
        self.chosen = random.integers(0, highest.size, (_DRAWS, highest.size))
        higher = random.gumbel(scale=highest.std(ddof=1) * math.sqrt(6) / math.pi, size=_DRAWS)
        self.higher = (higher - np.median(higher)) / _WIDER  # which is for means of a few values

    def held(
        self, scan: Surface, body: Solid, pressure: float, ages: Field, down: list[float], rtol: float
    ) -> list[Row]:
        """Rows at each age of a held pressure, and then of lower ones, at once."""
        contact = pressed(scan, body, pressure=pressure)
        found: list[Row] = []

        def reached(time: float, contact: Contact) -> None:
            if time not in ages or time in (row["time"] for row in found):
                return
            if contact.contact_fraction == 1:
                got, advice = f"{written(pressure, 'Pa')}: all of it touches", "a lower last pressure"
                raise InputError("pressures", expected="less than full contact", got=got, advice=advice)
            where = {"direction": "loading", "time": time, "pressure": pressure}
            found.append(where | self.row(contact))
            where["direction"] = "unloading"
            found.extend([found[-1] | where] * bool(down))
            for less in down:
                contact = pressed_anew(contact, Load(less * contact.nominal_area))
                found.append(where | {"pressure": less} | self.row(contact))

        reached(0.0, contact)
        if ages[-1] > 0:
            age(contact, ages, rtol=rtol, progress=lambda frame: reached(frame.time, frame.contact))
        return found

    def row(self, contact: Contact) -> Row:
        """The numbers of one contact, with their bands."""
        body, mean, borne = unit_response(contact)
        area, gap = contact.nominal_area, contact.gap
        approach = float((self.rough.max() - contact.heights - gap).mean())
        row = {"approach": approach, "stiffness": 1 / (mean * area)}
        if self.carried is not None:
            # All follow the stiffness, here of the mean of the surface, there of the body.
            per_area = body / (mean * area)
            for name, value in self.carried.of(contact).items():
                if name == "tangential_stiffness":
                    row[name] = value * per_area
                elif name in _CONDUCTANCES:
                    row[_CONDUCTANCES[name]] = per_area / value
        row |= {name: getattr(contact, name) for name in ("contact_fraction", "mean_gap", "largest_pressure")}
        maps = np.stack([contact.in_contact, contact.force, borne, gap, np.ones_like(gap)])
        return row | _hydraulic(gap) | self._bands(row, in_tiles(maps))

    def _bands(self, row: Row, tiles: Field) -> Row:
        touching, force, borne, gap, sites = tiles[:, self.chosen].sum(axis=-1)
        # Tiles that long waves lift bear more load at a smaller gap.
        slope = np.polyfit(tiles[1] / tiles[4], tiles[3] / tiles[4], 1)[0]
        wider = gap / sites - slope * (force / sites - tiles[1].sum() / tiles[4].sum())
        share = np.where(force > 0, force / tiles[1].sum(), np.nan)
        stiffer = borne / share
        drawn = {
            "approach": row["approach"] + self.higher - (wider - row["mean_gap"]),
            "contact_fraction": row["contact_fraction"] * touching / tiles[0].sum() / share,
            "mean_gap": wider,
        }
        alike = ("stiffness", "tangential_stiffness", *_CONDUCTANCES.values())
        drawn |= {name: row[name] * stiffer for name in alike if name in row}
        ends: Row = {}
        for name, values in drawn.items():
            low, high = np.nanquantile(row[name] + _WIDER * (values - row[name]), (0.025, 0.975)).tolist()
            ends |= {f"{name}_low": low, f"{name}_high": high}
        return ends


def _hydraulic(gap: Field) -> Row:
    """Gaps of smooth plates between which as much flows, on average and at least and at most."""
    widest = float(gap.max())
    cubes = (np.maximum(gap, 0.0) / widest) ** 3
    with np.errstate(divide="ignore"):
        least = min(float((1 / (1 / cubes).mean(axis=along)).mean()) for along in (0, 1))
        most = max(float(1 / (1 / cubes.mean(axis=across)).mean()) for across in (0, 1))
    percolates = np.count_nonzero(cubes) > cubes.size / 2
    mean = brentq(lambda b: float(((cubes - b) / (cubes + b)).mean()), 1e-12, 1.0) if percolates else 0.0
    found = {"hydraulic_gap": mean, "hydraulic_gap_least": least, "hydraulic_gap_most": most}
    return {name: widest * value ** (1 / 3) for name, value in found.items()}


def _kept(path: Path | None, mark: str) -> list[Row]:
    """Rows of the pressures that are done, from a checkpoint if there is one."""
    if path is None or not path.exists():
        return []
    try:
        return list(json.loads(path.read_text(encoding="utf-8"))[mark])
    except (OSError, ValueError, TypeError, KeyError):
        known = {"expected": "a checkpoint of this law", "advice": "another path, or remove the file"}
        raise CheckpointError("checkpoint", got=f"{path}, of something else", **known) from None


def _dataset(rows: list[Row]) -> xr.Dataset:
    ends = {"": "", "_low": ", low end of the 95 % band", "_high": ", high end of the 95 % band"}
    facts = {
        f"{name}{end}": {"units": unit, "long_name": f"{meaning}{said}"}
        for (name, (unit, meaning)), (end, said) in itertools.product(OF_LAWS.items(), ends.items())
    }
    table = pd.DataFrame(rows).set_index(["direction", "time", "pressure"])
    dataset = table[[name for name in facts if name in table]].to_xarray()
    dataset = dataset.assign_coords(direction=dataset["direction"].astype(str))
    facts["time"] = {"units": "s", "long_name": "age: how long the pressure was held"}
    facts["pressure"] = {"units": "Pa", "long_name": "load over nominal area"}
    for name in facts.keys() & dataset.variables.keys():
        dataset[name].attrs.update(facts[name])
    return dataset
