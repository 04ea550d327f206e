"""The command ``asperity infer``: the parameters of a model that a measured curve determines."""

from __future__ import annotations

import functools
import shlex
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from asperity.app.cli.command import command
from asperity.app.cli.flags import Folder, check_unit, naming, unit_of
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import (
    COLUMNS,
    DRAWN,
    INDENTER,
    READING,
    RESULTS,
    CurveColumns,
    Drawn,
    Indenter,
    Reading,
    Results,
)
from asperity.base.words import number
from asperity.errors import InputError, printable

if TYPE_CHECKING:
    from asperity.fits import Measurements


@command()
def infer(
    file: Path,
    /,
    *,
    model: Literal[
        "relaxation", "power", "logarithm", "lattice", "eyring", "healing", "ball", "held", "cone", "punch"
    ] = "relaxation",
    quantity: Literal["depth", "radius", "area"] | None = None,
    branches: int | None = None,
    priors: Path | None = None,
    error: float | str | None = None,
    reading: Reading = READING,
    columns: CurveColumns = COLUMNS,
    unit_time: str | None = None,
    unit_area: str | None = None,
    ramp: str | None = None,
    indenter: Indenter = INDENTER,
    sample: bool = False,
    seed: int = 0,
    walkers: int = 1000,
    workers: int | None = None,
    out: Folder = Path("inference"),
    results: Results = RESULTS,
    drawn: Drawn = DRAWN,
) -> None:
    """Infer which parameters of a model a measured curve of contact area or friction determines.

    The result is a folder: inference.html (read it first), verdicts.csv with a verdict for each parameter
    (determined, bounded, bounded above, bounded below, not identified), priors.toml to change and give again,
    and solid.toml for asperity run and asperity predict.

    Parameters
    ----------
    file
        Table of hold times and areas, static friction or force; for healing also the record of a
        slide-hold-slide test: time, load point or slip, and friction; with --radius or --angle the record of
        an indenter or AFM: time, depth (or height, deflection) and force.
    model
        relaxation: a half-space of some relaxation times; power, logarithm: a half-space whose creep is a
        power or a logarithm of time; lattice: light contacts on the lattice of springs; eyring: contacts
        that flow; healing: friction that grows by B ln(1 + t/time); ball: depth, contact radius or contact
        area of a ball under a constant load, with relaxation times; held: force at a held depth, with
        relaxation times; ball, cone, punch with --radius or --angle: depth and force of an indenter. Other
        models of creep are fitted for comparison.
    quantity
        Quantity that was measured of a ball. [default: from the name of the column]
    branches
        Number of relaxation times, 1 to 3. [default: by Akaike's criterion]
    priors
        TOML file of priors, a table for each parameter: [time_1], kind = "log_uniform", low = "1 s",
        high = "1 h"; other kinds are uniform, normal (mean, deviation) and log_normal (median, factor).
        [default: broad priors, which priors.toml states]
    error
        Standard error of all values, or relative to each, such as 1%, in place of a column. [default: from
        the scatter about the best fit]
    unit_time
        Unit of the hold times, where the table states none. [default: s]
    unit_area
        Unit of the areas, such as mm^2, if their size is to count; 1 for areas over the nominal area
        (lattice); for a ball, unit of its depth, radius or area. [default: only ratios count; what is
        measured of a ball has the unit of the column, if it has one]
    ramp
        Time over which the load rose linearly; times count from its start. [default: instantly]
    sample
        Sample the posterior, which takes minutes, for posterior.nc (ArviZ). By default intervals are profile
        likelihoods by least squares, in seconds.
    seed
        Seed of the random numbers.
    walkers
        With --sample, walkers in each of four ensembles.
    workers
        With --sample, number of processes. [default: one for each core, up to four]
    """
    chosen = columns.chosen()
    if ramp is not None:
        check_unit("--ramp", number(ramp), "s")
    if isinstance(error, float):
        from asperity.base import checks

        checks.number("--error", error, above=0)
    of_curves: dict[str, object] = {"--unit-time": unit_time, "--unit-area": unit_area}
    of_curves |= {f"--column-{name}": column for name, column in chosen.items()}
    tip = indenter.tip() or ({"radius": None} if model in ("cone", "punch") else {})
    if tip:
        facts = {"--error": error, "--quantity": quantity, "--ramp": ramp}
        data = _indentation(file, vars(reading), indenter, of_curves | facts)
    elif model == "healing" and _is_sliding(file):
        from asperity.friction import read_record

        _check_no(of_curves)
        record = read_record(file, **vars(reading))
        data = _Data((record, None, error), record.read)
    else:
        data = _curve(file, chosen, vars(reading), (unit_time, unit_area), error, model, quantity)
    folder = check_free(out, results)
    from asperity.app.cli.computing import compute_into
    from asperity.app.cli.reports.infer import write_inference
    from asperity.ask.files import read_tables
    from asperity.base import checks
    from asperity.base.machine import cores
    from asperity.base.rows import Row
    from asperity.fits.measurements import QUANTITIES
    from asperity.inference import Inference
    from asperity.inference import infer as inferred
    from asperity.inference.sampling import libraries
    from asperity.progress import Progress
    from asperity.results import Checkpoint

    if sample:
        libraries()
    how: dict[str, Any] = {"model": model, "branches": branches, "ramp": ramp or 0.0, **tip, **data.how}
    how |= {"sample": sample, "seed": seed, "walkers": walkers}
    how["priors"] = None if priors is None else read_tables(priors)
    asked = repr((*data.arrays, how))
    how["workers"] = min(cores(), 4) if workers is None else checks.integer("--workers", workers, least=1)

    def compute(progress: Progress, checkpoint: Checkpoint) -> Inference:
        places = {name: f"{file}: {name}" for name in ("time", *QUANTITIES)}
        with naming(**places, absolute="--unit-area"):
            inference = inferred(*data.arrays, **how, progress=progress, checkpoint=checkpoint)
        return replace(inference, remarks=(*data.remarks, *inference.remarks), unit=data.unit)

    typed, source = printable(shlex.join(["asperity", *sys.argv[1:]])), printable(file.name)
    compute_into(
        "inference",
        folder,
        asked,
        compute,
        rows=lambda inference: [Row("read", data.read), *inference.rows()],
        write=functools.partial(write_inference, formats=drawn.formats(), source=source, command=typed),
        every=0.0,
    )


@dataclass(frozen=True)
class _Data:
    """Times and values, or a record; how `asperity.infer` takes them, and how they were read."""

    arrays: tuple[Any, ...]
    read: str
    remarks: tuple[str, ...] = ()
    unit: str = ""
    how: Mapping[str, object] = field(default_factory=dict)


def _is_sliding(file: Path) -> bool:
    from asperity.friction.reading import ROLES
    from asperity.sheets.columns import Columns

    return bool({"load point", "velocity", "displacement"} & {*Columns(file, ROLES).roles})


def _indentation(
    file: Path, reading: dict[str, Any], indenter: Indenter, of_curves: Mapping[str, object]
) -> _Data:
    """The record of an indenter."""
    from asperity.inference import read_indentation

    _check_no(of_curves)
    for flag, value in vars(indenter).items():
        if flag != "poisson" and value not in (None, "fit"):
            units = {"angle": "deg", "spring": "N/m", "drift": "m/s"}
            check_unit(f"--{flag}", number(value), units.get(flag, "m"))
    record, read = read_indentation(file, **reading, **indenter.reading())
    return _Data((record,), read, unit="N")


def _check_no(of_curves: Mapping[str, object]) -> None:
    """Refuse flags of curves for a record."""
    for flag, asked in of_curves.items():
        if asked is not None:
            raise InputError(flag, expected="a table of hold times and values", got="a record")


def _curve(
    file: Path,
    chosen: dict[str, Any],
    reading: dict[str, Any],
    units: tuple[str | None, str | None],
    error: float | str | None,
    model: str,
    quantity: str | None,
) -> _Data:
    """Read times in s, values and errors of a curve."""
    import numpy as np

    from asperity.fits.measurements import errors_beside
    from asperity.sheets.tables import read_table

    if chosen["stderr"] is None and error is None and reading["columns"] is None:
        with naming(stderr="--column-stderr"):
            chosen["stderr"] = errors_beside(read_table(file).names, "its name, or --error 1%")
    table = _measurements(file, {**chosen, **reading}, model, quantity)
    if error is not None and table.stderr is not None:
        raise InputError("--error", expected="none beside --column-stderr", got=error)
    remarks, unit, how = table.remarks, table.value_unit, dict[str, object]()
    unit_time, unit_area = units
    of_value = unit_of("--unit-area", unit_area, table.value_unit)
    if model == "ball":
        quantity, unit_area = quantity or table.quantity, of_value
        if quantity not in ("depth", "radius", "area"):
            expected = "depth, radius or area of the contact of the ball"
            got = f"a column {table.value_name!r}"
            raise InputError("--quantity", expected=expected, got=got, advice="--quantity depth")
        how["quantity"] = quantity
    how["absolute"] = bool(unit_area) and model != "held"
    target, part = "1", "%" if of_value == "%" and model == "healing" else ""  # others compare ratios alone
    if unit_area:
        by_model = {"lattice": "1", "ball": "m^2" if quantity == "area" else "m", "held": "N"}
        target = by_model.get(model, "m^2")
    if unit_area or part:
        unit = target.removeprefix("1")
    if not (unit_time or table.time_unit or model == "lattice"):
        remarks = (*remarks, f"no unit of time beside {table.time_name!r}, taken as s; --unit-time decides")
    of_time = unit_of("--unit-time", unit_time, table.time_unit) or "s"
    if isinstance(error, float):
        table = replace(table, stderr=np.full_like(table.value, error))
    table = replace(table, time_unit="s" if of_time == "1" else of_time, value_unit=unit_area or part)
    table = table.in_units("s", target, ("--unit-time", "--unit-area"))
    errors = error if isinstance(error, str) else table.stderr
    return _Data((table.time, table.value, errors), table.source, remarks, unit, how)


def _measurements(file: Path, how: dict[str, Any], model: str, quantity: str | None) -> Measurements:
    """Read the values of a model; `InputError` with another model for the values that there are."""
    from asperity.fits import read_measurements

    if model == "ball" and not any(how[name] for name in ("columns", "time", "value")):
        from asperity.inference.indenting import is_record  # with the engine

        if is_record(file):
            expected = "the radius of the ball, for a record of depth and force"
            advice, cure = "--columns TIME DEPTH, for depths under a constant load", {"radius": "10um"}
            raise InputError("--radius", expected=expected, got="none", cure=cure, advice=advice)
    wanted: Any = {
        "ball": quantity or ("depth", "radius", "area"),
        "healing": ("friction", "area"),
        "held": "force",
    }.get(model, "area")
    try:
        return read_measurements(file, wanted, **how)
    except InputError as mistake:
        if "quantity" not in mistake.cure:
            raise
        of = {"force": "held", "friction": "healing", "area": "relaxation"}
        better = of.get(str(mistake.cure["quantity"]), "ball")
        if better != model:
            mistake.cure = {"model": better}
        elif model == "healing":
            mistake.cure, mistake.advice = {}, "friction forces divided by the normal load"
        raise mistake.about(mistake.name) from None
