"""Remarks on histories and predictions of continua, and on their limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from asperity.base.readable import written
from asperity.base.words import counted
from asperity.contact.remarks import Resolved, remarks_on_contacts
from asperity.lattice import Field
from asperity.prediction.results import Prediction
from asperity.solids import Solid
from asperity.surfaces import Surface

_WAVES, _NOISE = 1e-3, 0.05
"""Largest misfits of a table, in waves or as noise, without a remark."""

_STILL = 1e-9  # part of the largest load by which one that stays may fall by rounding
_RUBBED = 0.01, 3.0  # coefficients of friction of dry solids, from graphite to rubber on glass


def remarks_on_history(
    rough: Surface, solid: Solid, dataset: xr.Dataset, contacts: Sequence[Resolved]
) -> Iterator[str]:
    """Remarks on a history, in numbers, and on contacts of it under the largest load."""
    most = max(one.pressure for one in contacts)
    under_it = [one for one in contacts if one.pressure >= most - _STILL * abs(most)]
    yield from remarks_on_contacts(rough, solid, under_it)
    first, last = under_it[0], under_it[-1]
    if last is contacts[-1] and last.fraction <= 0.5 and last.patches < first.patches / 2:
        yield f"patches merge: {first.patches} {first.when}, {last.patches} {last.when}"
    at = int(np.argmax(dataset["load"].values >= (1 - _STILL) * dataset["load"].values.max()))
    mu = float(dataset["friction"][at]) if "friction" in dataset else math.nan
    if mu < _RUBBED[0] or mu > _RUBBED[1]:
        usual = "dry solids have {} to {}".format(*_RUBBED)
        yield f"the coefficient of friction is {mu:.3g}; {usual}: check the shear strength"


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
    if math.isfinite(prediction.material.span[1]) and not prediction.material.spread:
        yield "the band has no error of the solid: it was inferred from data, but has no draws"
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
