"""What the flags of ``asperity predict`` ask: of a table, of a file of a run, or of numbers alone."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.app.cli.flags import check_unit, flag, in_flags, keys_for
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.mistakes import Sections, flag_of
from asperity.app.config.models import SECTIONS, Output
from asperity.app.config.models import Carried as CarriedSection
from asperity.app.config.reading import config_from, file_surface, read_config, section_from
from asperity.app.config.solids import OF_TABLES, BesideTable
from asperity.base import units
from asperity.base.parameters import parameters_of
from asperity.errors import InputError
from asperity.protocols import KINDS
from asperity.relaxation import Material
from asperity.relaxation import material as material_of
from asperity.solids.arguments import POISSON

if TYPE_CHECKING:
    from asperity.analysis import Prediction


_ARGUMENTS = {key: name for name, key in OF_TABLES.items()}
"""Arguments of `asperity.relaxation.material` by keys of another name."""


def _named(wanted: Iterable[str], *sections: str) -> dict[str, str]:
    """Flags by the arguments that they stand for, of some sections or of all."""
    named = {
        _ARGUMENTS.get(key.name, key.name): flag_of(section, key.name)
        for section, key in keys_for("prediction")
        if section in sections or not sections
    }
    return named | {name: flag(name) for name in (*wanted, "extrapolate")}


def prediction_asked(
    material: Path | None, flags: Sections, wanted: dict[str, Any], ramp: str | None
) -> tuple[str, Callable[..., Prediction], Output]:
    """What is asked, in a text that is the same for the same numbers; what computes it; what is written."""
    loading = None if ramp is None else _with_unit("--ramp", ramp, "s")
    legs: Any = flags.get("protocol", {}).get("legs", [])
    _check_units(legs)
    compute: Callable[..., Prediction]
    if material is None or material.suffix == ".toml":
        config = read_config(material, _sections(material, flags, wanted))
        asked, compute = repr((config, loading)), functools.partial(_of_config, config)
        output = config.output
    else:
        scan, of_table, how = _scan(flags), *_arguments(flags, wanted)
        if legs:
            how["protocol"] = config_from({}, {"protocol": {"legs": legs}}, None).written_out
        asked = repr((material, scan, of_table, how, loading))
        output = section_from("output", Output, flags.get("output", {}))
        with in_flags(_named(wanted, "solid") | {"units": "--unit"}):
            table = material_of(material, **of_table)
        compute = functools.partial(_of_table, table, scan, how)

    def of_flags_alone(**more: Any) -> Prediction:
        with in_flags(_named(("surface", "ramp")) | ({"protocol": "--leg"} if legs else {})):
            return compute(ramp=loading, **more)

    return asked, of_flags_alone, output


def _of_config(config: RunConfig, **more: Any) -> Prediction:
    from asperity.app.predict import predict_config  # takes a second: mistakes are reported before

    return predict_config(config, **more)


def _of_table(table: Material, scan: MeasuredSurface, how: dict[str, Any], **more: Any) -> Prediction:
    from asperity.analysis import predict  # likewise
    from asperity.carried import Carried

    carried = Carried(**how["carried"]) if "carried" in how else None
    return predict(table, scan.build(), **{**how, "carried": carried}, **more)


def _scan(flags: Sections) -> MeasuredSurface:
    keys = dict(flags.get("surface", {}))
    if "path" not in keys:
        raise InputError("--surface", expected="the file of a scan", got="none", advice="--surface scan.opd")
    return file_surface(Path(str(keys.pop("path"))), keys)


def _sections(path: Path | None, flags: Sections, wanted: dict[str, Any]) -> Sections:
    """The flags as keys of a run's configuration, where there is no relaxation table."""
    about = [flag(name) for name, value in wanted.items() if value is not None]
    if path is None:
        about += [flag_of("solid", key) for key in flags.get("solid", {}) if key in _ARGUMENTS]
    if about:
        expected, got = "a relaxation table, which it is about", f"{path or 'none'}"
        raise InputError(about[0], expected=expected, got=got)
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


def _check_units(legs: Sequence[Mapping[str, Any]]) -> None:
    """Refuse legs with a number that has no unit, where it is of a quantity that has one."""
    for leg in legs:
        _check_units(leg.get("legs", []))
        kind = str(leg["kind"])
        parameters = parameters_of(KINDS[kind]) if kind in KINDS else {}
        for name in filter(parameters.__contains__, leg):
            if unit := parameters[name].quantity.unit:
                check_unit(f"--leg {kind}: {name}", str(leg[name]), unit)


def _one_load(flags: Sections) -> None:
    contact: dict[str, Any] = flags.get("contact", {})
    legs: Any = flags.get("protocol", {}).get("legs", [])
    rises = bool(legs) and legs[0]["kind"] == "ramp"
    if len(contact) != 1 and (contact or not rises):
        got = "both" if contact else "neither"
        raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")


def _arguments(flags: Sections, wanted: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """What `asperity.relaxation.material` takes besides a table, and `asperity.predict` besides a scan.

    `AsperityError` for flags that are wrong.
    """
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
    asked = section_from("solid", BesideTable, solid).model_dump(exclude_unset=True)
    of_table = {_ARGUMENTS.get(key, key): value for key, value in asked.items()}
    if "poisson" in of_table:
        of_table["poisson"] = of_table["poisson"][0]
    of_table |= {name: value for name, value in wanted.items() if value is not None}
    of_table |= {
        name: _with_unit(flag(name), wanted[name], unit)
        for name, unit in (("reference", "K"), ("activation_energy", "J/mol"))
        if wanted[name] is not None
    }
    how: dict[str, Any] = {}
    for section, model in SECTIONS.items():
        section_keys = section_from(section, model, flags.get(section, {}))
        if isinstance(section_keys, Output):
            how["instrument"] = section_keys.instrument
        elif not isinstance(section_keys, CarriedSection):
            how |= section_keys.model_dump(exclude_unset=True)
        elif (carried := section_keys.asked([of_table.get("poisson", POISSON)])) is not None:
            how["carried"] = carried
    return of_table, how


def _with_unit(name: str, text: str, unit: str) -> float:
    check_unit(name, text, unit)
    return units.quantity(text, unit, name)
