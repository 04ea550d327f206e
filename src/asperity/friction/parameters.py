"""Fitted parameters of rate-and-state friction."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits import Estimate, FitResult
from asperity.fits.result import parameters_of, quality, rms
from asperity.friction.laws import RateAndState, StateLaw
from asperity.friction.records import Record

MISSES = 2.5
"""Misfit over the noise from which a law does not describe a record: above those of published fits."""


def described(
    residual: Floats, friction: Floats, effective: float, count: int, values: dict[str, float], errors: Floats
) -> dict[str, Any]:
    """Fields of a fit: its quality with `count` parameters, and its numbers with their standard errors.

    `errors` is the covariance of the first of `values`; the others have no errors.
    """
    free = dict(zip(values, np.eye(len(values))[:, : len(errors)], strict=True))
    numbers = values | {"a_minus_b": values["a"] - values["b"]}
    rows = free | {"a_minus_b": free["a"] - free["b"]}
    spread = {f"{name}_stderr": math.sqrt(max(0.0, float(row @ errors @ row))) for name, row in rows.items()}
    return {
        **quality(residual, friction, None, count),
        "degrees_of_freedom": max(1.0, effective - count),
        "rms_residual": rms(residual / friction),
        "effective_points": effective,
        "residual": residual,
        **numbers,
        **spread,
    }


@dataclass(frozen=True, kw_only=True, repr=False)
class RateAndStateFit(FitResult):
    """Parameters of rate-and-state friction.

    Attributes
    ----------
    law, V_0
        Law of the state; reference velocity.
    mu_0, a, b, D_c, alpha
        The parameters, each with a standard error in ``..._stderr``, which is 0 for an a that was not fitted,
        and for the alpha of a constant normal stress. The interval of D_c is symmetric in its logarithm.
    a_minus_b
        Change of steady friction per e-fold of the velocity, with its standard error; below 0 sliding can be
        unstable.
    first_state
        State theta at the first time of the record.
    autocorrelation, effective_points
        Correlation rho of neighboring residuals; number of independent values, for standard errors.
    residual, used
        Friction less law at the fitted values, shape (points,); mask of these in the record, shape (n,).
    at_edge
        Whether the search for D_c ended at the end of its range.
    """

    law: StateLaw
    V_0: float
    mu_0: float
    mu_0_stderr: float
    a: float
    a_stderr: float
    b: float
    b_stderr: float
    D_c: float
    D_c_stderr: float
    a_minus_b: float
    a_minus_b_stderr: float
    first_state: float
    autocorrelation: float
    effective_points: float
    residual: Floats
    used: NDArray[np.bool_]
    at_edge: bool
    alpha: float = 0.0
    alpha_stderr: float = 0.0

    scales: ClassVar[frozenset[str]] = frozenset({"D_c"})

    @property
    def estimates(self) -> dict[str, Estimate]:
        """Estimates by name, with standard errors and 95 % intervals; alpha only if it was fitted."""
        estimates = {}
        for name in parameters_of(self):
            if name == "alpha" and not self.alpha_stderr:
                continue
            value, stderr, low, high = np.array([*self.known(name), *self.interval(name)])
            estimates[name] = Estimate(value, stderr, low, high, 1)
        return estimates

    @property
    def at_least(self) -> bool:
        """Whether its intervals hold the truth in 95 % of cases or more.

        The times at which a normal stress turns are known to a row. Intervals are for errors that are
        independent for each; the true ones are smaller, as rows within a ramp tell some of them.
        """
        return bool(self.alpha_stderr)

    @property
    def determined(self) -> bool:
        """Whether the record determines D_c to a factor of about three."""
        return not self.at_edge and self.D_c_stderr < self.D_c

    @property
    def stiffness_from(self) -> str:
        """Whether the stiffness of the machine was given or fitted."""
        return "fitted" if getattr(self, "stiffness_stderr", 0.0) > 0 else "given"

    @property
    def parameters(self) -> RateAndState:
        """The law with these parameters."""
        names = [item.name for item in fields(RateAndState)]
        return RateAndState(**{name: getattr(self, name) for name in names})

    def predict(self, record: Record) -> Floats:
        """Friction coefficient at each time of the record, from the state at its first time, shape (n,)."""
        return self.parameters.friction(record.time, record.velocity, self.first_state)


@dataclass(frozen=True, kw_only=True, repr=False)
class MachineFit(RateAndStateFit):
    """Parameters of rate-and-state friction of a slider on the spring of a machine.

    Attributes
    ----------
    stiffness
        k, change of the friction coefficient per displacement of the load point (1/length), with its standard
        error, 0 if k was not fitted. Its interval is symmetric in its logarithm.
    stiffness_at_edge
        Whether the search for k ended at the end of its range: the machine is stiffer than the record shows.
    drift
        Change of friction per displacement of the load point (1/length) besides the law.
    kinks
        Fitted times at which the velocity of the load point changes.
    released
        Kinks whose fitted time, by friction, is far from that of the measured load point.
    noise
        Scatter of friction about a line before the first kink, at least 0.1 % of the range of friction.
    tried
        D_c of the starts of the search, in order.
    friction, slip, state
        The course of the slider: friction coefficient, slip since the first time, theta; shape (n,), NaN
        before steady sliding.
    """

    stiffness: float
    stiffness_stderr: float
    stiffness_at_edge: bool
    drift: float
    drift_stderr: float
    kinks: Floats
    released: tuple[int, ...]
    noise: float
    tried: tuple[float, ...]
    friction: Floats
    slip: Floats
    state: Floats

    scales: ClassVar[frozenset[str]] = frozenset({"D_c", "stiffness"})

    @property
    def misfit(self) -> float:
        """Standard deviation of the residuals, over the noise."""
        return float(np.std(self.residual)) / self.noise

    @property
    def determined(self) -> bool:
        """Whether the law describes the record to its noise, and this determines D_c to a factor of three."""
        return super().determined and self.misfit < MISSES

    def predict(self, record: Record) -> Floats:
        """Friction coefficient at each time of the fitted record, shape (n,)."""
        if record.time.size != self.friction.size:
            expected = f"the fitted record, of {self.friction.size} rows"
            raise InputError("record", expected=expected, got=f"{record.time.size} rows")
        return self.friction
