"""An external force, not of contact: bodies touch as under the load and above the heights that it makes."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

import asperity as asp
from asperity.aging.local_steps import LocalSteps
from asperity.aging.separable import SeparableSteps
from asperity.aging.spring_steps import SpringSteps
from asperity.contact import ActiveSet, Multigrid, Separation
from asperity.contact.anchors import AnchorFields
from asperity.contact.arrays import inverse
from asperity.contact.choice import chosen_solver
from asperity.contact.problem import PUBLISHED
from asperity.contact.publish import contact_from
from asperity.errors import ConvergenceError
from asperity.solids import half_space, layer, spring_lattice
from asperity.surfaces import Surface
from tests.dense_reference import Dense
from tests.refusals import refuses
from tests.surfaces import correlated

HEIGHTS = correlated(32, hurst=0.8)
CASES = {
    "half-space": (half_space(modulus=1.0), "periodic", 5.0),
    "reflecting": (half_space(modulus=1.0), "reflecting", 5.0),
    "free": (half_space(modulus=1.0), "free", 5.0),
    "hard": (half_space(modulus=1.0, hardness=0.3), "periodic", 5.0),
    "layer": (layer(modulus=1.0, thickness=4.0, poisson=0.3), "periodic", 5.0),
    "springs": (spring_lattice(k0=1.0, k1=3.0), "periodic", 50.0),
    "line": (spring_lattice(k0=1.0, k1=3.0), "periodic", 5.0),
    "no neighbors": (spring_lattice(k0=0.0, k1=3.0), "periodic", 50.0),
}


def pressed(name):
    solid, edges, load = CASES[name]
    return asp.press(
        Surface(HEIGHTS[0] if name == "line" else HEIGHTS, edges=cast(Any, edges)), solid, load=load
    )


def pressed_beside(known, contact, *, control=None, solver=None):
    """The contact of anchors that are flat, beside an external force, published."""
    system = contact.system(control)
    mechanics = system.mechanics
    system = replace(system, external=mechanics.lattice.extended(known, 0.0))
    level = 0.0 if system.load is not None else system.control.value - system.datum
    problem = mechanics.implicit_step(0.0).problem(system.heights, level, system.held())
    solution = chosen_solver(solver, system).solve(problem, None, PUBLISHED)
    if system.load is not None:
        flat = np.full((mechanics.branches, *solution.u.shape), level)
        level = system.body.displacement(solution.u, flat, system.held(level))
    return contact_from(system, solution, AnchorFields.flat(level, system), level, bodies=contact)


def test_time_steps_that_leave_it_out_do_not_begin_with_it():
    body = half_space(modulus=1.0, branches=[(0.5, 1.0)])
    for solid, kind in ((spring_lattice(k0=1.0, k1=3.0), SpringSteps), (body, SeparableSteps)):
        contact = asp.press(HEIGHTS, solid, load=5.0)
        system = contact.system()
        solver = chosen_solver(None, system)
        assert kind.begin(system, solver, contact) is not None
        assert kind.begin(replace(system, external=uneven(contact)), solver, contact) is None
    law = asp.solids.Norton(rate=1.0, stress=1.0, exponent=3.0)
    contact = asp.press(HEIGHTS, half_space(modulus=1.0, creep=law), load=5.0)
    with refuses("creep", "one"):
        LocalSteps.begin(replace(contact.system(), external=uneven(contact)), ActiveSet(), contact)


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


@pytest.mark.parametrize("name", ["springs", "no neighbors", "layer"])
def test_a_held_body_is_pulled_as_under_the_load_that_comes_out(name):
    contact = pressed(name)
    under_load = pressed_beside(uneven(contact), contact)
    for solver in (Multigrid(), ActiveSet()) if name == "springs" else (None,):
        held = pressed_beside(
            uneven(contact), contact, control=Separation(under_load.separation), solver=solver
        )
        np.testing.assert_array_equal(held.in_contact, under_load.in_contact)
        assert held.load == pytest.approx(contact.load, rel=1e-7)


def test_springs_relax_beside_it():
    contact = pressed("springs")
    system = replace(contact.system(), external=uneven(contact))
    problem = system.mechanics.implicit_step(np.inf).problem(system.heights, 0.0, system.held())
    found = Multigrid().solve(problem, None, PUBLISHED)
    force = problem.spectral().force(found.u)
    assert found.solver == "ActiveSet"
    assert np.abs(force[~found.in_contact]).max() < 1e-8 * force[found.in_contact].mean()
    assert force.sum() + system.external.sum() == pytest.approx(contact.load, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "law"), [("half-space", lambda q, _: q / 2), ("springs", lambda _, lam: lam + 3.0)]
)
def test_dense_matrices_find_the_same(name, law):
    heights, load = HEIGHTS[:8, :8], CASES[name][2] / 16
    contact = asp.press(heights, CASES[name][0], load=load)
    known = uneven(contact)
    found, dense = pressed_beside(known, contact), Dense(heights, law, [], (1.0, 1.0))
    u, X, r = dense.contact([], load=load, known=known.ravel())
    np.testing.assert_array_equal(found.in_contact.ravel(), dense.touching)
    np.testing.assert_allclose((found.force - known).ravel(), np.where(dense.touching, r, 0.0), atol=1e-7)
    np.testing.assert_allclose(found.u.ravel(), u + X, atol=1e-7)


class Pulling:
    """A solver of somebody's own that adds an external force to any problem, twice a half."""

    def __init__(self, solver, known):
        self.solver, self.half = solver, known / 2

    def solve(self, problem, guess, accuracy):
        return self.solver.solve(problem.beside(self.half).beside(self.half), guess, accuracy)


@pytest.mark.parametrize("solver", [ActiveSet(), Multigrid()])
def test_a_wrapper_of_solvers_adds_it_to_problems(solver):
    contact = pressed("springs")
    known = uneven(contact)
    step, system = contact.system().mechanics.implicit_step(0.0), contact.system()
    problem = step.problem(system.heights, 0.0, system.held())
    found = Pulling(solver, known).solve(problem, None, PUBLISHED)
    np.testing.assert_array_equal(found.in_contact, pressed_beside(known, contact).in_contact)


def test_forces_off_contact_that_are_not_the_external_ones_are_refused():
    contact = pressed("half-space")
    known = uneven(contact)
    system = replace(contact.system(), external=known)
    problem = system.mechanics.implicit_step(0.0).problem(system.heights, 0.0, system.held())
    solution = ActiveSet().solve(problem, None, PUBLISHED)
    level = float(solution.u.mean())
    with refuses(kind=ConvergenceError):
        anchors = AnchorFields.flat(level, system)
        contact_from(replace(system, external=None), solution, anchors, level, bodies=contact)
