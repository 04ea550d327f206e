"""The search for the least squares of a machine."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asperity.base.checks import Floats
from asperity.fits.search import least_of
from asperity.friction.machine import Machine
from asperity.friction.slider import RunsAwayError

_STARTS = {"a": (0.03, 0.1, 0.3), "b": (0.7, 1.3), "D_c": (1e-3, 0.01, 0.03, 0.1, 0.3, 1.0), "k": (0.7, 2.0)}
_STARTS |= {"alpha": (0.1, 0.4)}
"""Starts: a over the range of friction, b/a, D_c over the median slide, k over the observed slope, alpha."""

_POLISHED, _FIRST, _FREE, _LAST = 3, 8, 16, 60
"""Number of starts to follow; evaluations for each, for the best with free kinks, and in the last search."""

_BEFORE = 5
"""Rows before a kink, whose median friction is that at the kink."""

_GREW = 0.01
"""Growth of the normal stress, over its mean, that stops a slider."""

_ROUNDS = 3
"""Searches, each with the noise after the one before."""

_SETTLED = 0.01
"""Relative change of the noise that ends the rounds."""

_RELEASED = 4.0
"""Standard errors beyond which a measured kink is not fitted."""


def solve(machine: Machine) -> tuple[Machine, Floats, tuple[int, ...], tuple[float, ...]]:
    """Search from several starts; `RunsAwayError` if none slides stably.

    Returns the machine with its noise, the point of the least squares, released kinks, and D_c of the starts.
    """
    count, every = len(machine.names), _starts(machine)
    starts = every[:_POLISHED]
    # First with measured kinks, as friction of a stiff machine jumps there from row to row; then with free
    # kinks, as measured ones may be wrong.
    held = least_of(starts, lambda start: _polished(machine, start, _FIRST, count))
    points = [*([] if held is None else [held.x]), *starts[:1]]
    best = least_of(points, lambda point: _polished(machine, point, _FREE, point.size))
    if best is None:
        raise RunsAwayError
    point, released = best.x, set[int]()
    for _ in range(_ROUNDS):
        off = np.abs(point[count:] - machine.drive.kinks) / machine.drive.spread > _RELEASED
        released |= set(np.flatnonzero(machine.measured & off).tolist())
        last = machine
        try:
            machine = machine.straightened(point).judged(point)[0]
        except RunsAwayError:  # a law that does not fit, at the limit of stability
            break
        machine = replace(machine, measured=machine.measured & ~off)
        best = _polished(machine, point, _LAST, point.size)
        point = point if best is None else best.x
        if np.allclose(last.noise, machine.noise, rtol=_SETTLED) and not off.any():
            break
    return machine, point, tuple(sorted(released)), tuple(sorted(machine.shape(start).D_c for start in every))


def _starts(machine: Machine) -> list[Floats]:
    """Points to search from: that of the least squares for each D_c, the best first."""
    size, rooms = float(np.ptp(machine.friction)), np.diff(machine.drive.edges(machine.time))
    slides = rooms * machine.drive.velocity
    scales = {"a": size, "D_c": float(np.median(slides[slides > 0])), "k": _stiffness_seen(machine)}
    low, high = machine.bounds
    starts: list[tuple[float, int, Floats]] = []
    for parts in product(*(_STARTS[name] for name in machine.names)):
        chosen = dict(zip(machine.names, parts, strict=True))
        numbers = {name: math.log(scales[name] * part) for name, part in chosen.items() if name in scales}
        numbers |= {"alpha": chosen.get("alpha", 0.0)}
        a = math.exp(numbers["a"]) if machine.a is None else machine.a or size
        numbers["b"] = chosen["b"] * a
        point = np.concatenate([[numbers[name] for name in machine.names], machine.drive.kinks])
        cost = float(np.sum(machine.residual(np.clip(point, low, high)) ** 2))
        if math.isfinite(cost):
            starts.append((cost, len(starts), point))
    best: dict[float, Floats] = {}
    for _, _, point in sorted(starts):
        best.setdefault(float(point[machine.names.index("D_c")]), point)
    return list(best.values())


def _stiffness_seen(machine: Machine) -> float:
    """Slope of friction against the load point, to half of its change, where this speeds up or else slows.

    Where a normal stress stops growing, the slider has stopped, as if the load point sped up from rest.
    """
    slopes: dict[bool, list[float]] = {True: [], False: []}
    drive, normal = machine.drive, machine.normal
    friction, edges = machine.friction * normal.at(machine.time), normal.edges(drive.edges(machine.time))
    velocity = np.where(np.diff(normal.at(edges)) > _GREW, 0.0, drive.along(edges))
    for n, change in enumerate(np.diff(velocity).tolist()):
        rows = (machine.time >= edges[n + 1]) & (machine.time <= edges[n + 2])
        if change and rows.sum() > 3:
            first, row = int(np.argmax(rows)), float(np.diff(machine.time[rows]).mean())
            before = float(np.median(friction[max(0, first - _BEFORE) : first + 1]))
            rise = (friction[rows] - before) * math.copysign(1.0, change)
            at = int(np.argmax(rise >= rise.max() / 2))
            lapse = max(machine.time[rows][at] - edges[n + 1], row / 2)
            slopes[change > 0].append(rise[at] / abs(change) / lapse)
    least = 1e-3 * float(np.ptp(machine.friction)) / float(drive.place(machine.time)[-1])
    return max(least, float(np.median(slopes[True] or slopes[False] or [least])))


def _polished(machine: Machine, start: Floats, evaluations: int, many: int) -> Any:
    """The minimum from a start, over its first `many` numbers; None in stick-slip."""
    low, high = machine.bounds
    margin = 1e-9 * (high - low)
    start = np.clip(start, low + margin, high - margin)

    def residual(part: Floats) -> Floats:
        return machine.residual(np.concatenate([part, start[many:]]))

    def jacobian(part: Floats) -> Floats:
        return machine.slopes(np.concatenate([part, start[many:]]), many)[2:]

    if not np.isfinite(residual(start[:many])).all():
        return None
    try:
        minimum = least_squares(
            residual,
            start[:many],
            jac=jacobian,
            bounds=(low[:many], high[:many]),
            x_scale="jac",
            ftol=1e-9,
            xtol=1e-8,
            gtol=1e-12,
            max_nfev=evaluations,
        )
    except RunsAwayError:
        return None
    minimum.x = np.concatenate([minimum.x, start[many:]])
    return minimum
