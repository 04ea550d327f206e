"""One run: a configuration in, a history with its limit and its summary out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.aging.legs import check_slides
from asperity.aging.memory import bytes_a_site
from asperity.analysis import AgingSummary, aging_summary, contact_maps, observe, with_limit
from asperity.app.config import MeasuredSurface, RunConfig, to_toml
from asperity.app.runs import defaults
from asperity.app.runs.defaults import map_times
from asperity.app.runs.outcome import Outcome, table_of
from asperity.app.runs.words import run_rows
from asperity.ask.run import Contact as ContactSection
from asperity.ask.surface import SurfaceSection
from asperity.base.calls import remark, remarks_made
from asperity.base.machine import require
from asperity.base.readable import written
from asperity.base.rows import Row
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
from asperity.results.quantities import RUN, select
from asperity.results.tabor import add_friction
from asperity.simulate import age, pressed, relax
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.theory import ExponentialHeights, GaussianHeights
from asperity.theory.heights import HeightLaw

if TYPE_CHECKING:
    from asperity.figures import Drawing

_REMARKED_SEAM = 3.0
"""Ratio of a step at the periodic seam to a usual one, above which a remark is made."""

_MOST_MAPS = 24
"""Maps that one figure shows."""

_FITTED = {"fit_a": "a", "fit_q": "q", "fit_t0": "t0", "fit_C": "(a - 1) q"}
"""Numbers of the saturation law, and how they are named."""

_SOFT = 1e-7
"""Least hardness and shear strength, over the modulus."""


@dataclass(frozen=True, eq=False)
class History(Outcome):
    """A history; under a protocol, where the area follows no law of growth, without a summary."""

    summary: AgingSummary | None = None

    def numbers(self) -> dict[str, tuple[tuple[()], float, dict[str, str]]]:
        """Sites, what is held, ends of the area, the relaxed state, and the fit of the saturation law."""
        dataset, fit = self.dataset, None if self.summary is None else self.summary.fit
        attrs = dataset.attrs
        units = {str(name): str(one.attrs.get("units", "")) for name, one in dataset.variables.items()}
        named = {name: str(dataset[name].attrs["long_name"]) for name in select("series") if name in dataset}
        found = {
            "sites": (attrs["sites"], "sites of the lattice", "sites"),
            "held": (attrs[f"held_{attrs['held']}"], "what is held at first", units[attrs["held"]]),
            "initial_area": (dataset["area"][0], f"{named['area']}, at time 0", units["area"]),
            "final_area": (dataset["area"][-1], f"{named['area']}, at the last time", units["area"]),
            "worst_residual": (dataset["residual"].max(), "largest residual of all entries", "1"),
        }
        for name in ("area", "load", "separation", "energy", "residual"):
            relaxed = attrs.get(f"relaxed_{name}", np.nan)
            found[f"relaxed_{name}"] = relaxed, f"{named[name]}, relaxed", units[name]
        for name, meaning in _FITTED.items() if fit is not None else ():
            unit, of_law = units["time"] if name == "fit_t0" else "1", f"{meaning} of the saturation law"
            value, error = (getattr(fit, name.removeprefix("fit_") + end) for end in ("", "_stderr"))
            found[name] = value, of_law, unit
            found[f"{name}_uncertainty"] = error, f"{of_law}, standard error of the fit", unit
        if fit is not None:
            found["fit_misfit"] = fit.rms_residual, "rms misfit of the saturation law", "1"
        return {
            name: ((), float(value), {"long_name": meaning, "units": unit})
            for name, (value, meaning, unit) in found.items()
            if np.isfinite(value)
        }

    def rows(self) -> list[Row]:
        """Rows on surface, solid and history."""
        return run_rows(self.config, self.dataset, self.summary)

    def tables(self) -> dict[str, pd.DataFrame]:
        """The series, and the patches of the maps."""
        dataset = self.dataset
        if dataset["load"][0] > 0:  # else the first area is that of first touch, and no measure of growth
            dataset = dataset.assign(area_ratio=(dataset["area"] / dataset["area"][0]).drop_attrs(deep=False))
        names = [name for name in select("series", "coordinate", table=RUN) if name in dataset.variables]
        if "area_ratio" in dataset:
            names.insert(names.index("area") + 1, "area_ratio")
        aging = table_of({name: dataset[name] for name in names})
        return {"aging": aging} | ({"patches": _patch_table(dataset)} if "patches" in dataset else {})

    def drawings(self) -> dict[str, Callable[[], Drawing]]:
        """History, sliding, carried quantities, maps and patches, as far as there are."""
        from asperity import figures

        dataset, summary, measured = self.dataset, self.summary, self.config.output.measured
        drawn: dict[str, Callable[[], Drawing]] = {}
        if summary is None:
            drawn["history"] = lambda: figures.history_figure(dataset, measured)
        elif summary.time.size:
            drawn["aging"] = lambda: figures.aging_curve(dataset, summary, measured)
        if "displacement" in dataset:
            drawn["sliding"] = lambda: figures.sliding_figure(dataset)
        if "normal_stiffness" in dataset and dataset.sizes["time"] > 1:
            drawn["carried"] = lambda: figures.carried_figure(dataset)
        if maps := dataset.sizes.get("field_time", 0):
            shown = dataset
            if maps > _MOST_MAPS:
                shown = dataset.isel(
                    field_time=[n * (maps - 1) // (_MOST_MAPS - 1) for n in range(_MOST_MAPS)]
                )
                remark(f"contacts shows {_MOST_MAPS} of {maps} maps; history.zarr holds all")
            drawn["contacts"] = lambda: figures.contact_figure(contact_maps(shown))
        if maps > 1:
            drawn["patches"] = lambda: figures.patch_figure(dataset)
        return drawn


def _patch_table(dataset: xr.Dataset) -> pd.DataFrame:
    columns = {"time": dataset["field_time"]}
    for name in select("map", table=RUN):
        if name in dataset and "quantile" in dataset[name].dims:
            for share in dataset["quantile"].values.tolist():
                columns[f"{name}_{100 * share:g}_percent"] = dataset[name].sel(quantile=share)
        elif name in dataset:
            columns[name] = dataset[name]
    return table_of(columns)


def execute(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> History:
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
    progress.completed(config)
    for text in remarks:
        progress.remark(text)
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
        return History(config, dataset.assign_attrs(config=to_toml(config)), remarks)
    progress.stage("finding the relaxed state")
    try:
        dataset = with_limit(dataset, relax(contact, hold=config.aging.hold))
    except (InputError, ConvergenceError, PulledOff) as error:  # the history is worth keeping all the same
        remarks += (f"no relaxed state: {error}",)
    dataset = dataset.assign_attrs(config=to_toml(config))
    return History(config, dataset, remarks, aging_summary(dataset, law=height_law(config.surface)))


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
    """Complete a configuration by a load, times and times of maps, without what is not used; and remarks."""
    chosen = config.surface
    remarks = (*remarks_on_bodies(rough, solid), *_odd_numbers(config, solid.modulus, rough))
    remarks += (config.solid.assumed,) * bool(config.solid.assumed)
    contact = config.contact
    if not contact.table and "contact" not in config.question.unused:
        contact, said = _usual_contact(config, solid, rough)
        remarks += (said,)
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
    output, aging = config.output, config.aging
    if output.maps_at is None:
        output = output.but(maps_at=_map_times(config))
    if aging.times is None:
        ends = dict(zip(("first", "last"), config.span, strict=True))
        aging = aging.but(**{"first": ends["first"]} if config.protocol else ends)
    return config.but(contact=contact, aging=aging, output=output).used, (*remarks, *config.remarks)


def _usual_contact(config: RunConfig, solid: Solid, rough: Surface) -> tuple[ContactSection, str]:
    """A load, or on a continuum a pressure, that gives about 1 % contact, and a remark on it."""
    if solid.modulus is not None:
        pressure = defaults.modest_pressure(modulus=solid.modulus, slope=rough.describe().rms_slope)
        shown = written(pressure, "Pa") if rough.has_lengths else f"{pressure:g}"
        said = f"no load was given: took a mean pressure of {shown} = 0.005 E* x rms slope"
        return ContactSection(pressure=pressure), said
    # The nominal rms, where there is one: surfaces of different seeds then bear the same load.
    nominal = getattr(config.surface, "rms", None)
    rms, which = (rough.describe().rms_height, ", measured") if nominal is None else (nominal, "")
    if (springs := solid.springs) is None:
        raise InputError("load", expected="a load or a separation", got="none", cure={"load": 1})
    sites = int(np.isfinite(rough.heights).sum())
    load = defaults.modest_load(k0=springs.k0, k1=springs.k1, rms=rms, sites=sites)
    said = f"no load was given: took {load:g} = 0.005 (k0 + k1) x rms height x sites{which}"
    return ContactSection(load=load), said


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
