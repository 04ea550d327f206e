"""From a relaxation table or a solid, a scan and a load to the growth of the real contact: the prediction."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from asperity.aging.march import DEFAULT_RTOL
from asperity.analysis.observation import observe
from asperity.analysis.plausible import remarks_on_contact
from asperity.analysis.prediction import Prediction, growth_of, resolved
from asperity.analysis.scan import written
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.solids import POISSON, HalfSpace, contact_modulus_of
from asperity.app.predict.bandwidth import bands_of
from asperity.app.predict.checked import (
    LEAST_TIMES,
    RUN,
    check_ramp,
    check_span,
    instrument_of,
    loading_of,
    no_half_space,
    no_protocol,
    quantity,
    series_with,
    times_within,
)
from asperity.app.predict.words import remarks_on
from asperity.app.runs.defaults import USUAL_MAPS
from asperity.app.runs.pipeline import (
    bytes_a_site,
    carried_by,
    check_units,
    completed,
    recorded_times,
    remarks_on_edges,
)
from asperity.base import checks
from asperity.base.columns import Chosen, Units
from asperity.base.files import content_of, expanded
from asperity.base.machine import require
from asperity.carried import Carried
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Progress, listener
from asperity.protocols import Hold, Ramp
from asperity.relaxation import Fit, Measured, PronySeries, fit
from asperity.relaxation import read as read_table
from asperity.relaxation.data import Extrapolate, Modulus
from asperity.relaxation.files import Kind
from asperity.results import Checkpoint, History
from asperity.simulate import age, press
from asperity.solids import Solid, half_space
from asperity.solids.continua import checked_poisson
from asperity.surfaces import Surface, read


def predict(
    material: str | Path | Measured | Solid,
    surface: str | Path | Surface,
    *,
    load: float | str | None = None,
    pressure: float | str | None = None,
    kind: Kind | None = None,
    columns: Chosen | None = None,
    units: Units | None = None,
    noise: float = 0.05,
    modulus: Modulus | None = None,
    poisson: float = POISSON,
    shift: float = 1.0,
    hardness: float | str | None = None,
    first: float | str | None = None,
    last: float | str | None = None,
    per_decade: int = 4,
    branches: int | None = None,
    branches_per_decade: float | None = None,
    extrapolate: Extrapolate | None = None,
    draws: Sequence[Iterable[Sequence[float | str]]] | None = None,
    ramp: float | str | None = None,
    shear_strength: float | str | None = None,
    carried: Carried | None = None,
    pixel: float | str | None = None,
    blur: float | str | None = None,
    threshold: float = 0.5,
    resolution_study: bool = False,
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
    kind, columns, units, noise
        How to read the file of the table, see `asperity.relaxation.read`.
    modulus
        What the table measures: "young", Young's modulus E; "shear", the shear modulus G; "contact", E*. By
        default what the names of its columns say, else Young's modulus.
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
    draws
        Branches that may be in place of those of a solid, such as draws of a posterior: 2 lists or more of
        pairs of a share of the modulus and a relaxation time, s. Their spread is in the bands.
    ramp
        Time, s, within which the load is put on, in proportion to time; by default at once. All times count
        from the start of the loading.
    shear_strength
        Of the contacts, Pa: gives friction (Tabor).
    carried
        What else to record at each time: stiffness, resistances, what sticks; see `asperity.age`.
    pixel, blur, threshold
        An instrument through which to look at the contact, see `asperity.observe`; by default none.
    resolution_study
        Whether to predict the same from the scan without its short waves, 4, 8, 16 and 32 pixels, too:
        `Prediction.bands` then says which of the results a finer scan would change.
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
    which = checks.one_of('pressure="1 MPa"', load=load, pressure=pressure)
    amount = quantity(which, *((load, "N") if which == "load" else (pressure, "Pa")))
    strength = None if shear_strength is None else quantity("shear_strength", shear_strength, "Pa")
    if modulus not in (None, *get_args(Modulus)):
        raise InputError("modulus", expected="'young', 'shear' or 'contact'", got=checks.shown(modulus))
    density = checks.integer("per_decade", per_decade, least=1, most=1000)
    checked_poisson("poisson", poisson)
    loading = 0.0 if ramp is None else quantity("ramp", ramp, "s")
    if branches_per_decade is not None:
        checks.number("branches_per_decade", branches_per_decade, least=0.2, most=10)
    if protocol:
        raise no_protocol("protocol", "asperity.press, and asperity.age with the protocol")
    facts: dict[str, object] = {}
    found: Fit | None = None
    series: tuple[PronySeries, ...] = ()
    with listener(progress) as listening:
        if isinstance(material, Solid):
            of_a_table = {
                **{"kind": (kind, None), "columns": (columns, None), "units": (units, None)},
                **{"noise": (noise, 0.05), "modulus": (modulus, None)},
                **{"poisson": (poisson, POISSON), "shift": (shift, 1.0)},
                **{"branches": (branches, None), "branches_per_decade": (branches_per_decade, None)},
                "extrapolate": (extrapolate, None),
            }
            for name, (told, usual) in of_a_table.items():
                if told != usual:
                    expected = "none beside a solid, for it is about a relaxation table"
                    raise InputError(name, expected=expected, got=checks.shown(told))
            solid = material
            series = series_with(draws, solid)
        else:
            if draws is not None:
                expected = "none beside a relaxation table, whose noise gives draws"
                raise InputError("draws", expected=expected, got=checks.shown(draws))
            listening.stage("reading the relaxation table")
            factor = checks.number("shift", shift, above=0)
            table = (
                read_table(material, kind=kind, columns=columns, units=units, modulus=modulus, noise=noise)
                if isinstance(material, str | Path)
                else material
            )
            how: dict[str, Any] = {"per_decade": branches_per_decade, "branches": branches}
            found = fit(table, extrapolate=extrapolate, **how)
            if factor != 1:
                found = fit(found.data.shifted(factor), **how)
            measured = modulus or found.data.measured or "young"
            stiffness = contact_modulus_of(found, poisson, measured)
            solid = half_space(modulus=stiffness, branches=found.series.branches)
            facts = {"measured": measured, "poisson": None if measured == "contact" else poisson}
            facts |= {"shift": factor, **_origin(material, found)}
        solid = solid.with_hardness(hardness)
        times = times_within(found, first, last, density, loading)
        listening.stage("reading the scan")
        if isinstance(surface, str | Path):
            surface = read(surface)
        advice = "asperity.surfaces.Surface(heights, unit='m', pixel_size=(dy, dx), length_unit='m')"
        scan = checks.instance("surface", surface, Surface, advice)
        return _predicted(
            scan.scan,
            solid,
            found,
            times,
            pressed={which: amount},
            ramp=loading,
            series=series,
            strength=strength,
            carried=carried,
            study=resolution_study,
            instrument=instrument_of(pixel=pixel, blur=blur, threshold=threshold),
            facts=facts,
            progress=listening,
            checkpoint=checkpoint,
        )


def predict_config(
    config: RunConfig,
    progress: Progress,
    *,
    ramp: float | str | None = None,
    resolution_study: bool = False,
    checkpoint: Checkpoint | None = None,
) -> Prediction:
    """Predict from the configuration of a run: the same solid, surface, load and times as `execute` takes.

    The load is put on at once, or within a ramp, see `predict`; in a file also by a protocol of a ramp from
    load 0 and a hold. `AsperityError` as `predict`; or the configuration asks for what is no prediction.
    """
    config, loading = loading_of(config, 0.0 if ramp is None else quantity("ramp", ramp, "s"))
    asked = {"[contact] separation": config.contact.separation, "[aging] hold": config.aging.hold}
    for name, value in asked.items():
        if value not in (None, "load"):
            raise InputError(name, expected="a load that stays", got=value, advice=RUN)
    section = config.solid
    if not isinstance(section, HalfSpace):
        raise no_half_space("[solid] kind", section.kind)
    chosen = config.surface
    if isinstance(chosen, MeasuredSurface) and chosen.rule == "mirror":
        if config.contact.load is not None:
            expected = "'reflect' beside a load, for one on mirrored copies is that of all of them"
            advice = "periodic = 'reflect', or a pressure"
            raise InputError("[surface] periodic", expected=expected, got="'mirror'", advice=advice)
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
    if times.size < LEAST_TIMES:
        name, advice = "per_decade", "a later last or more per_decade"
        if listed:
            name, advice = "times", "more times"
        expected = f"{LEAST_TIMES} times or more after 0"
        raise InputError(f"[aging] {name}", expected=expected, got=f"{times.size}", advice=advice)
    check_span(f"[aging] {'times' if listed else 'last'}", times[0], times[-1])
    check_ramp(loading, times[-1])
    idle = {"[friction] rate_coefficient": config.friction.rate_coefficient, "[output] maps_at": maps_asked}
    if unused := [name for name, value in idle.items() if value is not None]:
        remarks = (*remarks, f"a prediction does not use {' and '.join(unused)}")
    facts: dict[str, object] = {}
    if found is not None:
        is_modulus = section.modulus is None and section.young is None
        facts = {"measured": (found.data.measured or "young") if is_modulus else "shares"}
        facts |= {"poisson": next(iter(section.poisson or []), None), "shift": 1.0}
        facts |= _origin(section.relaxation, found)
    prediction = _predicted(
        scan,
        solid,
        found,
        times,
        pressed=config.contact.model_dump(exclude_none=True),
        ramp=loading,
        series=series_with(section.draws, solid),
        strength=config.friction.shear_strength,
        carried=carried_by(config),
        study=resolution_study,
        instrument=instrument_of(**config.output.instrument),
        facts=facts,
        progress=progress,
        checkpoint=checkpoint,
        rtol=config.aging.rtol,
    )
    return replace(prediction, remarks=tuple(dict.fromkeys((*remarks, *prediction.remarks))))


def _predicted(
    scan: Surface,
    solid: Solid,
    found: Fit | None,
    times: Field,
    *,
    pressed: dict[str, Any],
    ramp: float,
    series: tuple[PronySeries, ...],
    strength: float | None,
    carried: Carried | None,
    study: bool,
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
    plain = replace(scan, filled=None)  # load on filled pixels is remarked at the end, of all maps
    if not solid.half_space:
        raise no_half_space("material", solid.kind)
    maps = sorted({times[0], *times[np.linspace(0, times.size - 1, USUAL_MAPS).round().astype(int)]})
    require(bytes_a_site(solid, scan.shape, len(maps), free=scan.edges == "free", held=True), scan.shape)
    progress.stage(f"pressing {' x '.join(map(str, scan.shape))} sites")
    # There is no contact without a load but where the scan is highest: a ramp begins there.
    legs = [Ramp(ramp, **pressed), Hold(float(times[-1]) - ramp)] if ramp else None
    at_first = {"load": 0.0} if ramp else pressed

    def followed(surface: Surface, at: list[float]) -> History:
        return age(press(surface, solid, **at_first), at, protocol=legs, rtol=rtol)

    try:
        contact = press(plain, solid, **at_first)
        if instrument:
            observe(contact, **instrument)  # refuses before minutes have passed
        progress.stage("aging", times=times.tolist())
        how: dict[str, Any] = {"rtol": rtol, "progress": progress.reached, "checkpoint": checkpoint}
        dataset = age(contact, times, protocol=legs, fields_at=maps, carried=carried, **how).dataset
    except InputError as error:
        name, amount = next(iter(pressed.items()))
        if error.name != "load" or name != "pressure" or not solid.yields:
            raise
        expected = f"clearly less than the hardness, {written(solid.hardness, 'Pa')}"
        got, advice = written(amount, "Pa"), "a lower pressure, or a greater hardness"
        raise InputError(name, expected=expected, got=got, advice=advice) from None
    if ramp:  # switches between legs were recorded, too
        asked = np.isin(dataset["time"], times)
        dataset = dataset.isel(time=np.append(0, np.flatnonzero(asked))).drop_vars("leg")
    bands = bands_of(plain, followed, times[[0, -1]].tolist(), progress) if study else ()
    facts |= {"shear_strength": strength, "pressed_by": next(iter(pressed)), "rtol": rtol, "ramp": ramp}
    facts |= {"draws": len(series) - 1} if series else {}
    dataset = dataset.drop_vars("u0", errors="ignore").assign_attrs(prediction=json.dumps(facts))
    progress.stage("weighing the spread of the table and of the scan")
    if found is not None:
        series = (found.series, *found.alternatives)
    looked_at = (dataset.isel(field_time=n) for n in range(len(maps) if instrument else 0))
    prediction = Prediction(
        dataset,
        found,
        solid,
        growth_of(dataset, series, ramp=ramp),
        resolved(dataset),
        shear_strength=strength,
        observed=tuple(observe(one, **instrument) for one in looked_at),
        bands=bands,
    )
    on_contact = remarks_on_contact(scan, solid, dataset, prediction.resolved)
    remarks = *scan.remarks, *remarks_on_edges(scan), *on_contact
    return replace(prediction, remarks=(*remarks, *remarks_on(prediction)))


def _origin(table: object, found: Fit) -> dict[str, object]:
    """What identifies a table."""
    path = expanded(table) if isinstance(table, str | Path) else None
    facts: dict[str, object] = {"table": "", "table_sha256": ""}
    if path is not None:
        facts = {"table": path.name, "table_sha256": hashlib.sha256(content_of(path)).hexdigest()}
    facts |= {"kind": type(found.data).__name__, "points": int(found.data.columns[0].size)}
    return facts | ({"extrapolate": found.data.extrapolate} if found.data.extrapolate else {})
