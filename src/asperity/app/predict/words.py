"""The rows of the summary of a prediction."""

from __future__ import annotations

import numpy as np

from asperity.analysis.bands import rows_of_maps
from asperity.analysis.rows import carried_rows, words_of
from asperity.base.readable import written
from asperity.base.words import band_ends, thousands
from asperity.base.words import counted as how_many
from asperity.prediction.results import Prediction
from asperity.surfaces.provenance import understood

Row = tuple[str, str]


def report(prediction: Prediction, *, seconds: float, resumed: bool = False) -> list[Row]:
    """Rows on the material, the scan, the load, and the predicted contact."""
    dataset, scan = prediction.dataset, prediction.origin
    fit = prediction.fit
    pixels = " x ".join(map(str, dataset["heights"].shape))
    sides = " x ".join(written(side, "m", 4) for side in prediction.spacing)
    load, ramp = prediction.load, prediction.ramp
    rows = [("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels of {sides}"), *understood(scan)]
    if fit is not None:
        begin, end = fit.data.span
        rows += [("read", fit.data.source)] if fit.data.source else []
        text = f"{prediction.assumed['table']}: {written(begin, 's')} to {written(end, 's')}, "
        text += f"fit error {100 * fit.rms:.2g} % rms, {100 * fit.series.error:.2g} % at most"
        rows.append(("relaxation", text))
    nominal = prediction.nominal_area
    pressed = f"{written(load, 'N')}, {written(load / nominal, 'Pa')} over {written(nominal, 'm^2')}, "
    pressed += f"applied within {written(ramp, 's')}, from 0 s on" if ramp else "applied instantly"
    rows += [
        ("solid", "; ".join(prediction.words)),
        *_branches(prediction),
        ("load", prediction.legs or pressed),
    ]
    loaded = prediction.loaded
    rows += _contacts(prediction)
    rows += _growth(prediction)
    if prediction.theory is not None:
        name, area = prediction.theory
        first_to_last = " to ".join(written(float(area[place]), "m^2") for place in (0, -1))
        # A flow fits the last area only; its first is far above.
        ends = "" if prediction.relaxing is None else f"{first_to_last} by "
        rows.append(("theory", f"{ends}{name}: dashed in growth.png"))
    if prediction.friction is not None:
        mu = np.transpose([prediction.friction, *prediction.band("friction")])[[loaded, -1]]
        first, last = (f"{value:.3g}, 95 % band {band_ends(ends, '{:.3g}'.format)}" for value, *ends in mu)
        rows.append(("friction", f"{first}, at first; {last}, at last"))
    if len(prediction.bands) > 1:
        whole, half = prediction.bands[:2]
        changes = ", ".join(f"{name} by {100 * by:+.2g} %" for name, by in whole.change_to(half).items())
        rows.append(("resolution", f"without waves below {written(half.shortest, 'm')}: {changes}"))
    rows += words_of(carried_rows(dataset.isel(time=slice(1 + loaded, None))))
    for which, place in (("first", 0), ("last", -1)) if prediction.observed else ():
        seen = prediction.observed[place]
        rows.append((f"observed {which}", f"{written(seen.area, 'm^2')}, patches: {seen.patches.count}"))
    if prediction.solid.yields:
        lowered = dataset["permanent_indentation"].values
        begun, remaining = (int((lowered[place] > 0).sum()) for place in (0, -1))
        text = f"{how_many(begun, 'pixel')} permanently lowered at first, {thousands(remaining)} at last"
        text += f", by up to {written(float(lowered[-1].max()), 'm')}" if remaining else ""
        rows.append(("yields", text))
    exact = dataset.attrs.get("exact_contact") == "at all times"
    effort = "exact contact" if exact else f"{int(dataset['steps'].sum())} time steps"
    effort += f", {int(dataset['iterations'].sum())} iterations, {seconds:.1f} s"
    rows.append(("worst residual", f"{float(dataset['residual'].max()):.1e} of the mean contact force"))
    rows.append(("cost", effort + (" in this session" if resumed else "")))
    return [*rows, *(("remark", remark) for remark in prediction.remarks)]


def _contacts(prediction: Prediction) -> list[Row]:
    """Area, its band and its patches: at first and at last, or at the switches of a history."""
    rows, places = [], [row - 1 for row in rows_of_maps(prediction.dataset)]
    for number, place in enumerate(places):
        if not (place in (places[0], places[-1]) if prediction.growth else place >= prediction.loaded):
            continue
        names = ("contact_area", "contact_area_corrected", "mean_contact_pressure")
        counted, less, pressure = (float(prediction.series(name)[place]) for name in names)
        band = band_ends(
            (float(end[place]) for end in prediction.band(names[1])), lambda end: written(end, "m^2")
        )
        many = how_many(prediction.resolved[number].patches, "patch", "patches")
        text = f"{written(less, 'm^2')} = {100 * less / prediction.nominal_area:.3g} %"
        text += f", corrected for pixel rims, 95 % band {band}; "
        text += f"raw {written(counted, 'm^2')} in {many}, mean pressure {written(pressure, 'Pa')}"
        jumped = place > 0 and prediction.time[place] == prediction.time[place - 1]
        when = "just after" if jumped else f"contact at {written(float(prediction.time[place]), 's')}"
        rows.append((when, text))
    return rows


def _branches(prediction: Prediction) -> list[Row]:
    """Shares and relaxation times, with the 95 % intervals of a fit."""
    rows, intervals = [], None if prediction.fit is None else prediction.fit.intervals
    for number, (share, time) in enumerate(prediction.branches):
        parts = [f"share {share:.4g}", f"relaxes in {written(time, 's')}"]
        if intervals is not None:
            (low, high), (early, late) = intervals[number].tolist()
            parts[0] += f" ({low:.4g} to {high:.4g})"
            parts[1] += f" ({written(early, 's')} to {written(late, 's')})"
        rows.append(("" if number else "branches", " ".join(parts)))
    rows += [("", f"share {prediction.plateau:.4g} does not relax")] if rows else []
    if prediction.draws:
        rows.append(("", f"the band includes {prediction.draws} samples of the branches"))
    return rows


def _growth(prediction: Prediction) -> list[Row]:
    growth, effective = prediction.growth, prediction.effective_load
    if growth is None:
        return []
    least, most, last = (100 * slope for slope in (*growth.range, growth.decades[-1][2]))
    text = f"{least:.3g} to {most:.3g} % of the first area, {last:.3g} % in the last; "
    band = band_ends(growth.band, lambda slope: f"{100 * slope:.3g} %")
    text += f"mean {100 * growth.per_decade:.3g} %, 95 % band {band}"
    ratio = f"{prediction.between('A')} = {growth.ratio:.5g}, 95 % band {band_ends(growth.ratio_band)}"
    rows = [("growth", ratio), ("in each decade", text)]
    if effective is not None:
        name, symbol = prediction.beside
        rows.append((name, f"{prediction.between(symbol)} = {effective[-1] / effective[0]:.5g}"))
    return rows
