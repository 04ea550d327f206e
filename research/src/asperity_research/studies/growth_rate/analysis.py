"""The numbers on the growth rate, and the claims on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

import asperity.theory as theory
import asperity_research.studies.growth_rate.grown as grown
from asperity.fits import Estimate, jackknife
from asperity_research.arrays import Field
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.growth_rate.grown import Grown, Key, Number, rate
from asperity_research.studies.ledger import Finding
from asperity_research.studies.numbers import all_columns, power
from asperity_research.studies.study import Outcome

NEAR = (0.9, 1.1)
"""Ratios that bear out that two rates are the same."""

TWICE = (1.8, 2.2)
"""Ratios that bear out that one rate is twice another."""

FLAT = (-0.05, 0.05)
"""Exponents that bear out that one quantity does not depend on another."""


def _combined(
    combine: Callable[[Field], float],
    number: Callable[[Grown, Field, Field], float | tuple[float, float]],
    sets: Sequence[Grown],
) -> Estimate:
    """Combine what is computed of areas and closed forms of some sets, of as many surfaces each."""

    def statistic(*arrays: Field) -> float:
        each = zip(sets, arrays[::2], arrays[1::2], strict=True)
        return combine(np.array([number(*one) for one in each]))

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


def _estimate(combine: Callable[[Field], float], *sets: Grown, of: Number = rate) -> Estimate:
    """Combine a number of some sets."""
    return _combined(combine, lambda one, area, closed: one.number(of, area, closed), sets)


def _alone(found: Grown, of: Number = rate) -> Estimate:
    return _estimate(lambda numbers: float(numbers[0]), found, of=of)


def _over(one: Grown, other: Grown | float) -> Estimate:
    """B of one set over that of another, or over a number."""
    if isinstance(other, Grown):
        return _estimate(lambda rates: float(rates[0] / rates[1]), one, other)
    return _estimate(lambda rates: float(rates[0] / other), one)


def _over_limit(found: Grown) -> Estimate:
    """B over that of the closed form; the same whether both are of these surfaces or of those without end."""
    return _over(found, found.limit)


def _exponent(sets: Mapping[float, Grown], of: Number = rate) -> Estimate:
    """Slope of the logarithm of a rate against that of what is varied; NaN for an area that does not grow."""
    at = np.array(list(sets))
    return _estimate(lambda rates: power(at, rates) if (rates > 0).all() else math.nan, *sets.values(), of=of)


def _exponent_of_end(sets: Sequence[Grown]) -> Estimate:
    """Slope of the logarithm of the time at which the closed form ends against that of the area then."""
    return _combined(
        lambda ends: power(ends[:, 1], ends[:, 0]), lambda one, *areas: grown.end(one.time, *areas), sets
    )


def _row(key: Key, found: Grown) -> dict[str, Any]:
    """Everything that is said of one set of parameters."""
    return {
        **dict(zip(("of", "surfaces", "at"), key, strict=True)),
        "load": found.load,
        "sites": found.sites,
        "area_at_first": found.area[:, 0].mean(),
        "area_at_last": found.area[:, found.time <= grown.WINDOW[1] * (1 + 1e-9)][:, -1].mean(),
        **all_columns(
            B=_alone(found),
            over_closed=_over_limit(found),
            relative=_alone(found, grown.relative_rate),
            straightness=_alone(found, grown.straightness),
        ),
        "closed": found.limit,
        "runs": len(found.area),
    }


_DILUTE, _HERE, _PAPER = "dilute theory", "this study", "Jagla, Eq. (log)"
_B, _K = "<i>B</i>", "<i>k</i><sub>1</sub>/<i>k</i><sub>0</sub>"
_BEND = f"{_B} in the second decade over that in the first"
_RELATIVE = "d ln <i>A</i>/d ln <i>t</i>"


def _chosen(sets: Mapping[Key, Grown], of: str, surfaces: str = grown.GAUSSIAN) -> dict[float, Grown]:
    return {at: found for (what, kind, at), found in sets.items() if (what, kind) == (of, surfaces)}


def _part(some: Mapping[float, Grown], low: float, high: float = math.inf) -> dict[float, Grown]:
    return {at: found for at, found in some.items() if low <= at <= high}


def _closed(words: str, some: Mapping[float, Grown]) -> dict[str, Estimate]:
    head = f"{_B} over that of the closed form: {words}"
    return {f"{head} {at:g}": _over_limit(one) for at, one in some.items()}


def _on_solids(sets: Mapping[Key, Grown]) -> Iterator[Finding]:
    """Judge what is claimed of stiffness and mobility, under light loads."""
    within = Finding.within
    ratios = _chosen(sets, "k1/k0")
    viscous = {
        load: _chosen(sets, "R_viscous/R", grown.by_load(load)) for load in (grown.LIGHTEST, grown.LIGHT)
    }
    claim = "Under a light load B is that of the closed form"
    yield within(NEAR, "ratio", _DILUTE, claim, _closed(_K, ratios))
    head = f"d ln {_B}/d ln({_K}), {_K}"
    numbers = {
        f"{head} up to 1": _exponent(_part(ratios, 0, 1.0)),
        f"{head} from 3 on": _exponent(_part(ratios, 3.0)),
    }
    yield within(NEAR, "proportional", "Jagla, Eq. (ndet2)", "B is in proportion to k1/k0", numbers)
    found = _exponent(_part(ratios, 1.0), grown.relative_rate)
    numbers = {f"d ln({_RELATIVE})/d ln({_K}), {_K} from 1 on": found}
    yield within(FLAT, "relative", _DILUTE, "d ln A/d ln t does not depend on k1/k0", numbers)
    for load, some in viscous.items():
        claim = f"B is that of the closed form at all R_viscous/R under the load {load:g} a site"
        yield within(NEAR, f"viscous_{load:g}", _DILUTE, claim, _closed("R_viscous/R", some))
    numbers = {
        f"{_B} at R_viscous/R {r:g} over that at 0, load a site {load:g}": _over(one, some[0.0])
        for load, some in viscous.items()
        for r, one in _part(some, 1.0).items()
    }
    claim = "B doubles from R_viscous = 0 to large R_viscous/R"
    yield within(TWICE, "doubles", "Jagla, Fig. 9", claim, numbers)


def _on_surfaces(sets: Mapping[Key, Grown]) -> Iterator[Finding]:
    """Judge what is claimed of loads and heights."""
    within = Finding.within
    loads = _chosen(sets, "load")
    waves = {hurst: _chosen(sets, "cutoff", grown.by_hurst(hurst)) for hurst in grown.HURST}
    claim = "B is that of the closed form at all loads"
    yield within(NEAR, "load", _DILUTE, claim, _closed("load a site", loads))
    numbers = {
        f"d ln {_B}/d ln <i>F</i>, load a site from {low:g} to {high:g}": _exponent(_part(loads, low, high))
        for low, high in ((grown.LIGHTEST, grown.LIGHT), (grown.SIZE_LOAD, 0.3))
    }
    yield within(FLAT, "load_free", "Jagla, after Eq. (ndet2)", "B does not depend on load", numbers)
    bend = grown.straightness
    numbers = {f"{_BEND}: load a site {load:g}": _alone(one, bend) for load, one in loads.items()}
    claim = "On independent heights the area grows like ln t in the window"
    yield within(NEAR, "logarithm", _PAPER, claim, numbers)
    numbers = {f"{_BEND}: {grown.by_hurst(hurst)}": _alone(some[4.0], bend) for hurst, some in waves.items()}
    claim = "On waves the area grows like ln t in the window"
    yield within(NEAR, "logarithm_waves", _PAPER, claim, numbers)
    claim = "The closed form ends at a time in proportion to (contact fraction)^-2, when dips meet"
    what = f"d ln (time at which the area is {grown.END:g} of that of the closed form)"
    numbers = {f"{what}/d ln (contact fraction then)": _exponent_of_end([loads[at] for at in grown.ENDING])}
    yield within((-2.2, -1.8), "end", "dilute horizon", claim, numbers)
    found = _over(sets["rms", grown.GAUSSIAN, grown.RMS], loads[grown.LIGHT])
    numbers = {f"{_B} at heights and load times {grown.RMS:g} over that before": found}
    claim = "Heights and load times a number leave B alone"
    yield within((0.999, 1.001), "rms", "scaling", claim, numbers)
    law = sets["law", grown.EXPONENTIAL, 1.0]
    found = _over(law, float(theory.late_slope(grown.RATIO)))
    numbers = {f"{_B} over <i>k</i><sub>eff</sub>/(8 pi <i>k</i><sub>0</sub>)": found}
    numbers |= _closed("exponential heights, rms", {1.0: law})
    yield within(NEAR, "law", _DILUTE, "On exponential heights B is k_eff/(8 pi k0)", numbers)
    head = f"d ln {_B}/d ln (shortest wavelength)"
    numbers = {f"{head}: {grown.by_hurst(hurst)}": _exponent(some) for hurst, some in waves.items()}
    yield within(FLAT, "waves", _HERE, "B does not depend on the shortest wavelength", numbers)
    head = f"{_B} at the Hurst exponent 0.8 over that at 0.2, waves from"
    numbers = {f"{head} {wave:g} sites": _over(waves[0.8][wave], waves[0.2][wave]) for wave in grown.CUTOFFS}
    yield within(NEAR, "hurst", _HERE, "B does not depend on the Hurst exponent", numbers)
    sides = {
        grown.GAUSSIAN: _chosen(sets, "side"),
        "waves from 4 sites": _chosen(sets, "side", grown.by_hurst(0.8)),
    }
    over = f"sites along a side over that at {grown.SIDE}"
    numbers = {
        f"{_B} at {side} {over}: {words}": _over(some[side], some[grown.SIDE])
        for words, some in sides.items()
        for side in grown.SIZES[:-1]
    }
    yield within(NEAR, "size", _HERE, "B does not depend on the size of the surface", numbers)


def analyse(evidence: Evidence) -> Outcome:
    """Find B for all parameters, and compare it with the closed forms."""
    sets = grown.sets_of(evidence)
    courses = []
    for (of, _, load), one in sets.items():
        if of == "load":
            area, closed = one.area.mean(axis=0)[1:], one.closed.mean(axis=0)[1:]
            course = {"load": load, "time": one.time[1:], "area": area, "over_closed": area / closed}
            courses.append(pd.DataFrame(course))
    tables = {
        "points": pd.DataFrame([_row(key, found) for key, found in sets.items()]),
        "lines": _lines(),
        "courses": pd.concat(courses, ignore_index=True),
    }
    return Outcome((*_on_solids(sets), *_on_surfaces(sets)), tables)


def _lines() -> pd.DataFrame:
    """Closed forms on surfaces without end."""
    time = np.append(0.0, np.geomspace(*grown.WINDOW, 9))
    law = theory.GaussianHeights(1.0)

    def closed(load: float, x1: float = grown.RATIO, r: float = 0.0) -> float:
        return rate(time, grown.closed_area(law, load, time, x1, r)[None])

    ratios = np.geomspace(grown.RATIOS[0], grown.RATIOS[-1], 25).tolist()
    loads = np.geomspace(grown.LOADS[0], grown.LOADS[-1], 25).tolist()
    viscous = np.geomspace(grown.ZERO, grown.VISCOUS[-1], 31).tolist()
    lines: list[tuple[str, str, list[float], list[float]]] = [
        ("k1/k0", "closed form", ratios, [closed(grown.LIGHT, x1) for x1 in ratios]),
        ("k1/k0", "late, exponential", ratios, theory.late_slope(ratios).tolist()),
        ("k1/k0", "paper", ratios, theory.late_slope_paper(ratios).tolist()),
        ("load", "closed form", loads, [closed(load) for load in loads]),
        *(
            ("R_viscous/R", grown.by_load(load), viscous, [closed(load, r=r) for r in viscous])
            for load in (grown.LIGHTEST, grown.LIGHT)
        ),
        ("side", "closed form", list(grown.SIZES), [closed(grown.SIZE_LOAD)] * len(grown.SIZES)),
    ]
    names = ("of", "line", "at", "B")
    return pd.concat([pd.DataFrame(dict(zip(names, one, strict=True))) for one in lines], ignore_index=True)
