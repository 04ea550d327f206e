"""Contacts of continua on lattices of any spacing and edges, made by hand; waves, and transforms of creep."""

import numpy as np
import scipy.linalg

from asperity.contact import Load, Separation
from asperity.contact.bodies import Bodies
from asperity.contact.instantaneous import first_contact
from asperity.lattice import Lattice


def pressed(heights, solid, *, load=None, separation=None, spacing=(), edges="periodic"):
    """Press a solid onto heights whose sites have a spacing, in any one unit of length."""
    heights = np.ascontiguousarray(heights, dtype=float)
    bodies = Bodies(heights, Lattice(heights.shape, spacing, edges), solid, {}, False)
    control = Separation(separation) if load is None else Load(load)
    return first_contact(bodies, control, start=None, solver=None)


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


def elasticity(q, modulus, poisson):
    """A of dy/dz = A y for a wave cos(qx), by the laws of Hooke and of equilibrium in plane strain.

    y = (U, W, T, S): displacements U sin(qx), W cos(qx) and stresses T sin(qx) (shear), S cos(qx) (normal).
    """
    shear, ratio = modulus * (1 - poisson) / 2, poisson / (1 - poisson)
    return np.array(
        [
            [0, q, 1 / shear, 0],
            [-ratio * q, 0, 0, (1 - 2 * poisson) / (2 * shear * (1 - poisson))],
            [2 * shear / (1 - poisson) * q**2, 0, 0, ratio * q],
            [0, 0, -q, 0],
        ]
    )


def stiffness_of_a_wave(q, modulus, poisson, thickness, below):
    """Pressure that gives the top of a layer a displacement cos(qx) where nothing shears it.

    ``below`` has two columns: what y may be at the base.
    """
    up = scipy.linalg.expm(elasticity(q, modulus, poisson) * thickness) @ below
    return up[3] @ np.linalg.solve(up[[2, 1]], [0.0, 1.0])


def talbot(transform, t, count=22):
    """Numerical inverse of a Laplace transform; A. Talbot (1979), J. Abate and P. P. Valko (2004)."""
    theta = np.arange(1, count) * np.pi / count
    r = 2 * count / (5 * t)
    s = r * theta * (1 / np.tan(theta) + 1j)
    sigma = theta + (theta / np.tan(theta) - 1) / np.tan(theta)
    values = np.array([transform(one) for one in s])
    ends = 0.5 * np.exp(r * t) * transform(r).real
    return r / count * (ends + np.sum((np.exp(t * s) * values * (1 + 1j * sigma)).real))
