"""Contacts of continua on lattices of any spacing and edges, made by hand; and transforms of their creep."""

import numpy as np

from asperity.contact.bodies import Bodies
from asperity.contact.controls import control_from
from asperity.contact.instantaneous import first_contact
from asperity.lattice import Lattice


def pressed(heights, solid, *, load=None, separation=None, spacing=(), edges="periodic"):
    """Press a solid onto heights whose sites have a spacing, in any one unit of length."""
    heights = np.ascontiguousarray(heights, dtype=float)
    bodies = Bodies(heights, Lattice(heights.shape, spacing, edges), solid, {}, False)
    return first_contact(bodies, control_from(load, separation), start=None, solver=None)


def love(shape, sides):
    """Displacement of pixels by unit pressures on others, times E*, as a matrix; A. E. H. Love (1929)."""
    y, x = (side * ij.ravel() for side, ij in zip(sides, np.indices(shape), strict=True))
    integral = 0.0
    for v in (-0.5, 0.5):
        for w in (-0.5, 0.5):
            Y, X = y[:, None] - y + v * sides[0], x[:, None] - x + w * sides[1]
            r = np.hypot(Y, X)
            integral += 4 * v * w * (X * np.log(Y + r) + Y * np.log(X + r))
    return integral / np.pi


def talbot(transform, t, count=22):
    """Numerical inverse of a Laplace transform; A. Talbot (1979), J. Abate and P. P. Valko (2004)."""
    theta = np.arange(1, count) * np.pi / count
    r = 2 * count / (5 * t)
    s = r * theta * (1 / np.tan(theta) + 1j)
    sigma = theta + (theta / np.tan(theta) - 1) / np.tan(theta)
    values = np.array([transform(one) for one in s])
    ends = 0.5 * np.exp(r * t) * transform(r).real
    return r / count * (ends + np.sum((np.exp(t * s) * values * (1 + 1j * sigma)).real))
