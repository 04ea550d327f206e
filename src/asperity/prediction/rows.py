"""Rows of the summary of a prediction."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asperity.analysis.bands import rows_of_maps
from asperity.analysis.rows import carried_rows, surface_rows, worst_residual, yielding_rows
from asperity.base import views
from asperity.base.readable import written
from asperity.base.rows import Row
from asperity.base.words import counted
from asperity.prediction.results import Prediction


@views.defines(Prediction.rows)
def rows_of(prediction: Prediction, /) -> list[Row]:
    """Rows on the material, the scan, the load, and the predicted contact."""
    loaded = prediction.loaded
    return [
        *_origin(prediction),
        *_contacts(prediction),
        *_growth(prediction),
        *_theory(prediction),
        *_friction(prediction),
        *_resolution(prediction),
        *carried_rows(prediction.dataset.isel(time=slice(1 + loaded, None))),
        *_observed(prediction),
        *yielding_rows(prediction.dataset),
        worst_residual(prediction.dataset),
    ]


def _origin(prediction: Prediction) -> Iterator[Row]:
    scan, fit = prediction.origin, prediction.fit
    yield from surface_rows(scan, prediction.dataset["heights"].shape, prediction.spacing)
    if fit is not None:
        begin, end = fit.data.span
        yield from [Row("read", fit.data.source)] * bool(fit.data.source)
        text = f"{prediction.assumed['table']}: {written(begin, 's')} to {written(end, 's')}, "
        text += f"fit error {100 * fit.rms:.2g} % rms, {100 * fit.series.error:.2g} % at most"
        yield Row("relaxation", text)
    yield Row("solid", "; ".join(prediction.words), brief=True)
    yield from _branches(prediction)
    nominal, ramp = prediction.nominal_area, prediction.ramp
    note = f", {written(prediction.load / nominal, 'Pa')} over {written(nominal, 'm^2')}, "
    note += f"applied within {written(ramp, 's')}, from 0 s on" if ramp else "applied instantly"
    pressed = Row("load", prediction.load, "N", note=note, digits=4, brief=True)
    yield Row("load", prediction.legs, brief=True) if prediction.legs else pressed


def _branches(prediction: Prediction) -> Iterator[Row]:
    """Shares and relaxation times, with the 95 % intervals of a fit."""
    intervals = None if prediction.fit is None else prediction.fit.intervals
    for number, (share, time) in enumerate(prediction.branches):
        parts = [f"share {share:.4g}", f"relaxes in {written(time, 's')}"]
        if intervals is not None:
            (low, high), (early, late) = intervals[number].tolist()
            parts[0] += f" ({low:.4g} to {high:.4g})"
            parts[1] += f" ({written(early, 's')} to {written(late, 's')})"
        yield Row("" if number else "branches", " ".join(parts))
    if prediction.branches:
        yield Row("", f"share {prediction.plateau:.4g} does not relax")
    if prediction.draws:
        yield Row("", f"the band includes {prediction.draws} samples of the branches")


def _contacts(prediction: Prediction) -> Iterator[Row]:
    """Area, its band and its patches: at first and at last, or at the switches of a history."""
    places = [row - 1 for row in rows_of_maps(prediction.dataset)]
    names = ("contact_area", "contact_area_corrected", "mean_contact_pressure")
    for number, place in enumerate(places):
        if not (place in (places[0], places[-1]) if prediction.growth else place >= prediction.loaded):
            continue
        total, less, pressure = (float(prediction.series(name)[place]) for name in names)
        low, high = (float(end[place]) for end in prediction.band(names[1]))
        many = counted(prediction.resolved[number].patches, "patch", "patches")
        text = f" = {100 * less / prediction.nominal_area:.3g} %, corrected for pixel rims; "
        text += f"raw {written(total, 'm^2')} in {many}, mean pressure {written(pressure, 'Pa')}"
        jumped = place > 0 and prediction.time[place] == prediction.time[place - 1]
        when = "just after" if jumped else f"contact at {written(float(prediction.time[place]), 's')}"
        yield Row(when, less, "m^2", (low, high), text, digits=4, brief=True)


def _growth(prediction: Prediction) -> Iterator[Row]:
    growth, effective = prediction.growth, prediction.effective_load
    if growth is None:
        return
    least, most, last = (100 * slope for slope in (*growth.range, growth.decades[-1][2]))
    yield Row(prediction.between("A"), growth.ratio, "1", growth.ratio_band, digits=5, brief=True)
    note = f"; {least:.3g} to {most:.3g} % in each decade, {last:.3g} % in the last"
    low, high = (100 * end for end in growth.band)
    unit = "% of the first area"
    yield Row("growth per decade", 100 * growth.per_decade, unit, (low, high), note, digits=3, brief=True)
    if effective is not None:
        name, symbol = prediction.beside
        text = f"{prediction.between(symbol)} = {effective[-1] / effective[0]:.5g}"
        yield Row(name, text)


def _theory(prediction: Prediction) -> Iterator[Row]:
    if prediction.theory is not None:
        name, area = prediction.theory
        first_to_last = " to ".join(written(float(area[place]), "m^2") for place in (0, -1))
        # A flow fits the last area only; its first is far above.
        ends = "" if prediction.relaxing is None else f"{first_to_last} by "
        yield Row("theory", f"{ends}{name}: dashed in growth.png")


def _friction(prediction: Prediction) -> Iterator[Row]:
    if prediction.friction is not None:
        mu = np.transpose([prediction.friction, *prediction.band("friction")])
        for when, place in (("at first", prediction.loaded), ("at last", -1)):
            value, *ends = mu[place].tolist()
            yield Row(f"friction {when}", value, "1", (ends[0], ends[1]), digits=3, brief=True)


def _resolution(prediction: Prediction) -> Iterator[Row]:
    if len(prediction.bands) > 1:
        whole, half = prediction.bands[:2]
        changes = ", ".join(f"{name} by {100 * by:+.2g} %" for name, by in whole.change_to(half).items())
        yield Row("resolution", f"without waves below {written(half.shortest, 'm')}: {changes}")


def _observed(prediction: Prediction) -> Iterator[Row]:
    for which, place in (("first", 0), ("last", -1)) if prediction.observed else ():
        seen = prediction.observed[place]
        note = f", patches: {seen.patches.count}"
        yield Row(f"observed {which}", seen.area, "m^2", note=note, digits=4)
