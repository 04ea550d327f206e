"""Data with errors, and a model of them: all that a fit or a sampler must know.

A model, see `Model`, gives

- ``priors``: by name of each parameter a `Prior`, which is its range, its unit and its transform: searches
  and walkers see the coordinate z of a prior only (from 0 to 1 between the ends of a range, in the logarithm
  for ``log_uniform``; in standard deviations for ``normal``), and `Prior.at` gives the value.
- ``curve(time, values)``: the prediction at n times for m sets of parameters at once, shape (m, n); values
  are arrays of shape (m,) by name. It is finite, also where parameters are not allowed. A model of a record
  with another variable (depth of a ball) holds this and interpolates it in time.
- ``excess(values)``: by how much parameters leave what is allowed, shape (m, ...), at most 0 inside.
- ``solid(numbers)``: the section ``[solid]`` of a configuration, if it has one.

Data are ``value`` at ``time``, shape (n,), of any sign. ``error`` are their standard errors. If these are
not known (``informed=False``), it is the shape of the noise: the values for a relative noise, ones for an
absolute one. `Problem.scatter` then measures its size, and the correlation of neighboring rows.
`asperity.inference.concluding.conclude` takes problems, and answers an `Inference`.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.inference.models import Model

_TRIED, _STEP, _SINGULAR = 64, 1e-6, 1e-7
"""Draws of the prior, step of a coordinate, and least relative singular value, for a rank."""
_CORRELATIONS = np.linspace(-0.3, 0.98, 65)
"""Correlations of neighbors, with equal prior weight."""
_NOTHING = 1e-150
LOST = -1e300
"""Logarithm of a likelihood of 0, as a finite number."""
_TOLERATED = 2e-3
"""Excess over what a model allows that counts as none."""


@dataclass(frozen=True, eq=False)
class Problem:
    """Data with errors, and a model of them.

    Attributes
    ----------
    time, value, error
        Data and their standard errors, shape (n,).
    model
        Curve, parameters and priors, see `asperity.inference.problem`.
    rho
        Correlation of the errors of neighboring rows, an autoregressive series of first order.
    counted
        Number of independent rows that tell as much about a mean; NaN if errors are given.
    informed
        Whether the size of the errors is known; else priors do not count as data.
    """

    time: Floats
    value: Floats
    error: Floats
    model: Model
    rho: float = 0.0
    counted: float = math.nan
    informed: bool = True

    def values(self, z: Floats) -> dict[str, Floats]:
        """All parameters at coordinates of shape (m, parameters)."""
        return {
            name: prior.at(column)
            for (name, prior), column in zip(self.model.priors.items(), z.T, strict=True)
        }

    def numbers(self, z: Floats) -> dict[str, float]:
        """All parameters at coordinates of shape (parameters,)."""
        return {name: float(x) for name, x in self.values(z).items()}

    def curve(self, z: Floats) -> Floats:
        """Curve at the times of the data, shape (m, n)."""
        with np.errstate(all="ignore"):
            return self.model.curve(self.time, self.values(z))

    def misfit(self, z: Floats) -> Floats:
        """Curve less data, in errors made independent, shape (m, n)."""
        return self.apart((self.curve(z) - self.value) / self.error)

    def apart(self, misfit: Floats) -> Floats:
        """Make the errors of neighbors independent: shape (..., n)."""
        if self.rho == 0:
            return misfit
        later = (misfit[..., 1:] - self.rho * misfit[..., :-1]) / math.sqrt(1 - self.rho**2)
        return np.concatenate([misfit[..., :1], later], axis=-1)

    def excess(self, z: Floats) -> Floats:
        """By how much parameters leave what the model allows, shape (m, conditions), 0 inside."""
        beyond = np.asarray(self.model.excess(self.values(z)), dtype=np.float64)
        return np.maximum(beyond, 0.0).reshape(len(z), -1) if beyond.ndim else np.zeros((len(z), 1))

    def log_likelihood(self, z: Floats) -> Floats:
        """Of normal errors, without its constant, shape (m,); `LOST` if parameters are not allowed."""
        with np.errstate(all="ignore"):
            squares = (self.misfit(z) ** 2).sum(-1)
        fine = (squares < -LOST) & (self.excess(z) < _TOLERATED).all(-1)
        return np.where(fine, -squares / 2, LOST)

    @property
    def reach(self) -> Floats:
        """Bounds of the coordinates in a search, shape (parameters, 2)."""
        return np.array([prior.reach for prior in self.model.priors.values()])

    @functools.cached_property
    def informative(self) -> list[int]:
        """Places of used parameters whose priors count as data."""
        priors = list(self.model.priors.values())
        return [at for at in self.used if self.informed and not priors[at].bounded]

    @functools.cached_property
    def used(self) -> list[int]:
        """Places of the parameters on which the curve depends, found by changing each."""
        random = np.random.default_rng(0)
        z = self.of_prior(random, 32)
        changed = []
        for place, prior in enumerate(self.model.priors.values()):
            other = z.copy()
            other[:, place] = prior.drawn(random, len(z))
            if not np.array_equal(self.curve(z), self.curve(other), equal_nan=True):
                changed.append(place)
        return changed

    @functools.cached_property
    def rank(self) -> int:
        """Number of combinations of the parameters that any number of points would determine."""
        time = np.geomspace(self.time[self.time > 0][0], self.time[-1], 50)
        slopes = self._slopes(self.of_prior(np.random.default_rng(0), _TRIED), time)
        singular = np.linalg.svd(slopes, compute_uv=False)
        return int((singular > _SINGULAR * singular.max(-1, keepdims=True)).sum(-1).max())

    def _slopes(self, z: Floats, time: Floats, size: Floats | None = None) -> Floats:
        """Change of the curve over its size (itself) with each used coordinate: (m, used, n)."""
        center, step = z[:, np.newaxis], _STEP * np.eye(z.shape[1])[self.used]
        with np.errstate(all="ignore"):
            up, down, central = (
                self.model.curve(time, self.values(at.reshape(-1, z.shape[1]))).reshape(*at.shape[:-1], -1)
                for at in (center + step, center - step, center)
            )
            change = (up - down) / (central if size is None else size)
            return np.asarray(np.nan_to_num(change, posinf=0.0, neginf=0.0))

    def scatter(self, z: Floats) -> tuple[float, float]:
        """Standard error over `error`, and correlation rho of neighbors, about the best fit z.

        n errors of an autoregressive series of first order count as n (1 - rho)/(1 + rho) independent ones
        for a mean. The size of this mean's error is a geometric mean over rho, weighted by the restricted
        likelihood, which the fit does not bias (H. D. Patterson, R. Thompson, Biometrika 58, 545 (1971), DOI
        10.1093/biomet/58.3.545); so is rho, in atanh.
        """
        slopes = self._slopes(z[np.newaxis], self.time, self.error)[0].T
        columns, sizes, _ = np.linalg.svd(slopes, full_matrices=False)
        most = min(self.rank, int(np.sum(sizes > _SINGULAR * sizes[0])), self.time.size - 1)
        both = np.column_stack([columns[:, :most], self.misfit(z[np.newaxis])[0]])
        free = self.time.size - most
        logs, weights = np.empty((2, _CORRELATIONS.size))
        for n, rho in enumerate(_CORRELATIONS):
            apart = replace(self, rho=rho).apart(both.T).T
            *others, remaining = np.log(np.maximum(np.abs(np.diag(np.linalg.qr(apart, mode="r"))), _NOTHING))
            logs[n] = remaining + math.log((1 + rho) / (1 - rho) / free) / 2
            weights[n] = (1 - self.time.size) / 2 * math.log(1 - rho**2) - sum(others) - free * remaining
        weights = np.exp(weights - weights.max())
        rho = math.tanh(weights @ np.arctanh(_CORRELATIONS) / weights.sum())
        return math.exp(weights @ logs / weights.sum()) * math.sqrt((1 - rho) / (1 + rho)), rho

    def of_prior(self, random: np.random.Generator, count: int) -> Floats:
        """Coordinates of draws of the prior that are allowed, shape (count, parameters)."""
        drawn = np.empty((0, len(self.model.priors)))
        for _ in range(1000):
            size = max(64, count)
            more = np.stack([prior.drawn(random, size) for prior in self.model.priors.values()], -1)
            drawn = np.concatenate([drawn, more[(self.excess(more) == 0).all(-1)]])
            if len(drawn) >= count:
                return drawn[:count]
        raise InputError("priors", expected="parameters that the model allows", got="none among 64,000 draws")
