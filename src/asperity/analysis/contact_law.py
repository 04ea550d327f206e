r"""The law of a rough contact as a table for other programs: what a pressure does, at each age.

It is the law of the rough layer alone. Other programs compute how the bodies deform that it stands between,
so what the flat solid would do is taken off: two rough bodies differ from flat ones by the distance between
the means of their surfaces. With the heights h of the rough surface before anything yielded, and the surface
u of the solid,

    approach  a = max h - <u>,        stiffness  dp/da = 1 / (A c),

where c is how far a unit of load at once lowers <u>, with the contacts as they are. Both vanish for a flat
surface. On a half-space with edges that are not free, <u> is its position. A layer hangs on wave vector 0:
its position is <u> less its even compression p / K(0). With free edges, what all pressure displaces far away
is not in <u> either. Where nothing creeps or yields, the integral of p da is the elastic energy for each
area, less that of the even compression.

The gap g bounds the flow between the surfaces (cubic law, contacts are closed): channels that only exchange
fluid along the flow, or across it without loss, conduct less and more,

    < 1 / < g^-3 >_along >_across  <=  b^3  <=  1 / < 1 / < g^3 >_across >_along,

least and most over both directions. Between these b is that of an effective medium, < (g^3 - b^3) / (g^3 +
b^3) > = 0 (D. A. G. Bruggeman, Ann. Phys. 416, 636 (1935), DOI 10.1002/andp.19354160705).

Bands are those of another scan of this size on the same surface, from tiles drawn anew, as in
`asperity.analysis.prediction`: of area and stiffness for each load that the tiles bear; of the gap less what
follows from the pressure of the tiles, by a straight line. Another scan has another highest point: that
varies by Gumbel's distribution, whose width is that of the highest points of the tiles.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from asperity.aging.frames import Frame
from asperity.aging.march import DEFAULT_RTOL
from asperity.analysis.predicting import check_known
from asperity.analysis.prediction import DRAWS, WIDER, in_tiles
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
from asperity.relaxation import Material, Measured, PronySeries
from asperity.relaxation import material as material_of
from asperity.results import Checkpoint
from asperity.results.dataset import attributes_of_solid
from asperity.results.store import whole_file
from asperity.simulate import age, pressed
from asperity.solids import Solid
from asperity.surfaces import Surface, read

TITLE = "Law of a rough contact"

OF_LAWS = {
    "approach": ("m", "approach of the rough layer alone, from first touch"),
    "stiffness": ("Pa/m", "normal stiffness for each area, at once"),
    "tangential_stiffness": ("Pa/m", "tangential stiffness for each area, before anything slips"),
    "conductance": ("S/m^2", "electrical conductance for each area"),
    "thermal_conductance": ("W/m^2/K", "thermal conductance for each area"),
    "contact_fraction": ("1", "real contact area over nominal area"),
    "mean_gap": ("m", "mean gap"),
    "hydraulic_gap": ("m", "hydraulic gap of an effective medium"),
    "hydraulic_gap_least": ("m", "lower bound of the hydraulic gap"),
    "hydraulic_gap_most": ("m", "upper bound of the hydraulic gap"),
    "largest_pressure": ("Pa", "largest contact pressure"),
}
"""Unit and meaning of the columns of a law, in their order; some have a band, ``_low`` and ``_high``."""

_ENDS = ("low", "high")
_AS_STIFFNESS = ("tangential_stiffness", "conductance", "thermal_conductance")

Row = dict[str, float]


def law(
    solid: Solid | Material | Measured | PronySeries | str | Path,
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
        A half-space or a layer; or what `asperity.relaxation.material` makes one of, such as the file of a
        relaxation table.
    surface
        The scan: a file for `asperity.surfaces.read`, or a `Surface` with units.
    pressures
        Load over nominal area, Pa or with units, rising. Two are the ends of a range, ``["0.1 MPa",
        "100 MPa"]``; three or more are taken as they are.
    times
        Ages, s or with units, strictly increasing, >= 0; by default 0, where nothing creeps.
    per_decade
        Pressures in each decade of a range. A straight line between pressures errs by 0.7 % at 10.
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
        Over ``direction``, ``time`` (s) and ``pressure`` (Pa): approach, stiffness and the others of the
        module, with bands. Where something creeps or yields, ``direction`` has "unloading" beside "loading":
        from the largest pressure, at its age, at once.

    Raises
    ------
    InputError
        A number is wrong; all of the surface touches; or the solid has no lengths.
    ConvergenceError
        A contact problem was not solved.
    """
    material = None if isinstance(solid, Solid) else material_of(solid)
    body = checks.instance("solid", solid if material is None else material.solid, Solid, "half_space(...)")
    if not body.in_lengths:
        expected, advice = "a solid with an approach in units of length", "half_space(modulus='3 GPa')"
        got = f"{body.kind}, which is defined on sites"
        raise InputError("solid", expected=expected, got=got, advice=advice)
    if carried is not None and carried.shear is not None:
        raise InputError("carried", expected="no shear force: it is a law of small ones", got="shear")
    steps = _pressures(pressures, checks.integer("per_decade", per_decade, least=1, most=1000))
    ages = _ages(times, body)
    for moment in () if material is None else ages[ages > 0].tolist():
        check_known(material, "times", moment)
    scan = read(surface) if isinstance(surface, str | Path) else surface
    advice = "asperity.surfaces.Surface(heights, unit='m', pixel_size=(dy, dx), length_unit='m')"
    scan = checks.instance("surface", scan, Surface, advice).scan
    if scan.heights.ndim != 2:
        raise InputError("surface", expected="a scan of two axes", got="a profile", advice="a scan")
    scan.in_meters()
    place = _Place(checkpoint, repr((body, steps, ages, carried, rtol, scan.edges)), scan)
    asked = {"carried": carried, "rtol": rtol}
    with listener(progress) as listening:
        # The largest is first: it says whether all will touch, or yield.
        for number, step in reversed(list(enumerate(steps.tolist()))):
            if str(number) not in place.rows:
                listening.stage(f"pressing with {written(step, 'Pa')}, {number} more to come")
                memory = number == steps.size - 1 and (body.branches or body.yields)
                down = steps[:-1].tolist() if memory else []
                place.keep(number, [list(ages_of) for ages_of in _held(scan, body, step, ages, down, asked)])
    return _dataset(place.rows, steps, ages, scan, body)


def _pressures(given: Any, per_decade: int) -> Field:
    expected, advice = "two pressures or more that rise", 'pressures=["0.1 MPa", "100 MPa"]'
    steps: Field = checks.floats("pressures", units.numbers("pressures", given, "Pa"), advice=advice).reshape(
        -1
    )
    falls = np.flatnonzero(~(np.diff(steps) > 0))
    if steps.size < 2 or falls.size or not steps[0] > 0:
        got = f"{steps.size}" if steps.size < 2 else f"{written(float(steps[0]), 'Pa')} first"
        if falls.size:
            got = " after ".join(written(float(steps[falls[0] + n]), "Pa") for n in (1, 0))
        raise InputError("pressures", expected=f"{expected}, above 0", got=got, advice=advice)
    if steps.size > 2:
        return steps
    return np.geomspace(steps[0], steps[1], math.ceil(math.log10(steps[1] / steps[0]) * per_decade) + 1)


def _ages(given: Any, body: Solid) -> Field:
    if given is None and body.branches:
        advice = 'times=["0 s", "1 h"]'
        raise InputError("times", expected="the ages of a solid that creeps", got="none", advice=advice)
    return checks.times("times", units.numbers("times", [0.0] if given is None else given, "s"), at_least=0)


def _held(
    scan: Surface, body: Solid, pressure: float, ages: Field, down: list[float], asked: dict[str, Any]
) -> Iterator[list[Row]]:
    """What a held pressure does, a row for each age; of the largest one, then of those below, at once."""
    try:
        contact = pressed(scan, body, pressure=pressure)
    except InputError as error:
        if error.name != "load":
            raise
        expected = f"pressures clearly below the hardness, {written(body.hardness, 'Pa')}"
        got = written(pressure, "Pa")
        raise InputError("pressures", expected=expected, got=got, advice="a lower last pressure") from None
    row = _Rows(contact, asked["carried"])

    def at(contact: Contact, time: float) -> list[Row]:
        if contact.contact_fraction == 1:
            got = f"{written(pressure, 'Pa')}, under which all of it touches at {written(time, 's')}"
            expected, advice = "pressures below full contact", "a lower last pressure"
            raise InputError("pressures", expected=expected, got=got, advice=advice)
        found = [row.of(contact)]
        for less in reversed(down):
            contact = pressed_anew(contact, Load(less * contact.nominal_area))
            found.append(row.of(contact))
        return found[:1] + found[:0:-1]

    if ages[-1] == 0:
        yield at(contact, 0.0)
        return
    found: dict[float, list[Row]] = {}

    def reached(frame: Frame) -> None:
        if frame.time in ages and frame.time not in found:
            found[frame.time] = at(frame.contact, frame.time)

    age(contact, ages, rtol=asked["rtol"], progress=reached)
    yield from (found[time] for time in ages.tolist())


class _Rows:
    """Makes rows of contacts of one surface, with the same tiles drawn for all."""

    def __init__(self, contact: Contact, carried: Carried | None) -> None:
        self.carried = carried
        self.rough = contact.heights  # nothing has yielded where nothing was pressed
        if contact.solid.yields:
            self.rough = contact.heights + contact.permanent_indentation
        highest = in_tiles(self.rough[np.newaxis], np.maximum)[0]
        random = np.random.default_rng(0)
        self.chosen = random.integers(0, highest.size, (DRAWS, highest.size))
        draws = random.gumbel(scale=highest.std(ddof=1) * math.sqrt(6) / math.pi, size=DRAWS)
        self.higher = (draws - np.median(draws)) / WIDER  # it is no mean of a few values

    def of(self, contact: Contact) -> Row:
        _, lowered, borne = unit_response(contact)
        area, gap = contact.nominal_area, contact.gap
        stiffness, surface = 1 / (lowered * area), contact.heights + gap
        row = {"approach": float(self.rough.max() - surface.mean()), "stiffness": stiffness}
        if self.carried is not None:
            more = self.carried.of(contact, stiffness * area)
            inverse = {"resistance": "conductance", "thermal_resistance": "thermal_conductance"}
            row |= {new: 1 / (more[old] * area) for old, new in inverse.items() if old in more}
            if "tangential_stiffness" in more:
                row["tangential_stiffness"] = more["tangential_stiffness"] / area
        names = ("contact_fraction", "mean_gap", "largest_pressure")
        row |= {name: getattr(contact, name) for name in names} | _hydraulic(gap)
        maps = np.stack([contact.in_contact, contact.force, borne, gap, np.ones_like(gap)])
        return row | self._bands(row, in_tiles(maps))

    def _bands(self, row: Row, tiles: Field) -> Row:
        touching, force, borne, gap, sites = tiles[:, self.chosen].sum(axis=-1)
        # Tiles that long waves lift bear more load at a smaller gap.
        slope = np.polyfit(tiles[1] / tiles[4], tiles[3] / tiles[4], 1)[0]
        wider = gap / sites - slope * (force / sites - tiles[1].sum() / tiles[4].sum())
        bearing = force > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            share = force / tiles[1].sum()
            drawn = {
                "approach": row["approach"] + self.higher - (wider - row["mean_gap"]),
                "stiffness": row["stiffness"] * borne / share,
                "contact_fraction": row["contact_fraction"] * touching / tiles[0].sum() / share,
                "mean_gap": wider,
            }
        drawn |= {
            name: drawn["stiffness"] * row[name] / row["stiffness"] for name in _AS_STIFFNESS if name in row
        }
        ends: Row = {}
        for name, values in drawn.items():
            spread = np.quantile(WIDER * (values[bearing] - row[name]), (0.025, 0.975))
            ends |= {f"{name}_{end}": row[name] + float(by) for end, by in zip(_ENDS, spread, strict=True)}
        return ends


def _hydraulic(gap: Field) -> Row:
    """Gaps of smooth plates between which as much flows, on average and at least and at most."""
    widest = float(gap.max())
    cubes = (np.maximum(gap, 0.0) / widest) ** 3
    with np.errstate(divide="ignore"):
        least = [float((1 / (1 / cubes).mean(axis=along)).mean()) for along in (0, 1)]
        most = [float(1 / (1 / cubes.mean(axis=1 - along)).mean()) for along in (0, 1)]
    mean = 0.0
    if (cubes > 0).mean() > 0.5:  # else closed sites percolate

        def excess(b: float) -> float:
            return float(((cubes - b) / (cubes + b)).mean())

        mean = brentq(excess, 1e-12, 1.0)
    found = {"hydraulic_gap": mean, "hydraulic_gap_least": min(least), "hydraulic_gap_most": max(most)}
    return {name: widest * value ** (1 / 3) for name, value in found.items()}


class _Place:
    """The pressures that are done, in a file where one is given: lists over ages and pressures of rows."""

    def __init__(self, checkpoint: str | Path | Checkpoint | None, asked: str, scan: Surface) -> None:
        path = checkpoint.path if isinstance(checkpoint, Checkpoint) else checkpoint
        self.path = None if path is None else Path(path)
        self.mark = hashlib.sha256(asked.encode() + np.ascontiguousarray(scan.heights).tobytes()).hexdigest()
        self.rows: dict[str, list[list[Row]]] = {}
        if self.path is not None and self.path.exists():
            try:
                found = json.loads(self.path.read_text(encoding="utf-8"))
                fits, self.rows = found["mark"] == self.mark, found["rows"]
            except (ValueError, KeyError, TypeError, OSError):
                fits = False
            if not fits:
                known = {"expected": "a checkpoint of this law", "advice": "another path, or remove the file"}
                raise CheckpointError("checkpoint", got=f"{self.path}, of something else", **known)

    def keep(self, number: int, rows: list[list[Row]]) -> None:
        self.rows[str(number)] = rows
        if self.path is not None:
            with whole_file(self.path) as part:
                part.write_text(json.dumps({"mark": self.mark, "rows": self.rows}), encoding="utf-8")


def _dataset(
    rows: dict[str, list[list[Row]]], pressures: Field, ages: Field, scan: Surface, body: Solid
) -> xr.Dataset:
    by_pressure = [rows[str(number)] for number in range(pressures.size)]
    tables = {"loading": [[one[age][0] for one in by_pressure] for age in range(ages.size)]}
    if len(by_pressure[-1][0]) > 1:
        tables["unloading"] = [[*both[1:], both[0]] for both in by_pressure[-1]]
    dataset = xr.Dataset(coords={"direction": list(tables), "time": ages, "pressure": pressures})
    dims, first = tuple(dataset.dims), tables["loading"][0][0]
    for name, (unit, meaning) in OF_LAWS.items():
        for end in ("", *_ENDS):
            if (column := "_".join(filter(None, (name, end)))) in first:
                values = [[[row[column] for row in line] for line in table] for table in tables.values()]
                said = f"{meaning}, {end} end of the 95 % band" if end else meaning
                dataset[column] = (dims, np.array(values), {"units": unit, "long_name": said})
    dataset["time"].attrs.update(units="s", long_name="age: how long the pressure was held")
    dataset["pressure"].attrs.update(units="Pa", long_name="load over nominal area")
    return dataset.assign_attrs(
        title=TITLE,
        asperity_version=__version__,
        **attributes_of_solid(body),
        edges=scan.edges,
        shape=json.dumps(scan.shape),
        spacing=json.dumps(scan.in_meters()[1]),
        surface=json.dumps(dict(scan.provenance)),
    )
