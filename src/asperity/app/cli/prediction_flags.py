"""What the flags of ``asperity predict`` ask: of a table, of a file of a run, or of numbers alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.app.cli.flags import check_unit, file_of_run, flag, in_flags
from asperity.app.config.mistakes import Sections, flag_of
from asperity.app.config.models import Output
from asperity.app.config.reading import read_config
from asperity.base import units
from asperity.base.parameters import parameters_of
from asperity.errors import ConfigError, InputError
from asperity.protocols import KINDS

if TYPE_CHECKING:
    from asperity.analysis import Prediction

_ARGUMENTS = ("surface", "ramp", "load", "pressure", "first", "last", "per_decade", "extrapolate", "hardness")
"""Arguments of the library that are flags of the same name."""


def prediction_asked(
    material: Path | None, flags: Sections, ramp: str | None
) -> tuple[str, Callable[..., Prediction], Output]:
    """What is asked, in a text that is the same for the same numbers; what computes it; what is written."""
    legs: Any = flags.get("protocol", {}).get("legs", [])
    if ramp is not None:
        check_unit("--ramp", ramp, "s")
    loading = None if ramp is None else units.quantity(ramp, "s", "--ramp")
    _check_units(legs)
    if material is None or material.suffix != ".toml":
        contact, rises = flags.get("contact", {}), bool(legs) and legs[0]["kind"] == "ramp"
        if len(contact) != 1 and (contact or not rises):
            got = "both" if contact else "neither"
            raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")
        if material is None and "young" not in flags.get("solid", {}):
            expected = "a relaxation table, a TOML file, or --young"
            raise InputError("material", expected=expected, got="none", advice="asperity predict --help")
    file = file_of_run(material, flags)
    try:
        config = read_config(file, flags)
    except ConfigError as error:  # the table is no flag here
        foreign = re.compile("^--relaxation: (?!expected)|; try adhesion.*")
        lines = (foreign.sub("", line).replace("--relaxation", "material") for line in error.problems)
        raise ConfigError(list(lines)) from None
    named = {f"[{section}] {key}": flag_of(section, key) for section, keys in flags.items() for key in keys}
    named |= {name: flag(name) for name in _ARGUMENTS} | ({"protocol": "--leg"} if legs else {})

    def compute(**more: Any) -> Prediction:
        from asperity.app.predict import predict_config  # takes a second: mistakes are reported before

        with in_flags(named):
            return predict_config(config, ramp=loading, **more)

    return repr((config, loading)), compute, config.output


def _check_units(legs: Sequence[Mapping[str, Any]]) -> None:
    """Refuse legs with a number that has no unit, where it is of a quantity that has one."""
    for leg in legs:
        _check_units(leg.get("legs", []))
        kind = str(leg["kind"])
        parameters = parameters_of(KINDS[kind]) if kind in KINDS else {}
        for name in filter(parameters.__contains__, leg):
            if unit := parameters[name].quantity.unit:
                check_unit(f"--leg {kind}: {name}", str(leg[name]), unit)
