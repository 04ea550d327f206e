"""The smallest contact that loses a site after the load has fallen, in rational arithmetic.

A periodic line of springs, k0 = R = 1: contact by trying every set of sites, creep by series. All numbers are
fractions, in arrays of objects; what is not rational, exp(M t), comes as a fraction and a bound of its error.
"""

from fractions import Fraction
from itertools import combinations
from math import ceil, factorial

import numpy as np
import pytest

ROUNDED = 2**120
HEIGHTS = [Fraction(k, 9) for k in (1, 3, 4, 5)]
HIGH, LOW = Fraction(12, 5), Fraction(12, 25)
THREE, TWO = (1, 2, 3), (2, 3)


def eye(n):
    return np.array([[Fraction(i == j) for j in range(n)] for i in range(n)])


class Line:
    def __init__(self, heights, k1):
        self.h, self.k1, self.n = np.array(heights), Fraction(k1), len(heights)
        self.eye = eye(self.n)
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

    def later(self, held, u0, load, time):
        """u0 after a time in which these sites are held, and a bound of the error of each."""
        rest = self.rate(held, 0 * u0, load)
        columns = np.transpose([self.rate(held, one, load) - rest for one in self.eye])
        # u0 and a constant 1: d(u0, 1)/dt = M (u0, 1)
        matrix = np.vstack([np.column_stack([columns, rest]), np.full(self.n + 1, Fraction(0))])
        power, error = exponential(matrix, Fraction(time))
        start = np.array([*u0, Fraction(1)])
        return (power @ start)[: self.n], error * abs(start).sum()

    def rate(self, held, u0, load):
        return self.k1 * (self.laplacian @ self.creeping(held, u0, load)[1])


def solved(rows, right):
    table = np.column_stack([rows, right])
    for c in range(len(table)):
        pivot = next(i for i in range(c, len(table)) if table[i, c] != 0)
        table[[c, pivot]] = table[[pivot, c]]
        table[c] = table[c] / table[c, c]
        others = np.arange(len(table)) != c
        table[others] -= np.outer(table[others, c], table[c])
    return table[:, -1]


def exponential(matrix, time, halvings=10, terms=20):
    """exp(matrix time), rounded, and a bound of the error in the norm of the largest row sum.

    Entries are whole multiples of 2^-120. A series at time/2^halvings, squared again and again: what the
    series leaves out is below twice its first such term, and an error e of A becomes 2 |A| e + e^2 of A^2.
    """
    grain = Fraction(len(matrix), ROUNDED)  # a bound of what rounding adds
    small = np.frompyfunc(round, 1, 1)(matrix * time / 2**halvings * ROUNDED)
    size = norm(small) + grain
    assert size < Fraction(1, 2)
    found = term = eye(len(matrix)).astype(int).astype(object) * ROUNDED
    for k in range(1, terms + 1):
        term = term @ small // ROUNDED // k
        found = found + term
    # Each term is rounded twice, and what is wrong with one comes halved into the next; exp' < 2.
    error = 2 * size ** (terms + 1) / factorial(terms + 1) + (4 * terms + 2) * grain
    for _ in range(halvings):
        error = 2 * norm(found) * error + error**2 + grain
        error = Fraction(ceil(error * ROUNDED**2), ROUNDED**2)  # upward, to fewer digits
        found = found @ found // ROUNDED
    return found * Fraction(1, ROUNDED), error


def norm(matrix):
    return Fraction(abs(matrix).sum(axis=1).max(), ROUNDED)


@pytest.fixture
def line():
    return Line(HEIGHTS, 3)


def test_after_an_endless_wait_a_contact_is_lost(line):
    held, u, stretch, _ = line.contact(lambda held: line.relaxed(held, HIGH))
    assert held == THREE
    u0 = u - stretch
    held, _, _, force = line.contact(lambda held: line.creeping(held, u0, LOW))
    assert held == THREE  # the step itself takes none
    assert force[1] == Fraction(1, 7650)
    held, _, _, force = line.contact(lambda held: line.relaxed(held, LOW))
    assert held == TWO
    assert (force[2], force[3]) == (Fraction(62, 675), Fraction(262, 675))


def test_after_a_wait_of_10_it_is_lost_between_0_170_and_0_172(line):
    flat = 0 * line.h
    held, _, _, force = line.contact(lambda held: line.creeping(held, flat, HIGH))
    assert held == THREE
    # The set stays while the load stays: all forces and the gap at the start and later, with the bounds.
    for time in (1, 3, 10):
        u0, error = line.later(THREE, flat, HIGH, time)
        u, _, force = line.creeping(THREE, u0, HIGH)
        assert error < Fraction(1, 10**12)
        assert force[list(THREE)].min() > 100 * error
        assert u[0] - HEIGHTS[0] > 100 * error
    held, *_ = line.contact(lambda held: line.creeping(held, u0, LOW))
    assert held == THREE
    forces = []
    for since in (Fraction(170, 1000), Fraction(172, 1000)):
        after, more = line.later(THREE, u0, LOW, since)
        u, _, force = line.creeping(THREE, after, LOW)
        # A force is at most 8 + 2 k1 times as sensitive as u0 is, and exp(M t) brings at most 2 of an error.
        assert 20 * (2 * error + more) < Fraction(1, 10**10)
        assert u[0] > HEIGHTS[0]
        forces.append(force[1])
    assert forces[0] > Fraction(1, 10**7)
    assert forces[1] < -Fraction(1, 10**7)
