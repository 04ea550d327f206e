"""The command ``asperity predict``: from a material, a scan and a load to a page to read."""

from __future__ import annotations

import csv
import functools
import re
import shlex
import sys
import time as clock
from collections.abc import Callable
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
from asperity.config.keys import keys_of
from asperity.config.mistakes import Sections
from asperity.config.models import Scan
from asperity.config.reading import file_surface, read_config
from asperity.config.solids import YIELDING, HalfSpace
from asperity.errors import InputError
from asperity.figures.page import prediction_page, prediction_pictures
from asperity.relaxation import arrhenius, wlf
from asperity.results import Checkpoint
from asperity.results.store import whole_folder
from asperity.runs.loops import compile_loops
from asperity.runs.prediction import predict as predict_it
from asperity.runs.prediction import predict_config
from asperity.words import counted as how_many
from asperity.words import number, thousands

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

_OF_TABLES, _COUNTS = (
    ("kind", "columns", "noise", "modulus"),
    ("poisson", "per_decade", "branches_per_decade"),
)
"""Flags that go on as they are: about a relaxation table alone, and others."""

_KEYS = {
    "pressure": ("contact", "pressure"),
    "load": ("contact", "load"),
    "first": ("aging", "first"),
    "last": ("aging", "last"),
    "per_decade": ("aging", "per_decade"),
    "shear_strength": ("friction", "shear_strength"),
    "pixel": ("output", "pixel"),
    "blur": ("output", "blur"),
    "threshold": ("output", "threshold"),
    "poisson": ("solid", "poisson"),
    "temperature": ("solid", "temperature"),
    "branches_per_decade": ("solid", "per_decade"),
}
"""Flags that are keys of a run's configuration."""

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
    material: Path | None, flags: Sections, wanted: PredictFlags, *, out: Path, overwrite: bool, quiet: bool
) -> None:
    """Compute, and write the results to a folder; a long run keeps its place in a file beside it.

    `AsperityError` as `asperity.predict`; or the folder cannot be written. No results are left then.
    """
    check_free(out, overwrite=overwrite)
    known = keys_of(HalfSpace)
    for name, value in flags.get("solid", {}).items():
        if unit := known[name].unit:
            for one in value if isinstance(value, list) else [value]:
                _with_unit(name, str(one), unit)
    numbers = {name: _quantity(name, getattr(wanted, name), unit) for name, unit in _UNITS.items()}
    compute: Callable[..., Prediction]
    if material is None or material.suffix == ".toml":
        config = read_config(material, _sections(material, flags, wanted))
        compute, asked = functools.partial(predict_config, config), repr(config)
    else:
        scan, arguments = _scan(flags), _arguments(flags, wanted, numbers)
        compute = lambda **more: predict_it(material, scan.build(), **arguments, **more)  # noqa: E731
        asked = repr((material, scan, arguments))
    with place_beside(out, asked) as place, progress_shown(quiet=quiet) as progress:
        compile_loops(progress.stage, progress.remark)
        started = clock.perf_counter()
        if place.exists():
            progress.stage(f"going on from {place}")
        try:
            prediction = compute(progress=progress, checkpoint=Checkpoint(place, every=_CHECKPOINT_EVERY))
        except InputError as error:
            raise _of_flags(error) from error
        rows = _report(prediction, seconds=clock.perf_counter() - started)
        progress.stage("writing the results")
        _write(prediction, out, text=aligned(rows), overwrite=overwrite)
    if not quiet:
        tell_results(rows, out)


def _scan(flags: Sections) -> MeasuredSurface:
    """The surface file that the flags name."""
    given = dict(flags.get("surface", {}))
    if "path" not in given:
        raise InputError("--surface", expected="the file of a scan", got="none", advice="--surface scan.opd")
    return file_surface(Path(str(given.pop("path"))), given, Scan)


def _sections(path: Path | None, flags: Sections, wanted: PredictFlags) -> Sections:
    """The flags as keys of a run's configuration, where there is no relaxation table."""
    for name in (*_OF_TABLES, "reference", "activation_energy", "wlf"):
        if (value := getattr(wanted, name)) is not None:
            raise InputError(
                _flag(name), expected="a relaxation table, which it is about", got=f"{path or 'none'}"
            )
    sections: Sections = {name: dict(keys) for name, keys in flags.items()}
    for name, (section, key) in _KEYS.items():
        if (value := getattr(wanted, name)) is not None:
            sections.setdefault(section, {})[key] = value
    if path is None:
        _one_load(wanted)
        solid = sections.setdefault("solid", {})
        if "young" not in solid:
            expected = "a relaxation table, a TOML file, or --young"
            raise InputError("material", expected=expected, got="none", advice="asperity predict --help")
        solid |= {"kind": "half_space", "poisson": solid.get("poisson", 0.35)}
        _scan(flags)
        sections["surface"].setdefault("periodic", "reflect")
    return sections


def _one_load(wanted: PredictFlags) -> None:
    """Refuse none and two."""
    if (wanted.pressure is None) == (wanted.load is None):
        got = "neither" if wanted.load is None else "both"
        raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")


def _arguments(flags: Sections, wanted: PredictFlags, numbers: dict[str, float | None]) -> dict[str, Any]:
    """What `asperity.predict` takes besides table and scan."""
    _one_load(wanted)
    if wanted.threshold is not None and wanted.pixel is None and wanted.blur is None:
        expected = "a pixel or a blur of the instrument beside it"
        raise InputError("--threshold", expected=expected, got="neither", advice="--pixel 1um")
    solid = {key: value for key, value in flags.get("solid", {}).items() if (key, value) != ("creep", "none")}
    if others := set(solid) - {"hardness"}:
        raise InputError(
            _flag(min(others)),
            expected="no relaxation table beside it: that is the table of a linear solid",
            got="both",
            advice="--young 3GPa in place of the table",
        )
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
    plain = {name: getattr(wanted, name) for name in (*_OF_TABLES, *_COUNTS, "threshold")}
    return {
        **numbers,
        **{name: value for name, value in plain.items() if value is not None},
        **solid,
        "shift": shift,
    }


def _quantity(name: str, text: str | None, unit: str) -> float | None:
    if text is None:
        return None
    value = units.quantity(text, unit, _flag(name))
    _with_unit(name, text, unit)
    return value


def _with_unit(name: str, text: str, unit: str) -> None:
    """Refuse a number alone."""
    if isinstance(number(text), float | int):
        flag = _flag(name)
        raise InputError(flag, expected="a number with its unit", got=text, advice=f"{flag} {text}{unit}")


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _of_flags(error: InputError) -> InputError:
    """The same error, about the flag."""
    named = {*_UNITS, *_COUNTS, *_OF_TABLES, *YIELDING, "threshold", "surface"} - {"kind"}
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
    rows = [("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels of {sides}")]
    if fit is not None:
        begin, end = fit.series.span
        rows.append(
            (
                "relaxation",
                f"{prediction.assumed['table']}: {written(begin, 's')} to {written(end, 's')}, "
                f"{len(fit.series.branches)} branches, missed by {100 * fit.series.error:.2g} % at most",
            )
        )
    rows += [
        ("solid", "; ".join(prediction.words)),
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
    if prediction.solid.yields:
        lowered = dataset["permanent_indentation"].values
        begun, left = (int((lowered[place] > 0).sum()) for place in (0, -1))
        said = f"{how_many(begun, 'pixel')} lowered for good at first, {thousands(left)} at last"
        rows.append(
            ("yields", said + (f", by up to {written(float(lowered[-1].max()), 'm')}" if left else ""))
        )
    exact = "exact contact"
    if dataset.attrs.get("exact_contact") != "at all times":
        exact = f"{int(dataset['steps'].sum())} time steps"
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
