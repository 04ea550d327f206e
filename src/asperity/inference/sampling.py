"""The posterior of a model's parameters, by ensembles of walkers that start from the prior.

Each parameter is a function of a coordinate (`Prior.at`), in which walkers move by stretches and by
differences of others (emcee: D. Foreman-Mackey et al., Publ. Astron. Soc. Pac. 125, 306 (2013),
doi:10.1086/670067). An ensemble begins with draws of the prior. The power of the likelihood rises in stages,
and each resamples the walkers by their weights (P. Del Moral et al., J. R. Stat. Soc. B 68, 411 (2006),
doi:10.1111/j.1467-9868.2006.00553.x), against missing a part of the posterior. Independent ensembles must
agree, by the rank-normalized R-hat and the effective number of draws (A. Vehtari et al., Bayesian Anal. 16,
667 (2021), doi:10.1214/20-BA1221).
"""

from __future__ import annotations

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
from scipy.optimize import brentq

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.machine import end_with_parent, unhurried
from asperity.errors import ConvergenceError, InputError
from asperity.inference.problem import LOST, Problem
from asperity.progress import Checkpoint
from asperity.results.checkpoint import Keeper

ENSEMBLES = 4
_MOST_ROUNDS = 100
_LEAST_ROUNDS = 3
"""Rounds with the whole likelihood, in which copies of a walker must separate."""
_WALKS, _MOVED = 20, 0.9
"""Most walks of a stage, and share of walkers that must have moved, so that copies separate."""


@dataclass(frozen=True, eq=False)
class Draws:
    """Coordinates z of all parameters, shape (ensembles, draws, parameters), and the agreement of ensembles.

    R-hat is the largest of all parameters, the effective number of draws the least.
    """

    z: Floats
    r_hat: float
    effective: float

    @property
    def flat(self) -> Floats:
        """Coordinates of all ensembles, shape (draws, parameters)."""
        return self.z.reshape(-1, self.z.shape[-1])


class _Ensemble(NamedTuple):
    """Places of walkers (walkers, used), their power of the likelihood, and kept places (n, used)."""

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
    checkpoint: str | Path | Checkpoint | None = None,
    report: Callable[[str], object] = str,
) -> Draws:
    """Sample until ensembles agree, by R-hat, and have so many `effective` draws.

    Walkers make so many steps in a stage, or more if few of them move. `ConvergenceError` if ensembles do not
    agree in a hundred rounds; the same call then goes on from a checkpoint. `CheckpointError` for a
    checkpoint of another problem.
    """
    asked = [problem.model.name, *map(str, problem.model.priors.items()), seed, walkers, steps]
    some = problem.misfit(problem.of_prior(np.random.default_rng(0), 4))  # depends on function and ramp
    data = np.concatenate([problem.time, problem.value, problem.error, some.ravel()]).tobytes()
    keeper = Keeper(checkpoint, data + json.dumps(asked).encode())
    first, kept = keeper.read() or (0, {})
    ensembles = [
        _Ensemble(*(kept[f"{name}_{n}"] for name in _Ensemble._fields))
        for n in range(ENSEMBLES if kept else 0)
    ]
    r_hat, worth, begun = math.inf, 0.0, 0.0
    pooled = min(workers, ENSEMBLES), get_context("spawn"), end_with_parent
    with ProcessPoolExecutor(*pooled) if workers > 1 else nullcontext() as pool:
        for turn in range(first, first + _MOST_ROUNDS):
            if turn > first or not ensembles:  # else a checkpoint has this round, which may be the last
                before: Sequence[_Ensemble | None] = ensembles or [None] * ENSEMBLES
                tasks = [(problem, each, walkers, [seed, n, turn], steps) for n, each in enumerate(before)]
                with unhurried():  # processes begin here
                    advanced = pool.map(_advanced, tasks) if pool else map(_advanced, tasks)
                ensembles = list(advanced)
                fields = [each._asdict().items() for each in ensembles]
                keeper.write(turn, {f"{name}_{n}": x for n, each in enumerate(fields) for name, x in each})
            if (weight := min(ensemble.weight for ensemble in ensembles)) < 1:
                begun = begun or weight
                way = 1 - math.log(weight) / math.log(begun) if begun < 1 else 1.0
                report(f"from the priors toward the data, {100 * way:.0f} % of the way")
                continue
            rounds = min(len(ensemble.kept) for ensemble in ensembles) // walkers
            if rounds < _LEAST_ROUNDS:
                continue
            least = walkers * -(-rounds // 2)  # the later half, without effects of the start
            chains = np.stack([ensemble.kept[-least:] for ensemble in ensembles])
            r_hat, worth = _agreement(chains, walkers)
            enough = f"{worth:.0f} samples, to reach {effective}"
            report(f"chains: R-hat {r_hat:.3f}, to fall below {agreement}; {enough}")
            if r_hat < agreement and worth >= effective:
                return Draws(_thinned(problem, chains, draws, seed), r_hat, worth)
    raise ConvergenceError(
        f"inference: expected ensembles that agree, R-hat below {agreement} and {effective} "
        f"effective samples, got R-hat {r_hat:.3f} and {worth:.0f}; try more walkers, "
        "narrower priors, or fewer parameters"
    )


def posterior(z: Floats, problem: Problem, weight: float = 1.0) -> Floats:
    """Logarithm of the posterior of the used coordinates, with the likelihood to a power."""
    whole = _whole(problem, z)
    densities = zip(problem.model.priors.values(), whole.T, strict=True)
    prior = sum(marginal.log_density(x) for marginal, x in densities)
    density = np.full(len(z), LOST)
    inside = prior > -np.inf
    density[inside] = problem.log_likelihood(whole[inside])
    return np.where(density > LOST, weight * density + prior, -np.inf)


def _whole(problem: Problem, z: Floats) -> Floats:
    """Coordinates of all parameters, from those of the used ones."""
    full = np.zeros((len(z), len(problem.model.priors)))
    full[:, problem.used] = z
    return full


def _advanced(task: tuple[Problem, _Ensemble | None, int, list[int], int]) -> _Ensemble:
    """Raise the power of the likelihood, while the weights are worth half of the walkers; let them walk."""
    problem, ensemble, walkers, seeds, steps = task
    random = np.random.default_rng(seeds)
    if ensemble is None:
        place = problem.of_prior(random, 10 * walkers)[:, problem.used]
        ensemble = _Ensemble(place, 0.0, np.empty((0, place.shape[1])))
    place, weight = ensemble.place, ensemble.weight
    if weight < 1:
        likelihood = problem.log_likelihood(_whole(problem, place))
        if not (likelihood > LOST).any():
            raise InputError("priors", expected="some values that the data allow", got="none among thousands")
        added = _weight_added(likelihood, 1 - weight, enough=walkers / 2)
        share = np.exp(added * (likelihood - likelihood.max()))
        place = place[random.choice(len(place), walkers, p=share / share.sum())]
        weight = 1.0 if added == 1 - weight else weight + added
    begun, (emcee, _) = place, libraries()
    moves = [(emcee.moves.DEMove(), 0.5), (emcee.moves.StretchMove(), 0.5)]
    how = {"kwargs": {"weight": weight}, "vectorize": True, "moves": moves}
    for _ in range(_WALKS):
        sampler = emcee.EnsembleSampler(*place.shape, posterior, args=(problem,), **how)
        sampler.random_state = np.random.RandomState(random.integers(2**31)).get_state()
        place = sampler.run_mcmc(place, steps, store=False, skip_initial_state_check=True).coords
        if (place != begun).any(1).mean() > _MOVED:
            break
    kept = [ensemble.kept, place] if weight == 1 else [ensemble.kept]
    return _Ensemble(place, weight, np.concatenate(kept))


def _weight_added(likelihood: Floats, most: float, *, enough: float) -> float:
    """Largest increase of the power of the likelihood with weights that are worth `enough` draws."""
    lost = likelihood.max() - likelihood

    def excess(logarithm: float) -> float:
        share = np.exp(-math.exp(logarithm) * lost)
        return float(share.sum() ** 2 / (share**2).sum() - enough)

    high = math.log(most)
    return most if excess(high) >= 0 else math.exp(brentq(excess, high - 600, high))


def _agreement(chains: Floats, walkers: int) -> tuple[float, float]:
    """Largest R-hat, and smallest effective number of draws, of chains (ensembles, draws, used).

    R-hat takes draws in the order of rounds, so it includes a drift. The effective number takes those of each
    walker in a row, so it includes the autocorrelation of walkers.
    """
    _, az = libraries()
    in_rows = chains.reshape(len(chains), -1, walkers, chains.shape[-1]).swapaxes(1, 2).reshape(chains.shape)
    r_hat = max(float(az.rhat(draws)) for draws in np.moveaxis(chains, -1, 0))
    counted = ({"method": "bulk"}, {"method": "tail", "prob": (0.05, 0.95)})
    return r_hat, min(float(az.ess(draws, **how)) for draws in np.moveaxis(in_rows, -1, 0) for how in counted)


def _thinned(problem: Problem, chains: Floats, draws: int, seed: int) -> Floats:
    """Draws of all parameters of each ensemble; those of unused parameters are from their prior."""
    random = np.random.default_rng([seed, ENSEMBLES])
    chosen = random.permuted(np.tile(np.arange(chains.shape[1]), (len(chains), 1)), axis=1)[:, :draws]
    whole = problem.of_prior(random, chosen.size).reshape(*chosen.shape, -1)
    whole[..., problem.used] = np.take_along_axis(chains, chosen[..., None], axis=1)
    return whole


def libraries() -> tuple[Any, Any]:
    """Import emcee and ArviZ without their warnings; `MissingExtraError` if they are missing."""
    with checks.extra("inference", "inference"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import arviz
        import emcee

    return emcee, arviz
