"""From a relaxation table, a scan and a load to the growth of the real contact: the prediction."""

from __future__ import annotations

import functools
import hashlib
import json
import math
import warnings
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np

import asperity.checks as checks
import asperity.units as units
from asperity.analysis.observation import observe
from asperity.analysis.prediction import Prediction, growth_of, resolved
from asperity.analysis.scan import written
from asperity.errors import InputError, Remark
from asperity.lattice import Field
from asperity.memory import require
from asperity.progress import progress_shown
from asperity.relaxation import Fit, Measured, fit
from asperity.relaxation import read as read_table
from asperity.relaxation.files import Kind
from asperity.results import Checkpoint
from asperity.runs.defaults import USUAL_MAPS, hold_times
from asperity.runs.pipeline import Progress, Silent
from asperity.simulate import age, press
from asperity.solids import contact_modulus, half_space
from asperity.surfaces import Surface, read

Modulus = Literal["young", "shear", "contact"]

_SITE, _BRANCH = 340, 85
"""Bytes a site that a run needs, and that each branch adds; and each branch of a map 8 of them.

Measured on 512 x 512 sites with six maps: 418 with one branch, 1323 with eight.
"""

_LEAST_TIMES = 5

_UNEVEN = 1.5
"""Ratio of steps across rows to steps along them, above which a remark is made."""


def predict(
    relaxation: str | Path | Measured,
    surface: str | Path | Surface,
    *,
    load: float | str | None = None,
    pressure: float | str | None = None,
    kind: Kind | None = None,
    columns: Sequence[int | str] | None = None,
    noise: float = 0.05,
    modulus: Modulus = "young",
    poisson: float = 0.35,
    shift: float = 1.0,
    first: float | str | None = None,
    last: float | str | None = None,
    per_decade: int = 4,
    branches_per_decade: float = 1.0,
    shear_strength: float | str | None = None,
    pixel: float | str | None = None,
    blur: float | str | None = None,
    threshold: float = 0.5,
    progress: Progress | bool | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
) -> Prediction:
    """Predict how the contact of a rough rigid surface with a viscoelastic half-space grows under a load.

    Numbers are in SI units, or texts with a unit: ``"1 MPa"``.

    Parameters
    ----------
    relaxation
        Relaxation modulus, creep compliance, or storage and loss modulus: a file for
        `asperity.relaxation.read`, or what that returns.
    surface
        The scan: a file for `asperity.surfaces.read`, with reflecting edges, or a `Surface` with units. One
        that is made of a scan and its mirror images is taken as that scan with reflecting edges.
    load, pressure
        Normal load, N; or in its place load over nominal area, Pa. It is put on at once, and stays.
    kind, columns, noise
        How to read the file of the table, see `asperity.relaxation.read`.
    modulus
        What the table measures: "young", Young's modulus E; "shear", the shear modulus G; "contact", E*.
    poisson
        Poisson's ratio, which does not relax: E* = E/(1 - nu^2) = 2 G/(1 - nu).
    shift
        Factor on all times of the table, for another temperature; see `asperity.relaxation.arrhenius` and
        ``wlf``.
    first, last
        Times, s, between which to predict; by default all that the table spans, and never more.
    per_decade
        Times recorded in each decade.
    branches_per_decade
        Relaxation times that the fit has in each decade of the table, from 0.2 to 10: more of them for data
        with few distinct times, fewer for noisy data.
    shear_strength
        Of the contacts, Pa: gives friction (Tabor).
    pixel, blur, threshold
        An instrument through which to look at the contact, see `asperity.observe`; by default none.
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
    exact one, see `asperity.age`. Neither holds for local laws of creep or while a surface slides, for which
    there are `asperity.age` and `asperity.protocols`.

    References
    ----------
    H. Farain, D. Bonn, Nat. Commun. 14, 3606 (2023): frictional aging from bulk relaxation.
    """
    which = checks.one_of('pressure="1 MPa"', load=load, pressure=pressure)
    given = load if which == "load" else pressure
    amount = _quantity(which, given, "N" if which == "load" else "Pa")
    strength = None if shear_strength is None else _quantity("shear_strength", shear_strength, "Pa")
    if modulus not in get_args(Modulus):
        raise InputError("modulus", expected="'young', 'shear' or 'contact'", got=checks.shown(modulus))
    density = checks.integer("per_decade", per_decade, least=1, most=1000)
    fineness = checks.number("branches_per_decade", branches_per_decade, least=0.2, most=10)
    with _told(progress) as tell:
        tell.stage("reading the relaxation table")
        factor = checks.number("shift", shift, above=0)
        if isinstance(relaxation, str | Path):
            table = _table_with_units(relaxation, kind, columns, noise)
        else:
            table = relaxation
        found = fit(table, per_decade=fineness)
        if factor != 1:
            found = fit(found.data.shifted(factor), per_decade=fineness)
        times = _times(found, first, last, density)
        stiffness = _contact_modulus(found.series.modulus, modulus, poisson)
        tell.stage("reading the scan")
        scan = surface if isinstance(surface, Surface) else read(surface, periodic="reflect")
        if scan.heights.ndim != 2:
            raise InputError("surface", expected="a scan of two axes", got="a profile", advice="a scan")
        scan.in_meters()
        if scan.provenance.get("periodic_rule") == "mirror":
            scan = replace(scan.scan, provenance={**scan.provenance, "periodic_rule": "reflect"})
        branches = len(found.series.branches)
        maps = sorted({times[0], *times[np.linspace(0, times.size - 1, USUAL_MAPS).round().astype(int)]})
        require(_SITE + branches * (_BRANCH + 8 * len(maps)), scan.shape)
        solid = half_space(modulus=stiffness, branches=found.series.branches)
        tell.stage(f"pressing {' x '.join(map(str, scan.shape))} sites")
        by_load = which == "load"
        contact = press(scan, solid, load=amount if by_load else None, pressure=None if by_load else amount)
        look = functools.partial(
            observe, pixel=pixel, blur=0.0 if blur is None else blur, threshold=threshold
        )
        looks = pixel is not None or blur is not None
        if looks:
            look(contact)  # refuses before minutes have passed
        tell.stage("aging", times=times.tolist())
        history = age(contact, times, fields_at=maps, progress=tell.reached, checkpoint=checkpoint)
        dataset = history.dataset.drop_vars("u0")
        assumed = {
            "measured": modulus,
            "poisson": None if modulus == "contact" else poisson,
            "shift": shift,
            "table": Path(relaxation).name if isinstance(relaxation, str | Path) else "",
            "table_sha256": _checksum(relaxation) if isinstance(relaxation, str | Path) else "",
            "kind": type(found.data).__name__,
            "points": int(found.data.columns[0].size),
            "shear_strength": strength,
            "pressed_by": which,
        }
        dataset = dataset.assign_attrs(prediction=json.dumps(assumed))
        tell.stage("weighing the spread of the table and of the scan")
        prediction = Prediction(
            dataset,
            found,
            stiffness,
            growth_of(dataset, found),
            resolved(dataset),
            shear_strength=strength,
            observed=tuple(look(dataset.isel(field_time=n)) for n in range(len(maps) if looks else 0)),
        )
        return replace(prediction, remarks=(*scan.remarks, *_remarks(prediction, scan)))


def _told(progress: Progress | bool | None) -> AbstractContextManager[Progress]:
    """Whom to tell how far it has come: a bar, the user's own, or nobody."""
    return progress_shown() if progress is True else nullcontext(progress or Silent())


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
            raise InputError("relaxation", expected=expected, got=str(remark), advice=advice) from None


def _quantity(name: str, given: object, unit: str) -> float:
    return checks.number(name, units.quantity(given, unit, name), above=0, expected=f"more than 0 {unit}")


def _checksum(path: str | Path) -> str:
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _times(found: Fit, first: float | str | None, last: float | str | None, per_decade: int) -> Field:
    """Times to record: of the table, and no others."""
    begin, end = found.series.span
    start = begin if first is None else _quantity("first", first, "s")
    stop = end if last is None else _quantity("last", last, "s")
    if not start < stop:
        raise InputError("last", expected=f"a time after the first, {start:.4g} s", got=f"{stop:.4g} s")
    for name, time in (("first", start), ("last", stop)):
        if not begin * (1 - 1e-9) <= time <= end * (1 + 1e-9):
            expected = f"a time that the table spans, {begin:.3g} s to {end:.3g} s"
            raise InputError(name, expected=expected, got=f"{time:.4g} s", advice="a table of more decades")
    least = math.ceil(_LEAST_TIMES / math.log10(stop / start))
    return hold_times(first=start, last=stop, per_decade=max(per_decade, least))


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
    if strain > 0.05:
        remarks.append(
            f"the mean contact pressure is {written(pressure, 'Pa')} at first, {100 * strain:.2g} % of E*: "
            "real asperities would flow, and nothing flows here"
        )
    if fraction > 0.5:
        remarks.append(
            f"{100 * fraction:.0f} % of the surface touches at last: waves longer than the scan, "
            "which it does not have, would keep bodies further apart"
        )
    if prediction.fit.series.error > 0.05:
        remarks.append(
            f"the fit misses the table by up to {100 * prediction.fit.series.error:.2g} %: "
            "more branches per decade may follow it, if that is not noise"
        )
    if last.patches < first.patches / 2 and fraction <= 0.5:
        remarks.append(f"patches merge: {first.patches} at first, {last.patches} at last")
    return tuple(remarks)
