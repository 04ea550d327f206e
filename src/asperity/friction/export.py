"""Parameters of rate-and-state friction as files that programs for earthquakes can be fed from.

Names are those of the field: a, b, D_c (also L, D_RS, dc), mu_0 (f0) and V_0 (V0). The documentation has
a table of what other programs call them.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from asperity.base import checks
from asperity.base.files import expanded
from asperity.base.version import __version__
from asperity.base.words import tables_to_toml
from asperity.errors import InputError
from asperity.fits import Estimate
from asperity.friction.comparing import StateLaws
from asperity.friction.laws import STATE_LAWS, StateLaw, state_law
from asperity.friction.parameters import MachineFit, RateAndStateFit

_UNITS = {"D_c": "m", "V_0": "m/s", "stiffness": "1/m", "drift": "1/m"}
_OWN_UNITS = {"D_c": "length of the record", "V_0": "length / time of the record"}
_OWN_UNITS |= dict.fromkeys(("stiffness", "drift"), "1 / length of the record")
_SUFFIXES = {"D_c": "_m", "stiffness": "_per_m", "drift": "_per_m"}


def save_parameters(found: StateLaws, path: Path | str, *, law: StateLaw | None = None) -> None:
    """Write the parameters with their 95 % intervals and units, and where they come from.

    Parameters
    ----------
    path
        A file to write or replace. ``.toml``: the parameters of one law, both laws beside each other, the
        verdict and the origin; ``.csv``: a line for each law, the preferred one first. `InputError` for
        another suffix.
    law
        The law to prefer; by default that of the verdict or, where it is undecided, the one that fits better.
    """
    from asperity.results.store import whole_file  # late, as it brings the solvers

    checks.instance("found", found, StateLaws, "asperity.friction.compare_state_laws(record)")
    target, preferred = expanded(path), found.preferred if law is None else state_law(law)
    writers = {".toml": _toml, ".csv": _csv}
    if target.suffix.lower() not in writers:
        raise InputError("path", expected="a name that ends in .toml or .csv", got=target)
    text = writers[target.suffix.lower()](found, preferred)
    with whole_file(target) as part:
        part.write_text(text, encoding="utf-8")


def columns_of(estimates: Mapping[str, Estimate], *, si: bool) -> dict[str, float]:
    """Value, low and high of each number, by the names of columns with their units."""
    return {
        f"{name}{end}{_SUFFIXES.get(name, '') if si else ''}": float(number)
        for name, one in estimates.items()
        for end, number in (("", one.value), ("_low", one.low), ("_high", one.high))
    }


def _origin(found: StateLaws) -> dict[str, object]:
    method = "residuals of one record" if found.runs == 1 else "jackknife over surfaces"
    origin = {"surfaces": found.runs, "intervals_from": method, "record": found.record.source}
    return origin | {"asperity_version": __version__}


def _toml(found: StateLaws, law: StateLaw) -> str:
    units = (_UNITS if found.record.si else _OWN_UNITS) | {"normal_stress": "Pa"}
    values: dict[str, dict[str, float]] = {
        each: {name: float(one.value) for name, one in found.estimates[each].items()} for each in STATE_LAWS
    }
    parameters = {**values[law], "V_0": float(found.fits[law].V_0)}
    if found.record.normal_stress is not None:
        parameters["normal_stress"] = float(found.record.normal_stress)
    tables: dict[str, dict[str, object]] = {
        "parameters": {"law": law, **parameters},
        "intervals_95": {
            name: [float(one.low), float(one.high)] for name, one in found.estimates[law].items()
        },
        "units": {name: units.get(name, "1") for name in parameters},
        "laws": {
            "verdict": found.verdict,
            "ln_ratio_of_squares": float(found.log_ratio.value),
            **values,
        },
        "origin": _origin(found),
    }
    heading = "# Rate-and-state friction: mu = mu_0 + a ln(V/V_0) + b ln(V_0 theta/D_c)"
    return f"{heading}\n\n{tables_to_toml(tables)}"


def _csv(found: StateLaws, law: StateLaw) -> str:
    rows: list[dict[str, object]] = []
    for each in sorted(STATE_LAWS, key=lambda one: one != law):
        rows.append(_row(found, found.fits[each], found.estimates[each]))
        rows += [_row(found, fit, fit.estimates) for fit in [found.free.get(each)] if fit]
    return pd.DataFrame(rows).to_csv(index=False, na_rep="nan", lineterminator="\n")


def _row(found: StateLaws, fit: RateAndStateFit, estimates: Mapping[str, Estimate]) -> dict[str, object]:
    """A line of the table."""
    si, stress = found.record.si, found.record.normal_stress
    row: dict[str, object] = {"law": fit.law, **columns_of(estimates, si=si)}
    row |= {
        "V_0_m_per_s" if si else "V_0": float(fit.V_0),
        "normal_stress_Pa": "" if stress is None else stress,
    }
    if isinstance(fit, MachineFit):
        row["stiffness_from"] = "fitted" if fit.stiffness_stderr > 0 else "given"
    return row | {"misfit": fit.rms_residual, "verdict": found.verdict} | _origin(found)
