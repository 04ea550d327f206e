r"""95 % bands at each time of what a history records: from the spread of the scan, and of the solid.

Two spreads make it:

    scan    What another scan of this size would give. Each of 16 tiles is left out in turn (jackknife: B.
            Efron, Ann. Stat. 7, 1 (1979), DOI 10.1214/aos/1176344552). Load passes from tile to tile, so
            what the other tiles have is divided by the load that they bear: the area; of what the contact
            carries the force of a rigid punch, whose sum is the stiffness. Quantiles are those of Student's t
            of n - 1 degrees of freedom, where n = (sum F)^2 / sum F^2 tiles bear the loads F.
    solid   `Material.spread`. A separable half-space under a load that never falls has the contact of an
            elastic one at the load E* integral J(t - s) dF(s): what the history recorded is a function of
            that load over E*, which gives the curve of every draw. With a hardness this holds nearly, see
            docs/predict.md. Where a load falls, the history is computed for a few draws. The curves of the
            others are products of powers of these, as logarithms of their compliances are sums.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray

from asperity.analysis.legs import protocol_of
from asperity.base.checks import Floats
from asperity.carried.response import punch
from asperity.contact import Contact
from asperity.lattice import Field
from asperity.protocols import Hold, legs_of
from asperity.relaxation import PronySeries
from asperity.results.quantities import select
from asperity.solids import Solid
from asperity.solids.laws import Scaled

_DRAWS = 1000
_TILES = 4
"""Tiles along each axis of the scan."""

_FEWEST = 3.0
"""Tiles that bear the load, at least: fewer have no spread."""

_END = 0.25
"""Part of a curve along which it is continued."""

_MISSED, _MOST, _LAGS = 0.05, 6, 60
"""Part of the spread of compliances that computed draws may miss, most of these, and times looked at."""

_ROUNDING, _SAME_LOAD = 1e-12, 1e-6

_BY_AREA = {
    "contact_area": ("contact_area", 1),
    "contact_area_corrected": ("contact_area_corrected", 1),
    "contact_fraction": ("contact_area", 1),
    "mean_contact_pressure": ("contact_area", -1),
    "friction_force": ("contact_area_corrected", 1),
    "friction": ("contact_area_corrected", 1),
}
"""Numbers in proportion to a power of an area, where the load is what it is."""

_SHARES = {"stick_fraction": "stick"}
"""What the contact carries that is no stiffness, and what of the maps adds up to it."""

Interval = tuple[float, float]


def interval(values: Floats) -> Floats:
    """Ends of the 95 % band of draws, which are the first axis; shape (2, ...)."""
    return np.asarray(np.quantile(values, (0.025, 0.975), axis=0, method="hazen"))


def rows_of_maps(dataset: xr.Dataset) -> list[int]:
    """Entries of the time series at the times of the maps: at a jump those of the same side."""
    time, rows = np.asarray(dataset["time"]), []
    for number, moment in enumerate(np.asarray(dataset["field_time"])):
        entries = np.flatnonzero(time == moment)
        if "leg" in dataset.coords:
            entries = entries[np.asarray(dataset["leg"])[entries] == int(dataset["field_leg"][number])]
        rows.append(int(entries[-1]))
    return rows


@dataclass(frozen=True, eq=False)
class OfScan:
    """What a history would have been without each tile of the scan.

    Attributes
    ----------
    without
        By what adds up over the tiles, ``"in_contact"``, ``"punch"`` or ``"stick"``: the logarithm of it over
        what it is in proportion to, without a tile, less that with all; shape (tiles, entries). ``"load"``:
        that of the load over the sites.
    bearing
        How many tiles bear the load, shape (entries,).
    separable
        Whether the contact follows from the load alone; where stresses set the rates, which tiles bear it
        counts for growth, too.
    """

    without: Mapping[str, Floats]
    bearing: Field
    separable: bool

    @classmethod
    def of(cls, dataset: xr.Dataset, contact: Contact) -> OfScan:
        """Take it from the maps of a history that began with a contact."""
        touching, rows = np.asarray(dataset["in_contact"]), rows_of_maps(dataset)
        area, load = in_tiles(touching), in_tiles(np.asarray(dataset["pressure"]))
        sites = in_tiles(np.ones_like(touching))
        parts = {"in_contact": (area, load)}
        if set(banded(dataset)) - set(_BY_AREA):
            parts["punch"] = in_tiles(np.array([punch(contact, mask) for mask in touching])), load
        if "stick" in dataset:
            parts["stick"] = in_tiles(np.asarray(dataset["stick"])), area
        entries = np.arange(dataset.sizes["time"])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = {
                name: np.log(without_each(mask) / without_each(other))
                for name, (mask, other) in parts.items()
            }
            ratios["load"] = np.log(without_each(load) / without_each(sites))
            # Where much touches, the area is less than in proportion to the load.
            ratios["in_contact"] += (1 - _slope(touching.mean(axis=(1, 2))))[:, None] * ratios["load"]
            borne = bearing(load)
        without = {
            name: np.array(
                [np.interp(entries, rows, np.where(np.isfinite(tile), tile, np.nan)) for tile in ratio.T]
            )
            for name, ratio in ratios.items()
        }
        return cls(without, np.interp(entries, rows, borne), contact.solid.separable)

    def at(self, rows: NDArray[np.intp]) -> OfScan:
        """The same at some entries."""
        without = {name: logs[:, rows] for name, logs in self.without.items()}
        return replace(self, without=without, bearing=self.bearing[rows])

    def draws(self, name: str) -> Floats:
        """Factors of other scans, shape (draws, entries); NaN where too few tiles bear."""
        return np.exp(student(self.without[name], self.bearing))

    def draws_of(self, measure: Callable[[Field], float]) -> Floats:
        """What another scan would add to a measure of factors on the area, shape (draws,)."""
        deviations = np.array([measure(np.exp(logs)) for logs in np.nan_to_num(self.without["in_contact"])])
        deviations -= measure(np.ones_like(self.bearing))
        if self.separable:
            # What a tile takes over from others changes nothing for all: the regression on it is left out.
            moved = np.nan_to_num(np.diff(self.without["load"][:, [1, -1]]))[:, 0]
            deviations -= moved * (deviations @ moved) / max(float(moved @ moved), _ROUNDING)
        enough = self.bearing.min() >= _FEWEST
        return student(deviations[:, None], np.array(len(deviations) - 1 if enough else 0))[:, 0]


def banded(dataset: xr.Dataset) -> list[str]:
    """Names of what has a band: areas, friction, and all that the contact carries."""
    carried = select("series", of=["carried"])
    return [name for name in (*_BY_AREA, *carried) if name in dataset]


def with_bands(dataset: xr.Dataset, scan: OfScan, solid: Mapping[str, Floats]) -> xr.Dataset:
    """Add ``_low`` and ``_high`` of what has a band; `solid` is that of `draws_of_solid`."""
    columns = {}
    for name in banded(dataset):
        base, power = _BY_AREA.get(name, (name, 1))
        factors = scan.draws("in_contact" if name in _BY_AREA else _SHARES.get(name, "punch"))
        factors *= np.resize(solid.get(base, [[1.0]]), factors.shape)
        ends, facts = np.asarray(dataset[name]) * interval(factors**power), dataset[name].attrs
        for end, values in zip(("low", "high"), ends, strict=True):
            attributes = {
                "long_name": f"{facts['long_name']}: {end} end of the 95 % band",
                "units": facts["units"],
            }
            columns[f"{name}_{end}"] = "time", values, attributes
    return dataset.assign(columns)


def effective_load(dataset: xr.Dataset, series: PronySeries) -> Field | None:
    """Load on an elastic half-space with this contact at each entry; None where it is not known.

    It is known while the load never falls and creep is as fast all the time.
    """
    time, load = (np.asarray(dataset[name]) for name in ("time", "load"))
    falls = (np.diff(load) < -_SAME_LOAD * load.max()).any()
    if falls or any(leg.mobility != 1 for leg in legs_of(protocol_of(dataset) or Hold(1.0))):
        return None
    return series.effective_load(time, load)


def draws_of_solid(
    dataset: xr.Dataset,
    series: Sequence[PronySeries],
    solid: Solid,
    computed: Callable[[Solid, str], xr.Dataset],
) -> dict[str, Floats]:
    """Factors on a history by draws of its solid, by the names of what they are of.

    Parameters
    ----------
    dataset
        The history.
    series
        `Material.spread`: that of the solid, and those that may be in its place.
    solid
        The half-space of the history.
    computed
        The same history of another solid, which is done in a stage of this name.

    Returns
    -------
    dict
        Arrays of shape (draws, entries); empty without a spread.
    """
    names = [name for name in banded(dataset) if _BY_AREA.get(name, (name,))[0] == name]
    curves = {name: np.asarray(dataset[name], dtype=float) for name in names}
    if len(series) < 2:
        return {}
    if (loads := effective_load(dataset, series[0])) is None:
        return _by_some(dataset, curves, series, solid, computed)
    on = np.flatnonzero(loads > 0)
    crept = [np.log(np.asarray(effective_load(dataset, draw))[on] / draw.modulus) for draw in series]
    grown = np.flatnonzero(np.diff(np.maximum.accumulate(crept[0]), prepend=-np.inf) > _ROUNDING)
    factors_of = {}
    for name, curve in curves.items():
        factors = np.ones((len(series) - 1, curve.size))
        if grown.size > 1 and (curve[on] > 0).all() and np.isfinite(curve[on]).all():
            y = np.log(curve[on])
            at_once = select()[name].dimension == "stiffness"  # which is in proportion to the modulus at once
            for factor, load, draw in zip(factors, crept[1:], series[1:], strict=True):
                factor[on] = np.exp(_continued(load, crept[0][grown], y[grown]) - y)
                factor[on] *= draw.modulus / series[0].modulus if at_once else 1.0
        factors_of[name] = factors
    return factors_of


def _by_some(
    dataset: xr.Dataset,
    curves: Mapping[str, Field],
    series: Sequence[PronySeries],
    solid: Solid,
    computed: Callable[[Solid, str], xr.Dataset],
) -> dict[str, Floats]:
    """Compute the history for those draws that span the compliances; the others follow from these."""
    time = np.asarray(dataset["time"])
    lags = np.append(0.0, np.geomspace(time[time > 0][0] / 10, time[-1], _LAGS))
    compliance = np.log([draw.compliance_at(lags) for draw in series])
    modes, size, _ = np.linalg.svd(compliance[1:] - compliance[0], full_matrices=False)
    missed = np.sqrt(np.append(np.cumsum(size[::-1] ** 2)[::-1], 0.0))
    count = min(int(np.argmax(missed <= _MISSED * missed[0])), _MOST)
    scores = (modes * size)[:, :count]
    chosen = scipy.linalg.qr(scores.T, mode="r", pivoting=True)[1][:count]
    weights = np.linalg.lstsq(scores[chosen].T, scores.T, rcond=None)[0].T
    logarithms = {name: np.zeros((count, curve.size)) for name, curve in curves.items()}
    for number, draw in enumerate(chosen):
        other = series[1 + draw]
        factor = other.modulus / series[0].modulus
        assert solid.stiffness is not None
        assert solid.modulus is not None
        parts: dict[str, Any] = {"permanent": None, "branches": (), "parameters": {}}
        scaled = {"modulus": factor * solid.modulus, "stiffness": Scaled(solid.stiffness, factor)}
        drawn = replace(solid, shares=other.branches, **parts, **scaled)
        history = computed(drawn, f"aging draw {number + 1} of {count} of the solid")
        for name, curve in curves.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = np.log(np.asarray(history[name]) / curve)
            logarithms[name][number] = np.where(np.isfinite(ratio), ratio, 0.0)
    return {name: np.exp(weights @ computed_logs) for name, computed_logs in logarithms.items()}


def in_tiles(maps: Floats, gather: np.ufunc = np.add) -> Floats:
    """Sums, or what else gathers values, over the tiles of maps; shape (maps, tiles)."""
    for axis in (1, 2):
        ends = np.linspace(0, maps.shape[axis], _TILES + 1).astype(int)[:-1]
        maps = gather.reduceat(maps, ends, axis=axis, dtype=np.float64)
    return maps.reshape(maps.shape[0], -1)


def _slope(fraction: Field) -> Field:
    """Slope of ln A over ln F at fractions of contact, by Persson's theory: A goes as erf(c F)."""
    argument = scipy.special.erfinv(np.minimum(fraction, 1 - _ROUNDING))
    return np.asarray(argument * np.exp(-(argument**2)) * 2 / np.sqrt(np.pi) / fraction)


def bearing(load: Floats) -> Field:
    """How many tiles bear the load, shape (maps,), from what each bears, shape (maps, tiles)."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.nan_to_num(load.sum(axis=1) ** 2 / (load**2).sum(axis=1)))


def without_each(tiles: Floats) -> Floats:
    """The sum over the other tiles, divided by that over all; shape (maps, tiles)."""
    whole = tiles.sum(axis=1, keepdims=True)
    return np.asarray((whole - tiles) / whole)


def student(without: Floats, bearing: Field) -> Floats:
    """Draws of the error of a number from its changes without each tile; shape (draws, entries)."""
    count = len(without)
    error = np.sqrt((count - 1) / count * (without**2).sum(axis=0))
    error = np.where((bearing >= _FEWEST) | (error == 0), error, np.nan)
    evenly = (np.random.default_rng(0).permutation(_DRAWS) + 0.5) / _DRAWS
    return np.asarray(error * scipy.special.stdtrit(np.maximum(bearing, _FEWEST) - 1, evenly[:, None]))


def _continued(at: Field, x: Field, y: Field) -> Field:
    """Interpolate, and go on along the first and the last quarter: pieces may be as small as a pixel."""
    part = _END * (x[-1] - x[0])
    before, after = np.diff(np.interp([x[0], x[0] + part, x[-1] - part, x[-1]], x, y))[::2] / part
    inside = np.interp(at, x, y)
    return np.asarray(inside + np.minimum(at - x[0], 0) * before + np.maximum(at - x[-1], 0) * after)
