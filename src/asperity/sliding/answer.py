"""Friction and contact area against speed: the answer to `asperity.steady_sliding`."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from asperity.ask.question import answers
from asperity.ask.sliding import SteadySliding
from asperity.ask.strength import ShearStrength
from asperity.base import checks, units
from asperity.base.calls import remark
from asperity.base.machine import require
from asperity.base.readable import written
from asperity.contact.bodies import Bodies, bodies_of, control_by
from asperity.contact.remarks import remarks_on_bodies
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Progress, listener
from asperity.relaxation import Material
from asperity.relaxation import material as material_of
from asperity.results.dataset import attributes_of_answer, check_answer, coordinates_of
from asperity.results.quantities import units_of
from asperity.sliding.bands import draws_of_solid, with_bands
from asperity.sliding.problem import State
from asperity.sliding.profile import Profile, Row
from asperity.sliding.solver import solved
from asperity.solids import Solid
from asperity.surfaces import Surface, read

TITLE = "Steady sliding"

COLUMNS = {
    "hysteresis_friction_coefficient": ("1", "hysteresis friction: dissipation over speed and load"),
    "friction_coefficient": ("1", "hysteresis, and shear strength times real contact area, over load"),
    "contact_area": ("area", "real contact area"),
    "contact_area_corrected": ("area", "real contact area, corrected for pixel rims"),
    "contact_fraction": ("1", "real contact area over nominal area"),
    "mean_gap": ("length", "mean gap"),
    "largest_pressure": ("pressure", "largest contact pressure"),
    "last_octave": ("1", "share of the hysteresis that is lost without waves shorter than four sites"),
    "slope_friction_coefficient": ("1", "the hysteresis as mean of pressure times slope of the profile"),
    "residual": ("1", "largest force off contact over the mean contact force"),
    "products": ("1", "products of forces with the compliance"),
}
"""Dimension or unit, and meaning of the columns of steady sliding, in their order."""

_MOST_OF_LAST_OCTAVE = 0.1
_BYTES = 400  # for each site, measured at 1024 x 1024 sites


@answers(SteadySliding)
def steady_sliding(question: SteadySliding) -> xr.Dataset:
    """Answer the question of steady sliding."""
    material = question.solid if isinstance(question.solid, Material) else material_of(question.solid)
    surface = read(question.surface) if isinstance(question.surface, str | Path) else question.surface
    scan = surface.scan if isinstance(surface, Surface) else surface
    bodies = bodies_of(scan, _checked(material.solid))
    law = question.shear_strength
    of_law = vars(law) if isinstance(law, ShearStrength) else {}
    given = {"speeds": question.speeds}, of_law, dict(bodies.solid.parameters)
    units.check_units(*given, si=bodies.si, dimensions=bodies.lattice.dimension, name="apparatus")
    profile, speeds = Profile.of(bodies, question.direction, _load_of(question, bodies)), question.each_speed
    require(_BYTES + 16 * profile.branches, profile.lattice.shape)
    if not question.beyond_table:
        _check_known(material, profile, speeds)
    maps: dict[float, Field] = {}
    tiles: list[dict[str, Field]] = []
    coarse = profile.without_last_octave

    def whole(speed: float, state: State) -> Row:
        if np.isclose(speed, question.fields_at or [], rtol=1e-6, atol=0).any():
            maps[speed] = profile.pressure(state)
        if bodies.lattice.dimension == 2:
            tiles.append(profile.tiles(state))
        share = 0.0
        if coarse is not None and state.friction:
            share = 1 - solved(coarse.at(speed), state).friction / state.friction
        return profile.row(state) | {"last_octave": share}

    with listener(question.progress) as listening:
        table = _curve(profile, speeds, whole, listening)

        def drawn(solid: Solid, stage: str) -> dict[str, Field]:
            other = replace(profile, bodies=replace(bodies, solid=solid))
            return _curve(other, speeds, lambda _, state: other.row(state), listening, f", {stage}")

        dataset = _dataset(table, maps, profile, question)
        if tiles:
            most, least = profile.waves[0] * speeds[-1], profile.waves[1] * speeds[0]
            of_solid = draws_of_solid(material, table, (float(least), float(most)), drawn)
            dataset = with_bands(dataset, tiles, of_solid)
    on_bodies = remarks_on_bodies(scan, bodies.solid) if isinstance(scan, Surface) else ()
    for text in (*on_bodies, *(_remarks(dataset) if bodies.solid.in_lengths else ())):
        remark(text)
    return dataset.assign_attrs(material=json.dumps(dict(material.facts)))


def _curve(
    profile: Profile,
    speeds: Field,
    row_of: Callable[[float, State], Row],
    listening: Progress,
    stage: str = "",
) -> dict[str, Field]:
    """Numbers of the states at all speeds, each started from the one before."""
    state, rows = None, []
    for number, speed in enumerate(speeds.tolist(), 1):
        at = written(speed, "m/s") if profile.bodies.si else f"{speed:g}"
        listening.stage(f"sliding at {at}, speed {number} of {speeds.size}{stage}")
        state = solved(profile.at(speed), state)
        rows.append(row_of(speed, state))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def check_sliding(dataset: xr.Dataset) -> None:
    """`InputError` unless `steady_sliding` made the dataset."""
    advice = "asperity.steady_sliding(solid, scan, speeds=..., pressure=...)"
    check_answer(dataset, TITLE, "steady sliding", advice)


def _checked(solid: Solid) -> Solid:
    """Refuse a solid whose response to a wave is not linear."""
    laws = {
        "adhesion": solid.adhesion,
        "hardness": solid.hardness if solid.yields else None,
        "creep": solid.creep,
    }
    for name, law in laws.items():
        if law is not None:
            expected = "none for steady sliding, whose solid responds linearly"
            got = f"{law:g}" if isinstance(law, float) else type(law).__name__
            advice, path = "a slide in time, which is a leg of a history", ("solid", name)
            raise InputError(name, expected=expected, got=got, advice=advice, path=path)
    return solid


def _load_of(question: SteadySliding, bodies: Bodies) -> float:
    """The normal load; `InputError` unless it presses."""
    name = "load" if question.pressure is None else "pressure"
    value = getattr(question, name)
    if not (load := control_by(bodies, name, value).value) > 0:
        raise InputError(name, expected="more than 0", got=checks.shown(value), advice=f"{name}=1.0")
    return float(load)


def _check_known(material: Material, profile: Profile, speeds: Field) -> None:
    """Refuse speeds at which waves oscillate faster or slower than the data of a material."""
    begin, end = material.span
    shortest, longest = profile.waves
    least, most = (1 / (end * longest), 1 / (begin * shortest) if begin else math.inf)
    for speed in speeds.tolist():
        if not least * (1 - 1e-9) <= speed <= most * (1 + 1e-9):
            known = f"{written(least, 'm/s')} to {written(most, 'm/s')}"
            if least > most:
                known = "none, as the scan has more decades of waves than the table has of times"
            expected = f"speeds whose frequencies the table has, {known}"
            cure: dict[str, Any] = {"beyond_table": True}
            raise InputError("speeds", expected=expected, got=written(speed, "m/s"), cure=cure)


def _dataset(
    table: dict[str, Field], maps: dict[float, Field], profile: Profile, question: SteadySliding
) -> xr.Dataset:
    bodies, law, speeds = profile.bodies, question.shear_strength, question.each_speed
    if isinstance(law, ShearStrength):
        area = table.get("contact_area_corrected", table["contact_area"])
        adhered = law.at(speeds, law.settled(speeds)) * area / profile.load
        table["friction_coefficient"] = table["hysteresis_friction_coefficient"] + adhered
    unit = {"place / time": "1", **units_of(bodies), "1": "1"}
    unit.setdefault("area", "sites")
    dataset = xr.Dataset(coords={"speed": speeds})
    dataset["speed"].attrs.update(long_name="sliding speed", units=unit["place / time"])
    for name, (dimension, meaning) in COLUMNS.items():
        if name in table:
            facts = {"long_name": meaning, "units": unit[dimension]}
            dataset[name] = "speed", table[name], facts
    if maps:
        places = coordinates_of(bodies)
        dataset = dataset.assign_coords({"field_speed": list(maps), **places})
        facts = {"long_name": "contact pressure", "units": unit["pressure"]}
        dataset["pressure"] = ("field_speed", *places), np.stack([*maps.values()]), facts
    return dataset.assign_attrs(
        attributes_of_answer(TITLE, bodies.solid, bodies.lattice, bodies.surface),
        load=profile.load,
        nominal_area=bodies.nominal_area,
        direction=json.dumps(question.direction),
    )


def _remarks(dataset: xr.Dataset) -> Iterator[str]:
    """Remarks on friction that the shortest waves of the scan decide."""
    share, friction = dataset["last_octave"].values, dataset["hysteresis_friction_coefficient"].values
    if not (wrong := share > _MOST_OF_LAST_OCTAVE).any():
        return
    at = int(np.argmax(np.where(wrong, friction, -1.0)))
    speed, unit = float(dataset["speed"][at]), str(dataset["speed"].attrs["units"])
    when = written(speed, unit) if unit == "m/s" else f"{speed:g}"
    more = f"; likewise at {wrong.sum() - 1} other speeds" if wrong.sum() > 1 else ""
    yield (
        f"{100 * share[at]:.0f} % of the friction at {when} comes from the last octave of the scan, waves "
        f"shorter than four pixels: a finer scan would change it{more}"
    )
