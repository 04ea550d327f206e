"""The answer of an inference: verdicts, models side by side, bands, and the solid."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from asperity.base import checks, views
from asperity.base.calls import remark
from asperity.base.checks import Floats
from asperity.base.rows import Row, table_rows
from asperity.base.words import counted, to_digits
from asperity.errors import InputError
from asperity.inference.models import Model
from asperity.inference.problem import Problem
from asperity.inference.rivals import Rival, parting
from asperity.inference.sampling import Draws
from asperity.inference.verdicts import WORDS, Candidate, Combination, Verdict, distinguishable

_TELLS = 0.5
"""Largest expected width, over the present one, for which an experiment is recommended."""

_OF_SOLIDS = ("modulus", "k0", "x1", "rate", "stress")
"""Parameters of solids that a section has only if they are identified."""

_FAR = 10.0
"""Times of the last measured time up to which the report compares models and figures show the band."""

_OF_SOLID = 100
"""Number of draws of a solid for the band of a prediction."""


@dataclass(frozen=True, eq=False, repr=False)
class Inference(views.Brief, views.Pictured):
    """Posterior of a model, with a verdict on each parameter.

    Attributes
    ----------
    time, value, error
        The data in order of time, and their standard errors, shape (n,).
    verdicts, combinations, candidates
        A `Verdict` by parameter; each `Combination`, the best first; a `Candidate` for each experiment.
    profiles
        For each parameter of the curve, values, and -2 ln of the profile likelihood over its peak.
    draws, chi_squared
        Draws of the posterior, and chi-squared of the best fit.
    rivals
        The model, and models of creep for comparison, see `Rival`.
    remarks
        Decisions and warnings.
    quantity, unit
        The measured quantity, and its unit, "" if unknown.
    """

    time: Floats
    value: Floats
    error: Floats
    model: Model
    verdicts: Mapping[str, Verdict]
    combinations: tuple[Combination, ...]
    candidates: tuple[Candidate, ...]
    profiles: Mapping[str, tuple[Floats, Floats]]
    draws: Draws
    chi_squared: float
    rivals: tuple[Rival, ...]
    remarks: tuple[str, ...] = ()
    quantity: str = "area"
    unit: str = ""

    def rows(self) -> list[Row]:
        """Rows of a summary: the data, the models, the findings, and the agreement of the samples."""
        rows = [Row("data", counted(self.time.size, "point")), Row("model", self.model.name)]
        compared = self.models.itertuples(index=False)
        cells = [[str(name), *(to_digits(value, 3) for value in values)] for name, *values in compared]
        rows += table_rows("models", [[*self.models.columns], *cells])
        rows += [Row("", sentence) for sentence in (*self.told, *self.further)]
        rows += [Row(*finding) for finding in self.findings]
        if math.isfinite(self.problem.counted):
            count = f"{self.time.size} points as {to_digits(self.problem.counted, 2)}, as neighbors correlate"
            rows.append(Row("counted", count))
        if not self.sampled:
            return rows
        samples = f"R-hat {self.draws.r_hat:.4f}, {self.draws.effective:.0f} effective samples"
        return [*rows, Row("agreement", samples)]

    @property
    def problem(self) -> Problem:
        """Data and model."""
        return self.rivals[0].problem

    @property
    def sampled(self) -> bool:
        """Whether the draws are samples of walkers, and not along profiles."""
        return math.isfinite(self.draws.r_hat)

    @functools.cached_property
    def values(self) -> dict[str, Floats]:
        """Draws of each parameter, shape (ensembles, draws)."""
        flat = self.problem.values(self.draws.flat)
        return {name: column.reshape(self.draws.z.shape[:-1]) for name, column in flat.items()}

    @property
    def table(self) -> pd.DataFrame:
        """The verdicts, a row for each parameter."""
        names = ["parameter", "verdict", "low", "high", "value", "unit"]
        rows = [
            (*(getattr(verdict, name) for name in names), *verdict.profile)
            for verdict in self.verdicts.values()
        ]
        return pd.DataFrame(rows, columns=[*names, "profile_low", "profile_high"])

    @property
    def models(self) -> pd.DataFrame:
        """Models side by side: AICc less the least, misfit of the last fifth, held out, and growth beyond.

        NaN where the points are too few.
        """
        last = self.time[-1] * np.array([1.0, 10.0, 1000.0])
        rows = []
        for rival in self.rivals:
            now, *later = rival.band(last)[1]
            score = rival.aicc if math.isfinite(rival.aicc) else math.nan
            rows.append((rival.name, score, rival.missed, *(at / now for at in later)))
        names = ["model", "AICc", "misfit of last fifth (errors)", "at 10 x last time", "at 1000 x last time"]
        return pd.DataFrame(rows, columns=names)

    @property
    def findings(self) -> list[tuple[str, str]]:
        """Verdicts (determined, bounded, not identified) with their parameters, in words."""
        by_verdict: dict[str, list[str]] = {word: [] for word in WORDS}
        for name, verdict in self.verdicts.items():
            as_prior = " (as its prior)" * (not self.model.priors[name].bounded)
            words = verdict.words if verdict.verdict != "not identified" else f"{name}{as_prior}"
            by_verdict[verdict.verdict].append(words)
        return [(word, ", ".join(names)) for word, names in by_verdict.items() if names]

    @property
    def told(self) -> list[str]:
        """Sentences on the range of the data, and on models that differ beyond."""
        return parting(self.rivals)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Range of the model, findings, combinations, and recommended experiments."""
        findings = (f"{word[:1].upper()}{word[1:]}: {of}" for word, of in self.findings)
        return *self.told, *findings, *self.further

    @property
    def further(self) -> list[str]:
        """Sentences on combinations, and on experiments that would narrow parameters, or would not."""
        lines = []
        for combination in self.combinations:
            low, high = distinguishable(combination.low, combination.high)
            better = f"{combination.tighter:.2g} times better known than any of these alone"
            lines.append(f"{combination.name} lies between {low} and {high}, {better}")
        useless = []
        for experiment in self.candidates:
            narrowed = {name: width for name, width in experiment.widths.items() if width < _TELLS}
            of = ", ".join(f"{name} to {100 * width:.2g} %" for name, width in narrowed.items())
            if narrowed:
                lines.append(
                    f"Measuring {experiment.name} would narrow {of} of its present width, or further"
                )
            else:
                useless.append(experiment.name)
        if useless:
            lines.append(f"Measuring {', or '.join(useless)} would hardly help")
        return lines

    def predicted(self, time: ArrayLike) -> Floats:
        """The curve at any times: a 95 % band over all acceptable models, and the median of the first one.

        Shape (3, n): the least 2.5 % quantile of the posteriors, the median, and the largest 97.5 % quantile.
        A remark says if times are far beyond the data: the band knows no slower process.
        """
        at = checks.not_negative("time", time)
        if (beyond := float(at.max(initial=0.0) / self.time[-1])) > 1.001 * _FAR:
            remark(
                f"{at.max():.3g} is {beyond:.3g} times the last measured time: "
                "the band covers the models that were tried, and no process slower than the data"
            )
        bands = np.array([rival.band(at) for rival in self.acceptable])
        return np.array([bands[:, 0].min(axis=0), bands[0, 1], bands[:, 2].max(axis=0)])

    @property
    def acceptable(self) -> list[Rival]:
        """The model, and others that fit nearly as well as the best, or predict held-out points best."""
        return [rival for rival in self.rivals if rival.z is not None]

    def solid(self) -> dict[str, object]:
        """Section ``[solid]`` of a configuration, of the best fit, with draws of its branches.

        Draws are from all acceptable models in equal parts. `unknown` parameters are left out. `InputError`
        for a model without a solid.
        """
        if self.model.solid is None:
            raise InputError("solid", expected="a model of a solid", got=f"model {self.model.name!r}")
        numbers = self.problem.numbers(self.rivals[0].at)
        identified = {name: x for name, x in numbers.items() if name not in self.unknown}
        keys = self.model.solid(identified)
        if "branches" not in keys:
            return keys
        many = -(-_OF_SOLID // len(self.acceptable))
        keys |= {"data_first": f"{self.time[self.time > 0][0]:.6g} s", "data_last": f"{self.time[-1]:.6g} s"}
        draws = [solid["branches"] for rival in self.acceptable for solid in rival.solids(many)]
        return keys | {"draws": draws}

    @property
    def unknown(self) -> list[str]:
        """Parameters of the solid that the data do not identify."""
        return [
            name for name in _OF_SOLIDS if name in self.verdicts and self.verdicts[name].verdict == WORDS[-1]
        ]

    def to_datatree(self) -> xr.DataTree:
        """Posterior, prior and data in the groups that ArviZ reads."""
        problem, shape = self.problem, self.draws.z.shape[:-1]
        prior = problem.values(problem.of_prior(np.random.default_rng(0), math.prod(shape)))
        draws = {"posterior": self.values, "prior": {name: x.reshape(shape) for name, x in prior.items()}}
        observed = {"value": self.value, "error": self.error}
        data = {"observed_data": observed, "constant_data": {"time": self.time}}
        groups = {
            name: xr.Dataset({key: (dims, x) for key, x in of.items()})
            for dims, part in ((("chain", "draw"), draws), (("point",), data))
            for name, of in part.items()
        }
        return xr.DataTree.from_dict(groups)
