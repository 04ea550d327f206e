"""The contact solver on its own: dense reference, cycling, giving up; and several one after the other."""

import itertools

import numpy as np
import pytest

import asperity as asp
from asperity.contact import ActiveSet, Multigrid
from asperity.contact.interface import RIGID
from asperity.contact.pinning import effective_pinning
from asperity.contact.problem import TOLERANCE, Guess
from asperity.errors import ConvergenceError
from asperity.lattice import Lattice
from tests.problems import problem_of
from tests.refusals import refuses
from tests.surfaces import correlated


def tiny_problem(seed, n=9, load=None):
    """A one-dimensional problem small enough to try every set of contacts."""
    rng = np.random.default_rng(seed)
    lattice = Lattice((n,))
    stiffness = 0.3 * lattice.lam + (0.0 if load else 0.5)
    pull = lattice.forward(-0.2 * rng.uniform(size=n))
    if load:
        pull[0] = -load
    heights = rng.normal(size=n)
    return problem_of(lattice, heights, stiffness, pull)


def by_exhaustion(problem):
    """Try all subsets: solve each densely, keep the one that satisfies every condition."""
    n = problem.lattice.sites
    identity = np.eye(n)
    S = np.stack([problem.lattice.apply(problem.stiffness, row) for row in identity])
    b = problem.lattice.backward(problem.rhs)
    for size in range(n + 1):
        for contacts in map(np.array, itertools.combinations(range(n), size)):
            held = contacts.astype(int)
            free = np.setdiff1d(np.arange(n), held)
            u = problem.heights.copy()
            if len(free) == n and problem.load_controlled:
                continue
            rest = S[np.ix_(free, held)] @ u[held]
            u[free] = np.linalg.solve(S[np.ix_(free, free)], b[free] - rest)
            force = S @ u - b
            if (force >= -1e-12).all() and (u >= problem.heights - 1e-12).all():
                return u
    raise AssertionError("no set of contacts is right")


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("load", [None, 0.5, 5.0])
@pytest.mark.parametrize(
    "method", [ActiveSet(), ActiveSet(careful_after=0, patience=0)], ids=["block", "single"]
)
def test_agrees_with_exhaustion_from_any_start(seed, load, method):
    problem = tiny_problem(seed, load=load)
    expected = by_exhaustion(problem)
    n = problem.lattice.sites
    for contacts in (np.ones(n, bool), np.zeros(n, bool), np.arange(n) % 2 == 0):
        solution = method.solve(problem, Guess(np.zeros(n), contacts), TOLERANCE)
        np.testing.assert_allclose(solution.u, expected, atol=1e-7)


def hard_problem():
    """A correlated surface under a uniform pull, and a poor guess at it."""
    heights = correlated(64)
    lattice = Lattice(heights.shape)
    pull = np.zeros(lattice.spectral_shape, complex)
    pull[0, 0] = -100.0
    problem = problem_of(lattice, heights, lattice.lam.copy(), pull)
    guess = Guess(np.zeros_like(heights), heights > heights.mean())
    return problem, guess


def test_gives_up_with_advice():
    problem, guess = hard_problem()
    with refuses(kind=ConvergenceError):
        ActiveSet(max_iterations=5).solve(problem, guess, TOLERANCE)


@pytest.mark.parametrize("wrong", [{"reduction": 1.5}, {"patience": -1}])
def test_settings_are_checked(wrong):
    with refuses(next(iter(wrong))):
        ActiveSet(**wrong)


def test_a_set_of_contacts_that_does_not_settle_is_given_up():
    problem, guess = hard_problem()
    with refuses(kind=ConvergenceError):
        ActiveSet(max_revisions=2).solve(problem, guess, TOLERANCE)


def test_residual_sees_forces_off_contact_and_pulls_in_contact():
    contact = np.array([True, True, False])
    assert RIGID.violation(np.array([1.0, 3.0, 0.0]), contact) == 0
    assert RIGID.violation(np.array([1.0, 3.0, -0.2]), contact) == pytest.approx(0.1)
    assert RIGID.violation(np.array([-1.0, 3.0, 0.0]), contact) == pytest.approx(1.0)
    assert RIGID.violation(np.array([0.0, 0.0, 0.2]), ~np.ones(3, bool), smallest_scale=4.0) == pytest.approx(
        0.05
    )
    assert RIGID.violation(np.zeros(3), np.ones(3, bool)) == 0
    assert RIGID.violation(np.ones(3), np.zeros(3, bool)) == np.inf


@pytest.mark.parametrize("fraction", [1e-3, 0.1, 0.9])
def test_pinning_solves_its_condition(fraction):
    lattice = Lattice((300, 301))
    stiffness = lattice.lam + 0.1
    sigma = effective_pinning(lattice, stiffness, fraction)
    # Sampled modes and a coarse root: good to some percent, which is all that it needs to be.
    assert lattice.mean_over_modes(sigma / (stiffness + sigma)) == pytest.approx(fraction, rel=0.1)


def test_pinning_looks_at_modes_of_every_direction():
    lattice = Lattice((2048, 64))  # every 33rd mode is one of the same column
    stiffness = lattice.wave_number
    sigma = effective_pinning(lattice, stiffness, 0.05)
    assert lattice.mean_over_modes(sigma / (stiffness + sigma)) == pytest.approx(0.05, rel=0.05)


def test_pinning_counts_the_mean_of_the_surface_once():
    for shape in ((68, 60), (68, 62), (54, 40)):
        lattice = Lattice(shape)
        for contacts in (2, 5):
            fraction = contacts / lattice.sites
            sigma = effective_pinning(lattice, lattice.wave_number, fraction)
            found = lattice.mean_over_modes(sigma / (lattice.wave_number + sigma))
            assert found == pytest.approx(fraction, rel=0.1), (shape, contacts)


def test_pinning_has_finite_answers_at_the_ends():
    lattice = Lattice((20, 20))
    assert effective_pinning(lattice, lattice.lam, 1.0) > 1e3
    assert 0 < effective_pinning(lattice, lattice.lam, 1 / 400) < 0.1
    assert effective_pinning(lattice, np.zeros_like(lattice.lam), 0.5) > 0


@pytest.mark.parametrize(("max_cycles", "solver"), [(40, "Cycles"), (0, "ActiveSet"), (2, "ActiveSet")])
def test_the_solution_says_who_solved(max_cycles, solver):
    rough = np.random.default_rng(0).normal(size=(32, 32))
    contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=30.0)
    system = contact.system()
    problem = system.problem(system.mechanics.implicit_step(0.0), 0.0)
    found = Multigrid(max_cycles=max_cycles).solve(problem, None, TOLERANCE)
    alone = ActiveSet().solve(problem, None, TOLERANCE)
    assert found.solver == solver
    assert found.iterations >= max_cycles or solver == "Cycles"
    np.testing.assert_array_equal(found.in_contact, alone.in_contact)
