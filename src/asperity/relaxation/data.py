"""Measured relaxation, creep or dynamic moduli, and fits of branches with fixed times.

Each kind of data is linear in the weights w of the branches:

    relaxation    G(t)          = p + sum_b w_b exp(-t/tau_b)
    creep         J(t)          = J0 + f t + sum_k w_k (1 - exp(-t/theta_k))
    dynamic       G' + i G''    = p + sum_b w_b (i omega tau_b)/(1 + i omega tau_b)

`series.from_retardation` converts creep to relaxation exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Literal, Self, get_args

import numpy as np

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.base.positive_sums import positive_weights
from asperity.errors import LARGEST, InputError
from asperity.relaxation.series import PronySeries, from_retardation, of_weights

Extrapolate = Literal["plateau"]
Modulus = Literal["young", "shear", "contact"]

FEWEST = 5
"""Least number of points of a fit."""

_NOISE = 0.05
_FLOWS = (
    0.01  # creep flows if a fit without flow misses the data by this, rms, and twice as much as with flow
)
_SMALLEST_LOSS = 1e-3
_PLATEAU = 100.0
"""End of a fitted plateau over the last time."""
_STEEPEST = 0.9  # largest exponent of a power of time that is continued before the first time
_BEFORE = 0.1  # relaxation time of this continuation, over the first time


@dataclass(frozen=True, eq=False, repr=False)
class _Data(views.Brief):
    """Data against times or frequencies: this column, those of the quantities, and options.

    `measured` is the modulus, "young", "shear" or "contact", if that is known; `source` names file and
    columns. What is not `absolute` lacks a factor, such as the force at a held depth.
    """

    measured: Modulus | None = field(default=None, kw_only=True)
    absolute: bool = field(default=True, kw_only=True, repr=False)
    source: str = field(default="", kw_only=True, repr=False)
    falls: ClassVar[bool] = False
    """Whether the first quantity falls along the data, or rises."""

    def __post_init__(self: Any) -> None:
        checks.choice("extrapolate", self.extrapolate, (None, *get_args(Extrapolate)))
        object.__setattr__(self, "noise", checks.number("noise", self.noise, least=0, below=1))
        for name in self.names():
            object.__setattr__(self, name, checks.line(name, getattr(self, name)))
        self._check_columns()
        self._check_trend()

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(part.name for part in fields(cls) if not part.kw_only and part.name != "noise")

    @property
    def columns(self) -> tuple[Floats, tuple[Floats, ...]]:
        """Times or angular frequencies, and the quantities."""
        x, *values = (getattr(self, name) for name in self.names())
        return x, tuple(values)

    @property
    def fitted(self) -> Self:
        """Data to fit, with an assumed plateau after them."""
        return self

    def continued(self, series: PronySeries, part: float = 1.0) -> PronySeries:  # noqa: ARG002
        """Add a part of the relaxation before the first time that the slope there predicts."""
        return series

    def shifted(self, factor: float) -> Self:
        """Shift data to another temperature: multiply times, or divide frequencies, by `factor`."""
        factor = checks.number("factor", factor, least=1 / LARGEST, expected="a finite factor > 0")
        name, x = self.names()[0], self.columns[0]
        shifted: dict[str, Any] = {name: factor * x if name == "time" else x / factor}
        return replace(self, **shifted)

    def scaled(self, factor: float) -> Self:
        """Multiply the moduli by a factor that the data lack; they are absolute then."""
        name, values = self.names()[1], self.columns[1][0]
        factored: dict[str, Any] = {name: values / factor if name == "compliance" else factor * values}
        return replace(self, absolute=True, **factored)

    def _check_columns(self: Any) -> None:
        """Refuse columns that are not of one length, positive, and against rising times."""
        (x, *names), (along, _) = self.names(), self.columns
        if along.size < FEWEST:
            raise InputError(x, expected=f"a table of {FEWEST} rows or more", got=along.size)
        for name in (x, *names):
            values, zero = getattr(self, name), name == "loss"
            if values.shape != along.shape:
                raise InputError(name, expected=f"{along.size} values, as many as of {x}", got=values.size)
            wrong = values < 0 if zero else values < 1 / LARGEST
            wrong[0] &= name != "time" or values[0] != 0
            if wrong.any():
                at = int(np.argmax(wrong))
                expected = f"{name} {'not below' if zero else 'above'} 0"
                raise InputError(name, expected=expected, got=f"{values[at]:g} at point {at + 1}")
        if not (rises := np.diff(along) > 0).all():
            at = int(np.argmin(rises))
            got = f"{along[at + 1]:g} after {along[at]:g}, at point {at + 2}"
            raise InputError(x, expected=f"{x} that rises from point to point", got=got)

    def _check_trend(self: Any) -> None:
        """Refuse values that rise above (or fall below) an earlier one by more than noise."""
        (along, name, *_), (x, (values, *_)) = self.names(), self.columns
        extreme = (np.minimum if self.falls else np.maximum).accumulate(values)
        change = values / extreme - 1 if self.falls else 1 - values / extreme
        at = int(np.argmax(change))
        if change[at] > self.noise:
            before = int(np.flatnonzero(values[: at + 1] == extreme[at])[0])
            least, way = math.ceil(100 * change[at] + 1e-9) / 100, "rise" if self.falls else "fall"
            expected = f"no {way} with {along} beyond {100 * self.noise:g} % of noise"
            got = f"{values[before]:.4g} at {x[before]:.3g}, then {values[at]:.4g} at {x[at]:.3g}"
            advice = f"noise={least:g}, if this is noise" if least < 0.5 else ""
            raise InputError(name, expected=expected, got=got, advice=advice)


@dataclass(frozen=True, eq=False, repr=False)
class _InTime(_Data):
    """Data against times."""

    time: Floats
    extrapolate: Extrapolate | None = field(default=None, kw_only=True)

    @property
    def span(self) -> tuple[float, float]:
        """First and last time after 0."""
        return float(self.time[self.time > 0][0]), float(self.time[-1])

    def reach(self, decades: float) -> tuple[float, float]:
        """Range of relaxation times, so many decades after the data, and before them with a value at 0."""
        first, last = self.span
        return first * (_BEFORE if self.time[0] == 0 else 1), last * 10**decades

    @property
    def fitted(self) -> Self:
        if self.extrapolate is None:
            return self
        _, (values,) = self.columns
        later = self.time[-1] * np.geomspace(1, _PLATEAU, values.size + 1)[1:]
        longer: dict[str, Any] = {self.names()[1]: np.append(values, np.full(values.size, values[-1]))}
        return replace(self, time=np.append(self.time, later), extrapolate=None, **longer)


@dataclass(frozen=True, eq=False, repr=False)
class Relaxation(_InTime):
    """Relaxation modulus G(t): stress over a strain that was imposed at time 0.

    Parameters
    ----------
    time
        Rising times, s, shape (n,), n >= 5. The first may be 0: the value there is the instantaneous one.
    modulus
        Moduli above 0, Pa, shape (n,); they may rise by `noise` at most.
    noise
        Largest relative rise that counts as noise.
    extrapolate
        "plateau": assume the last modulus after the last time. None: nothing is known there.

    Raises
    ------
    InputError
        A number is out of its range, or the modulus rises.
    """

    modulus: Floats
    noise: float = _NOISE

    quantities: ClassVar[tuple[str, ...]] = ("relaxation modulus",)
    falls: ClassVar[bool] = True

    def predicted(self, series: PronySeries, time: Floats) -> tuple[Floats, ...]:
        """Quantities of a series in place of the data."""
        return (series.modulus_at(time),)

    def series(self, times: Floats) -> PronySeries:
        """Fit branches of these times."""
        columns = np.column_stack([np.exp(-self.time[:, None] / times), np.ones_like(self.time)])
        return of_weights(positive_weights(columns, self.modulus, self.modulus), times)

    def continued(self, series: PronySeries, part: float = 1.0) -> PronySeries:
        """See `_Data`. Until the first time, the relaxing part is a power of time with the slope there.

        One branch replaces the excess of this power over the series: it has the same integral over time, on
        which later strains depend.
        """
        (first, last), held = self.span, series.permanent * series.modulus
        end = min(10 * first, last)
        start, later = series.modulus_at([first, end]) - held
        if self.time[0] == 0 or not start > 0:
            return series
        slope = min(math.log(start / max(later, 1e-9 * start)) / math.log(end / first), _STEEPEST)
        shares, times = np.reshape(series.branches, (-1, 2)).T
        weights, time = shares * series.modulus, _BEFORE * first
        more = start * first / (1 - slope) + float(weights * times @ np.expm1(-first / times))
        return of_weights(np.r_[part * max(more, 0.0) / time, weights, held], np.append(time, times))


@dataclass(frozen=True, eq=False, repr=False)
class Creep(_InTime):
    """Creep compliance J(t): strain over a stress that was imposed at time 0.

    Parameters
    ----------
    compliance
        Compliances above 0, 1/Pa, shape (n,); they may fall by `noise` at most.

    Other arguments and errors are those of `Relaxation`; the last compliance stays on a plateau.
    """

    compliance: Floats
    noise: float = _NOISE

    quantities: ClassVar[tuple[str, ...]] = ("creep compliance",)

    def predicted(self, series: PronySeries, time: Floats) -> tuple[Floats, ...]:
        """Quantities of a series in place of the data."""
        return (series.compliance_at(time),)

    def series(self, times: Floats) -> PronySeries:
        """Fit a generalized Kelvin solid or fluid of these retardation times, and convert it."""
        t, J = self.time[:, None], self.compliance
        columns = np.hstack([t, np.ones_like(t), -np.expm1(-t / times)])
        solid = np.append(0.0, positive_weights(columns[:, 1:], J, J))
        fluid = positive_weights(columns, J, J)
        missed, missed_by_fluid = (float(np.std(columns @ w / J - 1)) for w in (solid, fluid))
        flows = missed > max(_FLOWS, 2 * missed_by_fluid)
        weights = fluid if flows else solid
        fluidity, instantaneous, delayed = float(weights[0]), float(weights[1]), weights[2:]
        if not instantaneous > 1e-6 * self.compliance[0]:
            expected, got = "creep that begins elastically", f"none of it before {self.time[0]:.3g} s"
            advice = "earlier times, or none of the first"
            raise InputError("compliance", expected=expected, got=got, advice=advice)
        kept = delayed > 0
        return from_retardation(instantaneous, np.column_stack([delayed, times])[kept], fluidity)


@dataclass(frozen=True, eq=False, repr=False)
class Dynamic(_Data):
    """Storage and loss modulus G', G'' against angular frequency.

    Parameters
    ----------
    frequency
        Angular frequencies above 0, rad/s, rising or falling, shape (n,), n >= 5; stored rising.
    storage
        Storage moduli above 0, Pa, shape (n,); they may fall with frequency by `noise` at most.
    loss
        Loss moduli, not below 0, Pa, shape (n,).
    noise
        Largest relative fall that counts as noise.
    """

    frequency: Floats
    storage: Floats
    loss: Floats
    noise: float = _NOISE

    quantities: ClassVar[tuple[str, ...]] = ("storage modulus", "loss modulus")
    extrapolate: ClassVar[None] = None

    def __post_init__(self) -> None:
        frequency = checks.line("frequency", self.frequency)
        if frequency.size > 1 and frequency[0] > frequency[-1]:
            for name in self.names():
                object.__setattr__(self, name, checks.line(name, getattr(self, name))[::-1])
        super().__post_init__()

    @property
    def span(self) -> tuple[float, float]:
        """Shortest and longest time, 1/frequency."""
        return 1 / float(self.frequency[-1]), 1 / float(self.frequency[0])

    def reach(self, decades: float) -> tuple[float, float]:
        """Range of relaxation times, so many decades beyond the data on both sides."""
        first, last = self.span
        return first / 10**decades, last * 10**decades

    def predicted(self, series: PronySeries, frequency: Floats) -> tuple[Floats, ...]:
        """Quantities of a series in place of the data."""
        return series.storage(frequency), series.loss(frequency)

    def series(self, times: Floats) -> PronySeries:
        """Fit branches of these times to both moduli."""
        x = self.frequency[:, None] * times
        still = np.ones((self.frequency.size, 1))
        rows = [np.hstack([x / (x + 1 / x), still]), np.hstack([1 / (x + 1 / x), 0 * still])]
        values, scale = np.concatenate([self.storage, self.loss]), np.concatenate(scales(self))
        return of_weights(positive_weights(np.vstack(rows), values, scale), times)


Measured = Relaxation | Creep | Dynamic


def scales(data: Measured) -> tuple[Floats, ...]:
    """Scales of relative deviations: the values; for a small loss, a thousandth of the storage modulus."""
    _, (first, *others) = data.columns
    return (first, *(np.maximum(loss, _SMALLEST_LOSS * first) for loss in others))
