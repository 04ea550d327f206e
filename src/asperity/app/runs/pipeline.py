"""One run: a configuration in, a history with its limit and its summary out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from asperity.aging.legs import check_slides
from asperity.aging.memory import bytes_a_site
from asperity.analysis import AgingSummary, aging_summary, observe, with_limit
from asperity.app.config import MeasuredSurface, RunConfig, to_toml
from asperity.app.runs import defaults
from asperity.app.runs.defaults import map_times
from asperity.ask.run import Contact as ContactSection
from asperity.ask.surface import SurfaceSection
from asperity.base.calls import remarks_made
from asperity.base.machine import require
from asperity.base.readable import written
from asperity.base.words import InUnits, written_with_units
from asperity.carried import check_half_space
from asperity.contact.bodies import bodies_of
from asperity.contact.remarks import remarks_on_bodies, resolution_of
from asperity.errors import ConvergenceError, InputError, PulledOff
from asperity.fits.measurements import measured_area
from asperity.lattice import Field
from asperity.prediction.plausible import remark_on_loading, remarks_on_history
from asperity.prediction.predicting import USUAL_MAPS, hold_times, map_moments, times_of_legs
from asperity.prediction.results import resolved
from asperity.progress import Progress
from asperity.protocols import Ramp
from asperity.protocols.schedule import Schedule
from asperity.results import Checkpoint
from asperity.results.tabor import add_friction
from asperity.simulate import age, pressed, relax
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.theory import ExponentialHeights, GaussianHeights
from asperity.theory.heights import HeightLaw

_REMARKED_SEAM = 3.0
"""Ratio of a step at the periodic seam to a usual one, above which a remark is made."""

_SOFT = 1e-7
"""Least hardness and shear strength, over the modulus."""

_DRAWS = {"solid": ("draws",)}
"""Keys that only a prediction uses, by section."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """The results of a run, and remarks on choices and on missing results.

    Its configuration is complete: reading it again gives the same result. Under a protocol, where the area
    follows no law of growth, there is no summary.
    """

    config: RunConfig
    dataset: xr.Dataset
    summary: AgingSummary | None
    remarks: tuple[str, ...]


def execute(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> Outcome:
    """Run the engine's verbs one after the other; `AsperityError` as these raise it."""
    solid = config.solid.build()
    if config.surface.lattice is not None:
        _require_memory(config.surface.lattice, solid, config)
    progress.stage("making the surface")
    rough = config.surface.build()
    if config.surface.lattice is None:
        _require_memory(rough.shape, solid, config)
    check_units(config, solid, rough)
    if (law := config.friction.strength) is not None:  # refuses before hours have passed, as does the next
        law.at([leg.speed for leg in config.written_out if leg.speed] or [0.0])
    bodies = bodies_of(rough, solid)  # refuses before anything is compiled
    if config.protocol:
        check_slides(config.written_out, bodies.lattice, solid)
    if config.carries is not None:
        check_half_space("carried", solid, bodies.lattice)
    config, remarks = completed(config, solid, rough)
    remarks += unused(config, "a run")
    progress.completed(config)
    for remark in remarks:
        progress.remark(remark)
    progress.stage(f"pressing {' x '.join(map(str, rough.shape))} sites")
    contact = pressed(rough, solid, **config.contact.table)
    if contact.area == 0:
        expected, advice = (
            f"one at which the solids touch, below {contact.heights.max():.6g}",
            "a smaller one, or a load",
        )
        raise InputError("separation", expected=expected, got=config.contact.separation, advice=advice)
    if config.output.instrument:
        observe(contact, **config.output.instrument)  # refuses before hours have passed
    times = recorded_times(config)
    progress.stage("aging", times=times.tolist())
    with remarks_made() as made:
        history = age(
            contact,
            times,
            protocol=config.protocol or None,
            hold=config.aging.hold,
            rtol=config.aging.rtol,
            fields_at=config.output.maps_at or (),
            progress=progress.reached,
            checkpoint=checkpoint,
            carried=config.recorded,
        )
    dataset = _observed(history.dataset, config.output.instrument)
    if law is not None and not law.ages:
        dataset = add_friction(dataset, law)
    contacts = resolved(dataset, solid, rough.filled) or (
        resolution_of(contact, rough, "at first"),
        resolution_of(history.final, rough, "at last"),
    )
    remarks += (*dict.fromkeys(made), *remarks_on_history(rough, solid, dataset, contacts))
    if config.protocol:
        return Outcome(config, dataset.assign_attrs(config=to_toml(config)), None, remarks)
    progress.stage("finding the relaxed state")
    try:
        dataset = with_limit(dataset, relax(contact, hold=config.aging.hold))
    except (InputError, ConvergenceError, PulledOff) as error:  # the history is worth keeping all the same
        remarks += (f"no relaxed state: {error}",)
    dataset = dataset.assign_attrs(config=to_toml(config))
    return Outcome(config, dataset, aging_summary(dataset, law=height_law(config.surface)), remarks)


def _require_memory(shape: Sequence[int], solid: Solid, config: RunConfig) -> None:
    """Refuse a run that needs more memory than there is."""
    maps, free = config.output.maps_at, config.surface.edges == "free"
    needed = bytes_a_site(solid, shape, USUAL_MAPS if maps is None else len(maps), free=free)
    require(needed, shape, power_of_two=config.surface.only_powers_of_two)


def height_law(surface: SurfaceSection) -> HeightLaw | None:
    """The law of the heights, if the sites are independent."""
    if surface.kind == "gaussian":
        return GaussianHeights(surface.rms)
    return ExponentialHeights(surface.rms) if surface.kind == "exponential" else None


def check_units(config: RunConfig, solid: Solid, rough: Surface) -> None:
    """Refuse numbers with units beside a surface or a solid without; and a measured area in other units."""
    si = solid.in_lengths and rough.has_lengths
    if config.output.measured is not None:
        measured_area(config.output.measured, 1.0, si=si)
    if si:
        return
    if (text := next(written_with_units(config.tables), None)) is not None:
        expected, advice = f"plain numbers for a {solid.kind}, which is defined on sites", "solid half_space"
        if solid.in_lengths:
            expected = "plain numbers, as the surface has no unit of length"
            advice = "file_unit, pixel_size and length_unit in [surface], or unit of a spectral one"
        raise InputError("quantities", expected=expected, got=repr(text.written), advice=advice)


def without_copies(config: RunConfig) -> SurfaceSection:
    """The surface without mirrored copies; `InputError` beside a load, which is that of all copies."""
    scan = config.surface.scan
    if scan is not config.surface and config.contact.load is not None:
        expected = "'reflect' beside a load, for one on mirrored copies is that of all of them"
        path, advice = ("surface", "periodic"), "periodic = 'reflect', or a pressure"
        raise InputError("periodic", expected=expected, got="'mirror'", advice=advice, path=path)
    return scan


def _odd_numbers(config: RunConfig, modulus: float | None, rough: Surface) -> tuple[str, ...]:
    """Remarks on numbers that were written without a unit and are out of proportion in SI."""
    if modulus is None or not rough.has_lengths:
        return ()
    _, spacing = rough.in_meters()
    longest = max(count * step for count, step in zip(rough.shape, spacing, strict=True))
    stresses = ("Pa", _SOFT * modulus, modulus)
    doubts: list[tuple[str, float | None, str, float, float]] = [
        ("thickness", getattr(config.solid, "thickness", None), "m", min(spacing) / 100, 1000 * longest),
        ("hardness", getattr(config.solid, "hardness", None), *stresses),
        ("shear_strength", config.friction.shear_strength, *stresses),
    ]
    doubts += [
        ("distance", getattr(leg, "distance", None), "m", min(spacing) / 1000, 1000 * longest)
        for leg in config.written_out
    ]
    return tuple(
        f"{name} {value:g} has no unit and was taken in {unit}; here it would usually be "
        f"from {written(low, unit, 3)} to {written(high, unit, 3)}"
        for name, value, unit, low, high in dict.fromkeys(doubts)
        if value is not None and not isinstance(value, InUnits) and value != 0 and not low <= value <= high
    )


def completed(config: RunConfig, solid: Solid, rough: Surface) -> tuple[RunConfig, tuple[str, ...]]:
    """Complete a configuration by a load, times and times of maps, with absolute paths; and remarks."""
    chosen = config.surface.anywhere()
    assumed = (config.solid.assumed,) if config.solid.assumed else ()
    remarks = (*remarks_on_bodies(rough, solid), *_odd_numbers(config, solid.modulus, rough), *assumed)
    contact = config.contact
    if not contact.table:
        contact, remark = _usual_contact(config, solid, rough)
        remarks += (remark,)
    if rough.has_lengths and not solid.in_lengths:
        remarks += (
            f"springs have no units: heights count as numbers of {rough.unit}, sites are 1 apart, and the "
            "load is not in N; for SI take a solid of kind half_space",
        )
    if isinstance(chosen, MeasuredSurface) and chosen.rule == "mirror":
        copies = 2**rough.heights.ndim
        remarks += (
            f"loads, areas, stiffness and resistance are those of {copies} mirrored copies of the scan; "
            "periodic = 'reflect' takes it once",
        )
    measured = isinstance(chosen, MeasuredSurface) and rough.edges == "periodic"
    if measured and (cliff := rough.describe().seam_ratio) > _REMARKED_SEAM:
        remarks += (
            f"the surface is not periodic: the step at its seam is {cliff:.2g} times a usual one; "
            "try periodic = 'reflect'",
        )
    if rough.heights.ndim == 1 and height_law(chosen) is not None:
        n = rough.heights.size
        remarks += (f"a line contact of {n} sites; for a square try shape = [{n}, {n}]",)
    match config.protocol:
        case (Ramp() as up, *_) if contact.load == 0 and config.aging.times is not None:
            end = written(up.duration, "s") if rough.has_lengths else f"{up.duration:g}"
            remarks += remark_on_loading(config.aging.times, up.duration, end)
    maps_at = config.output.maps_at
    if maps_at is None:
        maps_at = _map_times(config)
    aging = config.aging
    if aging.times is None:
        ends = dict(zip(("first", "last"), config.span, strict=True))
        aging = aging.but(**{"first": ends["first"]} if config.protocol else ends)
    completed = {
        "surface": chosen,
        "solid": config.solid.resolved(),
        "contact": contact,
        "aging": aging,
        "output": config.output.but(maps_at=maps_at),
    }
    return config.but(**completed), remarks


def unused(config: RunConfig, name: str, keys: Mapping[str, Iterable[str]] = _DRAWS) -> tuple[str, ...]:
    """Remark on the keys of a configuration, among these of each section, that a computation does not use."""
    idle = [
        f"[{section}] {key}"
        for section, unused_keys in keys.items()
        for key, value in vars(getattr(config, section)).items()
        if key in unused_keys and key in getattr(config, section).stated and value is not None
    ]
    return (f"{name} does not use {', '.join(idle)}",) if idle else ()


def _usual_contact(config: RunConfig, solid: Solid, rough: Surface) -> tuple[ContactSection, str]:
    """A load, or on a continuum a pressure, that gives about 1 % contact, and a remark on it."""
    if solid.modulus is not None:
        pressure = defaults.modest_pressure(modulus=solid.modulus, slope=rough.describe().rms_slope)
        shown = written(pressure, "Pa") if rough.has_lengths else f"{pressure:g}"
        remark = f"no load was given: took a mean pressure of {shown} = 0.005 E* x rms slope"
        return ContactSection(pressure=pressure), remark
    # The nominal rms, where there is one: surfaces of different seeds then bear the same load.
    nominal = getattr(config.surface, "rms", None)
    rms, which = (rough.describe().rms_height, ", measured") if nominal is None else (nominal, "")
    if (springs := solid.springs) is None:
        raise InputError("load", expected="a load or a separation", got="none", cure={"load": 1})
    sites = int(np.isfinite(rough.heights).sum())
    load = defaults.modest_load(k0=springs.k0, k1=springs.k1, rms=rms, sites=sites)
    remark = f"no load was given: took {load:g} = 0.005 (k0 + k1) x rms height x sites{which}"
    return ContactSection(load=load), remark


def recorded_times(config: RunConfig) -> Field:
    """Times to record, without 0; under a protocol, spread over each leg."""
    aging, (first, last) = config.aging, config.span
    if aging.times is not None:
        return np.asarray(aging.times, dtype=np.float64)
    if not config.protocol:
        return hold_times(first=first, last=last, per_decade=aging.per_decade)
    return times_of_legs(config.written_out, first=first, per_decade=aging.per_decade)


def _map_times(config: RunConfig) -> list[float]:
    if not config.protocol:
        return list(map_times(recorded_times(config).tolist()))
    return map_moments(Schedule.of(config.written_out, np.empty(0)).switches)


def _observed(dataset: xr.Dataset, instrument: dict[str, Any]) -> xr.Dataset:
    if not instrument:
        return dataset
    maps = (dataset.isel(field_time=number) for number in range(dataset.sizes["field_time"]))
    unit = dataset["contact_area"].attrs["units"] if "contact_area" in dataset else "sites"
    described = {"long_name": "contact area that the instrument sees", "units": unit}
    areas = [observe(one, **instrument).area for one in maps]
    return dataset.assign(area_observed=("field_time", areas, described))
