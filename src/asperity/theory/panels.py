r"""Means over the Brillouin zone of functions of the wave vector: any dispersion, any phase factor.

`modes` integrates over lam, by the density of states of the lattice. For another dispersion this density is
unknown, and a displacement beside the load depends on the direction of q. Then this module integrates over q
itself. Functions that are even in each component need the quarter 0 <= q <= pi of the zone. It is cut into
rings toward q = 0, each half the size of the one before, because the integrand changes on ever smaller scales
there. A ring has three squares (on the line: one interval), each with a tensor product of Gauss-Legendre
rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import roots_legendre

from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.theory.modes import zone_nodes

#: ``"lattice"``, ``"continuum"`` or a function lam(qx, qy) (on the line, lam(q)) of arrays of one shape.
Dispersion = Literal["lattice", "continuum"] | Callable[..., ArrayLike]

# Nodes along the side of a square whose distance from q = 0 is at least its side; measured: 1e-15.
_NODES = 20
# Rings end where lam has fallen to this part of the scale on which the integrand becomes constant.
_LOG_REST = math.log(1e-6)
# q = 1e-150: beyond it, q^2 vanishes.
_MOST_RINGS = 500


@dataclass(frozen=True, eq=False)
class Panel:
    """A square (an interval) of the zone: nodes and weights along each axis, lam at their tensor product.

    Products of the weights of all panels sum to 1.
    """

    q: tuple[Floats, ...]
    weight: tuple[Floats, ...]
    lam: Floats

    @classmethod
    def of(cls, law: Callable[..., ArrayLike], axes: tuple[tuple[Floats, Floats], ...]) -> Panel:
        """The panel of these axes, each of nodes and weights."""
        q, weight = zip(*axes, strict=True)
        return cls(q, weight, _evaluate(law, np.meshgrid(*q, indexing="ij")))


def mean_nodes(dispersion: Dispersion, dimension: int, log_scale: float) -> tuple[Floats, Floats]:
    """Values of lam and weights, shape (n,) each: ``sum(weight * f(lam))`` is the mean of f over the zone.

    For f that is that of lam = 0 below exp(log_scale), in 1 (line) or 2 dimensions (square zone).
    `InputError` for another dispersion than ``"lattice"`` (that of `modes`), ``"continuum"`` (lam = q^2)
    or a function, and for one that does not return finite numbers above 0 of the shape of its arguments,
    is not even in each component or does not vanish at q = 0.
    """
    if dispersion == "lattice":
        return zone_nodes(dimension, log_scale)
    law = continuum if dispersion == "continuum" else dispersion
    if not callable(law):
        raise InputError(
            "dispersion", expected='"lattice", "continuum" or a function of q', got=repr(dispersion)
        )
    panels = graded_panels(law, dimension, log_scale)
    lam = [panel.lam.ravel() for panel in panels]
    weight = [reduce(np.multiply.outer, panel.weight).ravel() for panel in panels]
    return np.concatenate(lam), np.concatenate(weight)


def lattice(*q: Floats) -> Floats:
    """Eigenvalue of minus the lattice's Laplacian, the sum of 2 - 2 cos q; keeps its digits at small q."""
    return np.asarray(sum(4 * np.sin(component / 2) ** 2 for component in q))


def continuum(*q: Floats) -> Floats:
    """Eigenvalue of minus the Laplacian of a continuum, q^2."""
    return np.asarray(sum(component**2 for component in q))


def graded_panels(
    law: Callable[..., ArrayLike], dimension: int, log_scale: float, farthest: int = 0
) -> list[Panel]:
    """Panels of the quarter zone, for integrands f(lam) cos(n qx) cos(m qy) with n, m up to `farthest`.

    Arguments and errors are otherwise those of `mean_nodes`.
    """
    panels: list[Panel] = []
    side = math.pi
    for _ in range(_MOST_RINGS):
        side /= 2
        low, high = _axis(0.0, side, farthest), _axis(side, 2 * side, farthest)
        ring = [(high,)] if dimension == 1 else [(high, low), (low, high), (high, high)]
        panels += [Panel.of(law, axes) for axes in ring]
        if len(panels) == len(ring):
            _check_even(law, panels[0])
        if math.log(max(float(panel.lam.max()) for panel in panels[-len(ring) :])) < log_scale + _LOG_REST:
            return [*panels, Panel.of(law, (low,) * dimension)]
    expected, got = "a function that vanishes at q = 0", f"{panels[-1].lam.max():.3g} near it"
    raise InputError("dispersion", expected=expected, got=got)


def _axis(start: float, stop: float, farthest: int) -> tuple[Floats, Floats]:
    """Nodes on an interval of q and their weights in a mean over 0 <= q <= pi."""
    half = (stop - start) / 2
    # A rule of n nodes is exact to degree 2 n - 1, and a wave of phase k over (-1, 1) looks like degree k.
    x, weight = _rule(_NODES + math.ceil(2 * farthest * half / 3))
    return start + half * (1 + x), half / math.pi * weight


_rule = lru_cache(maxsize=64)(roots_legendre)


def _evaluate(law: Callable[..., ArrayLike], q: tuple[Floats, ...]) -> Floats:
    lam = np.asarray(law(*q), dtype=np.float64)
    if lam.shape != q[0].shape:
        raise InputError("dispersion", expected=f"values of shape {q[0].shape}", got=f"shape {lam.shape}")
    wrong = ~(np.isfinite(lam) & (lam > 0))
    if wrong.any():
        at = ", ".join(f"{component[wrong][0]:.3g}" for component in q)
        raise InputError(
            "dispersion",
            expected="finite numbers above 0 for q other than 0",
            got=f"{lam[wrong][0]:.3g} at q = {at}",
            advice="a form that keeps its digits at small q: 4 * np.sin(q / 2) ** 2 for 2 - 2 * np.cos(q)",
        )
    return lam


def _check_even(law: Callable[..., ArrayLike], panel: Panel) -> None:
    for axis in range(len(panel.q)):
        mirrored = [-q if i == axis else q for i, q in enumerate(panel.q)]
        lam = _evaluate(law, np.meshgrid(*mirrored, indexing="ij"))
        if not np.allclose(lam, panel.lam, rtol=1e-9, atol=0):
            raise InputError("dispersion", expected="a function even in each component", got="another")
