"""Relaxation laws and data as sums of exponentials with positive weights, by least squares."""

from __future__ import annotations

import numpy as np
import scipy

from asperity.base.checks import Floats
from asperity.errors import ConvergenceError

_NOTHING = 1e-10  # what adds no more than this part of any value is a rounding error


def positive_weights(columns: Floats, values: Floats, scale: Floats) -> Floats:
    """Weights w >= 0, shape (m,), that make the sum of squares of (columns @ w - values) / scale least.

    The columns have the shape (n, m), values and scale (n,).
    """
    matrix = columns / scale[:, None]
    # Columns of equal norm: the answer does not depend on their units.
    norms = np.linalg.norm(matrix, axis=0)
    norms[norms == 0] = 1
    try:
        weights, _ = scipy.optimize.nnls(matrix / norms, values / scale, maxiter=100 * matrix.shape[1])
    except RuntimeError as error:
        raise ConvergenceError("the least squares for the branches did not converge") from error
    weights = weights / norms
    weights[(matrix * weights).max(axis=0) < _NOTHING] = 0
    return np.asarray(weights)


def log_times(first: float, last: float, per_decade: float, through: float) -> Floats:
    """Times from `first` to `last` or a step less, so many per decade, one of them at `through`."""
    steps = per_decade * np.log10(np.array([first, last]) / through)
    return np.asarray(through * 10 ** (np.arange(np.ceil(steps[0] - 1e-9), steps[1] + 1e-9) / per_decade))
