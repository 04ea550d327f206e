"""The contact solvers on their own, and the method for contacts of few sites.

Judges are exhaustion, dense matrices, and the same on the whole lattice.
"""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.contact import ActiveSet, Multigrid, active_set, free_sites
from asperity.contact.arrays import library
from asperity.contact.cascade import cold_start, independent_asperities
from asperity.contact.contact_sites import solved_on_contacts
from asperity.contact.free_sites import FreeSites
from asperity.contact.interface import RIGID, Interface
from asperity.contact.pinning import effective_pinning
from asperity.contact.problem import PUBLISHED, TOLERANCE, Accuracy, Guess
from asperity.errors import ConvergenceError, MissingExtraError
from asperity.lattice import Lattice
from asperity.solids import half_space, layer
from tests.problems import problem_of
from tests.refusals import refuses
from tests.surfaces import correlated


def pulled(heights, stiffness, mean_force):
    """The problem of a surface on which a uniform force pulls."""
    lattice = Lattice(heights.shape)
    pull = np.zeros(lattice.spectral_shape, complex)
    pull.flat[0] = -mean_force * lattice.sites
    return problem_of(lattice, heights, stiffness(lattice), pull)


def half_space_problem(heights, pressure, modulus=1.0):
    return pulled(heights, lambda lattice: half_space(modulus=modulus).on(lattice).permanent, pressure)


def held_problem(heights, separation):
    """Springs to neighbors and to a body held at a separation."""
    return pulled(heights, lambda lattice: lattice.lam + 0.3, -0.3 * separation)


def hard_problem():
    """A correlated surface under a uniform pull, and a poor guess at it."""
    heights = correlated(64)
    guess = Guess(np.zeros_like(heights), heights > heights.mean())
    return pulled(heights, lambda lattice: lattice.lam.copy(), 100.0 / 64**2), guess


def rms_slope(heights):
    return np.sqrt(2) * np.std(np.roll(heights, 1, 0) - heights)


def tiny_problem(seed, load, n=9):
    """A one-dimensional problem small enough to try every set of contacts."""
    rng = np.random.default_rng(seed)
    lattice = Lattice((n,))
    stiffness = 0.3 * lattice.lam + (0.0 if load else 0.5)
    pull = lattice.forward(-0.2 * rng.uniform(size=n))
    if load:
        pull[0] = -load
    return problem_of(lattice, rng.normal(size=n), stiffness, pull)


def by_exhaustion(problem):
    """Try all subsets: solve each densely, keep the one that satisfies every condition."""
    n = problem.lattice.sites
    S = np.stack([problem.lattice.apply(problem.stiffness, row) for row in np.eye(n)])
    b = problem.lattice.backward(problem.rhs)
    for contacts in map(np.array, itertools.product([False, True], repeat=n)):
        held, free = np.flatnonzero(contacts), np.flatnonzero(~contacts)
        if len(free) == n and problem.load is not None:
            continue
        u = problem.heights.copy()
        u[free] = np.linalg.solve(S[np.ix_(free, free)], b[free] - S[np.ix_(free, held)] @ u[held])
        force = S @ u - b
        if (force >= -1e-12).all() and (u >= problem.heights - 1e-12).all():
            return u
    raise AssertionError("no set of contacts is right")


@pytest.mark.parametrize("load", [None, 0.5, 5.0])
@pytest.mark.parametrize("tuned", [{}, {"careful_after": 0, "patience": 0}], ids=["block", "single"])
def test_agrees_with_exhaustion_from_any_start(load, tuned, monkeypatch):
    monkeypatch.setattr(active_set, "TUNING", active_set.Tuning(**tuned))
    for seed in range(6):
        problem = tiny_problem(seed, load)
        expected, n = by_exhaustion(problem), problem.lattice.sites
        for contacts in (np.ones(n, bool), np.zeros(n, bool), np.arange(n) % 2 == 0):
            solution = ActiveSet().solve(problem, Guess(np.zeros(n), contacts), PUBLISHED)
            np.testing.assert_allclose(solution.u, expected, atol=1e-7)


def test_gives_up_with_advice(monkeypatch):
    problem, guess = hard_problem()
    with refuses(kind=ConvergenceError):
        ActiveSet(max_iterations=5).solve(problem, guess, PUBLISHED)
    monkeypatch.setattr(active_set, "TUNING", active_set.Tuning(most_revisions=2))
    with refuses(kind=ConvergenceError):
        ActiveSet().solve(problem, guess, PUBLISHED)


def test_settings_and_array_libraries_are_checked():
    with refuses("max_iterations", -1):
        ActiveSet(max_iterations=-1)
    problem = half_space_problem(correlated(8), 0.05)
    with pytest.raises(MissingExtraError, match="arrays='nowhere' needs the library nowhere"):
        ActiveSet(arrays="nowhere").solve(problem, None, PUBLISHED)
    with refuses("arrays", "'json'"):
        ActiveSet(arrays="json").solve(problem, None, PUBLISHED)


@pytest.mark.parametrize(
    ("interface", "force", "contacts", "worst"),
    [
        (RIGID, [1.0, 3.0, 0.0], 2, 0.0),
        (RIGID, [1.0, 3.0, -0.2], 2, 0.1),
        (RIGID, [-1.0, 3.0, 0.0], 2, 1.0),
        (RIGID, [0.0, 0.0, 0.0], 3, 0.0),
        (RIGID, [1.0, 1.0, 1.0], 0, np.inf),
        (RIGID, [np.nan, 3.0, 0.0], 2, np.inf),
        (RIGID, [1.0, 3.0, np.nan], 2, np.inf),
        (Interface(low=-0.2), [2.0, 1.0, -0.6], 3, 0.5),
        (Interface(low=-1.0), [2.0, 1.0, -0.6], 3, 0.0),
        (Interface(high=1.2), [2.0, 1.0, 0.0], 2, 0.8 / 1.5),
        (Interface(external=np.array([-0.5, 0.0, -0.2])), [0.5, 3.0, -0.2], 2, 0.0),
        (Interface(external=np.array([-0.5, 0.0, -0.2])), [-0.7, 3.0, 0.0], 2, 0.2 / 1.4),
    ],
)
def test_forces_beyond_a_bound_or_off_contact_are_violations(interface, force, contacts, worst):
    assert interface.violation(np.array(force), np.arange(3) < contacts) == pytest.approx(worst)


def test_a_violation_knows_what_yields_and_the_smallest_force_that_matters():
    force, touching = np.array([1.0, 0.9, 0.0]), np.array([True, True, False])
    assert Interface(high=1.0).violation(force, touching, touching) == pytest.approx(0.1 / 0.95)
    assert RIGID.violation(np.array([0.0, 0.0, 0.2]), np.zeros(3, bool), smallest_scale=4.0) == 0.05


# Of the modes of (2048, 64) every 33rd is one of the same column.
@pytest.mark.parametrize(
    ("shape", "contacts", "mean", "rel"),
    [
        ((300, 301), 9e4, 0.1, 0.1),
        ((68, 60), 2, 0.0, 0.1),
        ((54, 40), 5, 0.0, 0.1),
        ((2048, 64), 6554, 0.0, 0.05),
    ],
)
def test_pinning_solves_its_condition(shape, contacts, mean, rel):
    lattice = Lattice(shape)
    stiffness, share = lattice.wave_number + mean, contacts / lattice.sites
    sigma = effective_pinning(lattice, stiffness, share)
    # Sampled modes and a coarse root: good to some percent, which is all that it needs to be.
    assert lattice.mean_over_modes(sigma / (stiffness + sigma)) == pytest.approx(share, rel=rel)


@pytest.mark.parametrize(("max_cycles", "solver"), [(40, "Cycles"), (2, "ActiveSet"), (0, "ActiveSet")])
def test_the_solution_says_who_solved(max_cycles, solver):
    rough = np.random.default_rng(0).normal(size=(32, 32))
    contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=30.0)
    system = contact.system()
    problem = system.mechanics.implicit_step(0.0).problem(system.heights, 0.0, system.held())
    found = Multigrid(max_cycles=max_cycles).solve(problem, None, PUBLISHED)
    assert found.solver == solver
    assert found.iterations > max_cycles or solver == "Cycles"
    np.testing.assert_array_equal(found.in_contact, ActiveSet().solve(problem, None, PUBLISHED).in_contact)


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_a_density_of_contacts_has_their_number_and_place(edges):
    lattice, contacts = Lattice((64, 96), edges=edges), np.zeros((64, 96), bool)
    contacts[27:35, 43:51] = True
    sites = FreeSites(lattice, lattice.lam, 1.0, lattice.lam, contacts, library("numpy"))
    density = (1 / sites.long_weight - 1) / free_sites.TUNING.crowding
    assert density.mean() == pytest.approx(contacts.mean(), rel=0.01)  # ripples are clipped
    for axis, (n, m) in enumerate(zip(lattice.shape, sites.coarse.shape, strict=True)):
        # A coarse site stands on a fine one, or in the middle of its cell where edges reflect.
        place = np.arange(m) * n / m if edges == "periodic" else (np.arange(m) + 0.5) * n / m - 0.5
        part = density.sum(axis=1 - axis)
        assert part @ place / part.sum() == pytest.approx(n // 2 - 1.5, abs=0.05 * n / m)


@pytest.mark.parametrize("size", [128, 384])
def test_iterations_do_not_grow_with_the_lattice(size):
    heights = correlated(size, hurst=0.8)
    for pressure in (0.001, 0.03, 0.3):
        problem = half_space_problem(heights, pressure * rms_slope(heights))
        assert ActiveSet().solve(problem, None, PUBLISHED).iterations <= 40


def test_a_cold_start_is_near_the_solution_and_a_coarse_lattice_that_fails_is_no_matter():
    problem = half_space_problem(correlated(256, hurst=0.8), 0.01)
    guess = cold_start(problem, ActiveSet())
    solution = ActiveSet().solve(problem, guess, PUBLISHED)
    assert np.std(guess.u - solution.u) < 0.03 * np.std(solution.u)  # measured 0.025
    failed = cold_start(problem, ActiveSet(max_iterations=1))
    np.testing.assert_array_equal(failed.in_contact, independent_asperities(problem).in_contact)


@pytest.mark.parametrize("unit", [1e-80, 1e80])
def test_units_are_beyond_single_precision_and_no_matter(unit):
    heights = correlated(144)
    usual = ActiveSet().solve(half_space_problem(heights, 0.05), None, PUBLISHED)
    scaled = ActiveSet().solve(half_space_problem(heights, 0.05 * unit, unit), None, PUBLISHED)
    np.testing.assert_array_equal(scaled.in_contact, usual.in_contact)
    assert abs(scaled.iterations - usual.iterations) <= 1  # rounding may tip the balance


def test_double_precision_takes_over_where_single_cannot():
    # Two sites hold a surface so large that eight digits cannot tell its longest waves from none.
    n = 2**16
    heights = np.full(n, -1e6)
    heights[[0, n // 2]] = 0.0
    problem = pulled(heights, lambda lattice: lattice.lam.copy(), 1e-3 / n)
    solution = ActiveSet().solve(problem, Guess(np.zeros(n), heights == 0), PUBLISHED)
    # Two parabolas, each between the sites, of curvature F / N.
    x = np.arange(n // 2)
    expected = 1e-3 / n / 2 * x * (x - n // 2)
    np.testing.assert_allclose(solution.u[: n // 2], expected, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("shape", [(64,), (65, 48), (128, 128)])
def test_another_array_library_finds_the_same(shape):
    pytest.importorskip("array_api_strict")
    heights = np.random.default_rng(0).normal(size=shape)
    for problem in (half_space_problem(heights, 0.05), held_problem(heights, -0.5)):
        here = ActiveSet().solve(problem, None, PUBLISHED)
        there = ActiveSet(arrays="array_api_strict").solve(problem, None, PUBLISHED)
        assert isinstance(there.u, np.ndarray)
        np.testing.assert_array_equal(there.in_contact, here.in_contact)
        np.testing.assert_allclose(there.u, here.u, atol=1e-8)


@pytest.mark.parametrize("size", [96, 160])  # in double precision, and in single
def test_a_solution_errs_no_more_than_it_may_and_takes_less(size):
    heights = correlated(size, hurst=0.8)
    problem, near = (half_space_problem(heights, share * rms_slope(heights)) for share in (0.02, 0.0196))
    exact, guess = (ActiveSet().solve(each, None, PUBLISHED) for each in (problem, near))
    iterations = [ActiveSet().solve(problem, Guess(guess.u), PUBLISHED).iterations]
    for allowed in np.std(exact.u) * np.array([1e-6, 1e-5, 1e-4]):
        for accuracy in (Accuracy(error=float(allowed)), Accuracy(1e-6, float(allowed))):
            found = ActiveSet().solve(problem, Guess(guess.u), accuracy)
            assert np.std(found.u - exact.u) < 4 * allowed
            assert np.mean(found.u - exact.u) ** 2 < (4 * allowed) ** 2
            assert (found.u >= problem.heights).all()
            if accuracy.settled:
                assert np.count_nonzero(found.in_contact ^ exact.in_contact) <= 2
                iterations.append(found.iterations)
    more = itertools.pairwise(iterations)
    assert all(later <= earlier + 1 for earlier, later in more)  # one more revision is an iteration
    assert iterations[-1] < iterations[0]
    assert found.iterations < 0.5 * iterations[0]  # not settled, as a stage of a time step


@pytest.mark.slow
def test_contacts_that_go_round_in_circles_are_solved_accurately(monkeypatch):
    # Nothing but an infinitely stiff apparatus holds the mean, and errors of it move all contacts.
    monkeypatch.setattr(active_set, "TUNING", active_set.Tuning(load_error=np.inf))
    heights = correlated(128, hurst=0.8)
    solid = half_space(modulus=1.0, apparatus=np.inf, flow=(0.5, 1.0))
    start = asp.press(heights, solid, load=0.03 * rms_slope(heights) * heights.size)
    assert asp.age(start, [1e3], hold="separation").final.load < start.load


LAWS = {
    "half-space": half_space(modulus=1.0).on,
    "held half-space": half_space(modulus=1.0, apparatus=50.0).on,
    "layer": layer(modulus=1.0, thickness=6.0, poisson=0.3).on,
}


def stiffness_of(law, lattice):
    if law in LAWS:
        return LAWS[law](lattice).permanent
    one, two = lattice.angles  # no mirror symmetry
    return np.sqrt(one**2 + two**2 + one * two)


def contact_problem(law, shape=(128, 128), spacing=(), load=2e-4, crept=False, level=0.1, edges="periodic"):
    lattice = Lattice(shape, spacing, edges).embedding
    heights = 3 * correlated(max(shape), hurst=0.8)[: shape[0], : shape[1]]
    stiffness = stiffness_of(law, lattice)
    pull = stiffness * lattice.forward(0.2 * np.roll(heights, 7, axis=1)) if crept else 0 * stiffness + 0j
    held = stiffness.flat[0] > 0
    pull.flat[0] = lattice.sites * (
        -stiffness.flat[0] * level * np.ptp(heights) if held else -load * lattice.cell
    )
    return problem_of(lattice, lattice.extended(heights, -np.inf), stiffness, pull)


CASES: dict[str, dict[str, Any]] = {
    "half-space": {"law": "half-space"},
    "stretched": {"law": "half-space", "shape": (64, 1536), "spacing": (37.0, 0.9)},
    "odd": {"law": "half-space", "shape": (125, 131)},
    "one site": {"law": "half-space", "load": 1e-9},
    "crept": {"law": "half-space", "crept": True},
    "held and crept": {"law": "held half-space", "crept": True},
    "layer": {"law": "layer", "level": 0.02},
    "free": {"law": "half-space", "shape": (100, 128), "edges": "free"},
    "slanted": {"law": "slanted", "shape": (125, 131)},
}


@pytest.mark.parametrize("name", CASES)
def test_contacts_are_those_of_the_whole_lattice(name, monkeypatch):
    problem = contact_problem(**CASES[name])
    found = ActiveSet().solve(problem, None, PUBLISHED)
    monkeypatch.setattr(active_set, "solved_on_contacts", lambda _, guess, *__: (guess, 0))
    whole = ActiveSet().solve(problem, None, PUBLISHED)
    assert name == "stretched" or found.iterations <= 5 < whole.iterations
    np.testing.assert_array_equal(found.in_contact, whole.in_contact)
    scale = np.ptp(whole.u)
    np.testing.assert_allclose(found.u, whole.u, atol=1e-8 * scale)


@pytest.mark.slow
def test_crowded_or_reflected_contacts_are_left_to_other_methods():
    problem = contact_problem("half-space", load=0.1)
    crowded = Guess(np.zeros(problem.lattice.shape), problem.heights > -2.0)
    assert solved_on_contacts(problem, crowded, TOLERANCE) == (crowded, 0)
    mirrored = Lattice(problem.lattice.shape, edges="reflecting")
    few = Guess(np.zeros(problem.lattice.shape), problem.heights > -0.5)
    other = replace(problem, lattice=mirrored, stiffness=stiffness_of("half-space", mirrored))
    assert solved_on_contacts(other, few, TOLERANCE) == (few, 0)
    assert solved_on_contacts(problem, few, TOLERANCE)[1] > 1


def test_a_poor_guess_of_the_contacts_is_mended():
    problem = contact_problem("half-space")
    exact = ActiveSet().solve(problem, None, PUBLISHED)
    poor = Guess(np.zeros(problem.lattice.shape), np.roll(exact.in_contact, 20, axis=0))
    found = ActiveSet().solve(problem, poor, PUBLISHED)
    np.testing.assert_array_equal(found.in_contact, exact.in_contact)
