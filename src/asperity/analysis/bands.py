r"""95 % bands of the areas, stiffness and friction of a history, at each time.

Two spreads make them:

scan    Another scan of this size. Each of 16 tiles is left out in turn (jackknife: B. Efron, Ann. Stat.
        7, 1 (1979), DOI 10.1214/aos/1176344552). Load passes from tile to tile, so the area of the other
        tiles is divided by their load. For stiffness and resistance the area is replaced by the force of
        a rigid punch. Quantiles are those of Student's t with n - 1 degrees of freedom, where
        n = (sum F)^2 / sum F^2 tiles bear the loads F.
solid   `Material.spread`: random draws of the branches. A separable half-space under a load that never
        falls has the contact of an elastic one at the load E* integral J(t - s) dF(s). So the recorded
        numbers are functions of that load over E*, which gives the curve of every draw. With a hardness
        this holds nearly, see docs/predict.md. Where a load falls, the history is computed for a few
        draws. Logarithms of the other compliances are sums of theirs, and so are those of the curves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray

from asperity.analysis.legs import numbers_of, protocol_of
from asperity.base.checks import Floats
from asperity.carried.response import punch
from asperity.contact import Contact
from asperity.lattice import Field
from asperity.protocols import Hold
from asperity.protocols.legs import legs_of
from asperity.relaxation import PronySeries
from asperity.results.quantities import select
from asperity.solids import Solid
from asperity.solids.laws import Scaled

_DRAWS = 1000
_TILES = 4
"""Tiles along each axis of the scan."""

_FEWEST = 3.0
"""Fewest tiles that bear the load for a band."""

CLOSED = 0.2
"""Contact fraction above which stiffness has no band: 87 % of 256 held the mean at 0.22, 53 % at 0.65."""

_END = 0.25
"""Part of a curve whose slope continues it."""

_MISSED, _MOST, _LAGS = 0.05, 6, 60
"""Spread of compliances that computed draws may miss, their largest number, and times compared."""

_ROUNDING, _SAME_LOAD = 1e-12, 1e-6

_BY_AREA = {
    "contact_area": ("contact_area", 1),
    "contact_area_corrected": ("contact_area_corrected", 1),
    "contact_fraction": ("contact_area", 1),
    "mean_contact_pressure": ("contact_area", -1),
    "friction_force": ("contact_area_corrected", 1),
    "friction": ("contact_area_corrected", 1),
}
"""Quantities proportional to a power of an area under the same load."""

_SHARES = {"stick_fraction": "stick"}
"""Carried quantities that do not follow the stiffness, and the maps whose sums they are."""

Interval = tuple[float, float]


def interval(values: Floats) -> Floats:
    """Ends of the 95 % band of draws along the first axis; shape (2, ...)."""
    return np.asarray(np.quantile(values, (0.025, 0.975), axis=0, method="hazen"))


def rows_of_maps(dataset: xr.Dataset) -> list[int]:
    """Entries of the time series at the times of the maps, or the last before; at a jump that of the leg."""
    time, moments, legs = dataset["time"].values, dataset["field_time"].values, numbers_of(dataset)
    until = dataset["field_leg"].values if "field_leg" in dataset.coords else 0 * moments
    before = (time <= moments[:, np.newaxis]) & (legs <= until[:, np.newaxis])
    return [int(np.flatnonzero(entries)[-1]) for entries in before]


@dataclass(frozen=True, eq=False)
class OfScan:
    """How a history changes where one tile of the scan is left out.

    Attributes
    ----------
    without
        Changes of ln(sum over the tiles / its reference) without each tile, shape (tiles, entries):
        ``"in_contact"`` and ``"punch"`` over the load, ``"stick"`` over the area, ``"load"`` over the sites.
    bearing
        How many tiles bear the load, shape (entries,).
    separable
        Whether the contact depends on the load alone. Otherwise stresses set the rates, so growth also
        depends on which tiles bear the load.
    """

    without: Mapping[str, Floats]
    bearing: Field
    separable: bool

    @classmethod
    def of(cls, dataset: xr.Dataset, contact: Contact) -> OfScan:
        """Compare the maps of a history that began with this contact."""
        touching, rows = np.asarray(dataset["in_contact"]), rows_of_maps(dataset)
        area, load = in_tiles(touching), in_tiles(np.asarray(dataset["pressure"]))
        sites = in_tiles(np.isfinite(contact.heights)[np.newaxis])
        parts = {"in_contact": (area, load)}
        if set(banded(dataset)) - set(_BY_AREA):
            parts["punch"] = in_tiles(np.array([punch(contact, mask) for mask in touching])), load
        if "stick" in dataset:
            parts["stick"] = in_tiles(np.asarray(dataset["stick"])), area
        entries = np.arange(dataset.sizes["time"])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = {name: np.log(without_each(a) / without_each(b)) for name, (a, b) in parts.items()}
            ratios["load"] = np.log(without_each(load) / without_each(sites))
            # Near full contact the area grows less than the load.
            ratios["in_contact"] += saturation(area.sum(axis=1) / contact.sites)[:, None] * ratios["load"]
            borne = bearing(load)
        without = {
            name: np.array(
                [np.interp(entries, rows, np.where(np.isfinite(tile), tile, np.nan)) for tile in ratio.T]
            )
            for name, ratio in ratios.items()
        }
        return cls(without, np.interp(entries, rows, borne), contact.solid.separable)

    def at(self, rows: NDArray[np.intp]) -> OfScan:
        """Changes at some entries."""
        without = {name: logs[:, rows] for name, logs in self.without.items()}
        return replace(self, without=without, bearing=self.bearing[rows])

    def draws(self, name: str) -> Floats:
        """Factors of other scans, shape (draws, entries); NaN where too few tiles bear."""
        return np.exp(student(self.without[name], self.bearing))

    def draws_of(self, measure: Callable[[Field], float]) -> Floats:
        """Errors of a measure of factors on the area, by scans; shape (draws,)."""
        deviations = np.array([measure(np.exp(logs)) for logs in np.nan_to_num(self.without["in_contact"])])
        deviations -= measure(np.ones_like(self.bearing))
        if self.separable:
            # Load that passes between tiles changes no sum: its regression is subtracted.
            moved = np.nan_to_num(np.diff(self.without["load"][:, [1, -1]]))[:, 0]
            deviations -= moved * (deviations @ moved) / max(float(moved @ moved), _ROUNDING)
        enough = self.bearing.min() >= _FEWEST
        return student(deviations[:, None], np.array(len(deviations) - 1 if enough else 0))[:, 0]


def banded(dataset: xr.Dataset) -> list[str]:
    """Names of the quantities with a band: areas, friction, and carried quantities."""
    carried = select("series", of=["carried"])
    return [name for name in (*_BY_AREA, *carried) if name in dataset]


def with_bands(dataset: xr.Dataset, scan: OfScan, solid: Mapping[str, Floats]) -> xr.Dataset:
    """Add ``_low`` and ``_high`` of each banded quantity; `solid` is from `draws_of_solid`."""
    columns: dict[str, Any] = {}
    for name in banded(dataset):
        base, power = _BY_AREA.get(name, (name, 1))
        part = "in_contact" if name in _BY_AREA else _SHARES.get(name, "punch")
        factors = scan.draws(part)
        if part == "punch":
            factors[:, dataset["contact_fraction"].values > CLOSED] = np.nan
        spring = dataset.attrs.get("apparatus", math.inf)
        if name == "normal_stiffness" and math.isfinite(spring):  # in series, and sure
            sure = dataset[name].values / spring
            factors = 1 / (sure + (1 - sure) / factors)
        factors *= np.resize(solid.get(base, [[1.0]]), factors.shape)
        columns |= band_of(dataset[name], factors**power)
    return dataset.assign(columns)


def band_of(quantity: xr.DataArray, factors: Floats) -> dict[str, Any]:
    """``_low`` and ``_high`` of a quantity, in a Dataset, by factors of draws along the first axis."""
    ends, facts, columns = quantity.values * interval(factors), quantity.attrs, {}
    for end, values in zip(("low", "high"), ends, strict=True):
        long_name = f"{facts['long_name']}: {end} end of the 95 % band"
        of_end = quantity.dims, values, {"long_name": long_name, "units": facts["units"]}
        columns[f"{quantity.name}_{end}"] = of_end
    return columns


def effective_load(dataset: xr.Dataset, series: PronySeries) -> Field | None:
    """Load on an elastic half-space with this contact, at each entry.

    None where the load falls or the mobility changes.
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
    """Factors on the quantities of a history, by their names, for draws of its solid.

    Parameters
    ----------
    dataset
        The history.
    series
        `Material.spread`: the series of the solid, then the draws.
    solid
        The half-space of the history.
    computed
        Computes this history for another solid, in a stage of progress with this name.

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
        time = np.asarray(dataset["time"])
        lags = np.append(0.0, np.geomspace(time[time > 0][0] / 10, time[-1], _LAGS))
        return by_some(curves, lags, series, solid, computed)
    on = np.flatnonzero(loads > 0)
    crept = [np.log(np.asarray(effective_load(dataset, draw))[on] / draw.modulus) for draw in series]
    grown = np.flatnonzero(np.diff(np.maximum.accumulate(crept[0]), prepend=-np.inf) > _ROUNDING)
    factors_of = {}
    for name, curve in curves.items():
        factors = np.ones((len(series) - 1, curve.size))
        if grown.size > 1 and (curve[on] > 0).all() and np.isfinite(curve[on]).all():
            y = np.log(curve[on])
            at_once = select()[name].dimension == "stiffness"  # proportional to E* by itself
            for factor, load, draw in zip(factors, crept[1:], series[1:], strict=True):
                factor[on] = np.exp(_continued(load, crept[0][grown], y[grown]) - y)
                factor[on] *= draw.modulus / series[0].modulus if at_once else 1.0
        factors_of[name] = factors
    return factors_of


def by_some(
    curves: Mapping[str, Field],
    lags: Field,
    series: Sequence[PronySeries],
    solid: Solid,
    computed: Callable[[Solid, str], Mapping[Any, Any]],
) -> dict[str, Floats]:
    """Compute curves for draws that span the compliances at some lags; derive the others from them."""
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
        history = computed(drawn, f"draw {number + 1} of {count} of the solid")
        for name, curve in curves.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = np.log(np.asarray(history[name]) / curve)
            logarithms[name][number] = np.where(np.isfinite(ratio), ratio, 0.0)
    return {name: np.exp(weights @ computed_logs) for name, computed_logs in logarithms.items()}


def in_tiles(maps: Floats, gather: np.ufunc = np.add) -> Floats:
    """Sums, or another reduction, over the tiles of maps; shape (maps, tiles)."""
    for axis in (1, 2):
        ends = np.linspace(0, maps.shape[axis], _TILES + 1).astype(int)[:-1]
        maps = gather.reduceat(maps, ends, axis=axis, dtype=np.float64)
    return maps.reshape(maps.shape[0], -1)


def saturation(fraction: Field) -> Field:
    """1 - d ln A / d ln F at contact fractions, by Persson's theory: A ~ erf(c F)."""
    argument = scipy.special.erfinv(np.minimum(fraction, 1 - _ROUNDING))
    return np.asarray(1 - argument * np.exp(-(argument**2)) * 2 / np.sqrt(np.pi) / fraction)


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
    """Interpolate; extrapolate with the slopes of the first and last quarter, as steps may be one pixel."""
    part = _END * (x[-1] - x[0])
    before, after = np.diff(np.interp([x[0], x[0] + part, x[-1] - part, x[-1]], x, y))[::2] / part
    inside = np.interp(at, x, y)
    return np.asarray(inside + np.minimum(at - x[0], 0) * before + np.maximum(at - x[-1], 0) * after)
