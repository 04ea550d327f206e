"""The solid under an indenter, from approach and hold of its record; and the retraction that it predicts."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.base.rows import Row
from asperity.inference.concluding import conclude
from asperity.inference.found import Inference
from asperity.inference.indenting import REACH, Indentation, noise
from asperity.inference.models import MOST_BRANCHES, Model, Values, branches_of, held, relaxed
from asperity.inference.priors import Given, Prior
from asperity.inference.problem import Problem
from asperity.inference.rivals import drift_in
from asperity.progress import Progress, listener
from asperity.theory.indenters import SHAPES, Tip, forces, tip_of

_MOST = 100
"""Most rows of each segment that are fitted, as means of neighbors."""
_AT_ONCE = 32
"""Solids that are pressed at once: their arrays stay in the memory of a processor."""
_TAIL = 5
"""Least number of rows after the tip is off, for the force there."""
_WIDE = 1e-2, 1e4
"""Ends of the prior of the modulus, over that of Hertz."""
_TOUCHING = 0.02
"""Least force in contact, over the largest."""
_ADHESIVE, _DRAG = 0.02, 0.02
"""Pull-off, and change of the force out of contact, over the largest force, that are remarked."""
_FASTER = 10.0
"""Factor by which relaxation times may be below the first time that is determined: faster ones act alike."""
_DRAWN = 100


@dataclass(frozen=True, eq=False, repr=False)
class IndentedSolid(Inference):
    """A solid inferred from the record of an indenter: an `Inference`, and what the record adds.

    Attributes
    ----------
    record, tip, radius, poisson
        The record; its indenter, and the radius of a ball or punch, m; Poisson's ratio, if it was given.
    """

    record: Indentation = None  # type: ignore[assignment]
    tip: Tip = None  # type: ignore[assignment]
    radius: float = math.nan
    poisson: float | None = None

    def rows(self) -> list[Row]:
        """Rows of a summary: the record, its solid, and the retraction that this predicts."""
        at = np.geomspace(*self.record.span, 3)
        rows = self.record.rows()
        for time, (low, value, high) in zip(at, self.modulus_at(at).T, strict=True):
            rows.append(Row(f"{self.kind} at {time:.3g} s", value, "Pa", (low, high), brief=True))
        if math.isfinite(self.deviation[0]):
            best, low, high = (f"{100 * one:.2g}" for one in self.deviation)
            words = f"{best} % of the largest force (95 %: {low} to {high}), rms in contact"
            rows.append(Row("retraction off its prediction by", words, brief=True))
        if self.pull_off > 0:
            work = self.pull_off / (1.5 * math.pi * self.radius)
            note = f", by JKR (elastic) a work of adhesion of {work:.2g} J/m^2" * (self.tip.exponent == 1.5)
            rows.append(Row("pull-off force", self.pull_off, "N", note=note, digits=2))
        return [*rows, *super().rows()]

    @property
    def kind(self) -> str:
        """Which modulus `modulus_at` is: Young's, or the contact modulus."""
        return "contact modulus E*" if self.poisson is None else "Young's modulus"

    @property
    def told(self) -> list[str]:
        """The times that the record determines, and models that differ beyond."""
        first, last = self.record.span
        told = f"The record determines the solid from {first:.3g} to {last:.3g} s after a load"
        return [told, *super().told[1:]]

    def modulus_at(self, time: ArrayLike) -> Floats:
        """Relaxation modulus (Young's if Poisson's ratio is known, else E*), Pa, shape (3, n): 95 % band.

        The rows are the 2.5 % quantile, the median and the 97.5 % quantile of draws. Trust it within the
        `Indentation.span` of the record.
        """
        t = np.atleast_1d(checks.not_negative("time", time))
        drawn = self.problem.values(self.draws.flat)
        curves = self._young * drawn["modulus"][:, None] * relaxed(t, drawn)
        return np.quantile(curves, (0.025, 0.5, 0.975), axis=0)

    @property
    def _young(self) -> float:
        return 1.0 if self.poisson is None else 1 - self.poisson**2

    @functools.cached_property
    def _of_contact(self) -> tuple[Indentation, Floats]:
        """The record as means of neighbors, and its contact forces: of the best fit, then of draws.

        The solid is of the approach and the hold alone: the retraction is predicted.
        """
        record, _ = self.record.thinned(3 * _MOST)
        flat = self.draws.flat
        some = flat[np.linspace(0, len(flat) - 1, _DRAWN).astype(int)]
        every = self.problem.values(np.vstack([self.rivals[0].at, some]))
        return record, _force(every, record, self.tip)

    @property
    def _predicted(self) -> tuple[Indentation, Floats]:
        """The same with the force out of contact: drag of a liquid changes its sign with the velocity."""
        record, forces = self._of_contact
        retracted = np.arange(record.time.size) > record.last
        return record, forces + np.where(retracted, self._rest_after or 0.0, 0.0)

    @property
    def forces(self) -> pd.DataFrame:
        """Measured and predicted forces of the whole record, N: best fit, and 95 % band."""
        record, (best, *drawn) = self._predicted
        low, high = np.quantile(drawn, (0.025, 0.975), axis=0)
        names, starts, _ = zip(*record.segments, strict=True)
        part = np.searchsorted(starts, np.arange(record.time.size), "right")
        table = {"segment": [("before", *names)[at] for at in part]}
        columns = {"time_s": record.time, "depth_m": record.depth, "force_N": record.force}
        columns |= {"predicted_N": best, "predicted_N_low": low, "predicted_N_high": high}
        return pd.DataFrame(table | columns)

    @functools.cached_property
    def deviation(self) -> tuple[float, float, float]:
        """Rms deviation of the retraction in contact from its prediction, over the largest force.

        Of the best fit, and the ends of its 95 % interval; NaN without a retraction.
        """
        record, forces = self._predicted
        measured, predicted = record.force[record.last + 1 :], forces[:, record.last + 1 :]
        above = np.maximum(measured, predicted) - (self._rest_after or 0.0)
        touching = above > _TOUCHING * self.record.largest
        if touching[0].sum() < 3:
            return math.nan, math.nan, math.nan
        squares = np.where(touching, (measured - predicted) ** 2, 0.0).sum(-1) / touching.sum(-1)
        best, *drawn = np.sqrt(squares) / self.record.largest
        low, high = np.quantile(drawn, (0.025, 0.975))
        return float(best), float(low), float(high)

    @functools.cached_property
    def pull_off(self) -> float:
        """Force by which the tip is pulled at most below the force after it is off, N; 0 if there is none."""
        rest = self._rest_after
        if rest is None:
            return 0.0
        pulled = rest - float(self.record.force[self.record.last :].min())
        return pulled if pulled > 5 * noise(self.record.force) else 0.0

    @functools.cached_property
    def _rest_after(self) -> float | None:
        """Force out of contact after the retraction, N; None if the record ends before, by its prediction."""
        record, (best, *_) = self._of_contact
        after = record.force[record.last :]
        count = max(after.size // 4, 1)
        tail, off = after[-count:], best[-count:].max() <= _TOUCHING * record.largest
        flat = count >= _TAIL and np.ptp(tail) < max(0.1 * record.largest, 10 * noise(after))
        return float(np.median(tail)) if off and flat else None

    def remarked(self) -> IndentedSolid:
        """The same with remarks on adhesion, on forces out of contact, and on the retraction."""
        remarks, largest = [], self.record.largest
        if self.pull_off > _ADHESIVE * largest:
            remarks.append(
                f"adhesive: the tip is pulled by up to {self.pull_off:.2g} N before it is off, "
                f"{100 * self.pull_off / largest:.0f} % of the largest force; this model has no adhesion"
            )
        rest = self._rest_after
        if rest is not None and abs(rest) > _DRAG * largest and self.record.touched:
            remarks.append(
                f"out of contact the force after the retraction differs by {rest:.2g} N "
                "from that before the approach: drag of a liquid, or drift"
            )
        if not self.record.touched:
            remarks.append(
                "the record begins in contact: its first depth is taken as reached at once, "
                f"{'at time 0' if self.record.time[0] > 0 else 'at its first time'}"
            )
        if self.record.held < self.record.last:
            remarks += drift_in(self.rivals[0], self.record.span[1], lambda t, p: 1 / relaxed(t, p), largest)
        return replace(self, remarks=(*self.remarks, *remarks))

    def solid(self) -> dict[str, object]:
        """Section ``[solid]`` of a configuration, of the best fit, without draws.

        Draws have branches alone, and the modulus of a record goes with them.
        """
        first, last = self.record.span
        keys = super().solid() | {"data_first": f"{first:.6g} s", "data_last": f"{last:.6g} s"}
        keys.pop("draws", None)
        if self.poisson is not None and "modulus" in keys:
            modulus, _, unit = str(keys.pop("modulus")).partition(" ")
            young = {"young": f"{self._young * float(modulus):.6g} {unit}", "poisson": self.poisson}
            keys = {"kind": keys.pop("kind"), **young, **keys}
        return keys


def of_record(
    record: Indentation,
    *,
    tip: object,
    radius: float | str | None = None,
    angle: float | str | None = None,
    poisson: float | None = None,
    priors: Mapping[str, Given] | None = None,
    branches: int | None = None,
    sampling: Mapping[str, Any] | None = None,
    seed: int = 0,
    progress: Progress | bool | None = None,
) -> IndentedSolid:
    """Infer the solid under an indenter; arguments are those of `asperity.infer`."""
    shape = tip_of(checks.choice("model", tip, SHAPES), radius, angle)
    if poisson is not None:
        poisson = checks.number("poisson", poisson, least=-1, most=0.5)
    few, count = record.thinned(_MOST)
    near = few.reached - REACH * (few.depth[few.last] - few.reached)
    first = few.touched if few.contact is not None else int(np.argmax(few.depth > near))
    rows = slice(first, few.last + 1)
    error = record.largest / np.sqrt(count[rows])
    family = []
    for n in [branches] if branches else range(1, MOST_BRANCHES + 1):
        model = _model(str(tip), few, shape, n)
        family.append(Problem(few.time[rows], few.force[rows], error, model, informed=False))
    with listener(progress) as listening:
        how: Any = {"seed": seed, "quantity": "force", "unit": "N", "listening": listening}
        found = conclude(family, priors=priors, sampling=sampling, **how)
    inherited = {field.name: getattr(found, field.name) for field in fields(found)}
    length = math.nan if radius is None else float(units.number("radius", radius, "m"))
    facts = {"record": record, "tip": shape, "radius": length, "poisson": poisson, "candidates": ()}
    return IndentedSolid(**inherited | facts).remarked()


def _model(name: str, record: Indentation, tip: Tip, branches: int) -> Model:
    """Force of the approach and the hold; the depth stays at later times."""
    creep = held(*record.span, branches)
    priors = {"modulus": _modulus(record, tip)} | creep.priors
    for key, prior in creep.priors.items():
        if prior.unit == "s":
            priors[key] = replace(prior, first=record.span[0] / _FASTER)
    if record.contact is None:
        reach = REACH * (record.depth[record.last] - record.reached)
        priors["contact"] = Prior("uniform", record.reached - reach, record.reached + reach, "m")

    def curve(time: Floats, p: Values) -> Floats:
        return _force(p, record, tip, time)

    return replace(creep, name=name, growth=curve, priors=priors)


def _modulus(record: Indentation, tip: Tip) -> Prior:
    """Range of the contact modulus, about that of an elastic solid at the largest force."""
    deep = record.depth[record.last] - record.reached
    elastic = record.largest / (tip.factor * deep**tip.exponent)
    return Prior("log_uniform", _WIDE[0] * elastic, _WIDE[1] * elastic, "Pa")


def _force(p: Values, record: Indentation, tip: Tip, time: Floats | None = None) -> Floats:
    """Force at the rows of a record, or at times before its retraction, with a depth that stays: (m, n)."""
    shares, times = branches_of(p)
    every = np.column_stack([np.maximum(1 - shares.sum(-1), 0.0), shares])
    t, depth, last = record.time, record.depth, record.last
    if time is not None:
        later = np.unique(time[time > t[last]])
        depth = np.append(depth[: last + 1], np.full(later.size, depth[last]))
        t = np.append(t[: last + 1], later)
        last = t.size - 1
    if not record.touched and t[0] > 0:  # pressed at time 0
        t = np.append(0.0, t[1:])
    fitted = "contact" in p  # else the depths of all are alike
    depths = depth - (p["contact"][:, None] if fitted else np.array([[record.contact]], dtype=float))
    parts = []
    for first in range(0, len(times), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        d = depths[some] if fitted else depths
        parts.append(forces(t, d, every[some], times[some], tip.exponent, last))
    force = tip.factor * p["modulus"][:, None] * np.concatenate(parts)
    if time is None or np.array_equal(time, t):
        return np.asarray(force)
    return np.array([np.interp(time, t, one) for one in force])
