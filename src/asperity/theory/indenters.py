r"""An indenter pressed into a viscoelastic half-space and withdrawn: force from depth.

With the contact modulus E*(t), the depth d(t) and the force F = c E* d^p of the elastic half-space,

    approach, hold   F(t) = c integral from 0 to t of E*(t - s) d(d^p)/ds ds
    retraction       F(t) = c integral from 0 to t1 of E*(t - s) d(d^p)/ds ds,
                     integral from t1 to t of E*(t - s) (dd/ds) ds = 0

    ball of radius R               c = 4 sqrt(R) / 3,         p = 3/2
    cone of half-angle alpha       c = 2 tan(alpha) / pi,     p = 2
    flat punch of radius R         c = 2 R,                   p = 1

The contact at t is that of the approach at t1(t). Nothing sticks.

References
----------
E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020 (approach, hold);
T. C. T. Ting, J. Appl. Mech. 33, 845 (1966), DOI 10.1115/1.3625192 (retraction);
I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965), DOI 10.1016/0020-7225(65)90019-4 (c and p).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.units import number
from asperity.errors import InputError

Shape = Literal["ball", "cone", "punch"]
SHAPES = get_args(Shape)

_NODES, _FEWEST = 24, 8
_MEMORY = 40.0
"""Relaxation times after which exp(-t/tau) is below the rounding."""
_NEWTON = 8
_REENTRY = 0.02
"""Largest rise of the depth during retraction, over the largest depth: larger ones are a second approach."""


class Relaxing(Protocol):
    """A modulus with its branches, such as `asperity.relaxation.PronySeries`."""

    @property
    def modulus(self) -> float:
        """Instantaneous contact modulus E*."""

    @property
    def permanent(self) -> float:
        """Share that does not relax."""

    @property
    def branches(self) -> Sequence[tuple[float, float]]:
        """Shares and relaxation times."""


@dataclass(frozen=True)
class Tip:
    """An indenter: its elastic force is ``factor`` E* depth^``exponent``."""

    factor: float
    exponent: float


def tip_of(tip: Shape, radius: float | str | None, angle: float | str | None = None) -> Tip:
    """Make a tip from its shape, radius (m) and half-angle (degrees); `InputError` without its size."""
    checks.choice("tip", tip, SHAPES)
    size, other = ("angle", radius) if tip == "cone" else ("radius", angle)
    given = angle if tip == "cone" else radius
    if given is None or other is not None:
        wanted = "a half-angle in degrees, and no radius" if tip == "cone" else "a radius, and no angle"
        raise InputError(size, expected=f"{wanted}, for a {tip}", got="none" if given is None else "both")
    if tip == "cone":
        alpha = math.radians(float(number("angle", given, "deg", above=0, below=90)))
        return Tip(2 * math.tan(alpha) / math.pi, 2.0)
    length = float(number("radius", given, "m", above=0))
    return Tip(4 * math.sqrt(length) / 3, 1.5) if tip == "ball" else Tip(2 * length, 1.0)


def ting(
    time: ArrayLike,
    depth: ArrayLike,
    series: Relaxing,
    radius: float | str | None = None,
    *,
    tip: Shape = "ball",
    angle: float | str | None = None,
    retraction: float | None = None,
) -> Floats:
    """Force on an indenter from its depth: approach, hold and retraction of a viscoelastic half-space.

    The depth is taken as linear between the times; the integrals are exact then, to about 1e-10.

    Parameters
    ----------
    time
        Times that do not fall, s, shape (n,).
    depth
        Depths below the undeformed surface, m, shape (n,); below 0 before the contact. The first one is
        reached at once.
    series
        Contact modulus E*(t), Pa: a `PronySeries`.
    radius, tip, angle
        Shape of the indenter: a ``"ball"`` or a flat ``"punch"`` of this radius, m; a ``"cone"`` of this
        half-angle, degrees.
    retraction
        Time at which retraction begins; by default the last one of the largest depth. Before it, small falls
        of the depth (noise) are taken as elastic.

    Returns
    -------
    Forces, N, shape (n,); 0 without contact.

    Raises
    ------
    InputError
        Shapes differ; times fall; the tip has no size; the depth rises again after the retraction has begun.

    References
    ----------
    See `asperity.theory.indenters`.
    """
    t, d = checks.history(time=time, depth=depth)
    last = _last_approach(t, d, retraction)
    shape = tip_of(tip, radius, angle)
    times = np.array([time for _, time in series.branches])
    shares = np.array([series.permanent, *(share for share, _ in series.branches)])
    force = forces(t, d[None], shares[None], times[None], shape.exponent, last)
    return np.asarray(shape.factor * series.modulus * force[0])


def _last_approach(t: Floats, d: Floats, retraction: float | None) -> int:
    """Place of the last time before the retraction; `InputError` for a second approach."""
    if retraction is None:
        last = int(t.size - 1 - np.argmax(d[::-1]))
    else:
        last = max(int(np.searchsorted(t, retraction, side="right")) - 1, 0)
    after = d[last:]
    rise = after - np.minimum.accumulate(after)
    if d.max() > 0 and ((rise > _REENTRY * d.max()) & (after > 0)).any():
        at = t[last + int(np.argmax(rise))]
        raise InputError("depth", expected="one approach and one retraction", got=f"a rise up to {at:.6g} s")
    return last


def forces(t: Floats, d: Floats, shares: Floats, times: Floats, exponent: float, last: int) -> Floats:
    """Force over factor and modulus, shape (m, n), of m solids at once; nothing is checked.

    Depths have shape (m, n) or (1, n), relaxation times (m, k), and shares (m, k + 1), the permanent one
    first. The retraction begins after the place `last`.
    """
    t = np.concatenate([t[:1], t])
    d = np.concatenate([np.minimum(d[:, :1], 0.0), d], axis=1)
    last += 1
    memory = np.concatenate([np.full((len(times), 1), math.inf), times], axis=1)[:, None]
    step = np.diff(t)[:, None] / memory
    decay = np.exp(-step)
    gained = _gain(d[:, :last], d[:, 1 : last + 1], step[:, :last], exponent, np.ones(last))
    pressed = _accumulated(decay[:, :last], gained)  # integral of exp(-(t - s)/tau) d(d^p)
    force = (pressed @ shares[..., None])[..., 0]
    if t.size > last + 1:
        moved = _accumulated(decay, np.diff(d)[..., None] * _mean_decay(step))  # and of dd
        withdrawn = _withdrawn(t, d, shares, memory, exponent, last, pressed, moved)
        force = np.concatenate([force, withdrawn], axis=1)
    return np.maximum(force[:, 1:], 0.0)


def _mean_decay(x: Floats) -> Floats:
    """Mean of exp(-y) over y from 0 to x."""
    return np.where(x > 1e-8, -np.expm1(-x) / np.maximum(x, 1e-8), 1 - x / 2)


def _gain(begin: Floats, end: Floats, step: Floats, exponent: float, part: Floats) -> Floats:
    """Integral of exp(-(s1 - s)/tau) d(d^p) over parts of steps, up to s1: shape (m, n, k + 1).

    The steps are over relaxation times. In sqrt(d) the integrand is smooth at the first contact. Nodes stand
    where the memory reaches.
    """
    few = _FEWEST + int(np.max(step, initial=0.0)) if np.max(step, initial=0.0) < _NODES else _NODES
    node, weight = np.polynomial.legendre.leggauss(min(few, _NODES))
    change = np.where(end == begin, 1.0, end - begin)[..., None]
    stop = np.maximum(begin + part * (end - begin), 0.0)[..., None]
    back = np.minimum(part[..., None], _MEMORY / np.maximum(step, 1e-300))
    low = np.sqrt(np.maximum(begin[..., None] + (part[..., None] - back) * (end - begin)[..., None], 0.0))
    half = (np.sqrt(stop) - low) / 2
    root = low[..., None] + half[..., None] * (1 + node)
    before = (stop[..., None] - root**2) * (step / change)[..., None]
    return np.asarray((np.exp(-before) * root ** (2 * exponent - 1)) @ weight * half * 2 * exponent)


def _accumulated(decay: Floats, gained: Floats) -> Floats:
    """Solve x[j + 1] = decay[j] x[j] + gained[j], x[0] = 0, in log2(n) passes: shape (m, n + 1, k + 1)."""
    shape = np.broadcast_shapes(decay.shape, gained.shape)
    factor, value, ahead = np.broadcast_to(decay, shape).copy(), np.broadcast_to(gained, shape).copy(), 1
    while ahead < shape[1]:
        value[:, ahead:] += factor[:, ahead:] * value[:, :-ahead]
        factor[:, ahead:] = factor[:, ahead:] * factor[:, :-ahead]
        ahead *= 2
    return np.concatenate([np.zeros_like(value[:, :1]), value], axis=1)


def _withdrawn(
    t: Floats,
    d: Floats,
    shares: Floats,
    memory: Floats,
    exponent: float,
    last: int,
    pressed: Floats,
    moved: Floats,
) -> Floats:
    """Force during the retraction, by the time t1 of the approach with the same contact."""
    after = t[last + 1 :]

    def at(values: Floats, place: NDArray[np.intp]) -> Floats:
        """Values of the knots, shape (m or 1, n, ...), at places of shape (m, after)."""
        return np.asarray(values[np.arange(len(values))[:, None] if len(values) > 1 else 0, place])

    def total(parts: Floats) -> Floats:
        return np.asarray((parts @ shares[..., None])[..., 0])

    def excess(place: NDArray[np.intp]) -> Floats:
        """Integral of E* dd from a knot to each time, over the modulus."""
        kept = np.exp(-(after - t[place])[..., None] / memory)
        return total(moved[:, last + 1 :] - kept * at(moved, place))

    low = np.zeros((len(moved), after.size), np.intp)
    high = np.full(low.shape, last)
    for _ in range(last.bit_length()):
        middle = (low + high) // 2
        above = excess(middle) > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    low = np.minimum(low, last - 1)
    high = low + 1
    begin, rise, step = at(d, low), at(d, high) - at(d, low), (t[high] - t[low])[..., None] / memory
    missing, kept = excess(high), np.exp(-(after - t[high])[..., None] / memory)
    part = np.ones(low.shape)
    for _ in range(_NEWTON):  # concave in the part: from its end, Newton's steps approach from one side
        back = step * (1 - part)[..., None]
        value = missing + rise * (1 - part) * total(kept * _mean_decay(back))
        slope = rise * total(kept * np.exp(-back))
        part = np.clip(part + np.where(slope > 0, value / np.where(slope > 0, slope, 1.0), 0.0), 0.0, 1.0)
    reached = np.exp(-part[..., None] * step) * at(pressed, low)
    reached = reached + _gain(begin, begin + rise, step, exponent, part)
    elapsed = after - (t[low] + part * (t[high] - t[low]))
    return total(np.exp(-elapsed[..., None] / memory) * reached)
