"""The load point of a machine as straight segments of time, found in noisy data.

A segment is split if two lines fit much better than one, compared with the noise. Neighbors of nearly one
velocity are joined. If only slip was measured, the load point is slip + friction/k, with the k that needs the
fewest segments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from asperity.base.checks import Floats

STEP = 1.2
"""Least ratio of two velocities that is a step."""

SLOW = 0.01
"""Velocity over that of sliding below which the load point rests, or a slider is at hold."""

_GAIN = 60.0
"""Least decrease of the sum of squares by a kink, in variances of the noise."""

_LEAST = 4
"""Least number of rows of a segment."""

_MOST = 400
"""Largest number of segments."""

_EQUAL, _FEW, _PRECISE = 1e-6, 0.1, 0.005
"""Relative difference of equal velocities; largest share of changing rows of a slip without noise; largest
noise over the least slip between rows of a precise slip, which makes `a` 0.3 % too small."""

_SWEEPS = 2
_ROUNDING = 1e-8
_COMPLIANCES, _ROUNDS, _SETTLED = 6, 8, 1e-4
"""Number of compliances tried, corrections of each for its kinks, and relative change that ends these."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A load point with a constant velocity between kinks.

    Kinks are times with standard errors `spread`, shape (m,). Velocities are those before, between and after
    them, shape (m + 1,), 0 at rest, with standard errors `error`, or one for all.
    """

    kinks: Floats
    velocity: Floats
    spread: Floats
    error: Floats | float = 0.0

    def edges(self, time: Floats) -> Floats:
        """The first time, the kinks, and the last time."""
        return np.concatenate([time[:1], self.kinks, time[-1:]])

    def along(self, edges: Floats) -> Floats:
        """Velocity from each of some times to the next, among which are the kinks."""
        return np.asarray(self.velocity[np.searchsorted(self.kinks, (edges[1:] + edges[:-1]) / 2)])

    def place(self, time: Floats) -> Floats:
        """Displacement since the first time, shape (n,)."""
        edges = np.clip(self.edges(time), time[0], time[-1])
        places = np.concatenate([[0.0], np.cumsum(self.velocity * np.diff(edges))])
        return np.asarray(np.interp(time, edges, places))

    def between(self, start: float, stop: float) -> Drive:
        """Return the part with the kinks between two times."""
        inside = slice(np.searchsorted(self.kinks, start, "right"), np.searchsorted(self.kinks, stop))
        every = slice(inside.start, inside.stop + 1)
        error = np.broadcast_to(self.error, self.velocity.shape)[every]
        return Drive(self.kinks[inside], self.velocity[every], self.spread[inside], error)

    def per_row(self, time: Floats) -> Floats:
        """Velocity of the interval that ends at each time, not below 0, with kinks at rows; shape (n,)."""
        middles = (time[1:] + time[:-1]) / 2
        rows, onward = np.searchsorted(middles, self.kinks), np.maximum(self.velocity, 0.0)
        return np.asarray(onward[np.searchsorted(rows, np.arange(time.size))])


def drive_of(time: Floats, place: Floats) -> Drive:
    """Straight segments through a noisy load point; times rise, both of shape (n,)."""
    return _Pieces.found(time, place, variance(time, place)).joined().drive()


def drive_of_slip(time: Floats, slip: Floats, friction: Floats) -> tuple[Drive, bool]:
    """Segments of the load point, from slip and friction; whether slip is precise and shows no spring."""
    least = float(np.min(slips := np.diff(slip), where=slips != 0, initial=math.inf))
    if (straight := _without_noise(time, slip)) is not None:
        return straight, least > 0
    noises = variance(time, slip), variance(time, friction)
    most = float(np.ptp(slip)) / max(float(np.ptp(friction)), math.sqrt(noises[1]), 1e-12)

    def attempt(compliance: float) -> tuple[float, _Pieces]:
        noise = noises[0] + compliance**2 * noises[1]
        pieces = _Pieces.found(time, slip + compliance * friction, noise)
        if len(pieces.edges) > _MOST:
            return math.inf, pieces
        pieces = pieces.joined()
        return float(pieces.off @ pieces.off) / noise + 3 * len(pieces.edges) * math.log(time.size), pieces

    def best(pieces: _Pieces) -> float:
        """Compliance of the least squares over the noise, with the kinks of these segments."""
        off, of_friction = (replace(pieces, place=values).off for values in (slip, friction))
        A, B, C = float(off @ off), float(off @ of_friction), float(of_friction @ of_friction)
        # The root of the derivative of (A + 2 B c + C c^2)/(n_0 + n_1 c^2).
        half = (C * noises[0] - A * noises[1]) / 2
        root = math.hypot(half, B * math.sqrt(noises[0] * noises[1]))
        return max(0.0, -B * noises[0] / (half + root) if half + root > 0 else 0.0)

    trials = [(*attempt(0.0), 0.0)]
    for compliance in np.geomspace(1e-3, 0.3, _COMPLIANCES) * most:
        for _ in range(_ROUNDS):
            cost, pieces = attempt(compliance)
            trials.append((cost, pieces, compliance))
            last, compliance = compliance, best(pieces)
            if abs(compliance - last) < _SETTLED * last:
                break
    cost, pieces, compliance = min(trials, key=lambda trial: trial[0])
    if trials[0][0] < cost + _GAIN:
        _, pieces, compliance = trials[0]
    return pieces.drive(), compliance == 0 and math.sqrt(noises[0]) < _PRECISE * least


def _without_noise(time: Floats, place: Floats) -> Drive | None:
    """Segments of equal velocities, if the slip has no noise, as in a simulation; else None."""
    speeds = np.diff(place) / np.diff(time)
    turns = np.flatnonzero(np.abs(np.diff(speeds)) > _EQUAL * np.abs(speeds).max()) + 1
    if turns.size > _FEW * speeds.size:
        return None
    return Drive(time[turns], speeds[np.append(0, turns)], np.diff(time)[turns])


def variance(time: Floats, values: Floats) -> float:
    """Variance of the noise, from distances of values from the line through their neighbors."""
    if time.size < 3:
        return 0.0
    part = (time[1:-1] - time[:-2]) / np.maximum(time[2:] - time[:-2], 1e-300)
    off = values[1:-1] - (1 - part) * values[:-2] - part * values[2:]
    squares = off**2 / (1 + part**2 + (1 - part) ** 2)
    middle = float(np.median(squares)) / 0.455  # of a chi-squared variable of one degree
    return max(middle, (_ROUNDING * float(np.ptp(values))) ** 2)


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Segments of rows, each from one of `edges` to the next; the last edge is the number of rows."""

    time: Floats
    place: Floats
    noise: float
    edges: tuple[int, ...]

    @classmethod
    def found(cls, time: Floats, place: Floats, noise: float) -> _Pieces:
        edges, open_ = {0, time.size}, [(0, time.size)]
        while open_ and len(edges) <= _MOST:
            first, end = open_.pop()
            if at := _split(time[first:end], place[first:end], noise):
                edges.add(first + at)
                open_ += [(first, first + at), (first + at, end)]
        return cls(time, place, noise, tuple(sorted(edges)))

    def joined(self) -> _Pieces:
        """Join segments whose kink is insignificant, rests, and velocities that hardly differ."""
        edges = list(self.edges)
        lines = [self._line(*pair) for pair in pairwise(edges)]
        fastest = max(abs(line[1]) for line in lines)

        def worth(n: int) -> float:
            first, second = lines[n : n + 2]
            rests = max(abs(first[1]), abs(second[1])) < SLOW * fastest
            if rests or (first[1] * second[1] > 0 and 1 / STEP < first[1] / second[1] < STEP):
                return 0.0
            together = self._line(edges[n], edges[n + 2])[2]
            noise = max(self.noise, (first[2] + second[2]) / (edges[n + 2] - edges[n]))
            return (together - first[2] - second[2]) / noise

        kinks = [worth(n) for n in range(len(lines) - 1)]
        while kinks and min(kinks) < _GAIN:
            n = int(np.argmin(kinks))
            lines[n : n + 2] = [self._line(edges[n], edges[n + 2])]
            del edges[n + 1], kinks[n]
            for near in range(max(0, n - 1), min(n + 1, len(kinks))):
                kinks[near] = worth(near)
        for n in [*range(1, len(edges) - 1)] * _SWEEPS:  # move each edge between the final others
            part = slice(edges[n - 1], edges[n + 1])
            edges[n] = part.start + _split(self.time[part], self.place[part], 0.0, always=True)
        fewer = replace(self, edges=tuple(edges))._without_between()
        # Moved edges change the lines.
        return fewer if len(fewer.edges) == len(self.edges) else fewer.joined()

    def _without_between(self) -> _Pieces:
        """Without the first segment whose neighbors, with one kink, fit its rows as well."""
        for n in range(1, len(self.edges) - 2):
            first, *_, last = ends = self.edges[n - 1 : n + 3]
            at = first + _split(self.time[first:last], self.place[first:last], 0.0, always=True)
            three, two = (self._squares_of(edges) for edges in (ends, (first, at, last)))
            if two - three < _GAIN * max(self.noise, three / (last - first)):
                return replace(self, edges=(*self.edges[:n], at, *self.edges[n + 2 :]))
        return self

    def _squares_of(self, edges: tuple[int, ...]) -> float:
        """Sum of squares about the lines between some edges."""
        return sum(self._line(*pair)[2] for pair in pairwise(edges))

    def _line(self, first: int, end: int) -> tuple[float, float, float]:
        """Mean, slope and sum of squares about the line of some rows."""
        t, y = self.time[first:end], self.place[first:end]
        t, mean = t - t.mean(), float(y.mean())
        span = float(t @ t)
        slope = float(t @ y) / span if span > 0 else 0.0
        return mean, slope, float(np.sum((y - mean - slope * t) ** 2))

    @property
    def off(self) -> Floats:
        """Distance of each row from its line, shape (n,)."""
        off = []
        for first, end in pairwise(self.edges):
            time, (mean, slope, _) = self.time[first:end], self._line(first, end)
            off.append(self.place[first:end] - mean - slope * (time - time.mean()))
        return np.concatenate(off)

    def drive(self) -> Drive:
        """Crossings of the lines, with standard errors; a slow segment beside a fast one is a rest."""
        pairs = list(pairwise(self.edges))
        places, speeds, squares = np.transpose([self._line(*pair) for pair in pairs])
        beside = np.maximum(np.append(0.0, np.abs(speeds[:-1])), np.append(np.abs(speeds[1:]), 0.0))
        speeds[(speeds < SLOW * beside) & (speeds > -5 * SLOW * beside)] = 0.0
        rows = np.diff(self.edges)
        means = squares / np.maximum(1, rows - 2) / rows
        errors = 4 * means  # the error of a line at its end is twice that of its mean
        times = [self.time[slice(*pair)] for pair in pairs]
        centers, widths = (np.array([of(part) for part in times]) for of in (np.mean, np.std))
        of_speeds = np.where(speeds == 0, 0.0, np.sqrt(means) / np.maximum(widths, 1e-300))
        starts = places - speeds * centers
        turns = np.flatnonzero(np.diff(speeds))  # not between two rests
        change = np.diff(speeds)[turns]
        ends = np.array(self.edges[1:-1], dtype=np.intp)[turns]
        before, after = self.time[ends - 1], self.time[ends]
        room = 2 * (after - before)
        kinks = np.clip((starts[turns] - starts[turns + 1]) / change, before - room, after + room)
        spread = np.maximum(after - before, np.sqrt(errors[turns] + errors[turns + 1]) / np.abs(change))
        every = np.append(0, turns + 1)
        return Drive(kinks, speeds[every], spread, of_speeds[every])


def _split(time: Floats, place: Floats, noise: float, *, always: bool = False) -> int:
    """Row at which two lines fit best; 0 if one line fits as well, unless `always`."""
    n = time.size
    if n < 2 * _LEAST:
        return 0
    t = time - time.mean()
    y = place - place.mean()
    y = y - t * (float(t @ y) / float(t @ t))
    sums = [np.cumsum(values) for values in (np.ones(n), t, y, t * t, t * y, y * y)]
    rows = np.arange(_LEAST - 1, n - _LEAST)
    before = _squares(*(column[rows] for column in sums))
    both = before + _squares(*(column[-1] - column[rows] for column in sums))
    at = int(np.argmin(both))
    gain = float(sums[5][-1] - both[at])
    return int(rows[at]) + 1 if always or gain > _GAIN * max(noise, float(both[at]) / n) else 0


def _squares(n: Floats, t: Floats, y: Floats, tt: Floats, ty: Floats, yy: Floats) -> Floats:
    """Sums of squares about lines, from sums over their rows."""
    across = tt - t * t / n
    along = ty - t * y / n
    return np.maximum(yy - y * y / n - along**2 / np.where(across > 0, across, np.inf), 0.0)
