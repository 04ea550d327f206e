"""The smallest contact that loses a site after the load has fallen, in rational arithmetic.

A periodic line of springs, k0 = 1: contact by trying every set of sites. All numbers are fractions, in arrays
of objects. `tests/physics/test_histories.py` has the time at which it is lost after a wait of 10.
"""

from fractions import Fraction
from itertools import combinations

import numpy as np

HEIGHTS = [Fraction(k, 9) for k in (1, 3, 4, 5)]
HIGH, LOW = Fraction(12, 5), Fraction(12, 25)
THREE, TWO = (1, 2, 3), (2, 3)


class Line:
    def __init__(self, heights, k1):
        self.h, self.k1, self.n = np.array(heights), Fraction(k1), len(heights)
        self.eye = np.array([[Fraction(i == j) for j in range(self.n)] for i in range(self.n)])
        self.laplacian = 2 * self.eye - np.roll(self.eye, 1, axis=1) - np.roll(self.eye, -1, axis=1)

    def held_or(self, held, free, right):
        """Rows that hold these sites at their heights, and other rows at the others; and right-hand sides."""
        holds = np.isin(np.arange(self.n), held)
        width = free.shape[1] - self.n
        hold = np.hstack([self.eye, np.full((self.n, width), Fraction(0))])
        return np.where(holds[:, np.newaxis], hold, free), np.where(holds, self.h, right)

    def creeping(self, held, u0, load):
        """u, stretches of the springs to the bulk and forces, with these sites held at their heights."""
        body = np.full((self.n, 1), -self.k1)
        free = np.hstack([self.laplacian + self.k1 * self.eye, body])
        rows, right = self.held_or(held, free, self.k1 * u0)
        balance = np.append(-body.T, [[-self.n * self.k1]], axis=1)
        *u, position = solved(np.vstack([rows, balance]), np.append(right, load + self.k1 * sum(u0)))
        stretch = np.array(u) - u0 - position
        return np.array(u), stretch, self.laplacian @ u + self.k1 * stretch

    def relaxed(self, held, load):
        """The same when all springs to the bulk carry the same."""
        even = np.full(self.n, load / self.n)
        u = solved(*self.held_or(held, self.laplacian, -even))
        return u, even / self.k1, self.laplacian @ u + even

    def contact(self, state):
        """The one set of sites whose forces and gaps are not negative, its u, stretches and forces."""
        for count in range(1, self.n + 1):
            for held in combinations(range(self.n), count):
                u, stretch, force = state(held)
                if force[list(held)].min() >= 0 and (u >= self.h).all():
                    return held, u, stretch, force
        raise AssertionError


def solved(rows, right):
    table = np.column_stack([rows, right])
    for c in range(len(table)):
        pivot = next(i for i in range(c, len(table)) if table[i, c] != 0)
        table[[c, pivot]] = table[[pivot, c]]
        table[c] = table[c] / table[c, c]
        others = np.arange(len(table)) != c
        table[others] -= np.outer(table[others, c], table[c])
    return table[:, -1]


def test_after_an_endless_wait_a_contact_is_lost():
    line = Line(HEIGHTS, 3)
    held, u, stretch, _ = line.contact(lambda held: line.relaxed(held, HIGH))
    assert held == THREE
    u0 = u - stretch
    held, _, _, force = line.contact(lambda held: line.creeping(held, u0, LOW))
    assert held == THREE  # the step itself takes none
    assert force[1] == Fraction(1, 7650)
    held, _, _, force = line.contact(lambda held: line.relaxed(held, LOW))
    assert held == TWO
    assert (force[2], force[3]) == (Fraction(62, 675), Fraction(262, 675))
