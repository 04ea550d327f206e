r"""Few contacts, far apart, under a load that changes: contacts form, and open again.

While the penetration never recedes no contact opens, every contact obeys the same linear law, and the load
alone counts (E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), doi:10.1115/1.3644020):

    N0 E[(xi - d)+] = int J(t - y) dF(y),      A = N0 Prob(xi > d),      J = G/k0

When contacts open it fails (T. C. T. Ting, J. Appl. Mech. 33, 845 (1966), doi:10.1115/1.3625192): an asperity
that has left its dip carries no force until it meets the bottom again. Every height has a history. So a
population of heights is followed, in classes, each with the lags of all its modes (`memory.SiteMemory`). At
the end of a step, with forces linear in time within it, the depth of a site is k0 u = S f + h, with one S for
all and h what the site inherits. Contact means f >= 0, u >= xi - d and one of them an equality, so

    f = (s - k0 d)+ / S,  s = k0 xi - h,      E[f] = load per site

which sorting s solves for d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.theory.heights import HeightLaw
from asperity.theory.memory import SiteMemory, response, site_memory

# The accuracy that these give was measured: see `dilute_history`.
_ERROR = 1e-6  # of the sum over modes
_PER_E_FOLD = 64  # classes of heights for each factor e in the mean excess above them
_GROWTH = 1 / 12  # of a step, over the time since the load last changed its course
_PER_RAMP = 16  # steps at least, while the load changes
_BELOW = 1.5  # mean excess above the lowest class, over the greatest that may be needed
_ABOVE = 1e-2  # mean excess above the highest class, over the least that may be needed


def dilute_history(
    x2: ArrayLike,
    load_per_site: ArrayLike,
    *,
    k0: float,
    x1: float,
    heights: HeightLaw,
    viscous: float = 0.0,
    dimension: int = 2,
) -> Floats:
    """Return the fraction of sites in contact, A/N0, in the dilute theory, under a load that changes.

    Parameters
    ----------
    x2
        As in `response`; a time that is given twice is a jump of the load.
    load_per_site
        F/N0 (force) at these times, not below 0, linear in between: shape (n,).
    k0
        Stiffness between neighbors (force per length), above 0.
    heights
        Law of the heights (length).

    Returns
    -------
    ndarray
        A/N0 at these times, shape (n,). Exact, to the accuracy of `response`, until the load first falls;
        `dilute_area` if it is constant. Afterwards within 1e-3 of A, mostly within 1e-4 (see Notes); for
        `EmpiricalHeights` also within the few heights that share a class. Trust it while the contacts are
        apart: see `dilute_horizon`.

    Notes
    -----
    The accuracy after a fall was measured: halved classes and steps changed no area by more than 4e-4 in the
    plane and 1e-3 on the line, over 60 cases (steps, ramps and cycles of the load, with and without R_tilde,
    k1/k0 from 0.05 to 100). It takes tenths of a second, and seconds for a hundred changes of slope.
    """
    times, loads = checks.history(x2=x2, load_per_site=checks.not_negative("load_per_site", load_per_site))
    lateral, x1 = checks.number("k0", k0, above=0), checks.number("x1", x1, above=0)
    viscous, dimension = checks.number("viscous", viscous, least=0), checks.line_or_plane(dimension)
    compression = response(times, loads, x1, viscous, dimension) / lateral
    touching = compression > 0
    area = np.zeros(times.size)
    area[touching] = heights.exceedance(heights.separation_for(compression[touching]))
    falls = np.diff(loads) < -1e-12 * loads.max()
    if falls.any():
        after = int(np.argmax(falls)) + 1
        area[after:] = _march(times, loads, lateral, x1, heights, viscous, dimension)[after:]
    return area


def _march(
    times: Floats, loads: Floats, k0: float, x1: float, heights: HeightLaw, viscous: float, dimension: int
) -> Floats:
    """A/N0 at the times, from a population that is followed through them."""
    duration = float(times[-1] - times[0])
    memory = site_memory(x1, duration, viscous, dimension, _ERROR)
    # No contact is ever deeper than under the greatest load from the start on.
    softest = memory.at_once - float(memory.slow @ np.expm1(-memory.rate * duration))
    deepest = _BELOW * float(loads.max()) * softest / k0
    lightest = _ABOVE * float(loads[loads > 0].min()) * memory.at_once / k0
    population = _Population(_classes(heights, deepest, lightest), k0, memory)
    area = np.zeros(times.size)
    for i, (steps, ends) in enumerate(_schedule(times, loads, 1 / float(memory.rate.max()))):
        for step, end in zip(steps, ends, strict=True):
            population.advance(float(step), float(end))
        area[i] = heights.exceedance(population.edge)
    return area


def _schedule(times: Floats, loads: Floats, fastest: float) -> Iterator[tuple[Floats, Floats]]:
    """Up to each time: durations of the steps and loads at their ends.

    Forces follow a change of the load's course fast at first, so steps are in proportion to the time since
    then.
    """
    since, course = 0.0, math.nan
    yield np.zeros(1), loads[:1]
    for duration, start, end in zip(np.diff(times), loads[:-1], loads[1:], strict=True):
        if duration == 0:
            since, course = 0.0, math.nan
            yield np.zeros(1), np.array([end])
            continue
        slope = (end - start) / duration
        if not math.isclose(slope, course, rel_tol=1e-9):
            since, course = 0.0, slope
        old = fastest + since
        whole = math.log1p(duration / old)
        ends = old * np.expm1(np.linspace(0, whole, math.ceil(whole / _GROWTH) + 1))
        ends[-1] = duration
        if slope != 0:
            ends = np.union1d(ends, np.linspace(0, duration, _PER_RAMP + 1))
        since += duration
        yield np.diff(ends), np.append(start + slope * ends[1:-1], end)


def _classes(heights: HeightLaw, deepest: float, lightest: float) -> tuple[Floats, Floats, float]:
    """Cut the heights into classes between two mean excesses.

    Return their mean heights and probabilities, and where the lowest of them begins.
    """
    count = math.ceil(_PER_E_FOLD * math.log(deepest / lightest)) + 1
    lower = heights.separation_for(np.geomspace(deepest, lightest, count))
    excess, beyond = heights.mean_excess(lower), heights.exceedance(lower)
    probability = -np.diff(beyond, append=0.0)
    # int Prob(xi > x) dx over the class, less the part of the heights above it
    inside = -np.diff(excess, append=0.0) - np.append(np.diff(lower) * beyond[1:], 0.0)
    held = probability > 0
    return lower[held] + inside[held] / probability[held], probability[held], float(lower[0])


class _Population:
    """Classes of heights, ascending, each with its force, its delayed depth and the lags of its modes."""

    def __init__(self, classes: tuple[Floats, Floats, float], k0: float, memory: SiteMemory) -> None:
        self.height, self.probability, self.bottom = classes
        self.k0, self.memory = k0, memory
        self.force, self.delayed = np.zeros(self.height.size), np.zeros(self.height.size)
        self.lag = np.zeros((self.height.size, memory.rate.size))
        #: Heights above it are in contact.
        self.edge = math.inf

    def advance(self, duration: float, load: float) -> None:
        """Go through a step that ends at this load per site."""
        step = self.memory.step(duration)
        stiffness = self.memory.at_once + step.follow
        inherited = self.delayed + self.lag @ step.recover - step.follow * self.force
        reach = self.k0 * self.height - inherited
        pressed = reach - self._level(reach, stiffness * load)
        change = np.maximum(pressed, 0) / stiffness - self.force
        self.force += change
        self.delayed = inherited + step.follow * self.force
        self.lag *= step.keep
        self.lag += np.multiply.outer(change, step.gain)
        self.edge = self._find_edge(pressed)

    def _level(self, reach: Floats, needed: float) -> float:
        """Solve E[(s - level)+] = needed, exactly."""
        order = np.argsort(-reach)
        s, p = reach[order] - reach[order[0]], self.probability[order]
        # With the first n in contact; the level must lie below the last of them.
        levels = (np.cumsum(p * s) - needed) / np.cumsum(p)
        return float(reach[order[0]] + levels[max(int(np.sum(levels < s)), 1) - 1])

    def _find_edge(self, pressed: Floats) -> float:
        """Between the highest class that is open and the lowest that touches.

        An advancing edge is where the gap of the open heights closes, a receding one is where the force of
        the touching heights ends. Among heights that were just reached or left, the line through two classes
        ends too low, because touching forces are concave there, and gaps convex.
        """
        first = int(np.searchsorted(pressed > 0, True))
        if first == pressed.size:
            return math.inf
        x, y = self.height, pressed
        low, high = x[first - 1] if first else self.bottom, np.nextafter(x[first], -math.inf)
        # Where the line through two classes is zero.
        pairs = [(n, n + 1) for n in (first - 2, first) if 0 <= n < x.size - 1]
        ends = [x[n] - y[n] * (x[m] - x[n]) / (y[m] - y[n]) for n, m in pairs]
        return float(np.clip(max(ends, default=low), low, high))
