"""What the flags of ``asperity predict`` ask: of a table, of a file of a run, or of numbers alone."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

from asperity.analysis.prediction import Prediction
from asperity.app.cli.flags import OF_TABLES, check_unit, in_flags, keys_for
from asperity.app.config import MeasuredSurface
from asperity.app.config.mistakes import Sections, flag_of
from asperity.app.config.models import SECTIONS
from asperity.app.config.models import Carried as CarriedSection
from asperity.app.config.reading import file_surface, read_config, section_from
from asperity.app.config.solids import POISSON, BesideTable
from asperity.app.predict import predict, predict_config
from asperity.base import units
from asperity.carried import Carried
from asperity.errors import InputError
from asperity.relaxation import arrhenius, wlf


def prediction_asked(
    material: Path | None, flags: Sections, wanted: dict[str, Any], ramp: str | None
) -> tuple[str, Callable[..., Prediction]]:
    """What is asked, in a text that is the same for the same numbers, and what computes it."""
    loading = None if ramp is None else _with_unit("--ramp", ramp, "s")
    compute: Callable[..., Prediction]
    if material is None or material.suffix == ".toml":
        config = read_config(material, _sections(material, flags, wanted))
        asked, compute = repr((config, loading)), functools.partial(predict_config, config)
    else:
        scan, arguments = _scan(flags), _arguments(flags, wanted)
        asked = repr((material, scan, arguments, loading))
        compute = lambda **more: predict(material, scan.build(), **arguments, **more)  # noqa: E731

    def of_flags_alone(**more: Any) -> Prediction:
        with in_flags(_flags_of_arguments(wanted)):
            return compute(ramp=loading, **more)

    return asked, of_flags_alone


def _scan(flags: Sections) -> MeasuredSurface:
    """The surface file that the flags name."""
    given = dict(flags.get("surface", {}))
    if "path" not in given:
        raise InputError("--surface", expected="the file of a scan", got="none", advice="--surface scan.opd")
    return file_surface(Path(str(given.pop("path"))), given)


def _sections(path: Path | None, flags: Sections, wanted: dict[str, Any]) -> Sections:
    """The flags as keys of a run's configuration, where there is no relaxation table."""
    for name, value in wanted.items():
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
    }


def _one_load(flags: Sections) -> None:
    """Refuse none and two."""
    if len(given := flags.get("contact", {})) != 1:
        got = "both" if given else "neither"
        raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")


def _arguments(flags: Sections, wanted: dict[str, Any]) -> dict[str, Any]:
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
        found = section_from(section, model, flags.get(section, {}))
        if not isinstance(found, CarriedSection):
            keys |= found.model_dump(exclude_unset=True)
        elif (carried := found.asked([keys.get("poisson", POISSON)])) is not None:
            keys["carried"] = Carried(**carried)
    keys |= {name: wanted[name] for name in (*OF_TABLES, "branches") if wanted[name] is not None}
    return keys | {"shift": _shift(keys.pop("temperature", None), wanted)}


def _shift(temperature: float | None, wanted: dict[str, Any]) -> float:
    """Factor on the times of the table, from its temperature to that of the contact."""
    reference, energy, constants = (wanted[name] for name in ("reference", "activation_energy", "wlf"))
    if (temperature, reference, energy, constants) == (None, None, None, None):
        return 1.0
    if temperature is None or reference is None:
        flag = "--temperature" if temperature is None else "--reference"
        expected = "the temperatures of contact and table"
        raise InputError(flag, expected=expected, got="none", advice=f"{flag} 25degC")
    kelvin = (temperature, _with_unit("--reference", reference, "K"))
    if (energy is None) == (constants is None):
        expected, got = "an activation energy, or the constants of WLF", "both" if energy else "neither"
        raise InputError("--activation-energy", expected=expected, got=got, advice="100kJ/mol")
    if constants is not None:
        return wlf(constants[0], constants[1], *kelvin)
    return arrhenius(_with_unit("--activation-energy", energy, "J/mol"), *kelvin)


def _with_unit(flag: str, text: str, unit: str) -> float:
    check_unit(flag, text, unit)
    return units.quantity(text, unit, flag)


def _flags_of_arguments(wanted: dict[str, Any]) -> dict[str, str]:
    """Flags of arguments, by their names in Python."""
    keys = {key.name: flag_of(section, key.name) for section, key in keys_for("prediction")}
    others = ("surface", "branches_per_decade", "extrapolate", "ramp", *wanted)
    return keys | {name: _flag(name) for name in others} | OF_TABLES


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"
