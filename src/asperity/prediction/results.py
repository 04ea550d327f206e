"""Results of a prediction: growth of the real contact area, its bands, and the resolution of the scan.

Growth is A(last)/A(first); per decade it is the least-squares slope of A(t)/A(first) against log10 t.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
import pandas as pd
import xarray as xr

from asperity.analysis.bands import Interval, OfScan, banded, interval, rows_of_maps
from asperity.analysis.field_values import lattice_of
from asperity.analysis.legs import protocol_of
from asperity.analysis.maps import on_the_surface
from asperity.analysis.observation import Observation
from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.readable import written
from asperity.base.rows import Row
from asperity.base.words import band_ends, counted
from asperity.contact.bodies import Bodies
from asperity.contact.remarks import Resolved
from asperity.creep import Eyring
from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.relaxation import Fit, Material, PronySeries
from asperity.relaxation.materials import relaxing_of
from asperity.results.quantities import PREDICT, areas_first, select
from asperity.solids import PARAMETERS_OF_LAWS, Solid
from asperity.solids.branches import Branches
from asperity.surfaces import statistics
from asperity.theory import flowing_area, persson_area

_FLOWING, _FULL = 3.0, 0.5
"""Contact pressure over s0 above which contacts flow, and largest contact fraction of separate contacts."""

_ROUNDING, _LOADING = 1e-12, 1e-6


@dataclass(frozen=True)
class Growth:
    """Growth of the area relative to the area at the first time.

    Attributes
    ----------
    ratio
        Area at the last time over that at the first.
    ratio_band
        Its 95 % band, from table and scan together.
    per_decade
        The slope over all decades.
    band
        Its 95 % band, of table and scan together.
    of_table, of_scan
        The band from each alone; without a spread of the material both ends of the first are the slope.
    decades
        Begin, end and growth per decade of each decade; the last may be incomplete.
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
        """Smallest and largest growth of a decade; an incomplete one counts from half a decade on."""
        slopes = [slope for begin, end, slope in self.decades if end > 3 * begin]
        return min(slopes), max(slopes)


@dataclass(frozen=True)
class Band:
    """A prediction without waves below a shortest one; SI units, at the last time.

    Attributes
    ----------
    shortest
        The shortest wave kept; two pixels for the whole scan.
    area
        Real contact area, corrected for pixel rims.
    pressure
        Load over that area.
    growth
        That area over the one at the first time.
    stiffness
        Normal contact stiffness without an apparatus; conductances are proportional to it.
    """

    shortest: float
    area: float
    pressure: float
    growth: float
    stiffness: float

    def change_to(self, coarser: Band) -> dict[str, float]:
        """Relative changes in a coarser band of the numbers that both have."""
        names = ("area", "pressure", "growth", "stiffness")
        pairs = ((name, getattr(self, name), getattr(coarser, name)) for name in names)
        return {name: there / here - 1 for name, here, there in pairs if math.isfinite(here + there)}


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
        Growth of the area corrected for pixel rims, under constant load; None for another history.
    resolved
        Resolution at the times of the maps.
    shear_strength
        Pa; None where none was given.
    observed
        Images of the contact at the times of the maps; empty without an instrument.
    remarks
        Warnings for the reader.
    bands
        Predictions without short waves, the whole scan first; empty without a resolution study.
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
        if self.growth is not None:
            ends = band_ends(self.growth.ratio_band)
            return f"<Prediction: {self.between('A')} = {self.growth.ratio:.5g}, 95 % band {ends}>"
        name = "contact_area_corrected"
        area, *pair = (float(values[-1]) for values in (self.series(name), *self.band(name)))
        ends = band_ends(pair, lambda end: written(end, "m^2"))
        at_last = f"A({written(float(self.time[-1]), 's')}) = {written(area, 'm^2')}"
        return f"<Prediction: {at_last}, 95 % band {ends}>"

    @views.later
    def rows(self, /) -> list[Row]:
        """Rows of a summary: material, scan, load, areas and growth with their 95 % bands, friction."""
        raise NotImplementedError

    @property
    def table(self) -> pd.DataFrame:
        """Its series over `time` with their bands: a row for each time, units in ``table.attrs["units"]``."""
        names = [*areas_first(select(table=PREDICT)), "effective_load"]
        wide = [one for name in names for one in (name, f"{name}_low", f"{name}_high") if one in self.dataset]
        table = pd.DataFrame({name: self.series(name) for name in wide})
        table.attrs["units"] = {name: self.dataset[name].attrs["units"] for name in wide}
        return table

    @property
    def fit(self) -> Fit | None:
        """Fit of the relaxation table, at the temperature of the contact; None without a table."""
        return self.material.fit

    @property
    def solid(self) -> Solid:
        """The half-space."""
        return self.material.solid

    @property
    def time(self) -> Field:
        """Times of the prediction, s, without time 0."""
        return np.asarray(self.dataset["time"])[1:]

    @property
    def spacing(self) -> tuple[float, ...]:
        """Distance between pixels along each axis, m."""
        return tuple(json.loads(self.dataset.attrs["spacing"]))

    @property
    def nominal_area(self) -> float:
        """Area of the scan, m^2."""
        return float(self.dataset.attrs["sites"] * math.prod(self.spacing))

    @property
    def origin(self) -> dict[str, object]:
        """Provenance of the scan; see `asperity.surfaces.Surface`."""
        return dict(json.loads(self.dataset.attrs["surface"]))

    @property
    def assumed(self) -> dict[str, object]:
        """The assumptions."""
        return dict(json.loads(self.dataset.attrs["prediction"]))

    @property
    def ramp(self) -> float:
        """Duration of the loading, s; 0 if instant."""
        return cast(float, self.assumed.get("ramp", 0.0))

    @property
    def legs(self) -> str:
        """The history of the load in words; empty for a constant load."""
        legs = [] if self.growth is not None else protocol_of(self.dataset)
        begin = f"from {_said('load', float(self.dataset['load'][0]))}"
        return ", ".join([begin, *(leg.words(_said) for leg in legs)]) if legs else ""

    @property
    def loaded(self) -> int:
        """Place in `time` at which the first loading of a protocol ends; 0 without a protocol."""
        load = self.series("load")
        return int(np.argmax(np.diff(load, append=0.0) < _LOADING * load.max())) if self.legs else 0

    @property
    def draws(self) -> int:
        """Draws of the solid's branches whose spread is in the bands; 0 without."""
        return len(self.material.draws)

    @property
    def load(self) -> float:
        """The last load, N."""
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
        """Instantaneous contact modulus E*, Pa."""
        return relaxing_of(self.solid).modulus

    @property
    def words(self) -> tuple[str, ...]:
        """The solid in words: modulus, creep, hardness."""
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
        """Name and symbol of the number to which the area of a light separable contact is proportional."""
        return ("effective load", "L") if self.ramp or self.legs else ("creep compliance", "J")

    @property
    def effective_load(self) -> Field | None:
        """Load under which an elastic half-space of E* has this contact, N; None where there is none.

        It is E* times the integral of J(t - s) dF(s); at a constant load F, E* F J(t). None for a solid that
        is not separable, and for a load that falls.
        """
        return self.series("effective_load") if "effective_load" in self.dataset else None

    @property
    def theory(self) -> tuple[str, Field] | None:
        """Name of a theory for this contact, and its area, m^2; None without one.

        For a separable solid Persson's theory, for the rms slope of the scan and the effective load. For
        creep by Eyring's law alone that of flowing contacts, through the last area.
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
        """Two ends of the 95 % band of an area, friction, or a carried quantity, at `time`.

        NaN where fewer than three of the 16 tiles of the scan bear the load; of stiffness and resistance also
        where more than 20 % of the surface touches. `InputError` for other names.
        """
        if (quantities := banded(self.dataset)) and name not in quantities:
            raise InputError("name", expected=f"one of {', '.join(quantities)}", got=repr(name))
        return self.series(f"{name}_low"), self.series(f"{name}_high")


def growth_of(dataset: xr.Dataset, scan: OfScan, solid: Mapping[str, Floats]) -> Growth:
    """Measure the growth of a history with maps; `solid` is from `draws_of_solid`."""
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


def resolved(dataset: xr.Dataset, solid: Solid, filled: Mask | None = None) -> tuple[Resolved, ...]:
    """The contacts of the maps; empty without maps or units."""
    if not dataset.attrs["si"] or "in_contact" not in dataset:
        return ()
    placed, lattice, si = on_the_surface(dataset), lattice_of(dataset), True
    bodies = Bodies(dataset["heights"].values, lattice, solid, {}, si)
    times, pressures = dataset["time"].values, dataset["load"].values / bodies.nominal_area

    def at(number: int, row: int) -> Resolved:
        touching, pressure = (placed[name].values[number] for name in ("in_contact", "pressure"))
        loads, when = (times[: row + 1], pressures[: row + 1]), f"at {written(float(times[row]), 's')}"
        return Resolved.of(bodies, touching.astype(bool), pressure, when, filled, *loads)

    return tuple(itertools.starmap(at, enumerate(rows_of_maps(dataset))))


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
