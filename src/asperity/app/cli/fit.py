"""The command ``asperity fit``: laws of growth fitted to a table of values against hold time."""

from __future__ import annotations

import dataclasses
import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from asperity.app.cli.command import command
from asperity.app.cli.flags import Out, Switch, unit_of
from asperity.app.cli.new_files import check_figures, check_new_file
from asperity.app.cli.options import COLUMNS, DRAWN, READING, CurveColumns, Drawn, Reading
from asperity.errors import InputError


@command()
def fit(
    file: Path,
    /,
    *,
    law: Literal["saturation", "logarithm", "both"] = "both",
    out: Out = Path("fit.png"),
    json: Path | None = None,
    overwrite: Switch = False,
    window: Annotated[tuple[float, float] | None, Parameter(negative=())] = None,
    reading: Reading = READING,
    drawn: Drawn = DRAWN,
    columns: CurveColumns = COLUMNS,
    quantity: str | None = None,
    unit_time: str | None = None,
) -> None:
    """Fit laws of growth to measured values against hold time: contact area, or static friction.

    A single value at time 0 without a standard error is taken as exact. Otherwise values at time 0 are
    measurements like others.

    Parameters
    ----------
    file
        Table of two columns or more with any separator, such as the aging.csv of a run. Lines beginning with
        #, % or ; are comments.
    law
        Law to fit.
    out
        Figure to write (.png, .pdf or .svg).
    json
        File to write all numbers to (.json).
    overwrite
        Replace these files if they exist.
    window
        Hold times T1 T2 between which a straight line gives the growth per decade; the laws are fitted
        to all values. [default: all]
    quantity
        Name of the values in the figure. [default: the name in the header]
    unit_time
        Unit of the hold times, such as s, where the table states none.
    """
    figures = check_figures("--out", out, drawn, overwrite=overwrite, source=file)
    if json is not None:
        numbers_before = check_new_file("--json", json, (".json",), overwrite=overwrite)
    first, last = window or (None, None)
    if window and not 0 <= window[0] < window[1]:
        raise InputError("--window", expected="two times, T1 < T2", got=" ".join(f"{t:g}" for t in window))
    from asperity.fits import measured_growth, read_measurements

    data = read_measurements(file, None, **columns.chosen(), **vars(reading))
    from asperity.app.cli.output import write_figures  # takes a second: mistakes are reported before
    from asperity.app.cli.reports.fit import write_numbers
    from asperity.app.config.mistakes import Door
    from asperity.base.rows import Row, aligned, words_of
    from asperity.figures import fit_figure

    unit = unit_of("--unit-time", unit_time, data.time_unit)
    named = quantity or data.value_name or "value"
    with Door({}, file).answering():  # what computes does not know where the numbers came from
        growth = measured_growth(
            data.time,
            data.value,
            stderr=data.stderr,
            laws=("saturation", "logarithm") if law == "both" else (law,),
            first=first,
            last=last,
            name=data.value_name or "value",
        )
    growth = dataclasses.replace(growth, notes=(*data.remarks, *growth.notes))
    label = quantity or f"{named}  [unit of the table]"
    written = []
    if json is not None:
        write_numbers(growth, json, numbers_before, file=str(file), quantity=named, unit_time=unit)
        written.append(f"numbers written: {json}")
    in_window = window is not None
    draw = partial(fit_figure, growth, quantity=label, unit_time=unit, window=in_window)
    written = write_figures(draw, figures) + written
    rows = [Row("read", data.source), Row("quantity", named), *growth.rows(unit=unit)]
    sys.stdout.write("\n\n".join([aligned(words_of(rows)), "\n".join(written)]).rstrip() + "\n")
