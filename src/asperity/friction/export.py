"""Parameters of rate-and-state friction as files that programs for earthquakes can be fed from.

Names are those of the field: a, b, D_c (also L, D_RS, dc), mu_0 (f0) and V_0 (V0). The documentation has
a table of what other programs call them.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path

from asperity.base import checks
from asperity.base.version import __version__
from asperity.base.words import tables_to_toml
from asperity.errors import InputError
from asperity.friction.comparing import PARAMETERS, StateLaws
from asperity.friction.laws import STATE_LAWS, StateLaw, state_law
from asperity.results.store import whole_file

_UNITS = {"D_c": "m", "V_0": "m/s", "normal_stress": "Pa"}
_OWN_UNITS = {"D_c": "length of the record", "V_0": "length / time of the record"}


def save_parameters(found: StateLaws, path: Path | str, *, law: StateLaw | None = None) -> None:
    """Write the parameters with their 95 % intervals and units, and where they come from.

    Parameters
    ----------
    found
        From `compare_state_laws`.
    path
        A file to write or replace. ``.toml``: the parameters of one law, both laws beside each other, the
        verdict and the origin; ``.csv``: a line for each law, the preferred one first.
    law
        The law to prefer; by default that of the verdict or, where it is undecided, the one that fits better.

    Raises
    ------
    InputError
        The name has another suffix.
    OutputError
        The disk refused.
    """
    checks.instance("found", found, StateLaws, "asperity.friction.compare_state_laws(record)")
    target, preferred = Path(path), found.preferred if law is None else state_law(law)
    writers = {".toml": _toml, ".csv": _csv}
    if target.suffix.lower() not in writers:
        raise InputError("path", expected="a name that ends in .toml or .csv", got=target)
    text = writers[target.suffix.lower()](found, preferred)
    with whole_file(target) as part:
        part.write_text(text, encoding="utf-8")


def _units(found: StateLaws) -> dict[str, str]:
    lengths = _UNITS if found.record.si else _OWN_UNITS
    return {name: lengths.get(name, "1") for name in (*PARAMETERS, "V_0")}


def _toml(found: StateLaws, law: StateLaw) -> str:
    estimates, record = found.estimates[law], found.record
    stress: dict[str, object] = {}
    if record.normal_stress is not None:
        stress["normal_stress"] = float(record.normal_stress)
    tables: dict[str, dict[str, object]] = {
        "parameters": {
            "law": law,
            **{name: float(estimates[name].value) for name in PARAMETERS},
            "V_0": float(found.fits[law].V_0),
            **stress,
        },
        "intervals_95": {
            name: [float(estimates[name].low), float(estimates[name].high)] for name in PARAMETERS
        },
        "units": {**_units(found), **({"normal_stress": "Pa"} if stress else {})},
        "laws": {
            "verdict": found.verdict,
            "ln_ratio_of_squares": float(found.log_ratio.value),
            **{
                each: {name: float(found.estimates[each][name].value) for name in PARAMETERS}
                for each in STATE_LAWS
            },
        },
        "origin": {
            "record": record.source,
            "surfaces": found.runs,
            "intervals_from": _method(found),
            "asperity_version": __version__,
        },
    }
    heading = "# Rate-and-state friction: mu = mu_0 + a ln(V/V_0) + b ln(V_0 theta/D_c)"
    return f"{heading}\n\n{tables_to_toml(tables)}"


def _csv(found: StateLaws, law: StateLaw) -> str:
    length, speed = ("_m", "_m_per_s") if found.record.si else ("", "")
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    names = [
        f"{name}{part}{length if name == 'D_c' else ''}"
        for name in PARAMETERS
        for part in ("", "_low", "_high")
    ]
    table.writerow(
        [
            *("law", *names, f"V_0{speed}", "normal_stress_Pa"),
            *("verdict", "surfaces", "intervals_from", "record", "asperity_version"),
        ]
    )
    stress = found.record.normal_stress
    for each in sorted(STATE_LAWS, key=lambda one: one != law):
        numbers = [
            float(getattr(found.estimates[each][name], part))
            for name in PARAMETERS
            for part in ("value", "low", "high")
        ]
        table.writerow(
            [
                *(each, *numbers, float(found.fits[each].V_0), "" if stress is None else float(stress)),
                *(found.verdict, found.runs, _method(found), found.record.source, __version__),
            ]
        )
    return stream.getvalue()


def _method(found: StateLaws) -> str:
    return "residuals of one record" if found.runs == 1 else "jackknife over surfaces"
