r"""95 % bands of steady sliding, by tiles of the scan and draws of the solid as in `asperity.analysis.bands`.

Friction is counted where it arises: of each site -p dv/dx, with the displacement v by the loss compliance
alone. The sum is the dissipation, and forces between tiles add nothing where nothing is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from asperity.analysis.bands import band_of, bearing, by_some, saturation, student, without_each
from asperity.lattice import Field
from asperity.relaxation import Material
from asperity.solids import Solid

HYSTERESIS, WHOLE, AREA = "hysteresis_friction_coefficient", "friction_coefficient", "contact_area"
_LIKE = {AREA: AREA, "contact_area_corrected": AREA, "contact_fraction": AREA}

_LAGS = 60
"""Times at which the compliances of draws are compared."""


def with_bands(
    dataset: xr.Dataset, tiles: Sequence[Mapping[str, Field]], solid: Mapping[str, Field]
) -> xr.Dataset:
    """Add ``_low`` and ``_high`` of friction and areas, from `Profile.tiles` at each speed.

    `solid` is from `draws_of_solid`.
    """
    sums = {name: np.array([each[name] for each in tiles]) for name in tiles[0]}
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = {name: np.log(without_each(part)) for name, part in sums.items()}
        borne = {AREA: bearing(sums["load"])}
        borne[HYSTERESIS] = borne[WHOLE] = np.minimum(borne[AREA], bearing(sums["friction"]))
        # Near full contact area and friction grow less than the load.
        full = saturation(dataset["contact_fraction"].values)[:, np.newaxis]
        moved = full * (logs["load"] - logs["sites"]) - logs["load"]
        without = {AREA: (logs["area"] + moved).T, HYSTERESIS: (logs["friction"] + moved).T}
        without = {name: np.where(np.isfinite(part), part, np.nan) for name, part in without.items()}
    draws = dict(solid)
    if WHOLE in dataset:
        share = (dataset[HYSTERESIS] / dataset[WHOLE]).values
        for parts in (without, draws):
            if parts:
                parts[WHOLE] = share * parts[HYSTERESIS] + (1 - share) * parts[AREA]
    columns: dict[str, Any] = {}
    for name in (HYSTERESIS, WHOLE, *_LIKE):
        if name in dataset:
            base = _LIKE.get(name, name)
            factors = np.exp(student(without[base], borne[base]))
            factors *= np.resize(draws.get(base, [[1.0]]), factors.shape)
            columns |= band_of(dataset[name], factors)
    return dataset.assign(columns)


def draws_of_solid(
    material: Material,
    curves: Mapping[str, Field],
    frequencies: tuple[float, float],
    computed: Callable[[Solid, str], Mapping[str, Field]],
) -> dict[str, Field]:
    """Factors on curves, shape (draws, speeds), by draws of a solid; empty without a spread.

    Its waves oscillate at frequencies between two, and `computed` has the curves of another one.
    """
    if len(material.spread) < 2:
        return {}
    least, most = frequencies
    lags = np.append(0.0, np.geomspace(0.1 / most, 1 / least, _LAGS))
    of = {name: curves[name] for name in (AREA, HYSTERESIS)}
    return by_some(of, lags, material.spread, material.solid, computed)
