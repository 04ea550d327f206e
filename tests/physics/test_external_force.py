"""An external force, not of contact: bodies touch as under the load and above the heights that it makes."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

import asperity as asp
from asperity.contact import ActiveSet, Separation
from asperity.contact.anchors import AnchorFields
from asperity.contact.arrays import inverse
from asperity.contact.problem import PUBLISHED
from asperity.contact.publish import contact_from
from asperity.solids import half_space, layer
from asperity.surfaces import Surface
from tests.surfaces import correlated

HEIGHTS = correlated(32, hurst=0.8)
CASES = {
    "half-space": (half_space(modulus=1.0), "periodic", 5.0),
    "reflecting": (half_space(modulus=1.0), "reflecting", 5.0),
    "free": (half_space(modulus=1.0), "free", 5.0),
    "hard": (half_space(modulus=1.0, hardness=0.3), "periodic", 5.0),
    "layer": (layer(modulus=1.0, thickness=4.0, poisson=0.3), "periodic", 5.0),
}


def pressed(name):
    solid, edges, load = CASES[name]
    return asp.press(Surface(HEIGHTS, edges=cast(Any, edges)), solid, load=load)


def pressed_beside(known, contact, *, control=None):
    """The contact of anchors that are flat, beside an external force, published."""
    system = contact.system(control)
    mechanics = system.mechanics
    system = replace(system, external=mechanics.lattice.extended(known, 0.0))
    level = 0.0 if system.load is not None else system.control.value - system.datum
    problem = mechanics.implicit_step(0.0).problem(system.heights, level, system.held())
    solution = ActiveSet().solve(problem.without_adhesion(system.external), None, PUBLISHED)
    if system.load is not None:
        flat = np.full((mechanics.branches, *solution.u.shape), level)
        level = system.body.displacement(solution.u, flat, system.held(level))
    return contact_from(system, solution, AnchorFields.flat(level, system), level, bodies=contact)


def indentation(known, contact):
    """What a force displaces, up to a constant, by the spectrum of the solid."""
    lattice = contact.lattice.embedding
    step = contact.system().mechanics.implicit_step(0.0)
    return lattice.cut(lattice.apply(inverse(step.load_controlled_stiffness), lattice.extended(known, 0.0)))


def uneven(contact, scale=0.5):
    known = np.random.default_rng(3).normal(size=contact.heights.shape) - 1.0
    return scale * contact.load / contact.heights.size * known


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("name", CASES)
def test_an_external_force_is_a_load_and_an_indentation(name, even):
    solid, edges, load = CASES[name]
    contact = pressed(name)
    known = uneven(contact)
    if even:
        known[...] = -0.5 * load / known.size
    found = pressed_beside(known, contact)
    lower = contact.heights - indentation(known, contact)
    if even and name != "free":  # a body that ends is indented by an even traction, too
        np.testing.assert_allclose(lower, contact.heights, atol=1e-12)
    same = asp.press(Surface(lower, edges=cast(Any, edges)), solid, load=load - known.sum())
    np.testing.assert_array_equal(found.in_contact, same.in_contact)
    np.testing.assert_allclose(found.force, same.force + known, atol=1e-6 * load / contact.area)
    assert found.load == pytest.approx(load, rel=1e-9)
    assert not even or found.area > contact.area


def test_a_held_body_is_pulled_as_under_the_load_that_comes_out():
    contact = pressed("layer")
    under_load = pressed_beside(uneven(contact), contact)
    held = pressed_beside(uneven(contact), contact, control=Separation(under_load.separation))
    np.testing.assert_array_equal(held.in_contact, under_load.in_contact)
    assert held.load == pytest.approx(contact.load, rel=1e-7)
