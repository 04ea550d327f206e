"""The command ``asperity predict``: from a material, a scan and a load to a page to read."""

from __future__ import annotations

import csv
import functools
import shlex
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from asperity.analysis.prediction import Prediction
from asperity.analysis.scan import written
from asperity.app.cli.flags import check_unit, keys_for, of_flags
from asperity.app.cli.options import PredictFlags
from asperity.app.cli.output import check_free, save_within
from asperity.app.cli.report import Row, aligned
from asperity.app.cli.resuming import place_beside, tell_results
from asperity.app.config import MeasuredSurface
from asperity.app.config.mistakes import Sections, flag_of
from asperity.app.config.models import SECTIONS, Scan
from asperity.app.config.reading import file_surface, read_config, section_from
from asperity.app.config.solids import POISSON, BesideTable
from asperity.app.runs.prediction import predict as predict_it
from asperity.app.runs.prediction import predict_config
from asperity.base import units
from asperity.base.words import counted as how_many
from asperity.base.words import tables_to_toml, thousands
from asperity.errors import InputError
from asperity.figures.page import prediction_page, prediction_pictures
from asperity.progress import listener
from asperity.relaxation import Fit, arrhenius, wlf
from asperity.results import Checkpoint
from asperity.results.quantities import PREDICT, areas_first, select
from asperity.results.store import whole_folder

_CHECKPOINT_EVERY = 3.0
_OF_TABLES = ("kind", "columns", "noise", "modulus", "branches")
"""Flags about a relaxation table, which go on as they are."""


def predict(
    material: Path | None,
    flags: Sections,
    wanted: PredictFlags,
    *,
    ramp: str | None,
    out: Path,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Compute, and write the results to a folder; a long run keeps its place in a file beside it.

    `AsperityError` as `asperity.predict`; or the folder cannot be written. No results are left then.
    """
    check_free(out, overwrite=overwrite)
    compute: Callable[..., Prediction]
    loading = None if ramp is None else _with_unit("--ramp", ramp, "s")
    if material is None or material.suffix == ".toml":
        config = read_config(material, _sections(material, flags, wanted))
        compute, asked = functools.partial(predict_config, config), repr((config, loading))
    else:
        scan, arguments = _scan(flags), _arguments(flags, wanted)
        compute = lambda **more: predict_it(material, scan.build(), **arguments, **more)  # noqa: E731
        asked = repr((material, scan, arguments, loading))
    with place_beside(out, asked) as place, listener(not quiet) as progress:
        started = clock.perf_counter()
        if place.exists():
            progress.stage(f"going on from {place}")
        try:
            kept = Checkpoint(place, every=_CHECKPOINT_EVERY)
            prediction = compute(ramp=loading, progress=progress, checkpoint=kept)
        except InputError as error:
            raise of_flags(error, _flags_of_arguments()) from error
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
    for name, value in vars(wanted).items():
        if value is not None:
            expected, got = "a relaxation table, which it is about", f"{path or 'none'}"
            raise InputError(_flag(name), expected=expected, got=got)
    if path is not None:
        return flags
    _one_load(flags)
    solid: dict[str, Any] = flags.get("solid", {})
    if "young" not in solid:
        expected = "a relaxation table, a TOML file, or --young"
        raise InputError("material", expected=expected, got="none", advice="asperity predict --help")
    _scan(flags)
    return flags | {
        "solid": {"kind": "half_space", "poisson": [POISSON] * len(solid["young"]), **solid},
        "surface": {"periodic": "reflect", **flags["surface"]},
    }


def _one_load(flags: Sections) -> None:
    """Refuse none and two."""
    if len(given := flags.get("contact", {})) != 1:
        got = "both" if given else "neither"
        raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")


def _arguments(flags: Sections, wanted: PredictFlags) -> dict[str, Any]:
    """What `asperity.predict` takes besides table and scan; `AsperityError` for flags that are wrong."""
    _one_load(flags)
    solid = dict(flags.get("solid", {}))
    if solid.get("creep") == "none":
        del solid["creep"]
    for key in solid:
        if key not in BesideTable.model_fields:
            raise InputError(
                flag_of("solid", key),
                expected="no relaxation table beside it: that is the table of a linear solid",
                got="both",
                advice="--young 3GPa in place of the table",
            )
    keys = section_from("solid", BesideTable, solid).model_dump(exclude_unset=True)
    if "poisson" in keys:
        keys["poisson"] = keys["poisson"][0]
    if "per_decade" in keys:
        keys["branches_per_decade"] = keys.pop("per_decade")
    for section, model in SECTIONS.items():
        keys |= section_from(section, model, flags.get(section, {})).model_dump(exclude_unset=True)
    keys |= {name: getattr(wanted, name) for name in _OF_TABLES if getattr(wanted, name) is not None}
    return keys | {"shift": _shift(keys.pop("temperature", None), wanted)}


def _shift(temperature: float | None, wanted: PredictFlags) -> float:
    """Factor on the times of the table, from its temperature to that of the contact."""
    energy, constants = wanted.activation_energy, wanted.wlf
    if temperature is None and wanted.reference is None and energy is None and constants is None:
        return 1.0
    if temperature is None or wanted.reference is None:
        flag, expected = (
            _flag("temperature" if temperature is None else "reference"),
            "the temperatures of contact and table",
        )
        raise InputError(flag, expected=expected, got="none", advice=f"{flag} 25degC")
    kelvin = (temperature, _with_unit("--reference", wanted.reference, "K"))
    if constants is not None and energy is None:
        return wlf(*constants, *kelvin)
    if energy is None or constants is not None:
        expected, got = "an activation energy, or the constants of WLF", "both" if energy else "neither"
        raise InputError("--activation-energy", expected=expected, got=got, advice="100kJ/mol")
    return arrhenius(_with_unit("--activation-energy", energy, "J/mol"), *kelvin)


def _with_unit(flag: str, text: str, unit: str) -> float:
    check_unit(flag, text, unit)
    return units.quantity(text, unit, flag)


def _flags_of_arguments() -> dict[str, str]:
    """Flags of arguments, by their names in Python."""
    keys = {key.name: flag_of(section, key.name) for section, key in keys_for("prediction")}
    others = ("surface", "branches_per_decade", "extrapolate", "ramp", *vars(PredictFlags()))
    return keys | {name: _flag(name) for name in others}


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _report(prediction: Prediction, *, seconds: float) -> list[Row]:
    """Say what was predicted from what."""
    dataset, scan = prediction.dataset, prediction.origin
    time, fit = prediction.time, prediction.fit
    pixels = " x ".join(map(str, dataset["heights"].shape))
    sides = " x ".join(written(side, "m", 4) for side in prediction.spacing)
    load, ramp = prediction.load, prediction.ramp
    rows = [("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels of {sides}")]
    if fit is not None:
        begin, end = fit.data.span
        rows.append(
            (
                "relaxation",
                f"{prediction.assumed['table']}: {written(begin, 's')} to {written(end, 's')}, "
                f"missed by {100 * fit.rms:.2g} % rms, {100 * fit.series.error:.2g} % at most",
            )
        )
    rows += [
        ("solid", "; ".join(prediction.words)),
        *_branches(prediction),
        (
            "held",
            f"load {written(load, 'N')}, {written(load / prediction.nominal_area, 'Pa')} "
            f"over {written(prediction.nominal_area, 'm^2')}, "
            + (f"put on within {written(ramp, 's')}, from 0 s on" if ramp else "put on at once"),
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
                f"with {written(float(prediction.series('mean_contact_pressure')[place]), 'Pa')} on average",
            )
        )
    rows += _growth(prediction)
    if prediction.theory is not None:
        name, area = prediction.theory
        first_to_last = " to ".join(written(float(area[place]), "m^2") for place in (0, -1))
        # A flow fits the last area only; its first is far above.
        ends = "" if prediction.relaxing is None else f"{first_to_last} by "
        rows.append(("theory", f"{ends}{name}: dashed in growth.png"))
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


def _branches(prediction: Prediction) -> list[Row]:
    """Shares and relaxation times; where a fit knows their 95 % intervals, with these."""
    rows, known = [], None if prediction.fit is None else prediction.fit.intervals
    for number, (share, time) in enumerate(prediction.branches):
        said = [f"share {share:.4g}", f"relaxes in {written(time, 's')}"]
        if known is not None:
            (low, high), (early, late) = known[number].tolist()
            said[0] += f" ({low:.4g} to {high:.4g})"
            said[1] += f" ({written(early, 's')} to {written(late, 's')})"
        rows.append(("" if number else "branches", " ".join(said)))
    return [*rows, ("", f"share {prediction.plateau:.4g} does not relax")] if rows else []


def _growth(prediction: Prediction) -> list[Row]:
    """How the area grows in all and in each decade, and beside what compliance."""
    growth, effective = prediction.growth, prediction.effective_load
    least, most, last = (100 * slope for slope in (*growth.range, growth.decades[-1][2]))
    low, high, (near, far) = 100 * growth.band[0], 100 * growth.band[1], growth.ratio_band
    rows = [
        (
            "growth",
            f"{prediction.between('A')} = {growth.ratio:.5g}, 95 % band {near:.4g} to {far:.4g}",
        ),
        (
            "in each decade",
            f"{least:.3g} to {most:.3g} % of the first area, {last:.3g} % in the last; "
            f"mean {100 * growth.per_decade:.3g} %, 95 % band {low:.3g} to {high:.3g} %",
        ),
    ]
    if effective is not None:
        name, symbol = prediction.beside
        rows.append((name, f"{prediction.between(symbol)} = {effective[-1] / effective[0]:.5g}"))
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
        if prediction.fit is not None:
            (folder / "solid.toml").write_text(_solid(prediction, prediction.fit), encoding="utf-8")


def _solid(prediction: Prediction, fit: Fit) -> str:
    """The fitted solid as a section of a configuration."""
    known = prediction.assumed
    solid: dict[str, object] = {"kind": "half_space", "modulus": prediction.modulus}
    if known["measured"] == "young":
        solid = {"kind": "half_space", "young": fit.series.modulus, "poisson": known["poisson"]}
    solid["branches"] = list(prediction.branches)
    if prediction.solid.yields:
        solid["hardness"] = prediction.solid.hardness
    table, (first, last) = known["table"] or "A table", fit.data.span
    head = f"# {table} as a sum of exponentials, known from {first:.4g} s to {last:.4g} s."
    if fit.assumed:
        head += f"\n# {fit.assumed.capitalize()}."
    return f"{head}\n{tables_to_toml({'solid': solid})}"


def _write_table(prediction: Prediction, path: Path) -> None:
    """One row a time; numbers to the last digit, with units in the header."""
    unit_of = {name: prediction.dataset[name].attrs["units"] for name in areas_first(select(table=PREDICT))}
    columns = {f"{name} [{unit}]": prediction.series(name) for name, unit in unit_of.items()}
    if prediction.effective_load is not None:
        columns["effective_load [N]"] = prediction.effective_load
    if prediction.friction_force is not None and prediction.friction is not None:
        columns |= {"friction_force [N]": prediction.friction_force, "friction [1]": prediction.friction}
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(columns)
        table.writerows(np.column_stack(list(columns.values())).tolist())
