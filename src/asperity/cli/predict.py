"""The command ``asperity predict``: from a relaxation table, a scan and a load to a page to read."""

from __future__ import annotations

import csv
import re
import shlex
import sys
import time as clock
from pathlib import Path
from typing import Any

import numpy as np

import asperity.units as units
from asperity.analysis.prediction import Prediction
from asperity.analysis.scan import written
from asperity.cli.options import PredictFlags
from asperity.cli.output import check_free, save_within
from asperity.cli.progress import progress_shown
from asperity.cli.report import Row, aligned
from asperity.cli.resuming import place_beside, tell_results
from asperity.config import MeasuredSurface
from asperity.errors import InputError
from asperity.figures.page import prediction_page, prediction_pictures
from asperity.relaxation import arrhenius, wlf
from asperity.results import Checkpoint
from asperity.results.store import whole_folder
from asperity.runs.loops import compile_loops
from asperity.runs.prediction import predict as predict_it
from asperity.words import counted as how_many

_CHECKPOINT_EVERY = 3.0
_UNITS = {
    "pressure": "Pa",
    "load": "N",
    "shear_strength": "Pa",
    "first": "s",
    "last": "s",
    "pixel": "m",
    "blur": "m",
    "temperature": "K",
    "reference": "K",
    "activation_energy": "J/mol",
}
"""Flags that are quantities, and the units in which they go on."""

_AS_WRITTEN = ("kind", "columns", "noise", "modulus", "poisson", "per_decade", "branches_per_decade")
"""Flags that go on as they are."""

_COLUMNS = {
    "time": "s",
    "contact_area": "m^2",
    "contact_area_corrected": "m^2",
    "contact_fraction": "1",
    "load": "N",
    "mean_contact_pressure": "Pa",
    "largest_pressure": "Pa",
    "mean_gap": "m",
    "approach": "m",
    "residual": "1",
}


def predict(
    relaxation: Path, scan: MeasuredSurface, wanted: PredictFlags, *, out: Path, overwrite: bool, quiet: bool
) -> None:
    """Compute, and write the results to a folder; a long run keeps its place in a file beside it.

    `AsperityError` as `asperity.predict`; or the folder cannot be written. No results are left then.
    """
    check_free(out, overwrite=overwrite)
    with (
        place_beside(out, repr((relaxation, scan, wanted))) as place,
        progress_shown(quiet=quiet) as progress,
    ):
        arguments = _arguments(wanted)
        compile_loops(progress.stage, progress.remark)
        started = clock.perf_counter()
        if place.exists():
            progress.stage(f"going on from {place}")
        try:
            prediction = predict_it(
                relaxation,
                scan.build(),
                **arguments,
                progress=progress,
                checkpoint=Checkpoint(place, every=_CHECKPOINT_EVERY),
            )
        except InputError as error:
            raise _of_flags(error) from error
        rows = _report(prediction, seconds=clock.perf_counter() - started)
        progress.stage("writing the results")
        _write(prediction, out, text=aligned(rows), overwrite=overwrite)
    if not quiet:
        tell_results(rows, out)


def _arguments(wanted: PredictFlags) -> dict[str, Any]:
    """What `asperity.predict` takes besides table and scan."""
    if (wanted.pressure is None) == (wanted.load is None):
        got = "neither" if wanted.load is None else "both"
        raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")
    if wanted.threshold is not None and wanted.pixel is None and wanted.blur is None:
        expected = "a pixel or a blur of the instrument beside it"
        raise InputError("--threshold", expected=expected, got="neither", advice="--pixel 1um")
    numbers = {name: _quantity(name, getattr(wanted, name), unit) for name, unit in _UNITS.items()}
    temperature, reference = numbers.pop("temperature"), numbers.pop("reference")
    energy, constants = numbers.pop("activation_energy"), wanted.wlf
    shift = 1.0
    if temperature is not None or reference is not None or energy is not None or constants is not None:
        if temperature is None or reference is None:
            name = "--temperature" if temperature is None else "--reference"
            raise InputError(
                name, expected="the temperatures of contact and table", got="none", advice=f"{name} 25degC"
            )
        if (energy is None) == (constants is None):
            expected = "an activation energy, or the constants of WLF"
            got = "neither" if energy is None else "both"
            raise InputError("--activation-energy", expected=expected, got=got, advice="100kJ/mol")
        shift = (
            arrhenius(energy, temperature, reference)
            if energy is not None
            else wlf(*(constants or (0.0, 1.0)), temperature, reference)
        )
    return {
        **numbers,
        **{name: getattr(wanted, name) for name in _AS_WRITTEN},
        **({} if wanted.threshold is None else {"threshold": wanted.threshold}),
        "shift": shift,
    }


def _quantity(name: str, text: str | None, unit: str) -> float | None:
    if text is None:
        return None
    flag = _flag(name)
    value = units.quantity(text, unit, flag)
    try:
        float(text)
    except ValueError:
        return value
    raise InputError(flag, expected="a number with its unit", got=text, advice=f"{flag} {text}{unit}")


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _of_flags(error: InputError) -> InputError:
    """The same error, about the flag."""
    named = {*_UNITS, *_AS_WRITTEN, "threshold", "surface"} - {"kind"}
    name = _flag(error.name) if error.name in named else error.name
    advice = re.sub(r"\b(noise|kind|columns)=\S", lambda found: f"--{found[1]} {found[0][-1]}", error.advice)
    return InputError(name, expected=error.expected, got=error.got, advice=advice)


def _report(prediction: Prediction, *, seconds: float) -> list[Row]:
    """Say what was predicted from what."""
    dataset, growth, scan = prediction.dataset, prediction.growth, prediction.origin
    time, fit = prediction.time, prediction.fit
    pixels = " x ".join(map(str, dataset["heights"].shape))
    sides = " x ".join(written(side, "m", 4) for side in prediction.spacing)
    load = float(dataset["load"][0])
    begin, end = fit.series.span
    rows = [
        ("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels of {sides}"),
        (
            "relaxation",
            f"{prediction.assumed['table']}: {written(begin, 's')} to {written(end, 's')}, "
            f"{len(fit.series.branches)} branches, missed by {100 * fit.series.error:.2g} % at most",
        ),
        ("solid", f"half-space, E* = {written(prediction.modulus, 'Pa')} at once"),
        (
            "held",
            f"load {written(load, 'N')}, {written(load / prediction.nominal_area, 'Pa')} "
            f"over {written(prediction.nominal_area, 'm^2')}",
        ),
    ]
    for place in (0, -1):
        counted, less = (
            float(prediction.series(name)[place]) for name in ("contact_area", "contact_area_corrected")
        )
        many = how_many(prediction.resolved[place].patches, "patch", "patches")
        rows.append(
            (
                f"contact at {written(float(time[place]), 's')}",
                f"{written(less, 'm^2')} = {100 * less / prediction.nominal_area:.3g} % less its rim; "
                f"counted {written(counted, 'm^2')} in {many}, "
                f"with {written(load / counted, 'Pa')} on average",
            )
        )
    low, high = (100 * edge for edge in growth.band)
    first, last, several = growth.decades[0][2], growth.decades[-1][2], len(growth.decades) > 1
    rows += [
        (
            "growth",
            f"{100 * growth.per_decade:.3g} % of the first area per decade, "
            f"95 % band {low:.3g} to {high:.3g} %",
        )
    ]
    if several:
        rows.append(("", f"{100 * first:.3g} % in the first decade, {100 * last:.3g} % in the last"))
    if prediction.friction is not None:
        mu = prediction.friction
        rows.append(("friction", f"{mu[0]:.3g} at first, {mu[-1]:.3g} at last"))
    for which, place in (("first", 0), ("last", -1)) if prediction.observed else ():
        seen = prediction.observed[place]
        rows.append((f"seen at {which}", f"{written(seen.area, 'm^2')}, patches: {seen.patches.count}"))
    exact = "exact contact" if dataset.attrs.get("exact_contact") == "at all times" else "time steps"
    rows += [
        ("worst residual", f"{float(dataset['residual'].max()):.1e} of the mean contact force"),
        ("effort", f"{exact}, {int(dataset['iterations'].sum())} iterations, {seconds:.1f} s"),
        *(("remark", remark) for remark in prediction.remarks),
    ]
    return rows


def _write(prediction: Prediction, out: Path, *, text: str, overwrite: bool) -> None:
    """Write every file: all of them, or none."""
    check_free(out, overwrite=overwrite)  # again: minutes may have passed
    pictures = prediction_pictures(prediction)
    page = prediction_page(prediction, pictures, command=shlex.join(["asperity", *sys.argv[1:]]))
    with whole_folder(out, overwrite=overwrite or out.exists()) as folder:
        save_within(prediction.dataset, folder)
        (folder / "summary.txt").write_text(f"{text}\n", encoding="utf-8")
        (folder / "prediction.html").write_text(page, encoding="utf-8")
        for name, picture in pictures.items():
            (folder / f"{name}.png").write_bytes(picture.png)
        _write_table(prediction, folder / "history.csv")


def _write_table(prediction: Prediction, path: Path) -> None:
    """One row a time; numbers to the last digit, with units in the header."""
    columns = {f"{name} [{unit}]": prediction.series(name) for name, unit in _COLUMNS.items()}
    if prediction.friction_force is not None and prediction.friction is not None:
        columns |= {"friction_force [N]": prediction.friction_force, "friction [1]": prediction.friction}
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(columns)
        table.writerows(np.column_stack(list(columns.values())).tolist())
