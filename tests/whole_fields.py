"""A second backend of multigrid: whole fields, rows in order, in numpy and double precision; slow and short.

It shares no loop and no layout with `asperity.contact.multigrid.processor`. What it does to one color it
does to all sites of that color at once, as a graphics card would.
"""

from dataclasses import astuple

import numpy as np

from asperity.contact.multigrid.loops import CoarseTwo
from asperity.contact.multigrid.processor import Defects, Extremes, Found


def around(x, sites):
    """Up, down, left and right neighbors, of the lattice or of its mirror images."""
    padded = np.pad(x, 1, mode="symmetric" if sites.mirrored else "wrap")
    return padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]


def lap(x, sites):
    """Minus the Laplacian."""
    return 4 * x - sum(around(x, sites))


def on_grid(x, grid):
    """Sum over neighbors of coupling times value, and of coupling, on a coarse grid."""
    my, mx, gy, gx = grid.my[:, None], grid.mx, grid.gy[:, None], grid.gx
    weights = np.roll(gy, 1, 0) * mx, gy * mx, np.roll(gx, 1) * my, gx * my
    places = np.roll(x, 1, 0), np.roll(x, -1, 0), np.roll(x, 1, 1), np.roll(x, -1, 1)
    return sum(w * p for w, p in zip(weights, places, strict=True)), sum(weights)


def colors(sites):
    """Masks of both colors."""
    color = np.indices(sites[:2]).sum(axis=0) % 2
    return color == 0, color == 1


def refine_axis(coarse, n, mirrored):
    """Interpolation along the first axis."""
    fine = np.empty((n, *coarse.shape[1:]))
    fine[::2] = coarse
    following = np.concatenate([coarse[1:], coarse[-1:] if mirrored else coarse[:1]])
    fine[1::2] = (coarse + following)[: n // 2] / 2
    return fine


def refined(coarse, sites):
    """Interpolation."""
    rows = refine_axis(np.asarray(coarse, float), sites.rows, sites.mirrored)
    return refine_axis(rows.T, sites.columns, sites.mirrored).T


def restricted(fine, sites):
    """The transpose of interpolation, by the matrices along both axes."""
    left, right = (refine_axis(np.eye((n + 1) // 2), n, sites.mirrored) for n in (sites.rows, sites.columns))
    return left.T @ fine @ right


class WholeFields:
    """The operations of `Processor`; see there."""

    def packed(self, field):
        return np.array(field, float)

    def unpacked(self, field, sites):
        assert field.shape == sites[:2]
        return field

    def total(self, field, sites):
        del sites
        return field.sum()

    def restrict(self, field, sites, out, softening=0.0, mean=0.0):
        out[...] = restricted(field / (1 + softening * np.maximum(field - mean, 0)), sites)

    def measure(self, surface, springs, uniform, scales, into, sites, *, flowing):
        (u, w, heights), (k0, k1, spread, drag) = surface, astuple(springs)
        force, free, rise = k0 * lap(u, sites) + k1 * w + uniform, u > heights, u - scales.level
        into.bound[...], into.b[...] = (heights - u) / scales.length, -force / scales.force
        if flowing:
            into.flow[...] = (spread * lap(w, sites) + drag * w) / scales.length
        carried, loose = np.where(free, 0, force), np.where(free, force, 0)
        worst, tension = np.abs(loose).max(), np.maximum(-carried, 0).sum(axis=1).max()
        sums = carried.sum(), loose.sum(), np.sum(~free), w.sum(), rise.sum(), (w**2).sum(), (rise**2).sum()
        return Found(worst, tension, np.abs(u).max(), *sums)

    def settle(self, surface, correction, bound, unit, offset):
        u, w, heights = surface
        u[...] = np.where(correction.e > bound, np.maximum(heights, u + unit * correction.e), heights)
        if len(w):
            w += unit * correction.f + offset

    def sweep_1(self, eq, halves):
        for half in range(halves):
            new = (sum(around(eq.e, eq.sites)) + eq.b - eq.uniform) / eq.diagonal
            np.copyto(eq.e, np.maximum(eq.bound, new), where=colors(eq.sites)[half % 2])

    def gradient_1(self, eq):
        return lap(eq.e, eq.sites) + eq.bed * eq.e - eq.b + eq.uniform

    def restrict_1(self, eq, out):
        free = eq.e > eq.bound
        defect = np.where(free, -self.gradient_1(eq), 0)
        out[...] = restricted(defect, eq.sites)
        return Extremes(np.abs(defect).max(), np.abs(eq.e).max(), np.sum(~free))

    def products_1(self, eq, coarse, previous):
        free = eq.e > eq.bound
        d, q, r = refined(coarse, eq.sites) * free, previous * free, self.gradient_1(eq)
        d_force, q_force = (lap(x, eq.sites) + eq.bed * x for x in (d, q))
        pairs = ((r, d), (r, q), (d, d_force), (d, q_force), (q, q_force))
        return np.array([np.sum(x * y) for x, y in pairs] + [d.sum(), q.sum()])

    def correct_1(self, eq, coarse, previous, alpha, beta):
        previous[...] = (alpha * refined(coarse, eq.sites) + beta * previous) * (eq.e > eq.bound)
        eq.e[...] = np.maximum(eq.bound, eq.e + previous)

    def smooth_1(self, grid, order):
        area = np.outer(grid.my, grid.mx)
        for color in order:
            beside, weight = on_grid(grid.e, grid)
            new = (grid.b + beside) / (weight + grid.bed * area + grid.pins)
            np.copyto(grid.e, new, where=colors(grid.sites)[color])
        return np.sum(grid.e * area)

    def descend(self, grid, out):
        if isinstance(grid, CoarseTwo):
            return self.descend_2(grid, out)
        grid.e.fill(0)
        total, area = self.smooth_1(grid, (0, 1)), np.outer(grid.my, grid.mx)
        beside, weight = on_grid(grid.e, grid)
        own = (weight + grid.bed * area + grid.pins) * grid.e
        out[0][...] = restricted(grid.b - grid.coupling * total * area + beside - own, grid.sites)
        return total

    def ascend(self, grid, coarse, shift, joined):
        if isinstance(grid, CoarseTwo):
            return self.ascend_2(grid, coarse, shift, joined)
        grid.e[...] += refined(coarse[0], grid.sites)
        grid.b[...] += shift * np.outer(grid.my, grid.mx)
        total = self.smooth_1(grid, (1, 0))
        joined[0][...] = grid.e
        return total

    def defects_2(self, eq):
        balance = eq.b - lap(eq.e, eq.sites) - eq.bed * eq.f
        lag = eq.diagonal - 4 * eq.spread
        return balance, eq.c + eq.shift + eq.e - eq.spread * lap(eq.f, eq.sites) - lag * eq.f

    def cycle_2(self, eq, coarse, part, out, *, correcting, restricting):
        if correcting:
            moved = eq.e + part * refined(coarse.e, eq.sites) * (eq.e > eq.bound)
            eq.e[...] = np.maximum(eq.bound, moved)
            eq.f[...] += part * refined(coarse.f, eq.sites)
        for color in colors(eq.sites):
            damping = 1 / eq.diagonal
            known = eq.spread * sum(around(eq.f, eq.sites)) + eq.c + eq.shift
            beside = sum(around(eq.e, eq.sites)) + eq.b - eq.bed * damping * known
            e = np.maximum(eq.bound, beside / (4 + eq.bed * damping))
            np.copyto(eq.f, (e + known) * damping, where=color)
            np.copyto(eq.e, e, where=color)
        balance, creep = self.defects_2(eq)
        free = eq.e > eq.bound
        balance *= free
        if restricting:
            out.e[...], out.f[...] = restricted(balance, eq.sites), restricted(creep, eq.sites)
        return Defects(eq.f.sum(), np.sum(~free), np.sum(eq.e**2))

    def smooth_2(self, grid, order):
        area = np.outer(grid.my, grid.mx)
        for color in order:
            (beside, weight), (flow, _) = on_grid(grid.e, grid), on_grid(grid.f, grid)
            known = grid.c + grid.spread * flow
            inverse = 1 / (area * grid.lag + grid.spread * weight)
            coupling = grid.bed * area * inverse
            e = (beside + grid.b - coupling * known) / (weight + grid.pins + coupling * area)
            np.copyto(grid.f, (known + area * e) * inverse, where=colors(grid.sites)[color])
            np.copyto(grid.e, e, where=colors(grid.sites)[color])

    def descend_2(self, grid, out):
        area = np.outer(grid.my, grid.mx)
        grid.e.fill(0)
        grid.f.fill(0)
        self.smooth_2(grid, (0, 1))
        (beside, weight), (flow, _) = on_grid(grid.e, grid), on_grid(grid.f, grid)
        balance = grid.b + beside - (weight + grid.pins) * grid.e - grid.bed * area * grid.f
        creep = grid.c + grid.spread * (flow - weight * grid.f) + area * (grid.e - grid.lag * grid.f)
        out.e[...], out.f[...] = restricted(balance, grid.sites), restricted(creep, grid.sites)
        return np.sum(grid.f * area)

    def ascend_2(self, grid, coarse, shift, joined):
        grid.e[...] += refined(coarse.e, grid.sites)
        grid.f[...] += refined(coarse.f, grid.sites)
        grid.c[...] += shift * np.outer(grid.my, grid.mx)
        self.smooth_2(grid, (1, 0))
        joined.e[...], joined.f[...] = grid.e, grid.f
        return np.sum(grid.f * np.outer(grid.my, grid.mx))

    def guess(self, past, numbers, middle, bound, guess, c, sites):
        del sites
        growth, offset, first, second = numbers
        f = guess.f + offset
        middle[...] = (guess.e - f) / past.tau - past.rate
        c[...] = -first * past.rate - second * middle - past.tau * past.flow
        path = growth * guess.e + past.ahead * past.last.e + past.back * past.before.e
        guess.e[...] = np.maximum(bound, path)
        guess.f[...] = growth * f + past.ahead * past.last.f + past.back * past.before.f
        return guess.e.sum(), guess.f.sum(), c.sum()

    def finish(self, correction, rates, numbers, error, sites):
        del sites
        (rate, middle, end), (offset, tau, weight, *shares) = rates, numbers
        end[...] = (correction.e - correction.f - offset - weight * (rate + middle)) / tau
        error[...] = sum(share * one for share, one in zip(shares, rates, strict=True))
