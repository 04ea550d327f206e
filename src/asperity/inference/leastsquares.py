"""Least squares from many starts at once: best fits, profile likelihoods, and draws from the curvature.

Searches are by Levenberg's and Marquardt's method in the coordinates of the priors, within their bounds. What
a model does not allow is a large misfit. The profile of a parameter is the least sum of squares over all
others: -2 ln of the profile likelihood, up to a constant. It is followed from the best fit toward either end
of the prior, until it passes the level of a 95 % interval. Draws are of a mixture of normal distributions
along the profiles, resampled by importance (D. B. Rubin, J. Am. Stat. Assoc. 82, 543 (1987),
doi:10.2307/2289460).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp
from scipy.stats import chi2

from asperity.base.checks import Floats
from asperity.fits.result import SURE
from asperity.inference.problem import Problem

LIMIT, ONE_SIDED = float(chi2.ppf(SURE, 1)), float(chi2.ppf(2 * SURE - 1, 1))
"""Squares above the least at an end of a 95 % interval with two ends, or with one."""
_STEP, _FAR = 1e-6, 1e9
"""Step of a coordinate for slopes; misfit without a curve."""
_ROUNDS, _PATIENCE, _EASED = 60, 1e8, 10.0
"""Most steps of a search; damping at which it ends; factor of the damping between steps."""
_SETTLED = 1e-7
"""Relative fall of the squares below which a search has ended."""
_FORBIDDEN = 1e3
"""Misfit of an excess of 1 over what the model allows."""
_TRIED, _STARTS = 2000, 6
"""Draws of the prior, of which so many begin searches."""
_MARCHES, _GROWTH, _CLOSE = 12, 3.0, 0.02
"""Most steps of a profile toward its level, largest growth of a step, and how close it comes."""
_INNER, _OUTER = 4, 3
"""Further points of a profile on either side, within and beyond its level."""
_BETTER = 1e-2
"""Fall of the squares by which a profile has found a better fit."""
_RANGE = 12.0
"""One over the variance of the coordinate in a range."""
_NEAR, _PROPOSED = 1e-4, 8
"""Least relative share of a point of a profile, and proposals for each draw."""
_REFINED, _CENTERS = 6, 256
"""Most rounds of proposals, and draws about which those after the first are."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Profile of one parameter: points z, shape (k, parameters), in order, and squares above the least."""

    place: int
    z: Floats
    deviance: Floats

    @property
    def at(self) -> Floats:
        """Coordinates of the parameter, shape (k,)."""
        return np.asarray(self.z[:, self.place])

    def excluded(self, informative: bool) -> tuple[bool, bool]:
        """Whether the data exclude the low and the high end of the prior, which itself does not count."""
        told = self.deviance - informative * self.at**2
        told = told - told.min()
        return bool(told[0] > LIMIT), bool(told[-1] > LIMIT)

    def ends(self, limit: float = LIMIT) -> Floats:
        """Low and high coordinate beyond which all is above the limit; infinite without one."""
        ends = np.array([-np.inf, np.inf])
        inside = np.flatnonzero(self.deviance <= limit)[[0, -1]]
        for number, (one, beyond) in enumerate(zip(inside, inside + np.array([-1, 1]), strict=True)):
            if 0 <= beyond < self.at.size:
                roots = np.sqrt(self.deviance[[one, beyond]])  # nearly straight
                ends[number] = np.interp(np.sqrt(limit), roots, self.at[[one, beyond]])
        return ends


def least(
    problem: Problem,
    z: Floats,
    *,
    held: NDArray[np.bool_] | None = None,
    beyond: NDArray[np.bool_] | None = None,
) -> tuple[Floats, Floats]:
    """Least squares from starts z, shape (m, parameters): squares (m,), and coordinates.

    Parameters that are ``held``, (m, parameters), stay; ranges of those ``beyond`` are five times as wide.
    Priors of `Problem.informative` parameters count as data.
    """
    used = np.isin(np.arange(z.shape[1]), problem.used)
    free: NDArray[np.bool_] = np.broadcast_to(used, z.shape) & ~(np.zeros(1, bool) if held is None else held)
    wider = np.array([-2.0, 2.0]) * (np.zeros(1) if beyond is None else beyond)[..., None]
    low, high = np.moveaxis(np.broadcast_to(problem.reach + wider, (*z.shape, 2)), -1, 0)
    z = np.where(free, np.clip(z, low, high), z)
    residual = _residual(problem, z)
    squares = (residual**2).sum(-1)
    damping, active = np.full(len(z), 1e-2), np.arange(len(z))
    for _ in range(_ROUNDS):
        if not active.size:
            break
        at, places = z[active], np.flatnonzero(free[active].any(0))
        slopes = _slopes(problem, at, residual[active], places, high[active])
        gradient = (slopes @ residual[active][..., None])[..., 0]
        outward = np.where(gradient > 0, at <= low[active], at >= high[active])
        stuck = outward | ~free[active]
        step = _step(slopes, gradient, stuck, damping[active])
        tried = np.where(stuck, at, np.clip(at + step, low[active], high[active]))
        left = _residual(problem, tried)
        sums = (left**2).sum(-1)
        fell = squares[active] - sums
        better = fell > 0
        done = (better & (fell <= _SETTLED * squares[active])) | (damping[active] > _PATIENCE)
        taken = active[better]
        z[taken], residual[taken], squares[taken] = tried[better], left[better], sums[better]
        damping[active] *= np.where(better, 1 / _EASED, _EASED)
        active = active[~done & (np.abs(step).max(-1) > 1e-13)]
    return squares, z


def _residual(problem: Problem, z: Floats) -> Floats:
    """Misfits, priors that count as data, and what is not allowed: shape (m, rows)."""
    forbidden = _FORBIDDEN * problem.excess(z)
    rows = np.concatenate([problem.misfit(z), z[:, problem.informative], forbidden], axis=-1)
    return np.clip(np.where(np.isnan(rows), _FAR, rows), -_FAR, _FAR)


def _slopes(problem: Problem, z: Floats, residual: Floats, places: NDArray[np.intp], high: Floats) -> Floats:
    """Change of the residual with each coordinate, shape (m, parameters, rows); 0 for those that stay."""
    slopes = np.zeros((*z.shape, residual.shape[-1]))
    steps = np.where(z + _STEP > high, -_STEP, _STEP)[:, places]
    moved = np.repeat(z[:, None], places.size, axis=1)
    moved[:, np.arange(places.size), places] += steps
    rows = _residual(problem, moved.reshape(-1, z.shape[1])).reshape(len(z), places.size, -1)
    slopes[:, places] = (rows - residual[:, None]) / steps[..., None]
    return slopes


def _step(slopes: Floats, gradient: Floats, stuck: NDArray[np.bool_], damping: Floats) -> Floats:
    """Damped step, 0 for parameters that are stuck."""
    slopes = np.where(stuck[..., None], 0.0, slopes)
    square = slopes @ slopes.swapaxes(-1, -2)
    scale = np.einsum("mii->mi", square)
    scale = np.maximum(scale, 1e-10 * scale.max(-1, keepdims=True)) + 1e-300
    root, identity = np.sqrt(scale), np.eye(square.shape[-1])
    scaled = square / (root[:, :, None] * root[:, None, :]) + damping[:, None, None] * identity
    rows = np.where(stuck, 0.0, gradient) / root
    return np.asarray(-np.linalg.solve(scaled + 1e-14 * identity, rows[..., None])[..., 0] / root)


def best_fit(problem: Problem, starts: Floats | None = None) -> tuple[float, Floats]:
    """Least squares, and coordinates, of searches from given starts, or from the best draws of the prior."""
    if starts is None:
        z = problem.of_prior(np.random.default_rng(0), _TRIED)
        starts = z[np.argsort(problem.log_likelihood(z))[: -_STARTS - 1 : -1]]
    used = np.isin(np.arange(starts.shape[1]), problem.used)
    squares, z = least(problem, np.where(used, starts, problem.reach.mean(1)))
    first = int(np.argmin(squares))
    return float(squares[first]), z[first]


def spreads(problem: Problem, z: Floats) -> Floats:
    """Roots of the covariance of used coordinates by the curvature at each z: shape (m, used, used).

    Ranges count by their width; borders of what is allowed do not.
    """
    used, priors = np.array(problem.used), list(problem.model.priors.values())
    high = np.broadcast_to(problem.reach[:, 1], z.shape)
    rows = problem.time.size + len(problem.informative)
    slopes = _slopes(problem, z, _residual(problem, z), used, high)[:, used, :rows]
    ranges = np.diag([_RANGE * priors[place].bounded for place in used])
    curvatures, along = np.linalg.eigh(slopes @ slopes.swapaxes(-1, -2) + ranges)
    least_one = np.finfo(np.float64).eps * curvatures.max(-1, keepdims=True)
    return np.asarray(along / np.sqrt(np.maximum(curvatures, least_one))[:, None, :])


def profiles(problem: Problem, best: Floats) -> tuple[Floats, dict[int, Profile]]:
    """Best fit, the better one if profiles pass it, and the profile of each used parameter by its place."""
    while True:
        march = _March(problem, best)
        march.follow()
        if march.passed is None:
            return best, march.profiles()
        best = best_fit(problem, march.passed[None])[1]


class _March:
    """The way of all profiles of a problem at once: each goes from the best fit in two directions."""

    def __init__(self, problem: Problem, best: Floats) -> None:
        squares, z = least(problem, best[None])
        self.problem, self.best, self.least = problem, z[0], float(squares[0])
        self.spread = np.zeros(2 * (best.size,))
        root = spreads(problem, self.best[None])[0]
        self.spread[np.ix_(problem.used, problem.used)] = root @ root.T
        self.points: dict[tuple[int, int], list[tuple[float, Floats]]] = {
            (place, side): [(0.0, self.best)] for place in problem.used for side in (-1, 1)
        }
        self.passed: Floats | None = None

    def follow(self) -> None:
        """Follow each to its level, or to the end of its prior; then fill in points for a drawing."""
        for _ in range(_MARCHES):
            aims = {task: at for task in self.points if (at := self._next(task)) is not None}
            if not aims or self.passed is not None:
                break
            self._solve(list(aims.items()))
        if self.passed is None:
            self._solve([(task, at) for task in self.points for at in self._between(task)])

    def profiles(self) -> dict[int, Profile]:
        found = {}
        for place in self.problem.used:
            points = [*self.points[place, -1], *self.points[place, 1][1:]]
            z = np.array([point for _, point in points])
            order = np.argsort(z[:, place], kind="stable")
            deviance = np.array([deviance for deviance, _ in points])[order]
            found[place] = Profile(place, z[order], np.maximum(deviance, 0.0))
        return found

    def _end(self, task: tuple[int, int]) -> float:
        place, side = task
        return float(self.problem.reach[place, int(side > 0)])

    def _next(self, task: tuple[int, int]) -> float | None:
        """Next coordinate of a profile, by a root of the squares that is nearly straight; None at the aim."""
        (place, side), end = task, self._end(task)
        points = sorted((side * z[place], deviance) for deviance, z in self.points[task])
        inside = [point for point in points if point[1] <= LIMIT]
        outside = [point for point in points if point[1] > LIMIT]
        (at, deviance), start = inside[-1], points[0][0]
        if at >= side * end or abs(points[-1][1] - LIMIT) < _CLOSE or abs(deviance - LIMIT) < _CLOSE:
            return None
        level, root = np.sqrt(LIMIT), np.sqrt(max(deviance, 0.0))
        if outside:
            there, above = outside[0]
            share = (level - root) / (np.sqrt(above) - root)
            if above < np.inf and there - at < 1e-9 * max(1.0, abs(at)):
                return None
            return float(side * (at + np.clip(share, 0.05, 0.95) * (there - at)))
        if at == start:
            step = level * np.sqrt(self.spread[place, place])
        else:
            gone = at - start
            step = np.clip(gone * (level / max(root, 1e-9) - 1), 0.02 * gone, _GROWTH * gone)
        return float(side * min(at + step, side * end))

    def _between(self, task: tuple[int, int]) -> list[float]:
        """Points within the level, and beyond it to the end of the prior."""
        (place, side), end = task, self._end(task)
        furthest = max((z[place] for _, z in self.points[task]), key=lambda at: side * at)
        inner = np.linspace(self.best[place], furthest, _INNER + 2)[1:-1]
        outer = np.linspace(furthest, end, _OUTER + 1)[1:]
        return [*inner, *(outer if furthest != end else ())]

    def _solve(self, asked: Sequence[tuple[tuple[int, int], float]]) -> None:
        """Least squares over all others, from the nearest point and along the way to it."""
        starts, held = [], []
        for task, at in asked:
            place = task[0]
            near = sorted((z for _, z in self.points[task]), key=lambda z: abs(z[place] - at))
            along = self.spread[:, place] / self.spread[place, place]
            if len(near) > 1 and near[0][place] != near[1][place]:
                along = (near[0] - near[1]) / (near[0][place] - near[1][place])
            for tangent in (along, np.zeros_like(along)):
                start = near[0] + tangent * (at - near[0][place])
                start[place] = at
                starts.append(start)
                held.append(np.arange(start.size) == place)
        if not asked:
            return
        squares, z = least(self.problem, np.array(starts), held=np.array(held))
        deviance = squares - self.least
        for n, (task, _) in enumerate(asked):
            first = 2 * n + int(np.argmin(deviance[2 * n : 2 * n + 2]))
            self.points[task].append((float(deviance[first]), z[first]))
        if deviance.min() < -_BETTER:
            self.passed = z[int(np.argmin(deviance))]


def drawn(problem: Problem, followed: Mapping[int, Profile], count: int, seed: int) -> tuple[Floats, float]:
    """Draws of the posterior, shape (count, parameters), and the number that they are worth.

    Proposals are normal about the points of all profiles, with the curvature there; the posterior over their
    density chooses among them. If they are worth too few, proposals are about the chosen ones next.
    """
    random = np.random.default_rng(seed)
    shares = [np.exp(-one.deviance / 2) * np.gradient(one.at) for one in followed.values()]
    share = np.concatenate([each / each.sum() for each in shares])
    near = share > _NEAR * share.max()
    share, centers = share[near], np.concatenate([one.z for one in followed.values()])[near]
    for _ in range(_REFINED):
        z, weights = _weighed(problem, centers, share / share.sum(), _PROPOSED * count, random)
        places = np.searchsorted(np.cumsum(weights), (np.arange(count) + random.random()) / count)
        chosen, worth = z[np.minimum(places, len(z) - 1)], float(1 / (weights @ weights))
        if worth > count / 2:
            break
        centers, share = chosen[:: count // _CENTERS], np.ones(_CENTERS)
    return chosen, worth


def _weighed(
    problem: Problem, centers: Floats, share: Floats, count: int, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Proposals about centers of these shares, and their weights; unused parameters are of their priors."""
    used, spread = problem.used, spreads(problem, centers)
    chosen = random.choice(share.size, count, p=share)
    z = problem.of_prior(random, count)
    steps = (spread[chosen] @ random.standard_normal((count, len(used), 1)))[..., 0]
    z[:, used] = centers[chosen][:, used] + steps
    low, high = problem.reach.T
    bounded = np.array([prior.bounded for prior in problem.model.priors.values()])
    inside = (((z >= low) & (z <= high)) | ~bounded).all(-1)
    weights = np.full(count, -np.inf)
    apart = z[inside][:, None, used] - centers[:, used]
    scaled = np.linalg.solve(spread, apart[..., None])[..., 0]
    volume = np.linalg.slogdet(spread).logabsdet
    density = logsumexp(-(scaled**2).sum(-1) / 2 - volume, b=share, axis=-1)
    prior = -(z[inside][:, problem.informative] ** 2).sum(-1) / 2
    weights[inside] = problem.log_likelihood(z[inside]) + prior - density
    weights = np.exp(weights - weights.max())
    return z, weights / weights.sum()
