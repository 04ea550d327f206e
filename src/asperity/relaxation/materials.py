"""A material: a half-space with the uncertainty and the origin of its parameters."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal, cast, get_args

from annotated_types import Ge, Gt, Le, Lt

from asperity.base import checks, views
from asperity.base import units as si
from asperity.base.files import content_of, expanded
from asperity.base.parameters import Quantity
from asperity.base.words import has_unit
from asperity.errors import InputError, Name, printable
from asperity.relaxation.data import Extrapolate, Measured, Modulus
from asperity.relaxation.files import Kind, read
from asperity.relaxation.fitting import Fit, fit
from asperity.relaxation.series import PronySeries
from asperity.relaxation.temperature import arrhenius
from asperity.relaxation.temperature import wlf as by_wlf
from asperity.sheets.columns import Chosen, Units
from asperity.solids import Solid, half_space
from asperity.solids.arguments import POISSON
from asperity.solids.branches import check_branches
from asperity.solids.continua import checked_poisson

_READING, _FITTING = (
    ("kind", "columns", "units", "stress", "ball_radius", "ball_depth", "noise"),
    ("branches", "per_decade", "extrapolate"),
)
_SHIFT = ("temperature", "reference", "activation_energy", "wlf", "shift")
_Positive = Annotated[float | str | None, Gt(0)]
_ELASTIC, _WORDS = ("modulus", "young", "poisson"), get_args(Modulus)


@dataclass(frozen=True, eq=False)
class Material:
    """A half-space with the uncertainty and the origin of its parameters; `material` makes one.

    Attributes
    ----------
    solid
        The half-space, for `asperity.press`.
    fit
        Fit of the relaxation table, at the temperature of the contact; None without a table.
    draws
        Samples of E* as series, such as a posterior.
    span
        Times of the data, s.
    facts
        Origin of the table and treatment of its numbers, for the provenance.
    """

    solid: Solid
    fit: Fit | None = None
    draws: tuple[PronySeries, ...] = ()
    span: tuple[float, float] = (0.0, math.inf)
    facts: Mapping[str, object] = field(default_factory=dict)

    def __repr__(self) -> str:
        spread = self.fit or (f"{len(self.draws)} draws" if self.draws else "no spread")
        return f"<Material: {self.solid!r}, {spread}>"

    @property
    def spread(self) -> tuple[PronySeries, ...]:
        """Its series, and samples of it from the fit or the draws; empty without either."""
        if self.fit is not None:
            return (self.fit.series, *self.fit.alternatives)
        return (relaxing_of(self.solid), *self.draws) if self.draws else ()


def relaxing_of(solid: Solid) -> PronySeries:
    """The contact modulus of a half-space as it relaxes."""
    return PronySeries(cast(float, solid.modulus), tuple(solid.relaxing))


@views.later
def material_of_file(path: Path, /, **arguments: Any) -> Material:
    """The half-space of [solid] in a TOML file; arguments of `material` replace its keys."""
    raise NotImplementedError


def material(
    source: str | Path | Measured | PronySeries | Solid | None = None,
    *,
    kind: Annotated[
        Kind | None,
        Quantity("quantity in the table, if its header lacks it.", key="table_kind", swept=False),
    ] = None,
    columns: Annotated[
        Chosen | None,
        Quantity(
            "columns by name, or by number from 0: time and modulus, time and compliance, or frequency, "
            "storage and loss modulus. By default those with such names.",
            swept=False,
        ),
    ] = None,
    units: Annotated[
        Units | None,
        Quantity('units in place of those of the table: a column and its unit, such as "E=MPa"', swept=False),
    ] = None,
    stress: Annotated[
        _Positive, Quantity("constant stress of a table of strain against time", "Pa", swept=False)
    ] = None,
    ball_radius: Annotated[
        _Positive, Quantity("radius of the ball whose force at a held depth the table has", "m", swept=False)
    ] = None,
    ball_depth: Annotated[_Positive, Quantity("held depth of this ball", "m", swept=False)] = None,
    noise: Annotated[
        float | None,
        *(Ge(0), Lt(1)),
        Quantity("largest relative rise or fall that is noise. By default 0.05.", swept=False),
    ] = None,
    branches: Annotated[
        int | None,
        Ge(1),
        Quantity(
            "number of free relaxation times in the fit of the table. By default the fewest whose misfit "
            "looks like noise, five at most; else 1 or 2 per decade.",
            key="free_branches",
        ),
    ] = None,
    per_decade: Annotated[
        float | None,
        *(Ge(0.2), Le(10)),
        Quantity(
            "relaxation times per decade of the table; fewer for noisy data. By default as few free times "
            "as fit within the noise, five at most, else 1 or 2 per decade.",
            swept=False,
        ),
    ] = None,
    extrapolate: Annotated[
        Extrapolate | Literal["model"] | None,
        Quantity(
            "assumption beyond the times of the data. plateau: the modulus keeps the last value of the "
            "table. model: the branches continue. By default other times are refused.",
            swept=False,
        ),
    ] = None,
    modulus: Modulus | float | str | None = None,
    young: float | str | None = None,
    poisson: float | None = None,
    temperature: Annotated[
        _Positive,
        Quantity("temperature of the contact, such as 40degC, for activated creep or a table.", "K"),
    ] = None,
    reference: Annotated[_Positive, Quantity("temperature of the table, such as 20degC.", "K")] = None,
    activation_energy: Annotated[
        _Positive,
        Quantity("activation energy of the relaxation times, by Arrhenius, such as 100kJ/mol.", "J/mol"),
    ] = None,
    wlf: Annotated[
        Sequence[float] | None,
        Quantity("constants C1 and C2 of Williams, Landel and Ferry, in its place; C2 in K."),
    ] = None,
    shift: float | None = None,
    hardness: float | str | None = None,
    draws: Sequence[Iterable[Sequence[float | str]]] | None = None,
) -> Material:
    """Make a material for `asperity.predict`. Numbers are in SI units, or texts with a unit: ``"3 GPa"``.

    Parameters
    ----------
    source
        A relaxation table: a file for `read`, or its result. Or a series; a half-space from
        `asperity.solids.half_space`; a TOML file whose ``[solid]`` is a half-space, such as ``solid.toml`` of
        an inference. None: an elastic half-space of `young` or `modulus`.
    kind, columns, units, stress, ball_radius, ball_depth, noise
        Options of `read`. A table that gives the modulus up to a factor needs `young` or `modulus`.
    branches, per_decade, extrapolate
        Options of `fit`. With "model" the branches of an inference also count beyond its data.
    modulus
        Modulus of the table or the series: "young", Young's modulus E; "shear", the shear modulus G;
        "contact", E*. By default from the names of the columns, else E. Or a number: the instantaneous E*, to
        which their shares apply.
    young
        The instantaneous Young's modulus, in place of this number.
    poisson
        Poisson's ratio, 0.35 by default, which does not relax: E* = E/(1 - nu^2) = 2 G/(1 - nu).
    temperature, reference
        Temperatures of the contact, and of table or series, K: shift all times by Arrhenius or WLF.
    activation_energy, wlf
        The energy, J/mol; or the constants c1 and c2 (K). See `arrhenius` and `asperity.relaxation.wlf`.
    shift
        Factor on all times, in place of these four.
    hardness
        Pressure under which the rough surface yields; see `asperity.solids.Solid.with_hardness`.
    draws
        Samples of the branches of a solid, such as draws of a posterior: 2 lists or more of pairs of a share
        of the modulus and a relaxation time, s.

    Raises
    ------
    InputError
        An argument is out of range, or does not apply to the source.
    """
    arguments = {name: value for name, value in locals().items() if name != "source" and value is not None}
    if isinstance(source, str | Path) and Path(source).suffix == ".toml":
        return material_of_file(expanded(source), **arguments)
    description, names = _about(source)
    for name in arguments:
        if name not in (*names, "hardness"):
            raise InputError(name, expected=f"none beside {description}", got=checks.shown(arguments[name]))

    def chosen(names: Iterable[str]) -> dict[str, Any]:
        """Those of the arguments that are given."""
        return {name: arguments[name] for name in names if name in arguments}

    if isinstance(source, Solid):
        solid = source.with_hardness(hardness)
        return Material(solid, draws=_draws(draws, solid))
    factor = _shift(chosen(_SHIFT))
    measured: Any = modulus if isinstance(modulus, str) and modulus in _WORDS else None
    fitted: Fit | None = None
    series: PronySeries | None = None
    if isinstance(source, PronySeries):
        series = source.shifted(factor)
    elif source is not None:
        how = chosen(_READING) | {"modulus": measured}
        table = read(source, **how) if isinstance(source, str | Path) else source
        fitted = fit(table.shifted(factor), **chosen(_FITTING))
        if not fitted.data.absolute:
            known, measured = _known(arguments)
            absolute = fitted.data.scaled(known / fitted.series.modulus)
            fitted = replace(fitted, series=replace(fitted.series, modulus=known), data=absolute)
        series, measured = fitted.series, measured or fitted.data.measured
    modulus_arguments, of = _instantaneous(series, measured, arguments)
    solid = half_space(**modulus_arguments, branches=series.branches if series else (), hardness=hardness)
    span = series.span if series else (0.0, math.inf)
    if fitted is None:
        return Material(solid, draws=_draws(draws, solid), span=span)
    ratio = None if of == "contact" else arguments.get("poisson", None if of == "shares" else POISSON)
    facts = {"measured": of, "poisson": ratio, "shift": factor, **_origin(source, fitted)}
    return Material(solid, fitted, span=span, facts=facts)


def _about(source: object) -> tuple[str, tuple[str, ...]]:
    if source is None:
        return "an elastic solid", _ELASTIC
    if isinstance(source, Solid):
        return "a solid, for it is about a relaxation table", ("draws",)
    if isinstance(source, PronySeries):
        return "a series, for it is about a relaxation table", (*_ELASTIC, *_SHIFT, "draws")
    if isinstance(source, str | Path | Measured):
        of_file = _READING if isinstance(source, str | Path) else ()
        description = "a relaxation table" if of_file else "a table that was read"
        return description, (*of_file, *_FITTING, *_ELASTIC, *_SHIFT)
    expected = "a relaxation table or its file, a series, or a half-space"
    advice = "asperity.relaxation.read(path)"
    raise InputError("material", expected=expected, got=checks.kind_of(source), advice=advice)


def _shift(how: Mapping[str, Any]) -> float:
    """Factor on all times: `shift`, or that of Arrhenius or WLF."""
    if how.keys() <= {"shift"}:
        return checks.number("shift", how.get("shift", 1.0), above=0)
    for name in ("temperature", "reference"):
        if name not in how:
            expected = "the temperatures of contact and table"
            raise InputError(name, expected=expected, got="none", advice=f"{name}='25 degC'")
    ways = how.keys() - {"temperature", "reference"}
    if len(ways) != 1:
        expected, advice = "an activation energy, or the constants of WLF", "activation_energy='100 kJ/mol'"
        got = "both" if ways else "neither"
        raise InputError("activation_energy", expected=expected, got=got, advice=advice)
    kelvin = [si.quantity(how[name], "K", name) for name in ("temperature", "reference")]
    if (wlf := how.get("wlf")) is not None:
        if len(wlf) != 2:
            raise InputError("wlf", expected="two constants, C1 and C2", got=checks.shown(wlf))
        return by_wlf(*wlf, *kelvin)
    return arrhenius(si.quantity(how.get("activation_energy"), "J/mol", "activation_energy"), *kelvin)


def _instantaneous(
    series: PronySeries | None, measured: Any, arguments: dict[str, Any]
) -> tuple[dict[str, Any], str]:
    """The instantaneous modulus, as arguments of `half_space`; and the modulus that the series has."""
    ratio = checked_poisson("poisson", arguments.get("poisson", POISSON))
    moduli = {name: arguments[name] for name in ("modulus", "young") if name in arguments}
    word = moduli.get("modulus")
    if isinstance(word, str) and word in _WORDS:
        del moduli["modulus"]
    elif isinstance(word, str) and not has_unit(word):
        expected = "'young', 'shear' or 'contact', or the instantaneous E*, such as '3 GPa'"
        raise InputError("modulus", expected=expected, got=checks.shown(word))
    if moduli or series is None:
        return moduli | ({"poisson": ratio} if "young" in moduli else {}), "shares"
    if measured == "contact":
        return {"modulus": series.modulus}, measured
    factor = 2 * (1 + ratio) if measured == "shear" else 1
    return {"young": series.modulus * factor, "poisson": ratio}, measured or "young"


def _known(arguments: dict[str, Any]) -> tuple[float, Modulus]:
    """Take the number of the modulus, which a table gives up to a factor, and which modulus it is."""
    which: dict[str, Modulus] = {"young": "young", "modulus": "contact"}
    for name in which:
        if name in arguments and arguments[name] not in _WORDS:
            return checks.number(name, si.quantity(arguments.pop(name), "Pa", name), above=0), which[name]
    expected = "the instantaneous modulus beside a table that gives it up to a factor"
    advice = (Name("young"), ", ", Name("stress"), " of a strain, or ", Name("ball_radius"), " of a force")
    raise InputError("young", expected=expected, got="none", advice=advice)


def _draws(draws: Sequence[Iterable[Sequence[float | str]]] | None, solid: Solid) -> tuple[PronySeries, ...]:
    if draws is None:
        return ()
    if not solid.relaxing:
        raise InputError("draws", expected="branches of the solid, in whose place they may be", got="none")
    if not hasattr(draws, "__len__") or len(draws) < 2:
        raise InputError("draws", expected="2 lists of branches or more", got=checks.shown(draws))
    solids, modulus = [], relaxing_of(solid).modulus
    for number, branches in enumerate(draws):
        try:
            solids.append(PronySeries(modulus, check_branches(branches)))
        except InputError as error:
            raise error.about(f"draws[{number}]: {error.name}") from None
    return tuple(solids)


def _origin(table: object, fitted: Fit) -> dict[str, object]:
    path = expanded(table) if isinstance(table, str | Path) else None
    facts: dict[str, object] = {"table": "", "table_sha256": ""}
    if path is not None:
        facts = {"table": printable(path.name), "table_sha256": hashlib.sha256(content_of(path)).hexdigest()}
    facts |= {"kind": type(fitted.data).__name__, "points": int(fitted.data.columns[0].size)}
    return facts | ({"extrapolate": fitted.data.extrapolate} if fitted.data.extrapolate else {})
