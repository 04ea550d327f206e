"""Laws of heights, the dilute theory and full contact, against quadrature, brute force and bisection."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.stats import norm

from asperity.theory import (
    EmpiricalHeights,
    ExponentialHeights,
    GaussianHeights,
    compliance,
    contacts_at_start,
    contacts_at_start_paper,
    dilute_area,
    dilute_horizon,
    exponential_growth,
    exponential_growth_paper,
    full_contact_load,
    full_contact_load_relaxed,
    late_slope,
    late_slope_paper,
    site_stiffness,
    static_friction,
    winkler_area,
)


@pytest.fixture
def sample() -> NDArray[np.float64]:
    return np.random.default_rng(5).normal(size=(30, 20))


@pytest.mark.parametrize("d", [-6.0, 0.0, 0.5, 20.0])
def test_gaussian_mean_excess_is_the_integral_of_its_exceedance(d: float) -> None:
    heights = GaussianHeights(rms=0.7)
    tail, _ = quad(
        lambda x: norm.sf(x / 0.7), d, max(d, 0) + 10, epsabs=0, epsrel=1e-12, points=[max(d, 0) + 0.5]
    )
    assert heights.exceedance(d) == pytest.approx(norm.sf(d / 0.7), rel=1e-13)
    assert heights.mean_excess(d) == pytest.approx(tail, rel=1e-10)


def test_gaussian_mean_excess_far_in_the_tail() -> None:
    # phi(x) - x Q(x) = phi(x) (x^-2 - 3 x^-4 + 15 x^-6 - 105 x^-8 ...); at x = 37 the next is 5e-10 of it.
    x = 37.0
    series = norm.pdf(x) * (x**-2 - 3 * x**-4 + 15 * x**-6 - 105 * x**-8)
    assert GaussianHeights().mean_excess(x) == pytest.approx(series, rel=1e-9)


def test_gaussian_separation_inverts_over_six_hundred_decades() -> None:
    heights = GaussianHeights(rms=2.0)
    targets = np.concatenate([np.logspace(-300, 3, 200), [2 * norm.pdf(0.0), 2.0]])
    again = heights.mean_excess(heights.separation_for(targets))
    # d ~ 74 has an error of an ulp, and the tail magnifies that by d.
    assert again == pytest.approx(targets, rel=1e-11)
    assert heights.separation_for(2 * norm.pdf(0.0)) == pytest.approx(0.0, abs=1e-14)
    assert heights.separation_for(1e6) == pytest.approx(-1e6, rel=1e-15)


def test_exponential_law_meets_quadrature_on_both_sides_of_its_edge() -> None:
    heights = ExponentialHeights(rms=0.4)
    for d in (-1.0, 0.0, 2.0):
        tail, _ = quad(
            lambda x: float(heights.exceedance(x)), d, 20, points=[0.0, 2.0], epsabs=1e-14, epsrel=1e-12
        )
        assert heights.mean_excess(d) == pytest.approx(tail, rel=1e-10)
    targets = np.array([1e-200, 1e-3, 0.4, 0.9, 50.0])
    assert heights.mean_excess(heights.separation_for(targets)) == pytest.approx(targets, rel=1e-12)
    assert heights.exceedance(-1e-9) == 1.0
    assert heights.exceedance(0.4) == pytest.approx(math.exp(-1), rel=1e-15)


def test_empirical_law_against_brute_force(sample: NDArray[np.float64]) -> None:
    heights = EmpiricalHeights(sample)
    for d in (-10.0, -0.3, 0.0, 2.0, float(sample[3, 4]), float(sample.max()), 9.0):
        assert heights.exceedance(d) == np.mean(sample > d)
        assert heights.mean_excess(d) == pytest.approx(
            np.mean(np.maximum(sample - d, 0)), rel=1e-12, abs=1e-16
        )


def test_empirical_inverse_is_exact_between_and_at_the_knots(sample: NDArray[np.float64]) -> None:
    heights = EmpiricalHeights(sample)
    targets = np.concatenate([np.logspace(-9, 2, 300), heights.mean_excess(np.sort(sample.ravel())[:-1])])
    found = heights.separation_for(targets)
    brute = np.maximum(sample.ravel() - found[:, None], 0).mean(axis=1)
    # d has an error of an ulp of the heights, 4e-16, whatever the target.
    assert brute == pytest.approx(targets, rel=1e-12, abs=1e-15)


def test_empirical_law_knows_ties_and_single_sites() -> None:
    tied = EmpiricalHeights([1.0, 1.0, 0.0, 0.0])
    assert tied.separation_for([0.25, 0.5, 1.0]) == pytest.approx([0.5, 0.0, -0.5])
    assert tied.exceedance(tied.separation_for(0.25)) == 0.5
    given = np.array([3.0])
    single = EmpiricalHeights(given)
    given += 1  # the heights were copied
    assert single.separation_for(0.5) == 2.5
    assert single.mean_excess([2.5, 3.0, 4.0]) == pytest.approx([0.5, 0.0, 0.0])


def test_dilute_area_against_bisection() -> None:
    load, soft = 2e-3, 0.6
    low, high = -5.0, 10.0
    for _ in range(100):
        d = (low + high) / 2
        low, high = (d, high) if norm.pdf(d) - d * norm.sf(d) > load * soft else (low, d)
    assert dilute_area(load, soft, GaussianHeights()) == pytest.approx(norm.sf(d), rel=1e-12)


def test_exponential_heights_grow_like_the_compliance() -> None:
    x2 = np.array([0.0, 1.0, 1e5, 1e10])
    area = dilute_area(1e-6, compliance(3.0, x2) / 2.5, ExponentialHeights(rms=0.3))
    assert area == pytest.approx(1e-6 * compliance(3.0, x2) / 2.5 / 0.3, rel=1e-13)
    assert exponential_growth(3.0, x2) == pytest.approx(area / area[0], rel=1e-12)


def test_the_papers_growth_is_the_corrected_one_with_k1_for_k_eff() -> None:
    x1, x2 = np.array([0.1, 1.0, 10.0]), 1e6
    ratio = (exponential_growth_paper(x1, x2) - 1) / (exponential_growth(x1, x2) - 1)
    assert ratio == pytest.approx(x1 / site_stiffness(x1), rel=1e-9)
    # Where the springs are far stiffer than the neighbors' the paper is right.
    assert exponential_growth_paper(1e5, x2) == pytest.approx(float(exponential_growth(1e5, x2)), rel=1e-4)
    # On the line with R_tilde, against the definition.
    line = compliance(2.0, x2, 0.5, 1)
    assert exponential_growth(2.0, x2, 0.5, 1) == pytest.approx(line * math.sqrt(12), rel=1e-12)
    assert exponential_growth_paper(2.0, x2, 0.5, 1) == pytest.approx(
        1 + 2 * (line - 1 / math.sqrt(12)), rel=1e-12
    )


def test_contacts_at_start_are_the_dilute_area() -> None:
    sites, load, rms, k0 = 1e8, 20.0, 0.3, 2.5
    for dimension in (1, 2):
        area = dilute_area(load / sites, compliance(3.0, 0.0, 0.0, dimension) / k0, ExponentialHeights(rms))
        assert contacts_at_start(load, rms, 3.0, k0=k0, dimension=dimension) == pytest.approx(
            sites * area, rel=1e-12
        )
    # The paper's: every contact a bare spring.
    springs = winkler_area(load / sites, 3.0 * k0, ExponentialHeights(rms))
    assert contacts_at_start_paper([load, 2 * load], rms, 3.0, k0=k0) == pytest.approx(
        sites * springs * np.array([1, 2]), rel=1e-12
    )


@pytest.mark.parametrize("viscous", [0.0, 0.5])
def test_late_slope_is_that_of_the_growth(viscous: float) -> None:
    x1, x2, step = np.array([0.3, 3.0, 30.0]), 1e13, 1e-2
    ends = exponential_growth(x1, x2 * np.exp(np.array([[-step], [step]])), viscous)
    assert late_slope(x1, viscous) == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5)


def test_the_papers_late_slope_is_right_where_springs_are_hard() -> None:
    assert late_slope_paper([1.0, 10.0]) == pytest.approx([0.04, 0.4])
    assert late_slope_paper(1e4) == pytest.approx(float(late_slope(1e4)), rel=6e-3)
    assert late_slope_paper(1.0) < 0.3 * late_slope(1.0)


def test_static_friction_is_the_shear_strength_of_the_contacts_over_the_load() -> None:
    # 375 sites of shear strength 1.6 under a load of 800.
    assert static_friction(375, 800.0, 1.6) == pytest.approx(0.75)
    growing = static_friction([375, 750], [[800.0], [1600.0]], 1.6)
    assert growing == pytest.approx(np.array([[0.75, 1.5], [0.375, 0.75]]))
    assert isinstance(static_friction(1.0, 1.0, 1.0), float)


def test_winkler_area_against_springs_one_by_one(sample: NDArray[np.float64]) -> None:
    k1, d = 1.7, 0.4
    load = np.mean(k1 * np.maximum(sample - d, 0))
    assert winkler_area(load, k1, EmpiricalHeights(sample)) == np.mean(sample > d)
    gauss = k1 * (norm.pdf(d) - d * norm.sf(d))
    assert winkler_area(gauss, k1, GaussianHeights()) == pytest.approx(norm.sf(d), rel=1e-13)


def test_horizon_is_where_the_dips_meet() -> None:
    # One contact in 100 sites: spacing 10 on the square lattice, 100 on the line.
    assert dilute_horizon(0.01) == pytest.approx(10.0**4)
    assert dilute_horizon([0.01, 1.0], dimension=1) == pytest.approx([100.0**4, 1.0])


@pytest.mark.parametrize("shape", [(9,), (5, 6)])
def test_full_contact_forces_just_reach_zero(shape: tuple[int, ...]) -> None:
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
    before = full_contact_load(xi, k0=k0, k1=k1) / xi.size
    after = full_contact_load_relaxed(xi, k0=k0) / xi.size
    offset = xi.mean() - before / k1
    forces = pull + k1 * (xi - offset)
    assert forces.min() == pytest.approx(0, abs=1e-12)
    assert forces.sum() == pytest.approx(before * xi.size)
    assert (pull + after).min() == pytest.approx(0, abs=1e-12)


def test_full_contact_of_a_cosine() -> None:
    n, m, k0, k1, height = 12, 3, 1.5, 2.5, 0.2
    x = np.arange(n)
    lam = 2 - 2 * math.cos(2 * np.pi * m / n)
    line = height * np.cos(2 * np.pi * m * x / n)
    assert full_contact_load(line, k0=k0, k1=k1) == pytest.approx(n * (k1 + k0 * lam) * height)
    assert full_contact_load_relaxed(line, k0=k0) == pytest.approx(n * k0 * lam * height)
    assert full_contact_load(line[None, :] + np.zeros((4, 1)), k0=k0, k1=k1) == pytest.approx(
        4 * n * (k1 + k0 * lam) * height
    )
    assert full_contact_load(np.ones((3, 3)), k0=1.0, k1=1.0) == 0.0
