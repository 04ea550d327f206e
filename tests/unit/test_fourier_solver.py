"""The Fourier solver beyond small problems: preconditioner, cold start, precision, other array libraries."""

import itertools

import numpy as np
import pytest

import asperity as asp
from asperity.contact import ActiveSet, active_set
from asperity.contact.arrays import library
from asperity.contact.cascade import cold_start, independent_asperities
from asperity.contact.free_sites import FreeSites, _added_up, _density
from asperity.contact.problem import TOLERANCE, Guess
from asperity.errors import MissingExtraError
from asperity.lattice import Lattice
from asperity.solids import half_space
from tests.problems import problem_of
from tests.refusals import refuses
from tests.surfaces import correlated, uncorrelated


def half_space_problem(heights, pressure, stiffness=1.0):
    lattice = Lattice(heights.shape)
    pull = np.zeros(lattice.spectral_shape, complex)
    pull.flat[0] = -pressure * lattice.sites
    permanent = half_space(modulus=stiffness).on(lattice).permanent
    return problem_of(lattice, heights, permanent, pull)


def held_problem(heights, separation):
    """Springs to neighbors and to a body held at a separation."""
    lattice = Lattice(heights.shape)
    stiffness = lattice.lam + 0.3
    pull = np.zeros(lattice.spectral_shape, complex)
    pull.flat[0] = stiffness.flat[0] * separation * lattice.sites
    return problem_of(lattice, heights, stiffness, pull)


@pytest.mark.parametrize("pressure_ratio", [0.05, 0.3, 0.7, 0.95])
def test_wavy_surface_on_a_half_space_touches_as_in_the_closed_form(pressure_ratio):
    # H. M. Westergaard, J. Appl. Mech. 6, A49 (1939): strips of half-width a, sin^2(pi a / L) = p / p*,
    # where p* = pi E* h / L flattens waves of amplitude h and length L.
    n, waves, amplitude = 4096, 2, 0.7
    length = n / waves
    heights = amplitude * np.cos(2 * np.pi * np.arange(n) / length)
    full = np.pi * amplitude / length
    solution = ActiveSet().solve(half_space_problem(heights, pressure_ratio * full), None, TOLERANCE)
    share = 2 / np.pi * np.arcsin(np.sqrt(pressure_ratio))
    assert np.count_nonzero(solution.in_contact) == pytest.approx(share * n, abs=2 * waves)


def test_iterations_do_not_grow_with_the_lattice():
    for size in (128, 384):
        heights = correlated(size, hurst=0.8)
        slope = np.sqrt(2) * np.std(np.roll(heights, 1, 0) - heights)
        for pressure in (0.001, 0.03, 0.3):
            problem = half_space_problem(heights, pressure * slope)
            assert ActiveSet().solve(problem, None, TOLERANCE).iterations <= 40


@pytest.mark.parametrize("shape", [(96, 64), (300,), (61, 75)])
def test_preconditioner_is_symmetric_and_positive(shape):
    lattice = Lattice(shape)
    rng = np.random.default_rng(0)
    in_contact = rng.uniform(size=shape) < 0.02
    stiffness = lattice.lam + 0.01
    sites = FreeSites(lattice, stiffness, 1.0, stiffness, in_contact, library("numpy"))
    assert sites.waves.longer is not None
    a, b = (np.where(in_contact, 0.0, rng.normal(size=shape)) for _ in range(2))
    ma, mb = sites.waves.respond(a.copy()), sites.waves.respond(b.copy())
    assert np.sum(a * mb) == pytest.approx(np.sum(b * ma), rel=1e-12)
    assert np.sum(a * ma) > 0
    assert not ma[in_contact].any()


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
@pytest.mark.parametrize(("shape", "few"), [((64, 96), (15, 21)), ((64,), (15,))])
def test_a_density_of_contacts_has_their_number_and_place(shape, few, edges):
    coarse, xp = Lattice(few, edges=edges), library("numpy")
    np.testing.assert_allclose(
        _density(_added_up(np.ones(shape, int), xp), coarse, float, xp), 1.0, rtol=1e-12
    )
    contacts = np.zeros(shape, bool)
    contacts[tuple(slice(n // 2 - 5, n // 2 + 3) for n in shape)] = True
    density = _density(_added_up(contacts.astype(int), xp), coarse, float, xp)
    assert density.mean() == pytest.approx(contacts.mean(), rel=0.01)  # ripples are clipped
    for axis, (n, m) in enumerate(zip(shape, few, strict=True)):
        part = density.sum(axis=tuple({0, 1}.intersection(range(len(few))) - {axis}))
        # A coarse site stands on a fine one, or in the middle of its cell where edges reflect.
        place = np.arange(m) * n / m if edges == "periodic" else (np.arange(m) + 0.5) * n / m - 0.5
        assert part @ place / part.sum() == pytest.approx(n // 2 - 1.5, abs=0.05 * n / m)


@pytest.mark.parametrize("heights", [correlated(160), uncorrelated(128), correlated(130)[:, :66]])
def test_a_start_through_coarser_lattices_changes_the_time_not_the_contacts(heights):
    for problem in (half_space_problem(heights, 0.05), held_problem(heights, -1.0)):
        near = ActiveSet().solve(problem, None, TOLERANCE)
        far = ActiveSet().solve(problem, independent_asperities(problem), TOLERANCE)
        np.testing.assert_array_equal(near.in_contact, far.in_contact)
        np.testing.assert_allclose(near.u, far.u, atol=1e-8)


def test_a_cold_start_is_near_the_solution():
    problem = half_space_problem(correlated(256, hurst=0.8), 0.01)
    guess = cold_start(problem, ActiveSet())
    solution = ActiveSet().solve(problem, guess, TOLERANCE)
    assert np.std(guess.u - solution.u) < 0.03 * np.std(solution.u)  # measured 0.025


def test_a_coarse_lattice_that_fails_is_no_matter():
    problem = half_space_problem(correlated(128), 0.05)
    guess = cold_start(problem, ActiveSet(max_iterations=1))
    np.testing.assert_array_equal(guess.in_contact, independent_asperities(problem).in_contact)


@pytest.mark.parametrize("unit", [1e-80, 1e80])
def test_units_are_beyond_single_precision_and_no_matter(unit):
    heights = correlated(144)
    usual = ActiveSet().solve(half_space_problem(heights, 0.05), None, TOLERANCE)
    scaled = ActiveSet().solve(half_space_problem(heights, 0.05 * unit, unit), None, TOLERANCE)
    np.testing.assert_array_equal(scaled.in_contact, usual.in_contact)
    assert abs(scaled.iterations - usual.iterations) <= 1  # rounding may tip the balance


def test_double_precision_takes_over_where_single_cannot():
    # Two sites hold a surface so large that eight digits cannot tell its longest waves from none.
    n = 2**16
    lattice = Lattice((n,))
    heights = np.full(n, -1e6)
    heights[[0, n // 2]] = 0.0
    pull = np.zeros(lattice.spectral_shape, complex)
    pull[0] = -1e-3
    problem = problem_of(lattice, heights, lattice.lam.copy(), pull)
    solution = ActiveSet().solve(problem, Guess(np.zeros(n), heights == 0), TOLERANCE)
    # Two parabolas, each between the sites, of curvature F / N.
    x = np.arange(n // 2)
    expected = -pull[0].real / n / 2 * x * (x - n // 2)
    np.testing.assert_allclose(solution.u[: n // 2], expected, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("shape", [(64,), (65, 48), (128, 128)])
def test_another_array_library_finds_the_same(shape):
    pytest.importorskip("array_api_strict")
    heights = np.random.default_rng(0).normal(size=shape)
    for problem in (half_space_problem(heights, 0.05), held_problem(heights, -0.5)):
        here = ActiveSet().solve(problem, None, TOLERANCE)
        there = ActiveSet(arrays="array_api_strict").solve(problem, None, TOLERANCE)
        assert isinstance(there.u, np.ndarray)
        np.testing.assert_array_equal(there.in_contact, here.in_contact)
        np.testing.assert_allclose(there.u, here.u, atol=1e-8)


def test_array_libraries_are_checked():
    problem = half_space_problem(correlated(8), 0.05)
    with pytest.raises(MissingExtraError, match="arrays='nowhere' needs the library nowhere"):
        ActiveSet(arrays="nowhere").solve(problem, None, TOLERANCE)
    with refuses("arrays"):
        ActiveSet(arrays="json").solve(problem, None, TOLERANCE)


@pytest.mark.parametrize("size", [96, 160])  # in double precision, and in single
def test_a_solution_errs_no_more_than_it_may_and_takes_less(size):
    heights = correlated(size, hurst=0.8)
    slope = np.sqrt(2) * np.std(np.roll(heights, 1, 0) - heights)
    problem, near = (half_space_problem(heights, share * 0.02 * slope) for share in (1.0, 0.98))
    exact, guess = (ActiveSet().solve(each, None, TOLERANCE) for each in (problem, near))
    iterations = [ActiveSet().solve(problem, Guess(guess.u), TOLERANCE).iterations]
    for allowed in np.std(exact.u) * np.array([1e-6, 1e-5, 1e-4]):
        for settled in (True, False):
            found = ActiveSet().solve(problem, Guess(guess.u), TOLERANCE, float(allowed), settled=settled)
            assert np.std(found.u - exact.u) < 4 * allowed
            assert np.mean(found.u - exact.u) ** 2 < (4 * allowed) ** 2
            assert (found.u >= problem.heights).all()
            if settled:
                assert np.count_nonzero(found.in_contact ^ exact.in_contact) <= 2
                iterations.append(found.iterations)
    more = itertools.pairwise(iterations)
    assert all(later <= earlier + 1 for earlier, later in more)  # one more revision is an iteration
    assert iterations[-1] < iterations[0]
    assert found.iterations < 0.5 * iterations[0]  # not settled, as a stage of a time step


def test_contacts_that_go_round_in_circles_are_solved_accurately(monkeypatch):
    # Nothing but an infinitely stiff apparatus holds the mean, and errors of it move all contacts.
    monkeypatch.setattr(active_set, "TUNING", active_set.Tuning(load_error=np.inf))
    heights = correlated(128, hurst=0.8)
    solid = half_space(modulus=1.0, apparatus=np.inf, flow=(0.5, 1.0))
    slope = np.sqrt(2) * np.std(np.roll(heights, 1, 0) - heights)
    start = asp.press(heights, solid, load=0.03 * slope * heights.size)
    assert asp.age(start, [1e3], hold="separation").final.load < start.load
