"""From a material, a scan and a load to the growth of the real contact: the prediction."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
import xarray as xr

from asperity.aging.memory import bytes_a_site
from asperity.analysis.bands import OfScan, draws_of_solid, effective_load, with_bands
from asperity.analysis.observation import observe
from asperity.ask.prediction import Predict
from asperity.ask.question import answers
from asperity.ask.surface import scan_of
from asperity.base.calls import remarks_made
from asperity.base.machine import require
from asperity.base.readable import length_factor, written
from asperity.carried.response import stiffness_of_contact
from asperity.contact.remarks import remarks_on_bodies
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.prediction.plausible import remarks_on_history, remarks_on_prediction
from asperity.prediction.results import Band, Prediction, growth_of, resolved
from asperity.progress import Progress, listener
from asperity.protocols import Hold, Leg, Ramp
from asperity.protocols.schedule import Schedule
from asperity.relaxation import Material
from asperity.relaxation import material as material_of
from asperity.relaxation.materials import relaxing_of
from asperity.results import History
from asperity.results.tabor import add_friction
from asperity.simulate import age, pressed
from asperity.solids import Solid
from asperity.surfaces import Surface

USUAL_MAPS = 6
LEAST_TIMES = 5

_IN_RAMP = 12
"""Evenly spread times recorded in a ramp."""

_SINCE = 1e-3
"""First recorded time after a change of the load, over the shortest hold; without a table."""

_FACTORS = (1, 2, 4, 8, 16)
"""Shortest waves of a resolution study, over two pixels, the shortest waves of a scan."""

_FEWEST = 8
"""Fewest waves along the shorter side, in a resolution study."""


@answers(Predict)
def predict(question: Predict) -> Prediction:
    """Answer the question of a prediction."""
    material = question.material
    with listener(question.progress) as listening:
        if not isinstance(material, Material):
            listening.stage("reading the material")
            material = material_of(material)
        if material.solid.adhesion is not None:
            expected, advice = "a solid without adhesion", "asperity run"
            raise InputError("material", expected=expected, got="one with adhesion", advice=advice)
        times = _times_of(question, material)
        listening.stage("reading the scan")
        scan = scan_of(question.surface)
        scan.in_meters()
        if not material.solid.half_space:
            raise no_half_space("material", material.solid.kind)
        return _predicted(question, material, scan, times, listening)


def _times_of(question: Predict, material: Material) -> Field:
    """Times to record: those listed, some of each leg, or by default those of the material."""
    first, last, ramp = (cast(float | None, one) for one in (question.first, question.last, question.ramp))
    begin, end = material.span
    if question.times is not None:
        times = np.array(question.times, dtype=np.float64)
        times = times[times > 0]
        _check_known(material, times=times)
        name, advice = "times", "more times"
    elif question.legs:
        shortest = min((leg.duration for leg in question.legs if leg.rests), default=1.0) * _SINCE
        start = first or begin or shortest
        _check_known(material, first=start, protocol=math.fsum(leg.duration for leg in question.legs))
        return times_of_legs(question.legs, first=start, per_decade=question.per_decade)
    else:
        latest = end if material.fit is None else material.fit.data.span[1]
        for name, time, usual in (("first", first, begin), ("last", last, latest)):
            if time is None and usual in (0, math.inf):
                expected, cure = "a time, as there is no table", {"first": "1 ms", "last": "10 days"}
                raise InputError(name, expected=expected, got="none", cure=cure)
        stop = last or latest
        _check_ramp(ramp or 0.0, stop)
        start = first or max(begin, ramp or 0.0)
        if not start < stop:
            raise InputError("last", expected=f"a time after the first, {start:.4g} s", got=f"{stop:.4g} s")
        _check_known(material, first=start, last=stop)
        _check_span("last", start, stop)
        times = hold_times(first=start, last=stop, per_decade=question.per_decade)
        name, advice = "per_decade", "a later last or more per_decade"
    if question.legs:
        return times
    if times.size < LEAST_TIMES:
        expected = f"{LEAST_TIMES} times or more after 0"
        raise InputError(name, expected=expected, got=f"{times.size}", advice=advice)
    _check_ramp(ramp or 0.0, times[-1])
    _check_span("last" if question.times is None else "times", times[0], times[-1])
    return times


def _predicted(
    question: Predict, material: Material, scan: Surface, times: Field, progress: Progress
) -> Prediction:
    """Press a scan, let the contact age, and add the bands."""
    legs, held, carried, rtol = question.legs, question.held, question.carried, question.rtol
    ramp, strength = cast(float, question.ramp or 0.0), cast(float | None, question.shear_strength)
    solid = material.solid
    instrument: dict[str, Any] = {**(question.instrument or {})}
    maps = map_moments([times[0], *Schedule.of(legs, times).switches[1:]] if legs else times)
    require(bytes_a_site(solid, scan.shape, len(maps), free=scan.edges == "free", held=True), scan.shape)
    progress.stage(f"pressing {' x '.join(map(str, scan.shape))} sites")
    # A ramp begins at load 0, where the highest site just touches.
    at_first: dict[str, Any] = {"load": 0.0} if ramp else {**held}
    protocol = legs or ([Ramp(ramp, **held), Hold(float(times[-1]) - ramp)] if ramp else None)

    def followed(surface: Surface, solid: Solid, at: Field | list[float], **how: Any) -> History:
        return age(pressed(surface, solid, **at_first), at, protocol=protocol, rtol=rtol, **how)

    def drawn(other: Solid, stage: str) -> xr.Dataset:
        progress.stage(stage, times=times.tolist())
        return followed(scan, other, times, carried=carried, progress=progress.reached).dataset

    try:
        contact = pressed(scan, solid, **at_first)
        if instrument:
            observe(contact, **instrument)  # refuses before minutes have passed
        progress.stage("aging", times=times.tolist())
        how: dict[str, Any] = {"rtol": rtol, "progress": progress.reached, "checkpoint": question.checkpoint}
        with remarks_made() as made:
            dataset = age(contact, times, protocol=protocol, fields_at=maps, carried=carried, **how).dataset
    except InputError as error:
        raise _of_pressure(error, held, solid) from None
    if strength is not None:
        dataset = add_friction(dataset, strength)
    if solid.separable and (load := effective_load(dataset, relaxing_of(solid))) is not None:
        attributes = {"long_name": "load on an elastic half-space with the same contact", "units": "N"}
        dataset["effective_load"] = "time", load, attributes
    progress.stage("bootstrapping the band")
    of_solid = draws_of_solid(dataset, material.spread, solid, drawn)
    of_scan = OfScan.of(dataset, contact)
    dataset = with_bands(dataset, of_scan, of_solid)
    if ramp:  # switches between legs were recorded, too
        rows = np.append(0, np.flatnonzero(np.isin(dataset["time"], times)))
        dataset, of_scan = dataset.isel(time=rows), of_scan.at(rows)
        of_solid = {name: factors[:, rows] for name, factors in of_solid.items()}
    bands: tuple[Band, ...] = ()
    if question.resolution_study:
        span = times[[0, -1]].tolist()
        bands = bands_of(scan, lambda part, at: followed(part, solid, at), span, progress)
    facts = {"shear_strength": strength, "pressed_by": next(iter(held)), "rtol": rtol, "ramp": ramp}
    settings = {**material.facts, **facts, **({"draws": len(material.draws)} if material.draws else {})}
    dataset = dataset.drop_vars("u0", errors="ignore").assign_attrs(prediction=json.dumps(settings))
    looked_at = (dataset.isel(field_time=n) for n in range(dataset.sizes["field_time"] if instrument else 0))
    prediction = Prediction(
        dataset,
        material,
        None if legs else growth_of(dataset, of_scan, of_solid),
        resolved(dataset, solid, scan.filled),
        shear_strength=strength,
        observed=tuple(observe(fields, **instrument) for fields in looked_at),
        bands=bands,
    )
    on_contact = remarks_on_history(scan, solid, dataset, prediction.resolved)
    remarks = *dict.fromkeys(made), *remarks_on_bodies(scan, solid), *on_contact
    return replace(prediction, remarks=(*remarks, *remarks_on_prediction(prediction)))


def _of_pressure(error: InputError, held: Mapping[str, float], solid: Solid) -> InputError:
    """The error about a load, as one about the pressure if that was given and exceeds the hardness."""
    if error.name != "load" or "pressure" not in held or not solid.yields:
        return error
    expected = f"clearly less than the hardness, {written(solid.hardness, 'Pa')}"
    got, advice = written(held["pressure"], "Pa"), "a lower pressure, or a greater hardness"
    return InputError("pressure", expected=expected, got=got, advice=advice)


def hold_times(*, first: float, last: float, per_decade: int) -> Field:
    """Logarithmically spaced times from ``first`` to ``last``, 0 < first < last, both included."""
    steps = max(1, round(math.log10(last / first) * per_decade))
    return np.geomspace(first, last, steps + 1)


def times_of_legs(legs: Sequence[Leg], *, first: float, per_decade: int) -> Field:
    """Times within the ramps of a protocol, and from ``first`` on within its holds."""
    schedule = Schedule.of(legs, np.empty(0))
    times = list(schedule.switches[1:])
    for leg, begun in zip(schedule.legs, schedule.switches, strict=False):
        if leg.target and leg.duration:
            times += (begun + leg.duration * np.arange(1, _IN_RAMP) / _IN_RAMP).tolist()
        elif leg.rests and leg.duration > first:
            since = hold_times(first=first, last=leg.duration, per_decade=per_decade)
            times += (begun + since[:-1]).tolist()
    return np.unique(times)


def map_moments(times: Sequence[float] | Field) -> list[float]:
    """Times of a few maps among increasing times: the first, the last, and others evenly spread."""
    moments = np.unique(times)
    chosen = np.linspace(0, moments.size - 1, USUAL_MAPS).round().astype(int)
    return [float(moment) for moment in np.unique(moments[chosen])]


def _check_known(material: Material, **times: float | Field) -> None:
    """Refuse times beyond the data of the material."""
    begin, end = material.span
    for name, time in ((name, time) for name, some in times.items() for time in np.atleast_1d(some)):
        if not begin * (1 - 1e-9) <= time <= end * (1 + 1e-9):
            of_data, of_table = ("the data span", "model"), ("the table spans", "plateau")
            source, word = of_data if material.fit is None else of_table
            facts: dict[str, Any] = {"cure": {"extrapolate": word}}
            if word == "plateau" and time <= end:
                facts = {"advice": "a table of more decades"}
            expected = f"a time that {source}, {begin:.3g} s to {end:.3g} s"
            raise InputError(name, expected=expected, got=f"{time:.4g} s", **facts)


def _check_ramp(ramp: float, last: float) -> None:
    """Refuse a ramp that ends after the last time."""
    if ramp >= last:
        expected = f"less than the last time, {last:.4g} s"
        raise InputError("ramp", expected=expected, got=f"{ramp:.4g} s", cure={"last": f"{10 * ramp:g} s"})


def _check_span(name: str, first: float, last: float) -> None:
    """Refuse times that span less than a decade, too little for growth per decade."""
    if last < 10 * first * (1 - 1e-9):
        expected = "times that span a decade or more"
        facts: dict[str, Any] = {"cure": {"last": f"{10 * first:g} s"}}
        if not name.endswith("last"):
            facts = {"advice": "later times"}
        raise InputError(name, expected=expected, got=f"{first:.4g} s to {last:.4g} s", **facts)


def no_half_space(name: str, kind: str) -> InputError:
    """The error for a solid that is no half-space."""
    advice = "asperity run, or asperity.press and asperity.age, which follow it without a band"
    return InputError(name, expected="a relaxation table or a half_space", got=kind, advice=advice)


def bands_of(
    scan: Surface, followed: Callable[[Surface, list[float]], History], span: list[float], progress: Progress
) -> tuple[Band, ...]:
    """Repeat a prediction with ever fewer short waves, at its first and last time (s)."""
    sides = scan.pixel_size or ()
    meter = length_factor(str(scan.length_unit), "m")
    longest = min(n * side for n, side in zip(scan.shape, sides, strict=True)) / _FEWEST
    bands = []
    for factor in _FACTORS:
        shortest = 2 * max(sides) * factor
        if factor > 1 and shortest > longest:
            break
        progress.stage(f"waves from {factor * 2} pixels on")
        history = followed(scan if factor == 1 else scan.band(shortest=shortest), span)
        first, last = history.dataset["time"].values == span[0], history.final
        area, force = last.contact_area_corrected, last.load
        growth = area / float(history.dataset["contact_area_corrected"][first][0])
        bands.append(Band(shortest * meter, area, force / area, growth, stiffness_of_contact(last)))
    return tuple(bands)
