"""Remarks on implausible contacts of continua, and on their limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from asperity.analysis.maps import loaded, on_the_surface
from asperity.analysis.prediction import Prediction, Resolved, resolved
from asperity.analysis.scan import written
from asperity.base.words import counted
from asperity.lattice import Field
from asperity.relaxation.materials import relaxing_of
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.doubts import load_on_filled
from asperity.theory import persson_area

# Contact area over Persson's above which a remark is made. Random surfaces have 0.7 to 2.5, most with patches
# of single pixels; offsets of lines of twice the rms height have 3 and more.
_BEYOND = 3.0

_WAVES, _NOISE = 1e-3, 0.05
"""Largest misfits of a table, in waves or as noise, without a remark."""

_STILL = 1e-9  # part of the largest load by which one that stays may fall by rounding


def remarks_on_contact(
    rough: Surface, solid: Solid, dataset: xr.Dataset, maps: tuple[Resolved, ...] | None = None
) -> tuple[str, ...]:
    """Remarks on a history, in numbers; `maps` are those of `resolved`, if known."""
    on_filled: tuple[str, ...] = ()
    if rough.filled is not None and "field_time" in dataset.dims:
        forces = on_the_surface(dataset)["pressure" if "pressure" in dataset else "force"]
        on_filled = load_on_filled(rough.filled, np.asarray(forces))
    in_lengths = solid.in_lengths and rough.has_lengths and rough.heights.ndim == 2
    limits = _limits(solid, dataset, maps) if in_lengths else ()
    return (*on_filled, *_beyond_theory(rough, solid, dataset), *limits)


def _beyond_theory(rough: Surface, solid: Solid, dataset: xr.Dataset) -> Iterator[str]:
    """Remark on a contact many times that of random heights, once the largest load is on."""
    load, at = np.asarray(dataset["load"]), _loaded(dataset["load"])
    elastic = solid.half_space and solid.separable and not solid.yields
    measured = "kind" not in rough.provenance and rough.heights.ndim == 2 and dataset.attrs.get("si")
    if not (elastic and measured and load[at] > 0 and (slope := rough.describe().rms_slope) > 0):
        return
    _, spacing = rough.in_meters()
    nominal, series = dataset.attrs["sites"] * math.prod(spacing), relaxing_of(solid)
    effective = series.effective_load(np.asarray(dataset["time"])[: at + 1], load[: at + 1])[-1]
    expected = float(persson_area(effective / nominal, modulus=series.modulus, slope=slope))
    fraction = float(dataset["contact_area_corrected"][at]) / nominal
    if fraction <= _BEYOND * expected:
        return
    yield (
        f"{100 * fraction:.2g} % of the surface touches under the full load; random heights of its rms slope "
        f"would have {100 * expected:.2g} % (Persson's theory): a bow, offsets of lines or spikes bear it; "
        "try tilt = 'quadratic' (--tilt quadratic), lines = 'median' (--lines median), despike (--despike)"
    )


def _loaded(load: xr.DataArray) -> int:
    """Number of the first time at which the largest load is on."""
    return int(np.argmax(load.values >= (1 - _STILL) * load.values.max()))


def _limits(solid: Solid, dataset: xr.Dataset, maps: tuple[Resolved, ...] | None) -> Iterator[str]:
    """Remarks on the limits of a contact of a continuum under a surface with units."""
    load, fraction = (np.asarray(dataset[name]) for name in ("load", "contact_fraction"))
    pressed = _loaded(dataset["load"])
    pressure = float(dataset["mean_contact_pressure"][pressed])
    strain = pressure / float(dataset.attrs["modulus"])
    if maps is None:
        maps = resolved(dataset) if "in_contact" in dataset else ()
    if maps:
        stays = load[-1] >= (1 - _STILL) * load.max()  # else patches are lost
        at = loaded(dataset)
        when = "when the load is on" if at else "at first"
        yield from _on_patches(maps[at], maps[-1], when, may_merge=stays and fraction[-1] <= 0.5)
    if strain > 0.05 and not solid.yields:
        share = f"{100 * strain:.2g} % of E*" if strain < 1 else f"{strain:.3g} times E*"
        when = "at the largest load" if pressed else "at first"
        yield (
            f"the mean contact pressure is {written(pressure, 'Pa')} {when}, {share}: "
            "real asperities would yield, and these do not; set a hardness"
        )
    if (most := float(fraction.max())) > 0.5:
        yield (
            f"{100 * most:.0f} % of the surface touches {'at last' if fraction[-1] == most else 'at most'}: "
            "on a larger surface longer waves would keep the bodies further apart"
        )


def _on_patches(first: Resolved, last: Resolved, when: str, *, may_merge: bool) -> Iterator[str]:
    """Remarks on the resolution of the first loaded map, and on merging patches."""
    if first.in_small > 0.2:
        yield (
            f"{100 * first.in_small:.0f} % of the area {when} lies in patches of fewer than 10 pixels: "
            "the scan does not resolve them, and a finer one would change the area"
        )
    if first.rim > 0.2:
        part = f"{100 * first.rim:.0f} % of the counted area {when}"
        yield f"the correction of the rim removes {part}: patches are few pixels wide"
    if 0 < first.patches < 30:
        many = counted(first.patches, "patch", "patches")
        yield f"{many} {when}: too few for the statistics of a surface"
    if may_merge and last.patches < first.patches / 2:
        yield f"patches merge: {first.patches} {when}, {last.patches} at last"


def remarks_on_edges(rough: Surface) -> tuple[str, ...]:
    """Remark on the edges of a scan."""
    if "periodic_rule" not in rough.provenance or rough.edges == "periodic":
        return ()
    if rough.edges == "free":
        return ("edges are free: the body ends with the scan, and does not tilt",)
    return (
        "edges reflect, as for a part of a larger surface; if the body ends with the scan, set "
        "edges = 'free' (--edges free)",
    )


def remark_on_loading(times: Sequence[float] | Field, end: float, when: str) -> tuple[str, ...]:
    """Remark on recorded times before the end of a loading ramp; `when` is that end in words."""
    if not (early := sum(0 < time < end for time in times)):
        return ()
    return (
        f"{counted(early, 'recorded time is', 'recorded times are')} before the end of the loading, {when}: "
        "load and area still rise there",
    )


def remarks_on_prediction(prediction: Prediction) -> Iterator[str]:
    """Remarks on the limits of a prediction, in numbers."""
    solid, fit, last = prediction.solid, prediction.fit, float(prediction.time[-1])
    if fit is not None and fit.assumed:
        yield fit.assumed
    if solid.creep is None and not solid.branches:
        yield "the contact does not grow: the solid is elastic"
    elif np.ptp(prediction.series("contact_area")) == 0:
        begun = solid.creep is None or prediction.series("contact_fraction")[-1] == 1
        yield f"the contact does not grow by {written(last, 's')}{'' if begun else ': creep has not begun'}"
    yield from remark_on_loading(prediction.time, prediction.ramp, written(prediction.ramp, "s"))
    if fit is not None and fit.series.error > (_WAVES if fit.systematic else _NOISE):
        cause = ", which looks like noise"
        if fit.systematic:
            more = "its errors depend on each other, or branches are too few"
            if fit.finer:
                more = f"{fit.finer:g} branches per decade miss it by less than half"
            cause = f" in waves, so that the band has no noise of the table: {more}"
        yield f"the fit misses the table by up to {100 * fit.series.error:.2g} %{cause}"
