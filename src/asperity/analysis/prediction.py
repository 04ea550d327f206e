"""What a prediction says: how the area of a real contact grows, how sure that is, and what is resolved.

It grows by A(last)/A(first); per decade by the slope of A(t)/A(first) against log10 t by least squares.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
import xarray as xr

from asperity.analysis.bands import Interval, OfScan, banded, interval, rows_of_maps
from asperity.analysis.legs import protocol_of
from asperity.analysis.observation import Observation
from asperity.analysis.scan import written
from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.words import counted
from asperity.creep import Eyring
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.patches import patches
from asperity.relaxation import Fit, Material, PronySeries
from asperity.relaxation.materials import relaxing_of
from asperity.solids import PARAMETERS_OF_LAWS, Solid
from asperity.solids.branches import Branches
from asperity.surfaces import statistics
from asperity.theory import flowing_area, persson_area

_FEW = 10
"""Pixels of a patch below which its shape is not resolved."""

_FLOWING, _FULL = 3.0, 0.5
"""Contact pressure over s0 above which contacts flow, and part of the area up to which they do so alone."""

_ROUNDING, _LOADING = 1e-12, 1e-6


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
        Real contact area, corrected for pixel rims.
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
        Of the area corrected for pixel rims, under a load that stays; None for another history.
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
    growth: Growth | None
    resolved: tuple[Resolved, ...]
    shear_strength: float | None = None
    observed: tuple[Observation, ...] = ()
    remarks: tuple[str, ...] = ()
    bands: tuple[Band, ...] = ()

    def __repr__(self) -> str:
        ends = self.band("contact_area_corrected")
        low, area, high = (
            float(values[-1]) for values in (ends[0], self.series("contact_area_corrected"), ends[1])
        )
        if self.growth is None:
            area_at_last = f"A({written(float(self.time[-1]), 's')}) = {written(area, 'm^2')}"
            return f"<Prediction: {area_at_last}, 95 % band {written(low, 'm^2')} to {written(high, 'm^2')}>"
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
    def legs(self) -> str:
        """The history of the load in words; empty for one that is put on and stays."""
        return (
            ""
            if self.growth is not None
            else ", ".join(leg.words(_said) for leg in protocol_of(self.dataset))
        )

    @property
    def loaded(self) -> int:
        """Place in `time` of the first contact under all of the load that is put on first."""
        load = self.series("load")
        return int(np.argmax(np.diff(load, append=0.0) < _LOADING * load.max())) if self.legs else 0

    @property
    def draws(self) -> int:
        """Draws of the solid's branches whose spread is in the bands; 0 without."""
        return len(self.material.draws)

    @property
    def load(self) -> float:
        """The load that is held at last, N."""
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
        parts = [f"half-space, instantaneous E* = {written(self.modulus, 'Pa')}"]
        if law is not None:
            numbers = [
                f"{fact.symbol} = {written(law.parameters[name], fact.unit or '1').removesuffix(' 1')}"
                for name, fact in PARAMETERS_OF_LAWS.items()
                if name in law.parameters
            ]
            parts.append(", ".join([f"creeps by {law.formula or 'a law of its own'}", *numbers]))
            if share := self.solid.permanent_share:
                parts.append(f"a share of {share:g} does not creep")
        mobilities = [branch.mobility for branch in self.solid.branches if branch.mobility is not None]
        parts += [f"flows with the mobility {mobility} (SI)" for mobility in mobilities]
        if self.fit is None and self.branches:
            parts.append(counted(len(self.branches), "relaxation time"))
        if self.solid.yields:
            parts.append(f"the scan yields under {written(self.solid.hardness, 'Pa')}")
        return tuple(parts)

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
        return ("effective load", "L") if self.ramp or self.legs else ("creep compliance", "J")

    @property
    def effective_load(self) -> Field | None:
        """Load under which an elastic half-space of E* has this contact, N; None where there is none.

        At a constant load F it is E* F J(t); while that was put on, E* times the integral of J(t - s) dF(s).
        A solid that is not separable has none, nor has a load that falls.
        """
        return self.series("effective_load") if "effective_load" in self.dataset else None

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
        held = self.growth is not None
        if not held or not isinstance(law, Eyring) or self.solid.yields or self.solid.permanent_share > 0:
            return None
        if load[-1] < _FLOWING * law.stress * last or last > _FULL * self.nominal_area:
            return None
        area = flowing_area(self.time, load=load[-1], area=last, at=self.time[-1], stress=law.stress)
        return "contacts that flow, through the last area", area

    @property
    def friction_force(self) -> Field | None:
        """Shear strength times corrected area, N; None without a shear strength."""
        return None if self.shear_strength is None else self.series("friction_force")

    @property
    def friction(self) -> Field | None:
        """Coefficient of static friction; None without a shear strength."""
        return None if self.shear_strength is None else self.series("friction")

    def band(self, name: str) -> tuple[Field, Field]:
        """95 % band of areas, friction, and all that the contact carries, at `time`: its two ends.

        NaN where fewer than three of sixteen tiles of the scan bear the load. `InputError` for other names.
        """
        if (quantities := banded(self.dataset)) and name not in quantities:
            raise InputError("name", expected=f"one of {', '.join(quantities)}", got=repr(name))
        return self.series(f"{name}_low"), self.series(f"{name}_high")


def growth_of(dataset: xr.Dataset, scan: OfScan, solid: Mapping[str, Floats]) -> Growth:
    """Measure the growth of a history with maps, whose draws of the solid are those of `draws_of_solid`."""
    time, area = (np.asarray(dataset[name])[1:] for name in ("time", "contact_area_corrected"))
    drawn = solid.get("contact_area_corrected", np.ones((1, area.size + 1)))

    def weighed(measure: Callable[[Field], float]) -> tuple[float, Interval, Interval, Interval]:
        value = measure(area)
        of_table = np.array([measure(area * factors[1:]) for factors in drawn])
        of_scan = value + (
            scan.draws_of(lambda factors: measure(area * factors[1:])) if value else np.zeros(1)
        )
        both = of_scan * np.resize(of_table / (value or 1.0), of_scan.shape)
        return value, _ends(both), _ends(of_table), _ends(of_scan)

    slope, band, of_table, of_scan = weighed(lambda area: _slope(time, area))
    rise, rise_band, *_ = weighed(lambda area: float(area[-1] / area[0] - 1))
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
    rows = []
    for number, row in enumerate(rows_of_maps(dataset)):
        fields = dataset.isel(field_time=number, time=row)
        touching = np.asarray(fields["in_contact"], dtype=bool)
        of_map = patches(touching, edges=dataset.attrs["edges"])
        counted, corrected = (float(fields[name]) for name in ("contact_area", "contact_area_corrected"))
        rows.append(
            Resolved(
                patches=of_map.count,
                mean=of_map.mean_size,
                in_small=float(of_map.sizes[of_map.sizes < _FEW].sum() / max(touching.sum(), 1)),
                rim=1 - corrected / counted if counted else 0.0,
            )
        )
    return tuple(rows)


def _said(quantity: str, value: float) -> str:
    units = {"time": "s", "load": "N", "mean_contact_pressure": "Pa"}
    return written(value, units.get(quantity, "1"))


def _ends(draws: Floats) -> Interval:
    low, high = interval(draws).tolist()
    return low, high


def _slope(time: Field, area: Field) -> float:
    slope = float(np.polyfit(np.log10(time), area / area[0], 1)[0])
    return slope if abs(slope) > _ROUNDING else 0.0


def _by_decade(time: Field, area: Field) -> tuple[tuple[float, float, float], ...]:
    span = math.log10(time[-1] / time[0])
    ends = np.append(np.arange(0, span - 1e-6), span)
    heights = np.interp(ends, np.log10(time / time[0]), area / area[0])
    slopes = np.diff(heights) / np.diff(ends)
    times = [*(time[0] * 10.0 ** ends[:-1]).tolist(), float(time[-1])]
    return tuple(zip(times[:-1], times[1:], slopes.tolist(), strict=True))
