r"""The growth of the contact area: as computed, as fitted by a law, and as predicted by theory.

The law is the paper's Eq. (a), fitted by `asperity.fits.saturation`. If the relaxed state is known, a is its
A(infinity)/A(0), which `asperity.relax` gives exactly. A fitted a differs from it by more than its standard
error, because the misfit along a curve is not random. So standard errors only show here whether the times
determine the law; the misfit shows how good it is.

The theory is that of dilute contacts, `asperity.theory.dilute_area`, evaluated only in its range:

* the heights of the sites are independent (a law of heights is given) and the load is held,
* at most a tenth of the sites touch, and at least ten sites,
* the dips around contacts are far from meeting: their widths (k0/k1)^(1/2), (k0 R t)^(1/4) and
  (k0 R_viscous t)^(1/2) are below a third of the spacing of contacts, (A/N)^(-1/dimension). Where the
  widths reach the spacing (`asperity.theory.dilute_horizon`) the theory is off by tens of percent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from asperity.base import views
from asperity.contact import Contact
from asperity.errors import ConvergenceError, InputError
from asperity.fits import SaturationFit, saturation
from asperity.lattice import Field
from asperity.results.history import check_dataset
from asperity.theory import compliance, dilute_area
from asperity.theory.heights import HeightLaw

DILUTE_FRACTION = 0.1
"""Largest contact fraction at which the dilute theory is shown."""

FAR_APART = 3.0
"""Spacing of contacts, in widths of the dips around them, at which the dilute theory is shown."""

FEWEST_CONTACTS = 10
"""Fewest contacts on a lattice for the dilute theory, which is about averages."""

_POOR_FIT = 0.05
"""Relative misfit, rms, above which a fit is called poor."""

_FEWEST_TIMES = {False: 4, True: 3}
"""One more than the parameters of the law: with an unknown limit, and with a known one."""

_SMOOTH_CURVE = 200
"""Points of a drawn curve."""


@dataclass(frozen=True, eq=False, repr=False)
class AgingSummary(views.Brief):
    """Growth of the contact area in a history.

    Attributes
    ----------
    time, area_ratio
        Hold times above 0 and A(t)/A(0), shape ``(n,)``; n may be 0.
    initial_area, sites
        A(0) and the nominal area, sites.
    relaxed_ratio
        A(infinity)/A(0); None without the relaxed state.
    load
        Load at `time`, shape ``(n,)``; None if it is held.
    initial_load, relaxed_load
        Load at time 0 and in the relaxed state (None if unknown), in the unit of the history.
    fit, fit_note
        The saturation law, with a = `relaxed_ratio` if known, or None; and a caveat or "". Without both for
        continua.
    fit_worst
        Largest relative residual of the law at `time`; NaN without a law.
    fit_curve
        The law at `curve_time`, or None.
    curve_time
        Times at which `fit_curve` is given, shape ``(m,)``.
    dilute_time, dilute_ratio, dilute_note
        Prediction of the dilute theory, A(t)/A(0), up to its horizon, shape ``(k,)``; or empty, and why.
    """

    time: Field
    area_ratio: Field
    initial_area: int
    sites: int
    relaxed_ratio: float | None
    load: Field | None
    initial_load: float
    relaxed_load: float | None
    fit: SaturationFit | None
    fit_note: str
    fit_worst: float
    fit_curve: Field | None
    curve_time: Field
    dilute_time: Field
    dilute_ratio: Field
    dilute_note: str


def summary_of(dataset: xr.Dataset, law: HeightLaw | None = None) -> AgingSummary | None:
    """Summarize as `aging_summary` does; None where the area follows no law: under legs, without contact."""
    held = "protocol" not in dataset.attrs and dataset["area"].values[0] > 0
    return aging_summary(dataset, law=law) if held else None


def aging_summary(dataset: xr.Dataset, *, law: HeightLaw | None = None) -> AgingSummary:
    """Summarize the growth of the contact area.

    Parameters
    ----------
    dataset
        The dataset of a `History`, with the relaxed state if `with_limit` added it.
    law
        Law of the heights, such as ``theory.GaussianHeights(rms=1.0)``, of independent sites; None for other
        surfaces, to which the dilute theory does not apply.

    Raises
    ------
    InputError
        The history started without any contact.
    """
    check_dataset(dataset)
    time, area = np.asarray(dataset["time"], dtype=np.float64), np.asarray(dataset["area"], dtype=np.float64)
    if area[0] == 0:
        raise InputError("dataset", expected="contact at time 0", got="none", advice="a larger load")
    later, ratio = time[1:], area[1:] / area[0]
    relaxed, relaxed_load = dataset.attrs.get("relaxed_area"), dataset.attrs.get("relaxed_load")
    # The law is the paper's, for its lattice; a continuum follows its own relaxation times.
    fit, fit_note = (None, "") if "contact_area" in dataset else _fit(time, area, relaxed)
    curve_time = np.geomspace(later[0], later[-1], _SMOOTH_CURVE) if later.size else later
    dilute_time, dilute_ratio, dilute_note = _dilute(dataset, law, curve_time)
    forces = np.asarray(dataset["load"], dtype=np.float64)
    return AgingSummary(
        time=later,
        area_ratio=ratio,
        initial_area=int(area[0]),
        sites=int(dataset.attrs["sites"]),
        relaxed_ratio=None if relaxed is None else float(relaxed / area[0]),
        load=None if dataset.attrs["held"] == "load" else forces[1:],
        initial_load=float(forces[0]),
        relaxed_load=None if relaxed_load is None else float(relaxed_load),
        fit=fit,
        fit_note=fit_note,
        fit_worst=math.nan if fit is None else float(np.abs(1 - fit.area_ratio(later) / ratio).max()),
        fit_curve=None if fit is None else fit.area_ratio(curve_time),
        curve_time=curve_time,
        dilute_time=dilute_time,
        dilute_ratio=dilute_ratio,
        dilute_note=dilute_note,
    )


def with_limit(dataset: xr.Dataset, limit: Contact) -> xr.Dataset:
    """Add the relaxed state to a history.

    Parameters
    ----------
    dataset
        The dataset of a `History`.
    limit
        The state from `asperity.relax`, of the same surface.

    Returns
    -------
    Dataset
        A copy with the fields ``in_contact_relaxed`` and ``u_relaxed`` and the attributes
        ``relaxed_area`` (sites), ``relaxed_load``, ``relaxed_separation``, ``relaxed_energy`` and
        ``relaxed_residual``.

    Raises
    ------
    InputError
        The state is of another lattice.
    """
    check_dataset(dataset)
    sites = dataset["heights"].dims
    if limit.heights.shape != dataset["heights"].shape:
        expected = f"a contact of shape {dataset['heights'].shape}"
        raise InputError("limit", expected=expected, got=limit.heights.shape)
    touching = {"long_name": "whether the site is in contact in the relaxed state", "units": "1"}
    unit = dataset["heights"].attrs.get("units", "height unit")
    height = {"long_name": "height of the elastic surface in the relaxed state", "units": unit}
    numbers = ("area", "load", "separation", "energy", "residual")
    return dataset.assign(
        in_contact_relaxed=(sites, limit.in_contact, touching), u_relaxed=(sites, limit.u, height)
    ).assign_attrs({f"relaxed_{name}": getattr(limit, name) for name in numbers})


def _fit(time: Field, area: Field, limit: float | None) -> tuple[SaturationFit | None, str]:
    """Fit Eq. (a); with a caveat if the fit means little."""
    if time.size == 1:
        return None, "no fit: only time 0 was asked for"
    if area[-1] <= area[0]:
        return None, "no fit: the area does not grow"
    if limit is not None and limit <= area[0]:
        return None, "no fit: the relaxed area is not above that at time 0"
    if time.size - 1 < (fewest := _FEWEST_TIMES[limit is not None]):
        return None, f"no fit: it takes {fewest} times above 0 or more"
    try:
        fit = saturation(time, area, limit=limit)
    except (InputError, ConvergenceError, ArithmeticError, np.linalg.LinAlgError) as error:
        return None, f"no fit: {error}"
    if not (fit.q_stderr < 0.5 * fit.q and np.isfinite(fit.a_stderr)):
        if fit.C_stderr < 0.5 * fit.C:
            return fit, "a and q are not determined by these times; their product C = (a - 1) q is"
        return fit, "the law's parameters are not determined by these times"
    if not fit.t0_stderr < fit.t0:
        return fit, "t0 is not determined by these times"
    if fit.rms_residual > _POOR_FIT:
        return fit, f"the law misses these areas by {100 * fit.rms_residual:.2g} % rms"
    return fit, ""


def _dilute(dataset: xr.Dataset, law: HeightLaw | None, time: Field) -> tuple[Field, Field, str]:
    """Times up to the horizon, the theory's A(t)/A(0) there, and why there is none."""
    none = np.empty(0), np.empty(0)
    k0, k1, R, viscous = (float(dataset.attrs.get(name, 0)) for name in ("k0", "k1", "R", "R_viscous"))
    if law is None:
        return *none, "the dilute theory needs independent sites"
    if dataset.attrs["held"] != "load":
        return *none, "the dilute theory needs a constant load"
    if not (k0 > 0 and k1 > 0 and R > 0):
        return *none, "the dilute theory needs k0, k1 and R above 0"
    dimension, sites = dataset["heights"].ndim, dataset["heights"].size
    growth = compliance(k1 / k0, k0 * R * np.append(0.0, time), viscous / R, dimension) / k0
    fraction = dilute_area(float(dataset.attrs["held_load"]) / sites, growth, law)
    initial, later = float(fraction[0]), fraction[1:]
    room = later ** (-1 / dimension) / FAR_APART
    apart = (
        (later <= DILUTE_FRACTION)
        & (later * sites >= FEWEST_CONTACTS)
        & (np.sqrt(k0 / k1) < room)
        & (k0 * R * time < room**4)
        & (np.sqrt(k0 * viscous * time) < room)
    )
    # Fraction and dips only grow, so dips that are near each other stay so.
    holds = np.logical_and.accumulate(apart)
    if not holds.any():
        return *none, "the contacts are too dense or too few for the dilute theory"
    return time[holds], later[holds] / initial, ""
