r"""Parameters of rate-and-state friction from records, with uncertainties.

The friction coefficient is linear in mu_0, a and b, which least squares give for any D_c and state at the
first time. Only these two are searched (variable projection: G. H. Golub, V. Pereyra, SIAM J. Numer. Anal.
10, 413 (1973), doi:10.1137/0710036), from many starts. The state at the first time is a parameter, because a
record may begin soon after the machine started.

Intervals follow from the covariance of least squares by Student's t, in ln D_c for D_c, for white noise. If
neighboring residuals correlate by rho > 2/sqrt(n), more than white noise, the n values count as n (1 -
rho)/(1 + rho), as in `asperity.fits.compare`: a rough measure. The jackknife over the records of several
surfaces under one protocol is better, as it assumes nothing about the residuals.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.base.words import has_unit
from asperity.errors import InputError
from asperity.fits.comparison import ROUNDING, independent
from asperity.fits.search import inverse_square, least_of
from asperity.friction.events import Event, Events, events_of, rows_of
from asperity.friction.laws import (
    STATE_LAWS,
    StateLaw,
    first_velocity,
    half_changes,
    log_state,
    log_velocity,
)
from asperity.friction.loading import STEP
from asperity.friction.parameters import MachineFit, RateAndStateFit, described
from asperity.friction.pulling import pulled_fit, stiffness_of
from asperity.friction.records import Record

_REACH = 10.0
"""Factor of the range of D_c: the smallest slip between two values over it, the whole slip times it."""

_EDGE = 1e-3
"""Distance from the ends of this range, in ln D_c, within which D_c is not determined."""

_START_REACH = 40.0
"""Largest magnitude of ln(V theta/D_c) at the first time."""

_STARTS = 10, (-3.0, 0.0, 3.0)
"""Starts of the search: number of D_c, and ln(V theta/D_c) at the first time."""

_POLISHED = 2
_DIFFERENCE = 1e-5
"""Step of the central differences in ln D_c and ln theta."""


def rate_and_state(
    record: Record,
    *,
    law: StateLaw = "aging",
    a: float | Literal["fitted"] | None = None,
    V_0: float | str | None = None,
    events: Events = "all",
    stiffness: float | str | None = None,
) -> RateAndStateFit:
    """Fit rate-and-state friction to a record, measured or simulated.

    Parameters
    ----------
    law
        Law of the state: ``"aging"`` or ``"slip"``.
    a
        The direct effect; or ``"fitted"``, which needs different velocities. By default that of the record (0
        for simulated contacts of constant shear strength), fitted if it has none.
    V_0
        Reference velocity (length/time; for a record in SI also ``"1 um/s"``), at which mu_0 is the steady
        friction; by default the first velocity of the record.
    events
        Parts to fit besides the run-in: ``"holds"`` (rests, and the slip after them until the velocity
        steps), ``"steps"`` of the velocity by 20 % or more, or ``"all"``. The state always follows the whole
        record.
    stiffness
        Stiffness of the machine, with its unit: ``"1.6e-3 / um"`` of the friction coefficient, or, if the
        record has the normal stress or force, ``"0.16 MPa/um"`` of the shear stress or ``"4 N/um"`` of the
        force. ``"fit"`` fits it; infinity takes the load point for the slip. By default it is fitted if the
        record has the velocity of the load point, and infinite if it has that of slip. With a finite
        stiffness the result is a `MachineFit`.

    Raises
    ------
    InputError
        There are no such events, too few values, or too similar velocities to fit a; the stiffness has no
        unit, or the slider sticks and slips with it.
    """
    advice = "asperity.friction.record_of(history), or asperity.friction.read_record(path)"
    record = checks.instance("record", record, Record, advice)
    k = stiffness_of(record, stiffness)
    if record.normal is not None and k == math.inf:
        expected = "a finite one, or 'fit', as the normal stress changes, and slip with it"
        got, cure = checks.shown(stiffness), {"stiffness": "fit"}
        raise InputError("stiffness", expected=expected, got=got, cure=cure)
    checks.choice("law", law, STATE_LAWS)
    reference = None if V_0 is None else _velocity(V_0, si=record.si)
    direct = record.a if a is None else a
    direct = None if direct == "fitted" else direct
    if k != math.inf:
        return pulled_fit(record, law, direct, reference, events, k)
    return _Problem.of(record, law, direct, reference, events).solution()


def fit_events(
    record: Record, *, law: StateLaw = "aging", stiffness: float | str | None = None
) -> Mapping[Event, MachineFit | None]:
    """Fit the events of a record of a machine, each by itself; arguments are those of `rate_and_state`.

    The fit of an event is None if it has too few rows, or no law fits.
    """
    fits: dict[Event, MachineFit | None] = {}
    for event in events_of(record):
        try:
            fit = rate_and_state(record.between(event.start, event.stop), law=law, stiffness=stiffness)
            fits[event] = fit if isinstance(fit, MachineFit) else None
        except InputError as error:
            if error.name == "stiffness":
                raise
            fits[event] = None
    return fits


def _velocity(V_0: float | str, *, si: bool) -> float:
    if has_unit(V_0) and not si:
        expected, advice = "a plain number, as the record has no units", "a header with units: time_s"
        raise InputError("V_0", expected=expected, got=repr(V_0), advice=advice)
    return float(units.number("V_0", V_0, "m/s", above=0.0))


@dataclass(frozen=True, eq=False)
class _Problem:
    """A fit to the entries `used` of a record. The direct effect `given_a` is None if it is fitted."""

    record: Record
    law: StateLaw
    V_0: float
    used: NDArray[np.bool_]
    given_a: float | None

    @classmethod
    def of(cls, record: Record, law: StateLaw, a: object, V_0: float | None, events: str) -> _Problem:
        """State the problem; an `a` that is None is fitted."""
        used = rows_of(record, events)
        reference = first_velocity(record.velocity) if V_0 is None else V_0
        # If V changes by more, the mean over an interval does not determine the velocity at its end.
        used &= np.abs(half_changes(record.time, record.velocity)) < math.log(STEP)
        if not record.strength_at_rest:
            used &= record.velocity > 0
        velocities = record.velocity[used & (record.velocity > 0)]
        differ = velocities.size > 0 and velocities.max() > STEP * velocities.min()
        if a is None and not differ:
            expected = "a number, as all slip is at one velocity, which does not show the direct effect"
            cure, advice = {"a": 0.01}, "another of the rock"
            raise InputError("a", expected=expected, got="none", cure=cure, advice=advice)
        problem = cls(record, law, reference, used, None if a is None else checks.number("a", a))
        if used.sum() < problem.count + 3:
            expected = f"at least {problem.count + 3} values for {problem.count} parameters"
            raise InputError("record", expected=expected, got=int(used.sum()))
        return problem

    @property
    def count(self) -> int:
        """Number of fitted parameters: mu_0, b, D_c, the first state, and perhaps a."""
        return 4 + (self.given_a is None)

    @cached_property
    def values(self) -> Floats:
        """Friction less the direct effect, if this is given."""
        direct = (self.given_a or 0.0) * log_velocity(self.record.time, self.record.velocity, self.V_0)
        return (self.record.friction - direct)[self.used]

    def columns(self, shape: Floats) -> Floats:
        """Factors of mu_0, b and a; `shape` is ln D_c and ln(V theta/D_c) at the first time."""
        record = self.record
        state = log_state(self.law, record.time, record.velocity, math.exp(shape[0]), self.log_start(shape))
        columns = [np.ones(self.values.size), (state + math.log(self.V_0) - shape[0])[self.used]]
        if self.given_a is None:
            columns.append(log_velocity(record.time, record.velocity, self.V_0)[self.used])
        return np.column_stack(columns)

    def log_start(self, shape: Floats) -> float:
        return float(shape[0] + shape[1] - math.log(first_velocity(self.record.velocity)))

    def linear(self, shape: Floats) -> tuple[Floats, Floats]:
        """The best mu_0, b and a, and the residuals."""
        columns, values = self.columns(shape), self.values
        solution = np.linalg.lstsq(columns, values)[0]
        return np.asarray(solution, dtype=np.float64), np.asarray(values - columns @ solution)

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Least and largest ln D_c."""
        whole = float(self.record.displacement[-1])
        return math.log(self.record.finest_slip / _REACH), math.log(whole * _REACH)

    def searched(self) -> Floats:
        """Ln D_c and ln(V theta/D_c) at the first time, of the least squares."""
        low, high = self.reach
        bounds = [low, -_START_REACH], [high, _START_REACH]

        def misfit(shape: Floats) -> Floats:
            return self.linear(shape)[1] / self._unit

        many, states = _STARTS
        starts = [np.array([D_c, state]) for D_c in np.linspace(low, high, many) for state in states]
        starts.sort(key=lambda shape: float(np.sum(misfit(shape) ** 2)))
        how: dict[str, Any] = {"bounds": bounds, "ftol": 1e-12, "xtol": 1e-9, "gtol": 1e-12}
        best = least_of(starts[:_POLISHED], lambda start: least_squares(misfit, start, **how))
        return np.asarray(best.x)

    @cached_property
    def _unit(self) -> float:
        """Spread of the values, the unit of residuals in the search."""
        return max(float(np.std(self.values)), ROUNDING * float(self.record.friction.max()))

    def solution(self) -> RateAndStateFit:
        shape = self.searched()
        (mu_0, b, *rest), residual = self.linear(shape)
        a = rest[0] if self.given_a is None else self.given_a
        slopes = []
        for h in _DIFFERENCE * np.eye(2):
            ahead, behind = self.columns(shape + h)[:, 1], self.columns(shape - h)[:, 1]
            slopes.append(b * (ahead - behind) / (2 * _DIFFERENCE))
        jacobian = np.column_stack([self.columns(shape), *slopes])
        n, squares, friction = residual.size, float(residual @ residual), self.record.friction[self.used]
        rho, worth = independent(residual)
        effective = n * worth
        covariance = squares / (n - self.count) * n / effective * inverse_square(jacobian)
        D_c = math.exp(shape[0])
        values = {"mu_0": float(mu_0), "b": float(b)} | ({"a": float(a)} if rest else {}) | {"D_c": D_c}
        scale = np.append(np.ones(len(values) - 1), D_c)
        errors = covariance[:-1, :-1] * np.outer(scale, scale)
        return RateAndStateFit(
            **described(residual, friction, effective, self.count, values | {"a": float(a)}, errors),
            law=self.law,
            V_0=self.V_0,
            first_state=math.exp(self.log_start(shape)),
            autocorrelation=rho,
            used=self.used,
            at_edge=min(abs(shape[0] - end) for end in self.reach) < _EDGE,
        )
