"""A periodic line of springs in rational arithmetic: contact by trying every set of sites, creep by series.

k0 = R = 1. All numbers are fractions; what is not rational, exp(M t), comes as a fraction and a bound of its
error.
"""

from fractions import Fraction
from itertools import combinations
from math import ceil, factorial

ROUNDED = 2**120


class Line:
    def __init__(self, heights, k1):
        self.h, self.k1, self.n = [Fraction(x) for x in heights], Fraction(k1), len(heights)
        self.sites = range(self.n)
        self.laplacian = [
            [Fraction(2 * (i == j) - ((i - j) % self.n in (1, self.n - 1))) for j in self.sites]
            for i in self.sites
        ]

    def creeping(self, held, u0, load):
        """u, position of the rigid body and forces, with these sites held at their heights."""
        rows, right = [], []
        for i in self.sites:
            if i in held:
                rows.append([Fraction(i == j) for j in self.sites] + [Fraction(0)])
                right.append(self.h[i])
            else:
                row = [self.laplacian[i][j] + self.k1 * (i == j) for j in self.sites]
                rows.append([*row, -self.k1])
                right.append(self.k1 * u0[i])
        rows.append([self.k1] * self.n + [-self.n * self.k1])
        right.append(load + self.k1 * sum(u0))
        *u, body = solved(rows, right)
        stretch = [a - b - body for a, b in zip(u, u0, strict=True)]
        return u, stretch, [x + self.k1 * s for x, s in zip(product(self.laplacian, u), stretch, strict=True)]

    def relaxed(self, held, load):
        """The same when all springs to the bulk carry the same."""
        rows, right = [], []
        for i in self.sites:
            rows.append([Fraction(i == j) for j in self.sites] if i in held else self.laplacian[i])
            right.append(self.h[i] if i in held else -load / self.n)
        u = solved(rows, right)
        even = load / self.n
        return u, [even / self.k1] * self.n, [x + even for x in product(self.laplacian, u)]

    def contact(self, state):
        """The one set of sites whose forces and gaps are not negative, its u, stretches and forces."""
        for count in range(1, self.n + 1):
            for held in combinations(self.sites, count):
                u, stretch, force = state(held)
                if min(force[i] for i in held) >= 0 and all(a >= b for a, b in zip(u, self.h, strict=True)):
                    return held, u, stretch, force
        raise AssertionError

    def later(self, held, u0, load, time):
        """u0 after a time in which these sites are held, and a bound of the error of each."""
        zero = [Fraction(0)] * self.n
        rest = self.rate(held, zero, load)
        columns = [self.rate(held, [Fraction(i == j) for i in self.sites], load) for j in self.sites]
        # u0 and a constant 1: d(u0, 1)/dt = M (u0, 1)
        matrix = [[columns[j][i] - rest[i] for j in self.sites] + [rest[i]] for i in self.sites]
        power, error = exponential([*matrix, [Fraction(0)] * (self.n + 1)], Fraction(time))
        start = [*u0, Fraction(1)]
        return product(power, start)[: self.n], error * sum(map(abs, start))

    def rate(self, held, u0, load):
        _, stretch, _ = self.creeping(held, u0, load)
        return [self.k1 * x for x in product(self.laplacian, stretch)]


def solved(rows, right):
    table = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for c in range(len(table)):
        pivot = next(i for i in range(c, len(table)) if table[i][c] != 0)
        table[c], table[pivot] = table[pivot], table[c]
        table[c] = [x / table[c][c] for x in table[c]]
        for i in range(len(table)):
            if i != c and table[i][c] != 0:
                table[i] = [x - table[i][c] * y for x, y in zip(table[i], table[c], strict=True)]
    return [row[-1] for row in table]


def product(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector, strict=True)) for row in matrix]


def exponential(matrix, time, halvings=10, terms=20):
    """exp(matrix time), rounded, and a bound of the error in the norm of the largest row sum.

    Entries are whole multiples of 2^-120. A series at time/2^halvings, squared again and again: what the
    series leaves out is below twice its first such term, and an error e of A becomes 2 |A| e + e^2 of A^2.
    """
    n = len(matrix)
    grain = Fraction(n, ROUNDED)  # a bound of what rounding adds
    small = [[round(x * time / 2**halvings * ROUNDED) for x in row] for row in matrix]
    size = norm(small) + grain
    assert size < Fraction(1, 2)
    found = term = [[ROUNDED * (i == j) for j in range(n)] for i in range(n)]
    for k in range(1, terms + 1):
        term = [[x // k for x in row] for row in times(term, small)]
        found = [[a + b for a, b in zip(p, q, strict=True)] for p, q in zip(found, term, strict=True)]
    # Each term is rounded twice, and what is wrong with one comes halved into the next; exp' < 2.
    error = 2 * size ** (terms + 1) / factorial(terms + 1) + (4 * terms + 2) * grain
    for _ in range(halvings):
        error = 2 * norm(found) * error + error**2 + grain
        error = Fraction(ceil(error * ROUNDED**2), ROUNDED**2)  # upward, to fewer digits
        found = times(found, found)
    return [[Fraction(x, ROUNDED) for x in row] for row in found], error


def times(left, right):
    columns = list(zip(*right, strict=True))
    return [
        [sum(a * b for a, b in zip(row, column, strict=True)) // ROUNDED for column in columns]
        for row in left
    ]


def norm(matrix):
    return Fraction(max(sum(map(abs, row)) for row in matrix), ROUNDED)
