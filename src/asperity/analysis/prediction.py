r"""What a prediction says: how the area of a real contact grows, how sure that is, and what is resolved.

It grows by A(last)/A(first); per decade by the slope of A(t)/A(first) against log10 t by least squares.
Their 95 % bands come from two spreads, each drawn anew with replacement (B. Efron, Ann. Stat. 7, 1 (1979),
DOI 10.1214/aos/1176344552):

    table   `Material.spread`. A separable solid under a constant pressure p has the contact of an elastic one
            at p J(t): A as a function of J, which the history has sampled, gives the curve of every draw.
            With a hardness this holds nearly, see docs/predict.md.
    scan    tiles of the scan: what another scan of this size would give. Load passes from tile to tile, so
            the area of the tiles drawn is divided by the load that they bear. Tiles are few: deviations are
            widened as Student's t is.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
import xarray as xr

from asperity.analysis.observation import Observation
from asperity.analysis.scan import written
from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.words import counted
from asperity.creep import Eyring
from asperity.lattice import Field
from asperity.patches import patches
from asperity.relaxation import Fit, Material, PronySeries
from asperity.relaxation.materials import relaxing_of
from asperity.solids import PARAMETERS_OF_LAWS, Solid
from asperity.solids.branches import Branches
from asperity.surfaces import statistics
from asperity.theory import flowing_area, persson_area, static_friction

_DRAWS = 200
_TILES = 4
"""Tiles along each axis of the scan."""

_WIDER = math.sqrt(16 / 15) * 2.131 / 1.960
"""Of sixteen values: the deviation of their mean that is known over that which drawing them gives."""

_FEW = 10
"""Pixels of a patch below which its shape is not resolved."""

_FLOWING, _FULL = 3.0, 0.5
"""Contact pressure over s0 above which contacts flow, and part of the area up to which they do so alone."""

_END = 0.25
"""Part of a curve along which it is continued."""

_ROUNDING = 1e-12

Interval = tuple[float, float]
_Measure = Callable[[Field, Field], float]
"""A measure of growth, from times and areas."""


@dataclass(frozen=True)
class Growth:
    """Growth of the area, in all and per decade of time, over the area at the first time.

    Attributes
    ----------
    ratio
        Area at the last time over that at the first.
    ratio_band
        Its 95 % band, of table and scan together.
    per_decade
        The slope over all decades.
    band
        Its 95 % band, of table and scan together.
    of_table, of_scan
        The band that each would give alone; the first is the slope, twice, for a material without spread.
    decades
        Begin, end and growth per decade of each decade, the last of which may be a part of one.
    """

    ratio: float
    ratio_band: Interval
    per_decade: float
    band: Interval
    of_table: Interval
    of_scan: Interval
    decades: tuple[tuple[float, float, float], ...]

    @property
    def range(self) -> Interval:
        """Smallest and largest growth of single decades; of half a decade or more, where the last ends."""
        slopes = [slope for begin, end, slope in self.decades if end > 3 * begin]
        return min(slopes), max(slopes)


@dataclass(frozen=True)
class Resolved:
    """What the pixels of a scan resolve of a contact.

    Attributes
    ----------
    patches
        Patches of contact.
    mean
        Pixels of a patch on average.
    in_small
        Part of the area that lies in patches of fewer than ten pixels.
    rim
        Part of the counted area that the correction of the rim takes away.
    """

    patches: int
    mean: float
    in_small: float
    rim: float


@dataclass(frozen=True)
class Band:
    """What a prediction becomes where only waves from a shortest one on are kept; SI units, at the last time.

    Attributes
    ----------
    shortest
        The shortest wave kept; two pixels for the scan as it is.
    area
        Real contact area less its rim.
    pressure
        Load over that area.
    growth
        That area over the one at the first time.
    stiffness
        Normal contact stiffness, to which conductances are proportional.
    """

    shortest: float
    area: float
    pressure: float
    growth: float
    stiffness: float

    def change_to(self, coarser: Band) -> dict[str, float]:
        """Relative changes of the numbers in a coarser band."""
        names = ("area", "pressure", "growth", "stiffness")
        return {name: getattr(coarser, name) / getattr(self, name) - 1 for name in names}


@dataclass(frozen=True, eq=False)
class Prediction(views.InNotebooks, views.Pictured):
    """The growth of a real contact, predicted from a relaxation table or a solid, a scan and a load.

    Attributes
    ----------
    dataset
        The history in SI units, with maps. Its attribute ``prediction`` holds the assumptions, as JSON.
    material
        The half-space, with the fit of its relaxation table or draws of its branches.
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
    bands
        The same of the scan without its short waves, the whole scan first; empty unless asked for.
    """

    dataset: xr.Dataset
    material: Material
    growth: Growth
    resolved: tuple[Resolved, ...]
    shear_strength: float | None = None
    observed: tuple[Observation, ...] = ()
    remarks: tuple[str, ...] = ()
    bands: tuple[Band, ...] = ()

    def __repr__(self) -> str:
        band = "{:.4g} to {:.4g}".format(*self.growth.ratio_band)
        return f"<Prediction: {self.between('A')} = {self.growth.ratio:.5g}, 95 % band {band}>"

    @property
    def fit(self) -> Fit | None:
        """Of the relaxation table, at the temperature of the contact; None without a table."""
        return self.material.fit

    @property
    def solid(self) -> Solid:
        """The half-space."""
        return self.material.solid

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

    @property
    def ramp(self) -> float:
        """Time within which the load was put on, s; 0 for at once."""
        return cast(float, self.assumed.get("ramp", 0.0))

    @property
    def draws(self) -> int:
        """Draws of the solid's branches whose spread is in the bands; 0 without."""
        return len(self.material.draws)

    @property
    def load(self) -> float:
        """The load that is held, N."""
        return float(self.dataset["load"][-1])

    def between(self, name: str) -> str:
        """A quantity at the last time over that at the first: ``A(1 ks)/A(1 s)``."""
        first, last = (f"{name}({written(float(self.time[place]), 's')})" for place in (0, -1))
        return f"{last}/{first}"

    def series(self, name: str) -> Field:
        """A quantity of the dataset at `time`."""
        return np.asarray(self.dataset[name])[1:]

    @property
    def modulus(self) -> float:
        """Contact modulus E* at once, Pa."""
        return relaxing_of(self.solid).modulus

    @property
    def words(self) -> tuple[str, ...]:
        """The solid in words: how stiff it is, how it creeps, and under which pressure the scan yields."""
        law = self.solid.creep
        said = [f"half-space, E* = {written(self.modulus, 'Pa')} at once"]
        if law is not None:
            numbers = [
                f"{what.symbol} = {written(law.parameters[name], what.unit or '1').removesuffix(' 1')}"
                for name, what in PARAMETERS_OF_LAWS.items()
                if name in law.parameters
            ]
            said.append(", ".join([f"creeps by {law.formula or 'a law of its own'}", *numbers]))
            if share := self.solid.permanent_share:
                said.append(f"a share of {share:g} does not creep")
        mobilities = [branch.mobility for branch in self.solid.branches if branch.mobility is not None]
        said += [f"flows with the mobility {mobility} (SI)" for mobility in mobilities]
        if self.fit is None and self.branches:
            said.append(counted(len(self.branches), "relaxation time"))
        if self.solid.yields:
            said.append(f"the scan yields under {written(self.solid.hardness, 'Pa')}")
        return tuple(said)

    @property
    def relaxing(self) -> PronySeries | None:
        """The contact modulus as it relaxes; None where the solid is not separable."""
        return relaxing_of(self.solid) if self.solid.separable else None

    @property
    def branches(self) -> Branches:
        """Shares of E* and the times in which they relax, s."""
        return relaxing_of(self.solid).branches

    @property
    def plateau(self) -> float:
        """Share of E* that does not relax."""
        return relaxing_of(self.solid).permanent

    @property
    def beside(self) -> tuple[str, str]:
        """Name and symbol of what the area of a light contact of a separable solid is in proportion to."""
        return ("effective load", "L") if self.ramp else ("creep compliance", "J")

    @property
    def effective_load(self) -> Field | None:
        """Load under which an elastic half-space of E* has this contact, N; None for no separable solid.

        At a constant load F it is E* F J(t); while that was put on, E* times the integral of J(t - s) dF(s).
        """
        return None if self.relaxing is None else self.load * _creep(self.relaxing, self.time, self.ramp)

    @property
    def theory(self) -> tuple[str, Field] | None:
        """Name of the theory that has an area for such a contact, and that area, m^2; None without one.

        Of a separable solid Persson's, for the rms slope of the scan and the effective load; of one that
        creeps by Eyring's law alone that of contacts that flow, through the last area.
        """
        load = self.series("load")
        if (effective := self.effective_load) is not None:
            slope = statistics(self.dataset["heights"].values, self.spacing).rms_slope
            pressure = effective / self.nominal_area
            area = self.nominal_area * persson_area(pressure, modulus=self.modulus, slope=slope)
            return "Persson's theory, from the rms slope", area
        law, last = self.solid.creep, float(self.series("contact_area")[-1])
        if not isinstance(law, Eyring) or self.solid.yields or self.solid.permanent_share > 0:
            return None
        if load[-1] < _FLOWING * law.stress * last or last > _FULL * self.nominal_area:
            return None
        area = flowing_area(self.time, load=load[-1], area=last, at=self.time[-1], stress=law.stress)
        return "contacts that flow, through the last area", area

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


def growth_of(
    dataset: xr.Dataset, series: Sequence[PronySeries] = (), *, ramp: float = 0.0, seed: int = 0
) -> Growth:
    """Measure the growth of a history with maps, under a load put on within a ramp; see the module.

    The series are `Material.spread`; the seed is that of the draws of tiles.
    """
    time, area = (np.asarray(dataset[name])[1:] for name in ("time", "contact_area_corrected"))
    moments, tiles = _of_tiles(dataset, np.random.default_rng(seed))
    tables = _of_series(time, area, series, ramp)

    def weighed(measure: _Measure) -> tuple[float, Interval, Interval, Interval]:
        value, of_table = measure(time, area), _factors(measure, time, [area, *tables])
        of_scan = 1 + _WIDER * (_factors(measure, moments, tiles) - 1)
        both = of_table * np.resize(of_scan, of_table.size)
        return value, _band(value, both), _band(value, of_table), _band(value, of_scan)

    slope, band, of_table, of_scan = weighed(_slope)
    rise, rise_band, *_ = weighed(lambda _, area: float(area[-1] / area[0] - 1))
    return Growth(
        ratio=1 + rise,
        ratio_band=(1 + rise_band[0], 1 + rise_band[1]),
        per_decade=slope,
        band=band,
        of_table=of_table,
        of_scan=of_scan,
        decades=_by_decade(time, area),
    )


def resolved(dataset: xr.Dataset) -> tuple[Resolved, ...]:
    """Say what is resolved at the times of the maps."""
    said = []
    for number, moment in enumerate(np.asarray(dataset["field_time"])):
        here = dataset.isel(field_time=number, time=int(np.argmax(np.asarray(dataset["time"]) == moment)))
        touching = np.asarray(here["in_contact"], dtype=bool)
        found = patches(touching, edges=dataset.attrs["edges"])
        counted, corrected = (float(here[name]) for name in ("contact_area", "contact_area_corrected"))
        said.append(
            Resolved(
                patches=found.count,
                mean=found.mean_size,
                in_small=float(found.sizes[found.sizes < _FEW].sum() / max(touching.sum(), 1)),
                rim=1 - corrected / counted if counted else 0.0,
            )
        )
    return tuple(said)


def _creep(series: PronySeries, time: Field, ramp: float) -> Field:
    """Effective load over the load that is held, which was put on within a ramp; without one, E* J(t)."""
    knots = np.union1d([0.0, ramp], time)
    loads = np.minimum(knots / ramp, 1.0) if ramp else np.ones_like(knots)
    return series.effective_load(knots, loads)[np.searchsorted(knots, time)]


def _of_series(time: Field, area: Field, series: Sequence[PronySeries], ramp: float) -> Floats:
    """Areas that all series but the first, that of the solid, would have given; shape (draws, times)."""
    crept = [np.log(_creep(one, time, ramp) / one.modulus) for one in series]
    compliance = crept[0] if series else np.zeros(time.size)
    grown = np.flatnonzero(np.diff(compliance, prepend=-np.inf) > _ROUNDING)  # a table may end in a plateau
    if grown.size < 2:  # it does not grow, whatever the table
        return np.empty((0, time.size))
    x, y = compliance[grown], np.log(area[grown])
    drawn = [np.exp(_continued(one, x, y)) for one in crept[1:]]
    return np.reshape(drawn, (-1, time.size))


def _of_tiles(dataset: xr.Dataset, random: np.random.Generator) -> tuple[Field, Floats]:
    """Times of the maps; areas of all tiles, and then those that other scans would have given.

    The shape of the areas is (1 + draws, maps).
    """
    area, load = (_in_tiles(np.asarray(dataset[name])) for name in ("in_contact", "pressure"))
    chosen = random.integers(0, area.shape[1], (_DRAWS, area.shape[1]))
    drawn, borne = area[:, chosen].sum(axis=-1).T, load[:, chosen].sum(axis=-1).T
    bearing = (borne > 0).all(axis=1)
    whole, pressed = area.sum(axis=1), load.sum(axis=1)
    return np.asarray(dataset["field_time"]), np.vstack([whole, drawn[bearing] / borne[bearing] * pressed])


def _factors(measure: _Measure, time: Field, areas: Sequence[Field] | Floats) -> Floats:
    """A measure of areas that were drawn, over that of the first areas, the true ones; 200 or more."""
    whole, *drawn = (measure(time, area) for area in areas)
    return np.resize(drawn, max(_DRAWS, len(drawn))) / whole if whole and drawn else np.ones(_DRAWS)


def _in_tiles(maps: Field) -> Field:
    for axis in (1, 2):
        ends = np.linspace(0, maps.shape[axis], _TILES + 1).astype(int)[:-1]
        maps = np.add.reduceat(maps, ends, axis=axis, dtype=np.float64)
    return maps.reshape(maps.shape[0], -1)


def _slope(time: Field, area: Field) -> float:
    slope = float(np.polyfit(np.log10(time), area / area[0], 1)[0])
    return slope if abs(slope) > _ROUNDING else 0.0


def _band(slope: float, factors: Floats) -> Interval:
    low, high = np.quantile(slope * factors, (0.025, 0.975))
    return float(low), float(high)


def _continued(at: Field, x: Field, y: Field) -> Field:
    """Interpolate, and go on along the first and the last quarter: pieces may be as small as a pixel."""
    part = _END * (x[-1] - x[0])
    before, after = np.diff(np.interp([x[0], x[0] + part, x[-1] - part, x[-1]], x, y))[::2] / part
    inside = np.interp(at, x, y)
    return np.asarray(inside + np.minimum(at - x[0], 0) * before + np.maximum(at - x[-1], 0) * after)


def _by_decade(time: Field, area: Field) -> tuple[tuple[float, float, float], ...]:
    span = math.log10(time[-1] / time[0])
    ends = np.append(np.arange(0, span - 1e-6), span)
    heights = np.interp(ends, np.log10(time / time[0]), area / area[0])
    slopes = np.diff(heights) / np.diff(ends)
    times = [*(time[0] * 10.0 ** ends[:-1]).tolist(), float(time[-1])]
    return tuple(zip(times[:-1], times[1:], slopes.tolist(), strict=True))
