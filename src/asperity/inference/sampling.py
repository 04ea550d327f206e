"""The posterior of a model's parameters, by ensembles of walkers that start from the prior.

Each parameter is a function of a coordinate (`Prior.at`), in which walkers move by stretches and by
differences of others (emcee: D. Foreman-Mackey et al., Publ. Astron. Soc. Pac. 125, 306 (2013),
doi:10.1086/670067). An ensemble begins with draws of the prior. The data gain weight in stages, and at each
the walkers are drawn anew by their weights (P. Del Moral et al., J. R. Stat. Soc. B 68, 411 (2006),
doi:10.1111/j.1467-9868.2006.00553.x). So no part of the posterior is missed that many walkers find. Several
ensembles that know nothing of each other must agree, by the rank-normalized R-hat and the effective number of
draws (A. Vehtari et al., Bayesian Anal. 16, 667 (2021), doi:10.1214/20-BA1221).
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, least_squares

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.machine import unhurried
from asperity.base.words import reason_of
from asperity.errors import CheckpointError, ConvergenceError, InputError
from asperity.inference.models import Model
from asperity.results.store import whole_file

ENSEMBLES = 4
_MOST_ROUNDS = 100
_LEAST_ROUNDS = 3
"""Rounds at the whole weight of the data, in which copies of a walker must part."""
_WALKS, _MOVED = 20, 0.9
"""Times that walkers walk in a stage, at most, until that part of them has moved: copies must part."""
_TRIED, _STEP, _TOLD = 64, 1e-6, 1e-7
"""Draws of the prior, step of a coordinate, and least singular value, by which a rank is found."""
_CORRELATIONS = np.linspace(-0.3, 0.98, 65)
"""Correlations of neighbors that are weighed, alike before the data."""
_NOTHING = 1e-150
_FAR = 1e9
"""Misfit, in errors, where there is no curve."""
_LOST = -1e300
"""Logarithm of a likelihood that is 0, as a number that can be multiplied."""


@dataclass(frozen=True, eq=False)
class Problem:
    """Data with errors, and a model of them."""

    time: Floats
    value: Floats
    error: Floats
    model: Model

    def values(self, z: Floats) -> dict[str, Floats]:
        """All parameters at coordinates of shape (m, parameters)."""
        return {
            name: prior.at(column)
            for (name, prior), column in zip(self.model.priors.items(), z.T, strict=True)
        }

    def numbers(self, z: Floats) -> dict[str, float]:
        """All parameters at one place, shape (parameters,)."""
        return {name: float(x) for name, x in self.values(z).items()}

    def misfit(self, z: Floats) -> Floats:
        """Curve less data, in errors, shape (m, n); infinite for what is not allowed."""
        values = self.values(z)
        allowed = np.broadcast_to(self.model.allowed(values), len(z))
        squares = np.full((len(z), self.time.size), np.inf)
        if allowed.any():
            some = {name: column[allowed] for name, column in values.items()}
            with np.errstate(all="ignore"):
                squares[allowed] = (self.model.curve(self.time, some) - self.value) / self.error
        return squares

    def log_likelihood(self, z: Floats) -> Floats:
        """Of normal errors, without its constant; very small for what is not allowed. Shape (m,)."""
        with np.errstate(all="ignore"):
            squares = (self.misfit(z) ** 2).sum(-1)
        return np.where(squares < -_LOST, -squares / 2, _LOST)

    @functools.cached_property
    def used(self) -> list[int]:
        """Places of the parameters on which the curve depends: found by changing each."""
        random = np.random.default_rng(0)
        z = self.of_prior(random, 32)
        changed = []
        for place in range(z.shape[1]):
            other = z.copy()
            other[:, place] = list(self.model.priors.values())[place].drawn(random, len(z))
            with np.errstate(all="ignore"):
                curve_at, curve_beside = (self.model.curve(self.time, self.values(one)) for one in (z, other))
            if not np.array_equal(curve_at, curve_beside, equal_nan=True):
                changed.append(place)
        return changed

    @functools.cached_property
    def rank(self) -> int:
        """How many combinations of the parameters the curve knows, however many points it has."""
        time = np.geomspace(self.time[self.time > 0][0], self.time[-1], 50)
        slopes = self._slopes(self.of_prior(np.random.default_rng(0), _TRIED), time)
        singular = np.linalg.svd(slopes, compute_uv=False)
        return int((singular > _TOLD * singular.max(-1, keepdims=True)).sum(-1).max())

    def _slopes(self, z: Floats, time: Floats) -> Floats:
        """Relative change of the curve with each used coordinate, at z (m, parameters): (m, used, n)."""
        center, step = z[:, np.newaxis], _STEP * np.eye(z.shape[1])[self.used]
        with np.errstate(all="ignore"):
            up, down, central = (
                self.model.curve(time, self.values(at.reshape(-1, z.shape[1]))).reshape(*at.shape[:-1], -1)
                for at in (center + step, center - step, center)
            )
            return np.asarray(np.nan_to_num((up - down) / central, posinf=0.0, neginf=0.0))

    def scatter(self, z: Floats) -> tuple[float, float]:
        """Relative error, and correlation rho of neighbors, about the best fit z; `error` are the values.

        The sum of n errors of an autoregressive series of first order is known as well as that of n (1 -
        rho)/(1 + rho) independent ones, so errors are larger accordingly. The error is a geometric mean over
        rho, by the likelihood of what the parameters cannot take up, which the fit does not bias (H. D.
        Patterson, R. Thompson, Biometrika 58, 545 (1971), DOI 10.1093/biomet/58.3.545).
        """
        columns, sizes, _ = np.linalg.svd(self._slopes(z[np.newaxis], self.time)[0].T, full_matrices=False)
        most = min(self.rank, int(np.sum(sizes > _TOLD * sizes[0])), self.time.size - 1)
        both, free = (
            np.column_stack([columns[:, :most], self.misfit(z[np.newaxis])[0]]),
            self.time.size - most,
        )
        logs, weights = np.empty((2, _CORRELATIONS.size))
        for n, rho in enumerate(_CORRELATIONS):
            apart = np.vstack([both[:1], (both[1:] - rho * both[:-1]) / math.sqrt(1 - rho**2)])
            *others, remaining = np.log(np.maximum(np.abs(np.diag(np.linalg.qr(apart, mode="r"))), _NOTHING))
            logs[n] = remaining + math.log((1 + rho) / (1 - rho) / free) / 2
            weights[n] = (1 - self.time.size) / 2 * math.log(1 - rho**2) - sum(others) - free * remaining
        weights = np.exp(weights - weights.max())
        return math.exp(weights @ logs / weights.sum()), float(weights @ _CORRELATIONS / weights.sum())

    def of_prior(self, random: np.random.Generator, count: int) -> Floats:
        """Draws of the prior that are allowed, as coordinates: shape (count, parameters)."""
        drawn = np.empty((0, len(self.model.priors)))
        for _ in range(1000):
            size = max(64, count)
            more = np.stack([prior.drawn(random, size) for prior in self.model.priors.values()], -1)
            allowed = np.broadcast_to(self.model.allowed(self.values(more)), len(more))
            drawn = np.concatenate([drawn, more[allowed]])
            if len(drawn) >= count:
                return drawn[:count]
        raise InputError("priors", expected="parameters that the model allows", got="none among 64,000 draws")

    def whole(self, z: Floats) -> Floats:
        """Coordinates of all parameters, of those that are used."""
        full = np.zeros((len(z), len(self.model.priors)))
        full[:, self.used] = z
        return full

    def posterior(self, z: Floats, weight: float = 1.0) -> Floats:
        """Logarithm of the posterior of the used coordinates, with the likelihood to a power."""
        whole = self.whole(z)
        densities = zip(self.model.priors.values(), whole.T, strict=True)
        prior = sum(one.log_density(x) for one, x in densities)
        density = np.full(len(z), _LOST)
        inside = prior > -np.inf
        density[inside] = self.log_likelihood(whole[inside])
        return np.where(density > _LOST, weight * density + prior, -np.inf)

    def improved(
        self, z: Floats, places: Sequence[int], *, informed: bool = True, beyond: Sequence[int] = ()
    ) -> tuple[float, Floats]:
        """Least squares over some of the coordinates, from z, shape (parameters,): sum, and coordinates.

        Priors that are knowledge (not `Prior.bounded`) of what the curve contains count as data if
        ``informed``; others only limit the search; those of some places, ``beyond``, are five times as wide.
        """
        priors = list(self.model.priors.values())
        informative = [place for place in self.used if informed and not priors[place].bounded]
        chosen, at = list(places), z.copy()

        def missed(part: Floats) -> Floats:
            at[chosen] = part
            residual = np.concatenate([self.misfit(at[np.newaxis])[0], at[informative]])
            return np.clip(np.where(np.isnan(residual), _FAR, residual), -_FAR, _FAR)

        reach = np.array([prior.reach for prior in priors])
        reach[list(beyond)] += (-2, 2)
        low, high = reach[chosen].T
        point = np.clip(z[chosen], low, high)
        if chosen:
            point = least_squares(missed, point, bounds=(low, high), max_nfev=40).x
        left = missed(point)
        return float(left @ left), at


@dataclass(frozen=True, eq=False)
class Draws:
    """Coordinates z of all parameters, shape (ensembles, draws, parameters), and how well ensembles agree.

    R-hat and the effective number of draws are those of the parameter of which they are worst.
    """

    z: Floats
    r_hat: float
    effective: float

    @property
    def flat(self) -> Floats:
        """Those of all ensembles, shape (draws, parameters)."""
        return self.z.reshape(-1, self.z.shape[-1])


class _Ensemble(NamedTuple):
    """Walkers (walkers, used), the power of the likelihood they have come to, what was kept (n, used)."""

    place: Floats
    weight: float
    kept: Floats


def sample(
    problem: Problem,
    *,
    seed: int,
    walkers: int = 1000,
    effective: int = 1000,
    agreement: float = 1.01,
    steps: int = 40,
    draws: int = 1000,
    workers: int = 1,
    checkpoint: Path | None = None,
    told: Callable[[str], object] = str,
) -> Draws:
    """Sample until ensembles agree, by their R-hat, and are worth so many independent draws.

    Walkers make so many steps in a stage, or more where few of them move. `ConvergenceError` if ensembles do
    not agree in a hundred rounds, after which the same call goes on from a checkpoint; `CheckpointError` for
    one of another problem.
    """
    asked = [problem.model.name, *map(str, problem.model.priors.items()), seed, walkers, steps]
    some = problem.misfit(problem.of_prior(np.random.default_rng(0), 4))  # of this function, and this ramp
    data = np.concatenate([problem.time, problem.value, problem.error, some.ravel()]).tobytes()
    mark = hashlib.sha256(data + json.dumps(asked).encode()).hexdigest()
    several, first = _resumed(checkpoint, mark)
    r_hat, worth, begun = math.inf, 0.0, 0.0
    spawned = functools.partial(ProcessPoolExecutor, min(workers, ENSEMBLES), get_context("spawn"))
    with spawned() if workers > 1 else nullcontext() as pool:
        for turn in range(first, first + _MOST_ROUNDS):
            if turn > first or not several:  # else a checkpoint holds this round, which may be the last
                before: Sequence[_Ensemble | None] = several or [None] * ENSEMBLES
                tasks = [(problem, one, walkers, [seed, n, turn], steps) for n, one in enumerate(before)]
                with unhurried():  # where the processes begin
                    advanced = pool.map(_advanced, tasks) if pool else map(_advanced, tasks)
                several = list(advanced)
                _keep(checkpoint, mark, turn, several)
            if any(one.weight < 1 for one in several):
                weight = min(one.weight for one in several)
                begun = begun or weight
                way = 1 - math.log(weight) / math.log(begun) if begun < 1 else 1.0
                told(f"from the priors toward the data, {100 * way:.0f} % of the way")
                continue
            rounds = min(len(one.kept) for one in several) // walkers
            if rounds < _LEAST_ROUNDS:
                continue
            least = walkers * -(-rounds // 2)  # the later half: what the start has left wears off
            chains = np.stack([one.kept[-least:] for one in several])
            r_hat, worth = _agreement(chains, walkers)
            told(f"sampling: R-hat {r_hat:.3f} (below {agreement}), {worth:.0f} of {effective} samples")
            if r_hat < agreement and worth >= effective:
                return Draws(_thinned(problem, chains, draws, seed), r_hat, worth)
    raise ConvergenceError(
        f"inference: expected ensembles that agree, R-hat below {agreement} and {effective} "
        f"effective samples, got R-hat {r_hat:.3f} and {worth:.0f}; try more walkers, "
        "narrower priors, or fewer parameters"
    )


def _keep(checkpoint: Path | None, mark: str, turn: int, several: Sequence[_Ensemble]) -> None:
    arrays = {f"{name}_{n}": x for n, one in enumerate(several) for name, x in one._asdict().items()}
    if checkpoint is not None:
        with whole_file(checkpoint) as path, path.open("wb") as stream:
            np.savez(stream, mark=mark, done=turn, **arrays)


def _resumed(checkpoint: Path | None, mark: str) -> tuple[list[_Ensemble], int]:
    """The ensembles of a checkpoint, if there is one, and the round they have come to."""
    if checkpoint is None or not checkpoint.exists():
        return [], 0
    try:
        with checkpoint.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            same, turn = str(arrays["mark"]) == mark, int(arrays["done"])
            several = [
                _Ensemble(*(arrays[f"{name}_{n}"] for name in _Ensemble._fields)) for n in range(ENSEMBLES)
            ]
    except Exception as error:  # of an archive, of headers: a damaged byte leads anywhere
        expected = "a checkpoint of an inference"
        got = f"{checkpoint}: {reason_of(error)}"
        raise CheckpointError("checkpoint", expected=expected, got=got, advice="removing it") from None
    if not same:
        expected = "a checkpoint of the same data, model, priors and seed"
        raise CheckpointError("checkpoint", expected=expected, got=f"{checkpoint}", advice="another file")
    return several, turn


def _advanced(task: tuple[Problem, _Ensemble | None, int, list[int], int]) -> _Ensemble:
    """Give the likelihood more weight, as far as half of the walkers bear it, and let them walk."""
    problem, ensemble, walkers, seeds, steps = task
    random = np.random.default_rng(seeds)
    if ensemble is None:
        place = problem.of_prior(random, 10 * walkers)[:, problem.used]
        ensemble = _Ensemble(place, 0.0, np.empty((0, place.shape[1])))
    place, weight = ensemble.place, ensemble.weight
    if weight < 1:
        likelihood = problem.log_likelihood(problem.whole(place))
        if not (likelihood > _LOST).any():
            raise InputError("priors", expected="some values that the data allow", got="none among thousands")
        added = _weight_added(likelihood, 1 - weight, enough=walkers / 2)
        share = np.exp(added * (likelihood - likelihood.max()))
        place = place[random.choice(len(place), walkers, p=share / share.sum())]
        weight = 1.0 if added == 1 - weight else weight + added
    begun, (emcee, _) = place, libraries()
    moves = [(emcee.moves.DEMove(), 0.5), (emcee.moves.StretchMove(), 0.5)]
    how = {"kwargs": {"weight": weight}, "vectorize": True, "moves": moves}
    for _ in range(_WALKS):
        sampler = emcee.EnsembleSampler(*place.shape, problem.posterior, **how)
        sampler.random_state = np.random.RandomState(random.integers(2**31)).get_state()
        place = sampler.run_mcmc(place, steps, store=False, skip_initial_state_check=True).coords
        if (place != begun).any(1).mean() > _MOVED:
            break
    kept = [ensemble.kept, place] if weight == 1 else [ensemble.kept]
    return _Ensemble(place, weight, np.concatenate(kept))


def _weight_added(found: Floats, most: float, *, enough: float) -> float:
    """Largest increase of the power of the likelihood after which the weights are worth `enough` draws."""
    lost = found.max() - found

    def excess(logarithm: float) -> float:
        share = np.exp(-math.exp(logarithm) * lost)
        return float(share.sum() ** 2 / (share**2).sum() - enough)

    high = math.log(most)
    return most if excess(high) >= 0 else math.exp(brentq(excess, high - 600, high))


def _agreement(chains: Floats, walkers: int) -> tuple[float, float]:
    """Largest R-hat, and smallest effective number of draws, of chains (ensembles, draws, used).

    Draws are in the order of rounds, by which R-hat sees a drift. For their number those of each walker
    stand in a row, by which it sees how slowly walkers move.
    """
    _, az = libraries()
    in_rows = chains.reshape(len(chains), -1, walkers, chains.shape[-1]).swapaxes(1, 2).reshape(chains.shape)
    r_hat = max(float(az.rhat(one)) for one in np.moveaxis(chains, -1, 0))
    counted = ({"method": "bulk"}, {"method": "tail", "prob": (0.05, 0.95)})
    return r_hat, min(float(az.ess(one, **how)) for one in np.moveaxis(in_rows, -1, 0) for how in counted)


def _thinned(problem: Problem, chains: Floats, draws: int, seed: int) -> Floats:
    """Draws of all parameters of each ensemble, those that the curve does not know from their prior."""
    random = np.random.default_rng([seed, ENSEMBLES])
    chosen = random.permuted(np.tile(np.arange(chains.shape[1]), (len(chains), 1)), axis=1)[:, :draws]
    whole = problem.of_prior(random, chosen.size).reshape(*chosen.shape, -1)
    whole[..., problem.used] = np.take_along_axis(chains, chosen[..., None], axis=1)
    return whole


def libraries() -> tuple[Any, Any]:
    """Emcee and ArviZ, without remarks about a later version of itself; `MissingExtraError` without them."""
    with checks.extra("inference", "inference"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import arviz
        import emcee

    return emcee, arviz
