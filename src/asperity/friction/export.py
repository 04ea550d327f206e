"""Parameters of rate-and-state friction in files for earthquake simulators.

Names are those of the field: a, b, D_c (also L, D_RS, dc), mu_0 (f0) and V_0 (V0). The documentation has a
table of the names in other programs.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from asperity.base import checks
from asperity.base.files import expanded
from asperity.base.version import __version__
from asperity.base.words import tables_to_toml
from asperity.errors import InputError
from asperity.fits import Estimate
from asperity.friction.comparing import StateLaws
from asperity.friction.events import Event
from asperity.friction.laws import STATE_LAWS, StateLaw
from asperity.friction.parameters import MachineFit, RateAndStateFit
from asperity.friction.records import Record

_UNITS = {"D_c": "m", "V_0": "m/s", "stiffness": "1/m", "drift": "1/m"}
_OWN_UNITS = {"D_c": "length of the record", "V_0": "length / time of the record"}
_OWN_UNITS |= dict.fromkeys(("stiffness", "drift"), "1 / length of the record")
_SUFFIXES = {"D_c": "_m", "stiffness": "_per_m", "drift": "_per_m"}


def save_parameters(found: StateLaws, path: Path | str, *, law: StateLaw | None = None) -> None:
    """Write the parameters with their 95 % intervals, units and origin.

    Parameters
    ----------
    path
        A file to write or replace. ``.toml``: the parameters of one law, those of both laws, the verdict and
        the origin; ``.csv``: a line for each law, the preferred one first. `InputError` for another suffix.
    law
        The preferred law; by default `StateLaws.preferred`.
    """
    from asperity.results.store import whole_file  # late, as it brings the solvers

    checks.instance("found", found, StateLaws, "asperity.friction.compare_state_laws(record)")
    target = expanded(path)
    preferred = checks.choice("law", found.preferred if law is None else law, STATE_LAWS)
    writers = {".toml": _toml, ".csv": _csv}
    if target.suffix.lower() not in writers:
        raise InputError("path", expected="a name that ends in .toml or .csv", got=target)
    text = writers[target.suffix.lower()](found, preferred)
    with whole_file(target) as part:
        part.write_text(text, encoding="utf-8")


def columns_of(estimates: Mapping[str, Estimate], *, si: bool) -> dict[str, float]:
    """Value, low and high of each estimate, by names of columns with units."""
    return {
        f"{name}{end}{_SUFFIXES.get(name, '') if si else ''}": float(number)
        for name, estimate in estimates.items()
        for end, number in (("", estimate.value), ("_low", estimate.low), ("_high", estimate.high))
    }


def _origin(laws: StateLaws) -> dict[str, object]:
    method = "residuals of one record" if laws.runs == 1 else "jackknife over surfaces"
    origin = {"surfaces": laws.runs, "intervals_from": method, "record": laws.record.source}
    return origin | {"asperity_version": __version__}


def _toml(laws: StateLaws, law: StateLaw) -> str:
    units = (_UNITS if laws.record.si else _OWN_UNITS) | {"normal_stress": "Pa"}
    estimates = laws.estimates
    values = {each: {name: float(x.value) for name, x in found.items()} for each, found in estimates.items()}
    intervals = {name: [float(x.low), float(x.high)] for name, x in estimates[law].items()}
    parameters = {**values[law], "V_0": float(laws.fits[law].V_0)}
    if laws.record.normal_stress is not None:
        parameters["normal_stress"] = float(laws.record.normal_stress)
    tables: dict[str, Any] = {
        "parameters": {"law": law, **parameters},
        f"intervals_{'at_least_' * laws.fits[law].at_least}95": intervals,
        "units": {name: units.get(name, "1") for name in parameters},
        "laws": {"verdict": laws.verdict, "ln_ratio_of_squares": float(laws.log_ratio.value), **values},
        "origin": _origin(laws),
    }
    heading = "# Rate-and-state friction: mu = mu_0 + a ln(V/V_0) + b ln(V_0 theta/D_c)"
    return f"{heading}\n\n{tables_to_toml(tables)}"


def events_table(fits: Mapping[Event, MachineFit | None], record: Record) -> pd.DataFrame:
    """Holds and steps fitted one by one: each at its displacement of the load point, with 95 % intervals.

    Parameters
    ----------
    fits, record
        Result and argument of `fit_events`.

    Returns
    -------
    DataFrame
        A row for each event, with the fields of `Event`, ``displacement``, and ``a``, ``b``, ``D_c``,
        ``a_minus_b`` and others with ``_low`` and ``_high``; where the record has units, lengths end in
        ``_m``. `determined` is false where D_c is not, and missing where no law fits.
    """
    name = "displacement_m" if record.si else "displacement"
    rows = []
    for event, fit in fits.items():
        place = float(np.interp(event.time, record.time, record.displacement))
        row = event._asdict() | {name: place}
        if fit is not None:
            row |= {**columns_of(fit.estimates, si=record.si), "determined": fit.determined}
        rows.append(row)
    return pd.DataFrame(rows)


def _csv(laws: StateLaws, law: StateLaw) -> str:
    rows: list[dict[str, object]] = []
    for each in sorted(STATE_LAWS, key=lambda name: name != law):
        rows.append(_row(laws, laws.fits[each], laws.estimates[each]))
        rows += [_row(laws, fit, fit.estimates) for fit in [laws.free.get(each)] if fit]
    return pd.DataFrame(rows).to_csv(index=False, na_rep="nan", lineterminator="\n")


def _row(laws: StateLaws, fit: RateAndStateFit, estimates: Mapping[str, Estimate]) -> dict[str, object]:
    si, stress = laws.record.si, laws.record.normal_stress
    row: dict[str, object] = {"law": fit.law, **columns_of(estimates, si=si)}
    row["V_0_m_per_s" if si else "V_0"] = float(fit.V_0)
    row["normal_stress_Pa"] = "" if stress is None else stress
    if isinstance(fit, MachineFit) or laws.record.drive is not None:
        row["stiffness_from"] = fit.stiffness_from
    return row | {"misfit": fit.rms_residual, "verdict": laws.verdict} | _origin(laws)
