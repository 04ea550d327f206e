"""The compliance of a site against sums over modes, other integrals, closed forms, many-digit quadrature."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.special import ive

from asperity.theory import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    Dispersion,
    compliance,
    compliance_asymptote,
    compliance_asymptote_paper,
    compliance_rate,
    site_stiffness,
    torus_compliance,
)
from asperity.theory.zone import zone_nodes

Floats = NDArray[np.float64]


def plain_sum(x1: float, x2: float, shape: tuple[int, ...], viscous: float) -> float:
    """Every mode of a torus, one by one, as the definition has it; lam = 0 has its term without decay."""
    axes = [2 * np.pi * np.arange(n) / n for n in shape]
    total = 1 / x1
    for q in np.array(np.meshgrid(*axes)).reshape(len(shape), -1).T[1:]:
        lam = float(np.sum(2 - 2 * np.cos(q)))
        z = (lam + viscous) * x1 * lam / (x1 + lam)
        total += 1 / lam + (1 / (x1 + lam) - 1 / lam) * math.exp(-z * x2)
    return total / math.prod(shape)


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


@pytest.mark.parametrize(("point", "depth", "rate"), MANY_DIGITS)
def test_compliance_has_fourteen_digits_at_the_corners(
    point: tuple[float, float, float, int], depth: float, rate: float
) -> None:
    assert compliance(*point) == pytest.approx(depth, rel=1e-14)
    assert compliance_rate(*point) == pytest.approx(rate, rel=1e-14)


@pytest.mark.parametrize("dimension", [1, 2])
def test_zone_measure_has_the_moments_of_the_lattice(dimension: int) -> None:
    lam, weight = zone_nodes(dimension, 0.0)
    # mean lam^n counts the closed walks of the lattice: 1, 2d, (2d)^2 + 2d, (2d)^3 + 3 (2d)^2.
    z = 2 * dimension
    moments = [1, z, z**2 + z, z**3 + 3 * z**2]
    assert [weight @ lam**n for n in range(4)] == pytest.approx(moments, rel=1e-14)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("x1", [0.05, 30.0])
def test_site_stiffness_against_a_random_walk(x1: float, dimension: int) -> None:
    # 1/(x1 + lam) = int exp(-(x1 + lam) s) ds, and the mean of exp(-lam s) is [exp(-2 s) I0(2 s)]^dimension.
    def walk(s: float) -> float:
        return math.exp(-x1 * s) * float(ive(0, 2 * s)) ** dimension

    reference, _ = quad(walk, 0, 40 / x1, limit=400, epsabs=0, epsrel=1e-12)
    assert 1 / site_stiffness(x1, dimension) == pytest.approx(reference, rel=1e-11)
    assert compliance(x1, 0.0, 7.0, dimension) == pytest.approx(1 / site_stiffness(x1, dimension), rel=1e-13)


def test_site_stiffness_is_k1_for_hard_springs_and_falls_like_a_logarithm_for_soft_ones() -> None:
    assert site_stiffness(1e9) == pytest.approx(1e9 + 4, rel=1e-12)
    # K(m) -> ln(4/sqrt(1 - m)) as m -> 1, with 1 - m -> x1/2.
    assert site_stiffness(1e-12) == pytest.approx(4 * math.pi / math.log(32 / 1e-12), rel=1e-11)
    # Origin: the ratio quoted in the text of the package, 37 % at x1 = 10.
    assert site_stiffness(10.0) / 10 == pytest.approx(1.37, abs=0.005)


@pytest.mark.parametrize("shape", [(1,), (5,), (6,), (1, 4), (4, 6), (3, 5)])
def test_torus_against_the_sum_over_every_mode(shape: tuple[int, ...]) -> None:
    times = np.array([0.0, 0.3, 20.0, np.inf])
    for viscous in (0.0, 0.4):
        expected = [plain_sum(1.7, x2, shape, viscous) for x2 in times]
        assert torus_compliance(1.7, times, shape, viscous) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("viscous", [0.0, 0.7])
def test_compliance_follows_from_the_equations_of_motion(viscous: float) -> None:
    """Integrate Eqs. (us), (dosrs) on a small torus, in real space, with matrices."""
    n, m, k0, k1, R, t = 4, 5, 1.3, 2.1, 0.6, 3.0
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
    assert torus_compliance(k1 / k0, k0 * R * t, (n, m), viscous) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("viscous", [0.0, 0.3])
@pytest.mark.parametrize("x1", [0.5, 100.0])
def test_each_asymptotic_term_gains_its_order(x1: float, viscous: float, dimension: int) -> None:
    x2 = np.array([1e6, 1e8])
    exact = compliance(x1, x2, viscous, dimension)
    leading = exact - compliance_asymptote(x2, viscous, dimension)
    both = exact - compliance_asymptote(x2, viscous, dimension, x1=x1)
    order = {(2, False): 0.5, (2, True): 1.0, (1, False): 0.25, (1, True): 0.5}[dimension, viscous > 0]
    # What the leading term misses falls as x2^(-order) and is the second term; what both miss is far smaller.
    second = leading - both
    assert math.log(second[0] / second[1]) / math.log(100) == pytest.approx(order, rel=1e-3)
    assert np.abs(both[0]) < 0.02 * np.abs(leading[0])


def test_late_slope_and_intercept_are_the_numbers_of_the_paper() -> None:
    assert pytest.approx(0.04, abs=5e-4) == LATE_SLOPE
    assert pytest.approx(0.3, abs=2e-3) == LATE_INTERCEPT
    x2 = 1e12
    assert x2 * compliance_rate([0.1, 3.0, 100.0], x2) == pytest.approx([LATE_SLOPE] * 3, rel=1e-5)
    assert x2 * compliance_rate(3.0, x2, 1e-3) == pytest.approx(2 * LATE_SLOPE, rel=1e-5)


def test_the_papers_dotted_line_is_the_asymptote_rounded() -> None:
    assert compliance_asymptote_paper([1.0, math.e]) == pytest.approx([0.3, 0.34], rel=1e-15)
    assert compliance_asymptote_paper(1e6) == pytest.approx(float(compliance_asymptote(1e6)), rel=6e-3)


def test_arguments_broadcast_block_by_block_and_scalars_give_floats() -> None:
    x1, x2 = np.array([0.1, 1.0, 10.0])[:, None], np.linspace(0, 5e3, 2500)
    table = compliance(x1, x2, 0.1)
    assert table.shape == (3, 2500)
    assert table[2, 1800] == pytest.approx(float(compliance(10.0, x2[1800], 0.1)), rel=1e-14)
    assert np.diff(table).min() > 0
    assert isinstance(compliance(1.0, 1.0), float)
    assert isinstance(torus_compliance(1.0, 1.0, (4, 4)), float)
    assert compliance(np.zeros((0, 2)) + 1, 1.0).shape == (0, 2)


def long_waves(*q: Floats) -> Floats:
    """A dispersion that is not quadratic: a cone."""
    return np.asarray(np.sqrt(sum(component**2 for component in q)))


@pytest.mark.parametrize("dimension", [1, 2])
def test_the_lattice_as_a_function_is_the_lattice(dimension: int) -> None:
    x1 = np.array([1e-3, 3.0, 1e4])[:, None, None]
    x2 = np.array([0.0, 1.0, 1e4, 1e15])[:, None]
    viscous = np.array([0.0, 1e-2, 1e6])

    def sines(*q: Floats) -> Floats:
        return np.asarray(sum(4 * np.sin(component / 2) ** 2 for component in q))

    for measure in (compliance, compliance_rate):
        known = measure(x1, x2, viscous, dimension)
        assert measure(x1, x2, viscous, dimension, dispersion=sines) == pytest.approx(known, rel=1e-12)


def test_late_continuum_has_the_papers_slope_and_its_own_intercept() -> None:
    # The late integral of (1 - exp(-x2 q^4)) / q^2 is (pi/2) (ln(x2 pi^4) + gamma_E) over the disk q < pi,
    # and over the rest of the square 8 int_0^(pi/4) -ln cos = 2 pi ln 2 - 4 K.
    catalan = 0.915965594177219015054603514932384110774
    intercept = (4 * math.log(2 * math.pi) + np.euler_gamma - 8 * catalan / math.pi) / (8 * math.pi)
    assert intercept == pytest.approx(0.222667, abs=5e-7)  # what a quadrature of the limit gives
    late = np.array([1e16, 1e20])
    grown = compliance(3.0, late, dispersion="continuum")
    assert grown - LATE_SLOPE * np.log(late) == pytest.approx([intercept] * 2, rel=0, abs=1e-9)
    # On the line the late growth knows only of long waves, which are those of the lattice.
    line = compliance(3.0, 1e20, dimension=1, dispersion="continuum")
    assert line == pytest.approx(compliance_asymptote(1e20, dimension=1), rel=1e-5)


@pytest.mark.parametrize(("law", "power"), [("continuum", 2), (long_waves, 1)])
def test_other_dispersions_against_integrals_in_polar_coordinates(law: Dispersion, power: int) -> None:
    x1, x2, r = 0.7, 20.0, 0.3

    def depth(q: float) -> float:
        lam = q**power
        z = (lam + r) * x1 * lam / (x1 + lam)
        return (1 - x1 / lam * math.expm1(-z * x2)) / (x1 + lam)

    def ray(angle: float) -> float:
        return quad(lambda q: q * depth(q), 0, math.pi / math.cos(angle), epsabs=0, epsrel=1e-12)[0]

    reference = 2 / math.pi**2 * quad(ray, 0, math.pi / 4, epsabs=0, epsrel=1e-11)[0]
    assert compliance(x1, x2, r, dispersion=law) == pytest.approx(reference, rel=1e-10)
    line = quad(depth, 0, math.pi, epsabs=0, epsrel=1e-12)[0] / math.pi
    assert compliance(x1, x2, r, 1, dispersion=law) == pytest.approx(line, rel=1e-11)


def test_stiffer_along_one_axis_is_allowed() -> None:
    # Before creep and at large x1: <1/(x1 + lam)> = 1/x1 - <lam>/x1^2 + ..., and <lam> = 2 + 2 * 9.
    soft = compliance(1e6, 0.0, dispersion=lambda qx, qy: 2 - 2 * np.cos(qx) + 9 * (2 - 2 * np.cos(qy)))
    assert 1 - 1e6 * soft == pytest.approx(20 / 1e6, rel=1e-4)
