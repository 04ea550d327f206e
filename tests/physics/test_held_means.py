"""A mean of the surface that is held rigidly takes no digits from the rest; dense matrices judge."""

import math

import numpy as np
import pytest

import asperity as asp
from tests.dense_reference import Dense
from tests.refusals import refuses

SOLIDS = asp.solids


def rough():
    heights = asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=1)
    return heights / heights.std()


def layer_on_its_base(poisson, thickness):
    """K of a bonded layer by its formula (K. L. Johnson, section 5.8), without its mean."""

    def law(q, lam):
        del lam
        x = np.where(q > 0, q, 1.0) * thickness
        sinh, cosh = np.sinh(2 * x), np.cosh(2 * x)
        nu = poisson
        yields = ((3 - 4 * nu) * sinh - 2 * x) / ((3 - 4 * nu) * cosh + 2 * x**2 + 5 - 12 * nu + 8 * nu**2)
        return np.where(q > 0, x / thickness / (2 * yields), 0.0)

    return law


def half_space(q, lam):
    """K of a half-space of modulus 1."""
    del lam
    return q / 2


CASES = [
    *(
        (SOLIDS.layer(modulus=1.0, poisson=nu, thickness=0.2), layer_on_its_base(nu, 0.2))
        for nu in (0.5, 0.4999999, 0.49999999999)
    ),
    *((SOLIDS.half_space(modulus=1.0, apparatus=apparatus), half_space) for apparatus in (math.inf, 1e15)),
]


@pytest.mark.parametrize("load", [0.01, 1.024, 102.4])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_a_mean_held_rigidly_is_solved_under_any_load(case, load):
    solid, law = CASES[case]
    heights = rough()
    contact = asp.press(heights, solid, load=load)
    dense = Dense(heights, law, [], (1.0, 1.0))  # the mean of its surface is free under a load
    y, mean, force = dense.contact([], load=load)
    np.testing.assert_array_equal(contact.in_contact.ravel(), dense.touching)
    np.testing.assert_allclose(contact.force.ravel(), np.where(dense.touching, force, 0.0), atol=1e-8 * load)
    np.testing.assert_allclose(contact.u.ravel(), y + mean, atol=1e-9)
    assert contact.load == pytest.approx(load, rel=1e-9)
    # Held where the load has put it, the rigid body bears the same: as far as its place has digits.
    held = asp.press(heights, solid, separation=contact.separation)
    np.testing.assert_array_equal(held.in_contact, contact.in_contact)
    assert held.load == pytest.approx(load, rel=1e-5)


def test_loads_that_the_heights_cannot_resolve_are_refused_as_before():
    heights = rough() + 1e4
    solid = SOLIDS.half_space(modulus=1.0, apparatus=math.inf)
    with refuses(kind=asp.errors.ConvergenceError):
        asp.press(heights, solid, load=1e-6)
