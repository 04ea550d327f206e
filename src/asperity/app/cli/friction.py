"""The command ``asperity friction``: rate and state from records of friction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

from cyclopts import Parameter

from asperity.app.cli.command import command
from asperity.app.cli.flags import Folder, Switch
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import DRAWN, READING, RESULTS, Drawn, Reading, Results
from asperity.base.files import kind_of
from asperity.base.words import number
from asperity.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from asperity.base.rows import Row
    from asperity.figures.style import Drawing
    from asperity.friction import Record


@command()
def friction(
    records: list[Path],
    /,
    *,
    law: Literal["best", "aging", "slip"] = "best",
    a: float | None = None,
    stiffness: str | None = None,
    start: Annotated[str | None, Parameter(name="--from")] = None,
    stop: Annotated[str | None, Parameter(name="--to")] = None,
    V_0: Annotated[str | None, Parameter(name="--reference-velocity")] = None,
    events: Literal["all", "holds", "steps"] = "all",
    shear_strength: str | None = None,
    reading: Reading = READING,
    calibration: Path | None = None,
    strength_at_rest: Switch = False,
    out: Folder = Path("friction"),
    results: Results = RESULTS,
    drawn: Drawn = DRAWN,
) -> None:
    """Fit rate-and-state friction to records of sliding with holds or velocity steps.

    The result is a folder with the parameters a, b, D_c, mu_0 and V_0, their 95 % intervals and units, for
    codes of earthquakes (friction.toml, friction.csv), a picture, and a verdict between the aging law and
    the slip law.

    Parameters
    ----------
    records
        The folder of a run with slides, or of a campaign over seeds; or a table or an xlook file with time;
        load point, slip or both; and friction, or shear and normal stress or force. The header has the units:
        time_s, load_point_um, displacement_um, friction. Several records are of different surfaces under
        one protocol; their scatter gives the intervals.
    law
        State law of the parameters; best takes the law that the data prefer.
    a
        Direct effect a, such as 0.01. [default: 0 for runs with a constant shear strength, else fitted]
    stiffness
        Stiffness of the machine: change of friction with length, "1.6e-3 / um"; of shear stress or force, if
        the table has the normal one, "0.16 MPa/um"; fit; or inf, if the load point is the slip. A number is
        compared with a fit. [default: fit, unless the slip is linear in time between holds and steps]
    start
        First time to read, such as 3845s; a number alone has the unit of the table.
    stop
        Last time to read.
    V_0
        Velocity V_0 of the steady friction mu_0, such as "1 um/s". [default: the first of the record]
    events
        What to fit: all, the holds, or the velocity steps.
    shear_strength
        Shear strength of the contacts, such as 50MPa, for runs that did not state it.
    calibration
        Text file for columns in bits, with a line for each: factor, unit, zero in bits; or - for none.
    strength_at_rest
        Take friction at rest in a table for the strength, as in simulations, and not for the force.
    """
    how: dict[str, Any] = {**vars(reading), "strength_at_rest": strength_at_rest}
    how |= {"start": start, "stop": stop, "calibration": calibration}
    strength, reference = (
        None if word is None else cast(float | str, number(word)) for word in (shear_strength, V_0)
    )
    several = [record for path in records for record in _records_at(path, strength, **how)]
    if several[0].si and isinstance(reference, float | int):
        expected, got = "a velocity with its unit, such as 1um/s", f"{reference:g}"
        raise InputError("V_0", expected=expected, got=got)
    new_folder = check_free(out, results)
    # Late: mistakes are reported before the engine is imported.
    from asperity.app.cli.computing import tell_results, write_results
    from asperity.figures.writing import write_each
    from asperity.friction import (
        MachineFit,
        compare_state_laws,
        events_figure,
        events_of,
        events_table,
        fit_events,
        rate_and_state_figure,
        save_parameters,
    )
    from asperity.friction.rows import rows_of_events

    comparison = compare_state_laws(several, a=a, V_0=reference, events=events, stiffness=stiffness)
    fit, fits = comparison.fits[comparison.preferred], None
    if isinstance(fit, MachineFit) and len(events_of(comparison.record)) > 1:
        k = f"{fit.stiffness:.12g} 1/m" if comparison.record.si else fit.stiffness
        fits = fit_events(comparison.record, law=fit.law, stiffness=k)

    def write_all(folder: Path) -> None:
        for kind in ("toml", "csv"):
            save_parameters(comparison, folder / f"friction.{kind}", law=None if law == "best" else law)
        draws: dict[str, Callable[[], Drawing]] = {"friction": lambda: rate_and_state_figure(comparison)}
        if fits is not None:
            table = events_table(fits, comparison.record)
            table.to_csv(folder / "events.csv", index=False)
            if any(fits.values()):
                draws["events"] = lambda: events_figure(table)
        write_each(draws, folder, drawn.formats())

    def rows() -> list[Row]:
        more = [] if fits is None else rows_of_events(fits, comparison.record)
        return [*comparison.rows(str(records[0])), *more]

    tell_results(write_results("fit of friction", new_folder, rows, write_all), new_folder)


def _records_at(path: Path, strength: float | str | None, **how: Any) -> list[Record]:
    from asperity.friction import read_record, record_of

    if not path.is_dir():
        if strength is not None:
            expected = "none for a table, which has friction itself"
            raise InputError("shear_strength", expected=expected, got=strength)
        return [read_record(path, **how)]
    histories = _surfaces(path) if kind_of(path) == "campaign" else [path]
    return [record_of(history, shear_strength=strength) for history in histories]


def _surfaces(path: Path) -> list[xr.Dataset]:
    """The finished runs of a campaign in which nothing but the surfaces differs."""
    import asperity.app.campaign as campaign

    dataset = campaign.open(path)
    swept = {str(dim): n for dim, n in dataset["load"].sizes.items() if dim not in ("seed", "time", "entry")}
    if several := [dim for dim, n in swept.items() if n > 1]:
        expected, got = "a campaign over seeds alone", f"one over {' and '.join(several)}"
        raise InputError(str(path), expected=expected, got=got, advice="a campaign for each of their values")
    runs = dataset.isel(dict.fromkeys(swept, 0))
    every = [runs.isel(seed=n) for n in range(runs.sizes["seed"])] if "seed" in runs.dims else [runs]
    return [run for run in every if run["load"].notnull().any()]
