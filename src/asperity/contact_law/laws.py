r"""The law of a rough contact, for other programs: a table over pressure, at each age.

The law is that of the rough layer alone, because other programs compute how the bodies behind it deform.
Rough bodies are further apart than flat ones, by the distance between the means of their surfaces.
With the heights h before anything yielded, and the surface u of the solid,

    approach  a = max h - <u>,        stiffness  dp/da = 1 / (A c),

where c is how far a unit of load lowers <u> instantly, with unchanged contacts. On a half-space without free
edges <u> is its position. The position of a layer is <u> less its even compression p / K(0), for wave vector
0. With free edges, <u> leaves out the displacement of the body far away. All means are over the sites of the
body. Where nothing creeps or yields, the integral of p da is the elastic energy per area less p^2 / (2 K(0)).

Bands are of the mean over scans of this size: each of 16 tiles is left out in turn
(`asperity.analysis.bands`). The others bear another pressure; the change of the law from that to this one is
taken off. The approach varies as the highest point of a scan: by Gumbel's distribution, of the width that
those of the tiles have.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import asdict
from operator import itemgetter
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.stats import gumbel_r

from asperity.analysis.bands import CLOSED, bearing, in_tiles, interval, student, without_each
from asperity.analysis.flow import hydraulic_gap
from asperity.ask.contact_law import Law
from asperity.ask.question import answers
from asperity.ask.surface import scan_of
from asperity.base.calls import remark
from asperity.base.readable import written
from asperity.carried import Carried
from asperity.carried.record import quantities, tangential
from asperity.carried.response import unit_response
from asperity.carried.shear import compliances, principal
from asperity.contact import Contact, Load
from asperity.contact.instantaneous import pressed_anew
from asperity.contact.remarks import Resolved, remarks_on_bodies, remarks_on_contacts, resolution_of
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.progress import listener
from asperity.results.checkpoint import Keeper, fingerprint_of_solid
from asperity.results.dataset import attributes_of_answer, check_answer
from asperity.results.quantities import describe
from asperity.simulate import age, pressed
from asperity.surfaces import Surface

TITLE = "Law of a rough contact"

OF_LAWS = {
    "approach": ("m", "approach of the rough layer alone, from first touch"),
    "stiffness": ("Pa/m", "normal stiffness per area, instantaneous"),
    "tangential_stiffness": ("Pa/m", "tangential stiffness per area, before anything slips, mean"),
    "tangential_stiffness_y": ("Pa/m", "tangential stiffness per area along y"),
    "tangential_stiffness_x": ("Pa/m", "tangential stiffness per area along x"),
    "tangential_stiffness_soft": ("Pa/m", "tangential stiffness per area in the softest direction"),
    "tangential_stiffness_stiff": ("Pa/m", "tangential stiffness per area in the stiffest direction"),
    "softest_direction": ("deg", "softest direction of the tangential stiffness, from x towards y"),
    "conductance": ("S/m^2", "electrical conductance per area"),
    "thermal_conductance": ("W/m^2/K", "thermal conductance per area"),
    "contact_fraction": ("1", "real contact area over nominal area"),
    "mean_gap": ("m", "mean gap"),
    "hydraulic_gap_y": ("m", "hydraulic gap of a flow along y"),
    "hydraulic_gap_x": ("m", "hydraulic gap of a flow along x"),
    "largest_pressure": ("Pa", "largest contact pressure"),
}
"""Unit and meaning of the columns of a law, in their order; some have a band, ``_low`` and ``_high``."""

TANGENTIAL = tuple(name for name in OF_LAWS if name.startswith("tangential"))
_CONDUCTANCES = {"resistance": "conductance", "thermal_resistance": "thermal_conductance"}

_BY_TILE = {
    "contact_fraction": "in_contact",
    "mean_gap": "gap",
    **dict.fromkeys(("stiffness", *TANGENTIAL, *_CONDUCTANCES.values()), "punch"),
}
"""Columns with a band, and the sums over tiles that vary as they do; ``"punch"``: forces of a rigid punch."""

State = dict[str, Any]


@answers(Law)
def law(question: Law) -> xr.Dataset:
    """Answer the question of a law."""
    body, steps = question.solid, question.steps
    if steps[-1] >= body.hardness:
        expected, got = f"less than the hardness, {written(body.hardness, 'Pa')}", written(steps[-1], "Pa")
        raise InputError("pressures", expected=expected, got=got, advice="a lower last pressure")
    scan = scan_of(question.surface)
    heights, spacing = scan.in_meters()
    lattice = Lattice(heights.shape, spacing, scan.edges)
    numbers = steps.tolist(), question.ages.tolist(), question.carried, question.rtol
    asked = repr(numbers).encode() + heights.tobytes()
    if question.checkpoint is not None:
        asked += fingerprint_of_solid(body, lattice)
    keeper = Keeper(question.checkpoint, asked)
    rows: list[State] = (keeper.read() or ([],))[0]
    done = {row["pressure"] for row in rows if row["direction"] == "loading"}
    with listener(question.progress) as listening:
        # The largest comes first, so that full contact or yield is refused early.
        for lower_steps, step in reversed(list(enumerate(steps.tolist()))):
            if step in done:
                continue
            listening.stage(f"pressing with {written(step, 'Pa')}, {lower_steps} more to come")
            rows += _held(question, scan, step)
            keeper.write(rows)
    rows.sort(key=itemgetter("pressure", "time"))
    held = [Resolved(**row["seen"]) for row in rows if row["direction"] == "loading"]
    for text in (*remarks_on_bodies(scan, body), *remarks_on_contacts(scan, body, held, "rows")):
        remark(text)
    return _dataset(rows, heights).assign_attrs(attributes_of_answer(TITLE, body, lattice, scan.provenance))


def check_law(dataset: xr.Dataset) -> None:
    """`InputError` unless `law` made the dataset."""
    check_answer(dataset, TITLE, "a law", "asperity.law(solid, scan, pressures=...)")


def _held(question: Law, scan: Surface, pressure: float) -> list[State]:
    """Rows at each age of a held pressure; of the largest, each is followed by instant unloading."""
    body, ages, carried = question.solid, question.ages, question.carried
    rough, _ = scan.in_meters()
    remembers = pressure == question.steps[-1] and (body.branches or body.yields)
    lower = question.steps[-2::-1].tolist() if remembers else []
    rows: list[State] = []

    def reached(time: float, contact: Contact) -> None:
        if time not in ages or time in (row["time"] for row in rows):
            return
        if contact.contact_fraction == 1:
            got, advice = f"{written(pressure, 'Pa')}: all of it touches", "a lower last pressure"
            raise InputError("pressures", expected="less than full contact", got=got, advice=advice)
        state: State = {"direction": "loading", "time": time, "pressure": pressure}
        when = f"under {written(pressure, 'Pa')} after {written(time, 's')}"
        seen = asdict(resolution_of(contact, scan, when, time))
        rows.append(state | {"seen": seen} | _row(contact, rough, carried))
        state["direction"] = "unloading"
        rows.extend([rows[-1] | state] * bool(lower))
        for less in lower:
            contact = pressed_anew(contact, Load(less * contact.nominal_area))
            rows.append(state | {"pressure": less} | _row(contact, rough, carried))

    contact = pressed(scan, body, pressure=pressure)
    reached(0.0, contact)
    if ages[-1] > 0:
        age(contact, ages, rtol=question.rtol, progress=lambda frame: reached(frame.time, frame.contact))
    return rows


def _row(contact: Contact, rough: Field, carried: Carried | None) -> State:
    """The numbers of one contact, and sums over its tiles for the bands."""
    of_body, of_mean, force = unit_response(contact)
    gap, area, body = contact.gap, contact.nominal_area, np.isfinite(rough)
    row: State = {
        "approach": float((rough.max() - contact.heights[body] - gap[body]).mean()),
        "stiffness": 1 / (of_mean * area),
    }
    if carried is not None:
        # The law has the stiffness of the mean of the surface, `carried` that of the body.
        per_area = of_body / (of_mean * area)
        for name, value in quantities(carried, contact).items():
            if name in _CONDUCTANCES:
                row[_CONDUCTANCES[name]] = per_area / value
        if carried.poisson is not None:
            compliance = compliances(contact, carried.poisson)[1] * area
            found = tangential(compliance, carried)
            if carried.direction:
                found = {f"{name}_{carried.direction}": value for name, value in found.items()}
            else:
                found["softest_direction"] = principal(compliance)[2]
            row |= found
    row |= {name: getattr(contact, name) for name in ("contact_fraction", "mean_gap", "largest_pressure")}
    maps = {"in_contact": contact.in_contact, "load": contact.force, "punch": force}
    maps["gap"] = np.where(body, gap, 0.0)
    sums = in_tiles(np.stack([*maps.values()])).tolist()
    aspect = contact.lattice.spacing[0] / contact.lattice.spacing[1]
    # Where the body ends, no pressure is known that a flow would begin from.
    row["hydraulic_gap_y"] = hydraulic_gap(gap.T, 1 / aspect) if body.all() else math.nan
    row["hydraulic_gap_x"] = hydraulic_gap(gap, aspect) if body.all() else math.nan
    return row | {"tiles": dict(zip(maps, sums, strict=True))}


def _with_bands(rows: pd.DataFrame, rough: Field) -> pd.DataFrame:
    """Add the bands to the rows of one direction and age, by increasing pressure."""
    sums = {name: np.array([tiles[name] for tiles in rows["tiles"]]) for name in rows["tiles"].iloc[0]}
    others = {name: without_each(tiles) for name, tiles in sums.items()}
    logs = {name: np.log(np.where(part > 0, part, math.nan)) for name, part in others.items()}
    per_load = logs["load"] - np.log(without_each(in_tiles(np.isfinite(rough)[np.newaxis])))
    pressure, ends = np.log(rows.index.get_level_values("pressure")), {}
    order: Any = min(2, len(rows) - 1)
    for name in [name for name in _BY_TILE if name in rows]:
        slope = np.gradient(np.log(rows[name]), pressure, edge_order=order)[:, np.newaxis]
        without = logs[_BY_TILE[name]] - logs["load"] + (1 - slope) * per_load
        ends[name] = rows[name].to_numpy() * interval(np.exp(student(without.T, bearing(sums["load"]))))
        if _BY_TILE[name] == "punch":
            ends[name][:, rows["contact_fraction"] > CLOSED] = math.nan
    tops = in_tiles(rough[np.newaxis], np.maximum)
    scale = tops[np.isfinite(tops)].std(ddof=1) * math.sqrt(6) / math.pi
    higher = scale * (gumbel_r.ppf([[0.025], [0.975]]) - gumbel_r.median())
    ends["approach"] = rows["approach"].to_numpy() + higher
    names = {
        f"{name}_{end}": values[n] for name, values in ends.items() for n, end in enumerate(("low", "high"))
    }
    return rows.assign(**names)


def _dataset(rows: list[State], rough: Field) -> xr.Dataset:
    ends = {"": "", "_low": ", low end of the 95 % band", "_high": ", high end of the 95 % band"}
    facts = {
        f"{name}{end}": (f"{meaning}{addition}", unit)
        for (name, (unit, meaning)), (end, addition) in itertools.product(OF_LAWS.items(), ends.items())
    }
    table = pd.DataFrame(rows).set_index(["direction", "time", "pressure"]).sort_index()
    groups = table.groupby(level=["direction", "time"])
    table = pd.concat([_with_bands(group, rough) for _, group in groups])
    dataset = table[[name for name in facts if name in table]].to_xarray()
    dataset = dataset.assign_coords(direction=dataset["direction"].astype(str))
    axes = {
        "time": ("age: how long the pressure was held", "s"),
        "pressure": ("load over nominal area", "Pa"),
    }
    describe(dataset, facts | axes, {})
    return dataset
