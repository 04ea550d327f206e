"""From a relaxation table or a solid, a scan and a load to the growth of the real contact: the prediction."""

from __future__ import annotations

import hashlib
import inspect
import json
import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr

from asperity.aging.march import DEFAULT_RTOL
from asperity.analysis.observation import observe
from asperity.analysis.prediction import Prediction, growth_of, resolved
from asperity.analysis.scan import written
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.models import Contact as ContactSection
from asperity.app.config.solids import POISSON, HalfSpace
from asperity.app.runs.defaults import USUAL_MAPS, hold_times
from asperity.app.runs.pipeline import bytes_a_site, check_units, completed, recorded_times
from asperity.base import checks, units
from asperity.base.machine import require
from asperity.base.words import counted as how_many
from asperity.errors import InputError, Remark
from asperity.lattice import Field
from asperity.progress import Progress, listener
from asperity.protocols import Hold, Ramp
from asperity.relaxation import Fit, Measured, fit
from asperity.relaxation import read as read_table
from asperity.relaxation.data import Extrapolate
from asperity.relaxation.files import Kind
from asperity.results import Checkpoint
from asperity.simulate import age, press
from asperity.solids import Solid, contact_modulus, half_space
from asperity.solids.continua import checked_poisson
from asperity.surfaces import Surface, read

Modulus = Literal["young", "shear", "contact"]

_SITE, _BRANCH = 340, 85
"""Bytes a site that a separable solid needs, and that each branch adds; and each branch of a map 8 of them.

Measured on 512 x 512 sites with six maps: 418 with one branch, 1323 with eight.
"""

_LEAST_TIMES = 5

_TOUCH = 1e-3
"""Part of the time to the first that is recorded, after which a ramp begins with the load of then: there is
no contact without a load. What creeps until then is left out."""

_UNEVEN = 1.5
"""Ratio of steps across rows to steps along them, above which a remark is made."""

_OF_TABLES = (
    *("kind", "columns", "noise", "modulus", "poisson", "shift"),
    *("branches", "branches_per_decade", "extrapolate"),
)
"""Arguments that are about a relaxation table."""

_RUN = "asperity run, which takes the same file"


def predict(
    material: str | Path | Measured | Solid,
    surface: str | Path | Surface,
    *,
    load: float | str | None = None,
    pressure: float | str | None = None,
    kind: Kind | None = None,
    columns: Sequence[int | str] | None = None,
    noise: float = 0.05,
    modulus: Modulus = "young",
    poisson: float = POISSON,
    shift: float = 1.0,
    hardness: float | str | None = None,
    first: float | str | None = None,
    last: float | str | None = None,
    per_decade: int = 4,
    branches: int | None = None,
    branches_per_decade: float | None = None,
    extrapolate: Extrapolate | None = None,
    ramp: float | str | None = None,
    shear_strength: float | str | None = None,
    pixel: float | str | None = None,
    blur: float | str | None = None,
    threshold: float = 0.5,
    protocol: None = None,
    progress: Progress | bool | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
) -> Prediction:
    """Predict how the contact of a rough rigid surface with a half-space grows under a load that stays.

    Numbers are in SI units, or texts with a unit: ``"1 MPa"``.

    Parameters
    ----------
    material
        Relaxation modulus, creep compliance, or storage and loss modulus: a file for
        `asperity.relaxation.read`, or what that returns. Or a half-space whose numbers are known, such as one
        with a local law of creep, from `asperity.solids.half_space`.
    surface
        The scan: a file for `asperity.surfaces.read`, with reflecting edges, or a `Surface` with units. One
        that is made of a scan and its mirror images is taken as that scan with reflecting edges.
    load, pressure
        Normal load, N; or in its place load over nominal area, Pa. It stays once it is put on.
    kind, columns, noise
        How to read the file of the table, see `asperity.relaxation.read`.
    modulus
        What the table measures: "young", Young's modulus E; "shear", the shear modulus G; "contact", E*.
    poisson
        Poisson's ratio, which does not relax: E* = E/(1 - nu^2) = 2 G/(1 - nu).
    shift
        Factor on all times of the table, for another temperature; see `asperity.relaxation.arrhenius` and
        ``wlf``.
    hardness
        Pressure under which the rough surface yields, Pa; see `asperity.solids.Solid.with_hardness`.
    first, last
        Times, s, between which to predict; by default all that the table spans and that are after the ramp,
        and never more than the table spans, unless `extrapolate` says so. Without a table both are needed.
    per_decade
        Times recorded in each decade.
    branches, branches_per_decade
        How many free relaxation times the fit of the table has; or how many in each decade, from 0.2 to 10.
        By default few free ones, where these suffice, see `asperity.relaxation.fit`.
    extrapolate
        "plateau": the last modulus of the table is assumed to stay for later times, up to `last`.
    ramp
        Time, s, within which the load is put on, in proportion to time; by default at once. All times count
        from the start of the loading.
    shear_strength
        Of the contacts, Pa: gives friction (Tabor).
    pixel, blur, threshold
        An instrument through which to look at the contact, see `asperity.observe`; by default none.
    protocol
        None: the load stays. Slides and loads that change are refused; `asperity.age` follows them.
    progress
        True for a bar, in notebooks as on terminals; or who is told how far it has come.
    checkpoint
        Where aging keeps its place; see `asperity.age`.

    Returns
    -------
    Prediction

    Raises
    ------
    AsperityError
        Something given is wrong, or does not fit together; a solver did not converge.

    Notes
    -----
    A generalized Maxwell half-space is separable, and the load never falls: the contact at each time is the
    exact one, see `asperity.age`. Local laws of creep and a hardness are followed in time steps.

    References
    ----------
    H. Farain, D. Bonn, Nat. Commun. 14, 3606 (2023): frictional aging from bulk relaxation.
    """
    given = locals()
    which = checks.one_of('pressure="1 MPa"', load=load, pressure=pressure)
    amount = _quantity(which, given[which], "N" if which == "load" else "Pa")
    strength = None if shear_strength is None else _quantity("shear_strength", shear_strength, "Pa")
    if modulus not in get_args(Modulus):
        raise InputError("modulus", expected="'young', 'shear' or 'contact'", got=checks.shown(modulus))
    density = checks.integer("per_decade", per_decade, least=1, most=1000)
    checked_poisson("poisson", poisson)
    loading = _ramp(ramp)
    if branches_per_decade is not None:
        checks.number("branches_per_decade", branches_per_decade, least=0.2, most=10)
    if protocol:
        raise _no_protocol("protocol", "asperity.press, and asperity.age with the protocol")
    facts: dict[str, object] = {}
    found: Fit | None = None
    with listener(progress) as listening:
        if isinstance(material, Solid):
            for name in _OF_TABLES:
                if given[name] != inspect.signature(predict).parameters[name].default:
                    expected = "none beside a solid, for it is about a relaxation table"
                    raise InputError(name, expected=expected, got=checks.shown(given[name]))
            solid = material
        else:
            listening.stage("reading the relaxation table")
            factor = checks.number("shift", shift, above=0)
            if isinstance(material, str | Path):
                table = _table_with_units(material, kind, columns, noise)
            else:
                table = material
            how: dict[str, Any] = {"per_decade": branches_per_decade, "branches": branches}
            found = fit(table, extrapolate=extrapolate, **how)
            if factor != 1:
                found = fit(found.data.shifted(factor), **how)
            stiffness = _contact_modulus(found.series.modulus, modulus, poisson)
            solid = half_space(modulus=stiffness, branches=found.series.branches)
            facts = {"measured": modulus, "poisson": None if modulus == "contact" else poisson}
            facts |= {"shift": factor, **_origin(material, found)}
        solid = solid.with_hardness(hardness)
        times = _times(found, first, last, density, loading)
        listening.stage("reading the scan")
        if isinstance(surface, str | Path):
            surface = read(surface, periodic="reflect")
        advice = "asperity.surfaces.Surface(heights, unit='m', pixel_size=(dy, dx), length_unit='m')"
        scan = checks.instance("surface", surface, Surface, advice)
        if scan.provenance.get("periodic_rule") == "mirror":
            scan = replace(scan.scan, provenance={**scan.provenance, "periodic_rule": "reflect"})
        return _predicted(
            scan,
            solid,
            found,
            times,
            pressed={which: amount},
            ramp=loading,
            strength=strength,
            instrument=_instrument(pixel=pixel, blur=blur, threshold=threshold),
            facts=facts,
            progress=listening,
            checkpoint=checkpoint,
        )


def predict_config(
    config: RunConfig,
    progress: Progress,
    *,
    ramp: float | str | None = None,
    checkpoint: Checkpoint | None = None,
) -> Prediction:
    """Predict from the configuration of a run: the same solid, surface, load and times as `execute` takes.

    The load is put on at once, or within a ramp, see `predict`; in a file also by a protocol of a ramp from
    load 0 and a hold. `AsperityError` as `predict`; or the configuration asks for what is no prediction.
    """
    config, loading = _loading(config, _ramp(ramp))
    asked = {"[contact] separation": config.contact.separation, "[aging] hold": config.aging.hold}
    for name, value in asked.items():
        if value not in (None, "load"):
            raise InputError(name, expected="a load that stays", got=value, advice=_RUN)
    section = config.solid
    if not isinstance(section, HalfSpace):
        raise _no_half_space("[solid] kind", section.kind)
    chosen = config.surface
    if isinstance(chosen, MeasuredSurface) and chosen.periodic == "mirror":
        if config.contact.load is not None:
            expected = "'reflect' beside a load, for one on mirrored copies is that of all of them"
            got = "'mirror'" if "periodic" in chosen.model_fields_set else "none, which is 'mirror'"
            advice = "periodic = 'reflect', or a pressure"
            raise InputError("[surface] periodic", expected=expected, got=got, advice=advice)
        chosen = chosen.model_copy(update={"periodic": "reflect"})
    aging = config.aging
    if aging.times is None and aging.first is None and config.span[0] < loading < config.span[1]:
        config = config.model_copy(update={"aging": aging.model_copy(update={"first": loading})})
    progress.stage("reading the scan")
    scan, solid, found = chosen.build(), section.build(), section.fit
    check_units(config, solid, scan)
    maps_asked = config.output.maps_at
    config, remarks = completed(config.model_copy(update={"surface": chosen}), scan)
    times = recorded_times(config)
    times = times[times > 0]
    listed = config.aging.times is not None
    if times.size < _LEAST_TIMES:
        name, advice = (
            ("times", "more times") if listed else ("per_decade", "a later last or more per_decade")
        )
        expected = f"{_LEAST_TIMES} times or more after 0"
        raise InputError(f"[aging] {name}", expected=expected, got=f"{times.size}", advice=advice)
    _check_span(f"[aging] {'times' if listed else 'last'}", times[0], times[-1])
    _check_ramp(loading, times[-1])
    idle = (
        ("[friction] rate_coefficient", config.friction.rate_coefficient),
        ("[output] maps_at", maps_asked),
    )
    if unused := [name for name, value in idle if value is not None]:
        remarks = (*remarks, f"a prediction does not use {' and '.join(unused)}")
    facts: dict[str, object] = {}
    if found is not None:
        measured = "young" if section.modulus is None and section.young is None else "shares"
        facts = {"measured": measured, "poisson": next(iter(section.poisson or []), None), "shift": 1.0}
        facts |= _origin(section.relaxation, found)
    prediction = _predicted(
        scan,
        solid,
        found,
        times,
        pressed=config.contact.model_dump(exclude_none=True),
        ramp=loading,
        strength=config.friction.shear_strength,
        instrument=_instrument(**config.output.instrument),
        facts=facts,
        progress=progress,
        checkpoint=checkpoint,
        rtol=config.aging.rtol,
    )
    return replace(prediction, remarks=tuple(dict.fromkeys((*remarks, *prediction.remarks))))


def _loading(config: RunConfig, ramp: float) -> tuple[RunConfig, float]:
    """A load with the ramp that puts it on, where a protocol says them; any other protocol is refused."""
    match config.legs:
        case ():
            return config, ramp
        case (Ramp(separation=None, approach=None) as up, Hold(hold=None | "load") as held) if (
            config.contact.load == 0 and not ramp and up.mobility == held.mobility == 1
        ):
            asked = {
                "contact": ContactSection(load=up.load, pressure=up.pressure),
                "aging": config.aging.model_copy(update={"last": up.duration + held.duration}),
                "protocol": [],
            }
            return config.model_copy(update=asked), up.duration
    raise _no_protocol("[[protocol]]", _RUN, ", or a ramp from load 0 and a hold")


def _predicted(
    scan: Surface,
    solid: Solid,
    found: Fit | None,
    times: Field,
    *,
    pressed: dict[str, Any],
    ramp: float,
    strength: float | None,
    instrument: dict[str, Any],
    facts: dict[str, object],
    progress: Progress,
    checkpoint: str | Path | Checkpoint | None,
    rtol: float = DEFAULT_RTOL,
) -> Prediction:
    """Press a scan, follow the contact, and weigh what is known of the spread."""
    if scan.heights.ndim != 2:
        raise InputError("surface", expected="a scan of two axes", got="a profile", advice="a scan")
    scan.in_meters()
    if solid.kind != "half_space":
        raise _no_half_space("material", solid.kind)
    branches = len(solid.branches)
    maps = sorted({times[0], *times[np.linspace(0, times.size - 1, USUAL_MAPS).round().astype(int)]})
    separable = _SITE + branches * (_BRANCH + 8 * len(maps))
    require(separable if solid.separable else bytes_a_site(solid, scan.shape, len(maps)), scan.shape)
    progress.stage(f"pressing {' x '.join(map(str, scan.shape))} sites")
    try:
        contact = press(scan, solid, **pressed)
    except InputError as error:
        name, amount = next(iter(pressed.items()))
        if (error.name, name) != ("load", "pressure") or not solid.yields:
            raise
        expected = f"clearly less than the hardness, {written(solid.hardness, 'Pa')}"
        got, advice = written(amount, "Pa"), "a lower pressure, or a greater hardness"
        raise InputError(name, expected=expected, got=got, advice=advice) from None
    if instrument:
        observe(contact, **instrument)  # refuses before minutes have passed
    progress.stage("aging", times=times.tolist())
    how: dict[str, Any] = {"rtol": rtol, "progress": progress.reached, "checkpoint": checkpoint}
    if ramp:
        dataset = _ramped(scan, solid, pressed, ramp, times, maps, **how)
    else:
        dataset = age(contact, times, fields_at=maps, **how).dataset
    facts |= {"shear_strength": strength, "pressed_by": next(iter(pressed)), "rtol": rtol, "ramp": ramp}
    dataset = dataset.drop_vars("u0", errors="ignore").assign_attrs(prediction=json.dumps(facts))
    progress.stage("weighing the spread of the table and of the scan")
    prediction = Prediction(
        dataset,
        found,
        solid,
        growth_of(dataset, found, ramp=ramp),
        resolved(dataset),
        shear_strength=strength,
        observed=tuple(
            observe(dataset.isel(field_time=n), **instrument) for n in range(len(maps) if instrument else 0)
        ),
    )
    return replace(prediction, remarks=(*scan.remarks, *_remarks(prediction, scan)))


def _ramped(
    scan: Surface,
    solid: Solid,
    pressed: dict[str, Any],
    ramp: float,
    times: Field,
    maps: Sequence[float],
    **how: Any,
) -> xr.Dataset:
    """The history of a load that is put on within a ramp, at the times, which count from its start."""
    begun = _TOUCH * min(ramp, float(times[0]))
    contact = press(scan, solid, **{name: begun / ramp * value for name, value in pressed.items()})
    legs = [Ramp(ramp - begun, **pressed), Hold(float(times[-1]) - ramp)]
    dataset = age(contact, times - begun, protocol=legs, fields_at=np.array(maps) - begun, **how).dataset
    # A protocol records its switches, too.
    distance = np.abs(dataset["time"].values[:, np.newaxis] - (times - begun))
    dataset = dataset.isel(time=np.append(0, distance.argmin(axis=0))).drop_vars("leg")
    moments = {"time": np.append(0.0, times), "field_time": np.array(maps)}
    return dataset.assign_coords({name: dataset[name].copy(data=at) for name, at in moments.items()})


def _instrument(
    pixel: float | str | None = None, blur: float | str | None = None, threshold: float = 0.5
) -> dict[str, Any]:
    """What looks at the contact, for `asperity.observe`; empty for none."""
    if pixel is None and blur is None:
        return {}
    return {"pixel": pixel, "blur": 0.0 if blur is None else blur, "threshold": threshold}


def _no_protocol(name: str, advice: str, otherwise: str = "") -> InputError:
    """What is said of slides and of loads that change."""
    expected = f"none{otherwise}, for a prediction is of a load that stays"
    return InputError(name, expected=expected, got="legs", advice=advice)


def _no_half_space(name: str, kind: str) -> InputError:
    """What is said of other solids."""
    advice = "asperity run, or asperity.press and asperity.age, which follow it without a band"
    return InputError(name, expected="a relaxation table or a half_space", got=kind, advice=advice)


def _origin(table: object, found: Fit) -> dict[str, object]:
    """What identifies a table."""
    path = Path(table) if isinstance(table, str | Path) else None
    facts: dict[str, object] = {"table": "", "table_sha256": ""}
    if path is not None:
        with path.open("rb") as stream:
            facts = {"table": path.name, "table_sha256": hashlib.file_digest(stream, "sha256").hexdigest()}
    facts |= {"kind": type(found.data).__name__, "points": int(found.data.columns[0].size)}
    return facts | ({"extrapolate": found.data.extrapolate} if found.data.extrapolate else {})


def _table_with_units(
    path: str | Path, kind: Kind | None, columns: Sequence[int | str] | None, noise: float
) -> Measured:
    """Read a table whose columns name their units: a modulus in MPa taken for Pa is a wrong prediction."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", Remark)
        try:
            return read_table(path, kind=kind, columns=columns, noise=noise)
        except Remark as remark:
            expected, advice = "columns that name their units", "a header such as time [s],E [MPa]"
            got = str(remark).partition(", taken as ")[0]
            raise InputError("relaxation", expected=expected, got=got, advice=advice) from None


def _quantity(name: str, given: object, unit: str) -> float:
    return checks.number(name, units.quantity(given, unit, name), above=0, expected=f"more than 0 {unit}")


def _ramp(given: float | str | None) -> float:
    """Time within which the load is put on, s; 0 for at once."""
    return 0.0 if given is None else _quantity("ramp", given, "s")


def _times(
    found: Fit | None,
    first: float | str | None,
    last: float | str | None,
    per_decade: int,
    ramp: float,
) -> Field:
    """Times to record: of the table, and no others but on a plateau after it."""
    if found is None and (first is None or last is None):
        name, expected = "first" if first is None else "last", "a time, for no table spans any"
        raise InputError(name, expected=expected, got="none", advice='first="1 ms", last="10 days"')
    begin, end = (0.0, math.inf) if found is None else found.series.span
    stop = found.data.span[1] if found is not None and last is None else _quantity("last", last, "s")
    _check_ramp(ramp, stop)
    start = max(begin, ramp) if first is None else _quantity("first", first, "s")
    if not start < stop:
        raise InputError("last", expected=f"a time after the first, {start:.4g} s", got=f"{stop:.4g} s")
    for name, time in (("first", start), ("last", stop)):
        if not begin * (1 - 1e-9) <= time <= end * (1 + 1e-9):
            expected = f"a time that the table spans, {begin:.3g} s to {end:.3g} s"
            advice = "a table of more decades"
            if time > end:
                advice = "extrapolate=plateau"
            raise InputError(name, expected=expected, got=f"{time:.4g} s", advice=advice)
    _check_span("last", start, stop)
    least = math.ceil(_LEAST_TIMES / math.log10(stop / start))
    return hold_times(first=start, last=stop, per_decade=max(per_decade, least))


def _check_ramp(ramp: float, last: float) -> None:
    """Refuse a loading that is not over by the last time."""
    if ramp >= last:
        expected = f"less than the last time, {last:.4g} s"
        raise InputError("ramp", expected=expected, got=f"{ramp:.4g} s", advice="a later last")


def _check_span(name: str, first: float, last: float) -> None:
    """Refuse times in less than a decade, of which no growth per decade can be told."""
    if last < 10 * first * (1 - 1e-9):
        expected, advice = "times that span a decade or more", "a later last"
        raise InputError(name, expected=expected, got=f"{first:.4g} s to {last:.4g} s", advice=advice)


def _contact_modulus(modulus: float, measured: Modulus, poisson: float) -> float:
    if measured == "contact":
        return modulus
    young = modulus if measured == "young" else 2 * (1 + poisson) * modulus
    return contact_modulus(young, poisson)


def _remarks(prediction: Prediction, scan: Surface) -> tuple[str, ...]:
    """What limits the prediction, in numbers."""
    between_rows, along_rows = scan.describe().neighbor_steps
    first, last = prediction.resolved[0], prediction.resolved[-1]
    fraction = float(prediction.series("contact_fraction")[-1])
    pressure = float(prediction.series("mean_contact_pressure")[0])
    strain = pressure / prediction.modulus
    remarks = []
    known, fit = prediction.solid.parameters, prediction.fit
    if fit is not None and fit.assumed:
        remarks.append(fit.assumed)
    if prediction.solid.creep is None and not known.get("branches") and "flow" not in known:
        remarks.append("nothing grows: the solid is elastic")
    elif np.ptp(prediction.series("contact_area")) == 0:
        reason = ": creep has not begun" if prediction.solid.creep is not None and fraction < 1 else ""
        remarks.append(f"the contact does not grow by {written(float(prediction.time[-1]), 's')}{reason}")
    if early := int((prediction.time < prediction.ramp).sum()):
        remarks.append(
            f"{how_many(early, 'recorded time is', 'recorded times are')} before the end of the loading, "
            f"{written(prediction.ramp, 's')}: there the load still rises, and the area with it"
        )
    if between_rows > _UNEVEN * along_rows:
        remarks.append(
            f"heights change {between_rows / along_rows:.2g} times as much from row to row as along a row: "
            "if that is noise of the scan's lines, their ridges carry load that asperities would carry"
        )
    if first.in_small > 0.2:
        remarks.append(
            f"{100 * first.in_small:.0f} % of the area at first lies in patches of fewer than 10 pixels: "
            "the scan does not resolve them, and a finer one would change the area"
        )
    if first.rim > 0.2:
        remarks.append(
            f"the rim takes {100 * first.rim:.0f} % of the counted area at first: patches are few pixels wide"
        )
    if first.patches < 30:
        remarks.append(f"{first.patches} patches at first: too few for the statistics of a surface")
    if strain > 0.05 and not prediction.solid.yields:
        remarks.append(
            f"the mean contact pressure is {written(pressure, 'Pa')} at first, {100 * strain:.2g} % of E*: "
            "real asperities would flow, and nothing flows at once here; try a hardness"
        )
    if fraction > 0.5:
        remarks.append(
            f"{100 * fraction:.0f} % of the surface touches at last: waves longer than the scan, "
            "which it does not have, would keep bodies further apart"
        )
    if fit is not None and (fit.systematic or fit.series.error > 0.05):
        error = f"{100 * fit.series.error:.2g} %"
        remarks.append(
            f"the fit misses the table by up to {error} in waves, not by noise, so that the band has no part "
            "of the table: more branches per decade may follow it"
            if fit.systematic
            else f"the fit misses the table by up to {error}, which looks like noise"
        )
    if last.patches < first.patches / 2 and fraction <= 0.5:
        remarks.append(f"patches merge: {first.patches} at first, {last.patches} at last")
    return tuple(remarks)
