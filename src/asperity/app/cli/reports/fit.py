"""All numbers of a fit of growth as JSON."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

from asperity.base.files import Standing
from asperity.base.words import finite
from asperity.fits import FitResult, MeasuredGrowth
from asperity.fits.result import parameters_of
from asperity.results.store import whole_file

_PER_DECADE = math.log(10)
_SLOPES = ("slope", "B", "relative")


def write_numbers(growth: MeasuredGrowth, path: Path, replaceable: Standing, **origin: str) -> None:
    """Write all numbers and their origin as JSON, with null for infinity."""
    comparison = {} if growth.comparison is None else vars(growth.comparison)
    numbers = {name: value for name, value in comparison.items() if name not in growth.fits}
    facts = {
        **origin,
        "points": growth.points,
        "initial_points": growth.initial_points,
        "fits": {law: _numbers(fit) for law, fit in growth.fits.items()},
        "initial_from": growth.initial_from,
        "straight_line": None if growth.rate is None else _numbers(growth.rate),
        "comparison": numbers or None,
        "notes": list(growth.notes),
    }
    text = json.dumps(finite(facts), indent=2, allow_nan=False)
    with whole_file(path, overwrite=replaceable) as part:
        part.write_text(f"{text}\n", encoding="utf-8")


def _numbers(fit: FitResult) -> dict[str, object]:
    """Every number of a fit under its name on the terminal; slopes also per decade."""
    names = parameters_of(fit)
    numbers: dict[str, object] = {}
    for field in dataclasses.fields(fit):
        if field.name in names:
            shown = "A0" if field.name == "initial_area" else field.name
            facts = (*fit.known(field.name), *fit.interval(field.name))
            scales = {"_per_efold": 1.0, "_per_decade": _PER_DECADE} if field.name in _SLOPES else {"": 1.0}
            for suffix, factor in scales.items():
                value, stderr, *ends = (factor * fact for fact in facts)
                numbers[shown + suffix] = {"value": value, "stderr": stderr, "interval": ends}
        elif field.name.removesuffix("_stderr") not in names:
            numbers[field.name] = getattr(fit, field.name)
    return numbers
