"""Laws of heights, the dilute theory and full contact: beside quadrature, brute force and bisection."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

import asperity as asp

T = asp.theory
GAUSS = T.GaussianHeights()


# -- Laws of heights -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("heights", [T.GaussianHeights(0.7), T.ExponentialHeights(0.4)])
def test_mean_excess_is_the_integral_of_the_exceedance(heights):
    for d in (-6.0, 0.0, 0.5, 14.0):
        where = max(d, 0.0)
        tail, _ = quad(heights.exceedance, where, where + 20, epsabs=0, epsrel=1e-12, points=[where + 0.5])
        if d < 0:
            tail += quad(heights.exceedance, d, 0, epsabs=0, epsrel=1e-12)[0]
        assert heights.mean_excess(d) == pytest.approx(tail, rel=1e-10)


def test_gaussian_separation_inverts_over_six_hundred_decades():
    heights = T.GaussianHeights(rms=2.0)
    assert heights.exceedance([-1.0, 2.0]) == pytest.approx(norm.sf([-0.5, 1.0]), rel=1e-13)
    # phi(x) - x Q(x) = phi(x) (x^-2 - 3 x^-4 + 15 x^-6 - 105 x^-8 ...); at x = 37 the next is 5e-10 of it.
    x = 37.0
    series = norm.pdf(x) * (x**-2 - 3 * x**-4 + 15 * x**-6 - 105 * x**-8)
    assert GAUSS.mean_excess(x) == pytest.approx(series, rel=1e-9)
    targets = np.concatenate([np.logspace(-300, 3, 200), [2 * norm.pdf(0.0), 2.0]])
    again = heights.mean_excess(heights.separation_for(targets))
    # d ~ 74 has an error of an ulp, and the tail magnifies that by d.
    assert again == pytest.approx(targets, rel=1e-11)
    assert heights.separation_for(2 * norm.pdf(0.0)) == pytest.approx(0.0, abs=1e-14)


def test_exponential_law_inverts_on_both_sides_of_its_edge():
    heights = T.ExponentialHeights(rms=0.4)
    targets = np.array([1e-200, 1e-3, 0.4, 0.9, 50.0])
    assert heights.mean_excess(heights.separation_for(targets)) == pytest.approx(targets, rel=1e-12)
    assert heights.exceedance([-1e-9, 0.4]) == pytest.approx([1.0, math.exp(-1)], rel=1e-15)


def test_empirical_law_against_brute_force():
    sample = np.random.default_rng(5).normal(size=(30, 20))
    heights = T.EmpiricalHeights(sample)
    for d in (-10.0, -0.3, 0.0, 2.0, sample[3, 4], sample.max(), 9.0):
        assert heights.exceedance(d) == np.mean(sample > d)
        expected = np.mean(np.maximum(sample - d, 0))
        assert heights.mean_excess(d) == pytest.approx(expected, rel=1e-12, abs=1e-16)
    targets = np.concatenate([np.logspace(-9, 2, 300), heights.mean_excess(np.sort(sample.ravel())[:-1])])
    found = heights.separation_for(targets)
    brute = np.maximum(sample.ravel() - found[:, None], 0).mean(axis=1)
    # d has an error of an ulp of the heights, 4e-16, whatever the target.
    assert brute == pytest.approx(targets, rel=1e-12, abs=1e-15)


def test_empirical_law_knows_ties_and_single_sites():
    tied = T.EmpiricalHeights([1.0, 1.0, 0.0, 0.0])
    assert tied.separation_for([0.25, 0.5, 1.0]) == pytest.approx([0.5, 0.0, -0.5])
    assert tied.exceedance(tied.separation_for(0.25)) == 0.5
    given = np.array([3.0])
    single = T.EmpiricalHeights(given)
    given += 1  # the heights were copied
    assert single.separation_for(0.5) == 2.5
    assert single.mean_excess([2.5, 3.0, 4.0]) == pytest.approx([0.5, 0.0, 0.0])


# -- Constant load -------------------------------------------------------------------------------------------


def test_dilute_and_winkler_area_against_bisection_and_springs_one_by_one():
    load, soft = 2e-3, 0.6
    low, high = -5.0, 10.0
    for _ in range(100):
        d = (low + high) / 2
        low, high = (d, high) if norm.pdf(d) - d * norm.sf(d) > load * soft else (low, d)
    assert T.dilute_area(load, soft, GAUSS) == pytest.approx(norm.sf(d), rel=1e-12)
    sample = np.random.default_rng(5).normal(size=600)
    mean = np.mean(1.7 * np.maximum(sample - 0.4, 0))
    assert T.winkler_area(mean, 1.7, T.EmpiricalHeights(sample)) == np.mean(sample > 0.4)


@pytest.mark.parametrize(("viscous", "dimension"), [(0.0, 2), (0.5, 1)])
def test_exponential_heights_grow_like_the_compliance(viscous, dimension):
    x2, sites, load, rms, k0 = np.array([0.0, 1.0, 1e5, 1e10]), 1e8, 20.0, 0.3, 2.5
    soft = T.compliance(3.0, x2, viscous, dimension)
    area = T.dilute_area(load / sites, soft / k0, T.ExponentialHeights(rms))
    assert sites * area == pytest.approx(load * soft / k0 / rms, rel=1e-12)
    assert T.exponential_growth(3.0, x2, viscous, dimension) == pytest.approx(area / area[0], rel=1e-12)
    start = T.contacts_at_start(load, rms, 3.0, k0=k0, dimension=dimension)
    assert start == pytest.approx(sites * area[0], rel=1e-12)
    # The paper takes k1 for k_eff in both.
    growth = 1 + 3.0 * (soft - soft[0])
    assert T.exponential_growth_paper(3.0, x2, viscous, dimension) == pytest.approx(growth, rel=1e-12)
    springs = T.winkler_area(load / sites, 3.0 * k0, T.ExponentialHeights(rms))
    paper = T.contacts_at_start_paper([load, 2 * load], rms, 3.0, k0=k0)
    assert paper == pytest.approx(sites * springs * np.array([1, 2]), rel=1e-12)


@pytest.mark.parametrize("viscous", [0.0, 0.5])
def test_late_slope_is_that_of_the_growth(viscous):
    x1, x2, step = np.array([0.3, 3.0, 30.0]), 1e13, 1e-2
    ends = T.exponential_growth(x1, x2 * np.exp(np.array([[-step], [step]])), viscous)
    assert T.late_slope(x1, viscous) == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5)
    # The paper's is right where springs are hard, and rounded.
    assert T.late_slope_paper([1.0, 10.0]) == pytest.approx([0.04, 0.4])


def test_static_friction_is_the_shear_strength_of_the_contacts_over_the_load():
    # 375 sites of shear strength 1.6 under a load of 800.
    growing = T.static_friction([375, 750], [[800.0], [1600.0]], 1.6)
    assert growing == pytest.approx(np.array([[0.75, 1.5], [0.375, 0.75]]))
    assert isinstance(T.static_friction(1.0, 1.0, 1.0), float)


def test_horizon_is_where_the_dips_meet():
    # One contact in 100 sites: spacing 10 on the square lattice, 100 on the line.
    assert T.dilute_horizon(0.01) == pytest.approx(10.0**4)
    assert T.dilute_horizon([0.01, 1.0], dimension=1) == pytest.approx([100.0**4, 1.0])


@pytest.mark.parametrize("shape", [(9,), (5, 6)])
def test_full_contact_forces_just_reach_zero(shape):
    """Forces of the surface u = xi, bond by bond, at the loads that are claimed."""
    k0, k1 = 1.2, 0.7
    xi = np.random.default_rng(3).normal(size=shape)
    pull = np.zeros(shape)
    for site in np.ndindex(shape):
        for axis, length in enumerate(shape):
            for step in (1, -1):
                other = list(site)
                other[axis] = (other[axis] + step) % length
                pull[site] += k0 * (xi[site] - xi[tuple(other)])
    before = T.full_contact_load(xi, k0=k0, k1=k1) / xi.size
    after = T.full_contact_load_relaxed(xi, k0=k0) / xi.size
    offset = xi.mean() - before / k1
    forces = pull + k1 * (xi - offset)
    assert forces.min() == pytest.approx(0, abs=1e-12)
    assert forces.sum() == pytest.approx(before * xi.size)
    assert (pull + after).min() == pytest.approx(0, abs=1e-12)


# -- A load that changes -------------------------------------------------------------------------------------


def test_growing_load_is_the_hereditary_integral():
    load = 1e-5 * np.array([0, 10, 30, 30])
    area = T.dilute_history([0, 10, 10, 50], load, k0=2.0, x1=1.0, heights=GAUSS)
    ramp, _ = quad(lambda y: float(T.compliance(1.0, y)), 40, 50, epsrel=1e-12)
    compression = 1e-5 * (ramp + 20 * T.compliance(1.0, 40.0)) / 2
    assert area[-1] == pytest.approx(norm.sf(GAUSS.separation_for(compression)), rel=1e-10)


@pytest.mark.parametrize(
    ("heights", "viscous", "dimension"),
    [(GAUSS, 0.0, 2), (T.ExponentialHeights(2.0), 0.3, 2), (T.GaussianHeights(0.7), 0.0, 1)],
)
def test_constant_load_is_the_closed_form(heights, viscous, dimension):
    """Also as the population has it, which follows a fall, of nearly nothing, at the end."""
    times = np.concatenate([[0.0, 0.0], np.logspace(-1, 6, 8), [1e6 + 1e-9, 2e6]])
    # A load that is constant but for rounding is constant.
    load = 4e-4 * (1 + 1e-15 * (-1.0) ** np.arange(times.size))
    load[0], load[-2:] = 0.0, 4e-4 * (1 - 1e-9)
    area = T.dilute_history(
        times, load, k0=1.7, x1=3.0, heights=heights, viscous=viscous, dimension=dimension
    )
    closed = T.dilute_area(4e-4, T.compliance(3.0, times[1:], viscous, dimension) / 1.7, heights)
    assert area[0] == 0
    assert area[1:-2] == pytest.approx(closed[:-2], rel=1e-11)
    assert area[-2:] == pytest.approx(closed[-2:], rel=1e-4)


def cycle(t):
    """Load up, hold, down to a tenth, hold, up."""
    return np.interp(t, [0, 4, 10, 12, 24, 30, 40], [0, 1, 1, 0.1, 0.1, 1.2, 1.2])


def brute_force(heights, load, step, *solid):
    """Count the contacts of equal heights: steps of one length, sums over the whole past, bisection.

    Up to the time 40, for k0 = 1; a force changes in the middle between two grid times.
    """
    kernel = T.compliance(solid[0], step * (np.arange(round(40 / step)) + 0.5), *solid[1:])
    increments = np.zeros((kernel.size, heights.size))
    force = np.zeros(heights.size)
    counts = np.zeros(kernel.size)
    for n in range(kernel.size):
        past = np.tensordot(kernel[n:0:-1], increments[:n], axes=1)

        def pressed(d, past=past, force=force):
            return np.maximum(force + (heights - d - past) / kernel[0], 0.0)

        low, high = -10.0, heights.max() + 10
        for _ in range(60):
            middle = (low + high) / 2
            too_low = pressed(middle).sum() > load * cycle((n + 1) * step)
            low, high = (middle, high) if too_low else (low, middle)
        increments[n] = pressed(high) - force
        force = force + increments[n]
        counts[n] = np.count_nonzero(force)
    return counts


@pytest.mark.parametrize(("x1", "viscous", "dimension"), [(3.0, 0.0, 2), (0.5, 0.5, 1)])
def test_unloading_counts_a_handful_of_asperities_like_brute_force(x1, viscous, dimension):
    heights, step, at = np.random.default_rng(6).normal(size=12), 0.05, np.arange(41)
    law, load = T.EmpiricalHeights(heights), 8 / 12 * cycle(at)
    area = T.dilute_history(at, load, k0=2.0, x1=x1, heights=law, viscous=viscous, dimension=dimension)
    counts = brute_force(2.0 * heights, 8, step, x1, viscous, dimension)
    expected = counts[np.round(at[1:] / step).astype(int) - 1]
    assert (12 * area[1:]).round(9).tolist() == expected.tolist()
    assert len(set(expected.tolist())) > 4


def test_unloading_a_gaussian_surface_like_brute_force():
    # 1200 heights of equal probability in the tail above 2.5, that hold all contacts.
    count, tail = 1200, norm.sf(2.5)
    heights = norm.isf(tail * (np.arange(count) + 0.5) / count)
    step, at = 0.1, np.array([0, 4, 10, 11, 12, 18, 24, 27, 30, 40])
    counts = brute_force(heights, 2e-3 * count / tail, step, 3.0)
    area = T.dilute_history(at, 2e-3 * cycle(at), k0=1.0, x1=3.0, heights=GAUSS)
    expected = tail / count * counts[np.round(at[1:] / step).astype(int) - 1]
    # To one asperity of the brute force.
    assert area[1:] == pytest.approx(expected, rel=0, abs=tail / count)
    assert expected[2] < expected[1]


def test_without_load_nothing_touches_and_dips_heal():
    load = 1e-3 * np.array([0, 1, 1, 0, 0, 1, 1, 0])
    times = np.array([0, 0, 1e3, 1e3, 2e3, 2e3, 1e8, 1e8])
    area = T.dilute_history(times, load, k0=1.0, x1=3.0, heights=GAUSS)
    fresh, crept = T.dilute_area(1e-3, T.compliance(3.0, [0.0, 1e3]), GAUSS)
    assert area[[0, 3, 4, 7]].tolist() == [0, 0, 0, 0]
    assert area[1:3] == pytest.approx([fresh, crept], rel=1e-11)
    # Reloaded after a rest: between a fresh contact and the old one.
    assert fresh * 1.001 < area[5] < crept
    # A rest of 1e11 leaves of a dip of 1e3 a part of 1e-8.
    times[4:6], times[6:] = 1e11, 2e11
    healed = T.dilute_history(times, load, k0=1.0, x1=3.0, heights=GAUSS)
    assert healed[5] == pytest.approx(fresh, rel=2e-4)


def test_heights_too_low_to_be_followed_do_not_touch():
    def touching(x2, load):
        heights = T.EmpiricalHeights([1.0, 1.0, 2.0, 0.5])
        return T.dilute_history(x2, load, k0=1.0, x1=3.0, heights=heights).tolist()

    assert touching([0, 1, 2, 3], [1e-3, 5e-4, 0, 2e-3]) == [0.25, 0.25, 0, 0.25]
    assert touching([0, 1, 2], [50, 20, 20]) == [1, 1, 1]
