"""A site under a force, and the dip around it: beside sums over modes, closed forms and quadrature."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.special import ive

import asperity as asp

T = asp.theory
# (x1, x2, viscous, dimension), G, dG/dx2. Origin: tanh-sinh quadrature with 25 digits in the library mpmath
# (1.4.1), over ln lam below 2 and graded toward lam = 4 (square), over ln q (line). The corners of the range.
MANY_DIGITS = [
    ((1e-3, 0, 0, 2), 0.825402973454055189, 7.45742235584010323e-7),
    ((1e-3, 1e15, 0, 2), 1.67301654446333314, 3.97881783735724118e-17),
    ((1e4, 1e15, 0, 2), 1.67301542938587212, 3.97887359123028515e-17),
    ((3, 1e4, 0.01, 2), 0.720416978554639937, 6.14968943140700206e-6),
    ((1e-3, 1e15, 1e6, 2), 4.16963975745738713, 7.95774715459475916e-17),
    ((1e4, 1e-4, 1e6, 2), 0.688096035666510736, 796.772552803189933),
    ((10, 0.3, 1, 2), 0.27286317362398861, 0.212779811427011753),
    ((1e-3, 1e3, 0.01, 2), 0.826725374352116727, 1.22183032304573794e-6),
    ((1e-3, 1e15, 1e6, 1), 17841241161.5277111, 8.92062058076385557e-6),
    ((1e4, 1e15, 0, 1), 2193.48122543402976, 5.48370309563231014e-13),
    ((3, 1, 0, 1), 0.422313052236456967, 0.0921338795220825287),
    ((0.5, 0.02, 30, 1), 0.774760820327963202, 5.19179206730846464),
]
# x1, x2 and viscous, to be broadcast.
GRID = np.array([1e-3, 3.0, 1e4])[:, None, None], np.array([[0.0], [1.0], [1e4], [1e12]]), [0.0, 1e-2, 1e6]


def modes(shape):
    """Wave vectors (axes, ...) of a torus, and lam, without the mode of lam = 0."""
    q = np.array(np.meshgrid(*(2 * np.pi * np.arange(n) / n for n in shape), indexing="ij"))
    q = q.reshape(len(shape), -1)[:, 1:]
    return q, np.sum(2 - 2 * np.cos(q), axis=0)


def depth(lam, x1, x2, viscous):
    """Of a mode, as the definition has it."""
    return (1 - x1 / lam * np.expm1(-x2 * x1 * lam * (lam + viscous) / (x1 + lam))) / (x1 + lam)


# -- Under a constant force ----------------------------------------------------------------------------------


def test_compliance_has_fourteen_digits_at_the_corners():
    for point, depth, rate in MANY_DIGITS:
        assert T.compliance(*point) == pytest.approx(depth, rel=1e-14)
        assert T.compliance_rate(*point) == pytest.approx(rate, rel=1e-14)


@pytest.mark.parametrize("dimension", [1, 2])
def test_site_stiffness_against_a_random_walk(dimension):
    # 1/(x1 + lam) = int exp(-(x1 + lam) s) ds, and the mean of exp(-lam s) is [exp(-2 s) I0(2 s)]^dimension.
    for x1 in (0.05, 30.0):

        def walk(s, x1=x1):
            return math.exp(-x1 * s) * ive(0, 2 * s) ** dimension

        reference, _ = quad(walk, 0, 40 / x1, limit=400, epsabs=0, epsrel=1e-12)
        assert 1 / T.site_stiffness(x1, dimension) == pytest.approx(reference, rel=1e-11)
    # K(m) -> ln(4/sqrt(1 - m)) as m -> 1, with 1 - m -> x1/2.
    assert T.site_stiffness(1e-12) == pytest.approx(4 * math.pi / math.log(32 / 1e-12), rel=1e-11)


@pytest.mark.parametrize("shape", [(1,), (5,), (4, 6), (3, 5)])
def test_torus_against_the_sum_over_every_mode(shape):
    _, lam = modes(shape)
    for x2 in (0.0, 0.3, 20.0, np.inf):
        expected = (1 / 1.7 + depth(lam, 1.7, x2, 0.4).sum()) / math.prod(shape)
        assert T.torus_compliance(1.7, x2, shape, 0.4) == pytest.approx(expected, rel=1e-12)


def test_compliance_follows_from_the_equations_of_motion():
    """Integrate Eqs. (us), (dosrs) on a small torus, in real space, with matrices."""
    n, m, k0, k1, R, viscous, t = 4, 5, 1.3, 2.1, 0.6, 0.7, 3.0
    one = np.eye(n * m)
    laplacian = sum(
        np.roll(one.reshape(n, m, n * m), s, a).reshape(n * m, n * m) for s in (1, -1) for a in (0, 1)
    )
    laplacian = laplacian - 4 * one
    force = one[0]
    # u = S (k1 u0 + f), du0/dt = (R Lap - R_tilde) k1 (u0 - u) = B u0 + b
    solve = np.linalg.inv(k1 * one - k0 * laplacian)
    mobility = R * laplacian - viscous * R * one
    B = k1 * mobility @ (one - k1 * solve)
    b = -k1 * mobility @ solve @ force
    augmented = np.block([[B, b[:, None]], [np.zeros((1, n * m + 1))]])
    u0 = expm(augmented * t)[:-1, -1]
    u = solve @ (k1 * u0 + force)
    expected = k0 * (u[0] - u0.mean())
    assert T.torus_compliance(k1 / k0, k0 * R * t, (n, m), viscous) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("dimension", "viscous", "order"), [(2, 0.0, 0.5), (2, 0.3, 1.0), (1, 0.0, 0.25), (1, 0.3, 0.5)]
)
def test_each_asymptotic_term_gains_its_order(dimension, viscous, order):
    x1, x2 = np.array([[0.5], [100.0]]), np.array([1e6, 1e8])
    exact = T.compliance(x1, x2, viscous, dimension)
    leading = exact - T.compliance_asymptote(x2, viscous, dimension)
    both = exact - T.compliance_asymptote(x2, viscous, dimension, x1=x1)
    # What the leading term misses falls as x2^(-order) and is the second term; what both miss is far smaller.
    second = leading - both
    assert np.log(second[:, 0] / second[:, 1]) / math.log(100) == pytest.approx([order] * 2, rel=1e-3)
    assert (np.abs(both) < 0.02 * np.abs(leading))[:, 0].all()


def test_late_slope_and_intercept_are_the_numbers_of_the_paper():
    assert pytest.approx(0.04, abs=5e-4) == T.LATE_SLOPE
    assert pytest.approx(0.3, abs=2e-3) == T.LATE_INTERCEPT
    assert T.compliance_asymptote_paper([1.0, math.e]) == pytest.approx([0.3, 0.34], rel=1e-15)


def test_arguments_broadcast_block_by_block_and_scalars_give_floats():
    x1, x2 = np.array([0.1, 1.0, 10.0])[:, None], np.linspace(0, 5e3, 2500)
    table = T.compliance(x1, x2, 0.1)
    assert table.shape == (3, 2500)
    assert table[2, 1800] == pytest.approx(float(T.compliance(10.0, x2[1800], 0.1)), rel=1e-14)
    assert isinstance(T.compliance(1.0, 1.0), float)
    assert isinstance(T.torus_compliance(1.0, 1.0, (4, 4)), float)
    assert T.compliance(np.zeros((0, 2)) + 1, 1.0).shape == (0, 2)


# -- Of other dispersions ------------------------------------------------------------------------------------


@pytest.mark.parametrize("dimension", [1, 2])
def test_the_lattice_as_a_function_is_the_lattice(dimension):
    def sines(*q):
        return sum(4 * np.sin(component / 2) ** 2 for component in q)

    for measure in (T.compliance, T.compliance_rate):
        known = measure(*GRID, dimension)
        assert measure(*GRID, dimension, dispersion=sines) == pytest.approx(known, rel=1e-12)


@pytest.mark.parametrize(("law", "power"), [("continuum", 2), (lambda *q: np.sqrt(sum(x**2 for x in q)), 1)])
def test_other_dispersions_against_integrals_in_polar_coordinates(law, power):
    x1, x2, r = 0.7, 20.0, 0.3

    def ray(angle):
        edge = math.pi / math.cos(angle)
        return quad(lambda q: q * depth(q**power, x1, x2, r), 0, edge, epsabs=0, epsrel=1e-12)[0]

    reference = 2 / math.pi**2 * quad(ray, 0, math.pi / 4, epsabs=0, epsrel=1e-11)[0]
    assert T.compliance(x1, x2, r, dispersion=law) == pytest.approx(reference, rel=1e-10)
    line = quad(lambda q: depth(q**power, x1, x2, r), 0, math.pi, epsabs=0, epsrel=1e-12)[0] / math.pi
    assert T.compliance(x1, x2, r, 1, dispersion=law) == pytest.approx(line, rel=1e-11)


def test_stiffer_along_one_axis_is_allowed():
    # Before creep and at large x1: <1/(x1 + lam)> = 1/x1 - <lam>/x1^2 + ..., and <lam> = 2 + 2 * 9.
    soft = T.compliance(1e6, 0.0, dispersion=lambda qx, qy: 2 - 2 * np.cos(qx) + 9 * (2 - 2 * np.cos(qy)))
    assert 1 - 1e6 * soft == pytest.approx(20 / 1e6, rel=1e-4)


# -- Beside the force ----------------------------------------------------------------------------------------


def torus_sum(offset, x1, x2, viscous, length):
    """The dip on a torus, with lam = 0 as on the infinite lattice: it sinks by r x2 per site."""
    q, lam = modes((length,) * len(offset))
    waves = np.prod(np.cos(np.array(offset)[:, None] * q), axis=0)
    return (1 / x1 + viscous * x2 + depth(lam, x1, x2, viscous) @ waves) / (lam.size + 1)


@pytest.mark.parametrize(("x2", "viscous"), [(0.0, 0.0), (1.0, 0.3), (1e4, 0.0)])
def test_a_torus_that_is_large_enough_has_the_same_dip_and_so_has_a_ring(x2, viscous):
    # The images of the load are 724 and more sites away, on the ring 3797.
    for offsets, length, most in ([(3, 4), (200, 300)], 1024, 1e-14), (np.arange(300)[:, None], 4096, 1e-13):
        expected = [torus_sum(offset, 3.0, x2, viscous, length) for offset in offsets]
        found = T.displacement(offsets, 3.0, x2, viscous, dimension=len(offsets[0]))
        assert found == pytest.approx(expected, rel=0, abs=most)


@pytest.mark.parametrize("dimension", [1, 2])
def test_at_the_load_it_is_the_compliance(dimension):
    here = np.zeros(dimension, dtype=int)
    expected = T.compliance(*GRID, dimension)
    assert T.displacement(here, *GRID, dimension) == pytest.approx(expected, rel=1e-13)


def test_late_it_falls_off_like_the_potential_kernel_of_the_lattice():
    # Spitzer, Principles of Random Walk (1976), section 15: G(0) - u(r) -> a(r), a quarter of his.
    sites = [(1, 0), (1, 1), (2, 0), (2, 1), (2, 2)]
    kernel = np.array([1 / 4, 1 / math.pi, 1 - 2 / math.pi, 2 / math.pi - 1 / 4, 4 / (3 * math.pi)])
    for x1 in (0.5, 20.0):
        fall = T.compliance(x1, 1e14) - T.displacement(sites, x1, 1e14)
        # What is missing falls as r^2 / sqrt(x2).
        assert fall == pytest.approx(kernel, rel=0, abs=1e-7)
    # Far away, but well within the dip: (ln r + gamma_E + 3/2 ln 2) / (2 pi) + O(r^-2).
    far = T.compliance(3.0, 1e20) - T.displacement((240, 320), 3.0, 1e20)
    closed = (math.log(400) + np.euler_gamma + 1.5 * math.log(2)) / (2 * math.pi)
    assert far == pytest.approx(closed, rel=0, abs=1e-6)


def test_signs_shapes_and_scalars():
    table = T.displacement([(2, -1), (-2, 1), (1, 2)], 3.0, np.array([0.0, 5.0])[:, None])
    assert table == pytest.approx(np.tile(table[:, :1], 3), rel=1e-13)
    assert isinstance(T.displacement((1, 0), 1.0, 1.0), float)
    assert T.displacement(-3, 1.0, 1.0, dimension=1) == T.displacement([3], 1.0, 1.0, dimension=1)
    assert T.displacement(np.zeros((0, 2), dtype=int), 1.0, 1.0).shape == (0,)


# -- Under a force that changes ------------------------------------------------------------------------------


@pytest.mark.parametrize("solid", [(0.02, 0.0, 2), (200.0, 0.4, 2), (3.0, 0.0, 1), (0.5, 30.0, 1)])
def test_a_step_is_the_compliance(solid):
    x1, *others = solid
    times = np.concatenate([[0.0, 0.0], np.logspace(-3, 14, 35)])
    force = np.full(times.size, 2.0)
    force[0] = 0.0
    depth = T.response(times, force, *solid)
    rate = T.response_rate(times, force, *solid)
    assert depth[0] == 0
    assert depth[1:] == pytest.approx(2 * T.compliance(x1, times[1:], *others), rel=1e-13)
    # 17 decades down, the rate keeps its digits.
    assert rate[1:] == pytest.approx(2 * T.compliance_rate(x1, times[1:], *others), rel=1e-12)
    # A first force that is not 0 is a jump too, also alone; the zero of time does not matter.
    assert T.response(times[1:] + 7.0, force[1:], *solid)[:8] == pytest.approx(depth[1:9], rel=1e-12)
    assert T.response([4.0], [2.0], *solid) == pytest.approx(depth[1:2], rel=1e-14)


def plain_quadrature(t, times, force, kernel):
    """The sum of jumps times the kernel, and the integral of the slope times it, interval by interval."""
    total = force[0] * kernel(t - times[0])
    for i in range(1, np.flatnonzero(times <= t)[-1] + 1):
        change, duration = force[i] - force[i - 1], times[i] - times[i - 1]
        if duration == 0:
            total += change * kernel(t - times[i])
        else:
            part, _ = quad(lambda y: kernel(t - y), times[i - 1], times[i], epsabs=1e-13, epsrel=1e-12)
            total += change / duration * part
    return total


@pytest.mark.parametrize(("x1", "viscous", "dimension"), [(3.0, 0.0, 2), (0.5, 0.3, 1)])
def test_random_histories_against_plain_quadrature(x1, viscous, dimension):
    rng = np.random.default_rng(11)
    times = np.sort(rng.uniform(0, 40, 8))
    times = np.sort(np.concatenate([times, times[[2, 5]]]))
    force = rng.normal(size=times.size)
    depth = T.response(times, force, x1, viscous, dimension)
    letter = T.response_rate(times, force, x1, viscous, dimension, instantaneous=False)
    for found, measure, rel in ((depth, T.compliance, 1e-10), (letter, T.compliance_rate, 1e-9)):
        for i in (0, 4, 9):
            expected = plain_quadrature(
                times[i], times, force, lambda y, measure=measure: measure(x1, y, viscous, dimension)
            )
            assert found[i] == pytest.approx(expected, rel=rel)


def test_rate_is_the_derivative_of_the_depth_but_for_the_term_that_the_paper_leaves_out():
    times = np.array([0.0, 5.0, 5.0, 9.0, 12.0 - 1e-5, 12.0, 12.0 + 1e-5, 20.0])
    force = np.array([1.0, 3.0, -1.0, 2.0, 2.0, 2.0, 2.0, 2.0])
    depth, rate = T.response(times, force, 3.0), T.response_rate(times, force, 3.0)
    letter = T.response_rate(times, force, 3.0, instantaneous=False)
    # Slopes at each time: of the interval that begins there; before the jump and at the end, that ends there.
    slopes = np.array([0.4, 0.4, 0.75, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert rate - letter == pytest.approx(slopes / T.site_stiffness(3.0), rel=1e-13, abs=1e-16)
    assert rate[5] == pytest.approx((depth[6] - depth[4]) / 2e-5, rel=1e-7)
