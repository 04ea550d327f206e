"""What is implausible in the contact of a continuum, and what limits it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import cast

import numpy as np
import xarray as xr

from asperity.analysis.maps import loaded, on_the_surface
from asperity.analysis.prediction import Resolved, resolved
from asperity.analysis.scan import written
from asperity.base.words import counted
from asperity.lattice import Field
from asperity.relaxation import PronySeries
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.doubts import load_on_filled
from asperity.theory import persson_area

# Contact area over Persson's, above which it is remarked: random surfaces have 0.7 to 2.5, the most where
# patches are single pixels, and offsets of lines of twice the rms height 3 and more.
_BEYOND = 3.0

_STILL = 1e-9  # part of the largest load by which one that stays may fall by rounding


def remarks_on_contact(
    rough: Surface, solid: Solid, dataset: xr.Dataset, maps: tuple[Resolved, ...] | None = None
) -> tuple[str, ...]:
    """What whoever reads a history should know, in numbers; `maps` are those of `resolved`, where known."""
    on_filled: tuple[str, ...] = ()
    if rough.filled is not None and "field_time" in dataset.dims:
        forces = on_the_surface(dataset)["pressure" if "pressure" in dataset else "force"]
        on_filled = load_on_filled(rough.filled, np.asarray(forces))
    in_lengths = solid.in_lengths and rough.has_lengths and rough.heights.ndim == 2
    limits = _limits(solid, dataset, maps) if in_lengths else ()
    return (*on_filled, *_beyond_theory(rough, solid, dataset), *limits)


def _beyond_theory(rough: Surface, solid: Solid, dataset: xr.Dataset) -> tuple[str, ...]:
    """Remark on a contact many times that of random heights, when the largest load is just on."""
    load = np.asarray(dataset["load"])
    elastic = solid.half_space and solid.separable and not solid.yields
    measured = "kind" not in rough.provenance and rough.heights.ndim == 2
    if not (elastic and measured and dataset.attrs.get("si")):
        return ()
    heights, spacing = rough.in_meters()
    at = _loaded(load)
    nominal, slope = heights.size * math.prod(spacing), rough.describe().rms_slope
    if not (load[at] > 0 and slope > 0):
        return ()
    modulus = cast(float, solid.modulus)
    series = PronySeries(modulus, tuple(solid.relaxing))
    effective = series.effective_load(np.asarray(dataset["time"])[: at + 1], load[: at + 1])[-1]
    expected = float(persson_area(effective / nominal, modulus=modulus, slope=slope))
    found = float(dataset["contact_area_corrected"][at]) / nominal
    if found <= _BEYOND * expected:
        return ()
    return (
        f"{100 * found:.2g} % of the surface touches under the full load; random heights of its rms slope "
        f"would have {100 * expected:.2g} % (Persson's theory): a bow, offsets of lines or spikes bear it; "
        "try tilt = 'quadratic' (--tilt quadratic), lines = 'median' (--lines median), despike (--despike)",
    )


def _loaded(load: Field) -> int:
    """Number of the first time at which the largest load is on."""
    return int(np.argmax(load >= (1 - _STILL) * load.max()))


def _limits(solid: Solid, dataset: xr.Dataset, maps: tuple[Resolved, ...] | None) -> Iterator[str]:
    """What limits a contact of a continuum under a surface with units, in numbers."""
    load, fraction = (np.asarray(dataset[name]) for name in ("load", "contact_fraction"))
    pressed = _loaded(load)
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
            "real asperities would flow, and nothing flows at once here; try a hardness"
        )
    if (most := float(fraction.max())) > 0.5:
        yield (
            f"{100 * most:.0f} % of the surface touches {'at last' if fraction[-1] == most else 'at most'}: "
            "waves longer than the scan, which it does not have, would keep bodies further apart"
        )


def _on_patches(first: Resolved, last: Resolved, when: str, *, may_merge: bool) -> Iterator[str]:
    """What the pixels resolve of the first map under the load, and what becomes of its patches."""
    if first.in_small > 0.2:
        yield (
            f"{100 * first.in_small:.0f} % of the area {when} lies in patches of fewer than 10 pixels: "
            "the scan does not resolve them, and a finer one would change the area"
        )
    if first.rim > 0.2:
        part = f"{100 * first.rim:.0f} % of the counted area {when}"
        yield f"the rim takes {part}: patches are few pixels wide"
    if first.patches < 30:
        many = counted(first.patches, "patch", "patches")
        yield f"{many} {when}: too few for the statistics of a surface"
    if may_merge and last.patches < first.patches / 2:
        yield f"patches merge: {first.patches} {when}, {last.patches} at last"
