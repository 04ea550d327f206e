"""What is implausible in the contact of a measured surface."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import xarray as xr

from asperity.analysis.maps import on_the_surface
from asperity.relaxation import PronySeries
from asperity.relaxation.series import Branches
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.doubts import load_on_filled
from asperity.theory import persson_area

# Contact area over Persson's, above which it is remarked: random surfaces have 0.7 to 2.5, the most where
# patches are single pixels, and offsets of lines of twice the rms height 3 and more.
_BEYOND = 3.0


def remarks_on_contact(rough: Surface, solid: Solid, dataset: xr.Dataset) -> tuple[str, ...]:
    """What whoever reads a history of a measured surface should know."""
    on_filled: tuple[str, ...] = ()
    if rough.filled is not None and "field_time" in dataset.dims:
        forces = on_the_surface(dataset)["pressure" if "pressure" in dataset else "force"]
        on_filled = load_on_filled(rough.filled, np.asarray(forces))
    return (*on_filled, *_beyond_theory(rough, solid, dataset))


def _beyond_theory(rough: Surface, solid: Solid, dataset: xr.Dataset) -> tuple[str, ...]:
    """Remark on a contact many times that of random heights, when the largest load is just on."""
    load = np.asarray(dataset["load"])
    elastic = solid.kind == "half_space" and solid.separable and not solid.yields
    measured = "kind" not in rough.provenance and rough.heights.ndim == 2
    if not (elastic and measured and dataset.attrs.get("si")):
        return ()
    heights, spacing = rough.in_meters()
    at = int(np.argmax(load >= (1 - 1e-9) * load.max()))
    nominal, slope = heights.size * math.prod(spacing), rough.describe().rms_slope
    if not (load[at] > 0 and slope > 0):
        return ()
    modulus = cast(float, solid.parameters["modulus"])
    series = PronySeries(modulus, cast(Branches, solid.parameters.get("branches") or ()))
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
