r"""What a prediction says: how the area of a real contact grows, how sure that is, and what is resolved.

The growth per decade is the slope of A(t)/A(first) against log10 t by least squares. Its 95 % band holds what
is known of two spreads, each found by drawing anew with replacement (B. Efron, Ann. Stat. 7, 1 (1979), DOI
10.1214/aos/1176344552):

    table   deviations of the relaxation table from its fit; each draw is fitted anew. A separable solid under
            a constant pressure p has the contact of an elastic one at p J(t), so that A as a function of J,
            which the history has sampled, gives the curve of every draw.
    scan    tiles of the scan, whose areas of contact grow differently: what another scan of this size would
            give.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import xarray as xr

import asperity.views as views
from asperity.analysis.observation import Observation
from asperity.checks import Floats
from asperity.errors import InputError
from asperity.fits import growth_rate
from asperity.lattice import Field
from asperity.patches import patches
from asperity.relaxation import Fit, fit
from asperity.relaxation.data import scales
from asperity.surfaces import statistics
from asperity.theory import persson_area, static_friction

_DRAWS = 200
_TILES = 4
"""Tiles along each axis of the scan."""

_FEW = 10
"""Pixels of a patch below which its shape is not resolved."""

_ROUNDING = 1e-12

Interval = tuple[float, float]


@dataclass(frozen=True)
class Growth:
    """Growth of the area per decade of time, over the area at the first time.

    Attributes
    ----------
    per_decade
        The slope over all decades.
    band
        Its 95 % band, of table and scan together.
    of_table, of_scan
        The band that each would give alone.
    decades
        Begin, end and growth per decade of each decade, the last of which may be a part of one.
    straight
        Whether the slope changes by no more than a quarter of itself; None where that cannot be told.
    """

    per_decade: float
    band: Interval
    of_table: Interval
    of_scan: Interval
    decades: tuple[tuple[float, float, float], ...]
    straight: bool | None


@dataclass(frozen=True)
class Resolved:
    """What the pixels of a scan resolve of a contact.

    Attributes
    ----------
    patches
        Patches of contact.
    largest, mean
        Pixels of the largest patch, and of a patch on average.
    in_small
        Part of the area that lies in patches of fewer than ten pixels.
    rim
        Part of the counted area that the correction of the rim takes away.
    """

    patches: int
    largest: int
    mean: float
    in_small: float
    rim: float


@dataclass(frozen=True, eq=False)
class Prediction(views.InNotebooks):
    """The growth of a real contact, predicted from a relaxation table, a scan and a load.

    Attributes
    ----------
    dataset
        The history in SI units, with maps at times from the first to the last. Its attribute ``prediction``
        holds the assumptions, as JSON.
    fit
        Of the relaxation table, shifted to the temperature of the contact.
    modulus
        Contact modulus E* at once, Pa.
    growth
        Of the area less its rim.
    resolved
        What is resolved at the times of the maps.
    shear_strength
        Pa; None where none was given.
    observed
        The contact at the times of the maps, as an instrument sees it; empty where none was given.
    remarks
        What the reader should know.
    """

    dataset: xr.Dataset
    fit: Fit
    modulus: float
    growth: Growth
    resolved: tuple[Resolved, ...]
    shear_strength: float | None = None
    observed: tuple[Observation, ...] = ()
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        low, high = (100 * edge for edge in self.growth.band)
        return (
            f"<Prediction: growth {100 * self.growth.per_decade:.3g} % of the first area per decade, "
            f"95 % band {low:.3g} to {high:.3g} %, {self.time[0]:g} to {self.time[-1]:g} s>"
        )

    @property
    def time(self) -> Field:
        """Times of the prediction, s: from the first of the table on, without the instant before."""
        return np.asarray(self.dataset["time"])[1:]

    @property
    def spacing(self) -> tuple[float, ...]:
        """Distance between pixels along each axis, m."""
        return tuple(json.loads(self.dataset.attrs["spacing"]))

    @property
    def nominal_area(self) -> float:
        """Area of the scan, m^2."""
        return float(self.dataset["heights"].size * math.prod(self.spacing))

    @property
    def origin(self) -> dict[str, object]:
        """Where the scan comes from; see `asperity.surfaces.Surface`."""
        return dict(json.loads(self.dataset.attrs["surface"]))

    @property
    def assumed(self) -> dict[str, object]:
        """The assumptions."""
        return dict(json.loads(self.dataset.attrs["prediction"]))

    def series(self, name: str) -> Field:
        """A quantity of the dataset at `time`."""
        return np.asarray(self.dataset[name])[1:]

    @property
    def persson_area(self) -> Field:
        """Area that Persson's theory has for the load, the table and the rms slope of the scan, m^2.

        The load is the effective one, under which an elastic half-space of E* has this contact.
        """
        series, slope = self.fit.series, statistics(self.dataset["heights"].values, self.spacing).rms_slope
        pressure = self.series("load") / self.nominal_area * series.modulus * series.compliance_at(self.time)
        return self.nominal_area * persson_area(pressure, modulus=self.modulus, slope=slope)

    @property
    def friction_force(self) -> Field | None:
        """Shear strength times area less rim, N; None without a shear strength."""
        if self.shear_strength is None:
            return None
        return self.shear_strength * self.series("contact_area_corrected")

    @property
    def friction(self) -> Field | None:
        """Coefficient of static friction; None without a shear strength."""
        if self.shear_strength is None:
            return None
        area, load = self.series("contact_area_corrected"), self.series("load")
        return np.asarray(static_friction(area, load, self.shear_strength))


def growth_of(dataset: xr.Dataset, found: Fit, *, seed: int = 0) -> Growth:
    """Measure the growth of a history, and how sure it is; see the module.

    The history, with maps, is of a separable solid with the branches of the fit under a constant load;
    the seed is that of the draws.
    """
    time, area = (np.asarray(dataset[name])[1:] for name in ("time", "contact_area_corrected"))
    line = growth_rate(time, area, initial=float(area[0]))
    slope = _slope(time, area)
    random = np.random.default_rng(seed)
    of_table, of_scan = _of_tables(time, area, found, random), _of_tiles(dataset, random)
    return Growth(
        per_decade=slope,
        band=_band(slope, of_table * of_scan),
        of_table=_band(slope, of_table),
        of_scan=_band(slope, of_scan),
        decades=_by_decade(time, area),
        straight=line.straight,
    )


def resolved(dataset: xr.Dataset) -> tuple[Resolved, ...]:
    """Say what is resolved at the times of the maps."""
    said = []
    for moment in np.asarray(dataset["field_time"]):
        here = dataset.sel(time=moment, field_time=moment)
        touching = np.asarray(here["in_contact"], dtype=bool)
        found = patches(touching, edges=dataset.attrs["edges"])
        counted, corrected = (float(here[name]) for name in ("contact_area", "contact_area_corrected"))
        said.append(
            Resolved(
                patches=found.count,
                largest=found.largest,
                mean=found.mean_size,
                in_small=float(found.sizes[found.sizes < _FEW].sum() / max(touching.sum(), 1)),
                rim=1 - corrected / counted if counted else 0.0,
            )
        )
    return tuple(said)


def _of_tables(time: Field, area: Field, found: Fit, random: np.random.Generator) -> Floats:
    """Slopes that tables with other deviations would have given, over the slope; shape (draws,)."""
    x, _ = found.data.columns
    names = [field.name for field in fields(found.data)][1:-1]
    predicted = found.data.predicted(found.series, x)
    free = max(x.size - len(found.series.branches) - 1, 1)
    wider = math.sqrt(x.size / free)
    compliance, whole = np.log(found.series.compliance_at(time)), _slope(time, area)
    if whole == 0 or not np.ptp(compliance) > 0:  # it does not grow, whatever the table
        return np.ones(_DRAWS)
    slopes = []
    for _ in range(_DRAWS):
        chosen = random.integers(0, x.size, x.size)
        drawn = [
            np.maximum(p + wider * r[chosen] * s, 0.0)
            for p, r, s in zip(predicted, found.residuals(), scales(found.data), strict=True)
        ]
        try:
            table: dict[str, Any] = dict(zip(names, drawn, strict=True))
            again = fit(replace(found.data, **table, noise=0.99), per_decade=found.per_decade)
        except InputError:  # deviations so large that a draw is no relaxation
            continue
        there = np.log(again.series.compliance_at(time))
        slopes.append(_slope(time, np.exp(_continued(there, compliance, np.log(area)))))
    return np.resize(np.array(slopes or [whole]), _DRAWS) / whole


def _of_tiles(dataset: xr.Dataset, random: np.random.Generator) -> Floats:
    """Slopes that other scans would have given, over the slope; shape (draws,)."""
    touching = np.asarray(dataset["in_contact"], dtype=np.float64)
    for axis in (1, 2):
        ends = np.linspace(0, touching.shape[axis], _TILES + 1).astype(int)[:-1]
        touching = np.add.reduceat(touching, ends, axis=axis)
    tiles = touching.reshape(touching.shape[0], -1)
    time = np.asarray(dataset["field_time"])
    chosen = random.integers(0, tiles.shape[1], (_DRAWS, tiles.shape[1]))
    areas = tiles[:, chosen].sum(axis=-1).T
    slopes = np.array([_slope(time, drawn) for drawn in areas if drawn[0] > 0])
    whole = _slope(time, tiles.sum(axis=1))
    return np.resize(slopes, _DRAWS) / whole if whole and slopes.size else np.ones(_DRAWS)


def _slope(time: Field, area: Field) -> float:
    """Slope of the area over the first against the decimal logarithm of time."""
    slope = float(np.polyfit(np.log10(time), area / area[0], 1)[0])
    return slope if abs(slope) > _ROUNDING else 0.0


def _band(slope: float, factors: Floats) -> Interval:
    low, high = np.quantile(slope * factors, (0.025, 0.975))
    return float(low), float(high)


def _continued(at: Field, x: Field, y: Field) -> Field:
    """Interpolate, and go on along the first and the last piece."""
    before, after = (y[1] - y[0]) / (x[1] - x[0]), (y[-1] - y[-2]) / (x[-1] - x[-2])
    inside = np.interp(at, x, y)
    return np.asarray(inside + np.minimum(at - x[0], 0) * before + np.maximum(at - x[-1], 0) * after)


def _by_decade(time: Field, area: Field) -> tuple[tuple[float, float, float], ...]:
    """Begin, end and growth per decade of each decade."""
    span = math.log10(time[-1] / time[0])
    ends = np.append(np.arange(0, span - 1e-6), span)
    heights = np.interp(ends, np.log10(time / time[0]), area / area[0])
    slopes = np.diff(heights) / np.diff(ends)
    times = (time[0] * 10.0**ends).tolist()
    return tuple(zip(times[:-1], times[1:], slopes.tolist(), strict=True))
