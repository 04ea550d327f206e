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
from asperity_research.studies.numbers import columns, power
from asperity_research.studies.study import Outcome

NEAR = (0.9, 1.1)
"""Ratios that bear out that two rates are the same."""

TWICE = (1.8, 2.2)
"""Ratios that bear out that one rate is twice another."""

FLAT = (-0.05, 0.05)
"""Exponents that bear out that one quantity does not depend on another."""


def _estimate(combine: Callable[[Field], float], *sets: Grown, of: Number = rate) -> Estimate:
    """Combine a number of some sets, of as many surfaces each; with its interval."""

    def statistic(*arrays: Field) -> float:
        pairs = zip(sets, arrays[::2], arrays[1::2], strict=True)
        return combine(np.array([one.number(of, area, closed) for one, area, closed in pairs]))

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


def _only(numbers: Field) -> float:
    return float(numbers[0])


def _over(one: Grown, other: Grown) -> Estimate:
    """B of one set over that of another."""
    return _estimate(lambda rates: float(rates[0] / rates[1]), one, other)


def _over_limit(found: Grown) -> Estimate:
    """B over that of the closed form; the same whether both are of these surfaces or of those without end."""
    return _estimate(lambda rates: float(rates[0] / found.limit), found)


def _exponent(sets: Mapping[float, Grown], of: Number = rate) -> Estimate:
    """Slope of the logarithm of a rate against that of what is varied; NaN for an area that does not grow."""
    at = np.array(list(sets))
    return _estimate(lambda rates: power(at, rates) if (rates > 0).all() else math.nan, *sets.values(), of=of)


def _row(key: Key, found: Grown) -> dict[str, Any]:
    """Everything that is said of one set of parameters."""
    return {
        **dict(zip(("of", "surfaces", "at"), key, strict=True)),
        "load": found.load,
        "sites": found.sites,
        "area_at_first": found.area[:, 0].mean(),
        "area_at_last": found.area[:, found.time <= grown.WINDOW[1] * (1 + 1e-9)][:, -1].mean(),
        **columns("B", _estimate(_only, found)),
        **columns("over_closed", _over_limit(found)),
        **columns("relative", _estimate(_only, found, of=grown.relative_rate)),
        **columns("straightness", _estimate(_only, found, of=grown.straightness)),
        "closed": found.limit,
        "runs": len(found.area),
    }


def _exponent_of_end(sets: Sequence[Grown]) -> Estimate:
    """Slope of the logarithm of the time at which the closed form ends against that of the area then."""

    def statistic(*arrays: Field) -> float:
        pairs = zip(sets, arrays[::2], arrays[1::2], strict=True)
        at, area = np.array([grown.end(one.time, simulated, closed) for one, simulated, closed in pairs]).T
        return power(area, at)

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


_DILUTE, _HERE, _PAPER = "dilute theory", "this study", "Jagla, Eq. (log)"
_B, _K = "<i>B</i>", "<i>k</i><sub>1</sub>/<i>k</i><sub>0</sub>"
_BEND = f"{_B} in the second decade over that in the first"
_RELATIVE = "d ln <i>A</i>/d ln <i>t</i>"
_ENDED = (
    f"d ln (time at which the area is {grown.END:g} of that of the closed form)/d ln (contact fraction then)"
)


def _findings(sets: Mapping[Key, Grown]) -> Iterator[Finding]:
    """Judge all claims."""

    def chosen(of: str, surfaces: str = grown.GAUSSIAN) -> dict[float, Grown]:
        return {at: found for (what, kind, at), found in sets.items() if (what, kind) == (of, surfaces)}

    def part(some: Mapping[float, Grown], low: float, high: float = math.inf) -> dict[float, Grown]:
        return {at: found for at, found in some.items() if low <= at <= high}

    def closed(words: str, some: Mapping[float, Grown]) -> dict[str, Estimate]:
        return {
            f"{_B} over that of the closed form: {words} {at:g}": _over_limit(one) for at, one in some.items()
        }

    ratios, loads = chosen("k1/k0"), chosen("load")
    viscous = {load: chosen("R_viscous/R", grown.by_load(load)) for load in (grown.LIGHTEST, grown.LIGHT)}
    waves = {hurst: chosen("cutoff", grown.by_hurst(hurst)) for hurst in grown.HURST}
    law = sets["law", grown.EXPONENTIAL, 1.0]
    yield Finding.within(
        NEAR, "ratio", _DILUTE, "Under a light load B is that of the closed form", closed(_K, ratios)
    )
    numbers = {
        f"d ln {_B}/d ln({_K}), {_K} up to 1": _exponent(part(ratios, 0, 1.0)),
        f"d ln {_B}/d ln({_K}), {_K} from 3 on": _exponent(part(ratios, 3.0)),
    }
    yield Finding.within(NEAR, "proportional", "Jagla, Eq. (ndet2)", "B is in proportion to k1/k0", numbers)
    numbers = {
        f"d ln({_RELATIVE})/d ln({_K}), {_K} from 1 on": _exponent(part(ratios, 1.0), grown.relative_rate)
    }
    yield Finding.within(FLAT, "relative", _DILUTE, "d ln A/d ln t does not depend on k1/k0", numbers)
    for load, some in viscous.items():
        words = f"B is that of the closed form at all R_viscous/R under the load {load:g} a site"
        yield Finding.within(NEAR, f"viscous_{load:g}", _DILUTE, words, closed("R_viscous/R", some))
    numbers = {
        f"{_B} at R_viscous/R {r:g} over that at 0, load a site {load:g}": _over(one, some[0.0])
        for load, some in viscous.items()
        for r, one in part(some, 1.0).items()
    }
    yield Finding.within(
        TWICE, "doubles", "Jagla, Fig. 9", "B doubles from R_viscous = 0 to large R_viscous/R", numbers
    )
    yield Finding.within(
        NEAR, "load", _DILUTE, "B is that of the closed form at all loads", closed("load a site", loads)
    )
    numbers = {
        f"d ln {_B}/d ln <i>F</i>, load a site from {low:g} to {high:g}": _exponent(part(loads, low, high))
        for low, high in ((grown.LIGHTEST, grown.LIGHT), (grown.SIZE_LOAD, 0.3))
    }
    yield Finding.within(FLAT, "load_free", "Jagla, after Eq. (ndet2)", "B does not depend on load", numbers)
    numbers = {
        f"{_BEND}: load a site {load:g}": _estimate(_only, one, of=grown.straightness)
        for load, one in loads.items()
    }
    yield Finding.within(
        NEAR, "logarithm", _PAPER, "On independent heights the area grows like ln t in the window", numbers
    )
    numbers = {
        f"{_BEND}: {grown.by_hurst(hurst)}": _estimate(_only, some[4.0], of=grown.straightness)
        for hurst, some in waves.items()
    }
    yield Finding.within(
        NEAR, "logarithm_waves", _PAPER, "On waves the area grows like ln t in the window", numbers
    )
    words = "The closed form ends at a time in proportion to (contact fraction)^-2, when dips meet"
    numbers = {_ENDED: _exponent_of_end([loads[load] for load in grown.ENDING])}
    yield Finding.within((-2.2, -1.8), "end", "dilute horizon", words, numbers)
    numbers = {
        f"{_B} at heights and load times {grown.RMS:g} over that before": _over(
            sets["rms", grown.GAUSSIAN, grown.RMS], loads[grown.LIGHT]
        )
    }
    yield Finding.within(
        (0.999, 1.001), "rms", "scaling", "Heights and load times a number leave B alone", numbers
    )
    late = float(theory.late_slope(grown.RATIO))
    numbers = {
        f"{_B} over <i>k</i><sub>eff</sub>/(8 pi <i>k</i><sub>0</sub>)": _estimate(
            lambda rates: float(rates[0] / late), law
        ),
        **closed("exponential heights, rms", {1.0: law}),
    }
    yield Finding.within(NEAR, "law", _DILUTE, "On exponential heights B is k_eff/(8 pi k0)", numbers)
    numbers = {
        f"d ln {_B}/d ln (shortest wavelength): {grown.by_hurst(hurst)}": _exponent(some)
        for hurst, some in waves.items()
    }
    yield Finding.within(FLAT, "waves", _HERE, "B does not depend on the shortest wavelength", numbers)
    numbers = {
        f"{_B} at the Hurst exponent 0.8 over that at 0.2, waves from {cutoff:g} sites": _over(
            waves[0.8][cutoff], waves[0.2][cutoff]
        )
        for cutoff in grown.CUTOFFS
    }
    yield Finding.within(NEAR, "hurst", _HERE, "B does not depend on the Hurst exponent", numbers)
    numbers = {
        f"{_B} at {side} sites along a side over that at {grown.SIDE}: {words}": _over(
            some[side], some[grown.SIDE]
        )
        for words, some in (
            (grown.GAUSSIAN, chosen("side")),
            ("waves from 4 sites", chosen("side", grown.by_hurst(0.8))),
        )
        for side in grown.SIZES[:-1]
    }
    yield Finding.within(NEAR, "size", _HERE, "B does not depend on the size of the surface", numbers)


def analyse(evidence: Evidence) -> Outcome:
    """Find B for all parameters, and compare it with the closed forms."""
    sets = grown.sets_of(evidence)
    courses = [
        pd.DataFrame(
            {
                "load": load,
                "time": one.time[1:],
                "area": one.area.mean(axis=0)[1:],
                "over_closed": (one.area.mean(axis=0) / one.closed.mean(axis=0))[1:],
            }
        )
        for (of, _, load), one in sets.items()
        if of == "load"
    ]
    tables = {
        "points": pd.DataFrame([_row(key, found) for key, found in sets.items()]),
        "lines": _lines(),
        "courses": pd.concat(courses, ignore_index=True),
    }
    return Outcome(tuple(_findings(sets)), tables)


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
    parts = [pd.DataFrame(dict(zip(names, one, strict=True))) for one in lines]
    return pd.concat(parts, ignore_index=True)
