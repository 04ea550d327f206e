"""A second backend of multigrid: whole fields, rows in order, in numpy and double precision; slow and short.

It shares no loop and no layout with `asperity.contact.multigrid.processor`. What it does to one color it
does to all sites of that color at once, as a graphics card would.
"""

import numpy as np

from asperity.contact.multigrid.processor import Defects, Extremes, Forces, Moments


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

    def zeros(self, sites):
        return np.zeros(sites[:2])

    joined = zeros

    def packed(self, field):
        return np.array(field, float)

    def unpacked(self, field, sites):
        assert field.shape == sites[:2]
        return field

    def along_rows(self, values, *, images):
        del images
        return values

    def total(self, field, sites):
        del sites
        return field.sum()

    def touching(self, e, bound):
        return np.count_nonzero(e <= bound)

    def touch(self, e, bound):
        deepest = np.argmax(bound - e)
        e.flat[deepest] = bound.flat[deepest]

    def measure_1(self, u, heights, force, unit, bound, b, sites):
        k0, bed, uniform = force
        found, free = k0 * lap(u, sites) + bed * u + uniform, u > heights
        bound[...], b[...] = (heights - u) / unit, -found / (k0 * unit)
        carried, loose = np.where(free, 0, found), np.where(free, found, 0)
        tension = np.maximum(-carried, 0).sum(axis=1).max()
        return Forces(np.abs(loose).max(), tension, carried.sum(), np.sum(~free), loose.sum())

    def measure_2(self, surface, anchors, springs, shift, unit, into, sites):
        (u, w, heights), (k0, k1, spread, drag) = surface, springs
        into.bound[...] = (heights - u) / unit
        into.b[...] = -(lap(u, sites) + k1 / k0 * w) / unit
        into.c[...] = (u - w - anchors + shift - spread * lap(w, sites) - drag * w) / unit
        return w.sum()

    def settle(self, u, heights, e, bound, unit):
        u[...] = np.where(e > bound, np.maximum(heights, u + unit * e), heights)

    def add(self, w, f, unit):
        w += unit * f

    def measure_law(self, surface, law, springs, tangent, scales, into, lag, sites):
        (u, w, heights), (k0, k1, spread, _), (lagging, beside, bend) = surface, springs, tangent
        into.bound[...] = (heights - u) / scales[1]
        into.b[...] = -(k0 * lap(u, sites) + k1 * w) / scales[0]
        lacking = u - law.anchors - law.position - lagging * w - spread * lap(w, sites)
        lacking -= law.tau * law.velocity
        rise = law.tau * k1 * law.derivative
        own = lagging + beside + rise
        into.c[...], lag[...] = lacking / scales[1], np.minimum(lagging + rise, law.largest)
        alone = lacking / own
        left = np.minimum(rise * alone**2 / (own * bend), np.abs(alone))
        return [w.sum(), alone.sum(), (alone**2).sum(), (left**2).sum(), (1 / own).sum()]

    def settle_law(self, surface, correction, bound, lag, tangent, unit, sites):
        (u, w, heights), (e, f), (lagging, beside, bend) = surface, correction, tangent
        self.settle(u, heights, e, bound, unit)
        self.add(w, f, unit)
        change = unit * f
        left = np.minimum((lag - lagging) * change**2 / ((lag + beside) * bend), np.abs(change))
        return (left**2).sum()

    def coarser_lag(self, lag, cells, beside, sites, out):
        weights = cells / (lag + beside)
        out[...] = restricted(weights * lag, sites) / restricted(weights, sites)

    def pin(self, e, bound, sites, strength, out):
        out[...] = restricted(np.where(e <= bound, strength, 0.0), sites)

    def coarser_pins(self, pins, sites, softening, mean, out):
        out[...] = restricted(pins / (1 + softening * np.maximum(pins - mean, 0)), sites)

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

    def descend_1(self, grid, coupling, out):
        grid.e.fill(0)
        total, area = self.smooth_1(grid, (0, 1)), np.outer(grid.my, grid.mx)
        beside, weight = on_grid(grid.e, grid)
        own = (weight + grid.bed * area + grid.pins) * grid.e
        out[...] = restricted(grid.b - coupling * total * area + beside - own, grid.sites)
        return total

    def ascend_1(self, grid, coarse, shift, joined):
        grid.e[...] += refined(coarse, grid.sites)
        grid.b[...] += shift * np.outer(grid.my, grid.mx)
        total = self.smooth_1(grid, (1, 0))
        joined[...] = grid.e
        return total

    def defects_2(self, eq):
        balance = eq.b - lap(eq.e, eq.sites) - eq.bed * eq.f
        return balance, eq.c + eq.shift + eq.e - eq.spread * lap(eq.f, eq.sites) - eq.lag * eq.f

    def cycle_2(self, eq, moves, out, *, correcting, sweeping, restricting):
        if correcting:
            alpha, beta = (moves.alpha, moves.beta) if moves.keeping else (1, 0)
            free = eq.e > eq.bound
            moves.previous.e[...] = (
                alpha * refined(moves.coarse.e, eq.sites) + beta * moves.previous.e
            ) * free
            moves.previous.f[...] = alpha * refined(moves.coarse.f, eq.sites) + beta * moves.previous.f
            eq.e[...] = np.maximum(eq.bound, eq.e + moves.previous.e)
            eq.f[...] += moves.previous.f
        for color in colors(eq.sites) if sweeping else ():
            damping = 1 / (eq.lag + 4 * eq.spread)
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
        squares = (np.sum(x**2) for x in (balance, creep, eq.e))
        first, second, moved = squares
        return Defects(first, second, eq.f.sum(), np.sum(~free), moved)

    def begin_error_2(self, e, least, error, eq):
        free = e > least
        for field in (eq.e, eq.f):
            field.fill(0)
        eq.c[...], eq.bound[...], eq.b[...] = -error, np.where(free, -np.inf, 0), np.where(free, 0, -1e30)
        return np.sum(error**2), np.sum(free & (least == 0))

    def differences(self, correction, sites):
        del sites
        change = correction.e - correction.f
        return change.sum(), np.sum(change**2)

    def products_2(self, eq, moves):
        free = eq.e > eq.bound
        d, p = refined(moves.coarse.e, eq.sites) * free, refined(moves.coarse.f, eq.sites)
        q, g = moves.previous.e * free, moves.previous.f
        balance, creep = self.defects_2(eq)

        def form(x, f, y, h):
            creep = f * (eq.spread * lap(h, eq.sites) + eq.lag * h)
            return np.sum(x * lap(y, eq.sites) + eq.bed * (x * h + f * y - creep))

        gradients = [eq.bed * np.sum(creep * f) - np.sum(balance * x) for x, f in ((d, p), (q, g))]
        forms = [form(d, p, d, p), form(d, p, q, g), form(q, g, q, g)]
        return np.array([*gradients, *forms, p.sum(), g.sum()])

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

    def guess_1(self, past, bound, guess, c, sites):
        del sites
        guess.e[...] = np.maximum(bound, past.ahead * past.last.e + past.back * past.before.e)
        guess.f[...] = past.ahead * past.last.f + past.back * past.before.f
        c[...] = -past.tau * (past.rate + past.flow)
        return guess.e.sum(), guess.f.sum(), c.sum()

    def guess_2(self, past, numbers, middle, bound, guess, c, sites):
        del sites
        growth, offset, weight = numbers
        f = guess.f + offset
        middle[...] = (guess.e - f) / past.tau - past.rate
        c[...] = -weight * (past.rate + middle) - past.tau * past.flow
        path = growth * guess.e + past.ahead * past.last.e + past.back * past.before.e
        guess.e[...] = np.maximum(bound, path)
        guess.f[...] = growth * f + past.ahead * past.last.f + past.back * past.before.f
        return guess.e.sum(), guess.f.sum(), c.sum()

    def finish(self, correction, rates, numbers, error):
        (rate, middle, end), (offset, tau, weight, *shares) = rates, numbers
        end[...] = (correction.e - correction.f - offset - weight * (rate + middle)) / tau
        error[...] = sum(share * one for share, one in zip(shares, rates, strict=True))

    def advance(self, correction, offset, surface, springs, unit, level, into, sites):
        (u, w, heights), (k0, k1, spread, drag) = surface, springs
        self.settle(u, heights, correction.e, into.bound, unit)
        w += unit * correction.f + offset
        into.bound[...] = (heights - u) / unit
        into.b[...] = -(k0 * lap(u, sites) + k1 * w) / unit
        into.c[...] = (spread * lap(w, sites) + drag * w) / unit
        rise, contacts = u - level, np.sum(u <= heights)
        return Moments(w.sum(), rise.sum(), (w**2).sum(), (rise**2).sum(), np.abs(u).max(), contacts)
